"""What stands in a box of code on a page can be typed: cells run with the site, the rest is read here."""

import re
import shlex
import tomllib
from pathlib import Path
from typing import Any

import click
import pytest

from warpwear import Study
from warpwear.cli.main import commands
from warpwear.figures.of_run.table import ESSENTIAL, FIGURES
from warpwear.study.keys import declarations

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md")] + sorted((ROOT / "docs").rglob("*.md"))
NAMES = [page.relative_to(ROOT).as_posix() for page in PAGES]
#: Boxes of Python that do not run when the site is made -> what they hold, and why.
LEFT_OUT = {
    "docs/how-to/programme.md": {"block=[": "tests/runs/stopped/test_blocks.py runs one like it"},
    "README.md": {"plt.subplots": "tests/test_readme.py runs it"},
    "docs/how-to/sweeps.md": {"SLURMCluster": "needs a cluster"},
    "docs/how-to/inference.md": {"warpwear.infer(": "takes a minute; tests run one like it"},
    "docs/reference/commands-in-python.md": {
        "study.wear_laws": "tests/docs/test_commands_in_python.py runs it",
        "effective_modulus(": "tests/docs/test_commands_in_python.py runs it",
    },
    "docs/developer/programs.md": {"program.loop(": "a part of warpwear/contact/search.py"},
    "docs/developer/kernels.md": {
        "carried = native_pass(": "tests/docs/test_kernels_page.py runs it",
        "compile_aot_module(": "takes half a minute",
    },
}
#: Sections that are no keys of a run.
OTHER_SECTIONS = ("sweep", "infer", "test")


def boxes(page: Path, language: str) -> list[str]:
    """The boxes of a page that are written in a language."""
    return re.findall(
        rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )


def cells(page: Path) -> list[str]:
    """The boxes of a page that run when the site is made."""
    return boxes(page, re.escape("{code-cell} ipython3"))


def commands_in(page: Path) -> list[list[str]]:
    """The words of every command warpwear that a page shows."""
    shells = boxes(page, "sh") + [cell for cell in cells(page) if "%%sh" in cell]
    lines = "\n".join(shells).replace("\\\n", " ").splitlines()
    return [
        words[1:] for line in lines if line.startswith("warpwear ") and (words := shlex.split(line, True))
    ]


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_python_runs_when_the_site_is_made(page: Path) -> None:
    reasons = LEFT_OUT.get(page.relative_to(ROOT).as_posix(), {})
    found = boxes(page, "python")
    assert len(found) == len(reasons)
    assert all(any(mark in box for mark in reasons) for box in found)
    if cells(page):
        assert page.read_text(encoding="utf-8").startswith("---\nfile_format: mystnb\n")


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_commands_have_these_options(page: Path) -> None:
    keys = declarations(Study)
    for words in commands_in(page):
        command: click.Command = commands
        given = words
        while isinstance(command, click.Group) and not given[0].startswith("-"):
            name, *given = given
            assert name in command.commands, words
            command = command.commands[name]
        context = command.make_context("warpwear", [*given], resilient_parsing="--help" in given)
        changed = [text.partition("=")[0] for text in context.params.get("changes") or ()]
        changed += [text.partition("=")[0].strip() for text in context.params.get("vary") or ()]
        assert all(name in keys for name in changed), words
        for name in context.params.get("only") or ():
            assert name in FIGURES, words


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_studies_have_these_keys(page: Path) -> None:
    keys = declarations(Study)

    def names(nested: dict[str, Any], prefix: str = "") -> list[str]:
        return [
            name
            for key, value in nested.items()
            for name in (names(value, f"{prefix}{key}.") if isinstance(value, dict) else [prefix + key])
        ]

    written = [cell.partition("\n")[2] for cell in cells(page) if re.match(r"%%writefile .*\.toml\n", cell)]
    for box in boxes(page, "toml") + written:
        found = {key: value for key, value in tomllib.loads(box).items() if key not in OTHER_SECTIONS}
        assert all(name in keys for name in names(found)), box


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_scripts_that_a_page_names_are_there(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for script in re.findall(r"\bpython ((?:bench|docs|examples)/[\w/]+\.py)", text):
        assert (ROOT / script).is_file(), script


def test_every_figure_is_on_the_page_of_results() -> None:
    """Those that a run draws by itself are in bold there."""
    table = (ROOT / "docs/reference/results.md").read_text(encoding="utf-8").partition("| about | names |")[2]
    table = table.partition("\n\n")[0]
    names = re.findall(r"`(\w+)`", table.replace("`wear.distance_factor`", ""))
    assert sorted(names) == sorted(FIGURES)
    assert set(re.findall(r"\*\*`(\w+)`\*\*", table)) == set(ESSENTIAL)
