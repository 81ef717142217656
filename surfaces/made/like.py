"""Random surfaces are made like a measured profile: its spectrum, its Rq, its distribution of heights."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.base import say
from warpwear.surfaces.made.fourier import ComplexArray, uniform_draws
from warpwear.surfaces.made.synthetic import FourierSurface
from warpwear.surfaces.profiles.profile import Profile
from warpwear.surfaces.roughness import height_parameters

fft = lazy.module("scipy.fft")

BANDS = 8  # of the spectrum per decade
STEPS = 2000  # in which the isotropic spectrum is found
FITS = 100  # of its decades to the profile's
FEWEST = 8  # waves of the profile in a band, whose power is known to about half of it
ROUNDS = 20  # in which spectrum and heights are brought together
POINTS = 3  # along a shortest wave, at which the heights are distributed
MUCH = 0.02  # of Rq², above which waves that are left out are told of
UNLIKELY = 1.0  # above which a spectrum that is not reached is told of: chance leaves less than half of it


@dataclass(frozen=True, kw_only=True)
class LikeProfile(FourierSurface):
    """A random surface whose profiles are like a measured one, periodic (period × period).

    Its spectrum is that of the profile between `period` and `cut_off`: isotropic, as bands of the spectrum
    whose projection on a line is nearest to the profile's, or, with `lay_length`, wave by wave across the
    lay. Heights are distributed as the profile's as far as that spectrum lets them: both are imposed in turn,
    the spectrum last (Schreiber and Schmitz 1996, Phys. Rev. Lett. 77, 635). Sq is exact over the period.

    lay: angle [degrees] between lay and sliding, 0 or 90; lay_length [mm]: over which the autocorrelation
    along the lay falls to 1/e, None for an isotropic surface. Raises InputError, naming
    ``disc.synthetic.NAME``, for a value that is not allowed.
    """

    profile: Profile = field(compare=False)
    like: str = ""  # name of its file
    digest: str = ""  # of its file, by which surfaces are compared
    lay: float = 90.0
    lay_length: float | None = None

    def __post_init__(self) -> None:
        self._check_waves()
        length, finest = self.profile.length, 2.0 * self.profile.spacing
        self._check("period", self.period <= length, f"at most the length of the profile ({length:g} mm)")
        shortest = f"from two points of the profile ({finest:g} mm) to a tenth of the period"
        self._check("cut_off", finest * (1 - 1e-9) <= self.cut_off <= 0.1 * self.period, shortest)
        if self.lay_length is not None:
            self._check("lay", self.lay in (0.0, 90.0), "0 or 90 deg beside like", unit="deg")

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Say what the profile does not tell, what is left out of it, and what the grid x × y [mm] lacks."""
        notices = self._repeats(x, y) + self._unresolved(x, y)
        what = "isotropic" if self.lay_length is None else f"alike over {self.lay_length:g} mm along its lay"
        notices.append(say("like", profile=self.like, what=what))
        short, long = self._left_out
        for part, waves in ((short, "shorter than cut_off"), (long, "longer than period")):
            if part > MUCH:
                notices.append(f"{100.0 * part:.2g} % of the profile's Rq² are waves {waves}, and left out")
        if self._spectrum[2] > UNLIKELY:
            notices.append(say("not_isotropic"))
        return notices

    def record(self) -> dict[str, Any]:
        """Return the parameters, and height parameters of the profile and of the surface."""
        points = np.linspace(0.0, self.period, POINTS * self._largest, endpoint=False)
        own = height_parameters(self.heights(points, points))
        profile = height_parameters(self._levelled)
        return {
            "kind": "profile",
            "like": self.like,
            "sha256": self.digest,
            "profile": {"rq_um": 1e3 * profile["sq"], "rsk": profile["ssk"], "rku": profile["sku"]},
            "left_out_percent": {"shorter": 100.0 * self._left_out[0], "longer": 100.0 * self._left_out[1]},
            "cut_off_um": 1e3 * self.cut_off,
            "seed": self.seed,
            "period_mm": self.period,
            "lay": None if self.lay_length is None else {"degrees": self.lay, "length_mm": self.lay_length},
            "spectrum_off_percent": 100.0 * self._spectrum[1],
            "ra_um": 1e3 * own["sa"],
            "sq_um": 1e3 * own["sq"],
            "ssk": own["ssk"],
            "sku": own["sku"],
            "rms_slope": self.rms_slope,
        }

    @property
    def _modes(self) -> tuple[FloatArray, FloatArray]:
        """Return the numbers of waves along x and y of the amplitudes, shapes (2n + 1, 1) and (1, n + 1)."""
        n = self._largest
        return np.arange(-n, n + 1.0)[:, None], np.arange(n + 1.0)[None, :]

    @cached_property
    def _levelled(self) -> FloatArray:
        """Return the complete profile less its mean line [mm], shape (n,)."""
        heights = self.profile.levelled(1).filled()
        return heights - heights.mean()

    @cached_property
    def _power(self) -> FloatArray:
        """Return the profile's mean square [mm²] below (j − ½)/period for j = 0 … n + 1, and in all."""
        # of the profile and its mirror, which closes without a jump; a window would weigh its middle
        power = np.square(fft.dct(self._levelled, type=2, norm="ortho"))[1:] / self._levelled.size
        edges = (np.arange(power.size + 1) + 0.5) / (2.0 * self.profile.length)
        wanted = (np.arange(self._largest + 2) - 0.5) / self.period
        below = np.interp(wanted, edges, np.concatenate([[0.0], np.cumsum(power)]))
        return np.append(below, float(power.sum()))

    @property
    def _left_out(self) -> tuple[float, float]:
        """Return which parts of the profile's Rq² are too short, and too long, waves for the surface."""
        whole = float(self._power[-1])
        return 1.0 - float(self._power[-2]) / whole, float(self._power[1]) / whole

    @cached_property
    def _spectrum(self) -> tuple[FloatArray, float, float]:
        """Return mean squares of the modes [mm²], (2n + 1, n + 1), and how far they are off the profile's.

        That is rms over decades of wavelength along lines, and how unlikely the profile would be.
        """
        by_mode = np.diff(self._power[1:-1])  # of the modes 1 to n
        i, j = self._modes
        half = (j > 0) | (i > 0)
        if self.lay_length is not None:
            along, across = (i, j) if self.lay == 0.0 else (j, i)
            own = np.concatenate([[0.0], by_mode])[np.abs(across).astype(np.intp)]
            weight = np.exp(-np.square(math.pi * self.lay_length / self.period * along))
            # of a pair (i, j), (−i, −j) one is there, and −i beside i where j is not 0
            return _normed(half * own * weight, float(by_mode.sum())), 0.0, 0.0
        n = self._largest
        edges = _edges(n, FEWEST * self.period / (2.0 * self.profile.length))
        bands = np.add.reduceat(by_mode, edges[:-1].astype(np.intp) - 1)
        middle, radius = np.sqrt(edges[:-1] * edges[1:]), np.hypot(i, j)
        # isotropic: of a profile's density C a plane's is about C/q, but for a factor that changes slowly
        density = np.log(np.maximum(bands / np.diff(edges), 1e-12 * bands.max()))
        radii = np.maximum(radius, 1.0)
        guess = np.exp(np.interp(np.log(radii), np.log(middle), density)) / radii
        guess[(radius > n * (1 + 1e-9)) | ~half] = 0.0
        ring, row = (np.digitize(np.broadcast_to(r, radius.shape).ravel(), edges) - 1 for r in (radius, j))
        seen = (row >= 0) & (guess.ravel() > 0.0)
        projected = np.zeros((bands.size, bands.size))
        np.add.at(projected, (row[seen], ring[seen]), guess.ravel()[seen])
        factors = _likeliest(projected, bands, np.diff(edges))
        decade = np.floor(np.log10(middle)).astype(np.intp)
        for _ in range(FITS):  # the powers of whole decades are known best, and kept
            fit = projected @ factors
            of_decades = np.bincount(decade, fit) / np.bincount(decade, bands)
            factors /= of_decades[decade]
        off = float(np.sqrt(np.mean(np.square(of_decades - 1.0))))
        ratio = bands / fit
        # twice the logarithm of how much likelier the own power of the bands is, a band
        number = np.diff(edges) * (2.0 * self.profile.length / self.period)
        unlikely = float(np.mean(number * (ratio - 1.0 - np.log(ratio))))
        power = guess * factors[np.clip(ring, 0, bands.size - 1)].reshape(guess.shape)
        return _normed(power, float(by_mode.sum())), off, unlikely

    @cached_property
    def _amplitudes(self) -> ComplexArray:
        """Return the amplitudes [mm] of the half plane of modes, c in z = Re Σ c exp(i q·r)."""
        power = self._spectrum[0]
        n = self._largest
        count = fft.next_fast_len(POINTS * n, real=True)
        size = np.zeros((count, count // 2 + 1))
        rows = np.arange(-n, n + 1) % count
        size[rows, : n + 1] = np.sqrt(2.0 * power) * (0.5 * count**2)
        size[-rows, 0] = np.maximum(size[-rows, 0], size[rows, 0])  # the other half of the pairs
        quantiles = (np.arange(count**2) + 0.5) / count**2
        ordered = np.sort(self._levelled)
        values = np.interp(quantiles, (np.arange(ordered.size) + 0.5) / ordered.size, ordered)
        draws = uniform_draws(size.size, seed=self.seed).reshape(size.shape)
        waves = size * np.exp(2j * math.pi * draws)
        for _ in range(ROUNDS):
            surface = fft.irfft2(waves, s=(count, count))
            heights = np.empty(count**2)
            heights[np.argsort(surface, axis=None, kind="stable")] = values
            waves = fft.rfft2(heights.reshape(count, count))
            waves *= size / np.maximum(np.abs(waves), 1e-300)
        amplitudes = waves[rows, : n + 1] * (2.0 / count**2)
        amplitudes[: n + 1, 0] = 0.0
        return amplitudes


def _likeliest(projected: FloatArray, bands: FloatArray, waves: FloatArray) -> FloatArray:
    """Return the factors of rings whose projection makes a profile's bands likeliest (Whittle 1953).

    projected: power that each ring gives each band, (bands, rings); bands: power, and waves: number of waves
    of each band of the profile, (bands,). Multiplicative steps keep the factors above zero (Févotte and Idier
    2011, Neural Comput. 23, 2421).
    """
    factors = np.ones(bands.size)
    for _ in range(STEPS):
        fit = projected @ factors
        up, down = projected.T @ (waves * bands / np.square(fit)), projected.T @ (waves / fit)
        factors *= np.sqrt(up / down)
    return factors


def _edges(largest: int, least: float) -> FloatArray:
    """Return the edges of bands of waves from 1 to `largest`, each at least `least` waves wide."""
    edges = [1.0]
    while edges[-1] < largest + 1.0:
        wide = max(round(edges[-1] * 10 ** (1.0 / BANDS)), edges[-1] + math.ceil(least))
        edges.append(min(wide, largest + 1.0))
    return np.array(edges)


def _normed(power: FloatArray, total: float) -> FloatArray:
    """Return mean squares of modes with the sum of a total."""
    return power * (total / float(power.sum()))
