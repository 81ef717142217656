"""How the report of the thesis judges: every verdict is computed from the numbers.

A `Rule` is a condition and its two reasons, written in the language of Jinja templates. The rules stand in
`items.toml`, which says what may stand in them.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from typing import Any

from warpwear import lazy
from warpwear.figures.wording import power_of_ten
from warpwear.thesis.printed import PRINTED, SERIES, TOLERANCES, Printed
from warpwear.thesis.runs import VERSIONS

jinja2 = lazy.module("jinja2")

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
        raised = f"{mantissa.removesuffix('.')}·{power_of_ten(exponent)}"
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
