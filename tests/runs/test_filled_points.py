"""What rests on points that were not measured is told of every run, and stops one that rests on many."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_track import small as on_track

import warpwear
from warpwear import Result, Study, StudyWarning
from warpwear.errors import InputError, InvariantError
from warpwear.history.snapshot import Snapshot
from warpwear.study.surface import surface_of
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.sphere import places

AT_REST = {"grid.cell": "20 um", "sliding.distance": "3 mm", "output.snapshots": ["1 mm"]}
CELL = 0.02


def study_of(folder: Path, hole: int, *, track: bool = False, **changes: Any) -> Study:
    """A study on a rough file, whose middle lacks a square of `hole` points of 20 µm."""
    points = places((101, 101), (CELL, CELL))
    heights = 1e3 * SelfAffine(ra=0.003, period=2.02).heights(*points)
    heights[50 : 50 + hole, 50 : 50 + hole] = np.nan
    np.save(folder / "disc.npy", heights)
    file = {"disc.surface": str(folder / "disc.npy"), "disc.pixel": "20 um", "disc.height_unit": "um"}
    file |= {"disc.extend": "periodic"} | {k.replace("__", "."): v for k, v in changes.items()}
    return (on_track("full") if track else Study.load("v3-fine").replace(AT_REST)).replace(file)


def shares(result: Result, study: Study, hole: int) -> list[float]:
    """By the fields: at rest of the load of the step, on a track of the disc's wear."""
    half = study.track.x if study.is_swept else study.cells.x
    rows, columns = ((x / CELL + 50).round().astype(int) % 101 for x in (half, study.cells.y))
    inside = [(place >= 50) & (place < 50 + hole) for place in (rows, columns)]
    where = np.logical_and.outer(*inside)
    fields = [s.wear_disc if study.is_swept else s.pressure for s in result.snapshots]
    return [100.0 * float(field[where].sum() / field.sum()) for field in fields]


@pytest.mark.parametrize("track", [False, True])
@pytest.mark.filterwarnings("ignore::warpwear.StudyWarning")
def test_a_run_tells_its_share_on_filled_points(tmp_path: Path, track: bool) -> None:
    study = study_of(tmp_path, 2, track=track, checks__strict=False)
    result = warpwear.run(study, out=tmp_path / "run", plots=False)
    expected = shares(result, study, 2)
    found = result.summary["load_on_filled_percent"]
    assert 0.0 < found["largest"] < 50.0
    assert found == pytest.approx({"end": expected[-1], "largest": max(expected)})
    assert [100.0 * s.load_on_filled for s in result.snapshots] == pytest.approx(expected)


@pytest.mark.parametrize("track", [False, True])
@pytest.mark.filterwarnings("ignore::warpwear.StudyWarning")
def test_a_measured_surface_that_is_given_is_as_a_file(tmp_path: Path, track: bool) -> None:
    study = study_of(tmp_path, 2, track=track, checks__strict=False)
    of_file = warpwear.run(study)
    surface = surface_of(study.disc)
    given = warpwear.run(study, surface=surface, out=tmp_path / "run", plots=False)
    expected = of_file.summary["load_on_filled_percent"]
    assert given.summary["load_on_filled_percent"] == pytest.approx(expected, rel=1e-9)
    assert given.record["surface"]["filled_percent"] > 0.0
    np.testing.assert_allclose(given.history["area_contact"], of_file.history["area_contact"], rtol=1e-9)
    with pytest.raises(InvariantError, match=r"of the load after .* rests on points"):
        warpwear.run(study_of(tmp_path, 12, track=track), surface=surface_of(study.disc))


def test_what_was_measured_nowhere_is_refused(tmp_path: Path) -> None:
    study = study_of(tmp_path, 0, grid__extent="0.6 mm")
    heights = np.load(tmp_path / "disc.npy")
    heights[25:75, 25:75] = np.nan
    np.save(tmp_path / "disc.npy", heights)
    with pytest.raises(InputError, match=r"was measured nowhere in the domain.*disc\.crop"):
        warpwear.run(study)


def test_a_whole_file_says_nothing_of_it(tmp_path: Path) -> None:
    result = warpwear.run(study_of(tmp_path, 0))
    assert "load_on_filled_percent" not in result.summary
    assert result.snapshots[-1].load_on_filled is None


@pytest.mark.filterwarnings("ignore::warpwear.StudyWarning")
@pytest.mark.parametrize("track", [False, True])
def test_more_than_five_percent_stops_the_run(tmp_path: Path, track: bool) -> None:
    study = study_of(tmp_path, 12, track=track)
    says = r"% of the load after .* mm of sliding rests on points that disc\.surface lacks .* 5 % is allowed"
    with pytest.raises(InvariantError, match=says):
        warpwear.run(study, out=tmp_path / "run", plots=False)
    stopped = Result.open(tmp_path / "run")
    assert not stopped.finished
    assert stopped.history["distance"].size in (1, 2, 4, 8, 16, 32, 64, 128)  # the steps that are looked at
    loose = study.replace({"checks.strict": False})
    resumed = warpwear.run(loose, out=tmp_path / "run", plots=False, resume=True)
    assert resumed.finished
    assert sum("disc.surface lacks" in text for text in resumed.summary["warnings"]) == 1
    with pytest.warns(StudyWarning, match=says):
        whole = warpwear.run(loose, plots=False)
    assert resumed.summary["load_on_filled_percent"] == whole.summary["load_on_filled_percent"]
    for name in whole.history:
        np.testing.assert_array_equal(resumed.history[name], whole.history[name])


def test_looking_changes_no_number(tmp_path: Path) -> None:
    study = study_of(tmp_path, 1, checks__strict=False)
    looked = warpwear.run(study)
    heights = surface_of(study.disc).heights(study.cells.x, study.cells.y)  # all of them measured
    given = warpwear.run(study, surface=heights)
    for name in ("area_contact", "pressure_max", "wear_depth_disc"):
        np.testing.assert_allclose(looked.history[name], given.history[name], rtol=1e-12)


def test_a_share_is_of_the_load(tmp_path: Path) -> None:
    pressure = np.array([[1.0, 0.0], [2.0, 1.0]])
    filled = np.array([[False, True], [True, False]])
    fields = {"wear_counter": pressure, "gap": pressure}
    assert Snapshot(1.0, pressure, wear_disc=pressure, **fields).share_on(filled) == 0.5
    # on a track: the wear of all its rows, or what lies under the counter-body where the disc does not wear
    track = np.array([[False, False], [True, True], [False, False], [False, True]])
    worn = np.arange(8.0).reshape(4, 2)
    assert Snapshot(1.0, pressure, wear_disc=worn, row=3, **fields).share_on(track) == 12.0 / 28.0
    unworn = Snapshot(1.0, pressure, wear_disc=0.0 * worn, row=3, **fields)
    assert unworn.share_on(track) == 0.0
    assert unworn.share_on(~track) == 1.0
