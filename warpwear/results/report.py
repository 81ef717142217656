"""A report declares each of its numbers once: as an entry of JSON and as an aligned line for people."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from warpwear.history.quantities import printed

_UNITS = ("um", "mm", "um^2", "mm^2", "mm^3", "N", "MPa", "J", "W", "s", "N/mm^3", "mm^3/N/m", "mm/min")
#: End of a key -> its unit as people write it.
UNITS = {unit.replace("^", "").replace("/N/m", "/Nm").replace("/", "_per_"): printed(unit) for unit in _UNITS}
UNITS |= {"percent": "%", "per_Pa": "m²/N (Pa⁻¹)", "MPa_m_per_s": "MPa·m/s", "um_per_N": "µm/N"}
#: Column at which values start.
VALUES = 19


@dataclass(frozen=True)
class Row:
    """Declare one quantity of a report.

    label: its name for people; "" where JSON alone has it. key: its name in JSON, with its unit at the end;
    "" where people alone see it. value: a number in that unit, a text, None where it is unknown (and then no
    line), a mapping or a sequence of these, or rows: with a key one entry of JSON, else an entry each; with a
    label one line, else a line each. digits: significant digits for people. note: what they read after the
    unit. error: the standard error, whose key is the row's with _error before its unit, or this error and
    its key. unit: for people, where the key does not name it.
    scientific: whether to write 3.5e-4.
    """

    label: str
    key: str
    value: Any
    digits: int = 4
    note: str = ""
    error: tuple[str, float | None] | float | None = None
    unit: str | None = None
    scientific: bool = False
    sentence: str | None = None

    @property
    def ending(self) -> str:
        """Return the end of the key that is a unit, with what stands before it; empty for none."""
        parts = self.key.split("_")
        ends = ("_".join(parts[start:]) for start in range(1, len(parts)))
        return next((f"_{end}" for end in ends if end in UNITS), "")

    @property
    def units(self) -> str:
        """Return the unit as people write it; empty for a number without one."""
        return UNITS.get(self.ending[1:], "") if self.unit is None else self.unit

    @property
    def uncertainty(self) -> tuple[str, float | None]:
        """Return key and value of the standard error."""
        if isinstance(self.error, tuple):
            return self.error
        return f"{self.key.removesuffix(self.ending)}_error{self.ending}", self.error

    @property
    def number(self) -> str:
        """Write the value with its error, without its unit: '0.0071 ± 0.0004'."""
        error = self.uncertainty[1]
        if self.scientific:
            return scientific(self.value, error, digits=self.digits)
        text = shown(self.value, self.digits)
        if error is None:
            return text
        if isinstance(self.value, float) and 0.0 < abs(self.value) < math.inf and 0.0 < error < math.inf:
            # no digit of the value stands behind the last one of its error
            known = math.floor(math.log10(abs(self.value))) - math.floor(math.log10(error)) + 2
            text = f"{self.value:#.{max(1, min(self.digits, known))}g}".replace(".e", "e").rstrip(".")
        return f"{text} ± {error:.2g}"

    @property
    def text(self) -> str:
        """Write everything that stands behind the label."""
        if self.sentence is not None:
            return self.sentence
        number = self.number
        if _are_rows(self.value):
            number = ", ".join(f"{row.label} {row.text}" for row in _visible(self.value))
        space = " " * (self.note[:1] not in ("", ",", ";", ":"))
        return f"{number} {self.units}".rstrip() + space + self.note


def record(rows: Iterable[Row]) -> dict[str, Any]:
    """Turn a report into key -> value, ready for JSON but for NaN; see `to_json`."""
    content: dict[str, Any] = {}
    for row in rows:
        if row.key:
            content[row.key] = _entry(row.value)
        elif _are_rows(row.value):
            content |= record(row.value)
        if row.error is not None and row.uncertainty[0]:
            content[row.uncertainty[0]] = row.uncertainty[1]
    return content


def lines(rows: Iterable[Row]) -> list[str]:
    """Write a report for people: lines of label and value; each text of a list has a line of its own."""
    text: list[str] = []
    for row in rows:
        if not row.label:
            text += lines(_inner(row.value))
        elif _visible([row]):
            label = f"  {row.label}"
            for line in row.value if _are_texts(row.value) else [row.text]:
                text.append(f"{label:<{VALUES - 1}} {line}")
                label = ""
    return text


def table(groups: Sequence[Sequence[Row]]) -> list[str]:
    """Write a table with a line for each group and a column for each of its rows, alike in all groups."""
    head = [f"{row.label}, {row.units}".removesuffix(", ") for row in _visible(groups[0])]
    cells = [[row.number for row in _visible(rows)] for rows in groups]
    return ["  " + line for line in aligned([head, *cells])]


def aligned(cells: Sequence[Sequence[str]]) -> list[str]:
    """Write the lines of a table: the first column begins at the left, the others end at the right."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    form = "  ".join(f"{{:{'>' if column else '<'}{width}}}" for column, width in enumerate(widths))
    return [form.format(*line).rstrip() for line in cells]


def shown(value: Any, digits: int = 4) -> str:
    """Write a value for people: '0.36', '3 × 3' (a sequence), 'mean 303, max 590' (a mapping), '–' (None)."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {shown(part, digits)}" for name, part in value.items())
    if isinstance(value, list | tuple):
        return " × ".join(shown(part, digits) for part in value)
    if isinstance(value, float):
        return f"{value:.{digits}g}"
    return "–" if value is None else str(value)


def times(factor: float, value: float | None) -> float | None:
    """Return a multiple of a number; None of one that is not known."""
    return None if value is None else factor * value


def scientific(value: float, error: float | None = None, *, digits: int = 4) -> str:
    """Write a number as 3.691e-4, with its error to two digits as (3.69 ± 0.18)e-4."""
    power = math.floor(math.log10(abs(value))) if value else 0
    part = float(f"{value / 10.0**power:.{digits - 1}f}")
    if abs(part) >= 10.0:  # rounded up to the next power
        part, power = part / 10.0, power + 1
    if not error:
        return f"{part:.{digits - 1}f}e{power}"
    small = error / 10.0**power
    if not 1e-6 < small < 1e4:  # two digits of it would be a row of zeros
        return f"({part:.{digits - 1}f} ± {small:.0e})e{power}"
    decimals = max(0, 1 - math.floor(math.log10(small)))
    return f"({value / 10.0**power:.{decimals}f} ± {small:.{decimals}f})e{power}"


def to_json(content: Any) -> str:
    """Write JSON, which has no word for NaN and infinity: they become null."""
    return json.dumps(without_nan(content), indent=2, ensure_ascii=False, allow_nan=False)


def without_nan(content: Any) -> Any:
    """Copy nested mappings and sequences with None for every number that is not finite."""
    if isinstance(content, Mapping):
        return {name: without_nan(value) for name, value in content.items()}
    if isinstance(content, list | tuple):
        return [without_nan(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content


def finite(value: float) -> float | None:
    """Return a number for JSON, None for infinity and NaN, which it has no words for."""
    return float(value) if math.isfinite(value) else None


def quoted(text: str) -> str:
    """Put an apostrophe before what a spreadsheet would compute as a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def _entry(value: Any) -> Any:
    """Turn a row's value into what JSON has: rows into a mapping."""
    if _are_rows(value):
        return record(value)
    if isinstance(value, Mapping):
        return {name: _entry(part) for name, part in value.items()}
    return [_entry(part) for part in value] if isinstance(value, list | tuple) else value


def _are_rows(value: Any) -> bool:
    return isinstance(value, list | tuple) and bool(value) and isinstance(value[0], Row)


def _inner(value: Any) -> list[Row]:
    """List the rows in a value that is a list of rows, or of lists of them."""
    if isinstance(value, list | tuple):
        return [row for part in value for row in _inner(part)]
    return [value] if isinstance(value, Row) else []


def _are_texts(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(part, str) for part in value)


def _visible(rows: Iterable[Row]) -> list[Row]:
    return [row for row in rows if row.label and row.value is not None and row.value != {}]
