"""Reduce the raw record of a reciprocating tribometer to one coefficient of friction a cycle."""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.experiment import Experiment
from warpwear.measured.rows import Indices, Mask, RecordRows

#: Share of the stroke at each end whose samples are cut: the stage slows down, stands and turns there.
END_CUT = 0.1
#: A turn is told from noise by this share of the stroke on either side of its middle.
HYSTERESIS = 0.25
#: Quantile of the position that counts as an end of the stroke: single jumps lie beyond.
END_QUANTILE = 0.01
#: Samples of a pass over those of the running mean that takes noise off the turning points, at least.
LEAST_PARTS = 20
#: Turning points of two whole cycles, the fewest that a record of them needs.
LEAST_TURNS = 5
#: A cycle whose normal force is below this share of the median was not yet, or no longer, under load.
UNLOADED = 0.5
#: Relative difference of the normal force from the load that is told.
OTHER_LOAD = 0.1
#: Factor between the normal force and the load that is refused.
WRONG_LOAD = 2.0
#: Relative difference of the stroke by the position from the one given that is refused.
OTHER_STROKE = 0.1
#: Share of the rows whose force may have the other sign in a record of sliding in one direction.
OTHER_SIGN = 0.1
#: Half the difference of the directions over their mean; below it the sign does not follow the direction.
RECTIFIED = 0.2
#: Share of the steps whose friction has the other sign than the step before, where steps are strokes.
ALTERNATING = 0.9


def from_forces(
    path: Path, table: Mapping[str, FloatArray], *, step: Indices, stroke: float | None, load: float | None
) -> Experiment:
    """Return the course of friction from 'friction force' and 'normal force' [N] over 'position' [mm].

    table: role -> values, all of shape (rows,), NaN for gaps where it has positions; step: number of each
    row's step, shape (rows,); stroke: length of a pass [mm], None to find it; load: normal load [N], for a
    record without a normal force and to compare with.

    A cycle is a pass and the one back. With F̄x and F̄z the means of a pass without the outer tenth of the
    stroke at both ends, its coefficient is |F̄x(forth) − F̄x(back)| / (F̄z(forth) + F̄z(back)): an offset of
    the force, half the sum of the directions, drops out and is told. The distance is the number of passes
    times the stroke, given or from the turning points; noise of the position does not add up.
    Without a position the steps are passes where the force changes its sign from step to step, and 'distance'
    serves where it keeps it. Raises InputError for a record that says too little.
    """
    friction = table["friction force"]
    normal, notes, warnings = _normal_force(path, table, load)
    if "position" in table:
        course = _by_cycles(path, table["position"], friction, normal, stroke)
    elif _alternating(friction, step):
        course = _by_strokes(path, table, normal, step, stroke)
    else:
        course = _one_way(path, table, normal)
    return replace(course, notes=(*notes, *course.notes), warnings=warnings)


def _normal_force(
    path: Path, table: Mapping[str, FloatArray], load: float | None
) -> tuple[FloatArray, list[str], tuple[str, ...]]:
    """Return the normal force [N], pressing positive, shape (rows,); notes and warnings."""
    if "normal force" not in table:
        if load is None:
            raise InputError(f"{path} has a friction force but no normal force; 'Fz [N]' is expected")
        note = f"The normal force is not in the record: {load:g} N."
        return np.full_like(table["friction force"], load), [note], ()
    normal = table["normal force"]
    middle = float(np.nanmedian(normal))
    if middle == 0.0:
        raise InputError(f"{path}: the normal force is 0 N for half the record or more; a load is expected")
    notes = []
    if middle < 0.0:
        normal, middle = -normal, -middle
        notes.append("The normal force is negative in the record and was taken as pressing.")
    if load is None or abs(middle - load) <= OTHER_LOAD * load:
        return normal, notes, ()
    doubt = f"the median of the normal force is {middle:.3g} N where the run has {load:g} N"
    if not load / WRONG_LOAD <= middle <= load * WRONG_LOAD:
        raise InputError(
            f"{path}: {doubt}; less than a factor of {WRONG_LOAD:g} is expected, so the unit or the column "
            "is wrong, or the run is of another test"
        )
    return normal, notes, (f"Warning: {doubt}.",)


def _one_way(path: Path, table: Mapping[str, FloatArray], normal: FloatArray) -> Experiment:
    """Return the course sample by sample, for sliding in one direction."""
    friction, distance, notes = table["friction force"], table["distance"], []
    sign = one_sign(path, friction)
    loaded = normal > UNLOADED * np.median(normal)
    if np.any(np.diff(distance[loaded]) < 0.0):
        raise InputError(f"{path}: the distance falls; an accumulated distance is expected")
    if not loaded.all():
        notes.append(f"Rows with less than half of the median normal force, left out: {(~loaded).sum()}.")
    distance, cof = averaged(path, distance[loaded], sign * friction[loaded] / normal[loaded])
    notes.append("The coefficient is Fx/Fz of every row: sliding in one way.")
    return Experiment(path.stem, distance, cof, tuple(notes))


def one_sign(path: Path, friction: FloatArray) -> float:
    """Return the sign that a friction force [N], shape (rows,), has. Raises InputError where it has both."""
    friction = friction[np.isfinite(friction)]
    sign = float(np.sign(np.median(friction))) if friction.size else 0.0
    if sign == 0.0 or (sign * friction < 0.0).mean() > OTHER_SIGN:
        raise InputError(f"{path}: the friction force changes its sign: 'Position [mm]' is expected")
    return sign


def averaged(path: Path, distance: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distances, each once and rising, and the mean of the values at each, (points,).

    distance and values have the same shape (rows,). Raises InputError for one distance only.
    """
    places, which = np.unique(distance, return_inverse=True)
    if places.size < 2:
        raise InputError(f"{path} has one distance only; two or more are expected")
    return places, np.bincount(which, weights=values) / np.bincount(which)


def _by_cycles(
    path: Path, position: FloatArray, friction: FloatArray, normal: FloatArray, stroke: float | None
) -> Experiment:
    """Return the course cycle by cycle, of the passes forth and back between the turning points."""
    known = np.isfinite(position)
    position = np.interp(np.arange(known.size), np.flatnonzero(known), position[known])
    turns, smooth = turning_points(position)
    if turns.size < LEAST_TURNS:
        raise InputError(f"{path}: the position turns {turns.size} times: two whole cycles are expected")
    ends = [float(np.median(smooth[turns[side::2]])) for side in (0, 1)]
    measured, middle = abs(ends[1] - ends[0]), 0.5 * (ends[0] + ends[1])
    if stroke is not None and abs(measured - stroke) > OTHER_STROKE * stroke:
        real = f"{measured:.3g} mm"
        cure = f"pass --stroke='{real}' to record or compare"
        raise InputError(f"{path}: the stroke is {real} by the position, not {stroke:g} mm: {cure}")
    used = measured if stroke is None else stroke
    inside = np.abs(position - middle) <= (0.5 - END_CUT) * measured
    start = abs(float(smooth[turns[0]] - smooth[0]))
    source = "as given" if stroke is not None else "from its turning points"
    turns, inside = _with_lost(turns, known), inside & known
    return _course_of_passes(path, friction, normal, turns, inside, used, source, start=min(start, used))


def _with_lost(turns: Indices, known: Mask) -> Indices:
    """Return the turns with those that lie in gaps of the position: passes last as long as the median one.

    known: the rows with a position, shape (rows,). Turns alternate between the ends, so that two are lost.
    """
    lengths = np.diff(turns)
    pairs = np.rint(0.5 * (lengths / np.median(lengths) - 1.0)).astype(np.intp)
    pairs[[known[a:b].all() for a, b in pairwise(turns)]] = 0  # it stood there
    ends = zip(pairwise(turns), pairs, strict=True)
    parts = [np.linspace(*between, 1 + 2 * lost, endpoint=False) for between, lost in ends]
    return np.rint(np.append(np.concatenate(parts), turns[-1])).astype(np.intp)


def alternates(rows: RecordRows) -> bool:
    """Return whether the friction force of a record changes its sign from step to step."""
    return "friction force" in rows.table and _alternating(rows.table["friction force"], rows.step)


def _alternating(friction: FloatArray, step: Indices) -> bool:
    known = np.isfinite(friction)
    steps, which = np.unique(step[known], return_inverse=True)
    if steps.size < LEAST_TURNS - 1:
        return False
    sums = np.bincount(which, weights=friction[known]) * (-1.0) ** steps  # a step of gaps alone turns, too
    return bool((sums[1:] * sums[:-1] > 0.0).mean() >= ALTERNATING)


def _by_strokes(
    path: Path, table: Mapping[str, FloatArray], normal: FloatArray, step: Indices, stroke: float | None
) -> Experiment:
    """Return the course of a record whose steps are passes forth and back, cycle by cycle."""
    turns = np.searchsorted(step, np.arange(step[-1] + 2))  # a step of gaps alone has no rows
    count, seen = np.diff(turns), step[-1] - step[0] + 1
    place = (np.arange(step.size) - np.repeat(turns[:-1], count) + 0.5) / np.repeat(count, count)
    inside = np.abs(place - 0.5) <= 0.5 - END_CUT
    source = "as given" if stroke is not None else "of its steps"
    if stroke is None and "distance" not in table:
        raise InputError(f"{path} has a stroke a step and not its length: --stroke '10 mm' is needed")
    if stroke is None:
        stroke = float((table["distance"][-1] - table["distance"][0]) / (seen - seen / step.size))
    return _course_of_passes(path, table["friction force"], normal, turns, inside, stroke, source)


def _course_of_passes(
    path: Path,
    friction: FloatArray,
    normal: FloatArray,
    turns: Indices,
    inside: Mask,
    stroke: float,
    source: str,
    *,
    start: float = 0.0,
) -> Experiment:
    """Return the course cycle by cycle, of passes forth and back.

    friction, normal: forces [N], shape (rows,); turns: rows at which the sliding turns, shape (passes + 1,);
    inside: rows away from the ends, shape (rows,); stroke: length of a pass [mm], and its source for a
    sentence; start: distance slid before the first turn [mm].
    """
    inside[: turns[0]] = inside[turns[-1] :] = False
    between = int(turns[-1] - turns[0])
    notes = [f"Samples within a tenth of the stroke of its ends, cut: {between - inside.sum()} of {between}."]
    sampled = inside & np.isfinite(friction) & np.isfinite(normal)
    forces, loads = (_pass_means(path, values, sampled, turns) for values in (friction, normal))
    pairs = forces.size // 2
    forth, back = (forces[first : 2 * pairs : 2] for first in (0, 1))
    pressing = 0.5 * (loads[0 : 2 * pairs : 2] + loads[1 : 2 * pairs : 2])
    half = 0.5 * np.abs(forth - back)
    empty = np.isnan(half)
    loaded = ~empty if empty.all() else pressing > UNLOADED * np.median(pressing[~empty])
    if loaded.sum() < 2:
        raise InputError(f"{path} has whole cycles under load: {loaded.sum()}; two or more are expected")
    # A pass and the mean of its neighbours: a friction that changes steadily makes no offset.
    middles = 0.5 * forces[1:-1] + 0.25 * (forces[:-2] + forces[2:])
    middles = middles if np.isfinite(middles).any() else 0.5 * (forth + back)
    offset, typical = float(np.nanmedian(middles)), float(np.median(half[loaded]))
    if typical <= RECTIFIED * abs(offset):
        raise InputError(
            f"{path}: the friction force does not change its sign with the direction: it was recorded "
            "without sign, is nothing, or has a large offset; a signed force, or a column of coefficients, "
            "is expected"
        )
    distance = start + stroke * (1.0 + 2.0 * np.arange(pairs, dtype=np.float64))
    if empty.any():
        notes.append(f"Cycles with gaps through a whole pass, left out: {empty.sum()}.")
    if (unloaded := ~loaded & ~empty).any():
        notes.append(f"Cycles with less than half of the median normal force, left out: {unloaded.sum()}.")
    notes.append(f"{pairs} cycles; the distance is passes times the stroke, {stroke:.4g} mm ({source}).")
    notes.append(
        f"Half the difference of the directions is the friction; their offset is {offset:.3g} N, "
        f"{100.0 * abs(offset) / typical:.2g} % of the friction (medians)."
    )
    cycles = 1.0 + np.flatnonzero(loaded).astype(np.float64)
    return Experiment(path.stem, distance[loaded], half[loaded] / pressing[loaded], tuple(notes), cycles)


def _pass_means(path: Path, values: FloatArray, inside: Mask, turns: Indices) -> FloatArray:
    """Return the mean of the samples inside every pass from turn to turn, shape (passes,), NaN without one.

    inside: which samples count, shape (rows,); what lies before the first turn and after the last does not.
    """
    passes, count = np.searchsorted(turns, np.flatnonzero(inside), side="right") - 1, turns.size - 1
    number = np.bincount(passes, minlength=count)
    if np.median(number) == 0.0 or (number > 0).sum() < LEAST_TURNS - 1:
        raise InputError(f"{path}: a pass has no sample between its ends; a higher sampling rate is expected")
    sums: FloatArray = np.bincount(passes, weights=values[inside], minlength=count).astype(np.float64)
    return np.where(number > 0, sums / np.maximum(number, 1), np.nan)


def turning_points(position: FloatArray) -> tuple[Indices, FloatArray]:
    """Return the rows at which the position [mm] turns, in order, and the smoothed position [mm].

    Between two crossings of the middle of the stroke, each complete only when it leaves a band of half the
    stroke, lies one turn: the extreme of the smoothed position. Noise inside the band makes none. The first
    and the last count if they come so near to the stroke's end that only what is cut is missing.
    """
    low, high = np.quantile(position, [END_QUANTILE, 1.0 - END_QUANTILE])
    if high <= low:
        return np.zeros(0, dtype=np.intp), position
    away = (position - 0.5 * (low + high)) / (high - low)
    side = np.where(away > HYSTERESIS, 1, np.where(away < -HYSTERESIS, -1, 0))
    outside = np.flatnonzero(side)
    changes = np.flatnonzero(np.diff(side[outside]) != 0)
    if changes.size < 2:
        return np.zeros(0, dtype=np.intp), position
    stays = np.split(outside, changes + 1)
    smooth = _smoothed(position, int(np.median(np.diff(outside[changes]))))
    turns = [int(stay[0] + np.argmax(side[stay[0]] * smooth[stay[0] : stay[-1] + 1])) for stay in stays]
    for at in (0, -1):  # the record may begin or end within a pass
        end = high if side[stays[at][0]] > 0 else low
        if abs(smooth[turns[at]] - end) > END_CUT * (high - low):
            del turns[at]
    return np.array(turns, dtype=np.intp), smooth


def _smoothed(position: FloatArray, samples: int) -> FloatArray:
    """Return the position [mm] after a running mean that finds its turns. samples: of one pass.

    The mean over w samples cuts v w/4 off a turn at speed v [mm a sample]; noise of deviation σ adds some
    2.5 σ/√w, the largest of many. Where both are equal they cancel: w = (10 σ/v)^(2/3).
    """
    speed = float(np.ptp(position)) / samples
    # Of second differences, which neither sliding nor single jumps reach; a normal distribution's quartile.
    noise = float(np.median(np.abs(np.diff(position, 2)))) / (0.6745 * math.sqrt(6.0))
    width = min(round((10.0 * noise / speed) ** (2.0 / 3.0)), samples // LEAST_PARTS)
    if width < 2:
        return position
    padded = np.pad(position, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
