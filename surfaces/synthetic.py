"""Surfaces from formulae: flat, self-affine and milled."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import brentq

from warpwear.errors import InputError
from warpwear.surfaces.base import FloatArray, spacing
from warpwear.surfaces.fourier import (
    BLOCK_VALUES,
    ComplexArray,
    fourier_blocks,
    fourier_sum,
    half_plane_draws,
    uniform_draws,
)

LARGEST_MODE = 2048  # 17 million amplitudes; beyond, the spectrum no longer fits a small machine
POINTS_PER_CUT_OFF = 4  # of the reference grid on which Ra is defined
SLACK = 1e-9  # relative, so that 2.0/0.008 counts as 250 and a window of one period does not repeat


@dataclass(frozen=True, kw_only=True)
class Flat:
    """The plane z = 0."""

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Zeros [mm], shape (x.size, y.size)."""
        return np.zeros((x.size, y.size))

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """None."""
        return []

    def record(self) -> dict[str, Any]:
        """Kind, and the parameters every synthetic surface has."""
        return {"kind": "flat", "ra_um": 0.0, "sq_um": 0.0, "rms_slope": 0.0}


@dataclass(frozen=True, kw_only=True)
class SelfAffine:
    """A Gaussian random surface, self-affine between two wavelengths, periodic (period × period).

    A finite Fourier sum over the modes 2π(i, j)/period. Its isotropic power spectral density is constant for
    wavelengths above `roll_off`, ∝ q^(−2 − 2·hurst) down to `cut_off`, and zero for shorter ones (a circle in
    the plane of modes) and for the mean (Persson et al. 2005, J. Phys.: Condens. Matter 17, R1). Amplitudes
    are complex Gaussian; a mode's draw depends on `seed` and (i, j) alone, so a shorter cut-off adds waves
    and leaves the others as they were, up to the common factor that restores the asked roughness.

    Lengths in mm; exactly one of `ra`, `sq`. Sq is exact over the period (Parseval), Ra over a fixed grid of
    one period with a pitch of at most cut_off/4. InputError, naming ``disc.synthetic.NAME``, for bad values.
    """

    hurst: float = 0.8
    roll_off: float = 0.1
    cut_off: float = 0.008
    seed: int = 0
    period: float = 2.0
    ra: float | None = None
    sq: float | None = None

    def __post_init__(self) -> None:
        _check_roughness(self.ra, self.sq)
        _check_spectrum(self.hurst, self.roll_off, self.cut_off, self.seed, self.period)

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Heights [mm] at the points x × y [mm], shape (x.size, y.size); repeats beyond the period."""
        return fourier_sum(self._amplitudes, *self._waves, x, y)

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Whether the grid is wider than the period or too coarse for the cut-off."""
        return _repeats(self.period, x, y) + _unresolved(self.cut_off, x, y)

    @property
    def rms_slope(self) -> float:
        """Root mean square gradient [-] over the period, from the spectrum."""
        wave_x, wave_y = self._waves
        squared = np.add.outer(wave_x**2, wave_y**2)
        return math.sqrt(0.5 * float(np.sum(squared * np.abs(self._amplitudes) ** 2)))

    def record(self) -> dict[str, Any]:
        """Parameters, what was asked for, and the Ra, Sq and rms slope that the surface has."""
        return {
            "kind": "self-affine",
            "asked": _asked(self.ra, self.sq),
            "hurst": self.hurst,
            "roll_off_um": self.roll_off * 1e3,
            "cut_off_um": self.cut_off * 1e3,
            "seed": self.seed,
            "period_mm": self.period,
            "ra_um": self._scale * self._unscaled_ra * 1e3,
            "sq_um": math.sqrt(0.5 * float(np.sum(np.abs(self._amplitudes) ** 2))) * 1e3,
            "rms_slope": self.rms_slope,
        }

    @cached_property
    def _largest(self) -> int:
        return int(self.period / self.cut_off * (1 + SLACK))

    @cached_property
    def _waves(self) -> tuple[FloatArray, FloatArray]:
        """Wave numbers [rad/mm] of the half plane of modes."""
        modes = np.arange(-self._largest, self._largest + 1).astype(np.float64)
        modes *= 2.0 * math.pi / self.period
        return modes, modes[self._largest :]

    @cached_property
    def _unscaled(self) -> ComplexArray:
        """Draws times the root of the power spectral density (1 on its plateau)."""
        i = np.arange(-self._largest, self._largest + 1)
        radius = np.sqrt(np.add.outer(i**2, np.arange(self._largest + 1) ** 2))
        # in units of the roll-off wave number, so that the plateau is 1 whatever the cut-off
        level = np.maximum(radius * (self.roll_off / self.period), 1.0) ** (-1.0 - self.hurst)
        level[radius > self.period / self.cut_off * (1 + SLACK)] = 0.0
        return half_plane_draws(self._largest, seed=self.seed) * level

    @cached_property
    def _unscaled_ra(self) -> float:
        count = math.ceil(self.period / self.cut_off * POINTS_PER_CUT_OFF)
        points = _points(self.period, count)
        blocks = fourier_blocks(self._unscaled, *self._waves, points, points)
        return sum(float(np.abs(values).sum()) for _, values in blocks) / count**2

    @cached_property
    def _scale(self) -> float:
        if self.sq is not None:
            return self.sq / math.sqrt(0.5 * float(np.sum(np.abs(self._unscaled) ** 2)))
        assert self.ra is not None
        return self.ra / self._unscaled_ra

    @cached_property
    def _amplitudes(self) -> ComplexArray:
        """Amplitudes [mm] of the half plane of modes: z = Re Σ c exp(i q·r)."""
        return self._scale * self._unscaled


@dataclass(frozen=True, kw_only=True)
class Milled:
    """Feed marks of a finishing cut with a fine self-affine roughness on them.

    A cutter of round edge leaves parabolic grooves that meet in cusps, one per `feed` (0.65 mm per tooth:
    thesis table 3.2): over one feed z ∝ (2u/feed)², as a Fourier series cut at the wavelength `cut_off`. The
    ridges run at `lay` degrees to the sliding direction (90: across it); where they lie is drawn from `seed`.
    The fine part is a `SelfAffine` of Ra `fine_ra` (none for 0) with the other parameters.

    Lengths in mm; exactly one of `ra`, `sq`: the feed marks are scaled until the whole has it, about its
    mean, on a fixed grid of pitch ≤ cut_off/4: whole feeds along the axis nearer to the feed's, one period
    along the other. InputError, naming ``disc.synthetic.NAME``, for bad values, also when the fine part alone
    is as rough as the whole is to be.
    """

    feed: float = 0.65
    fine_ra: float = 0.0003
    lay: float = 90.0
    hurst: float = 0.8
    roll_off: float = 0.1
    cut_off: float = 0.008
    seed: int = 0
    period: float = 2.0
    ra: float | None = None
    sq: float | None = None

    def __post_init__(self) -> None:
        _check_roughness(self.ra, self.sq)
        _check_spectrum(self.hurst, self.roll_off, self.cut_off, self.seed, self.period)
        _check("feed", self.feed, self.feed > self.cut_off, f"more than cut_off ({self.cut_off:g} mm)")
        _check("fine_ra", self.fine_ra, self.fine_ra >= 0.0, "0 or a positive length")
        _check("lay", self.lay, abs(self.lay) <= 180.0, "an angle from -180 to 180 degrees", unit="degrees")
        if self.fine_ra >= (self.ra or self.sq or 0.0):  # Ra is below Sq, so this refuses nothing sound
            raise self._too_fine()

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Heights [mm] at the points x × y [mm], shape (x.size, y.size)."""
        field = np.empty((x.size, y.size))
        for rows, values in self._marks(x, y):
            np.multiply(values, self._peak_to_valley, out=field[rows])
        if self._fine is not None:
            for rows, values in fourier_blocks(self._fine._amplitudes, *self._fine._waves, x, y):
                field[rows] += values
        return field

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Whether the fine part repeats within the grid, or the grid is too coarse for the cut-off."""
        return (_repeats(self.period, x, y) if self._fine else []) + _unresolved(self.cut_off, x, y)

    @property
    def rms_slope(self) -> float:
        """Root mean square gradient [-] from both spectra, which are taken to be uncorrelated."""
        wave = 2.0 * math.pi / self.feed * self._orders
        marks = 0.5 * float(np.sum((wave * self._series) ** 2)) * self._peak_to_valley**2
        return math.sqrt(marks + (self._fine.rms_slope**2 if self._fine is not None else 0.0))

    def record(self) -> dict[str, Any]:
        """Parameters, what was asked for, and the Ra, Sq and rms slope that the surface has."""
        return {
            "kind": "milled",
            "asked": _asked(self.ra, self.sq),
            "feed_mm": self.feed,
            "feed_marks_peak_to_valley_um": self._peak_to_valley * 1e3,
            "fine_ra_um": self.fine_ra * 1e3,
            "lay_degrees": self.lay,
            "hurst": self.hurst,
            "roll_off_um": self.roll_off * 1e3,
            "cut_off_um": self.cut_off * 1e3,
            "seed": self.seed,
            "period_mm": self.period,
            "ra_um": self._scaled[1] * 1e3,
            "sq_um": self._scaled[2] * 1e3,
            "rms_slope": self.rms_slope,
        }

    def _too_fine(self) -> InputError:
        name, whole = ("ra", self.ra) if self.ra is not None else ("sq", self.sq)
        return InputError(
            f"disc.synthetic.fine_ra is {self.fine_ra:g} mm: the fine part alone is as rough as the whole "
            f"is to be ({name} = {whole:g} mm), allowed is a smaller fine_ra, or 0"
        )

    @cached_property
    def _fine(self) -> SelfAffine | None:
        if self.fine_ra == 0.0:
            return None
        return SelfAffine(
            hurst=self.hurst,
            roll_off=self.roll_off,
            cut_off=self.cut_off,
            seed=self.seed,
            period=self.period,
            ra=self.fine_ra,
        )

    @cached_property
    def _orders(self) -> FloatArray:
        return np.arange(1.0, int(self.feed / self.cut_off * (1 + SLACK)) + 1)

    @cached_property
    def _series(self) -> FloatArray:
        """Cosine amplitudes of (2u/feed)² on |u| ≤ feed/2, less its mean 1/3."""
        return 4.0 / math.pi**2 * (-1.0) ** self._orders / self._orders**2

    @cached_property
    def _normal(self) -> tuple[float, float]:
        """Unit vector of the feed: across the ridges."""
        return math.sin(math.radians(self.lay)), -math.cos(math.radians(self.lay))

    def _marks(self, x: FloatArray, y: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
        """Feed marks of unit peak-to-valley height (before the cut), in blocks of rows.

        cos k(a + b) = cos ka cos kb − sin ka sin kb makes a plane wave at any angle a matrix product.
        """
        unit = 2.0 * math.pi / self.feed
        start = 2.0 * math.pi * float(uniform_draws(1, seed=self.seed, stream=1)[0])
        along = np.multiply.outer(unit * self._normal[0] * x + start, self._orders)
        across = np.multiply.outer(self._orders, unit * self._normal[1] * y)
        left = np.concatenate([np.cos(along) * self._series, -np.sin(along) * self._series], axis=1)
        right = np.concatenate([np.cos(across), np.sin(across)])
        rows = max(1, BLOCK_VALUES // y.size)
        for first in range(0, x.size, rows):
            block = slice(first, min(first + rows, x.size))
            yield block, left[block] @ right

    def _reference(self) -> tuple[FloatArray, FloatArray]:
        """Unit feed marks [-] and fine part less its mean [mm] on the grid on which Ra and Sq are defined."""
        steep = max(abs(part) for part in self._normal)
        whole = max(1, round(self.period * steep / self.feed)) * self.feed / steep
        sides = (whole, self.period) if abs(self._normal[0]) == steep else (self.period, whole)
        x, y = (
            _points(side, count)
            for side, count in ((side, math.ceil(side / self.cut_off * POINTS_PER_CUT_OFF)) for side in sides)
        )
        marks = np.concatenate([values for _, values in self._marks(x, y)])
        fine = np.zeros((1, 1)) if self._fine is None else self._fine.heights(x, y)
        return marks, fine - fine.mean()

    @property
    def _peak_to_valley(self) -> float:
        """Height [mm] of the feed marks before the cut-off."""
        return self._scaled[0]

    @cached_property
    def _scaled(self) -> tuple[float, float, float]:
        """Factor [mm] on the unit feed marks that makes the whole as rough as asked; its Ra and Sq [mm]."""
        marks, fine = self._reference()
        factor = self._factor_for_sq(marks, fine) if self.ra is None else self._factor_for_ra(marks, fine)
        marks *= factor
        marks += fine
        return factor, float(np.abs(marks).mean()), math.sqrt(float(np.square(marks).mean()))

    def _factor_for_sq(self, marks: FloatArray, fine: FloatArray) -> float:
        # Sq² = s² <m²> + 2 s <m f> + <f²>, its positive root
        assert self.sq is not None
        square, cross = float(np.square(marks).mean()), float((marks * fine).mean())
        rest = float(np.square(fine).mean()) - self.sq**2
        if rest >= 0.0:
            raise self._too_fine()
        return (math.sqrt(cross**2 - square * rest) - cross) / square

    def _factor_for_ra(self, marks: FloatArray, fine: FloatArray) -> float:
        assert self.ra is not None
        asked, alone = self.ra, float(np.abs(fine).mean())
        if alone >= asked:
            raise self._too_fine()

        def excess(factor: float) -> float:
            return float(np.abs(factor * marks + fine).mean()) / asked - 1.0

        # mean |s m + f| ≥ s mean |m| − mean |f|: rough enough at the upper end for sure
        highest = (asked + alone) / float(np.abs(marks).mean())
        return float(brentq(excess, 0.0, highest * (1 + SLACK), xtol=1e-15 * highest, rtol=1e-14))


def _check(name: str, value: float, allowed: bool, expected: str, *, unit: str = "mm") -> None:
    if not (math.isfinite(value) and allowed):
        shown = f"{value:g} {unit}".rstrip()
        raise InputError(f"disc.synthetic.{name} is {shown}: allowed is {expected}")


def _check_roughness(ra: float | None, sq: float | None) -> None:
    if (ra is None) == (sq is None):
        given = "neither is given" if ra is None else f"both are given ({ra:g} mm and {sq:g} mm)"
        raise InputError(
            f"disc.synthetic.ra and disc.synthetic.sq: {given}, "
            "allowed is exactly one of the two, a positive length"
        )
    for name, value in (("ra", ra), ("sq", sq)):
        if value is not None:
            _check(name, value, value > 0.0, "a positive length")


def _check_spectrum(hurst: float, roll_off: float, cut_off: float, seed: int, period: float) -> None:
    _check("hurst", hurst, 0.0 < hurst <= 1.0, "more than 0 and at most 1", unit="")
    _check("cut_off", cut_off, cut_off > 0.0, "a positive length")
    _check("period", period, period > 0.0, "a positive length")
    _check(
        "roll_off",
        roll_off,
        cut_off < roll_off < period,
        f"more than cut_off ({cut_off:g} mm) and less than period ({period:g} mm)",
    )
    _check(
        "cut_off",
        cut_off,
        period / cut_off <= LARGEST_MODE * (1 + SLACK),
        f"at least period/{LARGEST_MODE} ({period / LARGEST_MODE:g} mm)",
    )
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"disc.synthetic.seed is {seed!r}: allowed is a whole number from 0")


def _points(side: float, count: int) -> FloatArray:
    points = np.arange(count).astype(np.float64)
    points *= side / count
    return points


def _asked(ra: float | None, sq: float | None) -> dict[str, float]:
    return {name: value * 1e3 for name, value in (("ra_um", ra), ("sq_um", sq)) if value is not None}


def _repeats(period: float, x: FloatArray, y: FloatArray) -> list[str]:
    widest = max(float(p[-1] - p[0]) + spacing(p) for p in (x, y))
    if widest <= period * (1 + SLACK):
        return []
    return [f"the random surface repeats: its period {period:g} mm is shorter than the grid, {widest:g} mm"]


def _unresolved(cut_off: float, x: FloatArray, y: FloatArray) -> list[str]:
    coarsest = max(spacing(x), spacing(y))
    if coarsest <= cut_off / 2 * (1 + SLACK):
        return []
    return [
        f"cells of {coarsest * 1e3:.4g} µm do not resolve the shortest waves of the surface, "
        f"{cut_off * 1e3:.4g} µm: that takes cells of at most {cut_off * 500:.4g} µm"
    ]
