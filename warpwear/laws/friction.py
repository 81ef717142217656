"""A coefficient of friction follows from an area: junctions shear, with an offset for ploughing; or is μ.

μ = μ_p + τ A / F (thesis eqs 4.18 to 4.20; the offset after eq 2.8). Which area A shears, and when a
measured coefficient fixes τ, are choices of the study. τ is a constant τ0 times `FACTORS`. With a film τ is
the mean over the cells in contact, of which a fraction is bare. By Coulomb's law it is one number.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.archard import Scales, decay_integral
from warpwear.laws.junctions import junction_strength
from warpwear.laws.passes import WHEN, Laps, When, mean_over, within
from warpwear.laws.states import shares

#: A load [N], or one a step.
Load = float | FloatArray
AREAS = ("contact", "touched", "cumulative", "nominal")
#: Keys of [friction] that the coefficient is linear in: the offset, and the shear strengths.
COEFFICIENT = "coefficient"
PLOUGHING, STRENGTH, FILM_STRENGTH = "ploughing", "shear_strength", "film.shear_strength"
#: Keys of a measured coefficient, to which the shear strength is fitted.
FITTED = (COEFFICIENT, "calibrate")
#: Key of the part of its pressure that shears a cell at most.
LARGEST = "largest_coefficient"


@dataclass(frozen=True)
class StrengthFactor:
    """A factor makes of τ0 the shear strength of bare contact at a step; without its keys it is 1.

    of: history and the numbers of the keys -> factor of every step. columns: of the history, that it reads.
    formula: in LaTeX. sentence: what a paper says of it, with {key} for values. scales: see `archard.Scales`.
    """

    keys: tuple[str, ...]
    of: Callable[..., FloatArray]
    formula: str
    sentence: str
    columns: tuple[str, ...] = ("distance",)
    scales: bool = False


def _decay(history: Mapping[str, FloatArray], length: Any) -> FloatArray:
    """Return e^(−L/length) at the end of every step; where what shears wears its mean over the step."""
    distance, increment = history["distance"], history.get("increment")
    if "area_sheared" not in history or increment is None or not np.all(increment > 0.0):
        return np.asarray(np.exp(-distance / length))
    return np.asarray(decay_integral(distance - increment, increment, length) / increment)


RUNNING_IN = StrengthFactor(
    keys=("initial_ratio", "running_in"),
    of=lambda history, ratio, length: 1.0 + (ratio - 1.0) * _decay(history, length),
    formula=r"\left(1 + (r - 1) e^{-L/L_\tau}\right)",
    sentence="it runs in by 1 + (r − 1) e^(−L/L_τ), r = {initial_ratio:.4g}, L_τ = {running_in:.4g} mm",
    scales=True,
)
FACTORS = (RUNNING_IN,)
#: Keys of what film, its wear, bare metal and cover have, which friction of three states is linear in, ...
STATES = tuple(f"states.{key}" for key in ("film", "slope", "metal", "cover"))
#: ... and of the rates by which these share the load.
RATES = tuple(f"states.{key}" for key in ("spread", "seed", "cover_rate"))
#: Keys of [friction] that are numbers of the law.
NUMBERS = (PLOUGHING, STRENGTH, FILM_STRENGTH, *(key for factor in FACTORS for key in factor.keys))
NUMBERS += STATES + RATES
KEYS = (*NUMBERS, *FITTED, LARGEST, "area", "states.per")
#: Sliding distance of a lap, or of two strokes [mm]: beside the keys, None where there is none.
LAP = "lap"


@dataclass(frozen=True)
class FrictionLaw(Scales):
    """Holds what a contact's friction follows from; `Study.friction_law` is that of a study.

    Called with pressures, it gives the shear stress of cells.

    Attributes
    ----------
    values : dict
        Key of [friction] -> its value, a number also as an array.

    Examples
    --------
    >>> keys = {"shear_strength": "5 MPa", "ploughing": 0.1}
    >>> law = warpwear.Study.load("v3-fine").replace(friction=keys).friction_law
    >>> pressure = np.array([0.0, 10.0, 40.0])
    >>> law(pressure=pressure).tolist()
    [0.0, 6.0, 9.0]
    >>> float(law(pressure=pressure).sum() / pressure.sum())  # the coefficient of friction
    0.3
    """

    SCALES: ClassVar[bool] = True
    #: Key of what is the same at every step.
    constant: ClassVar[str] = PLOUGHING

    values: Mapping[str, Any]

    @property
    def area(self) -> str:
        """Tell which area shears, a name of `AREAS`."""
        return str(self.values["area"])

    @property
    def factors(self) -> tuple[StrengthFactor, ...]:
        """Return the factors whose keys have values."""
        return tuple(f for f in FACTORS if all(self.values[key] is not None for key in f.keys))

    @property
    def strengths(self) -> tuple[str, ...]:
        """Return the keys of the shear strengths that cells have."""
        return (STRENGTH,) if self.values[FILM_STRENGTH] is None else (STRENGTH, FILM_STRENGTH)

    @property
    def scales(self) -> bool:
        """Tell whether an area of the step shears, by factors that scale; see `archard.Scales`."""
        return super().scales and self.area != "cumulative" and all(f.scales for f in self.factors)

    @property
    def said(self) -> str:
        """Return half a sentence on the factors and on ploughing; empty where there are none."""
        parts = [factor.sentence.format(**self.values) for factor in self.factors]
        if self.values[PLOUGHING]:
            parts.append(f"{self.values[PLOUGHING]:.4g} of the coefficient does not shear")
        if self.values[LARGEST]:
            parts.append(f"at most {self.values[LARGEST]:.4g} of its pressure shears a cell")
        return "; ".join(parts)

    @property
    def formula(self) -> str:
        """Return the coefficient of friction in LaTeX; τ_f: strength of cells with film, φ: bare part."""
        if self.values[LARGEST]:
            shear = r"\int_A \min(\tau, \mu_\mathrm{max} p) \, \mathrm{d}A / F"
            return r"\mu_\mathrm{p} + " * bool(self.values[PLOUGHING]) + shear
        tau = r" \, ".join([r"\tau_0", *(factor.formula for factor in self.factors)])
        if FILM_STRENGTH in self.strengths:
            tau = rf"\left(\tau_\mathrm{{f}} + ({tau} - \tau_\mathrm{{f}}) \varphi\right)"
        return r"\mu_\mathrm{p} + " * bool(self.values[PLOUGHING]) + rf"{tau} \, A / F"

    def factor(self, history: Mapping[str, FloatArray], strength: str = STRENGTH) -> FloatArray:
        """Return the shear strength over the given one at every step; 1 for that of a film."""
        product = np.ones_like(history["distance"])
        for factor in self.factors if strength == STRENGTH else ():
            product = product * factor.of(history, *(self.values[key] for key in factor.keys))
        return product

    def strength(self, history: Mapping[str, FloatArray], **fit: Any) -> FloatArray:
        """Return τ [MPa] of every step. fit: as of `final_strength`."""
        bare = self.final_strength(history, **fit) * self.factor(history)
        return self._mean(bare, self.values[FILM_STRENGTH], history)

    def coefficient(self, history: Mapping[str, FloatArray], *, load: Load, **fit: Any) -> FloatArray:
        """Return the coefficient of friction of every step.

        Parameters
        ----------
        history : dict
            Columns of a run's history, or arrays by their names: distance [mm] and that of the area, such as
            area_contact [mm²].
        load : float or array
            Normal load [N], of a programme that of every step.
        **fit
            finished: whether the history is whole; laps: of a ball on a track.

        Returns
        -------
        array
            NaN while τ waits for the end.
        """
        area = history.get("area_sheared")
        if area is not None:  # what shears wears: the mean over the step, as if all cells of it were bare
            tau = self.final_strength(history, load=load, **fit) * self.factor(history)
        else:
            tau, area = self.strength(history, load=load, **fit), history[f"area_{self.area}"]
        return np.asarray(self.values[PLOUGHING] + tau * area / load)

    def terms(self, history: Mapping[str, FloatArray]) -> dict[str, Any]:
        """Return key -> what it multiplies in the coefficient, for what no area shears."""
        return {self.constant: np.ones_like(history["distance"])}

    def __call__(self, *, pressure: Any, distance: Any = 0.0, bare_fraction: Any = 1.0) -> FloatArray:
        """Return the shear stress of cells [MPa]; its mean over that of their pressures is the friction.

        Parameters
        ----------
        pressure : float or array
            Of each cell [MPa], 0 out of contact.
        distance : float or array
            Slid before [mm]; broadcasts with the pressure.
        bare_fraction : float or array
            Part of a cell without film, where there is one.

        Returns
        -------
        array
            The shear stress of each cell.

        Raises
        ------
        InputError
            Where the shear strength is fitted to a measured coefficient, which takes a run.
        """
        share, strength = self.tractions
        if strength is None:
            raise InputError("friction.shear_strength is not given: a run fits it to friction.coefficient")
        pressure, distance, bare_fraction = np.broadcast_arrays(pressure, distance, bare_fraction)
        history = {"distance": distance, "bare_fraction": bare_fraction}
        tau = self._mean(strength * self.factor(history), self.values[FILM_STRENGTH], history)
        if self.values[LARGEST]:
            tau = np.minimum(tau, self.values[LARGEST] * pressure)
        return np.asarray(share * pressure + np.where(pressure > 0.0, tau, 0.0))

    @property
    def tractions(self) -> tuple[Any, Any]:
        """Return the part of its pressure that shears a cell, and the strength that does beside it [MPa]."""
        return self.values[PLOUGHING], self.values[STRENGTH]

    @property
    def course(self) -> dict[str, Any]:
        """Return the numbers by which the strength runs in, as the energy law names them; none without."""
        numbers = (self.values[key] for key in RUNNING_IN.keys)
        return dict(zip(("ratio", "running_in"), numbers, strict=True)) if RUNNING_IN in self.factors else {}

    def sheared(self, history: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Return key of a strength -> the area [mm²] that it shears at every step, without `factor`."""
        area = history[f"area_{self.area}"]
        if FILM_STRENGTH not in self.strengths:
            return dict.fromkeys(self.strengths, area)
        bare, filmed = self._mean(1.0, 0.0, history), self._mean(0.0, 1.0, history)
        return {STRENGTH: area * bare, FILM_STRENGTH: area * filmed}

    @staticmethod
    def _mean(bare: Any, filmed: Any, history: Mapping[str, FloatArray]) -> FloatArray:
        """Return the mean shear strength of the cells in contact. filmed: of those with a film, or None."""
        return np.asarray(bare if filmed is None else filmed + (bare - filmed) * history["bare_fraction"])

    def final_strength(
        self, history: Mapping[str, FloatArray], *, load: Load, finished: bool, laps: Laps | None = None
    ) -> float:
        """Return τ0 [MPa], as given or as calibrated; NaN while it waits for the end.

        load: F [N], of a programme that of every step. finished: whether the history is whole. laps: of a
        ball on a track.
        """
        when = self.values["calibrate"]
        if self.values[STRENGTH] is not None:
            return self.values[STRENGTH]
        if when == "end" and not finished:
            return math.nan
        return self.strength_for(history, when, area=self.area, load=load, laps=laps)

    def strength_for(
        self, history: Mapping[str, FloatArray], when: When, *, area: str, load: Load, laps: Laps | None
    ) -> float:
        """Return τ0 = (μ0 − μ_p) F / A0 [MPa], by which the measured coefficient holds (eq 4.19).

        when: at the start or the end; A0 is the mean over the first pass or the last cycle, as an area
        changes with the place on a track, and F the load there. A0 contains `factor`.
        """
        if isinstance(load, np.ndarray):
            here = load[within(history, when, laps)]
            load = float(here[0]) if np.ptp(here) == 0.0 else mean_over(history, load, when, laps)
        sheared = mean_over(history, history[f"area_{area}"] * self.factor(history), when, laps)
        return fitted_strength(self.values["coefficient"], self.values[PLOUGHING], load=load, area=sheared)

    def calibrations(
        self, history: Mapping[str, FloatArray], *, load: Load, hardness: float, laps: Laps | None = None
    ) -> dict[str, float]:
        """Return τ0 [MPa] by which the measured coefficient holds with each area, at the start and the end.

        What "the" shear strength is depends on the area that it was calibrated with; H/(3√3) is the usual
        estimate from hardness.
        """
        # Nothing is left to shear, or what shears is not in proportion to the strength.
        if self.values["coefficient"] <= self.values[PLOUGHING] or self.values[LARGEST]:
            return {}
        strengths = {
            f"{area}_{when}": self.strength_for(history, when, area=area, load=load, laps=laps)
            for area in AREAS
            for when in WHEN
        }
        return strengths | ({"hardness": junction_strength(hardness)} if math.isfinite(hardness) else {})


class CoulombLaw(FrictionLaw):
    """Coulomb's law has one coefficient μ, ploughing included, whatever the area."""

    SCALES = True
    constant = COEFFICIENT
    factors = strengths = ()
    formula = r"\mathrm{const}"

    @property
    def said(self) -> str:
        """Return that there is nothing beside the coefficient."""
        return ""

    @property
    def tractions(self) -> tuple[Any, Any]:
        """Return μ, and no strength."""
        return self.values[COEFFICIENT], 0.0

    def coefficient(self, history: Mapping[str, FloatArray], **fit: Any) -> FloatArray:
        """Return μ of every step."""
        return np.full_like(history["distance"], self.values[COEFFICIENT])

    def final_strength(self, history: Mapping[str, FloatArray], **fit: Any) -> float:
        """Return NaN: there is no shear strength."""
        return math.nan

    def calibrations(self, history: Mapping[str, FloatArray], **fit: Any) -> dict[str, float]:
        """Return none: no shear strength is fitted."""
        return {}


class StatesLaw(CoulombLaw):
    """A film is lost, bare metal is left and gets covered: each has its coefficient; a law that fits."""

    constant = STATES[0]
    formula = r"(1 - b) (\mu_\mathrm{f} + s N) + (b - c) \mu_\mathrm{m} + c \mu_\mathrm{c}"

    @property
    def said(self) -> str:
        """Return half a sentence on what follows the distance."""
        film, slope, metal, cover, r, e, k = (self.values[key] for key in STATES + RATES)
        return (
            f"coefficients {film:.4g} + {slope:.4g} N under film, {metal:.4g} of bare metal, {cover:.4g} "
            "under cover; of the load b has lost its film, c is covered: db/dN = (1 − b)(e + r b), dc/dN = "
            f"k (b − c), r = {r:.4g}, e = {e:.4g}, k = {k:.4g}, N in {self.values['states.per']}"
        )

    @property
    def tractions(self) -> tuple[Any, Any]:
        """Return that no part of the pressure shears at all distances, and no strength."""
        return math.nan, 0.0

    def terms(self, history: Mapping[str, FloatArray]) -> dict[str, Any]:
        """Return key -> the share of the load, that of the slope times laps or mm."""
        count = history["distance"] / (self.values[LAP] if self.values["states.per"] == "lap" else 1.0)
        spread, seed, cover_rate = (self.values[key] for key in RATES)
        middle = np.log(spread / seed)
        own = shares(count, rate=spread + seed, middle=middle, cover_rate=cover_rate)
        return dict(zip(STATES, (own.filmed, own.filmed * count, own.metal, own.covered), strict=True))

    def coefficient(self, history: Mapping[str, FloatArray], **fit: Any) -> FloatArray:
        """Return μ of every step."""
        return np.asarray(sum(self.values[key] * term for key, term in self.terms(history).items()))

    def __call__(self, *, pressure: Any, distance: Any = 0.0, bare_fraction: Any = 1.0) -> FloatArray:
        """Return the shear stress of cells [MPa], in proportion to their pressures."""
        return np.asarray(self.coefficient({"distance": np.asarray(distance)}) * pressure)


#: Value of `friction.law` -> law.
FRICTION_LAWS = {"shear-strength": FrictionLaw, "coulomb": CoulombLaw, "states": StatesLaw}


def friction_energy(
    distance: FloatArray, cof: FloatArray, load: FloatArray, *, of_steps: bool = False
) -> FloatArray:
    """Integrate the friction force over the distance slid: ∫ μ F dL [J] up to the end of each step.

    distance [mm] and coefficient at the end of each step, load [N] in it, all (n,). Trapezoids between the
    coefficients; in the first step, and in the first under another load, its own holds from the start.
    of_steps: whether coefficients are means over their steps instead.
    """
    if of_steps:
        return 1.0e-3 * np.cumsum(cof * load * np.diff(distance, prepend=0.0))
    before = np.where(np.diff(load, prepend=load[:1]) == 0.0, np.concatenate([cof[:1], cof[:-1]]), cof)
    return 0.5e-3 * np.cumsum((cof + before) * load * np.diff(distance, prepend=0.0))


def fitted_strength(coefficient: float, ploughing: float, *, load: float, area: float) -> float:
    """Return τ0 = (μ0 − μ_p) F / A [MPa] (thesis eq 4.19)."""
    return (coefficient - ploughing) * load / area
