"""Designs: which values of varied keys go together in one run, listed or drawn from distributions.

Distributions are written as people write them: "normal 9.4e-4 +- 0.7e-4 mm^3/N/m".
"""

import itertools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray

stats = lazy.module("scipy.stats")
qmc = lazy.module("scipy.stats.qmc")

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
LISTED = ("grid", "zip")
SAMPLED = ("sobol", "latin-hypercube", "saltelli")
#: Runs of one sweep at most: a slip of the pen asks for more.
MOST_RUNS = 1_000_000
_RANGE = re.compile(r"\s*([+-]?\d+)\s*:\s*([+-]?\d+)\s*")

Value = Any


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


@dataclass(frozen=True)
class Factor:
    """A key that is varied: its values one by one, or the distribution that they are drawn from."""

    key: str
    values: tuple[Value, ...] = ()
    distribution: Distribution | None = None

    def at(self, u: FloatArray) -> list[Value]:
        """Return values at parts u of the distribution, or of the list, whose values are equally likely."""
        if self.distribution is not None:
            return [self.distribution.written(value) for value in self.distribution.quantiles(u)]
        places = np.minimum((u * len(self.values)).astype(np.intp), len(self.values) - 1)
        return [self.values[place] for place in places]


@dataclass(frozen=True)
class Design:
    """Which runs a sweep makes: its kind, and of a sampled one the number of samples and their seed."""

    kind: str = "grid"
    samples: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        if self.kind in SAMPLED and self.samples is None:
            raise InputError(f"sweep.design = '{self.kind}' needs a number of samples, such as samples = 256")
        if self.kind in LISTED and self.samples is not None:
            raise InputError(f"sweep.samples does not apply to design '{self.kind}', which takes every value")
        if self.samples is not None and self.samples < 2:
            raise InputError(f"sweep.samples = {self.samples}: at least 2 are needed.")

    def points(self, factors: Sequence[Factor]) -> list[dict[str, Value]]:
        """Key -> value of every run; the first key varies slowest. InputError for what does not fit."""
        keys = [factor.key for factor in factors]
        if self.kind in LISTED:
            for factor in factors:
                if factor.distribution is not None:
                    raise InputError(
                        f"sweep.vary '{factor.key}' is a distribution, from which the design '{self.kind}' "
                        f"cannot draw; give design = 'sobol' and samples."
                    )
            lists = [factor.values for factor in factors]
            lengths = sorted({len(values) for values in lists})
            if self.kind == "zip" and len(lengths) > 1:
                counts = ", ".join(f"{factor.key} {len(factor.values)}" for factor in factors)
                raise InputError(f"design = 'zip' needs as many values of every key; given: {counts}.")
            rows = zip(*lists, strict=True) if self.kind == "zip" else itertools.product(*lists)
            _check_number(lengths[0] if self.kind == "zip" else math.prod(map(len, lists)))
            return [dict(zip(keys, row, strict=True)) for row in rows]
        u = self.unit_samples(len(factors))
        _check_number(len(u))
        columns = [factor.at(u[:, place]) for place, factor in enumerate(factors)]
        return [dict(zip(keys, row, strict=True)) for row in zip(*columns, strict=True)]

    def unit_samples(self, factors: int) -> FloatArray:
        """Points of the unit cube, shape (runs, factors), inside of it.

        saltelli: samples · (factors + 2) points: A, B, and A with one column of B each (Saltelli 2010,
        doi:10.1016/j.cpc.2009.09.018), in the order that `indices.sobol` takes.
        """
        assert self.samples is not None
        _check_number(self.samples * (factors + 2.0))
        if self.kind == "latin-hypercube":
            return _inside(qmc.LatinHypercube(factors, rng=self.seed).random(self.samples))
        sequence = qmc.Sobol(2 * factors if self.kind == "saltelli" else factors, rng=self.seed)
        power = int(np.ceil(np.log2(self.samples)))
        u = _inside(sequence.random_base2(power)[: self.samples])
        if self.kind == "sobol":
            return u
        if self.samples != 2**power:
            raise InputError(
                f"sweep.samples = {self.samples}: 'saltelli' needs a power of two, such as {2**power}."
            )
        a, b = u[:, :factors], u[:, factors:]
        mixed = [np.where(np.arange(factors) == place, b, a) for place in range(factors)]
        return np.concatenate([a, b, *mixed])


def factors_of(vary: Mapping[str, Any]) -> list[Factor]:
    """Return what each key is varied over: a list, a range "1:20" with both ends, or a distribution.

    Raises InputError for anything else.
    """
    if not vary:
        raise InputError("sweep.vary is empty: name a key and its values, such as contact.load=2 N,4 N,8 N.")
    return [_factor(str(key), values) for key, values in vary.items()]


def _factor(key: str, values: Any) -> Factor:
    if isinstance(values, str) and (ends := _RANGE.fullmatch(values)):
        first, last = int(ends[1]), int(ends[2])
        if last < first:
            raise InputError(f"sweep.vary '{key}' = '{values}': the first number must be the smaller one.")
        _check_number(last - first + 1.0)
        return Factor(key, tuple(range(first, last + 1)))
    if isinstance(values, str):
        return Factor(key, distribution=distribution(values, key))
    if isinstance(values, Distribution):
        return Factor(key, distribution=values)
    if isinstance(values, Mapping) or not hasattr(values, "__iter__"):
        raise InputError(
            f"sweep.vary '{key}' = {values!r}: a list of values, a range such as '1:20' or a distribution "
            "such as 'normal 8 +- 1 N' is expected."
        )
    values = tuple(values)
    if not values:
        raise InputError(f"sweep.vary '{key}' has no values.")
    return Factor(key, values)


def _inside(u: FloatArray) -> FloatArray:
    """Points moved off the cube's faces, where a normal distribution has no finite value."""
    return np.clip(u, 2.0**-53, 1.0 - 2.0**-53)


def _check_number(runs: float) -> None:
    if runs > MOST_RUNS:
        raise InputError(f"the sweep asks for {runs:g} runs; at most {MOST_RUNS:g} are made at once.")
