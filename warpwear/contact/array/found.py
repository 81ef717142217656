"""Users get this of what is asked of a finished contact: what flows through its gap, how hot it gets."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from warpwear.contact.array.arguments import number, shape_of, shown
from warpwear.errors import InputError
from warpwear.grid import FloatArray


@dataclass(frozen=True)
class FlowFactors:
    """Tells what flows through the gap of a contact, over what would through a gap of its mean everywhere.

    Attributes
    ----------
    along, across : float
        Of a pressure that falls along axis 0 and along axis 1, over the cube of the mean gap (Patir and Cheng
        1978, J. Lubr. Technol. 100, 12); exactly 0 where no way is open.
    shear : float
        Of the surface's sliding along axis 0 under a smooth one, over half the sliding speed and the mean gap
        (Patir and Cheng 1979, J. Lubr. Technol. 101, 220, whose factor is this × mean gap / rms roughness).
    is_open : tuple of bool
        Whether a way leads through, along axis 0 and along axis 1.
    mean_gap, nominal_gap : float
        Of the deformed surface, 0 where it touches; and between the mean planes before they were deformed,
        which may be negative.
    """

    along: float
    across: float
    shear: float
    is_open: tuple[bool, bool]
    mean_gap: float  # length
    nominal_gap: float  # length

    @property
    def nominal(self) -> tuple[float, float] | None:
        """Return what is along and across over the cube of the nominal gap; None where that is below 0."""
        if self.nominal_gap <= 0.0:
            return None
        cube = (self.mean_gap / self.nominal_gap) ** 3
        return self.along * cube, self.across * cube

    def leakage(self, pressure_drop: float, *, viscosity: float, length: float, axis: int = 0) -> float:
        """Return what leaks through a strip of the contact.

        Parameters
        ----------
        pressure_drop, viscosity, length : float
            The pressure falls by so much over so long a strip; the fluid's viscosity is a pressure × time.
        axis : {0, 1}
            Along which it falls.

        Returns
        -------
        float
            A volume over time and width: an area over a time.

        Raises
        ------
        InputError
            For another axis, and a number that is not positive.
        """
        if shape_of(axis) or axis not in (0, 1):
            raise InputError(f"axis = {shown(axis)} is not possible; it must be 0 or 1.")
        numbers = {"pressure_drop": pressure_drop, "viscosity": viscosity, "length": length}
        drop, viscosity, length = (number(name, value, optional=False) for name, value in numbers.items())
        return float(
            (self.across if axis else self.along) * self.mean_gap**3 * drop / (12.0 * viscosity * length)
        )


@dataclass(frozen=True, eq=False)
class Flash:
    """Tells how hot a sliding contact gets, and which body its heat flows into.

    Attributes
    ----------
    heat : array
        What friction makes, of each cell a power over an area, shape (nx, ny).
    heat_into : array
        What of it flows into the body with the heights; it may be below 0, or above all, of single cells.
    temperature : array
        Of the cells in contact, where both bodies are as hot; NaN elsewhere.
    """

    heat: FloatArray
    heat_into: FloatArray
    temperature: FloatArray

    @cached_property
    def largest(self) -> float:
        """Return the largest temperature; 0 where nothing touches."""
        return float(np.nanmax(self.temperature)) if self.heat.any() else 0.0

    @cached_property
    def mean(self) -> float:
        """Return the mean temperature of the cells in contact; 0 where nothing touches."""
        return float(np.nanmean(self.temperature)) if self.heat.any() else 0.0

    @cached_property
    def share(self) -> float:
        """Return the share of the heat that flows into the body with the heights."""
        return float(self.heat_into.sum() / (self.heat.sum() or 1.0))
