"""Unknowns: keys of a study, and of the scatter of measurements, each with a prior distribution.

Every unknown is sampled as a number z that is standard normal before the data. All priors are then alike, and
the variance of z after the data says what they taught.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.batches.design import Distribution, distribution
from warpwear.calibration.bayes.data import Data
from warpwear.errors import InputError, reworded
from warpwear.grid import FloatArray
from warpwear.laws.friction import STRENGTH
from warpwear.study.keys import attribute_of, key_of, no_such_key
from warpwear.study.sections.wear import ArchardCoefficient
from warpwear.study.study import Study
from warpwear.study.units import EXAMPLES, InUnit, Number, Range, parse

special = lazy.module("scipy.special")

#: Without a prior an unknown lies within this factor of the study's value, both ways.
FACTOR = 5.0
#: Largest ploughing part without a prior.
PLOUGHING = 0.5
#: Part of a normal prior beyond the allowed values from which it is cut off there.
NEGLIGIBLE = 1e-6
#: Largest deviation of friction without a prior; about a course at most so many times its own scatter, and
#: at least what a tribometer resolves, or what repeated tests differ by.
LARGEST, SCATTERS, AT_LEAST, APART = 0.3, 3.0, 0.01, 0.05
#: Unknowns of the scatter about a course of friction -> what they are.
NOISE = {
    "noise.deviation": "standard deviation of the residuals",
    "noise.length": "distance over which the residuals go together, mm",
    "noise.repeat": "standard deviation between the levels of repeated tests",
}


@dataclass(frozen=True)
class Unknown:
    """An unknown number: its key, its prior in the unit of the key, and the values that it may have.

    assumed: whether the prior was not given. unit: empty for a number without one.
    """

    key: str
    prior: Distribution
    unit: str = ""
    least: float = 0.0
    most: float = math.inf
    assumed: bool = False

    @property
    def is_normal(self) -> bool:
        """True for a normal prior that is not cut off: what is linear in it has a closed form."""
        return self.prior.kind == "normal" and self.prior.within is None

    def values(self, z: FloatArray) -> FloatArray:
        """Turn standard normal numbers of any shape into values of the unknown."""
        a, b = self.prior.numbers
        if self.prior.kind in ("normal", "log-normal"):
            if self.prior.within is not None:
                low, high = (special.ndtr((self.prior.scaled(end) - a) / b) for end in self.prior.within)
                z = special.ndtri(low + special.ndtr(z) * (high - low))
            scaled = a + b * z
        else:
            scaled = a + (b - a) * special.ndtr(z)
        return np.asarray(np.exp(scaled) if self.prior.is_logarithmic else scaled)

    def place_of(self, value: FloatArray) -> FloatArray:
        """Turn values into places for an emulator: even where the prior is, variance one."""
        z = self.normal(value)
        uniform = self.prior.kind.endswith("uniform")
        return np.asarray(math.sqrt(12.0) * (special.ndtr(z) - 0.5)) if uniform else z

    def normal(self, value: FloatArray) -> FloatArray:
        """Turn values of the unknown back into standard normal numbers."""
        a, b = self.prior.numbers
        scaled = np.log(value) if self.prior.is_logarithmic else np.asarray(value)
        if self.prior.kind.endswith("uniform"):
            return np.asarray(special.ndtri(np.clip((scaled - a) / (b - a), 1e-15, 1.0 - 1e-15)))
        if self.prior.within is None:
            return np.asarray((scaled - a) / b)
        low, high = (special.ndtr((self.prior.scaled(end) - a) / b) for end in self.prior.within)
        part = (special.ndtr((scaled - a) / b) - low) / (high - low)
        return np.asarray(special.ndtri(np.clip(part, 1e-15, 1.0 - 1e-15)))

    def text(self, value: float) -> str | float:
        """Write a value as studies do."""
        value = float(f"{value:.6g}")
        return f"{value!r} {self.unit}" if self.unit else value


def unknowns_of(study: Study, priors: Mapping[str, str | None]) -> list[Unknown]:
    """Read the unknowns of a study. priors: by key, as in a sweep, or None for one about the study's value.

    Raises InputError for a key that is none, or is no number, and for a prior beyond its allowed values.
    """
    if not any(key not in NOISE for key in priors):
        raise InputError("no unknown is named: give a key of the study, such as wear.counter")
    return [_unknown(study, key, prior) for key, prior in priors.items() if key not in NOISE]


def noise_for(data: Data, priors: Mapping[str, str | None]) -> list[Unknown]:
    """Return the unknowns of the scatter of the courses in the data; none without a course.

    Without a prior the deviation is anything from 0.001 to thrice what the courses scatter about straight
    lines through their thirds, so that it makes up for no level or trend that the study misses; the length
    anything from a fifth of the spacing to the whole test, and the deviation between repeats, of which there
    are two or more, anything up to thrice what their levels scatter, or 0.05.
    """
    if not data.courses:
        return []
    spacing = min(float(np.median(np.diff(course.distance))) for course in data.courses)
    longest = max(float(course.distance[-1]) for course in data.courses)
    scatter = max(course.scatter for course in data.courses)
    most = min(max(AT_LEAST, SCATTERS * scatter), LARGEST)
    apart = min(max(APART, SCATTERS * data.between), LARGEST)
    assumed = {
        "noise.deviation": f"log-uniform 0.001 .. {most:.4g}",
        "noise.length": f"log-uniform {0.2 * spacing!r} .. {longest!r} mm",
        "noise.repeat": f"log-uniform 0.001 .. {apart:.4g}",
    }
    if len(data.courses) < 2:
        if "noise.repeat" in priors:
            raise InputError("noise.repeat needs two or more courses: one test does not show it")
        del assumed["noise.repeat"]
    unknowns = []
    for key, text in assumed.items():
        unit = "mm" if key == "noise.length" else ""
        prior = _in_unit(_read(priors.get(key) or text, key), unit, key)
        unknowns.append(_within_allowed(Unknown(key, prior, unit, assumed=priors.get(key) is None)))
    return unknowns


def _unknown(study: Study, key: str, text: str | None) -> Unknown:
    """Read the unknown of a key. text: its prior, None for one about the study's value. Raises InputError."""
    field, assumed = key_of(Study, key), text is None
    if field is None:
        raise InputError(no_such_key(Study, key))
    kinds = [*field.metadata, *_inside(field.annotation)]
    kind = next((part for part in kinds if isinstance(part, InUnit | Number)), None)
    wear = ArchardCoefficient in [getattr(part, "__origin__", part) for part in kinds]
    if kind is None and not wear:
        raise InputError(f"'{key}' cannot be an unknown: it is no number")
    unit = study.wear.unit if wear else getattr(kind, "unit", "")
    allowed = Range(or_equal=True) if kind is None else kind.range
    own = number_of(study, key)
    if own is None and key == f"friction.{STRENGTH}" and text is None:
        text = _strength(study)
    prior = _about(key, own, unit) if text is None else _in_unit(_read(text, key), unit, key)
    return _within_allowed(Unknown(key, prior, unit, allowed.least, allowed.most, assumed=assumed))


def _strength(study: Study) -> str | None:
    """Write a prior of a shear strength that a coefficient stands for, None where nothing bounds it.

    It goes from what all of the field would need to beyond that of the hardness, H/(3√3).
    """
    hardness, sides, cof = study.pair.indentation_hardness, study.grid.sides, study.friction.coefficient
    if cof is None or not math.isfinite(hardness) or not math.isfinite(math.prod(sides)):
        return None
    low, high = cof * study.contact.load / math.prod(sides), FACTOR * hardness / (3.0 * math.sqrt(3.0))
    return f"log-uniform {low:.3g} .. {high:.3g} MPa" if low < high else None


def _inside(annotation: Any) -> list[Any]:
    """List an annotation and all that it is made of."""
    parts = [part for arg in getattr(annotation, "__args__", ()) for part in _inside(arg)]
    return [annotation, *getattr(annotation, "__metadata__", ()), *parts]


def number_of(study: Study, key: str) -> float | None:
    """Return the study's number of a key in its unit, None where it has none."""
    value = attribute_of(study, key)
    if isinstance(value, ArchardCoefficient):
        return 1.0e3 * value.resolved(study.pair.wear_hardness) if value.dimensionless else value.value
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None


def _about(key: str, value: float | None, unit: str) -> Distribution:
    """Return the prior of an unknown for which none is given."""
    if key == "friction.ploughing":
        return Distribution("uniform", 0.0, PLOUGHING)
    if value is None or value <= 0.0:
        raise InputError(
            f"{key} needs a prior: the study has no value of it that is a positive number; such as "
            f"'{key}=log-uniform 1 .. 10{' ' + unit if unit else ''}'"
        )
    return Distribution("log-uniform", value / FACTOR, value * FACTOR, unit=unit)


def _read(text: str, key: str) -> Distribution:
    """Read a prior. Raises InputError."""
    with reworded({"sweep.vary": "the prior of"}):
        return distribution(text, key)


def _in_unit(prior: Distribution, unit: str, key: str) -> Distribution:
    """Return a prior in the unit of its key. Raises InputError for another kind of unit."""
    if not unit:
        if prior.unit:
            raise InputError(f"the prior of '{key}' is in {prior.unit}: allowed is a number without a unit")
        return prior
    if not prior.unit:
        raise InputError(f"the prior of '{key}' needs its unit, such as {unit}")
    try:
        wears = unit in (ArchardCoefficient.unit, energy := ArchardCoefficient.of_energy)
        if wears and ArchardCoefficient.read(f"1 {prior.unit}").per_energy != (unit == energy):
            raise ValueError(f"does not go with the study's wear.law: {EXAMPLES[unit]} is expected")
        factor = parse(f"1 {prior.unit}", unit)
    except ValueError as error:
        raise InputError(f"the prior of '{key}' has the unit {prior.unit}: it {error}") from None
    cut = None if prior.within is None else (factor * prior.within[0], factor * prior.within[1])
    return replace(prior, first=factor * prior.first, second=factor * prior.second, within=cut, unit=unit)


def _within_allowed(unknown: Unknown) -> Unknown:
    """Cut a prior off where its key ends. Raises InputError for one that lies beyond."""
    prior, least, most = unknown.prior, unknown.least, unknown.most
    ends = prior.within if prior.kind.endswith("normal") else (prior.first, prior.second)
    if ends is None and prior.kind == "normal":
        beyond = 0.5 * math.erfc((prior.first - least) / (math.sqrt(2.0) * prior.second))
        if math.isfinite(most):
            beyond += 0.5 * math.erfc((most - prior.first) / (math.sqrt(2.0) * prior.second))
        if beyond < NEGLIGIBLE:
            return unknown
        if beyond < 0.5:
            far = prior.first + 10.0 * prior.second
            return replace(unknown, prior=replace(prior, within=(least, min(most, far))))
        ends = (-math.inf, math.inf)
    if ends is not None and (ends[0] < least or ends[1] > most):
        upper = f"to {most:g}" if math.isfinite(most) else "up"
        raise InputError(
            f"the prior of '{unknown.key}', {unknown.prior}, goes beyond what is allowed: from {least:g} "
            f"{upper} {unknown.unit}".rstrip()
        )
    return unknown
