"""Results that are exported: of a contact at rest and of a track; shared by tests."""

import base64
import struct
import zipfile
import zlib
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


class Vtk:
    """An independent reader of VTK's XML files with packed base64 data, after the format's description."""

    def __init__(self, path: Path) -> None:
        root = ElementTree.parse(path).getroot()
        assert root.attrib["compressor"] == "vtkZLibDataCompressor"
        assert root.attrib["header_type"] == "UInt64"
        self.grid = root[0]
        self.kind = root.attrib["type"]
        extent = [int(n) for n in self.grid.attrib["WholeExtent"].split()]
        self.sides = [last - first + 1 for first, last in zip(extent[::2], extent[1::2], strict=True)]
        self.shape = (self.sides[0], self.sides[1])
        appended = root.find("AppendedData")
        assert appended is not None
        text = (appended.text or "").strip().removeprefix("_")
        self.arrays = {
            one.attrib["Name"]: self._unpack(one, text)
            for one in root.iter("DataArray")
            if one.attrib["format"] == "appended"
        }
        (time,) = [one for one in root.iter("DataArray") if one.attrib["Name"] == "TimeValue"]
        self.time = float(time.text or "nan")
        self.texts = {
            one.attrib["Name"]: bytes(map(int, (one.text or "").split()))[:-1].decode()
            for one in root.iter("Array")
        }

    def _unpack(self, one: Any, text: str) -> Any:
        start = int(one.attrib["offset"])
        (count,) = struct.unpack("<Q", base64.b64decode(text[start : start + 12])[:8])
        length = -(-8 * (3 + count) // 3) * 4
        head = struct.unpack(
            f"<{3 + count}Q", base64.b64decode(text[start : start + length])[: 8 * (3 + count)]
        )
        packed = sum(head[3:])
        start += length
        content = base64.b64decode(text[start : start + -(-packed // 3) * 4])
        blocks, at = b"", 0
        for size in head[3:]:
            blocks += zlib.decompress(content[at : at + size])
            at += size
        dtype = {"Float64": "<f8", "Float32": "<f4", "UInt8": "u1"}[one.attrib["type"]]
        components = int(one.attrib.get("NumberOfComponents", 1))
        values = np.frombuffer(blocks, dtype)
        if self.kind == "RectilinearGrid" and values.size in self.sides:  # places along an axis
            return values
        # x is the fastest in the file
        return values.reshape(*self.sides[::-1], components).swapaxes(0, 2).squeeze()
