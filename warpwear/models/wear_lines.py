"""Cells of a half-space wear by a K of their own pressure: lines over it are drawn until they hold."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import warp as wp

from warpwear.contact.half_space.solver import HalfSpaceContact
from warpwear.contact.search import bends_of
from warpwear.engine.executor import Executor, Field
from warpwear.engine.numbers import Mirror, Numbers
from warpwear.engine.program import launch_once
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.kernels import wear_from_pressure as kernels

#: Contacts of a step at most.
MOST_CONTACTS = 100


class WearLines:
    """Solves contacts with what wear takes off each cell as a straight line over its pressure, drawn anew.

    knots: of K over the pressure, see `laws.archard.knots_of`. slides: the step, in an array. moves: whether
    the disc does, so that the counter-body wears by means of pressures that pass.
    """

    def __init__(self, knots: FloatArray, executor: Executor, slides: Numbers, *, moves: bool = False) -> None:
        self._executor, self._slides = executor, slides
        self._bends = bends_of(knots, executor)
        self._gap, self._yields, self._last, self._far = (executor.zeros() for _ in range(4))
        #: Pressures that wear counter-body and disc at the K of a step.
        self.counter, self.disc = executor.zeros(), executor.zeros()
        self._passing = [executor.zeros(executor.grid.nx if moves else 1) for _ in range(2)]
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
        *,
        certified: bool | None,
    ) -> HalfSpaceContact:
        """Solve a contact whose wear lies on its lines, as near as it is solved.

        solve: solves a contact of a gap, with `yields` and `certified`. start: pressures of the last contact,
        where there are.

        Raises ConvergenceError where it, or the lines, do not converge.
        """
        own = self._slides["k_counter"] * (self._slides["window"] == 1), self._slides["k_disc"]
        self._executor.put(self._bends.step, [0.0, *own])
        if start is None:
            self._last.zero_()
        else:
            wp.copy(self._last, start)
        wp.copy(self._far, self._last)
        self._draw(gap, self._last)
        transforms = 0
        for _ in range(MOST_CONTACTS):
            contact = solve(self._gap, yields=self._yields, certified=certified)
            certified, transforms = contact.certificate is not None, transforms + contact.transforms
            off, allowed = self._draw(gap, contact.pressure_field), float(contact.allowed.min())
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

    def _draw(self, gap: Field, pressure: Field) -> float:
        """Draw lines through the present pressures; return by how much the last ones were off there [mm]."""
        slides, passing = self._slides.array, self._passing[0]
        if self._slides["window"] > 1:
            self.press(pressure)
            launch_once(self._executor, kernels.means, slides, self.counter, passing)
            if self._slides["window"] < self._executor.grid.nx:
                launch_once(self._executor, kernels.means, slides, *self._passing)
                passing = self._passing[1]
        fields: Any = pressure, self._last, self._far, passing, gap, self._gap, self._yields
        launch_once(self._executor, kernels.straighten, slides, self._bends, *fields, self._off)
        return float(np.max(self._mirror.read()[1]))
