"""Tables of many rows, as files that spreadsheets read."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from warpwear.results.report import quoted


def write_csv(table: Mapping[str, Sequence[Any]], path: Path) -> None:
    """Write a table, a column a name with its unit: numbers in all their digits, nothing for None."""
    with path.open("w", newline="", encoding="utf-8", errors="backslashreplace") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(quoted, table))
        for row in zip(*table.values(), strict=True):
            writer.writerow([quoted(cell) if isinstance(cell, str) else cell for cell in row])


def read_csv(path: Path) -> list[dict[str, str]]:
    """Read the rows of a table by the names of their columns, without one that was cut off.

    Raises OSError, UnicodeError or csv.Error for what is no such table.
    """
    with path.open(newline="", encoding="utf-8-sig") as file:
        return [row for row in csv.DictReader(file) if None not in row.values()]
