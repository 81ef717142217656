"""Tell the error of a volume: what the same levelling and sum would find anywhere on unworn surface.

Levelling and sum are one weighted sum of heights, so its scatter over all places of an endless unworn surface
follows from the spectrum of that surface. The spectrum is taken in bands from the heights that are unworn, by
restricted likelihood: that counts correlated neighbours for what they are, needs no window that fits beside
the worn part, and knows what the levelling took off. Waves that the unworn part is too small to show are tied
to the neighbouring bands. How badly the bands are known widens the error.
"""

import math
from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray

linalg = lazy.module("scipy.linalg")
optimize = lazy.module("scipy.optimize")
special = lazy.module("scipy.special")

BANDS = 1.5  # per octave
SPREAD = 0.3  # width of a band over its wave number, so that neighbours overlap
LONGEST = 4.0  # wavelengths, in extents of the field: levelling leaves nothing of longer ones
ROUGH = 0.5  # Hurst exponent of rough surfaces: 0 to 1
CHANGED = -0.5  # of the difference of two measurements: between that of white noise, -1 in a plane, and 0
# standard deviation, about 2 H log 2, of how the log variance grows from octave to octave
TIE = math.log(8.0)
LOOSE = 100.0  # standard deviation of the log power of all bands together, which is not known beforehand
LINE = 3.0  # standard deviation of the log power of a regular wave: it may be missing
WAVES = 4.0  # in the field, at least, of a regular wave; fewer may be chance
# of spectra, in each of the rounds in which those that the heights allow are found: along a line, and in a
# plane, where each takes ten times as long; the error is then known to about 5 and 10 %
DRAWS, DRAWS_IN_PLANE = 1000, 250
ROUNDS = 2
FREEDOM = 6.0  # degrees, of Student's t: spectra far from the likeliest are drawn, too
NARROWEST = 0.03  # standard deviation of the log power of a band that is drawn in a second round
STEPS = 60  # of the search for the most likely spectrum
LONGEST_STEP = 2.0  # of the search, in log power
SETTLED = 0.01  # gain in log likelihood below which the search ends
FEWEST = 4  # heights beyond the terms of the levelling
AT_ONCE = 16  # spectra whose likelihoods are taken together
CORNER = 1e30  # far above the square of what is solved for, m / 1e-9 at most
ONE_SIGMA = math.erf(math.sqrt(0.5))  # probability within one standard deviation
ROUNDING = 1e-12  # of the largest height


@dataclass(frozen=True, eq=False)
class Waviness:
    """The waviness of an unworn surface is known by spectra that its heights allow."""

    covariances: FloatArray  # of bands between n places for a variance of 1, shortest first, (bands, n, n)
    spectra: FloatArray  # variances [mm²] of the bands, one spectrum a row, shape (draws, bands)
    chances: FloatArray  # of each spectrum, with the sum 1, shape (draws,)

    def error(self, weights: FloatArray, alone: float) -> float:
        """Return the standard error of the sum of heights times weights, shape (n,), over unworn surface.

        alone: variance of that sum if neighbouring points were independent, and a mean over a place had a
        variance of 1. The error is half the interval that holds 68.27 % of such sums, over all places and all
        the spectra.
        """
        by_band = np.einsum("i,bij,j->b", weights, self.covariances, weights, optimize=True)
        by_band[0] = alone
        sigma = np.sqrt(np.maximum(self.spectra @ by_band, 0.0))
        if not sigma.any():
            return 0.0
        least, most = float(sigma[sigma > 0.0].min()), float(sigma.max())
        sigma = np.maximum(sigma, least)

        def lacks(log_width: float) -> float:
            inside = special.erf(math.exp(log_width) / (math.sqrt(2.0) * sigma))
            return float(self.chances @ inside) - ONE_SIGMA

        # at the ends every spectrum has more, or less, than its standard deviation
        return math.exp(optimize.brentq(lacks, math.log(0.9 * least), math.log(1.1 * most), rtol=1e-9))


def waviness(
    heights: FloatArray,
    *,
    distances: FloatArray,
    unworn: BoolArray,
    terms: FloatArray,
    spacing: float,
    hurst: float,
    plane: bool = False,
    regular: float | None = None,
) -> Waviness:
    """Find the waviness of heights [mm], shape (n,), where they are unworn, shape (n,).

    distances: between all places [mm], (n, n); terms: what the levelling takes off, (n, p); spacing: of the
    places [mm]; hurst: exponent H that is likely beforehand, where the variance of an octave grows with the
    wavelength to the power 2H; plane: whether the places lie in a plane, whose waves run in all directions,
    or along a line; regular: wave number [rad/mm] of a wave that keeps its phase, such as a feed, see
    `regular_wave`. Raises InputError where too few heights are unworn.
    """
    known = np.flatnonzero(unworn)
    if known.size < terms.shape[1] + FEWEST:
        raise InputError("too little unworn surface to tell an error from: a wider measurement is needed")
    low, high = 2.0 * math.pi / (LONGEST * float(distances.max())), math.pi / spacing
    count = max(3, math.ceil(BANDS * math.log2(high / low)) + 1)
    numbers = np.geomspace(high, low, count)
    wave = special.j0 if plane else np.cos  # correlation over a phase, of all directions
    shorter = np.eye(heights.size)  # than the spacing
    bands = [
        shorter,
        *(wave(p) * np.exp(-0.5 * np.square(SPREAD * p)) for p in np.multiply.outer(numbers, distances)),
    ]
    level = np.concatenate([[0.0], -2.0 * hurst * np.log(numbers / high)])
    step = np.diff(np.eye(len(bands)), axis=0)
    tie = step.T @ step / (TIE**2 / BANDS) + np.eye(len(bands)) / LOOSE**2
    if regular is not None:
        bands.append(np.cos(regular * distances))
        level = np.append(level, 0.0)
        tie = linalg.block_diag(tie, 1.0 / LINE**2)
    covariances = np.stack(bands)
    # contrasts that no term of the levelling changes
    contrasts = linalg.qr(terms[known])[0][:, terms.shape[1] :]
    seen = contrasts.T @ heights[known]
    if np.abs(seen).max() <= ROUNDING * max(float(np.abs(heights).max()), ROUNDING):
        return Waviness(covariances, np.zeros((1, len(bands))), np.ones(1))
    draws = DRAWS_IN_PLANE if plane else DRAWS
    seen_bands = contrasts.T @ covariances[:, known][:, :, known] @ contrasts
    return Waviness(covariances, *_likely_spectra(seen, seen_bands, level, tie, draws=draws))


def regular_wave(heights: FloatArray, *, places: FloatArray, unworn: BoolArray) -> float | None:
    """Return the wave number [rad/mm] of the strongest wave of levelled heights [mm] along a line.

    Shapes are (n,); places [mm]. None where the field holds fewer than four of it: that may be a chance.
    """
    extent = float(np.ptp(places))
    waves = np.arange(1.0, 0.5 * places.size, 0.125)
    numbers = 2.0 * math.pi * waves / extent
    strength = np.abs(np.exp(1j * np.multiply.outer(numbers, places[unworn])) @ heights[unworn])
    strongest = int(np.argmax(strength))
    return float(numbers[strongest]) if waves[strongest] >= WAVES else None


def _likely_spectra(
    seen: FloatArray, bands: FloatArray, level: FloatArray, tie: FloatArray, *, draws: int
) -> tuple[FloatArray, FloatArray]:
    """Return variances of bands that contrasts allow, shape (draws, bands), and the chance of each, (draws,).

    seen: contrasts [mm], (m,); bands: their covariances for a variance of 1, (bands, m, m); level, tie: mean
    of the log variances beforehand, but for the size of the contrasts, (bands,), and precision, (bands,
    bands). About the likeliest, found by Fisher's scoring, spectra are drawn. Each counts by how likely it is
    over how likely it was drawn (importance sampling, whose second round draws as the first found). Log
    variances are far from Gaussian: heights that show no long waves allow none as well as few.
    """
    size, scale = seen.size, float(seen @ seen) / seen.size
    start = math.log(scale / len(bands)) + level
    bordered = np.pad(bands, ((0, 0), (0, 1), (0, 1)))

    def likelihood(logs: FloatArray) -> tuple[FloatArray, FloatArray]:
        whole = np.tensordot(np.exp(logs), bordered, 1)
        diagonal = np.einsum("dii->di", whole)
        # long waves alone are the same everywhere, but for rounding
        diagonal += 1e-9 * scale + 1e-12 * diagonal.sum(axis=1, keepdims=True)
        # under the factor L then stands the solution of L x = seen, whatever the corner, if it is large
        whole[:, size, :size], whole[:, size, size] = seen, CORNER
        factor = np.linalg.cholesky(whole)
        rest, apart = factor[:, size, :size], logs - start
        value = -np.log(np.einsum("dii->di", factor)[:, :size]).sum(axis=1)
        value -= 0.5 * (np.square(rest).sum(axis=1) + np.einsum("di,ij,dj->d", apart, tie, apart))
        return value, whole[:, :size, :size]

    log = start
    value, whole = (one[0] for one in likelihood(log[None]))
    for _ in range(STEPS):
        inverse = np.linalg.inv(whole)
        parts = inverse @ (bands * np.exp(log)[:, None, None])
        rest = inverse @ seen
        pulls = 0.5 * np.einsum("i,bij,j->b", rest, bands, rest, optimize=True) * np.exp(log)
        gradient = pulls - 0.5 * np.trace(parts, axis1=1, axis2=2) - tie @ (log - start)
        information = 0.5 * np.einsum("bij,cji->bc", parts, parts, optimize=True) + tie
        move = np.linalg.solve(information, gradient)
        move *= min(1.0, LONGEST_STEP / float(np.abs(move).max()))
        gain = -math.inf
        for _ in range(10):
            tried, tried_whole = (one[0] for one in likelihood((log + move)[None]))
            gain = tried - value
            if gain >= 0.0:
                break
            move *= 0.5
        if gain < 0.0:
            break
        log, value, whole = log + move, tried, tried_whole
        if gain < SETTLED:
            break
    random = np.random.default_rng(0)
    middle, covariance, count = log, np.linalg.inv(information), len(bands)
    for _ in range(ROUNDS):
        normal = random.normal(size=(draws, count))
        drawn = normal / np.sqrt(random.chisquare(FREEDOM, size=draws) / FREEDOM)[:, None]
        logs = middle + drawn @ np.linalg.cholesky(covariance).T
        tails = 0.5 * (FREEDOM + count) * np.log1p(np.square(drawn).sum(axis=1) / FREEDOM)
        blocks = np.array_split(logs, math.ceil(draws / AT_ONCE))
        weights = np.concatenate([likelihood(block)[0] for block in blocks]) + tails
        chances = np.exp(weights - weights.max())
        # no single spectrum decides: truncated importance sampling (Ionides 2008)
        chances = np.minimum(chances, chances.mean() * math.sqrt(draws))
        chances /= chances.sum()
        # the roots, as few of the first draws may have most of the chances
        roots = np.sqrt(chances) / np.sqrt(chances).sum()
        middle = roots @ logs
        covariance = (logs - middle).T @ ((logs - middle) * roots[:, None]) + NARROWEST**2 * np.eye(count)
    return np.exp(logs), chances
