"""Roughness and islands against the distance slid."""

import numpy as np
import pytest
from scipy import ndimage

import warpwear
from warpwear import Result, Study
from warpwear.history.quantities import EVOLUTION
from warpwear.results.evolution import surface_evolution
from warpwear.results.export import worn_heights


@pytest.fixture(scope="module")
def result() -> Result:
    study = Study.load("v3-fine").replace(
        {
            "grid.cell": "5 um",
            "sliding.distance": "240 mm",
            "output.snapshots": ["0.003 mm", "3 mm", "30 mm"],
        }
    )
    return warpwear.run(study)


def test_one_row_a_snapshot(result: Result) -> None:
    found = surface_evolution(result)
    assert list(found.table) == [column.name for column in EVOLUTION]
    assert found.table["distance"].tolist() == [0.003, 3.0, 30.0, 240.0]
    assert all(values.shape == (4,) for values in found.table.values())


def test_islands_add_up_to_the_area_in_contact(result: Result) -> None:
    found = surface_evolution(result)
    for index, areas in enumerate(found.island_areas):
        pressure = result.snapshot(index).pressure
        assert areas.sum() == pytest.approx((pressure > 0.0).sum() * 25e-6)
        assert areas.size == ndimage.label(pressure > 0.0)[1] == found.table["islands"][index]
        assert found.table["island_area_largest"][index] == areas.max()
    # Many asperities grow into one contact.
    assert found.table["islands"][1] > 10.0
    assert found.table["island_area_largest"][-1] > 0.9 * found.island_areas[-1].sum()


def test_wear_takes_the_peaks_off(result: Result) -> None:
    table = surface_evolution(result).table
    # At first the roughness inside the scar is the disc's own: Sq 3.76 µm for Ra 3 µm, less its long waves,
    # which the bowl that is taken off holds. Wear makes it smooth, peaks before valleys.
    assert 2.0 < table["sq"][0] < 4.0
    assert np.all(np.diff(table["sq"][1:]) < 0.0)
    assert table["ssk"][2] < -0.5
    assert abs(table["ssk"][0]) < 0.3
    assert table["spk"][1] < table["spk"][0]
    assert table["svk"][2] / table["spk"][2] > 1.3 * table["svk"][0] / table["spk"][0]


def test_the_rim_does_not_count(result: Result) -> None:
    """Bodies that conform share the roughness as they share the wear: K_s/(K_s + K_d) of it is the disc's.

    The rim of the scar, which was touched here and there, has nearly all of it still.
    """
    study = result.study.replace({"sliding.distance": "600 mm", "output.snapshots": []})
    worn = warpwear.run(study)
    sphere, disc = study.wear_coefficients
    snapshot = worn.snapshot(-1)
    before = worn_heights(worn, snapshot, "disc") + snapshot.wear_disc
    share = surface_evolution(worn).table["sq"][-1] / (1e3 * before[snapshot.touched].std())
    assert share == pytest.approx(sphere / (sphere + disc), rel=0.08)


def test_a_flat_disc_has_no_roughness() -> None:
    study = Study.load("v3-fine").replace(
        {
            "grid.cell": "10 um",
            "sliding.distance": "30 mm",
            "output.snapshots": [],
            "disc.synthetic.kind": "flat",
        }
    )
    table = surface_evolution(warpwear.run(study)).table
    assert table["islands"].tolist() == [1.0]
    # What is left of the sphere's form under a paraboloid, and the step at the scar's edge.
    assert table["sq"][0] < 0.2
