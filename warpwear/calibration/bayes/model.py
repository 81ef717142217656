"""What a test would measure, for many values of the unknowns at once.

Friction and wear follow from the laws of the study. Where results only scale, area and scar are those of one
run at the distance that wears as much: (K_s + K_d) L.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from warpwear.calibration.bayes.emulator import Emulator
from warpwear.calibration.bayes.runs import Runs
from warpwear.calibration.bayes.unknowns import Unknown
from warpwear.calibration.measurements import KINDS
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.archard import BODIES, WearLaw
from warpwear.laws.friction import FrictionLaw
from warpwear.study.study import Study

#: Error between runs from which an emulator is refused, as a part of what it gives.
WORST = 0.10
#: Rounding of a scar's two ends to whole cells, as a part of a cell: each is even over a cell.
ROUNDING = 1.0 / math.sqrt(6.0)
#: Distance at which a course of a run begins to be looked up, where nothing has worn yet.
SMALLEST = 1e-300

Values = Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class FrictionTerms:
    """A coefficient of friction is a sum of terms: key of the strength -> its factor (samples, points).

    errors: the standard deviations of what the emulator adds, (samples, sources, points), for the strengths
    and their factors as they are. scatter: those of what is on its own at every point, (samples, points):
    areas are of whole cells.
    """

    terms: dict[str, FloatArray]
    errors: FloatArray
    scatter: FloatArray


@dataclass(eq=False)
class ForwardModel:
    """What a study's test would measure, over its unknowns.

    study: of the test. unknowns: of the model, without those of the scatter. Raises InputError for an
    emulator that is too far off between its runs.
    """

    study: Study
    unknowns: tuple[Unknown, ...]
    runs: Runs
    kinds: frozenset[str] = frozenset()
    _strengths: dict[str, tuple[FloatArray, Emulator]] = field(init=False, default_factory=dict)
    _values: dict[str, tuple[FloatArray, Emulator]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        law, runs = self.study.friction.law_with(), self.runs
        distance, area, scatter = runs.smooth(f"area_{law.area}")
        columns = {f"area_{law.area}": area}
        whole = len(law.strengths) <= 1
        if not whole:
            columns["bare_fraction"] = runs.course("bare_fraction")[1]
        sheared = law.sheared(columns)
        name = "area" if whole else "areas that shear by film and body"
        emulators = self._emulators([*sheared.values()], name)
        for key, emulator in zip(sheared, emulators, strict=True):
            emulator.scatter = np.hypot(emulator.scatter, scatter if whole else 0.0)
            self._strengths[key] = self._places(distance), emulator
        if "scar" in self.kinds:
            distance, along = runs.course("patch_along")
            patch = 0.5 * (along + runs.course("patch_across")[1])
            if runs.scaled:
                lines = np.array([_without_stairs(line) for line in patch])
                (emulator,) = self._emulators([lines], "scar")
                self._values["scar"] = self._places(distance), emulator
            else:
                self._values["scar"] = self._end(patch[:, -1], "scar")
        for kind in self.kinds & {"sq_counter", "sq_disc"}:
            assert runs.roughness is not None
            self._values[kind] = self._end(runs.roughness[:, int(kind == "sq_disc")], KINDS[kind][1])
        for body in () if runs.scaled else BODIES:
            volumes = np.array([row.ends[f"wear_volume_{body} [mm^3]"] for row in runs.rows])
            self._values[f"volume_{body}"] = self._end(volumes, "volume")

    @property
    def error(self) -> float:
        """Largest error of the emulators between runs, as a part of what they give; 0 without one."""
        return max((emulator.error for _, emulator in (self._strengths | self._values).values()), default=0.0)

    @property
    def scatter(self) -> float:
        """Largest scatter of areas about what is computed, as a part of them."""
        scatters = (float(emulator.scatter.max()) for _, emulator in self._strengths.values())
        return max(scatters, default=0.0)

    def friction(self, values: Values, distance: FloatArray) -> FrictionTerms:
        """Return the terms of the coefficient of friction at distances [mm], (points,).

        values: key -> (samples,).
        """
        count, load = _count(values), self.study.contact.load
        law = self.study.friction_law_with(_columns(values))
        worn = self._worn(values, distance[None])
        areas = {key: self._looked_up(*course, values, worn) for key, course in self._strengths.items()}
        area = np.sum([area for area, _, _ in areas.values()], axis=0)
        history = columns_for(law, load, distance[None], area) if areas else {"distance": distance[None]}
        terms = {
            f"friction.{key}": np.broadcast_to(term, (count, distance.size))
            for key, term in law.terms(history).items()
        }
        errors: FloatArray = np.zeros((count, 0, distance.size))
        square = np.zeros((count, distance.size))
        for key, (area, apart, scatter) in areas.items():
            name, factor = f"friction.{key}", law.factor(history, key)
            terms[name] = area * factor / load
            each = self.number(values, name)[:, None] * factor / load
            errors = (errors if errors.size else 0.0) + apart * each[:, None]  # of the same runs: shared
            square += (scatter * each) ** 2
        return FrictionTerms(terms, errors, np.sqrt(square))

    def cof(self, values: Values, distance: FloatArray) -> FloatArray:
        """Return the coefficient of friction itself, (samples, points)."""
        terms = self.friction(values, distance).terms
        return np.asarray(sum(self.number(values, key)[:, None] * term for key, term in terms.items()))

    def value(self, values: Values, kind: str) -> tuple[FloatArray, FloatArray]:
        """Return a value of `KINDS` at the end of the test and its variance, both (samples,)."""
        if kind == "section":
            volume, variance = self.value(values, "volume_disc")
            length = self.study.sliding.lap or math.nan
            return volume / length, variance / length**2
        end = np.full((_count(values), 1), self.study.sliding.total)
        if kind not in self._values:  # a volume, where results scale
            law = self._wear_laws(values)[BODIES.index(kind.removeprefix("volume_"))]
            worn = law.wear_per_pressure(0.0, end)[:, 0]
            return self.study.contact.load * worn, np.zeros(len(end))
        rounding = (ROUNDING * self.study.grid.cell) ** 2 if kind == "scar" else 0.0
        mean, apart, scatter = self._looked_up(*self._values[kind], values, self._worn(values, end))
        return mean[:, 0], np.sum(apart[..., 0] ** 2, axis=1) + scatter[:, 0] ** 2 + rounding

    def scar_of(self, volume: float) -> float:
        """Return the diameter [mm] of a scar at rest from which a volume [mm³] has worn off both bodies."""
        places, emulator = self._values["scar"]
        size = float(np.interp(math.log(volume / self.study.contact.load), np.log(places), emulator.mean))
        return math.exp(size) if emulator.logarithmic else size

    def allowed(self, values: Values) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
        """Tell where the run goes as far as these values wear, (samples,)."""
        if not self.runs.scaled:
            return np.ones(_count(values), dtype=bool)
        end = np.full((_count(values), 1), self.study.sliding.total)
        last = min((places[-1] for places, _ in (self._strengths | self._values).values()), default=math.inf)
        return np.asarray(self._worn(values, end)[:, 0] <= last * (1.0 + 1e-9))

    def number(self, values: Values, key: str) -> FloatArray:
        """Return the values of a key of friction, unknown or as the study has it, (samples,); or NaN."""
        own = self.study.friction.law_with().values[key.removeprefix("friction.")]
        return values.get(key, np.full(_count(values), math.nan if own is None else own))

    def _wear_laws(self, values: Values) -> tuple[WearLaw, WearLaw]:
        """Return the laws of wear, whose numbers that are unknown have the shape (samples, 1)."""
        study = self.study
        return study.wear.laws(study.pair.wear_hardness, study.friction, _columns(values))

    def _places(self, distance: FloatArray) -> FloatArray:
        """Return the places of a course: worn depth a pressure [mm³/N] where it scales, or its distances."""
        places = distance * sum(self.runs.study.wear_coefficients) if self.runs.scaled else distance
        return np.maximum(places, SMALLEST)

    def _end(self, values: FloatArray, name: str) -> tuple[FloatArray, Emulator]:
        """Return a single place, and the emulator of values at the end of every run, (runs,)."""
        (emulator,) = self._emulators([values[:, None]], name)
        return np.zeros(1), emulator

    def _emulators(self, courses: Sequence[FloatArray], name: str) -> list[Emulator]:
        """Return the emulators of courses, each (runs, points). Raises InputError if they are too far off."""
        if not courses:
            return []
        emulators = Emulator.together(self.runs.places, courses)
        emulator = emulators[0]
        if not emulator.error <= WORST:
            raise InputError(
                f"between its {len(self.runs.rows)} runs the emulator of the {name} is off by "
                f"{100 * emulator.error:.0f} % (each run predicted from the others): allowed are "
                f"{100 * WORST:.0f} %; more runs (--runs), narrower priors or, where surfaces scatter, a "
                "longer track are needed"
            )
        return emulators

    def _looked_up(
        self, places: FloatArray, emulator: Emulator, values: Values, at: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return a course (samples, points) and its standard deviations, shared and of each point alone.

        The shared ones are (samples, shapes, points), the others (samples, points). at: where the course is
        looked up, (samples, points), or (1, points) where that is the same of all samples.
        """
        inputs = [unknown.place_of(values[unknown.key]) for unknown in self.runs.inputs]
        where = np.column_stack(inputs) if inputs else np.zeros((_count(values), 0))
        weights, variances = emulator.weights(where)
        lines = np.array([emulator.scatter, emulator.mean, *emulator.shapes])
        if places.size == 1:
            lines = lines[:, None]
        else:
            if self.runs.scaled:
                places, at = np.log(places), np.log(np.maximum(at, SMALLEST))
            lines = np.array([np.interp(at, places, line) for line in lines])
        mean = lines[1] + np.sum(weights.T[..., None] * lines[2:], axis=0)
        apart = np.sqrt(variances)[..., None] * lines[2:].transpose(1, 0, 2)
        if not emulator.logarithmic:
            return mean, apart, np.broadcast_to(lines[0], mean.shape)
        mean = np.exp(mean)
        return mean, apart * mean[:, None], lines[0] * mean

    def _worn(self, values: Values, distance: FloatArray) -> FloatArray:
        """Return where a course is looked up: what a pressure has worn [mm³/N], or the distance [mm].

        distance: (1, points), or (samples, 1); the former is (samples, points).
        """
        if not self.runs.scaled:
            return distance
        counter, disc = self._wear_laws(values)
        return counter.wear_per_pressure(0.0, distance) + disc.wear_per_pressure(0.0, distance)


def columns_for(
    law: FrictionLaw, load: float, distance: FloatArray, area: FloatArray
) -> dict[str, FloatArray]:
    """Return the columns of a history that a factor of the shear strength may read here."""
    columns = {"distance": distance, f"area_{law.area}": area}
    return columns | ({"pressure_mean": load / area} if law.area == "contact" else {})


def _columns(values: Values) -> dict[str, FloatArray]:
    """Return samples as columns, (samples, 1), that broadcast with points."""
    return {key: column[:, None] for key, column in values.items()}


def _count(values: Values) -> int:
    return len(next(iter(values.values())))


def _without_stairs(values: FloatArray) -> FloatArray:
    """Return a course that rises by whole cells without stairs: straight through the middle of each rise."""
    rises = np.flatnonzero(np.diff(values) > 0.0) + 1
    if rises.size < 2:
        return values
    places = np.arange(values.size)
    middles = 0.5 * (values[rises - 1] + values[rises])
    knots = np.concatenate([[0], rises - 0.5, [values.size - 1]])  # a rise is between two places
    return np.interp(places, knots, np.concatenate([values[:1], middles, values[-1:]]))
