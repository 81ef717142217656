"""Two published tests with measured profiles: a block on a ring, and a cylinder that frets on a flat.

Cruzado et al., Rev. Metalurgia 46 (2010) 106; McColl, Ding and Leen, Wear 256 (2004) 1114. Their wear
coefficients were fitted to the worn volume, so depth, width and shape are tested, not volume.
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import warpwear
from warpwear import Result, Study

FILES = Path(__file__).parents[2] / "docs" / "files" / "published"


class Section(NamedTuple):
    """A worn section of a body: depth [mm], area [mm²], and the width where it is worn [mm]."""

    depth: float
    area: float
    width: float


def study_of(name: str, **changes: str) -> Study:
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


def test_a_block_on_a_ring() -> None:
    """Depth within 0.2 % of the rigid form's 44.06 µm; width and area within 1 %."""
    study = study_of("cruzado2010")
    expected = rigid(20.0, 2.0e-9 * study.contact.load / study.cells.ny / 0.02 * 3.6e6)
    assert expected.depth == pytest.approx(44.064e-3, rel=1e-4)
    with warpwear.run(study) as result:
        block = section(result, "disc")
    assert block.depth == pytest.approx(expected.depth, rel=2e-3)
    assert block.area == pytest.approx(expected.area, rel=1e-9)
    assert block.width == pytest.approx(expected.width, rel=1e-2)


@pytest.mark.parametrize(("stroke", "flat", "cylinder", "width"), [("50 um", 2.761, 2.067, 0.515)])
def test_a_cylinder_that_frets(stroke: str, flat: float, cylinder: float, width: float) -> None:
    """Both depths [µm] and the width [mm] of a plane half-plane reference at jumps of 100 cycles."""
    with warpwear.run(study_of("mccoll2004", sliding__stroke=stroke)) as result:
        worn, cut = section(result, "disc"), section(result, "counter")
    assert 1e3 * worn.depth == pytest.approx(flat, rel=0.01)
    assert 1e3 * cut.depth == pytest.approx(cylinder, rel=0.015)
    assert abs(worn.width - width) <= 2.0 * 0.005 + 1e-9
    removed = 18.5 * 18000 * 2 * float(result.study.sliding.stroke or math.nan)
    assert worn.area == pytest.approx(2.9e-8 * removed, rel=1e-9)
    assert cut.area == pytest.approx(1.9e-8 * removed, rel=1e-9)
