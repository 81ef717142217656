"""Gross-slip fretting and a block on a ring, by the numbers that others measured and computed."""

from typing import Any

import numpy as np
import pytest

import warpwear
from warpwear import Study


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


def of_lines(radius: str, load: float, cell: str, extent: list[str], **sections: dict[str, Any]) -> Study:
    """A smooth cylinder on a smooth disc, a line contact of a load a length [N/mm]."""
    steel = {"young": "200 GPa", "poisson": 0.3}
    across = float(extent[1].split()[0]) * 1.0e-3  # given in µm
    contact = {"load": f"{load * across} N", "law": "half-space", "boundary": "line", "hardness": "inf MPa"}
    return Study(
        study={"name": "lines"},
        counter={"shape": "cylinder", "radius": radius, **steel},
        disc={"synthetic": {"kind": "flat"}, **steel},
        contact=contact,
        grid={"cell": cell, "extent": extent},
        output={"snapshots": []},
        friction={"shear_strength": "100 MPa"},
        **sections,
    )


def test_gross_slip_of_a_cylinder(device: str) -> None:
    """McColl, Ding and Leen (2004): 18,000 cycles of 50 µm, in jumps of a hundred.

    A plain half-plane at the same cells and jumps: flat 2.761 µm, cylinder 2.067 µm, width 0.515 mm.
    """
    study = of_lines(
        "6 mm",
        18.5,
        "5 um",
        ["0.8 mm", "40 um"],
        wear={"counter": "1.9e-5 mm^3/N/m", "disc": "2.9e-5 mm^3/N/m"},
        sliding={"stroke": "50 um", "cycles": 18_000},
        stepping={"jump": 100},
    )
    assert study.shift == 1
    last = warpwear.run(study, device=device).snapshot(-1)
    flat, cylinder = last.wear_disc.mean(axis=1), last.wear_counter.mean(axis=1)
    assert flat.max() == pytest.approx(2.761e-3, rel=2e-3)
    assert cylinder.max() == pytest.approx(2.067e-3, rel=2e-3)
    assert np.count_nonzero(flat) * study.grid.cell == pytest.approx(0.515, abs=1.01 * study.grid.cell)
    assert flat.sum() * study.grid.cell == pytest.approx(0.966e-3, rel=1e-3)


@pytest.mark.parametrize(
    ("wear", "ball", "disc", "widths"),
    [(1e-3, 0.1179e-3, 0.1161e-3, (0.190, 0.240, 0.190)), (1e-2, 0.720e-3, 0.704e-3, (0.255, 0.300, 0.270))],
)
def test_gross_slip_of_a_ball(
    wear: float, ball: float, disc: float, widths: tuple[float, float, float], device: str
) -> None:
    """A prototype in NumPy of places passed in turn: depths, and lengths of ball, disc, and width of both.

    wear: coefficient of each body times the cycles [mm³/(N·m)].
    """
    cycles, steel = 20, {"young": "210 GPa", "poisson": 0.3}
    coefficient = f"{wear / cycles} mm^3/N/m"
    study = Study(
        study={"name": "fretting"},
        counter={"radius": "5 mm", **steel},
        disc={"synthetic": {"kind": "flat"}, **steel},
        contact={"load": "20 N", "law": "half-space", "hardness": "inf MPa"},
        wear={"counter": coefficient, "disc": coefficient},
        grid={"cell": "5 um", "extent": "0.4 mm"},
        sliding={"stroke": "50 um", "cycles": cycles},
        output={"snapshots": []},
        friction={"shear_strength": "100 MPa"},
    )
    last = warpwear.run(study, device=device).snapshot(-1)
    worn = last.wear_counter, last.wear_disc
    assert [depth.max() for depth in worn] == pytest.approx([ball, disc], rel=1e-2)
    counts = worn[0].any(axis=1).sum(), worn[1].any(axis=1).sum(), worn[1].any(axis=0).sum()
    assert [count * study.grid.cell for count in counts] == pytest.approx(widths, abs=0.0101)
    for depth in worn:
        volume = float(depth.sum()) * study.grid.cell**2
        assert volume == pytest.approx(wear / cycles * 1e-3 * 20.0 * study.sliding.total, rel=1e-12)


def test_a_block_on_a_rigid_ring(device: str) -> None:
    """Cruzado et al. (2010): 3600 m at rest, in increments that follow the distance."""
    k, load, radius = 2.0e-9, 65.0 / 6.0, 20.0
    study = of_lines(
        "20 mm",
        load,
        "20 um",
        ["3 mm", "160 um"],
        wear={"counter": "0 mm^3/N/m", "disc": f"{1e3 * k} mm^3/N/m"},
        sliding={"distance": "3600 m"},
    )
    result = warpwear.run(study, device=device)
    assert result.history["distance"].size < 2000
    section, cell = result.snapshot(-1).wear_disc.mean(axis=1), study.grid.cell
    area = k * load * 3.6e6  # of a segment of the ring, 2 a³/3R
    half_width = (1.5 * radius * area) ** (1.0 / 3.0)
    assert section.sum() * cell == pytest.approx(area, rel=1e-9)
    assert section.max() == pytest.approx(half_width**2 / (2.0 * radius), rel=2e-3)
    assert np.count_nonzero(section) * cell == pytest.approx(2.0 * half_width, abs=2.0 * cell)
