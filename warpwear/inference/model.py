"""What a test would measure, for many values of the unknowns at once.

Friction is linear in its strengths: μ = μ_p + τ0 A/F (thesis eqs 4.18 to 4.20), with a film μ_p + Σ τ_i
A_i/F. Where results only scale, area and scar are those of one run at the distance that wears as much: (K_s +
K_d) L.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.inference.data import KINDS
from warpwear.inference.emulator import Emulator
from warpwear.inference.runs import Runs
from warpwear.inference.unknowns import Unknown
from warpwear.laws.archard import WearLaw
from warpwear.study.study import Study

#: Error between runs from which an emulator is refused, as a part of what it gives.
WORST = 0.10
#: Rounding of a scar's two ends to whole cells, as a part of a cell: each is even over a cell.
ROUNDING = 1.0 / math.sqrt(6.0)
#: Distance at which a course of a run begins to be looked up, where nothing has worn yet.
SMALLEST = 1e-300

Values = Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class Friction:
    """A coefficient of friction is a sum of terms: key of the strength -> its factor (samples, points).

    errors: the standard deviations of what the emulator adds, (samples, sources, points), for the given
    strengths. scatter: those of what is on its own at every point, (samples, points): areas are of whole
    cells.
    """

    terms: dict[str, FloatArray]
    errors: FloatArray
    scatter: FloatArray


@dataclass(eq=False)
class Model:
    """What a study's test would measure, over its unknowns.

    study: of the test. unknowns: of the model, without those of the scatter. Raises InputError for an
    emulator that is too far off between its runs.
    """

    study: Study
    unknowns: tuple[Unknown, ...]
    runs: Runs
    kinds: frozenset[str] = frozenset()
    _courses: dict[str, tuple[FloatArray, Emulator]] = field(init=False)
    _ends: dict[str, Emulator] = field(init=False)

    def __post_init__(self) -> None:
        area = f"area_{self.study.friction.area}"
        self._courses, self._ends = {}, {}
        distance, size, scatter = self.runs.smooth(area)
        if self.study.friction.film is None:
            self._courses["friction.shear_strength"] = self._emulated(distance, size, "area", scatter)
        else:
            bare = self.runs.course("bare_fraction")[1]
            self._courses["friction.shear_strength"] = self._emulated(
                distance, size * bare, "bare area", scatter
            )
            self._courses["friction.film.shear_strength"] = self._emulated(
                distance, size * (1.0 - bare), "area under a film", scatter
            )
        if "diameter" in self.kinds:
            distance, along = self.runs.course("patch_along")
            patch = 0.5 * (along + self.runs.course("patch_across")[1])
            if self.runs.scaled:
                self._courses["diameter"] = self._emulated(
                    distance, np.array([_without_stairs(line) for line in patch]), "scar"
                )
            else:
                self._ends["diameter"] = self._end(patch[:, -1], "scar")
        for kind in self.kinds & {"sq_sphere", "sq_disc"}:
            assert self.runs.roughness is not None
            self._ends[kind] = self._end(self.runs.roughness[:, int(kind == "sq_disc")], KINDS[kind][1])
        if not self.runs.scaled:
            for body in ("sphere", "disc"):
                column = f"wear_volume_{body} [mm^3]"
                self._ends[f"volume_{body}"] = self._end(
                    np.array([row.ends[column] for row in self.runs.rows]), "volume"
                )

    @property
    def error(self) -> float:
        """Largest error of the emulators between runs, as a part of what they give; 0 without one."""
        found = [emulator.error for _, emulator in self._courses.values()] + [
            e.error for e in self._ends.values()
        ]
        return max(found)

    @property
    def scatter(self) -> float:
        """Largest scatter of areas about what is computed, as a part of them."""
        found = [e.scatter for key, (_, e) in self._courses.items() if key.startswith("friction.")]
        return max(float(scatter.max()) for scatter in found)

    def friction(self, values: Values, distance: FloatArray) -> Friction:
        """Return the terms of the coefficient of friction. values: key -> (samples,); distance [mm],
        (points,).
        """
        count = _count(values)
        worn = self._worn(values, distance[None])
        terms = {"friction.ploughing": np.ones((count, distance.size))}
        errors = [np.zeros((count, 0, distance.size))]
        square = np.zeros((count, distance.size))
        for key, (places, emulator) in self._courses.items():
            if not key.startswith("friction."):
                continue
            area, apart, scatter = self._looked_up(places, emulator, values, worn)
            factor = (
                np.ones((1, 1))
                if key == "friction.film.shear_strength"
                else self._running_in(values, distance)
            )
            terms[key] = area * factor / self.study.contact.load
            each = self.number(values, key)[:, None] * factor / self.study.contact.load
            errors.append(apart * each[:, None])
            square += (scatter * each) ** 2
        return Friction(terms, np.concatenate(errors, axis=1), np.sqrt(square))

    def cof(self, values: Values, distance: FloatArray) -> FloatArray:
        """Return the coefficient of friction itself, (samples, points)."""
        terms = self.friction(values, distance).terms
        return np.asarray(sum(self.number(values, key)[:, None] * term for key, term in terms.items()))

    def value(self, values: Values, kind: str) -> tuple[FloatArray, FloatArray]:
        """Return a value of `KINDS` at the end of the test and its variance, both (samples,)."""
        if kind == "section":
            volume, variance = self.value(values, "volume_disc")
            stroke = self.study.sliding.stroke or math.nan
            return volume / stroke, variance / stroke**2
        end = np.full((_count(values), 1), self.study.sliding.total)
        if kind in ("volume_sphere", "volume_disc") and self.runs.scaled:
            worn = self._removal(values, kind.removeprefix("volume_"), end)[:, 0]
            return self.study.contact.load * worn, np.zeros(len(end))
        rounding = (ROUNDING * self.study.grid.cell) ** 2 if kind == "diameter" else 0.0
        if kind in self._ends:
            places, emulator = np.zeros(1), self._ends[kind]
            found, apart, scatter = self._looked_up(places, emulator, values, np.zeros((len(end), 1)))
        else:
            places, emulator = self._courses[kind]
            found, apart, scatter = self._looked_up(places, emulator, values, self._worn(values, end))
        return found[:, 0], np.sum(apart[..., 0] ** 2, axis=1) + scatter[:, 0] ** 2 + rounding

    def scar_of(self, volume: float) -> float:
        """Return the diameter [mm] of a scar at rest from which a volume [mm³] has worn off both bodies."""
        places, emulator = self._courses["diameter"]
        found = float(np.interp(math.log(volume / self.study.contact.load), np.log(places), emulator.mean))
        return math.exp(found) if emulator.logarithmic else found

    def allowed(self, values: Values) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
        """Tell where the run goes as far as these values wear, (samples,)."""
        if not self.runs.scaled:
            return np.ones(_count(values), dtype=bool)
        end = np.full((_count(values), 1), self.study.sliding.total)
        last = next(iter(self._courses.values()))[0][-1]
        return np.asarray(self._worn(values, end)[:, 0] <= last * (1.0 + 1e-9))

    def number(self, values: Values, key: str) -> FloatArray:
        """Return the values of a key that may be unknown, else of the study, (samples,); NaN where it has
        none.
        """
        return values[key] if key in values else np.full(_count(values), self._known[key])

    @cached_property
    def _laws(self) -> tuple[WearLaw, WearLaw]:
        return self.study.wear_laws

    @cached_property
    def _known(self) -> dict[str, float]:
        """Keys that may be unknown -> what the study has, NaN where it has none."""
        friction, wear = self.study.friction, self.study.wear
        known = {
            "friction.shear_strength": friction.shear_strength,
            "friction.ploughing": friction.ploughing,
            "friction.initial_ratio": friction.initial_ratio,
            "friction.running_in": friction.running_in,
            "friction.film.shear_strength": friction.film.shear_strength if friction.film else None,
            "wear.decay": wear.decay,
            "wear.running_in": wear.running_in,
        }
        return {key: math.nan if value is None else float(value) for key, value in known.items()}

    def _emulated(
        self, distance: FloatArray, courses: FloatArray, what: str, scatter: FloatArray | float = 0.0
    ) -> tuple[FloatArray, Emulator]:
        """Return the places of a course, worn depth a pressure [mm³/N] where it scales, and its emulator.

        scatter: of the runs about the courses, (points,), beside what the emulator leaves out.
        """
        places = distance * sum(self.runs.study.wear_coefficients) if self.runs.scaled else distance
        emulator = self._checked(Emulator(self.runs.places, courses), what)
        emulator.scatter = np.hypot(emulator.scatter, scatter)
        return np.maximum(places, SMALLEST), emulator

    def _end(self, values: FloatArray, what: str) -> Emulator:
        return self._checked(Emulator(self.runs.places, values[:, None]), what)

    def _checked(self, emulator: Emulator, what: str) -> Emulator:
        if not emulator.error <= WORST:
            raise InputError(
                f"between its {len(self.runs.rows)} runs the emulator of the {what} is off by "
                f"{100 * emulator.error:.0f} % "
                f"(each run predicted from the others): allowed are {100 * WORST:.0f} %; more runs "
                "(--runs) or narrower "
                "priors are needed"
            )
        return emulator

    def _looked_up(
        self, places: FloatArray, emulator: Emulator, values: Values, at: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return a course (samples, points) and its standard deviations: those that points share (samples,
        shapes, points), and those of each point on its own (samples, points).

        at: places asked for, (samples, points), or (1, points) where they are the same of all samples.
        """
        inputs = [unknown.place_of(values[unknown.key]) for unknown in self.runs.inputs]
        where = np.column_stack(inputs) if inputs else np.zeros((_count(values), 0))
        weights, variances = emulator.weights(where)
        lines = np.array([emulator.scatter, emulator.mean, *emulator.shapes])
        if places.size == 1:
            lines = lines[:, None]
        else:
            scale, asked = (
                (np.log(places), np.log(np.maximum(at, SMALLEST))) if self.runs.scaled else (places, at)
            )
            lines = np.array([np.interp(asked, scale, line) for line in lines])
        found = lines[1] + np.sum(weights.T[..., None] * lines[2:], axis=0)
        apart = np.sqrt(variances)[..., None] * lines[2:].transpose(1, 0, 2)
        if not emulator.logarithmic:
            return found, apart, np.broadcast_to(lines[0], found.shape)
        found = np.exp(found)
        return found, apart * found[:, None], lines[0] * found

    def _worn(self, values: Values, distance: FloatArray) -> FloatArray:
        """Return where a course is looked up: what a pressure has worn [mm³/N], or the distance [mm].

        distance: (1, points); the former is (samples, points).
        """
        if not self.runs.scaled:
            return distance
        return self._removal(values, "sphere", distance) + self._removal(values, "disc", distance)

    def _removal(self, values: Values, body: str, distance: FloatArray) -> FloatArray:
        """Return ∫ K dL of a body over distances (samples, points) [mm³/N]; see `laws.archard.WearLaw`."""
        law = self._laws[body == "disc"]

        def k(key: str, known: float) -> FloatArray:
            return 1e-3 * values[key][:, None] if key in values else np.full((len(distance), 1), known)

        steady = k(f"wear.{body}", law.steady)
        if self.study.wear.law == "exponential":
            decay = self.number(values, "wear.decay")[:, None]
            return steady * -np.expm1(-decay * distance) / decay
        if self.study.wear.law == "running-in":
            length = self.number(values, "wear.running_in")[:, None]
            at_first = steady
            initial = f"wear.initial_{body}"
            if initial in values or getattr(self.study.wear, f"initial_{body}") is not None:
                at_first = k(initial, law.initial or 0.0)
            return steady * distance - (at_first - steady) * length * np.expm1(-distance / length)
        return steady * distance

    def _running_in(self, values: Values, distance: FloatArray) -> FloatArray:
        """Return τ over τ0, (samples, points): 1, or the law of a shear strength that runs in."""
        ratio, length = (self.number(values, f"friction.{name}") for name in ("initial_ratio", "running_in"))
        if np.isnan(ratio[0] + length[0]):
            return np.ones((1, 1))
        return np.asarray(1.0 + (ratio[:, None] - 1.0) * np.exp(-distance / length[:, None]))


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
