"""Sweeps through the public door: rows, folders that are the truth, workers that die, bands."""

import json
import logging
import math
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_sweeps import ROOT, SMALL, Here, address_in, processes, small

import warpwear
from warpwear import InputError, Study
from warpwear.cli.main import main
from warpwear.engine.workers import WorkerDiedError, Workers, local_workers
from warpwear.figures.paint import paint
from warpwear.history.quantities import BY_NAME
from warpwear.results.folder import LOCK
from warpwear.sweeps.figures import courses
from warpwear.sweeps.plan import Plan, section_of
from warpwear.sweeps.points import task_of
from warpwear.sweeps.report import summary_text
from warpwear.sweeps.run_one import Row, run_one
from warpwear.sweeps.sweep import make_runs, share_runs
from warpwear.sweeps.table import SweepResult

VARY = {"contact.load": ["4 N", "8 N"], "disc.synthetic.seed": "1:3"}


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory, quick_pictures: Any) -> Any:
    out = tmp_path_factory.mktemp("swept") / "s"
    with quick_pictures():
        return warpwear.sweep(small(), vary=VARY, band_over="disc.synthetic.seed", out=out, executor=Here())


@pytest.fixture
def work_here(monkeypatch: pytest.MonkeyPatch, quick_pictures: Any) -> Iterator[None]:
    """Let the workers of a command be this process, which has imported all; pictures have few dots."""
    monkeypatch.setattr("warpwear.sweeps.sweep.local_workers", lambda *_, **__: Here())
    with quick_pictures():
        yield


def test_rows_are_the_runs(swept: Any) -> None:
    table = swept.table
    assert table["status"] == ["done"] * 6
    assert table["contact.load"] == ["4 N"] * 3 + ["8 N"] * 3
    with warpwear.run(small(**{"contact.load": "8 N", "disc.synthetic.seed": 2}), plots=False) as result:
        assert table["cof [1]"][4] == result.history["cof"][-1]
        assert table["area_contact [mm^2]"][4] == result.history["area_contact"][-1]


def test_folder_has_tables_figures_and_a_page(swept: Any) -> None:
    there = {path.name for path in swept.folder.rglob("*") if path.is_file()}
    assert {"table.csv", "sweep.html", "courses.png", "scatter.png", "tornado.png"} <= there
    page = (swept.folder / "sweep.html").read_text(encoding="utf-8")
    assert "http:" not in page  # and no data spell it: base64 has no colon
    assert "https:" not in page
    assert "load 8 N" in page


def test_data_set_has_the_dimensions_run_and_distance(swept: Any) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    with xarray.open_dataset(swept.folder / "sweep.nc", engine="h5netcdf") as data:
        assert data["cof"].dims == ("run", "distance")
        assert data["contact.load"].attrs["units"] == "N"
        assert list(data["contact.load"]) == [4.0] * 3 + [8.0] * 3
        assert float(data["cof"][4, -1]) == swept.table["cof [1]"][4]


def test_a_run_of_a_sweep_leaves_its_result_alone(swept: Any) -> None:
    """What it takes longest to write beside a short run nobody reads of a thousand."""
    for folder in (path for path in (swept.folder / "runs").iterdir() if path.is_dir()):
        assert {path.name for path in folder.iterdir()} == {"result.h5", "log.txt", "manifest.json"}
        with warpwear.Result.open(folder) as result:
            assert result.finished
            assert len(result.snapshots) == 0
            assert result.summary["area_mm2"]["contact"] > 0.0


def test_band_lies_around_its_mean(swept: Any) -> None:
    groups = swept.plan.groups
    assert list(groups) == ["load 4 N", "load 8 N"]
    mean, low, high = swept.band("cof", groups["load 4 N"])
    values = swept.courses("cof")[:3]
    assert np.allclose(mean, values.mean(axis=0))
    assert np.allclose([low, high], np.percentile(values, (5.0, 95.0), axis=0, method="weibull"))
    assert np.all((low <= mean * (1.0 + 1e-12)) & (mean <= high * (1.0 + 1e-12)))


def test_finished_runs_are_not_made_again(swept: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def not_again(*_: Any, **__: Any) -> None:
        raise AssertionError("a finished run was made again")

    monkeypatch.setattr("warpwear.runs.run.StepLoop", not_again)
    again = make_runs(swept.plan, swept.folder, Here())
    assert [row.ends for row in again] == [row.ends for row in swept.rows]


def test_name_of_a_run_follows_what_decides_its_numbers() -> None:
    def name(**changes: Any) -> str:
        plan = Plan(small(**changes), section_of({"vary": {"disc.synthetic.seed": [1]}}, {}))
        return plan.points[0].run

    assert name() == name(**{"study.name": "another", "run.checkpoint": "1 s"})
    assert name() != name(**{"contact.load": "7 N"})


FAILING = {"contact.hardness": ["0.001 MPa", "590 MPa", "-1 MPa"]}


def test_failed_run_is_a_row_with_its_sentence_and_a_warning() -> None:
    says = "^2 of 3 runs failed, rows 0, 2 from 0: the column status of the result's table says why.$"
    with pytest.warns(warpwear.StudyWarning, match=says) as warned:
        found = warpwear.sweep(small(), vary=FAILING, executor=Here())
    assert [Path(w.filename).name for w in warned if w.category is warpwear.StudyWarning] == [
        Path(__file__).name
    ]
    table = found.table
    assert table["status"][1] == "done"
    assert table["status"][0].startswith("failed: ")
    assert table["status"][2].startswith("failed: contact.hardness")
    assert math.isnan(table["cof [1]"][0])
    with pytest.raises(InputError, match=r"not kept: give sweep\(\) a folder, out"):
        found.open(1)


@pytest.mark.usefixtures("work_here")
def test_a_command_of_which_runs_failed_ends_with_1(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    study = tmp_path / "s.toml"
    study.write_text(small().to_toml(), encoding="utf-8")
    command = ["sweep", str(study), "--out", str(tmp_path / "out"), "--workers", "1", "--vary"]
    with pytest.raises(SystemExit) as ended:
        main([*command, "contact.hardness=0.001 MPa,590 MPa"])
    assert ended.value.code == 1
    (told,) = (line for line in capfd.readouterr().err.splitlines() if line.startswith("warpwear: "))
    assert told.startswith("warpwear: 1 of 2 runs failed, row 0 from 0: the column status of ")
    assert f"{tmp_path / 'out' / 'table.csv'} says why" in told
    with pytest.raises(SystemExit) as ended:
        main([*command, "contact.hardness=590 MPa", "--resume"])
    assert ended.value.code == 0


def test_a_run_of_a_sweep_is_opened_by_its_row(swept: Any) -> None:
    with swept.open(4) as result:
        assert result.study.contact.load == 8.0
        assert result.study.disc.synthetic.seed == 2
        assert result.history["cof"][-1] == swept.table["cof [1]"][4]
    for number in (6, -7):
        with pytest.raises(InputError, match=f"no run {number}: it has 6, counted from 0"):
            swept.open(number)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"vary": {"contact.lod": ["1 N"]}}, "contact.lod"),
        ({"vary": {"contact.load": ["1 N"]}, "band_over": "grid.cell"}, "not varied"),
        ({"vary": {"contact.load": ["1 N"]}, "design": "cross"}, "sweep.design"),
        ({"vary": {"disc.crop": {"positions": 3}}}, "measured disc"),
    ],
)
def test_what_makes_no_sweep_is_refused(asked: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        warpwear.sweep(small(), executor=Here(), **asked)


def test_friction_over_wear_and_load_follows_the_closed_form() -> None:
    """A paraboloid on springs k sinks by what is worn and pressed in: A² = 4π R (K F s + F/k)."""
    study = Study.load("v1").replace({"sliding.distance": "600 mm", "wear.disc": "0 mm^3/N/m"})
    study = study.replace({"output.snapshots": []})
    vary = {"wear.counter": ["5e-4 mm^3/N/m", "1e-3 mm^3/N/m"], "contact.load": ["4 N", "8 N"]}
    found = warpwear.sweep(study, vary=vary, executor=Here())
    wear, load = found.numbers("wear.counter")[0], found.numbers("contact.load")[0]
    stiffness = np.array([point.study.bulk_stiffness() for point in found.plan.points])
    worn = 1.0e-3 * wear * load * 600.0
    area = np.sqrt(4.0 * np.pi / study.counter.form.curvature * (worn + load / stiffness))
    assert found.ends("wear_volume_counter") == pytest.approx(worn, rel=1e-9)
    assert found.ends("area_contact") == pytest.approx(area, rel=0.01)
    assert found.ends("cof") == pytest.approx(study.friction.shear_strength * area / load, rel=0.01)
    influence = found.influence("cof")
    assert influence["wear.counter"] > 0.0 > influence["contact.load"]


# Workers of this machine.


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


def test_sweep_from_a_script_without_a_guard(swept: Any, tmp_path: Path) -> None:
    """And its rows are those of another executor."""
    script = tmp_path / "script.py"
    some = {"contact.load": ["4 N"], "disc.synthetic.seed": "1:2"}
    script.write_text(
        "import json\nimport warpwear\n"
        f"study = warpwear.Study.load('v3-fine').replace({SMALL!r})\n"
        f"print(json.dumps(warpwear.sweep(study, vary={some!r}, workers=1).table))\n",
        encoding="utf-8",
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    ran = subprocess.run(
        [sys.executable, str(script)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    table = json.loads(ran.stdout)
    assert table["status"] == ["done"] * 2
    assert [*table] == [*swept.table]
    for name, values in swept.table.items():
        if name != "seconds":
            assert table[name] == values[:2]


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


def test_run_that_takes_far_longer_than_the_others_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("warpwear.sweeps.sweep.LOOK", 0.01)
    monkeypatch.setattr("warpwear.sweeps.sweep.SILENCE", 0.2)
    plan = Plan(small(), section_of({"vary": {"contact.load": ["4 N", "8 N"]}}, {}))
    hanging = threading.Event()

    def make(number: int) -> Row:
        if number == 1:
            assert hanging.wait(60.0)
        return Row("done", 0.01)

    class Hangs(Executor):
        pool, made = ThreadPoolExecutor(2), iter(range(2))

        def submit(self, function: Any, /, *arguments: Any, **named: Any) -> "Future[Any]":
            return self.pool.submit(make, next(self.made))

    told: list[str] = []

    def warned(sentence: str) -> None:
        told.append(sentence)
        hanging.set()

    rows = make_runs(plan, tmp_path, Hangs(), on_warning=warned)
    assert [row.status for row in rows] == ["done"] * 2
    assert len(told) == 1
    assert told[0].startswith("run 1 has taken ")
    assert plan.points[1].run in told[0]


def test_sweeps_share_their_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan, store = Plan(small(), section_of({"vary": {"contact.load": ["8 N"]}}, {})), tmp_path / "store"
    share_runs(tmp_path / "one", store)
    first = make_runs(plan, tmp_path / "one", Here(), threads=1)
    monkeypatch.setattr("warpwear.runs.run.StepLoop", None)  # nothing is computed again
    share_runs(tmp_path / "two", store)
    share_runs(tmp_path / "two", store)  # as with --resume
    assert make_runs(plan, tmp_path / "two", Here(), threads=1)[0].ends == first[0].ends
    assert (store / plan.points[0].run / "result.h5").is_file()
    with pytest.raises(InputError, match="has its runs in"):
        share_runs(tmp_path / "two", tmp_path / "other")


def test_two_keys_have_colours_and_kinds_of_line(swept: Any) -> None:
    """Two groups that are alike are both seen, and the legend names each value once."""
    plan = Plan(small(), section_of({"vary": {**VARY, "contact.hardness": ["590 MPa", "1200 MPa"]}}, {}))
    plan.band_over = ["disc.synthetic.seed"]
    rows = [swept.rows[3 * (n // 6) + (n // 2) % 3] for n in range(12)]
    figure = paint(courses(SweepResult(plan, rows), [BY_NAME["cof"], BY_NAME["area_contact"]]))
    lines = [line for line in figure.axes[0].get_lines() if len(line.get_xdata())]
    assert [(line.get_linestyle(), line.get_linewidth()) for line in lines] == [("-", 2.4), ("--", 1.1)] * 2
    assert len({line.get_color() for line in lines}) == 4
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    assert named == ["load 4 N", "load 8 N", "hardness 590 MPa", "hardness 1200 MPa"]
    assert figure.axes[0].get_title() == "mean and 5–95 % of 3 runs"
    assert swept.influence()["disc.synthetic.seed"] >= 0.0  # no order, no rank


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
    from warpwear.sweeps.cluster import connected

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
    from warpwear.sweeps.cluster import connected

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


def test_a_sweep_from_python_tells_the_log_how_far_it_is(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, logger="warpwear")
    found = warpwear.sweep(small(), vary={"contact.load": ["4 N", "8 N"]}, executor=Here())
    told = [record.getMessage() for record in caplog.records if " of 2 runs, " in record.getMessage()]
    assert [line.partition(";")[0] for line in told] == [f"{n} of 2 runs, the last done" for n in (1, 2)]
    assert told[1].endswith("about 0 s left")
    assert repr(found) == "<sweep over contact.load: 2 of 2 runs done>"


@pytest.mark.usefixtures("work_here")
def test_a_sweep_in_a_log_tells_how_far_it_is(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("warpwear.sweeps.command.EVERY_SECONDS", 0.0)
    study = tmp_path / "s.toml"
    study.write_text(small().to_toml(), encoding="utf-8")
    command = ["sweep", str(study), "--out", str(tmp_path / "out"), "--workers", "1", "--vary"]
    with pytest.raises(SystemExit):
        main([*command, "contact.load=4 N,8 N"])
    assert "1 of 2 runs, the last done; " in capfd.readouterr().err
    with pytest.raises(SystemExit) as ended:
        main([*command, "contact.load=4 N,8 N"])
    assert ended.value.code == 2
    told = capfd.readouterr().err
    assert "already holds a sweep; resume it (--resume), or give another folder (--out)." in told
    assert "overwrite" not in told  # the command has no such option


def test_a_hardness_that_decides_nothing_is_told_with_the_reason() -> None:
    """A disc at rest runs in until no cell bears the hardness; early it decides."""
    vary = {"contact.hardness": ["500 MPa", "700 MPa"], "contact.load": ["6 N", "8 N"]}
    late, early = (
        summary_text(warpwear.sweep(small().replace({"sliding.distance": d}), vary=vary, workers=1))
        for d in ("60 mm", "0.1 mm")
    )
    assert "contact.hardness without influence at the end: a disc at rest runs in" in late
    assert "without influence" not in early


def test_a_table_holds_no_formula_of_a_spreadsheet(tmp_path: Path) -> None:
    """As in the table of a comparison; the run is found again, so that the sweep may go on."""
    names = ["=1+2", "plain"]
    for _ in range(2):
        warpwear.sweep(
            small(),
            vary={"study.description": names, "contact.load": ["8 N"]},
            out=tmp_path / "out",
            workers=1,
        )
    text = (tmp_path / "out" / "table.csv").read_text(encoding="utf-8")
    assert "'=1+2" in text
    assert ",=1+2" not in text
    assert "\n=1+2" not in text
