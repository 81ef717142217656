"""A step on the half-space is made in parts: what each is like, and what they add up to."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from warpwear.contact.balance import checked_residual
from warpwear.contact.certificate import Certificate, columns_of
from warpwear.grid import FloatArray
from warpwear.laws.task import ContactTask

#: Sums that are averaged over the parts of a step; the others accumulate: the last part's are the step's.
OF_A_PART = ("pressure", "deviation_squared", "contact", "capped", "bare", "rubbed")
#: The same where K goes with the pressure.
BY_PRESSURE = ("wearing_counter", "pressure_times_factor")


class Made(NamedTuple):
    """Tells what some parts of a step have left, each a number of every array."""

    approaches: FloatArray  # [mm]
    transforms: int
    certificate: Certificate | None  # of the last
    sums: Mapping[str, FloatArray]
    most: Mapping[str, FloatArray]


class Substep(NamedTuple):
    """Describes a part of a step."""

    start: float  # sliding distance at its start [mm]
    increment: float  # [mm]
    weight: float  # part of the step
    removals: tuple[float, float]  # K ΔL of counter and disc [mm³/N]
    shears: tuple[float, float]  # depths that shear wears off cells in contact [mm]
    shift: int = 0  # the disc's row under the counter-body's first
    cells: int = 1  # of the disc that it goes over
    tolerance: float | None = None  # of its contact, see `solver.BoundedPressure`
    certified: bool | None = None

    def is_like(self, other: "Substep") -> bool:
        """Tell whether bodies wear as much in another one."""
        about = self.increment, self.removals, self.shears
        return about == (other.increment, other.removals, other.shears)


class StepMeans:
    """Keeps the means over the parts of a step, and what is the largest or the sum of them.

    Of a step over an increment [mm] that begins at a distance [mm]. by_pressure: whether K goes with that.
    """

    def __init__(
        self, task: ContactTask, track_fraction: float, start: float, increment: float, *, by_pressure: bool
    ) -> None:
        self._task, self._start, self._increment = task, start, increment
        counter, disc = task.wear_per_contact(start, increment)
        self._shears, self._track_fraction = (counter, disc), track_fraction
        self.approach = self.residual = self.highest = 0.0  # [mm], [N], [MPa]
        self.total = dict.fromkeys(OF_A_PART + (BY_PRESSURE if by_pressure else ()), 0.0)
        #: K ΔL of counter and disc, and the depths that shear wears off cells in contact.
        self.removals: tuple[float, ...] = (0.0, 0.0, counter, disc)
        self.transforms = 0
        self._parts, self._last_row = 0, dict[str, float]()
        self._certificates: list[Certificate | None] = []

    def part(self, begins: float, weight: float, *about: Any) -> Substep:
        """Return the part of the step that begins after so much of it and has such a weight.

        about: its last members.
        """
        start, increment = self._start + self._increment * begins, self._increment * weight
        shears = weight * self._shears[0], weight * self._track_fraction * self._shears[1]
        removals = self._task.wear_per_pressure(start, increment)
        return Substep(start, increment, weight, removals, shears, *about)

    def add(
        self,
        parts: Sequence[Substep],
        made: Made,
        *,
        cell_area: float,
        worn: tuple[float, float],
        row: Mapping[str, float],
    ) -> None:
        """Add parts by what they have left.

        cell_area: [mm²]. worn: K ΔL that bodies wore by in each. row: what
        features say of the last.

        Raises ConvergenceError where the pressures do not carry the load.
        """
        load, (counter, disc) = self._task.load, self._shears
        weights = np.array([part.weight for part in parts])
        # Wear by shear lowers all cells in contact by one depth, which changes the approach alone; what
        # some cells lose beyond it was in their gap.
        shear_depth = counter + self._track_fraction * disc
        shear_depth *= self._task.shear_ratios["least_shear_ratio"]
        approaches = weights * (made.approaches + weights * shear_depth)
        forces = made.sums["pressure"] * cell_area
        for force, approach, own in zip(
            *(values.tolist() for values in (forces, made.approaches, approaches)), strict=True
        ):
            residual = checked_residual(force - load, load, approach=approach)
            self.residual = max(self.residual, residual, key=abs)
            # One by one: how many were made in one go changes no digit.
            self.approach += own
            self.removals = self.removals[0] + worn[0], self.removals[1] + worn[1], counter, disc
        for name in self.total:
            for value in (weights * made.sums[name]).tolist():
                self.total[name] += value
        self.highest = max(self.highest, float(made.most["pressure"].max()))
        self._parts, self.transforms = self._parts + len(parts), self.transforms + made.transforms
        self._certificates.append(made.certificate)
        self._last_row = dict(row)

    @property
    def row(self) -> dict[str, float]:
        """Return the columns of the row of the step that only such steps have."""
        return {"parts": float(self._parts)} | columns_of(*self._certificates) | self._last_row
