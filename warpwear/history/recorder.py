"""What the steps of a contact add up to, and the row of the history that each one gives."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from warpwear.contact.balance import Balance
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray, Grid
from warpwear.history.quantities import per
from warpwear.kernels.cells import MAXIMA
from warpwear.laws.task import ContactTask

#: Columns to which each step adds.
SUMMED = ("distance", "area_cumulative", "archard_volume_sphere", "archard_volume_disc")


@dataclass(frozen=True)
class Step:
    """A step holds what one increment left: its balance, its row, and what it touched."""

    balance: Balance
    row: dict[str, float]  # the columns of warpwear.history except time and cof
    touches_edge: bool  # of the domain
    touches_rim: bool  # of the sphere: the contact is as wide as the sphere itself
    pressure: FloatArray | None = None  # [MPa], shape (nx, ny), when it was asked for


def divided(found: Mapping[str, float], fractions: tuple[float, float]) -> dict[str, float]:
    """Sums or maxima of "worn", by both bodies, as those of sphere and disc: a small one is no difference."""
    rest = {name: value for name, value in found.items() if name != "worn"}
    sphere, disc = fractions
    return rest | {"wear_sphere": sphere * found["worn"], "wear_disc": disc * found["worn"]}


class Ledger:
    """The books of one contact: its last row, and the largest of what only ever grows.

    row: columns of the last step, 0 before the first. most: by the names of `kernels.cells.MAXIMA`. weight:
    area that a cell stands for over its own. margin: cells along the edge that must not be touched.
    track_fraction: of the stroke, that a disc that slides covers; the disc's volumes are those of the stroke.
    """

    STATE: ClassVar = {"most": dict, "row": dict}

    def __init__(
        self,
        task: ContactTask,
        grid: Grid,
        *,
        weight: float = 1.0,
        margin: int = 1,
        track_fraction: float = 1.0,
    ) -> None:
        self._task, self._grid, self._weight, self._margin = task, grid, weight, margin
        self._track_fraction = track_fraction
        self._x, self._y = grid.x, grid.y
        self.most = dict.fromkeys(MAXIMA, -math.inf)
        self.row = {column.name: 0.0 for column in per("step")}

    def restored(self) -> None:
        """Raise ValueError for books that no step has left."""
        books = {name: self.row.get(name) for name in SUMMED} | {name: self.most.get(name) for name in MAXIMA}
        for name, value in books.items():
            if not isinstance(value, int | float):
                raise ValueError(f"the books have no {name}")

    @property
    def columns(self) -> tuple[int, int]:
        """First column that was ever touched, and the one after the last; 0, 0 before the first step."""
        first, last = (self.most[name] for name in ("first_column", "last_column"))
        return (int(-first), int(last) + 1) if math.isfinite(first) else (0, 0)

    def enter(
        self,
        balance: Balance,
        increment: float,
        removal: tuple[float, float],
        reference: float,
        total: Mapping[str, float],
        most: Mapping[str, float],
        *,
        pressure: FloatArray | None = None,
        bearing: float | None = None,
    ) -> Step:
        """Book a step of an increment [mm] that wore sphere and disc by K ΔL = removal [mm³/N].

        total, most: what the kernels found, by the names of `SUMS` and `MAXIMA`. reference: pressure from
        which the squares count [MPa]. bearing: cells' area that bears, where not all that is in contact does.
        The row has `plastic_volume_disc` where the totals have "pressed_disc".

        Raises ConvergenceError where nothing is in contact.
        """
        grid, area, load = self._grid, self._weight * self._grid.cell_area, self._task.load
        count = total["contact"]
        if not count > 0.0 or not math.isfinite(total["pressure"]):
            raise ConvergenceError(f"no cell is in contact at an approach of {balance.approach:.6g} mm.")
        # What was reached once stays so, also where the tiles visited now do not show it.
        self.most = {name: max(most[name], self.most[name]) for name in self.most}
        first_row, last_row = int(-self.most["first_row"]), int(self.most["last_row"])
        first_column, last_column = int(-self.most["first_column"]), int(self.most["last_column"])
        along = (last_row - first_row + 1) * grid.cell
        across = (last_column - first_column + 1) * grid.cell
        mean = total["pressure"] / count
        variance = total["deviation_squared"] / count - (mean - reference) ** 2
        in_contact = (count if bearing is None else bearing) * area
        before = self.row
        self.row = {
            "distance": before["distance"] + increment,
            "increment": increment,
            "approach": balance.approach,
            "load": load,
            "load_residual": balance.load_residual,
            "area_contact": in_contact,
            "area_plastic": total["capped"] * area,
            "area_touched": total["touched"] * area,
            "area_cumulative": before["area_cumulative"] + in_contact,
            "area_nominal": math.pi / 4.0 * along * across,
            "patch_along": along,
            "patch_across": across,
            "pressure_mean": mean,
            "pressure_std": math.sqrt(max(variance, 0.0)),
            "pressure_max": most["pressure"],
            "wear_volume_sphere": total["wear_sphere"] * area,
            "wear_volume_disc": total["wear_disc"] / self._track_fraction * area,
            "wear_depth_sphere": self.most["wear_sphere"],
            "wear_depth_disc": self.most["wear_disc"],
            "cells_in_contact": count,
            "archard_volume_sphere": before["archard_volume_sphere"] + removal[0] * load,
            "archard_volume_disc": before["archard_volume_disc"]
            + removal[1] * total.get("pressure_times_factor", total["pressure"]) * area,
            "evaluations": float(balance.evaluations),
        }
        if "pressed_disc" in total:
            self.row["plastic_volume_disc"] = total["pressed_disc"] / self._track_fraction * area
        margin = self._margin
        at_edge = min(first_row, first_column) < margin
        at_edge |= last_row >= grid.nx - margin or last_column >= grid.ny - margin
        # Beyond the sphere's rim there is nothing to touch: a contact as wide as the sphere is cut off.
        reach = max(-self._x[first_row], self._x[last_row], -self._y[first_column], self._y[last_column])
        beyond_sphere = bool((reach + 1.5 * grid.cell) * self._task.curvature >= 1.0)
        return Step(balance, self.row, at_edge, beyond_sphere, pressure)
