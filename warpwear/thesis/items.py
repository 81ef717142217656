"""What the report of the thesis compares: the table at its top, figures and tables of the thesis, findings.

They stand in `items.toml`, which says how; here they are read, and each row of the table is judged.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from warpwear.thesis.printed import PRINTED, TOLERANCES, Printed, read
from warpwear.thesis.runs import VERSIONS
from warpwear.thesis.verdicts import Kind, Rule, folded

#: Unit of a row -> numbers are shown times this.
FACTORS = {"%": 100.0, "10⁻⁴ mm³/(N·m)": 1e4}


@dataclass(frozen=True)
class Row:
    """One quantity: what is printed and which of our numbers stand beside it, each under a column's name."""

    quantity: str
    unit: str
    ours: Mapping[str, str]  # column -> name of a number
    printed: Mapping[str, Printed]  # column -> value

    @property
    def factor(self) -> float:
        """What our numbers, and printed ones, are multiplied with to have the unit."""
        return FACTORS.get(self.unit, 1.0)


@dataclass(frozen=True)
class Line:
    """A row of the table at the top and where more is said of it.

    item: id of a figure or a finding. tolerance: largest difference, in the row's unit, of a printed and one
    of our numbers that agree.
    """

    row: Row
    item: str
    tolerance: float

    def judge(self, numbers: Mapping[str, float]) -> Kind | None:
        """Judge whether ours are what is printed; None where nothing is.

        A column 'thesis V1' stands beside our V1, the experiment's beside all of ours.
        """
        pairs = [
            (self.row.factor * printed.value, self.row.factor * numbers.get(name, math.nan))
            for column, printed in self.row.printed.items()
            for version, name in self.row.ours.items()
            if column in (f"thesis {version}", "experiment")
        ]
        if not pairs:
            return None
        if not all(math.isfinite(ours) for _, ours in pairs):
            return Kind.NOT_COMPARABLE
        near = all(abs(ours - printed) <= self.tolerance for printed, ours in pairs)
        return Kind.AGREES if near else Kind.DISAGREES


@dataclass(frozen=True)
class Item:
    """One figure, table or statement with the rule that judges it."""

    id: str
    title: str
    says: str  # what the thesis says or draws there, in our words; or what is claimed here
    rule: Rule
    place: str = ""  # in the thesis; a statement of our own has none
    rows: tuple[Row, ...] = ()
    figures: tuple[str, ...] = ()  # names of figures


def _row(
    quantity: str,
    unit: str,
    *,
    ours: Mapping[str, str] | Sequence[str] = (),
    of_all: str = "",
    printed: Mapping[str, str] | None = None,
) -> Row:
    """Make a row from its entry. of_all: name of a number of every version, without the version."""
    names = [f"{version}.{of_all}" for version in VERSIONS] if of_all else ours
    columns = names if isinstance(names, Mapping) else {VERSIONS[n.partition(".")[0]]: n for n in names}
    return Row(quantity, unit, columns, {column: PRINTED[name] for column, name in (printed or {}).items()})


def _line(item: str, tolerance: str = "", **row: Any) -> Line:
    """Make a row of the table at the top from its entry. tolerance: its name."""
    return Line(_row(**row), item, TOLERANCES[tolerance] if tolerance else 0.0)


def _item(says: str, verdict: dict[str, Any], **entry: Any) -> Item:
    """Make an item from its entry."""
    rule = Rule(**verdict | {"kind": Kind(verdict["kind"])})
    rows = tuple(_row(**row) for row in entry.pop("rows", ()))
    figures = tuple(entry.pop("figures", ()))
    return Item(says=folded(says), rule=rule, rows=rows, figures=figures, **entry)


_CONTENT = read("items.toml")
SUMMARY = tuple(_line(**entry) for entry in _CONTENT["summary"])
#: Figures and tables of the thesis, then statements of our own.
ALL_ITEMS = tuple(_item(**entry) for entry in _CONTENT["item"])
OF_THESIS = tuple(item for item in ALL_ITEMS if item.place)
FINDINGS = {item.id: item for item in ALL_ITEMS if not item.place}
