"""A disc displaced under the sphere and a stored pressure: gap of the bodies, and what the pressure wears.

During a step the disc's asperities move under the sphere, and the pressure with them. A cell of the disc is
worn by its own pressure, one of the sphere by the mean of those that pass over it: along x, over rows.
"""

import warp as wp

from warpwear.kernels.cells import LANES, NO_INDEX, ONE, ZERO, Cells, largest_of, sum_of
from warpwear.kernels.sliding import beneath

wp.set_module_options({"enable_backward": False})


@wp.kernel
def gaps(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift: wp.int32,
    passing_in: wp.array2d(dtype=Cells),
    wear_sphere_in: wp.array2d(dtype=Cells),
    sphere_in: wp.array2d(dtype=Cells),
    disc_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
):
    """Gap that a cell of the disc meets, displaced by so many rows, on its way through a step.

    passing_in: mean of the sphere's wear along that way, instead of the wear at its middle; one row where it
    is the same along x.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    under = beneath(row, shift, disc_in.shape[0])
    passing_row = wp.min(row, passing_in.shape[0] - 1)
    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        worn_more = passing_in[passing_row, k] - wear_sphere_in[row, k]
        gap_out[row, k] = (sphere_in[row, k] + worn_more) - disc_in[under, k]


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
    """Mean of a field over a window of so many rows; of an even one the row at either end counts half.

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
def remove(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    cap: wp.float64,
    approach: wp.float64,
    removal_sphere: wp.float64,
    removal_disc: wp.float64,
    pressure_reference: wp.float64,
    shift: wp.int32,
    pressure_in: wp.array2d(dtype=Cells),
    passing_in: wp.array2d(dtype=Cells),
    gradient_in: wp.array2d(dtype=Cells),
    sphere_out: wp.array2d(dtype=Cells),
    disc_out: wp.array2d(dtype=Cells),
    wear_sphere_out: wp.array2d(dtype=Cells),
    wear_disc_out: wp.array2d(dtype=Cells),
    plastic_disc_out: wp.array2d(dtype=Cells),
    reached_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: the disc loses K ΔL p, the sphere that of the mean that passes over it.

    passing_in: that mean; one row where it is the same along x. gradient_in: gap after the step, from the
    mean planes [mm]: where it is below the approach at the cap, the disc is displaced for good by so much.
    plastic_disc_out: of one row where the disc springs back; reached_out: of one row where the sphere's wear
    shows where the contact has been. Neither is then looked at.

    Sums and maxima in the order of `types.SUMS` and `types.MAXIMA`; the sums have one row more, what is
    displaced of the disc. Both of the disc are of what lies under the sphere.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    under = beneath(row, shift, disc_out.shape[0])
    passing_row = wp.min(row, passing_in.shape[0] - 1)
    keeps = plastic_disc_out.shape[0] == disc_out.shape[0]
    shows = reached_out.shape[0] != sphere_out.shape[0]
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
    for k in range(slot % slots_per_row, sphere_out.shape[1], slots_per_row):
        p = pressure_in[row, k]
        m = passing_in[passing_row, k]
        s = sphere_out[row, k]
        d = disc_out[under, k]
        a = wear_sphere_out[row, k]
        b = wear_disc_out[under, k]
        if keeps:
            t = gradient_in[row, k]
            x = plastic_disc_out[under, k]
            for j in range(LANES):
                beyond = wp.where(p[j] >= cap, wp.max(approach - t[j], ZERO), ZERO)
                d[j] = d[j] - beyond
                x[j] = x[j] + beyond
            plastic_disc_out[under, k] = x
            pressed += x
        before = a
        if not shows:
            before = reached_out[row, k]
        is_touched = Cells(ZERO)
        for j in range(LANES):
            of_sphere = removal_sphere * m[j]
            of_disc = removal_disc * p[j]
            s[j] = s[j] + of_sphere
            a[j] = a[j] + of_sphere
            d[j] = d[j] - of_disc
            b[j] = b[j] + of_disc
            pressure[j] += p[j]
            from_reference = wp.where(p[j] > ZERO, p[j] - pressure_reference, ZERO)
            deviation[j] += from_reference * from_reference
            contact[j] += wp.where(p[j] > ZERO, ONE, ZERO)
            capped[j] += wp.where(p[j] >= cap, ONE, ZERO)
            reached = m[j] + before[j] > ZERO
            column = wp.float64(k * LANES + j)
            is_touched[j] = wp.where(reached, ONE, ZERO)
            first[j] = wp.max(first[j], wp.where(reached, -column, NO_INDEX))
            last[j] = wp.max(last[j], wp.where(reached, column, NO_INDEX))
            highest[j] = wp.max(highest[j], p[j])
            deepest_sphere[j] = wp.max(deepest_sphere[j], a[j])
            deepest_disc[j] = wp.max(deepest_disc[j], b[j])
        touched += is_touched
        worn_sphere += a
        worn_disc += b
        sphere_out[row, k] = s
        disc_out[under, k] = d
        wear_sphere_out[row, k] = a
        wear_disc_out[under, k] = b
        if not shows:
            reached_out[row, k] = is_touched
    total = sum_of(pressure)
    reached_here = sum_of(touched)
    sums_out[0, slot] = total
    sums_out[1, slot] = total  # every cell slides as far
    sums_out[2, slot] = sum_of(deviation)
    sums_out[3, slot] = sum_of(contact)
    sums_out[4, slot] = sum_of(capped)
    sums_out[5, slot] = reached_here
    sums_out[6, slot] = sum_of(worn_sphere)
    sums_out[7, slot] = sum_of(worn_disc)
    sums_out[8, slot] = sum_of(pressed)
    maxima_out[0, slot] = largest_of(highest)
    maxima_out[1, slot] = largest_of(deepest_sphere)
    maxima_out[2, slot] = largest_of(deepest_disc)
    maxima_out[3, slot] = wp.where(reached_here > ZERO, -wp.float64(row), NO_INDEX)
    maxima_out[4, slot] = wp.where(reached_here > ZERO, wp.float64(row), NO_INDEX)
    maxima_out[5, slot] = largest_of(first)
    maxima_out[6, slot] = largest_of(last)


@wp.kernel
def totals(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift: wp.int32,
    worn_in: wp.int32,
    pressed_in: wp.int32,
    sums_in: wp.array2d(dtype=wp.float64),
    worn_disc_out: wp.array(dtype=wp.float64),
    pressed_disc_out: wp.array(dtype=wp.float64),
):
    """Of every row of the disc under the sphere, its slots' sums in two rows of the table.

    Sums over the fields as they are: increments added up would drift.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    if slot % slots_per_row > 0:
        return
    under = beneath(row, shift, worn_disc_out.shape[0])
    worn = wp.float64(0.0)
    pressed = wp.float64(0.0)
    for other in range(slot, slot + slots_per_row):
        worn += sums_in[worn_in, other]
        pressed += sums_in[pressed_in, other]
    worn_disc_out[under] = worn
    pressed_disc_out[under] = pressed
