"""A checkpoint is kept until it is not needed; what cannot be resumed is refused in one sentence."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest
from cases_stopped import differences, killed, run_stopped, short, stop
from numpy.testing import assert_array_equal

import warpwear
from warpwear import InputError, Result, Study
from warpwear.results.seal import HEADER
from warpwear.runs import checkpoint
from warpwear.runs.checkpoint import FILE_NAME
from warpwear.runs.order import RunOrder


def test_without_a_checkpoint_it_starts_from_the_beginning(alone: Path, tmp_path: Path) -> None:
    warpwear.run(short(), out=tmp_path / "out", plots=False, resume=True).close()
    assert differences(alone, tmp_path / "out") == []
    with pytest.raises(InputError, match="resume needs out, a run folder"):
        warpwear.run(short(), resume=True)
    with pytest.raises(InputError, match="excludes overwrite"):
        warpwear.run(short(), out=tmp_path / "out", resume=True, overwrite=True)


def test_a_finished_run_is_left_as_it_is(alone: Path) -> None:
    before = (alone / "result.h5").stat()
    with warpwear.run(short(), out=alone, resume=True) as result:
        assert result.finished
    assert (alone / "result.h5").stat() == before
    with pytest.raises(InputError, match=r"holds a run of another study \(contact\.load\)"):
        warpwear.run(short(contact__load="9 N"), out=alone, resume=True)
    with pytest.raises(InputError, match=r"holds a run of another study \(friction\.shear_strength\)"):
        warpwear.run(short(friction__shear_strength="9 MPa"), out=alone, resume=True)
    warpwear.run(short(run__checkpoint="1 min", study__name="other"), out=alone, resume=True).close()
    with pytest.raises(InputError, match="already holds a run"):
        warpwear.run(short(), out=alone)


def test_what_cannot_be_resumed_is_refused_and_kept(alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_stopped(short(), out, 12)
    path = out / FILE_NAME
    good = path.read_bytes()

    def refused(match: str, study: Study | None = None) -> None:
        left = path.read_bytes()
        with pytest.raises(InputError, match=match) as error:
            warpwear.run(study or short(), out=out, plots=False, resume=True)
        assert "\n" not in str(error.value)
        assert path.read_bytes() == left
        assert [p.name for p in out.iterdir()] == [FILE_NAME]

    changed = short(contact__load="9 N", wear__disc="0 mm^3/N/m")
    refused(r"another study \(contact\.load, wear\.disc\)", changed)
    refused(r"another study \(output\.snapshots\)", short(output__snapshots=["0.1 mm"]))
    with pytest.raises(InputError, match=r"resume it \(--resume, resume=True\), or overwrite it \(--over"):
        warpwear.run(short(), out=out)
    for place in (30, HEADER + 40, len(good) - 1):
        path.write_bytes(good[:place] + bytes([good[place] ^ 1]) + good[place + 1 :])
        refused("is damaged")
    for size in (0, HEADER, len(good) // 2):
        path.write_bytes(good[:size])
        refused("damaged")
    path.write_bytes(good.replace(b"checkpoint %d " % checkpoint.FORMAT, b"checkpoint 99 ", 1))
    refused(rf"another version of warpwear \(format 99, this one reads {checkpoint.FORMAT}\)")
    path.write_bytes(good)
    # What no step depends on may change.
    renamed = short(study__name="other", friction__shear_strength="2 MPa", run__checkpoint="1 min")
    with warpwear.run(renamed, out=out, plots=False, resume=True) as result:
        assert_array_equal(result.history["cof"], 2.0 * result.history["area_contact"] / 8.0)
        assert result.study.study.name == "other"
    assert set(differences(alone, out)) == {"history/cof", "history/friction_energy", "history.csv"}


def test_another_device_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_stopped(short(), out, 2)
    with checkpoint.opened(out / FILE_NAME) as found:
        assert found is not None
        with pytest.raises(InputError, match="which was made on cpu; give that one"):
            found.refuse_changes(RunOrder(short()), device="cuda:0")


def test_overwriting_forgets_the_checkpoint(alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_stopped(short(contact__load="9 N"), out, 12)
    warpwear.run(short(run__checkpoint="inf s"), out=out, plots=False, overwrite=True).close()
    assert differences(alone, out) == []
    assert not (out / FILE_NAME).exists()


def test_a_file_of_that_name_that_is_none_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / FILE_NAME).write_bytes(b"weights of a network")
    for overwrite in (False, True):
        with pytest.raises(InputError, match="holds other files"):
            warpwear.run(short(), out=tmp_path, overwrite=overwrite)
    with pytest.raises(InputError, match="no checkpoint of warpwear or is damaged"):
        warpwear.run(short(), out=tmp_path, resume=True)
    assert (tmp_path / FILE_NAME).read_bytes() == b"weights of a network"


def test_a_full_disk_costs_the_checkpoint_and_not_the_run(
    alone: Path, tmp_path: Path, failing: Callable[[str, Exception], None]
) -> None:
    full = OSError(28, "2 MiB are needed, 0 MiB are free")
    failing("warpwear.runs.checkpoint.require_free_space", full)
    with warpwear.run(short(run__checkpoint="0 s"), out=tmp_path / "out", plots=False) as result:
        told = [w for w in result.record["warnings"] if "checkpoint" in w]
        assert len(told) == 1
        assert "No checkpoint could be written: 2 MiB are needed, 0 MiB are free." in told[0]
    assert differences(alone, tmp_path / "out") == []


def test_the_last_checkpoint_stays_until_the_next_is_whole(
    alone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    run_stopped(short(), out, 12)
    good = (out / FILE_NAME).read_bytes()

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", full)
        stop(patch, 5, killed)
        with pytest.raises(SystemExit):
            warpwear.run(short(run__checkpoint="0 s"), out=out, plots=False, resume=True)
    assert (out / FILE_NAME).read_bytes() == good
    warpwear.run(short(), out=out, plots=False, resume=True).close()
    assert differences(alone, out) == []


def test_a_result_that_was_changed_is_refused_and_may_be_overwritten(alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(alone, out)
    with h5py.File(out / "result.h5", "a") as file:
        file.attrs["note"] = "mine"
    told = r"result\.h5 is damaged: .* another program changed it; run the study again and overwrite it"
    with pytest.raises(InputError, match=told):
        Result.open(out)
    for options in ({}, {"resume": True}):
        with pytest.raises(InputError, match=told):
            warpwear.run(short(), out=out, plots=False, **options)
    warpwear.run(short(), out=out, plots=False, overwrite=True).close()
    assert differences(alone, out) == []


def test_the_checkpoint_is_plain_hdf5(tmp_path: Path) -> None:
    run_stopped(short(), tmp_path / "out", 12)
    with h5py.File(tmp_path / "out" / FILE_NAME) as file:
        assert file["rows"].shape[0] == 12
        assert {"gap", "tiles.list"} <= set(file["model"])
