"""Cells of a half-space wear by a K of their own pressure: lines over it are drawn until they hold."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
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


class WearLines:
    """Solves contacts with what wear takes off each cell as a straight line over its pressure, drawn anew.

    knots: of K over the pressure, see `laws.archard.knots_of`.
    """

    def __init__(self, knots: FloatArray, executor: Executor) -> None:
        self._executor = executor
        self._bends = bends_of(knots, executor)
        self._gap, self._yields, self._last, self._far = (executor.zeros() for _ in range(4))
        #: Pressures that wear counter-body and disc at the K of a step.
        self.counter, self.disc = executor.zeros(), executor.zeros()
        slots = executor.slots_of(executor.grid.nx)
        self._sums, self._off = (
            wp.zeros((lines, slots), dtype=wp.float64, device=executor.device) for lines in (2, 1)
        )
        self._mirror = Mirror(self._sums, self._off)

    def solve(
        self,
        solve: Callable[..., HalfSpaceContact],
        gap: Field,
        start: Field | None,
        removals: tuple[float, float],
        *,
        certified: bool | None,
    ) -> HalfSpaceContact:
        """Solve a contact whose wear lies on its lines, as near as it is solved.

        solve: solves a contact of a gap, with `yields` and `certified`. start: pressures of the last contact,
        where there are. removals: K ΔL of counter-body and disc [mm³/N].

        Raises ConvergenceError where it, or the lines, do not converge.
        """
        self._executor.put(self._bends.step, [0.0, *removals])
        if start is None:
            self._last.zero_()
        else:
            wp.copy(self._last, start)
        wp.copy(self._far, self._last)
        self._draw(gap, self._last, keeps=0.0)
        transforms = 0
        for number in range(MOST_CONTACTS):
            contact = solve(self._gap, yields=self._yields, certified=certified)
            certified, transforms = contact.certificate is not None, transforms + contact.transforms
            off, allowed = (
                self._draw(gap, contact.pressure_field, keeps=1.0 - 0.5 * FORGETS**number),
                float(contact.allowed.min()),
            )
            if off <= allowed:
                return replace(contact, transforms=transforms)
        raise ConvergenceError(
            f"wear by the pressure of cells did not settle in {MOST_CONTACTS} contacts: depths are off by "
            f"{off:.3g} mm (allowed {allowed:.1g} mm); shorter steps or a wider transition are needed."
        )

    def press(self, pressure: Field) -> dict[str, float]:
        """Find the pressures that wear both bodies; return the sums of them by name [MPa]."""
        fields = pressure, self.counter, self.disc
        launch_once(self._executor, kernels.wearing_pressures, self._bends, *fields, self._sums)
        counter, disc = self._mirror.read()[0].sum(axis=1).tolist()
        return {"wearing_counter": counter, "pressure_times_factor": disc}

    def _draw(self, gap: Field, pressure: Field, *, keeps: float) -> float:
        """Draw lines through the present pressures; return by how much the last ones were off there [mm]."""
        fields: Any = pressure, self._last, self._far, gap, self._gap, self._yields
        launch_once(self._executor, kernels.straighten, self._bends, keeps, *fields, self._off)
        return float(np.max(self._mirror.read()[1]))
