"""Columns of a run that output.joint asks for."""

import numpy as np
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
    metals = {"counter.conductivity": "20 W/m/K", "disc.conductivity": "60 W/m/K"}
    metals |= {"counter.resistivity": "1e-6 ohm*m", "disc.resistivity": "3e-7 ohm*m"}
    asked = {"output.joint": ["stiffness", "conductance"]}
    study = warpwear.Study.load("v3-fine").replace(SMOOTH | metals | asked)
    result = warpwear.run(study)
    table, hertz = result.surface_evolution.table, study.pair.hertz
    assert hertz is not None
    assert table["conductance_length"] == pytest.approx([2.0 * hertz.radius] * 2, rel=0.02)
    assert table["stiffness_loading"] == pytest.approx(hertz.modulus * table["conductance_length"])
    assert table["conductance_heat"] == pytest.approx(2e-3 * table["conductance_length"] / (1 / 20 + 1 / 60))
    assert table["conductance_charge"] == pytest.approx(table["conductance_length"] / (500 * (1e-6 + 3e-7)))
    assert table["stiffness_unloading"].tolist() == table["stiffness_loading"].tolist()


SEAL = {
    "counter.radius": "inf mm",
    "disc.synthetic.ra": "0.3 um",
    "disc.synthetic.roll_off": "50 um",
    "disc.synthetic.cut_off": "8 um",
    "disc.synthetic.period": "0.128 mm",
    "contact.law": "half-space",
    "contact.load": "0.8 N",
    "grid.cell": "2 um",
    "grid.extent": "0.128 mm",
    "output.snapshots": ["0.001 mm"],
    "sliding.distance": "0.002 mm",
    "sliding.speed": "100 mm/s",
    "wear.counter": "1e-9 mm^3/N/m",
    "wear.disc": "1e-9 mm^3/N/m",
    "friction.coefficient": 0.6,
    "friction.calibrate": "end",
    "output.joint": ["flow", "flash"],
}


def test_what_flows_and_how_hot_it_gets(two_threads: int) -> None:
    """As a contact of the disc's heights says, and as the summary does; by one thread and by two."""
    study = warpwear.Study.load("v3-fine").replace(SEAL)
    result, other = (warpwear.run(study, threads=threads) for threads in (1, two_threads))
    table, cells = result.surface_evolution.table, study.cells
    for name in ("flow_along", "flow_across", "flow_shear", "flash_max", "flash_mean"):
        assert table[name].tolist() == other.surface_evolution.table[name].tolist()
    contact = warpwear.solve_contact(
        result.unworn_disc(cells.x, cells.y), cell=cells.cell, load=0.8,
        modulus=study.pair.effective_modulus, hardness=study.hardness, boundary="periodic",
    )  # fmt: skip
    factors = contact.flow_factors()
    assert table["flow_along"] == pytest.approx([factors.along] * 2, rel=1e-3)
    assert table["flow_across"] == pytest.approx([factors.across] * 2, rel=1e-3)
    assert table["flow_shear"] == pytest.approx([factors.shear] * 2, rel=1e-3)
    assert table["flash_max"][-1] == pytest.approx(result.summary["flash_K"]["largest"])
    assert table["flash_mean"][-1] == pytest.approx(result.summary["flash_K"]["mean"])
    assert not result.surface_evolution.warnings


def test_what_a_block_slides_at_decides_how_hot_it_gets() -> None:
    """Twice as fast it is nearly twice as hot, where that is slow; without a speed it is not known."""
    blocks = [{"distance": "0.001 mm", "speed": speed} for speed in ("10 mm/s", "20 mm/s")]
    study = warpwear.Study.load("v3-fine").replace(SEAL)
    programme = {"block": blocks, "sliding.distance": None, "sliding.speed": None}
    hot = warpwear.run(study.replace(programme)).surface_evolution.table["flash_max"]
    assert hot[1] == pytest.approx(2.0 * hot[0], rel=0.02)
    unknown = warpwear.run(study.replace({"sliding.speed": None}))
    assert np.isnan(unknown.surface_evolution.table["flash_mean"]).all()


def test_cells_that_are_too_coarse_are_told() -> None:
    few = SEAL | {"contact.load": "0.02 N", "disc.synthetic.cut_off": "4 um", "disc.synthetic.seed": 0}
    few |= {"output.joint": ["conductance", "flow"]}
    result = warpwear.run(warpwear.Study.load("v3-fine").replace(few))
    told = [text for text in result.summary["warnings"] if text.startswith("output.joint: ")]
    assert any("half of the spots in contact are of fewer than 3 cells" in text for text in told)
    assert any("the gap has waves of fewer than 4 cells" in text for text in told)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"contact.law": "half-space"}, "flow needs contact.boundary = 'periodic', not 'free'"),
        (
            {"contact.law": "half-space", "contact.boundary": "line", "counter.shape": "cylinder"},
            "flow needs contact.boundary = 'periodic', not 'line'",
        ),
        (
            {
                "contact.law": "half-space",
                "contact.boundary": "line",
                "counter.shape": "cylinder",
                "output.joint": ["flash"],
            },
            "output.joint = flash needs a contact of limited extent",
        ),
        ({}, "output.joint = flow needs contact.law = 'half-space', not 'local'"),
        ({"output.joint": ["heat"]}, "output.joint"),
    ],
)
def test_what_cannot_flow_is_refused(changes: dict[str, str], sentence: str) -> None:
    with pytest.raises(InputError) as refused:
        warpwear.Study.load("v3-fine").replace({"output.joint": ["flow"]} | changes)
    assert sentence in str(refused.value)


def test_a_material_has_what_conducts() -> None:
    """Its constants of heat are assumed where a column goes by them."""
    half_space = {"contact.law": "half-space"}
    study = warpwear.Study.load("v3-fine").replace(half_space | {"output.joint": ["flash"]})
    assert study.disc.conductivity == 16.2
    assert "disc.conductivity" in study.assumptions
    plain = warpwear.Study.load("v3-fine")
    assert plain.disc.conductivity == 16.2
    assert not {"disc.conductivity", "disc.density"} & ({*plain.assumptions} | {*plain.used_keys})
    assert "disc.conductivity" in plain.replace({"disc.conductivity": "15 W/m/K"}).used_keys
    assert "disc.resistivity" in plain.unused_keys
    with pytest.raises(InputError, match=r"output.joint = conductance needs contact.law = "):
        warpwear.Study.load("v1").replace({"output.joint": ["conductance"]})
