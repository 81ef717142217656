"""Fit friction of three states, `warpwear.laws.states`, to courses of one pair, with errors.

A course is linear in four constants. Of the other three the wait ln(r/e)/r stands for the seed e, and the
rates are fitted as logarithms. Courses share what belongs to the pair: r and the friction of bare metal.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

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
#: Gives shares by which a film is lost, which fits cannot tell apart: see `spreading` and `scattered`.
Kinetics = Callable[[FloatArray, float, float, float], Shares]
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
#: What follows from them, those of a count, those that a course may not tell, and what they are for people.
NUMBERS = ("metal", "film", "slope", "cover", "spread", "seed", "cover_rate", "wait", "width", "overshoot")
PER, UNTOLD = ("slope", "spread", "seed", "cover_rate"), ("metal", "spread", "cover_rate")
WORDS = {"metal": "bare metal", "cover": "cover, level", "cover_rate": "cover rate", "wait": "wait N50"}


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

    @cached_property
    def numbers(self) -> dict[str, tuple[float, float]]:
        """Map `NUMBERS` to values and errors: wait is N50, width from 10 to 90 % of the load without film."""
        slopes = _slopes(self._numbers, self.values)
        errors = np.sqrt(np.einsum("ij,jk,ik->i", slopes, self.covariance, slopes))
        pairs = zip(self._numbers(self.values).tolist(), errors.tolist(), strict=True)
        return dict(zip(NUMBERS, pairs, strict=True))

    def _numbers(self, values: FloatArray) -> FloatArray:
        spread, wait, cover_rate = math.exp(values[4]), values[5], math.exp(values[6])
        rates = spread, spread * math.exp(-spread * wait), cover_rate
        over = _course(np.linspace(0.0, self.count[-1], 1000), values, spreading).max() - values[3]
        return np.array([*values[:4], *rates, *wait_and_width(**_of_spreading(spread, wait)), over])


def fit_states(courses: Sequence[LapMeans]) -> list[StatesFit]:
    """Fit courses of one pair at once by least squares. Raises InputError for one that is too short."""
    lengths = [course.length / course.laps if course.laps else 1.0 for course in courses]
    data = [(one.distance / length, one.cof) for one, length in zip(courses, lengths, strict=True)]
    for course in courses:
        if course.cof.size < FEWEST:
            raise InputError(f"the course has {course.cof.size} means: at least {FEWEST} are needed")
    found = zip(courses, lengths, data, _fit(data, spreading), _fit(data, scattered), strict=True)
    return [
        StatesFit(course.unit if course.laps else "mm", length, *means, values, covariance, rms, other[2])
        for course, length, means, (values, covariance, rms), other in found
    ]


def part_of(course: Experiment, lap: float | None, until: float | None = None) -> LapMeans:
    """Return the means of laps that a course is fitted over. until: end [mm]; by default `SPAN` says it."""
    if until is None:
        jump = events_of(laps_of(course, lap)).jump
        if jump is None:
            raise InputError(f"{course.name} has no jump: give --until, how far it is fitted, such as '3 m'")
        until = SPAN * jump.end
    used = course.distance <= until
    numbers = None if course.cycles is None else course.cycles[used]
    if np.count_nonzero(used) < FEWEST:
        raise InputError(f"{course.name} has too few points up to {until:g} mm: {FEWEST} are needed")
    part = replace(course, distance=course.distance[used], cof=course.cof[used], cycles=numbers)
    return laps_of(part, lap)


def spreading(count: FloatArray, rate: float, wait: float, cover_rate: float) -> Shares:
    """Return the shares where bare metal makes more, at a rate, and a film lasts ln(r/e)/r."""
    return shares(count, **_of_spreading(rate, wait), cover_rate=cover_rate)


def scattered(count: FloatArray, rate: float, wait: float, cover_rate: float) -> Shares:
    """Return the shares where lives of a film scatter normally about a wait; rate: of as wide a spreading."""
    deviation = LOGISTIC / NORMAL / rate
    place, turn = (count - wait) / deviation, cover_rate * deviation
    metal = np.exp(0.5 * turn**2 - turn * place + special.log_ndtr(place - turn))
    return Shares(special.ndtr(-place), metal, special.ndtr(place) - metal)


def _of_spreading(spread: float, wait: float) -> dict[str, float]:
    return {"rate": spread * (1.0 + math.exp(-spread * wait)), "middle": spread * wait}


def _columns(count: FloatArray, shape: FloatArray, kinetics: Kinetics) -> FloatArray:
    """Return what a course is linear in, (means, 4). shape: the other values."""
    own = kinetics(count, math.exp(shape[0]), shape[1], math.exp(shape[2]))
    return np.column_stack([own.metal, own.filmed, own.filmed * count, own.covered])


def _course_of(count: FloatArray, linear: FloatArray, kinetics: Kinetics, shape: FloatArray) -> FloatArray:
    return np.asarray((_columns(count, shape, kinetics) * linear).sum(axis=1))


def _course(count: FloatArray, values: FloatArray, kinetics: Kinetics) -> FloatArray:
    return _course_of(count, values[:4], kinetics, values[4:])


def _slopes(function: Callable[[FloatArray], FloatArray], at: FloatArray) -> FloatArray:
    """Return the derivatives of a function's values, (values, unknowns)."""
    steps = np.diag(1e-5 * np.maximum(np.abs(at), 1e-2))
    return np.column_stack([(function(at + s) - function(at - s)) / (2.0 * s.max()) for s in steps])


def _fit(data: Sequence[Course], kinetics: Kinetics) -> list[tuple[FloatArray, FloatArray, float]]:
    """Return values of `FITTED`, their covariance and the rms of each course; of several at once."""
    shared, every = len(SHARED), len(FITTED)
    own = [place for place in range(every) if place not in SHARED]
    places = np.zeros((len(data), every), dtype=np.intp)
    places[:, SHARED] = range(shared)
    places[:, own] = shared + np.arange(len(data) * len(own)).reshape(-1, len(own))
    pairs = [(place, *one) for place, one in zip(places, data, strict=True)]
    low, high = np.full((2, places.max() + 1), [[-np.inf], [np.inf]])
    for place, count, _ in pairs:
        span, gap = count[-1], count[1] - count[0]
        low[place[4:]] = math.log(1.0 / span), 0.0, math.log(0.01 / span)
        high[place[4:]] = math.log(10.0 / gap), span, math.log(50.0 / gap)
    if len(data) == 1:
        starts = [start[np.argsort(places[0])] for start in _begin(*data[0], kinetics)]
    else:
        starts = [np.zeros(low.size)]
        for place, *one in pairs:
            starts[0][place] += _fit([(one[0], one[1])], kinetics)[0][0]
        starts[0][:shared] /= len(data)

    def residual(joint: FloatArray) -> FloatArray:
        return np.concatenate([_course(count, joint[place], kinetics) - cof for place, count, cof in pairs])

    def slopes(joint: FloatArray) -> FloatArray:
        blocks = [np.zeros((count.size, low.size)) for _, count, _ in pairs]
        for block, (place, count, _) in zip(blocks, pairs, strict=True):
            block[:, place[:4]] = _columns(count, joint[place[4:]], kinetics)
            course = partial(_course_of, count, joint[place[:4]], kinetics)
            block[:, place[4:]] = _slopes(course, joint[place[4:]])
        return np.concatenate(blocks)

    how: Any = {"jac": slopes, "bounds": (low, high), "x_scale": "jac"}
    tries = [
        optimize.least_squares(residual, np.clip(start, low + 1e-9, high - 1e-9), **how) for start in starts
    ]
    found = min(tries, key=lambda one: float(one.cost))
    inner, outer, left = found.jac.T @ found.jac, np.zeros((low.size, low.size)), []
    ends = np.cumsum([count.size for _, count, _ in pairs])[:-1]
    for block, off in zip(np.split(found.jac, ends), np.split(found.fun, ends), strict=True):
        tau, square = _together(off), float(off @ off)
        left.append(math.sqrt(square / off.size))
        outer += block.T @ block * square * tau / (off.size - every * tau)
    inverse = np.linalg.pinv(inner, hermitian=True)
    covariance = inverse @ outer @ inverse
    return [
        (found.x[place], covariance[np.ix_(place, place)], rms)
        for (place, *_), rms in zip(pairs, left, strict=True)
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


def untold(fit: StatesFit) -> list[str]:
    """List the constants that a course does not tell to a half."""
    return [name for name in UNTOLD if fit.numbers[name][1] > 0.5 * abs(fit.numbers[name][0])]


def states_text(fit: StatesFit) -> str:
    """Say in a line what a course does."""
    (wait, of_wait), (metal, of_metal) = fit.numbers["wait"], fit.numbers["metal"]
    if of_wait > 0.5 * wait:
        return "not told by this course"
    bare = f", bare metal {metal:.3g} ± {of_metal:.2g}" * ("metal" not in untold(fit) and metal > 0.0)
    factor, many = (1e-3, "m") if fit.unit == "mm" else (1.0, f"{fit.unit}s")
    film = f"film for {factor * wait:.4g} ± {factor * of_wait:.2g} {many}"
    return f"{film}{bare}; a fitted law, rms {fit.rms:.2g}, no prediction"


def states_rows(fit: StatesFit) -> list[Row]:
    """Declare the constants of a course, and what it does by them."""
    many = fit.unit if fit.unit == "mm" else f"{fit.unit}s"
    rows = []
    for name, (value, error) in fit.numbers.items():
        counts, key = name in ("wait", "width"), name
        note = f"a {fit.unit}" if name in PER else many if counts else ""
        key = f"{name}_{many}" if counts else name
        rows.append(
            Row(WORDS.get(name, name), key, value, 4, note, error, "" if counts else None, name == "seed")
        )
    wide = [fit.millimetres * number for number in fit.numbers["width"]]
    hardly = [f"the course hardly tells {name}: ± half of it or more" for name in untold(fit)]
    either = f"; {fit.rms_scattered:.2g} if films' lives scatter normally: this does not tell which"
    return [
        *rows,
        Row("  or", "width_mm", wide[0], error=wide[1]),
        Row("rms", "rms", fit.rms, digits=2, note=either),
        Row("", "rms_scattered", fit.rms_scattered),
        Row("means", "means", fit.cof.size, note=f"up to {fit.millimetres * fit.count[-1]:.4g} mm"),
        Row("warning", "untold", hardly),
        Row("", "covariance", fit.covariance.tolist()),
        Row("", "values", dict(zip(FITTED, fit.values.tolist(), strict=True))),
    ]
