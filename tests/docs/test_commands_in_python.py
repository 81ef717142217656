"""The page that sets Python beside the command line: each row runs, and prints what the command does."""

import inspect
import re
import shlex
import shutil
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner

import warpwear
from warpwear.batches.batch import executor_for, local_executor
from warpwear.cli.main import commands

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "reference" / "commands-in-python.md"

#: Commands that print what Python prints, to the last sign.
SAME = ("studies", "materials", "show", "surface", "calibrate")


def rows() -> list[tuple[list[str], str]]:
    """The words of each command and the Python beside it."""
    boxes = re.findall(
        r"^\* - ```sh\n(.*?)^    ```\n  - ```python\n(.*?)^    ```$",
        PAGE.read_text("utf-8"),
        re.DOTALL | re.M,
    )
    return [(shlex.split(shell.replace("\\\n", " "))[1:], textwrap.dedent(python)) for shell, python in boxes]


def names(group: click.Group, prefix: str = "") -> set[str]:
    """The commands of a group, those of groups within by two words."""
    found = set()
    for name, command in group.commands.items():
        found |= names(command, f"{name} ") if isinstance(command, click.Group) else {prefix + name}
    return found


def test_every_command_has_a_row_of_ten_lines_at_most() -> None:
    shown = set()
    for words, python in rows():
        command, name = commands.commands[words[0]], words[0]
        given = words[1:]
        if isinstance(command, click.Group):
            inner = words[1] if words[1] in command.commands else "DIR"
            command, name, given = command.commands[inner], f"{name} {inner}", words[1 + (inner != "DIR") :]
        command.make_context(name, given)
        shown.add(name)
        assert len(python.strip().splitlines()) <= 10, python
    assert names(commands) == shown


@pytest.fixture
def blank(quick_pictures: Any) -> Iterator[None]:
    """Nobody looks at the pictures."""
    with quick_pictures(blank=True):
        yield


@pytest.mark.usefixtures("blank")
@pytest.mark.slow
def test_rows_do_what_the_commands_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for package in ("SurfaceTopography", "ruptures", "pandas"):
        pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    for name in ("ground-disc.x3p", "ball-on-disc.csv"):
        shutil.copy(DOCS / "files" / name, tmp_path)
    rough = np.random.default_rng(0).normal(0.0, 0.1, (120, 120))
    y = np.linspace(-1.0, 1.0, 120)
    bowl = np.maximum(0.0, 1.0 - np.add.outer(y**2, y**2) / 0.2)
    np.save("new.npy", rough)
    np.save("worn.npy", rough - 2.0 * bowl)
    angle = np.arange(0.0, 2.0 * np.pi, 0.01)
    loop = np.column_stack([20.0 * np.cos(angle), 12.0 * np.clip(3.0 * np.cos(angle - 0.9), -1.0, 1.0)])
    np.savetxt("loop.csv", loop, delimiter=",", header="Displacement [um],Friction force [N]", comments="")
    tests = '[[test]]\nfriction = "0.60 +- 0.02"\nload = "8 N"\ndistance = "2400 mm"\narea = "1.254 mm^2"\n'
    loops = '[[test]]\nloop = "loop.csv"\nload = "20 N"\n'
    Path("tests.toml").write_text(f"{tests}\n{tests.replace('0.60', '0.63')}", encoding="utf-8")
    Path("loops.toml").write_text(loops, encoding="utf-8")
    space: dict[str, Any] = {}
    for words, python in rows():
        capsys.readouterr()
        exec(python, space)
        printed = capsys.readouterr().out
        if words[0] in SAME and "bayes" not in words:
            done = CliRunner().invoke(commands, [*words, *["--overwrite"] * ("--figure" in words)])
            assert done.exit_code == 0, done.output
            told = re.sub(r"(; |\n)\d+ more lines with --details", "", done.stdout.strip())
            assert told in (printed.strip(), f"{printed.strip()}\nwritten to disc.png"), words
    made = {path.name for path in tmp_path.iterdir()}
    assert made >= {"my-test.toml", "my-test", "cof.png", "my-test.gif", "exported", "disc.png", "record"}
    assert made >= {"loads", "comparison", "drawn", "shared"}
    assert "on 1 worker" in space["cost"]
    assert any(Path("drawn/figures").iterdir())
    assert Path("drawn/runs").resolve() == Path("shared").resolve()


def boxes() -> list[str]:
    """What stands beside no command: laws, and one contact."""
    return re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.DOTALL | re.M)


@pytest.mark.usefixtures("blank")
def test_one_contact_of_two_materials(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (box,) = boxes()[1:]
    assert len(box.strip().splitlines()) <= 10
    surface = warpwear.read_surface(DOCS / "files" / "ground-disc.x3p", crop="0.3 mm")
    space: dict[str, Any] = {"warpwear": warpwear, "surface": surface}
    exec(box, space)
    contact = space["contact"]
    assert contact.cell == surface.pixel[0]
    assert contact.load == pytest.approx(5.0, rel=1e-9)
    assert contact.mean_real_pressure == pytest.approx(contact.load / contact.area)
    assert contact.mean_real_pressure > 2.0 * contact.mean_pressure
    assert Path("pressure.png").is_file()


def test_laws_are_functions_of_arrays() -> None:
    box = boxes()[0]
    space: dict[str, Any] = {}
    exec(box, space)
    assert space["k_disc"].shape == space["stress"].shape == (2, 3)
    assert (space["stress"] == 5.0).all()


def test_options_of_a_sweep_are_those_of_python() -> None:
    """Each option of the command is a parameter of `sweep`, or of what makes the runs."""
    known = {
        name
        for function in (warpwear.sweep, executor_for, local_executor)
        for name in inspect.signature(function).parameters
    }
    of_python = {"changes": "study", "resume": "out"}  # the study is changed before; a folder is gone on with
    for parameter in commands.commands["sweep"].params:
        name = str(parameter.name)
        assert of_python.get(name, name) in known | {"device"}, name
