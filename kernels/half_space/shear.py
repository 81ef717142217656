"""A search for the tangential traction of a contact with friction: its numbers, passes and decisions.

`contact.half_space.shear` says what is looked for, `native/half_space/shear.h` has the loops over cells.
"""

from enum import IntEnum

import warp as wp

from warpwear.kernels.cells import NONE, ONE, ZERO, Cells
from warpwear.kernels.half_space.solve import CONVERGED, LED_NOWHERE, RUNS
from warpwear.kernels.native_code import Lines, lane, lines_of_table, passes_of

native_pass = passes_of(__name__, "half_space/shear.h")

#: Lines of the table of partial results.
LINES = 14
#: Force that a search may miss, over Σ c: of a shift that ends, and of a traction that is taken.
MISSED = wp.constant(wp.float64(1.0e-13))
MISSED_AT_END = wp.constant(wp.float64(1.0e-12))
#: Steps with cells that come to their circles after which one is plain, as the first is: where bodies slide,
#: the preconditioner pushes some of them the wrong way.
HITS = wp.constant(wp.int32(5))
#: Shifts of one trial at most.
SHIFTS = wp.constant(wp.int32(100))
#: Damping of the first of them, over that of a cell, and what a better or a worse one multiplies it by.
DAMPING = wp.constant(wp.float64(1.0e-6))
EASED = wp.constant(wp.float64(0.1))
HARDENED = wp.constant(wp.float64(100.0))
#: Least determinant of what cells may follow, over its squared trace: below it they all slip one way.
ONE_WAY = wp.constant(wp.float64(1.0e-12))


class ShearFlag(IntEnum):
    """Names what a decision says of what follows: places in `Shear.flags`."""

    SEARCHING = 0
    SHIFTING = 1
    PRECONDITIONS = 2


@wp.struct
class ShearNumbers:
    """Holds what the host asks of a search, and what that knows; vectors are along both axes."""

    forced: wp.int32  # 1 where the force is prescribed, 0 where the displacement is
    force: wp.vec2d  # Σ q that is to be carried [MPa]
    level: wp.vec2d  # rigid displacement of the increment [mm]
    tolerance: wp.float64  # of the largest violation, over the scale
    most: wp.int32  # iterations
    strength: wp.float64  # by which multipliers weigh in the preconditioner [MPa/mm]
    scale: wp.float64  # largest displacement by the bound itself [mm]
    cells: wp.float64  # in contact
    bounds: wp.float64  # Σ c [MPa]
    violation: wp.float64  # over the scale
    missed: wp.float64  # force, over Σ c
    last: wp.float64  # g z of the last step
    downhill: wp.float64  # g d
    memory: wp.float64
    mean: wp.vec2d
    length: wp.float64
    shift: wp.vec2d  # of the trial [MPa]
    best: wp.vec2d  # shift so far, the force that it misses, and by how much shifts add to that
    miss: wp.vec2d
    slopes: wp.vec3d  # xx, xy and yy
    least: wp.float64  # force missed by it, over Σ c
    damping: wp.float64  # of its next change
    shifts: wp.int32
    hits: wp.int32  # steps one after another in which a free cell has come to its circle
    iteration: wp.int32
    status: wp.int32


@wp.struct
class Shear:
    """Holds a search. Fields of vectors have the rows of one component after those of the other."""

    traction: wp.array2d(dtype=Cells)  # q [MPa]
    start: wp.array2d(dtype=Cells)  # what surfaces were displaced by at the start of the increment [mm]
    response: wp.array2d(dtype=Cells)  # [mm]
    gradient: wp.array2d(dtype=Cells)  # g, slip that cells may follow [mm]
    change: wp.array2d(dtype=Cells)  # of it since the last step [mm]
    trial: wp.array2d(dtype=Cells)  # z [MPa]
    way: wp.array2d(dtype=Cells)  # d [MPa]
    tie: wp.array2d(dtype=Cells)  # [mm/MPa]
    bound: wp.array2d(dtype=Cells)  # c [MPa]
    numbers: wp.array(dtype=ShearNumbers)  # one
    table: wp.array2d(dtype=wp.float64)  # a line a sum or maximum, a column a slot
    flags: wp.array(dtype=wp.int32)  # by `ShearFlag`


#: Take the displacement by the last traction as the start, and the bound along axis 0 as the traction.
starts = native_pass("shear_starts", shear=Shear)
#: Sum up the bound, find the largest response to it, and begin with no traction.
scale = native_pass("shear_scale", shear=Shear)
#: Sum up how far cells inside their circles have been displaced, and all in contact.
levels = native_pass("shear_levels", shear=Shear)
#: Make ties and gradient of the slip; find by how much it breaches the conditions.
slips = native_pass("shear_slips", shear=Shear)
#: Make the descent, and sum up its products.
descends = native_pass("shear_descends", shear=Shear)
#: Make the way of a step.
aims = native_pass("shear_aims", shear=Shear)
#: Sum up the curvature along the way.
curves = native_pass("shear_curves", shear=Shear)
#: Go along the way, each cell within its circle.
goes = native_pass("shear_moves<true>", shear=Shear)
#: Shift the trial, each cell within its circle.
shifts = native_pass("shear_moves<false>", shear=Shear)


@wp.func
def lines_of(shear: Shear, sums: wp.int32, lines: wp.int32):
    """Bring the first lines of the table to a number each: so many sums, then maxima."""
    return lines_of_table(shear.table, shear.table.shape[1], sums, lines)


@wp.func
def shift_of(xx: wp.float64, xy: wp.float64, yy: wp.float64, sums: wp.vec2d):
    """Return the shift of all cells that adds up to a sum; nothing where they all slip one way."""
    determinant = xx * yy - xy * xy
    if determinant > ONE_WAY * (xx + yy) * (xx + yy):
        return wp.vec2d(yy * sums[0] - xy * sums[1], xx * sums[1] - xy * sums[0]) / determinant
    return wp.vec2d(ZERO, ZERO)


@wp.func
def shifted(shear: Shear, n: ShearNumbers, lines: Lines):
    """Shift the trial on, until it carries the force, by Newton's method, damped more after it led away."""
    miss = n.force - wp.vec2d(lines[0], lines[1])
    n.missed = wp.where(n.forced == 1, wp.max(wp.abs(miss[0]), wp.abs(miss[1])) / n.bounds, ZERO)
    if n.missed < n.least:
        n.least = n.missed
        n.best = n.shift
        n.miss = miss
        n.slopes = wp.vec3d(lines[2], lines[3], lines[4])
        n.damping = n.damping * EASED
    else:
        n.damping = n.damping * HARDENED
    damping = n.damping * n.cells
    n.shift = n.best + shift_of(n.slopes[0] + damping, n.slopes[1], n.slopes[2] + damping, n.miss)
    n.shifts = n.shifts + 1
    shear.flags[ShearFlag.SHIFTING] = wp.where(n.missed > MISSED and n.shifts <= SHIFTS, 1, 0)
    return n


@wp.func
def unshifted(n: ShearNumbers):
    """Begin to shift a trial."""
    n.shift = wp.vec2d(ZERO, ZERO)
    n.shifts = 0
    n.least = NONE
    n.damping = DAMPING
    return n


@wp.kernel
def begin(shear: Shear):
    """Begin with no traction, or with the force on all cells alike."""
    lines = lines_of(shear, 6, 7)
    if lane() == 0:
        n = unshifted(shear.numbers[0])
        n.cells = lines[2]
        n.bounds = lines[5]
        n.scale = lines[6]
        n.hits = HITS
        n.status = RUNS
        shear.numbers[0] = shifted(shear, n, lines)


@wp.kernel
def shift(shear: Shear):
    """Shift on, until the force is met."""
    lines = lines_of(shear, 5, 6)
    if lane() == 0:
        shear.numbers[0] = shifted(shear, shear.numbers[0], lines)


@wp.kernel
def arrive(shear: Shear):
    """Note what a step has led to, and shift where it misses the force."""
    lines = lines_of(shear, 5, 6)
    if lane() == 0:
        n = shear.numbers[0]
        plain = shear.flags[ShearFlag.PRECONDITIONS] == 0
        n.hits = wp.where(plain or lines[5] > ZERO, wp.where(plain, 1, n.hits + 1), 0)
        n.iteration = n.iteration + 1
        shear.numbers[0] = shifted(shear, n, lines)


@wp.kernel
def level(shear: Shear):
    """Find the rigid displacement: under a force, that by which cells slip least where they may move."""
    lines = lines_of(shear, 8, 8)
    if lane() == 0:
        n = shear.numbers[0]
        if n.forced == 1:
            n.level = -shift_of(lines[5], lines[6], lines[7], wp.vec2d(lines[3], lines[4]))
            if wp.length_sq(n.level) == ZERO:  # all slip one way
                n.level = wp.vec2d(-lines[1] / lines[0], -lines[2] / lines[0])
        shear.numbers[0] = n


@wp.kernel
def judge(shear: Shear):
    """Judge whether the traction is the solution."""
    lines = lines_of(shear, 0, 2)
    if lane() == 0:
        n = shear.numbers[0]
        n.violation = wp.max(wp.sqrt(lines[0]), lines[1]) / n.scale
        if n.violation <= n.tolerance and n.missed <= MISSED_AT_END:
            n.status = CONVERGED
        elif n.iteration >= n.most:
            n.status = LED_NOWHERE
        shear.flags[ShearFlag.PRECONDITIONS] = wp.where(n.hits < HITS, 1, 0)
        shear.flags[ShearFlag.SEARCHING] = wp.where(n.status == RUNS, 1, 0)
        shear.numbers[0] = n


@wp.kernel
def aim(shear: Shear):
    """Decide how the way is made of descent and last way; under a force it moves none on the whole."""
    lines = lines_of(shear, 14, 14)
    if lane() == 0:
        n = shear.numbers[0]
        descent = shift_of(lines[4], lines[5], lines[6], wp.vec2d(lines[0], lines[1]))
        last = shift_of(lines[4], lines[5], lines[6], wp.vec2d(lines[2], lines[3]))
        if n.forced == 0:
            descent = wp.vec2d(ZERO, ZERO)
            last = wp.vec2d(ZERO, ZERO)
        of_gradient = wp.vec2d(lines[10], lines[11])
        gz = lines[7] - wp.dot(descent, of_gradient)
        cz = lines[8] - wp.dot(descent, wp.vec2d(lines[12], lines[13]))
        gd = lines[9] - wp.dot(last, of_gradient)
        n.memory = ZERO
        if n.last > ZERO:
            n.memory = wp.max(ZERO, cz / n.last)
        if gz + n.memory * gd <= ZERO:
            n.memory = ZERO
        n.mean = descent + n.memory * last
        n.downhill = gz + n.memory * gd
        n.last = gz
        shear.numbers[0] = n


@wp.kernel
def go(shear: Shear):
    """Decide how far to go along the way: to the least energy along it."""
    lines = lines_of(shear, 1, 1)
    if lane() == 0:
        n = unshifted(shear.numbers[0])
        n.length = wp.where(lines[0] > ZERO, n.downhill / wp.where(lines[0] > ZERO, lines[0], ONE), ZERO)
        shear.numbers[0] = n
