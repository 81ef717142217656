"""A run folder is one run's: another is refused, and what killed runs left is cleaned up."""

import json
import os
import platform
from pathlib import Path
from typing import Any

import psutil
import pytest
from cases_stopped import differences, short, stop

import warpwear
from warpwear import InputError
from warpwear.results import manifest
from warpwear.runs import lock as run_lock


def test_what_killed_runs_left_is_cleaned_up(tmp_path: Path) -> None:
    """A run killed before its first checkpoint leaves its lock and its work folder."""
    out = tmp_path / "out"
    (out / ".work-abc").mkdir(parents=True)
    (out / ".work-abc" / "result.h5").write_bytes(b"half")
    gone = {"pid": os.getpid(), "started": psutil.Process().create_time() - 99.0, "host": platform.node()}
    gone["work"] = [".work-abc"]
    manifest.write(out, ["history.csv"])
    (out / run_lock.NAME).write_text(json.dumps(gone))
    (out / "history.csv").write_text("half")  # killed while it moved its files into place
    study = short(sliding__distance="0 mm")
    warpwear.run(study, out=out, plots=False).close()
    assert not [p for p in out.iterdir() if p.name.startswith(".")]
    (out / ".work-abc").mkdir()  # killed when all was in place
    (out / run_lock.NAME).write_text(json.dumps(gone))
    warpwear.run(study, out=out, plots=False, resume=True).close()
    assert not [p for p in out.iterdir() if p.name.startswith(".")]


@pytest.mark.parametrize(
    ("owner", "message"),
    [
        ({"pid": os.getppid()}, rf"in use by another run \(process {os.getppid()}\)"),
        ({"host": "elsewhere"}, r"on elsewhere\).* If that is gone, delete .*\.lock"),
        (None, r"left of one that is gone and may be deleted"),
    ],
)
def test_a_folder_in_use_is_refused(tmp_path: Path, owner: dict[str, Any] | None, message: str) -> None:
    pid = os.getpid() if owner is None else owner.get("pid", os.getpid())
    known = {"pid": pid, "started": psutil.Process(pid).create_time(), "host": platform.node()}
    lock = tmp_path / run_lock.NAME
    lock.write_text("" if owner is None else json.dumps(known | owner))
    for options in ({}, {"resume": True}, {"overwrite": True}):
        with pytest.raises(InputError, match=message):
            warpwear.run(short(), out=tmp_path, **options)
    assert [p.name for p in tmp_path.iterdir()] == [run_lock.NAME]


def test_a_lock_taken_between_looking_and_taking_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parent = psutil.Process(os.getppid())
    lock = tmp_path / run_lock.NAME
    owner = {"pid": parent.pid, "started": parent.create_time(), "host": platform.node()}
    found = run_lock.psutil.Process

    def quicker(*args: Any) -> psutil.Process:  # another process takes it while this one asks for its number
        if not args:
            lock.write_text(json.dumps(owner))
        return found(*args)

    monkeypatch.setattr(run_lock.psutil, "Process", quicker)
    with pytest.raises(InputError, match=rf"in use by another run \(process {parent.pid}\)"):
        warpwear.run(short(), out=tmp_path)
    assert json.loads(lock.read_text()) == owner


def test_two_runs_in_one_folder(alone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out"
    refused: list[str] = []

    def another() -> None:
        for options in ({}, {"resume": True}, {"overwrite": True}):
            with pytest.raises(InputError, match="is in use by another run") as error:
                warpwear.run(short(), out=out, **options)
            refused.append(str(error.value))

    stop(monkeypatch, 10, another)
    warpwear.run(short(), out=out, plots=False).close()
    assert len(refused) == 3
    assert differences(alone, out) == []
    assert not (out / run_lock.NAME).exists()
