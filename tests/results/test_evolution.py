"""Roughness and islands against the distance slid."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cases_track import small
from numpy.testing import assert_allclose, assert_array_equal
from scipy import ndimage

import warpwear
from warpwear import Result, Study
from warpwear.history.quantities import evolution_columns
from warpwear.laws.courses import Settling
from warpwear.results import evolution, summary_models
from warpwear.results.evolution import (
    inner_scar,
    settling,
    settling_course,
    surface_evolution,
)
from warpwear.results.formats.bodies import worn_heights


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
    assert list(found.table) == [column.name for column in evolution_columns(result.study)]
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
    counter, disc = study.wear_coefficients
    snapshot = worn.snapshot(-1)
    before = worn_heights(worn, snapshot, "disc") + snapshot.wear_disc
    share = surface_evolution(worn).table["sq"][-1] / (1e3 * before[snapshot.touched].std())
    assert share == pytest.approx(counter / (counter + disc), rel=0.08)


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
    # What is left of the counter-body's form under a paraboloid, and the step at the scar's edge.
    assert table["sq"][0] < 0.2


def test_both_bodies_in_the_inner_scar(result: Result) -> None:
    """Bodies that conform are rough alike; their courses are those of the table, from before wear on."""
    table = surface_evolution(result).table
    assert_allclose(table["sq_counter"][-1], table["sq_disc"][-1], rtol=0.01)
    assert table["sq_counter"][0] < 0.2 < 2.0 < table["sq_disc"][0] <= table["sq_disc_unworn"][0]
    assert np.all(table["sq_disc"][1:] < table["sq_disc_unworn"][1:])
    assert_allclose(table["sdq_counter"][-1], table["sdq_disc"][-1], rtol=0.01)
    slid, course = settling_course(result, "counter")
    assert_array_equal(slid, [0.0, *table["distance"]])
    assert_array_equal(course, [0.0, *table["sq_counter"]])
    _, course = settling_course(result, "disc")
    assert course[0] == table["sq_disc_unworn"][-1]
    assert course[-1] == pytest.approx(table["sq_disc"][-1])
    assert "5 places, where 6 are needed" in str(settling(result, "disc"))
    assert result.summary["inner_scar"]["disc"]["settling"] is None
    assert result.summary["inner_scar"]["counter"]["sq_um"] == table["sq_counter"][-1]


def test_unworn_heights_of_a_track_are_those_of_its_surface() -> None:
    """At places along the track, of the columns under the inner scar, worn and unworn."""
    worn = warpwear.run(
        small("representative", grid__cell="10 um", sliding__shift=8, output__snapshots=["3 mm"])
    )
    snapshot, last = worn.snapshot(-1), len(worn.snapshots) - 1
    before = inner_scar(worn, last, snapshot, "disc", unworn=True)
    after = inner_scar(worn, last, snapshot, "disc")
    assert len(before) == len(after) > 1
    whole = worn.track_heights()
    columns = before[0].shape[1]
    assert any(np.isin(part, whole).all() for part in before)
    assert all(part.shape == before[0].shape for part in (*before, *after))
    lost = np.mean([b - a for b, a in zip(before, after, strict=True)])
    middle = slice(worn.y.size // 2 - columns // 2, worn.y.size // 2 + columns // 2)
    assert lost == pytest.approx(np.add(*worn.track_loss(last))[:, middle].mean(), rel=0.3)


def test_junctions_above_the_pieces_diameter_count() -> None:
    """Where bodies wear in pieces d* is theirs; else that of eq 2.3; without either there is no share."""
    study = Study.load("v3-fine")
    assert study.pair.critical_diameter == study.pair.critical_junction
    assert study.replace({"junctions.surface_energy": None}).pair.critical_diameter is None
    pieces = Study.load("running-in")
    assert pieces.pair.critical_diameter == 0.02 != pieces.pair.critical_junction


def test_the_share_above_is_that_of_the_islands(result: Result) -> None:
    found = surface_evolution(result)
    diameter = result.study.pair.critical_junction
    assert diameter is not None
    for share, areas in zip(found.table["share_above_critical"], found.island_areas, strict=True):
        large = areas > np.pi / 4.0 * diameter**2
        assert share == pytest.approx(areas[large].sum() / areas.sum())
    above = result.summary["junctions"]["share_above"]
    assert above["end"] == found.table["share_above_critical"][-1] > above["first"]


def test_a_run_computes_it_once(tmp_path: Path, watch: Callable[..., None]) -> None:
    """The result in its place knows what was found before it was moved there."""
    made: list[int] = []
    watch(evolution, "_of_snapshot", lambda *given: made.append(given[1]))
    study = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "3 mm"})
    with warpwear.run(study, out=tmp_path / "run", plots=False) as result:
        assert result.surface_evolution.table["distance"].size == len(result.snapshots)
        assert sorted(made) == list(range(len(result.snapshots)))


@pytest.mark.parametrize(("last", "grows"), [(3.34, True), (2.8, False)])
def test_a_way_to_an_equilibrium_has_no_length_where_the_view_changes(last: float, grows: bool) -> None:
    """The unworn disc's roughness in the inner scar says that it is another place."""
    table = {"distance": np.array([0.0, 3.0, 30.0]), "sq_disc_unworn": np.array([2.0, 2.73, last])}
    reason = evolution.growth_of_view(table)
    assert (reason is not None) == grows
    if grows:
        assert "from 2.73 to 3.34 µm" in reason


@pytest.mark.parametrize("reason", ["no length, as the inner scar grows", None])
def test_the_summary_withholds_that_length(
    result: Result, monkeypatch: pytest.MonkeyPatch, reason: str | None
) -> None:
    fit = Settling(1.6, 3.6, 120.0, 0.1, 9.0, 0.05)
    monkeypatch.setattr(summary_models, "settling", lambda *_: fit)
    monkeypatch.setattr(summary_models, "growth_of_view", lambda _: reason)
    numbers = summary_models._inner_scar(result, "disc")
    assert numbers["settling"]["running_in_length_mm"] == (None if reason else 120.0)
    assert numbers["settling"].get("no_length") == reason
