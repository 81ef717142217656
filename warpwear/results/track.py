"""What a swept run leaves on its track: groove, roughness, wear of each pass. Tracks are read in parts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray
from warpwear.laws.passes import Directions, directions
from warpwear.laws.track import Track
from warpwear.results.file import ResultFile
from warpwear.study.study import Study
from warpwear.surfaces.worn.scar import LENGTHS, roughness_without_form

#: Rows of a track that are read at once.
ROWS = 2000
#: Rows of a track whose roughness is taken, at most.
ROUGH_ROWS = 2000
#: Width of the middle of the groove, whose roughness is taken, over that of the patch.
MIDDLE = 0.5
#: Fewest points for the shape of a course.
FEWEST = 20
#: A last pass shorter than this part of one is left out of a course: it has not seen the whole track.
WHOLE = 0.9
#: Part of its length that a step may lack and count as whole.
SHORT = 1.0e-3


@dataclass(frozen=True)
class Groove:
    """Hold the disc's loss at one snapshot, worn or displaced: means along what whole passes slide over.

    Within the first pass that includes what the counter-body has not reached yet.
    """

    distance: float  # [mm]
    y: FloatArray  # [mm]
    worn: FloatArray  # mean depth [mm], shape (ny,)
    displaced: FloatArray  # mean depth pressed down for good [mm], shape (ny,)
    cell: float  # [mm]

    @property
    def depth(self) -> FloatArray:
        """Return the mean depth that is gone [mm], shape (ny,)."""
        return self.worn + self.displaced

    @property
    def width(self) -> float:
        """Return the width of the cells that lost anything [mm]."""
        return float(np.count_nonzero(self.depth)) * self.cell

    @property
    def section(self) -> float:
        """Return the area of the cross-section that is gone [mm²]."""
        return float(self.depth.sum()) * self.cell

    @property
    def mean_depth(self) -> float:
        """Return the mean of the depth over the width [mm]; 0 where nothing is gone."""
        return self.section / self.width if self.width else 0.0


def is_short(result: ResultFile) -> bool:
    """Tell whether the stroke is shorter than the contact, whose middle never leaves the disc's scar."""
    track = _shortest(result)
    return not track.periodic and track.stroke < float(result.history["patch_along"][-1])


def _shortest(result: ResultFile) -> Track:
    return min(result.study.tracks, key=lambda track: track.stroke)


def scar_length(result: ResultFile, index: int) -> float:
    """Return the length of the rows of the disc that lost anything [mm]."""
    lost = np.add(*result.track_loss(index, slice(0, result.track_x.size))).any(axis=1)
    return float(np.count_nonzero(lost)) * result.study.grid.cell


def whole_rows(result: ResultFile) -> slice:
    """Return the rows that all of the contact slides over in a pass: not those at the ends of a stroke.

    Of a stroke shorter than the contact those in the middle of the scar.
    """
    track = _shortest(result)
    if track.periodic:
        return slice(0, track.rows)
    half = 0.5 * (track.stroke - float(result.history["patch_along"][-1]))
    inside = np.flatnonzero(np.abs(result.track_x) <= max(half, track.cell))
    return slice(int(inside[0]), int(inside[-1]) + 1)


def inner_rows(result: ResultFile) -> slice:
    """Return the rows whose roughness is that of the track: `whole_rows`, or half of the scar's if more."""
    whole = whole_rows(result)
    middle = (whole.start + whole.stop) // 2
    half = round(0.5 * MIDDLE * float(result.history["patch_along"][-1]) / result.study.grid.cell)
    stop = min(max(whole.stop, middle + half), result.track_x.size)
    return slice(max(min(whole.start, middle - half), 0), stop)


def groove(result: ResultFile, index: int) -> Groove:
    """Return the groove at snapshot number `index`."""
    rows, lost = whole_rows(result), np.zeros((2, result.y.size))
    for first in range(rows.start, rows.stop, ROWS):
        part = slice(first, min(first + ROWS, rows.stop))
        lost += [depth.sum(axis=0) for depth in result.track_loss(index, part)]
    worn, displaced = lost / (rows.stop - rows.start)
    return Groove(float(result.snapshot_distances[index]), result.y, worn, displaced, result.study.grid.cell)


def depth_along(result: ResultFile, index: int, bins: int) -> tuple[FloatArray, FloatArray]:
    """Return places along the track [mm], at most `bins`, and the groove's mean depth around each [mm]."""
    rows = result.track_x.size
    width = groove(result, index).width
    per_bin = -(-rows // bins)
    places, depths = [], []
    for first in range(0, rows, per_bin):
        part = slice(first, min(first + per_bin, rows))
        worn, displaced = result.track_loss(index, part)
        places.append(result.track_x[part].mean())
        section = (worn + displaced).mean(axis=0).sum() * result.study.grid.cell
        depths.append(section / width if width else 0.0)
    return np.array(places), np.array(depths)


@dataclass(frozen=True)
class Blocks:
    """Hold fields of the whole track, means of blocks, shape (along, across)."""

    heights: FloatArray  # as worn [mm]
    loss: FloatArray  # worn or displaced [mm]
    extent: tuple[float, float, float, float]  # first x, last x, first y, last y [mm]


def blocks(result: ResultFile, index: int, most: int) -> Blocks:
    """Return the track at snapshot number `index`, in at most `most` blocks along either side."""
    rows, columns = result.track_x.size, result.y.size
    along, across = -(-rows // most), -(-columns // most)
    nx, ny = rows // along, columns // across
    heights, loss = np.empty((nx, ny)), np.empty((nx, ny))
    per_part = max(1, ROWS // along)
    for first in range(0, nx, per_part):
        last = min(first + per_part, nx)
        part = slice(first * along, last * along)
        gone = np.add(*result.track_loss(index, part))
        shape = (last - first, along, ny, across)
        for field, values in ((heights, result.track_heights(part) - gone), (loss, gone)):
            field[first:last] = values[:, : ny * across].reshape(shape).mean(axis=(1, 3))
    half, x, y = 0.5 * result.study.grid.cell, result.track_x, result.y
    return Blocks(heights, loss, extent(x[: nx * along], y[: ny * across], half, half))


def extent(x: FloatArray, y: FloatArray, half_x: float, half_y: float) -> tuple[float, float, float, float]:
    """Return first x, last x, first y, last y of cells that reach half_x and half_y beyond places x, y."""
    return float(x[0]) - half_x, float(x[-1]) + half_x, float(y[0]) - half_y, float(y[-1]) + half_y


def roughness_in_track(result: ResultFile) -> dict[str, FloatArray]:
    """Return height parameters [µm] in the middle of the groove, unworn and at each snapshot, over `passes`.

    The middle half of the final patch's width, so that all are of the same cells, and of its length at least;
    its form is taken off.
    """
    inner = inner_rows(result)
    middle = (inner.start + inner.stop) // 2
    part = slice(max(inner.start, middle - ROUGH_ROWS // 2), min(inner.stop, middle + ROUGH_ROWS // 2))
    half = 0.5 * MIDDLE * float(result.history["patch_across"][-1])
    columns = np.flatnonzero(np.abs(result.y) <= half)
    unworn = result.track_heights(part)[:, columns]
    everywhere = np.ones(unworn.shape, dtype=bool)
    rows = [roughness_without_form(unworn, everywhere)]
    for index in range(result.snapshot_distances.size):
        worn = unworn - np.add(*result.track_loss(index, part))[:, columns]
        rows.append(roughness_without_form(worn, everywhere))
    passes = result.study.passes_at(np.append(0.0, result.snapshot_distances))
    return {"passes": passes} | {name: np.array([row[name] for row in rows]) for name in LENGTHS}


def both_directions(study: Study, history: Mapping[str, FloatArray], name: str) -> Directions | None:
    """Return a column's means in both directions of the last cycle; None where there is no such cycle."""
    if not study.is_swept:
        return None
    margin = 0.5 * float(history["patch_along"][-1]) / study.tracks[-1].track_fraction
    return directions(history, history[name], study.laps, margin=margin)


def doubt_of_directions(study: Study, history: Mapping[str, FloatArray]) -> str | None:
    """Return a sentence where the directions of the last cycle differ beyond their scatter; else None."""
    ways = both_directions(study, history, "area_contact")
    if ways is None or not ways.differ:
        return None
    periodic = study.track.periodic
    where = "the seam of sliding.track" if periodic else "the ends of the stroke"
    cause = f"not at {where}: the surface differs by direction, and end values are means of both"
    if ways.by_ends:
        cause = f"most of it at {where}{', so a disc without a seam there is the cure' * periodic}"
    return (
        f"The area in contact of the last cycle depends on the direction: {ways.forward:.3g} mm² forward and "
        f"{ways.backward:.3g} mm² backward, more than they scatter along the track; {cause}."
    )


def pass_numbers(result: ResultFile) -> "np.ndarray[tuple[int], np.dtype[np.int_]]":
    """Return the number of the computed pass that each step belongs to, from 0."""
    parts = _of_blocks(result, [1.0 / track.steps_of_pass for track in result.study.tracks])
    return np.floor(np.cumsum(parts) - 0.5 * parts).astype(int)


def _of_blocks(result: ResultFile, values: Sequence[float]) -> FloatArray:
    """Return for every step the value of its block."""
    number = result.history.get("block", np.ones(result.history["distance"].size))
    return np.asarray(values)[number.astype(int) - 1]


def whole_steps(result: ResultFile) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """Tell which steps are as long as the others: not those that the end of a pass or of the run cuts.

    A step that is implicit in the wear yields by K p ΔL: a short one has less area, so less friction, and
    higher pressures, which say nothing of the track. All steps of a ball that does not slide over one.
    """
    increment = result.history["increment"] / result.history.get("cycles", 1.0)
    if not result.study.is_swept:
        return np.ones(increment.size, dtype=bool)
    tracks = [track.stroke * min(track.shift / track.cells, 1.0) for track in result.study.tracks]
    increment = increment / (longest := _of_blocks(result, tracks)) * longest.max()
    return increment > (1.0 - SHORT) * increment.max() if increment.any() else increment == 0.0


def by_pass(result: ResultFile, *means: str) -> dict[str, FloatArray]:
    """Return one value a computed pass, of which the last may be short.

    `distance` slid in it [mm], and means over it of the columns of the history that are asked for.
    """
    history, number, increment = result.history, pass_numbers(result), result.history["increment"]
    slid = np.bincount(number, increment).astype(np.float64)
    means_of = {name: np.bincount(number, increment * history[name]) / slid for name in means}
    return {"distance": slid, **means_of}


def shape_of_growth(distance: FloatArray, values: FloatArray) -> dict[str, float]:
    """Return how a quantity grows with the distance slid; without what its course is too short for.

    exponent: m = d ln(value) / d ln(distance) over the second half (least squares), of values that are
    positive there. levelling: λ, the slope over the second half by that over 1/80 to 1/10 of the distance
    (secants). A straight line from the origin has 1 and 1, a square root 0.5 and 0.25.
    """
    total = distance[-1]
    late = distance >= 0.5 * total
    known = np.isfinite(values).all() and late.sum() >= 3 and values[late].min() > 0.0
    if distance.size < FEWEST or not known:
        return {}
    far = np.log(distance[late]) - np.log(distance[late]).mean()
    exponent = float((far * np.log(values[late])).sum() / np.square(far).sum())

    def secant(start: float, end: float) -> float:
        low, high = np.interp([start * total, end * total], distance, values)
        return float((high - low) / ((end - start) * total))

    shape, early = {"exponent_m": exponent}, secant(1.0 / 80.0, 0.1)
    if early and distance[0] <= total / 80.0:
        shape["levelling_lambda"] = secant(0.5, 1.0) / early
    return shape


def course(result: ResultFile, name: str) -> tuple[FloatArray, FloatArray]:
    """Return distance [mm] and values of a column.

    Of a swept run they are the means of its whole passes, whose ends differ from their middles, at the
    middles.
    """
    history = result.history
    stroke = None if result.study.laps is None else result.study.laps.length
    if stroke is None or history["distance"][-1] == 0.0:  # at rest, or a static contact
        return history["distance"], history[name]
    passes = by_pass(result, *(() if name == "distance" else (name,)))  # whose distances are its own
    slid = passes["distance"]
    places = np.cumsum(slid) - 0.5 * slid
    passes["distance"] = places
    whole = slice(None, -1 if slid.size > 1 and slid[-1] < WHOLE * stroke else None)
    return places[whole], passes[name][whole]
