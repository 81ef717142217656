"""Patches whose asperities deform together on the elastic–plastic half-space share a load, on two scales.

Every patch is a half-space of its own, behind which the bulk yields to its mean pressure p_k:

    u_k + p_k / K_N = δ,   A Σ p_k = F

with u_k the patch's approach from its own mean plane. All patches are one convex problem for the pressures of
all cells, whose one multiplier is δ: see `PatchInfluence` and `half_space.search`.
Where a smooth contact prescribes each p_k, on springs K_N of its own, each u_k is a multiplier of its own.
"""

from dataclasses import replace
from functools import cached_property, partial
from typing import Any, ClassVar

import numpy as np

from warpwear.contact.certificate import columns_of
from warpwear.contact.half_space.influence import Influence
from warpwear.contact.half_space.solver import BoundedPressure, HalfSpaceContact
from warpwear.engine.executor import Executor
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.history.recorder import Step
from warpwear.history.recorder_patches import PatchLedger, Worn
from warpwear.history.snapshot import Snapshot
from warpwear.kernels import wear_from_pressure
from warpwear.kernels.cells import PADDING
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.features.features import Features
from warpwear.models.model import Model
from warpwear.models.patches.shares import SmoothContact
from warpwear.models.patches.wear import PatchWear
from warpwear.models.unworn import gap_over
from warpwear.models.wear_lines import WearLines

#: Growth of the approach in a step, as is thought before it, over what the last mean pressure would wear off.
GROWTH_GUESS = 2.0


class HalfSpacePatches(Model):
    """Patches touch and wear in a two-scale study with contact.law = "half-space".

    A step finds the pressure with which it ends (implicit Archard), from the last one's pressure. Only
    patches that the approach may reach are visited: they lie in the order of their lowest points before any
    wear, or of their smooth gaps where a smooth contact prescribes the loads, so that those are the first.

    patches: in the order of the macro cells. executor: on `patches.grid`. heights: of the disc over its mean
    plane [mm], shape of the domain.
    """

    STATE: ClassVar = {
        "_ledger": PatchLedger,
        "_smooth": SmoothContact,
        "gap": InFrame("contact"),
        "worn": InFrame("contact"),
        "_solver": BoundedPressure,
        "_reached": float,
        "visited": int,
        "_features": Features,
        "_wears": PatchWear,
    }
    SCRATCH: ClassVar = ("_influence",)

    def __init__(self, task: ContactTask, patches: Patches, heights: FloatArray, executor: Executor) -> None:
        self.task, self._executor = task, executor
        self._ledger = PatchLedger(task, patches)
        self.book = self._ledger.book
        of_patches = executor.to_numpy(gap_over(task.form, heights, executor, patches)).min(axis=1)
        self._smooth = SmoothContact(task, patches, executor) if task.prescribed_loads else None
        reached = of_patches if self._smooth is None else self._smooth.initial
        self._order = np.argsort(reached, kind="stable")
        #: As they are stored here.
        self.patches = replace(
            patches,
            first_row=patches.first_row[self._order],
            first_column=patches.first_column[self._order],
        )
        self.lowest: FloatArray = of_patches[self._order]  # before any wear [mm]
        self.gap = gap_over(task.form, heights, executor, self.patches)
        self.worn = executor.zeros()  # by both bodies, as long as that is not kept apart [mm]
        #: The task until a cell can reach another material.
        self._unlayered = replace(task, profiles=None)
        self._features = Features.of(self._unlayered, executor, {"worn": self.worn})
        shared = {"gap": self.gap, "worn": self.worn, "together": self._features}
        self._wears = PatchWear(task, self.patches, executor, self._ledger, **shared)
        #: Cells where there is a surface, summed over the patches up to each.
        self._cells = np.cumsum((executor.to_numpy(self.gap) < PADDING).sum(axis=1))
        assert task.modulus is not None  # checked with the study
        self._influence = PatchInfluence(executor, self.patches, modulus=task.modulus, boundary=task.boundary)
        self._solver = BoundedPressure(executor, self._influence, hardness=task.hardness)
        #: Patches visited in the last solve; the others have not been touched.
        self.visited = 0
        #: Largest approach so far [mm].
        self._reached = float(of_patches.min())
        executor.load(wear_from_pressure.wear)
        #: Finds what wears cells whose K goes with their pressure; None where none does.
        self._lines = WearLines(task.knots, executor) if len(task.knots) else None

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Solve the contact at the end of an increment [mm], and wear both bodies.

        Raises ConvergenceError when the contact cannot be solved.
        """
        removals = self.task.wear_per_pressure(self._ledger.row["distance"], increment)
        lends, certified = self._wears.begin(increment, removals), self.certified or None
        if self._smooth is None:
            self._influence.set_bulk(1.0 / self._ledger.foundation)
            contact = self._share(lends, certified=certified)
            approach = contact.approach
        else:
            contact = self._press(self._smooth, lends, certified=certified)
            approach = self._smooth.approach
        pressure = self.patches.on_domain(contact.pressure) if with_pressure else None
        worn = self._wear(contact, increment, approach)
        step = self._ledger.enter_worn(worn, increment, removals, pressure)
        step.row.update(columns_of(contact.certificate))
        return step

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """Return the fields after the last step, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        read = self._executor.to_numpy
        fields = self._wears.fields(step.pressure, gap=read(self.gap), worn=read(self.worn))
        return self._ledger.snapshot(step, distance, self.patches, **fields)

    def below_bounds(self) -> float:
        """Compare with the lowest gap of every patch before any wear, see `Model.below_bounds`."""
        return float((self.lowest - self._executor.to_numpy(self.gap).min(axis=1)).max())

    def _press(self, smooth: SmoothContact, removal: float, *, certified: bool | None) -> HalfSpaceContact:
        """Solve the contact by loads that a smooth one prescribes. removal: K ΔL of both bodies [mm³/N]."""
        loads = smooth.press(foundation=self._ledger.foundation, removal=removal)[self._order]
        # One that has carried a load is visited for good, which is how it can let go of it.
        self.visited = max(self.visited, int(np.flatnonzero(loads)[-1]) + 1)
        self._influence.visit(self.visited)
        return self._solve(removal, mean_pressure=loads[: self.visited], certified=certified)

    def _solve(self, removal: float, *, certified: bool | None, **loads: Any) -> HalfSpaceContact:
        """Solve the contact of the patches visited. removal: as of `_press`."""
        features = self._wears.features
        solve: Any = partial(self._solver.solve, cap_ratio=features.cells.cap_ratio, **loads)
        if self._lines is None:
            own = {"compliance": removal, "yields": features.value_of("yields")}
            contact: HalfSpaceContact = solve(self.gap, certified=certified, **own)
            return contact
        start = self._solver.pressure_field if self._solver.started else None
        return self._lines.solve(solve, self.gap, start, (removal, 0.0), certified=certified)

    def _share(self, removal: float, *, certified: bool | None) -> HalfSpaceContact:
        """Solve the contact by loads that patches share through one approach. removal: as of `_press`.

        It is solved once no patch that was left out lies below its approach: those carry nothing then.
        """
        load = self.task.load / (self.patches.count * self.patches.area)
        certified = certified or not self._solver.started  # of the last of its solves
        needed = self._below(self._reached + GROWTH_GUESS * removal * self._ledger.row["pressure_mean"])
        # As many as carry the load at the hardness.
        least = (self.task if self._wears.is_apart else self._unlayered).least_hardness
        carriers = load / least * self._influence.cells
        needed = max(needed, int(np.searchsorted(self._cells, carriers, side="right")) + 1)
        transforms = 0
        while True:
            self.visited = min(needed, self.patches.count)
            self._influence.visit(self.visited)
            contact = self._solve(removal, mean_pressure=load, certified=certified)
            transforms += contact.transforms
            needed = self._below(contact.approach)
            if needed <= self.visited:
                self._reached = max(self._reached, contact.approach)
                return replace(contact, transforms=transforms)

    def _below(self, approach: float) -> int:
        """Count the patches that had their lowest point below an approach or at it before any wear [mm]."""
        return int(np.searchsorted(self.lowest, approach, side="right"))

    def _wear(self, contact: HalfSpaceContact, increment: float, approach: float) -> Worn:
        """Wear both bodies by the pressure of the contact."""
        lines, pressure = self._lines, contact.pressure_field
        wearing = lines.press(pressure)["wearing_counter"] if lines else 0.0
        on_both = lines.counter if lines else None
        self._wears.wear(pressure, visited=self.visited, gradient=contact.gradient_field, on_both=on_both)
        numbers = {"approach": (approach, 0.0), "evaluations": contact.transforms}
        return self._wears.worn(self._order[: self.visited], increment, wearing=wearing, **numbers)


class PatchInfluence(Influence):
    """Applies the operator of patches of which each displaces itself alone, and an approximate inverse.

    modulus: E* of both bodies together [MPa]. boundary: "periodic" (each patch repeats itself; the mean
    displacement, which has no limit then, is the business of the bulk behind the patch, see `set_bulk`) or
    "free" (nothing outside a patch, whose mean displacement is then contained). executor: on `patches.grid`.
    """

    _bulk = 0.0  # 1/K_N of the spring behind every patch [mm³/N]

    def __init__(self, executor: Executor, patches: Patches, *, modulus: float, boundary: str) -> None:
        super().__init__(executor, modulus=modulus, boundary=boundary, side=patches.side)
        self.visited = self._grids.visited
        self.visit(patches.count)

    def visit(self, patches: int) -> None:
        """Leave out all but the first `patches`; the pressures of the others stay, which must be 0."""
        self._executor.put(self._grids.visited, patches)
        self.chunks = self._executor.split_rows(np.full(patches, self._executor.grid.ny))

    def set_bulk(self, flexibility: float) -> None:
        """Set 1/K_N of the spring behind every patch [mm³/N]; it yields to the patch's mean pressure."""
        if flexibility != self._bulk:
            assert all(self.wraps)  # else the mean displacement is contained
            self._bulk = flexibility
            self._set_means()

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """Add to the elastic response to a cell's own pressure [mm/MPa]; patches have no streaks."""
        assert streak == 0.0
        before = self._compliance
        super().set_compliance(own, streak, window)
        if self._compliance != before and all(self.wraps):
            self._set_means()

    def _set_means(self) -> None:
        """Let the mean pressure of a patch displace it; programs recorded before heed it."""
        assert self._compliance is not None
        longest = self._longest
        self._far.set_mean(self._bulk)
        # A mean that displaces nothing, or that Fourier modes do not tell of, yields as the longest waves.
        self._near.set_mean(self._bulk or (0.0 if self._compliance[0] else longest))

    @cached_property
    def _longest(self) -> float:
        """Return the response to the longest waves [mm/MPa], before a library's filter has another mean."""
        return float(self.near_elastic.max())
