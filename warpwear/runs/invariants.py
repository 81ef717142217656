"""What must hold after every step: finite numbers, a balanced load, conserved volumes, a contact inside.

After steps 1, 2, 4, 8, … no gap lies below the bound of its tile, by which searches leave tiles out.

Works on rows of the history, as dictionaries, so that every model is checked by the same rules. A row without
a column is not checked for it.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear.contact.balance import TOLERANCE
from warpwear.history.quantities import FIELDS, columns_of
from warpwear.history.recorder import StepColumns
from warpwear.history.snapshot import Snapshot
from warpwear.study.rules_track import extent_for
from warpwear.study.study import Study

#: Part of a worn volume that may be off what Archard's law asks for; rounding leaves 1e-12 of it.
CONSERVATION = 1.0e-10
#: Mean depth over the cells ever touched that rounding of their gaps may add or take [mm].
ROUNDING = 1.0e-15
#: Share of the load that may rest on points of the disc that were not measured.
ON_FILLED = 0.05
#: Columns that may be no number: without a speed, before the shear strength is calibrated, between solves.
OPEN = frozenset(("time", "cof", "area_static", "violation", "energy_gap", "energy_gap_relative")) | {
    "area_error",
    "displacement",
    "displacement_border",
    "energy_ratio",
}
#: Columns that are made of whole histories.
MADE_LATER = frozenset(("cof", "friction_energy"))
#: What heights may be off by rounding [mm]: of 1 mm the last digit is 1e-16 mm.
ROUNDING = 1.0e-15
#: What follows from a gap below its bound.
MISSED = "something has raised a surface and does not say so, and contact may have been missed"
#: What heights may be off by the rounding of many steps [mm].
OF_STEPS = 1.0e-9
BODIES = (
    ("wear_volume_counter", "archard_volume_counter", "pending_volume_counter"),
    ("wear_volume_disc", "archard_volume_disc", "pending_volume_disc"),
)


@dataclass(frozen=True)
class Violation:
    """Something that does not hold."""

    quantity: str  # column of the history or name of the field; "edge" or "rim"
    sentence: str  # without its full stop
    remedy: str = "so what follows cannot be trusted"
    sound: bool = False  # whether the state is what the equations say, so that it may be kept


class Invariants:
    """Checks the steps of one study."""

    def __init__(self, study: Study) -> None:
        self._study = study
        of_bearing_area = study.load_tolerance if study.uses_bearing_area else 0.0
        #: Load that may be left unbalanced [N]: what the study's balance is solved to.
        self._residual = max(TOLERANCE * max(block.load for block in study.blocks), of_bearing_area)
        self._laws = study.contact_task.features.values()
        self._uncovered = study.patch_layout.uncovered if study.study.model == "two-scale" else 0

    def of_row(
        self, row: Mapping[str, float], *, touches_edge: bool = False, touches_rim: bool = False
    ) -> Iterator[Violation]:
        """Return what a row violates, the worst first.

        touches_edge, touches_rim: whether the contact reached the domain's edge or the ball's rim, which a
        rigid flat has not.
        """
        # Infinities do not cancel, and a NaN stays one: a finite sum, the usual case, needs no second look.
        if not math.isfinite(sum(row.values())):
            yield from self._not_finite(row)
        residual = row.get("load_residual", 0.0)
        if abs(residual) > self._residual:
            yield Violation(
                "load_residual",
                f"load_residual = {residual:.3g} N {_where(row)} is beyond {self._residual:.3g} N",
            )
        for worn, expected, pending in BODIES:
            if _is_off(row, worn, expected, pending):
                yield self._not_conserved(row, worn, row[expected])
        for law in self._laws:
            for what, volume, due in law.balances(row):
                if not abs(volume - due) <= CONSERVATION * abs(due) + ROUNDING * row["area_touched"]:
                    due_to = f"where {due:.9g} mm³ are due"
                    yield Violation(what, f"{what} = {volume:.9g} mm³ {_where(row)}, {due_to}")
        if (touches_edge and not self._study.repeats) or touches_rim:
            yield self._outside(row, rim=touches_rim)

    def hold(self, steps: StepColumns) -> bool:
        """Tell whether `of_row` has nothing to say of steps in a row; False where it is to be asked."""
        columns, outside = steps.columns, steps.touches_rim
        if not self._study.repeats:
            outside = outside | steps.touches_edge
        closed = [values for name, values in columns.items() if name not in OPEN]
        wrong = outside | (np.abs(columns["load_residual"]) > self._residual)
        for names in BODIES:
            wrong = wrong | _is_off(columns, *names)
        return not self._laws and not wrong.any() and bool(np.isfinite(closed).all())

    def of_columns(self, row: Mapping[str, float]) -> Iterator[Violation]:
        """Yield columns of the study's runs that a row does not have, so that they would be unknown."""
        if lacking := {column.name for column in columns_of(self._study)} - MADE_LATER - row.keys():
            yield Violation("columns", f"no step says what {', '.join(sorted(lacking))} is {_where(row)}")

    def of_heights(self, depth: float, row: Mapping[str, float]) -> Iterator[Violation]:
        """Yield a disc that is off the heights that results have of it by a depth [mm]."""
        if depth > OF_STEPS:
            why = "something lowers or raises it, and no field of a cell says so"
            yield Violation("heights", f"the disc is off its wear by {depth:.3g} mm {_where(row)}: {why}")

    def of_bounds(self, depth: float, row: Mapping[str, float]) -> Iterator[Violation]:
        """Report a gap below the bound of its tile by a depth [mm], so that its tile may be missed."""
        if depth > ROUNDING:
            yield Violation(
                "bounds", f"a gap lies {depth:.3g} mm below the bound of its tile {_where(row)}", MISSED
            )

    def of_filled(self, snapshot: Snapshot, row: Mapping[str, float]) -> Iterator[Violation]:
        """Return a contact that rests on points of the disc which were not measured, but filled in."""
        share = snapshot.load_on_filled or 0.0
        if share > ON_FILLED:
            yield Violation(
                "filled",
                f"{100.0 * share:.3g} % of the load {_where(row)} rests on points that disc.surface lacks "
                f"and that were filled in, where {100.0 * ON_FILLED:g} % is allowed",
                "a part of the measurement with fewer missing points is needed (disc.crop)",
                sound=True,
            )

    def of_fields(self, fields: Mapping[str, Any], row: Mapping[str, float]) -> Iterator[Violation]:
        """Fields with values that are no finite numbers: a cell without a gap would carry no load, unseen.

        Or with negative ones, where they do not say that they are signed: no result could be read again.
        Cells of the domain that no patch covers have no gap (NaN).
        """
        for name, values in fields.items():
            if np.asarray(values).dtype.kind == "f" and not math.isfinite(float(np.sum(values))):
                of_none = self._uncovered if np.shape(values) == self._study.cells.shape else 0
                if of_none and np.count_nonzero(np.isnan(values)) == of_none and not np.isinf(values).any():
                    continue
                bad = int(np.count_nonzero(~np.isfinite(values))) - of_none
                yield Violation(name, f"{name} is no finite number on {bad} cells {_where(row)}")
            elif name in FIELDS and not FIELDS[name].signed and np.min(values) < 0.0:
                yield Violation(name, f"{name} is negative {_where(row)}, and is not declared as signed")

    def _not_finite(self, row: Mapping[str, float]) -> Iterator[Violation]:
        for name, value in row.items():
            if not math.isfinite(value) and name not in OPEN:
                yield Violation(name, f"{name} = {value:g} {_where(row)} is no finite number")

    def _not_conserved(self, row: Mapping[str, float], name: str, expected: float) -> Violation:
        off = f"{abs(row[name] - expected) / expected:.2g}" if expected else "all"
        return Violation(
            name,
            f"{name} = {row[name]:.9g} mm³ {_where(row)} is off the {expected:.9g} mm³ of Archard's law "
            f"by {off} of it, where {CONSERVATION:g} is allowed",
        )

    def _outside(self, row: Mapping[str, float], *, rim: bool) -> Violation:
        after = f"after {row['distance']:g} mm of sliding"
        if rim:
            return Violation(
                "rim",
                f"counter.radius = {self._study.counter.nominal_radius:g} mm is too small: the contact "
                f"reached the counter-body's rim {after}, so the counter-body is worn away",
                "a larger radius, or less load, wear or distance is needed",
                sound=True,
            )
        sides, domain = extent_for(self._study, row["distance"]), self._study.grid
        needed = [*sides] if isinstance(domain.extent, tuple) else [max(sides)]
        return Violation(
            "edge",
            f"grid.extent = {domain.size} is too small: the contact reached the domain's "
            f"edge {after}, so what lies beyond it would be missing",
            f"a larger extent is needed, of about {' × '.join(f'{1.05 * side:.2g}' for side in needed)} mm",
            sound=True,
        )


def _is_off(row: Mapping[str, Any], worn: str, expected: str, pending: str) -> Any:
    """Tell whether a worn volume is off what Archard's law asks for, in a row or in each of many."""
    if worn not in row:
        return False
    allowed = CONSERVATION * row[expected] + ROUNDING * row.get("area_touched", 0.0)
    return abs(row[worn] + row.get(pending, 0.0) - row[expected]) > allowed


def _where(row: Mapping[str, float]) -> str:
    return f"after {row.get('distance', math.nan):g} mm of sliding"
