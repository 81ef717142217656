"""Files that a study names are exchanged before, while and after a sweep: no row is of another body."""

import csv
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_sweeps import ROOT, small
from fuzzing import numbers

import warpwear
from warpwear import InputError, Result, Study
from warpwear.batches.batch import RUNS, make_runs
from warpwear.batches.plan import Plan, section_of
from warpwear.engine.workers import Here
from warpwear.results.ensemble import digests_in
from warpwear.runs.loop import StepLoop
from warpwear.study.keys import declarations
from warpwear.study.loading import FILES
from warpwear.study.study import Content
from warpwear.surfaces import formats
from warpwear.surfaces.reading import digest_of, read

ARRAY = {"pixel": "10 um", "height_unit": "mm", "level": "none"}
DISC = {
    "disc.synthetic": None,
    "disc.surface": "{}",
    **{f"disc.{key}": value for key, value in ARRAY.items()},
}
COUNTER = {f"counter.{key}": value for key, value in ({"shape": "measured", "surface": "{}"} | ARRAY).items()}
LIKE = {"disc.synthetic": {"like": "{}", "period": "0.5 mm", "cut_off": "50 um"}}
#: By the bearing curve smooth bodies wear, which read the disc's file for that alone.
CURVE = {"study.model": "macro", "wear.law": "bearing-curve", "stepping.scheme": "implicit"}
#: What names files, in every way.
WAYS: dict[str, dict[str, Any]] = {
    "disc": DISC,
    "counter": COUNTER,
    "one file for both": DISC | COUNTER,
    "like a profile": LIKE,
    "bearing curve": DISC | CURVE,
}
#: Few cells and steps.
SHORT = {"grid.cell": "20 um", "sliding.distance": "0.3 mm"}
#: Texts of a study that name no file.
TEXTS = {"study.name", "study.description", "study.author", "study.publisher", "study.license", "disc.array"}
TEXTS |= {"counter.array", "counter.material", "disc.material", "counter.layers.name", "disc.layers.name"}
#: Exchanges of all in the mass trial.
EXCHANGES = 12


def write(way: str, path: Path, seed: int) -> None:
    """Write a file of one of two bodies, in one go."""
    new = path.with_name("new")
    if way == "like a profile":
        heights = np.random.default_rng(seed).normal(size=1500)
        lines = (f"{2 * i},{z}" for i, z in enumerate(heights))
        new.write_text("\n".join(["x [um],z [um]", *lines]), encoding="utf-8")
    else:
        x = 0.01 * (np.arange(120) - 59.5)
        rough = np.random.default_rng(seed).normal(scale=1.0e-3, size=(120, 120))
        bulge = 0.0 if way in ("disc", "bearing curve") else seed / 6.0
        with new.open("wb") as file:
            np.save(file, rough - bulge * np.add.outer(x**2, x**2))
    new.replace(path)


def study_of(way: str, path: Path) -> Study:
    changes = {
        key: {name: str(path) if word == "{}" else word for name, word in value.items()}
        if isinstance(value, dict)
        else str(path)
        if value == "{}"
        else value
        for key, value in WAYS[way].items()
    }
    return small(**{**SHORT, **changes})


def planned(study: Study) -> Plan:
    return Plan(study, section_of({"vary": {"contact.load": ["8 N"]}}, {}))


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(folder.rglob("*.h5"))}


@pytest.fixture(params=WAYS)
def way(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def path(way: str, tmp_path: Path) -> Path:
    place = tmp_path / "named file"
    write(way, place, 1)
    return place


def test_every_key_that_names_a_file_says_so(tmp_path: Path) -> None:
    """Any other text is known to name none, so that a new one has to say what it is."""
    texts = {name for name, key in declarations(Content).items() if key.field.annotation in (str, str | None)}
    assert texts - TEXTS == {"disc.surface", "disc.synthetic.like", "counter.surface"} == {*FILES}
    assert not [name for name in FILES if name.startswith("block.")]  # where `Study.files` looks for none
    assert {*FILES} == {key for way in WAYS for key in study_of(way, tmp_path).files}


def test_an_exchange_before_a_run_and_after_it(way: str, path: Path, tmp_path: Path) -> None:
    """Runs are not made on another file, and found whatever is there now; they are nobody else's."""
    plan, out = planned(study_of(way, path)), tmp_path / "store"
    write(way, path, 2)
    (key, *_) = plan.study.files
    for row in make_runs(plan, out, Here()):
        assert row.status.startswith(f"failed: {key} '{path}' is not the file any more that the sweep was")
    assert not contents(out)
    write(way, path, 1)
    right = make_runs(plan, out, Here())
    assert [(row.status, row.was_there) for row in right] == [("done", False)]
    stored = contents(out)
    write(way, path, 2)
    again = make_runs(plan, out, Here())
    assert [(row.ends, row.was_there) for row in again] == [(row.ends, True) for row in right]
    path.unlink()
    assert [row.was_there for row in make_runs(plan, out, Here())] == [True]
    assert contents(out) == stored
    write(way, path, 2)
    others = make_runs(planned(study_of(way, path)), out, Here())
    assert all(one.ends != other.ends for one, other in zip(right, others, strict=True))
    assert stored.items() < contents(out).items()


def test_the_same_file_elsewhere_is_the_same_run(way: str, path: Path, tmp_path: Path) -> None:
    """Who shares the runs has the file under another name, or a link to it; no run is written again."""
    out = tmp_path / "store"
    make_runs(planned(study_of(way, path)), out, Here())
    stored = contents(out)
    (tmp_path / "others").mkdir()
    copy, link = tmp_path / "others" / "copy", tmp_path / "others" / "link"
    shutil.copy(path, copy)
    link.symlink_to(path)
    for place in (copy, link):
        assert all(row.was_there for row in make_runs(planned(study_of(way, place)), out, Here()))
    assert contents(out) == stored


def test_an_exchange_while_the_steps_are_made(
    way: str, path: Path, tmp_path: Path, watch: Callable[..., None]
) -> None:
    """What was read is what the run is of, and is recorded."""
    plan = planned(study_of(way, path))
    (right,) = make_runs(plan, tmp_path / "right", Here())
    watch(StepLoop, "_make_steps", lambda *_: write(way, path, 2))
    (row,) = make_runs(plan, tmp_path / "s", Here())
    assert (row.status, row.ends) == ("done", right.ends)
    with Result.open(tmp_path / "s" / RUNS / plan.points[0].run) as result:
        assert digests_in(result) == result.record["files"] == plan.points[0].files
        assert digest_of(path) not in result.record["files"].values()


@pytest.mark.parametrize("how", ["in its place", "by a link"])
def test_a_file_changed_and_changed_back_while_it_is_read(
    how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its digest is that of the heights that were read."""
    one, other, path = (tmp_path / name for name in ("1", "2", "s.npy"))
    write("disc", one, 1)
    write("disc", other, 2)
    read_raw = formats.read_raw

    def put(source: Path) -> None:
        if how == "by a link":
            path.unlink(missing_ok=True)
            path.symlink_to(source)
        else:
            shutil.copy(source, path)

    def exchanged(source: formats.SurfaceFile) -> formats.Raw:
        put(other)
        raw = read_raw(source)
        put(one)
        return raw

    put(one)
    monkeypatch.setattr(formats, "read_raw", exchanged)
    reading = read(path, pixel=0.01, height_unit="mm")
    assert reading.digest == digest_of(one)
    np.testing.assert_array_equal(reading.heights, np.load(one))


def test_an_exchange_between_the_kill_of_a_run_and_its_resumption(
    way: str, path: Path, tmp_path: Path
) -> None:
    """It goes on with the file that it began with alone, in a sweep and as a run by itself."""
    study, out = study_of(way, path), tmp_path / "s"
    plan = planned(study)
    (right,) = make_runs(plan, tmp_path / "right", Here())
    folder = out / RUNS / plan.points[0].run
    steps: list[Any] = []

    def stop(step: Any) -> None:
        steps.append(step)
        if len(steps) == 3:
            raise KeyboardInterrupt

    changes = {"contact.load": "8 N", "run.checkpoint": "0 s"}
    with pytest.raises(KeyboardInterrupt):
        warpwear.run(study.replace(changes), out=folder, plots=False, callback=stop)
    kept = (folder / "checkpoint.h5").read_bytes()
    write(way, path, 2)
    (row,) = make_runs(plan, out, Here())
    assert row.status.startswith("failed: ")
    with pytest.raises(InputError, match=r"cannot go on: |is not what it was"):
        warpwear.run(study.replace(changes), out=folder, plots=False, resume=True)
    assert (folder / "checkpoint.h5").read_bytes() == kept
    write(way, path, 1)
    (row,) = make_runs(plan, out, Here())
    assert (row.status, row.ends, row.was_there) == ("done", right.ends, False)
    (folder / "checkpoint.h5").write_bytes(kept)  # killed when its result was in place
    result = (folder / "result.h5").read_bytes()
    write(way, path, 2)
    (row,) = make_runs(plan, out, Here())
    assert (row.status, row.ends, row.was_there) == ("done", right.ends, True)
    assert (folder / "result.h5").read_bytes() == result
    assert not (folder / "checkpoint.h5").exists()


def test_a_finished_run_is_not_resumed_on_another_file(way: str, path: Path, tmp_path: Path) -> None:
    study, out = study_of(way, path), tmp_path / "out"
    warpwear.run(study, out=out, plots=False).close()
    stored = contents(out)
    warpwear.run(study, out=out, plots=False, resume=True).close()
    write(way, path, 2)
    with pytest.raises(InputError, match=r"holds a run on what .* was before"):
        warpwear.run(study, out=out, plots=False, resume=True)
    assert contents(out) == stored


def test_a_whole_run_that_cannot_be_understood_is_left_alone(
    tmp_path: Path, failing: Callable[[str, Exception], None]
) -> None:
    """As that of another version may be, in a folder that several share."""
    plan = planned(small())
    make_runs(plan, tmp_path, Here())
    stored = contents(tmp_path)
    failing("warpwear.Result.open", InputError("this version knows no such key"))
    for row in make_runs(plan, tmp_path, Here()):
        assert row.status == "failed: this version knows no such key."
    assert contents(tmp_path) == stored


def sweep_of(study: Path, out: Path, store: Path) -> "subprocess.Popen[str]":
    command = ["sweep", str(study), "--vary", "contact.load=6 N,7 N,8 N,9 N", "--out", str(out), "--resume"]
    return subprocess.Popen(
        [sys.executable, "-m", "warpwear", *command, "--workers", "2", "--runs", str(store)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def rows_of(out: Path) -> dict[str, dict[str, str]]:
    with (out / "table.csv").open(newline="", encoding="utf-8-sig") as file:
        rows = [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]
    return {row["run"]: row for row in rows}


@pytest.mark.slow
def test_files_exchanged_at_random_under_sweeps(way: str, path: Path, tmp_path: Path) -> None:
    """Two workers, a store shared with sweeps of both bodies, and kills: a row is right, or says why not."""
    dice, file = random.Random(numbers(EXCHANGES).start), tmp_path / "s.toml"
    file.write_text(study_of(way, path).to_toml(), encoding="utf-8")
    right: dict[str, dict[str, str]] = {}
    for seed in (1, 2):
        write(way, path, seed)
        alone = sweep_of(file, tmp_path / f"alone{seed}", tmp_path / f"store{seed}")
        assert alone.wait() == 0, alone.communicate()[1]
        right |= rows_of(tmp_path / f"alone{seed}")
    assert len(right) == 8
    whole: dict[str, bytes] = {}
    told: list[str] = []
    for number in numbers(EXCHANGES):
        store = tmp_path / f"shared{number // 3}"
        whole = {name: content for name, content in whole.items() if name.startswith(f"{store}/")}
        write(way, path, dice.choice((1, 2)))
        process = sweep_of(file, out := tmp_path / f"s{number}", store)
        end = time.monotonic() + (dice.uniform(0.5, 15.0) if dice.random() < 0.3 else 600.0)
        while process.poll() is None and time.monotonic() < end:
            time.sleep(dice.uniform(0.0, 2.0))
            write(way, path, dice.choice((1, 2)))
        process.kill()
        _, errors = process.communicate()
        assert "Traceback" not in errors
        for name, row in rows_of(out).items() if (out / "table.csv").is_file() else ():
            if row["status"] == "done":
                assert {k: v for k, v in row.items() if k != "number"} == {
                    k: v for k, v in right[name].items() if k != "number"
                }
            else:
                assert re.search(r"named file' (is not the file any more|changed while)", row["status"]), row
            told.append(row["status"][:6])
        now = contents(store)
        assert whole.items() <= now.items()
        whole = {name: content for name, content in now.items() if name.endswith("result.h5")}
    print(way, {status: told.count(status) for status in {*told}}, len(whole), "results")
