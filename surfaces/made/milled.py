"""Milled surfaces have feed marks with a fine roughness on them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray, blocks_of_rows
from warpwear.surfaces.made.fourier import sum_waves, uniform_draws
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.made.synthetic import SLACK, RandomPart

optimize = lazy.module("scipy.optimize")


@dataclass(frozen=True, kw_only=True)
class Milled(RandomPart):
    """Feed marks of a finishing cut carry a fine self-affine roughness.

    A cutter of round edge leaves parabolic grooves that meet in cusps, one per `feed` (0.65 mm per tooth:
    thesis table 3.2): over one feed z ∝ (2u/feed)², as a Fourier series cut at the wavelength `cut_off`. The
    ridges run at `lay` degrees to the sliding direction (90: across it); where they lie is drawn from `seed`.
    The fine part is a `SelfAffine` of Ra `fine_ra` (none for 0) with the other parameters.

    `ra` or `sq` is that of the whole: the feed marks are scaled until the whole has it, about its mean, on a
    fixed grid of pitch ≤ cut_off/4: whole feeds along the axis nearer to the feed's, one period along the
    other. Lengths are in mm. Raises InputError, naming ``disc.synthetic.NAME``, for bad values, also when the
    fine part alone is as rough as the whole is to be.
    """

    feed: float = 0.65
    fine_ra: float = 0.0003
    lay: float = 90.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check("feed", self.feed > self.cut_off, f"more than cut_off ({self.cut_off:g} mm)")
        if self.fine_ra >= self._target[1]:  # Ra is below Sq, so this refuses nothing sound
            raise self._too_fine()

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [mm] at the points x × y [mm], shape (x.size, y.size)."""
        field = np.empty((x.size, y.size))
        for rows, values in self._marks(x, y):
            np.multiply(values, self._peak_to_valley, out=field[rows])
        if self._fine is not None:
            for rows, values in self._fine.blocks(x, y):
                field[rows] += values
        return field

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Say whether the fine part repeats in the grid x × y [mm], or it is too coarse for the cut-off."""
        return (self._repeats(x, y) if self._fine else []) + self._unresolved(x, y)

    @property
    def rms_slope(self) -> float:
        """Return the root mean square gradient [-] from both spectra, which are taken to be uncorrelated."""
        wave = 2.0 * math.pi / self.feed * self._orders
        marks = 0.5 * float(np.sum((wave * self._series) ** 2)) * self._peak_to_valley**2
        return math.sqrt(marks + (self._fine.rms_slope**2 if self._fine is not None else 0.0))

    def record(self) -> dict[str, Any]:
        """Return the parameters, what was asked for, and the Ra, Sq and rms slope that the surface has."""
        return {
            "kind": "milled",
            **self._parameters(),
            "feed_mm": self.feed,
            "feed_marks_peak_to_valley_um": self._peak_to_valley * 1e3,
            "fine_ra_um": self.fine_ra * 1e3,
            "lay_degrees": self.lay,
            "ra_um": self._scaled[1] * 1e3,
            "sq_um": self._scaled[2] * 1e3,
            "rms_slope": self.rms_slope,
        }

    def _too_fine(self) -> InputError:
        name, whole = self._target
        return InputError(
            f"disc.synthetic.fine_ra is {self.fine_ra:g} mm: the fine part alone is as rough as the whole "
            f"is to be ({name} = {whole:g} mm), allowed is a smaller fine_ra, or 0"
        )

    @cached_property
    def _fine(self) -> SelfAffine | None:
        """Return the fine part, None where there is none."""
        shared = {field.name: getattr(self, field.name) for field in fields(RandomPart)}
        return SelfAffine(**(shared | {"ra": self.fine_ra, "sq": None})) if self.fine_ra else None

    @cached_property
    def _orders(self) -> FloatArray:
        """Return the orders 1, 2, … of the Fourier series of a feed mark, down to the cut-off."""
        return np.arange(1.0, int(self.feed / self.cut_off * (1 + SLACK)) + 1)

    @cached_property
    def _series(self) -> FloatArray:
        """Return the cosine amplitudes of (2u/feed)² on |u| ≤ feed/2, less its mean 1/3."""
        return 4.0 / math.pi**2 * (-1.0) ** self._orders / self._orders**2

    @cached_property
    def _normal(self) -> tuple[float, float]:
        """Return the unit vector of the feed, which is across the ridges."""
        return math.sin(math.radians(self.lay)), -math.cos(math.radians(self.lay))

    def _marks(self, x: FloatArray, y: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
        """Yield blocks of rows of feed marks of unit peak-to-valley height (before the cut).

        In a row the marks are a Fourier sum along y, whose phases are those of the row.
        """
        unit = 2.0 * math.pi / self.feed
        start = 2.0 * math.pi * float(uniform_draws(1, seed=self.seed, stream=1)[0])
        series = np.concatenate([[0.0], self._series])  # from the order 0
        for block in blocks_of_rows(x.size, values=y.size + series.size):
            along = np.multiply.outer(unit * self._normal[0] * x[block] + start, np.arange(series.size))
            yield block, sum_waves(series * np.exp(1j * along), unit * self._normal[1], y).real

    def _reference(self) -> tuple[FloatArray, FloatArray]:
        """Return unit feed marks [-] and fine part [mm], over its mean, where Ra and Sq are defined."""
        steep = max(abs(part) for part in self._normal)
        whole = max(1, round(self.period * steep / self.feed)) * self.feed / steep
        sides = (whole, self.period) if abs(self._normal[0]) == steep else (self.period, whole)
        x, y = (self._points_along(side) for side in sides)
        marks = np.concatenate([values for _, values in self._marks(x, y)])
        fine = np.zeros((1, 1)) if self._fine is None else self._fine.heights(x, y)
        return marks, fine - fine.mean()

    @property
    def _peak_to_valley(self) -> float:
        """Return the height [mm] of the feed marks before the cut-off."""
        return self._scaled[0]

    @cached_property
    def _scaled(self) -> tuple[float, float, float]:
        """Return the factor [mm] on unit feed marks that makes the whole as rough as asked; its Ra, Sq."""
        marks, fine = self._reference()
        name, target = self._target
        factor = (self._factor_for_sq if name == "sq" else self._factor_for_ra)(target, marks, fine)
        marks *= factor
        marks += fine
        return factor, float(np.abs(marks).mean()), math.sqrt(float(np.square(marks).mean()))

    def _factor_for_sq(self, target: float, marks: FloatArray, fine: FloatArray) -> float:
        # Sq² = s² <m²> + 2 s <m f> + <f²>, its positive root
        square, cross = float(np.square(marks).mean()), float((marks * fine).mean())
        rest = float(np.square(fine).mean()) - target**2
        if rest >= 0.0:
            raise self._too_fine()
        return (math.sqrt(cross**2 - square * rest) - cross) / square

    def _factor_for_ra(self, target: float, marks: FloatArray, fine: FloatArray) -> float:
        alone = float(np.abs(fine).mean())
        if alone >= target:
            raise self._too_fine()

        def excess(factor: float) -> float:
            return float(np.abs(factor * marks + fine).mean()) / target - 1.0

        # mean |s m + f| ≥ s mean |m| − mean |f|: rough enough at the upper end for sure
        highest = (target + alone) / float(np.abs(marks).mean())
        return float(optimize.brentq(excess, 0.0, highest * (1 + SLACK), xtol=1e-15 * highest, rtol=1e-14))
