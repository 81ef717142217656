"""The examples in the docstrings of the public names give what they say."""

import doctest
import inspect
from pathlib import Path

import numpy as np
import pytest

import warpwear

#: Names that show by an example how they are used.
SHOWN = {"Study.replace", "run", "solve_contact", "steps"}
SHOWN |= {f"calibrate_{what}" for what in ("wear", "coat", "friction", "energy", "loop")}


def test_examples_of_docstrings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    finder, runner = doctest.DocTestFinder(recurse=True), doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    shown = set()
    for name in warpwear.__all__:
        thing = getattr(warpwear, name)
        if not (inspect.isclass(thing) or inspect.isfunction(thing)):
            continue
        module = inspect.getmodule(thing)
        for test in finder.find(thing, name, module=module, globs={"warpwear": warpwear, "np": np}):
            if test.examples:
                shown.add(test.name)
                assert runner.run(test).failed == 0, test.name
    assert shown >= SHOWN
