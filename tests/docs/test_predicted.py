"""Tests of other laboratories: the rule of the verdict, the studies, and the table of the documentation."""

import runpy
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpwear import Study
from warpwear.study import loading

ROOT = Path(__file__).parents[2]
OTHERS = ROOT / "bench" / "others"
PREDICTIONS = sorted(OTHERS.glob("*/prediction*.toml"))


@pytest.fixture(scope="module")
def bench() -> dict[str, Any]:
    return runpy.run_path(str(OTHERS / "verdicts.py"))


@pytest.mark.parametrize(
    ("low", "high", "rigid", "value", "expected"),
    [
        (1.0, 3.9, None, 2.0, "inside"),
        (1.0, 4.1, None, 2.0, "says nothing (band of a factor of 4.1)"),
        (0.6, 0.9, [1.0, 1.0], 0.8, "inside"),
        (0.6, 1.1, [1.0, 1.0], 1.04, "inside: the rigid form does as well, no agreement"),
        (0.6, 0.9, [1.0, 1.0], 1.0, "off by 1.11, the rigid form is right"),
        (0.6, 0.9, None, 0.3, "off by 2.00"),
    ],
)
def test_the_rule(
    bench: dict[str, Any], low: float, high: float, rigid: Any, value: float, expected: str
) -> None:
    assert bench["verdict"]({"low": low, "high": high, "rigid": rigid}, value) == expected


def test_the_table_of_the_page_is_what_the_rule_gives(bench: dict[str, Any]) -> None:
    page = (ROOT / "docs" / "validation" / "predicted.md").read_text(encoding="utf-8")
    rows = ["| " + " | ".join(row) + " |" for row in bench["table_rows"]()]
    assert len(rows) > 30
    assert [row for row in rows if row not in page] == []


@pytest.mark.parametrize("path", PREDICTIONS, ids=lambda path: f"{path.parent.name} {path.stem}")
def test_its_studies_can_be_run(path: Path) -> None:
    """Each names its studies, which the program accepts, and a middle inside of every band."""
    prediction = tomllib.loads(path.read_text(encoding="utf-8"))
    for name in prediction["studies"]:
        source = name.removeprefix("preset ") if name.startswith("preset ") else path.parent / name
        sections = loading.read_sections(source)
        sections.pop("sweep", None)
        assert Study(**sections).contact.load > 0.0
    for quantity in prediction["quantity"]:
        assert quantity["low"] < quantity["middle"] < quantity["high"]


def test_a_groove_is_read_below_its_crests(bench: dict[str, Any], tmp_path: Path) -> None:
    """A parabola of 0.2 mm and 0.5 µm has two thirds of width times depth."""
    x = np.arange(0.0, 2.4, 0.0005)
    z = np.where(np.abs(x - 1.2) < 0.1, -0.5 * (1.0 - ((x - 1.2) / 0.1) ** 2), 0.0)
    lines = [f'"{a:.5f}","{b:.5f}"'.replace(".", ",") for a, b in zip(x, z, strict=True)]
    (tmp_path / "p.csv").write_text("\n".join(['"Distance","Profile"', *lines]), encoding="utf-8")
    read: Callable[[Path], dict[str, float]] = bench["groove"]
    assert read(tmp_path / "p.csv") == pytest.approx(
        {"section of the groove": 66.7, "depth of the groove": 0.5}, rel=0.01
    )
