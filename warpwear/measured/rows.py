"""Hold the rows of a record of friction in mm, s and N, of one file or of many, with its recipe's steps."""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.columns import OTHER_RATIO, Column, choose, further, other_coefficients
from warpwear.measured.record import Record, read_record
from warpwear.study.units import several
from warpwear.surfaces.outliers import TIMES_NEXT, at_ends

Indices: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.intp]]"
Mask: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]"
#: A file, a folder of files of one record, or several files of one.
Paths: TypeAlias = str | Path | Sequence[str | Path]
#: Roles that go on where a machine begins to count anew at a step.
COUNTED = ("time", "distance", "laps", "cycle")
#: Part of the largest normal force below which there is no load, and rows that make a sensor's offset.
UNLOADED, FEW_ROWS = 0.02, 5
#: Part of the rows between these values that may repeat the row before: more is what a sensor resolves.
COARSE = 0.1
#: Part of the rows at one value that is told, of so many rows or more.
ONE_VALUE, FEWEST = 0.5, 50


@dataclass(frozen=True, eq=False)
class RecordRows:
    """A record has rows of quantities, in steps one after another.

    table: role -> values [mm, s, N, turns a minute, 1], shape (rows,), NaN where missing; what plays no role
    by name and unit. step: of each row, counted from 0, shape (rows,); steps: their names.
    """

    path: Path
    format: str
    table: dict[str, FloatArray]
    chosen: dict[str, Column]
    step: Indices
    steps: tuple[str, ...]
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def of_step(self, number: int) -> "RecordRows":
        """Return the rows of one step, by its number from 0; all but the first count from their beginning."""
        inside = self.step == number
        table = {role: values[inside] for role, values in self.table.items()}
        for role in set(COUNTED) & table.keys() if number else ():
            table[role] = table[role] - np.append(table[role][np.isfinite(table[role])], 0.0)[0]
        step = np.zeros(np.count_nonzero(inside), dtype=np.intp)
        return replace(self, table=table, step=step, steps=(self.steps[number],))


def without(rows: RecordRows, some: Mask, what: str) -> tuple[RecordRows, list[str]]:
    """Return rows without some, shape (rows,), and a note on these; all where there is no other."""
    if not some.any() or some.all():
        return rows, []
    table = {role: values[~some] for role, values in rows.table.items()}
    note = f"{what}, left out: {some.sum()} of {some.size}."
    return replace(rows, table=table, step=rows.step[~some]), [note]


def files_of(paths: Paths) -> list[Path]:
    """Return the files of one record in order: those given, or those in a folder, 2 before 10."""
    places = [Path(path) for path in several(paths)]
    files: list[Path] = []
    for path in places:
        if path.is_dir():
            inside = [one for one in path.iterdir() if one.is_file() and not one.name.startswith(".")]
            files += sorted(inside, key=_natural)
        else:
            files.append(path)
    if not files:
        raise InputError(f"{places[0] if places else 'the record'} holds no file of a record")
    return files


def _natural(path: Path) -> list[tuple[int, str]]:
    """Return what sorts names with numbers as people do."""
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdecimal() and part.isascii() else (-1, part) for part in parts]


def read_rows(paths: Paths, columns: str | None = None) -> RecordRows:
    """Read the rows of a record, whatever machine wrote it.

    paths: a file, a folder, or files that follow each other. columns: which to take, see
    `warpwear.measured.columns.choose`. Raises InputError.
    """
    files = files_of(paths)
    parts = [_rows_of(path, columns) for path in files]
    if len(parts) == 1:
        return parts[0]
    first = parts[0]
    for part in parts:
        if part.table.keys() != first.table.keys():
            raise InputError(
                f"{part.path} has {', '.join(part.table)} where {first.path.name} has "
                f"{', '.join(first.table)}: files of one record have the same columns"
            )
    counts = np.cumsum([0, *(len(part.steps) for part in parts)])
    step = np.concatenate([part.step + count for part, count in zip(parts, counts[:-1], strict=True)])
    table = {role: np.concatenate([part.table[role] for part in parts]) for role in first.table}
    names = tuple(f"{part.path.stem} {name}".strip() for part in parts for name in part.steps)
    notes: tuple[str, ...] = (f"{len(files)} files, from {files[0].name} to {files[-1].name}.",)
    notes += tuple(dict.fromkeys(note for part in parts for note in part.notes))
    warnings = tuple(dict.fromkeys(warning for part in parts for warning in part.warnings))
    at = files[0].parent if all(path.parent == files[0].parent for path in files) else files[0]
    return _continued(RecordRows(at, first.format, table, first.chosen, step, names, notes, warnings))


def _rows_of(path: Path, columns: str | None) -> RecordRows:
    """Read the rows of one file. Raises InputError."""
    record = read_record(path)
    chosen = choose(record, columns)
    chosen |= further(record, chosen)
    numbered = chosen.pop("step", None)
    values = record.columns([column.index for column in chosen.values()])
    table = {role: column.factor * values[:, place] for place, (role, column) in enumerate(chosen.items())}
    step, names, known = _steps(record, numbered)
    table = {role: np.where(known, column, np.nan) for role, column in table.items()}
    if "load" in table and "normal force" not in table:  # what was set, where nothing was measured
        table["normal force"], chosen["normal force"] = table.pop("load"), chosen.pop("load")
    rows = RecordRows(path, record.format.name, table, chosen, step, names, record.notes)
    warnings = [*_contradictions(rows), *_sensors(rows)]
    if columns is None and "cof" in chosen:
        warnings += other_coefficients(record, chosen["cof"])
    return _continued(replace(rows, warnings=tuple(warnings)))


def _steps(record: Record, numbered: Column | None) -> tuple[Indices, tuple[str, ...], Mask]:
    """Return the step of each row, from 0, and their names: of the lines between, or of a column.

    The third says which rows have a step: one without a number may belong to the step before or behind it,
    unless a machine writes the number in few rows, where a step begins.
    """
    labels: list[str] = list(record.steps)
    count = len(record.table.rows)
    known = np.ones(count, dtype=np.bool_)
    if not any(labels) and numbered is not None:
        with suppress(InputError):  # of words
            numbers = record.columns([numbered.index])[:, 0]
            if np.isfinite(numbers).any():
                known = np.isfinite(numbers)
                last = np.maximum.accumulate(np.where(known, np.arange(count), np.argmax(known)))
                labels = [f"{value:g}" for value in numbers[last]]
                known |= known.mean() < 0.5
    if not any(labels):
        return np.zeros(count, dtype=np.intp), ("",), known
    starts = [0, *(i for i in range(1, count) if labels[i] != labels[i - 1])]
    step = np.zeros(count, dtype=np.intp)
    step[starts[1:]] = 1
    return np.cumsum(step), tuple(labels[start] for start in starts), known


def _continued(rows: RecordRows) -> RecordRows:
    """Let what a machine counts from zero in each step go on from the end of the step before."""
    table, notes = dict(rows.table), list(rows.notes)
    for role in COUNTED:
        if role not in table:
            continue
        known = np.isfinite(table[role])  # a gap where a step begins does not hide that it counts anew
        values, starts = table[role][known], np.flatnonzero(np.diff(rows.step[known])) + 1
        again = starts[values[starts] < values[starts - 1]]
        if again.size:
            steps = np.diff(values)
            usual = float(np.nanmedian(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
            shift = np.zeros(values.size)
            for start in again:
                shift[start] = values[start - 1] + (0.0 if values[start] > 0.0 else usual)
            table[role] = table[role].copy()
            table[role][known] = values + np.cumsum(shift)
            notes.append(f"The {role} begins anew with steps, and goes on here.")
    return replace(rows, table=table, notes=tuple(dict.fromkeys(notes)))


def offset_of(rows: RecordRows) -> float:
    """Return the friction that a machine shows without load [N], 0 where it never slides or rests so."""
    if not {"friction force", "normal force"} <= rows.table.keys():
        return 0.0
    friction, normal = rows.table["friction force"], np.abs(rows.table["normal force"])
    unloaded = friction[np.isfinite(friction) & (normal < UNLOADED * np.nanmax(normal))]
    if unloaded.size < FEW_ROWS:
        return 0.0
    middle, spread = float(np.median(unloaded)), float(np.std(unloaded)) / np.sqrt(unloaded.size)
    return middle if abs(middle) > 3.0 * spread else 0.0


def without_offset(rows: RecordRows) -> RecordRows:
    """Return rows whose friction force is less by that without load, and a coefficient of forces."""
    offset, table = offset_of(rows), dict(rows.table)
    if offset == 0.0:
        raise InputError(f"{rows.path} shows no friction without load, which --zero would take off")
    table["friction force"] = table["friction force"] - offset
    table.pop("cof", None)
    note = f"The friction without load, {offset:.3g} N, was taken off."
    rows = replace(rows, table=table, notes=(*rows.notes, note))
    return replace(rows, warnings=tuple(_sensors(rows)))


def _sensors(rows: RecordRows) -> Iterator[str]:
    """Say where a sensor is at the end of its range, or shows one value, or friction without load."""
    for role in sorted({"cof", "friction force", "torque", "normal force"} & rows.table.keys()):
        title, values = rows.chosen[role].title, rows.table[role][np.isfinite(rows.table[role])]
        levels, counts = np.unique(values, return_counts=True)
        inside = (values[1:] > levels[:1]) & (values[1:] < levels[-1:])
        fine = inside.any() and np.mean(np.diff(values)[inside] == 0.0) < COARSE
        beside = np.maximum(np.append(0, counts[:-1]), np.append(counts[1:], 0))
        ends = np.isin(levels, at_ends(values)) & fine
        often = (counts > ONE_VALUE * values.size) & (values.size >= FEWEST) & (role != "normal force")
        for at in np.flatnonzero((counts >= TIMES_NEXT * beside) & (ends | often) & (levels != 0.0)):
            which = {0: "its least", levels.size - 1: "its largest"}.get(int(at), "one")
            where = f"{levels[at]:.4g}, {which} value, in {counts[at]} of {values.size} rows"
            bound = f"no error counts that, and a mean is {'a lower' if at else 'an upper'} bound"
            yield f"Warning: '{title}' is exactly {where}: end of the range, or set? If so, {bound}."
    if offset := offset_of(rows):
        load = np.abs(rows.table["normal force"])
        share = abs(offset) / float(np.nanmedian(load[load >= UNLOADED * np.nanmax(load)]))
        told = f"Warning: friction without load is {offset:.3g} N, {share:.2g} of the load"
        yield f"{told}: --zero takes it off."


def _contradictions(rows: RecordRows) -> tuple[str, ...]:
    """Say where a column of coefficients is not the ratio of the forces beside it."""
    if not {"cof", "friction force", "normal force"} <= rows.table.keys():
        return ()
    values = np.abs([rows.table[role] for role in ("cof", "friction force", "normal force")])
    cof, friction, normal = values[:, np.isfinite(values).all(axis=0)]
    if not (pressed := normal > 0.5 * np.median(normal) if normal.size else normal > 0.0).any():
        return ()
    ratio = friction[pressed] / normal[pressed]
    middle = float(np.median(ratio))
    off = float(np.median(np.abs(cof[pressed] - ratio)))
    if off <= OTHER_RATIO * middle:
        return ()
    titles = [rows.chosen[role].title for role in ("cof", "friction force", "normal force")]
    return (
        f"Warning: the column '{titles[0]}' is not '{titles[1]}' over '{titles[2]}': its median is "
        f"{float(np.median(cof[pressed])):.3g}, that of the ratio {middle:.3g}; --columns picks one of them.",
    )
