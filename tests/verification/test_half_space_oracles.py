"""The half-space against Hertz, Westergaard, the hardness cut and the worn Gaussian surface."""

import math
from statistics import NormalDist

import numpy as np
import pytest
from cases_half_space import area_fraction_of
from scipy.optimize import brentq

from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.laws.elastic import Hertz
from warpwear.surfaces.made.self_affine import SelfAffine


def counter(grid: Grid, radius: float) -> FloatArray:
    """Sag of a ball over its apex [mm]."""
    squared = np.add.outer(grid.x**2, grid.y**2)
    return np.asarray(squared / (radius + np.sqrt(radius**2 - squared)))


def test_hertz() -> None:
    """The reference test's counter-body, 512² cells over five contact radii."""
    hertz = Hertz(modulus=1.072e5, counter_radius=3.0, load=8.0)
    grid = Grid(512, 512, 5.0 * hertz.radius / 512)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=hertz.modulus, boundary="free")
        contact = solver.solve(executor.field(counter(grid, 3.0)), mean_pressure=hertz.load / grid.area)
        assert contact.approach == pytest.approx(1.0143e-3, rel=1e-2)
        assert contact.approach == pytest.approx(hertz.approach, rel=2e-3)
        assert contact.pressure.max() == pytest.approx(hertz.peak_pressure, rel=1e-2)
        area = contact.cells_in_contact * grid.cell_area
        assert area == pytest.approx(hertz.area, rel=2.0 * grid.cell / hertz.radius)
        # dF/dδ = 2 E* a
        step = 1e-2 * hertz.approach
        gap = executor.field(counter(grid, 3.0))
        low, high = (solver.solve(gap, approach=hertz.approach + s).mean_pressure for s in (-step, step))
        slope = (high - low) * grid.area / (2.0 * step)
        assert slope == pytest.approx(2.0 * hertz.modulus * hertz.radius, rel=1e-2)


@pytest.mark.parametrize("by", ["load", "approach"])
def test_hertz_under_the_conditions_of_a_peer(by: str) -> None:
    """Those of ContactMechanics' test_hertz: R = 20, E* = 102, 5 × 5, load 15 or approach 0.1, 512² cells."""
    load = 15.0 if by == "load" else 4.0 / 3.0 * 102.0 * math.sqrt(20.0) * 0.1**1.5
    hertz = Hertz(modulus=102.0, counter_radius=20.0, load=load)
    grid = Grid(512, 512, 5.0 / 512)
    squared = np.add.outer(grid.x**2, grid.y**2)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=102.0, boundary="free", tolerance=1e-5)
        gap = executor.field(squared / 40.0)
        if by == "load":
            contact = solver.solve(gap, mean_pressure=load / grid.area)
        else:
            contact = solver.solve(gap, approach=0.1)
        assert contact.mean_pressure * grid.area == pytest.approx(load, rel=1e-7 if by == "load" else 1e-2)
        assert contact.approach == pytest.approx(hertz.approach, rel=1e-2)
        area = contact.cells_in_contact * grid.cell_area
        assert area == pytest.approx(hertz.area, rel=2.0 * grid.cell / hertz.radius)
        r = np.sqrt(squared)
        inside = r < 0.99 * hertz.radius
        assert np.abs(contact.pressure - hertz.pressure(r))[inside].max() < 1e-3 * 102.0


@pytest.mark.parametrize(("share", "cells"), [(0.05, 2048), (0.2, 1024), (0.5, 1024), (0.8, 1024)])
def test_westergaard(share: float, cells: int) -> None:
    """A wave in one direction: Johnson, Contact Mechanics (1985), section 13.2.

    The error is that of the cells at the edge, so a narrow contact needs more cells.
    """
    grid = Grid(4, cells, 1.0 / cells)
    amplitude = 1e-3
    full = math.pi * amplitude  # p* = π E* Δ/λ
    gap = np.broadcast_to(amplitude * (1.0 - np.cos(2.0 * math.pi * grid.y)), grid.shape)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1.0)
        contact = solver.solve(executor.field(np.array(gap)), mean_pressure=share * full)
        half = math.asin(math.sqrt(share)) / math.pi  # half width of the contact over λ
        phase = math.pi * grid.y
        inside = np.maximum(math.sin(math.pi * half) ** 2 - np.sin(phase) ** 2, 0.0)
        exact = 2.0 * full * np.cos(phase) * np.sqrt(inside)
        exact *= np.abs(grid.y) < half
        error = np.linalg.norm(contact.pressure - exact) / np.linalg.norm(np.tile(exact, (4, 1)))
        assert error < 1e-3
        assert area_fraction_of(contact) == pytest.approx(2.0 * half, abs=grid.cell)
        if share == 0.2:
            assert area_fraction_of(contact) == pytest.approx(0.2952, abs=grid.cell)


@pytest.mark.parametrize(("hardness", "allowed"), [(1.0, 38), (0.1, 4), (0.01, 0)])
def test_soft_surfaces_are_cut_at_a_height(hardness: float, allowed: int) -> None:
    """With H → 0 the contact is the bearing area, but for the cells that tamaas 2.9.0 leaves on this surface.

    Its `KatoSaturated` (E = 1, ν = 0, tolerance 1e-6) has 38, 4 and 0 cells that differ.
    """
    grid = Grid(128, 128, 1.0 / 128)
    surface = SelfAffine(hurst=0.8, roll_off=0.25, cut_off=1.0 / 16, period=1.0, sq=1.0, seed=2)
    gap = -surface.heights(grid.x, grid.y)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1.0, hardness=hardness)
        contact = solver.solve(executor.field(gap), mean_pressure=0.1 * hardness)
        cut = np.zeros(grid.cells, dtype=bool)
        cut[np.argsort(gap.ravel())[: contact.cells_in_contact]] = True
        assert np.count_nonzero((contact.pressure.ravel() > 0.0) != cut) <= allowed


@pytest.mark.parametrize("hardness", [math.inf, 0.05])
def test_wear_removes_what_the_pressure_says(hardness: float) -> None:
    """Implicit steps of 30 mm: mean removed = K p̄ ΔL, and no scatter of the pressure from step to step."""
    grid = Grid(128, 128, 1.0 / 128)
    surface = SelfAffine(hurst=0.8, roll_off=0.25, cut_off=1.0 / 32, period=1.0, sq=1e-3, seed=3)
    gap = -surface.heights(grid.x, grid.y)
    mean_pressure, worn_a_step = 1e-3, 1e-3  # a whole rms height in a step
    compliance = worn_a_step / mean_pressure
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1.0, hardness=hardness)
        areas = []
        for _ in range(6):
            contact = solver.solve(executor.field(gap), mean_pressure=mean_pressure, compliance=compliance)
            removed = compliance * contact.pressure
            assert removed.mean() == pytest.approx(worn_a_step, rel=1e-12)
            gap = gap + removed
            areas.append(area_fraction_of(contact))
    assert areas == sorted(areas)
    assert areas[-1] == 1.0
    assert contact.pressure.std() < 1e-2 * mean_pressure


def test_gaussian_surface_worn_by_a_stiff_plane() -> None:
    """Truncation to the volume removed, v = σ(φ(c) − c Q(c)), leaves A/A0 = Q(c)."""
    grid = Grid(256, 256, 1.0 / 256)
    surface = SelfAffine(hurst=0.8, roll_off=0.1, cut_off=0.04, period=1.0, sq=1e-3, seed=3)
    gap = -surface.heights(grid.x, grid.y)
    normal = NormalDist()
    mean_pressure = 1e-5  # of E*, far below E* times the slope
    worn = 0.0
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1.0, hardness=0.05)
        for target in (0.139, 0.384, 1.06):
            compliance = 1e-3 * (target - worn) / 4 / mean_pressure
            for _ in range(4):
                contact = solver.solve(
                    executor.field(gap), mean_pressure=mean_pressure, compliance=compliance
                )
                gap = gap + compliance * contact.pressure
            worn = target
            depth = brentq(lambda c, v=target: normal.pdf(c) - c * normal.cdf(-c) - v, -4.0, 4.0)
            assert area_fraction_of(contact) == pytest.approx(normal.cdf(-depth), rel=0.1)
