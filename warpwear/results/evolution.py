"""Roughness of ball and disc in the scar and islands of contact, against the distance slid.

Taken from the snapshots of a result; ask for more with `output.snapshots`.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import astuple, dataclass, replace
from functools import partial

import numpy as np
from scipy import ndimage  # every run needs it: not late, when memory may be short

from warpwear.grid import FloatArray
from warpwear.history.quantities import EVOLUTION
from warpwear.history.snapshot import Snapshot
from warpwear.laws.junctions import share_above
from warpwear.laws.settling import Settling, fit_settling
from warpwear.results.file import ResultFile
from warpwear.results.formats.bodies import BODIES, worn_heights
from warpwear.results.track import whole_rows
from warpwear.surfaces.spectrum import Spectrum
from warpwear.surfaces.worn.scar import Texture, ellipse, fine_spectrum, roughness_without_form, texture

#: Part of the scar's area whose roughness is taken.
MIDDLE = 0.5
#: Most places along a track at which the disc's texture is taken.
PLACES = 16


@dataclass(frozen=True)
class SurfaceEvolution:
    """One row a snapshot: `table[name]` of shape (snapshots,), and the area of every island [mm²]."""

    table: dict[str, FloatArray]
    island_areas: tuple[FloatArray, ...]


def surface_evolution(result: ResultFile) -> SurfaceEvolution:
    """Roughness parameters (ISO 25178-2) and islands at every snapshot of a result, computed once."""
    return result.once(_surface_evolution)


def _surface_evolution(result: ResultFile) -> SurfaceEvolution:
    kept = len(result.snapshots)  # none of a run that was interrupted before the first
    if result.at_hand.keys() >= {*range(kept)}:
        with ThreadPoolExecutor(int(result.attributes["threads"])) as pool:
            fields = [result.at_hand[number] for number in range(kept)]
            found = list(pool.map(partial(_of_snapshot, result), range(kept), fields))
    else:  # one at a time in memory
        found = [_of_snapshot(result, index, snapshot) for index, snapshot in enumerate(result.snapshots)]
    table = {column.name: np.array([row[column.name] for row, _ in found]) for column in EVOLUTION}
    return SurfaceEvolution(table, tuple(islands for _, islands in found))


def _of_snapshot(result: ResultFile, index: int, snapshot: Snapshot) -> tuple[dict[str, float], FloatArray]:
    """The row of a snapshot, and the areas of its islands [mm²]."""
    islands, critical = island_areas(result, snapshot), result.study.critical_diameter
    # The edges of patches that cover a part of the area cut islands: their number and sizes mean nothing.
    one_cell = np.nan if result.study.samples_area else 1.5 * result.study.cells.cell_area
    row = {"distance": snapshot.distance} | _roughness_in_scar(result, snapshot)
    for body in BODIES:
        found = _texture(result, index, snapshot, body)
        row |= {f"sq_{body}": 1e3 * found.sq, f"sdq_{body}": found.sdq, f"rq_{body}": 1e3 * found.rq}
    row["sq_disc_unworn"] = 1e3 * _texture(result, index, snapshot, "disc", unworn=True).sq
    row |= _count_islands(islands, one_cell)
    above = np.nan if critical is None or np.isnan(one_cell) else share_above(islands, critical)
    return row | {"share_above_critical": above}, islands


def island_areas(result: ResultFile, snapshot: Snapshot) -> FloatArray:
    """Areas [mm²] of the connected regions in contact, shape (islands,)."""
    pressed = snapshot.pressure > 0.0
    labels, _ = ndimage.label(pressed[_extents(pressed)])
    return np.asarray(np.bincount(labels.ravel())[1:] * result.study.cells.cell_area, dtype=np.float64)


def _extents(where: "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]") -> tuple[slice, slice]:
    """Rows and columns from the first to the last that has a place; none where there is no place."""
    found = (np.flatnonzero(where.any(axis=axis)) for axis in (1, 0))
    rows, columns = (slice(at[0], at[-1] + 1) if at.size else slice(0, 0) for at in found)
    return rows, columns


def _count_islands(areas: FloatArray, one_cell: float) -> dict[str, float]:
    """Numbers of a row. one_cell: areas below are of a single cell [mm²]; NaN where islands are cut."""
    found = {
        "islands": float(areas.size),
        "islands_of_one_cell": float((areas < one_cell).sum()),
        "island_area_median": float(np.median(areas)) if areas.size else np.nan,
        "island_area_largest": float(areas.max(initial=0.0)),
    }
    return dict.fromkeys(found, np.nan) if np.isnan(one_cell) else found


def _roughness_in_scar(result: ResultFile, snapshot: Snapshot) -> dict[str, float]:
    """Roughness of the worn disc in the middle of the scar, without its ragged rim, which is hardly worn.

    The scar is the ellipse in the extents of the touched cells; its middle has the same shape and half the
    area. Cells between islands of contact count: without them valleys would be missing.
    """
    extents = _extents(snapshot.touched)
    heights = worn_heights(result, snapshot, "disc", extents)
    inside = ellipse((heights.shape[0], heights.shape[1]), size=MIDDLE**0.5) & np.isfinite(heights)
    box = _extents(inside)
    return roughness_without_form(heights[box], inside[box])


def inner_scar(
    result: ResultFile, index: int, snapshot: Snapshot, body: str, *, unworn: bool = False
) -> list[FloatArray]:
    """Heights [mm] of a body in the middle of the scar, half as long and wide, at snapshot number `index`.

    One field; of the disc of a swept run one for each of some places along the track, evenly apart: one
    place has too few asperities to tell the roughness of a track. unworn: as they were before any wear.
    """
    extents = _extents(snapshot.touched)
    quarters = [(part.stop - part.start) // 4 for part in extents]
    rows, columns = (slice(part.start + q, part.stop - q) for part, q in zip(extents, quarters, strict=True))
    if body == "sphere" or not result.study.is_swept:
        heights = worn_heights(result, snapshot, body, (rows, columns))
        if unworn:
            heights = (
                heights + (snapshot.wear_sphere if body == "sphere" else snapshot.wear_disc)[rows, columns]
            )
        return [heights]
    whole, length = whole_rows(result), rows.stop - rows.start
    length = min(length, whole.stop - whole.start)
    places = min(PLACES, max((whole.stop - whole.start) // max(length, 1), 1))
    starts = np.linspace(whole.start, whole.stop - length, places).astype(int)
    found = []
    for start in starts:
        part = slice(int(start), int(start) + length)
        heights = result.track_heights(part)[:, columns]
        found.append(heights if unworn else heights - np.add(*result.track_loss(index, part))[:, columns])
    return found


def _texture(
    result: ResultFile, index: int, snapshot: Snapshot, body: str, *, unworn: bool = False
) -> Texture:
    """Roughness of a body in the inner scar, root mean squares over its fields."""
    fields = inner_scar(result, index, snapshot, body, unworn=unworn)
    each = [astuple(texture(heights, cell=result.study.grid.cell)) for heights in fields]
    return Texture(*(float(value) for value in np.sqrt(np.mean(np.square(each), axis=0))))


def spectrum_in_scar(result: ResultFile, index: int, snapshot: Snapshot, body: str) -> Spectrum | None:
    """The power spectrum of a body in the inner scar at snapshot number `index`, the mean over its fields.

    None where the scar is too small, or patches cover a part of it.
    """
    fields = inner_scar(result, index, snapshot, body)
    found = [fine_spectrum(heights, cell=result.study.grid.cell) for heights in fields]
    known = [spectrum for spectrum in found if spectrum is not None]
    if len(known) < len(found) or len({spectrum.density.size for spectrum in known}) != 1:
        return None
    return replace(known[0], density=np.mean([spectrum.density for spectrum in known], axis=0))


def settling_course(result: ResultFile, body: str) -> tuple[FloatArray, FloatArray]:
    """Distances [mm] and Sq [µm] of a body in the inner scar, from before wear on, as it is fitted.

    A ball is smooth before. The inner scar grows, and a disc's Sq with it: it is taken over that of the same
    cells unworn, times that of the last ones.
    """
    table = surface_evolution(result).table
    after = table["distance"] > 0.0
    slid, values = np.append(0.0, table["distance"][after]), table[f"sq_{body}"][after]
    if body == "sphere" or not values.size:
        return slid, np.append(0.0, values)
    unworn = table["sq_disc_unworn"][after]
    with np.errstate(invalid="ignore", divide="ignore"):  # a disc without roughness
        return slid, unworn[-1] * np.append(1.0, values / unworn)


def settling(result: ResultFile, body: str) -> Settling | str:
    """The fitted course of a body's Sq [µm] in the inner scar, or half a sentence that says why not."""
    return fit_settling(*settling_course(result, body))
