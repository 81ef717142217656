"""The page of all keys is what the declarations of the keys say."""

import re
import runpy
from functools import cached_property
from pathlib import Path

import pytest

from warpwear import Study
from warpwear.study.keys import declarations, key_of, section_in
from warpwear.study.pair import Pair

ROOT = Path(__file__).parent.parent.parent


def test_the_page_of_keys_is_up_to_date() -> None:
    made = runpy.run_path(str(ROOT / "docs" / "make_keys.py"))["page"]()
    page = (ROOT / "docs" / "reference" / "keys.md").read_text(encoding="utf-8")
    assert made == page, "run: python docs/make_keys.py"


def test_every_key_has_a_meaning() -> None:
    for name in declarations(Study):
        info = key_of(Study, name)
        assert info is not None
        assert info.description or "." not in name, name


def test_what_keys_apply_to_and_demand_is_there() -> None:
    """Rules and demands name keys or properties of a study, which a misspelt name would switch off."""
    for name, declared in declarations(Study).items():
        for other in {rule.name for rule in (*declared.applies, *declared.demands)} - {*declarations(Study)}:
            section, _, last = other.rpartition(".")
            field = key_of(Study, section) if section else None
            owner = section_in(field.annotation) if field else {"": Study, "pair": Pair}.get(section)
            assert isinstance(getattr(owner, last, None), property | cached_property), f"{name}: {other}"


@pytest.mark.parametrize(
    ("key", "says"),
    [
        ("contact.load", "above 0 N"),
        ("counter.poisson", "0 to 0.5"),
        ("counter.radius", "above 0 mm, also `inf`"),
        ("disc.level", '`"none"`, `"plane"`, `"sphere"`, `"cylinder"`, whole numbers 0 to 12'),
        ("disc.synthetic.hurst", "above 0, at most 1"),
        ("disc.synthetic.lay", "-180 to 180 deg"),
        ("wear.counter", "0 mm^3/N/m or more"),
        ("sliding.shift", "whole numbers 1 to 100,000"),
        ("checks.strict", "`true`, `false`"),
    ],
)
def test_the_page_says_what_is_allowed(key: str, says: str) -> None:
    page = (ROOT / "docs" / "reference" / "keys.md").read_text(encoding="utf-8")
    (facts,) = re.findall(rf"^- `{re.escape(key)}`: .*\\\n  (.*)$", page, re.M)
    assert f"*allowed* {says}" in facts.split(" · ")


def test_every_number_has_bounds() -> None:
    """A key that is left without them is text."""
    page = (ROOT / "docs" / "reference" / "keys.md").read_text(encoding="utf-8")
    free = [
        key
        for key, facts in re.findall(r"^- `([\w.]+)`: .*\\\n  (.*)$", page, re.M)
        if "*allowed*" not in facts
    ]
    assert free == [
        "study.name", "study.description", "study.author", "study.publisher", "study.license",
        "counter.material", "counter.gradient", "counter.surface", "counter.array", "counter.layers.name",
        "disc.material", "disc.gradient", "disc.surface", "disc.array", "disc.layers.name",
        "disc.synthetic.like"
    ]  # fmt: skip
