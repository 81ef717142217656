"""Roughness without its form: waves of known height, slope and wavelength on a bowl."""

import math

import numpy as np
import pytest

from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.worn.scar import ellipse, fine_spectrum, texture

CELL = 1.0e-3
HEIGHT, WAVE = 0.5e-3, 20.0e-3  # amplitude and wavelength [mm]


def places(n: int = 400, m: int = 300) -> tuple[np.ndarray, np.ndarray]:
    x, y = (CELL * (np.arange(count) - 0.5 * (count - 1)) for count in (n, m))
    return np.meshgrid(x, y, indexing="ij")


def bowl(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A ball's cap that has worn flatter along than across, tilted, 20 µm high."""
    return np.asarray((x**2 + 0.7 * y**2) / 6.0 + 3.0 * x**4 - 2.0 * x * y**3 + 0.01 * x + 0.4)


@pytest.mark.parametrize("axis", [0, 1])
def test_sq_and_slope_of_a_wave_on_a_bowl(axis: int) -> None:
    """A wave a sin(kx) has Sq a/√2 and Sdq ak/√2; differences over a cell see sin(kh/2)/(kh/2) of it."""
    x, y = places()
    k = 2.0 * math.pi / WAVE
    wave = HEIGHT * np.sin(k * (x, y)[axis])
    found = texture(wave + bowl(x, y), cell=CELL)
    assert found.sq == pytest.approx(HEIGHT / math.sqrt(2.0), rel=0.01)
    blind = math.sin(0.5 * k * CELL) / (0.5 * k * CELL)
    assert found.sdq == pytest.approx(blind * HEIGHT * k / math.sqrt(2.0), rel=0.01)
    # Ridges along sliding are no roughness of profiles along it.
    assert found.rq == pytest.approx(HEIGHT / math.sqrt(2.0) if axis == 0 else 0.0, rel=0.01, abs=1e-9)


def test_a_form_alone_has_no_roughness() -> None:
    found = texture(bowl(*places()), cell=CELL)
    assert max(found.sq, found.sdq, found.rq) < 1e-12


def test_cells_outside_the_ellipse_and_missing_ones_do_not_count() -> None:
    x, y = places()
    heights = HEIGHT * np.sin(2.0 * math.pi * x / WAVE) + bowl(x, y)
    known = texture(heights, cell=CELL)
    heights[~ellipse((400, 300))] += 1.0
    assert texture(heights, cell=CELL).sq == pytest.approx(known.sq, rel=1e-12)
    heights[200, 150] = np.nan
    assert texture(heights, cell=CELL).sq == pytest.approx(known.sq, rel=1e-3)
    assert fine_spectrum(heights, cell=CELL) is None


def test_a_handful_of_cells_tells_nothing() -> None:
    found = texture(np.random.default_rng(1).normal(size=(9, 9)), cell=CELL)
    assert all(math.isnan(value) for value in (found.sq, found.sdq, found.rq))
    assert fine_spectrum(np.zeros((9, 9)), cell=CELL) is None


def test_an_ellipse_has_its_area() -> None:
    assert ellipse((400, 300)).mean() == pytest.approx(math.pi / 4.0, rel=1e-3)
    assert ellipse((400, 300), size=0.5).mean() == pytest.approx(math.pi / 16.0, rel=1e-3)


def test_the_spectrum_peaks_at_the_wave_and_holds_its_power() -> None:
    x, y = places(400, 400)
    heights = HEIGHT * np.sin(2.0 * math.pi * x / WAVE) + bowl(x, y)
    found = fine_spectrum(heights, cell=CELL)
    assert found is not None
    assert found.wavelength[np.argmax(found.density * found.modes)] == pytest.approx(WAVE, rel=0.1)
    # ∫ C d²q/(2π)² over the modes of the field
    power = float((found.density * found.modes).sum()) / (0.4 * 0.4)
    assert power == pytest.approx(0.5 * HEIGHT**2, rel=0.02)


def test_a_form_may_be_fitted_to_every_third_cell() -> None:
    """It is the same where heights are a form, and nearly the same where they are rough."""
    x, y = places()
    assert np.abs(without_polynomial(bowl(x, y), degree=4, every=3)).max() < 1e-12
    rough = bowl(x, y) + HEIGHT * np.random.default_rng(1).normal(size=x.shape)
    both = [without_polynomial(rough, degree=4, every=every).std() for every in (1, 3)]
    assert both[1] == pytest.approx(both[0], rel=2e-3)
