"""Runs of a sweep in a comparison: bands over a key, names by what differs."""

import csv
import json
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_comparison import gather, refusal, warpwear_compare

import warpwear
from warpwear import Study
from warpwear.batches.batch import make_runs
from warpwear.batches.plan import Plan, section_of
from warpwear.comparison.figures import FIGURES
from warpwear.figures.paint import paint
from warpwear.sweeps.table import SweepResult


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
    with quick_pictures(blank=True):
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
    assert panel.get_title() == "mean and least to most of 3 runs"
    areas = np.array([run.courses["area_contact"][1] for run in read.groups[0].rows])
    assert np.allclose(panel.get_lines()[0].get_ydata(), areas.mean(axis=0))
    corners = panel.collections[0].get_paths()[0].vertices[:, 1]
    assert corners.min() == pytest.approx(np.percentile(areas, 5.0, axis=0, method="weibull").min())
    assert corners.max() == pytest.approx(np.percentile(areas, 95.0, axis=0, method="weibull").max())
    mixed = gather([swept, runs / "soft"], band_over=["disc.synthetic.seed", "contact.load"])
    assert [len(group.rows) for group in mixed.groups] == [6, 1]


def test_runs_of_a_sweep_are_named_by_what_differs_between_them(swept: Path, runs: Path) -> None:
    folders = sorted(path for path in (swept / "runs").iterdir() if path.is_dir())
    labels = {f"load {load} N, seed {seed}" for load in (4, 8) for seed in (1, 2, 3)}
    assert {run.name for run in gather(folders).rows} == labels
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
    assert len(read.rows) == 2
    assert read.notes[0] == f"1 of the 3 runs of {stopped} failed and are left out."
    assert "given 2 times" in refusal(swept, next((swept / "runs").glob("*/")), *out)
