"""`warpwear compare --scar`: a scar cut by a run's own wear is that of the run."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_worn import PIXEL, seen, self_affine
from click.testing import CliRunner, Result

import warpwear
from warpwear import Study
from warpwear.cli.compare import compare
from warpwear.comparison.figures import FIGURES
from warpwear.comparison.scar import _shift
from warpwear.errors import InputError
from warpwear.results.track import blocks


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run, and its disc before and after, seen by an instrument, 1.1 times as deep."""
    folder = tmp_path_factory.mktemp("scar")
    study = Study.load("v3-fine").replace(
        {"grid.cell": "10 um", "sliding.distance": "100 mm", "output.snapshots": ["100 mm"]}
    )
    result = warpwear.run(study, out=folder / "run", plots=False)
    lost = result.snapshot(-1).wear_disc
    result.close()
    rng = np.random.default_rng(0)
    field = 1e-3 * self_affine(rng, (240, 240), hurst=0.8)
    noise = 3e-5 * rng.normal(size=(2, *lost.shape))
    np.save(folder / "after.npy", seen(field, lost.shape) - 1.1 * lost + noise[0])
    before = seen(field, lost.shape, shift=(0.02, -0.03), angle=0.02)
    np.save(folder / "before.npy", before + noise[1])
    np.save(folder / "um.npy", 1e3 * before)
    np.save(folder / "true.npy", 1.1 * lost)
    return folder


@pytest.fixture
def of_scars(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the figures of scars: the others are drawn elsewhere."""
    for name in FIGURES.keys() - {"scar", "groove"}:
        monkeypatch.delitem(FIGURES, name)


def warpwear_compare(here: Path, *more: str, out: str = "out") -> Result:
    arguments = [here / "run", "--out", here / out, "--pixel", "10 um", "--height-unit", "mm", *more]
    return CliRunner().invoke(compare, [*map(str, arguments)])


@pytest.mark.usefixtures("of_scars")
def test_a_scar_beside_its_run(here: Path) -> None:
    done = warpwear_compare(here, "--scar", str(here / "after.npy"), "--before", str(here / "before.npy"))
    assert done.exit_code == 0, done.output
    for words in ("the scar measured", "measured less it", "Sq in the scar"):
        assert words in done.output
    found = json.loads((here / "out/comparison.json").read_text(encoding="utf-8"))["scar"]
    measured, (computed,) = found["measured"], found["computed"].values()
    true = float(np.load(here / "true.npy").sum()) * 1e-4
    assert abs(measured["net_mm3"] - true) < 4 * measured["net_error_mm3"] + 2e-3 * true
    assert computed["volume_mm3"] == pytest.approx(true / 1.1, rel=2e-3)
    assert computed["difference_mm3"] == pytest.approx(0.1 / 1.1 * true, rel=0.05)
    assert measured["patch_across_mm"] == pytest.approx(computed["patch_across_mm"], rel=0.15)
    for name in ("scar.png", "groove.png"):
        assert (here / "out" / name).stat().st_size > 10_000
    assert "The scar, measured and computed" in (here / "out/compare.html").read_text(encoding="utf-8")


def refusal(here: Path, *more: str) -> str:
    done = warpwear_compare(here, *more, out="none")
    assert isinstance(done.exception, InputError), done.output
    assert not (here / "none").exists()
    assert "\n" not in done.exception.sentence
    return done.exception.sentence


def test_wrong_data_are_one_sentence(here: Path) -> None:
    after = str(here / "after.npy")
    assert "times as rough as FILE" in refusal(here, "--scar", after, "--before", str(here / "um.npy"))
    assert "the file's pixel has another unit" in refusal(
        here, "--scar", after, "--before", str(here / "before.npy"), "--pixel", "0.5 mm"
    )
    assert "--before needs --scar" in refusal(here, "--before", after)
    assert "does not exist" in refusal(here, "--scar", str(here / "none.npy"))


@pytest.mark.usefixtures("of_scars")
def test_a_scar_on_a_track(tmp_path: Path, quick_pictures: Any) -> None:
    """A swept run has its scar on the track; the two lie on each other to a part of a cell."""
    changes = {"grid.cell": "20 um", "grid.extent": "1.6 mm", "sliding.track": "2.4 mm", "sliding.shift": 2}
    disc = {"disc.synthetic.cut_off": "80 um", "disc.synthetic.roll_off": "300 um"}
    study = Study.load("track").replace(
        {**changes, **disc, "disc.synthetic.period": "2.4 mm", "sliding.distance": "240 mm"}
    )
    result = warpwear.run(study, out=tmp_path / "run", plots=False)
    lost = 1.1 * np.pad(blocks(result, len(result.snapshots) - 1, 2000).loss, ((30, 30), (20, 20)))
    result.close()
    rng = np.random.default_rng(0)
    field = 1e-3 * self_affine(rng, (300, 220), hurst=0.8)
    noise = 3e-5 * rng.normal(size=(2, *lost.shape))
    np.save(tmp_path / "after.npy", seen(field, lost.shape) - lost + noise[0])
    np.save(tmp_path / "before.npy", seen(field, lost.shape, shift=(0.02, -0.03), angle=0.02) + noise[1])
    files = ("--scar", str(tmp_path / "after.npy"), "--before", str(tmp_path / "before.npy"))
    with quick_pictures(blank=True):
        done = warpwear_compare(tmp_path, *files, "--pixel", "20 um")
    assert done.exit_code == 0, done.output
    found = json.loads((tmp_path / "out/comparison.json").read_text(encoding="utf-8"))["scar"]
    (computed,) = found["computed"].values()
    worn = 1e3 * float(np.sqrt(np.mean(lost[lost > 0.0] ** 2)))
    assert computed["rms_um"] < 0.2 * worn  # a tenth is missing, and half a pixel gives 0.3 of it
    assert computed["profile_rms_um"] < 2.0 * computed["profile_error_um"]
    true = float(lost.sum()) * 4e-4
    assert computed["volume_mm3"] == pytest.approx(true / 1.1, rel=0.01)
    measured = found["measured"]  # with the asperities that have worn alone beside the rest
    assert abs(measured["net_mm3"] - true) < 2.5 * measured["net_error_mm3"]


@pytest.mark.parametrize("off", [(0.0, 0.0), (0.031, -0.018)])
def test_scars_are_laid_on_each_other_within_a_pixel(off: tuple[float, float]) -> None:
    rng = np.random.default_rng(1)
    rough = np.maximum(self_affine(rng, (200, 160), roll_off=24.0, hurst=0.9), 0.5)[20:180, 20:140] - 0.5
    moved = seen(rough, (120, 90), shift=off)
    found = _shift(seen(rough, (120, 90)), moved, (4.0, 4.0), (PIXEL, PIXEL))
    assert found == pytest.approx(off, abs=0.2 * PIXEL)
