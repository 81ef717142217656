"""Figures of domains that are no squares: they are drawn, and fit to print."""

from pathlib import Path

import pytest
from cases_figures import drawn, faults_of
from numpy.testing import assert_allclose

import warpwear
from warpwear import Result, Study
from warpwear.figures.of_run.data import FigureData

#: A line contact of a rough disc and a flat, as long as the domain, and a cylinder on one row of cells.
ROUGH = {"kind": "self-affine", "ra": "0.2 um", "cut_off": "40 um", "period": "0.16 mm"}
FLAT = {"counter.radius": "inf mm", "disc.synthetic": ROUGH, "grid.extent": ["2 mm", "0.16 mm"]}
CYLINDER = {"counter.shape": "cylinder", "counter.radius": "6 mm", "disc.synthetic": {"kind": "flat"}}
CYLINDER |= {"grid.extent": ["0.6 mm", "10 um"]}


@pytest.fixture(scope="module", params=["flat", "cylinder"])
def result(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Result:
    base = Study.load("v3-fine").replace(
        {"contact.law": "half-space", "contact.boundary": "line", "contact.load": "10 N/mm"}
        | {"grid.cell": "10 um", "sliding.distance": "3 mm", "stepping.largest": "0.5 mm"}
        | {
            "stepping.first": "0.05 mm",
            "stepping.growth": 1.5,
            **(FLAT if request.param == "flat" else CYLINDER),
        }
    )
    out: Path = tmp_path_factory.mktemp("rectangles") / request.param
    return warpwear.run(base, out=out, plots=False)


def check_figures(result: Result, names: set[str]) -> None:
    faults = [fault for name in sorted(names) for fault in faults_of(name, *drawn(result, name))]
    assert not faults, "\n".join(faults)


def test_figures_of_a_rectangle_are_fit_to_print(result: Result) -> None:
    """Long maps lie one below the other; a row of cells has no relief."""
    narrow = {name for name, why in result.plot.left_out.items() if "too narrow" in why}
    assert bool(narrow) == (result.study.cells.ny == 1)
    check_figures(result, {"setup", "pressure_3d", "pressure_map", "pressure_profiles"} - narrow)


@pytest.mark.slow
def test_every_figure_of_a_rectangle_is_fit_to_print(result: Result) -> None:
    check_figures(result, {*result.plot.names()})


def test_the_window_of_a_rectangle_is_one(result: Result) -> None:
    """As long as the domain under a flat, and as the scar under a cylinder; as wide as the domain."""
    x0, x1, y0, y1 = FigureData(result).window.extent
    along, across = result.study.grid.sides
    assert_allclose((y0, y1), (-0.5 * across, 0.5 * across), atol=1e-12)
    if result.study.counter.form.is_flat:
        assert_allclose((x0, x1), (-0.5 * along, 0.5 * along), atol=1e-12)
    else:
        assert 0.5 * result.history["patch_along"][-1] < x1 < 0.25 * along
