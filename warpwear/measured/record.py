"""Read records of measurements: a table in text with the names and units of its columns, of any make.

A make stands in one place, `makes.toml`: its name, the words that it is known by, the line above its rows,
what its columns are. A file without such words is a plain table, which `warpwear.surfaces.text` reads.
"""

import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.study.units import is_known
from warpwear.surfaces.container import check_archive
from warpwear.surfaces.text import COMMENTS, MISSING, SEPARATORS, NoTable, Table, lines_of, split, table_of

pandas = lazy.module("pandas")

#: Lines at the start of a file among which a make's words are looked for.
HEAD = 80
#: A line that begins with a number, a word for none or a time of day, behind separators.
_NUMERIC = re.compile(rf"[\s;,]*\"?(?:[-+]?(?:\d|[.,]\d)|(?!-)(?:{MISSING.pattern[1:]})\"?\s*[;,\t])", re.I)
#: Name of a column behind the others that a file may leave empty altogether.
_REMARK = "comment"
#: Letters of a column's name; what is longer is no name, and would fill every sentence.
LONGEST = 80
#: A time of day or since the start, behind a date or without.
_CLOCK = re.compile(
    r"(?:\S.*?[T ,]\s*)?(\d{1,3}):(\d\d):(\d\d(?:[.,]\d*)?)\s*(?:([ap])\.?m\.?|Z|[+-]\d\d:?\d\d)?", re.I
)
#: A day [s]; a clock that falls by more than half of it has passed midnight.
DAY = 86400.0


@dataclass(frozen=True, kw_only=True)
class RecordFormat:
    """A make writes its records in one way.

    mark: expression found in the first lines of its files. header: expression of the line with the names of
    the columns; rows follow, after a line of units where there is one. columns: expression of a name in small
    letters -> what it is, "" for nothing of interest, and its unit where the file has none. step: expression
    of a line before a table that begins a step, its group the step's name.
    """

    name: str
    mark: str = ""
    header: str = ""
    columns: Mapping[str, Sequence[str]] = field(default_factory=dict)
    step: str = ""


def declared(name: str) -> dict[str, Any]:
    """Read one of the tables of this wing."""
    return tomllib.loads((files("warpwear.measured") / f"{name}.toml").read_text(encoding="utf-8"))


FORMATS = tuple(RecordFormat(**make) for make in declared("makes")["make"])
#: What stands for a unit in the header of a record.
UNITS = frozenset(declared("columns")["units"])
PLAIN = RecordFormat(name="plain table")


@dataclass(frozen=True, eq=False)
class Record:
    """A record is the table in a file, with the name and the unit of each column."""

    path: Path
    table: Table
    names: tuple[str, ...]  # shape (columns,); empty without a header
    units: tuple[str, ...]  # from a row of their own below the names, shape (columns,); empty without
    format: RecordFormat = PLAIN
    steps: tuple[str, ...] = ()  # name of each row's step by the lines between them, shape (rows,); or none
    notes: tuple[str, ...] = ()  # what was left out of the file, each a sentence

    def columns(self, wanted: Sequence[int]) -> FloatArray:
        """Return columns as numbers, shape (rows, len(wanted)), NaN where missing.

        Raises InputError for what is no number and for decimal commas beside points.
        """
        with _refusals(self.path):
            clocks = {index: self._seconds(index) for index in wanted if self.is_clock(index)}
            plain = [index for index in wanted if index not in clocks]
            read = dict(zip(plain, self.table.numbers(plain).T, strict=True)) if plain else {}
            return np.array([(clocks | read)[index] for index in wanted]).T

    def is_clock(self, index: int) -> bool:
        """Return whether a column holds times of day, with or without a date."""
        return _CLOCK.fullmatch(split(self.table.rows[0], self.table.separator)[index]) is not None

    def _seconds(self, index: int) -> FloatArray:
        """Return the time since the first row [s] by a clock, over midnight. Raises ValueError."""
        seconds = np.full(len(self.table.rows), np.nan)
        for place, (row, line) in enumerate(zip(self.table.rows, self.table.lines, strict=True)):
            text = split(row, self.table.separator)[index]
            clock = _CLOCK.fullmatch(text)
            if clock is None and not MISSING.fullmatch(text):
                raise ValueError(f"line {line} holds '{text[:30]}', which is no time of day")
            if clock is not None:
                hour = int(clock[1]) if clock[4] is None else int(clock[1]) % 12 + 12 * (clock[4] in "pP")
                seconds[place] = 3600.0 * hour + 60.0 * int(clock[2]) + float(clock[3].replace(",", "."))
                with suppress(ValueError):  # a date that is none of ISO 8601: midnight counts it
                    seconds[place] = datetime.fromisoformat(text).replace(tzinfo=UTC).timestamp()
        known = np.isfinite(seconds)
        seconds[known] += DAY * np.cumsum(np.diff(seconds[known], prepend=np.nan) < -0.5 * DAY)
        return seconds - seconds[known][0]


def read_record(path: Path) -> Record:
    """Read the rows of a text file and the header over them.

    A header has as many names as there are columns, above the first row, with at most a row of units between.
    A unit may also be a field of its own behind its name. Raises InputError for what is no table of text.
    """
    with _refusals(path):
        lines, said = _sheet(path) if path.suffix.lower() in (".xlsx", ".xlsm") else (lines_of(path), ())
        if _is_cut(lines):
            said = (*said, f"The last row, line {len(lines)}, is cut short and was left out.")
            lines = [*lines[:-1], ""]
        head = "\n".join(lines[:HEAD])
        form = next((form for form in FORMATS if re.search(form.mark, head)), PLAIN)
        pieces = list(_pieces(lines, form)) if form.header else []
        if pieces:
            record = _joined(path, form, pieces)
        else:
            table = table_of(lines, words=True)
            record = Record(path, table, *_names_and_units(table), form)
    names = (name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…" for name in record.names)
    return replace(record, names=tuple(names), notes=(*said, *record.notes))


def _sheet(path: Path) -> tuple[list[str], tuple[str, ...]]:
    """Return the lines of the sheet of a workbook that has most rows, and a note where there are others.

    Raises ValueError for what is no workbook, and InputError where a package is missing.
    """
    try:
        check_archive(path)
        sheets = pandas.read_excel(path, sheet_name=None, header=None, dtype=object, engine="openpyxl")
    except ImportError as error:
        raise InputError(f"{path} needs pandas and openpyxl: pip install 'warpwear[io]'") from error
    except Exception as error:  # whatever openpyxl meets
        raise ValueError(f"it is no workbook that can be read: {error}") from error
    name = max(sheets, key=lambda name: len(sheets[name]))
    rows = sheets[name].fillna("").to_numpy().tolist()
    lines = ["\t".join(" ".join(str(cell).split()) for cell in row) for row in rows]
    note = f"Sheet '{name}' of {len(sheets)}, the one with most rows."
    return [*lines, ""], (note,) * (len(sheets) > 1)


def _is_cut(lines: list[str]) -> bool:
    """Return whether the last line has no end and less in it than the row before: the file was cut there.

    A row has fewer fields then, or a last number of fewer digits.
    """
    if len(lines) < 4 or not lines[-1].strip():
        return False
    before, last = (re.split(r"[\s;,]+", line.rstrip(" ;,\t")) for line in lines[-2:])
    if bool(_NUMERIC.match(lines[-2])) != bool(_NUMERIC.match(lines[-1])):
        return False
    return len(last) < len(before) or (len(last) == len(before) and len(last[-1]) < len(before[-1]))


@contextmanager
def _refusals(path: Path) -> Iterator[None]:
    """Turn what a table refuses into InputError with the file's name."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except NoTable as error:
        raise InputError(
            f"{path} {error}: a table of text (.csv, .txt) or .xlsx is expected, with numbers under a header"
        ) from error
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error


@dataclass
class _Piece:
    """A table of a file has names, units and rows."""

    separator: str | None
    names: tuple[str, ...]
    units: tuple[str, ...]
    step: str
    rows: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)


def _pieces(lines: list[str], form: RecordFormat) -> Iterator[_Piece]:
    """Give the tables of a file whose make says where they begin. Raises ValueError for rows out of place."""
    header, step_line = re.compile(form.header), re.compile(form.step or r"(?!)")
    piece: _Piece | None = None
    step, closed = "", False
    for number, line in enumerate(lines, 1):
        if (mark := step_line.match(line)) is not None:
            step = mark[1]
        if header.match(line):
            if piece is not None and piece.rows:
                yield piece
            separator = max(SEPARATORS[:3], key=lambda sign: line.count(sign or ""))
            piece, closed = _Piece(separator, tuple(split(line, separator)), (), step), False
        elif piece is None or not line.strip():
            closed = piece is not None and bool(piece.rows)
        elif _NUMERIC.match(line) and piece.separator and piece.separator in line:
            if closed and piece.rows and lines[number - 2].strip():
                raise ValueError(
                    f"line {number} is a row of numbers behind '{lines[number - 2][:30]}', which is none: "
                    "rows without anything between them are expected"
                )
            piece.rows.append(line)
            piece.lines.append(number)
        elif not piece.rows and _are_units(split(line, piece.separator)):
            piece.units = tuple(split(line, piece.separator))
        else:
            closed = True
    if piece is not None and piece.rows:
        yield piece


def _joined(path: Path, form: RecordFormat, pieces: list[_Piece]) -> Record:
    """Lay the tables of one file together: those whose names are those of most rows."""
    rows_of: Counter[tuple[str, ...]] = Counter()
    for piece in pieces:
        rows_of[piece.names] += len(piece.rows)
    ((names, most),) = rows_of.most_common(1)
    other = rows_of.total() - most
    notes = [f"Tables of other columns, left out: {len(rows_of) - 1} with {other} rows."] if other else []
    chosen = [piece for piece in pieces if piece.names == names]
    separator, units = chosen[0].separator, chosen[0].units
    rows = [row.rstrip() if separator != "\t" else row for piece in chosen for row in piece.rows]
    numbers = [number for piece in chosen for number in piece.lines]
    steps = tuple(piece.step for piece in chosen for _ in piece.rows)
    width = rows[0].count(separator or "") + 1
    for row, number in zip(rows, numbers, strict=True):
        if (count := row.count(separator or "") + 1) != width:
            raise ValueError(f"line {number} has {count} fields, line {numbers[0]} {width}: ragged rows")
    full = _fitting(names, rows, separator, width, numbers)
    table = Table((), separator, width, rows, np.array(numbers, dtype=np.intp), ended=True)
    return Record(path, table, full, _padded(units, width), form, steps, tuple(notes))


def _fitting(
    names: tuple[str, ...], rows: list[str], separator: str | None, width: int, numbers: list[int]
) -> tuple[str, ...]:
    """Return a name for each field of the rows. Raises ValueError where names and fields do not fit.

    Behind the names there may be empty fields, and behind the fields the name of a remark.
    """
    last = max((place for place, name in enumerate(names) if name), default=-1) + 1
    if width > last:
        first = next(
            (number for row, number in zip(rows, numbers, strict=True) if any(split(row, separator)[last:])),
            None,
        )
        if first is not None:
            raise ValueError(f"line {first} has {width} fields under {last} names: a name each is expected")
    if width < last and any(name.lower() not in ("", _REMARK) for name in names[width:]):
        raise ValueError(f"line {numbers[0]} has {width} fields under {last} names: a field each is expected")
    return _padded(names, width)


def _padded(names: tuple[str, ...], width: int) -> tuple[str, ...]:
    return (*names[:width], *[""] * (width - len(names))) if names else ()


def _names_and_units(table: Table) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of the columns from the last lines before the numbers; () for none."""
    rows = []
    for line in table.header[-1:-3:-1]:
        fields = _names(line.lstrip("#%/ ") if line.lstrip().startswith(COMMENTS) else line, table)
        if fields is None or not any(fields):
            break
        rows.append(fields)
    if len(rows) == 2 and _are_units(rows[0]):
        return rows[1], rows[0]
    return (rows[0] if rows else ()), ()


def _names(line: str, table: Table) -> tuple[str, ...] | None:
    """Return the fields of a line of the header, if there are as many as columns."""
    fields = split(line, table.separator)
    if table.separator is None:
        ways = [fields, _with_units(fields, " "), re.split(r"\s{2,}|\t|;", line.strip())]
    else:
        while len(fields) > table.width and not fields[-1]:
            fields.pop()
        ways = [fields, _with_units(fields, ", ")]
    return next((tuple(way) for way in ways if len(way) == table.width), None)


def _with_units(fields: list[str], joint: str) -> list[str]:
    """Join units that stand as fields of their own to the names before them."""
    joined: list[str] = []
    for part in fields:
        if joined and is_unit(part):
            joined[-1] += joint + part
        else:
            joined.append(part)
    return joined


def is_unit(text: str, *, rare: bool = False) -> bool:
    """Return whether a field is a unit of a record and no name, such as mm, [s] or (-).

    rare: whether all that pint knows are units, bar and Ohm, but also t and mu: for where a unit stands.
    """
    bare = text.strip("[]() ").replace("μ", "u").replace("µ", "u")
    return bare.lower() in UNITS or (rare and is_known(bare))


def _are_units(fields: Sequence[str]) -> bool:
    """Return whether the fields of a row are units, all of them or most, the others rare ones."""
    filled = [field for field in fields if field]
    usual = sum(is_unit(field) or field[0] + field[-1] in ("[]", "()") for field in filled)
    units = usual + sum(is_unit(field, rare=True) and not is_unit(field) for field in filled) * (usual > 1)
    return usual == len(filled) or (usual > 1 and 2 * units > len(filled))
