"""Roughness of the disc in the middle of the scar and islands of contact, against the distance slid.

Taken from the snapshots of a result; ask for more with `output.snapshots`.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy import ndimage  # every run needs it: not late, when memory may be short

from warpwear.grid import FloatArray
from warpwear.history.quantities import EVOLUTION
from warpwear.history.snapshot import Snapshot
from warpwear.results.export import worn_heights
from warpwear.results.file import ResultFile
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.roughness import bearing_parameters, height_parameters

#: Parameters that are lengths.
LENGTHS = ("sa", "sq", "sk", "spk", "svk")
#: A worn scar is a bowl, a groove a trough: a polynomial of this degree is taken off as their form.
FORM_DEGREE = 2
#: Part of the scar's area whose roughness is taken.
MIDDLE = 0.5
#: A part of fewer cells has no roughness worth a number.
FEWEST_CELLS = 100


@dataclass(frozen=True)
class SurfaceEvolution:
    """One row a snapshot: `table[name]` of shape (snapshots,), and the area of every island [mm²]."""

    table: dict[str, FloatArray]
    island_areas: tuple[FloatArray, ...]


def surface_evolution(result: ResultFile) -> SurfaceEvolution:
    """Roughness parameters (ISO 25178-2) and islands at every snapshot of a result, computed once."""
    return result.once(_surface_evolution)


def _surface_evolution(result: ResultFile) -> SurfaceEvolution:
    numbers = range(len(result.snapshots))  # none of a run that was interrupted before the first
    if result.at_hand.keys() >= {*numbers}:
        with ThreadPoolExecutor(int(result.attributes["threads"])) as pool:
            found = list(pool.map(partial(_of_snapshot, result), (result.at_hand[n] for n in numbers)))
    else:  # one at a time in memory
        found = [_of_snapshot(result, snapshot) for snapshot in result.snapshots]
    table = {column.name: np.array([row[column.name] for row, _ in found]) for column in EVOLUTION}
    return SurfaceEvolution(table, tuple(islands for _, islands in found))


def _of_snapshot(result: ResultFile, snapshot: Snapshot) -> tuple[dict[str, float], FloatArray]:
    """The row of a snapshot, and the areas of its islands [mm²]."""
    islands = island_areas(result, snapshot)
    # The edges of patches that cover a part of the area cut islands: their number and sizes mean nothing.
    one_cell = np.nan if result.study.samples_area else 1.5 * result.study.cells.cell_area
    row = {"distance": snapshot.distance} | _roughness_in_scar(result, snapshot)
    return row | _count_islands(islands, one_cell), islands


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
    x, y = (np.linspace(-1.0, 1.0, 2 * n + 1)[1::2] for n in heights.shape)
    inside = (x[:, None] ** 2 + y[None, :] ** 2 <= MIDDLE) & np.isfinite(heights)
    box = _extents(inside)
    return roughness_without_form(heights[box], inside[box])


def roughness_without_form(
    heights: FloatArray, inside: "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]"
) -> dict[str, float]:
    """Sa, Sq, Sk, Spk, Svk [µm] and Ssk of worn heights [mm], of the cells inside, once their form is gone.

    NaN where too few cells are inside.
    """
    if np.count_nonzero(inside) < FEWEST_CELLS:
        return dict.fromkeys((*LENGTHS, "ssk"), np.nan)
    level = without_polynomial(heights, degree=FORM_DEGREE, where=inside)[inside]
    found = height_parameters(level) | vars(bearing_parameters(level))
    return {name: 1.0e3 * found[name] for name in LENGTHS} | {"ssk": found["ssk"]}
