"""The folder of a sweep: what is refused before any run, and what of others is left alone."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest
from cases_sweeps import ROOT, small
from fuzzing import check_sentence

import warpwear
from warpwear import InputError
from warpwear.batches import cluster
from warpwear.batches.batch import RUNS, estimate, local_executor, make_runs
from warpwear.batches.cluster import Patience
from warpwear.batches.plan import Plan, section_of
from warpwear.engine.workers import Here, WorkerDiedError
from warpwear.results import manifest
from warpwear.results.folder import held
from warpwear.sweeps.sweep import check_runs

VARY = {"contact.load": ["8 N"]}


def sweep(out: Path, **options: Any) -> Any:
    return warpwear.sweep(small(), vary=VARY, out=out, executor=Here(), **options)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory, quick_pictures: Any) -> Path:
    out = tmp_path_factory.mktemp("sweeps") / "s"
    with quick_pictures(blank=True):
        sweep(out)
    return out


@pytest.fixture
def out(finished: Path, tmp_path: Path) -> Path:
    subprocess.run(["cp", "-r", str(finished), str(tmp_path / "s")], check=True)
    return tmp_path / "s"


@pytest.fixture(autouse=True)
def _blank(quick_pictures: Any) -> Any:
    with quick_pictures(blank=True):
        yield


def test_a_manifest_says_what_a_sweep_wrote(finished: Path) -> None:
    ours = manifest.written(finished)
    there = {str(p.relative_to(finished)) for p in finished.rglob("*") if p.is_file()}
    assert ours == {name for name in there if not name.startswith(RUNS)}


def test_a_table_that_was_cut_does_not_refuse_its_own_sweep(out: Path) -> None:
    table = out / "table.csv"
    whole = table.read_text()
    for cut in range(0, len(whole), 7):
        table.write_text(whole[:cut])
        check_runs(Plan(small(), section_of({"vary": VARY}, {})), out)


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("name", ["table.csv", "sweep.html"])
def test_a_foreign_file_is_not_replaced(name: str, known: bool, out: Path) -> None:
    """Neither where a manifest knows the others, nor where there is none."""
    manifest.write(out, manifest.written(out) - {name})
    if not known:
        (out / manifest.NAME).unlink()
    (out / name).write_text("mine\n")
    with pytest.raises(InputError, match=name.replace(".", r"\.")) as error:
        sweep(out)
    check_sentence(error.value)
    assert (out / name).read_text() == "mine\n"


def test_a_foreign_figure_is_kept_under_another_name(out: Path) -> None:
    figure = next((out / "figures").glob("*.png"))
    manifest.write(out, manifest.written(out) - {f"figures/{figure.name}"})
    figure.write_bytes(b"mine")
    with pytest.warns(UserWarning, match=r"was not written by a run: it is .*\.png now"):
        sweep(out)
    assert b"mine" in {path.read_bytes() for path in (out / "figures").glob(f"{figure.stem}-*.png")}


def test_a_full_disk_is_said_of_the_folder_that_was_given(
    out: Path, failing: Callable[[str, Exception], None]
) -> None:
    failing("warpwear.page.folder._write", OSError(28, "No space left on device"))
    with pytest.raises(
        InputError, match="could not be written: No space left on device; the runs are kept"
    ) as error:
        sweep(out)
    assert f"out = {out}:" in str(error.value)
    assert ".tables-" not in str(error.value)


def test_links_are_not_followed(out: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine.csv"
    (out / "table.csv").rename(mine)
    (out / "table.csv").symlink_to(mine)
    before = mine.read_bytes()
    sweep(out)
    assert mine.read_bytes() == before
    assert not (out / "table.csv").is_symlink()
    (out / "figures").rename(tmp_path / "elsewhere")
    (out / "figures").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="figures is a link"):
        sweep(out)


def test_a_folder_that_another_sweep_writes_is_refused(out: Path) -> None:
    with held(out), pytest.raises(InputError, match="is in use by another run"):
        sweep(out)


def test_a_folder_that_cannot_be_written_is_refused_at_once(
    tmp_path: Path, failing: Callable[[str, Exception], None]
) -> None:
    failing("warpwear.results.folder.tempfile.TemporaryFile", PermissionError(13, "Permission denied"))
    failing("warpwear.batches.batch.run_one", AssertionError("a run was begun"))
    with pytest.raises(InputError, match="cannot be written: Permission denied"):
        sweep(tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_a_run_folder_that_is_a_file_fails_alone(tmp_path: Path) -> None:
    plan = Plan(small(), section_of({"vary": {"contact.load": ["4 N", "8 N"]}}, {}))
    (tmp_path / RUNS).mkdir()
    (tmp_path / RUNS / plan.points[0].run).write_text("mine")
    rows = make_runs(plan, tmp_path, Here())
    assert rows[0].status.startswith("failed: ")
    assert rows[0].status.endswith(f"{plan.points[0].run}'")
    assert rows[1].status == "done"


class Dies(Here):
    """An executor whose workers always die."""

    def submit(self, *_: Any, **__: Any) -> Any:
        future: Future[Any] = Future()
        future.set_exception(WorkerDiedError("its worker process died 3 times"))
        return future


def test_an_unreadable_run_folder_does_not_end_the_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = Plan(small(), section_of({"vary": VARY}, {}))
    folder, stat = tmp_path / RUNS / plan.points[0].run, os.stat
    folder.mkdir(parents=True)

    def refused(path: Any, *more: Any, **others: Any) -> os.stat_result:
        if str(path).startswith(f"{folder}/"):
            raise PermissionError(13, "Permission denied", str(path))
        return stat(path, *more, **others)

    monkeypatch.setattr(os, "stat", refused)
    assert "there already" not in estimate(plan, tmp_path, Dies())
    (row,) = make_runs(plan, tmp_path, Here())
    assert row.status.startswith("failed: ")


def test_a_pilot_whose_worker_dies_is_no_traceback(tmp_path: Path) -> None:
    plan = Plan(small(), section_of({"vary": VARY}, {}))
    assert estimate(plan, tmp_path, Dies()).startswith("1 run: about")


def test_runs_that_a_cluster_takes_with_it_are_told(tmp_path: Path) -> None:
    class Gone(Here):
        def submit(self, *_: Any, **__: Any) -> "Future[Any]":
            future: Future[Any] = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    plan = Plan(small(), section_of({"vary": VARY}, {}))
    (row,) = make_runs(plan, tmp_path, Gone())
    assert row.status == "failed: it was cancelled, as runs are whose cluster is gone"


def test_a_cluster_without_workers_is_not_waited_for_in_silence() -> None:
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=0, processes=False, dashboard_address=None, protocol="tcp"
        ) as here,
        pytest.warns(UserWarning, match=r"has no workers yet: waiting 0\.2 s for the first"),
        pytest.raises(InputError, match=r"has no workers: start some"),
        cluster.connected(here.scheduler_address, insecure=True, patience=Patience(first=0.2)),
    ):
        pass


def test_a_cluster_that_loses_all_its_workers_is_given_up(tmp_path: Path) -> None:
    """It is told of, what waits fails, and so does what is begun after that."""
    distributed = pytest.importorskip("distributed")
    patience = Patience(look=0.1, lost=1.0)
    options: dict[str, Any] = {"dashboard_address": None, "protocol": "tcp", "threads_per_worker": 1}
    plan = Plan(small(), section_of({"vary": VARY}, {}))
    with (
        distributed.LocalCluster(n_workers=1, processes=False, **options) as here,
        cluster.connected(here.scheduler_address, patience=patience) as (executor, *_),
    ):
        here.scale(0)
        with pytest.warns(UserWarning, match=r"has lost all its workers: waiting 1 s for one to come back"):
            (row,) = make_runs(plan, tmp_path, executor)
        assert row.status == "failed: it was cancelled, as runs are whose cluster is gone"
        (row,) = make_runs(plan, tmp_path, executor)
        assert row.status.startswith("failed: ")


def test_a_cluster_makes_runs_and_nothing_else() -> None:
    """xarray would ask the scheduler for a lock of the tables, in vain where it has died."""
    distributed = pytest.importorskip("distributed")
    options: dict[str, Any] = {"dashboard_address": None, "protocol": "tcp", "threads_per_worker": 1}
    with (
        distributed.LocalCluster(n_workers=1, processes=False, **options) as here,
        cluster.connected(here.scheduler_address, insecure=True),
        pytest.raises(ValueError, match="No clients found"),
    ):
        distributed.default_client()


@pytest.mark.parametrize("workers", [0, 100_000])
def test_a_number_of_workers_that_cannot_be(workers: int) -> None:
    plan = Plan(small(), section_of({"vary": VARY}, {}))
    with pytest.raises(InputError, match=rf"workers = {workers} is not possible; allowed: 1 to"):
        local_executor(plan, workers=workers).__enter__()


def test_a_device_that_is_not_there_is_refused_before_any_run(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"device = 'cuda:99' is not there"):
        warpwear.sweep(small(), vary=VARY, out=tmp_path / "s", device="cuda:99", workers=1)


@pytest.mark.slow
def test_one_interrupt_stops_a_pilot(tmp_path: Path) -> None:
    """A run of many minutes, in a worker that Ctrl-C does not reach."""
    study = tmp_path / "long.toml"
    study.write_text(small(**{"sliding.distance": "200 mm", "grid.cell": "2 um", **LONG}).to_toml())
    command = ["-m", "warpwear", "sweep", str(study), "--vary", "contact.load=4 N,8 N", "--workers", "1"]
    process = subprocess.Popen(
        [sys.executable, *command, "--out", str(tmp_path / "s")],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    while process.poll() is None and not any((tmp_path / "s").glob("runs/*/.work-*/log.txt")):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in errors
    for log in (tmp_path / "s").glob("runs/*/log.txt"):  # its run was not waited for
        assert "finished:" not in log.read_text(encoding="utf-8")


#: Steps beyond what a test waits for.
LONG = {"stepping.largest": "3 um", "stepping.growth": 1.0}
