"""A snapshot holds the fields of one moment of a run."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray


@dataclass(frozen=True, repr=False)
class Snapshot:
    """Hold the fields at one sliding distance, each of shape (nx, ny), axis 0 along the sliding direction.

    distance [mm]. pressure [MPa], solved in the step that ends here. wear_counter, wear_disc: depths worn off
    [mm]. gap [mm], after the step's wear, without elastic deformation. plastic_disc: depth displaced for good
    [mm], of a swept disc that keeps its dents. bare: 1 where a cell was bare of film as the step began, else
    0. slip: way of places in contact in a cycle of fretting [mm]. material_counter, material_disc:
    number of the layer that wear has bared, 0 the uppermost. load_on_filled: share of the load on
    points that the disc's file lacks. Those from plastic_disc on are None where a run has none.

    Of a swept run the fields of the disc cover the track, shape (rows, ny), whose row number `row` lies under
    the first row of the others.
    """

    distance: float
    pressure: FloatArray
    wear_counter: FloatArray
    wear_disc: FloatArray
    gap: FloatArray
    plastic_disc: FloatArray | None = None
    bare: FloatArray | None = None
    slip: FloatArray | None = None
    material_counter: FloatArray | None = None
    material_disc: FloatArray | None = None
    row: int | None = None
    load_on_filled: float | None = None  # see `share_on`
    fresh: frozenset[str] = frozenset()  # names of fields that no later step changes

    @property
    def fields(self) -> dict[str, FloatArray]:
        """Name -> field, of those that there are; units in `warpwear.history.quantities`."""
        return {name: values for name, values in vars(self).items() if isinstance(values, np.ndarray)}

    def lasting(self) -> "Snapshot":
        """Return a snapshot of its own: fields that a later step changes are copied."""
        changing: dict[str, Any] = {k: v for k, v in self.fields.items() if k not in self.fresh}
        return replace(self, **{name: values.copy() for name, values in changing.items()})

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
        """Return what is gone of the disc under the ball's domain [mm]: worn, or displaced for good."""
        if self.plastic_disc is None:
            return self.wear_beneath
        return np.asarray(self.wear_beneath + self.beneath(self.plastic_disc))

    def beneath(self, field: Any) -> Any:
        """Cut the part under the ball's domain, shape (nx, ny), out of a field of the track, (rows, ny)."""
        assert self.row is not None
        rows = np.arange(self.row, self.row + self.pressure.shape[0]) % field.shape[0]
        return np.asarray(field[rows])


def extents(where: BoolArray) -> tuple[slice, slice]:
    """Return the rows and columns from the first to the last that has a place; none where there is none."""
    lines = (np.flatnonzero(where.any(axis=axis)) for axis in (1, 0))
    rows, columns = (slice(at[0], at[-1] + 1) if at.size else slice(0, 0) for at in lines)
    return rows, columns
