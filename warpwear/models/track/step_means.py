"""A step on the half-space is made in parts: what each is like, and what they add up to."""

from collections.abc import Mapping
from dataclasses import dataclass

from warpwear.contact.balance import checked_residual
from warpwear.contact.certificate import Certificate, columns_of
from warpwear.contact.half_space.solver import HalfSpaceContact
from warpwear.laws.task import ContactTask

#: Sums that are averaged over the parts of a step; the others accumulate: the last part's are the step's.
OF_A_PART = ("pressure", "deviation_squared", "contact", "capped", "bare", "rubbed")
#: The same where K goes with the pressure.
BY_PRESSURE = ("wearing_counter", "pressure_times_factor")


@dataclass(frozen=True)
class Substep:
    """Describes a part of a step."""

    start: float  # sliding distance at its start [mm]
    increment: float  # [mm]
    weight: float  # part of the step
    removals: tuple[float, float]  # K ΔL of counter and disc [mm³/N]
    shears: tuple[float, float]  # depths that shear wears off cells in contact [mm]


class StepMeans:
    """Keeps the means over the parts of a step, and what is the largest or the sum of them.

    Of a step over an increment [mm] that begins at a distance [mm].
    """

    def __init__(self, task: ContactTask, track_fraction: float, start: float, increment: float) -> None:
        self._task, self._start, self._increment = task, start, increment
        counter, disc = task.wear_per_contact(start, increment)
        self._shears, self._track_fraction = (counter, disc), track_fraction
        self.approach = self.residual = self.highest = 0.0  # [mm], [N], [MPa]
        self.total = dict.fromkeys(OF_A_PART + (BY_PRESSURE if len(task.knots) else ()), 0.0)
        #: K ΔL of counter and disc, and the depths that shear wears off cells in contact.
        self.removals = (0.0, 0.0, counter, disc)
        self.transforms = 0
        self._error, self._parts, self._last_row = 0.0, 0, dict[str, float]()
        self._certificates: list[Certificate | None] = []

    def part(self, begins: float, weight: float) -> Substep:
        """Return the part of the step that begins after so much of it and has such a weight."""
        start, increment = self._start + self._increment * begins, self._increment * weight
        shears = weight * self._shears[0], weight * self._track_fraction * self._shears[1]
        return Substep(start, increment, weight, self._task.wear_per_pressure(start, increment), shears)

    def add(
        self,
        part: Substep,
        contact: HalfSpaceContact,
        force: float,
        sums: Mapping[str, float],
        *,
        highest: float,
        error: float,
        worn: tuple[float, float],
        row: Mapping[str, float],
    ) -> None:
        """Add a part: its contact, the force [N] and the sums by which it wore.

        highest: pressure [MPa]. error: of the area by its length. worn: K ΔL that bodies wore by. row: what
        features say of it.

        Raises ConvergenceError where the force is not the load.
        """
        load, (counter, disc) = self._task.load, self._shears
        residual = checked_residual(force - load, load, approach=contact.approach)
        self.residual = max(self.residual, residual, key=abs)
        # Wear by shear lowers all cells in contact by one depth, which changes the approach alone; what
        # some cells lose beyond it was in their gap.
        shear_depth = part.weight * (counter + self._track_fraction * disc)
        shear_depth *= self._task.shear_ratios["least_shear_ratio"]
        self.approach += part.weight * (contact.approach + shear_depth)
        self.removals = self.removals[0] + worn[0], self.removals[1] + worn[1], counter, disc
        self.highest, self._error = max(self.highest, highest), max(self._error, error)
        for name in self.total:
            self.total[name] += part.weight * sums[name]
        self._parts, self.transforms = self._parts + 1, self.transforms + contact.transforms
        self._certificates.append(contact.certificate)
        self._last_row = dict(row)

    @property
    def row(self) -> dict[str, float]:
        """Return the columns of the row of the step that only such steps have."""
        of_parts = {"parts": float(self._parts), "area_error": self._error}
        return of_parts | columns_of(*self._certificates) | self._last_row
