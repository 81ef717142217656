"""Faults of the machine: what can be kept is kept, and the run says in one sentence what it needs."""

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import warp as wp
from cases_stopped import killed, stop
from fuzzing import check_sentence

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli import main as cli
from warpwear.figures.of_run.table import Plotter
from warpwear.models.rest.local import OneScaleModel
from warpwear.results import tables as run_tables
from warpwear.results.writer import ResultWriter
from warpwear.runs import folder as run_folder
from warpwear.runs import order as run_order
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT

ROOT = Path(__file__).parents[3]
ENVIRONMENT = os.environ | {
    "PYTHONPATH": os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH")))),
    "MPLBACKEND": "agg",
}
SMALL = {
    "grid.cell": "20 um",
    "sliding.distance": "0.5 mm",
    "output.snapshots": ["0.2 mm"],
    "stepping.growth": 1.4,
    "run.checkpoint": "0 s",
}


def small(**changes: Any) -> Study:
    return Study.load("v3-fine").replace(SMALL | {k.replace("__", "."): v for k, v in changes.items()})


@pytest.fixture(scope="module")
def history() -> dict[str, Any]:
    """Of an undisturbed run."""
    return warpwear.run(small()).history


def check_same(out: Path, history: dict[str, Any]) -> None:
    with Result.open(out) as result:
        assert result.finished
        for name, values in history.items():
            np.testing.assert_array_equal(result.history[name], values)


def small_disks() -> bool:
    """Whether file systems of our own can be had: a name space of mounts for this user alone."""
    mount = "unshare -rm mount -t tmpfs -o size=1m none /mnt"
    return (
        shutil.which("unshare") is not None
        and not subprocess.run(mount.split(), capture_output=True, check=False).returncode
    )


@pytest.mark.parametrize("count", [3, pytest.param(60, marks=pytest.mark.slow)])
def test_a_disk_that_fills(count: int, tmp_path: Path) -> None:
    """From 1 MiB to more than enough: full at the start, a snapshot, a checkpoint, a table, a figure."""
    if not small_disks():
        pytest.skip("no file system of our own can be mounted here")
    script = ROOT / "tests" / "runs" / "stopped" / "small_disk.py"
    disk = tmp_path / "disk"
    disk.mkdir()
    done = subprocess.run(
        ["unshare", "-rm", sys.executable, script, disk, str(count)],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        timeout=60 + 10 * count,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads(done.stdout)
    stages = {run["stage"] for run in found}
    assert {"nothing written", "finished"} <= stages, stages
    for run in found:
        assert run["resumed"] == "the same", run


@pytest.mark.slow
@pytest.mark.parametrize("free", ["0", "0.05", "0.1", "0.3", "0.6", "1", "2", "3", "4"])
def test_commands_on_a_disk_that_fills(free: str, tmp_path: Path) -> None:
    """Sweep, export and record: exit status 2 and one sentence at the end, nothing in part, never a crash."""
    if not small_disks():
        pytest.skip("no file system of our own can be mounted here")
    script = ROOT / "tests" / "runs" / "stopped" / "small_disk_commands.py"
    disk = tmp_path / "disk"
    disk.mkdir()
    command = ["unshare", "-rm", sys.executable, str(script), str(disk), free]
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    for end in json.loads(done.stdout):
        print(end["free"], end["command"], end["status"], end["said"][-1:])
        assert not any("Traceback" in line for line in end["said"]), end
        assert end["whole"] == (end["status"] == 0), end
        if end["status"]:
            assert end["status"] == 2 or (end["command"] == "sweep" and end["status"] == 1), end
            assert end["said"][-1].startswith("warpwear: "), end
            assert all(name.startswith("runs/") for name in end["there"]) or end["status"] == 1, end
        assert end["again"] is True, end


@pytest.mark.parametrize(
    ("mebibytes", "holds"), [(4.5, ""), pytest.param(1.0, "no run", marks=pytest.mark.slow)]
)
def test_a_limit_to_the_size_of_files(mebibytes: float, holds: str, tmp_path: Path) -> None:
    """As a quota: the disk has room, and a write fails all the same."""
    resource = pytest.importorskip("resource")
    code = (
        "import resource, sys; from warpwear.cli import main as cli\n"
        "limit = int(float(sys.argv[1]) * 2**20)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))\n"
        "cli.main(['run', sys.argv[2], '--out', sys.argv[3], '--no-plots'])"
    )
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
    (tmp_path / "mine.toml").write_text(small(grid__cell="5 um").to_toml())
    out = tmp_path / "out"
    done = subprocess.run(
        [sys.executable, "-c", code, str(mebibytes), str(tmp_path / "mine.toml"), str(out)],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    last = done.stderr.splitlines()[-1]
    assert last.startswith(f"warpwear: out = {out} could not be written and holds {holds}")
    assert last.endswith("MiB are needed: File too large.")
    assert "Traceback" not in done.stderr


def test_a_folder_that_must_not_be_written(tmp_path: Path) -> None:
    if not small_disks():
        pytest.skip("no file system of our own can be mounted here")
    code = (
        "import subprocess, sys; from warpwear.cli import main as cli\n"
        f"subprocess.run('mount -t tmpfs none {tmp_path}'.split(), check=True)\n"
        f"subprocess.run('mkdir {tmp_path}/out'.split(), check=True)\n"
        f"subprocess.run('mount -o remount,ro {tmp_path}'.split(), check=True)\n"
        "for name in ('out', 'new'):\n"
        "    try:\n"
        f"        cli.main(['run', 'v3', '--out', '{tmp_path}/' + name])\n"
        "    except SystemExit as ended:\n"
        "        print(ended.code)\n"
    )
    done = subprocess.run(
        ["unshare", "-rm", sys.executable, "-c", code],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.split() == ["2", "2"], done.stderr
    assert done.stderr.splitlines() == [
        f"warpwear: out = {tmp_path}/{name} cannot be written: Read-only file system."
        for name in ("out", "new")
    ]


def during(
    monkeypatch: pytest.MonkeyPatch, owner: Any, name: str, do: Callable[[], Any], after: int = 0
) -> None:
    """Let something happen where a function is called for the time after so many."""
    original, calls = getattr(owner, name), []
    monkeypatch.setattr(OneScaleModel, "in_blocks", False)  # a call is a step

    def disturbed(*args: Any, **kwargs: Any) -> Any:
        calls.append(1)
        if len(calls) == after + 1:
            do()
        return original(*args, **kwargs)

    monkeypatch.setattr(owner, name, disturbed)


@pytest.mark.parametrize(("checkpoint", "after"), [("0 s", 6), ("inf s", 6)])
def test_a_folder_that_is_removed_while_it_runs(
    checkpoint: str, after: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    stop(monkeypatch, after, lambda: shutil.rmtree(out))
    with pytest.raises(InputError, match="could not be written and holds no run: No such file") as error:
        warpwear.run(small(run__checkpoint=checkpoint), out=out, plots=False)
    check_sentence(error.value)


def test_a_second_process_in_the_same_folder(
    tmp_path: Path, history: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    refused = []

    def second() -> None:
        command = [sys.executable, "-m", "warpwear", "run", "v3", "--out", str(out), "--resume"]
        refused.append(subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, check=False))

    stop(monkeypatch, 6, second)
    warpwear.run(small(), out=out, plots=False).close()
    assert refused[0].returncode == 2
    assert f"is in use by another run (process {os.getpid()} on " in refused[0].stderr
    assert refused[0].stderr.count("\n") == 1
    check_same(out, history)


PHASES: dict[str, tuple[Any, str, int]] = {
    "compile": (wp, "load_module", 0),
    "surface": (run_order, "surface_in", 0),
    "first step": (OneScaleModel, "advance", 0),
    "step": (OneScaleModel, "advance", 8),
    "snapshot": (ResultWriter, "add_snapshot", 0),
    "end of the history": (ResultWriter, "finish", 0),
    "tables": (run_tables, "_write_table", 1),
    "moving": (run_folder, "move_into_place", 0),
    "figures": (Plotter, "save", 1),
}


@pytest.mark.parametrize(
    "phase",
    [p if p in ("surface", "step", "tables") else pytest.param(p, marks=pytest.mark.slow) for p in PHASES],
)
def test_a_signal_to_end_in_every_phase(
    phase: str, tmp_path: Path, history: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit status 130; the same command with --resume ends as if nothing had been."""
    (tmp_path / "mine.toml").write_text(small().to_toml())
    out = tmp_path / "out"
    command = ["run", str(tmp_path / "mine.toml"), "--out", str(out), "--resume"]
    owner, name, after = PHASES[phase]
    before = signal.getsignal(signal.SIGTERM)
    try:
        with pytest.MonkeyPatch.context() as patch:
            during(patch, owner, name, lambda: os.kill(os.getpid(), signal.SIGTERM), after)
            if phase != "figures":
                patch.setattr(Plotter, "save_all", lambda *_, **__: [])
            with pytest.raises(SystemExit) as stopped:
                cli.main(command)
        assert stopped.value.code == 130
        told = capsys.readouterr().err
        assert "interrupted" in told
        assert "Traceback" not in told
        if out.exists():
            assert not [path for path in out.iterdir() if path.name.startswith(".")]
        if phase in ("step", "snapshot", "end of the history", "tables", "moving"):
            assert (out / CHECKPOINT).is_file()
            assert "--resume" in told[told.index("go on") :]
        elif phase == "figures":
            assert "finished, without all its figures" in told
        with pytest.raises(SystemExit) as done:
            cli.main([*command, "--no-plots"])
        assert done.value.code == 0
    finally:
        signal.signal(signal.SIGTERM, before)
    check_same(out, history)


@pytest.mark.parametrize("sizes", [[150], pytest.param([50, 100, 150, 200], marks=pytest.mark.slow)])
def test_memory_that_runs_out(sizes: list[int], tmp_path: Path) -> None:
    """With a limit of the process to what it may hold beyond what it has: one sentence, and no folder."""
    resource = pytest.importorskip("resource")
    code = (
        "import resource, sys\n"
        "import psutil\n"
        "from warpwear.cli import main as cli\n"
        "from warpwear.runs import run\n"
        # What loads late is there: OpenBLAS waits for ever where it finds no room for itself.
        "import matplotlib, scipy.fft, scipy.ndimage, scipy.optimize\n"
        "from warpwear.engine.executor import Executor\n"
        "from warpwear.grid import Grid\n"
        "Executor(Grid(8, 8, 1.0))\n"
        "here = psutil.Process().memory_info().vms\n"
        "limit = here + int(float(sys.argv[1]) * 2**20)\n"
        "resource.setrlimit(resource.RLIMIT_AS, (limit, limit))\n"
        "cli.main(['run', 'v3-fine', '--out', sys.argv[2], '--no-plots', '--threads', '1',\n"
        "  '--set', 'grid.cell=0.75 um', '--set', 'sliding.distance=0 mm', '--set', 'output.snapshots=[]'])"
    )
    assert resource.getrlimit(resource.RLIMIT_AS)[0] == resource.RLIM_INFINITY
    said = set()
    for mebibytes in sizes:
        done = subprocess.run(
            [sys.executable, "-c", code, str(mebibytes), str(tmp_path / "out")],
            env=ENVIRONMENT,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 2, done.stderr
        last = done.stderr.splitlines()[-1]
        assert "memory ran out" in last, done.stderr
        assert "Traceback" not in done.stderr
        assert list(tmp_path.iterdir()) == []
        said.add(last)
    assert (
        "warpwear: grid.cell = 0.75 µm makes 2000 × 2000 cells, for which the memory ran out; larger "
        in min(said)
    )


def test_memory_of_a_gpu_that_runs_out(failing: Callable[[str, Exception], None]) -> None:
    full = RuntimeError("Failed to allocate 18000000 bytes on device 'cuda:0'")
    failing("warpwear.engine.executor.Executor.zeros", full)
    with pytest.raises(InputError, match=r"75 × 75 cells, for which the memory ran out; larger cells"):
        warpwear.run(small())


def test_no_file_of_the_run_is_mapped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some file systems of clusters have no mmap."""
    maps = Path("/proc/self/maps")
    if not maps.exists():
        pytest.skip("what is mapped is not told here")
    seen: list[str] = []
    stop(monkeypatch, 6, lambda: seen.append(maps.read_text()))
    warpwear.run(small(), out=tmp_path / "out", plots=False)
    assert seen
    assert str(tmp_path) not in seen[0]


def test_the_log_of_killed_sessions_is_kept(tmp_path: Path) -> None:
    out = tmp_path / "out"

    def killed() -> None:  # leaves its work folder, as SIGKILL does
        shutil.copytree(next(out.glob(".work-*")), tmp_path / "left")
        raise SystemExit

    for after in (4, 2):
        with pytest.MonkeyPatch.context() as patch:
            stop(patch, after, killed)
            with pytest.raises(SystemExit):
                warpwear.run(small(), out=out, plots=False, resume=True)
        (tmp_path / "left").rename(out / f".work-{after:012x}")
    warpwear.run(small(), out=out, plots=False, resume=True).close()
    log = (out / "log.txt").read_text()
    assert log.count("warpwear 0.1.0 on cpu") == 3
    assert "goes on after step 4," in log
    assert "goes on after step 6," in log
    assert log.count("finished: ") == 1
    warpwear.run(small(), out=out, plots=False, overwrite=True).close()
    assert (out / "log.txt").read_text().count("warpwear 0.1.0 on cpu") == 1


def test_a_changed_study_is_refused_before_the_surface_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        stop(patch, 6, killed)
        with pytest.raises(SystemExit):
            warpwear.run(small(), out=tmp_path / "out", plots=False)
    during(monkeypatch, run_order, "surface_in", lambda: pytest.fail("the surface was made"))
    with pytest.raises(InputError, match=r"is of another study \(contact\.load\)"):
        warpwear.run(small(contact__load="9 N"), out=tmp_path / "out", resume=True)
