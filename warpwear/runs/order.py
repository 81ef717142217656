"""What a run goes by: a study, the heights given for its disc, and what follows from both, made once."""

import tomllib
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from warpwear.engine.executor import Executor
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid
from warpwear.history.quantities import columns_of
from warpwear.history.rows import Rows
from warpwear.laws.form import Form
from warpwear.laws.friction import friction_energy
from warpwear.laws.passes import Block
from warpwear.laws.track import WHOLE, Track
from warpwear.models.model import Model
from warpwear.results.file import SURFACE_FILE
from warpwear.runs.arrangements import Maker, Parts, Record, arrangement_of
from warpwear.runs.array_surface import ArraySurface, say, take_surface
from warpwear.runs.invariants import Invariants
from warpwear.runs.plan import Planned, plan_of
from warpwear.study.keys import dotted
from warpwear.study.rules_track import too_small
from warpwear.study.study import Study
from warpwear.study.surface import counter_surface, form_of, surface_in
from warpwear.surfaces.base import BoolArray, Surface
from warpwear.surfaces.made.synthetic import Periodic
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.reading import digest_of, noted
from warpwear.surfaces.roughness import roughness

#: Rows of a track whose roughness is recorded.
MOST_ROWS = 4000
#: The largest sampled surface that stays for the next run of this process [B].
KEPT_SURFACE = 2**26


class PreparedModel(NamedTuple):
    """A model, and what it was made of."""

    model: Model
    heights: FloatArray  # of the unworn disc [mm], shape (nx, ny), or of the track, (rows, ny)
    record: Record  # of the surface
    filled: BoolArray | None  # what was not measured of the disc, as its heights; None: all was


@dataclass(frozen=True, eq=False)
class RunOrder:
    """A study that is to be run. What follows from it is made where it is first needed, and then stays.

    planned: digests of files by the keys that name them, where a run on others is not wanted.
    """

    study: Study
    heights: ArraySurface | None = None  # instead of the disc's own
    planned: Mapping[str, str] = field(default_factory=dict)
    _read: dict[str, set[str]] = field(default_factory=dict)  # path -> digests

    @cached_property
    def toml(self) -> str:
        """The whole study after defaults, as files have it."""
        return self.study.to_toml()

    @cached_property
    def keys(self) -> dict[str, Any]:
        """Map the dotted name of every key in that text to its value."""
        return dotted(tomllib.loads(self.toml))

    @cached_property
    def arrangement(self) -> Maker:
        """What makes the executor and the model."""
        return arrangement_of(self.study)

    @cached_property
    def invariants(self) -> Invariants:
        """What must hold after every step."""
        return Invariants(self.study)

    @cached_property
    def plan(self) -> list[tuple[float, float, bool]]:
        """Every step: its increment, the distance at its end [mm], and whether its fields are kept."""
        return plan_of(self.study)

    def blocks_of(self, steps: Sequence[Planned]) -> list[Block]:
        """Return the block in which each step of the plan lies."""
        blocks = self.study.blocks
        if len(blocks) == 1:
            return [*blocks] * len(steps)
        ends = [block.end for block in blocks]
        middles = (distance - 0.5 * increment for increment, distance, _ in steps)
        return [blocks[bisect_left(ends, middle)] for middle in middles]

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Name the columns of the history."""
        return tuple(column.name for column in columns_of(self.study))

    @cached_property
    def surface(self) -> Surface:
        """The disc's surface. Raises InputError where it, or the domain that it is seen in, will not do."""
        problem = too_small(self.study) if self.study.checks.strict else None
        if problem is not None:
            raise InputError(f"{problem}.")
        with noted(self._read):
            return self.heights.surface if self.heights else surface_in(self.study)

    @cached_property
    def counter(self) -> Measured | None:
        """What was measured of the counter-body. Raises InputError as `counter_surface` does."""
        with noted(self._read):
            return counter_surface(self.study)

    @cached_property
    def form(self) -> Form:
        """The unworn counter-body's form on the domain's cells. Raises InputError as `form_of` does."""
        return form_of(self.study, self.counter)

    @cached_property
    def notes(self) -> list[str]:
        """Sentences on what of the study and of the surface misleads before anything is computed."""
        grid, surface, places = self.study.cells, self.surface, self.study.places
        is_lap = self.study.is_swept and self.study.sliding.track != "full"
        seam = surface.lap_seam(*places) if is_lap and isinstance(surface, Measured) else []
        of_counter = self.counter.notices(grid.x, grid.y) if self.counter else []
        of_counter = [f"The counter-body: {notice.replace('disc.', 'counter.')}" for notice in of_counter]
        return [*self.study.notices(), *seam, *surface.notices(*places), *of_counter]

    def model(
        self,
        executor: Executor,
        *,
        block: Block | None = None,
        original: Callable[[FloatArray], FloatArray] = np.asarray,
    ) -> PreparedModel:
        """Make the model that the run goes by, on its surface. Raises InputError for one that it cannot use.

        block: that it begins in, by default the first. original: gives the heights that a run began with for
        those that are made now.
        """
        study, surface, grid = self.study, self.surface, self.study.cells
        track = study.track if study.is_swept else None
        sampled = _sample(study, surface, track)
        heights, record = original(sampled.heights), {**sampled.record}
        filled = None
        if isinstance(surface, Measured):
            filled = surface.filled_at(*study.places)
            filled = None if filled is None or not filled.any() else filled
        if filled is not None and filled.all():
            raise InputError(say("all_filled", study=study))
        if filled is not None or heights is not sampled.heights:
            seen = slice(None if track is None else MOST_ROWS)
            measured = heights[seen] if filled is None else np.where(filled[seen], np.nan, heights[seen])
            record["on_the_grid"] = _roughness_on(grid, measured)
        if self.counter is not None:
            record["counter"] = self.counter.record()
        heaviest = max(study.blocks, key=lambda block: block.load)
        if study.contact_task.prescribed_loads and heaviest.load > study.blocks[0].load:
            self.model_in(heaviest, heights, executor, {})  # refuses a load before the run, not within it
        model = self.model_in(block or study.blocks[0], heights, executor, record)
        return PreparedModel(model, heights, record, filled)

    def model_in(
        self, block: Block, heights: FloatArray, executor: Executor, record: dict[str, Any]
    ) -> Model:
        """Make the model of a block of the programme, on unworn bodies.

        heights, record: of the disc as it was.
        """
        task = replace(self.study.parts[block.number - 1].contact_task, form=self.form)
        with noted(self._read):
            model = self.arrangement.model(Parts(self.study, task, block, heights, executor, record))
        self._check_files()  # before a step is made on another
        return model

    def save_heights(self, folder: Path) -> None:
        """Write heights that were given as an array into a folder, the file that the study names."""
        if self.heights:
            self.heights.save(folder)
            self._read[str(self.study.disc.surface)] = {digest_of(folder / SURFACE_FILE)}

    @property
    def files(self) -> dict[str, str]:
        """Map keys to the SHA-256 of what was read of the files that they name, as far as they were read.

        Raises InputError for a file that was exchanged meanwhile, or is not the planned one.
        """
        self._check_files()
        paths = {key: str(Path(path)) for key, path in self.study.files.items()}
        return {key: digest for key, path in paths.items() for digest in self._read.get(path, ())}

    def _check_files(self) -> None:
        for key, path in self.study.files.items():
            read, planned = self._read.get(str(Path(path)), set()), self.planned.get(key)
            if planned and read != {planned}:
                raise InputError(say("unplanned_file", key=key, path=path))
            if len(read) > 1:
                raise InputError(f"{key} '{path}' changed while the run read it; run it again")

    def history_of(self, rows: Rows, *, finished: bool) -> dict[str, FloatArray]:
        """Make the history of its rows, with the coefficient of friction and its energy."""
        history = {name: rows.column(name) for name in self.columns}
        cof = self.cof_of(history, finished=finished)
        energy = friction_energy(
            history["distance"], cof, history["load"], of_steps=self.study.pair.wears_by_area
        )
        if self.study.fretting is not None:
            energy = 1.0e-3 * np.cumsum(history["energy"] * history["cycles"])
        return history | {"cof": cof, "friction_energy": energy}

    def cof_of(self, history: dict[str, FloatArray], *, finished: bool) -> FloatArray:
        """Return the coefficient of friction of every step; NaN while it waits for the whole run."""
        law = self.study.friction_law
        return law.coefficient(history, load=history["load"], finished=finished, laps=self.study.laps)


def order_of(
    study: Study | str | Path,
    surface: ArrayLike | Surface | None,
    folder: Path | None = None,
    *,
    planned: Mapping[str, str] | None = None,
) -> RunOrder:
    """Take what `run` gets as an order. folder: where the heights are to lie. Raises InputError."""
    if not isinstance(study, Study):
        study = Study.load(study)
    if surface is None:
        return RunOrder(study, planned=planned or {})
    heights = take_surface(study, surface, folder)
    return RunOrder(heights.study, heights)


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
    sampled = _Sampled(heights, surface.record() | {"on_the_grid": _roughness_on(grid, heights[seen])})
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
    """Return what cells see of the surface: after filtering, mirroring and sampling; NaN: not measured."""
    numbers = roughness(heights, pixel=(grid.cell, grid.cell))
    return {f"{key}_um": 1.0e3 * numbers.pop(key) for key in ("sa", "sq", "sz")} | numbers
