"""What must hold after every step: finite numbers, a balanced load, conserved volumes, a contact inside.

After steps 1, 2, 4, 8, … no gap lies below the bound of its tile, by which searches leave tiles out.

Works on rows of the history, as dictionaries, so that every model is checked by the same rules. A row without
a column is not checked for it.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from warpwear.contact.balance import TOLERANCE
from warpwear.errors import prose
from warpwear.history.quantities import FIELDS, columns_of
from warpwear.history.recorder import StepColumns
from warpwear.history.snapshot import Snapshot
from warpwear.laws.archard import BODIES
from warpwear.study.rules_track import extent_for
from warpwear.study.study import Study

#: Part of a worn volume that may be off what Archard's law asks for; rounding leaves 1e-12 of it.
CONSERVATION = 1.0e-10
#: What rounding may add or take [mm]: of a height, or of the mean depth over the cells ever touched.
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
#: What heights may be off by the rounding of many steps [mm].
OF_STEPS = 1.0e-9
#: Columns of what each body has worn, is due to, and has not lost yet.
BOOKS = tuple((f"wear_volume_{b}", f"archard_volume_{b}", f"pending_volume_{b}") for b in BODIES)
#: Kind of a violation -> what is said of it, and whether the state is sound.
VIOLATIONS: dict[str, dict[str, Any]] = prose("violations")


@dataclass(frozen=True)
class Violation:
    """Something that does not hold."""

    quantity: str  # column of the history or name of the field; "edge" or "rim"
    sentence: str  # without its full stop
    remedy: str = "so what follows cannot be trusted"
    sound: bool = False  # whether the state is what the equations say, so that it may be kept

    @classmethod
    def of(cls, kind: str, row: Mapping[str, float], /, quantity: str = "", **values: Any) -> Self:
        """Return what `VIOLATIONS` say of a kind, after the step of a row, with values by their fields.

        quantity: that it is of, by default the kind.
        """
        where = f"after {row.get('distance', math.nan):g} mm of sliding"
        values |= {"what": quantity or kind, "where": where}
        about = VIOLATIONS[kind].items()
        told: Any = {name: said.format(**values) if isinstance(said, str) else said for name, said in about}
        return cls(values["what"], **told)


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
            yield Violation.of("load_residual", row, residual=residual, most=self._residual)
        for worn, expected, pending in BOOKS:
            if _is_off(row, worn, expected, pending):
                yield self._not_conserved(row, worn, row[expected])
        for law in self._laws:
            for what, volume, due in law.balances(row):
                if not abs(volume - due) <= CONSERVATION * abs(due) + ROUNDING * row["area_touched"]:
                    yield Violation.of("not_due", row, what, volume=volume, due=due)
        if (touches_edge and not self._study.repeats) or touches_rim:
            yield self._outside(row, rim=touches_rim)

    def hold(self, steps: StepColumns) -> bool:
        """Tell whether `of_row` has nothing to say of steps in a row; False where it is to be asked."""
        columns, outside = steps.columns, steps.touches_rim
        if not self._study.repeats:
            outside = outside | steps.touches_edge
        closed = [values for name, values in columns.items() if name not in OPEN]
        wrong = outside | (np.abs(columns["load_residual"]) > self._residual)
        for names in BOOKS:
            wrong = wrong | _is_off(columns, *names)
        return not self._laws and not wrong.any() and bool(np.isfinite(closed).all())

    def of_columns(self, row: Mapping[str, float]) -> Iterator[Violation]:
        """Yield columns of the study's runs that a row does not have, so that they would be unknown."""
        if lacking := {column.name for column in columns_of(self._study)} - MADE_LATER - row.keys():
            yield Violation.of("columns", row, lacking=", ".join(sorted(lacking)))

    def of_heights(self, depth: float, row: Mapping[str, float]) -> Iterator[Violation]:
        """Yield a disc that is off the heights that results have of it by a depth [mm]."""
        if depth > OF_STEPS:
            yield Violation.of("heights", row, depth=depth)

    def of_bounds(self, depth: float, row: Mapping[str, float]) -> Iterator[Violation]:
        """Report a gap below the bound of its tile by a depth [mm], so that its tile may be missed."""
        if depth > ROUNDING:
            yield Violation.of("bounds", row, depth=depth)

    def of_filled(self, snapshot: Snapshot, row: Mapping[str, float]) -> Iterator[Violation]:
        """Return a contact that rests on points of the disc which were not measured, but filled in."""
        share = snapshot.load_on_filled or 0.0
        if share > ON_FILLED:
            yield Violation.of("filled", row, percent=100.0 * share, most=100.0 * ON_FILLED)

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
                yield Violation.of("infinite_field", row, name, bad=bad)
            elif name in FIELDS and not FIELDS[name].signed and np.min(values) < 0.0:
                yield Violation.of("negative_field", row, name)

    def _not_finite(self, row: Mapping[str, float]) -> Iterator[Violation]:
        for name, value in row.items():
            if not math.isfinite(value) and name not in OPEN:
                yield Violation.of("infinite", row, name, value=value)

    def _not_conserved(self, row: Mapping[str, float], name: str, expected: float) -> Violation:
        off = f"{abs(row[name] - expected) / expected:.2g}" if expected else "all"
        allowed, worn = CONSERVATION, row[name]
        return Violation.of("not_conserved", row, name, worn=worn, expected=expected, off=off, most=allowed)

    def _outside(self, row: Mapping[str, float], *, rim: bool) -> Violation:
        if rim:
            return Violation.of("rim", row, radius=self._study.counter.nominal_radius)
        sides, domain = extent_for(self._study, row["distance"]), self._study.grid
        needed = [*sides] if isinstance(domain.extent, tuple) else [max(sides)]
        sizes = " × ".join(f"{1.05 * side:.2g}" for side in needed)
        return Violation.of("edge", row, size=domain.size, sizes=sizes)


def _is_off(row: Mapping[str, Any], worn: str, expected: str, pending: str) -> Any:
    """Tell whether a worn volume is off what Archard's law asks for, in a row or in each of many."""
    if worn not in row:
        return False
    allowed = CONSERVATION * row[expected] + ROUNDING * row.get("area_touched", 0.0)
    return abs(row[worn] + row.get(pending, 0.0) - row[expected]) > allowed
