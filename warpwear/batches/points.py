"""The runs of a sweep: the study of each, and the name that finds it again wherever it was computed."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.batches.run_one import RunTask
from warpwear.errors import InputError
from warpwear.results.ensemble import name_of
from warpwear.study.study import Study
from warpwear.surfaces.reading import digest_of, read

#: Key that takes parts of a measured disc instead of values, and what says where they lie.
CROP, POSITIONS = "disc.crop", {"positions", "seed"}


@dataclass(frozen=True)
class Point:
    """One run of a sweep: its varied values as they were given, and its study, or why there is none."""

    number: int
    values: dict[str, Any]
    study: Study | None
    run: str  # name of its folder; empty without a study
    problem: str = ""
    files: dict[str, str] = field(default_factory=dict)  # key that names a file -> SHA-256 of that


def points_of(study: Study, values: Iterable[Mapping[str, Any]], *, device: str) -> list[Point]:
    """Return the runs of a study with these values of its keys.

    A combination that makes no study is a point with its sentence. Raises InputError where none makes one.
    """
    digest = cache(digest_of)  # a file is read once for all runs
    points = [_point(number, study, dict(changes), device, digest) for number, changes in enumerate(values)]
    if all(point.study is None for point in points):
        raise InputError(points[0].problem)
    return points


def _point(
    number: int, study: Study, values: dict[str, Any], device: str, digest: Callable[..., str]
) -> Point:
    try:
        varied = study.replace(values)
    except InputError as error:
        return Point(number, values, None, "", str(error))
    files = {key: digest(path, key=key) for key, path in varied.files.items()}
    return Point(number, values, varied, name_of(varied, device=device, files=files), files=files)


def task_of(point: Point, runs: Path, *, device: str, threads: int | None = None) -> RunTask:
    """Return what a worker is asked for a run. runs: the folder of all of them."""
    assert point.study is not None
    return RunTask(point.study.to_toml(), str((runs / point.run).resolve()), device, threads, point.files)


def with_positions(study: Study, vary: Mapping[str, Any]) -> dict[str, Any]:
    """Put parts of the measured disc where {positions = 12, seed = 1} stands for them in what is varied.

    Each part is as large as the domain, or the track, and lies anywhere in the file, as often as not over
    another. Raises InputError for a disc that is not measured, or too small for any choice.
    """
    positions = vary.get(CROP)
    if not isinstance(positions, Mapping):
        return dict(vary)
    number = positions.get("positions")
    if set(positions) - POSITIONS or not isinstance(number, int) or isinstance(number, bool) or number < 1:
        raise InputError(
            f"sweep.vary '{CROP}' = {dict(positions)!r}: {{positions = 12, seed = 1}} is expected, or a list."
        )
    disc = study.disc
    if disc.surface is None:
        raise InputError(f"sweep.vary '{CROP}' needs a measured disc, disc.surface; vary disc.synthetic.seed")
    reading = read(disc.surface, pixel=disc.pixel, height_unit=disc.height_unit, array=disc.array)
    rows = study.track.rows if study.is_swept else study.cells.nx
    needed = np.array([rows, study.cells.ny]) * study.grid.cell
    needed = needed[::-1] if disc.sliding_axis == "y" else needed
    pixel = np.asarray(reading.pixel)
    whole = np.asarray(reading.heights.shape) * pixel
    needed = needed + 2.0 * pixel  # cells at the rim lie between points
    if np.any(needed > whole):
        raise InputError(
            f"disc.surface '{disc.surface}' measures {whole[0]:.4g} × {whole[1]:.4g} mm: the part of "
            f"{needed[0]:.4g} × {needed[1]:.4g} mm that a run needs has no other place in it."
        )
    corners = np.random.default_rng(positions.get("seed", 0)).random((number, 2)) * (whole - needed)
    crops = [[f"{e:.9g} mm" for e in (x, x + needed[0], y, y + needed[1])] for x, y in corners.tolist()]
    return {**vary, CROP: crops}
