"""What the benchmark compares with, in plain NumPy: the same algorithm, and a displaced contact.

Lengths in mm, pressures in MPa, loads in N. Arrays are float64 [x, y], axis 0 along the sliding direction.
Work arrays are kept from step to step and every operation writes into one, as a careful author would: nothing
is allocated in a loop. Less is recorded than by the package: approach, area in contact and volumes of a step.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from contenders.search import TIE, TOLERANCE, bisected, newton_in_bracket
from warpwear import Study

FloatArray = NDArray[np.float64]

#: Rows of a block that stays in the cache.
BLOCK = 32


class Solved(NamedTuple):
    """What every contender says of a step."""

    approach: float  # [mm]
    volume_counter: float  # worn so far [mm³]
    volume_disc: float
    area: float  # in contact [mm²]
    evaluations: int  # of the load at an approach


@dataclass(frozen=True)
class Problem:
    """The numbers of a study that a loop needs."""

    load: float
    hardness: float
    cell: float
    wear_counter: float  # K [mm²/N]
    wear_disc: float
    compliance: float  # 1/k of the local foundation [mm³/N]
    implicit: bool
    tolerance: float  # of a bearing area [N]
    factor: FloatArray  # on the disc's distance, one value a column, shape (ny,)

    @classmethod
    def of(cls, study: Study) -> Self:
        """From a study with constant K and a factor that is none or across (eq 4.22)."""
        y = study.cells.y
        across = study.wear.distance_factor == "across"
        factor = np.sqrt(1.0 - (y * study.counter.form.curvature) ** 2) if across else np.ones_like(y)
        counter, disc = (law.steady for law in study.wear_laws)
        return cls(
            load=study.contact.load,
            hardness=study.hardness,
            cell=study.grid.cell,
            wear_counter=counter,
            wear_disc=disc,
            compliance=1.0 / study.contact.stiffness,
            implicit=study.stepping.scheme == "implicit",
            tolerance=study.load_tolerance,
            factor=factor,
        )

    def compliance_of(self, increment: float) -> float:
        """c of a step [mm³/N]; the implicit one's is of a disc without a factor."""
        worn = (self.wear_counter + self.wear_disc) * increment if self.implicit else 0.0
        return self.compliance + worn


def sag_of(x: FloatArray, y: FloatArray, curvature: float, *, out: FloatArray | None = None) -> FloatArray:
    """Height of the counter-body over its apex [mm], r²/(R + √(R² − r²)), shape (x.size, y.size)."""
    sag = np.empty((x.size, y.size)) if out is None else out
    squared = y * y
    for first in range(0, x.size, BLOCK):
        block = sag[first : first + BLOCK]
        np.add.outer(x[first : first + BLOCK] ** 2, squared, out=block)
        root = block * -(curvature**2)
        root += 1.0
        np.sqrt(root, out=root)
        root += 1.0
        block *= curvature
        block /= root
    return sag


class NumpyLoop:
    """The package's algorithm over the whole grid: Newton in a bracket or bisection, then wear."""

    def __init__(self, problem: Problem, gap: FloatArray) -> None:
        """gap: of the unworn bodies from the mean planes [mm], shape (nx, ny); worn in place."""
        self.problem = problem
        self.gap = gap
        self.wear_counter = np.zeros_like(gap)
        self.wear_disc = np.zeros_like(gap)
        self.last: tuple[float, float] | None = None  # approach and mean pressure of the last step
        self.allocate()

    def allocate(self) -> None:
        """Work arrays."""
        self.overlap = np.empty_like(self.gap)
        self.work = np.empty_like(self.gap)
        self._flags = np.empty(self.gap.shape, dtype=bool)

    def advance(self, increment: float) -> Solved:
        """Balance the load, then wear over an increment [mm]."""
        problem = self.problem
        area = problem.cell**2
        counter, disc = problem.wear_counter * increment, problem.wear_disc * increment
        c = problem.compliance_of(increment)
        if c == 0.0:
            low, high = self.bounds()
            approach, found, trials = bisected(
                self.count, low, high + 2.0 * TIE, problem.load / (problem.hardness * area),
                problem.tolerance / (problem.hardness * area),
            )  # fmt: skip
            mean = problem.load / (found * area)
            sums = self.wear_bearing(approach, counter * mean, disc * mean)
        else:
            deepest = problem.hardness * c
            base, offset, trials = self._balanced(c, deepest, counter + disc)
            approach = base + offset
            sums = self.wear_overlap(offset, deepest, counter / c, disc / c)
        contact, worn_counter, worn_disc = sums
        self.last = approach, problem.load / (contact * area)
        return Solved(approach, worn_counter * area, worn_disc * area, contact * area, trials)

    def _balanced(self, c: float, deepest: float, removal: float) -> tuple[float, float, int]:
        """Base, offset and evaluations of the contact with compliance, balanced to TOLERANCE."""
        load, per_length = self.problem.load, self.problem.cell**2 / c
        low, high = -math.inf, math.inf
        if self.last is None:
            base, highest = self.bounds()
            low, high = 0.0, highest - base + min(deepest, load / per_length)
            guess = 0.5 * high
        else:
            base, mean = self.last
            guess = removal * mean
        trials = 0
        for _ in range(3):
            self.set_base(base)

            def carried(offset: float) -> tuple[float, float]:
                pressed, between = self.carried(offset, deepest)
                return pressed * per_length, between * per_length

            offset, force, more = newton_in_bracket(carried, load, guess, low, high)
            trials += more
            if abs(force - load) <= TOLERANCE * load:
                return base, offset, trials
            base, guess, low, high = base + offset, 0.0, -math.inf, math.inf
        raise ArithmeticError(f"{force - load} N of {load} N are left")

    def bounds(self) -> tuple[float, float]:
        """Smallest and largest gap [mm]."""
        return float(self.gap.min()), float(self.gap.max())

    def set_base(self, base: float) -> None:
        """The approach [mm] from which the offsets of the next evaluations count."""
        np.subtract(base, self.gap, out=self.overlap)

    def carried(self, offset: float, deepest: float) -> tuple[float, float]:
        """Sum of the overlaps up to `deepest` [mm], and number of cells strictly between 0 and it."""
        between = float(self._pressed(offset, deepest))
        if math.isfinite(deepest):
            between -= np.count_nonzero(np.greater_equal(self.work, deepest, out=self._flags))
        return float(self.work.sum()), between

    def _pressed(self, offset: float, deepest: float) -> int:
        """Leaves the overlaps, clipped to 0 … deepest, in the work array; returns how many are not 0."""
        np.add(self.overlap, offset, out=self.work)
        np.clip(self.work, 0.0, deepest, out=self.work)
        return int(np.count_nonzero(np.greater(self.work, 0.0, out=self._flags)))

    def count(self, approach: float) -> float:
        """Cells not higher than an approach [mm]."""
        return float(np.count_nonzero(np.less_equal(self.gap, approach, out=self._flags)))

    def wear_overlap(
        self, offset: float, deepest: float, counter: float, disc: float
    ) -> tuple[float, float, float]:
        """Each body loses its share of the overlaps; cells in contact, summed wear of both [mm]."""
        return self._wear(self._pressed(offset, deepest), counter, disc)

    def wear_bearing(self, approach: float, counter: float, disc: float) -> tuple[float, float, float]:
        """Each body loses the same depth [mm] in every cell not higher than the approach."""
        contact = self.count(approach)
        self.work[...] = self._flags
        return self._wear(contact, counter, disc)

    def _wear(self, contact: float, counter: float, disc: float) -> tuple[float, float, float]:
        for wear, share in ((self.wear_counter, counter), (self.wear_disc, disc * self.problem.factor)):
            np.multiply(self.work, share, out=self.overlap)
            self.gap += self.overlap
            wear += self.overlap
        return float(contact), float(self.wear_counter.sum()), float(self.wear_disc.sum())


class Slid(NamedTuple):
    """One step of a displaced contact."""

    approach: float  # [mm]
    cells: int  # in contact
    pressure: float  # in each of them [MPa]
    trials: int


def sliding_step(
    counter: FloatArray,
    track: FloatArray,
    *,
    start: int,
    load: float,
    hardness: float,
    cell: float,
    removal_counter: float,
    removal_disc: float,
    work: tuple[FloatArray, NDArray[np.bool_]],
) -> Slid:
    """A bearing area of a ball over one window of a track, and the wear of both, in place.

    ball: its surface over the unworn apex, as worn [mm], shape (nx, ny). track: heights of the disc as worn
    [mm], shape (≥ start + nx, ny); the window is its rows start … start + nx, so a disc that moves by 8 cells
    a step has start = 8 i. The gap is ball − window; the approach is bisected until the load is met to half
    a cell's force (gaps do not tie on a rough track), the pressure is load over area. removal_*: K ΔL of a
    body in this step [mm³/N]; a swept track's ΔL is the shift. work: arrays of the counter-body's shape.

    ArithmeticError where cells tie so that no approach meets the load.
    """
    gap, flags = work
    window = track[start : start + counter.shape[0]]
    np.subtract(counter, window, out=gap)

    def count(approach: float) -> float:
        return float(np.count_nonzero(np.less_equal(gap, approach, out=flags)))

    approach, cells, trials = bisected(
        count, float(gap.min()), float(gap.max()) + 2.0 * TIE, load / (hardness * cell**2), 0.5
    )
    pressure = load / (cells * cell**2)
    np.multiply(flags, removal_counter * pressure, out=gap)
    counter += gap
    np.multiply(flags, removal_disc * pressure, out=gap)
    window -= gap
    return Slid(approach, int(cells), pressure, trials)


def work_for(counter: FloatArray) -> tuple[FloatArray, NDArray[Any]]:
    """Work arrays of `sliding_step`."""
    return np.empty_like(counter), np.empty(counter.shape, dtype=bool)
