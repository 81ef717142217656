"""Implicit Archard wear without springs cuts the initial gap off at a plane.

g ← max(g, δ) with h² Σ max(δ − g, 0) = K F L, from when no cell is at hardness any more.
"""

import math
from functools import cache

import numpy as np
import pytest
import reference
from numpy.testing import assert_allclose
from reference import FloatArray
from scipy.optimize import brentq
from scipy.stats import norm
from thesis import K_COUNTER, K_DISC, F, H, K, R, smooth

from warpwear import Result, Study, run
from warpwear.study.surface import surface_of

STOPS = (30.0, 240.0, 1200.0, 2400.0)
CELLS = [5, pytest.param(1, marks=pytest.mark.slow)]


def heights(study: Study) -> FloatArray:
    return surface_of(study.disc).heights(study.cells.x, study.cells.y)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_gaussian_surface_worn_by_a_plane(seed: int, device: str) -> None:
    """Removed v = σ [φ(c) − c Q(c)] leaves A/A0 = Q(c): 10 % on one patch; its own cut to round-off."""
    sigma, targets = 3.75e-3, {0.139: 0.237, 0.384: 0.488, 1.06: 0.835}
    distances = [v * sigma / (K * F) for v in targets]  # on 1 mm²
    study = smooth(
        counter__radius="inf mm",
        disc__synthetic={
            "kind": "self-affine",
            "sq": f"{sigma} mm",
            "roll_off": "40 um",
            "cut_off": "8 um",
            "period": "1 mm",
            "seed": seed,
        },
        grid__cell="4 um",
        grid__extent="1 mm",
        sliding__distance=f"{distances[-1]} mm",
        stepping__first="0.1 mm",
        stepping__growth=1.1,
        stepping__largest="1 mm",
        output__snapshots=[f"{d} mm" for d in distances],
    )
    history = run(study, device=device, plots=False).history
    for distance, (v, published) in zip(distances, targets.items(), strict=True):
        c = brentq(lambda c, v=v: norm.pdf(c) - c * norm.sf(c) - v, -5.0, 5.0)
        assert norm.sf(c) == pytest.approx(published, abs=1e-3)
        row = int(np.argmin(np.abs(history["distance"] - distance)))
        assert history["area_contact"][row] == pytest.approx(published, rel=0.1)
        approach, count = reference.truncation(-heights(study), K * F * distance, study.cells.cell)
        assert_allclose(history["approach"][row], approach, rtol=1e-10)
        assert history["cells_in_contact"][row] == count
    assert_allclose(history["pressure_mean"] * history["area_contact"], F, rtol=1e-12)
    assert_allclose(history["pressure_max"][1:], recession(history)[1:], rtol=1e-9)


def recession(history: dict[str, FloatArray]) -> FloatArray:
    """Pressure of the cells that already touched, (δ − δ before)/(K ΔL) [MPa]."""
    return np.diff(history["approach"], prepend=np.nan) / (K * history["increment"])


@cache
def headline(cell: int, device: str) -> Result:
    """v3-fine. cell: [µm]."""
    changes = {"grid.cell": f"{cell} um", "output.snapshots": [f"{s} mm" for s in STOPS]}
    changes |= {"output.precision": "double"}
    return run(Study.load("v3-fine").replace(changes), device=device, plots=False)


@pytest.mark.parametrize("cell", CELLS)
def test_headline_is_the_truncated_gap(cell: int, device: str) -> None:
    """From 30 mm on: δ to 1e-10, the area to one cell, the gap field, and the pressure of all worn cells."""
    result = headline(cell, device)
    history, grid = result.history, result.study.cells
    initial = reference.counter_gap(grid.x, grid.y, R, heights(result.study))
    assert result.snapshot_distances.tolist() == list(STOPS)
    for number, distance in enumerate(STOPS):
        row = int(np.argmin(np.abs(history["distance"] - distance)))
        approach, count = reference.truncation(initial, K * F * distance, grid.cell)
        assert history["distance"][row] == distance
        assert_allclose(history["approach"][row], approach, rtol=1e-10)
        assert abs(history["cells_in_contact"][row] - count) <= 1
        assert history["pressure_mean"][row] == pytest.approx(F / (count * grid.cell**2), rel=1.5 / count)
        assert history["pressure_max"][row] == pytest.approx(recession(history)[row], rel=1e-8)
        assert history["area_plastic"][row] == 0.0
        fields = result.snapshot(number)
        removed = np.maximum(approach - initial, 0.0)
        assert_allclose(fields.gap, initial + removed, rtol=0, atol=1e-12)
        assert_allclose(fields.wear_counter, K_COUNTER / K * removed, rtol=0, atol=1e-12)
        assert_allclose(fields.wear_disc, K_DISC / K * removed, rtol=0, atol=1e-12)
        worn_before = fields.pressure[initial < history["approach"][row - 1]]
        assert np.ptp(worn_before) <= 1e-8 * worn_before.mean()


@pytest.mark.parametrize("cell", CELLS)
def test_headline_is_balanced_and_conserves(cell: int, device: str) -> None:
    """Residual ≤ 1e-12 F at every step, p ≤ H, volumes K F L to 1e-10."""
    history = headline(cell, device).history
    assert np.abs(history["load_residual"]).max() <= 1e-12 * F
    assert_allclose(history["pressure_mean"] * history["area_contact"], F, rtol=1e-11)
    assert history["pressure_max"].max() <= H
    assert_allclose(history["wear_volume_counter"], K_COUNTER * F * history["distance"], rtol=1e-10)
    assert_allclose(history["wear_volume_disc"], K_DISC * F * history["distance"], rtol=1e-10)


@pytest.mark.parametrize("cell", CELLS)
def test_headline_figures(cell: int, device: str) -> None:
    """A is F/H = 0.0136 mm² after 3 µm, 0.123 ± 0.010 at 30 mm, 1.253 ± 0.014 at 2400 mm, and levels off."""
    result = headline(cell, device)
    history = result.history
    area = dict(zip(history["distance"].tolist(), history["area_contact"].tolist(), strict=True))
    assert area[3.0e-3] == pytest.approx(0.0136, rel=0.01)
    assert history["pressure_mean"][0] == pytest.approx(H, rel=0.01)
    assert area[30.0] == pytest.approx(0.123, abs=0.010)
    assert area[2400.0] == pytest.approx(1.253, abs=0.014)
    shape = result.summary["area_shape"]
    assert shape["exponent_m"] == pytest.approx(0.50, abs=0.02)
    assert shape["levelling_lambda"] == pytest.approx(0.24, abs=0.02)
    assert 1.29 <= history["patch_along"][-1] <= 1.38
    assert 1.29 <= history["patch_across"][-1] <= 1.38


def test_one_surface_on_four_meshes(device: str) -> None:
    """10, 5, 2 and 1 µm cells: area and mean pressure at 30 mm within 1.5 % of each other."""
    areas, pressures = [], []
    for cell in (10, 5, 2, 1):
        study = Study.load("v3-fine").replace({"grid.cell": f"{cell} um", "sliding.distance": "30 mm"})
        history = run(study, device=device, plots=False).history
        areas.append(history["area_contact"][-1])
        pressures.append(history["pressure_mean"][-1])
    assert max(areas) / min(areas) - 1.0 <= 0.015
    assert max(pressures) / min(pressures) - 1.0 <= 0.015


def test_independent_of_the_increment(device: str) -> None:
    """One step, 40 equal ones or 230 growing ones: the same fields and areas, on a rough counter-body too."""
    rough = {
        "kind": "self-affine",
        "ra": "1 um",
        "roll_off": "60 um",
        "cut_off": "20 um",
        "period": "1 mm",
        "seed": 3,
    }
    plans = [
        {"stepping__increment": "30 mm"},
        {"stepping__increment": "0.75 mm"},
        {"stepping__first": "3 um", "stepping__growth": 1.02, "stepping__largest": "1 mm"},
    ]
    ends = []
    for plan in plans:
        study = smooth(disc__synthetic=rough, grid__cell="5 um", sliding__distance="30 mm", **plan)
        result = run(study.replace({"grid.extent": "0.6 mm"}), device=device, plots=False)
        ends.append((result.history, result.snapshot(-1)))
    assert [end[0]["distance"].size for end in ends][:2] == [1, 40]
    for history, fields in ends[1:]:
        assert history["cells_in_contact"][-1] == ends[0][0]["cells_in_contact"][-1]
        assert_allclose(history["approach"][-1], ends[0][0]["approach"][-1], rtol=1e-12)
        assert_allclose(fields.gap, ends[0][1].gap, rtol=0, atol=1e-14)
        assert_allclose(fields.wear_disc, ends[0][1].wear_disc, rtol=0, atol=1e-14)
        # Pressures are those of the last step alone: the longer it is, the more they are an average.
        assert history["pressure_max"][-1] == pytest.approx(recession(history)[-1], rel=1e-8)
        assert math.isclose(history["pressure_mean"][-1] * history["area_contact"][-1], F, rel_tol=1e-12)
