"""Convolutions of fields in single precision on a CPU: sixteen lines at a time, one in each lane of a vector.

A convolution needs its modes in no order. What goes in is in order and comes out of the transform with the
digits of its index reversed; there it is multiplied by a table in that order, and what comes back is in order
again, so that nothing is ever moved about (Gentleman and Sande 1966, AFIPS Conf. Proc. 29, 563). A row of 2n
real cells is transformed as n complex numbers (Cooley, Lewis and Welch 1970, J. Sound Vib. 12, 315).
"""

import warp as wp

from warpwear.kernels.cells import Cells

#: Whole registers, where compilers take half of each: a fifth less time.
FLAGS = "-march=native -mprefer-vector-width=512"
wp.set_module_options({"enable_backward": False, "cpu_compiler_flags": FLAGS})

#: Lines that are transformed together.
LINES = 16


@wp.struct
class Plan:
    """A transform of one length: its stages from the longest on, and the factors between them."""

    length: wp.int32
    radices: wp.array(dtype=wp.int32)  # 2, 3, 4 or 5, whose product is the length; −2: 2, half of it zeros
    turns: wp.array(dtype=wp.float32)  # cosine and sine of each factor, stage by stage


@wp.struct
class Rows:
    """What turns n complex numbers into the modes 0 … n of 2n real ones, in the order of the transform."""

    plan: Plan  # of n
    partners: wp.array(dtype=wp.int32)  # place of mode n − k, by that of k; of mode 0 its own
    turns: wp.array(dtype=wp.float32)  # cosine and sine of π k/n, negated


# What follows is put together to functions in C++. Number i of sixteen lines has its real parts at x + 32 i
# and its imaginary ones at x + 32 i + 16; a transform that takes the one for the other goes backwards.
_BEGIN = """
    typedef float Lanes __attribute__((vector_size(64)));
    typedef float Stored __attribute__((vector_size(64), aligned(4)));
    typedef double Doubles __attribute__((vector_size(128), aligned(8)));
    struct Half { enum { radix = 2, half = 1 }; };
    struct Two { enum { radix = 2, half = 0 }; };
    struct Three { enum { radix = 3, half = 0 }; };
    struct Four { enum { radix = 4, half = 0 }; };
    struct Five { enum { radix = 5, half = 0 }; };
    const auto at = [](float* x) -> Stored& { return *(Stored*)x; };
    // One stage: blocks of `size` become `radix` blocks each. First come the sums and then the factors; on
    // the way back the factors come first.
    const auto stage = [&](auto kind, float* x, int length, int size, const float* turns, bool back) {
        constexpr int r = decltype(kind)::radix;
        constexpr bool half = decltype(kind)::half;
        const int m = size / r, real = back ? 16 : 0, imag = 16 - real;
        for (int first = 0; first < length; first += size) {
            const float* turn = turns;
            float* here = x + 32 * first;
            for (int j = 0; j < m; ++j, here += 32, turn += 2 * (r - 1)) {
                Lanes a[r], b[r];
                for (int q = 0; q < r; ++q) {
                    if (half && q && !back) { a[q] = b[q] = Lanes{}; continue; }
                    a[q] = at(here + 32 * q * m + real);
                    b[q] = at(here + 32 * q * m + imag);
                }
                if (back) {
                    for (int q = 1; q < r; ++q) {
                        const Lanes c = a[q] * turn[2 * q - 2] - b[q] * turn[2 * q - 1];
                        b[q] = a[q] * turn[2 * q - 1] + b[q] * turn[2 * q - 2];
                        a[q] = c;
                    }
                }
                Lanes c[r], d[r];
                if constexpr (r == 2) {
                    c[0] = a[0] + a[1]; d[0] = b[0] + b[1];
                    c[1] = a[0] - a[1]; d[1] = b[0] - b[1];
                } else if constexpr (r == 3) {
                    const Lanes s = a[1] + a[2], t = b[1] + b[2];
                    const float sine = 0.8660254037844386f;
                    const Lanes u = sine * (a[1] - a[2]), v = sine * (b[1] - b[2]);
                    const Lanes e = a[0] - 0.5f * s, f = b[0] - 0.5f * t;
                    c[0] = a[0] + s; d[0] = b[0] + t;
                    c[1] = e + v; d[1] = f - u;
                    c[2] = e - v; d[2] = f + u;
                } else if constexpr (r == 4) {
                    const Lanes s = a[0] + a[2], t = b[0] + b[2], u = a[0] - a[2], v = b[0] - b[2];
                    const Lanes e = a[1] + a[3], f = b[1] + b[3], g = a[1] - a[3], h = b[1] - b[3];
                    c[0] = s + e; d[0] = t + f;
                    c[1] = u + h; d[1] = v - g;
                    c[2] = s - e; d[2] = t - f;
                    c[3] = u - h; d[3] = v + g;
                } else {
                    const float c1 = 0.30901699437494745f, c2 = -0.8090169943749475f;
                    const float s1 = 0.9510565162951535f, s2 = 0.5877852522924731f;
                    const Lanes p = a[1] + a[4], q = b[1] + b[4], s = a[2] + a[3], t = b[2] + b[3];
                    const Lanes e = a[1] - a[4], f = b[1] - b[4], g = a[2] - a[3], h = b[2] - b[3];
                    const Lanes u = a[0] + c1 * p + c2 * s, v = b[0] + c1 * q + c2 * t;
                    const Lanes w = a[0] + c2 * p + c1 * s, z = b[0] + c2 * q + c1 * t;
                    const Lanes i = s1 * e + s2 * g, j = s1 * f + s2 * h;
                    const Lanes k = s2 * e - s1 * g, l = s2 * f - s1 * h;
                    c[0] = a[0] + p + s; d[0] = b[0] + q + t;
                    c[1] = u + j; d[1] = v - i;
                    c[2] = w + l; d[2] = z - k;
                    c[3] = w - l; d[3] = z + k;
                    c[4] = u - j; d[4] = v + i;
                }
                if (!back) {
                    for (int q = 1; q < r; ++q) {
                        const Lanes e = c[q] * turn[2 * q - 2] - d[q] * turn[2 * q - 1];
                        d[q] = c[q] * turn[2 * q - 1] + d[q] * turn[2 * q - 2];
                        c[q] = e;
                    }
                }
                for (int q = 0; q < (half && back ? 1 : r); ++q) {
                    at(here + 32 * q * m + real) = c[q];
                    at(here + 32 * q * m + imag) = d[q];
                }
            }
        }
    };
    const auto transform = [&](const Plan_T& plan, float* x, bool back) {
        const int length = plan.length, stages = plan.radices.shape[0];
        const float* turns = plan.turns.data + (back ? plan.turns.shape[0] : 0);
        int size = back ? 1 : length;
        for (int n = 0; n < stages; ++n) {
            const int kind = plan.radices.data[back ? stages - 1 - n : n], r = kind > 0 ? kind : 2;
            if (back) size *= r;
            const int of_stage = 2 * (r - 1) * (size / r);
            if (back) turns -= of_stage;
            if (kind < 0) stage(Half(), x, length, size, turns, back);
            else if (r == 4) stage(Four(), x, length, size, turns, back);
            else if (r == 2) stage(Two(), x, length, size, turns, back);
            else if (r == 3) stage(Three(), x, length, size, turns, back);
            else stage(Five(), x, length, size, turns, back);
            if (!back) { turns += of_stage; size /= r; }
        }
    };
    const auto transpose = [](Lanes* a) {
        for (int n = 0; n < 4; ++n) {
            Lanes b[16];
            for (int i = 0; i < 8; ++i) {
                b[2 * i] = __builtin_shufflevector(
                    a[i], a[i + 8], 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
                b[2 * i + 1] = __builtin_shufflevector(
                    a[i], a[i + 8], 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
            }
            for (int i = 0; i < 16; ++i) a[i] = b[i];
        }
    };
"""
_FORWARD = """
{
    const int n = rows.plan.length, nx = field.shape[0], ny = columns, first = 16 * batch;
    const int of_row = 8 * field.shape[1], groups = spectrum.shape[0];
    const int of_batch = nx - first < 16 ? nx - first : 16;
    float* const x = &wp::index(scratch, slab, 0);
    const double* const cells = (const double*)field.data + (size_t)first * of_row;
    const int filled = rows.plan.radices.data[0] < 0 ? n / 2 : n;
    for (int k = 0; k < filled; k += 16) {
        Lanes a[16], b[16];
        for (int i = 0; i < 16; ++i) {
            Lanes u = {}, v = {};
            const double* const line = cells + (size_t)i * of_row + 2 * k;
            if (i < of_batch && 2 * k + 32 <= ny) {
                u = __builtin_convertvector(*(const Doubles*)line, Lanes);
                v = __builtin_convertvector(*(const Doubles*)(line + 16), Lanes);
            } else if (i < of_batch) {
                for (int j = 0; j < 16 && 2 * k + j < ny; ++j) u[j] = line[j];
                for (int j = 0; j < 16 && 2 * k + 16 + j < ny; ++j) v[j] = line[16 + j];
            }
            a[i] = __builtin_shufflevector(u, v, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            b[i] = __builtin_shufflevector(u, v, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
        }
        transpose(a);
        transpose(b);
        for (int i = 0; i < 16 && k + i < filled; ++i) {
            at(x + 32 * (k + i)) = a[i];
            at(x + 32 * (k + i) + 16) = b[i];
        }
    }
    transform(rows.plan, x, false);
    const Lanes a0 = at(x), b0 = at(x + 16);
    for (int k = 1; k < n; ++k) {
        const int l = rows.partners.data[k];
        if (l < k) continue;
        float *const y = x + 32 * k, *const z = x + 32 * l;
        const float c = rows.turns.data[2 * k], s = rows.turns.data[2 * k + 1];
        const Lanes a = at(y), b = at(y + 16), e = at(z), f = at(z + 16);
        const Lanes p = a + e, q = b - f, u = b + f, v = e - a;
        const Lanes g = u * c - v * s, h = u * s + v * c;
        at(y) = p + g; at(y + 16) = q + h;
        if (l > k) { at(z) = p - g; at(z + 16) = h - q; }
    }
    at(x) = 2.0f * (a0 + b0); at(x + 16) = Lanes{};
    at(x + 32 * n) = 2.0f * (a0 - b0); at(x + 32 * n + 16) = Lanes{};
    for (int k = n + 1; k < 16 * groups; ++k) { at(x + 32 * k) = Lanes{}; at(x + 32 * k + 16) = Lanes{}; }
    for (int g = 0; g < groups; ++g) {
        Lanes a[16], b[16];
        for (int i = 0; i < 16; ++i) {
            a[i] = at(x + 32 * (16 * g + i));
            b[i] = at(x + 32 * (16 * g + i) + 16);
        }
        transpose(a);
        transpose(b);
        float* const place = &wp::index(spectrum, g, first, 0);
        for (int i = 0; i < of_batch; ++i) { at(place + 32 * i) = a[i]; at(place + 32 * i + 16) = b[i]; }
    }
}
"""
_ACROSS = """
{
    const int n = plan.length, nx = spectrum.shape[1];
    float* const place = &wp::index(spectrum, group, 0, 0);
    float* const x = n == nx ? place : &wp::index(scratch, slab, 0);
    if (n > nx) {
        __builtin_memcpy(x, place, sizeof(float) * 32 * nx);
        const int filled = plan.radices.data[0] < 0 ? n / 2 : n;
        __builtin_memset(x + 32 * nx, 0, sizeof(float) * 32 * (filled - nx));
    }
    transform(plan, x, false);
    float* const factors = &wp::index(table, group, 0, 0);
    for (int k = 0; k < n; ++k) {
        const Lanes factor = at(factors + 16 * folded.data[k]);
        at(x + 32 * k) *= factor;
        at(x + 32 * k + 16) *= factor;
    }
    transform(plan, x, true);
    if (n > nx) __builtin_memcpy(place, x, sizeof(float) * 32 * nx);
}
"""
_BACK = """
{
    const int n = rows.plan.length, nx = field.shape[0], ny = columns, first = 16 * batch;
    const int of_row = 8 * field.shape[1], groups = spectrum.shape[0];
    const int of_batch = nx - first < 16 ? nx - first : 16;
    float* const x = &wp::index(scratch, slab, 0);
    for (int g = 0; g < groups; ++g) {
        Lanes a[16], b[16];
        float* const place = &wp::index(spectrum, g, first, 0);
        for (int i = 0; i < 16; ++i) {
            a[i] = i < of_batch ? at(place + 32 * i) : Lanes{};
            b[i] = i < of_batch ? at(place + 32 * i + 16) : Lanes{};
        }
        transpose(a);
        transpose(b);
        for (int i = 0; i < 16; ++i) {
            at(x + 32 * (16 * g + i)) = a[i];
            at(x + 32 * (16 * g + i) + 16) = b[i];
        }
    }
    const Lanes a0 = at(x), an = at(x + 32 * n);
    for (int k = 1; k < n; ++k) {
        const int l = rows.partners.data[k];
        if (l < k) continue;
        float *const y = x + 32 * k, *const z = x + 32 * l;
        const float c = rows.turns.data[2 * k], s = -rows.turns.data[2 * k + 1];
        const Lanes a = at(y), b = at(y + 16), e = at(z), f = at(z + 16);
        const Lanes p = a + e, q = b - f, g = a - e, h = b + f;
        const Lanes u = g * c - h * s, v = g * s + h * c;
        at(y) = p - v; at(y + 16) = q + u;
        if (l > k) { at(z) = p + v; at(z + 16) = u - q; }
    }
    at(x) = a0 + an; at(x + 16) = a0 - an;
    transform(rows.plan, x, true);
    double* const cells = (double*)field.data + (size_t)first * of_row;
    for (int k = 0; k < n && 2 * k < ny; k += 16) {
        Lanes a[16], b[16];
        for (int i = 0; i < 16; ++i) {
            const int j = k + i < n ? k + i : n - 1;
            a[i] = at(x + 32 * j);
            b[i] = at(x + 32 * j + 16);
        }
        transpose(a);
        transpose(b);
        for (int i = 0; i < of_batch; ++i) {
            const Lanes u = __builtin_shufflevector(
                a[i], b[i], 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            const Lanes v = __builtin_shufflevector(
                a[i], b[i], 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
            double* const line = cells + (size_t)i * of_row + 2 * k;
            if (2 * k + 32 <= ny) {
                *(Doubles*)line = __builtin_convertvector(u, Doubles);
                *(Doubles*)(line + 16) = __builtin_convertvector(v, Doubles);
            } else {
                for (int j = 0; j < 16 && 2 * k + j < ny; ++j) line[j] = u[j];
                for (int j = 0; j < 16 && 2 * k + 16 + j < ny; ++j) line[16 + j] = v[j];
            }
        }
    }
}
"""


def _begin(plan: str) -> str:
    return "\n{" + _BEGIN.replace("const Plan_T&", "const auto&") + plan + "}\n"


@wp.func_native(_begin(_FORWARD))
def forward_rows(
    batch: wp.int32,
    slab: wp.int32,
    columns: wp.int32,
    rows: Rows,
    field: wp.array2d(dtype=Cells),
    scratch: wp.array2d(dtype=wp.float32),
    spectrum: wp.array3d(dtype=wp.float32),
):
    """Transforms sixteen rows of a field."""
    ...


@wp.func_native(_begin(_ACROSS))
def across_columns(
    group: wp.int32,
    slab: wp.int32,
    plan: Plan,
    folded: wp.array(dtype=wp.int32),
    table: wp.array3d(dtype=wp.float32),
    scratch: wp.array2d(dtype=wp.float32),
    spectrum: wp.array3d(dtype=wp.float32),
):
    """Transforms sixteen columns of modes, multiplies them and transforms them back."""
    ...


@wp.func_native(_begin(_BACK))
def back_rows(
    batch: wp.int32,
    slab: wp.int32,
    columns: wp.int32,
    rows: Rows,
    spectrum: wp.array3d(dtype=wp.float32),
    scratch: wp.array2d(dtype=wp.float32),
    field: wp.array2d(dtype=Cells),
):
    """Transforms the modes of sixteen rows back to cells."""
    ...


@wp.kernel
def forward(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    of_slab: wp.int32,
    columns: wp.int32,
    rows: Rows,
    field_in: wp.array2d(dtype=Cells),
    scratch_out: wp.array2d(dtype=wp.float32),
    spectrum_out: wp.array3d(dtype=wp.float32),
):
    """Modes of the rows; a slot is sixteen of them. of_slab: slots that share a row of the scratch memory."""
    slot = first_slot + wp.tid()
    forward_rows(slot, slot // of_slab, columns, rows, field_in, scratch_out, spectrum_out)


@wp.kernel
def across(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    of_slab: wp.int32,
    plan: Plan,
    folded_in: wp.array(dtype=wp.int32),
    table_in: wp.array3d(dtype=wp.float32),
    scratch_out: wp.array2d(dtype=wp.float32),
    spectrum_out: wp.array3d(dtype=wp.float32),
):
    """Multiply the modes of all columns by a table, in place; a slot is sixteen columns of modes.

    The table is even: mode k is multiplied by the line that `folded_in` has in its place.
    """
    slot = first_slot + wp.tid()
    across_columns(slot, slot // of_slab, plan, folded_in, table_in, scratch_out, spectrum_out)


@wp.kernel
def back(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    of_slab: wp.int32,
    columns: wp.int32,
    rows: Rows,
    spectrum_in: wp.array3d(dtype=wp.float32),
    scratch_out: wp.array2d(dtype=wp.float32),
    field_out: wp.array2d(dtype=Cells),
):
    """Cells of the rows from their modes; a slot is sixteen rows."""
    slot = first_slot + wp.tid()
    back_rows(slot, slot // of_slab, columns, rows, spectrum_in, scratch_out, field_out)
