"""Which column of a record is what, by its name and unit, and what its numbers are in mm, s and N."""

import re
import unicodedata
from dataclasses import dataclass

from warpwear.errors import InputError
from warpwear.measured.record import Record, is_unit
from warpwear.study.units import parse

#: What may stand before the name of a coefficient of friction.
_MEAN = r"(?:(?:mean|avg|average|abs|absolute|filtered|dynamic|kinetic|mittlere[rs]?) )?"
_COEFFICIENT = (
    r"cof|c\.o\.f\.?|μ|mu|coeff?(?:icient|\.)? of friction|friction coeff?(?:icient|\.)?|"
    r"reibungskoeffizient|reibkoeffizient|reibwert|reibungszahl|reibzahl"
)
#: Role -> what such a column is called, in small letters and without its unit.
NAMES = {
    "distance": r"(?:total |sliding |accumulated |cumulative )*(?:distance|dist\.?)|"
    r"gleitweg|reibweg|gesamtweg|weg|gleitstrecke|strecke",
    "time": r"(?:total |elapsed |test |sliding |run )?time|t|(?:test|mess|versuchs|lauf|gleit)?zeit",
    "cycle": r"cycles?(?: (?:number|no\.?|count))?|zykl(?:us|en)(?:zahl)?",
    "cof": rf"{_MEAN}(?:{_COEFFICIENT})(?: (?:mean|avg|average|abs|absolute|filtered))?",
    "friction force": r"fx|ff|ft|fr|f[ _]?x|(?:friction|tangential|lateral)(?: force)?|"
    r"reib(?:ungs)?kraft|tangentialkraft",
    "normal force": r"fz|fn|f[ _]?z|normal (?:force|load)|load|down ?force|normalkraft|anpresskraft|last",
    "position": r"(?:x[ -]?|stage |stroke |linear )?pos(?:ition|\.)?|x|displacement|auslenkung|hub",
}
#: Role -> unit that its numbers are converted to; the other roles have numbers without a unit.
TARGETS = {"distance": "mm", "time": "s", "friction force": "N", "normal force": "N", "position": "mm"}
#: What a unit of each target measures.
KINDS = {"mm": "length", "s": "time", "N": "force"}
#: What stands for a unit of a plain number.
WITHOUT_UNIT = frozenset(("", "-", "–", "—", "1", "/", "none"))
#: Units in small letters that are spelt otherwise in a study.
LOCAL = {"sek": "s", "std": "h", "μm": "um"}
#: What a number of columns picked by hand stands for.
PICKED = {2: ("distance", "cof"), 4: ("time", "friction force", "normal force", "position")}


@dataclass(frozen=True)
class Column:
    """A column plays a role: its numbers times a factor are in mm, s, N or 1."""

    index: int  # from 0
    title: str  # as the file has it
    factor: float


def choose(record: Record, picks: str | None = None) -> dict[str, Column]:
    """Return the columns to take, role -> column.

    picks: titles or numbers (from 1) of two columns, distance or time and CoF, or of four: time, friction
    force, normal force and position; a unit may follow in brackets where the file has none. Without picks
    the names in the header tell. Raises InputError for what is missing or could be two things.
    """
    titles = [_title(record, index) for index in range(record.table.width)]
    if picks is not None:
        return _picked(record, titles, picks)
    if not record.names:
        raise InputError(
            f"{record.path} has no header with a name for each of its {record.table.width} columns: such as "
            "'Distance [mm]' and 'CoF' are expected, or --columns '1 [mm],2'"
        )
    roles = {role: [i for i, title in enumerate(titles) if _role(*title) == role] for role in NAMES}
    if not roles["cof"] and not roles["friction force"]:
        raise InputError(
            f"{record.path} has no column for the coefficient of friction among {_listed(record.names)}; a "
            "name such as 'CoF' is expected, or --columns 'DISTANCE,COF' picks two of these"
        )
    needed = ("distance", "time", "cycle", "cof") if roles["cof"] else tuple(NAMES)
    columns = {}
    for role in needed:
        if len(roles[role]) > 1:
            rivals = [record.names[i] for i in roles[role]]
            how = "by name" if len(set(rivals)) == len(rivals) else "by number, counted from 1"
            raise InputError(
                f"{record.path} has {len(rivals)} columns that could be the {_spoken(role)}: "
                f"{_listed(rivals)}; --columns 'DISTANCE,COF' picks {how}"
            )
        for index in roles[role]:
            title = record.names[index]
            columns[role] = Column(index, title, _factor(record, role, title, titles[index][1]))
    return columns


def _title(record: Record, index: int) -> tuple[str, str]:
    """Return the name in small letters and the unit of a column, "" for what the header does not say."""
    if not record.names:
        return "", ""
    name, unit = split_unit(record.names[index])
    below = record.units[index].strip("[]() ") if record.units else ""
    return name, unit or below


def split_unit(title: str) -> tuple[str, str]:
    """Split a title such as "Sliding distance, mm" into its name in small letters and its unit, or ""."""
    title = unicodedata.normalize("NFKC", title).strip().replace("_", " ")
    for pattern in (
        r"(.*?)\s*[\[(]([^\[\]()]*)[\])]$",
        r"(.*?)\s*[,/]\s*([^,/]+)$",
        r"(.*?)\s+in\s+(\S+)$",
        r"(.*?)\s+(\S+)$",
    ):
        match = re.fullmatch(pattern, title)
        if match and match[1] and (is_unit(match[2]) or pattern.endswith(r"[\])]$")):
            return " ".join(match[1].lower().split()), match[2].strip()
    return " ".join(title.lower().split()), ""


def _role(name: str, unit: str) -> str | None:
    """Return the role that a name in small letters and a unit stand for, None for none."""
    if name in ("friction", "reibung"):  # a force or a coefficient, which the unit tells
        return {"n": "friction force", "-": "cof", "1": "cof"}.get(unit.lower())
    return next((role for role, pattern in NAMES.items() if re.fullmatch(pattern, name)), None)


def _factor(record: Record, role: str, name: str, unit: str) -> float:
    """Return the factor from a unit to that of a role. Raises InputError for another kind of unit."""
    target = TARGETS.get(role)
    which = f"{record.path}: the {_spoken(role)} '{name}' has"
    if target is None:
        if unit.lower() not in WITHOUT_UNIT:
            raise InputError(f"{which} the unit {unit}, where a plain number is expected")
        return 1.0
    if unit.lower() in WITHOUT_UNIT:
        how = f"write it in the header, such as '{name} [{target}]', or in --columns"
        raise InputError(f"{which} no unit; {how}")
    factor = _converted(unit, target)
    if factor is None:
        raise InputError(f"{which} the unit {unit}, which is no unit of {KINDS[target]}")
    return factor


def _converted(unit: str, target: str) -> float | None:
    """Return one of a unit in the target's, None where it is of another kind."""
    try:
        return parse(f"1 {LOCAL.get(unit.lower(), unit)}", target)
    except ValueError:
        return None


def _picked(record: Record, titles: list[tuple[str, str]], picks: str) -> dict[str, Column]:
    """Return the columns that a user picked, role -> column."""
    parts = [part.strip() for part in picks.split(";" if ";" in picks else ",")]
    chosen = _match(record, titles, parts)
    known = _listed(record.names) or f"1 to {record.table.width}"
    if chosen is None or len(chosen) not in PICKED:
        raise InputError(
            f"--columns '{picks}': two columns (distance or time, CoF) or four (time, friction force, normal "
            f"force, position) of {record.path} are expected: {known}"
        )
    columns = {}
    for role, (index, unit_picked) in zip(PICKED[len(chosen)], chosen, strict=True):
        name, unit = titles[index][0], titles[index][1] or unit_picked
        meant, named = role, _role(name, unit)
        if role == "distance" and named == "cycle":
            meant = "cycle"
        elif role == "distance" and (named == "time" or _converted(unit, "s") is not None):
            meant = "time"
        title = record.names[index] if record.names else f"column {index + 1}"
        columns[meant] = Column(index, title, _factor(record, meant, title, unit))
    return columns


def _match(record: Record, titles: list[tuple[str, str]], parts: list[str]) -> list[tuple[int, str]] | None:
    """Return index and given unit of each pick, None where one is no column; a title may hold commas."""
    if not parts:
        return []
    for count in range(len(parts), 0, -1):
        index = _index(record, titles, ", ".join(parts[:count]))
        if index is None:
            continue
        rest = _match(record, titles, parts[count:])
        if rest is not None:
            return [index, *rest]
    return None


def _index(record: Record, titles: list[tuple[str, str]], pick: str) -> tuple[int, str] | None:
    """Return the index of the column that one pick means and the unit in it, None for none."""
    plain = [" ".join(name.lower().split()) for name in record.names]
    name, unit = split_unit(pick)
    for wanted, known in ((" ".join(pick.lower().split()), plain), (name, [title for title, _ in titles])):
        if known.count(wanted) > 1:
            raise InputError(
                f"--columns: {record.path} has {known.count(wanted)} columns called '{pick}'; pick by "
                f"number, from 1 to {record.table.width}"
            )
        if wanted and wanted in known:
            return known.index(wanted), unit
    if name.isdecimal() and 1 <= int(name) <= record.table.width:
        return int(name) - 1, unit
    return None


def _spoken(role: str) -> str:
    return "coefficient of friction" if role == "cof" else role


def _listed(names: tuple[str, ...] | list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
