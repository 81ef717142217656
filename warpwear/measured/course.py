"""Read the coefficient of friction over the distance slid from a file, and look for its gaps."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.columns import Column, choose
from warpwear.measured.experiment import Experiment
from warpwear.measured.record import read_record
from warpwear.measured.tribometer import averaged, from_forces

#: A coefficient of friction beyond this is a mistake: a force, percent, or a load that is not yet on.
LARGEST_COF = 3.0
#: Share of the rows: more negative coefficients than this are a sign that changes with the direction.
NEGATIVE_SHARE = 0.1
#: Distances that go up or down for longer than this many rows are a course, not rows out of order.
RUN = 2.5
#: Share of the whole distance that may be covered twice.
OVERLAP = 0.05
#: A gap between two points is longer than this share of the range that is looked at ...
GAP = 0.05
#: ... and longer than this many times the mean distance between points.
MEAN_GAPS = 2.0
#: Largest share of the range that may lie in gaps.
MOST_IN_GAPS = 0.5


def read_experiment(
    path: str | Path,
    *,
    stroke: float | None = None,
    load: float | None = None,
    speed: float | None = None,
    columns: str | None = None,
) -> Experiment:
    """Read a record of friction from text (.csv, .tsv, .txt, …).

    Two kinds are told apart by the names of the columns: distance (or time, or the number of the cycle) with
    the coefficient of friction; and the raw record of a reciprocating tribometer, friction force, normal
    force and position, see `warpwear.measured.tribometer`.

    stroke: length of one pass [mm], for cycles and for the raw record. load: normal load [N], where the raw
    record has none. speed: sliding speed [mm/s], which makes distance of time. columns: which columns to
    take, see `warpwear.measured.columns.choose`. Raises InputError for whatever could be read in two ways.
    """
    path = Path(path)
    record = read_record(path)
    chosen = choose(record, columns)
    values = record.columns([column.index for column in chosen.values()])
    table = {role: column.factor * values[:, place] for place, (role, column) in enumerate(chosen.items())}
    table, notes = _without_gaps(path, table)
    origin = []
    if "cof" not in table:
        course = from_forces(path, table, stroke=stroke, load=load, speed=speed)
    else:
        distance, role = _sliding_distance(path, table, chosen, stroke=stroke, speed=speed)
        chosen = {one: column for one, column in chosen.items() if one in ("cof", role)}
        course = _in_order(path, distance, table["cof"])
        if role != "distance":
            factor = f"speed, {speed:g} mm/s" if role == "time" else f"two strokes of {stroke:g} mm"
            origin.append(f"Distance is {role} times {factor}.")
    taken = ", ".join(f"{role} from {column.title!r}" for role, column in chosen.items())
    notes += [f"Columns: {taken}.", *origin, *course.notes, *_check_cof(path, course.distance, course.cof)]
    return replace(course, notes=tuple(notes))


def _sliding_distance(
    path: Path,
    table: Mapping[str, FloatArray],
    chosen: Mapping[str, Column],
    *,
    stroke: float | None,
    speed: float | None,
) -> tuple[FloatArray, str]:
    """Return the distance slid [mm], shape (rows,), and the role of the column it is from.

    table: role -> values [mm, s]; stroke [mm] makes distance of cycles, speed [mm/s] of time. Raises
    InputError where the table does not say how far the sliding went.
    """
    if "distance" in table:
        return table["distance"], "distance"
    if "cycle" in table and stroke is not None:
        return 2.0 * stroke * table["cycle"], "cycle"
    if "time" in table:
        time = table["time"]
        if speed is None:
            raise InputError(
                f"{path} gives the time '{chosen['time'].title}' and no distance: a speed is needed, such as "
                "--speed '20 mm/min'"
            )
        if time.min() > np.ptp(time) > 0.0:
            raise InputError(
                f"{path}: the time starts at {time.min():g} s, later than the record is long; time since the "
                "start of sliding is expected"
            )
        return speed * time, "time"
    if "cycle" in table:
        raise InputError(
            f"{path} gives the cycle '{chosen['cycle'].title}' and no distance: the length of a stroke is "
            "needed, from a run's sliding.stroke"
        )
    raise InputError(
        f"{path} has a coefficient of friction but neither a distance nor a time; a column such as "
        "'Distance [mm]' is expected, or --columns 'DISTANCE,COF'"
    )


def _without_gaps(path: Path, table: dict[str, FloatArray]) -> tuple[dict[str, FloatArray], list[str]]:
    """Return the rows with all values, and a note on the others."""
    rows = next(iter(table.values())).size
    whole = np.all([np.isfinite(values) for values in table.values()], axis=0)
    count = int(whole.sum())
    if count < 2:
        raise InputError(f"{path} has rows with all values: {count}; two or more are expected")
    notes = [] if count == rows else [f"Rows with gaps, left out: {rows - count} of {rows}."]
    return {role: values[whole] for role, values in table.items()}, notes


def _in_order(path: Path, distance: FloatArray, cof: FloatArray) -> Experiment:
    """Return the course over rising distances [mm], each once, and notes on what was done.

    Raises InputError for a distance that starts again or goes to and fro.
    """
    notes = []
    before = distance < 0.0
    if before.any():
        if before.mean() > NEGATIVE_SHARE:
            raise InputError(
                f"{path}: {before.sum()} of {before.size} distances or times are negative; those since the "
                "start of sliding are expected"
            )
        distance, cof = distance[~before], cof[~before]
        notes.append(f"Rows before the start (negative distance or time), left out: {before.sum()}.")
    if np.any(np.diff(distance) < 0.0):
        again = _covered_again(distance)
        if again is not None:
            raise InputError(
                f"{path}: the distance falls back at row {again + 1} and covers the same range again: it was "
                "reset or is a position; an accumulated distance is expected"
            )
        order = np.argsort(distance, kind="stable")
        repeated = np.diff(distance[order]) == 0.0
        if np.any(repeated & (np.diff(cof[order]) != 0.0)):
            raise InputError(
                f"{path}: rows are out of order and the distance {distance[order][1:][repeated][0]:g} mm "
                "comes with different coefficients of friction; an accumulated distance is expected"
            )
        distance, cof = distance[order], cof[order]
        notes.append("Rows were out of order and were sorted by distance.")
    places, means = averaged(path, distance, cof)
    if places.size < distance.size:
        notes.append(f"Rows at the distance of another, averaged with it: {distance.size - places.size}.")
    return Experiment(path.stem, places, means, tuple(notes))


def _covered_again(distance: FloatArray) -> int | None:
    """Return the row where a distance first falls, if long rises or falls cover the same range, else None."""
    steps = np.sign(np.diff(distance))
    turns = np.concatenate([[0], np.flatnonzero(np.diff(steps) != 0.0) + 1, [steps.size]])
    if steps.size / (turns.size - 1) < RUN:
        return None
    long = np.flatnonzero(np.diff(turns) > 1)
    ends = distance[np.column_stack([turns[long], turns[long + 1]])]
    low, high = ends.min(axis=1), ends.max(axis=1)
    order = np.argsort(low)
    reached = np.concatenate([[low.min()], np.maximum.accumulate(high[order])[:-1]])
    twice = np.clip(np.minimum(high[order], reached) - low[order], 0.0, None)
    if twice.sum() <= OVERLAP * np.ptp(distance):
        return None
    return int(np.flatnonzero(steps < 0.0)[0]) + 1


def _check_cof(path: Path, distance: FloatArray, cof: FloatArray) -> list[str]:
    """Return notes on coefficients of friction. Raises InputError for those that no contact has."""
    negative = cof < 0.0
    if negative.all():
        raise InputError(
            f"{path}: the coefficient of friction is negative everywhere; positive values are expected, so "
            "the sign of the force has to be turned"
        )
    if negative.mean() > NEGATIVE_SHARE:
        raise InputError(
            f"{path}: {negative.sum()} of {negative.size} coefficients of friction are negative: a signed "
            "friction of both directions; the raw record with forces and position, or means per cycle, are "
            "expected"
        )
    large = cof > LARGEST_COF
    if large.any():
        first = int(np.flatnonzero(large)[0])
        raise InputError(
            f"{path}: {large.sum()} of {large.size} coefficients of friction exceed {LARGEST_COF:g} (the "
            f"first is {cof[first]:.4g} at {distance[first]:.4g} mm), which no contact has; a plain ratio of "
            "forces under load is expected"
        )
    if not negative.any():
        return []
    return [f"Coefficients of friction below zero, kept: {negative.sum()} of {negative.size}."]


def gaps(distance: FloatArray, start: float, end: float) -> list[tuple[float, float]]:
    """Return the pieces of a range from start to end [mm] without a measured point nearby, from and to [mm].

    Each lies between two successive points that are much further apart than the others, whose spacing may
    well change: records are often dense at first. distance: of the points, rising [mm], shape (points,).
    """
    inside = (distance[1:] > start) & (distance[:-1] < end)
    low, high = distance[:-1][inside].clip(start, end), distance[1:][inside].clip(start, end)
    if low.size == 0:
        return []
    lengths = high - low
    wide = (lengths > GAP * (end - start)) & (lengths > MEAN_GAPS * lengths.mean())
    return list(zip(low[wide].tolist(), high[wide].tolist(), strict=True))


def check_coverage(experiment: Experiment, start: float, end: float) -> list[str]:
    """Say, in sentences, where an experiment has gaps in the range from start to end [mm].

    That is the range over which it is compared. Raises InputError when more than half of it lies in gaps.
    """
    pieces = gaps(experiment.distance, start, end)
    if not pieces:
        return []
    missing = sum(high - low for low, high in pieces) / (end - start)
    low, high = max(pieces, key=lambda piece: piece[1] - piece[0])
    where = f"{100.0 * missing:.0f} % of the distance shared with the runs, the longest piece from "
    where += f"{low:.4g} to {high:.4g} mm"
    if missing > MOST_IN_GAPS:
        raise InputError(
            f"{experiment.name} has no measured point over {where}; points over half of it or more are "
            "expected"
        )
    return [f"It has no measured point over {where}: straight lines bridge that in the rms."]
