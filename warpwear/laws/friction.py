"""Coefficient of friction from an area: shear of junctions, with an offset for ploughing.

μ = μ_p + τ A / F (thesis eqs 4.18 to 4.20; the offset after eq 2.8). Which area A shears, and when a
measured coefficient fixes τ, are choices of the study. τ is constant, or runs in by an empirical fit:
τ0 (1 + (r − 1) e^(−L/L_τ)). With a film τ is the mean over the cells in contact, of which a fraction is
bare.
"""

import math
from collections.abc import Mapping
from typing import Literal, Protocol

import numpy as np

from warpwear.grid import FloatArray

WHEN: tuple[Literal["initial"], Literal["end"]] = ("initial", "end")


class FilmLaw(Protocol):
    """The numbers of a film that friction follows from; the section [friction.film] has them."""

    @property
    def shear_strength(self) -> float:
        """τ of a cell with its film [MPa]."""


class FrictionLaw(Protocol):
    """The numbers that friction follows from; the section [friction] of a study has them."""

    shear_strength: float | None  # τ0 [MPa]; None where `coefficient` fixes it
    coefficient: float  # the measured one that fixes τ0
    calibrate: Literal["end", "initial"]  # when that coefficient holds
    ploughing: float  # the part μ_p of the coefficient that does not shear
    initial_ratio: float | None  # τ at the start over τ0, where it runs in
    running_in: float | None  # the length L_τ of that [mm]
    area: Literal["contact", "touched", "cumulative", "nominal"]  # which area shears

    @property
    def film(self) -> FilmLaw | None:
        """The film that wear breaks, None without one; τ0 is then the shear strength of bare cells."""


def shear_strength(
    friction: FrictionLaw,
    history: Mapping[str, FloatArray],
    *,
    load: float,
    finished: bool,
    lap: float | None = None,
) -> FloatArray:
    """τ [MPa] of every step: as given, or from (μ0 − μ_p) F / A0 at the end or the start (eq 4.19).

    lap: what is slid in a pass over a track [mm]: A0 is then the mean over the last or the first one, as the
    area changes with the place. NaN while a τ that is calibrated at the end waits for it.
    """
    final = final_strength(friction, history, load=load, finished=finished, lap=lap)
    if friction.film is not None:
        filmed = friction.film.shear_strength
        return np.asarray(filmed + (final - filmed) * history["bare_fraction"])
    return final * _running_in(friction, history["distance"])


def final_strength(
    friction: FrictionLaw,
    history: Mapping[str, FloatArray],
    *,
    load: float,
    finished: bool,
    lap: float | None = None,
) -> float:
    """τ0 [MPa] that τ ends or runs in to, as given or calibrated; NaN while it waits for the end."""
    if friction.shear_strength is not None:
        return friction.shear_strength
    if friction.calibrate == "end" and not finished:
        return math.nan
    areas = history[f"area_{friction.area}"] * _running_in(friction, history["distance"])
    return (
        (friction.coefficient - friction.ploughing)
        * load
        / mean_over(history, areas, friction.calibrate, lap)
    )


def mean_over(
    history: Mapping[str, FloatArray], values: FloatArray, when: Literal["initial", "end"], lap: float | None
) -> float:
    """Mean of a column over the first or the last lap [mm] slid; its first or last value without a lap."""
    inside = within(history, when, lap)
    if np.count_nonzero(inside) == 1:
        return float(values[inside][0])
    return float(np.average(values[inside], weights=history["increment"][inside]))


def within(
    history: Mapping[str, FloatArray], when: Literal["initial", "end"], lap: float | None
) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """The steps of the first or the last lap [mm] slid; the first or the last step without a lap."""
    distance = history["distance"]
    if lap is None or distance[-1] == 0.0:
        inside = np.zeros(distance.size, dtype=bool)
        inside[-1 if when == "end" else 0] = True
        return inside
    middle = distance - 0.5 * history["increment"]
    return middle > distance[-1] - lap if when == "end" else middle < lap


def coefficient(
    friction: FrictionLaw,
    history: Mapping[str, FloatArray],
    *,
    load: float,
    finished: bool,
    lap: float | None = None,
) -> FloatArray:
    """Coefficient of friction of every step; NaN while τ waits for the end. lap: as in `shear_strength`."""
    tau = shear_strength(friction, history, load=load, finished=finished, lap=lap)
    return np.asarray(friction.ploughing + tau * history[f"area_{friction.area}"] / load)


def _running_in(friction: FrictionLaw, distance: FloatArray) -> FloatArray:
    """τ/τ0 at sliding distances [mm]."""
    if friction.initial_ratio is None or friction.running_in is None:
        return np.ones_like(distance)
    return np.asarray(1.0 + (friction.initial_ratio - 1.0) * np.exp(-distance / friction.running_in))


def calibrations(
    friction: FrictionLaw,
    history: Mapping[str, FloatArray],
    *,
    load: float,
    hardness: float,
    lap: float | None = None,
) -> dict[str, float]:
    """τ0 [MPa] that each area would ask for at `friction.coefficient`, at the start and at the end.

    What "the" shear strength is depends on the area that it was calibrated with; H/(3√3) is the usual
    estimate from hardness.
    """
    found: dict[str, float] = {}
    if friction.coefficient <= friction.ploughing:  # nothing is left to shear
        return found
    for name in ("contact", "touched", "cumulative", "nominal"):
        areas = history[f"area_{name}"]
        for when in WHEN:
            area = mean_over(history, areas, when, lap)
            found[f"{name}_{when}"] = (friction.coefficient - friction.ploughing) * load / area
    if math.isfinite(hardness):
        found["hardness"] = hardness / (3.0 * math.sqrt(3.0))
    return found
