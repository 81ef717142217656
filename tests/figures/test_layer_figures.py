"""Figures of bodies with layers: a map by the layers' names, and sections through them."""

import numpy as np
import pytest
from cases_figures import drawn, faults_of
from numpy.testing import assert_allclose

import warpwear
from warpwear import Result, Study
from warpwear.figures.describe import Chart, Line, Map
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.layers import layers, material_map
from warpwear.figures.of_run.view import State

BALL = [
    {"name": "crn", "thickness": "0.2 um", "wear": "1e-7 mm^3/N/m"},
    {"name": "cr", "thickness": "0.1 um", "wear": "5e-7 mm^3/N/m"},
]
LAYERS = {"counter.layers": BALL, "wear.counter": "2e-6 mm^3/N/m"}


@pytest.fixture(scope="module")
def result() -> Result:
    """A coat worn through, on coarse cells; the ball has layers, too, which wear off first."""
    coarse = {"grid.cell": "16 um", "grid.extent": "0.96 mm", "disc.synthetic.cut_off": "32 um"}
    coarse |= {"disc.layers.1.thickness": "0.5 um", "output.snapshots": ["1 m"]}
    return warpwear.run(Study.load("coat").replace(coarse | LAYERS), plots=False)


def test_a_map_has_the_layers_names(result: Result) -> None:
    data, snapshot = FigureData(result), result.snapshot(-1)
    figure = material_map(data)
    for panel, body, depths in zip(figure.panels, ("counter", "disc"), ((2e-4, 3e-4), (5e-4,)), strict=True):
        assert isinstance(panel, Map)
        wear = data.window.largest(getattr(snapshot, f"wear_{body}"))
        assert np.array_equal(panel.fields[-1], sum((wear >= depth).astype(int) for depth in depths))
        assert panel.fields[-1].max() == len(depths)
    legend, _ = drawn(result, "material_map")
    names = [text.get_text() for text in legend.legends[0].get_texts()]
    of_ball = ["ball: crn, 0.2 µm", "ball: cr, 0.1 µm", "ball: substrate"]
    assert names == [*of_ball, "disc: dlc, 0.5 µm", "disc: substrate"]
    assert len(legend.axes) == 4  # no bar of colours


def test_a_section_shows_layers_as_thick_as_they_are_left(result: Result) -> None:
    data = FigureData(result)
    panel = layers(data).panels[2]
    assert isinstance(panel, Chart)
    lines = {line.label: line for line in panel.lines if isinstance(line, Line)}
    dlc, body, worn = lines["disc: dlc, 0.5 µm"], lines["disc: substrate"], lines["worn"].y
    lost = lines["unworn"].y - worn
    assert dlc.low is not None
    assert body.high is not None
    assert_allclose(dlc.y - dlc.low, np.clip(0.5 - lost, 0.0, None), atol=1e-12)
    assert_allclose(np.maximum(dlc.y, body.high), worn, atol=1e-12)
    assert lost.max() > 0.5
    assert (panel.y.label, panel.y.low) == ("height of the disc, µm", pytest.approx(body.low[0]))  # type: ignore[index]


def test_they_are_fit_to_print_and_in_a_paper(result: Result) -> None:
    assert {"material_map", "layers"} <= set(result.plot.names("essential"))
    faults = [fault for name in ("material_map", "layers") for fault in faults_of(name, *drawn(result, name))]
    assert not faults, "\n".join(faults)


def test_other_runs_have_none(results: dict[str, Result]) -> None:
    said = "neither body has layers: see disc.layers and counter.layers"
    assert [results["rough"].plot.reason(name) for name in ("material_map", "layers")] == [said] * 2


def test_cells_are_at_the_hardness_of_what_lies_bare_there() -> None:
    """As many as the step that wears has counted, on the coat and on a softer body below it."""
    soft = {"grid.cell": "16 um", "grid.extent": "0.96 mm", "disc.synthetic.cut_off": "32 um"}
    soft |= {"disc.hardness": "600 MPa", "disc.layers.1.thickness": "20 nm", "contact.law": "local"}
    soft |= {"output.snapshots": ["100 mm"], "sliding.distance": "200 mm"}
    result = warpwear.run(Study.load("coat").replace(soft), plots=False)
    (view, *_) = FigureData(result).views
    at_hardness = np.count_nonzero(view.state == State.AT_HARDNESS) * result.study.cells.cell_area
    assert 0.0 < at_hardness == pytest.approx(result.history["area_plastic"][view.row], rel=1e-12)
    assert at_hardness < result.history["area_contact"][view.row]
