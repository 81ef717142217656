"""Workers of a sweep, here and on a cluster: what dies, hangs or is not there."""

import math
import os
import signal
import sys
import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from cases_sweeps import VARY, address_in, processes, small

from warpwear import InputError
from warpwear.batches.batch import make_runs
from warpwear.batches.plan import Plan, section_of, task_of
from warpwear.batches.run_one import RunRow, run_one
from warpwear.engine.workers import Here, WorkerDiedError, Workers, local_workers
from warpwear.results.folder import LOCK


def test_worker_that_dies_is_started_again(tmp_path: Path) -> None:
    with local_workers(1, cores=1) as pool:
        first = pool.submit(os.getpid).result()
        os.kill(first, signal.SIGKILL)
        assert pool.submit(os.getpid).result() != first


def test_call_whose_worker_always_dies_is_given_up() -> None:
    with local_workers(1, cores=1) as pool:
        with pytest.raises(WorkerDiedError, match="died 3 times"):
            pool.submit(os._exit, 3).result()
        assert pool.submit(math.sqrt, 4.0).result() == 2.0


def test_error_of_a_call_is_raised() -> None:
    with local_workers(1, cores=1) as pool, pytest.raises(ValueError, match="math domain"):
        pool.submit(math.sqrt, -1.0).result()


def test_killed_sweep_goes_on_where_it_was(tmp_path: Path) -> None:
    plan = Plan(small(), section_of({"vary": {**VARY, "disc.synthetic.seed": "1:2"}}, {}))
    done = []

    def interrupt(number: int, row: object) -> None:
        done.append(number)
        if len(done) == 1:
            raise KeyboardInterrupt

    with local_workers(1, cores=1) as pool, pytest.raises(KeyboardInterrupt):
        make_runs(plan, tmp_path, pool, threads=1, on_row=interrupt)
    finished = [path.parent.name for path in tmp_path.glob("runs/*/result.h5")]
    assert 1 <= len(finished) <= 4
    times = {path: path.stat().st_mtime_ns for path in tmp_path.glob("runs/*/result.h5")}
    rows = make_runs(plan, tmp_path, Here(), threads=1)
    assert [row.status for row in rows] == ["done"] * 4
    assert all(path.stat().st_mtime_ns == when for path, when in times.items())


def test_run_that_takes_far_longer_than_the_others_is_told(tmp_path: Path) -> None:
    plan = Plan(small(), section_of({"vary": {"contact.load": ["4 N", "8 N"]}}, {}))
    hanging = threading.Event()

    def make(number: int) -> RunRow:
        if number == 1:
            assert hanging.wait(60.0)
        return RunRow("done", 0.01)

    class Hangs(Executor):
        pool, made = ThreadPoolExecutor(2), iter(range(2))

        def submit(self, function: Any, /, *arguments: Any, **named: Any) -> "Future[Any]":
            return self.pool.submit(make, next(self.made))

    told: list[str] = []

    def warned(sentence: str) -> None:
        told.append(sentence)
        hanging.set()

    rows = make_runs(plan, tmp_path, Hangs(), on_warning=warned, silence=0.2)
    assert [row.status for row in rows] == ["done"] * 2
    assert len(told) == 1
    assert told[0].startswith("run 1 has taken ")
    assert plan.points[1].run in told[0]


def test_work_of_a_lost_computer_is_cleaned_up(tmp_path: Path) -> None:
    """The system frees the lock of a process that is gone; what it left goes, too."""
    plan = Plan(small(), section_of({"vary": {"contact.load": ["8 N"]}}, {}))
    task = task_of(plan.points[0], tmp_path, device="cpu", threads=1)
    left = Path(task.folder) / ".work-0123456789ab"
    left.mkdir(parents=True)
    (left.parent / LOCK).write_text("process 1 on another", encoding="utf-8")
    assert run_one(task).status == "done"
    assert not left.exists()


@pytest.mark.slow
def test_dask_cluster_that_loses_a_worker(tmp_path: Path) -> None:
    """A scheduler and three workers of their own; one is killed, one frozen for a while."""
    distributed = pytest.importorskip("distributed")
    from warpwear.batches.cluster import connected

    place = tmp_path / "scheduler.json"
    run_dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    scheduler = [
        *run_dask,
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--no-dashboard",
        "--scheduler-file",
        str(place),
    ]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(place)]
    worker += ["--nthreads", "1", "--no-dashboard", "--no-nanny", "--local-directory", str(tmp_path)]
    with processes(scheduler, worker, worker, worker) as started:
        address = address_in(place)
        with distributed.Client(address, timeout="60s") as client:
            client.wait_for_workers(3, timeout=60)
        plan = Plan(small(), section_of({"vary": {**VARY, "disc.synthetic.seed": "1:4"}}, {}))
        with connected(address) as (executor, _, number):
            assert number == 3
            seen: list[int] = []

            def disturb(number: int, row: object) -> None:
                seen.append(number)
                if len(seen) == 1:
                    started[1].send_signal(signal.SIGKILL)
                    started[2].send_signal(signal.SIGSTOP)
                if len(seen) == 4:
                    started[2].send_signal(signal.SIGCONT)

            rows = make_runs(plan, tmp_path, executor, threads=1, on_row=disturb)
    assert [row.status for row in rows] == ["done"] * 8


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("tcp://10.1.2.3:8786", "neither encrypted"),
        ("somewhere:8786", "neither encrypted"),
        ("nonsense", "is no address"),
        ("tcp://127.0.0.1:1", "cannot be reached"),
    ],
)
def test_cluster_that_is_refused(address: str, says: str, monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    from warpwear.batches.cluster import connected

    client = distributed.Client
    monkeypatch.setattr(distributed, "Client", lambda address, **_: client(address, timeout="1s"))
    with pytest.raises(InputError, match=says), connected(address):
        pass


def test_one_run_through_a_thread_pool_of_the_library(tmp_path: Path) -> None:
    plan = Plan(small(), section_of({"vary": {"contact.load": ["8 N"]}}, {}))
    with ThreadPoolExecutor(1) as pool:
        row = pool.submit(run_one, task_of(plan.points[0], tmp_path, device="cpu", threads=1)).result()
    assert row.status == "done"
    assert isinstance(pool, Executor)
    assert issubclass(Workers, Executor)
