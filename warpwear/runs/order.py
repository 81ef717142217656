"""What a run goes by: a study, the heights given for its disc, and what follows from both, made once."""

import tomllib
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.quantities import columns_of
from warpwear.history.rows import Rows
from warpwear.laws.friction import friction_energy
from warpwear.laws.passes import Block
from warpwear.results.ensemble import dotted
from warpwear.runs.arrangements import Maker, arrangement_of
from warpwear.runs.array_surface import ArraySurface, take_surface
from warpwear.runs.invariants import Invariants
from warpwear.runs.plan import Planned, plan_of
from warpwear.study.rules_track import too_small
from warpwear.study.study import Study
from warpwear.study.surface import counter_surface, form_of, surface_in
from warpwear.surfaces.base import Surface
from warpwear.surfaces.form import Form
from warpwear.surfaces.measured import Measured


@dataclass(frozen=True, eq=False)
class RunOrder:
    """A study that is to be run. What follows from it is made where it is first needed, and then stays."""

    study: Study
    heights: ArraySurface | None = None  # instead of the disc's own

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

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Return the blocks of the programme; one, the whole test, without a programme."""
        return self.study.blocks

    def blocks_of(self, steps: Sequence[Planned]) -> list[Block]:
        """Return the block in which each step of the plan lies."""
        if len(self.blocks) == 1:
            return [*self.blocks] * len(steps)
        ends = [block.end for block in self.blocks]
        middles = (distance - 0.5 * increment for increment, distance, _ in steps)
        return [self.blocks[bisect_left(ends, middle)] for middle in middles]

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Name the columns of the history."""
        return tuple(column.name for column in columns_of(self.study))

    @cached_property
    def track(self) -> FloatArray | None:
        """Places of the track's rows along x [mm]; None where the disc's heights are of the domain."""
        return self.study.track.x if self.study.is_swept else None

    @cached_property
    def surface(self) -> Surface:
        """The disc's surface. Raises InputError where it, or the domain that it is seen in, will not do."""
        problem = too_small(self.study) if self.study.checks.strict else None
        if problem is not None:
            raise InputError(f"{problem}.")
        return self.heights.surface if self.heights else surface_in(self.study)

    @cached_property
    def counter(self) -> Measured | None:
        """What was measured of the counter-body. Raises InputError as `counter_surface` does."""
        return counter_surface(self.study)

    @cached_property
    def form(self) -> Form:
        """The unworn counter-body's form on the domain's cells. Raises InputError as `form_of` does."""
        return form_of(self.study, self.counter)

    @cached_property
    def notes(self) -> list[str]:
        """Sentences on what of the study and of the surface misleads before anything is computed."""
        grid = self.study.cells
        along = grid.x if self.track is None else self.track
        of_counter = self.counter.notices(grid.x, grid.y) if self.counter else []
        of_counter = [f"The counter-body: {notice.replace('disc.', 'counter.')}" for notice in of_counter]
        return [*self.study.notices(), *self.surface.notices(along, grid.y), *of_counter]

    def history_of(self, rows: Rows, *, finished: bool) -> dict[str, FloatArray]:
        """Make the history of its rows, with the coefficient of friction and its energy."""
        history = {name: rows.column(name) for name in self.columns}
        cof = self.cof_of(history, finished=finished)
        energy = friction_energy(
            history["distance"], cof, history["load"], of_steps="area_sheared" in history
        )
        if self.study.fretting is not None:
            energy = 1.0e-3 * np.cumsum(history["energy"] * history["cycles"])
        return history | {"cof": cof, "friction_energy": energy}

    def cof_of(self, history: dict[str, FloatArray], *, finished: bool) -> FloatArray:
        """Return the coefficient of friction of every step; NaN while it waits for the whole run."""
        law = self.study.friction.law_with()
        return law.coefficient(history, load=history["load"], finished=finished, laps=self.study.laps)


def order_of(
    study: Study | str | Path, surface: ArrayLike | Surface | None, folder: Path | None = None
) -> RunOrder:
    """Take what `run` gets as an order. folder: where the heights are to lie. Raises InputError."""
    if not isinstance(study, Study):
        study = Study.load(study)
    if surface is None:
        return RunOrder(study)
    heights = take_surface(study, surface, folder)
    return RunOrder(heights.study, heights)
