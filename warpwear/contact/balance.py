"""Load balance: the approach at which the pressures carry the load, as a solved contact has it.

How it is searched for is told in `kernels.balance` and `kernels.bearing`; `search` says it to a program.
"""

from typing import Any, NamedTuple

import numpy as np

from warpwear.errors import ConvergenceError

#: Residual of the balance of a contact with compliance, relative to the load.
TOLERANCE = 1.0e-12
#: Stands for 1/c where c = 0: any overlap reaches the cap.
RIGID = 1.0e300
MAX_EVALUATIONS = 400


class Balance(NamedTuple):
    """Holds of a solved contact what `contact.pressure_of` needs, and how well the load is met."""

    base: float  # approach = base + offset [mm]
    offset: float  # [mm]
    cap: float  # pressure of a cell at its cap [MPa]
    load_residual: float  # carried at hardness − asked for [N]
    tie_width: float = 0.0  # [mm]
    tie_pressure: float = 0.0  # pressure that tied cells share [MPa]
    evaluations: int = 0

    @property
    def approach(self) -> float:
        """Return the rigid approach from the mean planes [mm]."""
        return self.base + self.offset


def stiffness_of(compliance: Any) -> Any:
    """Return 1/c [N/mm³] of a compliance c [mm³/N], or of an array of them, `RIGID` at most."""
    with np.errstate(divide="ignore", over="ignore"):
        return np.minimum(np.divide(1.0, compliance), RIGID)


def checked_residual(residual: float, load: float, *, approach: float) -> float:
    """Return what the pressures that wore carry beyond the load [N]. approach: theirs [mm].

    Raises ConvergenceError where it is more than a balance and its rounding leave.
    """
    if not abs(residual) <= 2.0 * TOLERANCE * load:
        raise ConvergenceError(
            f"{residual:.3g} N of {load:.6g} N are left at an approach of {approach:.9g} mm."
        )
    return residual
