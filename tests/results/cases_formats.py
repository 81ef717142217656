"""Results that are exported: of a contact at rest and of a track; shared by tests."""

import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from cases_track import small

import warpwear
from warpwear import Result, Study
from warpwear.results.export import FORMATS

EVIL = "<script>alert(1)</script> \"'$x$ ]]> &amp; " + "é" * 300
NEEDS = {name: entry.packages for name, entry in FORMATS.items()}


def needs(name: str) -> None:
    for package in NEEDS[name]:
        pytest.importorskip(package)


@pytest.fixture(scope="module")
def result() -> Result:
    """A ball of 0.6 mm, whose rim lies inside the domain, and a domain that is no square of round numbers."""
    return warpwear.run(
        Study.load("v3-fine").replace(
            {
                "grid.cell": "20 um",
                "sliding.distance": "30 mm",
                "counter.radius": "0.6 mm",
                "output.snapshots": ["1 mm", "3 mm"],
                "study.description": EVIL,
            }
        )
    )


@pytest.fixture(scope="module")
def swept() -> Result:
    return warpwear.run(small("full", output__snapshots=["3 mm"], sliding__plastic="keep"))


def read_x3p(path: Path) -> tuple[Any, dict[str, str], dict[str, bytes]]:
    """Heights [m] of a .x3p file, shape (nx, ny), the texts of its main.xml by path, and its parts."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    root = ElementTree.fromstring(parts["main.xml"])
    assert root.tag == "{http://www.opengps.eu/2008/ISO5436_2}ISO5436_2"
    texts: dict[str, str] = {}

    def walk(element: Any, place: str) -> None:
        for child in element:
            texts[f"{place}{child.tag}"] = (child.text or "").strip()
            walk(child, f"{place}{child.tag}/")

    walk(root, "")
    shape = [int(texts[f"Record3/MatrixDimension/Size{axis}"]) for axis in "YX"]
    data = np.frombuffer(parts[texts["Record3/DataLink/PointDataLink"]], "<f8").reshape(shape)
    return data.T, texts, parts
