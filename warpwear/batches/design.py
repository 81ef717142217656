"""Designs: which values of the varied keys go together in one run."""

import itertools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.batches.distributions import Distribution, distribution
from warpwear.errors import InputError
from warpwear.grid import FloatArray

qmc = lazy.module("scipy.stats.qmc")

LISTED = ("grid", "zip")
SAMPLED = ("sobol", "latin-hypercube", "saltelli")
#: Runs of one sweep at most: a slip of the pen asks for more.
MOST_RUNS = 1_000_000
_RANGE = re.compile(r"\s*([+-]?\d+)\s*:\s*([+-]?\d+)\s*")

Value = Any


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
