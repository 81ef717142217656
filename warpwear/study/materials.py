"""The table of materials (`materials.toml`): elastic constants, hardness, and where each number is from."""

import re
import tomllib
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from warpwear.study.keys import LONGEST_NAME
from warpwear.study.units import parse


@dataclass(frozen=True)
class Material:
    """A material has its constants in one condition."""

    name: str
    condition: str  # state of the hardness: annealed, hardened, ...
    young: float  # Young's modulus [MPa]
    poisson: float  # Poisson's ratio
    hardness: float  # indentation hardness: hardness number × 9.807 [MPa]
    sources: Mapping[str, str]  # each of its numbers -> document; † where it could not be read
    conductivity: float | None = None  # thermal [W/(m K)]
    heat_capacity: float | None = None  # [J/(kg K)]
    density: float | None = None  # [kg/m³]
    resistivity: float | None = None  # electrical [Ω m]; None of insulators


#: Units of its numbers.
UNITS = {"young": "MPa", "hardness": "MPa", "conductivity": "W/m/K"}
UNITS |= {"heat_capacity": "J/kg/K", "density": "kg/m^3", "resistivity": "ohm*m"}


def names() -> tuple[str, ...]:
    """Return the names of the materials, in the order of the table."""
    return tuple(entry.name for entry in _table()[0])


def material(name: str) -> Material:
    """Return the material of this name or alias; case, spaces, dashes and dots do not matter.

    Raises ValueError with one sentence for a name that the table does not have.
    """
    entries, aliases = _table()
    key = _key(name)
    place = aliases.get(key, aliases.get(_STANDARDS.sub("", key)))
    if place is not None:
        return entries[place]
    near = get_close_matches(key[:LONGEST_NAME], aliases, n=1, cutoff=0.6)
    hint = f" (did you mean '{entries[aliases[near[0]]].name}'?)" if near else ""
    raise ValueError(f"no material '{name[:LONGEST_NAME]}' is known{hint}; allowed: {', '.join(names())}")


#: Who numbered a grade: "EN 1.4301" is "1.4301".
_STANDARDS = re.compile(r"^(aisi|sae|uns|wnr|en|din|jis|astm)+")


def _key(name: str) -> str:
    """Return the name's letters and digits, in lower case; "Al₂O₃" is "al2o3"."""
    return "".join(sign for sign in unicodedata.normalize("NFKC", name).casefold() if sign.isalnum())


@cache
def _table() -> tuple[tuple[Material, ...], Mapping[str, int]]:
    """Return the materials, and the place among them of each key of a name or alias."""
    rows = tomllib.loads((files("warpwear") / "materials.toml").read_text(encoding="utf-8"))["material"]
    entries: list[Material] = []
    aliases: dict[str, int] = {}
    for place, row in enumerate(rows):
        aliases |= {_key(alias): place for alias in (row["name"], *row.pop("aliases"))}
        row |= {name: parse(row[name], unit) for name, unit in UNITS.items() if name in row}
        row["sources"] = MappingProxyType(row["sources"])
        entries.append(Material(**row))
    return tuple(entries), MappingProxyType(aliases)
