"""Two published tests with measured profiles: a block on a ring, and a cylinder that frets on a flat.

Cruzado et al., Rev. Metalurgia 46 (2010) 106; McColl, Ding and Leen, Wear 256 (2004) 1114. Their wear
coefficients were fitted to the worn volume, so depth, width and shape are tested, not volume.
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import warpwear
from warpwear import Result, Study

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

FILES = Path(__file__).parents[2] / "docs" / "files" / "published"


class Section(NamedTuple):
    """A worn section of a body: depth [mm], area [mm²], and the width where it is worn [mm]."""

    depth: float
    area: float
    width: float


def study_of(name: str, **changes: Any) -> Study:
    return Study.load(FILES / f"{name}.toml").replace({k.replace("__", "."): v for k, v in changes.items()})


def section(result: Result, body: str) -> Section:
    """What a body lost in the section of one row of cells at the end."""
    snapshot, cell = result.snapshots[-1], result.study.grid.cell
    worn = np.asarray(getattr(snapshot, f"wear_{body}")).mean(axis=1)
    return Section(float(worn.max()), float(worn.sum() * cell), float((worn > 0.0).sum() * cell))


def rigid(radius: float, area: float) -> Section:
    """The section that a rigid ring wears into a flat: A = K P' L, a = (3 R A/2)^⅓, depth a²/2R."""
    half_width = (1.5 * radius * area) ** (1.0 / 3.0)
    return Section(half_width**2 / (2.0 * radius), area, 2.0 * half_width)


def test_a_block_on_a_ring(device: str) -> None:
    """Depth within 0.2 % of the rigid form's 44.06 µm; width and area within 1 %."""
    study = study_of("cruzado2010")
    expected = rigid(20.0, 2.0e-9 * study.contact.load / study.cells.ny / 0.02 * 3.6e6)
    assert expected.depth == pytest.approx(44.064e-3, rel=1e-4)
    with warpwear.run(study, device=device) as result:
        block = section(result, "disc")
    assert block.depth == pytest.approx(expected.depth, rel=2e-3)
    assert block.area == pytest.approx(expected.area, rel=1e-9)
    assert block.width == pytest.approx(expected.width, rel=1e-2)


@pytest.mark.parametrize(
    ("cell", "flat", "cylinder", "width"),
    [
        (5.0, 2.761, 2.067, 0.515),
        pytest.param(4.835, 2.698, 2.022, 0.505, marks=pytest.mark.slow),
    ],
)
def test_a_cylinder_that_frets(cell: float, flat: float, cylinder: float, width: float, device: str) -> None:
    """Depths [µm] and width [mm] of a plane half-plane reference, here in jumps that the error allows.

    cell: a tenth of the stroke [µm]; the smaller stroke is the slip that others' worn area tells.
    """
    size = {"grid__cell": f"{cell} um", "grid__extent": [f"{200 * cell} um", f"{cell} um"]}
    study = study_of("mccoll2004", **size, sliding__stroke=f"{10 * cell} um", output__snapshots=[])
    with warpwear.run(study, device=device) as result:
        worn, cut = section(result, "disc"), section(result, "counter")
        contacts = result.history["distance"].size
    assert contacts < 20 * 18_000 / 20
    assert 1e3 * worn.depth == pytest.approx(flat, rel=0.01)
    assert 1e3 * cut.depth == pytest.approx(cylinder, rel=0.015)
    assert abs(worn.width - width) <= 2.0 * 1e-3 * cell + 1e-9
    removed = 18.5 * 2 * 18_000 * 1e-2 * cell
    assert worn.area == pytest.approx(2.9e-8 * removed, rel=1e-9)
    assert cut.area == pytest.approx(1.9e-8 * removed, rel=1e-9)


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
