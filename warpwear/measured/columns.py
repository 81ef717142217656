"""Which column of a record is what, by its name and unit, and what its numbers are in mm, s and N."""

import re
import unicodedata
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.record import Record, declared, is_unit
from warpwear.study.units import parse

#: What columns are called, by their roles, and units, see columns.toml.
WORDS = declared("columns")
ROLES, COUNTS, WITHOUT_UNIT = WORDS["roles"], WORDS["counts"], frozenset(WORDS["without_unit"])
NAMES = {role: said["names"].format(**WORDS) for role, said in ROLES.items()}
#: A torque's unit with whatever stands between force and length.
_TORQUE = re.compile(r"([mk]?N)\W*([cm]?m)")
#: Relative difference of a coefficient from the one taken, or from the ratio of the forces, that is told.
OTHER_RATIO = 0.05


@dataclass(frozen=True)
class Column:
    """A column plays a role: its numbers times a factor are in mm, s, N or 1."""

    index: int  # from 0
    title: str  # as the file has it
    factor: float


def choose(record: Record, picks: str | None = None) -> dict[str, Column]:
    """Return the columns to take, role -> column.

    picks: titles or numbers (from 1) of two columns, distance or time and CoF; of three, time, friction force
    and normal force; or of four, a position behind these; a unit may follow in brackets where the file has
    none. Without picks the names in the header tell. Raises InputError for what is missing or could be two
    things; what is not needed beside a coefficient is left out where it could.
    """
    titles = [_title(record, index) for index in range(record.table.width)]
    if picks is not None:
        return _picked(record, titles, picks)
    if not record.names:
        raise InputError(
            f"{record.path} has no header with a name for each of its {record.table.width} columns: such as "
            "'Distance [mm]' and 'CoF' are expected, or --columns '1 [mm],2'"
        )
    roles = {
        role: _different(record, [i for i, title in enumerate(titles) if _role(record, *title) == role])
        for role in NAMES
    }
    if not roles["cof"] and not roles["friction force"] and not roles["torque"]:
        raise InputError(
            f"{record.path} has no column for the coefficient of friction among "
            f"{_listed([name for name in record.names if name])}; a "
            "name such as 'CoF' is expected, or --columns 'DISTANCE,COF' picks two of these, --columns "
            "'TIME,FRICTION,LOAD' three"
        )
    needed = {"distance", "time", "cycle", "cof"} if roles["cof"] else NAMES.keys() - {*WORDS["helpers"]}
    columns = {}
    for role in NAMES:
        if len(roles[role]) > 1 and role in needed:
            rivals = [record.names[i] for i in roles[role]]
            how = "by name" if len(set(rivals)) == len(rivals) else "by number, counted from 1"
            raise InputError(
                f"{record.path} has {len(rivals)} columns that could be the {_spoken(role)}: "
                f"{_listed(rivals)}; --columns 'DISTANCE,COF' picks {how}"
            )
        if len(roles[role]) != 1:
            continue
        title = record.names[roles[role][0]]
        try:
            factor = _factor(record, role, title, titles[roles[role][0]][1])
        except InputError:
            if role in needed:
                raise
            continue
        columns[role] = Column(roles[role][0], title, factor)
    clock = columns.pop("clock", None)
    return columns if clock is None else {"time": clock} | columns


def further(record: Record, chosen: dict[str, Column]) -> dict[str, Column]:
    """Return the columns of numbers with a unit that play no role, by name and unit: 'temperature [°C]'."""
    taken, columns = {column.index for column in chosen.values()}, {}
    for index in range(record.table.width):
        name, unit = _title(record, index)
        if (
            index in taken
            or unit.lower() in WITHOUT_UNIT | COUNTS.keys()
            or _known(record, name)
            or _role(record, name, unit)
        ):
            continue
        with suppress(InputError):  # of words
            record.columns([index])
            columns[f"{name} [{unit}]"] = Column(index, record.names[index], 1.0)
    return columns


def other_coefficients(record: Record, taken: Column) -> list[str]:
    """Say which columns beside the coefficient that is taken look like others, and differ."""
    middles = {}
    for index in range(record.table.width):
        name, unit = _title(record, index)
        if unit.lower() in WITHOUT_UNIT and re.fullmatch(WORDS["like"].format(**WORDS), name):
            with suppress(InputError):  # of words
                values = np.abs(record.columns([index]))
                if (known := values[np.isfinite(values)]).size:
                    middles[index] = float(np.median(known))
    own = middles.pop(taken.index, np.nan)
    others = [i for i, middle in middles.items() if abs(middle - own) > OTHER_RATIO * own]
    if not others:
        return []
    listed = ", ".join(f"'{record.names[index]}' {middles[index]:.3g}" for index in others)
    which = f"the coefficient is the column '{taken.title}', median {own:.3g}"
    return [f"Warning: {which}; others look like coefficients: {listed}; --columns takes one of them."]


def _different(record: Record, indices: list[int]) -> list[int]:
    """Return the columns of one role without those that say the same as the first."""
    if len(indices) < 2 or record.names[indices[0]] == "":
        return indices
    try:
        values: FloatArray = record.columns(indices)
    except InputError:
        return indices
    same = [np.array_equal(values[:, 0], values[:, k], equal_nan=True) for k in range(len(indices))]
    return [index for index, equal in zip(indices, same, strict=True) if not equal or index == indices[0]]


def _title(record: Record, index: int) -> tuple[str, str]:
    """Return the name in small letters and the unit of a column, "" for what the header does not say."""
    if not record.names:
        return "", ""
    name, unit = split_unit(record.names[index])
    below = record.units[index].strip("[]() ") if record.units else ""
    if record.is_clock(index):
        return "clock", "s"
    _, known = _known(record, name) or ("", "")
    return name, known if known == "-" else unit or below or known


def _known(record: Record, name: str) -> Sequence[str] | None:
    """Return role and unit of a name in small letters by the make's format: of its last entry, or None."""
    entries = [entry for title, entry in record.format.columns.items() if re.fullmatch(title, name)]
    return entries[-1] if entries else None


def split_unit(title: str) -> tuple[str, str]:
    """Split a title such as "Sliding distance, mm" into its name in small letters and its unit, or ""."""
    title = unicodedata.normalize("NFKC", title).strip().replace("_", " ")
    for pattern in WORDS["titles"]:
        match = re.fullmatch(pattern, title)
        if match and match[1] and ("[(" in pattern or is_unit(match[2], rare="[,/]" in pattern)):
            return " ".join(match[1].lower().split()), match[2].strip()
    return " ".join(title.lower().split()), ""


def _role(record: Record, name: str, unit: str) -> str | None:
    """Return the role that a name in small letters and a unit stand for, None for none."""
    known = _known(record, name)
    if known is not None:
        return known[0] or None
    if name in ("friction", "reibung"):  # a force or a coefficient, which the unit tells
        return {"n": "friction force", "-": "cof", "1": "cof"}.get(unit.lower())
    role = next((role for role, pattern in NAMES.items() if re.fullmatch(pattern, name)), None)
    if role in ("distance", "time"):
        return COUNTS.get(unit.lower(), role)
    return "speed" if role == "rpm" and unit.lower() not in WORDS["turns"] else role


def _factor(record: Record, role: str, name: str, unit: str) -> float:
    """Return the factor from a unit to that of a role. Raises InputError for another kind of unit."""
    target = ROLES[role].get("unit")
    which = f"{record.path}: the {_spoken(role)} '{name}' has"
    if target is None:
        if unit.lower() not in WITHOUT_UNIT | COUNTS.keys():
            raise InputError(f"{which} the unit {unit}, where a plain number is expected")
        return 1.0
    if unit.lower() in WITHOUT_UNIT:
        how = f"write it in the header, such as '{name} [{target}]', or in --columns"
        raise InputError(f"{which} no unit; {how}")
    factor = _converted(unit, target)
    if factor is None:
        raise InputError(f"{which} the unit {unit}, which is no unit of {WORDS['kinds'][target]}")
    return factor


def _converted(unit: str, target: str) -> float | None:
    """Return one of a unit in the target's, None where it is of another kind."""
    if target == "rpm":
        return WORDS["turns"].get(unit.lower())
    if target == "N*mm":
        unit = _TORQUE.sub(r"\1*\2", unit)
    unit = WORDS["weights"].get(unit, unit) if target == "N" else WORDS["local"].get(unit.lower(), unit)
    try:
        return parse(f"1 {unit}", target)
    except ValueError:
        return None


def _picked(record: Record, titles: list[tuple[str, str]], picks: str) -> dict[str, Column]:
    """Return the columns that a user picked, role -> column."""
    parts = picks.split(";" if ";" in picks else ",")  # a title may hold commas
    chosen = [place for part in parts if (place := _index(record, titles, part.strip())) is not None]
    known = _listed(record.names) or f"1 to {record.table.width}"
    if len(chosen) != len(parts) or str(len(chosen)) not in WORDS["picked"]:
        raise InputError(
            f"--columns '{picks}': two columns (distance or time, CoF), three (time, friction force, normal "
            f"force) or four (these and a position) of {record.path} are expected, with ; between titles "
            f"with commas: {known}"
        )
    columns = {}
    for role, (index, unit_picked) in zip(WORDS["picked"][str(len(chosen))], chosen, strict=True):
        name, unit = titles[index][0], unit_picked or titles[index][1]
        meant, named = role, _role(record, name, unit)
        if role == "distance" and named in ("laps", "cycle"):
            meant = named
        elif role == "distance" and (named == "time" or _converted(unit, "s") is not None):
            meant = "time"
        title = record.names[index] if record.names else f"column {index + 1}"
        if titles[index][1] not in ("", unit):
            title += f", taken in {unit}"
        columns[meant] = Column(index, title, _factor(record, meant, title, unit))
    return columns


def _index(record: Record, titles: list[tuple[str, str]], pick: str) -> tuple[int, str] | None:
    """Return the index of the column that one pick means and the unit in it, None for none."""
    plain = [" ".join(name.lower().split()) for name in record.names]
    name, unit = split_unit(pick)
    for wanted, known in ((" ".join(pick.lower().split()), plain), (name, [title for title, _ in titles])):
        if known.count(wanted) > 1:
            raise InputError(f"--columns: {known.count(wanted)} columns called '{pick}'; pick by number")
        if wanted and wanted in known:
            return known.index(wanted), unit if known is not plain else ""
    if name.isdecimal() and 1 <= int(name) <= record.table.width:
        return int(name) - 1, unit
    return None


def _spoken(role: str) -> str:
    return "coefficient of friction" if role == "cof" else role


def _listed(names: tuple[str, ...] | list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
