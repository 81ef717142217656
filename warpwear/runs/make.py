"""What a run steps through, made from its study: the model on its executor, and the heights at first."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from warpwear.engine.executor import Executor
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid
from warpwear.laws.passes import Block
from warpwear.laws.track import WHOLE, Track
from warpwear.runs.arrangements import Parts, PreparedModel
from warpwear.runs.order import RunOrder
from warpwear.study.study import Study
from warpwear.surfaces.base import Surface
from warpwear.surfaces.made.synthetic import Periodic
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.roughness import roughness

#: Rows of a track whose roughness is recorded.
MOST_ROWS = 4000
#: The largest sampled surface that stays for the next run of this process [B].
KEPT_SURFACE = 2**26


def model_of(
    order: RunOrder, executor: Executor, *, original: Callable[[FloatArray], FloatArray] = np.asarray
) -> PreparedModel:
    """The model that a run goes by, on its surface. Raises InputError for one that it cannot use.

    original: gives the heights that a run began with for those that are made now.
    """
    study, surface, grid = order.study, order.surface, order.study.cells
    track = study.track if study.is_swept else None
    sampled = _sample(study, surface, track)
    heights, record = original(sampled.heights), {**sampled.record}
    filled = None
    if isinstance(surface, Measured):
        filled = surface.filled_at(grid.x if track is None else track.x, grid.y)
        filled = None if filled is None or not filled.any() else filled
    if filled is not None and filled.all():
        raise InputError(
            f"disc.surface = {study.disc.surface!r} was measured nowhere in the domain, but filled in: "
            "another part of it is needed (disc.crop)."
        )
    if filled is not None or heights is not sampled.heights:
        seen = slice(None if track is None else MOST_ROWS)
        measured = heights[seen] if filled is None else np.where(filled[seen], np.nan, heights[seen])
        record["on_the_grid"] = _roughness_on(grid, measured)
    if order.counter is not None:
        record["counter"] = order.counter.record()
    heaviest = max(order.blocks, key=lambda block: block.load)
    if study.contact_task.prescribed_loads and heaviest.load > order.blocks[0].load:
        model_in(order, heaviest, heights, executor, {})  # refuses a load before the run, not within it
    return replace(model_in(order, order.blocks[0], heights, executor, record), filled=filled)


def model_in(
    order: RunOrder, block: Block, heights: FloatArray, executor: Executor, record: dict[str, Any]
) -> PreparedModel:
    """The model of a block of the programme, on unworn bodies. heights, record: of the disc as it was."""
    task = replace(order.study.parts[block.number - 1].contact_task, form=order.form)
    return order.arrangement.model(Parts(order.study, task, block, heights, executor, record))


class _Sampled(NamedTuple):
    """A surface has these heights [mm] on the cells of a study, of its domain or its track."""

    heights: FloatArray
    record: dict[str, Any]  # of the surface, and of its heights as if all of them were measured


#: What was made last of a random surface: the surface, the cells it was sampled on, and what it is there.
_LAST: list[tuple[Any, _Sampled]] = []


def _sample(study: Study, surface: Surface, track: Track | None) -> _Sampled:
    """Sample a surface on the cells of a study; a random one is the last one again where nothing differs."""
    grid = study.cells
    place = surface, grid, track
    random = isinstance(surface, Periodic)
    for last, sampled in _LAST:
        if random and last == place:
            return sampled
    heights = surface.heights(grid.x, grid.y) if track is None else _heights_of(study, surface, track)
    seen = slice(None if track is None else MOST_ROWS)
    record = surface.record() | {"on_the_grid": _roughness_on(grid, heights[seen])}
    sampled = _Sampled(heights, record)
    if random and heights.nbytes <= KEPT_SURFACE:
        heights.flags.writeable = False
        _LAST[:] = [(place, sampled)]
    return sampled


def _heights_of(study: Study, surface: Surface, track: Track) -> FloatArray:
    """Make the heights of the track over its mean plane [mm], shape (track.rows, ny).

    A random surface that repeats after whole cells is made once: the sums behind it take most of the time.
    """
    x, y, disc = track.x, study.cells.y, study.disc.synthetic
    if disc is not None and disc.kind in ("self-affine", "profile"):
        period = disc.period / track.cell
        if abs(period - round(period)) <= WHOLE * period and round(period) < track.rows:
            return surface.heights(x[: round(period)], y)[np.arange(track.rows) % round(period)]
    return surface.heights(x, y)


def _roughness_on(grid: Grid, heights: FloatArray) -> dict[str, float]:
    """What the cells see of the surface: after filtering, mirroring and sampling, NaN where not measured."""
    numbers = roughness(heights, pixel=(grid.cell, grid.cell))
    lengths = {f"{key}_um": 1.0e3 * numbers.pop(key) for key in ("sa", "sq", "sz")}
    return lengths | numbers
