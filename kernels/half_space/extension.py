"""What the preconditioner of a search does beside its transforms: it extends values of free cells to others.

|q| E*/2 is the inverse of the whole surface. Of free cells alone it is the inverse of their own operator if
their gradient is extended to the other cells so that no pressure is needed there. About that extension is
made here, by two of Jacobi's iterations with the coefficients of next neighbours alone. Whatever extension E
is made, Eᵀ |q| E is symmetric and positive as |q| is. On a CPU, in single precision as the transforms
between. Symbols as in `search`.
"""

import warp as wp

from warpwear.kernels.cells import Cells
from warpwear.kernels.half_space.search import Fields, SingleCells

wp.set_module_options({"enable_backward": False})

#: Rows of a slot.
ROWS = 16
#: Weights of neighbours along x, along y and across corners.
Weights = wp.types.vector(3, wp.float32)

# Cells of a tile and two around it begin with what the fields hold, `begun`, and from it those one further in
# are made, `within`; eight at a time, after two vectors that end in what lies to the left. Where there is no
# cell there is nothing.
_BEGIN = """
{
    #pragma clang fp contract(fast)
    typedef double D __attribute__((ext_vector_type(8), aligned(8)));
    typedef float F __attribute__((ext_vector_type(8)));
    const int deep = DEEP, most = 128, ahead = 16, rows = fields.pressure.shape[0];
    const bool parted = fields.parts.shape[0] > 0;
    const D zero = 0.0, one = 1.0, level = wp::index(approach_in, 0), cap_of_all = fields.cap;
    const float along = weights[0], across = weights[1], corner = weights[2];
    F begun[deep + 4][most + 4], bound[deep + 4][most + 4], within[deep + 2][most + 4];
    const auto around = [&](const F* above, const F* here, const F* below) {
        const F before = above[-1] + below[-1], beside = above[0] + below[0], after = above[1] + below[1];
        const F left = __builtin_shufflevector(before, beside, 7, 8, 9, 10, 11, 12, 13, 14);
        const F right = __builtin_shufflevector(beside, after, 1, 2, 3, 4, 5, 6, 7, 8);
        const F own_left = __builtin_shufflevector(here[-1], here[0], 7, 8, 9, 10, 11, 12, 13, 14);
        const F own_right = __builtin_shufflevector(here[0], here[1], 1, 2, 3, 4, 5, 6, 7, 8);
        return along * beside + across * (own_left + own_right) + corner * (left + right);
    };
    const int top = slot * deep, height = rows - top < deep ? rows - top : deep;
    for (int left = 0; left < columns; left += 8 * most) {
        const int size = columns - left < 8 * most ? columns - left : 8 * most, vectors = (size + 7) / 8;
        for (int i = 0; i < height + 4; ++i) {
            float *const begins = (float*)begun[i], *const bounds = (float*)bound[i];
            const int asked = top + i - 2, row = (asked + 2 * rows) % rows;
            const D* const pressure = (const D*)&wp::index(fields.pressure, row, 0);
            const D* const gradient = (const D*)&wp::index(fields.gradient, row, 0);
            const D* const parts = parted ? (const D*)&wp::index(fields.parts, row, 0) : pressure;
            GIVEN
            const auto load = [&](int v, F& begin, F& is_bound) {
                const D p = pressure[v], t = gradient[v], cap = parted ? cap_of_all * parts[v] : cap_of_all;
                const auto free = ((p > zero) | (t < level)) & ((p < cap) | (t > level));
                begin = __builtin_convertvector(BEGINS, F);
                is_bound = __builtin_convertvector(free ? zero : one, F);
            };
            for (int v = 0; v < vectors; ++v) load(left / 8 + v, begun[i][v + 2], bound[i][v + 2]);
            for (int side = 0; side < 4; ++side) {
                const int k = side < 2 ? side - 2 : size + side - 2, j = (left + k + 2 * columns) % columns;
                F begin, is_bound;
                load(j / 8, begin, is_bound);
                const bool there = wraps || j == left + k;
                begins[ahead + k] = there ? begin[j % 8] : 0.0f;
                bounds[ahead + k] = there ? is_bound[j % 8] : 0.0f;
            }
            if (!wraps && row != asked)
                for (int k = ahead - 2; k < ahead + size + 2; ++k) begins[k] = bounds[k] = 0.0f;
        }
        for (int i = 0; i < height + 2; ++i)
            for (int v = 1; v < vectors + 3; ++v)
                within[i][v] = begun[i + 1][v]
                    + bound[i + 1][v] * around(begun[i] + v, begun[i + 1] + v, begun[i + 2] + v);
        for (int i = 0; i < height; ++i) {
            const int row = top + i;
            MADE_OF* const made = (MADE_OF*)&wp::index(values_out, row, 0) + left / 8;
            GIVEN
            for (int v = 0; v < vectors; ++v) {
                const F given = around(within[i] + v + 2, within[i + 1] + v + 2, within[i + 2] + v + 2);
                made[v] = MADE;
            }
        }
    }
}
"""
_EXTENDED = (
    _BEGIN.replace("DEEP", str(ROWS))
    .replace("GIVEN", "")
    .replace("MADE_OF", "D")
    .replace("BEGINS", "free ? t - level : zero")
    .replace("MADE", "__builtin_convertvector(begun[i + 2][v + 2] + bound[i + 2][v + 2] * given, D)")
)
_GATHERED = (
    _BEGIN.replace("DEEP", str(ROWS))
    .replace("GIVEN", "const D* const values = (const D*)&wp::index(values_in, row, 0);")
    .replace("BEGINS", "free ? zero : values[v]")
    .replace("MADE_OF", "F")
    .replace("MADE", "__builtin_convertvector(values[left / 8 + v], F) + given")
)


@wp.func_native(_EXTENDED)
def extend_rows(
    slot: wp.int32,
    columns: wp.int32,
    wraps: wp.bool,
    weights: Weights,
    approach_in: wp.array(dtype=wp.float64),
    fields: Fields,
    values_out: wp.array2d(dtype=Cells),
):
    """Extends the gradient of the rows of a slot; arguments as of `extend`."""
    ...


@wp.kernel
def extend(
    first_slot: wp.int32,
    _: wp.int32,
    columns: wp.int32,
    wraps: wp.bool,
    weights: Weights,
    approach_in: wp.array(dtype=wp.float64),
    fields: Fields,
    values_out: wp.array2d(dtype=Cells),
):
    """t − λ on the free cells; elsewhere the weighted sum of their neighbours, made twice from the last one.

    columns: of the grid, without padding. wraps: whether the surface repeats beyond its edges.
    """
    extend_rows(first_slot + wp.tid(), columns, wraps, weights, approach_in, fields, values_out)


@wp.func_native(_GATHERED)
def gather_rows(
    slot: wp.int32,
    columns: wp.int32,
    wraps: wp.bool,
    weights: Weights,
    approach_in: wp.array(dtype=wp.float64),
    fields: Fields,
    values_in: wp.array2d(dtype=Cells),
    values_out: wp.array2d(dtype=SingleCells),
):
    """Gathers the values of the rows of a slot; arguments as of `gather`."""
    ...


@wp.kernel
def gather(
    first_slot: wp.int32,
    _: wp.int32,
    columns: wp.int32,
    wraps: wp.bool,
    weights: Weights,
    approach_in: wp.array(dtype=wp.float64),
    fields: Fields,
    values_in: wp.array2d(dtype=Cells),
    values_out: wp.array2d(dtype=SingleCells),
):
    """The transpose of `extend`: adds to values of free cells what those of others give back."""
    gather_rows(first_slot + wp.tid(), columns, wraps, weights, approach_in, fields, values_in, values_out)
