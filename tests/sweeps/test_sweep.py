"""Sweeps through the public door: rows, folders that are the truth, closed forms, bands."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_sweeps import ROOT, SMALL, VARY, small

import warpwear
from warpwear import InputError, Study
from warpwear.batches.batch import make_runs, share_runs
from warpwear.batches.plan import Plan, section_of
from warpwear.engine.workers import Here
from warpwear.figures.paint import paint
from warpwear.history.quantities import BY_NAME
from warpwear.sweeps.figures import courses
from warpwear.sweeps.report import summary_text
from warpwear.sweeps.table import SweepResult


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory, quick_pictures: Any) -> Any:
    out = tmp_path_factory.mktemp("swept") / "s"
    with quick_pictures(blank=True):
        return warpwear.sweep(small(), vary=VARY, band_over="disc.synthetic.seed", out=out, executor=Here())


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


def test_finished_runs_are_not_made_again(swept: Any, failing: Callable[[str, Exception], None]) -> None:
    failing("warpwear.runs.run.StepLoop", AssertionError("a finished run was made again"))
    again = make_runs(swept.plan, swept.folder, Here())
    assert [row.ends for row in again] == [row.ends for row in swept.rows]


def test_name_of_a_run_follows_what_decides_its_numbers() -> None:
    def name(**changes: Any) -> str:
        plan = Plan(small(**changes), section_of({"vary": {"disc.synthetic.seed": [1]}}, {}))
        return plan.points[0].run

    assert name() == name(**{"study.name": "another", "run.checkpoint": "1 s"})
    assert name() != name(**{"contact.load": "7 N"})


def test_a_run_of_a_sweep_is_opened_by_its_row(swept: Any) -> None:
    with swept.open(4) as result:
        assert result.study.contact.load == 8.0
        assert result.study.disc.synthetic.seed == 2
        assert result.history["cof"][-1] == swept.table["cof [1]"][4]
    for number in (6, -7):
        with pytest.raises(InputError, match=f"no run {number}: it has 6, counted from 0"):
            swept.open(number)


def test_friction_over_wear_and_load_follows_the_closed_form() -> None:
    """A paraboloid on springs k sinks by what is worn and pressed in: A² = 4π R (K F s + F/k)."""
    study = Study.load("v1").replace({"sliding.distance": "600 mm", "wear.disc": "0 mm^3/N/m"})
    study = study.replace({"output.snapshots": []})
    vary = {"wear.counter": ["5e-4 mm^3/N/m", "1e-3 mm^3/N/m"], "contact.load": ["4 N", "8 N"]}
    found = warpwear.sweep(study, vary=vary, executor=Here())
    wear, load = found.numbers("wear.counter")[0], found.numbers("contact.load")[0]
    stiffness = np.array([point.study.pair.bulk_stiffness for point in found.plan.points])
    worn = 1.0e-3 * wear * load * 600.0
    area = np.sqrt(4.0 * np.pi / study.counter.form.curvature * (worn + load / stiffness))
    assert found.ends("wear_volume_counter") == pytest.approx(worn, rel=1e-9)
    assert found.ends("area_contact") == pytest.approx(area, rel=0.01)
    assert found.ends("cof") == pytest.approx(study.friction.shear_strength * area / load, rel=0.01)
    influence = found.influence("cof")
    assert influence["wear.counter"] > 0.0 > influence["contact.load"]


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


def test_sweeps_share_their_runs(tmp_path: Path, failing: Callable[[str, Exception], None]) -> None:
    plan, store = Plan(small(), section_of({"vary": {"contact.load": ["8 N"]}}, {})), tmp_path / "store"
    share_runs(tmp_path / "one", store)
    first = make_runs(plan, tmp_path / "one", Here(), threads=1)
    failing("warpwear.runs.run.StepLoop", AssertionError("a run was computed again"))
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
    assert figure.axes[0].get_title() == "mean and least to most of 3 runs"
    assert swept.influence()["disc.synthetic.seed"] >= 0.0  # no order, no rank


def test_a_hardness_that_decides_nothing_is_told_with_the_reason() -> None:
    """A disc at rest runs in until no cell bears the hardness; early it decides."""
    vary = {"contact.hardness": ["500 MPa", "700 MPa"], "contact.load": ["6 N", "8 N"]}
    late, early = (
        summary_text(warpwear.sweep(small().replace({"sliding.distance": d}), vary=vary, executor=Here()))
        for d in ("60 mm", "0.1 mm")
    )
    assert "contact.hardness without influence at the end: a disc at rest runs in" in late
    assert "without influence" not in early


def test_a_table_holds_no_formula_of_a_spreadsheet(tmp_path: Path, quick_pictures: Any) -> None:
    """As in the table of a comparison; the run is found again, so that the sweep may go on."""
    names = ["=1+2", "plain"]
    vary = {"study.description": names, "contact.load": ["8 N"]}
    for _ in range(2):
        with quick_pictures(blank=True):
            warpwear.sweep(small(), vary=vary, out=tmp_path / "out", executor=Here())
    text = (tmp_path / "out" / "table.csv").read_text(encoding="utf-8")
    assert "'=1+2" in text
    assert ",=1+2" not in text
    assert "\n=1+2" not in text


def test_a_dry_run_says_a_cost_and_no_failure(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    """Runs that were not asked for have not failed; records are read before, by the speed of the study."""
    (tmp_path / "cof.csv").write_text("Time [s],CoF\n0,0.5\n1,0.5\n2,0.5\n", encoding="utf-8")
    how = {"executor": Here(), "dry_run": True, "experiments": [tmp_path / "cof.csv"]}
    dry = warpwear.sweep(small(), vary={"contact.load": ["8 N"]}, out=tmp_path / "out", **how)
    assert dry.cost.startswith("1 run: about ")
    assert not [w for w in recwarn if w.category is warpwear.StudyWarning]
