"""One step of a run that goes on, as those see it who watch it."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.quantities import UNITS, columns_of
from warpwear.history.rows import Named
from warpwear.history.snapshot import Snapshot
from warpwear.runs.order import RunOrder


@dataclass(frozen=True, eq=False, repr=False)
class RunStep:
    """One step that was just made: its row of the history and, until the next is made, its fields.

    Attributes
    ----------
    index : int
        Of the row in the history.
    count : int
        Steps of the whole run, those of cycles that are jumped over included.
    """

    index: int
    count: int
    _order: RunOrder
    _booked: dict[str, float]
    _fields: Callable[[], Snapshot | None]

    @cached_property
    def row(self) -> dict[str, float]:
        """Name -> value of every column of the history, in the units of `units`.

        The coefficient of friction is NaN where it is calibrated: with the whole run. So is its energy, a
        sum over all steps.
        """
        row = Named((name, self._booked.get(name, np.nan)) for name in self._order.columns)
        if self._order.study.friction.fitted in (None, "coulomb", "states"):
            history = {name: np.array([value]) for name, value in row.items()}
            row["cof"] = float(self._order.cof_of(history, finished=False)[0])
        return row

    @property
    def units(self) -> dict[str, str]:
        """Map the name of a column or field to its unit, such as "mm^2"."""
        return Named(UNITS | {column.name: column.units for column in columns_of(self._order.study)})

    @property
    def fields(self) -> dict[str, FloatArray]:
        """Name -> field of this step, as those of `snapshot()`."""
        return self.snapshot().fields

    def snapshot(self) -> Snapshot:
        """Copy pressure, wear of both bodies and gap after this step.

        Returns
        -------
        Snapshot
            The fields, which stay as they are.

        Raises
        ------
        InputError
            Where a later step has been made: the fields are then of that one.
        """
        snapshot = self._fields()
        if snapshot is None:
            raise InputError(
                f"step {self.index} is over: its fields are there until the next one is made; take "
                "snapshot() before."
            )
        return deepcopy(snapshot)  # on a CPU a model gives views of what it works on

    def __repr__(self) -> str:
        distance, area = self._booked["distance"], self._booked["area_contact"]
        return f"<step {self.index} of {self.count}: {distance:g} mm slid, {area:.4g} mm² in contact>"
