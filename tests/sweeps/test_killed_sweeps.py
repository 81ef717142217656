"""Sweeps whose processes are killed, or that meet in one folder: the rows are those of one left alone."""

import csv
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil
import pytest
from cases_sweeps import ROOT, address_in, processes, small
from fuzzing import numbers

#: The command with figures of one white dot, which take no time.
COMMAND = """import sys
from conftest import BLANK
from warpwear.figures import style
write = style.bytes_of
style.bytes_of = lambda figure, kind="png", **more: BLANK if kind == "png" else write(figure, kind, **more)
from warpwear.cli import main as cli
from warpwear.batches import cluster
cluster.LOOK, cluster.LOST = 0.5, 5.0
cli.main(sys.argv[1:])
"""
ENVIRONMENT = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests")))}
#: Seven short runs, and one that fails each time.
VARY = "contact.load=2 N,3 N,4 N,5 N,6 N,7 N,8 N,-1 N"
#: Kills of all.
KILLS = 30
#: Longest that a sweep may take which something was done to [s].
PATIENCE = 300.0


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("study") / "s.toml"
    path.write_text(small(**{"run.checkpoint": "0.05 s"}).to_toml(), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def alone(study: Path) -> list[dict[str, str]]:
    """The rows of a sweep to which nothing happened."""
    out = study.parent / "alone"
    process = begin(study, out)
    _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode in (0, 1), errors
    return rows_in(out)


def begin(study: Path, out: Path, *more: str) -> "subprocess.Popen[str]":
    command = ["sweep", str(study), "--vary", VARY, "--out", str(out), "--resume", *more]
    if "--cluster" not in more:
        command += ["--workers", "2"]
    return subprocess.Popen(
        [sys.executable, "-c", COMMAND, *command],
        env=ENVIRONMENT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def rows_in(out: Path) -> list[dict[str, str]]:
    with (out / "table.csv").open(newline="", encoding="utf-8") as file:
        return [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]


def check_end(process: "subprocess.Popen[str]", out: Path, alone: list[dict[str, str]]) -> None:
    """The sweep ends, without a traceback, and its rows are those; nothing half-written is left."""
    _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode in (0, 1), errors
    assert "Traceback" not in errors
    assert rows_in(out) == alone
    assert not [*out.glob(".tables-*"), *out.glob("runs/*/.work-*"), *out.glob("runs/*/checkpoint*")]


@pytest.mark.slow
def test_sweeps_and_workers_killed_at_random(
    study: Path, alone: list[dict[str, str]], tmp_path: Path
) -> None:
    """Two workers, then the sweep, which is begun again; the same call loses at most two workers.

    Quick tests kill a worker, and stop a sweep and begin it again, where they choose: see `test_workers.py`.
    """
    dice, out = random.Random(numbers(KILLS).start), tmp_path / "s"
    kills, ends = {"workers": 0, "sweeps": 0}, 0
    while sum(kills.values()) < len(numbers(KILLS)):
        process = begin(study, out)
        for strike in ("workers", "workers", "sweeps"):
            with suppress(psutil.NoSuchProcess, subprocess.TimeoutExpired):
                here = psutil.Process(process.pid)
                while process.poll() is None and not here.children():
                    time.sleep(0.02)
                process.wait(timeout=dice.uniform(0.0, 5.0))
            with suppress(psutil.NoSuchProcess, IndexError):
                target = dice.choice(here.children()) if strike == "workers" else here
                target.kill()
                kills[strike] += 1
        process.wait()
        if process.returncode != -signal.SIGKILL:
            check_end(process, out, alone)
            shutil.rmtree(out)
            ends += 1
        else:
            process.communicate()
    check_end(begin(study, out), out, alone)
    print(f"{kills} killed, {ends + 1} sweeps ended with the same rows")


@pytest.mark.slow
@pytest.mark.parametrize("store", [False, True])
def test_three_sweeps_at_once(store: bool, study: Path, alone: list[dict[str, str]], tmp_path: Path) -> None:
    """In one folder one of them makes it and the others say so; in three with one store all do."""
    places = [tmp_path / (f"s{number}" if store else "s") for number in range(3)]
    more = ["--runs", str(tmp_path / "store")] if store else []
    ended = 0
    for process in [begin(study, place, *more) for place in places]:
        _, errors = process.communicate(timeout=PATIENCE)
        assert "Traceback" not in errors
        if not store and process.returncode == 2:
            assert "is in use by another run" in errors
            assert errors.count("\n") == 1
            continue
        assert process.returncode == 1, errors
        ended += 1
    assert ended == 3 if store else ended >= 1
    for place in places:
        assert rows_in(place) == alone


def kill(process: Any) -> None:
    process.kill()
    process.wait()


@pytest.mark.slow
@pytest.mark.parametrize("victim", ["scheduler", "a worker", "all workers", "parent"])
def test_a_dask_cluster_loses(victim: str, study: Path, alone: list[dict[str, str]], tmp_path: Path) -> None:
    """A sentence each and no traceback; the same command goes on here to the same rows."""
    pytest.importorskip("distributed")
    place, out = tmp_path / "scheduler.json", tmp_path / "s"
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    scheduler = [*dask, "--no-dashboard", "--scheduler-file", str(place)]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(place)]
    worker += ["--nthreads", "1", "--no-dashboard", "--no-nanny", "--local-directory", str(tmp_path)]
    with processes(scheduler, worker, worker) as started:
        process = begin(study, out, "--cluster", address_in(place))
        end = time.monotonic() + 120.0
        while len([*out.glob("runs/*/result.h5")]) < 2:
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < end
            time.sleep(0.05)
        victims: dict[str, list[Callable[[], Any]]] = {
            "scheduler": [lambda: kill(started[0])],
            "a worker": [lambda: kill(started[1])],
            "all workers": [lambda: kill(started[1]), lambda: kill(started[2])],
            "parent": [lambda: process.send_signal(signal.SIGKILL)],
        }
        for strike in victims[victim]:
            strike()
        _, errors = process.communicate(timeout=PATIENCE)
    print(victim, process.returncode, errors)
    assert "Traceback" not in errors
    assert process.returncode == (-signal.SIGKILL if victim == "parent" else 1), errors
    if victim == "all workers":
        assert "has lost all its workers: waiting 5 s for one to come back" in errors
    if victim in ("scheduler", "all workers"):
        assert "it was cancelled, as runs are whose cluster is gone" in errors
        assert "could not be written" not in errors
    check_end(begin(study, out), out, alone)
