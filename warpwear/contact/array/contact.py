"""Users get this of a solved contact of an array of heights."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.contact.array.found import Flash, FlowFactors
from warpwear.contact.certificate import Certificate
from warpwear.errors import InputError
from warpwear.grid import FloatArray

#: What is asked of a finished contact by its methods alone; each brings kernels of its own.
conducting = lazy.module("warpwear.contact.joint.conductance")
flow, heating = lazy.module("warpwear.contact.joint.flow"), lazy.module("warpwear.contact.joint.flash")


@dataclass(frozen=True, eq=False)
class ArrayContact:
    """Holds a solved contact of an array of heights. Units are the caller's; fields have the heights' shape.

    Attributes
    ----------
    pressure : array
        Of every cell, shape (nx, ny).
    gap : array
        Distance between the bodies after elastic deformation, shape (nx, ny); 0 under a pressure below the
        hardness, negative where the hardness is reached (how deep the material has to flow), infinite beyond
        the counter-body.
    approach : float
        How far the plane, or the counter-body's lowest point, lies below the heights' mean plane; negative
        while it lies above.
    cell, hardness : float
        As they were given.
    certificate : Certificate
        Error bounds recomputed from the pressure; chiefly how far its energy can lie above the minimum. Its
        violation is `residual`, the largest breach of (gap = 0 under pressure, gap ≥ 0 elsewhere, gap ≤ 0 at
        the hardness), divided by the rms gap before contact.
    evaluations : int
        Pairs of Fourier transforms on a half-space, else passes over the cells that a trial approach took.
    modulus, boundary : float, str or None
        Of the half-space; None where there is none.
    """

    pressure: FloatArray  # pressure, shape (nx, ny)
    gap: FloatArray  # length, shape (nx, ny)
    approach: float  # length
    cell: float  # length
    hardness: float | None  # pressure
    certificate: Certificate
    evaluations: int
    modulus: float | None = None  # E*, pressure
    boundary: str | None = None

    @property
    def residual(self) -> float:
        """Return the largest breach of the contact conditions, divided by the rms gap before contact."""
        return self.certificate.violation

    @cached_property
    def load(self) -> float:
        """Return the sum of the pressures, each times the area of a cell: a force."""
        return float(self.pressure.sum()) * self.cell**2

    @property
    def mean_pressure(self) -> float:
        """Return the load over the nominal area, that of the whole array; `mean_real_pressure` is higher."""
        return self.load / self.nominal_area

    @property
    def mean_real_pressure(self) -> float:
        """Return the load over the real area of contact, `area`; 0 where nothing touches."""
        return self.load / self.area if self.area else 0.0

    @property
    def nominal_area(self) -> float:
        """Return the area of all cells of the array: a length²."""
        return self.pressure.size * self.cell**2

    @cached_property
    def area(self) -> float:
        """Return the real area of contact, a length², of the cells that carry a pressure."""
        return np.count_nonzero(self.pressure) * self.cell**2

    @cached_property
    def area_at_hardness(self) -> float:
        """Return the area, a length², of the cells whose pressure is the hardness; 0 without a hardness.

        Of a bearing area it may be a cell short of `area`: one cell carries what is left of the load.
        """
        if self.hardness is None:
            return 0.0
        return np.count_nonzero(self.pressure >= self.hardness) * self.cell**2

    @cached_property
    def conductions(self) -> dict[Any, Any]:
        """Return what its cells conduct, by what was asked; see `conductance`."""
        return {}

    def conductance(self, conductivity: float = 1.0, **options: Any) -> float:
        """Return what the contact conducts between the bodies, whose cells in contact have one potential.

        Where the surface repeats it is h × nominal area, else ∫ q over the potential: 2a of a round spot.

        Parameters
        ----------
        conductivity : float
            k_s = 2 k₁ k₂ / (k₁ + k₂) of both bodies, thermal or electrical; 1 returns a length.
        **options
            film_resistance, of a film on the area in contact, resistance × area; gap_conductivity of a gas or
            grease in the gap, with jump, a length by which that is longer for it and which it needs: without
            it, cells at the rims of spots would conduct the more the smaller they are. What it conducts is
            added as if it flowed straight across. boundary, by default that of the half-space; of a line what
            is found is out to a distance of the array's length along axis 0. device and threads.

        Returns
        -------
        float
            Conductivity × length; infinite in full contact of a surface that repeats.
        """
        return float(conducting.conductance(self, conductivity, **options))

    def stiffness(self, *, unloading: bool = False, **options: Any) -> float:
        """Return by how much the load grows over the approach.

        Parameters
        ----------
        unloading : bool
            Whether all cells in contact follow; else those at the hardness carry no more.
        **options
            boundary, device and threads, as of `conductance`.

        Returns
        -------
        float
            A force over a length.
        """
        return float(conducting.stiffness(self, unloading=unloading, **options))

    def flux(self, **options: Any) -> FloatArray:
        """Return the flux of `conductance` through each cell, over its mean.

        Parameters
        ----------
        **options
            film (resistance × area × conductivity, a length), boundary, device and threads.

        Returns
        -------
        array
            Of shape (nx, ny).
        """
        return np.asarray(conducting.flux(self, **options))

    def __repr__(self) -> str:
        return (
            f"<contact: area {self.area:.4g} of {self.nominal_area:.4g}, "
            f"mean pressure {self.mean_pressure:.4g}, approach {self.approach:.4g}, "
            f"{self.evaluations} evaluations>"
        )

    def flow_factors(self) -> FlowFactors:
        """Return what flows through the gap, of a contact whose surface repeats, computed once.

        A warning tells where the gap has waves of fewer than four cells.

        Returns
        -------
        FlowFactors
            Along both axes.

        Raises
        ------
        InputError
            For a contact on a free half-space, of a line, and under a counter-body.
        """
        return self._flow_factors

    @cached_property
    def _flow_factors(self) -> FlowFactors:
        factors: FlowFactors = flow.flow_factors(self)
        return factors

    def leakage(self, pressure_drop: float, **options: Any) -> float:
        """Return what leaks through a strip of the contact: `FlowFactors.leakage` of its `flow_factors`.

        Parameters
        ----------
        pressure_drop : float
            By which the pressure falls over the strip.
        **options
            viscosity, length and axis, as there.

        Returns
        -------
        float
            A volume over time and width: an area over a time.
        """
        return self.flow_factors().leakage(pressure_drop, **options)

    def flash(self, speed: float, **options: Any) -> Flash:
        """Return how hot the contact gets that slides along axis 0, and which body its heat flows into.

        Both are half-spaces, one of which moves steadily; nothing beside the array is heated.

        Parameters
        ----------
        speed : float
            Of sliding, a length over a time.
        **options
            conductivity and diffusivity, each a number of both bodies, or a pair: of the body with the
            heights and of the other one. k is a force over time and temperature, κ = k/(ρ c) a length² over a
            time: in mm, N and s that of W/(m K), and 10⁶ times that of m²/s. friction, of heat friction ×
            pressure × speed, or shear_strength, of heat shear_strength × speed wherever the bodies touch.
            moving: "heights" or "counter", the body that moves through the contact, which stays on the other
            one. bulk: the temperature of both far below, or a pair; by default 0, and what comes out is the
            rise. threads: of the CPU.

        Returns
        -------
        Flash
            Temperatures, heat, and how it is shared.

        Raises
        ------
        InputError
            For a line contact, and for numbers that are not possible.
        ConvergenceError
            Where the temperatures of both bodies cannot be made the same.
        """
        if self.boundary == "line":
            raise InputError('boundary = "line" is not possible for heat; it must be of limited extent.')
        hot: Flash = heating.flash(self.pressure, speed, cell=self.cell, **options)
        return hot
