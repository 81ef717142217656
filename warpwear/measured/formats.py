"""Know the make of a record of friction by what is in its file, and cut its tables out of the text.

A make stands in one place, `makes.toml`: its name, the words that it is known by, the line above its rows,
what its columns are. A file without such words is a plain table, which `warpwear.surfaces.text` reads.
"""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files

import numpy as np

from warpwear.surfaces.text import SEPARATORS, Table, split, table_of

#: Lines at the start of a file among which a make's words are looked for.
HEAD = 80
#: A line that begins with a number or a time of day, behind separators.
_NUMERIC = re.compile(r"[\s;,]*\"?[-+]?(?:\d|[.,]\d)")
#: Name of a column behind the others that a file may leave empty altogether.
_REMARK = "comment"


@dataclass(frozen=True, kw_only=True)
class Format:
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


_MAKES = tomllib.loads((files("warpwear.measured") / "makes.toml").read_text(encoding="utf-8"))
FORMATS = tuple(Format(**make) for make in _MAKES["make"])
PLAIN = Format(name="plain table")


@dataclass(frozen=True)
class Text:
    """The tables of one file hold one after another, with the names of their columns.

    steps: name of the step of each row by the text, shape (rows,), or none. notes: what was left out.
    """

    format: Format
    table: Table
    names: tuple[str, ...] | None = None  # None where the table's header has them
    units: tuple[str, ...] = ()
    steps: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def format_of(lines: Sequence[str]) -> Format:
    """Return the make whose words stand in the first lines of a file."""
    head = "\n".join(lines[:HEAD])
    return next((form for form in FORMATS if re.search(form.mark, head)), PLAIN)


def text_of(lines: list[str], is_unit: Callable[[str], bool]) -> Text:
    """Cut the tables out of the lines of a record. Raises NoTable and ValueError for what is none.

    is_unit: says of a field whether it is a unit.
    """
    form = format_of(lines)
    if form.header:
        pieces = list(_pieces(lines, form, is_unit))
        if pieces:
            return _joined(form, pieces, ended=not lines[-1])
    return Text(form, table_of(lines, words=True))


@dataclass
class _Piece:
    """A table of a file has names, units and rows."""

    separator: str | None
    names: tuple[str, ...]
    units: tuple[str, ...]
    step: str
    rows: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    cut: int = 0  # line of a last row without its end


def _pieces(lines: list[str], form: Format, is_unit: Callable[[str], bool]) -> Iterator[_Piece]:
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
        elif not piece.rows and all(not part or is_unit(part) for part in split(line, piece.separator)):
            piece.units = tuple(split(line, piece.separator))
        else:
            closed = True
    if piece is not None and piece.rows:
        yield piece


def _joined(form: Format, pieces: list[_Piece], *, ended: bool) -> Text:
    """Lay the tables of one file together: those whose names are those of most rows."""
    rows_of: dict[tuple[str, ...], int] = {}
    for piece in pieces:
        rows_of[piece.names] = rows_of.get(piece.names, 0) + len(piece.rows)
    names = max(rows_of, key=lambda key: rows_of[key])
    other = sum(rows_of.values()) - rows_of[names]
    notes = [f"Tables of other columns, left out: {len(rows_of) - 1} with {other} rows."] if other else []
    chosen = [piece for piece in pieces if piece.names == names]
    separator, units = chosen[0].separator, chosen[0].units
    rows = [row.rstrip() if separator != "\t" else row for piece in chosen for row in piece.rows]
    numbers = [number for piece in chosen for number in piece.lines]
    steps = tuple(piece.step for piece in chosen for _ in piece.rows)
    width = rows[0].count(separator or "") + 1
    last = rows[-1].count(separator or "") + 1
    if not ended and len(rows) > 2 and last < width:
        notes.append(f"The last row, line {numbers[-1]}, is cut short and was left out.")
        rows, numbers, steps = rows[:-1], numbers[:-1], steps[:-1]
    for row, number in zip(rows, numbers, strict=True):
        if (count := row.count(separator or "") + 1) != width:
            raise ValueError(
                f"line {number} has {count} fields where line {numbers[0]} has {width}: ragged rows, where "
                "equal ones are expected"
            )
    full = _fitting(names, rows, separator, width, numbers)
    table = Table((), separator, width, rows, np.array(numbers, dtype=np.intp), ended=ended)
    return Text(form, table, full, _padded(units, width), steps, tuple(notes))


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
