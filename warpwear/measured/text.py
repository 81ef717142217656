"""The text of a measured record: encoding, header, separator, decimal sign; its columns as numbers."""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray

COMMENTS = ("#", "%", "//")
#: Lines among which the first row of numbers must be.
HEADER_LINES = 2000
MISSING = frozenset(("", "-", "--", "nan", "na", "n/a", "#n/a", "null", "none", "bad", "***", "#div/0!"))
NUMBER = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?|[+-]?inf", re.I)


@dataclass(frozen=True, eq=False)
class RecordText:
    """Rows of text fields under a header, not yet numbers."""

    path: Path
    names: tuple[str, ...]  # of the columns; empty without a header
    units: tuple[str, ...]  # from a row of their own below the names; empty without
    separator: str | None  # None for blanks
    rows: list[str]
    lines: list[int]  # number of each row's line in the file

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(_split(self.rows[0], self.separator))

    def columns(self, wanted: Sequence[int]) -> FloatArray:
        """Columns as numbers, shape (rows, len(wanted)), NaN where missing. Raises InputError."""
        rows = self.rows
        if self.separator != ",":
            rows = self._with_points(wanted)
        try:
            text = io.StringIO("\n".join(rows))
            values = np.loadtxt(text, delimiter=self.separator, usecols=wanted, ndmin=2, comments=None)
        except ValueError:  # gaps, or what is no number
            values = np.array(
                [self._numbers(row, line, wanted) for row, line in zip(rows, self.lines, strict=True)]
            )
        return np.where(np.isfinite(values), values, np.nan)

    def _with_points(self, wanted: Sequence[int]) -> list[str]:
        """Rows with points for decimal commas."""
        commas, points = (any(sign in row for row in self.rows) for sign in (",", "."))
        if commas and points:  # in other columns, or mixed
            seen: dict[str, int] = {}
            for row, line in zip(self.rows, self.lines, strict=True):
                fields = _split(row, self.separator)
                for sign in (",", "."):
                    if sign not in seen and any(sign in fields[i] for i in wanted):
                        seen[sign] = line
                if len(seen) == 2:
                    raise InputError(
                        f"{self.path} mixes decimal commas (line {seen[',']}) and points (line {seen['.']}): "
                        "one of them is expected, and no separators of thousands"
                    )
        return [row.replace(",", ".") for row in self.rows] if commas else self.rows

    def _numbers(self, row: str, line: int, wanted: Sequence[int]) -> list[float]:
        fields = _split(row, self.separator)
        found = []
        for i in wanted:
            try:
                found.append(np.nan if fields[i].lower() in MISSING else float(fields[i]))
            except ValueError:
                raise InputError(
                    f"{self.path}: line {line} holds '{fields[i][:30]}', which is no number"
                ) from None
        return found


def read_record(path: Path) -> RecordText:
    """The rows of a text file and the header over them. Raises InputError.

    Rows are separated by tabs, semicolons, commas or blanks, the same on every line; empty lines and comments
    (#, %, //) are passed over. What a header needs: as many names as there are columns, above the first row,
    with at most a row of units between.
    """
    lines = _lines(path)
    start, separator = _first_row(path, lines)
    rows, numbers = [], []
    for number, line in enumerate(lines[start:], start=start + 1):
        if line.strip() and not line.startswith(COMMENTS):
            rows.append(line)
            numbers.append(number)
    above = [line for line in lines[:start] if line.strip(" \t;,")]
    if any('"' in row for row in rows):
        rows = ["\t".join(_split(row, separator)) for row in rows]
        above = ["\t".join(_split(line, separator)) for line in above]
        separator = "\t"
    rows, width = _even(path, rows, numbers, separator)
    names, units = _header(above, separator, width)
    return RecordText(path, names, units, separator, rows, numbers)


def _lines(path: Path) -> list[str]:
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = raw.decode("utf-16", errors="replace")
    elif b"\x00" in raw:
        raise InputError(f"{path} is no text file: a table of text such as .csv or .txt is expected")
    else:
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = raw.decode("latin-1")
    if not text.strip():
        raise InputError(f"{path} is empty: columns of numbers under a header are expected")
    if sum(not (c.isprintable() or c in "\r\n\t\f") for c in text[:4000]) > 40:
        raise InputError(f"{path} is no text file: a table of text such as .csv or .txt is expected")
    return text.replace("\r\n", "\n").replace("\r", "\n").replace("\xa0", " ").split("\n")


def _first_row(path: Path, lines: list[str]) -> tuple[int, str | None]:
    """Where the rows of numbers begin, and their separator."""
    for index, line in enumerate(lines[:HEADER_LINES]):
        if not line.strip() or line.startswith(COMMENTS):
            continue
        following = next((other for other in lines[index + 1 :] if other.strip()), None)
        for separator in ("\t", ";", ",", None):
            if (separator is None or separator in line) and _is_row(line, separator):
                width = len(_split(line, separator))
                if following is None or len(_split(following, separator)) == width or _all_numbers(line):
                    return index, separator
    shown = next((line.strip() for line in lines if line.strip()), "")
    raise InputError(f"{path} has no rows of numbers in two or more columns; it begins with '{shown[:60]}'")


def _is_row(line: str, separator: str | None) -> bool:
    fields = _split(line, separator)
    if len(fields) < 2:
        return False
    numbers = sum(NUMBER.fullmatch(field) is not None for field in fields)
    missing = sum(field.lower() in MISSING for field in fields)
    if separator is None or len(fields) == 2:
        return numbers > 0 and numbers + missing == len(fields)
    words = sum(any(c.isalpha() or c == ":" for c in field) for field in fields if not NUMBER.match(field))
    return numbers >= 2 and numbers + missing + words >= len(fields)


def _all_numbers(line: str) -> bool:
    return all(NUMBER.fullmatch(field) for field in re.split(r"[\s;,]+", line.strip(" \t;,")))


def _split(line: str, separator: str | None) -> list[str]:
    """Fields without the blanks and quotes around them."""
    if separator is None:
        return line.split()
    fields = next(csv.reader([line], delimiter=separator)) if '"' in line else line.split(separator)
    return [field.strip() for field in fields]


def _even(path: Path, rows: list[str], lines: list[int], separator: str | None) -> tuple[list[str], int]:
    """Rows without a separator that ends them all, and how many fields each has."""
    if separator is None:
        widths = [len(row.split()) for row in rows]
    else:
        if all(row.rstrip(" ").endswith(separator) for row in rows):
            rows = [row.rstrip(" ")[: -len(separator)] for row in rows]
        widths = [row.count(separator) + 1 for row in rows]
    for width, line in zip(widths, lines, strict=True):
        if width != widths[0]:
            raise InputError(
                f"{path}: line {line} has {width} fields where line {lines[0]} has {widths[0]}: rows of "
                "equal length with the same separator are expected"
            )
    return rows, widths[0]


def _header(above: list[str], separator: str | None, width: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of the columns, from the last lines before the numbers."""
    found = []
    for line in above[-1:-3:-1]:
        fields = _names(line.lstrip("#%/ ") if line.startswith(COMMENTS) else line, separator, width)
        if fields is None or not any(fields):
            break
        found.append(fields)
    if not found:
        return (), ()
    if len(found) == 2 and all(not field or is_unit(field) for field in found[0]):
        return found[1], found[0]
    return found[0], ()


def _names(line: str, separator: str | None, width: int) -> tuple[str, ...] | None:
    """The fields of a header, if there are as many as columns."""
    fields = _split(line, separator)
    if separator is not None:
        while len(fields) > width and not fields[-1]:
            fields.pop()
        ways = [fields, _with_units(fields, ", ")]
    else:
        ways = [fields, _with_units(fields, " "), re.split(r"\s{2,}|\t|;", line.strip())]
    return next((tuple(way) for way in ways if len(way) == width), None)


def _with_units(fields: list[str], joint: str) -> list[str]:
    """Units that stand as fields of their own joined to the names before them."""
    joined: list[str] = []
    for field in fields:
        if joined and is_unit(field):
            joined[-1] += joint + field
        else:
            joined.append(field)
    return joined


def is_unit(text: str) -> bool:
    """Whether a field is a unit of a record and no name, such as mm, [s] or (-)."""
    bare = text.strip("[]() ").replace("μ", "u").replace("µ", "u").lower()
    return bare in UNITS


UNITS = frozenset(
    ("-", "–", "1", "%", "nm", "um", "mm", "cm", "m", "km", "ms", "s", "sec", "sek", "min", "h", "hr", "std")
) | {"n", "mn", "kn", "°c", "c", "rpm", "mm/s", "m/s", "hz", "v", "g"}
