"""The books of a contact of patches hold its history, what each patch did, and whose wear it was."""

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from warpwear.contact.balance import Balance, checked_residual
from warpwear.grid import FloatArray
from warpwear.history.quantities import PATCH_TABLES
from warpwear.history.recorder import Ledger, Step, split_wear
from warpwear.history.snapshot import Snapshot
from warpwear.laws.archard import BODIES
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask


@dataclass(frozen=True, eq=False)
class Worn:
    """Hold what a step did to the patches; of loads and areas one value a patch.

    "worn" is by both bodies, of which each may have its own instead, "wear_counter" and "wear_disc".
    """

    total: dict[str, float]  # over all patches, by the names of `kernels.cells.PATCH_SUMS`
    most: dict[str, float]  # by those of `PATCH_MAXIMA`
    loads: FloatArray  # [N]
    areas: FloatArray  # in contact [mm²]
    approach: tuple[float, float]  # of the bodies, base and offset [mm]
    reference: float  # pressure from which the squares count [MPa]
    evaluations: int


def bytes_of_book(steps: int, patches: int) -> int:
    """Return the memory that the tables take at most: as they grow and as a checkpoint writes them."""
    return 2 * len(PATCH_TABLES) * 8 * steps * patches


class PatchBook:
    """Grows by a row of each table a step."""

    STATE: ClassVar = {"tables": dict}

    def __init__(self, patches: Patches) -> None:
        self.patches = patches
        self._rows: dict[str, list[FloatArray]] = {table.name: [] for table in PATCH_TABLES}

    def enter(self, **row: FloatArray) -> None:
        """Add the values of one step by the names of `PATCH_TABLES`, shape (patches,) each."""
        for name, values in row.items():
            self._rows[name].append(values)

    def table(self, name: str) -> FloatArray:
        """Return a table, shape (steps, patches)."""
        return np.array(self._rows[name]).reshape(-1, self.patches.count)

    @property
    def tables(self) -> dict[str, FloatArray]:
        """Return every table, by name; may be set."""
        return {name: self.table(name) for name in self._rows}

    @tables.setter
    def tables(self, tables: dict[str, FloatArray]) -> None:
        self._rows = {name: list(table) for name, table in tables.items()}


class PatchLedger(Ledger):
    """Keep the books of patches, whose counter-body and disc may wear in one proportion.

    patches: in the order of the macro cells, in which the book has them.
    """

    STATE: ClassVar[dict[str, Any]] = {**Ledger.STATE, "book": PatchBook}

    def __init__(self, task: ContactTask, patches: Patches) -> None:
        # In the outermost macro cells, what a patch touches may stand for the domain's edge.
        margin = 1 if patches.cover_everything else patches.pitch
        super().__init__(task, patches.domain, weight=patches.weight, margin=margin)
        self.book = PatchBook(patches)
        #: Area that a cell stands for [mm²].
        self._of_cell = patches.domain.cell_area * patches.weight
        #: Fractions of counter-body and disc in what both lose.
        self._fractions = task.wear_fractions
        #: Whether K goes with the pressure.
        self._bends = len(task.knots) > 0

    @property
    def foundation(self) -> float:
        """Return K_N of the next step [N/mm³], which may follow the scar; inf where it plays no part."""
        if not self._task.uses_bulk_stiffness:
            return math.inf
        return self._task.bulk_stiffness_at(math.sqrt(self.row["area_nominal"] / math.pi) or None)

    def worn(self, sums: dict[str, FloatArray], most: dict[str, float], **others: Any) -> Worn:
        """Return what a step did, by its sums over each patch; 0 for those that never touched."""
        total = {name: float(values.sum()) for name, values in sums.items()}
        loads, areas = (sums[name] * self._of_cell for name in ("pressure", "contact"))
        return Worn(total, most, loads, areas, **others)

    def enter_worn(
        self,
        worn: Worn,
        increment: float,
        removals: tuple[float, float],
        pressure: FloatArray | None = None,
    ) -> Step:
        """Book a step of an increment [mm] that wore counter-body and disc by K ΔL = removals [mm³/N].

        worn: of patches in the order of the macro cells. pressure: on the domain [MPa], where it was asked
        for. Raises ConvergenceError where the pressures do not add up to the load.
        """
        total, most = (
            split_wear(both, self._fractions) if "worn" in both else both for both in (worn.total, worn.most)
        )
        if self._bends:
            total["wearing_counter"] = total["pressure_times_factor"] = total["wearing"]
        load, approach = self._task.load, sum(worn.approach)
        residual = checked_residual(total["pressure"] * self._of_cell - load, load, approach=approach)
        self.book.enter(load_share=worn.loads, area_patch=worn.areas)
        balance = Balance(*worn.approach, self._task.hardness, residual, evaluations=worn.evaluations)
        return self.enter(balance, increment, removals, worn.reference, total, most, pressure=pressure)

    def snapshot(
        self, step: Step, distance: float, patches: Patches, **stored: FloatArray | None
    ) -> Snapshot:
        """Return the fields after a step that was asked for its pressure, at its distance [mm].

        Over the whole domain; what no patch covers has neither pressure nor wear, and no gap (NaN). stored:
        gap, what both bodies have worn of it, or each [mm], and fields of features, as `patches` stores them,
        in whatever order.
        """
        assert step.pressure is not None
        fields: dict[str, Any] = {
            name: patches.on_domain(values, beside=math.nan if name == "gap" else 0.0)
            for name, values in stored.items()
            if values is not None
        }
        if "worn" in fields:
            worn = fields.pop("worn")
            fields |= {f"wear_{b}": part * worn for b, part in zip(BODIES, self._fractions, strict=True)}
        snapshot = Snapshot.of(distance, fields | {"pressure": step.pressure})
        return replace(snapshot, fresh=frozenset(snapshot.fields))  # all are made for it
