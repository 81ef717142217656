"""Gross-slip fretting and a block on a ring, by the numbers that others measured and computed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import warpwear
from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.models.track.model import SweptModel
from warpwear.runs.plan import plan_of

STEEL = {"young": "200 GPa", "poisson": 0.3}
BASE = {"output": {"snapshots": []}, "friction": {"shear_strength": "100 MPa"}}


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


def test_gross_slip_of_a_cylinder(device: str) -> None:
    """McColl, Ding and Leen (2004): 18,000 cycles of 50 µm, here 180 of a hundredfold wear.

    A plain half-plane at the same cells and cycles: flat 2.761 µm, cylinder 2.067 µm, width 0.515 mm. Here
    the half-plane is a narrow periodic strip, whose period of 1.28 mm is far beyond the contact.
    """
    jump, cell, across = 100, 0.005, 8
    study = Study(
        study={"name": "fretting"},
        counter={"shape": "cylinder", "radius": "6 mm", **STEEL},
        disc={"synthetic": {"kind": "flat"}, **STEEL},
        contact={"load": "18.5 N", "law": "half-space", "hardness": "inf MPa"},
        wear={"counter": f"{1.9e-5 * jump} mm^3/N/m", "disc": f"{2.9e-5 * jump} mm^3/N/m"},
        grid={"cell": f"{cell} mm", "extent": "1.28 mm"},
        sliding={"stroke": "50 um", "cycles": 18_000 // jump},
        **BASE,
    )
    assert study.shift == 1
    task = replace(study.contact_task, boundary="periodic", load=18.5 * across * cell)
    with Executor(Grid(256, across, cell), device=device) as executor:
        model = SweptModel(task, study.track, np.zeros((study.track.rows, across)), executor)
        for _ in model.steps([(increment, False) for increment, *_ in plan_of(study)]):
            pass
        state = model.contact.state
        flat, cylinder = (executor.to_numpy(f).mean(axis=1) for f in (state.wear_disc, state.wear_counter))
    assert flat.max() == pytest.approx(2.761e-3, rel=2e-3)
    assert cylinder.max() == pytest.approx(2.067e-3, rel=2e-3)
    assert np.count_nonzero(flat) * cell == pytest.approx(0.515, abs=1.01 * cell)
    assert flat.sum() * cell == pytest.approx(0.966e-3, rel=1e-3)


def test_a_block_on_a_rigid_ring(tmp_path: Path) -> None:
    """Cruzado et al. (2010): 3600 m in increments that follow the distance; an array stands for the ring."""
    cell, cells, load, k, radius = 0.02, 150, 65.0 / 6.0, 2.0e-9, 20.0
    x = (np.arange(cells) - 0.5 * (cells - 1)) * cell
    ring = np.repeat((np.sqrt(radius**2 - x**2) - radius)[:, None], cells, axis=1)
    np.save(tmp_path / "ring.npy", ring)
    study = Study(
        study={"name": "ring"},
        counter={"radius": "inf mm", **STEEL},
        disc={
            "surface": str(tmp_path / "ring.npy"),
            "pixel": "20 um",
            "height_unit": "mm",
            "level": "none",
            **STEEL,
        },
        contact={"load": f"{load * cells * cell} N", "law": "half-space", "hardness": "inf MPa"},
        wear={"counter": f"{1e3 * k} mm^3/N/m", "disc": "0 mm^3/N/m"},
        grid={"cell": "20 um", "extent": f"{cells * cell} mm"},
        sliding={"distance": "3600 m"},
        **BASE,
    )
    result = warpwear.run(study)
    assert len(result.history["distance"]) < 2000
    section = result.snapshot(-1).wear_counter.mean(axis=1)
    area = k * load * 3.6e6  # of a segment of the ring, 2 a³/3R
    half_width = (1.5 * radius * area) ** (1.0 / 3.0)
    assert section.sum() * cell == pytest.approx(area, rel=1e-9)
    assert section.max() == pytest.approx(half_width**2 / (2.0 * radius), rel=2e-3)
    assert np.count_nonzero(section) * cell == pytest.approx(2.0 * half_width, abs=2.0 * cell)
