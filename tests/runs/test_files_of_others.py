"""Nothing in a run folder that no run wrote is ever replaced or deleted."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fuzzing import check_sentence

import warpwear
from warpwear import InputError, Study
from warpwear.results import manifest
from warpwear.results.folder import LOCK

WAYS: dict[str, dict[str, Any]] = {"anew": {}, "overwrite": {"overwrite": True}, "resume": {"resume": True}}


def study(**changes: str) -> Study:
    quick = {"grid.cell": "20 um", "sliding.distance": "0.01 mm", "output.snapshots": []}
    return Study.load("v3-fine").replace(quick | {k.replace("__", "."): v for k, v in changes.items()})


def content(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def dead_lock(folder: Path, **more: Any) -> None:
    (folder / LOCK).write_text(json.dumps({"pid": os.getpid()} | more))


def a_work_folder(out: Path) -> None:
    (out / ".work-of-mine").mkdir()
    (out / ".work-of-mine" / "thesis.tex").write_text("mine")


def a_dead_lock_and_a_log(out: Path) -> None:
    dead_lock(out)
    (out / "log.txt").write_text("mine")


def a_lock_that_claims_other_folders(out: Path) -> None:
    (out / "mine").mkdir()
    (out / "mine" / "thesis.tex").write_text("mine")
    dead_lock(out, work=["mine", ".work-x/../mine", "..", 3])


def another_programs_manifest(out: Path) -> None:
    (out / manifest.NAME).write_text('{"name": "an app"}')


def a_claim_beyond_the_folder(out: Path) -> None:
    (out.parent / "thesis.tex").write_text("mine")
    (out / "notes.txt").write_text("mine")
    manifest.write(out, ["../thesis.tex", "/etc/hosts", "figures/../notes.txt"])


@pytest.mark.parametrize("how", WAYS)
@pytest.mark.parametrize(
    "lay",
    [
        a_work_folder,
        a_dead_lock_and_a_log,
        a_lock_that_claims_other_folders,
        another_programs_manifest,
        a_claim_beyond_the_folder,
    ],
)
def test_a_folder_of_others_is_refused_and_left_alone(
    lay: Callable[[Path], None], how: str, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    lay(out)
    before = content(tmp_path)
    with pytest.raises(InputError, match="holds other files") as error:
        warpwear.run(study(), out=out, plots=False, **WAYS[how])
    check_sentence(error.value)
    assert content(tmp_path) == before


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory, quick_pictures: Any) -> Path:
    out = tmp_path_factory.mktemp("runs") / "out"
    with quick_pictures(blank=True):
        warpwear.run(study(), out=out).close()
    return out


def test_a_manifest_says_what_a_run_wrote(finished: Path) -> None:
    there = {str(p.relative_to(finished)) for p in finished.rglob("*") if p.is_file()}
    assert manifest.written(finished) == there
    assert {"study.toml", "result.h5", "log.txt", "figures/cof.png"} <= there


@pytest.fixture
def out(finished: Path, tmp_path: Path) -> Path:
    shutil.copytree(finished, tmp_path / "out")
    return tmp_path / "out"


def test_overwriting_keeps_what_others_put_there(out: Path) -> None:
    """Work folders, notes, drawings beside the figures; a stale figure goes."""
    mine = [".work-dir/a.txt", "notes.txt", "figures/cof.tex", "figures/mine.png", "figures/sub/cof.png"]
    for name in mine:
        (out / name).parent.mkdir(exist_ok=True)
        (out / name).write_text("mine")
    warpwear.run(study(contact__load="9 N"), out=out, plots=False, overwrite=True).close()
    assert [(out / name).read_text() for name in mine] == ["mine"] * len(mine)
    assert not (out / "figures" / "cof.png").exists()
    assert not any(name.startswith("figures/") for name in manifest.written(out))


def test_figures_of_another_folder_by_a_link(out: Path, tmp_path: Path) -> None:
    (out / "figures").rename(tmp_path / "elsewhere")
    (out / "figures").symlink_to(tmp_path / "elsewhere")
    before = content(tmp_path)
    with pytest.raises(InputError, match=r"figures is a link; a run draws its figures into its own"):
        warpwear.run(study(), out=out, overwrite=True)
    assert content(tmp_path) == before


@pytest.mark.parametrize("name", ["log.txt", "history.csv", "figures/cof.png"])
def test_a_file_that_a_run_would_replace(name: str, out: Path) -> None:
    """One of the same name that the manifest does not have."""
    manifest.write(out, manifest.written(out) - {name})
    (out / name).write_text("mine")
    with pytest.raises(InputError, match=rf"holds {name}, which no run wrote") as error:
        warpwear.run(study(contact__load="9 N"), out=out, plots=False, overwrite=True)
    check_sentence(error.value)
    assert (out / name).read_text() == "mine"


def test_a_file_that_came_while_the_run_went_on(tmp_path: Path) -> None:
    out = tmp_path / "out"

    def writing(step: warpwear.RunStep) -> None:
        (out / "log.txt").write_text("mine")

    with pytest.warns(UserWarning, match=r"log\.txt was not written by a run: it is log-.*\.txt now"):
        warpwear.run(study(), out=out, plots=False, callback=writing).close()
    (kept,) = out.glob("log-*.txt")
    assert kept.read_text() == "mine"
    assert "finished: " in (out / "log.txt").read_text()
