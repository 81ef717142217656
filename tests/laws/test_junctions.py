"""Critical size of a junction against its two energies, and the figure of islands beside it."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe

import warpwear
from warpwear import Result, Study
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.snapshots import junctions
from warpwear.figures.paint import paint
from warpwear.laws.junctions import critical_junction, diameters_of, junction_strength, share_above

STEEL: dict[str, float] = {
    "surface_energy": 1e-3,
    "shear_modulus": 74806.0,
    "poisson": 0.29,
    "strength": 113.5,
}


def test_at_the_critical_size_stored_energy_pays_for_a_hemisphere() -> None:
    """The even shear of a circle on a half-space, integrated from Cerruti's point force."""
    radius = 0.5 * critical_junction(**STEEL)
    shear, modulus, poisson = STEEL["strength"], STEEL["shear_modulus"], STEEL["poisson"]

    def inverse_distances(r: float) -> float:
        # ∫ dA/s over the circle from a point at r in it: 4 a E(r²/a²)
        return float(4.0 * radius * ellipe((r / radius) ** 2))

    mean = quad(lambda r: 2.0 * r / radius**2 * inverse_distances(r), 0.0, radius)[0]
    # u = q/(2πG) ∫ [(1 − ν)/s + ν x²/s³] dA, and x²/s² is one half on average over pairs of points
    displacement = shear / (2.0 * np.pi * modulus) * (1.0 - 0.5 * poisson) * mean
    stored = 0.5 * shear * displacement * np.pi * radius**2
    assert stored == pytest.approx(2.0 * STEEL["surface_energy"] * 2.0 * np.pi * radius**2, rel=1e-9)


def test_a_joule_a_square_metre_on_soft_steel() -> None:
    # 12π · 1 J/m² · 74.806 GPa / (1.71 · (113.5 MPa)²) = 128.0 µm, in SI by hand
    assert critical_junction(**STEEL) == pytest.approx(0.1280, rel=1e-3)


def test_strength_is_the_yield_stress_of_the_hardness_in_shear() -> None:
    assert junction_strength(590.0) == pytest.approx((590.0 / 3.0) / 3.0**0.5)


def test_share_above_a_diameter_is_of_the_area() -> None:
    areas = np.pi / 4.0 * np.array([1.0, 1.0, 4.0, 9.0])  # diameters 1, 1, 2 and 3 mm
    assert diameters_of(areas) == pytest.approx([1.0, 1.0, 2.0, 3.0])
    assert share_above(areas, 0.9) == 1.0
    assert share_above(areas, 1.5) == pytest.approx(13.0 / 15.0)
    assert share_above(areas, 2.5) == pytest.approx(9.0 / 15.0)
    assert share_above(areas, 3.1) == 0.0
    assert np.isnan(share_above(areas[:0], 1.0))


@pytest.fixture(scope="module")
def result() -> Result:
    return warpwear.run(
        Study.load("v3-fine").replace(
            {"grid.cell": "20 um", "sliding.distance": "10 mm", "output.snapshots": ["1 mm"]}
        )
    )


def drawn(result: Result, critical: float | None) -> Any:
    data = FigureData(result)
    data.study = SimpleNamespace(  # type: ignore[assignment]
        pair=SimpleNamespace(critical_junction=critical, critical_diameter=critical),
        cells=result.study.cells,
        fretting=None,
    )
    figure = paint(junctions(data))
    figure.canvas.draw()
    return figure


def test_the_figure_shows_all_of_the_area_and_what_is_above(result: Result) -> None:
    figure = drawn(result, 0.06)
    axes, entries = figure.axes[0], [text.get_text() for text in figure.legends[0].get_texts()]
    curves = [line for line in axes.lines if line.get_label() in entries]
    dots = [line for line in axes.lines if line.get_marker() == "o"]
    assert len(curves) == len(dots) == 2
    areas_of = result.surface_evolution.island_areas
    for curve, dot, areas, distance in zip(curves, dots, areas_of, (1, 10), strict=True):
        diameters, shares = curve.get_data()
        assert shares[0] == 1.0
        assert shares[-1] == pytest.approx(0.0, abs=1e-12)
        assert diameters.max() == pytest.approx(2e3 * np.sqrt(areas.max() / np.pi))
        above = areas[2.0 * np.sqrt(areas / np.pi) > 0.06].sum() / areas.sum()
        assert dot.get_xydata().ravel().tolist() == pytest.approx([60.0, above])
        assert curve.get_label() == f"after {distance} mm: {100.0 * above:.0f} %"
    assert "60 µm" in axes.get_title()
    # A cell of 20 µm is as large as a circle of 22.57 µm.
    assert axes.get_xlim()[0] == pytest.approx(0.9 * 22.57, rel=1e-3)


def test_without_a_critical_size_the_islands_are_drawn_alone(result: Result) -> None:
    figure = drawn(result, None)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["after 1 mm", "after 10 mm"]
    assert not [line for line in figure.axes[0].lines if line.get_marker() == "o"]
