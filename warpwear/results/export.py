"""Worn bodies as files that surface metrology software opens."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.snapshot import Snapshot
from warpwear.results.file import ResultFile
from warpwear.study.surface import surface_in
from warpwear.surfaces.sphere import sag

BODIES = ("sphere", "disc")
#: All rows or columns of a field.
ALL = slice(None)
#: A gap beyond this stands for a place beyond the sphere's rim [mm].
NO_SURFACE = 1.0e20


def worn_heights(
    result: ResultFile, snapshot: Snapshot, body: str, part: tuple[slice, slice] = (ALL, ALL)
) -> FloatArray:
    """Heights of a worn body [mm], positive out of its material, shape (nx, ny) or that of a part of it.

    The disc's are over its mean plane, the sphere's over the apex it had, so that its cap lies below 0.
    Beyond the sphere's edge the sphere is NaN and the disc as it was before; NaN too if its file is gone, and
    of a swept run, whose disc is what lies under the sphere. Where the patches of a two-scale
    run cover nothing both are NaN.
    """
    curvature = result.study.sphere.curvature
    radius = 1.0 / curvature if curvature else np.inf
    x, y, gap = result.x[part[0]], result.y[part[1]], snapshot.gap[part]
    sphere = sag(x, y, radius=radius) + snapshot.wear_sphere[part]
    with np.errstate(invalid="ignore"):  # beyond the sphere's edge
        heights = -sphere if body == "sphere" else sphere - gap
    not_covered = np.isnan(gap)  # by the patches of a two-scale run
    beyond = (~np.isfinite(sphere) | (gap > NO_SURFACE)) & ~not_covered
    heights[beyond | not_covered] = np.nan
    if body == "disc" and beyond.any() and snapshot.row is None:
        with suppress(InputError):
            heights[beyond] = surface_in(result.study).heights(x, y)[beyond]
    return heights


def export(
    result: ResultFile,
    folder: str | Path,
    *,
    snapshot: int = -1,
    formats: Sequence[str] = ("sdf", "xyz", "npy"),
    overwrite: bool = False,
) -> list[Path]:
    """Write both worn bodies at one snapshot (-1: the end) into a folder; returns the paths.

    sdf: ASCII, ISO 25178-71, metres. xyz: a line x, y, z a point, mm, tabs between them. npy: heights alone,
    mm, shape (nx, ny). Raises InputError for an unknown format or snapshot and for files that are there.
    """
    unknown = [name for name in formats if name not in WRITERS]
    if unknown:
        raise InputError(f"format = '{unknown[0]}' is not known; allowed: {', '.join(WRITERS)}")
    kept = result.snapshot_distances.size
    if not -kept <= snapshot < kept:
        raise InputError(
            f"snapshot = {snapshot} is not in this result; allowed: 0 to {kept - 1}, -1 is the last"
        )
    folder = Path(folder)
    paths = {(body, kind): folder / f"{body}_worn.{kind}" for body in BODIES for kind in formats}
    there = [path for path in paths.values() if path.exists()]
    if there and not overwrite:
        raise InputError(
            f"out = {folder} already holds {there[0].name}; give another folder, or overwrite it"
        )
    folder.mkdir(parents=True, exist_ok=True)
    fields = result.snapshot(snapshot)
    for (body, kind), path in paths.items():
        partial = path.with_name(f".{path.name}.partial")
        try:
            WRITERS[kind](partial, worn_heights(result, fields, body), result)
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)
    return list(paths.values())


def _write_sdf(path: Path, heights: FloatArray, result: ResultFile) -> None:
    try:
        sdfio = lazy.load("sdfio")
    except ImportError as error:
        raise InputError("format = 'sdf' needs the package sdfio: pip install 'warpwear[io]'") from error
    step = 1.0e-3 * result.study.grid.cell
    # A profile of the file runs along the sliding direction.
    metadata = sdfio.Metadata(revision=sdfio.Revision.ISO_1_0, manufacturer_id="warpwear")
    data = 1.0e-3 * heights.T
    with path.open("wb") as file:
        sdfio.write(file, data, x_scale=step, y_scale=step, format=sdfio.FileFormat.ASCII, metadata=metadata)


def _write_xyz(path: Path, heights: FloatArray, result: ResultFile) -> None:
    x, y = np.meshgrid(result.x, result.y, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), heights.ravel()])
    points = points[np.isfinite(points[:, 2])]
    np.savetxt(path, points, fmt="%.9g", delimiter="\t", header="x [mm]\ty [mm]\tz [mm]")


def _write_npy(path: Path, heights: FloatArray, result: ResultFile) -> None:
    with path.open("wb") as file:
        np.save(file, heights)


WRITERS: dict[str, Callable[[Path, FloatArray, ResultFile], None]] = {
    "sdf": _write_sdf,
    "xyz": _write_xyz,
    "npy": _write_npy,
}
