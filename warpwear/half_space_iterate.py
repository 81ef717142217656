"""A pressure on a half-space with its gradient, and the passes over the cells that move them."""

import math
from typing import Any, NamedTuple

import warp as wp

from warpwear.balance import Carried, newton_in_bracket
from warpwear.errors import ConvergenceError
from warpwear.execution import Executor, Field
from warpwear.half_space_operator import Operator
from warpwear.kernels import half_space as passes
from warpwear.kernels import half_space_setup, half_space_sums

#: Stands for no cap: kernels compare with it.
NO_CAP = 1.0e300
#: A trial may miss the load by so much, relatively: the next step makes up for it.
ROUGH_BALANCE = 1.0e-3
#: Columns of the table that a GPU reduces partial results to.
FOLDED = 256


class State(NamedTuple):
    """Of the present pressure."""

    total: float  # Σ p [MPa]
    touching: float  # cells with p > 0
    between: float  # cells with 0 < p < H
    level: float  # Σ t of those [mm]
    highest: float  # largest t where p > 0 [mm]
    lowest: float  # smallest t where p < H [mm]


class Products(NamedTuple):
    """Over the free cells: descent z, gradient r = t − λ, last step s and its response y."""

    cells: float
    z: float
    r: float
    y: float
    zy: float
    zr: float
    sr: float
    largest_z: float
    largest_r: float


class Moments(NamedTuple):
    """Of a gap, where there is a surface [mm]."""

    mean: float
    rms: float
    lowest: float


class Iterate:
    """Pressure p, gradient t = Gp + g, trial pressure, step and its response, on the grid of an executor."""

    def __init__(self, executor: Executor, influence: Operator, hardness: float) -> None:
        self._executor = executor
        self._influence = influence
        self._cap = min(hardness, NO_CAP)
        for module in (passes, half_space_setup, half_space_sums):
            wp.load_module(module, device=executor.device)
        self.pressure = executor.zeros()
        self.gradient = executor.zeros()
        self._trial = executor.zeros()
        self._step = executor.zeros()
        self._response = executor.zeros()
        self._sums = executor.partials(len(Products._fields) - 2)
        self._maxima = executor.partials(2)
        #: On a GPU, where tables of many slots are reduced before they are read.
        self._folded = (
            None
            if executor.device.is_cpu
            else wp.zeros((len(Products._fields), FOLDED), dtype=wp.float64, device=executor.device)
        )

    def moments(self, gap: Field) -> Moments:
        """Mean, rms height and lowest point of a gap."""
        mean, variance, lowest = 0.0, 0.0, 0.0
        for _ in range(2):  # about 0, then about the mean
            inputs = [self._executor.grid.ny, mean, gap]
            count, first, second, deepest, _unused = self._pass(
                half_space_setup.moments, inputs, [], sums=3, maxima=2
            )
            mean += first / count
            variance, lowest = second / count - (first / count) ** 2, -deepest
        return Moments(mean, math.sqrt(max(variance, 0.0)), lowest)

    def foundation(self, gap: Field, *, stiffness: float, level: float) -> tuple[float, float]:
        """Trial pressure of a foundation [N/mm³] at an approach [mm]; what it carries, as `carried`."""
        self._pass(half_space_setup.spring, [self._executor.grid.ny, stiffness, level, gap], [self._trial])
        return self.carried(0.0)

    def begin(self, gap: Field) -> State:
        """Gradient of the present pressure."""
        self._influence.respond(self.pressure, self._response)
        self._pass(half_space_setup.gradient, [self._executor.grid.ny, gap, self._response], [self.gradient])
        return self.advance(0.0)

    def take_trial(self, shift: float) -> None:
        """The trial pressure, shifted and clipped, becomes the pressure. Its gradient is then out of date."""
        self._advance(whole=True, length=0.0, shift=shift)

    def advance(self, length: float, *, shift: float | None = None) -> State:
        """Go so much of the step; all of it, exact at the bounds, where the trial's shift is given."""
        return self._advance(whole=shift is not None, length=length, shift=shift or 0.0)

    def _advance(self, *, whole: bool, length: float, shift: float) -> State:
        inputs = [whole, length, shift, self._cap, self._trial, self._step, self._response]
        outputs = [self.pressure, self.gradient]
        *values, negative = self._pass(passes.advance, inputs, outputs, sums=4, maxima=2)
        return State._make([*values, -negative])

    def descent(self, approach: float, *, plain: bool) -> tuple[Field, float]:
        """Where to go from the gradient, as a field and a level to take off it; may lie in the trial."""
        if plain:
            return self.gradient, approach
        inputs = [approach, self._cap, self.pressure, self.gradient]
        self._pass(passes.residual, inputs, [self._trial])
        self._influence.invert(self._trial, self._trial)
        return self._trial, 0.0

    def products(self, approach: float, descent: Field, level: float) -> Products:
        """Sums and maxima over the free cells."""
        inputs = [approach, self._cap, level, self.pressure, self.gradient, descent]
        inputs += [self._step, self._response]
        return Products(*self._pass(passes.products, inputs, [], sums=7, maxima=2))

    def aim(
        self, approach: float, descent: Field, level: float, *, memory: float, length: float, outward: float
    ) -> tuple[float, float]:
        """Trial pressure along −descent + memory × last step; what it carries, as `carried`."""
        inputs = [approach, self._cap, level, memory, length, outward]
        inputs += [self.pressure, self.gradient, descent, self._step]
        total, between = self._pass(passes.direction, inputs, [self._trial], sums=2)
        return total, between

    def carried(self, shift: float) -> tuple[float, float]:
        """Sum of the shifted and clipped trial pressures [MPa], and the cells between the bounds."""
        total, between = self._pass(passes.carried, [shift, self._cap, self._trial], [], sums=2)
        return total, between

    def balance(self, asked: float, total: float, between: float, *, unit: float) -> float:
        """Shift of the trial pressure with which it carries what is asked [MPa].

        total, between: what is carried without a shift. unit: a shift that may be needed [MPa]. Met to
        `balance.TOLERANCE` where the digits of the trial allow it, which they do near the solution. Raises
        ConvergenceError.
        """
        at_zero = total, between
        unit = max(unit, total / between if between > 0.0 else 0.0, asked / self._influence.cells)

        def carried(shift: float) -> Carried:
            total, slope = at_zero if shift == 0.0 else self.carried(shift * unit)
            return Carried(total, slope * unit)

        found = newton_in_bracket(carried, asked, 0.0, -math.inf, math.inf, 1.0)
        if not abs(found.force - asked) <= ROUGH_BALANCE * asked:
            raise ConvergenceError(
                f"the load balance of the half-space missed {found.force - asked:.3g} MPa."
            )
        return found.offset * unit

    def step(self, approach: float, shift: float) -> tuple[float, float, float]:
        """Take aim at the shifted trial, and respond.

        Returns the sums of step × (t − λ) and of step × response, and the largest share of its room to a
        bound that a cell uses.
        """
        inputs = [approach, shift, self._cap, self._trial, self.pressure, self.gradient]
        slope, used, _unused = self._pass(passes.step, inputs, [self._step], sums=1, maxima=2)
        self._influence.respond(self._step, self._response)
        curvature = self._product(self._step, self._response)
        return slope, curvature, used

    def tangent(self, *, tolerance: float, max_iterations: int) -> float:
        """Sum of dp/dλ [MPa/mm] of the cells between the bounds, by preconditioned conjugate gradients.

        tolerance: of the displacement, over the dλ that they all follow. Raises ConvergenceError. The step of
        the iterate is lost.
        """
        residual, descent = self._executor.zeros(), self._executor.zeros()
        direction, solution = self._step, self._trial
        solution.zero_()
        self._pass(half_space_setup.between, [self._cap, self.pressure], [residual])
        allowed = tolerance**2 * self._product(residual, residual)
        total, memory, reduced = 0.0, 0.0, 1.0
        for _ in range(max_iterations):
            self._influence.invert(residual, descent)
            before, reduced = reduced, self._product(residual, descent)
            memory = reduced / before if memory else 0.0
            self._pass(half_space_setup.conjugate, [memory, self._cap, self.pressure, descent], [direction])
            self._influence.respond(direction, self._response)
            curvature = self._product(direction, self._response)
            if not curvature > 0.0:
                break
            inputs = [reduced / curvature, self._cap, self.pressure, direction, self._response]
            total, left = self._pass(half_space_setup.relax, inputs, [solution, residual], sums=2)
            if left <= allowed:
                return total
            memory = 1.0
        raise ConvergenceError("the slope of the half-space contact did not converge.")

    def _product(self, first: Field, second: Field) -> float:
        (total,) = self._pass(half_space_sums.product, [first, second], [], sums=1)
        return total

    def _pass(
        self, kernel: Any, inputs: list[Any], outputs: list[Field], *, sums: int = 0, maxima: int = 0
    ) -> list[float]:
        """Launch, and reduce the first rows of the tables that the kernel fills."""
        tables = ([self._sums] if sums else []) + ([self._maxima] if maxima else [])
        chunks = self._influence.chunks
        self._executor.launch(kernel, inputs=inputs, outputs=[*outputs, *tables], chunks=chunks)
        slots = chunks[-1][1] if chunks else self._executor.slots
        if self._folded is None:
            table, largest = self._sums.numpy()[:sums, :slots], self._maxima.numpy()[:maxima, :slots]
        else:  # one short table to read back
            both = sums + maxima
            self._executor.launch(
                half_space_sums.fold,
                inputs=[FOLDED, sums, slots, self._sums, self._maxima],
                outputs=[self._folded],
                chunks=[(0, both * FOLDED)],
            )
            folded = self._folded.numpy()
            table, largest = folded[:sums], folded[sums:both]
        return [*table.sum(axis=1).tolist(), *largest.max(axis=1, initial=-NO_CAP).tolist()]
