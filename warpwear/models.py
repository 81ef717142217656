"""From a study to what a run steps through: its model, the executor it launches on, the plan of its steps."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Protocol

from warpwear.checkpoint import checksum
from warpwear.execution import FIELDS_NEEDED, Executor
from warpwear.grid import FloatArray, Grid
from warpwear.ledger import Step
from warpwear.one_scale import OneScaleModel
from warpwear.results import Snapshot
from warpwear.stepping import increments
from warpwear.study import Study
from warpwear.surface_of import bearing_curve_of
from warpwear.surfaces.base import Surface
from warpwear.surfaces.parameters import roughness


class Model(Protocol):
    """Contact and wear of one study on one executor."""

    #: Steps that the state is ahead of the last one given.
    ahead: int

    def steps(self, plan: Iterable[tuple[float, bool]]) -> Iterator[Step]:
        """One step for each (increment [mm], whether a snapshot of it will be asked for)."""

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, at its distance [mm]."""

    def saved_state(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays and numbers that the steps so far have changed: all that `restore` needs."""

    def restore(self, arrays: Mapping[str, Any], numbers: Mapping[str, Any]) -> None:
        """Go on from the state that another model of the same study, surface and device saved."""


@dataclass(frozen=True)
class Made:
    """A model, and what it was made of."""

    model: Model
    surface_sum: int  # `checksum` of the heights
    record: dict[str, Any]  # of the surface, for the result


def executor_of(study: Study, *, device: str, threads: int | None) -> Executor:
    """What the kernels of the study's model are launched on. Raises InputError as `Executor` does."""
    # A radial factor is a field of its own, so are the share of the sphere and the stiffnesses of two steps.
    fields = FIELDS_NEEDED + 5.0 * (study.wear.distance_factor == "radial")
    return Executor(study.cells, device=device, threads=threads, fields_needed=fields)


def model_of(study: Study, surface: Surface, executor: Executor) -> Made:
    """The model that the study asks for, on a surface. Raises InputError for one that it cannot use."""
    grid = executor.grid
    heights = surface.heights(grid.x, grid.y)
    record = surface.record() | {"on_the_grid": _roughness_on(grid, heights)}
    curve = None
    if study.wear.law == "bearing-curve":
        curve = bearing_curve_of(study)
        record["bearing_curve"] = asdict(curve)
    model = OneScaleModel(study, heights, executor, bearing_curve=curve)
    return Made(model, checksum(heights), record)


def plan_of(study: Study) -> list[tuple[float, float, bool]]:
    """Of every step the increment, the distance at its end [mm], and whether its fields are kept."""
    stops, total = set(study.output.snapshots), study.sliding.total
    return [
        (increment, distance, distance in stops or distance == total)
        for increment, distance in increments(study.stepping.plan, total, stops)
    ]


def _roughness_on(grid: Grid, heights: FloatArray) -> dict[str, float]:
    """What the cells see of the surface: after filling, filtering, mirroring and sampling."""
    found = roughness(heights, pixel=(grid.cell, grid.cell))
    lengths = {f"{key}_um": 1.0e3 * found.pop(key) for key in ("sa", "sq", "sz")}
    return lengths | found
