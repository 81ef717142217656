"""Users get this of a contact with friction that is sheared, and of what its traction is worth."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from warpwear.contact.array.contact import ArrayContact
from warpwear.grid import FloatArray


@dataclass(frozen=True)
class ShearCertificate:
    """Tells what a tangential traction q within friction's bound c = μ p is worth, reckoned anew from it.

    s is the slip of the increment. The conditions are s = 0 where ‖q‖ < c, else s along q.

    Attributes
    ----------
    violation : float
        Largest breach of these, over the largest displacement that c itself makes.
    allowed : float
        What may be left of it, the tolerance or, where that is more, what rounding shows.
    beyond_bounds : float
        By how much ‖q‖ exceeds c, a pressure.
    force_residual : float
        Force missed, over μ P; 0 at a displacement.
    energy_gap : float
        Σ c ‖s‖ − q·s, times the area of a cell. No other traction within the bounds, of the same force where
        a force is prescribed, has an energy ½ q·Aq − q·(rhs + D) that is lower by more (Frank and Wolfe 1956,
        Nav. Res. Logist. Q. 3, 95): s is that energy's negative gradient, and no other traction of a cell
        gives more than c ‖s‖ − q·s along it.
    relative_gap : float
        That over Σ c times the scale of violations.
    """

    violation: float
    allowed: float
    beyond_bounds: float
    force_residual: float
    energy_gap: float
    relative_gap: float


@dataclass(frozen=True, eq=False)
class ShearedContact:
    """Holds the tangential traction of a contact after an increment. Units are the caller's.

    Attributes
    ----------
    contact : ArrayContact
        The normal contact that it acts in; of dissimilar bodies as changed by the traction.
    friction : float
        μ, as it was given.
    traction : array
        On the surface of heights along axis 0 and axis 1, shape (2, nx, ny), so that ``qx, qy = traction``.
    slip : array
        Of the surfaces in contact on each other during this increment, shape (2, nx, ny); 0 out of contact,
        and where they stick but for the tolerance.
    stick : array of bool
        Cells in contact whose traction is below friction's bound, shape (nx, ny).
    displacement : tuple of float
        Rigid, along both axes, since the first increment.
    energy : float
        Dissipated in this increment.
    certificate : ShearCertificate
        What the traction is worth.
    evaluations, iterations : int
        Responses and their inverses, of four Fourier transforms each, and steps of the search.
    """

    contact: ArrayContact
    friction: float
    traction: FloatArray  # pressure
    slip: FloatArray  # length
    stick: npt.NDArray[np.bool_]
    displacement: tuple[float, float]  # length
    energy: float  # force times length
    certificate: ShearCertificate
    evaluations: int
    iterations: int

    @cached_property
    def force(self) -> tuple[float, float]:
        """Return the sum of the tractions, each times the area of a cell, along both axes: forces."""
        along, across = (self.traction.sum(axis=(1, 2)) * self.contact.cell**2).tolist()
        return along, across

    @cached_property
    def stick_area(self) -> float:
        """Return the area of the cells that stick: a length²."""
        return np.count_nonzero(self.stick) * self.contact.cell**2

    def __repr__(self) -> str:
        return (
            f"<sheared contact: force ({self.force[0]:.4g}, {self.force[1]:.4g}), displacement "
            f"({self.displacement[0]:.4g}, {self.displacement[1]:.4g}), sticks on {self.stick_area:.4g} of "
            f"{self.contact.area:.4g}, {self.iterations} iterations>"
        )
