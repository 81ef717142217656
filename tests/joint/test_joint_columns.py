"""Columns of a run that output.joint asks for."""

import pytest

import warpwear
from warpwear.errors import InputError

pytestmark = pytest.mark.transforms

SMOOTH = {
    "disc.synthetic": {"kind": "flat"},
    "contact.law": "half-space",
    "contact.hardness": "inf MPa",
    "grid.cell": "4 um",
    "grid.extent": "0.2 mm",
    "output.snapshots": ["0.001 mm"],
    "sliding.distance": "0.002 mm",
    "wear.counter": "1e-9 mm^3/N/m",
    "wear.disc": "1e-9 mm^3/N/m",
}


def test_a_run_has_the_columns_that_it_asks_for() -> None:
    """Of a smooth ball the contact conducts 2a of Hertz, and its stiffness is that times E*."""
    study = warpwear.Study.load("v3-fine").replace(SMOOTH | {"output.joint": ["stiffness", "conductance"]})
    result = warpwear.run(study)
    table, hertz = result.surface_evolution.table, study.pair.hertz
    assert hertz is not None
    assert table["conductance_length"] == pytest.approx([2.0 * hertz.radius] * 2, rel=0.02)
    assert table["stiffness_loading"] == pytest.approx(hertz.modulus * table["conductance_length"])
    assert table["stiffness_unloading"].tolist() == table["stiffness_loading"].tolist()


def test_a_material_has_what_conducts() -> None:
    half_space = {"contact.law": "half-space"}
    study = warpwear.Study.load("v3-fine").replace(half_space | {"output.joint": ["conductance"]})
    assert study.disc.conductivity == 16.2
    assert "disc.conductivity" in study.assumptions
    plain = warpwear.Study.load("v3-fine")
    assert "disc.resistivity" in plain.unused_keys
    with pytest.raises(InputError, match=r"output.joint = conductance needs contact.law = "):
        warpwear.Study.load("v1").replace({"output.joint": ["conductance"]})
