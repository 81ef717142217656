"""Docstrings of public names have the sections of numpydoc, and what these say of errors is true."""

import builtins
import dataclasses
import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpwear

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "interface.md"
#: Functions that nothing a caller gives can make fail.
CANNOT_FAIL = {"materials", "studies"}
#: Name of a section -> its lines, with those that are not indented.
Sections = dict[str, list[str]]


def sections(thing: Any) -> Sections:
    parts = re.split(r"^([A-Z][a-z]+)\n-{4,}$", inspect.getdoc(thing) or "", flags=re.MULTILINE)
    return {name: text.strip("\n").split("\n") for name, text in zip(parts[1::2], parts[2::2], strict=True)}


def named(lines: list[str]) -> set[str]:
    """The names that a section declares: 'load, distance : str' are two."""
    heads = [line.partition(" : ")[0] for line in lines if line and not line.startswith(" ")]
    return {name.strip().lstrip("*") for head in heads for name in head.split(",")}


def shown() -> Iterator[tuple[str, Any]]:
    """Public functions, and methods of public classes that the page of the interface shows."""
    for name in warpwear.__all__:
        thing = getattr(warpwear, name)
        if inspect.isfunction(thing):
            yield name, thing
        if not inspect.isclass(thing) or issubclass(thing, Exception):
            continue
        entry = re.search(rf"autoclass:: {name}\(\)\n((?:   :.*\n)*)", PAGE.read_text("utf-8"))
        assert entry, f"{name} is not on the page"
        members = re.search(r":members:(.*)", entry[1])
        listed = [member.strip() for member in (members[1] if members else "").split(",") if member.strip()]
        for member in listed or [one for one in dir(thing) if not one.startswith("_") and members]:
            function = getattr(inspect.getattr_static(thing, member), "__func__", getattr(thing, member))
            if inspect.isfunction(function):
                yield f"{name}.{member}", function


SHOWN = dict(shown())


@pytest.mark.parametrize("name", SHOWN)
def test_parameters_returns_and_raises(name: str) -> None:
    signature, found = inspect.signature(SHOWN[name]), sections(SHOWN[name])
    parameters = {p for p in signature.parameters if p not in ("self", "cls")}
    assert parameters == named(found.get("Parameters", [])), name
    assert ("Returns" in found) == (signature.return_annotation not in (None, "None")), name
    assert "." in name or name in CANNOT_FAIL or "Raises" in found, name
    for error in named(found.get("Raises", [])):
        assert issubclass(getattr(warpwear, error, None) or getattr(builtins, error), Exception), error
    told = (inspect.getdoc(SHOWN[name]) or "").partition("\nParameters\n---")[0]
    assert not re.search(r"\bRaises [A-Z]", told), f"{name} tells of an error outside of its section"


CLASSES = [name for name in warpwear.__all__ if dataclasses.is_dataclass(getattr(warpwear, name))]


@pytest.mark.parametrize("name", CLASSES)
def test_attributes(name: str) -> None:
    kind = getattr(warpwear, name)
    known = {one for base in kind.__mro__ for one in named(sections(base).get("Attributes", []))}
    fields = {field.name for field in dataclasses.fields(kind) if not field.name.startswith("_")}
    assert fields <= known, name


FLAT = np.zeros((8, 8))


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda w: w.run("none.toml"), "InputError", "none.toml"),
        (lambda w: w.run("v3-fine", resume=True), "InputError", "resume needs out"),
        (lambda w: w.run("v3-fine", callback=1), "InputError", "a function is expected"),
        (lambda w: next(w.steps("v3-fine", threads=0)), "InputError", "threads"),
        (lambda w: w.sweep("v3-fine"), "InputError", "vary"),
        (lambda w: w.sweep("v3-fine", vary={"contact.load": ["4 N"]}, bogus=1), "TypeError", "bogus"),
        (lambda w: w.sweep("v3-fine", vary={"contact.load": ["4 N"]}, executor=3), "InputError", "submit"),
        (lambda w: w.infer("v3-fine", unknown=["wear.disc"], tests=[]), "InputError", "nothing was measured"),
        (lambda w: w.solve_contact(FLAT, cell=1.0, load=1.0), "InputError", "hardness = None"),
        (
            lambda w: w.solve_tangential(None, friction=0.5, poisson=0.3, force=1.0),
            "InputError",
            "half-space",
        ),
        (lambda w: w.stresses(FLAT, [0.0], poisson=0.3, cell=1.0), "InputError", "boundary"),
        (lambda w: w.stresses(FLAT, [0.0], poisson=0.7, cell=1.0, boundary="free"), "InputError", "poisson"),
        (lambda w: w.Study.load("none"), "InputError", "none"),
        (lambda w: w.Study.load("v1").replace({"contact.load": "4 mm"}), "InputError", "dimension"),
        (lambda w: w.Result("nowhere"), "InputError", "holds no result"),
        (lambda w: w.read_surface("none.npy"), "InputError", "none.npy"),
        (lambda w: w.read_surface("none.npy", bogus=1), "TypeError", "bogus"),
        (lambda w: w.read_record("none.csv"), "InputError", "none.csv"),
        (lambda w: w.compare("nowhere"), "InputError", "two runs"),
        (lambda w: w.worn_cap(7.0, 7.0, radius=3.0), "InputError", ""),
        (lambda w: w.worn_cap(0.8, 0.8, radius=3.0).figure(), "InputError", "no figure"),
        (lambda w: w.calibrate_friction(cof=0.6), "InputError", "area is missing"),
        (lambda w: w.calibrate_energy(), "InputError", "load is missing"),
        (lambda w: w.calibrate_coat([]), "InputError", "need 3 craters"),
    ],
)
def test_errors_are_raised_as_told(call: Callable[[Any], Any], error: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(getattr(warpwear, error, None) or getattr(builtins, error)) as raised:
        call(warpwear)
    assert says in str(raised.value)
