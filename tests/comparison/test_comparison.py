"""`warpwear compare` as a user meets it, and the numbers it gives."""

import csv
import json
import math
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from click.testing import CliRunner, Result

import warpwear
from warpwear import Study
from warpwear.cli.compare import compare
from warpwear.comparison import figures
from warpwear.comparison.figures import FIGURES
from warpwear.comparison.gather import gather, means_of_parts, rms_difference, shape_of
from warpwear.comparison.table import to_text, write_csv
from warpwear.errors import InputError
from warpwear.figures.describe import Chart, Line
from warpwear.figures.paint import paint
from warpwear.measured.experiment import Experiment
from warpwear.sweeps.plan import Plan, section_of
from warpwear.sweeps.sweep import make_runs
from warpwear.sweeps.table import SweepResult

#: Drawn where a measured scar is given.
OF_SCARS = "scar", "groove"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders of runs: 'a', at half the load 'light', with another disc 'soft', and static 'still'."""
    folder = tmp_path_factory.mktemp("runs")
    study = Study.load("v3-fine").replace(
        {"grid.cell": "10 um", "sliding.distance": "30 mm", "output.snapshots": ["3 mm", "30 mm"]}
    )
    light = {"contact.load": "4 N", "sliding.distance": "60 mm", "sliding.speed": "40 mm/min"}
    soft = {"wear.disc": "25e-4 mm^3/N/m", "friction.ploughing": 0.05, "study.name": "soft"}
    still = {"sliding.distance": "0 mm", "output.snapshots": [], "study.name": "still"}
    for name, changes in {"a": {}, "light": light, "soft": soft, "still": still}.items():
        warpwear.run(study.replace(changes), out=folder / name, plots=False).close()
    return folder


@pytest.fixture
def measured(tmp_path: Path) -> Path:
    """μ = 0.1 + √(distance/mm)/100 with two columns that could be it."""
    distance = np.linspace(0.0, 40.0, 801)
    path = tmp_path / "sample 3.csv"
    header = "Distance [m];COF"
    table = np.column_stack([distance / 1e3, 0.1 + 0.01 * np.sqrt(distance)])
    np.savetxt(path, table, delimiter=";", header=header, comments="", fmt="%.9f")
    return path


def warpwear_compare(*arguments: str | Path) -> Result:
    return CliRunner().invoke(compare, [*map(str, arguments)])


def refusal(*arguments: str | Path) -> str:
    done = warpwear_compare(*arguments)
    assert isinstance(done.exception, InputError), done.output
    return str(done.exception)


def test_a_run_and_an_experiment(runs: Path, measured: Path, tmp_path: Path, quick_pictures: Any) -> None:
    out = tmp_path / "new" / "out"
    with quick_pictures():
        done = warpwear_compare(runs / "a", "--experiment", measured, "--out", out)
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in out.iterdir()) == sorted(
        [
            *(f"{name}.png" for name in FIGURES if name not in ("area_load", *OF_SCARS)),
            "table.csv",
            "comparison.json",
            "compare.html",
        ]
    )
    with warpwear.Result.open(runs / "a") as result:
        summary, history = result.summary, result.history
    with (out / "table.csv").open(encoding="utf-8") as file:
        run, experiment = csv.DictReader(file)
    assert (run["name"], run["kind"]) == ("v3-fine", "run")
    assert (experiment["name"], experiment["kind"]) == ("sample 3", "experiment")
    expected = {
        "patch_along [mm]": summary["scar_mm"]["along"],
        "patch_across [mm]": summary["scar_mm"]["across"],
        "depth_counter [um]": summary["depth_um"]["counter"],
        "depth_disc [um]": summary["depth_um"]["disc"],
        "volume_counter [mm^3]": summary["volume_mm3"]["counter"],
        "volume_disc [mm^3]": summary["volume_mm3"]["disc"],
        "area_contact [mm^2]": summary["area_mm2"]["contact"],
        "pressure_mean [MPa]": summary["pressure_MPa"]["mean"],
        "cof [1]": history["cof"][-1],
        "exponent_m [1]": summary["cof_shape"]["exponent_m"],
        "levelling_lambda [1]": summary["cof_shape"]["levelling_lambda"],
        "steps [1]": history["distance"].size,
        "cell [um]": 10.0,
    }
    assert {key: float(run[key]) for key in expected} == pytest.approx(expected, rel=1e-9)
    places = np.linspace(history["distance"][0], 30.0, 200_001)
    gap = np.interp(places, history["distance"], history["cof"]) - (0.1 + 0.01 * np.sqrt(places))
    assert float(run["rms_cof sample 3 [1]"]) == pytest.approx(math.sqrt(np.mean(gap**2)), rel=1e-4)
    assert experiment["depth_disc [um]"] == ""
    assert float(experiment["cof [1]"]) == pytest.approx(0.1616, abs=1e-4)
    document = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    assert document["comparison"]["v3-fine"]["steps"] == history["distance"].size
    assert document["units"]["pressure_mean"] == "MPa"
    for words in (
        "scar, along sliding, mm",
        "CoF − sample 3 (rms)",
        "m and λ are of the coefficient",
        "from 'Distance [m]'",
        "v3-fine: cells of 10 µm do not resolve",
    ):
        assert words in done.output
    assert "Unlike tests" not in done.output


def test_runs_that_are_unlike_and_named_alike(runs: Path, tmp_path: Path, quick_pictures: Any) -> None:
    out = tmp_path / "out"
    arguments = (runs / "a", runs / "light", runs / "soft", runs / "still", "--out", out)
    with quick_pictures(blank=True):  # the pictures of its page
        done = warpwear_compare(*arguments, "--format", "svg")
    assert done.exit_code == 0, done.output
    document = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    assert list(document["comparison"]) == ["a", "light", "soft", "still"]
    assert document["comparison"]["still"]["exponent_m"] is None
    with warpwear.Result.open(runs / "soft") as result:
        distance, cof = result.history["distance"], result.history["cof"]
        of_area = result.summary["area_shape"]["exponent_m"]
        of_cof = result.summary["cof_shape"]["exponent_m"]
    late = distance >= 15.0
    slope = np.cov(np.log(distance[late]), np.log(cof[late]))
    found = document["comparison"]["soft"]["exponent_m"]  # flatter than the area's: ploughing does not grow
    assert found == pytest.approx(slope[0, 1] / slope[0, 0], rel=1e-9)
    assert found == pytest.approx(of_cof, rel=1e-12)
    assert found < of_area - 0.05
    notes = "\n".join(document["notes"])
    assert "differ in load (a 8 N, light 4 N, soft 8 N, still 8 N)" in notes
    assert "differ in sliding distance (a 30 mm, light 60 mm" in notes
    assert "differ in wear coefficient of the disc (a 0.00127 mm³/(N·m), light 0.00127" in notes
    assert "wear coefficient of the counter-body" not in notes
    # The legend of each names every run; SVG keeps text as paths and names as comments.
    for name in FIGURES.keys() - set(OF_SCARS):
        drawn = (out / f"{name}.svg").read_text(encoding="utf-8")
        labels = ("a", "light", "soft")
        if name == "area_load":  # where runs of one law make one series
            labels = ("computed: local, H = 590 MPa", "load over hardness")
        assert all(f"<!-- {label} -->" in drawn for label in labels)


def test_ends_that_are_inputs_are_told_and_notes_are_said_once(tmp_path: Path) -> None:
    """Three loads calibrated at their ends: 0.55 three times, which compares nothing."""
    study = Study.load("v3-fine").replace(
        {"grid.cell": "10 um", "sliding.distance": "30 mm", "friction.coefficient": 0.55}
    )
    names = ["l2", "l4", "l8"]
    for name in names:
        loaded = study.replace({"contact.load": f"{name[1]} N"})
        warpwear.run(loaded, out=tmp_path / name, plots=False).close()
    told = gather([tmp_path / name for name in names])
    text = to_text(told)
    assert re.search(r"^coefficient of friction at the end +0\.55 +0\.55 +0\.55$", text, re.MULTILINE)
    assert re.search(r"^CoF that is an input +end +end +end$", text, re.MULTILINE)
    strengths = [run.summary["shear_strength_MPa"] for run in told.runs]
    assert len(set(strengths)) == 3
    for run, found in zip(told.runs, strengths, strict=True):
        assert found == pytest.approx(0.55 * run.study.contact.load / run.history["area_contact"][-1])
    line = " +".join(f"{found:.4g}" for found in strengths)
    assert re.search(rf"^shear strength τ0, MPa +{line}$", text, re.MULTILINE)
    assert len(told.notes) == 4  # unlike loads, late snapshots, coarse cells, inputs
    assert sum(note.startswith("l2, l4, l8: cells of 10 µm") for note in told.notes) == 1
    assert told.notes[-1].startswith(
        "The CoF at the end of l2, l4, l8 is an input (friction.calibrate = 'end')"
    )
    assert figures.cof(told).panels[0].note == "the end is an input of 3 of 3 runs"  # type: ignore[union-attr]
    write_csv(told, tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8") as file:
        assert [row["cof_input [1]"] for row in csv.DictReader(file)] == ["end", "end", "end"]


def test_representative_patches_are_told_beside_whole_ones(runs: Path, tmp_path: Path) -> None:
    """And a two-scale run beside one of one scale."""
    changes = {"grid.cell": "10 um", "disc.synthetic.cut_off": "20 um", "grid.extent": "1.2 mm"}
    changes |= {"sliding.distance": "0.1 mm", "patches.macro_cell": "300 um", "output.snapshots": []}
    for name, patch in {"whole": "300 um", "part": "150 um"}.items():
        study = Study.load("two-scale").replace(changes | {"patches.width": patch, "study.name": name})
        warpwear.run(study, out=tmp_path / name, plots=False).close()
    read = gather([tmp_path / "whole", tmp_path / "part"])
    told = [note for note in read.notes if note.startswith("Unlike tests")]
    assert told == ["Unlike tests: the runs differ in patches.width (whole 300 µm, part 150 µm)."]
    lines = {line.split("  ")[0]: line.split()[-2:] for line in to_text(read).splitlines()}
    assert lines["patches.macro_cell, µm"] == ["300", "300"]
    assert lines["patches.width, µm"] == ["300", "150"]
    beside = gather([runs / "a", tmp_path / "part"])
    assert "Unlike tests: the runs differ in model (v3-fine micro, part two-scale)." in beside.notes
    assert not any("differ in patches." in note for note in beside.notes)
    assert "patches.width" not in to_text(gather([runs / "a", runs / "light"]))


def test_two_folders_of_one_name_go_by_their_paths(runs: Path, tmp_path: Path) -> None:
    shutil.copytree(runs / "a", tmp_path / "a")
    names = [run.name for run in gather([runs / "a", tmp_path / "a", runs / "soft"]).runs]
    assert names == [str(runs / "a"), str(tmp_path / "a"), "soft"]
    copy = shutil.copy(runs / "a" / "history.csv", tmp_path / "soft.csv")
    read = gather([runs / "soft"], [copy], columns="distance [mm],cof [1]")
    assert [e.name for e in read.experiments] == ["soft (experiment)"]
    assert read.rms(read.runs[0], read.experiments[0]) is not None


def test_a_runs_own_history_differs_by_nothing(runs: Path) -> None:
    read = gather([runs / "a"], [runs / "a" / "history.csv"], columns="distance,cof")
    assert read.rms(read.runs[0], read.experiments[0]) == pytest.approx(0.0, abs=1e-11)


def test_time_takes_the_runs_speed_unless_they_differ(runs: Path, tmp_path: Path) -> None:
    record = tmp_path / "record.txt"
    record.write_text("Zeit [min]\tReibwert\n0\t0,1\n1\t0,2\n2\t0,2\n", encoding="utf-8")
    alike = gather([runs / "a", runs / "soft"], [record])
    assert alike.experiments[0].distance.tolist() == pytest.approx([0.0, 20.0, 40.0])
    with pytest.raises(InputError, match="a speed is needed"):
        gather([runs / "a", runs / "light"], [record])
    told = gather([runs / "a", runs / "light"], [record], speed="1 mm/s")
    assert told.experiments[0].distance.tolist() == [0.0, 60.0, 120.0]
    assert not any("mm long" in note for note in told.notes)  # twice the longer run's
    slow = gather([runs / "a", runs / "light"], [record], speed="1 um/s")
    assert "record: It is 0.12 mm long, the runs 30, 60 mm." in slow.notes
    twice = gather([runs / "a", runs / "soft"], [record], speed="1 um/s")
    assert "record: It is 0.12 mm long, the runs 30 mm." in twice.notes
    single = gather([runs / "a"], [record], speed="1 um/s")
    assert "record: It is 0.12 mm long, the run 30 mm." in single.notes


def test_a_raw_record_is_told_by_its_last_cycle_and_its_load(runs: Path, tmp_path: Path) -> None:
    part = np.arange(1600) / 200  # of a pass of 30 mm, eight of them
    position = 30.0 * np.where(part % 2 < 1, part % 1, 1 - part % 1)
    table = np.column_stack([np.where(part % 2 < 1, 1.5, -1.5), np.full(1600, 5.0), position])
    record = tmp_path / "raw.csv"
    np.savetxt(record, table, delimiter=";", header="Fx (N);Fz (N);X position (mm)", comments="", fmt="%.6f")
    notes = gather([runs / "a"], [record], stroke="30 mm").notes
    assert notes[0] == "raw: Warning: the median of the normal force is 5 N where the run has 8 N."
    (told,) = (note for note in notes if "last cycle" in note)
    assert told == "raw: The middle of its last cycle is at 210 mm, the run 30 mm long."


def test_gaps_of_a_measured_course_are_told_or_refused(runs: Path, tmp_path: Path) -> None:
    record = tmp_path / "holes.csv"

    def notes(places: np.ndarray) -> str:
        np.savetxt(
            record, np.c_[places, 0.3 + 0 * places], delimiter=";", header="Distance [mm];COF", comments=""
        )
        return "\n".join(gather([runs / "a"], [record]).notes)

    assert "no measured point" not in notes(np.linspace(0.0, 30.0, 6))  # few, but even
    assert "no measured point" not in notes(30.0 * np.linspace(0.0, 1.0, 60) ** 2)  # dense at first
    some = notes(np.concatenate([np.arange(0.0, 10.0, 0.1), np.arange(22.0, 30.1, 0.1)]))
    # From 9.9 to 22 mm of the 0.3 to 30 mm that both have, or a little more.
    assert re.search(r"holes: It has no measured point over 4[01] % of .* from 9\.9 to 22 mm:", some)
    with pytest.raises(
        InputError, match=r"no measured point over 6\d % .* from 9\.9 to 28 mm; points over half"
    ):
        notes(np.concatenate([np.arange(0.0, 10.0, 0.1), np.arange(28.0, 30.1, 0.1)]))


def test_both_courses_are_drawn_over_their_mean_in_the_last_tenth(runs: Path, measured: Path) -> None:
    read = gather([runs / "a"], [measured])
    right = FIGURES["cof"](read).panels[1]
    assert isinstance(right, Chart)
    assert "last tenth" in right.note
    assert len(right.lines) == 2
    for line in right.lines:
        assert isinstance(line, Line)
        places = np.linspace(0.9, 1.0, 10_001) * line.x[-1]
        assert np.interp(places, line.x, line.y).mean() == pytest.approx(1.0, abs=2e-3)


def test_what_is_refused_leaves_nothing_behind(runs: Path, measured: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    run = runs / "a"
    assert "two runs or more, or a run and an --experiment or a --scar; given: nothing." in refusal(
        "--out", out
    )
    assert f"given: {run}." in refusal(run, "--out", out)
    assert "given: " in refusal(run, "--out", runs / "a")  # before it looks at the folder
    assert "given: " in refusal("--experiment", measured, "--out", out)
    assert "is given 2 times" in refusal(run, runs / "." / "a", "--out", out)
    assert f"{tmp_path} holds no result" in refusal(run, tmp_path, "--out", out)
    assert "cannot be read" in refusal(run, "--experiment", tmp_path / "no.csv", "--out", out)
    assert "format = 'jpg'" in refusal(run, runs / "soft", "--format", "jpg", "--out", out)
    for speed in ("20", "-1 mm/s", "3 kg"):
        assert f"--speed = '{speed}'" in refusal(
            run, "--experiment", measured, "--speed", speed, "--out", out
        )
    assert "holds other files" in refusal(run, runs / "soft", "--out", runs / "a")
    assert "is a file" in refusal(run, runs / "soft", "--out", measured)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["sample 3.csv"]


def test_a_comparison_is_replaced_only_when_asked(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, quick_pictures: Any
) -> None:
    for name in FIGURES.keys() - {"cof", "area"}:  # the others are drawn elsewhere
        monkeypatch.delitem(FIGURES, name)
    out = tmp_path / "out"
    arguments = (runs / "a", runs / "soft", "--out", out)
    with quick_pictures():
        assert warpwear_compare(*arguments).exit_code == 0
    (out / "mine.txt").write_text("kept")
    before = (out / "cof.png").read_bytes()
    told = (
        "already holds a comparison; give another folder (out), or overwrite it (--overwrite, overwrite=True)"
    )
    assert f"{told}." in refusal(*arguments)
    assert (out / "cof.png").read_bytes() == before
    with quick_pictures(blank=True):
        done = warpwear_compare(*arguments, "--overwrite", "--format", "svg")
    assert done.exit_code == 0, done.output
    assert (out / "mine.txt").read_text() == "kept"
    assert sorted(path.suffix for path in out.iterdir()) == [".csv", ".html", ".json", ".svg", ".svg", ".txt"]
    # A failure while writing leaves the old one.
    before = {path.name: path.read_bytes() for path in out.iterdir()}

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("warpwear.comparison.folder.write_json", full)
    with quick_pictures(blank=True):
        assert "could not be written: No space left on device." in refusal(*arguments, "--overwrite")
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_files_of_the_runs_are_closed(runs: Path) -> None:
    gather([runs / "a", runs / "soft"])
    with h5py.File(runs / "a" / "result.h5", "r+"):  # refused while it is open elsewhere for reading
        pass


def test_experiments_alone_have_one_figure(measured: Path, tmp_path: Path) -> None:
    other = shutil.copy(measured, tmp_path / "other.csv")
    out = tmp_path / "out"
    done = warpwear_compare("--experiment", measured, "--experiment", other, "--out", out)
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in out.iterdir()) == [
        "cof.png",
        "compare.html",
        "comparison.json",
        "table.csv",
    ]


def test_rms_difference_of_straight_lines() -> None:
    one, other = np.array([0.0, 3.0]), np.array([1.0, 2.0, 5.0])
    # x against 0 from 1 to 3: the mean of x² is 26/6.
    assert rms_difference(one, one, other, np.zeros(3)) == pytest.approx(math.sqrt(26 / 6))
    assert rms_difference(one, one, other + 3.0, np.zeros(3)) is None


def test_shape_of_a_noisy_square_root_and_of_too_few_points() -> None:
    distance = np.linspace(0.0, 100.0, 20_001)
    noise = np.random.default_rng(4).normal(0.0, 0.02, distance.size)
    found = shape_of(Experiment("root", distance, np.sqrt(distance) / 10 + noise))
    assert found["exponent_m"] == pytest.approx(0.5, abs=0.01)
    # Secants of √x: (1 − √½)/½ over (√0.1 − √(1/80))/(0.1 − 1/80).
    expected = (1 - math.sqrt(0.5)) / 0.5 / ((math.sqrt(0.1) - math.sqrt(1 / 80)) / (0.1 - 1 / 80))
    assert found["levelling_lambda"] == pytest.approx(expected, rel=0.05)
    late = shape_of(Experiment("late", distance[2000:], np.sqrt(distance[2000:])))
    assert set(late) == {"exponent_m"}
    assert shape_of(Experiment("few", distance[::2000], np.sqrt(distance[::2000]))) == {}


def test_means_of_parts_are_over_the_distance() -> None:
    """Rows that lie ten times as close weighted ten times as much, and hid what came after."""
    dense, sparse = np.linspace(0.0, 50.0, 501), np.linspace(51.0, 100.0, 50)
    distance = np.concatenate([dense, sparse, 100.0 + dense[1:], 100.0 + sparse])
    places, means, same = means_of_parts(2, distance, distance**2, np.full(distance.size, 0.3))
    assert places == pytest.approx([50.0, 150.0])
    assert means == pytest.approx([100.0**2 / 3.0, 7.0 * 100.0**2 / 3.0], rel=1e-4)
    assert same == pytest.approx([0.3, 0.3], rel=1e-12)
    gap = np.array([0.0, 5.0, 70.0, 80.0, 100.0])  # parts without rows go
    assert means_of_parts(4, gap, gap)[0] == pytest.approx([12.5, 62.5, 87.5])


def test_names_that_a_spreadsheet_would_compute(
    runs: Path, measured: Path, tmp_path: Path, quick_pictures: Any
) -> None:
    """Names of files are text; numbers, negative ones too, stay numbers."""
    record = shutil.copy(measured, tmp_path / "=1+1.csv")
    out = tmp_path / "out"
    with quick_pictures(blank=True):
        done = warpwear_compare(runs / "a", "--experiment", record, "--out", out)
    assert done.exit_code == 0, done.output
    with (out / "table.csv").open(encoding="utf-8") as file:
        _, header, *rows = "", *csv.reader(file)
    assert [row[0] for row in rows] == ["v3-fine", "'=1+1"]
    for row in rows:
        for value in filter(None, row[2:]):
            float(value)
    assert "rms_cof =1+1 [1]" in header


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of two loads and three seeds."""
    study = Study.load("v3-fine").replace({"grid.cell": "10 um", "sliding.distance": "3 mm"})
    vary = {"contact.load": ["4 N", "8 N"], "disc.synthetic.seed": "1:3"}
    study = study.replace({"grid.extent": "1 mm", "output.snapshots": []})
    out = tmp_path_factory.mktemp("swept") / "loads"
    plan = Plan(study, section_of({"vary": vary}, {}))
    with ThreadPoolExecutor(1) as pool:
        SweepResult(plan, make_runs(plan, out, pool)).write_tables(out)
    return out


def test_runs_that_differ_in_a_seed_are_one_line_with_a_band(
    swept: Path, runs: Path, measured: Path, tmp_path: Path, quick_pictures: Any
) -> None:
    """And one column: mean ± standard deviation of them."""
    out = tmp_path / "out"
    with quick_pictures():
        done = warpwear_compare(
            *(swept, "--band-over", "disc.synthetic.seed", "--experiment", measured, "--out", out)
        )
    assert done.exit_code == 0, done.output
    cofs: dict[str, list[float]] = {"load 4 N": [], "load 8 N": []}
    for folder in swept.glob("runs/*/result.h5"):
        with warpwear.Result.open(folder) as result:
            cofs[f"load {result.study.contact.load:g} N"].append(float(result.history["cof"][-1]))
    with (out / "table.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == [*cofs, "sample 3"]
    for row, values in zip(rows, cofs.values(), strict=False):
        assert float(row["cof [1]"]) == pytest.approx(np.mean(values), rel=1e-9)
        assert float(row["cof_std [1]"]) == pytest.approx(np.std(values, ddof=1), rel=1e-6)
        assert row["runs"] == "3"
        assert len(row["folders"].split("; ")) == 3
        assert 0.0 < float(row["rms_cof sample 3 [1]"]) < 1.0
    mean, scatter = np.mean(cofs["load 4 N"]), np.std(cofs["load 4 N"], ddof=1)
    assert re.search(rf"coefficient of friction at the end +{mean:.4g} ± {scatter:.2g} ", done.output)
    document = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    assert document["groups"]["load 4 N"] == [f"load 4 N, seed {seed}" for seed in (1, 2, 3)]
    assert set(document["folders"]) == {run for group in document["groups"].values() for run in group}

    read = gather([swept], band_over=["disc.synthetic.seed"])
    panel = paint(FIGURES["area"](read)).axes[0]
    assert [line.get_label() for line in panel.get_lines()] == list(cofs)
    assert panel.get_title() == "mean and 5–95 % of 3 runs"
    areas = np.array([run.history["area_contact"] for run in read.groups[0].runs])
    assert np.allclose(panel.get_lines()[0].get_ydata(), areas.mean(axis=0))
    corners = panel.collections[0].get_paths()[0].vertices[:, 1]
    assert corners.min() == pytest.approx(np.percentile(areas, 5.0, axis=0, method="weibull").min())
    assert corners.max() == pytest.approx(np.percentile(areas, 95.0, axis=0, method="weibull").max())
    mixed = gather([swept, runs / "soft"], band_over=["disc.synthetic.seed", "contact.load"])
    assert [len(group.runs) for group in mixed.groups] == [6, 1]


def test_runs_of_a_sweep_are_named_by_what_differs_between_them(swept: Path, runs: Path) -> None:
    folders = sorted(path for path in (swept / "runs").iterdir() if path.is_dir())
    labels = {f"load {load} N, seed {seed}" for load in (4, 8) for seed in (1, 2, 3)}
    assert {run.name for run in gather(folders).runs} == labels
    assert [group.name for group in gather([swept]).groups] == sorted(labels)


def test_bands_over_what_does_not_differ_and_sweeps_without_a_table_are_refused(
    swept: Path, runs: Path, tmp_path: Path
) -> None:
    out = ("--out", tmp_path / "out")
    told = refusal(swept, "--band-over", "grid.cell", *out)
    assert told == (
        "--band-over grid.cell: the runs do not differ in it; they differ in contact.load, "
        "disc.synthetic.seed."
    )
    stopped = tmp_path / "stopped"
    shutil.copytree(swept / "runs", stopped / "runs")
    assert "warpwear sweep --resume" in refusal(stopped, *out)
    lines = (swept / "table.csv").read_text(encoding="utf-8").splitlines()
    failed = [*lines[:3], lines[3].replace("done", "failed: why")]
    (stopped / "table.csv").write_text("\n".join(failed), encoding="utf-8")
    read = gather([stopped])
    assert len(read.runs) == 2
    assert read.notes[0] == f"1 of the 3 runs of {stopped} failed and are left out."
    assert "given 2 times" in refusal(swept, next((swept / "runs").glob("*/")), *out)
