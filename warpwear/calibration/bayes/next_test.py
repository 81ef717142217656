"""The next test: of several, the one from which an unknown is expected to become best known.

Every candidate is a study with other keys, or the same one again. What it would measure, with the
uncertainties of this test, adds information; the variance of the unknown itself that is left is averaged over
the posterior, for one more test and for many.
"""

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpwear.calibration.bayes.data import Data
from warpwear.calibration.bayes.identify import STEP, information, some_of
from warpwear.calibration.bayes.likelihood import Posterior
from warpwear.calibration.bayes.model import ForwardModel
from warpwear.calibration.bayes.sampler import spread_of
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.study.study import Study

#: Places of the posterior over which the variance is averaged.
PLACES = 48
#: Most repeats that are looked at, and the part of an unknown that they should reach.
MOST_REPEATS, REACHED = 100, 0.10
#: Keys that tests may differ in, beside the number of repeats.
ALLOWED = ("contact.load", "sliding.distance", "counter.radius")


@dataclass(frozen=True, eq=False)
class Candidate:
    """A test that could be made: changes of the study, how often, and its model; None for that of the test.

    extent: the field [mm] that holds its scar, where that of the test is too small. now, expected: the
    relative standard uncertainty of the target, and what this test would leave of it.
    """

    changes: Mapping[str, Any]
    repeats: int = 1
    model: ForwardModel | None = None
    extent: float | None = None
    now: float = math.nan
    expected: float = math.nan

    @property
    def label(self) -> str:
        """Describe the test in words."""
        test = ", ".join(f"{key} {value}" for key, value in self.changes.items()) or "the same test again"
        test += "" if self.extent is None else f" (grid.extent {self.extent:.4g} mm)"
        return test if self.repeats == 1 else f"{test}, {self.repeats} times"


def candidates_of(study: Study, texts: Sequence[str], *, cheap: bool) -> list[Candidate]:
    """Read candidates such as "contact.load=16 N, repeats=3"; without any, a few likely ones.

    cheap: whether another load or radius costs one run, and not a design. Raises InputError.
    """
    if texts:
        return [_candidate(text) for text in texts]
    likely = [{"contact.load": f"{factor * study.contact.load:g} N"} for factor in (0.5, 2.0)]
    likely.append({"sliding.distance": f"{0.25 * study.sliding.total:g} mm"})
    return [Candidate({}), Candidate({}, 3), *(Candidate(changes) for changes in likely if cheap)]


def _candidate(text: str) -> Candidate:
    """Read one candidate. Raises InputError."""
    changes: dict[str, Any] = {}
    repeats = 1
    for part in text.split(","):
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if key == "repeats" and value.isdecimal() and 0 < int(value) <= MOST_REPEATS:
            repeats = int(value)
        elif equals and value and key in ALLOWED:
            changes[key] = value
        else:
            raise InputError(
                f"the next test '{text}': {', '.join(ALLOWED)} and repeats with a value each are allowed, "
                "such as 'contact.load=16 N, repeats=3'"
            )
    return Candidate(changes, repeats)


def best_tests(
    posterior: Posterior, values: Mapping[str, FloatArray], target: str, candidates: Sequence[Candidate]
) -> list[Candidate]:
    """Rank tests by the uncertainty of an unknown that they leave, the best first.

    values: samples of the posterior. Raises InputError.
    """
    now, some = _relative(values[target]), some_of(values, PLACES)
    known, slopes = information(posterior, some), _slopes(posterior, some, target)
    tests = []
    for candidate in candidates:
        part = _left(known, candidate.repeats * information(_after(posterior, candidate), some), slopes)
        tests.append(replace(candidate, now=now, expected=now * part))
    return sorted(tests, key=lambda test: test.expected)


def repeats_needed(posterior: Posterior, values: Mapping[str, FloatArray], target: str) -> int | None:
    """Return how many more tests like this one bring an unknown to ± 10 %, None where none do."""
    now, some = _relative(values[target]), some_of(values, PLACES)
    known, slopes = information(posterior, some), _slopes(posterior, some, target)
    every = range(MOST_REPEATS + 1)
    reached = bisect_left(every, True, key=lambda n: now * _left(known, n * known, slopes) <= REACHED)
    return reached if reached in every else None


def _relative(column: FloatArray) -> float:
    """Return the relative standard uncertainty of samples."""
    middle, half, _ = spread_of(column)
    return half / abs(middle)


def place_of(posterior: Posterior, target: str) -> int:
    """Return the place of an unknown among those of the model. Raises InputError."""
    keys = [unknown.key for unknown in posterior.model.unknowns]
    if target not in keys:
        raise InputError(f"'{target}' is no unknown, so no test is sought for it; allowed: {', '.join(keys)}")
    return keys.index(target)


def _slopes(posterior: Posterior, values: Mapping[str, FloatArray], target: str) -> FloatArray:
    """Return slopes of an unknown over the standard normal numbers of all, (samples, unknowns)."""
    place = place_of(posterior, target)
    unknown = posterior.model.unknowns[place]
    z, slopes = unknown.normal(values[target]), np.zeros((values[target].size, len(posterior.model.unknowns)))
    slopes[:, place] = (unknown.values(z + STEP) - unknown.values(z - STEP)) / (2.0 * STEP)
    return slopes


def _left(known: FloatArray, added: FloatArray, slopes: FloatArray) -> float:
    """Return the part of a standard uncertainty that added information leaves, by the mean variance.

    known: information of the data so far, added: of more, both (samples, unknowns, unknowns); the prior's is
    one. slopes: of the unknown, (samples, unknowns).
    """
    prior = np.eye(known.shape[1])
    both = (np.linalg.inv(prior + known), np.linalg.inv(prior + known + added))
    before, after = (np.einsum("si,sij,sj->s", slopes, covariance, slopes).mean() for covariance in both)
    return float(np.sqrt(after / before))


def _after(posterior: Posterior, candidate: Candidate) -> Posterior:
    """Return what a candidate would measure: as this test, over its own distance."""
    if candidate.model is None:
        return posterior
    scale = candidate.model.study.sliding.total / posterior.model.study.sliding.total
    data = posterior.data
    courses = tuple(replace(course, distance=scale * course.distance) for course in data.courses)
    points = tuple(replace(point, at=scale * (point.at or 0.0)) for point in data.points)
    return Posterior(candidate.model, posterior.noise, Data(courses, points, data.values))
