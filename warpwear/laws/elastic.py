"""Hertz solved the smooth elastic contact, and Winkler foundations get a stiffness that matches it."""

import math
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.archard import Scales

optimize = lazy.module("scipy.optimize")
special = lazy.module("scipy.special")

#: C_W of K_N = C_W E*/a (thesis eq 2.7 for a ball) -> what of Hertz's the foundation then reproduces. One
#: constant cannot match all three.
MATCHES = {"area": 16.0 / (3.0 * math.pi), "pressure": 3.0 / math.pi, "approach": 4.0 / (3.0 * math.pi)}

#: H/(E*·rms slope) up to which nearly all asperities flow (load over hardness is low by some 5 %), and from
#: which they stay elastic: of their pressures, mean E*·slope/2, some 4 % would be above H.
FLOW, STAY_ELASTIC = 0.2, 1.0
#: E* of two bodies of steel [MPa], of 210 GPa and Poisson's ratio 0.3, to judge by where it is not known.
OF_STEEL = 210.0e3 / (2.0 * (1.0 - 0.3**2))
#: Least fatigue limit in torsion over that in bending which Crossland's criterion is made for.
LEAST_TORSION = 1.0 / math.sqrt(3.0)


def effective_modulus(first: tuple[float, float], second: tuple[float, float]) -> float:
    """Return the modulus E* of two elastic bodies in contact, 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.

    Parameters
    ----------
    first, second
        Young's modulus and Poisson's ratio of each body.

    Returns
    -------
    float
        In the unit of Young's moduli.

    Raises
    ------
    InputError
        For a modulus that is not positive, or a ratio not above -1 and up to 0.5.

    Examples
    --------
    >>> round(warpwear.effective_modulus((210e3, 0.3), (193e3, 0.29)))  # MPa
    110145
    """
    for young, poisson in (first, second):
        if not (young > 0.0 and -1.0 < poisson <= 0.5):
            raise InputError(f"young = {young:g}, poisson = {poisson:g}: above 0, and -1 to 0.5, are allowed")
    return 1.0 / sum((1.0 - poisson**2) / young for young, poisson in (first, second))


def asperities(hardness: float, modulus: float | None, slope: float) -> tuple[float, str]:
    """Return H/(E*·rms slope) of a rough surface, and how its asperities yield; without E* by steel's."""
    ratio = hardness / ((modulus or OF_STEEL) * slope) if slope > 0.0 else math.inf
    if ratio <= FLOW:
        return ratio, "plastic"
    return ratio, "elastic" if ratio >= STAY_ELASTIC else "partly plastic"


def joint_laws(
    pressures: FloatArray, *, sq: float, slope: float, hardness: float, modulus: float
) -> dict[str, FloatArray]:
    """Return the conductance [1/mm] of a joint by power laws of asperities that flow, and of elastic ones.

    sq: rms height [mm]; slope: rms gradient, √π times the mean slope of a Gaussian profile. A law without a
    value is left out: both of a flat, the plastic one without a hardness.

    Of Cooper, Mikic, Yovanovich, Int. J. Heat Mass Transfer 12 (1969) 279, the power is Yovanovich's of 1982;
    elastic: Mikic, Int. J. Heat Mass Transfer 17 (1974) 205.
    """
    if not slope:
        return {}
    mean = slope / math.sqrt(math.pi)
    plastic = 1.25 * mean / sq * (pressures / hardness) ** 0.95
    elastic = 1.55 * mean / sq * (math.sqrt(2.0) * pressures / (modulus * mean)) ** 0.94
    return {"plastic": plastic, "elastic": elastic} if math.isfinite(hardness) else {"elastic": elastic}


@dataclass(frozen=True)
class Hertz(Scales):
    """A smooth elastic counter-body is pressed on a flat (Johnson, Contact Mechanics, 1985, section 4.2).

    A ball by default; with another radius across sliding the contact is an ellipse. One radius may be
    infinite: that is a cylinder, pressed over its length, whose approach has no absolute zero (NaN).
    """

    SCALES: ClassVar[bool] = True

    modulus: float  # E* [MPa]
    counter_radius: float  # R [mm] of the section along sliding
    load: float  # F [N]
    radius_across: float | None = None  # of the section across sliding [mm]; None: of a ball
    length: float = math.inf  # of a cylinder [mm]

    @property
    def semi_axes(self) -> tuple[float, float]:
        """Return the half widths of the contact [mm] along sliding and across it; of a line one is its own.

        A ball has a³ = 3 F R/(4 E*), a line a² = 4 F R/(π E* l), an ellipse elliptic integrals: here those of
        Carlson, K − E = e² R_D(0, 1−e², 1)/3 and E/(1−e²) − K = e² R_D(0, 1, 1−e²)/3, which do not cancel.
        """
        along, across = self.counter_radius, self.radius_across
        if across is None or along == across:
            a = float((0.75 * self.load * along / self.modulus) ** (1.0 / 3.0))
            return a, a
        least, most = sorted((along, across))
        if math.isinf(most):
            a = math.sqrt(4.0 * self.load * least / (math.pi * self.modulus * self.length))
            return (a, 0.5 * self.length) if along < across else (0.5 * self.length, a)
        ratio = self._ratio(most / least)
        integrals = special.elliprd(0.0, 1.0, ratio**2) * special.elliprd(0.0, ratio**2, 1.0)
        one = self.load * math.sqrt(least * most) / (math.pi * self.modulus)
        mean = float(one * ratio**1.5 * math.sqrt(integrals)) ** (1.0 / 3.0)
        axes = mean * math.sqrt(ratio), mean / math.sqrt(ratio)
        return axes if along < across else axes[::-1]

    @staticmethod
    def _ratio(of_radii: float) -> float:
        """Find the ellipse's lesser over its greater axis. of_radii: the greater radius over the lesser."""

        def excess(log: float) -> float:
            squared = math.exp(2.0 * log)
            ratio = special.elliprd(0.0, 1.0, squared) / special.elliprd(0.0, squared, 1.0)
            return float(math.log(ratio / of_radii))

        return math.exp(optimize.brentq(excess, -math.log(of_radii) - 1.0, 0.0, xtol=1e-14))

    @property
    def is_line(self) -> bool:
        """Tell whether the contact is a line's, of a cylinder."""
        return math.isinf(max(self.counter_radius, self.radius_across or 0.0))

    @property
    def radius(self) -> float:
        """Return the radius of the contact [mm], of an ellipse √(a b); of a line its half width."""
        along, across = self.semi_axes
        if self.is_line:
            return across if math.isinf(self.counter_radius) else along
        return along if along == across else math.sqrt(along * across)

    @property
    def area(self) -> float:
        """Return the area of the contact [mm²]: π a², of a line 2 a times its length."""
        return 2.0 * self.radius * self.length if self.is_line else math.pi * self.radius**2

    @property
    def peak_pressure(self) -> float:
        """Return the pressure in the middle [MPa]: 3/2 of the mean, of a line 4/π of it."""
        return (4.0 / math.pi if self.is_line else 1.5) * self.load / self.area

    @property
    def approach(self) -> float:
        """Tell how far the bodies approach each other [mm]: a²/R, of an ellipse p₀ b K(e)/E*."""
        least, most = sorted(self.semi_axes)
        if self.is_line:
            return math.nan
        if least == most:
            return least**2 / self.counter_radius
        integral = special.elliprf(0.0, (least / most) ** 2, 1.0)  # K(e)
        return float(self.peak_pressure * least * integral / self.modulus)

    def pressure(self, r: FloatArray) -> FloatArray:
        """Return the pressure [MPa] at distances r along sliding from the middle [mm], of any shape."""
        inside = np.maximum(0.0, 1.0 - np.square(r / self.semi_axes[0]))
        if math.isinf(self.counter_radius):
            inside = (np.abs(r) <= self.semi_axes[0]).astype(np.float64)
        return np.asarray(self.peak_pressure * np.sqrt(inside))

    def foundation(self, match: str, *, radius: float | None = None) -> float:
        """Return K_N = C_W E*/a [N/mm³] (thesis eq 2.7); of an ellipse and a line what gives the same value.

        match: which of Hertz's values K_N reproduces, a key of `MATCHES`. radius: a [mm], Hertz's by default.
        A foundation of stiffness K bears F = π K δ² √(R R') under an ellipse, of the area 2π δ √(R R').
        """
        if self.radius_across in (None, self.counter_radius):
            return MATCHES[match] * self.modulus / (radius or self.radius)
        return self._foundation(match) * (self.radius / radius if radius else 1.0)

    def _foundation(self, match: str) -> float:
        """Return K_N of an ellipse or a line."""
        if self.is_line:
            factor = {"area": 3.0 * math.pi / 8.0, "pressure": 64.0 / (9.0 * math.pi**2)}[match]
            return factor * self.modulus / self.radius
        mean = math.sqrt(self.counter_radius * (self.radius_across or 0.0))
        depth = {"area": self.radius**2 / (2.0 * mean), "approach": self.approach}.get(match)
        if depth is None:
            return math.pi * mean * self.peak_pressure**2 / self.load
        return self.load / (math.pi * mean * depth**2)


#: Separations, in standard deviations of the summits, between which Greenwood and Williamson's is looked for.
SEPARATIONS = (-8.0, 30.0)


@dataclass(frozen=True)
class SpectralMoments:
    """Spectral moments are mean squares of profiles through an isotropic Gaussian surface."""

    m0: float  # of the height [mm²]
    m2: float  # of the slope [-]
    m4: float  # of the curvature [1/mm²]

    @classmethod
    def of(cls, heights: FloatArray, cell: float) -> Self:
        """Return the moments of one period of a surface, from its spectrum.

        heights: [mm], shape (nx, ny). cell: size of a cell [mm].

        A profile's mean square slope is half the surface's, its mean square curvature three eighths of the
        Laplacian's (Nayak 1971, J. Lubr. Technol. 93, 398).
        """
        nx, ny = heights.shape
        q_x = 2.0 * math.pi * np.fft.fftfreq(nx, cell)
        q_y = 2.0 * math.pi * np.fft.fftfreq(ny, cell)
        squared = np.add.outer(q_x**2, q_y**2)
        power = np.abs(np.fft.fft2(heights - heights.mean())) ** 2 / heights.size**2
        m0, slope, laplacian = (float(np.sum(power * squared**n)) for n in (0, 1, 2))
        return cls(m0, slope / 2.0, 3.0 * laplacian / 8.0)

    @property
    def rms_slope(self) -> float:
        """Return the root mean square h' of the surface's gradient [-]."""
        return math.sqrt(2.0 * self.m2)


def persson_area(mean_pressure: FloatArray, *, modulus: float, rms_slope: float) -> FloatArray:
    """Return the real over the nominal area, erf(√2 p̄/(E* h')), of elastic bodies without adhesion.

    mean_pressure: p̄ [MPa], of any shape. modulus: E* [MPa]. rms_slope: h' of the surface [-].
    Source: Persson 2001, J. Chem. Phys. 115, 3840, in the form of Manners and Greenwood 2006, Wear 261, 600.
    """
    ratio = math.sqrt(2.0) / (modulus * rms_slope) * np.asarray(mean_pressure, dtype=np.float64)
    return np.vectorize(math.erf, otypes=[np.float64])(ratio)


def greenwood_williamson_area(
    mean_pressure: FloatArray, *, modulus: float, moments: SpectralMoments
) -> FloatArray:
    """Return the real over the nominal area of spherical summits that yield each by itself.

    mean_pressure: p̄ [MPa], of any shape. modulus: E* [MPa]. An area above 1 means nothing; it is NaN for
    pressures beyond the theory's range. Sources: Greenwood and Williamson 1966, Proc. R. Soc. A 295, 300;
    McCool 1987, J. Tribol. 109, 264 for the summits of a spectrum.
    """
    alpha = moments.m0 * moments.m4 / moments.m2**2
    density = moments.m4 / (6.0 * math.pi * math.sqrt(3.0) * moments.m2)
    radius = 0.375 * math.sqrt(math.pi / moments.m4)
    scatter = math.sqrt((1.0 - 0.8968 / alpha) * moments.m0)
    scale = 4.0 / 3.0 * modulus * density * math.sqrt(radius * scatter) * scatter

    def pressure(separation: float) -> float:
        # ∫ (s − t)^(3/2) φ(s) ds from t on, by a parabolic cylinder function
        integral = math.gamma(2.5) * special.pbdv(-2.5, separation)[0] * math.exp(-(separation**2) / 4.0)
        return float(scale * integral / math.sqrt(2.0 * math.pi))

    def area(mean: float) -> float:
        low, high = SEPARATIONS
        if mean == 0.0:
            return 0.0
        if not pressure(high) < mean < pressure(low):
            return math.nan
        t = optimize.brentq(lambda t: math.log(pressure(t) / mean), low, high)
        beyond = 0.5 * math.erfc(t / math.sqrt(2.0))
        integral = math.exp(-0.5 * t**2) / math.sqrt(2.0 * math.pi) - t * beyond
        return math.pi * density * radius * scatter * integral

    return np.vectorize(area, otypes=[np.float64])(mean_pressure)
