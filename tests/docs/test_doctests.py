"""The examples in the docstrings of the public names give what they say."""

import doctest
import inspect

import numpy as np

import warpwear

#: Names that show by an example how they are used.
SHOWN = {"Study.replace", "run", "solve_contact", "steps"}


def test_examples_of_docstrings() -> None:
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
