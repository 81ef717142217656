"""Files of Gwyddion: named parts in each other, among them fields of values with their units and masks."""

from pathlib import Path
from typing import Any

import numpy as np

GWY = b"GWYP"  # begins such a file
#: Kind of a part -> type of its number, and of those of an array, which is named by the capital letter.
NUMBERS = {"b": "i1", "c": "i1", "i": "<i4", "q": "<i8", "d": "<f8"}


def parts_of(path: Path) -> dict[str, Any]:
    """Return the parts of a file by their names. Raises ValueError or KeyError for what is damaged."""
    return _object(path.read_bytes(), len(GWY))[0]


def _object(raw: bytes, at: int) -> tuple[dict[str, Any], int]:
    """Return the parts of the object at a place, by their names, and the place behind it."""
    at = _text(raw, at)[1] + 4
    end = at + int.from_bytes(raw[at - 4 : at], "little")
    if end > len(raw):
        raise ValueError("it is cut short")
    parts = {}
    while at < end:
        name, at = _text(raw, at)
        parts[name], at = _part(raw, at + 1, raw[at : at + 1].decode("latin-1"))
    return parts, at


def _part(raw: bytes, at: int, kind: str) -> tuple[Any, int]:
    """Return what stands at a place, by its kind, and the place behind it."""
    if kind == "s":
        return _text(raw, at)
    if kind == "o":
        return _object(raw, at)
    if kind in NUMBERS:
        value = np.frombuffer(raw, NUMBERS[kind], 1, at)
        return value[0].item(), at + value.nbytes
    count, at = int.from_bytes(raw[at : at + 4], "little"), at + 4
    if kind not in ("S", "O"):
        values = np.frombuffer(raw, NUMBERS[kind.lower()], count, at)
        return values, at + values.nbytes
    for _ in range(count):  # of no use here
        at = _part(raw, at, kind.lower())[1]
    return None, at


def _text(raw: bytes, at: int) -> tuple[str, int]:
    """Return the text at a place, which ends with a 0, and the place behind it."""
    end = raw.find(b"\0", at)
    if end < 0:
        raise ValueError("it is cut short")
    return raw[at:end].decode("utf-8", errors="replace"), end + 1
