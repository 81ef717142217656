"""Area against load of several runs, and the lines of theories beside it."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpwear import Study
from warpwear.comparison.area_load import area_load, has_loads
from warpwear.comparison.groups import RunData
from warpwear.comparison.table import Comparison
from warpwear.ensembles.ensemble import Group
from warpwear.figures.describe import Chart, Line
from warpwear.history.end_values import Summary

FLAT = {
    "counter.radius": "inf mm",
    "contact.hardness": "inf MPa",
    "grid.cell": "2 um",
    "grid.extent": "0.4 mm",
}
FLAT |= {"contact.law": "half-space", "disc.synthetic.period": "0.4 mm", "disc.synthetic.ra": "0.3 um"}
LOADS = (10.0, 3.0, 30.0)


def compared(*changes: dict[str, Any]) -> Comparison:
    """Runs whose area in contact is a thousandth of the load."""
    runs = []
    for change in changes:
        study = Study.load("v3-fine").replace(change)
        courses = {"area_contact": (np.arange(2.0), np.array([1e-3 * study.contact.load, 1.0]))}
        runs.append(RunData("run", {}, courses, study, Path("run"), Summary.of({})))
    return Comparison(tuple(Group(run.name, (run,)) for run in runs))


def lines(comparison: Comparison) -> dict[str, Any]:
    (chart,) = area_load(comparison).panels
    assert isinstance(chart, Chart)
    lines = (line for line in chart.lines if isinstance(line, Line))
    return {line.label: np.transpose([line.x, line.y]) for line in lines}


def test_theories_beside_flats() -> None:
    found = lines(compared(*(FLAT | {"contact.load": f"{load} N"} for load in LOADS)))
    assert [*found] == ["computed: half-space, no hardness", "Persson", "Greenwood and Williamson"]
    np.testing.assert_allclose(found["computed: half-space, no hardness"], [[3, 3], [10, 10], [30, 30]])
    study = Study.load("v3-fine").replace(FLAT)
    assert study.pair.effective_modulus is not None
    from warpwear.study.surface import surface_in

    slope = surface_in(study).record()["rms_slope"]
    load, area = found["Persson"].T
    expected = [
        0.16 * math.erf(math.sqrt(2.0) * f / 0.16 / (study.pair.effective_modulus * slope)) for f in load
    ]
    np.testing.assert_allclose(area, 1e3 * np.array(expected), rtol=1e-6)


def test_theories_beside_balls_that_touch_their_points() -> None:
    found = lines(compared(*({"contact.load": f"{load} N"} for load in LOADS)))
    assert [*found] == ["computed: local, H = 590 MPa", "load over hardness", "Hertz, smooth bodies"]
    load, area = found["load over hardness"].T
    np.testing.assert_allclose(area, 1e3 * load / 590.0)
    load, area = found["Hertz, smooth bodies"].T
    assert np.interp(8.0, load, area) == pytest.approx(9.56, rel=2e-3)


def test_bodies_that_differ_have_no_theory() -> None:
    found = lines(compared({"contact.load": "4 N"}, {"contact.load": "8 N", "disc.synthetic.seed": 2}))
    assert [*found] == ["computed: local, H = 590 MPa"]


def test_one_load_has_no_such_figure() -> None:
    assert not has_loads(compared({}, {"contact.hardness": "1 GPa"}))
    assert has_loads(compared({}, {"contact.load": "1 N"}))
