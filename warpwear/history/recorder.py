"""The steps of a contact are added up, and each gives a row of the history."""

import functools
import math
import operator
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray, Grid
from warpwear.history.quantities import per
from warpwear.kernels.cells import EXTENTS, MAXIMA
from warpwear.kernels.running_in.materials import BOOKS
from warpwear.laws.archard import BODIES
from warpwear.laws.depth_profile import of_materials
from warpwear.laws.task import ContactTask
from warpwear.surfaces.base import BoolArray

#: Columns that grow from step to step.
RUNNING = ("distance", "area_cumulative", "archard_volume_counter", "archard_volume_disc")
#: Columns of the history, by name.
COLUMNS = {column.name: column for column in per("step")}
#: Columns that count a part of the stroke's disc for the whole, summed over the disc as it is.
DISC_COLUMNS = tuple(column.name for column in per("step") if column.frame == "disc")
#: First and last of what was touched, along and across; first ones are negated.
EXTENT_PAIRS = (EXTENTS[:2], EXTENTS[2:])
#: One of a step, or an array of those of many.
Number = Any


class Step(NamedTuple):
    """A step holds what one increment left: its row, and what it touched."""

    row: dict[str, float]  # the columns of warpwear.history that a ledger knows; a run adds to them
    touches_edge: bool  # of the domain
    touches_rim: bool  # of the counter-body: the contact is as wide as the counter-body itself
    pressure: FloatArray | None = None  # [MPa], shape (nx, ny), when it was asked for


@dataclass(frozen=True)
class StepColumns:
    """Holds steps in a row as columns: arrays of one number a step, as each `Step` of them has one."""

    columns: dict[str, FloatArray]
    touches_edge: BoolArray
    touches_rim: BoolArray

    def __len__(self) -> int:
        return len(self.touches_edge)

    def __iter__(self) -> Iterator[Step]:
        table = np.stack([*self.columns.values()], axis=1).tolist()
        # One by one: many at a time would be looked through for garbage.
        rows = (dict(zip(self.columns, values, strict=True)) for values in table)
        return map(Step, rows, self.touches_edge.tolist(), self.touches_rim.tolist())


def each_step(groups: Iterable[Step | StepColumns]) -> Iterator[Step]:
    """Yield steps one by one."""
    for group in groups:
        yield from group if isinstance(group, StepColumns) else (group,)


class Entry(NamedTuple):
    """A step as it is booked, or many in arrays: an increment [mm] wore the bodies by K ΔL [mm³/N].

    removal: K ΔL of counter-body and disc; where bodies wear by their shear the depths of cells in contact
    [mm] follow. reference: pressure from which the squares count [MPa]. total, most: what the kernels found,
    by the names of `SUMS` and `MAXIMA`; the totals have "bearing", how many cells' area bears, where not all
    that is in contact does.
    """

    balance: Any
    increment: Number
    removal: tuple[Number, ...]
    reference: Number
    total: Mapping[str, Number]
    most: Mapping[str, Number]


def split_wear(sums: Mapping[str, Number], fractions: tuple[float, float]) -> dict[str, Number]:
    """Split sums or maxima of what both bodies lose into those of counter and disc, exact for small ones."""
    (counter, disc), worn = fractions, sums["worn"]
    return {**sums, "wear_counter": counter * worn, "wear_disc": disc * worn}


class Ledger:
    """Keep the books of one contact: its last row, and the largest of what only ever grows.

    row: columns of the last step, 0 before the first. most: by the names of `kernels.cells.MAXIMA`. weight:
    area that a cell stands for over its own. margin: cells along the edge that must not be touched.
    track_fraction: of the stroke, that a disc that slides covers; the disc's volumes are those of the stroke.
    """

    STATE: ClassVar = {"most": dict, "row": dict, "before": dict}

    def __init__(
        self,
        task: ContactTask,
        grid: Grid,
        *,
        weight: float = 1.0,
        margin: int = 1,
        track_fraction: float = 1.0,
    ) -> None:
        self._task, self._grid, self._weight = task, grid, weight
        self._track_fraction = track_fraction
        # Beyond the ball's rim there is nothing to touch: a contact as wide as the ball is cut off.
        widths = (grid.x + 1.5 * grid.cell, grid.y + 1.5 * grid.cell)
        rows, columns = (int(np.count_nonzero(width * task.form.curvature >= 1.0)) for width in widths)
        # A body that does not rise towards an edge ends there, and is to touch as far.
        margins = (margin if rises else -1 for rises in task.form.rises)
        self._edge, self._rim = self._inside(*margins), self._inside(rows, columns)
        #: By `EXTENTS`, as far as what is touched is neither at the edge nor at the rim.
        self.within = tuple(map(min, self._edge, self._rim))
        self._outline = 1.0 if task.form.is_line else math.pi / 4.0
        self.most = dict.fromkeys(MAXIMA, -math.inf)
        self.row = {column.name: 0.0 for column in per("step")}
        profiles = zip(BODIES, task.profiles or (), strict=False)
        volumes = [name for body in profiles for *_, name in of_materials(*body)]
        self.row |= dict.fromkeys(volumes, 0.0)
        self.running = (*RUNNING, *volumes)
        #: What the disc of a stroke lost on other strokes, over what this one makes of the same depths; or on
        #: other circles.
        self.before: dict[str, float] = {}

    def switch_stroke(self, track_fraction: float) -> None:
        """Go on with the volumes of a disc that stood for another stroke, as a part of it, before."""
        ratio = track_fraction / self._track_fraction
        for name in DISC_COLUMNS if ratio != 1.0 else ():
            total, before = self.row.get(name, 0.0), self.before.get(name, 0.0)
            self.before[name] = total - (total - before) * ratio

    def switch_circle(self, own: Mapping[str, float]) -> dict[str, float]:
        """Go on with another circle of the disc; return what is booked of the one that is left.

        own: what is booked of the other by now, volumes and the deepest wear; nothing where it is unworn.
        """
        left = {n: self.row.get(n, 0.0) - self.before.get(n, 0.0) for n in DISC_COLUMNS}
        left["deepest"], self.most["wear_disc"] = self.most["wear_disc"], own.get("deepest", 0.0)
        self.before = {n: self.row.get(n, 0.0) - own.get(n, 0.0) for n in DISC_COLUMNS}
        return left

    def restored(self) -> None:
        """Raise ValueError for books that no step has left."""
        for book, names in ((self.row, self.running), (self.most, MAXIMA)):
            for name in names:
                if not isinstance(book.get(name), int | float):
                    raise ValueError(f"the books have no {name}")

    @property
    def columns(self) -> tuple[int, int]:
        """Return the first column ever touched, and the one after the last; 0, 0 before the first step."""
        first, last = self.most["first_column"], self.most["last_column"]
        return (int(-first), int(last) + 1) if math.isfinite(first) else (0, 0)

    def enter(self, *entry: Any, pressure: FloatArray | None = None) -> Step:
        """Book a step. entry: the members of an `Entry`. pressure: of the step, where it was asked for [MPa].

        The row has what totals have by the name of a column: where that has a frame, as a sum of depths [mm]
        over a body's cells. It has `bare_fraction` where they have "bare".

        Raises ConvergenceError where nothing is in contact.
        """
        step = Entry(*entry)
        total, most = step.total, step.most
        if not total["contact"] > 0.0 or not math.isfinite(total["pressure"]):
            raise ConvergenceError(f"no cell is in contact at an approach of {step.balance.approach:.6g} mm.")
        # What was reached once stays so, also where the tiles visited now do not show it.
        self.most = {name: max(most[name], before) for name, before in self.most.items()}
        largest = self.most | {"pressure": most["pressure"]}
        row = self._row(step, largest)
        row["pressure_std"] = math.sqrt(max(row["pressure_std"], 0.0))
        for name in self.running:
            row[name] += self.row[name]
        self.row = row.copy()
        at_edge, at_rim = map(bool, self._reaches(self.most))
        return Step(row, at_edge, at_rim, pressure)

    def enter_all(self, *entry: Any) -> StepColumns:
        """Book steps in a row as `enter` does one: all are arrays of one number a step."""
        steps = Entry(*entry)
        most, count = steps.most, len(steps.increment)
        grown = {
            name: np.maximum.accumulate(np.maximum(most[name], before)) for name, before in self.most.items()
        }
        row = self._row(steps, grown | {"pressure": most["pressure"]})
        row["pressure_std"] = np.sqrt(np.maximum(row["pressure_std"], 0.0))
        for name in self.running:
            grows = np.broadcast_to(row[name], count)
            row[name] = np.add.accumulate(np.concatenate([[self.row[name]], grows]))[1:]
        columns = {name: np.broadcast_to(values, count) for name, values in row.items()}
        self.row = {name: float(values[-1]) for name, values in columns.items()}
        self.most = {name: float(values[-1]) for name, values in grown.items()}
        return StepColumns(columns, *self._reaches(grown))

    def _row(self, entry: "Entry", most: Mapping[str, Number]) -> dict[str, Any]:
        """Return the columns of a step, or of many: of `RUNNING` what they grow by, of the std its square."""
        balance, increment, removal, reference, total, _ = entry
        area, load = self._weight * self._grid.cell_area, self._task.load
        along, across = ((most[last] + most[first] + 1.0) * self._grid.cell for first, last in EXTENT_PAIRS)
        count = total["contact"]
        mean = total["pressure"] / count
        apart = mean - reference  # squared by Python for many as for one: NumPy rounds squares differently
        squared = apart**2 if isinstance(apart, float) else np.array([one**2 for one in apart.tolist()])
        in_contact = total.get("bearing", count) * area
        row = {
            "distance": increment,
            "increment": increment,
            "approach": balance.approach,
            "load": load,
            "load_residual": balance.load_residual,
            "area_contact": in_contact,
            "area_plastic": total["capped"] * area,
            "area_touched": total["touched"] * area,
            "area_cumulative": in_contact,
            "area_nominal": self._outline * along * across,
            "patch_along": along,
            "patch_across": across,
            "pressure_mean": mean,
            "pressure_std": total["deviation_squared"] / count - squared,
            "pressure_max": most["pressure"],
            "wear_volume_counter": total["wear_counter"] * area,
            "wear_volume_disc": total["wear_disc"] / self._track_fraction * area,
            "wear_depth_counter": most["wear_counter"],
            "wear_depth_disc": most["wear_disc"],
            "cells_in_contact": count,
            "archard_volume_counter": removal[0]
            * (total["wearing_counter"] * area if "wearing_counter" in total else load),
            "archard_volume_disc": removal[1] * total.get("pressure_times_factor", total["pressure"]) * area,
            "evaluations": 1.0 * balance.evaluations,
        }
        for column in [COLUMNS[name] for name in total if name in COLUMNS]:
            value = total[column.name] / (self._track_fraction if column.frame == "disc" else 1.0)
            row[column.name] = value * area if column.frame else value
        if "rubbed" in total:
            row["area_sheared"] = sheared = total["rubbed"] * area
            for body, depth in zip(BODIES, removal[2:], strict=True):
                row[f"archard_volume_{body}"] = row[f"archard_volume_{body}"] + depth * sheared
        if "bare" in total:
            row["bare_fraction"] = total["bare"] / count
        if self._task.profiles is not None:
            row |= self._material_columns(total, row)
        if self._task.shears_unalike:
            books, of_surfaces = total.get("materials"), self._task.surface_shear or math.nan
            row["area_sheared"] = area * books["shear_ratios"] if books else row["area_contact"] * of_surfaces
        return row | {name: row[name] + lost for name, lost in self.before.items() if name in row}

    def _material_columns(self, total: Mapping[str, Any], row: Mapping[str, Number]) -> dict[str, Any]:
        """Return what each material bears and has lost; Archard's volumes are those of all of a body.

        Without books of a step all cells are of the uppermost materials.
        """
        books, columns = total.get("materials"), dict[str, Any]()
        area = self._weight * self._grid.cell_area
        for body, profile in zip(BODIES, self._task.profiles or (), strict=True):
            names, archard = of_materials(body, profile), f"archard_volume_{body}"
            parts: list[tuple[Any, ...]] = [(1.0, row["area_contact"], row[archard])]
            if books is None:
                parts += [(0.0, 0.0, 0.0)] * len(names)
            else:
                whole = area / (self._track_fraction if body == "disc" else 1.0)
                of = {
                    name: [v for key, v in books.items() if key.startswith(f"{name}_{body}_")]
                    for name in BOOKS
                }
                # Not by sum(), which since Python 3.12 compensates floats, but no arrays.
                columns[archard] = whole * functools.reduce(operator.add, of["lost"])
                parts = [
                    (pressure / total["pressure"], area * cells, whole * lost)
                    for cells, pressure, lost in zip(*of.values(), strict=True)
                ]
            columns |= {n: v for pair in zip(names, parts, strict=False) for n, v in zip(*pair, strict=True)}
        return columns

    def _inside(self, rows: int, columns: int) -> tuple[float, ...]:
        """Return the extents of what leaves so many rows and columns along each edge."""
        return -rows, self._grid.nx - rows - 1, -columns, self._grid.ny - columns - 1

    def _reaches(self, most: Mapping[str, Number]) -> list[Number]:
        """Tell whether what was touched reaches the domain's edge, and whether the counter-body's rim."""
        pairs = [
            [most[name] > limit for name, limit in zip(EXTENTS, limits, strict=True)]
            for limits in (self._edge, self._rim)
        ]
        return [functools.reduce(operator.or_, reaches) for reaches in pairs]
