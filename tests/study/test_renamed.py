"""Old names of keys: one sentence says what to type now; in stored results they are taken silently."""

import tomllib
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli.main import commands
from warpwear.results.file import MAGIC
from warpwear.results.seal import seal

#: Old name and value -> new ones.
RENAMED: dict[tuple[str, Any], tuple[str, Any]] = {
    ("contact.law", "foundation"): ("contact.law", "local"),
    ("contact.foundation", "pressure"): ("contact.bulk_stiffness", "pressure"),
    ("contact.foundation_update", "updated"): ("contact.bulk_update", "updated"),
    ("macro.cell", "100 um"): ("patches.macro_cell", "100 um"),
    ("macro.patch", "50 um"): ("patches.width", "50 um"),
    ("macro.bulk", "foundation"): ("patches.bulk", "spring"),
    ("macro.bulk", "none"): ("patches.bulk", "none"),
    ("macro.coupling", "load"): ("patches.coupling", "load"),
    ("macro.placement", "random"): ("patches.placement", "random"),
    ("macro.seed", 3): ("patches.seed", 3),
}
CASES = pytest.mark.parametrize(
    ("old", "new"), RENAMED.items(), ids=[f"{name} = {value}" for name, value in RENAMED]
)


def of_old_names(study: Study) -> list[str]:
    return [notice for notice in study.notices() if "new name" in notice]


def base() -> Study:
    return Study.load("two-scale").replace({"grid.extent": "1.8 mm", "patches.width": "50 um"})


def sentence(old: tuple[str, Any], new: tuple[str, Any]) -> str:
    renamed = old[1] != new[1]
    left, right = (f"{name} = '{value}'" if renamed else name for name, value in (old, new))
    return f"Keys have new names, and the next release refuses the old ones: {left} is {right}."


@CASES
def test_a_change_by_an_old_name(old: tuple[str, Any], new: tuple[str, Any]) -> None:
    changed, expected = base().replace(dict([old])), base().replace(dict([new]))
    assert changed.to_toml() == expected.to_toml()
    assert of_old_names(changed) == [sentence(old, new)]
    assert of_old_names(expected) == []
    section, _, key = old[0].partition(".")
    assert of_old_names(base().replace(**{section: {key: old[1]}})) == [sentence(old, new)]
    # What was said once is said once, and not forgotten by further changes.
    again = changed.replace(dict([old])).replace({"contact.load": "4 N"})
    assert of_old_names(again) == [sentence(old, new)]


@CASES
def test_an_old_name_in_a_file(tmp_path: Path, old: tuple[str, Any], new: tuple[str, Any]) -> None:
    sections = tomllib.loads(base().to_toml())
    key = new[0].partition(".")[2]
    sections[new[0].partition(".")[0]].pop(key, None)
    section, _, key = old[0].partition(".")
    text = tomli_w.dumps(sections | {section: sections.get(section, {}) | {key: old[1]}})
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    expected = base().replace(dict([new]))
    for study in (Study(**tomllib.loads(text)), Study.load(tmp_path / "study.toml")):
        assert of_old_names(study) == [sentence(old, new)]
        left_out = {"assumed", "study"}  # the reasons, and the description, which tells what was changed
        assert study.model_dump(exclude=left_out) == expected.model_dump(exclude=left_out)


def test_reasons_of_assumptions_move_with_their_keys() -> None:
    sections = tomllib.loads(base().to_toml())
    sections["macro"] = {"cell": sections["patches"].pop("macro_cell")}
    sections["assumed"]["macro.cell"] = sections["assumed"].pop("patches.macro_cell")
    study = Study(**sections)
    assert study.assumed["patches.macro_cell"].startswith("the thesis names no size")
    assert study.to_toml() == base().to_toml()
    assert len(of_old_names(study)) == 1


@CASES
def test_the_command_line_says_what_to_type(old: tuple[str, Any], new: tuple[str, Any]) -> None:
    args = ["show", "two-scale", "--set", "grid.extent=1.8 mm", "--set", "patches.width=50 um"]
    if old[0] == "macro.patch":
        args = args[:4]
    shown = CliRunner().invoke(commands, [*args, "--set", f"{old[0]}={old[1]}"])
    assert shown.exit_code == 0
    assert shown.stderr.count("new name") == 1
    assert f"note: {sentence(old, new)}\n" in shown.stderr
    assert "macro." not in shown.stdout.replace("# ASSUMED", "")


@pytest.mark.parametrize("old", [name for name, _ in RENAMED if name != "contact.law"])
def test_both_names_at_once_are_refused(old: str) -> None:
    new, value = next(new for (name, _), new in RENAMED.items() if name == old)
    told = f"^{old} and {new} are the old and the new name of one key: give {new} alone\\.$"
    with pytest.raises(InputError, match=told):
        base().replace({old: value, new: value})
    sections = tomllib.loads(base().to_toml())
    for name in (old, new):
        section, _, key = name.partition(".")
        sections.setdefault(section, {})[key] = value
    with pytest.raises(InputError, match=told):
        Study(**sections)


def test_what_was_no_key_is_none() -> None:
    for change in ({"macro": {"cells": "1 um"}}, {"macro.cells": "1 um"}):
        told = r"^'patches\.cells' is no key of a study; allowed are patches\.macro_cell, "
        with pytest.raises(InputError, match=told):
            base().replace(change)
    with pytest.raises(InputError, match=r"^'patches\.extent' is no key .* did you mean 'grid\.extent'\?"):
        base().replace({"macro.extent": "1 mm"})
    with pytest.raises(InputError, match=r"^patches = 3 is not a section; write \[patches\]"):
        Study(**{**tomllib.loads(Study.load("v3").to_toml()), "macro": 3})


@pytest.fixture
def old_run(tmp_path: Path) -> Path:
    """A finished run of two scales whose result and study.toml say the old names, as before they changed."""
    small = {"grid.cell": "25 um", "sliding.distance": "0.02 mm", "output.snapshots": []}
    study = Study.load("two-scale").replace(small)
    warpwear.run(study, out=tmp_path / "run", plots=False).close()
    sections = tomllib.loads(study.to_toml())
    contact, patches = sections["contact"], sections.pop("patches")
    contact["law"] = "foundation"
    for old, new in (("foundation", "bulk_stiffness"), ("foundation_update", "bulk_update")):
        contact[old] = contact.pop(new)
    sections["macro"] = {"cell": patches["macro_cell"], "bulk": "foundation", "coupling": patches["coupling"]}
    text = tomli_w.dumps(sections)
    (tmp_path / "run" / "study.toml").write_text(text, encoding="utf-8")
    path = tmp_path / "run" / "result.h5"
    with h5py.File(path, "r+") as file:
        file.attrs["study"] = text
    with path.open("r+b") as file:
        seal(file, MAGIC)
    return tmp_path / "run"


def test_stored_results_open_without_a_notice(old_run: Path) -> None:
    with Result.open(old_run) as result:
        assert of_old_names(result.study) == []
        assert result.study.contact.law == "local"
        assert result.study.patches.bulk == "spring"
        assert result.study.patches.macro_cell == pytest.approx(0.05)
        assert result.load_share.shape == (result.history["load"].size, 900)
        assert result.macro_x.shape == (30,)
        assert result.summary["patches"]["bulk"] == "spring"
        assert of_old_names(result.study.replace({"contact.load": "4 N"})) == []
        study = result.study
    assert of_old_names(Study.load(old_run)) == []  # the folder's study.toml was written by a run
    # The same study by its new names is the run that the folder holds.
    assert study.to_toml() == Study.load(old_run).to_toml()


def sphere_for_counter(text: str) -> str:
    """Write what a version before the counter-body was called so would have written."""
    return text.replace("counter", "sphere")


def test_a_study_of_a_sphere(tmp_path: Path) -> None:
    """Keys of a study that says sphere throughout are the counter-body's, and one sentence says so."""
    study = Study.load("track").replace({"friction.film": FILM, "friction.shear_strength": "172 MPa"})
    (tmp_path / "study.toml").write_text(sphere_for_counter(study.to_toml()), encoding="utf-8")
    old = Study.load(tmp_path / "study.toml")
    assert old.to_toml() == study.to_toml()
    (notice,) = of_old_names(old)
    assert "sphere.radius is counter.radius" in notice
    assert "friction.film.bodies = 'sphere' is friction.film.bodies = 'counter'" in notice
    changed = study.replace({"sphere.radius": "2 mm", "wear.sphere": "1e-4 mm^3/N/m"})
    assert changed.counter.radius == 2.0


FILM = {"thickness": "10 nm", "shear_strength": "40 MPa", "bodies": "counter"}


@pytest.mark.parametrize("preset", ["v3-fine", "track"])
def test_a_result_of_a_sphere(tmp_path: Path, preset: str) -> None:
    """Columns and fields of a result that say sphere are read as the counter-body's."""
    changes: dict[str, Any] = {"grid.cell": "20 um", "sliding.distance": "0.5 mm"}
    changes["output.snapshots"] = ["0.5 mm"]
    study = Study.load(preset).replace(changes)
    run = tmp_path / "run"
    with warpwear.run(study, out=run, plots=False) as result:
        history, worn = dict(result.history), result.snapshot(0).wear_counter
        summary = result.summary
    with h5py.File(run / "result.h5", "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        for name in sorted((n for n in names if "counter" in n), key=len, reverse=True):
            file.move(name, sphere_for_counter(name))
        file.attrs["study"] = sphere_for_counter(file.attrs["study"])
    with (run / "result.h5").open("r+b") as sealed:
        seal(sealed, MAGIC)
    with Result.open(run) as old:
        assert of_old_names(old.study) == []
        assert old.study.to_toml() == study.to_toml()
        assert list(old.history) == list(history)
        for name, values in history.items():
            np.testing.assert_array_equal(old.history[name], values, err_msg=name)
        np.testing.assert_array_equal(old.snapshot(0).wear_counter, worn)
        assert old.summary["volume_mm3"] == summary["volume_mm3"]
        old.plot.save_all(tmp_path / "figures", plots="essential")
        old.export(tmp_path / "export", formats=["npy"])
    assert {path.name for path in (tmp_path / "export").glob("*.npy")} == {
        "counter_worn.npy",
        "disc_worn.npy",
    }
