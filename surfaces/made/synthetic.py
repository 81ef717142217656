"""What surfaces from formulas have in common: their parameters and notices; and the flat one."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import spacing
from warpwear.surfaces.made.fourier import ComplexArray, fourier_blocks, fourier_sum

LARGEST_MODE = 2048  # 17 million amplitudes; beyond, the spectrum no longer fits a small machine
POINTS_PER_CUT_OFF = 4  # of the reference grid on which Ra is defined
SLACK = 1e-9  # relative, so that 2.0/0.008 counts as 250 and a window of one period does not repeat


@dataclass(frozen=True, kw_only=True)
class Flat:
    """A flat surface is the plane z = 0."""

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return zeros [mm], shape (x.size, y.size)."""
        return np.zeros((x.size, y.size))

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Return no notice: a plane has no grid that is too coarse for it."""
        return []

    def record(self) -> dict[str, Any]:
        """Return the kind, and the roughness that every synthetic surface records."""
        return {"kind": "flat", "ra_um": 0.0, "sq_um": 0.0, "rms_slope": 0.0}


@dataclass(frozen=True, kw_only=True)
class Periodic:
    """Random surfaces repeat after a period, and have a shortest wave; lengths are in mm."""

    cut_off: float = 0.008  # shortest wavelength
    seed: int = 0
    period: float = 2.0  # distance after which the random part repeats, along both axes

    def _check_waves(self) -> None:
        """Raise InputError unless the waves are few enough, and the seed is one."""
        resolved = self.period / self.cut_off <= LARGEST_MODE * (1 + SLACK)
        shortest = self.period / LARGEST_MODE
        self._check("cut_off", resolved, f"at least period/{LARGEST_MODE} ({shortest:g} mm)")

    def _check(self, name: str, allowed: bool, expected: str, *, unit: str = "mm") -> None:
        """Raise InputError unless the value of a parameter is finite and allowed."""
        value = getattr(self, name)
        if not (math.isfinite(value) and allowed):
            text = f"{value:g} {unit}".rstrip()
            raise InputError(f"disc.synthetic.{name} is {text}: allowed is {expected}")

    def _repeats(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Return a notice where the grid is wider than the period."""
        widest = max(float(p[-1] - p[0]) + spacing(p) for p in (x, y))
        if widest <= self.period * (1 + SLACK):
            return []
        return [
            f"the random surface repeats: its period {self.period:g} mm is shorter than the grid, "
            f"{widest:g} mm"
        ]

    def _unresolved(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Return a notice where the grid is too coarse for the shortest waves."""
        coarsest = max(spacing(x), spacing(y))
        if coarsest <= self.cut_off / 2 * (1 + SLACK):
            return []
        return [
            f"cells of {coarsest * 1e3:.4g} µm do not resolve the shortest waves of the surface, "
            f"{self.cut_off * 1e3:.4g} µm: that takes cells of at most {self.cut_off * 500:.4g} µm"
        ]


@dataclass(frozen=True, kw_only=True)
class FourierSurface(Periodic):
    """A periodic surface is a finite Fourier sum over the modes 2π(i, j)/period of its `_amplitudes`."""

    @property
    def _amplitudes(self) -> ComplexArray:
        """Return the amplitudes [mm] of the half plane of modes, c in z = Re Σ c exp(i q·r)."""
        raise NotImplementedError

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [mm] at the points x × y [mm], shape (x.size, y.size), repeated past the period."""
        return fourier_sum(self._amplitudes, self._wave, x, y)

    def blocks(self, x: FloatArray, y: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
        """Yield blocks of rows and their heights [mm], shape (rows, y.size), at the points x × y [mm]."""
        return fourier_blocks(self._amplitudes, self._wave, x, y)

    @property
    def rms_slope(self) -> float:
        """Return the root mean square gradient [-] over the period, from the spectrum."""
        modes = self._wave * np.arange(-self._largest, self._largest + 1)
        squared = np.add.outer(modes**2, modes[self._largest :] ** 2)
        return math.sqrt(0.5 * float(np.sum(squared * np.abs(self._amplitudes) ** 2)))

    @property
    def _largest(self) -> int:
        """Return the largest mode along an axis."""
        return int(self.period / self.cut_off * (1 + SLACK))

    @property
    def _wave(self) -> float:
        """Return the wave number of the period [rad/mm]."""
        return 2.0 * math.pi / self.period


@dataclass(frozen=True, kw_only=True)
class RandomPart(Periodic):
    """Surfaces with a random part share these parameters: its spectrum, and the roughness of the whole.

    Lengths are in mm; exactly one of `ra`, `sq` is given. Raises InputError, naming
    ``disc.synthetic.NAME``, for a value that is not allowed.
    """

    hurst: float = 0.8
    roll_off: float = 0.1  # wavelength above which the spectrum is flat
    ra: float | None = None
    sq: float | None = None

    def __post_init__(self) -> None:
        between = f"more than cut_off ({self.cut_off:g} mm) and less than period ({self.period:g} mm)"
        self._check("roll_off", self.cut_off < self.roll_off < self.period, between)
        self._check_waves()

    @property
    def _target(self) -> tuple[str, float]:
        """Return which roughness the whole is to have, "ra" or "sq", and its value [mm]."""
        return ("ra", self.ra) if self.ra is not None else ("sq", self.sq or 0.0)

    def _parameters(self) -> dict[str, Any]:
        """Return the parameters for the record: the roughness asked for, the spectrum, the seed."""
        name, roughness = self._target
        return {
            "asked": {f"{name}_um": 1e3 * roughness},
            "hurst": self.hurst,
            "roll_off_um": self.roll_off * 1e3,
            "cut_off_um": self.cut_off * 1e3,
            "seed": self.seed,
            "period_mm": self.period,
        }

    def _points_along(self, side: float) -> FloatArray:
        """Return the even points of the reference grid along a side [mm], from 0, its end left out."""
        count = math.ceil(side / self.cut_off * POINTS_PER_CUT_OFF)
        return np.asarray(np.arange(count) * (side / count), dtype=np.float64)
