"""Read the coefficient of friction over the distance slid from a file, and look for its gaps."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.experiment import Experiment
from warpwear.measured.motion import Motion, doubts, moving, sliding_distance, with_friction
from warpwear.measured.record import PLAIN
from warpwear.measured.rows import UNLOADED, Paths, RecordRows, read_rows, without
from warpwear.measured.tribometer import UNLOADED as HALF_LOAD
from warpwear.measured.tribometer import alternates, averaged, from_forces, one_sign

#: A coefficient of friction beyond this is a mistake: a force, percent, or a load that is not yet on.
LARGEST_COF = 3.0
#: No contact has less.
LEAST_COF = 1e-9
#: Share of negative coefficients beyond which their sign is taken to change with the direction.
NEGATIVE_SHARE = 0.1
#: Mean number of rows between turns of a distance that goes to and fro; with fewer, rows are out of order.
RUN = 2.5
#: Share of the whole distance that may be covered twice.
OVERLAP = 0.05
#: Share of the rows with gaps beyond which they are warned of.
MANY_GAPS = 0.1
#: A gap between two points is longer than this share of the range that is looked at ...
GAP = 0.05
#: ... and longer than this many times the mean distance between points.
MEAN_GAPS = 2.0
#: Largest share of the range that may lie in gaps.
MOST_IN_GAPS = 0.5


def read_experiment(path: Paths, *, columns: str | None = None, **motion: Any) -> Experiment:
    """Read a record of friction as a machine wrote it, see `warpwear.measured.record`, or a table of text.

    Two kinds are told apart by the names of the columns: a coefficient of friction over distance, laps, speed
    and time, time or cycles; and forces with the position, or stroke by stroke, see
    `warpwear.measured.tribometer`.

    path: a file, or a folder or several files that make one record. columns: which columns to take, see
    `warpwear.measured.columns.choose`. motion: fields of `Motion`. Raises InputError for whatever could be
    read in two ways.
    """
    return experiment_of(read_rows(path, columns), Motion(**motion))


def experiment_of(rows: RecordRows, motion: Motion) -> Experiment:
    """Return the course of friction in the rows of a record, see `read_experiment`. Raises InputError."""
    rows = with_friction(rows, motion)
    path, notes, steps = rows.path, [], rows.steps
    warnings = [*rows.warnings, *doubts(rows, motion.radius)]
    if _signed(rows):
        title = rows.chosen["cof"].title
        notes.append(f"The column {title!r} goes with the direction: the forces are taken.")
        rows = replace(rows, table={role: v for role, v in rows.table.items() if role != "cof"})
    forces = "cof" not in rows.table
    taken, origin = {"friction force", "normal force"} if forces else {"cof"}, ""
    if "position" in rows.table and forces:
        taken.add("position")
    else:
        all_rows, (rows, left_out) = rows, moving(rows)
        strokes = forces and alternates(rows)
        if forces and not strokes:
            one_sign(path, rows.table["friction force"])
        what = "friction force" if forces else "coefficient of friction"
        try:  # rows at rest count in time, and the distance stands still there
            distance, role, origin = sliding_distance(all_rows, motion, what=what)
            rows, _ = moving(replace(all_rows, table={**all_rows.table, "distance": distance}))
            taken |= {role, "distance"}
            notes += left_out
        except InputError:
            if not strokes:
                raise
    if not forces:
        rows, left_out = _loaded(rows)
        notes += left_out
    table = {role: values for role, values in rows.table.items() if role in taken}
    columns = {role: rows.chosen[role] for role in rows.chosen if role in taken}
    table, left_out, many = _without_gaps(path, {**table, "step": rows.step.astype(np.float64)})
    step = table.pop("step").astype(np.intp)
    if forces:
        course = from_forces(path, table, step=step, stroke=motion.stroke, load=motion.load)
    else:
        course = _in_order(path, table["distance"], table["cof"])
    titles = ", ".join(f"{role} from {column.title!r}" for role, column in columns.items())
    notes = [*rows.notes, f"Columns: {titles}.", *([origin] if origin else []), *notes, *course.notes]
    if rows.format != PLAIN.name:
        notes.insert(0, f"Format: {rows.format}" + (f", {len(steps)} steps." if len(steps) > 1 else "."))
    notes += check_cof(path, course.distance, course.cof)
    return replace(course, notes=(*left_out, *notes), warnings=(*many, *warnings, *course.warnings))


def _loaded(rows: RecordRows) -> tuple[RecordRows, list[str]]:
    """Return the rows in which something presses, as far as a force tells, and a note on the others.

    Where the ratio of the others is still noise, all with less than half of the median force are left out.
    """
    normal, cof = np.abs(rows.table.get("normal force", np.zeros(0))), np.abs(rows.table["cof"])
    if not np.any(normal > 0.0):
        return rows, []
    light = normal < UNLOADED * np.nanmax(normal)
    if np.any(cof[~light] > LARGEST_COF):
        light = normal < HALF_LOAD * np.nanmedian(normal[~light])
    return without(rows, light, "Rows without load")


def _signed(rows: RecordRows) -> bool:
    """Return whether coefficients are better taken from forces: they or the forces beside them alternate."""
    if not {"cof", "friction force"} <= rows.table.keys():
        return False
    cof = rows.table["cof"]
    cof = cof[np.isfinite(cof)]
    turning = cof.size > 0 and NEGATIVE_SHARE < (cof < 0.0).mean() < 1.0 - NEGATIVE_SHARE
    return (turning and "position" in rows.table) or ("position" not in rows.table and alternates(rows))


def _without_gaps(
    path: Path, table: dict[str, FloatArray]
) -> tuple[dict[str, FloatArray], list[str], list[str]]:
    """Return the rows with all values, a note on the others, and a warning where these are many.

    Those of a record with positions stay, where they are NaN.
    """
    rows = next(iter(table.values())).size
    whole = np.isfinite(list(table.values())).all(axis=0)
    count = int(whole.sum())
    if count < 2:
        raise InputError(f"{path} has rows with all values: {count}; two or more are expected")
    out = rows - count
    notes = [f"Rows with gaps, left out: {out} of {rows}."] * (out > 0)
    share = f"{out} of {rows} rows ({out / rows:.0%}) have gaps and were left out"
    many = [f"Warning: {share}: what happened in them is not known."] * (out > MANY_GAPS * rows)
    if "position" not in table:  # whose turns are found among rows of even sampling
        table = {role: values[whole] for role, values in table.items()}
    return table, notes, many


def _in_order(path: Path, distance: FloatArray, cof: FloatArray) -> Experiment:
    """Return the course over rising distances [mm], each once, and notes on what was done.

    Raises InputError for a distance that starts again or goes to and fro.
    """
    notes = []
    before = distance < 0.0
    if before.any():
        if before.mean() > NEGATIVE_SHARE:
            raise InputError(f"{path}: {before.sum()} of {before.size} distances or times are negative")
        distance, cof = distance[~before], cof[~before]
        notes.append(f"Rows before the start (negative distance or time), left out: {before.sum()}.")
    if np.any(np.diff(distance) < 0.0):
        again = _covered_again(distance)
        if again is not None:
            raise InputError(f"{path}: row {again + 1} starts again: an accumulated distance is expected")
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


def check_cof(path: Path | str, distance: FloatArray, cof: FloatArray) -> list[str]:
    """Return notes on coefficients of friction. Raises InputError for those that no contact has."""
    negative = cof < 0.0
    if negative.all():
        raise InputError(f"{path}: friction is negative everywhere: the force's sign has to be reversed")
    if negative.mean() > NEGATIVE_SHARE:
        raise InputError(
            f"{path}: {negative.sum()} of {negative.size} coefficients of friction are negative: a signed "
            "friction of both directions; the raw record with forces and position, or means per cycle, are "
            "expected"
        )
    large, typical = cof > LARGEST_COF, float(np.median(cof))
    if large.any():
        first = int(np.flatnonzero(large)[0])
        percent = ", as if in percent: 20 instead of 0.20" if 1.0 < typical / LARGEST_COF < 100.0 else ""
        raise InputError(
            f"{path}: {large.sum()} of {large.size} coefficients of friction exceed {LARGEST_COF:g} (the "
            f"first is {cof[first]:.4g} at {distance[first]:.4g} mm), which no contact has{percent}; a plain "
            "ratio of forces under load is expected"
        )
    if abs(typical) < LEAST_COF:
        raise InputError(
            f"{path}: the coefficient of friction is {typical:.3g} in the middle: nothing was measured"
        )
    if not negative.any():
        return []
    return [f"Coefficients of friction below zero, kept: {negative.sum()} of {negative.size}."]


def gaps(distance: FloatArray, start: float, end: float) -> list[tuple[float, float]]:
    """Return where gaps between measured points begin and end [mm], in a range from start to end [mm].

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
        raise InputError(f"{experiment.name} has no measured point over {where}; half of it is expected")
    return [f"It has no measured point over {where}: straight lines bridge that in the rms."]
