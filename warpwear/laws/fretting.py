"""Fretting: what a cycle of partial or gross slip is, by Cattaneo, Mindlin, Ciavarella and Jäger.

In a contact of alike bodies that is sheared by Q < μP, a part sticks: it is the contact under P* = P − Q/μ.
The bodies are displaced by δ = κμ (d − d*), with the approaches d and d* of both, and a place whose gap is g*
in the contact under P* slips 4κμ g* in a cycle. So one more contact tells stick, slip, displacement and
energy, on any shape (Ciavarella 1998, Int. J. Solids Struct. 35, 2349; Jäger 1998, Arch. Appl. Mech. 68, 61).
It is exact in line contacts and where Poisson's ratio is 0; of a ball Mindlin neglects the same.
"""

from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.laws.archard import Scales
from warpwear.laws.elastic import Hertz, effective_modulus

optimize = lazy.module("scipy.optimize")

#: Slip ring over the radius of the contact up to which it counts as sticking.
RING = 0.05
#: Stroke over the width of the contact up to which a pressure of all places is honest: depths are 3 % off.
HONEST_MEAN = 0.15


def softness_ratio(*bodies: tuple[float, float], line: bool = False) -> float:
    """Return κ, a contact's tangential over its normal compliance: (2 − ν)/(2 − 2ν) of alike bodies.

    bodies: Young's modulus [MPa] and Poisson's ratio of both. line: of a line contact it is 1.
    """
    if line:
        return 1.0
    softness = sum(2.0 * (1.0 + poisson) * (2.0 - poisson) / young for young, poisson in bodies)
    return 0.25 * softness * effective_modulus(*bodies)


@dataclass(frozen=True)
class Fretting(Scales):
    """Holds what drives a fretting contact; models read nothing else of it."""

    friction: float  # μ of Coulomb's law
    kappa: float  # κ
    stroke: float  # of the slip or the drive, peak to peak; of a force that of the unworn bodies, about [mm]
    force: float | None = None  # amplitude Q that drives instead [N]
    of_body: bool = False  # whether the stroke is that of the bodies: slip is what yielding leaves of it
    rig: float = 0.0  # compliance of the rig, whose drive has the stroke then [mm/N]
    has_displacement: bool = True  # whether bodies are displaced by a number: those of a line are not

    @property
    def cycle(self) -> float:
        """Return the distance that a cycle counts for: twice the stroke [mm]."""
        return 2.0 * self.stroke

    @property
    def slip_of_gap(self) -> float:
        """Return the slip of a cycle over the gap under P*: 4κμ."""
        return 4.0 * self.kappa * self.friction


def displacement(hertz: Hertz, kappa: float, friction: float, ratio: float = 1.0) -> float:
    """Return the amplitude of displacement [mm] that a force of `ratio` times μP gives unworn bodies.

    At 1 all of the contact begins to slip. Of a ball it is Mindlin's 3μP Σ(2 − ν)/G/16a [1 − (1 − Q/μP)^⅔];
    of a line, which has none, the same κμ (a² − c²)/R.
    """
    power = 1.0 if hertz.is_line else 2.0 / 3.0
    radius = hertz.radius_across or hertz.counter_radius
    mean = min(radius, hertz.counter_radius) if hertz.is_line else (radius * hertz.counter_radius) ** 0.5
    return kappa * friction * hertz.radius**2 / mean * (1.0 - (1.0 - min(ratio, 1.0)) ** power)


def energy_ratio(power: float, ratio: float = 1.0, slide: float = 0.0) -> float:
    """Return the energy of a cycle over 4QΔ of a body that yields by δ ∝ 1 − (1 − Q/μP)^power.

    ratio: of the amplitude Q to μP. slide: gross slip over the displacement at which it begins. Unloading
    follows the first loading at half the rate (Masing). The power is ⅔ under an unworn ball, whose gross slip
    begins at 1/5.
    """
    rest = 1.0 - ratio
    area = ratio - (1.0 - rest ** (power + 1.0)) / (power + 1.0)
    own = 1.0 - 2.0 * area / (ratio * (1.0 - rest**power))
    return float((own + slide) / (1.0 + slide))


def power_of(energy: float, ratio: float = 1.0, slide: float = 0.0) -> float:
    """Return the power for which `energy_ratio` is that of a cycle, 0.05 or more; 1 if linear."""

    def excess(power: float) -> float:
        return energy_ratio(power, ratio, slide) - energy

    if excess(1.0) >= 0.0:
        return 1.0
    return 0.05 if excess(0.05) <= 0.0 else float(optimize.brentq(excess, 0.05, 1.0))


def loop(
    force: float, displacement: float, border: float, energy: float, *, limit: float
) -> tuple[FloatArray, FloatArray]:
    """Return a loop of tangential force [N] and displacement [mm], closed, by the numbers of its cycle.

    force, displacement: amplitudes [N, mm]; border: displacement from which on all slips [mm]; energy: of the
    cycle over 4QΔ; limit: μP [N]. Between its tips it is the power law that has the energy: Mindlin's under
    an unworn ball, a straight line where yielding dissipates nothing.
    """
    ratio, slide = min(force / limit, 1.0), max(displacement / border - 1.0, 0.0)
    power, elastic = power_of(energy, ratio, slide), min(displacement, border)
    t = np.linspace(ratio, -ratio, 101)
    # Unloading yields twice what half the force does first.
    first = (1.0 - (1.0 - 0.5 * (ratio - t)) ** power) / (1.0 - (1.0 - ratio) ** power)
    back = displacement - 2.0 * elastic * first
    forces, places = np.append(t, -ratio) * limit, np.append(back, -displacement)
    return np.concatenate([forces, -forces, forces[:1]]), np.concatenate([places, -places, places[:1]])


def regime_of(stick: FloatArray, contact: FloatArray) -> str:
    """Name the regime of a course: "stick", "partial", "gross", or "mixed" of gross slip and others.

    stick, contact: areas that do not slip and that are in contact [mm²], of each cycle seen.
    """
    slips_all = stick == 0.0
    if slips_all.any():
        return "gross" if slips_all.all() else "mixed"
    return "stick" if (stick > (1.0 - RING) ** 2 * contact).all() else "partial"
