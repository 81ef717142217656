"""A snapshot holds the fields of one moment of a run."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.quantities import FIELDS
from warpwear.surfaces.base import BoolArray

#: Fields of every run, and those by which the disc lies lower or higher beside its wear.
NAMED = ("pressure", "wear_counter", "wear_disc", "gap")
LOWERING = tuple(name for name, one in FIELDS.items() if one.lowers and name not in NAMED)
#: Fields that keep all digits: the cells at the hardness are told by its very value.
EXACT = ("pressure",)


@dataclass(frozen=True, repr=False)
class Snapshot:
    """Hold the fields at one sliding distance, each of shape (nx, ny), axis 0 along the sliding direction.

    Of a swept run the fields of the disc cover the track, shape (rows, ny), whose row number `row` lies under
    the first row of the others. What features have are attributes as the others are: bare, slip,
    material_disc, plastic_disc (depth displaced for good [mm], of a swept disc that keeps its dents); None
    where a run has none.

    Attributes
    ----------
    distance : float
        Slid so far [mm].
    pressure : array
        Solved in the step that ends here [MPa].
    wear_counter, wear_disc : array
        Depths worn off [mm].
    gap : array
        After the step's wear, without elastic deformation [mm].
    own : dict
        What features have, by the names of cells' quantities.
    row : int or None
        Of the track under the first row of the others.
    load_on_filled : float or None
        Share of the load on points that the disc's file lacks.
    fresh : frozenset of str
        Names of fields that no later step changes.
    """

    distance: float
    pressure: FloatArray
    wear_counter: FloatArray
    wear_disc: FloatArray
    gap: FloatArray
    own: dict[str, FloatArray] = field(default_factory=dict)
    row: int | None = None
    load_on_filled: float | None = None  # see `share_on`
    fresh: frozenset[str] = frozenset()  # names of fields that no later step changes

    @property
    def fields(self) -> dict[str, FloatArray]:
        """Name -> field, of those that there are; units in `warpwear.history.quantities`."""
        return {name: getattr(self, name) for name in NAMED} | self.own

    def __getattr__(self, name: str) -> FloatArray | None:
        """Return a field of a feature; None where the run has none."""
        if name not in FIELDS or name in NAMED:
            raise AttributeError(f"a snapshot has no {name!r}")
        return self.own.get(name)

    @classmethod
    def of(cls, distance: float, values: Mapping[str, FloatArray], **others: Any) -> Self:
        """Return a snapshot of fields by name. Raises TypeError for one that is no quantity of a cell.

        Or that is not of the size of what it lies on.
        """
        own = {name: one for name, one in values.items() if name not in NAMED}
        for name, one in own.items():
            if name not in FIELDS:
                raise TypeError(f"{name} is not declared: see history/quantities.toml, [cell]")
            like = values["wear_disc" if FIELDS[name].frame == "disc" else "pressure"]
            if one.shape != like.shape:
                raise TypeError(f"{name} is of {one.shape} cells, where its frame has {like.shape}")
        named: dict[str, Any] = {name: values[name] for name in NAMED}
        return cls(distance, own=own, **named, **others)

    def lasting(self) -> "Snapshot":
        """Return a snapshot of its own: fields that a later step changes are copied."""
        copies = {k: v if k in self.fresh else v.copy() for k, v in self.fields.items()}
        others = {name: getattr(self, name) for name in ("row", "load_on_filled", "fresh")}
        return Snapshot.of(self.distance, copies, **others)

    def rounded(self) -> "Snapshot":
        """Return a snapshot of its own with the digits of single precision, but for the fields of EXACT."""
        whole = self.lasting()
        for name in whole.fields.keys() - {*EXACT}:
            values = whole.fields[name]
            values[...] = values.astype(np.float32)
        return whole

    def __repr__(self) -> str:
        nx, ny = self.pressure.shape
        return f"<Snapshot at {self.distance:g} mm, {nx} × {ny} cells: {', '.join(self.fields)}>"

    def share_on(self, filled: BoolArray) -> float:
        """Return the share of the load on points of the disc that were not measured.

        At rest it is that of the step. Of a swept run it is the mean over its way so far, by the wear of the
        disc, or, where that does not wear, that of the step.
        """
        carried, here = self.pressure, filled
        if self.row is not None and self.wear_disc.any():
            carried = self.wear_disc
        elif self.row is not None:
            here = self.beneath(filled)
        return float(np.sum(carried, where=here) / np.sum(carried))

    @property
    def wear_beneath(self) -> FloatArray:
        """Return the wear of the disc under the counter-body's domain [mm], shape (nx, ny)."""
        return self.wear_disc if self.row is None else np.asarray(self.beneath(self.wear_disc))

    @property
    def touched(self) -> BoolArray:
        """Return the cells ever touched, shape (nx, ny).

        Of a swept run they are those of the counter-body, or of the disc beneath a ball that does not wear.
        """
        touched = (self.wear_counter > 0.0) | (self.pressure > 0.0)
        if self.row is not None and self.wear_counter.any():
            return np.asarray(touched)
        return np.asarray(touched | (self.wear_beneath > 0.0))

    @cached_property
    def scar(self) -> tuple[slice, slice]:
        """Return the rows and columns from the first to the last touched cell; none where no cell is."""
        return extents(self.touched)

    @property
    def lost_beneath(self) -> FloatArray:
        """Return by how much the disc lies lower under the ball's domain [mm]: what is worn, and the rest."""
        cut = np.asarray if self.row is None else self.beneath
        own = {name: cut(self.own[name]) for name in LOWERING if name in self.own}
        return np.asarray(self.wear_beneath + lowered(own))

    def beneath(self, field: Any) -> Any:
        """Cut the part under the ball's domain, shape (nx, ny), out of a field of the track, (rows, ny)."""
        assert self.row is not None
        rows = np.arange(self.row, self.row + self.pressure.shape[0]) % field.shape[0]
        return np.asarray(field[rows])


def lowered(fields: Mapping[str, Any], rows: slice = slice(None)) -> Any:
    """Return by how much the disc lies lower beside its wear [mm], by fields; 0 where none says so."""
    return sum(FIELDS[name].lowers * fields[name][rows] for name in LOWERING if name in fields)


def extents(where: BoolArray) -> tuple[slice, slice]:
    """Return the rows and columns from the first to the last that has a place; none where there is none."""
    lines = (np.flatnonzero(where.any(axis=axis)) for axis in (1, 0))
    rows, columns = (slice(at[0], at[-1] + 1) if at.size else slice(0, 0) for at in lines)
    return rows, columns
