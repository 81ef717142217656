"""A run from study to folder: what it writes, what it refuses, what it leaves alone."""

import csv
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import warpwear
from warpwear import InputError, Result, Study
from warpwear.engine.executor import Executor
from warpwear.history.quantities import columns_of
from warpwear.models.rest.local import OneScaleModel
from warpwear.surfaces.made.self_affine import SelfAffine

COLUMNS = columns_of(Study.load("v3-fine"))
QUICK = {
    **{"grid.cell": "20 um", "sliding.distance": "30 mm", "output.snapshots": ["3 mm"]},
    "output.precision": "double",
}


def quick(**changes: Any) -> Study:
    dotted = {k.replace("__", "."): v for k, v in changes.items()}
    return Study.load("v3-fine").replace(QUICK | dotted)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of one finished run, without figures: the command line's test has them drawn."""
    out = tmp_path_factory.mktemp("runs") / "quick"
    warpwear.run(quick(), out=out, plots=False).close()
    return out


def test_the_folder_holds_everything(folder: Path) -> None:
    names = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert {"study.toml", "result.h5", "history.csv", "summary.json", "log.txt"} <= names
    assert not [p for p in folder.parent.iterdir() if p.name.startswith(".")]


def test_the_hdf5_file_is_as_documented(folder: Path) -> None:
    with h5py.File(folder / "result.h5") as file:
        assert file.attrs["finished"]
        assert {"version", "study", "device", "precision", "threads"} <= set(file.attrs)
        assert set(file["history"]) == {c.name for c in COLUMNS}
        rows = {d.shape for d in file["history"].values()}
        assert len(rows) == 1
        for column in COLUMNS:
            assert file["history"][column.name].attrs["units"] == column.units
            assert file["history"][column.name].dtype == np.float64
        assert [g.attrs["distance"] for g in file["snapshots"].values()] == [3.0, 30.0]
        for group in file["snapshots"].values():
            fields = {"pressure", "wear_counter", "wear_disc", "gap"}
            assert set(group) == fields | {"x", "y"}
            assert {group[name].shape for name in fields} == {(75, 75)}
            assert all(group[name].compression for name in fields)
            # Shuffled and deflated by this package: what HDF5 reads is what was there.
            assert group["gap"].shuffle
            assert np.count_nonzero(group["pressure"]) > 0
            assert group["x"] == file["grid/x"]  # one dataset under two names
        assert file["grid/x"].shape == file["grid/y"].shape == (75,)


def test_snapshots_are_the_same_with_threads_without_and_in_memory(tmp_path: Path) -> None:
    """Blocks at the edges of 300 cells are filled up; those of zeros are not stored."""
    study = quick(grid__cell="5 um", grid__extent="1.5 mm", sliding__distance="0.1 mm")
    with warpwear.run(study) as in_memory:
        for threads in (1, 2):
            with warpwear.run(study, out=tmp_path / str(threads), threads=threads, plots=False) as result:
                for snapshot, other in zip(result.snapshots, in_memory.snapshots, strict=True):
                    for name, values in snapshot.fields.items():
                        assert np.array_equal(values, other.fields[name]), name
                assert snapshot.pressure.any()
                assert snapshot.gap.shape == (300, 300)


def test_snapshots_in_memory_are_copies_until_they_are_closed() -> None:
    with warpwear.run(quick()) as result:
        kept = result.snapshots[-1].pressure.copy()
        result.snapshots[-1].pressure[:] = -1.0
        assert np.array_equal(result.snapshots[-1].pressure, kept)
    with pytest.raises(InputError, match="closed"):
        _ = result.snapshots[-1]


def test_a_random_surface_is_made_once_for_runs_on_the_same_cells(watch: Callable[..., None]) -> None:
    made: list[int] = []
    watch(SelfAffine, "heights", lambda surface, *_: made.append(surface.seed))
    study = quick(disc__synthetic__seed=71)
    first, again = (warpwear.run(study) for _ in range(2))
    assert made == [71]
    assert first.record["surface"] == again.record["surface"]
    assert np.array_equal(first.snapshots[-1].gap, again.snapshots[-1].gap)
    for other in ({"disc.synthetic.seed": 72}, {"grid.extent": "1.48 mm"}, {"disc.synthetic.hurst": 0.7}):
        study = study.replace(other)
        assert warpwear.run(study).record["surface"] != first.record["surface"]
    assert made == [71, 72, 72, 72]


def test_a_run_tells_its_seconds(tmp_path: Path) -> None:
    with warpwear.run(quick(sliding__distance="0.1 mm"), out=tmp_path / "out", plots=False) as result:
        told = json.loads((tmp_path / "out" / "summary.json").read_text())["seconds"]
        assert told == result.seconds == result.summary["seconds"]
    assert list(told) == ["load", "compile", "solve", "write", "draw"]
    assert min(told["load"], told["solve"], told["write"]) > 0.0 == told["draw"]


def test_the_tables_agree_with_the_result(folder: Path) -> None:
    with Result.open(folder) as result, (folder / "history.csv").open() as file:
        header, *rows = csv.reader(file)
        assert header == [f"{c.name} [{c.units}]" for c in COLUMNS]
        table = np.array(rows, dtype=float)
        for i, column in enumerate(COLUMNS):
            np.testing.assert_allclose(table[:, i], result.history[column.name], rtol=1e-11)
        summary = json.loads((folder / "summary.json").read_text())
        assert summary["area_mm2"]["contact"] == result.history["area_contact"][-1]
        assert summary["finished"] is True
        assert summary["assumptions"]["contact.hardness"].startswith("not in the thesis")
        assert max(map(abs, summary["conservation_relative"].values())) < 1e-10
        assert summary["load_residual_N"]["largest"] < 1e-12 * 8.0
        assert summary["assumptions"]["contact.stiffness"]  # a default that is a choice
        assert summary["surface"]["kind"] == "self-affine"
        on_the_grid = summary["surface"]["on_the_grid"]
        last = result.snapshot(-1)
        x, y = np.meshgrid(result.x, result.y, indexing="ij")
        disc = 3.0 - np.sqrt(9.0 - x**2 - y**2) + last.wear_counter + last.wear_disc - last.gap
        assert on_the_grid["sq_um"] == pytest.approx(1e3 * disc.std(), rel=1e-9)
        assert 0.1 < on_the_grid["rms_slope"] < 0.4


def test_snapshots_and_history_describe_one_state(folder: Path) -> None:
    with Result.open(folder / "result.h5") as result:
        last, history = result.snapshot(-1), {k: v[-1] for k, v in result.history.items()}
        area = result.study.cells.cell_area
        contact = last.pressure > 0.0
        assert contact.sum() * area == pytest.approx(history["area_contact"])
        assert last.pressure.sum() * area == pytest.approx(8.0, rel=1e-12)
        assert last.pressure[contact].mean() == pytest.approx(history["pressure_mean"])
        assert last.pressure[contact].std() == pytest.approx(history["pressure_std"])
        assert last.pressure.max() == history["pressure_max"]
        for body in ("counter", "disc"):
            wear = getattr(last, f"wear_{body}")
            assert wear.max() == history[f"wear_depth_{body}"]
            assert wear.sum() * area == pytest.approx(history[f"wear_volume_{body}"])
        touched = last.wear_counter > 0.0
        assert touched.sum() * area == pytest.approx(history["area_touched"])
        rows, columns = np.flatnonzero(touched.any(axis=1)), np.flatnonzero(touched.any(axis=0))
        cell = result.study.grid.cell
        assert (rows[-1] - rows[0] + 1) * cell == pytest.approx(history["patch_along"])
        assert (columns[-1] - columns[0] + 1) * cell == pytest.approx(history["patch_across"])
        nominal = np.pi / 4.0 * history["patch_along"] * history["patch_across"]
        assert history["area_nominal"] == pytest.approx(nominal)
        assert history["time"] == pytest.approx(30.0 / (20.0 / 60.0))


def test_a_run_folder_is_a_study_again(folder: Path) -> None:
    assert Study.load(folder) == Study.load(folder / "study.toml")
    with Result.open(folder) as result:
        again = warpwear.run(result.study)
        for name in ("approach", "area_contact", "wear_volume_disc", "cof"):
            np.testing.assert_array_equal(again.history[name], result.history[name])


def test_a_static_contact_has_one_row(tmp_path: Path, quick_pictures: Any) -> None:
    with quick_pictures():
        result = warpwear.run(quick(sliding__distance="0 mm"), out=tmp_path / "static")
    history = result.history
    assert history["distance"].tolist() == [0.0]
    assert history["wear_volume_disc"].tolist() == [0.0]
    assert history["area_contact"][0] == pytest.approx(8.0 / 590.0, abs=(20e-3) ** 2)
    assert history["area_touched"][0] == history["area_contact"][0]
    assert result.snapshot_distances.tolist() == [0.0]


def test_a_rigid_flat_has_no_edge() -> None:
    result = warpwear.run(quick(counter__radius="inf mm", sliding__distance="0.3 mm"))
    assert result.history["area_contact"][-1] > 0.0
    assert result.finished


def test_nothing_is_overwritten_silently(tmp_path: Path) -> None:
    out = tmp_path / "out"
    warpwear.run(quick(sliding__distance="0 mm"), out=out, plots=False).close()
    before = (out / "result.h5").read_bytes()
    with pytest.raises(InputError, match=r"already holds a run"):
        warpwear.run(quick(), out=out)
    assert (out / "result.h5").read_bytes() == before
    with warpwear.Result.open(out) as result:
        result.plot.save("pressure_map", out / "figures", file_format="svg")
    (out / "figures" / "pressure_map.tex").write_text("mine")
    (out / "notes.txt").write_text("mine")
    warpwear.run(quick(), out=out, plots=False, overwrite=True).close()
    assert (out / "result.h5").read_bytes() != before
    assert (out / "notes.txt").read_text() == "mine"
    assert not (out / "figures" / "pressure_map.svg").exists()  # it would show the run that is gone
    assert (out / "figures" / "pressure_map.tex").read_text() == "mine"
    foreign = tmp_path / "mine"
    foreign.mkdir()
    (foreign / "thesis.doc").touch()
    for overwrite in (False, True):
        with pytest.raises(InputError, match="holds other files"):
            warpwear.run(quick(), out=foreign, overwrite=overwrite)
    for inside in ("thesis.doc", "thesis.doc/run"):
        with pytest.raises(InputError, match=r"thesis\.doc is a file"):
            warpwear.run(quick(), out=foreign / inside)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"grid.extent": "0.4 mm"}, r"grid\.extent = 0\.4 mm is too small: the worn patch will be 0\.42. mm"),
        (
            {"grid.cell": "50 nm"},
            r"grid\.cell = 0\.05 µm makes .* need .* GiB of memory; the host has 8\.0 GiB free",
        ),
        ({"disc.surface": "nowhere.sur"}, r"disc\.surface"),
        (
            {"disc.synthetic.cut_off": "200 um"},
            r"disc\.synthetic\.roll_off is 0\.1 mm: allowed is more than cut_off",
        ),
    ],
)
def test_what_cannot_be_computed_leaves_nothing_behind(
    tmp_path: Path, host_with: Callable[[float], None], changes: dict[str, Any], message: str
) -> None:
    # a host with more memory would make these cells, for minutes
    host_with(8 * 2**30)
    with pytest.raises(InputError, match=message):
        warpwear.run(quick().replace(changes), out=tmp_path / "new" / "out")
    assert list(tmp_path.iterdir()) == []


def test_the_edge_can_be_overruled_and_is_recorded() -> None:
    result = warpwear.run(quick(grid__extent="0.4 mm", checks__strict=False))
    warnings = [w for w in result.summary["warnings"] if "domain's edge" in w]
    assert len(warnings) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"device": "cuda:9"}, r"device = 'cuda:9' is not there; this machine has cpu"),
        ({"device": "gpu"}, r"device = 'gpu' is not there"),
        ({"threads": 0}, r"threads = 0 is not possible"),
        ({"threads": 10_000}, r"threads = 10000 is not possible; allowed are 1 to \d+"),
    ],
)
def test_a_device_that_is_not_there(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        warpwear.run(quick(), **arguments)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="cannot be written"):
        warpwear.run(quick(), out=tmp_path / "out")


def test_an_interrupted_run_keeps_what_it_has(tmp_path: Path) -> None:
    def interrupted(step: warpwear.RunStep) -> None:
        if step.index == 99:
            raise KeyboardInterrupt

    study = quick(friction__coefficient=0.6, friction__calibrate="end")
    with pytest.raises(KeyboardInterrupt):
        warpwear.run(study, out=tmp_path / "deep" / "out", plots=False, callback=interrupted)
    with Result.open(tmp_path / "deep" / "out") as result:
        assert not result.finished
        assert np.isnan(result.history["cof"]).all()  # τ0 waits for the end of the test
        assert result.history["distance"].size == 100
        assert result.summary["cof_shape"] is None
        assert result.summary["area_shape"] is not None
        assert "interrupted" in repr(result)


def test_results_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no result"):
        Result.open(tmp_path)
    (tmp_path / "result.h5").write_bytes(b"nothing")
    with pytest.raises(InputError, match="no HDF5 file"):
        Result.open(tmp_path)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["a"] = 1
    with pytest.raises(InputError, match="not a result of warpwear"):
        Result.open(tmp_path / "other.h5")


def test_an_absurd_coefficient_and_a_contact_of_few_cells_are_told() -> None:
    absurd = warpwear.run(quick(friction__area="cumulative"))
    assert any("which no contact has" in warning for warning in absurd.summary["warnings"])
    coarse = warpwear.run(quick(contact__load="0.5 N"))
    assert any("cells are in contact" in warning for warning in coarse.summary["warnings"])
    fine = warpwear.run(quick(contact__load="30 N"))
    assert not [w for w in fine.summary["warnings"] if "cells are in contact" in w or "no contact has" in w]


def test_a_preset_runs_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(quick(sliding__distance="0 mm").to_toml())
    assert warpwear.run(tmp_path).finished
    with pytest.raises(InputError, match="is no file, no run folder and no preset"):
        Study.load(tmp_path.parent)


def test_a_smooth_wear_rate_that_is_very_low_still_balances() -> None:
    # Steps of picometres and less: the approach needs more digits than it has from the lowest gap.
    low = {"wear.counter": "1e-8 mm^3/N/m", "wear.disc": "1e-8 mm^3/N/m"}
    for kind in ("flat", "self-affine"):
        result = warpwear.run(quick().replace(low | {"disc.synthetic.kind": kind}))
        assert np.abs(result.history["load_residual"]).max() < 1e-12 * 8.0
        assert max(map(abs, result.summary["conservation_relative"].values())) < 1e-10


def test_no_hardness_is_no_number_in_the_summary(tmp_path: Path) -> None:
    with warpwear.run(quick(contact__hardness="inf MPa"), out=tmp_path / "out", plots=False) as result:
        assert result.summary["hardness_MPa"] is None
        assert "hardness" not in result.summary["shear_strength_MPa_for_reference"]
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["hardness_MPa"] is None


def test_hertz_is_told_when_the_bodies_are_known() -> None:
    steel = {"young": "193 GPa", "poisson": 0.29}
    alloy = {"young": "200 GPa", "poisson": 0.29}
    hertz = warpwear.run(quick(sliding__distance="0 mm").replace(disc=steel, counter=alloy)).summary["hertz"]
    assert hertz["effective_modulus_MPa"] == pytest.approx(1.072e5, rel=1e-3)
    assert hertz["radius_um"] == pytest.approx(55.16, rel=1e-3)
    assert hertz["peak_pressure_MPa"] == pytest.approx(1255.0, rel=1e-3)
    assert hertz["approach_um"] == pytest.approx(1.0143, rel=1e-3)
    assert hertz["area_mm2"] == pytest.approx(0.00956, rel=1e-3)


def test_a_counter_that_is_worn_away_is_no_result() -> None:
    tiny = {"counter.radius": "0.1 mm", "grid.extent": "0.4 mm", "disc.synthetic.kind": "flat"}
    with pytest.raises(InputError, match=r"counter\.radius = 0\.1 mm is too small: .*the counter-body's rim"):
        warpwear.run(quick(grid__cell="5 um").replace(tiny | {"sliding.distance": "2400 mm"}))


@pytest.mark.parametrize(
    "side", [(0, 12), (24, 12), (12, 0), (12, 24)], ids=["x low", "x high", "y low", "y high"]
)
def test_the_edge_is_watched_on_every_side(side: tuple[int, int]) -> None:
    study = quick(grid__extent="0.5 mm", sliding__distance="0.003 mm")
    heights = np.zeros(study.cells.shape)
    with Executor(study.cells, threads=1) as executor:
        for place, expected in (((12, 12), False), (side, True)):
            peaks = heights.copy()
            peaks[place] = 1.0  # far above the counter-body's sag
            peaks[12, 12] = max(peaks[12, 12], 0.9999)
            one_cell = study.replace({"contact.load": "0.3 N"})
            step = OneScaleModel(one_cell.contact_task, peaks, executor).advance(0.003)
            assert step.touches_edge is expected


def test_the_log_says_what_ran(folder: Path) -> None:
    log = (folder / "log.txt").read_text()
    assert warpwear.__version__ in log
    assert "finished: 268 steps" in log


def test_a_result_that_is_none_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "result.h5").write_text("mine")
    with pytest.raises(InputError, match="holds other files"):
        warpwear.run(quick(), out=tmp_path, overwrite=True)
    assert (tmp_path / "result.h5").read_text() == "mine"


def test_an_empty_folder_is_used_as_it_is(tmp_path: Path) -> None:
    # It may be a mount point, which cannot be replaced by another folder.
    before = tmp_path.stat().st_ino
    warpwear.run(quick(sliding__distance="0 mm"), out=tmp_path, plots=False).close()
    assert tmp_path.stat().st_ino == before
    assert (tmp_path / "result.h5").is_file()
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_a_full_disk_is_one_sentence_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import shutil
    from collections import namedtuple

    usage = namedtuple("usage", "total used free")
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage(2**30, 2**30 - 2**21 - 4096, 2**21 + 4096))
    with pytest.raises(InputError, match=r"could not be written and holds no run: 2 MiB are needed, 2 MiB"):
        warpwear.run(quick(), out=tmp_path / "out", plots=False)
    assert list(tmp_path.iterdir()) == []
