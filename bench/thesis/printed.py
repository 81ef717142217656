"""What the thesis prints: its test, its wear coefficients, its patch diameters, and where each is printed.

*Modeling the Influence of Wear on the Evolution of the Coefficient of Friction*, a Master's thesis. Kept in
one table, `printed.toml`, so that no number is typed twice.
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Printed:
    """One printed number: its unit, and where it stands."""

    value: float
    unit: str
    place: str
    note: str = ""


def read(name: str) -> dict[str, Any]:
    """Read a file of data of the report. name: of the file."""
    return tomllib.loads((Path(__file__).parent / name).read_text(encoding="utf-8"))


_CONTENT = read("printed.toml")
#: Single numbers by name.
PRINTED = {name: Printed(**entry) for name, entry in _CONTENT["number"].items()}
#: Numbers of the same kind in a row, by name.
SERIES = {
    name: tuple(Printed(value, entry["unit"], entry["place"]) for value in entry["values"])
    for name, entry in _CONTENT["series"].items()
}
#: How near to what is printed ours must come: name, which ends with its unit -> largest difference.
TOLERANCES: dict[str, float] = _CONTENT["tolerance"]


def _group(prefix: str) -> dict[str, Printed]:
    """Find numbers whose names begin with a prefix, without it."""
    return {name.removeprefix(prefix): p for name, p in PRINTED.items() if name.startswith(prefix)}


LOAD, STROKE, PASSES, DISTANCE = (PRINTED[name] for name in ("load", "stroke", "passes", "distance"))
COUNTER_RADIUS, SLOWS_AFTER = PRINTED["counter_radius"], PRINTED["slows_after"]
#: Table 4.1: body or way of measuring -> K with the hardness contained.
WEAR_COEFFICIENTS = _group("K_")
#: The experiment, or a version -> diameter of the worn patch on the counter-body after the whole distance.
PATCH_DIAMETERS = _group("patch_")
#: Mean pressure of version 3 at all times, least and largest.
V3_PRESSURES = (PRINTED["pressure_smallest"], PRINTED["pressure_largest"])
