"""Two scales: patches of fine cells that share the load of a macro contact."""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from warpwear.contact.balance import stiffness_of
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray
from warpwear.history.recorder import Step
from warpwear.history.recorder_patches import PatchLedger
from warpwear.history.snapshot import Snapshot
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.model import Model
from warpwear.models.patches.cells import PatchContact
from warpwear.models.patches.foresight import PatchForesight
from warpwear.models.patches.shares import Shares, SharingTask, press, share_load
from warpwear.models.patches.smooth import SmoothContact


class TwoScaleModel(Model):
    """Contact and wear of one task. Patches share the load by one approach, or as a smooth contact says.

    Approaches and gaps count from the mean planes, so that the worn mean height of a patch, which closes the
    loop back to the macro contact, is part of its gap.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """

    STATE: ClassVar = {
        "contact": PatchContact,
        "_ledger": PatchLedger,
        "_smooth": SmoothContact,
        "_last": Shares,
        "_foresight": PatchForesight,
    }

    def __init__(self, task: ContactTask, patches: Patches, heights: FloatArray, executor: Executor) -> None:
        self.task, self.patches = task, patches
        self._executor = executor
        self.contact = PatchContact(
            patches,
            heights,
            executor,
            curvature=task.curvature,
            hardness=task.hardness,
            film=task.film,
            fractions=task.wear_fractions,
        )
        self._ledger = PatchLedger(task, patches)
        self.book = self._ledger.book
        self._smooth = SmoothContact(task, patches) if task.prescribed_loads else None
        self._last: Shares | None = None
        self._foresight = PatchForesight()

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Share the load, then slide by the increment [mm] and wear both bodies.

        then: the next increment, where it is known [mm]; the pass that wears evaluates for it as well.

        Raises ConvergenceError when the load cannot be shared.
        """
        task, row = self.task, self._ledger.row
        removals = self._ledger.removals(0.0, increment)
        removal = sum(removals)
        self.contact.stiffness = self._stiffness(removal)
        evaluations = self.contact.evaluations
        self.contact.look(row["distance"])
        shares = self._share(removal)
        evaluations = self.contact.evaluations - evaluations
        self._foresight.note(shares, self._last, removal, sprung=task.uses_bulk_stiffness)
        self._last = shares
        pressure = None
        if with_pressure:
            pressure = self.patches.on_domain(self.contact.pressures(shares.base, shares.offset))
        reference = row["pressure_mean"] or (task.hardness if math.isfinite(task.hardness) else 0.0)
        foreseen = None
        if then is not None and self._smooth is None and task.film is None:  # whose wear changes the caps
            removal_next = sum(self._ledger.removals(increment, then))
            step, steps = self._foresight.expected(removal_next)
            if step is not None:
                offset = np.full_like(shares.base, step) if steps is None else steps
                foreseen = self._stiffness(removal_next), shares.bases, offset
        bare = self.contact.bare(shares.base, shares.offset)
        worn = self.contact.wear(
            shares.base,
            shares.offset,
            removal=removal,
            reference=reference,
            known=self._ledger.most,
            foreseen=foreseen,
        )
        worn = replace(worn, bare=bare)
        self.contact.rub(row["distance"] + increment)
        approach = shares.common_base, shares.common_offset
        return self._ledger.enter(worn, approach, increment, removals, reference, pressure, evaluations)

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, which was asked for its pressure, at its distance [mm]."""
        gap, initial = (self._executor.to_numpy(f) for f in (self.contact.gap, self.contact.initial))
        bare = None if self.contact.film is None else self._executor.to_numpy(self.contact.film.bare)
        return self._ledger.snapshot(step, distance, self.patches, gap=gap, worn=gap - initial, bare=bare)

    def _share(self, removal: float) -> Shares:
        task, last, response = self.task, self._last, self.contact.response
        foundation = self._ledger.foundation
        step, steps = self._foresight.expected(removal)
        if step is None:
            step = removal * self._ledger.row["pressure_mean"]
        sharing = SharingTask(
            task.load, self.patches.area, 1.0 / foundation, task.hardness, self.contact.lowest
        )
        if self._smooth is not None:
            target = self._smooth.press(foundation=foundation, removal=removal)
            common = self._smooth.approach
            return press(response, sharing, target, last, step=step, first=self._first, common=common)
        if last is None:
            return share_load(response, sharing, None, step=self._first)
        return share_load(response, sharing, last, step=step, steps=steps)

    def _stiffness(self, removal: float) -> float:
        """1/c [N/mm³] of a step that wears both bodies by K ΔL = removal [mm³/N]."""
        return stiffness_of(self.task.compliance + (removal if self.task.implicit else 0.0))

    @property
    def _first(self) -> float:
        """First step of a search from the lowest cell [mm]."""
        pressure = min(self.task.hardness, self.task.load / self.patches.domain.cell_area)
        return 0.5 * pressure / self.contact.stiffness
