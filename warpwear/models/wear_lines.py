"""Cells of a half-space wear by a K of their own pressure: lines over it are drawn until they hold."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import warp as wp

from warpwear.contact.half_space.solver import HalfSpaceContact
from warpwear.contact.search import bends_of
from warpwear.engine.executor import Executor, Field
from warpwear.engine.numbers import Mirror
from warpwear.engine.program import launch_once
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.kernels import wear_from_pressure as kernels

#: Contacts of a step at most.
MOST_CONTACTS = 200
#: The slope of a line keeps a part of the last one's, half at first, and more in each contact by what this
#: leaves of the rest: else cells may go to and fro.
FORGETS = 0.97


class Lines:
    """Holds lines over a pressure, of what wear takes off each cell: a part of the gap, and slopes."""

    def __init__(self, knots: FloatArray, executor: Executor) -> None:
        self._executor = executor
        self.bends = bends_of(knots, executor)
        self.gap, self.yields, self._last, self._far = (executor.zeros() for _ in range(4))
        #: By how much the last ones were off at the pressures that they were drawn through next [mm].
        self.off: Field = wp.zeros(
            (1, executor.slots_of(executor.grid.nx)), dtype=wp.float64, device=executor.device
        )

    def begin(self, removals: tuple[float, float], gap: Field, pressure: Field) -> None:
        """Draw the first ones. removals: K ΔL of counter-body and disc [mm³/N]."""
        self._executor.put(self.bends.step, [0.0, *removals])
        wp.copy(self._last, pressure)
        wp.copy(self._far, pressure)
        self.draw(gap, pressure, keeps=0.0)

    def draw(self, gap: Field, pressure: Field, *, keeps: float) -> None:
        """Draw them through the present pressures. keeps: see `FORGETS`."""
        fields: Any = pressure, self._last, self._far, gap, self.gap, self.yields
        launch_once(self._executor, kernels.linearise, self.bends, keeps, *fields, self.off)


class WearLines:
    """Solves contacts with what wear takes off each cell as a straight line over its pressure, drawn anew.

    knots: of K over the pressure, see `laws.archard.knots_of`. moves: whether a disc does: then cells of the
    counter-body have lines over the mean of the pressures that pass them.
    """

    def __init__(self, knots: FloatArray, executor: Executor, *, moves: bool = False) -> None:
        self._executor, self._moves = executor, moves
        self._lines = [Lines(knots, executor) for _ in range(1 + moves)]
        self._nothing = executor.zeros()
        #: The mean of the pressures along x, and the gap with what all lines add to it.
        self._passing, self._gap = (executor.zeros(None if moves else 0) for _ in range(2))
        #: Pressures that wear counter-body and disc at the K of a step.
        self.counter, self.disc = executor.zeros(), executor.zeros()
        slots = executor.slots_of(executor.grid.nx)
        self._sums = wp.zeros((2, slots), dtype=wp.float64, device=executor.device)
        self._mirror = Mirror(self._sums, *(one.off for one in self._lines))

    def solve(
        self,
        solve: Callable[..., HalfSpaceContact],
        gap: Field,
        start: Field | None,
        removals: tuple[float, float],
        *,
        certified: bool | None,
        window: int = 1,
    ) -> HalfSpaceContact:
        """Solve a contact whose wear lies on its lines, as near as it is solved.

        solve: solves a contact of a gap, with `yields` and `certified`. start: pressures of the last contact,
        where there are. removals: K ΔL of counter-body and disc [mm³/N]. window: cells of a disc that moves
        which pass one of the counter-body.

        Raises ConvergenceError where it, or the lines, do not converge.
        """
        each = [(0.0, removals[1]), (removals[0], 0.0)] if self._moves else [removals]
        start = self._nothing if start is None else start
        for (lines, *of_lines), own in zip(self._over(gap, start, window), each, strict=True):
            lines.begin(own, *of_lines)
        streak, transforms = {}, 0
        if self._moves:
            streak = {"streak_yields": self._lines[1].yields, "streak_window": window}
        for number in range(MOST_CONTACTS):
            contact = solve(
                self._with_wear(window), yields=self._lines[0].yields, certified=certified, **streak
            )
            certified, transforms = contact.certificate is not None, transforms + contact.transforms
            for lines, *of_lines in self._over(gap, contact.pressure_field, window):
                lines.draw(*of_lines, keeps=1.0 - 0.5 * FORGETS**number)
            off, allowed = max(one.max() for one in self._mirror.read()[1:]), float(contact.allowed.min())
            if off <= allowed:
                return replace(contact, transforms=transforms)
        raise ConvergenceError(
            f"wear by the pressure of cells did not settle in {MOST_CONTACTS} contacts: depths are off by "
            f"{off:.3g} mm (allowed {allowed:.1g} mm); shorter steps or a wider transition are needed."
        )

    def press(self, pressure: Field) -> dict[str, float]:
        """Find the pressures that wear both bodies in the last contact; return their sums by name [MPa]."""
        fields = self._passing if self._moves else pressure, pressure, self.counter, self.disc
        launch_once(self._executor, kernels.wearing_pressures, self._lines[0].bends, *fields, self._sums)
        counter, disc = self._mirror.read()[0].sum(axis=1).tolist()
        return {"wearing_counter": counter, "pressure_times_factor": disc}

    def _over(self, gap: Field, pressure: Field, window: int) -> Iterator[tuple[Lines, Field, Field]]:
        """Yield lines with the gap that they add to, and the pressures that they are over."""
        yield self._lines[0], gap, pressure
        if self._moves:
            self._add_mean(window, pressure, self._nothing, self._passing)
            yield self._lines[1], self._nothing, self._passing

    def _with_wear(self, window: int) -> Field:
        """Return the gap with what lines add to it; cells meet the mean of what the counter-body loses."""
        if not self._moves:
            return self._lines[0].gap
        self._add_mean(window, self._lines[1].gap, self._lines[0].gap, self._gap)
        return self._gap

    def _add_mean(self, window: int, *fields: Field) -> None:
        launch_once(self._executor, kernels.add_mean, window, *fields)
