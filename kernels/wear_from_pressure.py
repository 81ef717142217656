"""Archard wear of both bodies by a stored pressure: of a grid at rest, on a track, and of patches.

While a disc moves under the sphere, its asperities and the pressure move with it during a step. A cell of the
disc is worn by its own pressure, one of the sphere by the mean of those that pass over it along x.

A row of the fields is a row of a grid, which is one line of a `Layout`, or a patch with its lines one after
another.
"""

import warp as wp

from warpwear.kernels.cells import (
    LANES,
    NO_INDEX,
    ONE,
    ZERO,
    Cells,
    PressureMost,
    PressureSum,
    largest_of,
    sum_of,
)
from warpwear.kernels.sliding import Bodies, beneath
from warpwear.kernels.wear_loops import Layout

wp.set_module_options({"enable_backward": False})


@wp.struct
class Increment:
    """What a step does to the cells."""

    wear_per_pressure_sphere: wp.float64  # K ΔL [mm³/N]
    wear_per_pressure_disc: wp.float64
    shift: wp.int32  # rows by which the disc is displaced
    cap: wp.float64  # largest pressure [MPa]
    approach: wp.float64  # [mm]
    reference: wp.float64  # pressure from which the squares count [MPa]
    parts: wp.array2d(dtype=Cells)  # of the cap, that cells bear; no rows where all bear it


@wp.kernel
def gaps(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift: wp.int32,
    bodies: Bodies,
    passing_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
):
    """Gap that a cell of the disc, displaced by `shift` rows, meets on its way through a step.

    passing_in: mean of the sphere's wear along that way, instead of the wear at its middle; one row where it
    does not change along x.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    under = beneath(row, shift, bodies.disc.shape[0])
    passing_row = wp.min(row, passing_in.shape[0] - 1)
    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        worn_more = passing_in[passing_row, k] - bodies.wear_sphere[row, k]
        gap_out[row, k] = (bodies.sphere[row, k] + worn_more) - bodies.disc[under, k]


@wp.kernel
def mean_of_lines(
    first_column: wp.int32,
    slots_per_row: wp.int32,
    field_in: wp.array2d(dtype=Cells),
    mean_out: wp.array2d(dtype=Cells),
):
    """Mean of a field along x, in one row. A thread is a column of vectors."""
    k = first_column + wp.tid()
    total = Cells(ZERO)
    for row in range(field_in.shape[0]):
        total += field_in[row, k]
    mean_out[0, k] = total / wp.float64(field_in.shape[0])


@wp.kernel
def mean_passing(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    window: wp.int32,
    field_in: wp.array2d(dtype=Cells),
    mean_out: wp.array2d(dtype=Cells),
):
    """Mean of a field over `window` rows around each; of an even number the row at either end counts half.

    At the first and the last row the field is mirrored, so that its sum is kept there too.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    rows = field_in.shape[0]
    half = window // 2
    end = wp.where(window % 2 == 0, wp.float64(0.5), ONE)
    for k in range(slot % slots_per_row, mean_out.shape[1], slots_per_row):
        total = Cells(ZERO)
        for i in range(row - half, row + half + 1):
            inside = wp.where(i < 0, -1 - i, wp.where(i < rows, i, 2 * rows - 1 - i))
            weight = wp.where(i == row - half or i == row + half, end, ONE)
            total += weight * field_in[inside, k]
        mean_out[row, k] = total / wp.float64(window)


@wp.kernel
def wear(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    increment: Increment,
    layout: Layout,
    pressure_in: wp.array2d(dtype=Cells),
    passing_in: wp.array2d(dtype=Cells),
    gradient_in: wp.array2d(dtype=Cells),
    bodies: Bodies,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: the disc loses K ΔL p, the sphere K ΔL times the mean that passes it.

    Without a disc all wear is the sphere's, whose height is then the gap.

    passing_in: that mean; one row where it does not change along x. gradient_in: gap after the step, from the
    mean planes [mm]: where it is below the approach at the cap, a disc that keeps its dents is displaced for
    good by the difference. Sums and maxima of the disc are over what lies under the sphere.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    # A store into a field makes a compiler read a struct anew: what the loops need is read before them.
    wear_per_pressure_sphere = increment.wear_per_pressure_sphere
    wear_per_pressure_disc = increment.wear_per_pressure_disc
    cap = increment.cap
    approach = increment.approach
    reference = increment.reference
    parted = increment.parts.shape[0] > 0
    vectors = layout.vectors
    domain_row = layout.first_row[row]
    domain_column = layout.first_column[row]
    has_disc = bodies.disc.shape[0] > 0
    under = beneath(row, increment.shift, bodies.disc.shape[0])
    passing_row = wp.min(row, passing_in.shape[0] - 1)
    keeps = has_disc and bodies.plastic_disc.shape[0] == bodies.disc.shape[0]
    shows = bodies.reached.shape[0] != bodies.sphere.shape[0]
    pressure = Cells(ZERO)
    deviation = Cells(ZERO)
    contact = Cells(ZERO)
    capped = Cells(ZERO)
    touched = Cells(ZERO)
    worn_sphere = Cells(ZERO)
    worn_disc = Cells(ZERO)
    pressed = Cells(ZERO)
    highest = Cells(ZERO)
    deepest_sphere = Cells(ZERO)
    deepest_disc = Cells(ZERO)
    first = Cells(NO_INDEX)
    last = Cells(NO_INDEX)
    first_row = NO_INDEX + ZERO  # variables of their own
    last_row = NO_INDEX + ZERO
    for line in range(bodies.sphere.shape[1] // vectors):
        in_line = Cells(ZERO)
        for vector in range(slot % slots_per_row, vectors, slots_per_row):
            k = line * vectors + vector
            first_column = domain_column + vector * LANES
            p = pressure_in[row, k]
            m = passing_in[passing_row, k]
            s = bodies.sphere[row, k]
            a = bodies.wear_sphere[row, k]
            before = a
            if not shows:
                before = bodies.reached[row, k]
            is_touched = Cells(ZERO)
            caps = Cells(cap)
            if parted:
                caps = cap * increment.parts[row, k]
            for j in range(LANES):
                removed = wear_per_pressure_sphere * m[j]
                s[j] = s[j] + removed
                a[j] = a[j] + removed
                pressure[j] += p[j]
                from_reference = wp.where(p[j] > ZERO, p[j] - reference, ZERO)
                deviation[j] += from_reference * from_reference
                contact[j] += wp.where(p[j] > ZERO, ONE, ZERO)
                capped[j] += wp.where(p[j] >= caps[j], ONE, ZERO)
                reached = m[j] + before[j] > ZERO
                column = wp.float64(first_column + j)
                is_touched[j] = wp.where(reached, ONE, ZERO)
                first[j] = wp.max(first[j], wp.where(reached, -column, NO_INDEX))
                last[j] = wp.max(last[j], wp.where(reached, column, NO_INDEX))
                highest[j] = wp.max(highest[j], p[j])
                deepest_sphere[j] = wp.max(deepest_sphere[j], a[j])
            bodies.sphere[row, k] = s
            bodies.wear_sphere[row, k] = a
            worn_sphere += a
            in_line += is_touched
            if not shows:
                bodies.reached[row, k] = is_touched
            if has_disc:
                d = bodies.disc[under, k]
                b = bodies.wear_disc[under, k]
                if keeps:
                    t = gradient_in[row, k]
                    x = bodies.plastic_disc[under, k]
                    for j in range(LANES):
                        is_capped = p[j] >= caps[j]
                        beyond = wp.where(is_capped, wp.max(approach - t[j], ZERO), ZERO)
                        d[j] = d[j] - beyond
                        x[j] = x[j] + beyond
                    bodies.plastic_disc[under, k] = x
                    pressed += x
                for j in range(LANES):
                    removed = wear_per_pressure_disc * p[j]
                    d[j] = d[j] - removed
                    b[j] = b[j] + removed
                    deepest_disc[j] = wp.max(deepest_disc[j], b[j])
                bodies.disc[under, k] = d
                bodies.wear_disc[under, k] = b
                worn_disc += b
        touched += in_line
        if wp.max(in_line) > ZERO:
            first_row = wp.max(first_row, -wp.float64(domain_row + line))
            last_row = wp.max(last_row, wp.float64(domain_row + line))
    sums_out[PressureSum.PRESSURE, slot] = sum_of(pressure)
    sums_out[PressureSum.DEVIATION_SQUARED, slot] = sum_of(deviation)
    sums_out[PressureSum.CONTACT, slot] = sum_of(contact)
    sums_out[PressureSum.CAPPED, slot] = sum_of(capped)
    sums_out[PressureSum.TOUCHED, slot] = sum_of(touched)
    sums_out[PressureSum.WEAR_SPHERE, slot] = sum_of(worn_sphere)
    sums_out[PressureSum.WEAR_DISC, slot] = sum_of(worn_disc)
    sums_out[PressureSum.PRESSED_DISC, slot] = sum_of(pressed)
    maxima_out[PressureMost.PRESSURE, slot] = largest_of(highest)
    maxima_out[PressureMost.WEAR_SPHERE, slot] = largest_of(deepest_sphere)
    maxima_out[PressureMost.WEAR_DISC, slot] = largest_of(deepest_disc)
    maxima_out[PressureMost.FIRST_ROW, slot] = first_row
    maxima_out[PressureMost.LAST_ROW, slot] = last_row
    maxima_out[PressureMost.FIRST_COLUMN, slot] = largest_of(first)
    maxima_out[PressureMost.LAST_COLUMN, slot] = largest_of(last)
