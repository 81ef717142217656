"""The examples in the docstrings of the public names give what they say."""

import doctest
import inspect
import shutil
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import warpwear

#: Names that show by an example how they are used.
SHOWN = {"Study.replace", "run", "solve_contact", "steps"}
SHOWN |= {f"calibrate_{what}" for what in ("wear", "coat", "friction", "energy", "loop")}
SHOWN |= {"compare", "materials", "new_study", "read_profile", "read_record", "read_surface"}
SHOWN |= {"read_worn", "studies", "worn_cap"}
#: Those whose examples need a package that need not be installed.
NEEDS = {"read_record": "ruptures", "compare": "pandas"}
#: Where the examples find their files.
FILES = Path(__file__).parents[2] / "docs" / "files"


def test_examples_of_docstrings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copy(FILES / "ball-on-disc.csv", tmp_path)
    monkeypatch.chdir(tmp_path)
    finder, runner = doctest.DocTestFinder(recurse=True), doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    shown = set()
    for name in warpwear.__all__:
        thing = getattr(warpwear, name)
        if not (inspect.isclass(thing) or inspect.isfunction(thing)):
            continue
        module = inspect.getmodule(thing)
        for test in finder.find(thing, name, module=module, globs={"warpwear": warpwear, "np": np}):
            if test.examples and find_spec(NEEDS.get(name, "numpy")):
                shown.add(test.name)
                assert runner.run(test).failed == 0, test.name
    assert shown >= {name for name in SHOWN if find_spec(NEEDS.get(name, "numpy"))}
