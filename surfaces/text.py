"""Tables of numbers in text: header, separators and decimal sign told apart without guessing."""

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpwear import lazy
from warpwear.surfaces.base import FloatArray

spatial = lazy.module("scipy.spatial")

COMMENTS = ("#", "%", "//", "*", "!")
MISSING = re.compile(rb"(?i)\b(?:bad|null|nil|none|na|n/a)\b|\*{2,}|-{2,}")
SAMPLE_LINES = 400
#: Bytes that no text has, and the share of them, zeros aside, in one that is only damaged.
BINARY = bytes([*range(1, 9), *range(14, 32)])
LARGEST_BINARY = 0.05
NUMBER = re.compile(
    r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eEdD][+-]?\d+)?|[+-]?(?:nan|inf|bad|null)|-{2,}|\*{2,}", re.I
)


@dataclass(frozen=True, eq=False)
class Table:
    """Values as they stand, shape (lines, columns), NaN where missing; header: the lines before them."""

    values: FloatArray
    header: tuple[str, ...]
    ended: bool = True  # whether the last line is: of a file cut short it is not


def read_table(path: Path) -> Table:
    """The table of numbers in a text file.

    Separators: tab, spaces, semicolon or comma, the same on every line; decimal point or comma. Empty fields
    and words such as ``NaN``, ``BAD`` or ``***`` are missing values. ValueError, with a sentence's end, for
    rows of unequal length, and where a comma could be either a separator or a decimal sign.
    """
    raw = path.read_bytes()
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raw = raw.decode("utf-16").encode()
    raw = raw.removeprefix(b"\xef\xbb\xbf")
    if b"\x00" in raw:
        _refuse_zeros(raw)
    raw = raw.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\xc2\xa0", b" ")
    header, body, first = _split(raw)
    if not body.strip():
        raise ValueError("no table of numbers")
    values = _numbers(_unified(body), first=first)
    if values.shape[0] > 1 and header == () and values.shape[1] == 1:
        raise ValueError("a single column of numbers")
    _refuse_lost_rows(header, body, first=first, width=values.shape[1])
    return Table(values=values, header=header, ended=raw.endswith(b"\n"))


def _refuse_zeros(raw: bytes) -> None:
    """ValueError: "no text" for an instrument's own format, the line of the damage for a text with a few."""
    rest = raw[:100000].translate(None, b"\x00")
    if len(rest.translate(None, BINARY)) <= (1.0 - LARGEST_BINARY) * len(rest):
        raise ValueError("no text")
    line = raw.count(b"\n", 0, raw.index(b"\x00")) + 1
    raise ValueError(f"line {line} holds a byte of value 0, which no text has")


def _refuse_lost_rows(header: tuple[str, ...], body: bytes, *, first: int, width: int) -> None:
    """ValueError for a broken row that passed for the header, and for one behind a comment's sign.

    Of two or three columns a header may well be made of a word and numbers.
    """
    if width > 3 and header and not header[-1].startswith(COMMENTS[:3]):
        for separators in (r"[\s;]+", r"[\s;,]+"):
            fields = re.split(separators, header[-1].strip(" \t;,"))
            words = [field for field in fields if not NUMBER.fullmatch(field)]
            if abs(len(fields) - width) <= width // 8 and 0 < len(words) < 0.5 * width:
                raise ValueError(f"line {first - 1} holds {words[0][:20]!r}, which is no number")
    if not any(sign.encode() in body for sign in COMMENTS[:3]):
        return
    for number, line in enumerate(body.decode("utf-8", errors="replace").split("\n"), start=first):
        sign = next((sign for sign in COMMENTS[:3] if line.strip().startswith(sign)), None)
        if sign is not None:
            fields = re.split(r"[\s;]+", line.strip()[len(sign) :].strip(" \t;,"))
            if len(fields) == width > 2 and all(NUMBER.fullmatch(field) for field in fields):
                raise ValueError(f"line {number} is a row of numbers behind a {sign!r}")


def _split(raw: bytes) -> tuple[tuple[str, ...], bytes, int]:
    """Header lines, the rest, and the number of its first line: from there on lines hold numbers alone."""
    header, start, count = [], 0, 0
    while start < len(raw):
        end = raw.find(b"\n", start)
        end = len(raw) if end < 0 else end
        line = raw[start:end].decode("utf-8", errors="replace").strip()
        if _is_data(line):
            following = raw[end + 1 : raw.find(b"\n", end + 1)].decode("utf-8", errors="replace").strip()
            # one or two bare integers over wider rows: a count of points or of the grid, part of the header
            counts = re.fullmatch(r"\d+(?:[\s;,]+\d+)?", line) and _is_data(following)
            if not (counts and len(NUMBER.findall(following)) > len(line.split())):
                break
        if line:
            header.append(line)
        start, count = end + 1, count + 1
        if count > 2000:
            raise ValueError("no table of numbers")
    return tuple(header), raw[start:], count + 1


def _is_data(line: str) -> bool:
    if not line or line.startswith(COMMENTS[:3]):
        return False
    fields = [field for field in re.split(r"[\s;,]+", line) if field]
    return (
        bool(fields) and all(NUMBER.fullmatch(field) for field in fields) and any(c.isdigit() for c in line)
    )


def _unified(body: bytes) -> bytes:
    """The same numbers with points for decimals and one space between fields."""
    sample = [line for line in body[:200000].split(b"\n")[:SAMPLE_LINES] if line.strip()]
    if len(body) > 400000:  # the end may differ from the beginning
        sample += [line for line in body[-200000:].split(b"\n")[1:][-SAMPLE_LINES:] if line.strip()]
    semicolons, tabs, commas = (body.count(c) > 0 for c in (b";", b"\t", b","))
    if MISSING.search(b"\n".join(sample)) or re.search(rb"(?i)bad|null|\*\*|--", body):
        body = MISSING.sub(b"nan", body)
    if commas:
        if semicolons or tabs:
            joined = b"\n".join(sample)
            if re.search(rb"\d\.\d*,\d|,\d*\.\d", joined) or re.search(rb",[;\t\n]|[;\t],", joined + b"\n"):
                raise ValueError("mixed separators: commas beside semicolons or tabs, and decimal points")
            body = body.replace(b",", b".")
        elif _comma_is_decimal(sample):
            body = body.replace(b",", b".")
        else:
            body = _explicit(body, b",", sample)
    if semicolons and tabs:
        if re.search(rb";[ \t]*;|\t\t", body):
            raise ValueError("mixed separators: semicolons and tabs, with empty fields")
        body = body.translate(bytes.maketrans(b";", b" "))
    elif semicolons:
        body = _explicit(body, b";", sample)
    elif tabs:
        body = _explicit(body, b"\t", sample)
    return body


def _comma_is_decimal(sample: list[bytes]) -> bool:
    """Of a table whose only other separator is blank. ValueError where both readings make sense."""
    points = any(b"." in line for line in sample)
    spaced = any(re.search(rb"\d +[-+\d]", line.strip()) for line in sample)
    if points:
        if spaced and any(re.search(rb"\d\.\d+,\d|\d,\d+\.\d", line) for line in sample):
            raise ValueError("mixed separators: blanks and commas, and decimal points")
        return False
    if any(re.search(rb", |,,|,\s*$", line) for line in sample):
        if spaced:
            raise ValueError("mixed separators: blanks and commas")
        return False
    if spaced:
        return True
    fields = [line.strip().split(b",") for line in sample]
    odd = any(len(line) % 2 for line in fields)
    signed = any(f.strip()[:1] in (b"-", b"+") for line in fields for f in line[1::2])
    if not (odd or signed):
        raise ValueError("a comma between all digits, which may be a separator or a decimal sign")
    return False


def _explicit(body: bytes, separator: bytes, sample: list[bytes]) -> bytes:
    """Blanks for a separator, ``nan`` for the empty fields between two of them."""
    if all(line.rstrip(b" ").endswith(separator) for line in sample):  # each line ends in one
        body = re.sub(separator + rb"[ ]*(?=\n|$)", b"", body)
    filler = b"[ ]*"
    if re.search(separator + filler + rb"(?:" + separator + rb"|\n|$)", body) or re.search(
        rb"(?:^|\n)" + filler + separator, body
    ):
        body = re.sub(rb"(?m)(?<=" + separator + rb")" + filler + rb"(?=" + separator + rb"|$)", b"nan", body)
        body = re.sub(rb"(?m)^" + filler + rb"(?=" + separator + rb")", b"nan", body)
    return body.replace(separator, b" ")


def _numbers(body: bytes, *, first: int) -> FloatArray:
    try:
        return np.loadtxt(io.BytesIO(body), comments=list(COMMENTS[:3]), ndmin=2, dtype=np.float64)
    except ValueError as error:
        raise ValueError(_fault(body, first=first) or str(error).splitlines()[0]) from error


def _fault(body: bytes, *, first: int) -> str:
    """What is wrong with the first bad line, in words."""
    wanted = None
    for number, line in enumerate(body.split(b"\n"), start=first):
        if not line.strip() or line.strip().startswith(tuple(c.encode() for c in COMMENTS[:3])):
            continue
        fields = line.split()
        for field in fields:
            try:
                float(field)
            except ValueError:
                shown = field.decode(errors="replace")[:20]
                return f"line {number} holds {shown!r}, which is no number"
        wanted = len(fields) if wanted is None else wanted
        if len(fields) != wanted:
            return (
                f"line {number} has {len(fields)} values where the others have {wanted}: ragged rows or "
                "mixed separators"
            )
    return ""


SLACK = 0.2  # pixels that a point may lie off its grid: the rounding of printed coordinates
LEAST_FILLED = 0.25  # of the grid; scattered points and turned grids fill next to nothing
UNIT = (
    r"(?:mm|cm|km|nm|pm|[uµμ]m|m|Å|micrometers?|micrometres?|microns?|millimeters?|millimetres?"
    r"|meters?|metres?)"
)
WORDS = {"micro": "µm", "milli": "mm", "meter": "m", "metre": "m"}


@dataclass(frozen=True, eq=False)
class Cloud:
    """A gridded cloud: heights in the file's unit, shape (nx, ny), NaN where no point is; x increases with
    axis 0 and y with axis 1. pixel: distance of the points along both, in the file's lateral unit."""

    heights: FloatArray
    pixel: tuple[float, float]
    notes: tuple[str, ...]


def gridded(points: FloatArray) -> Cloud:
    """The height map of points, shape (n, 3 or more): x, y, z in the first columns.

    A full grid or one with holes, in any order. The same point twice counts once. ValueError, with the end of
    a sentence, for one point with two heights, and for points of no axis-parallel, evenly spaced grid.
    """
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    placed = np.isfinite(x) & np.isfinite(y)
    if not placed.all():
        x, y, z = x[placed], y[placed], z[placed]
    if x.size < 4:
        raise ValueError("fewer than four points")
    column, nx, px = _axis(x, "x")
    row, ny, py = _axis(y, "y")
    if nx < 2 or ny < 2:
        raise ValueError("holds a line scan")
    if x.size < LEAST_FILLED * nx * ny:
        raise ValueError(_scattered(x, y))
    cell = column * ny + row
    heights = np.full(nx * ny, np.nan)
    heights[cell] = z
    notes = []
    count = np.bincount(cell, minlength=1)
    if count.max() > 1:
        same = (heights[cell] == z) | ~np.isfinite(z) & ~np.isfinite(heights[cell])
        if not same.all():
            bad = int(np.flatnonzero(~same)[0])
            raise ValueError(
                f"{int((~same).sum())} points that are given twice with different heights, the first at "
                f"x = {x[bad]:g}, y = {y[bad]:g}"
            )
        notes.append(f"{int(x.size - np.count_nonzero(count))} repeated points dropped")
    return Cloud(heights=heights.reshape(nx, ny), pixel=(px, py), notes=tuple(notes))


def units_in(header: Sequence[str]) -> tuple[str | None, str | None]:
    """Lateral unit and height unit that a header states, each None unless unambiguous."""
    found: dict[str, set[str]] = {"x": set(), "y": set(), "z": set(), "": set()}
    words_between = r"(?:axis|position|pos|coordinate|height|unit|units)?"
    named = rf"\b([xyz])(?:\b|(?=[-_ ]))[ _-]*{words_between}[ ]*[:=]?[ ]*[\[(/]?[ ]*(?:in[ ]+)?({UNIT})\b"
    general = rf"\b(?:units?|einheit)\b[ ]*[:=]?[ ]*[\[(]?[ ]*({UNIT})\b"
    for line in header:
        names = re.findall(named, line, re.I)
        for axis, unit in names:
            found[axis.lower()].add(_canonical(unit))
        if names:
            continue
        height = re.search(rf"\b(?:z|height)[ _-]*units?\b[ ]*[:=]?[ ]*({UNIT})\b", line, re.I)
        if height:
            found["z"].add(_canonical(height[1]))
        elif match := re.search(general, line, re.I):
            found[""].add(_canonical(match[1]))
        else:
            # a line of units alone, under the names of the columns
            words = re.findall(rf"(?<![\w])({UNIT})(?![\w])", line)
            rest = re.sub(rf"{UNIT}|[\[\]()#%;,\s]", "", line)
            if len(words) == 3 and not rest:
                for axis, unit in zip("xyz", words, strict=True):
                    found[axis].add(_canonical(unit))
    lateral = found["x"] | found["y"] or found[""]
    height_units = found["z"] or found[""]
    return (
        next(iter(lateral)) if len(lateral) == 1 else None,
        next(iter(height_units)) if len(height_units) == 1 else None,
    )


def _canonical(unit: str) -> str:
    lower = unit.lower()
    for start, meant in WORDS.items():
        if lower.startswith(start):
            return meant
    return unit.replace("μ", "µ").replace("um", "µm").replace("UM", "µm")


def _axis(places: FloatArray, name: str) -> tuple[np.ndarray, int, float]:
    """Index of each place on its axis, their number, and the spacing."""
    sorted_places, inverse = np.unique(places, return_inverse=True)
    span = float(sorted_places[-1] - sorted_places[0])
    if span == 0.0:
        return np.zeros(places.size, dtype=np.int64), 1, 0.0
    gaps = np.diff(sorted_places)
    real = gaps > 1e-7 * span  # smaller ones are rounding of the same place
    spacing = float(np.median(gaps[real]))
    steps = np.where(real, np.rint(gaps / spacing), 0.0)
    index = np.concatenate([[0.0], np.cumsum(steps)])
    if index[-1] < 1.0 or index[-1] >= 1.0 / LEAST_FILLED * max(places.size, 4):
        raise ValueError(f"points along {name} that are not evenly spaced, or a turned grid")
    slope, offset = np.polyfit(index, sorted_places, 1)
    off = np.abs(sorted_places - (slope * index + offset)) / slope
    if off.max() > SLACK or np.any(real & (steps == 0.0)):
        if sorted_places.size > 0.2 * places.size:
            raise ValueError("points of a turned grid, or scattered ones")
        raise ValueError(f"points along {name} that are not evenly spaced")
    return index.astype(np.int64)[inverse.reshape(-1)], int(index[-1]) + 1, float(slope)


def _scattered(x: FloatArray, y: FloatArray) -> str:
    """What kind of no grid: the angle of a turned one from neighbours of some points."""

    points = np.column_stack([x, y])
    near = spatial.cKDTree(points).query(points[:: max(1, len(points) // 500)], k=2)[1]
    step = points[near[:, 1]] - points[near[:, 0]]
    angle = np.angle(np.exp(4j * np.arctan2(step[:, 1], step[:, 0])).sum()) / 4.0
    agree = float(np.abs(np.exp(4j * np.arctan2(step[:, 1], step[:, 0])).mean()))
    if agree > 0.95 and abs(np.degrees(angle)) > 0.05:
        return f"points of a grid turned by {np.degrees(angle):.3g}° from the axes"
    return "scattered points, of no regular grid"
