"""Contact junctions have a critical size: smaller islands smooth out, larger ones can lose particles."""

import math

import numpy as np

from warpwear.grid import FloatArray


def critical_junction(
    *, surface_energy: float, shear_modulus: float, poisson: float, strength: float
) -> float:
    """Return the diameter d* = 12π γ G / ((2 − ν) σ_j²) [mm] (thesis eq 2.3).

    surface_energy: γ of one new surface [N/mm]; 1 J/m² is 1e-3 N/mm.
    shear_modulus: G of the body that particles come from [MPa]. poisson: its ν.
    strength: σ_j, the shear stress that the junction bears [MPa]; see `junction_strength`.

    An adhesive junction that slides stores elastic energy up to the shear stress σ_j. A circle of diameter d
    under an even σ_j stores (2 − ν) σ_j² d³ / (12 G) in one half-space; a hemisphere below it has two new
    surfaces, π d² γ. At d* both are equal: a smaller junction cannot pay for a crack and is smoothed
    plastically, a larger one can detach a particle of about its own size. d* tells which of the two can
    happen, not how often. γ is the energy of brittle separation; plastic work at the crack's tip makes d*
    larger.

    Sources: Aghababaei, Warner, Molinari, Nature Communications 7 (2016) 11816, for the length scale,
    γ G / σ_j² times a factor of shape; for the comparison of energies Pham-Ba, Brink, Molinari (arXiv
    1907.08183, 2019) and Pham-Ba, Molinari (Tribology Letters, 2021, doi 10.1007/s11249-021-01471-5).
    """
    return 12.0 * math.pi * surface_energy * shear_modulus / ((2.0 - poisson) * strength**2)


def junction_strength(hardness: float) -> float:
    """Return σ_j = H / (3√3) [MPa] of a junction as strong as the softer body. hardness: its H [MPa].

    Yield stress H/3 (Tabor, The Hardness of Metals, 1951), in shear by von Mises' criterion. Dirt, oxide and
    lubricant make junctions weaker, and d* larger.
    """
    return hardness / (3.0 * math.sqrt(3.0))


def share_above(areas: FloatArray, diameter: float) -> float:
    """Return the part of the islands' area in islands larger than a circle; NaN without islands.

    areas: (islands,) [mm²]. diameter: [mm]. Frérot, Aghababaei and Molinari (J. Mech. Phys. Solids 114,
    2018, 172) take it, of d*, for the wear coefficient of full adhesion.
    """
    return float(areas[diameters_of(areas) > diameter].sum() / areas.sum()) if areas.size else math.nan


def diameters_of(areas: FloatArray) -> FloatArray:
    """Return the diameters [mm] of circles of these areas [mm²], any shape."""
    return np.asarray(2.0 * np.sqrt(areas / np.pi))
