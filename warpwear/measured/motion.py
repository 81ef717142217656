"""Find how far a record slid: by its distance, its laps, its speeds, its turns, its cycles or its time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.options import optional, quantity, with_unit
from warpwear.measured.rows import RecordRows, without
from warpwear.study.study import Study

#: Of a track: a number in mm or text with its unit, one or one for each step, "6 mm, 9 mm".
Radius: TypeAlias = float | str | Sequence[float | str]
#: Units of what a person gives.
UNITS = {"stroke": "mm", "speed": "mm/s", "radius": "mm", "load": "N"}
#: A speed below this share of the largest is rest.
REST = 0.01
#: Part of the rows, and of the distance, by which a counter may slip back.
SLIPS = 0.01
#: Turns before the first row that are told.
BEFORE = 1.0
#: Relative difference of a distance from that by the laps that is told.
OTHER_DISTANCE = 0.05


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A person gives these numbers beside a record, None where they are not known.

    stroke: length of one pass [mm], for cycles and forces. load: normal load [N], where the record has none.
    speed: sliding speed [mm/s], which makes distance of time. radius: of the track [mm], which makes distance
    of laps and turns a minute, one or one for each step. run_speed: of a run beside it [mm/s], which stands
    for the speed of a record that counts no turns.
    """

    stroke: float | None = None
    load: float | None = None
    speed: float | None = None
    radius: float | Sequence[float] | None = None
    run_speed: float | None = None

    def over(self, other: "Motion") -> "Motion":
        """Return these numbers, and another's where they are not known."""
        return replace(other, **{name: value for name, value in vars(self).items() if value is not None})


def motion_of(*, radius: Radius | None = None, **others: Any) -> Motion:
    """Return the numbers that a person gives, as numbers or as text with units. Raises InputError.

    others: stroke, speed and load, None where they are not known.
    """
    radii = with_unit(radius.split(",") if isinstance(radius, str) else radius, "mm")
    tracks = radii if isinstance(radii, list) else [] if radii is None else [radii]
    known = {name: optional(f"--{name}", value, UNITS[name]) for name, value in others.items()}
    return Motion(radius=[quantity("--radius", track, "mm") for track in tracks] or None, **known)


def motion_of_runs(*studies: Study) -> Motion:
    """Return what studies say of a record that is laid beside their runs, None where they differ."""
    said = [(s.same_load, s.sliding.mean_speed, s.sliding.stroke, s.same_radius) for s in studies]
    alike = (each[0] if len({*each}) == 1 else None for each in zip(*said, strict=True))
    return Motion(**dict(zip(("load", "run_speed", "stroke", "radius"), alike, strict=False)))


def moving(rows: RecordRows) -> tuple[RecordRows, list[str]]:
    """Return the rows in which something slides, and a note on the others; all where no speed tells."""
    speed = next((np.abs(rows.table[role]) for role in ("speed", "rpm") if role in rows.table), None)
    if speed is None or not np.isfinite(speed).any():
        return rows, []
    return without(rows, speed < REST * np.nanmax(speed), "Rows at rest")


def sliding_distance(rows: RecordRows, motion: Motion, *, what: str) -> tuple[FloatArray, str, str]:
    """Return the distance slid [mm], shape (rows,), the role of the column it is from, and how it was made.

    It is NaN in rows with a gap in what it is made of, and goes on behind them as if they were not there.
    what: the record has, for sentences. Raises InputError where the record does not say how far it slid.
    """
    table, path, stroke, speed = rows.table, rows.path, motion.stroke, motion.speed
    turns = next((role for role in ("laps", "rpm") if role in table), None)
    speed = motion.run_speed if speed is None and turns is None else speed
    track = _radius(rows, motion.radius)
    if "distance" in table:
        distance, note = _without_slips(table["distance"], table.get("time"))
        return distance, "distance", note
    if "laps" in table and track is not None:
        return _by_laps(table["laps"], track, rows)
    length = table.get("stroke") if stroke is None else stroke
    rates = {
        "speed": (1.0, ""),
        "rpm": (None if track is None else 2.0 * np.pi * track / 60.0, ", times 2π radius"),
        "frequency": (None if length is None else 2.0 * length, ", times two strokes"),
    }
    for role, (factor, way) in rates.items():
        if role in table and "time" in table and factor is not None:
            along = _over_gaps(_integral, np.abs(table[role] * factor), table["time"])
            note = f"Distance is the integral of the {role} over time{way}."
            return along, role, note + _falls(table["time"])
    if "cycle" in table and stroke is not None:
        note = f"Distance is cycle times two strokes of {stroke:g} mm."
        return 2.0 * stroke * table["cycle"], "cycle", note
    if turns is not None and speed is None:
        steps = f", or one for each of its {len(rows.steps)} steps" if len(rows.steps) > 1 else ""
        raise InputError(
            f"{path} gives turns, '{rows.chosen[turns].title}', and no distance: the radius of the track is "
            f"needed, such as --radius '6 mm'{steps}"
        )
    if "time" in table:
        time = table["time"]
        if speed is None:
            raise InputError(
                f"{path} gives the time '{rows.chosen['time'].title}' and no distance: a speed is needed, "
                "such as --speed '20 mm/min'"
            )
        if np.nanmin(time) > np.ptp(time[np.isfinite(time)]) > 0.0:
            raise InputError(
                f"{path}: the time starts at {np.nanmin(time):g} s, later than the record is long; time "
                "since the start of sliding is expected"
            )
        return speed * time, "time", f"Distance is time times speed, {speed:g} mm/s."
    if "cycle" in table:
        raise InputError(
            f"{path} gives the cycle '{rows.chosen['cycle'].title}' and no distance: the length of a stroke "
            "is needed, such as --stroke '10 mm'"
        )
    raise InputError(f"{path} has a {what} but neither distance nor time: --columns 'DISTANCE,COF' names it")


def _falls(time: FloatArray) -> str:
    """Say where a time falls, and no distance is added."""
    rows = np.flatnonzero(np.diff(time[np.isfinite(time)]) < 0.0) + 2
    if not rows.size:
        return ""
    return f" The time falls back at {rows.size} rows, first at row {rows[0]}: no distance is added there."


def with_friction(rows: RecordRows, motion: Motion) -> RecordRows:
    """Return rows with the friction force [N] of a torque over the track's radius, where it alone is there.

    Raises InputError where the radius is not known.
    """
    if "torque" not in rows.table or {"friction force", "cof"} & rows.table.keys():
        return rows
    radius, title = _radius(rows, motion.radius), rows.chosen["torque"].title
    if radius is None:
        raise InputError(
            f"{rows.path} gives the torque '{title}' and no friction force: the radius of the track is "
            "needed, such as --radius '6 mm'"
        )
    table = {**rows.table, "friction force": rows.table["torque"] / radius}
    column = replace(rows.chosen["torque"], title=f"{title}, over the radius of the track")
    return replace(rows, table=table, chosen={**rows.chosen, "friction force": column})


def _without_slips(distance: FloatArray, time: FloatArray | None) -> tuple[FloatArray, str]:
    """Return a distance [mm] that stands still where a counter slips back while time goes on; a note."""
    known = distance[np.isfinite(distance)]
    falls = np.diff(known)[np.diff(known) < 0.0]
    goes_on = time is not None and bool(np.all(np.diff(time[np.isfinite(time)]) >= 0.0))
    if not (goes_on and 0 < falls.size <= SLIPS * known.size and -falls.sum() <= SLIPS * np.ptp(known)):
        return distance, ""
    note = f"The distance falls back at {falls.size} rows while time goes on: it is taken to stand still."
    return _over_gaps(np.maximum.accumulate, distance), note


def doubts(rows: RecordRows, radius: float | Sequence[float] | None) -> tuple[str, ...]:
    """Say where the distance of a record is not the one by its laps."""
    track = _radius(rows, radius)
    if track is None or not {"distance", "laps"} <= rows.table.keys():
        return ()
    ends = spans(rows.table["distance"], _by_laps(rows.table["laps"], track, rows)[0])
    if abs(ends[0] - ends[1]) <= OTHER_DISTANCE * ends[1]:
        return ()
    return (
        f"Warning: the column '{rows.chosen['distance'].title}' goes over {ends[0]:.4g} mm, "
        f"'{rows.chosen['laps'].title}' times 2π radius over {ends[1]:.4g} mm.",
    )


def _radius(rows: RecordRows, radius: float | Sequence[float] | None) -> FloatArray | None:
    """Return the radius of the track of each row [mm], shape (rows,), given or measured, or None."""
    if radius is None:
        return rows.table.get("radius")
    tracks = np.atleast_1d(np.asarray(radius, dtype=np.float64))
    if tracks.size not in (1, len(rows.steps)):
        names = ", ".join(f"'{name}'" for name in rows.steps[:12])
        raise InputError(
            f"--radius has {tracks.size} values where {rows.path} has {len(rows.steps)} steps ({names}): "
            "one, or one a step, is expected"
        )
    return tracks[rows.step] if tracks.size > 1 else np.full(rows.step.size, tracks[0])


def _by_laps(laps: FloatArray, track: FloatArray, rows: RecordRows) -> tuple[FloatArray, str, str]:
    """Return the distance by laps [mm], counted from the first row where many went before."""
    first = float(np.append(laps[np.isfinite(laps + track)], 0.0)[0])
    start = first if first > BEFORE else min(first, 0.0)

    def along(laps: FloatArray, track: FloatArray) -> FloatArray:
        return 2.0 * np.pi * np.cumsum(np.diff(laps, prepend=start) * track)

    note = "Distance is laps times 2π radius."
    if start > 0.0:
        note += f" It is counted from the first row, at '{rows.chosen['laps'].title}' {start:g}."
    return _over_gaps(along, laps, track), "laps", note


def spans(*columns: FloatArray) -> list[float]:
    """Return how far columns go from least to most, over the rows in which none has a gap."""
    known = np.array(columns)[:, np.isfinite(columns).all(axis=0)]
    return [float(np.ptp(values)) if values.size else 0.0 for values in known]


def _over_gaps(along: Callable[..., FloatArray], *columns: FloatArray) -> FloatArray:
    """Return a sum along the rows in which no column has a gap, NaN in the others, which would end it."""
    whole = np.isfinite(columns).all(axis=0)
    distance = np.full(whole.size, np.nan)
    if whole.any():
        distance[whole] = along(*(values[whole] for values in columns))
    return distance


def _integral(speed: FloatArray, time: FloatArray) -> FloatArray:
    """Return the distance slid [mm] by a speed [mm/s] over time [s], by trapezoids from the first row."""
    steps = np.clip(np.diff(time), 0.0, None)
    return np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * steps)])
