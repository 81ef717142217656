"""Layouts of files of profiles that are read here: .prf of stylus instruments and .x3p."""

import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

import numpy as np

from warpwear.grid import FloatArray

PRF = b"1 2"  # the first line of a .prf
FEATURE = "{*}Record1/{*}FeatureType"
SIZE = "{*}Record3/{*}MatrixDimension/{*}SizeX"
LINK = "{*}Record3/{*}DataLink/"
AXES = "{*}Record1/{*}Axes/"
#: Types of an .x3p's values, little endian: 16 and 32 bit integers and floats of 32 and 64 bit.
TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


def read_prf(path: Path) -> tuple[FloatArray, float]:
    """Return heights [mm], shape (n,), and spacing [mm] of a .prf. Raises ValueError.

    Its records are lines of text that end with EOR: axes with number of points, unit and scale, then keys
    such as the spacing, then whole numbers of steps (the softgauges of NPL write it so).
    """
    records = path.read_text(encoding="latin-1").split("EOR")
    if len(records) < 4:
        raise ValueError("it is cut short: fewer than three records that end with EOR")
    lines = {words[0]: words for line in "\n".join(records[:2]).splitlines() if (words := line.split())}
    axis, spacing = lines.get("CZ", []), lines.get("SPACING", [])
    if len(axis) < 5 or len(spacing) < 3 or spacing[1] != "CX":
        raise ValueError("it lacks the scale of its heights, CZ, or SPACING CX")
    if {axis[3], lines.get("CX", axis)[3]} != {"MM"}:
        raise ValueError(f"its unit is {axis[3]!r}: allowed is MM")
    values = np.array([float(word) for word in records[2].split()])
    if values.size != round(float(axis[2])):
        raise ValueError(f"it holds {values.size} heights, and says that there are {axis[2]}")
    return values * float(axis[4]), float(spacing[2])


def x3p_profile(path: Path) -> tuple[FloatArray, float] | None:
    """Return heights [m] and spacing [m] of a profile in an .x3p, None where it holds a map; shape (n,).

    ISO 25178-72: evenly spaced, with the heights in a file of their own. Raises ValueError, KeyError or
    zipfile.BadZipFile for what is damaged or not so.
    """
    with zipfile.ZipFile(path) as archive:
        main = ElementTree.fromstring(archive.read("main.xml"))
        if _text(main, FEATURE) != "PRF":
            return None
        if _text(main, f"{AXES}{{*}}CX/{{*}}AxisType") != "I":
            raise ValueError("its points are not evenly spaced")
        kind = TYPES[_text(main, f"{AXES}{{*}}CZ/{{*}}DataType")]
        values = np.frombuffer(archive.read(_text(main, f"{LINK}{{*}}PointDataLink")), kind)
        mask = main.findtext(f"{LINK}{{*}}ValidPointsLink")
        packed = archive.read(mask.strip()) if mask else b""
    count = int(_text(main, SIZE))
    if values.size != count:
        raise ValueError(f"it holds {values.size} heights, and says that there are {count}")
    step, scale = (float(main.findtext(f"{AXES}{{*}}{axis}/{{*}}Increment") or 1.0) for axis in ("CX", "CZ"))
    heights = values * (scale if kind[1] == "i" else 1.0)
    if packed:
        valid = np.unpackbits(np.frombuffer(packed, np.uint8), count=count, bitorder="little")
        heights = np.where(valid == 1, heights, np.nan)
    return heights, step


def _text(main: ElementTree.Element, place: str) -> str:
    """Return the text at a place of a main.xml. Raises ValueError where there is none."""
    text = (main.findtext(place) or "").strip()
    if not text:
        raise ValueError(f"its main.xml has no {place.rpartition('}')[2]}")
    return text
