"""`warpwear compare` as a user meets it: its folder, its tables, and what it refuses."""

import csv
import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_comparison import refusal, warpwear_compare

import warpwear
from warpwear.comparison.figures import FIGURES

#: Drawn where a measured scar is given.
OF_SCARS = "scar", "groove"


def test_a_run_and_an_experiment(runs: Path, measured: Path, tmp_path: Path, quick_pictures: Any) -> None:
    out = tmp_path / "new" / "out"
    with quick_pictures(blank=True):
        done = warpwear_compare(runs / "a", "--experiment", measured, "--out", out)
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in out.iterdir()) == sorted(
        [
            *(f"{name}.png" for name in FIGURES if name not in ("area_load", *OF_SCARS)),
            "table.csv",
            "comparison.json",
            "compare.html",
            "manifest.json",
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
    assert "contact.load (a 8 N, light 4 N, soft 8 N, still 8 N)" in notes
    assert "sliding.distance (a 30 mm, light 60 mm" in notes
    assert "wear.disc (a 0.00127 mm³/(N·m), light 0.00127" in notes
    assert "wear.counter" not in notes
    # The legend of each names every run; SVG keeps text as paths and names as comments.
    for name in FIGURES.keys() - set(OF_SCARS):
        drawn = (out / f"{name}.svg").read_text(encoding="utf-8")
        labels = ("a", "light", "soft")
        if name == "area_load":  # where runs of one law make one series
            labels = ("computed: local, H = 590 MPa", "load over hardness")
        assert all(f"<!-- {label} -->" in drawn for label in labels)


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
    runs: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    failing: Callable[[str, Exception], None],
    quick_pictures: Any,
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
    kinds = [".csv", ".html", ".json", ".json"]
    assert sorted(path.suffix for path in out.iterdir()) == [*kinds, ".svg", ".svg", ".txt"]
    # A failure while writing leaves the old one.
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    failing("warpwear.comparison.compare.write_json", OSError(28, "No space left on device"))
    with quick_pictures(blank=True):
        assert "could not be written: No space left on device." in refusal(*arguments, "--overwrite")
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_experiments_alone_have_one_figure(measured: Path, tmp_path: Path) -> None:
    other = shutil.copy(measured, tmp_path / "other.csv")
    out = tmp_path / "out"
    done = warpwear_compare("--experiment", measured, "--experiment", other, "--out", out)
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in out.iterdir()) == [
        "cof.png",
        "compare.html",
        "comparison.json",
        "manifest.json",
        "table.csv",
    ]


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
