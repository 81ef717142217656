"""Loads far above those of the block before, or near what all cells carry at the hardness, are carried."""

from itertools import product
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from warpwear import InputError, Result, Study, run, solve_contact

#: On a GPU the transforms need their library. Small loads touch few cells.
pytestmark = [pytest.mark.transforms, pytest.mark.filterwarnings("ignore::warpwear.StudyWarning")]

CELL, STEEL = 0.01, {"young": "210 GPa", "poisson": 0.3}  # [mm]
MODULUS = 210e3 / (2.0 * (1.0 - 0.3**2))  # of both bodies [MPa]
ROUGH = {"disc.synthetic": {"kind": "self-affine", "ra": "0.2 um", "roll_off": "100 um", "cut_off": "30 um"}}
LINE = {"counter.shape": "cylinder", "contact.boundary": "line", "grid.extent": ["0.64 mm", "0.08 mm"]}
SWEPT = {"sliding.stroke": "0.5 mm"}
#: What there is beside a ball on a smooth disc, and how long a block is [mm].
KINDS: dict[str, tuple[dict[str, Any], float]] = {
    "rest": ({}, 0.1),
    "rough": (ROUGH, 0.1),
    "oblong": ({"grid.extent": ["0.96 mm", "0.64 mm"]}, 0.1),
    "flat": (ROUGH | {"counter.radius": "inf mm", "contact.boundary": "periodic"}, 0.1),
    "track": (SWEPT, 1.0),
    "fretting": ({"sliding.stroke": "0.1 mm", "sliding.kinematics": "fretting"}, 0.4),
    "line": (LINE, 0.1),
    "line on a track": (LINE | SWEPT, 1.0),
}
LOADS = [(1e-9, 30.0), (0.01, 30.0), (0.1, 20.0), (0.2, 20.0), (0.5, 20.0), (1.0, 20.0), (2.0, 40.0)]
LOADS += [(5.0, 30.0), (30.0, 1e-3), (20.0, 0.5)]
PAIRS = list(product(KINDS, LOADS, (1000.0, 1500.0, 2000.0)))
QUICK_PAIRS = [
    ("rest", (0.2, 20.0), 1000.0),
    ("rough", (1.0, 20.0), 1000.0),
    ("oblong", (0.01, 30.0), 1500.0),
    ("track", (1e-9, 30.0), 2000.0),
    ("fretting", (0.1, 20.0), 1000.0),
    ("line", (0.2, 20.0), 1000.0),
]
#: Radius of a pin's face and of its edge [mm]: sharp, an edge of half a cell, rounded.
PINS = {"sharp": (0.2, 0.0), "half a cell": (0.15, 0.005), "rounded": (0.12, 0.05)}
#: Parts of what all cells of a pin carry.
PARTS = [*np.geomspace(0.005, 0.9, 15).tolist(), 0.95, 0.99, 0.9999, 1.0 - 1e-9, 1.0]
DISCS: dict[str, dict[str, Any]] = {"smooth": {}, "rough": ROUGH}
QUICK_PINS = [*product(PINS, (PARTS[10], PARTS[-2]), ["smooth"]), ("half a cell", 1.0, "rough")]
ALL_PINS = [
    pytest.param(*case, marks=[] if case in QUICK_PINS else [pytest.mark.slow])
    for case in product(PINS, PARTS, DISCS)
]


def study_of(changes: dict[str, Any]) -> Study:
    """Make a study of two bodies of steel and 64 × 64 cells, without snapshots and without wear."""
    study = Study(
        counter=STEEL | {"radius": "5 mm"},
        disc=STEEL | {"synthetic": {"kind": "flat"}},
        contact={"load": "1 N", "law": "half-space", "hardness": "1500 MPa"},
        wear={"counter": "0 mm^3/N/m", "disc": "0 mm^3/N/m"},
        friction={"law": "coulomb", "coefficient": 0.6},
        grid={"cell": f"{CELL} mm", "extent": "0.64 mm"},
        sliding={"distance": "0 mm"},
        output={"snapshots": []},
    )
    return study.replace(changes)


def end_of(result: Result) -> tuple[float, float]:
    """Return area [mm²] and approach [mm] of the last contact, of steps that all carry their loads."""
    assert np.all(np.abs(result.history["load_residual"]) <= 2e-12 * result.history["load"])
    return float(result.history["area_contact"][-1]), float(result.history["approach"][-1])


def blocks(kind: str, loads: tuple[float, ...], hardness: float, **more: str) -> Result:
    """Run blocks of some loads [N]; of a line contact on its width."""
    changes, distance = KINDS[kind]
    of_blocks = [{"load": f"{load} N", "distance": f"{distance} mm"} for load in loads]
    keys = {"contact.hardness": f"{hardness} MPa", "stepping.first": "20 um", "block": of_blocks}
    return run(study_of({"sliding.distance": None, "contact.load": None} | changes | keys | more))


@pytest.mark.parametrize(("kind", "loads", "hardness"), QUICK_PAIRS)
def test_a_larger_load_is_carried_as_if_it_came_first(
    kind: str, loads: tuple[float, float], hardness: float
) -> None:
    with blocks(kind, loads, hardness) as result, blocks(kind, loads[1:], hardness) as alone:
        assert_allclose(end_of(result), end_of(alone), rtol=1e-5)


@pytest.mark.parametrize(("loads", "hardness"), [((0.2, 20.0), 1000.0), ((1e-9, 30.0, 0.1, 60.0), 2000.0)])
def test_a_block_of_a_larger_load_against_one_contact(loads: tuple[float, ...], hardness: float) -> None:
    heights = np.zeros((64, 64))
    options = {"cell": CELL, "modulus": MODULUS, "hardness": hardness, "counter_radius": 5.0}
    contact = solve_contact(heights, load=loads[-1], **options)
    with blocks("rest", loads, hardness) as result:
        assert_allclose(end_of(result), (contact.area, contact.approach), rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "loads", "hardness"), PAIRS)
def test_worn_bodies_carry_a_larger_load(kind: str, loads: tuple[float, float], hardness: float) -> None:
    wear = dict.fromkeys(("wear.counter", "wear.disc"), "1e-6 mm^3/N/m")
    with blocks(kind, loads, hardness, **wear) as result:
        end_of(result)


def pin(shape: str, changes: dict[str, Any]) -> tuple[Study, float]:
    """Make a study of a pin, and return what its cells carry [N] at 1500 MPa, counted by their middles."""
    face, edge = PINS[shape]
    keys = {"counter.shape": "pin", "counter.radius": f"{face} mm", "counter.edge_radius": f"{edge} mm"}
    study = study_of(keys | changes)
    cells = np.hypot.outer(study.cells.x, study.cells.y) <= face + edge
    return study, 1500.0 * CELL**2 * np.count_nonzero(cells)


@pytest.mark.parametrize(("shape", "part", "disc"), ALL_PINS)
def test_a_pin_against_one_contact(shape: str, part: float, disc: str) -> None:
    study, most = pin(shape, DISCS[disc])
    study = study.replace({"contact.load": f"{part * most} N", "output.snapshots": ["0 mm"]})
    with run(study) as result:
        area, approach = end_of(result)
        gap = result.snapshot(-1).gap
    face, edge = PINS[shape]
    form = study.counter.form.heights(study.cells.x, study.cells.y)
    heights = np.where(np.isfinite(form), form - gap, 0.0)
    contact = solve_contact(
        heights,
        cell=CELL,
        load=part * most,
        modulus=MODULUS,
        hardness=1500.0,
        counter={"shape": "pin", "radius": face, "edge_radius": edge},
    )
    # That one counts from the mean plane of what it is given.
    assert_allclose((area, approach), (contact.area, contact.approach - heights.mean()), rtol=1e-4)


@pytest.mark.parametrize("shape", PINS)
def test_more_than_all_cells_of_a_pin_carry_is_refused(shape: str) -> None:
    study, most = pin(shape, {})
    sentence = rf"contact\.load = \S+ N is more than the domain .* carries at this hardness \({most:.6g} N\)"
    with pytest.raises(InputError, match=sentence):
        study.replace({"contact.load": f"{1.00001 * most} N"})
    with pytest.raises(InputError, match="block 2: load = "):
        study.replace(
            {
                "sliding.distance": None,
                "contact.load": None,
                "block": [
                    {"load": "1 N", "distance": "1 mm"},
                    {"load": f"{1.00001 * most} N", "distance": "1 mm"},
                ],
            }
        )
