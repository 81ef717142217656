"""Standard streams that are closed or lose their reader, and studies that begin with a byte-order mark."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from warpwear import Study
from warpwear.cli.main import main

ROOT = Path(__file__).parents[2]
QUICK = "--set grid.cell=30um --set sliding.distance=0.01mm --no-plots"
VARIED = f"{QUICK.removesuffix('--no-plots')} --vary contact.load=4N,8N"
#: Longest time that a command may wait for what nobody writes [s].
PATIENCE = 30


def shell(command: str, folder: Path, *, limit: float | None = None) -> "subprocess.CompletedProcess[str]":
    line = f"{sys.executable} -m warpwear {command}"
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", line],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=limit,
    )


@pytest.mark.parametrize(
    "closed", [*(pytest.param(one, marks=pytest.mark.slow) for one in (">&-", "2>&-")), "<&- >&- 2>&-"]
)
def test_closed_streams_stop_nothing(closed: str, tmp_path: Path) -> None:
    done = shell(f"run v3-fine {QUICK} --out out {closed}", tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert (tmp_path / "out" / "result.h5").is_file()


def test_a_run_outlives_the_reader_of_its_messages(tmp_path: Path) -> None:
    done = shell(f"run v3-fine {QUICK} --out out 2>&1 | head -0", tmp_path)
    assert "Traceback" not in done.stderr
    assert (tmp_path / "out" / "result.h5").is_file()


@pytest.mark.parametrize(
    "command",
    [
        f"run v3-fine {QUICK.removesuffix('--no-plots')}",
        pytest.param(f"sweep v3-fine {VARIED} --workers 1", marks=pytest.mark.slow),
    ],
)
def test_nothing_is_left_open(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor does anything else warn: every warning of Python is an error here."""
    monkeypatch.setenv("PYTHONWARNINGS", "error")
    done = shell(f"{command} --out out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Warning" not in done.stderr


def test_a_byte_order_mark_is_no_part_of_a_study(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text("\ufeff" + Study.load("v3-fine").to_toml(), encoding="utf-8")
    assert Study.load(path) == Study.load("v3-fine")


@pytest.mark.parametrize("command", ["show", "run", "sweep --vary contact.load=1N,2N --out out"])
def test_a_pipe_in_the_place_of_a_study_is_not_waited_for(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.chdir(tmp_path)
    before = signal.signal(signal.SIGALRM, lambda *_: pytest.fail("it waits"))
    signal.alarm(PATIENCE)
    try:
        with pytest.raises(SystemExit) as ended:
            main([*command.split(), "pipe"])
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    assert ended.value.code == 2
    assert "warpwear: STUDY = 'pipe' is no file, no run folder" in capsys.readouterr().err


def test_a_pipe_is_not_written_into(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    done = shell("new pipe.toml --overwrite", tmp_path, limit=PATIENCE)
    assert done.returncode == 2
    assert "is no file that can be replaced" in done.stderr


def test_what_a_pipe_of_the_shell_says_is_read(tmp_path: Path) -> None:
    done = shell("show <(echo '[contact]')", tmp_path, limit=PATIENCE)
    assert done.stderr.startswith("warpwear: counter is missing")


def test_a_folder_without_a_study_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit):
        main(["show", "."])
    told = capsys.readouterr().err
    assert told.startswith("warpwear: STUDY = '.' is no file, no run folder and no preset (")
    assert told.count("\n") == 1
