"""A run folder is one run's: another is refused, and what killed runs left is cleaned up."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from cases_stopped import ROOT, differences, short, stop

import warpwear
from warpwear import InputError
from warpwear.results import manifest
from warpwear.results.folder import LOCK, held, whole_folder

#: Holds a folder until its input ends, or tells that another holds it.
HOLDER = """
import sys
from pathlib import Path
from warpwear import InputError
from warpwear.results import folder
folder.PATIENCE = 0.02
for line in sys.stdin:
    try:
        with folder.held(Path(line.strip())):
            print("held", flush=True)
            sys.stdin.readline()
    except InputError as error:
        print(f"refused: {error}", flush=True)
        sys.stdin.readline()
    print("free", flush=True)
"""


class Holder:
    """Another process that holds a folder."""

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", HOLDER],
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )

    def ask(self, folder: Path) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{folder}\n")
        self.process.stdin.flush()

    def answer(self) -> str:
        assert self.process.stdout is not None
        return self.process.stdout.readline().strip()

    def release(self) -> None:
        self.ask(Path())
        assert self.answer() == "free"

    def end(self) -> None:
        self.process.kill()
        self.process.communicate()


@pytest.fixture
def holders() -> Iterator[list[Holder]]:
    started = [Holder(), Holder()]
    yield started
    for holder in started:
        holder.end()


def test_what_killed_runs_left_is_cleaned_up(tmp_path: Path) -> None:
    """A run killed before its first checkpoint leaves its lock and its work folder."""
    out, left = tmp_path / "out", tmp_path / "out" / ".work-0123456789ab"
    left.mkdir(parents=True)
    (left / "log.txt").write_bytes(b"half")
    (left / "result.h5").write_bytes(b"half")
    manifest.write(out, ["history.csv"])
    (out / LOCK).write_text("process 1 on another computer")
    (out / "history.csv").write_text("half")  # killed while it moved its files into place
    study = short(sliding__distance="0 mm")
    warpwear.run(study, out=out, plots=False).close()
    assert not [p for p in out.iterdir() if p.name.startswith(".")]
    left.mkdir()  # killed when all was in place
    (out / LOCK).write_text("")
    warpwear.run(study, out=out, plots=False, resume=True).close()
    assert not [p for p in out.iterdir() if p.name.startswith(".")]


@pytest.mark.parametrize("content", ["", "{", '{"pid": -1}', '{"pid": 1e400}', "\0\xff", "process 1 on here"])
def test_a_lock_file_that_nobody_holds_is_none(content: str, tmp_path: Path) -> None:
    """Whatever it holds, and whatever the clock says: the system knows who is gone."""
    (tmp_path / LOCK).write_text(content)
    warpwear.run(short(sliding__distance="0 mm"), out=tmp_path, plots=False).close()
    assert not (tmp_path / LOCK).exists()


def test_a_folder_in_use_is_refused(tmp_path: Path, holders: list[Holder]) -> None:
    holders[0].ask(tmp_path)
    assert holders[0].answer() == "held"
    number = holders[0].process.pid
    for options in ({}, {"resume": True}, {"overwrite": True}):
        with pytest.raises(InputError, match=rf"in use by another run \(process {number} on .*\); give"):
            warpwear.run(short(), out=tmp_path, **options)
    assert [p.name for p in tmp_path.iterdir()] == [LOCK]


@pytest.mark.skipif(sys.platform == "win32", reason="a folder itself cannot be locked there")
def test_a_lock_whose_file_is_deleted_holds(tmp_path: Path, holders: list[Holder]) -> None:
    holders[0].ask(tmp_path)
    assert holders[0].answer() == "held"
    (tmp_path / LOCK).unlink()
    for options in ({}, {"resume": True}, {"overwrite": True}):
        with pytest.raises(InputError, match="in use by another run"):
            warpwear.run(short(), out=tmp_path, **options)
    holders[0].release()
    with held(tmp_path):
        pass


def test_the_lock_of_a_killed_process_is_free_at_once(tmp_path: Path, holders: list[Holder]) -> None:
    holders[0].ask(tmp_path)
    assert holders[0].answer() == "held"
    with pytest.raises(InputError, match="in use"), held(tmp_path):
        pass
    holders[0].process.send_signal(signal.SIGKILL)
    holders[0].process.wait()
    with held(tmp_path):
        assert (tmp_path / LOCK).read_text().startswith("process ")
    assert not (tmp_path / LOCK).exists()


def test_two_processes_never_hold_one_folder(tmp_path: Path, holders: list[Holder]) -> None:
    """Both ask at once, for a folder where a killed process left its lock."""
    for _ in range(50):
        (tmp_path / LOCK).write_text("process 1 on here")
        for holder in holders:
            holder.ask(tmp_path)
        answers = sorted(holder.answer()[:7] for holder in holders)
        assert answers == ["held", "refused"]
        for holder in holders:
            holder.release()


def test_a_comparison_waits_for_nobody(tmp_path: Path, holders: list[Holder]) -> None:
    """A folder of tables that another process writes is left alone."""
    (tmp_path / "table.csv").write_text("theirs")
    holders[0].ask(tmp_path)
    assert holders[0].answer() == "held"
    with pytest.raises(InputError, match="in use"), whole_folder(tmp_path, ["table.csv"]) as work:
        (work / "table.csv").write_text("ours")
    assert (tmp_path / "table.csv").read_text() == "theirs"


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
    assert not (out / LOCK).exists()
