"""What the report of the thesis compares, and how it judges: every verdict is computed from the numbers.

The table at its top, figures and tables of the thesis and findings stand in `items.toml`, which says how. A
`Rule` is a condition and its two reasons, written in the language of Jinja templates.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from typing import Any

import jinja2
from printed import PRINTED, SERIES, TOLERANCES, Printed, read
from recomputed import VERSIONS

#: Digits and sign of an exponent -> those above the line.
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: Exponent m and levelling index λ of an area that grows as the square root of the distance.
SQUARE_ROOT = {"exponent_m": 0.5, "levelling_lambda": 0.25}
#: What the names of numbers begin with, before their dot.
GROUPS = (*VERSIONS, "beyond", "experiment", "implicit", "surfaces")


class Kind(StrEnum):
    """What a verdict can be, in the words that the reader sees."""

    AGREES = "agrees"
    DISAGREES = "disagrees"
    NOT_COMPARABLE = "cannot be compared"
    WRONG = "wrong in the thesis"
    HOLDS = "holds"
    FAILS = "does not hold"


#: What a verdict is if its condition holds -> what it is if not.
OTHERWISE = {
    Kind.AGREES: Kind.DISAGREES,
    Kind.WRONG: Kind.AGREES,
    Kind.HOLDS: Kind.FAILS,
    Kind.NOT_COMPARABLE: Kind.NOT_COMPARABLE,
}


@dataclass(frozen=True)
class Verdict:
    """A verdict has a judgement and its reason in one to three sentences."""

    kind: Kind
    reason: str


class Unknown(Exception):
    """A rule asked for a number that the runs cannot say."""


@dataclass(frozen=True)
class Known:
    """Numbers whose names have one beginning; raises Unknown for one that is missing or not finite."""

    numbers: Mapping[str, float]
    beginning: str = ""

    def __getitem__(self, name: str) -> float:
        value = self.numbers.get(self.beginning + name, math.nan)
        if not math.isfinite(value):
            raise Unknown(self.beginning + name)
        return value


@dataclass(frozen=True, kw_only=True)
class Rule:
    """A verdict of a kind if a condition holds, and why or why not.

    condition, unless and the values of `let` are expressions; yes and no are templates, and yes is both
    without a no. let: names for what
    follows. unless: when nothing can be compared; since: why not.
    """

    kind: Kind
    yes: str
    no: str = ""
    condition: str = "true"
    let: Mapping[str, str] = field(default_factory=dict)
    unless: str = "false"
    since: str = ""

    def judge(self, numbers: Mapping[str, float]) -> Verdict:
        """Judge by these numbers; where one is missing, even in the reason not given, nothing is compared."""
        known: dict[str, Any] = {group: Known(numbers, f"{group}.") for group in GROUPS}
        known["n"] = Known(numbers)
        try:
            if _expression(self.unless)(known):
                return Verdict(Kind.NOT_COMPARABLE, self.since)
            for name, expression in self.let.items():
                known[name] = _expression(expression)(known)
            holds = _expression(self.condition)(known)
            yes, no = (folded(_template(text).render(known)) for text in (self.yes, self.no or self.yes))
        except Unknown as missing:
            return Verdict(Kind.NOT_COMPARABLE, f"The runs do not say {missing}.")
        return Verdict(self.kind, yes) if holds else Verdict(OTHERWISE[self.kind], no)


@cache
def environment() -> Any:
    """Make what rules can use besides numbers of the runs."""
    rules = jinja2.Environment(undefined=jinja2.StrictUndefined, autoescape=False)
    rules.globals = {
        "abs": abs,
        "max": max,
        "printed": {name: printed.value for name, printed in PRINTED.items()},
        "tolerance": TOLERANCES,
    } | {name: [printed.value for printed in series] for name, series in SERIES.items()}
    rules.filters |= {"number": number, "percent": percent, "shape": shape_of}
    rules.tests["square_root"] = is_square_root
    return rules


@cache
def _expression(text: str) -> Any:
    """Compile an expression into a function of names and values."""
    return environment().compile_expression(text, undefined_to_none=False)


@cache
def _template(text: str) -> Any:
    """Compile a template."""
    return environment().from_string(text)


def folded(text: str) -> str:
    """Write a text of several lines as one."""
    return " ".join(text.split())


def is_square_root(version: Known) -> bool:
    """Tell whether a version's area grows as the square root of the distance."""
    return all(abs(version[name] - value) < TOLERANCES["shape"] for name, value in SQUARE_ROOT.items())


def shape_of(version: Known) -> str:
    """Write m and λ of a version's area."""
    return f"m = {number(version['exponent_m'])}, λ = {number(version['levelling_lambda'])}"


def number(value: float, digits: int = 3) -> str:
    """Write a number with all its digits and a true minus sign; – for one that is not known."""
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    text = f"{value:#.{digits}g}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        raised = f"{mantissa.removesuffix('.')}·10{str(int(exponent)).translate(RAISED)}"
        text = f"{float(text):.0f}" if 0 <= int(exponent) < 7 else raised
    return text.removesuffix(".").replace("-", "−")


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
