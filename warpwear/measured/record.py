"""Read records of measurements: a table in text with the names and units of its columns."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.formats import PLAIN, Format, text_of
from warpwear.surfaces.text import COMMENTS, NoTable, Table, lines_of, split

#: What stands for a unit in the header of a record, in small letters, µ as u.
UNITS = frozenset(
    ("-", "–", "1", "%", "nm", "um", "mm", "cm", "m", "km", "ms", "s", "sec", "sek", "min", "h", "hr", "std")
) | {"n", "mn", "kn", "°c", "c", "rpm", "mm/s", "m/s", "hz", "v", "g"}
UNITS |= {"1/min", "kg", "gf", "kgf", "mm/sec", "m/sec", "µm", "micrometer", "deg", "rev", "degc", "mm/min"}


#: Letters of a column's name; what is longer is no name, and would fill every sentence.
LONGEST = 80


@dataclass(frozen=True, eq=False)
class Record:
    """A record is the table in a file, with the name and the unit of each column."""

    path: Path
    table: Table
    names: tuple[str, ...]  # shape (columns,); empty without a header
    units: tuple[str, ...]  # from a row of their own below the names, shape (columns,); empty without
    format: Format = PLAIN
    steps: tuple[str, ...] = ()  # name of each row's step by the lines between them, shape (rows,); or none
    notes: tuple[str, ...] = ()  # what was left out of the file, each a sentence

    def columns(self, wanted: Sequence[int]) -> FloatArray:
        """Return columns as numbers, shape (rows, len(wanted)), NaN where missing.

        Raises InputError for what is no number and for decimal commas beside points.
        """
        with _refusals(self.path):
            return self.table.numbers(wanted)


def read_record(path: Path) -> Record:
    """Read the rows of a text file and the header over them.

    A header has as many names as there are columns, above the first row, with at most a row of units between.
    A unit may also be a field of its own behind its name. Raises InputError for what is no table of text.
    """
    with _refusals(path):
        text = text_of(lines_of(path), is_unit)
    table = text.table
    names, units = _names_and_units(table) if text.names is None else (text.names, text.units)
    names = tuple(name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…" for name in names)
    return Record(path, table, names, units, text.format, text.steps, text.notes)


@contextmanager
def _refusals(path: Path) -> Iterator[None]:
    """Turn what a table refuses into InputError with the file's name."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except NoTable as error:
        raise InputError(
            f"{path} {error}: a table of text such as .csv or .txt is expected, with numbers under a header"
        ) from error
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error


def _names_and_units(table: Table) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of the columns from the last lines before the numbers; () for none."""
    rows = []
    for line in table.header[-1:-3:-1]:
        fields = _names(line.lstrip("#%/ ") if line.lstrip().startswith(COMMENTS) else line, table)
        if fields is None or not any(fields):
            break
        rows.append(fields)
    if len(rows) == 2 and all(not field or is_unit(field) for field in rows[0]):
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
    for field in fields:
        if joined and is_unit(field):
            joined[-1] += joint + field
        else:
            joined.append(field)
    return joined


def is_unit(text: str) -> bool:
    """Return whether a field is a unit of a record and no name, such as mm, [s] or (-)."""
    return text.strip("[]() ").replace("μ", "u").replace("µ", "u").lower() in UNITS
