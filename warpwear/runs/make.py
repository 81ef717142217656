"""What a run steps through, made from its study: the model, its executor, the plan of the steps."""

import math
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from warpwear import lazy
from warpwear.engine.device import free_memory
from warpwear.engine.executor import FIELDS_NEEDED, Executor
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid
from warpwear.history.pieces import PieceBook
from warpwear.history.recorder_patches import PatchBook, bytes_of_book
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.laws.track import WHOLE, Track, increments
from warpwear.models.model import Model
from warpwear.study.study import Study
from warpwear.study.surface import bearing_curve_of
from warpwear.surfaces.base import BoolArray, Surface
from warpwear.surfaces.made.synthetic import RandomPart
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.roughness import roughness

# The models, each with its kernels, of which a run needs one: reading them all takes longer than a short run.
models_rest = lazy.module("warpwear.models.rest.local")
models_track = lazy.module("warpwear.models.track.model")
models_two_scale = lazy.module("warpwear.models.patches.local")
models_patches = lazy.module("warpwear.models.patches.half_space")
width = lazy.module("warpwear.models.patches.width")

#: Fields at the peak of a run on the half-space, by its boundary, and more on a GPU, whose transforms copy.
HALF_SPACE_FIELDS, GPU_FIELDS = {"periodic": 16.0, "free": 22.0}, 12.0
#: More where the disc slides: a mean along x, and what it takes to follow the disc.
SLIDING_FIELDS = 3.0
#: More with a film: what is bare and its caps; and of each body whose film forms anew.
FILM_FIELDS, HEALING_FIELDS = 2.0, 3.0
#: More of each body that wears in pieces: what is pending, its sums, and lists of cells.
PIECES_FIELDS = 2.5
#: Rows of a track whose roughness is recorded.
MOST_ROWS = 4000
#: The largest sampled surface that stays for the next run of this process [B].
KEPT_SURFACE = 2**26


@dataclass(frozen=True)
class PreparedModel:
    """A model, and what it was made of."""

    model: Model
    heights: FloatArray  # of the unworn disc [mm], shape (nx, ny), or of the track, (rows, ny)
    record: dict[str, Any]  # of the surface, for the result
    book: PatchBook | None = None  # of the patches that the model has
    pieces: PieceBook | None = None  # in which its bodies have worn
    filled: BoolArray | None = None  # what was not measured of the disc, as its heights; None: all was


def executor_of(study: Study, *, device: str, threads: int | None) -> Executor:
    """What the kernels of the study's model are launched on. Raises InputError as `Executor` does."""
    fields = FIELDS_NEEDED + PIECES_FIELDS * study.wear.sheds
    elastic = study.contact.law == "half-space"
    if elastic:
        fields += HALF_SPACE_FIELDS[study.boundary] + GPU_FIELDS * (device != "cpu") - FIELDS_NEEDED
    if study.film is not None:
        bodies = study.track.rows / study.cells.nx + 1.0 if study.is_swept else 2.0
        fields += FILM_FIELDS + HEALING_FIELDS * bodies * math.isfinite(study.film.regrowth)
    if study.is_swept:
        rows = study.track.rows
        fields += SLIDING_FIELDS * elastic
        fields += models_track.DISC_FIELDS * rows / study.cells.nx
        fields += (study.sliding.plastic == "keep") * rows / study.cells.nx
        fields += PIECES_FIELDS * study.wear.sheds * rows / study.cells.nx
        _check_memory(study, rows, fields, device)
        return Executor(study.cells, device=device, threads=threads)
    # Laws of cell by cell are those of a track, and a radial factor is a field of its own, as its stiffness.
    task = study.contact_task
    fields += (SLIDING_FIELDS + 2.0) * (not task.is_uniform or study.wear.law == "bearing-curve")
    if study.study.model == "two-scale":
        patches = study.patch_layout
        _check_memory_of_book(study, patches, device)
        return Executor(patches.grid, device=device, threads=threads, fields_needed=fields)
    return Executor(study.cells, device=device, threads=threads, fields_needed=fields)


def model_of(
    study: Study,
    surface: Surface,
    executor: Executor,
    *,
    kept: Callable[[FloatArray], FloatArray] = lambda heights: heights,
) -> PreparedModel:
    """The model that the study asks for, on a surface. Raises InputError for one that it cannot use.

    kept: gives the heights that a run began with for those that are made now.
    """
    grid = study.cells
    sampled = _sample(study, surface)
    heights, record = kept(sampled.heights), {**sampled.record}
    filled = None
    if isinstance(surface, Measured):
        filled = surface.filled_at(study.track.x if study.is_swept else grid.x, grid.y)
        filled = None if filled is None or not filled.any() else filled
    if filled is not None and filled.all():
        raise InputError(
            f"disc.surface = {study.disc.surface!r} was measured nowhere in the domain, but filled in: "
            "another part of it is needed (disc.crop)."
        )
    if filled is not None or heights is not sampled.heights:
        seen = slice(MOST_ROWS if study.is_swept else None)
        measured = heights[seen] if filled is None else np.where(filled[seen], np.nan, heights[seen])
        record["on_the_grid"] = _roughness_on(grid, measured)
    if study.is_swept:
        swept = models_track.SweptModel(study.contact_task, study.track, heights, executor)
        return PreparedModel(swept, heights, record, pieces=swept.pieces, filled=filled)
    if study.study.model == "two-scale":
        patches = study.patch_layout
        width.refuse_unsuitable(study, patches, heights)
        task = study.contact_task
        of_law = models_patches.HalfSpacePatches if task.half_space else models_two_scale.TwoScaleModel
        of_patches = of_law(task, patches, heights, executor)
        return PreparedModel(of_patches, heights, record, book=of_patches.book, filled=filled)
    curve = bearing_curve_of(study) if study.wear.law == "bearing-curve" else None
    if curve is not None:
        record["bearing_curve"] = asdict(curve)
    model = model_at_rest(study.contact_task, heights, executor, bearing_curve=curve)
    pieces = getattr(model, "pieces", None)
    return PreparedModel(model, heights, record, pieces=pieces, filled=filled)


def model_at_rest(
    task: ContactTask, heights: FloatArray, executor: Executor, *, bearing_curve: Logistic | None = None
) -> Model:
    """The model of one grid that lies still. Laws of cell by cell are those of a track that does not move.

    heights: of the disc over its mean plane [mm], shape (nx, ny). bearing_curve: of a roughness that the grid
    does not resolve.
    """
    if task.is_uniform and not task.half_space and bearing_curve is None and task.pieces is None:
        return models_rest.OneScaleModel(task, heights, executor)
    # The asperities spring back: a dent that stays would be pressed anew in each step.
    task = replace(task, keeps_dents=False)
    track = Track.at_rest(executor.grid)
    return models_track.SweptModel(task, track, heights, executor, bearing_curve=bearing_curve)


def plan_of(study: Study) -> list[tuple[float, float, bool]]:
    """Plan every step: its increment, the distance at its end [mm], and whether its fields are kept."""
    stops, total = study.snapshot_distances, study.sliding.total
    if study.is_swept:
        return _kept_after(stops, study.track.increments(total), total)
    if study.output.snapshots == "auto":
        return _kept_after(stops, increments(study.stepping.plan, total), total)
    return [
        (increment, distance, distance in stops or distance == total)
        for increment, distance in increments(study.stepping.plan, total, stops)
    ]


class _Sampled(NamedTuple):
    """A surface has these heights [mm] on the cells of a study, of its domain or its track."""

    heights: FloatArray
    record: dict[str, Any]  # of the surface, and of its heights as if all of them were measured


#: What was made last of a random surface: the surface, the cells it was sampled on, and what it is there.
_LAST: list[tuple[Any, _Sampled]] = []


def _sample(study: Study, surface: Surface) -> _Sampled:
    """Sample a surface on the cells of a study; a random one is the last one again where nothing differs."""
    grid, track = study.cells, study.track if study.is_swept else None
    asked = surface, grid, track
    random = isinstance(surface, RandomPart)
    for made, sampled in _LAST:
        if random and made == asked:
            return sampled
    heights = surface.heights(grid.x, grid.y) if track is None else _heights_of(study, surface, track)
    seen = slice(None if track is None else MOST_ROWS)
    record = surface.record() | {"on_the_grid": _roughness_on(grid, heights[seen])}
    sampled = _Sampled(heights, record)
    if random and heights.nbytes <= KEPT_SURFACE:
        heights.flags.writeable = False
        _LAST[:] = [(asked, sampled)]
    return sampled


def _heights_of(study: Study, surface: Surface, track: Track) -> FloatArray:
    """Make the heights of the track over its mean plane [mm], shape (track.rows, ny).

    A random surface that repeats after whole cells is made once: the sums behind it take most of the time.
    """
    x, y, disc = track.x, study.cells.y, study.disc.synthetic
    if disc is not None and disc.kind == "self-affine":
        period = disc.period / track.cell
        if abs(period - round(period)) <= WHOLE * period and round(period) < track.rows:
            return surface.heights(x[: round(period)], y)[np.arange(track.rows) % round(period)]
    return surface.heights(x, y)


def _kept_after(
    distances: tuple[float, ...], steps: Iterable[tuple[float, float]], total: float
) -> list[tuple[float, float, bool]]:
    """Leave the steps as long as they are: fields are kept at the first end at or after each distance."""
    stops, plan = sorted(stop for stop in set(distances) if stop < total), []
    for increment, distance in steps:
        reached = bool(stops) and stops[0] > 0.0 and distance >= stops[0] - 1.0e-6 * increment
        while stops and distance >= stops[0] - 1.0e-6 * increment:
            del stops[0]
        plan.append((increment, distance, reached or distance == total))
    return plan


def _check_memory(study: Study, rows: int, fields: float, device: str) -> None:
    """Raises InputError for a track that the host or the device does not hold."""
    needed = 8.0 * fields * study.cells.cells
    whole = study.sliding.track == "full"
    instead = "a representative track, such as sliding.track = '3.2 mm', or " if whole else ""
    for place, free in free_memory(device).items():
        if needed > free:
            raise InputError(
                f"sliding.track = {study.sliding.track!r} makes a disc of {rows} × {study.cells.ny} cells, "
                f"which takes {needed / 2**30:.1f} GiB of memory; {place} has {free / 2**30:.1f} GiB free, "
                f"so {instead}larger cells are needed."
            )


def _check_memory_of_book(study: Study, patches: Patches, device: str) -> None:
    """Raises InputError for a history of patches that the host does not hold beside the fields."""
    steps = len(plan_of(study))
    tables = bytes_of_book(steps, patches.count)
    fields = 8.0 * FIELDS_NEEDED * patches.grid.cells * (device == "cpu")
    free = free_memory(device)["the host"]
    if fields <= free < fields + tables:  # fields that are too many are told by their cells
        raise InputError(
            f"patches.macro_cell = {1e3 * study.patches.macro_cell:g} µm makes {patches.count} patches, "
            f"whose loads and areas over {steps} steps take {tables / 2**30:.1f} GiB of memory beside "
            f"{fields / 2**30:.1f} GiB of fields; the host has {free / 2**30:.1f} GiB free, so a larger "
            "patches.macro_cell is needed."
        )


def _roughness_on(grid: Grid, heights: FloatArray) -> dict[str, float]:
    """What the cells see of the surface: after filtering, mirroring and sampling, NaN where not measured."""
    found = roughness(heights, pixel=(grid.cell, grid.cell))
    lengths = {f"{key}_um": 1.0e3 * found.pop(key) for key in ("sa", "sq", "sz")}
    return lengths | found
