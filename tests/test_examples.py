"""Every example runs by itself in an empty folder, quickly, and answers the question in its docstring."""

import ast
import runpy
import time
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import warpwear

FOLDER = Path(__file__).parent.parent / "examples"
EXAMPLES = sorted(FOLDER.glob("*.py"))
NAMES = [path.stem for path in EXAMPLES]
#: Seconds of processor time, which others on the machine hardly lengthen; most take three to five.
LONGEST = 30.0


#: Dear ones, which the site runs whenever it is made.
DEAR = ("running_in", "scatter", "patch_loads", "hardness_cap", "area_against_load")


@pytest.mark.parametrize(
    "path", [pytest.param(p, id=p.stem, marks=[pytest.mark.slow] if p.stem in DEAR else []) for p in EXAMPLES]
)
def test_an_example_runs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    begin = time.process_time()
    runpy.run_path(str(path), run_name="__main__")
    plt.close("all")
    printed = capsys.readouterr().out
    assert printed.count("\n") >= 2
    assert "nan" not in printed
    assert time.process_time() - begin < LONGEST


@pytest.mark.parametrize("path", EXAMPLES, ids=NAMES)
def test_an_example_is_short_and_of_the_public_names_only(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert 20 <= len(text.splitlines()) <= 40
    tree = ast.parse(text)
    assert (ast.get_docstring(tree) or "").split("\n")[0].endswith("?")
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            assert not (node.module or "").startswith("warpwear"), node.module
        if isinstance(node, ast.Import):
            assert all(not name.name.startswith("warpwear.") for name in node.names)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            assert node.value.id != "warpwear" or node.attr in warpwear.__all__


def test_there_are_sixteen() -> None:
    assert len(EXAMPLES) == 16
