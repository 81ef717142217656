"""The passes over all cells of a search of the half-space solver, each with the sums that the next one needs.

Symbols: p pressure, t = Gp + g its gradient (gap after deformation, from the mean planes), λ the rigid
approach, H the cap. At the solution t = λ on cells with 0 < p < H, t ≥ λ where p = 0, t ≤ λ where p = H.
A cell is free if it may move: p > 0 or t < λ, and p < H or t > λ. Levels and shifts are one for all rows, or
one a row. H is one for all cells, or a part of it of each.
"""

import warp as wp

from warpwear.kernels.cells import LANES, ONE, ZERO, Cells
from warpwear.kernels.wear_loops import LANES_IN_C

wp.set_module_options({"enable_backward": False})

#: Rounding of a sum of two numbers, relatively.
EPSILON = wp.constant(wp.float64(4.0e-16))


#: Cells of a field in single precision.
SingleCells = wp.types.vector(LANES, wp.float32)


@wp.struct
class Fields:
    """What a search moves, and the caps."""

    pressure: wp.array2d(dtype=Cells)  # p [MPa]
    gradient: wp.array2d(dtype=Cells)  # t [mm]
    trial: wp.array2d(dtype=Cells)  # pressure that a step aims at, before it is shifted and clipped [MPa]
    step: wp.array2d(dtype=Cells)  # the last one [MPa]
    response: wp.array2d(dtype=Cells)  # of the gradient to it [mm]
    cap: wp.float64  # H [MPa]
    parts: wp.array2d(dtype=Cells)  # of H, that cells bear; no rows where all bear it


@wp.func
def clipped(x: wp.float64, cap: wp.float64):
    """x between 0 and the cap."""
    return wp.min(wp.max(x, ZERO), cap)


@wp.func
def shifted(x: wp.float64, shift: wp.float64, cap: wp.float64):
    """x + shift between 0 and the cap; at a bound where it is off it by the rounding of the sum alone."""
    y = x + shift
    rounding = EPSILON * wp.abs(shift)
    return wp.where(y < rounding, ZERO, wp.where(y > cap - rounding, cap, y))


@wp.func
def free(p: wp.float64, t: wp.float64, approach: wp.float64, cap: wp.float64):
    """1 where the pressure of a cell may change, else 0."""
    return wp.where((p > ZERO or t < approach) and (p < cap or t > approach), ONE, ZERO)


# What follows is put together to functions in C++, whose arguments are those of the kernels below.
_BEGIN = (
    LANES_IN_C
    + """
{
#if defined(__CUDA_ARCH__)
    const auto any = [](bool v) { return v; };
    typedef float Single;
    const auto doubled = [](Single v) { return double(v); };
#else
    #pragma clang fp contract(fast)
    const auto any = [](auto v) { return __builtin_reduce_or(v) != 0; };
    typedef float Single __attribute__((ext_vector_type(8), aligned(4)));
    const auto doubled = [](Single v) { return __builtin_convertvector(v, Lanes); };
#endif
    const auto free_of = [&](Lanes p, Lanes t, Lanes level, Lanes cap) {
        return ((p > zero) | (t < level)) & ((p < cap) | (t > level));
    };
    const auto clip = [&](Lanes x, Lanes cap) {
        x = x > zero ? x : zero;
        return x < cap ? x : cap;
    };
    const auto move = [&](const Stored* x, Lanes by, Lanes cap) {  // as `shifted`
        const Lanes y = *x + by, rounding = 4.0e-16 * size_of(by);
        const Lanes low = y < rounding ? zero : y;
        return y > cap - rounding ? cap : low;
    };
    const Lanes none = 1.0e300, one = 1.0, cap_of_all = fields.cap;
    const int row = slot / slots_per_row, vectors = fields.pressure.shape[1], of_vector = 8 / lanes;
    const auto of = [&](const auto& values) {
        return wp::index(values, row < values.shape[0] ? row : values.shape[0] - 1);
    };
    Stored* const pressure = (Stored*)&wp::index(fields.pressure, row, 0);
    Stored* const gradient = (Stored*)&wp::index(fields.gradient, row, 0);
    Stored* const trial = (Stored*)&wp::index(fields.trial, row, 0);
    Stored* const steps = (Stored*)&wp::index(fields.step, row, 0);
    const Stored* const response = (const Stored*)&wp::index(fields.response, row, 0);
    const bool parted = fields.parts.shape[0] > 0;
    const Stored* const parts = parted ? (const Stored*)&wp::index(fields.parts, row, 0) : nullptr;
"""
)
_EACH = """
    for (int k = slot % slots_per_row; k < vectors; k += slots_per_row)
        for (int i = k * of_vector; i < (k + 1) * of_vector; ++i) {
            const Lanes cap = parted ? fields.cap * parts[i] : cap_of_all;
"""
_ADVANCE = (
    """
    const Lanes shift = of(shift_in), by = length;
    Lanes sum = 0.0, level = 0.0, highest = -none, lowest = -none;
    Counts touching = 0, between = 0;
"""
    + _EACH
    + """
            Lanes p = pressure[i], t = gradient[i];
            p = whole ? move(trial + i, shift, cap) : clip(p + by * steps[i], cap);
            if (length > 0.0) t += by * response[i];  // else there may be no response
            pressure[i] = p;
            gradient[i] = t;
            const auto touches = p > zero, below = p < cap;
            const Lanes up = touches ? t : -none, down = below ? -t : -none;
            sum += p;
            touching += touches ? yes : no;
            between += (touches & below) ? yes : no;
            level += (touches & below) ? t : zero;
            highest = highest > up ? highest : up;
            lowest = lowest > down ? lowest : down;
        }
    wp::index(sums_out, 0, slot) = total(sum);
    wp::index(sums_out, 1, slot) = count(touching);
    wp::index(sums_out, 2, slot) = count(between);
    wp::index(sums_out, 3, slot) = total(level);
    wp::index(maxima_out, 0, slot) = most(highest);
    wp::index(maxima_out, 1, slot) = most(lowest);
}
"""
)
_RESIDUAL = (
    """
    const Lanes level = of(approach_in);
"""
    + _EACH
    + """
            const Lanes p = pressure[i], t = gradient[i];
            trial[i] = free_of(p, t, level, cap) ? t - level : zero;
        }
}
"""
)
_DESCENT = """
    const bool is_single = gathered_in.shape[0] > 0;
    const Single* const gathered = is_single ? (const Single*)&wp::index(gathered_in, row, 0) : nullptr;
    const Stored* const given = (const Stored*)&wp::index(descent_in, row, 0);
    const auto descent = [&](int i) { return is_single ? doubled(gathered[i]) : Lanes(given[i]); };
"""
_PRODUCTS = (
    _DESCENT
    + """
    const Lanes level = of(approach_in), descent_level = of(descent_level_in);
    Counts free_cells = 0;
    Lanes sum_z = 0.0, sum_r = 0.0, sum_y = 0.0, zy = 0.0, zr = 0.0, sr = 0.0;
    Lanes largest_z = 0.0, largest_r = 0.0;
"""
    + _EACH
    + """
            const Lanes p = pressure[i], t = gradient[i];
            const auto may = free_of(p, t, level, cap);
            if (!any(may)) continue;  // the others are not read
            const Lanes z = may ? descent(i) - descent_level : zero, r = may ? t - level : zero;
            const Lanes y = may ? response[i] : zero, s = steps[i], of_z = size_of(z), of_r = size_of(r);
            free_cells += may ? yes : no;
            sum_z += z;
            sum_r += r;
            sum_y += y;
            zy += z * y;
            zr += z * r;
            sr += s * r;
            largest_z = largest_z > of_z ? largest_z : of_z;
            largest_r = largest_r > of_r ? largest_r : of_r;
        }
    wp::index(sums_out, 0, slot) = count(free_cells);
    wp::index(sums_out, 1, slot) = total(sum_z);
    wp::index(sums_out, 2, slot) = total(sum_r);
    wp::index(sums_out, 3, slot) = total(sum_y);
    wp::index(sums_out, 4, slot) = total(zy);
    wp::index(sums_out, 5, slot) = total(zr);
    wp::index(sums_out, 6, slot) = total(sr);
    wp::index(maxima_out, 0, slot) = most(largest_z);
    wp::index(maxima_out, 1, slot) = most(largest_r);
}
"""
)
_DIRECTION = (
    _DESCENT
    + """
    const Lanes level = of(approach_in), descent_level = of(descent_level_in);
    const Lanes memory = way[0], length = way[1], out = -way[2];
    Lanes sum = 0.0;
    Counts between = 0;
"""
    + _EACH
    + """
            const Lanes p = pressure[i], t = gradient[i];
            const auto may = free_of(p, t, level, cap);
            Lanes d = out * (t - level);
            if (any(may)) d = may ? memory * steps[i] - (descent(i) - descent_level) : d;
            const Lanes x = p + length * d;
            trial[i] = x;
            sum += clip(x, cap);
            between += ((x > zero) & (x < cap)) ? yes : no;
        }
    wp::index(sums_out, 0, slot) = total(sum);
    wp::index(sums_out, 1, slot) = count(between);
}
"""
)
_CARRIED = (
    """
    const Lanes shift = of(shift_in);
    Lanes sum = 0.0;
    Counts between = 0;
"""
    + _EACH
    + """
            const Lanes q = move(trial + i, shift, cap);
            sum += q;
            between += ((q > zero) & (q < cap)) ? yes : no;
        }
    wp::index(sums_out, 0, slot) = total(sum);
    wp::index(sums_out, 1, slot) = count(between);
}
"""
)
_STEP = (
    """
    const Lanes level = of(approach_in), shift = of(shift_in);
    Lanes slope = 0.0, used = 0.0;
"""
    + _EACH
    + """
            const Lanes p = pressure[i], s = move(trial + i, shift, cap) - p;
            steps[i] = s;
            const auto moves = s != zero;
            if (!any(moves)) continue;
            const Lanes room = s < zero ? p : cap - p;
            const auto more = moves & (size_of(s) > used * room);
            if (any(more)) used = more ? size_of(s) / room : used;  // a division is dear
            slope += moves ? s * (gradient[i] - level) : zero;
        }
    wp::index(sums_out, 0, slot) = total(slope);
    wp::index(maxima_out, 0, slot) = most(used);
}
"""
)


@wp.func_native(_BEGIN + _ADVANCE)
def advance_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    whole: wp.bool,
    length: wp.float64,
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Moves pressures and gradient of a slot; arguments as of `advance`."""
    ...


@wp.kernel
def advance(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    whole: wp.bool,
    length: wp.float64,
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """p += length × step, t += length × response. A whole step takes the trial itself, exact at the bounds.

    Sums: p, cells in contact, cells between the bounds and their t. Maxima: t where p > 0, −t where p < H.
    """
    slot = first_slot + wp.tid()
    advance_row(slot, slots_per_row, whole, length, shift_in, fields, sums_out, maxima_out)


@wp.func_native(_BEGIN + _RESIDUAL)
def residual_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    fields: Fields,
):
    """Makes the gradient of free cells of a slot; arguments as of `residual`."""
    ...


@wp.kernel
def residual(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    fields: Fields,
):
    """t − λ on the free cells, 0 elsewhere, in the place of the trial."""
    slot = first_slot + wp.tid()
    residual_row(slot, slots_per_row, approach_in, fields)


@wp.func_native(_BEGIN + _PRODUCTS)
def products_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    descent_level_in: wp.array(dtype=wp.float64),
    fields: Fields,
    descent_in: wp.array2d(dtype=Cells),
    gathered_in: wp.array2d(dtype=SingleCells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Sums up over the free cells of a slot; arguments as of `products`."""
    ...


@wp.kernel
def products(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    descent_level_in: wp.array(dtype=wp.float64),
    fields: Fields,
    descent_in: wp.array2d(dtype=Cells),
    gathered_in: wp.array2d(dtype=SingleCells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Over the free cells, with z = descent − descent_level, r = t − λ, s, y the last step and its response.

    gathered_in: the descent where there are such; no rows where it is descent_in.

    Sums: cells, z, r, y, z y, z r, s r. Maxima: |z|, |r|.
    """
    slot = first_slot + wp.tid()
    products_row(
        slot,
        slots_per_row,
        approach_in,
        descent_level_in,
        fields,
        descent_in,
        gathered_in,
        sums_out,
        maxima_out,
    )


@wp.func_native(_BEGIN + _DIRECTION)
def direction_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    descent_level_in: wp.array(dtype=wp.float64),
    way: wp.vec3d,
    fields: Fields,
    descent_in: wp.array2d(dtype=Cells),
    gathered_in: wp.array2d(dtype=SingleCells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Makes the trial pressures of a slot; arguments as of `direction`."""
    ...


@wp.kernel
def direction(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    descent_level_in: wp.array(dtype=wp.float64),
    way: wp.vec3d,
    fields: Fields,
    descent_in: wp.array2d(dtype=Cells),
    gathered_in: wp.array2d(dtype=SingleCells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Trial pressure p + length × d, with d = −z + memory × last step on the free cells (z as in `products`).

    way: memory, length and outward.
    Elsewhere d = −outward × (t − λ), which points out of the bounds: such a cell moves only if the shift that
    restores the load is larger. Sums: the clipped trial, and cells between the bounds.
    """
    slot = first_slot + wp.tid()
    direction_row(
        slot,
        slots_per_row,
        approach_in,
        descent_level_in,
        way,
        fields,
        descent_in,
        gathered_in,
        sums_out,
    )


@wp.func_native(_BEGIN + _CARRIED)
def carried_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sums up the trial pressures of a slot; arguments as of `carried`."""
    ...


@wp.kernel
def carried(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sums of the trial pressures, shifted and clipped, and of the cells between the bounds."""
    slot = first_slot + wp.tid()
    carried_row(slot, slots_per_row, shift_in, fields, sums_out)


@wp.func_native(_BEGIN + _STEP)
def step_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Makes the step of a slot; arguments as of `step`."""
    ...


@wp.kernel
def step(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Feasible step to the trial. Sum: step × (t − λ). Maximum: fraction used of the room to a bound."""
    slot = first_slot + wp.tid()
    step_row(slot, slots_per_row, approach_in, shift_in, fields, sums_out, maxima_out)
