"""Users get this of what is asked of a finished contact: what flows through its gap."""

from dataclasses import dataclass

from warpwear.contact.array.arguments import number


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
        Of the deformed surface, where it touches 0; and between the mean planes before they were deformed, which
        may be negative.
    """

    along: float
    across: float
    shear: float
    is_open: tuple[bool, bool]
    mean_gap: float  # length
    nominal_gap: float  # length

    @property
    def nominal(self) -> tuple[float, float] | None:
        """Return the factors along and across over the cube of the nominal gap; None where that is below 0."""
        if self.nominal_gap <= 0.0:
            return None
        cube = (self.mean_gap / self.nominal_gap) ** 3
        return self.along * cube, self.across * cube

    def leakage(self, pressure_drop: float, *, viscosity: float, length: float, axis: int = 0) -> float:
        """Return what leaks through a strip in a time, a volume for each unit of its width.

        length: over which the pressure falls, along the axis.
        """
        numbers = {"pressure_drop": pressure_drop, "viscosity": viscosity, "length": length}
        drop, viscosity, length = (number(name, value, optional=False) for name, value in numbers.items())
        return float((self.along, self.across)[axis] * self.mean_gap**3 * drop / (12.0 * viscosity * length))
