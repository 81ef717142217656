"""Gross slip at the mean pressure of a stroke: against NumPy's operator, closed forms, and each place."""

import math
from functools import partial
from typing import Any

import numpy as np
import pytest
from cases_fretting import HERTZ, LOAD, MODULUS, PEAK, RADIUS, mean_along, study_of
from cases_half_space import MODULUS as OF_CASES
from cases_half_space import bounded, dense_free

import warpwear
from warpwear import InputError, Study
from warpwear.contact.half_space.window import WindowedHalfSpace
from warpwear.models.track import half_space


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


@pytest.fixture
def solved_tightly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Contacts as near to the solution as a dense one."""
    monkeypatch.setattr(half_space, "WindowedHalfSpace", partial(WindowedHalfSpace, tolerance=1e-10))


@pytest.mark.usefixtures("solved_tightly")
@pytest.mark.parametrize("window", [4, 5])
def test_jumps_against_a_dense_operator(window: int, device: str, threads: int) -> None:
    """Three jumps of S + ΔL (K_counter + K_disc B²) on what was worn before, disc worn by the mean."""
    cell = 0.012
    study = study_of(
        grid__cell=f"{cell} mm",
        grid__extent=f"{26 * cell} mm",
        sliding__stroke=f"{window * cell} mm",
        sliding__cycles=None,
        sliding__distance="0.3 m",
        sliding__positions="mean",
        stepping__increment="0.1 m",
        wear__disc="3e-6 mm^3/N/m",
        output__snapshots=["0.1 m", "0.2 m"],
    )
    result = warpwear.run(study, device=device, threads=threads)
    grid, mean = study.cells, mean_along(26, window)
    elastic = dense_free(grid) * OF_CASES / MODULUS
    gap = RADIUS - np.sqrt(RADIUS**2 - np.add.outer(grid.x**2, grid.y**2))
    disc, counter, removal = np.zeros(grid.shape), np.zeros(grid.shape), 1e-9 * 100.0
    matrix = elastic + removal * np.eye(grid.cells)
    matrix += 3.0 * removal * np.kron(mean @ mean, np.eye(grid.ny))
    for snapshot, approach in zip(result.snapshots, result.history["approach"], strict=True):
        pressure = bounded(matrix, gap + counter + mean @ disc, float(approach), math.inf)
        counter += removal * pressure
        disc += 3.0 * removal * (mean @ pressure)
        np.testing.assert_allclose(snapshot.pressure, pressure, atol=1e-6 * PEAK)
        np.testing.assert_allclose(snapshot.wear_disc, disc, atol=1e-6 * disc.max())
        np.testing.assert_allclose(snapshot.wear_counter, counter, atol=1e-6 * counter.max())


@pytest.fixture(scope="module")
def late() -> warpwear.Result:
    """A hundred thousand cycles of 50 µm."""
    return warpwear.run(study_of())


def test_volumes_and_energy_are_those_of_the_way_slid(late: warpwear.Result) -> None:
    end = {name: values[-1] for name, values in late.history.items()}
    for body in ("counter", "disc"):
        assert end[f"wear_volume_{body}"] == pytest.approx(1e-9 * LOAD * 1e4, rel=1e-12)
    assert end["friction_energy"] == pytest.approx(1e-3 * 0.6 * LOAD * 1e4, rel=1e-12)
    np.testing.assert_allclose(late.history["energy"], 0.6 * LOAD * 0.1, rtol=1e-12)
    np.testing.assert_allclose(late.history["cycles"].sum(), 1e5, rtol=1e-12)
    assert not late.history["stick_area"].any()


def test_depths_and_scars_late(late: warpwear.Result) -> None:
    """Reference values are of a program in NumPy that shares nothing with this one."""
    history = late.history
    assert history["wear_depth_counter"][-1] == pytest.approx(2.486e-3, rel=5e-3)
    assert history["wear_depth_disc"][-1] == pytest.approx(2.476e-3, rel=5e-3)
    closed = 2.0 * (4.0 * RADIUS * 2e-9 * LOAD * 1e4 / math.pi) ** 0.25
    assert history["patch_across"][-1] == pytest.approx(closed, abs=0.01)
    disc = late.snapshots[-1].wear_disc > 1e-9
    counter = late.snapshots[-1].wear_counter > 1e-9
    longer = np.count_nonzero(disc.any(axis=1)) - np.count_nonzero(counter.any(axis=1))
    assert longer == 10  # cells of the stroke


def test_finer_jumps_change_little(late: warpwear.Result) -> None:
    fine = warpwear.run(study_of(stepping__growth=10.0 ** (1.0 / 48.0)))
    assert len(fine.history["distance"]) > 3 * len(late.history["distance"])
    for body in ("counter", "disc"):
        depth = late.history[f"wear_depth_{body}"][-1]
        assert depth == pytest.approx(fine.history[f"wear_depth_{body}"][-1], rel=2e-3)


def test_a_stroke_of_nothing_wears_the_cap_of_the_ball() -> None:
    """The overlap of a ball with a plane, a²/2R deep in all; a program in NumPy had 4.339 µm."""
    result = warpwear.run(
        study_of(
            sliding__stroke="1 um", sliding__cycles=None, sliding__distance="30 m", grid__extent="0.8 mm"
        )
    )
    depth = sum(result.history[f"wear_depth_{body}"][-1] for body in ("counter", "disc")) / 2.0
    closed = 0.25 * (4.0 * RADIUS * 2e-9 * LOAD * 3e4 / math.pi) ** 0.5 / RADIUS
    assert closed == pytest.approx(4.370e-3, rel=1e-3)
    assert -0.02 <= depth / closed - 1.0 <= 0.0
    assert depth == pytest.approx(4.339e-3, rel=5e-3)


#: Line contact: 18.5 N/mm on R 6 mm, E* 109.89 GPa, 18,000 cycles of 50 µm (a definition of a case).
LINE: dict[str, Any] = {
    "counter__shape": "cylinder",
    "counter__radius": "6 mm",
    "counter__young": "200 GPa",
    "disc__young": "200 GPa",
    "contact__load": "18.5 N/mm",
    "contact__boundary": "line",
    "grid__cell": "2 um",
    "grid__extent": ["0.8 mm", "8 um"],
    "sliding__cycles": 18_000,
    "wear__counter": "3.33e-5 mm^3/N/m",
    "wear__disc": "3.33e-5 mm^3/N/m",
}


def test_a_line_contact() -> None:
    """A program in NumPy had 3.06 and 3.05 µm, 536 and 580 µm; the closed form 3.066 µm and 543 µm."""
    result = warpwear.run(study_of(**LINE))
    history, cell = result.history, 2e-3
    assert history["wear_depth_counter"][-1] == pytest.approx(3.06e-3, rel=1e-2)
    assert history["wear_depth_disc"][-1] == pytest.approx(3.05e-3, rel=1e-2)
    along = {
        body: cell * np.count_nonzero(getattr(result.snapshots[-1], f"wear_{body}").any(axis=1))
        for body in ("counter", "disc")
    }
    assert along["counter"] == pytest.approx(0.536, abs=0.008)
    assert along["disc"] == pytest.approx(0.580, abs=0.008)
    assert np.isnan(history["displacement"]).all()  # a line is displaced by no number


@pytest.mark.usefixtures("solved_tightly")
def test_layers_wear_by_the_pressure_and_its_mean(device: str) -> None:
    """By S + ΔL (K_counter of cells + K_disc of the fastest met B²); ∫ p dL wears through layers."""
    cell, stops = 0.012, [f"0.{n} m" for n in range(1, 7)]
    layer = {"name": "coat", "thickness": "0.1 um", "wear": "3e-7 mm^3/N/m"}
    study = study_of(
        grid__cell=f"{cell} mm",
        grid__extent=f"{26 * cell} mm",
        sliding__stroke=f"{4 * cell} mm",
        sliding__cycles=None,
        sliding__distance="0.6 m",
        sliding__positions="mean",
        stepping__increment="0.1 m",
        counter__layers=[layer],
        disc__layers=[layer | {"thickness": "0.05 um"}],
        wear__disc="3e-6 mm^3/N/m",
        output__snapshots=stops,
    )
    result = warpwear.run(study, device=device)
    grid, mean, step = study.cells, mean_along(26, 4), 100.0
    elastic = dense_free(grid) * OF_CASES / MODULUS
    gap = RADIUS - np.sqrt(RADIUS**2 - np.add.outer(grid.x**2, grid.y**2))
    worn, profiles = [np.zeros(grid.shape), np.zeros(grid.shape)], study.pair.profiles or ()
    for snapshot, approach in zip(result.snapshots, result.history["approach"], strict=True):
        fastest = profiles[1].fastest_above(worn[1].max())
        matrix = elastic + step * np.diag(profiles[0].coefficient_at(worn[0]).ravel())
        matrix += step * fastest * np.kron(mean @ mean, np.eye(grid.ny))
        pressure = bounded(matrix, gap + worn[0] + mean @ worn[1], float(approach), math.inf)
        worn = [
            p.worn(w, step * q) for p, w, q in zip(profiles, worn, (pressure, mean @ pressure), strict=True)
        ]
        np.testing.assert_allclose(snapshot.pressure, pressure, atol=1e-6 * PEAK)
        np.testing.assert_allclose(snapshot.wear_counter, worn[0], atol=1e-6 * worn[0].max())
        np.testing.assert_allclose(snapshot.wear_disc, worn[1], atol=1e-6 * worn[1].max())
    for body, profile, depth in zip(("counter", "disc"), profiles, worn, strict=True):
        assert profile.exposure(depth).sum() * grid.cell_area == pytest.approx(LOAD * 600.0, rel=1e-5)
        assert 0.0 < result.history[f"area_{body}_coat"][-1] < result.history["area_contact"][-1]
    with pytest.raises(InputError, match="fretting by slips of each cell, do not follow them"):
        study.replace({"sliding.stroke_of": "body", "sliding.positions": None})


@pytest.mark.slow
def test_each_place_of_a_long_stroke() -> None:
    """Beside the mean; the program in NumPy had 2.54 and 2.42 µm, 450 µm across."""
    result = warpwear.run(study_of(sliding__positions="cells", grid__extent=["0.64 mm", "0.6 mm"]))
    history = result.history
    assert history["wear_depth_counter"][-1] == pytest.approx(2.54e-3, rel=1e-2)
    assert history["wear_depth_disc"][-1] == pytest.approx(2.42e-3, rel=1e-2)
    assert history["patch_across"][-1] == pytest.approx(0.45, abs=0.01)
    assert history["patch_along"][-1] == pytest.approx(0.44, abs=0.01)


def test_the_run_decides_what_is_honest() -> None:
    early = study_of(sliding__cycles=100)
    assert early.stroke_ratio > 0.15
    assert early.kinematics == "swept"
    assert early.resolved["sliding.positions"] == "cells"
    named = study_of(sliding__cycles=100, sliding__positions="mean")
    assert any("the stroke is 0.29 of the scar's width" in notice for notice in named.notices())
    late = study_of()
    assert late.stroke_ratio < 0.15
    assert late.kinematics == "fretting"
    assert Study.stored(late.to_toml()) == late
    assert Study.stored(early.to_toml()) == early


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"disc__synthetic": {"kind": "self-affine", "ra": "0.1 um"}}, None),
        (
            {"disc__synthetic": {"kind": "self-affine", "ra": "0.1 um"}, "sliding__positions": "mean"},
            "kind = 'flat'",
        ),
        ({"sliding__stroke": "52 um"}, r"stroke = 52 µm is not a whole number of cells"),
        ({"friction__law": "shear-strength"}, "kinematics = 'fretting' needs friction.law = 'coulomb'"),
        ({"contact__law": "local"}, "needs contact.law = 'half-space'"),
        ({"sliding__stroke": None, "sliding__cycles": None, "sliding__distance": "1 m"}, "needs a sliding"),
        ({"friction__coefficient": 0.0}, "friction.coefficient"),
    ],
)
def test_what_is_refused(changes: dict[str, Any], told: str | None) -> None:
    if told is None:  # what is rough has a contact at each place
        assert study_of(**changes).kinematics == "swept"
        return
    with pytest.raises(InputError, match=told):
        study_of(**changes)


def test_hertz_before_any_wear() -> None:
    assert pytest.approx(0.0866, rel=1e-3) == HERTZ
