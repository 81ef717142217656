"""What the report of the thesis compares and how it judges: every verdict is computed from the numbers.

An `Item` is declared with `@item` above the rule that judges it; the rule gets the numbers by name and
returns a `Verdict`. The items stand in `items_*` (figures and tables of the thesis) and in `findings`
(statements of our own); `summary` has all of them.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from warpwear.thesis.printed import PATCH_DIAMETERS, Printed
from warpwear.thesis.runs import VERSIONS

#: Exponent of an area that grows as the square root of the distance.
ROOT_EXPONENT = 0.5
#: Its levelling index λ.
ROOT_LEVELLING = 0.25
#: How far from them a course still counts as a square root.
SHAPE_TOLERANCE = 0.05
#: Largest relative difference of two volumes that count as one.
SAME_VOLUME = 1e-3
#: Rounding of a printed diameter plus two cells of 10 µm [mm].
DIAMETER_TOLERANCE = 0.025
#: Rounding of a printed limit of the pressure [MPa].
PRESSURE_TOLERANCE = 5.0
#: Part of a depth below which no figure shows a difference of shape.
VISIBLE = 0.01
#: Unit of a row -> numbers are shown times this.
FACTORS = {"%": 100.0, "10⁻⁴ mm³/(N·m)": 1e4}
#: Diameter of the worn patch of smooth discs: from the depths.
SMOOTH_PATCHES = {"V1": "v1.patch_by_depth_mm", "V2": "v2.patch_by_depth_mm"}
#: Diameter of the worn patch of rough discs: as touched.
ROUGH_PATCHES = {"V3": "v3.patch_along_mm", "V3 fine": "fine.patch_along_mm"}


class Kind(StrEnum):
    """What a verdict can be, in the words that the reader sees."""

    AGREES = "agrees"
    DISAGREES = "disagrees"
    NOT_COMPARABLE = "cannot be compared"
    WRONG = "wrong in the thesis"
    HOLDS = "holds"
    FAILS = "does not hold"


@dataclass(frozen=True)
class Verdict:
    """A judgement and its reason in one to three sentences."""

    kind: Kind
    reason: str


class Unknown(Exception):
    """A rule asked for a number that the runs cannot say."""


class Known(Mapping[str, float]):
    """Numbers by name; raises Unknown for one that is missing or not finite."""

    def __init__(self, numbers: Mapping[str, float]) -> None:
        self._numbers = numbers

    def __getitem__(self, name: str) -> float:
        value = self._numbers.get(name, math.nan)
        if not math.isfinite(value):
            raise Unknown(name)
        return value

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers)

    def __len__(self) -> int:
        return len(self._numbers)


Rule = Callable[[Known], Verdict]


@dataclass(frozen=True)
class Row:
    """One quantity: what is printed and which of our numbers stand beside it, each under a column's name."""

    quantity: str
    unit: str
    ours: Mapping[str, str]  # column -> name of a number
    printed: Mapping[str, Printed] = field(default_factory=dict)  # column -> value

    @property
    def factor(self) -> float:
        """What our numbers, and printed ones, are multiplied with to have the unit."""
        return FACTORS.get(self.unit, 1.0)


@dataclass(frozen=True)
class Item:
    """One figure, table or statement with the rule that judges it."""

    id: str
    place: str
    title: str
    says: str  # what the thesis says or draws there, in our words; or what is claimed here
    rule: Rule
    rows: tuple[Row, ...] = ()
    figures: tuple[str, ...] = ()  # names of figures

    def judge(self, numbers: Mapping[str, float]) -> Verdict:
        """Judge the item by these numbers."""
        try:
            return self.rule(Known(numbers))
        except Unknown as missing:
            return Verdict(Kind.NOT_COMPARABLE, f"The runs do not say {missing}.")


@dataclass(frozen=True)
class Table:
    """Items in their order, filled by decorators."""

    items: list[Item] = field(default_factory=list)

    def item(
        self,
        name: str,
        title: str,
        says: str,
        *rows: Row,
        place: str | None = None,
        figures: tuple[str, ...] = (),
    ) -> Callable[[Rule], Rule]:
        """Add an item with the decorated function as its rule.

        place: where the thesis has it, by default what its name says: figure-4.17 is Figure 4.17.
        """
        if place is None:
            kind, _, where = name.partition("-")
            place = f"{kind.capitalize()} {where}" if where else ""

        def add(rule: Rule) -> Rule:
            self.items.append(Item(name, place, title, says, rule, rows, figures))
            return rule

        return add


def agrees_if(condition: bool, yes: str, no: str) -> Verdict:
    """Judge what the thesis shows: it agrees, or disagrees."""
    return Verdict(Kind.AGREES, yes) if condition else Verdict(Kind.DISAGREES, no)


def wrong_if(condition: bool, yes: str, no: str) -> Verdict:
    """Judge what the thesis claims: it is wrong there, or else agrees with ours."""
    return Verdict(Kind.WRONG, yes) if condition else Verdict(Kind.AGREES, no)


def holds_if(condition: bool, yes: str, no: str) -> Verdict:
    """Judge a statement of our own: it holds, or does not."""
    return Verdict(Kind.HOLDS, yes) if condition else Verdict(Kind.FAILS, no)


def of(*names: str) -> dict[str, str]:
    """Put numbers of versions under their columns: 'v1.area_mm2' under 'V1'."""
    return {VERSIONS[name.partition(".")[0]]: name for name in names}


def of_all(quantity: str, unit: str, key: str, printed: Mapping[str, Printed] | None = None) -> Row:
    """Declare one quantity of the four versions. printed: column -> value."""
    return Row(quantity, unit, of(*(f"{version}.{key}" for version in VERSIONS)), printed or {})


def extremes(name: str) -> dict[str, str]:
    """Put a number's smallest and largest over all surfaces under columns. name: with {} for which."""
    return {which: name.format(which) for which in ("smallest", "largest")}


def patches(*names: str) -> dict[str, Printed]:
    """Put printed diameters of the worn patch under columns: of the experiment and of versions."""
    return {v if v == "experiment" else f"thesis {VERSIONS[v]}": PATCH_DIAMETERS[v] for v in names}


def is_root(n: Known, version: str) -> bool:
    """Tell whether a version's area grows as the square root of the distance."""
    return (
        abs(n[f"{version}.exponent_m"] - ROOT_EXPONENT) < SHAPE_TOLERANCE
        and abs(n[f"{version}.levelling_lambda"] - ROOT_LEVELLING) < SHAPE_TOLERANCE
    )


def shape_of(n: Known, version: str) -> str:
    """Write m and λ of a version's area."""
    return f"m = {number(n[f'{version}.exponent_m'])}, λ = {number(n[f'{version}.levelling_lambda'])}"


def number(value: float, digits: int = 3) -> str:
    """Write a number with all its digits and a true minus sign; – for one that is not known."""
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    shown = f"{value:#.{digits}g}"
    if "e" in shown:
        mantissa, exponent = shown.split("e")
        power = int(exponent)
        raised = str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        shown = f"{float(shown):.0f}" if 0 <= power < 7 else f"{mantissa.removesuffix('.')}·10{raised}"
    return shown.removesuffix(".").replace("-", "−")


def percent(value: float, digits: int = 2) -> str:
    """Write a ratio in per cent, with its sign where it is negative; round-off is 0."""
    if abs(value) < 1e-9:
        return "0 %"
    return f"{number(100.0 * value, digits)} %"


def as_printed(printed: Printed, factor: float = 1.0) -> str:
    """Write a number as the thesis does: millimetres with two decimals."""
    if printed.unit == "mm" and printed.value < 10.0:
        return f"{printed.value:.2f}"
    return f"{factor * printed.value:.6g}"
