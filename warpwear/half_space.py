"""The elastic–plastic half-space: contact of two bodies whose surfaces deform together, 0 ≤ p ≤ H.

The pressure minimises ½ p·(G + c)p + p·g at a given mean pressure or approach; see `half_space_search`.
"""

import math
from dataclasses import dataclass

import numpy as np

from warpwear.balance import TOLERANCE as LOAD_TOLERANCE
from warpwear.errors import ConvergenceError, InputError
from warpwear.execution import Executor, Field
from warpwear.grid import FloatArray
from warpwear.half_space_iterate import Iterate
from warpwear.half_space_operator import Operator
from warpwear.half_space_search import Search
from warpwear.influence import Influence

#: Largest violation of complementarity, over the rms height of the gap.
TOLERANCE = 1.0e-6
MAX_ITERATIONS = 1000
#: Of displacements: smaller differences are those of the last digits.
ROUNDING = 16.0 * float(np.finfo(np.float64).eps)
#: Of dp̄/ds, by the displacement left over.
SLOPE_TOLERANCE = 1.0e-8


@dataclass(frozen=True)
class HalfSpaceContact:
    """A solved contact. The fields are the solver's own and last until its next solve."""

    approach: float  # rigid approach from the mean planes [mm]
    mean_pressure: float  # [MPa]
    violation: float  # largest violation of complementarity, over the rms height
    load_residual: float  # mean pressure over the one asked for, − 1; 0 under approach control
    cells_in_contact: int  # with p > 0
    cells_between: int  # with 0 < p < H
    iterations: int
    transforms: int  # pairs of Fourier transforms
    pressure_field: Field
    gradient_field: Field  # gap after deformation and wear, from the mean planes [mm]
    executor: Executor
    cells: int  # of the surface

    @property
    def pressure(self) -> FloatArray:
        """[MPa], shape (nx, ny)."""
        return self.executor.to_numpy(self.pressure_field)

    @property
    def area_fraction(self) -> float:
        """Contact area over nominal area."""
        return self.cells_in_contact / self.cells

    @property
    def separation(self) -> FloatArray:
        """Gap left after deformation (and implicit wear) [mm], shape (nx, ny); negative where p = H."""
        return np.asarray(self.executor.to_numpy(self.gradient_field) - self.approach)


class BoundedPressure:
    """Solves contacts under one operator; each solve starts from the last one's pressure.

    hardness: H [MPa]. tolerance: of the largest violation of complementarity (|t − λ| where 0 < p < H, λ − t
    where p = 0, t − λ where p = H; t gap after deformation, λ approach), over the rms height of the gap. The
    load is met to 1e-12.
    """

    def __init__(
        self,
        executor: Executor,
        influence: Operator,
        *,
        hardness: float = math.inf,
        tolerance: float = TOLERANCE,
        max_iterations: int = MAX_ITERATIONS,
    ) -> None:
        if not hardness > 0.0:
            raise InputError(f"contact.hardness = {hardness:g} MPa is not possible; it must be positive.")
        self._executor = executor
        self._hardness = hardness
        self._tolerance = tolerance
        self._max_iterations = max_iterations
        self._influence = influence
        self._iterate = Iterate(executor, influence, hardness)
        self._started = False

    def forget(self) -> None:
        """Start the next solve from nothing."""
        self._started = False

    def go_on(self) -> None:
        """Start the next solve from what `pressure_field` holds."""
        self._started = True

    @property
    def pressure_field(self) -> Field:
        """Where the next solve starts after `go_on`, to be changed in place between 0 and H [MPa]."""
        return self._iterate.pressure

    @property
    def pressure(self) -> FloatArray:
        """Where the next solve starts [MPa], shape (nx, ny)."""
        return self._executor.to_numpy(self._iterate.pressure)

    def go_on_from(self, pressure: FloatArray) -> None:
        """Start the next solve from a pressure between 0 and H [MPa], shape (nx, ny)."""
        self._executor.fill(self._iterate.pressure, pressure)
        self._started = True

    def solve(
        self,
        gap: Field,
        *,
        mean_pressure: float | None = None,
        approach: float | None = None,
        compliance: float = 0.0,
        streak_compliance: float = 0.0,
        streak_window: int | None = None,
    ) -> HalfSpaceContact:
        """The contact at a mean pressure [MPa] or at an approach [mm].

        gap: from the mean planes [mm]. compliance: c of every cell beside the half-space's [mm/MPa]: K ΔL of
        both bodies for an implicit step of wear. streak_compliance: K ΔL of a body that the other slides
        over, under pressures averaged along x, see `Influence`. streak_window: cells of that mean; None: the
        whole line.

        Raises InputError for a load that the hardness cannot carry, ConvergenceError where the tolerance is
        not met.
        """
        cells = self._influence.cells
        asked = self._asked(mean_pressure, approach)
        self._influence.set_compliance(compliance, streak_compliance, streak_window)
        done = self._influence.transforms
        moments = self._iterate.moments(gap)
        response = self._influence.shortest_response + compliance
        stiffness = 1.0 / response
        if not self._started:
            level = moments.mean if approach is None else approach
            unit = stiffness * (moments.mean - moments.lowest)
            carried = self._iterate.foundation(gap, stiffness=stiffness, level=level)
            self._iterate.take_trial(
                0.0 if asked is None else self._iterate.balance(asked, *carried, unit=unit)
            )
            self._started = True
        search = Search(self._iterate, asked, approach, stiffness)
        state = self._iterate.begin(gap)
        for iteration in range(self._max_iterations + 1):
            level = search.level(state)
            violation = max(state.highest - level, level - state.lowest, 0.0)
            yielded = abs(level) + response * state.total / cells
            scale = moments.rms or yielded
            allowed = max(self._tolerance * scale, ROUNDING * yielded)
            off = 0.0 if asked is None else state.total / asked - 1.0
            if violation <= allowed and abs(off) <= LOAD_TOLERANCE:
                return HalfSpaceContact(
                    approach=level,
                    mean_pressure=state.total / cells,
                    violation=violation / scale if violation > 0.0 else 0.0,
                    load_residual=off,
                    cells_in_contact=round(state.touching),
                    cells_between=round(state.between),
                    iterations=iteration,
                    transforms=self._influence.transforms - done,
                    pressure_field=self._iterate.pressure,
                    gradient_field=self._iterate.gradient,
                    executor=self._executor,
                    cells=cells,
                )
            moved = search.move(state, level, loaded=abs(off) <= LOAD_TOLERANCE)
            if moved is None:
                break
            state = moved
        self._started = False
        raise ConvergenceError(
            f"the half-space contact did not converge in {iteration} iterations: complementarity is violated "
            f"by {violation:.3g} mm, {violation / scale:.3g} of the rms height (allowed {self._tolerance:g})."
        )

    def slope(self, contact: HalfSpaceContact) -> float:
        """Slope dp̄/ds of the last solved contact, mean pressure over approach [MPa/mm].

        Cells at their bounds stay there. Infinite where every cell of a periodic surface follows. Raises
        ConvergenceError.
        """
        cells = self._influence.cells
        if contact.cells_between == 0:
            return 0.0
        if contact.cells_between == cells and self._influence.rigid_mean:
            return math.inf
        total = self._iterate.tangent(tolerance=SLOPE_TOLERANCE, max_iterations=self._max_iterations)
        return total / cells

    def displacement(self) -> FloatArray:
        """Elastic displacement of both surfaces in the last solve [mm], shape (nx, ny), without wear."""
        field = self._executor.zeros()
        self._influence.respond_elastically(self._iterate.pressure, field)
        return self._executor.to_numpy(field)

    def _asked(self, mean_pressure: float | None, approach: float | None) -> float | None:
        """Sum of the pressures of all cells [MPa]; None under approach control."""
        if (mean_pressure is None) == (approach is None):
            raise InputError("a half-space contact needs either a mean pressure or an approach.")
        if mean_pressure is None:
            return None
        if not 0.0 < mean_pressure <= self._hardness:
            raise InputError(
                f"a mean pressure of {mean_pressure:g} MPa is not possible; it must be positive and at most "
                f"the hardness, {self._hardness:g} MPa."
            )
        return mean_pressure * self._influence.cells


class HalfSpace(BoundedPressure):
    """Solves contacts of one grid, as `BoundedPressure` says.

    modulus: E* of both bodies [MPa]. boundary: "periodic" or "free".
    """

    def __init__(
        self,
        executor: Executor,
        *,
        modulus: float,
        boundary: str = "periodic",
        hardness: float = math.inf,
        tolerance: float = TOLERANCE,
        max_iterations: int = MAX_ITERATIONS,
    ) -> None:
        super().__init__(
            executor,
            Influence(executor, modulus=modulus, boundary=boundary),
            hardness=hardness,
            tolerance=tolerance,
            max_iterations=max_iterations,
        )
