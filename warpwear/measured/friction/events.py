"""Gather a course of friction in laps or cycles; find its levels, its jump and what it comes to.

The error of the latter is that by its noise.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.experiment import Experiment

ruptures = lazy.module("ruptures")
stats = lazy.module("scipy.stats")

#: Fewest points on average in a group that has a scatter; a group is of several laps where laps have fewer.
POINTS = 4
#: Most groups, which the search for changes takes a second for.
MOST = 1500
#: Groups of a course whose laps are not known.
PARTS = 400
#: Fewest groups of points in which levels are looked for, and of a level.
FEWEST, LEAST = 20, 5
#: Penalty of a change in units of σ² τ ln n: σ the scatter, τ the groups that scatter together.
PENALTY = 3.0
#: Changes by less than this part are rounding.
ROUNDING = 1e-3
#: Part of the last level that is left out of the steady value: it may still settle.
SETTLING = 1.0 / 3.0
#: A rise from 10 to 90 % within this part of the course is a jump, ...
LONGEST_JUMP = 0.2
#: ... if it is this many times the scatter high, this part of the level before, and of what levels differ by.
LEAST_JUMP, LEAST_RISE, LEAST_PART = 4.0, 0.2, 0.4
#: Groups on either side of a change whose means are compared, and of the levels that the jump is between.
BESIDE, AROUND = 5, 20
#: Standard errors above the steady value that make an overshoot.
OVER = 3.0


@dataclass(frozen=True, eq=False)
class LapMeans:
    """A course is means over groups of points, one after another.

    distance: of the groups' middles [mm]; cof: means; scatter: standard deviations within, NaN for single
    points; points: how many; all of shape (groups,). length: of a group [mm]. laps: in a group, None where it
    is not known how long one is. unit: what is counted, "lap", "cycle" or "part".
    """

    distance: FloatArray
    cof: FloatArray
    scatter: FloatArray
    points: FloatArray
    length: float
    laps: float | None
    unit: str

    def count(self, length: float) -> float | None:
        """Return how many laps or cycles a length [mm] is, None where that is not known."""
        return None if self.laps is None else self.laps * length / self.length


def laps_of(course: Experiment, lap: float | None) -> LapMeans:
    """Gather a course in laps. lap: distance of one [mm], None where it is not known."""
    distance, cof = course.distance, course.cof
    if course.cycles is not None:
        length = float(np.median(np.diff(distance) / np.diff(course.cycles)))
        return LapMeans(distance, cof, np.full(cof.size, np.nan), np.ones(cof.size), length, 1.0, "cycle")
    start, size = float(distance[0]), float(np.ptp(distance))
    if lap is None or lap > size / 2.0:
        groups = max(min(PARTS, distance.size // POINTS), 1)
        length, laps, unit = size / groups, None, "part"
    else:
        start = 0.0 if start < lap else start
        together = max(POINTS * size / (distance.size * lap), size / (lap * MOST), 1.0)
        laps = float(math.ceil(together - 1e-9))
        length, unit = laps * lap, "lap"
    group = np.floor((distance - start) / length * (1.0 - 1e-12)).astype(np.intp)
    places, which, number = np.unique(group, return_inverse=True, return_counts=True)
    means: FloatArray = (np.bincount(which, weights=cof) / number).astype(np.float64)
    squares = np.bincount(which, weights=(cof - means[which]) ** 2)
    with np.errstate(invalid="ignore", divide="ignore"):
        scatter = np.where(number > 1, np.sqrt(squares / (number - 1)), np.nan)
    whole = number >= 0.5 * np.median(number)  # the last one ends with the record
    middles: FloatArray = (start + (places + 0.5) * length).astype(np.float64)
    return LapMeans(
        middles[whole], means[whole], scatter[whole], number[whole].astype(np.float64), length, laps, unit
    )


@dataclass(frozen=True, kw_only=True)
class Steady:
    """A course comes to a value at its end, with the half widths of its bands of 68 and 95 %.

    It is the end of a straight line through a part of the course. drift: by how much the line rises over the
    part, drift_95: half the width of its band. start, end: of the part [mm]; groups: of laps in it;
    independent: how many groups scatter as much; share: part of the course that is the last level.
    """

    value: float
    error: float
    error_95: float
    drift: float
    drift_95: float
    start: float
    end: float
    groups: int
    independent: float
    share: float


@dataclass(frozen=True, kw_only=True)
class Jump:
    """A course goes up within a few laps, from one level to another.

    start, end: distances at 10 and 90 % of the way from the level before to the one after [mm]; low, high:
    the two levels.
    """

    start: float
    end: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Events:
    """What happens in a course: the distances at which its level changes [mm], a jump, what it comes to.

    overshoot: how far five groups in a row rise above the steady value between the jump and the steady part,
    None for none; overshoot_after: above the level that follows it. steady: None for a course too short.
    """

    changes: tuple[float, ...] = ()
    jump: Jump | None = None
    steady: Steady | None = None
    overshoot: float | None = None
    overshoot_after: float | None = None


def events_of(laps: LapMeans) -> Events:
    """Find what happens in a course. Raises InputError where the package ruptures is not installed."""
    cof = laps.cof
    if cof.size < FEWEST:
        return Events()
    bounds = _levels(cof)
    steady = _steady(laps, bounds[-2])
    jump, after = _jump(laps, bounds)
    first = int(np.searchsorted(laps.distance, steady.start)) if steady else cof.size
    overshoot, beyond = None, None
    if steady is not None and jump is not None:
        overshoot = _over(cof[after:first], steady.value, _scatter(cof[first:]), steady.error)
    if jump is not None:  # from twice to thrice as far as the jump's end is the level that follows
        places = np.searchsorted(laps.distance, [2.0 * jump.end, 3.0 * jump.end])
        level = cof[places[0] : places[1]]
        if level.size >= BESIDE:
            beyond = _over(cof[after : places[0]], float(np.median(level)), _scatter(level))
    changes = tuple(float(0.5 * (laps.distance[k - 1] + laps.distance[k])) for k in bounds[1:-1])
    return Events(changes=changes, jump=jump, steady=steady, overshoot=overshoot, overshoot_after=beyond)


def _over(values: FloatArray, level: float, scatter: float, error: float = 0.0) -> float | None:
    """Return how far means of groups in a row rise above a level with an error; None where they do not."""
    if values.size < BESIDE:
        return None
    over = float(np.convolve(values, np.full(BESIDE, 1.0 / BESIDE), mode="valid").max()) - level
    return over if over > OVER * math.hypot(error, scatter / math.sqrt(BESIDE)) else None


def line_with_error(values: FloatArray) -> tuple[float, float, float, float, float]:
    """Fit a straight line to values that scatter together, (n,), one after another.

    Returns the line's middle and the standard error of that, how far the line rises, the standard error of
    that, and the independent number n/τ: τ = 1 + 2 Σ ρ_k up to the first zero of the autocorrelation, each
    ρ_k 2 (1 − k/n) τ/n higher than it is computed about the line through the same values (Marriott and Pope,
    Biometrika 41, 1954, to the first order, for a line's two numbers).
    """
    count, middle = values.size, float(values.mean())
    place = np.linspace(-0.5, 0.5, count)
    square = float(place @ place)
    rise = float(place @ values) / square
    residual = values - middle - rise * place
    power = float(residual @ residual)
    if power <= 1e-18 * count * middle**2:
        return middle, 0.0, rise, 0.0, float(count)
    length = 1 << (2 * count - 1).bit_length()
    raw = np.fft.irfft(np.abs(np.fft.rfft(residual, length)) ** 2, length)[1:count] / power
    lags, tau = np.arange(1, count), 1.0
    for _ in range(6):
        correlation = raw + 2.0 * (1.0 - lags / count) * tau / count
        ends = np.flatnonzero(correlation <= 0.0)
        last = min(int(ends[0]) if ends.size else count - 1, math.ceil(5.0 * tau) + 1)
        tau = min(max(1.0 + 2.0 * float(correlation[:last].sum()), 1.0), count / 6.0)
    error = math.sqrt(power / count / (1.0 - 2.0 * tau / count) * tau / count)
    return middle, error, rise, error * math.sqrt(count / square), count / tau


def _scatter(values: FloatArray) -> float:
    """Return the standard deviation of values about a straight line through them."""
    place = np.arange(values.size, dtype=np.float64)
    return float((values - np.polyval(np.polyfit(place, values, 1), place)).std())


def _levels(cof: FloatArray) -> list[int]:
    """Return the first group of each level, 0 among them, and the number of groups at the end.

    The squared error and a penalty for each change are least together (PELT, Killick, Fearnhead and Eckley
    2012). σ² τ is the median over the quarters of the course, so that a change in one of them does not count.
    A drift comes out as stairs: from where on a straight line, at the price of one change, is no worse than
    they are, the course is one level.
    """
    quarters = np.array_split(cof, 4)
    strengths = [quarter.size * line_with_error(quarter)[1] ** 2 for quarter in quarters]
    penalty = PENALTY * float(np.median(strengths)) * math.log(cof.size)
    penalty = max(penalty, ROUNDING**2 * float(cof @ cof) / cof.size)
    try:
        search = ruptures.KernelCPD(kernel="linear", min_size=LEAST)
    except ImportError as error:
        raise InputError("the levels of a record need ruptures: pip install 'warpwear[io]'") from error
    bounds = [0, *(int(place) for place in search.fit(cof[:, None]).predict(pen=penalty))]
    squares = [(b - a) * float(cof[a:b].var()) + penalty for a, b in pairwise(bounds)]
    for number, start in enumerate(bounds[:-2]):
        straight = (cof.size - start) * _scatter(cof[start:]) ** 2
        if straight + 2.0 * penalty <= sum(squares[number:]):
            return [*bounds[: number + 1], cof.size]
    return bounds


def _steady(laps: LapMeans, level: int) -> Steady | None:
    """Return what a level comes to, by a line through it without its first third, None where it is too short.

    The level at the end is as uncertain as a line's end, twice as much as a mean: whether it drifts is not
    known. A mean of courses that do, by less than is seen, would be off by more than its error.
    """
    first = level + math.floor(SETTLING * (laps.cof.size - level))
    cof = laps.cof[first:]
    if cof.size < 2 * LEAST:
        return None
    middle, error, drift, of_drift, independent = line_with_error(cof)
    factors = (float(stats.t.ppf(share, max(independent - 2.0, 1.0))) for share in (0.8413447, 0.975))
    band, wide = (factor * math.hypot(error, 0.5 * of_drift) for factor in factors)
    return Steady(
        value=middle + 0.5 * drift,
        error=band,
        error_95=wide,
        drift=drift,
        drift_95=wide * of_drift / math.hypot(error, 0.5 * of_drift) if error else 0.0,
        start=float(laps.distance[first]) - 0.5 * laps.length,
        end=float(laps.distance[-1]) + 0.5 * laps.length,
        groups=cof.size,
        independent=independent,
        share=1.0 - level / laps.cof.size,
    )


def _jump(laps: LapMeans, bounds: list[int]) -> tuple[Jump | None, int]:
    """Return the steepest rise between levels, if it is a jump, and the group at its end."""
    cof = laps.cof
    rises = {k: cof[k : k + BESIDE].mean() - cof[max(k - BESIDE, 0) : k].mean() for k in bounds[1:-1]}
    if not rises:
        return None, 0
    k = max(rises, key=lambda bound: rises[bound])
    before, after = cof[max(0, k - BESIDE - AROUND) : max(k - BESIDE, 1)], cof[k + BESIDE : k + 3 * BESIDE]
    if not after.size:
        return None, 0
    low, high = float(np.median(before)), float(np.median(after))
    noise = max(_scatter(after) if after.size > 2 else 0.0, _scatter(before) if before.size > 2 else 0.0)
    means = [float(cof[a:b].mean()) for a, b in pairwise(bounds)]
    least = max(LEAST_RISE * abs(low), LEAST_PART * (max(means) - min(means)), LEAST_JUMP * noise)
    if high - low <= least:
        return None, 0
    way = (cof - low) / (high - low)
    start = k
    while start > 0 and way[start - 1] > 0.1:
        start -= 1
    end = start
    while end < cof.size - 1 and way[end] < 0.9:
        end += 1
    if start == 0 or end - start > max(LONGEST_JUMP * cof.size, 2.0 * BESIDE):
        return None, 0
    places = [_crossing(laps.distance, way, at, level) for at, level in ((start, 0.1), (end, 0.9))]
    return Jump(start=places[0], end=max(places), low=low, high=high), end


def _crossing(distance: FloatArray, way: FloatArray, at: int, level: float) -> float:
    """Return where a straight line from the group before crosses a level [mm]."""
    low, high = float(way[at - 1]), float(way[at])
    part = (level - low) / (high - low) if high > low else 1.0
    return float(distance[at - 1] + min(max(part, 0.0), 1.0) * (distance[at] - distance[at - 1]))
