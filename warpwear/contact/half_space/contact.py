"""A solver of the half-space leaves what it found as one of these."""

from dataclasses import dataclass

import numpy as np

from warpwear.contact.certificate import Certificate
from warpwear.engine.executor import Executor, Field
from warpwear.grid import FloatArray


@dataclass(frozen=True)
class HalfSpaceContact:
    """Holds a solved contact. The fields are the solver's own and last until its next solve."""

    approaches: FloatArray  # rigid, from the mean planes: of all cells, or row by row [mm]
    mean_pressure: float  # [MPa]
    violation: float  # largest violation of complementarity, over the rms height
    load_residual: float  # mean pressure over the prescribed one, − 1, furthest from 0; 0 at an approach
    cells_in_contact: int  # with p > 0
    iterations: int
    transforms: int  # pairs of Fourier transforms of the search; a certificate takes one more
    pressure_field: Field
    gradient_field: Field  # gap after deformation and wear, from the mean planes [mm]
    executor: Executor
    cells: int  # of the surface
    allowed: FloatArray  # violation that may be left, of each part [mm]
    certificate: Certificate | None = None

    @property
    def approach(self) -> float:
        """Return the one approach that all cells share [mm]."""
        return float(self.approaches.item())

    @property
    def pressure(self) -> FloatArray:
        """Return the pressure [MPa], shape (nx, ny)."""
        return self.executor.to_numpy(self.pressure_field)

    @property
    def area_fraction(self) -> float:
        """Return the contact area over the nominal one."""
        return self.cells_in_contact / self.cells

    @property
    def separation(self) -> FloatArray:
        """Return the gap left by deformation and implicit wear [mm], shape (nx, ny); negative where p = H."""
        return np.asarray(self.executor.to_numpy(self.gradient_field) - self.approach)


def residual_of(total: FloatArray, loads: FloatArray | None) -> float:
    """Return the relative residual of the load, of the part where it is furthest from 0; 0 at an approach."""
    if loads is None:
        return 0.0
    over = np.divide(total, loads, out=1.0 + total, where=loads > 0.0) - 1.0
    return float(over[np.argmax(np.abs(over))])


def worst_of(violation: FloatArray, scale: FloatArray) -> float:
    """Return the largest violation over the scale of its part."""
    return float(np.divide(violation, scale, out=np.zeros_like(scale), where=violation > 0.0).max())
