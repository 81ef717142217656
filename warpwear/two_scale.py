"""Two scales: patches of fine cells that share the load of a macro contact."""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from warpwear.balance import RIGID, TOLERANCE, Balance
from warpwear.errors import ConvergenceError
from warpwear.execution import Executor
from warpwear.grid import FloatArray
from warpwear.ledger import Ledger, Step
from warpwear.load_shares import Shares, Task, share
from warpwear.patch_book import PatchBook
from warpwear.patch_contact import PatchContact, Worn
from warpwear.patches import Patches
from warpwear.prescribed_loads import press
from warpwear.results import Snapshot
from warpwear.smooth_contact import SmoothContact
from warpwear.study import Study


class TwoScaleModel:
    """Contact and wear of one study. Patches share the load by one approach, or as a smooth contact says.

    Approaches and gaps count from the mean planes, so that the worn mean height of a patch, which closes the
    loop back to the macro contact, is part of its gap.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """

    def __init__(self, study: Study, patches: Patches, heights: FloatArray, executor: Executor) -> None:
        self.study, self.patches = study, patches
        self._executor = executor
        self._wear = study.wear_laws
        curvature, hardness = study.sphere.curvature, study.hardness
        self.contact = PatchContact(patches, heights, executor, curvature=curvature, hardness=hardness)
        # In the outermost macro cells, what a patch touches may stand for the domain's edge.
        margin = 1 if patches.cover_everything else patches.pitch
        self._ledger = Ledger(study, patches.domain, weight=patches.weight, margin=margin)
        self.book = PatchBook(patches)
        self._smooth = SmoothContact(study, patches) if study.macro.coupling == "load" else None
        self._last: Shares | None = None
        #: Pressure at which the approach grew by wear in the last step and the one before [MPa].
        self._pace = (0.0, 0.0)
        steady = [law.steady for law in self._wear]
        #: Of what both bodies lose, the parts of sphere and disc: a small one is no difference of large ones.
        self._parts = [k / sum(steady) for k in steady] if sum(steady) else [0.5, 0.5]
        self.ahead = 0

    def steps(self, plan: Iterable[tuple[float, bool]]) -> Iterator[Step]:
        """One step for each increment [mm] of the plan, with its pressure where that is asked for."""
        for increment, with_pressure in plan:
            yield self.advance(increment, with_pressure=with_pressure)

    def advance(self, increment: float, *, with_pressure: bool = False) -> Step:
        """Share the load, then slide by the increment [mm] and wear both bodies.

        Raises ConvergenceError when the load cannot be shared.
        """
        study, row = self.study, self._ledger.row
        removals = (
            self._wear[0].removal(row["distance"], increment),
            self._wear[1].removal(row["distance"], increment),
        )
        removal = sum(removals)
        compliance = study.law().compliance + (removal if study.stepping.scheme == "implicit" else 0.0)
        self.contact.stiffness = 1.0 / compliance if compliance else RIGID
        shares = self._share(removal)
        pressure = None
        if with_pressure:
            pressure = self.patches.on_domain(self.contact.pressures(shares.base, shares.offset))
        reference = row["pressure_mean"] or (study.hardness if math.isfinite(study.hardness) else 0.0)
        worn = self.contact.remove(shares.base, shares.offset, removal=removal, reference=reference)
        pace = (shares.approach - self._last.approach) / removal if self._last and removal else 0.0
        self._last, self._pace = shares, (self._pace[1], pace)
        return self._entered(shares, worn, increment, removals, reference, pressure)

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, which was asked for its pressure, at its distance [mm].

        Over the whole domain; what no patch covers has neither pressure nor wear, and no gap (NaN).
        """
        assert step.pressure is not None
        gap, initial = (self._executor.to_numpy(f) for f in (self.contact.gap, self.contact.initial))
        worn = self.patches.on_domain(gap - initial)
        return Snapshot(
            distance,
            pressure=step.pressure,
            wear_sphere=self._parts[0] * worn,
            wear_disc=self._parts[1] * worn,
            gap=self.patches.on_domain(gap, beside=math.nan),
        )

    def saved_state(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays and numbers that the steps so far have changed: all that `restore` needs."""
        arrays = {"gap": self._executor.to_numpy(self.contact.gap), "reached": self.contact.reached}
        numbers: dict[str, Any] = {
            "most": self._ledger.most,
            "row": self._ledger.row,
            "last": None,
            "pace": self._pace,
        }
        if self._last is not None:
            state = vars(self._last)
            arrays |= {f"shares_{k}": v for k, v in state.items() if isinstance(v, np.ndarray)}
            numbers["last"] = {k: v for k, v in state.items() if not isinstance(v, np.ndarray)}
        if self._smooth is not None:
            arrays["smooth_worn"] = self._smooth.worn
            numbers["smooth_approach"] = self._smooth.approach
        return arrays | self.book.saved_state(), numbers

    def restore(self, arrays: Mapping[str, Any], numbers: Mapping[str, Any]) -> None:
        """Go on from the state that another model of the same study, surface and device saved."""
        self._executor.fill(self.contact.gap, arrays["gap"])
        self.contact.reached = arrays["reached"]
        self._ledger.most, self._ledger.row = dict(numbers["most"]), dict(numbers["row"])
        self._pace = (numbers["pace"][0], numbers["pace"][1])
        if numbers["last"] is not None:
            of_patches = {k: arrays[f"shares_{k}"] for k in ("base", "offset", "pressure")}
            self._last = Shares(**of_patches, **numbers["last"])
        if self._smooth is not None:
            self._smooth.worn, self._smooth.approach = arrays["smooth_worn"], numbers["smooth_approach"]
        self.book.restore(arrays)

    def _share(self, removal: float) -> Shares:
        study, row = self.study, self._ledger.row
        nominal = row.get("area_nominal", 0.0)
        foundation = (
            study.foundation(radius=math.sqrt(nominal / math.pi) or None)
            if study.uses_foundation
            else math.inf
        )
        before, now = self._pace
        # Where the contact grows evenly its pressure falls by as much again.
        step = removal * (now * min(now / before, 1.0) if before > 0.0 < now else row["pressure_mean"])
        load = study.contact.load
        if self._smooth is not None:
            target = self._smooth.press(foundation=foundation, removal=removal)
            return press(
                self.contact.response,
                target,
                self.contact.lowest,
                self._last,
                step=step,
                first=self._first,
                common=self._smooth.approach,
                area=self.patches.area,
                load=load,
            )
        task = Task(
            load=load,
            area=self.patches.area,
            flexibility=1.0 / foundation,
            hardness=study.hardness,
            lowest=self.contact.lowest,
        )
        return share(self.contact.response, task, self._last, step=step if self._last else self._first)

    @property
    def _first(self) -> float:
        """First step of a search from the lowest cell [mm]."""
        pressure = min(self.study.hardness, self.study.contact.load / self.patches.domain.cell_area)
        return 0.5 * pressure / self.contact.stiffness

    def _entered(
        self,
        shares: Shares,
        worn: Worn,
        increment: float,
        removals: tuple[float, float],
        reference: float,
        pressure: FloatArray | None,
    ) -> Step:
        sums, most = worn.sums, dict(worn.most)
        total = {name: float(values.sum()) for name, values in sums.items()}
        total["pressure_times_factor"] = total["pressure"]
        deepest = most.pop("worn")
        for body, part in zip(("sphere", "disc"), self._parts, strict=True):
            total[f"wear_{body}"] = part * total["worn"]
            most[f"wear_{body}"] = part * deepest
        of_cell = self.patches.domain.cell_area * self.patches.weight
        load = self.study.contact.load
        residual = total["pressure"] * of_cell - load  # of the pressures that wore
        if not abs(residual) <= 2.0 * TOLERANCE * load:
            raise ConvergenceError(
                f"{residual:.3g} N of {load:.6g} N are left at an approach of {shares.approach:.9g} mm."
            )
        self.book.enter(load_share=sums["pressure"] * of_cell, area_patch=sums["contact"] * of_cell)
        balance = Balance(
            shares.common_base,
            shares.common_offset,
            self.study.hardness,
            residual,
            evaluations=shares.evaluations,
        )
        return self._ledger.enter(balance, increment, removals, reference, total, most, pressure=pressure)
