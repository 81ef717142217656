"""[[disc.layers]], [[counter.layers]] and their gradients: what a body is made of by worn depth."""

import csv
import itertools
import math
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import AfterValidator, BeforeValidator

from warpwear.laws.depth_profile import SUBSTRATE, DepthProfile, LayerMaterial
from warpwear.study.keys import Hardness, Length, Pressure, Section, excludes, key, needs, refused, when
from warpwear.study.sections.friction import NOT_CONTACT
from warpwear.study.sections.wear import BY_AREA, ArchardCoefficient, WearCoefficient
from warpwear.study.units import Number, Range

#: Most rows of a gradient, and layers of a body: with the substrate, that books are kept of.
MOST_ROWS, MOST_LAYERS = 1000, 7
OF_PATCHES = when("study.model", "two-scale")
#: What is computed of materials by depth, and what is not.
LAYERED = (
    needs("wear.law", "archard", "exponential", "energy", why=": others have one K of a body")
    + excludes("wear.law", "energy", where=BY_AREA, why=", unless friction.law = 'coulomb'")
    + excludes("wear.particle", why=", whose pieces are of one material")
    + excludes("wear.distance_factor", "across", "radial")
    + excludes("stepping.scheme", "explicit")
    + excludes("patches.coupling", "load", why=", which prescribes loads by one K")
    + excludes("friction.film", where=OF_PATCHES, why=", which patches do not follow with layers")
    + excludes("friction.junction_growth", why=", by which caps follow from one shear strength")
    + excludes("friction.area", *NOT_CONTACT, why=": materials shear where they are in contact")
    + excludes("sliding.plastic", "keep", why=", whose dents are as deep as one hardness lets them be")
)


def _name(value: str) -> str:
    if not re.fullmatch(r"[A-Za-z0-9_]{1,40}", value) or value == SUBSTRATE:
        raise refused("layer_name", substrate=SUBSTRATE)
    return value


class LayerSection(Section):
    """A table [[disc.layers]] or [[counter.layers]] says what a layer is, from the surface down."""

    name: Annotated[str, AfterValidator(_name)] = key(..., "what it is called in results, such as 'dlc'")
    thickness: Length = key(..., "wear depth at which it is worn through, below the layer above")
    wear: WearCoefficient = key(
        ..., "wear coefficient K, such as '2e-7 mm^3/N/m'; mm^3/J by wear.law = 'energy'"
    )
    hardness: Hardness | None = key(None, "indentation hardness; if not given the body's")
    shear_strength: Pressure | None = key(
        None, "interfacial shear strength; if not given friction.shear_strength, that of the bodies"
    )
    coefficient: Annotated[float, Number(Range(most=3.0))] | None = key(
        None, "instead of a shear strength: the shear is at most this part of the pressure"
    )

    def _check(self) -> None:
        if self.shear_strength is not None and self.coefficient is not None:
            raise ValueError(f"layer '{self.name}': shear_strength and coefficient exclude each other")
        if self.wear.dimensionless or self.wear.value == 0.0:
            raise refused("wear_of_a_layer", name=self.name, wear=self.wear.write())


def _rows(value: Any) -> Any:
    """Return the rows of a file of numbers; of a list those that it has."""
    if not isinstance(value, str):
        return value
    try:
        with Path(value).open(encoding="utf-8-sig", newline="") as file:
            lines = [line for line in csv.reader(itertools.islice(file, MOST_ROWS + 9)) if any(line)]
    except (OSError, UnicodeDecodeError, ValueError, csv.Error) as error:
        raise ValueError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    numbers = [[_number(cell) for cell in line] for line in lines]
    return [line for line in numbers if line and None not in line]


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _graded(rows: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    """Refuse rows that are no gradient: raises ValueError with what is allowed."""
    depths = [row[0] for row in rows if row]
    rise = depths[:1] == [0.0] and all(a < b for a, b in itertools.pairwise(depths))
    alike = len({len(row) for row in rows}) == 1 and len(rows[0]) in (2, 3)
    finite = all(0.0 <= number < 1.0e30 for row in rows for number in row)
    if not (2 <= len(rows) <= MOST_ROWS and alike and rise and finite and rows[0][1] > 0.0):
        raise refused("gradient", most=MOST_ROWS)
    return rows


Gradient = Annotated[tuple[tuple[float, ...], ...], BeforeValidator(_rows), AfterValidator(_graded)]


#: Gives K [mm²/N] of a coefficient, or of a number in its unit.
Resolved: TypeAlias = Callable[[float | ArchardCoefficient], float]


def depth_profiles(
    bodies: tuple[Any, Any],
    wear: Iterable[float],
    resolved: Resolved,
    *,
    hardness: float | None,
    shear_strength: float | None,
) -> tuple[DepthProfile, DepthProfile]:
    """Return what both bodies are made of by worn depth, of their sections.

    wear: K of the bodies themselves [mm²/N]. hardness: of all cells, None where each body has its own;
    shear_strength: of the bodies [MPa]. resolved: gives K of a coefficient.
    """
    caps, strength = [hardness or body.hardness or math.inf for body in bodies], shear_strength or math.inf
    counter, disc = (
        _depth_profile(body, LayerMaterial(own, cap, strength), resolved)
        for body, own, cap in zip(bodies, wear, caps, strict=True)
    )
    return counter, disc


def _depth_profile(section: Any, body: LayerMaterial, resolved: Resolved) -> DepthProfile:
    """Return what a section of a study is made of by worn depth. body: its own material."""
    if section.gradient is not None:
        depths = tuple(1.0e-3 * row[0] for row in section.gradient)
        hardness = (row[2] if len(row) > 2 else body.hardness for row in section.gradient)
        materials = (
            replace(body, wear=resolved(row[1]), hardness=limit)
            for row, limit in zip(section.gradient, hardness, strict=True)
        )
        return DepthProfile(depths, tuple(materials), graded=True)
    of_layers = (
        LayerMaterial(
            resolved(layer.wear),
            body.hardness if layer.hardness is None else layer.hardness,
            layer.shear_strength or (body.shear_strength if layer.coefficient is None else math.inf),
            layer.coefficient or math.inf,
            layer.name,
        )
        for layer in section.layers or ()
    )
    thicknesses = (layer.thickness for layer in section.layers or ())
    return DepthProfile(tuple(itertools.accumulate(thicknesses, initial=0.0)), (*of_layers, body))
