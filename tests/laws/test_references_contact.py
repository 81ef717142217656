"""Area against load by theories of rough contact, by quadrature and beside the half-space."""

import math

import numpy as np
import pytest
from cases_half_space import area_fraction_of
from scipy.integrate import quad

from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.laws.elastic import SpectralMoments, greenwood_williamson_area, persson_area
from warpwear.surfaces.made.self_affine import SelfAffine


def test_moments_of_a_wave() -> None:
    """Mean squares of height and gradient are exact for a single wave; a profile's are a share of them."""
    cell, n = 0.01, 64
    q = 2.0 * math.pi * 3.0 / (n * cell)
    heights = np.tile(0.2 * np.cos(q * cell * np.arange(n))[:, np.newaxis], (1, n))
    moments = SpectralMoments.of(heights, cell)
    assert moments.m0 == pytest.approx(0.02)
    assert moments.rms_slope == pytest.approx(0.2 * q / math.sqrt(2.0))
    assert moments.m4 == pytest.approx(0.375 * 0.02 * q**4)


def test_persson() -> None:
    area = persson_area(np.array([0.0, 1e-4, 50.0]), modulus=100.0, rms_slope=0.1)
    assert area[0] == 0.0
    assert area[1] == pytest.approx(math.sqrt(8.0 / math.pi) * 1e-4 / 10.0, rel=1e-6)
    assert area[2] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("separation", [-1.0, 0.5, 3.0])
def test_greenwood_williamson_is_its_integrals(separation: float) -> None:
    moments = SpectralMoments(1e-6, 0.005, 2000.0)
    alpha = 1e-6 * 2000.0 / 0.005**2
    density, radius = 2000.0 / (6.0 * math.pi * math.sqrt(3.0) * 0.005), 0.375 * math.sqrt(math.pi / 2000.0)
    scatter = math.sqrt((1.0 - 0.8968 / alpha) * 1e-6)

    def summits(power: float) -> float:
        def over(s: float) -> float:
            weight = math.exp(-0.5 * s**2) / math.sqrt(2.0 * math.pi)
            return float((scatter * (s - separation)) ** power * weight)

        return float(quad(over, separation, separation + 20.0, epsabs=0.0, epsrel=1e-11)[0])

    pressure = 4.0 / 3.0 * 70.0 * density * math.sqrt(radius) * summits(1.5)
    area = math.pi * density * radius * summits(1.0)
    found = greenwood_williamson_area(np.array([0.0, pressure, 1e9]), modulus=70.0, moments=moments)
    assert found[0] == 0.0
    assert found[1] == pytest.approx(area, rel=1e-7)
    assert math.isnan(found[2])


def test_the_half_space_lies_between_persson_and_independent_summits() -> None:
    """At light load A E* h'/(A0 p̄) is some 2: 1.6 by Persson, 2.5 by summits that ignore each other."""
    grid = Grid(256, 256, 1.0 / 256)
    surface = SelfAffine(hurst=0.8, roll_off=0.2, cut_off=1.0 / 24, period=1.0, sq=1e-3, seed=1)
    heights = surface.heights(grid.x, grid.y)
    moments = SpectralMoments.of(heights, grid.cell)
    assert moments.rms_slope == pytest.approx(surface.rms_slope, rel=1e-9)
    pressure = 0.05 * moments.rms_slope
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1.0)
        area = area_fraction_of(solver.solve(executor.field(-heights), mean_pressure=pressure))
    low = persson_area(np.array(pressure), modulus=1.0, rms_slope=moments.rms_slope)
    assert float(low) < area < math.sqrt(2.0 * math.pi) * 0.05
