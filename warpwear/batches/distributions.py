"""Distributions of an input, written as people write them: "normal 9.4e-4 +- 0.7e-4 mm^3/N/m"."""

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray

stats = lazy.module("scipy.stats")

_NUMBER = r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
_WRITTEN = re.compile(
    rf"\s*(?P<kind>[a-z][a-z -]*?)\s+{_NUMBER}\s*(?P<between>\+-|±|\.\.|to)\s*{_NUMBER}"
    rf"(?:\s+within\s+{_NUMBER}\s*(?:\.\.|to)\s*{_NUMBER})?(?:\s+(?P<unit>\S.*?))?\s*"
)
#: Kind -> what stands between its two numbers: mean and standard deviation, or the ends of a range.
KINDS = {"normal": "+-", "log-normal": "+-", "uniform": "..", "log-uniform": ".."}
ALLOWED = (
    "'normal 9.4e-4 +- 0.7e-4 mm^3/N/m', 'log-normal 2 +- 0.5 N', 'uniform 2 .. 8 N' or "
    "'log-uniform 1e-4 .. 1e-3 mm^3/N/m', the first two also truncated: 'normal 8 +- 2 within 4 .. 12 N'"
)


@dataclass(frozen=True)
class Distribution:
    """An input that is not one number.

    first, second: mean and standard deviation of a normal or log-normal one (of the quantity itself, not of
    its logarithm), the ends of a uniform or log-uniform one. within: the range outside of which a normal or
    log-normal one is cut off. unit: as written, empty for a number without one.
    """

    kind: str
    first: float
    second: float
    within: tuple[float, float] | None = None
    unit: str = ""

    def __str__(self) -> str:
        """Write it for people, in few digits."""
        between = ".." if self.kind.endswith("uniform") else "±"
        cut = " within {:.4g} .. {:.4g}".format(*self.within) if self.within else ""
        return f"{self.kind} {self.first:.4g} {between} {self.second:.4g}{cut} {self.unit}".rstrip()

    def quantiles(self, u: FloatArray) -> FloatArray:
        """Return the values below which parts u of the distribution lie. u: in (0, 1), of any shape."""
        a, b = self.first, self.second
        if self.kind == "uniform":
            return a + (b - a) * u
        if self.kind == "log-uniform":
            return np.asarray(a * (b / a) ** u)
        frozen: Any = stats.norm(*self.numbers)
        if self.within is not None:
            low, high = map(self.scaled, self.within)
            u = frozen.cdf(low) + u * (frozen.cdf(high) - frozen.cdf(low))
        values: FloatArray = frozen.ppf(u)
        return math.e**values if self.is_logarithmic else values

    @property
    def is_logarithmic(self) -> bool:
        """Tell whether it is one of the logarithm."""
        return self.kind.startswith("log-")

    @property
    def numbers(self) -> tuple[float, float]:
        """Return mean and deviation, or the ends, of the quantity or its logarithm."""
        if self.kind == "log-normal":
            spread = math.sqrt(math.log1p((self.second / self.first) ** 2))
            return math.log(self.first) - 0.5 * spread**2, spread
        return self.scaled(self.first), self.scaled(self.second)

    def scaled(self, value: float) -> float:
        """Return a value of the quantity, or its logarithm where the distribution is one of that."""
        return math.log(value) if self.is_logarithmic else value

    def written(self, value: float) -> str | float:
        """Return a value as a study takes it."""
        return f"{float(value)!r} {self.unit}" if self.unit else float(value)


def distribution(text: str, key: str) -> Distribution:
    """Return the distribution that a text describes. Raises InputError, naming the key, for another text."""
    match = _WRITTEN.fullmatch(text)
    kind, between = "", ""
    if match is not None:
        kind = " ".join(match["kind"].split()).removeprefix("truncated ")
        between = {"±": "+-", "to": ".."}.get(match["between"], match["between"])
    if match is None or KINDS.get(kind) != between:
        raise InputError(f"sweep.vary '{key}' = '{text}': a distribution such as {ALLOWED} is expected.")
    _, first, _, second, low, high, unit = match.groups()
    within = None if low is None else (float(low), float(high))
    parsed = Distribution(kind, float(first), float(second), within, unit or "")
    _check(parsed, text, key)
    return parsed


def _check(parsed: Distribution, text: str, key: str) -> None:
    """Raise InputError for numbers that make no distribution."""
    problem = None
    if KINDS[parsed.kind] == ".." and not parsed.first < parsed.second:
        problem = "the first number must be the smaller one"
    elif KINDS[parsed.kind] == ".." and parsed.within is not None:
        problem = "a uniform distribution ends where its range does and takes no 'within'"
    elif KINDS[parsed.kind] == "+-" and not parsed.second > 0.0:
        problem = "the number after +- must be greater than 0"
    elif parsed.kind.startswith("log-") and not parsed.first > 0.0:
        problem = "a logarithmic distribution needs positive numbers"
    elif parsed.within is not None and not parsed.within[0] < parsed.within[1]:
        problem = "the first number after 'within' must be the smaller one"
    elif parsed.within is not None and parsed.kind == "log-normal" and not parsed.within[0] > 0.0:
        problem = "a logarithmic distribution needs positive numbers"
    if problem:
        raise InputError(f"sweep.vary '{key}' = '{text}': {problem}.")
