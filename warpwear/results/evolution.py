"""Measure the roughness of ball and disc in the scar and islands of contact, against the distance slid.

Taken from the snapshots of a result; ask for more with `output.snapshots`.
"""

import warnings
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import astuple, dataclass, replace
from functools import partial

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.history.quantities import evolution_columns
from warpwear.history.snapshot import Snapshot, extents
from warpwear.laws.archard import BODIES
from warpwear.laws.courses import Settling, fit_settling
from warpwear.laws.junctions import share_above
from warpwear.results.file import ResultFile
from warpwear.results.formats.bodies import worn_heights
from warpwear.results.track import inner_rows
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.spectrum import Spectrum
from warpwear.surfaces.worn.scar import Texture, ellipse, fine_spectrum, roughness_without_form, texture

joints = lazy.module("warpwear.history.joint")

#: Part of the scar's area whose roughness is taken.
MIDDLE = 0.5
#: Most places along a track at which the disc's texture is taken.
PLACES = 16
#: Part by which the unworn roughness in the inner scar may change where a way to an equilibrium has a length.
VIEW = 0.1


@dataclass(frozen=True)
class SurfaceEvolution:
    """Hold one row a snapshot: `table[name]` of shape (snapshots,), and the area of every island [mm²].

    warnings: sentences about columns of output.joint.
    """

    table: dict[str, FloatArray]
    island_areas: tuple[FloatArray, ...]
    warnings: tuple[str, ...] = ()


def surface_evolution(result: ResultFile) -> SurfaceEvolution:
    """Return roughness (ISO 25178-2) and islands at every snapshot of a result, computed once."""
    return result.once(_surface_evolution)


def _surface_evolution(result: ResultFile) -> SurfaceEvolution:
    count = len(result.snapshots)  # none of a run that was interrupted before the first
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UserWarning)
        # Contacts are solved one after another, each by all threads.
        if result.at_hand.keys() >= {*range(count)} and not result.study.output.joint:
            with ThreadPoolExecutor(int(result.attributes["threads"])) as pool:
                fields = [result.at_hand[number] for number in range(count)]
                rows = list(pool.map(partial(_of_snapshot, result), range(count), fields))
        else:  # one at a time in memory
            rows = [_of_snapshot(result, index, snapshot) for index, snapshot in enumerate(result.snapshots)]
    names = [column.name for column in evolution_columns(result.study)]
    table = {name: np.array([row[name] for row, _ in rows]) for name in names}
    sentences = dict.fromkeys(f"output.joint: {one.message}" for one in told if one.category is UserWarning)
    return SurfaceEvolution(table, tuple(islands for _, islands in rows), tuple(sentences))


def _of_snapshot(result: ResultFile, index: int, snapshot: Snapshot) -> tuple[dict[str, float], FloatArray]:
    """Return the row of a snapshot, and the areas of its islands [mm²]."""
    islands, critical = island_areas(result, snapshot), result.study.pair.critical_diameter
    # The edges of patches that cover a part of the area cut islands: their number and sizes mean nothing.
    one_cell = np.nan if result.study.samples_area else 1.5 * result.study.cells.cell_area
    disc = worn_heights(result, snapshot, "disc", snapshot.scar)
    row = {"distance": snapshot.distance} | _roughness_in_scar(disc)
    for body in BODIES:
        rough = _texture(result, inner_scar(result, index, snapshot, body))
        row |= {f"sq_{body}": 1e3 * rough.sq, f"sdq_{body}": rough.sdq, f"rq_{body}": 1e3 * rough.rq}
    unworn = inner_scar(result, index, snapshot, "disc", unworn=True)
    row["sq_disc_unworn"] = 1e3 * _texture(result, unworn).sq
    row |= _count_islands(islands, one_cell)
    above = np.nan if critical is None or np.isnan(one_cell) else share_above(islands, critical)
    if result.study.output.joint:
        row |= joints.columns_at(result.study, snapshot, result.history)
    return row | {"share_above_critical": above}, islands


def island_areas(result: ResultFile, snapshot: Snapshot) -> FloatArray:
    """Return the areas [mm²] of the connected regions in contact, shape (islands,)."""
    pressed = snapshot.pressure > 0.0
    return np.asarray(_sizes(pressed[extents(pressed)]) * result.study.cells.cell_area)


def _sizes(where: BoolArray) -> FloatArray:
    """Count the cells of each region connected by sides, in the order of their first cells, shape (regions,).

    Runs of cells along rows are joined: to be imported, `scipy.ndimage` takes longer than this.
    """
    width = where.shape[1] + 1  # a column that ends every run
    closed = np.zeros((where.shape[0], width), dtype=bool)
    closed[:, :-1] = where
    first, end = np.flatnonzero(np.diff(closed.ravel(), prepend=False)).reshape(-1, 2).T
    # of each run the runs of the next row that it touches
    begin, stop = np.searchsorted(end, first + width, "right"), np.searchsorted(first, end + width)
    counts = np.maximum(stop - begin, 0)
    above = np.repeat(np.arange(first.size), counts)
    below = np.arange(above.size) + np.repeat(begin - (np.cumsum(counts) - counts), counts)
    region = np.arange(first.size)
    while (apart := region[above] != region[below]).any():
        above, below = above[apart], below[apart]
        low, high = np.sort([region[above], region[below]], axis=0)
        np.minimum.at(region, high, low)
        while (region != region[region]).any():
            region = region[region]
    cells = np.bincount(region, weights=end - first, minlength=first.size)
    return np.asarray(cells[region == np.arange(first.size)])


def _count_islands(areas: FloatArray, one_cell: float) -> dict[str, float]:
    """Count and size islands. one_cell: areas below are of a single cell [mm²]; NaN where they are cut."""
    numbers = {
        "islands": float(areas.size),
        "islands_of_one_cell": float((areas < one_cell).sum()),
        "island_area_median": float(np.median(areas)) if areas.size else np.nan,
        "island_area_largest": float(areas.max(initial=0.0)),
    }
    return dict.fromkeys(numbers, np.nan) if np.isnan(one_cell) else numbers


def _roughness_in_scar(heights: FloatArray) -> dict[str, float]:
    """Measure the worn disc in the middle of the scar, without its ragged rim, which is hardly worn.

    heights: of the disc in the extents of the touched cells [mm]. The scar is the ellipse in them; its middle
    has the same shape and half the area. Cells between islands of contact count: without them valleys would
    be missing.
    """
    inside = ellipse((heights.shape[0], heights.shape[1]), size=MIDDLE**0.5) & np.isfinite(heights)
    box = extents(inside)
    return roughness_without_form(heights[box], inside[box])


def inner_scar(
    result: ResultFile, index: int, snapshot: Snapshot, body: str, *, unworn: bool = False
) -> list[FloatArray]:
    """Return heights [mm] of a body in the middle of the scar, half as long and wide, at snapshot `index`.

    One field; of the disc of a swept run one for each of some places along the track, evenly apart: one
    place has too few asperities to tell the roughness of a track. unworn: as they were before any wear.
    """
    quarters = [(part.stop - part.start) // 4 for part in snapshot.scar]
    rows, columns = (slice(p.start + q, p.stop - q) for p, q in zip(snapshot.scar, quarters, strict=True))
    if body == "counter" or not result.study.is_swept:
        heights = worn_heights(result, snapshot, body, (rows, columns))
        worn = snapshot.wear_counter if body == "counter" else snapshot.wear_disc
        return [heights + worn[rows, columns] if unworn else heights]
    whole, length = inner_rows(result), rows.stop - rows.start
    length = min(length, whole.stop - whole.start)
    places = min(PLACES, max((whole.stop - whole.start) // max(length, 1), 1))
    starts = np.linspace(whole.start, whole.stop - length, places).astype(int)
    parts = [slice(int(start), int(start) + length) for start in starts]
    fields = [result.track_heights(part)[:, columns] for part in parts]
    if unworn:
        return fields
    lost = (np.add(*result.track_loss(index, part))[:, columns] for part in parts)
    return [heights - depth for heights, depth in zip(fields, lost, strict=True)]


def _texture(result: ResultFile, fields: list[FloatArray]) -> Texture:
    """Return the roughness of a body in the inner scar, root mean squares over its fields."""
    each = [astuple(texture(heights, cell=result.study.grid.cell)) for heights in fields]
    return Texture(*(float(value) for value in np.sqrt(np.mean(np.square(each), axis=0))))


def spectrum_in_scar(result: ResultFile, index: int, snapshot: Snapshot, body: str) -> Spectrum | None:
    """Return the power spectrum of a body in the inner scar at snapshot `index`, the mean over its fields.

    None where the scar is too small, or patches cover a part of it.
    """
    fields = inner_scar(result, index, snapshot, body)
    known = [s for heights in fields if (s := fine_spectrum(heights, cell=result.study.grid.cell))]
    if len(known) < len(fields) or len({spectrum.density.size for spectrum in known}) != 1:
        return None
    return replace(known[0], density=np.mean([spectrum.density for spectrum in known], axis=0))


def settling_course(result: ResultFile, body: str) -> tuple[FloatArray, FloatArray]:
    """Return distances [mm] and Sq [µm] of a body in the inner scar from before wear on, to be fitted.

    A ball is smooth before. The inner scar grows, and a disc's Sq with it: it is taken over that of the same
    cells unworn, times that of the last ones.
    """
    table = surface_evolution(result).table
    after = table["distance"] > 0.0
    slid, values = np.append(0.0, table["distance"][after]), table[f"sq_{body}"][after]
    if body == "counter" or not values.size:
        return slid, np.append(0.0, values)
    unworn = table["sq_disc_unworn"][after]
    with np.errstate(invalid="ignore", divide="ignore"):  # a disc without roughness
        return slid, unworn[-1] * np.append(1.0, values / unworn)


def growth_of_view(table: Mapping[str, FloatArray]) -> str | None:
    """Say why the way to an equilibrium has no length, where the inner scar grows while it is looked at.

    The disc's Sq before any wear, in the same cells, then changes, and so does what the ball takes on.
    table: of a `SurfaceEvolution`.
    """
    unworn = table["sq_disc_unworn"][(table["distance"] > 0.0) & np.isfinite(table["sq_disc_unworn"])]
    if not unworn.size or np.ptp(unworn) <= VIEW * unworn[-1]:
        return None
    low, high = unworn[0], unworn[-1]
    return (
        f"no length, as the inner scar grows: the unworn disc's Sq in it goes from {low:.3g} to {high:.3g} µm"
    )


def settling(result: ResultFile, body: str) -> Settling | str:
    """Fit the course of a body's Sq [µm] in the inner scar, or say in half a sentence why not."""
    return fit_settling(*settling_course(result, body))
