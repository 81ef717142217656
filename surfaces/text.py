"""Tables of numbers in text: encoding, header, separator, decimal sign and missing values are told apart.

Points and matrices of heights and records of friction are read by the same rules: tabs, semicolons, commas or
blanks between the fields of every row, a decimal point or comma, empty fields and words such as NaN, BAD or
*** for what is missing. Nothing is guessed: what makes sense in two ways is refused.
"""

import csv
import errno
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import compress
from pathlib import Path
from stat import S_ISREG

import numpy as np
import numpy.typing as npt

from warpwear.grid import FloatArray

COMMENTS = ("#", "%", "//")
COMMENT = re.compile(r"\s*(?!#n/a|#div/0!)(?:#|%|//)", re.I)  # their start, but no word of a spreadsheet
SEPARATORS = ("\t", ";", ",", None)  # in the order in which they are tried; None is any run of blanks
HEADER_LINES = 2000  # among which the first row of numbers must be
CONTROL = bytes([*range(1, 9), *range(14, 32)])  # bytes that no text has
LARGEST_CONTROL = 0.05  # share of such bytes, zeros aside, in a text that is only damaged
MOST_UNPRINTABLE = 40  # characters among the first 4000 of a text
NUMBER = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?|[+-]?inf", re.I | re.A)
MISSING = re.compile(r"|-+|–|\*{2,}|nan|n/?a|#n/a|nil|null|none|bad|#div/0!", re.I)
#: One or two bare integers. Over wider rows they count the points, and belong to the header.
COUNTS = re.compile(r"\s*\d+(?:[\s;,]+\d+)?\s*")
DATE = re.compile(r"\d+[:./-]\d+[:./-]\d+.*|\d+:\d+")
EMPTY_FIELD = re.compile(r"(?:^|[;\t]) *(?:[;\t]|$)")


class NoTable(ValueError):
    """There is no table of text in a file; the message goes on after the file's name."""


@dataclass(frozen=True, eq=False)
class Table:
    """A table has rows of fields of text, equally many in each, not yet numbers."""

    header: tuple[str, ...]  # the lines before the rows, comments among them, without empty ones
    separator: str | None  # None for blanks
    width: int  # number of columns
    rows: list[str]
    lines: npt.NDArray[np.intp]  # number of each row's line in the file, from 1, shape (rows,)
    ended: bool  # whether the last line has an end, which in a file cut short it has not

    def numbers(self, wanted: Sequence[int] | None = None) -> FloatArray:
        """Return the wanted columns (all by default) as numbers, shape (rows, columns), NaN where missing.

        Raises ValueError, naming the line, for what is no number and for decimal commas beside points.
        """
        columns = range(self.width) if wanted is None else wanted
        rows = self.rows if self.separator == "," else self._with_points(columns)
        try:
            values = np.loadtxt(rows, delimiter=self.separator, usecols=wanted, ndmin=2, comments=None)
        except ValueError:  # words for what is missing, or what is no number
            numbered = zip(rows, self.lines, strict=True)
            values = np.array([self._row(row, line, columns) for row, line in numbered])
        return np.where(np.isfinite(values), values, np.nan)

    def names(self) -> list[str]:
        """Return the names of the columns where the header ends with a word for each, else none.

        In blanks any words may pass for names: then the table must be longer than it is wide, and the first
        column may have none.
        """
        fields = split(self.header[-1].lstrip("#%/ "), self.separator) if self.header else []
        words = [any(c.isalpha() for c in field) and not _is_value(field) for field in fields]
        alike = len(fields) == self.width and all(words[1:]) and len(set(fields)) == len(fields)
        long = self.separator is not None or len(self.rows) > self.width
        return fields if alike and long and self.width > 1 else []

    def _with_points(self, wanted: Sequence[int]) -> list[str]:
        """Return the rows with points for decimal commas."""
        if not any("," in row for row in self.rows):
            return self.rows
        if any("." in row for row in self.rows):  # in columns that are not wanted, or mixed
            seen: dict[str, int] = {}
            for row, line in zip(self.rows, self.lines, strict=True):
                fields = split(row, self.separator)
                seen = {s: int(line) for s in ",." if any(s in fields[i] for i in wanted)} | seen
                if len(seen) == 2:
                    raise ValueError(f"mixes decimal commas (line {seen[',']}) and points (line {seen['.']})")
        return [row.replace(",", ".") for row in self.rows]

    def _row(self, row: str, line: int, wanted: Sequence[int]) -> list[float]:
        parts = split(row, self.separator)
        fields = [parts[i] for i in wanted]
        if row.isascii() and "_" not in row:  # else float would take what is no number in a table
            with suppress(ValueError):
                return [float(field) for field in fields]
        wrong = next((field for field in fields if not _is_value(field)), None)
        if wrong is not None:
            raise ValueError(f"line {line} holds '{wrong[:30]}', which is no number")
        return [np.nan if MISSING.fullmatch(field) else float(field) for field in fields]


def read_table(path: Path) -> Table:
    """Read the table of numbers in a text file, see `table_of`. Raises what that does, and OSError."""
    return table_of(lines_of(path))


def table_of(lines: list[str], *, words: bool = False) -> Table:
    """Find the table of numbers in the lines of a text, from its first row of numbers to its end.

    Empty lines and comments (#, %, //) between rows are passed over. words: whether columns of words or dates
    may stand among those of numbers, and a text may follow, as in records; without, whatever could be a
    damaged row of numbers is refused too, and commas that could be separators or decimal signs. Raises
    NoTable for what is no text or holds no row of numbers; ValueError, naming the line where there is one,
    for what is damaged or could be read in two ways.
    """
    start, separator = _first_row(lines, words=words)
    body = lines[start:]
    if words:
        body = body[: len(body) - _below(body, separator)]
    is_row = [bool(bare := line.strip()) and not COMMENT.match(bare) for line in body]
    rows = list(compress(body, is_row))
    places = np.flatnonzero(is_row) + start + 1
    header = [line for line in lines[:start] if line.strip(" \t;,")]
    if not words and separator == ",":
        _refuse_doubtful_commas(header, rows)
    if any('"' in row for row in rows):
        rows = ["\t".join(split(row, separator)) for row in rows]
        header = ["\t".join(split(line, separator)) for line in header]
        separator = "\t"
    rows, separator, width = _even(rows, places, separator)
    table = Table(tuple(header), separator, width, rows, places, ended=not lines[-1])
    if not words:
        _refuse_lost_rows(table, body, is_row)
    return table


def split(line: str, separator: str | None) -> list[str]:
    """Return the fields of a line without the blanks and quotes around them."""
    if separator is None:
        return line.split()
    fields = line.split(separator)
    if '"' in line:
        with suppress(csv.Error):  # a quote that is never closed belongs to its field
            fields = next(csv.reader([line], delimiter=separator, strict=True))
    return [field.strip() for field in fields]


def _below(body: list[str], separator: str | None) -> int:
    """Count the lines below the rows that are a remark: they begin with a letter and have fewer fields."""
    width, count = len(split(body[0], separator)), 0
    for line in reversed(body[1:]):
        bare = line.strip()
        if bare and (not bare[0].isalpha() or _is_value(bare) or len(split(bare, separator)) >= width):
            break
        count += 1
    return count if any(line.strip() for line in body[len(body) - count :]) else 0


def lines_of(path: Path) -> list[str]:
    """Return the lines of a text file of any encoding. Raises NoTable for what is no text, and OSError."""
    if not S_ISREG(path.stat().st_mode):  # a pipe would be waited for without end
        raise OSError(errno.EINVAL, "it is not a file")
    raw = path.read_bytes()
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = raw.decode("utf-16", errors="replace")
    elif raw[1:200:2].count(0) > 0.8 * len(raw[1:200:2]):  # the same without a mark
        text = raw.decode("utf-16-le", errors="replace")
    else:
        if b"\x00" in raw:
            _refuse_zeros(raw)
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = raw.decode("latin-1")
    if not text.strip():
        raise NoTable("is empty")
    return text.replace("\r\n", "\n").replace("\r", "\n").replace("\xa0", " ").split("\n")


def _refuse_zeros(raw: bytes) -> None:
    """Raise NoTable for an instrument's own format, ValueError with the line for a text with a few zeros."""
    rest = raw[:100000].translate(None, b"\x00")
    if len(rest.translate(None, CONTROL)) <= (1.0 - LARGEST_CONTROL) * len(rest):
        raise NoTable("is no text file")
    line = raw.count(b"\n", 0, raw.index(b"\x00")) + 1
    raise ValueError(f"line {line} holds a byte of value 0, which no text has")


def _first_row(lines: list[str], *, words: bool) -> tuple[int, str | None]:
    """Return the index of the line where the rows of numbers begin, and their separator."""
    for index, line in enumerate(lines[:HEADER_LINES]):
        if not line.strip() or COMMENT.match(line):
            continue
        following = next((other for other in lines[index + 1 : index + 100] if other.strip()), "")
        count = _numbers_between_any(line)
        if COUNTS.fullmatch(line) and _first_split(following, words=words)[1] > count:
            continue
        separator, width = _first_split(line, words=words)
        if width and (count or not following or len(split(following, separator)) == width):
            while index and _is_missing(split(lines[index - 1], separator), width, words=words):
                index -= 1
            return index, separator
        if count > 1 and not width and not any(_are_values(split(line, sign)) for sign in SEPARATORS):
            raise ValueError(f"mixed separators: line {index + 1} has different ones between its numbers")
    beginning = "\n".join(lines)[:4000]
    if sum(not (c.isprintable() or c in "\n\t\f") for c in beginning) > MOST_UNPRINTABLE:
        raise NoTable("is no text file")
    first = next(line.strip() for line in lines if line.strip())
    raise NoTable(f"has no rows of numbers in two or more columns; it begins with '{first[:60]}'")


def _numbers_between_any(line: str) -> int:
    """Return how many fields a line has between any separators, 0 unless all are numbers or missing."""
    fields = [field for field in re.split(r"[\s;,]+", line) if field]
    numbers = sum(NUMBER.fullmatch(field) is not None for field in fields)
    return len(fields) if numbers and all(_is_value(field) for field in fields) else 0


def _first_split(line: str, *, words: bool) -> tuple[str | None, int]:
    """Return the first separator that makes a line a row, and the number of its fields; 0 where none does."""
    for separator in SEPARATORS:
        fields = split(line, separator)
        least = 2 if words or separator is not None else 1
        if len(fields) >= least and _is_row(fields, words=words and separator is not None, clocks=words):
            return separator, len(fields)
    return None, 0


def _is_row(fields: list[str], *, words: bool, clocks: bool) -> bool:
    numbers = sum(NUMBER.fullmatch(field) is not None for field in fields)
    others = [field for field in fields if not _is_value(field) and not (clocks and DATE.fullmatch(field))]
    if not words or len(fields) < 3:
        return numbers > 0 and not others
    return numbers > 1 and all(any(map(str.isalpha, word)) and not NUMBER.match(word) for word in others)


def _is_missing(fields: list[str], width: int, *, words: bool) -> bool:
    """Return whether all of `width` fields are words for missing values, and no line of dashes.

    words: in records, where a row may miss some values, a number among them is none of a header.
    """
    no_dashes = [bool(field.strip("-–")) for field in fields]
    if words:
        return len(fields) == width and any(no_dashes) and _are_values(fields)
    return len(fields) == width and all(no_dashes) and all(map(MISSING.fullmatch, fields))


def _are_values(fields: list[str]) -> bool:
    return len(fields) > 1 and all(map(_is_value, fields))


def _is_value(field: str) -> bool:
    return bool(NUMBER.fullmatch(field) or MISSING.fullmatch(field))


def _even(
    rows: list[str], lines: npt.NDArray[np.intp], separator: str | None
) -> tuple[list[str], str | None, int]:
    """Return rows of equal length without a separator that ends them all, their separator and their width.

    Blanks, tabs and semicolons may change from row to row where no field is empty.
    """
    if separator is None:
        widths = [len(row.split()) for row in rows]
    else:
        if all(row.rstrip(" ").endswith(separator) for row in rows):
            rows = [row.rstrip(" ")[:-1] for row in rows]
        widths = [row.count(separator) + 1 for row in rows]
    width = widths[0]
    uneven = next((place for place, other in enumerate(widths) if other != width), None)
    if uneven is None:
        return rows, separator, width
    if separator != "," and not any(EMPTY_FIELD.search(row) for row in rows):
        blank = [row.replace(";", " ") for row in rows]
        if all(len(row.split()) == width for row in blank):
            return blank, None, width
    raise ValueError(
        f"line {lines[uneven]} has {widths[uneven]} fields where line {lines[0]} has {width}: ragged rows or "
        "mixed separators, where equal ones are expected"
    )


def _refuse_doubtful_commas(header: list[str], rows: list[str]) -> None:
    """Raise ValueError where no number has a point and every other comma could be a decimal sign."""
    if any("." in row or ", " in row or ",," in row or row.rstrip().endswith(",") for row in rows):
        return
    fields = [split(row, ",") for row in rows]
    if any(len(row) % 2 or any(field[:1] in ("-", "+") for field in row[1::2]) for row in fields):
        return
    if not any(len(split(line, ",")) == len(fields[0]) for line in header[-2:]):
        raise ValueError("a comma between all digits, which may be a separator or a decimal sign")


def _refuse_lost_rows(table: Table, body: list[str], is_row: list[bool]) -> None:
    """Raise ValueError for a broken row that passed for the header, and for one behind a comment's sign.

    In two or three columns a header may well be made of a word and numbers.
    """
    width, last = table.width, table.header[-1] if table.header else ""
    if width > 3 and not last.lstrip().startswith(COMMENTS):
        fields = split(last, table.separator)
        words = [field for field in fields if not _is_value(field)]
        if abs(len(fields) - width) <= width // 8 and 0 < len(words) < 0.5 * width:
            raise ValueError(f"line {table.lines[0] - 1} holds {words[0][:20]!r}, which is no number")
    for place in np.flatnonzero(np.logical_not(is_row)):
        line = body[place].strip()
        sign = next((sign for sign in COMMENTS if line.startswith(sign)), "")
        fields = split(line[len(sign) :], table.separator)
        if len(fields) == width > 2 and all(map(_is_value, fields)):
            raise ValueError(f"line {table.lines[0] + place} is a row of numbers behind a {sign!r}")
