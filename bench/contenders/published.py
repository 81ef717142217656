"""The published way to balance a load, in plain NumPy: a pass over both surfaces for every trial."""

from typing import Self

import numpy as np

from contenders.baselines import FloatArray, NumpyLoop, Problem, Solved, sag_of
from contenders.search import TIE, bisected


class PublishedLoop:
    """Bisects the approach as published, between bounds of the gap, with a pass over S − D per trial.

    S is the ball's surface and D the disc's, both as worn [mm]. A contact without compliance is the bearing
    area (thesis eqs 4.8–4.11); with it the pressures are summed instead. Pressures are then scaled to the
    load, so that volumes are exact whatever the tolerance.
    """

    def __init__(
        self,
        problem: Problem,
        counter: FloatArray,
        disc: FloatArray,
        worn: tuple[float, float] = (0.0, 0.0),
        *,
        work: FloatArray | None = None,
    ) -> None:
        """worn: volumes of counter-body and disc so far [mm³]. All arrays are taken over."""
        self.problem = problem
        self.counter = counter
        self.disc = disc
        self._volumes = worn
        self._gap = np.empty_like(counter) if work is None else work
        self._flags = np.empty(counter.shape, dtype=bool)

    @classmethod
    def after(cls, loop: NumpyLoop, x: FloatArray, y: FloatArray, curvature: float) -> Self:
        """From where another loop stands, in the memory of that one, which ends here. x, y: of cells [mm]."""
        area = loop.problem.cell**2
        worn = float(loop.wear_counter.sum()) * area, float(loop.wear_disc.sum()) * area
        counter = sag_of(x, y, curvature, out=loop.overlap)
        counter += loop.wear_counter
        disc = np.subtract(counter, loop.gap, out=loop.gap)
        return cls(loop.problem, counter, disc, worn, work=loop.work)

    def advance(self, increment: float, *, tolerance: float | None = None) -> Solved:
        """Balance the load to a tolerance [N], by default the study's, then wear over an increment [mm]."""
        problem = self.problem
        area = problem.cell**2
        tolerance = problem.tolerance if tolerance is None else tolerance
        c = problem.compliance_of(increment)
        np.subtract(self.counter, self.disc, out=self._gap)
        low, high = float(self._gap.min()), float(self._gap.max())
        if c == 0.0:
            unit = problem.hardness * area
            approach, carried, trials = bisected(
                self._count, low, high + 2.0 * TIE, problem.load / unit, tolerance / unit
            )
            self._gap[...] = self._flags
        else:
            unit = area / c
            deepest = problem.hardness * c
            high += min(deepest, problem.load / unit)
            approach, carried, trials = bisected(
                lambda approach: self._pressed(approach, deepest),
                low, high, problem.load / unit, tolerance / unit,
            )  # fmt: skip
        contact = np.count_nonzero(self._gap) * area
        self._gap *= problem.load / (carried * area)  # the pressure
        volume_counter = problem.load * problem.wear_counter * increment
        volume_disc = float((self._gap * problem.factor).sum()) * area * problem.wear_disc * increment
        self._volumes = self._volumes[0] + volume_counter, self._volumes[1] + volume_disc
        self._gap *= problem.wear_counter * increment
        self.counter += self._gap
        self._gap *= problem.wear_disc / problem.wear_counter * problem.factor
        self.disc -= self._gap
        return Solved(approach, *self._volumes, contact, trials)

    def _count(self, approach: float) -> float:
        np.subtract(self.counter, self.disc, out=self._gap)
        return float(np.count_nonzero(np.less_equal(self._gap, approach, out=self._flags)))

    def _pressed(self, approach: float, deepest: float) -> float:
        np.subtract(self.counter, self.disc, out=self._gap)
        np.subtract(approach, self._gap, out=self._gap)
        np.clip(self._gap, 0.0, deepest, out=self._gap)
        return float(self._gap.sum())
