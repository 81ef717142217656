"""Fit friction of three states, `warpwear.laws.states`, to courses of one pair, with errors.

A course is linear in four constants. Of the other three the wait ln(r/e)/r stands for the seed e, and the
rates are fitted as logarithms. Courses share what belongs to the pair: r and the friction of bare metal.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.states import Shares, shares, wait_and_width
from warpwear.measured.experiment import Experiment
from warpwear.measured.friction.events import LapMeans, events_of, laps_of
from warpwear.results.report import Row

optimize = lazy.module("scipy.optimize")
special = lazy.module("scipy.special")

#: A count of laps or mm (means,), and the friction of each.
Course = tuple[FloatArray, FloatArray]
#: A film is lost by bare metal beside it, or after lives that scatter normally: fits cannot tell these apart.
Kinetics = Literal["spreading", "scattered"]
#: What is fitted of a course; what it is linear in comes first.
FITTED = ("metal", "film", "slope", "cover", "ln spread", "wait", "ln cover_rate")
#: Places in it of what courses of one pair share.
SHARED = (0, 4)
#: What is fitted of a record ends at this many times the end of its jump: later steps are other events.
SPAN = 3.0
#: Fewest means of a course, and ratios of k to r that a search begins with.
FEWEST, RATIOS = 20, (0.5, 3.0)
#: From 10 to 90 % of a logistic rise of rate 1, and of a normal one of deviation 1.
LOGISTIC, NORMAL = math.log(81.0), 2.5631031310892007
#: Fewest independent means of a course, three a constant.
INDEPENDENT = 3.0 * len(FITTED)
#: Part of a constant that its error may be, or the course does not tell it.
TOLD = 0.5


@dataclass(frozen=True, eq=False)
class StatesFit:
    """A course has these constants.

    unit: what N counts, "lap", "cycle" or "mm", each of so many `millimetres`. count, cof: the course,
    (means,). values: of `FITTED`, covariance theirs, (7, 7), with noise that goes together counted. rms: of
    the residuals, and rms_scattered where films' lives scatter normally.
    """

    unit: str
    millimetres: float
    count: FloatArray
    cof: FloatArray
    values: FloatArray
    covariance: FloatArray
    rms: float
    rms_scattered: float

    @property
    def constants(self) -> dict[str, tuple[float, float]]:
        """Map the keys of [friction.states] to their values and errors."""
        return self._with_errors(
            ("metal", "film", "slope", "cover", "spread", "cover_rate", "seed"), _constants
        )

    @property
    def events(self) -> dict[str, tuple[float, float]]:
        """Map wait (N50), width (10 to 90 %), overshoot and level to their values and errors."""
        return self._with_errors(("wait", "width", "overshoot", "level"), self._events)

    @property
    def untold(self) -> list[str]:
        """List the constants that the course does not tell."""
        told = {name: error <= TOLD * abs(value) for name, (value, error) in self.constants.items()}
        return [name for name in ("metal", "spread", "cover_rate") if not told[name]]

    def _with_errors(
        self, names: Sequence[str], function: Callable[[FloatArray], FloatArray]
    ) -> dict[str, tuple[float, float]]:
        slopes = _slopes(function, self.values)
        errors = np.sqrt(np.einsum("ij,jk,ik->i", slopes, self.covariance, slopes))
        pairs = zip(function(self.values).tolist(), errors.tolist(), strict=True)
        return dict(zip(names, pairs, strict=True))

    def _events(self, values: FloatArray) -> FloatArray:
        places = np.linspace(0.0, self.count[-1], 1000)
        peak = _course(places, values[:4], values[4:], kinetics="spreading").max()
        spreading = _spreading(math.exp(values[4]), values[5])
        return np.array([*wait_and_width(**spreading), peak - values[3], values[3]])


def fit_states(courses: Sequence[LapMeans]) -> list[StatesFit]:
    """Fit courses of one pair at once by least squares. Raises InputError for one that does not rise."""
    lengths = [course.length / course.laps if course.laps else 1.0 for course in courses]
    data = [(one.distance / length, one.cof) for one, length in zip(courses, lengths, strict=True)]
    fits = [_fit(data, kinetics) for kinetics in ("spreading", "scattered")]
    return [
        StatesFit(course.unit if course.laps else "mm", length, *each, values, covariance, rms, other[2])
        for course, length, each, (values, covariance, rms), other in zip(
            courses, lengths, data, *fits, strict=True
        )
    ]


def part_of(course: Experiment, lap: float | None, until: float | None = None) -> LapMeans:
    """Return the means of laps that a course is fitted over. until: end [mm]; by default `SPAN` says it."""
    if until is None:
        jump = events_of(laps_of(course, lap)).jump
        until = math.inf if jump is None else SPAN * jump.end
    used = course.distance <= until
    numbers = None if course.cycles is None else course.cycles[used]
    part = replace(course, distance=course.distance[used], cof=course.cof[used], cycles=numbers)
    if part.cof.size < FEWEST:
        raise InputError(f"{course.name} has {part.cof.size} points up to {until:g} mm: {FEWEST} are needed")
    return laps_of(part, lap)


def _fit(data: Sequence[Course], kinetics: Kinetics) -> list[tuple[FloatArray, FloatArray, float]]:
    """Return values of `FITTED`, their covariance and the rms of each course; of several at once."""
    shared, every = len(SHARED), len(FITTED)
    own = [place for place in range(every) if place not in SHARED]
    places = np.zeros((len(data), every), dtype=np.intp)
    places[:, SHARED] = range(shared)
    places[:, own] = shared + np.arange(len(data) * len(own)).reshape(-1, len(own))
    low, high = np.full((2, places.max() + 1), [[-np.inf], [np.inf]])
    for place, (count, _) in zip(places, data, strict=True):
        span, gap = count[-1], count[1] - count[0]
        low[place[4:]] = math.log(1.0 / span), 0.0, math.log(0.01 / span)
        high[place[4:]] = math.log(10.0 / gap), span, math.log(50.0 / gap)
    if len(data) == 1:
        starts = [start[np.argsort(places[0])] for start in _begin(*data[0], kinetics)]
    else:
        starts = [np.zeros(low.size)]
        for place, one in zip(places, data, strict=True):
            starts[0][place] += _fit([one], kinetics)[0][0]
        starts[0][:shared] /= len(data)

    def residuals(joint: FloatArray) -> list[FloatArray]:
        each = zip(places, data, strict=True)
        return [
            _course(count, joint[place[:4]], joint[place[4:]], kinetics=kinetics) - cof
            for place, (count, cof) in each
        ]

    def slopes(joint: FloatArray) -> list[FloatArray]:
        blocks = [np.zeros((cof.size, joint.size)) for _, cof in data]
        for block, place, (count, _) in zip(blocks, places, data, strict=True):
            linear, shape = joint[place[:4]], joint[place[4:]]
            block[:, place[:4]] = _columns(count, shape, kinetics)
            of_shape = partial(_course, count, linear, kinetics=kinetics)
            block[:, place[4:]] = _slopes(of_shape, shape)
        return blocks

    found = min(
        (
            optimize.least_squares(
                lambda joint: np.concatenate(residuals(joint)),
                np.clip(start, low + 1e-9, high - 1e-9),
                jac=lambda joint: np.concatenate(slopes(joint)),
                bounds=(low, high),
                x_scale="jac",
            )
            for start in starts
        ),
        key=lambda result: float(result.cost),
    )
    inner, outer = np.zeros((2, low.size, low.size))
    left = residuals(found.x)
    for block, residual in zip(slopes(found.x), left, strict=True):
        tau = _together(residual)
        inner += block.T @ block
        outer += block.T @ block * (residual @ residual) * tau / (residual.size - every * tau)
    inverse = np.linalg.pinv(inner, hermitian=True)
    covariance = inverse @ outer @ inverse
    return [
        (found.x[place], covariance[np.ix_(place, place)], float(np.sqrt(np.mean(residual**2))))
        for place, residual in zip(places, left, strict=True)
    ]


def _begin(count: FloatArray, cof: FloatArray, kinetics: Kinetics) -> list[FloatArray]:
    """Return values that a search begins with: of the rise of a running mean, and covers of some rates."""
    smooth = np.convolve(cof, np.full(5, 0.2), mode="valid")
    way = (smooth - smooth[0]) / ((smooth.max() - smooth[0]) or 1.0)
    begins, half, ends = (float(count[2:][np.argmax(way >= part)]) for part in (0.1, 0.5, 0.9))
    rate = math.log(LOGISTIC / max(ends - begins, 2.0 * (count[1] - count[0])))
    shapes = [np.array([rate, half, rate + math.log(ratio)]) for ratio in RATIOS]
    linear = (np.linalg.lstsq(_columns(count, shape, kinetics), cof, rcond=None)[0] for shape in shapes)
    return [np.concatenate(parts) for parts in zip(linear, shapes, strict=True)]


def _constants(values: FloatArray) -> FloatArray:
    """Return the law's own constants of fitted values, the seed last."""
    spread = math.exp(values[4])
    return np.array([*values[:4], spread, math.exp(values[6]), spread * math.exp(-spread * values[5])])


def _together(residual: FloatArray) -> float:
    """Return of how many residuals each stands for one: (1 + φ)/(1 − φ) by the correlation φ of neighbours.

    That is as much higher than it is computed as after a fit of a line; the other constants bend the course
    within a jump alone.
    """
    count, tau = residual.size, 1.0
    computed = float(residual[1:] @ residual[:-1]) / (float(residual @ residual) or 1.0)
    for _ in range(10):
        neighbours = min(max(computed + 2.0 * tau / count, -0.5), 0.95)
        tau = min((1.0 + neighbours) / (1.0 - neighbours), count / INDEPENDENT)
    return tau


def _spreading(spread: float, wait: float) -> dict[str, float]:
    """Return what `shares` asks for."""
    return {"rate": spread * (1.0 + math.exp(-spread * wait)), "middle": spread * wait}


def _columns(count: FloatArray, shape: FloatArray, kinetics: Kinetics) -> FloatArray:
    """Return what a course is linear in, (means, 4). shape: the other values, alike in both kinetics."""
    rate, wait, cover_rate = math.exp(shape[0]), shape[1], math.exp(shape[2])
    if kinetics == "spreading":
        own = shares(count, **_spreading(rate, wait), cover_rate=cover_rate)
    else:
        deviation = LOGISTIC / NORMAL / rate
        place, turn = (count - wait) / deviation, cover_rate * deviation
        metal = np.exp(0.5 * turn**2 - turn * place + special.log_ndtr(place - turn))
        own = Shares(special.ndtr(-place), metal, special.ndtr(place) - metal)
    return np.column_stack([own.metal, own.filmed, own.filmed * count, own.covered])


def _course(count: FloatArray, linear: FloatArray, shape: FloatArray, *, kinetics: Kinetics) -> FloatArray:
    return np.asarray((_columns(count, shape, kinetics) * linear).sum(axis=1))


def _slopes(function: Callable[[FloatArray], FloatArray], at: FloatArray) -> FloatArray:
    """Return the derivatives of a function's values, (values, unknowns)."""
    steps = np.diag(1e-5 * np.maximum(np.abs(at), 1e-2))
    return np.column_stack([(function(at + s) - function(at - s)) / (2.0 * s.max()) for s in steps])


def states_rows(fit: StatesFit) -> list[Row]:
    """Declare the constants of a course, and what it does by them."""
    per, labels = f"a {fit.unit}", {"metal": "bare metal", "spread": "spread r", "seed": "seed e"}
    many = fit.unit if fit.unit == "mm" else f"{fit.unit}s"
    rows = [
        Row(
            labels.get(name, name.replace("_", " ")),
            name,
            value,
            error=error,
            scientific=name == "seed",
            note=per * (name not in ("metal", "film", "cover")),
        )
        for name, (value, error) in fit.constants.items()
    ]
    (wait, of_wait), (width, of_width), *others = fit.events.values()
    wide = fit.millimetres * width, ("width_error_mm", fit.millimetres * of_width)
    rows += [
        Row("wait N50", f"wait_{many}", wait, error=of_wait, unit=f"{many}, half has lost its film"),
        Row("width", f"width_{many}", width, error=of_width, unit=f"{many}, from 10 to 90 % of it"),
    ]
    rows += [Row("  or", "width_mm", wide[0], error=wide[1])] * (fit.unit != "mm")
    rows += [
        Row(name, name, value, error=error)
        for name, (value, error) in zip(("overshoot", "level"), others, strict=True)
    ]
    either = f"; {fit.rms_scattered:.2g} if films' lives scatter normally: this does not tell which"
    untold = [f"the course does not tell {name}" for name in fit.untold]
    return [
        *rows,
        Row("rms", "rms", fit.rms, digits=2, note=either),
        Row("", "rms_scattered", fit.rms_scattered),
        Row("means", "means", fit.cof.size, note=f"up to {fit.millimetres * fit.count[-1]:.4g} mm"),
        Row("warning", "untold", untold),
        Row("", "fitted", list(FITTED)),
        Row("", "values", fit.values.tolist()),
        Row("", "covariance", fit.covariance.tolist()),
    ]
