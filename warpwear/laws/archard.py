"""Wear laws: how much of each body a pressure removes between two sliding distances.

A law is a class here, whose numbers are its fields, and a name among the values of `wear.law`. All that needs
a law calls it, with plain numbers or with arrays of them.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self, TypeVar

import numpy as np

from warpwear.grid import FloatArray, Grid

#: Both bodies, in the order in which they are numbered, and what sentences call them.
BODIES = ("counter", "disc")
CALLED = {"counter": "counter-body", "disc": "disc"}
#: Pressures at most between which K is linear, as native/law.h has room for.
MOST_KNOTS = 16
Number = TypeVar("Number", float, FloatArray)


class Scales:
    """Says of a law whether a contact's area and scar follow from the sum of both wears alone."""

    @property
    def scales(self) -> bool:
        """Tell whether they do, so that one run serves all wear: if the class itself has `SCALES = True`."""
        return bool(vars(type(self)).get("SCALES"))  # not inherited: what a law adds to another may not scale


@dataclass(frozen=True)
class WearLaw(Scales):
    """Archard's law V = K F L has one K of a body [mm²/N] at all distances.

    `Study.wear_laws` has those of both bodies; called with pressures and distances, a law gives K there. Runs
    integrate it over a step: volumes do not depend on the step's size.

    Attributes
    ----------
    steady : float
        K in the long run, where nothing presses [mm²/N]; as other numbers of laws also an array that
        broadcasts with the distances.

    Examples
    --------
    >>> keys = {"law": "running-in", "initial_disc": "3e-3 mm^3/N/m", "running_in": "40 mm"}
    >>> counter, disc = warpwear.Study.load("v3-fine").replace(wear=keys).wear_laws
    >>> (1e3 * disc(distance=np.array([0.0, 40.0, 4000.0]))).round(5).tolist()  # mm³/(N·m)
    [0.003, 0.00191, 0.00127]
    """

    SCALES: ClassVar[bool] = True
    name: ClassVar[str] = "archard"
    #: Number -> key of [wear]; with {body}, the counter-body and the disc have a K of their own.
    keys: ClassVar[dict[str, str]] = {"steady": "{body}"}
    #: K over the distance L, in LaTeX.
    formula: ClassVar[str] = "K"
    #: What a paper says of the law, with {key} for the values of keys; empty where K is constant.
    sentence: ClassVar[str] = ""

    steady: float

    @classmethod
    def of(cls, body: str, number: Callable[[str], Any]) -> Self:
        """Return the law of a body. number: gives the number of a key of [wear], K in mm²/N."""
        return cls(**{name: number(key.format(body=body)) for name, key in cls.keys.items()})

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Return every K of the body [mm²/N]."""
        return tuple(getattr(self, name) for name, key in self.keys.items() if "{body}" in key)

    @property
    def over_pressure(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return pressures of a cell [MPa] from low to high, and K at them; nothing where none changes K.

        K is linear between them and constant beyond. Programs take it over `steady`, K where nothing presses.
        """
        return (), ()

    @property
    def fastest(self) -> float:
        """Return the largest K at any distance and pressure [mm²/N]."""
        return max(self.over_pressure[1] or self.coefficients)

    def rates(self, most: float = math.inf) -> FloatArray:
        """Return d(p K)/dp [mm²/N] at the ends of the pieces of K, up to a pressure [MPa].

        It lies between them elsewhere. The largest limits explicit steps; implicit ones need all above 0.
        """
        pressures, values = (np.array(column) for column in self.over_pressure)
        if not pressures.size:
            return np.array([self.fastest])
        ends = np.minimum(pressures, most)
        bends = np.diff(values) / np.diff(pressures) * (pressures[:-1] < most)
        at_ends = np.interp(ends, pressures, values)
        return np.concatenate([at_ends, at_ends[:-1] + ends[:-1] * bends, at_ends[1:] + ends[1:] * bends])

    def in_proportion_to(self, other: "WearLaw") -> bool:
        """Tell whether this K and the `other` are in one proportion at every distance."""
        if self.fastest == 0.0 or other.fastest == 0.0:
            return True
        shared = [name for name, key in self.keys.items() if "{body}" not in key]
        if type(self) is not type(other) or any(getattr(self, n) != getattr(other, n) for n in shared):
            return False
        pairs = zip(self.coefficients, other.coefficients, strict=True)
        return all(k * other.steady == of_other * self.steady for k, of_other in pairs)

    @property
    def terms(self) -> tuple[tuple[float, float | None], ...]:
        """Return what K is the sum of [mm²/N], each with the length of its decay [mm] or None."""
        return ((self.steady, None),)

    def __call__(self, *, pressure: Any = 0.0, distance: Any = 0.0) -> FloatArray:
        """Return K of a cell [mm²/N], the depth that it wears over its pressure and a short way.

        Parameters
        ----------
        pressure : float or array
            Of the cell [MPa]; above 0 where wear does not go by the pressure alone.
        distance : float or array
            Slid before [mm]; broadcasts with the pressure.

        Returns
        -------
        array
            K at each; 1 mm²/N is 1000 mm³/(N·m).
        """
        pressure, distance = np.broadcast_arrays(pressure, distance)
        if self.over_pressure[0]:
            return np.interp(pressure, *self.over_pressure)
        return np.asarray(self._sum(lambda n: np.ones_like(distance) if n is None else np.exp(-distance / n)))

    def wear_per_pressure(self, start: float, increment: Number) -> Number:
        """Return ∫ K dL, the depth that a unit of pressure wears [mm³/N].

        start: distance slid before [mm]. increment: slid while the pressure acts [mm].
        """
        return self._sum(lambda n: increment if n is None else decay_integral(start, increment, n))

    def _sum(self, way: Callable[[float | None], Any]) -> Any:
        """Sum up the terms of K, each times what a function makes of its length."""
        return sum(k * way(length) for k, length in self.terms)

    def wear_per_contact(self, start: float, increment: float) -> float:
        """Return the depth that an increment wears off a cell in contact, whatever its pressure [mm]."""
        return 0.0

    @property
    def wears(self) -> bool:
        """Tell whether the body loses anything."""
        return self.fastest > 0.0 or self.wear_per_contact(0.0, 1.0) > 0.0


@dataclass(frozen=True)
class ExponentialLaw(WearLaw):
    """K falls as e^(−αL), an empirical fit: V = K F (1 − e^(−αL))/α (thesis eq 2.4)."""

    SCALES = True
    name = "exponential"
    keys = WearLaw.keys | {"decay": "decay"}
    formula = r"K e^{-\alpha L}"
    sentence = "K e^(−αL) over the distance L, with α = {decay:.4g} 1/mm"

    decay: float  # α [1/mm]

    @property
    def terms(self) -> tuple[tuple[float, float | None], ...]:
        """Return the one term of K; see `WearLaw`."""
        return ((self.steady, 1.0 / self.decay),)


@dataclass(frozen=True)
class RunningInLaw(WearLaw):
    """K + (K0 − K) e^(−L/L0) begins at another K and runs in, an empirical fit."""

    SCALES = True
    name = "running-in"
    keys = WearLaw.keys | {"running_in": "running_in", "initial": "initial_{body}"}
    formula = "K + (K_0 - K) e^{-L/L_0}"
    sentence = (
        "K + (K0 − K) e^(−L/L0) over the distance L, with L0 = {running_in:.4g} mm and K0 = "
        "{initial_counter:.3g} and {initial_disc:.3g} mm³/(N·m)"
    )

    running_in: float  # L0 [mm]
    initial: float | None = None  # K0 [mm²/N]; None: K

    def __post_init__(self) -> None:
        if self.initial is None:
            object.__setattr__(self, "initial", self.steady)

    @property
    def terms(self) -> tuple[tuple[float, float | None], ...]:
        """Return K in the long run, and what it is more before; see `WearLaw`."""
        assert self.initial is not None
        return (self.steady, None), (self.initial - self.steady, self.running_in)


@dataclass(frozen=True)
class BearingCurveLaw(WearLaw):
    """Archard's K wears a macro contact, in which a share of each cell bears."""

    name = "bearing-curve"
    sentence = "constant, in the share of each cell that bears by the disc's bearing area curve"


@dataclass(frozen=True)
class EnergyLaw(WearLaw):
    """Wear is in proportion to the energy that friction dissipates: V = α ∫ τ ds.

    What of τ goes with the pressure, μ p, makes K = α μ; a shear strength τ0 wears a cell in contact by a
    depth of α τ a distance, whatever its pressure; τ may run in from another one.
    """

    SCALES = True
    name = "energy"
    formula = r"\alpha_\mathrm{E} \mu"
    sentence = "worn volume in proportion to the energy that friction dissipates"

    shear: float = 0.0  # α τ0, a depth over a distance
    ratio: float = 1.0  # of τ at the start to τ0
    running_in: float = 1.0  # L_τ [mm]

    @property
    def scales(self) -> bool:
        """Tell whether all of τ goes with the pressure; see `Scales`."""
        return super().scales and self.shear == 0.0

    def __call__(self, *, pressure: Any = 0.0, distance: Any = 0.0) -> FloatArray:
        """Return α τ/p [mm²/N]; see `WearLaw`."""
        by_pressure = super().__call__(pressure=pressure, distance=distance)
        part = 1.0 + (self.ratio - 1.0) * np.exp(-np.asarray(distance) / self.running_in)
        return by_pressure + (self.shear * part / pressure if self.shear else 0.0)

    def wear_per_contact(self, start: float, increment: float) -> float:
        """Return ∫ α τ dL [mm]; see `WearLaw`."""
        more = (self.ratio - 1.0) * decay_integral(start, increment, self.running_in)
        return self.shear * (increment + more)


@dataclass(frozen=True)
class TransitionLaw(WearLaw):
    """K passes from mild wear to severe with the pressure of a cell, linearly over a width."""

    name = "transition"
    keys = WearLaw.keys | {
        "severe": "severe_{body}",
        "middle": "transition_pressure",
        "width": "transition_width",
    }
    formula = "K(p)"
    sentence = (
        "K of mild wear, which passes linearly to {severe_counter:.3g} and {severe_disc:.3g} mm³/(N·m) of "
        "severe wear over {transition_width:.4g} MPa about a pressure of the cell of "
        "{transition_pressure:.4g} MPa"
    )

    severe: float  # K above the transition [mm²/N]
    middle: float  # pressure in the middle of it [MPa]
    width: float  # from its beginning to its end [MPa]

    @property
    def over_pressure(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the ends of the transition; see `WearLaw`."""
        half = 0.5 * self.width
        return (self.middle - half, self.middle + half), (self.steady, self.severe)


#: Value of `wear.law` -> law.
WEAR_LAWS: dict[str, type[WearLaw]] = {
    law.name: law
    for law in (WearLaw, ExponentialLaw, RunningInLaw, BearingCurveLaw, EnergyLaw, TransitionLaw)
}
#: Keys of [wear] that are numbers of a law, and those of them that are a K.
KEYS = {key.format(body=body) for law in WEAR_LAWS.values() for key in law.keys.values() for body in BODIES}
COEFFICIENTS = {key for key in KEYS if key.endswith(BODIES)}


def said(laws: tuple[WearLaw, WearLaw]) -> str:
    """Say in half a sentence what is not constant about the laws of counter-body and disc; K in mm³/(N·m)."""
    numbers = {
        key.format(body=body): getattr(law, name) * (1.0e3 if "{body}" in key else 1.0)
        for body, law in zip(BODIES, laws, strict=True)
        for name, key in law.keys.items()
    }
    return laws[0].sentence.format(**numbers)


def knots_of(laws: tuple[WearLaw, WearLaw]) -> FloatArray:
    """Return rows of a pressure [MPa], and K of counter-body and disc at it over `steady`, from 0 up.

    K is linear between rows, and constant beyond the last; there is none where no pressure changes it. A body
    that does not wear has the other's.
    """
    wearing = [law for law in laws if law.wears]
    tables = [law.over_pressure for law in (wearing if len(wearing) == len(laws) else 2 * wearing)]
    pressures = sorted({0.0}.union(*(at for at, _ in tables)))
    if len(pressures) == 1:
        return np.zeros((0, 3))
    return np.column_stack([pressures, *(np.interp(pressures, at, k) / k[0] for at, k in tables)])


def wear_in_steps(laws: tuple[WearLaw, WearLaw], start: float, increments: Sequence[float]) -> FloatArray:
    """Return what a unit of pressure wears off counter-body and disc in each of the increments [mm³/N].

    laws: of counter and disc. start: distance slid before the first of the increments [mm], which follow each
    other. Shape (steps, 2).
    """

    def way(length: float | None) -> FloatArray:
        if length is None:
            return np.array(increments)
        starts = itertools.accumulate(increments, initial=start)  # one by one: NumPy's exp is not that of C
        return np.array([decay_integral(*step, length) for step in zip(starts, increments, strict=False)])

    return np.stack([law._sum(way) for law in laws], axis=1)


def decay_integral(start: Any, increment: Number, length: Any) -> Number:
    """Return ∫ e^(−L/length) dL from start over an increment [mm], exact for small ones too."""
    # NumPy's own exp may differ in the last digit from one processor to the next: runs take that of C.
    arrays = any(isinstance(value, np.ndarray) for value in (start, increment, length))
    functions: Any = np if arrays else math
    return -length * functions.exp(-start / length) * functions.expm1(-increment / length)


def distance_factor(grid: Grid, kind: Literal["none", "across", "radial"], *, curvature: float) -> FloatArray:
    """Return how far disc cells slide relative to the middle one: cos θ with sin θ = d/R.

    Thesis eqs 4.21 and 4.22, used relative to the value at the centre. d is the distance from the middle
    across the sliding direction (as its figure 4.30b shows) or radially (as its text says). It is the chord
    of the ball, not of the contact: a published option, not geometry.

    grid: of nx × ny cells. kind: "none", "across" or "radial". curvature: 1/R of the counter-body [1/mm].
    The factors have no unit and the shape (1, 1), (1, ny) or (nx, ny), by kind.
    """
    if kind == "none":
        return np.ones((1, 1))
    d2 = grid.y[None, :] ** 2
    if kind == "radial":
        d2 = d2 + grid.x[:, None] ** 2
    return np.sqrt(np.maximum(0.0, 1.0 - d2 * curvature**2))
