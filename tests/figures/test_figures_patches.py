"""What is drawn of two-scale runs, and what is left out where patches cover a part of the area only."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_figures import drawn, faults_of, is_map
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

import warpwear
from warpwear import InputError, Result, Study
from warpwear.figures.of_run.animation import animate
from warpwear.figures.of_run.data import load_share_error, smooth_shares

RUNS: dict[str, dict[str, Any]] = {
    "all covered": {"output.snapshots": ["0.3 mm", "3 mm"]},
    "a ninth": {"grid.extent": "2.1 mm", "patches.macro_cell": "300 um", "patches.width": "100 um"}
    | {"sliding.distance": "60 mm"},
    "no smooth contact": {"disc.material": None, "patches.bulk": "none"},
}
OF_FIELDS = {"setup", "pressure_map", "contact_map", "wear_map", "counter_3d", "disc_profiles", "islands"}


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Result]:
    where = tmp_path_factory.mktemp("runs")
    small = {"grid.cell": "10 um", "sliding.distance": "10 mm", "output.snapshots": []}
    small["disc.synthetic.cut_off"] = "20 um"  # what such cells resolve
    return {
        name: warpwear.run(
            Study.load("two-scale").replace(small | changes), out=where / name.replace(" ", "-"), plots=False
        )
        for name, changes in RUNS.items()
    }


@pytest.fixture(scope="module")
def load_shares(results: dict[str, Result]) -> dict[str, tuple[Figure, Any]]:
    return {run: drawn(result, "load_share") for run, result in results.items()}


def test_maps_of_loads_are_fit_to_print(load_shares: dict[str, tuple[Figure, Any]]) -> None:
    faults = [fault for run, figure in load_shares.items() for fault in faults_of(run, *figure)]
    assert not faults, "\n".join(faults)


def test_patches_drawn_large_are_fit_to_print(results: dict[str, Result]) -> None:
    faults = [fault for run, r in results.items() for fault in faults_of(run, *drawn(r, "patch_zoom"))]
    assert not faults, "\n".join(faults)


def test_the_maps_show_the_loads(
    results: dict[str, Result], load_shares: dict[str, tuple[Figure, Any]]
) -> None:
    """Every panel's pressures times the area of a macro cell sum up to the load."""
    for run, panels in (("all covered", 6), ("a ninth", 2), ("no smooth contact", 1)):
        figure, _ = load_shares[run]
        maps = [axes for axes in figure.axes if is_map(axes)]
        assert len(maps) == panels
        assert len({(axes.images[0].norm.vmin, axes.images[0].norm.vmax) for axes in maps}) == 1
        area = results[run].study.patches.macro_cell ** 2
        for axes in maps:
            shown = np.ma.filled(axes.images[0].get_array(), np.nan)
            assert np.nansum(shown) * area == pytest.approx(8.0, rel=1e-9)


def test_fields_with_holes_are_not_drawn(results: dict[str, Result], tmp_path: Path) -> None:
    sampled = results["a ninth"]
    assert set(sampled.plot.left_out) >= OF_FIELDS
    assert not OF_FIELDS & set(results["all covered"].plot.left_out)
    assert "cover a part of the area" in sampled.plot.left_out["pressure_map"]
    assert np.isnan(sampled.surface_evolution.table["islands"]).all()
    assert np.isfinite(sampled.surface_evolution.table["sq"]).all()
    with pytest.raises(InputError, match="a film needs whole fields"):
        animate(sampled, tmp_path / "film.gif")
    folders = [r.folder for r in (sampled, results["all covered"]) if r.folder]
    found = warpwear.compare(*folders)
    names = {"profile_counter", "profile_disc"}
    assert not found.rows[0].courses.keys() & names
    assert found.rows[1].courses.keys() >= names
    assert any("no whole field, so no profile" in note for note in found.notes)


def test_the_summary_tells_of_patches(results: dict[str, Result]) -> None:
    whole, sampled = (results[name].summary["patches"] for name in ("all covered", "a ninth"))
    assert (whole["number"], whole["cover"], whole["bulk"]) == (900, 1.0, "spring")
    assert sampled["number"] == 49
    assert sampled["cover"] == pytest.approx(1.0 / 9.0)


def test_smooth_shares_are_those_of_the_load_coupling(results: dict[str, Result]) -> None:
    """What the figure draws beside the patches is what that coupling prescribes."""
    whole = results["all covered"]
    load = warpwear.run(whole.study.replace({"patches.coupling": "load"}))
    rows = [0, 40, load.history["distance"].size - 1]
    found = smooth_shares(whole, rows)
    assert found is not None
    assert_allclose(found, load.load_share[rows], rtol=0.0, atol=1e-9)
    assert load_share_error(np.array([2.0, 0.0]), np.array([1.0, 1.0])) == 0.5
