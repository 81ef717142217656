"""What a surface has at which wavelength: power spectrum, rms slope against cut-off, roll-off."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray

fft = lazy.module("scipy.fft")

BINS_PER_DECADE = 12  # of wavelength
FINE_BINS = 4096  # of frequency, for sums over filtered waves
FLAT_BINS = 3  # that a knee needs below it
STEEP_BINS = 4  # that a knee needs above it
KNEES = 200  # tried between the longest and the shortest wave
LEAST_EXPONENT = 1.0  # of the decay above a knee
STEEPEST = -6.0  # exponent that no rough surface has: 2 + 2H is at most 4
SURE_MODES = 100  # of a bin, below which its scatter may look as steep


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A power spectral density is averaged over all directions; empty bins are left out.

    It is normalised such that ∫ C d²q/(2π)² = Sq².
    """

    wavelength: FloatArray  # [mm], decreasing, shape (bins,)
    density: FloatArray  # C [mm⁴] at the wavenumbers q = 2π/wavelength, shape (bins,)
    modes: FloatArray  # number of waves averaged, shape (bins,)


@dataclass(frozen=True)
class RollOff:
    """A roll-off wavelength is suggested, or none where the surface does not tell one."""

    wavelength: float | None  # [mm]
    source: str  # how it was found
    hurst: float | None = None  # exponent at shorter waves; None where unknown


def power_spectrum(
    heights: FloatArray, *, pixel: tuple[float, float], measured: BoolArray | None = None
) -> Spectrum:
    """Return the power spectrum of complete, levelled heights [mm], shape (nx, ny), over all directions.

    pixel: (px, py) [mm]. measured: which points are, shape (nx, ny), all by default; filled ones are smooth,
    and their lack of power is made up for. It is computed from the Fourier transform under a Hann window,
    which keeps the jump between opposite edges out of the spectrum; its loss of power is made up for (Jacobs,
    Junge and Pastewka 2017, sections 3 and 4). Up to the Nyquist frequency of the coarser pixel.
    """
    nx, ny = heights.shape
    window = np.multiply.outer(_hann(nx), _hann(ny))
    valid: Any = True if measured is None else measured
    window /= math.sqrt(float(np.sum(np.square(window), where=valid)) / window.size)
    waves = fft.rfft2((heights - heights.mean(where=valid)) * window)
    power = np.square(np.abs(waves))
    power *= pixel[0] * pixel[1] / (nx * ny)
    fx, fy = fft.fftfreq(nx, pixel[0]), fft.rfftfreq(ny, pixel[1])
    # a column of the half transform stands for two, but for the first and an even count's last
    weight = np.full(fy.size, 2.0)
    weight[0] = 1.0
    if ny % 2 == 0:
        weight[-1] = 1.0
    frequency = np.hypot(fx[:, None], fy[None, :])
    lowest = 1.0 / max(nx * pixel[0], ny * pixel[1])
    highest = 0.5 / max(pixel)
    count = max(int(BINS_PER_DECADE * math.log10(highest / lowest)), 2)
    edges = np.geomspace(lowest * (1 - 1e-9), highest * (1 + 1e-9), count + 1)
    place = np.digitize(frequency, edges).ravel()
    weights = np.broadcast_to(weight, frequency.shape).ravel()
    logarithm = np.log(np.maximum(frequency.ravel(), lowest / 2))
    summed = (weights, weights * power.ravel(), weights * logarithm)
    modes, total, mean_log = (np.bincount(place, sums, minlength=count + 2)[1:-1] for sums in summed)
    used = (modes > 0) & (total > 0)
    return Spectrum(
        wavelength=np.exp(-mean_log[used] / modes[used]),
        density=total[used] / modes[used],
        modes=modes[used].astype(np.float64),
    )


def slope_against_cut_off(
    heights: FloatArray,
    *,
    pixel: tuple[float, float],
    cut_offs: FloatArray,
    measured: BoolArray | None = None,
) -> FloatArray:
    """Return the rms slope [-] after an S-filter with each of the cut-offs [mm], shape (n,); 0 is none.

    heights [mm], shape (nx, ny), complete; measured: as in `power_spectrum`. The filter is the Gaussian one
    of ISO 16610-61, mirrored at the edges; slopes are those of the waves themselves, so that pixels only
    limit the waves.
    """
    nx, ny = heights.shape
    waves = fft.dctn(heights - heights.mean(), type=2, norm="ortho")
    energy = np.square(waves, out=waves)
    energy /= nx * ny if measured is None else np.count_nonzero(measured)
    squared = np.add.outer(
        np.square(np.arange(nx) / (2.0 * nx * pixel[0])), np.square(np.arange(ny) / (2.0 * ny * pixel[1]))
    )
    # one sum over bins of √f² stands for a filter of the field for each cut-off
    frequency = np.sqrt(squared)
    place = (frequency * (FINE_BINS / float(frequency.max()))).astype(np.intp).ravel()
    energy *= squared
    slopes = np.bincount(place, energy.ravel()) * (2.0 * math.pi) ** 2
    moment = np.bincount(place, (energy * squared).ravel()) * (2.0 * math.pi) ** 2
    # the frequency of a bin is the one of its waves' slopes
    middle = np.divide(moment, slopes, out=np.zeros_like(slopes), where=slopes > 0.0)
    passed = np.exp2(-2.0 * np.square(cut_offs)[:, None] * middle[None, :])
    return np.asarray(np.sqrt(np.einsum("cf,f->c", passed, slopes)))


def autocorrelation_length(
    heights: FloatArray, *, pixel: tuple[float, float], level: float = 0.2
) -> float | None:
    """Return the shortest distance [mm] in which the autocorrelation falls to `level`: Sal of ISO 25178-2.

    heights [mm], shape (nx, ny), NaN where missing, levelled; pixel (px, py) [mm]. It is None when the
    autocorrelation does not fall to `level` within a quarter of the field. The field is padded with zeros, so
    that opposite edges do not meet; the loss of overlap is made up for, and that of missing points.
    """
    nx, ny = heights.shape
    shape = [fft.next_fast_len(n + n // 4, real=True) for n in (nx, ny)]
    valid = ~np.isnan(heights)
    mean = heights.mean(where=valid)

    def correlation(field: FloatArray) -> FloatArray:
        return np.asarray(fft.irfft2(np.square(np.abs(fft.rfft2(field, s=shape))), s=shape))

    mx, my = nx // 4, ny // 4
    i, j = np.arange(-mx, mx + 1), np.arange(my + 1)
    overlap = np.multiply.outer(nx - np.abs(i), ny - j).astype(np.float64)
    if not valid.all():
        overlap = np.maximum(correlation(valid.astype(np.float64))[np.ix_(i, j)], 1.0)
    near = correlation(np.where(valid, heights - mean, 0.0))[np.ix_(i, j)] / overlap
    if near[mx, 0] <= 0.0:
        return None
    below = near < level * near[mx, 0]
    if not below.any():
        return None
    distance = np.hypot((i * pixel[0])[:, None], (j * pixel[1])[None, :])
    return float(distance[below].min())


def suggested_roll_off(spectrum: Spectrum, *, correlation: float | None, resolved: float) -> RollOff:
    """Suggest the wavelength above which a spectrum is flat: its knee, or four autocorrelation lengths.

    correlation: autocorrelation length [mm], None where it is not known.

    The knee is that of the best fit of a constant below it and a power law above, in logarithms, among
    wavelengths above `resolved` [mm] (two pixels, or the S-filter). It counts when at least three bins lie
    on the flat side and the power law explains the rest; else four autocorrelation lengths are suggested
    (a quarter wave is how far heights of one wavelength stay alike), where that is known.
    """
    if not spectrum.density.size:
        return RollOff(wavelength=None, source="a flat, which has no waves")
    rough = spectrum.wavelength > 1.5 * resolved
    # nor does a sharp cut-off of the surface itself belong to the power law
    fall = np.diff(np.log(spectrum.density)) / np.diff(-np.log(spectrum.wavelength))
    cliff = np.flatnonzero((fall < STEEPEST) & (spectrum.modes[1:] > SURE_MODES))
    if cliff.size:
        rough[max(cliff[0], 1) :] = False
    q = -np.log(spectrum.wavelength[rough])
    c = np.log(spectrum.density[rough])
    # few waves to a bin scatter much; many differ by the model's faults, not by chance
    weight = 1.0 / (0.02 + 1.0 / spectrum.modes[rough])
    best: tuple[float, float, float] | None = None
    for knee in np.linspace(q[0], q[-1], KNEES) if q.size > FLAT_BINS + STEEP_BINS else []:
        if np.sum(q <= knee) < FLAT_BINS or np.sum(q > knee) < STEEP_BINS:
            continue
        ramp = np.maximum(q - knee, 0.0)
        design = np.stack([np.ones_like(q), -ramp], axis=1) * np.sqrt(weight)[:, None]
        solution, *_ = np.linalg.lstsq(design, c * np.sqrt(weight), rcond=None)
        error = float(np.sum(weight * np.square(c - solution[0] + solution[1] * ramp)))
        if best is None or error < best[0]:
            best = (error, float(knee), float(solution[1]))
    if best is not None and best[2] > LEAST_EXPONENT:
        # flat must be flat: a straight line through all the low waves may not fall by itself
        flat = q <= best[1]
        tilt = np.polyfit(q[flat], c[flat], 1, w=np.sqrt(weight[flat]))[0]
        if tilt > -0.5 * best[2]:
            hurst = best[2] / 2.0 - 1.0
            sound = hurst if 0.0 < hurst <= 1.2 else None
            return RollOff(math.exp(-best[1]), source="knee of the power spectrum", hurst=sound)
    # longer than a third of the field, a wave is seen too seldom to tell where the spectrum turns flat
    if correlation is not None and 4.0 * correlation <= float(spectrum.wavelength.max()) / 3.0:
        return RollOff(wavelength=4.0 * correlation, source="four autocorrelation lengths (no clear knee)")
    return RollOff(wavelength=None, source="not in the field: the spectrum still rises at its longest waves")


def _hann(count: int) -> FloatArray:
    """Return a Hann window at the middles of `count` pixels, shape (count,)."""
    return 0.5 - 0.5 * np.cos(2.0 * math.pi * (np.arange(count) + 0.5) / count)
