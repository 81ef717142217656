"""Every quantity of a result is declared once: name, unit, meaning, what has a value of it, and looks.

The columns of the history, the fields of a snapshot, the tables of patches and of roughness, the headers of
CSV files, the attributes in HDF5 files, `Result.units`, the axes of figures and the table of the docs
follow from this. All of it stands in `quantities.toml`.
"""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from itertools import chain
from typing import Any, Literal

from warpwear.grid import FloatArray, Frame
from warpwear.history.arrangements import ARRANGEMENTS
from warpwear.laws.archard import BODIES, CALLED
from warpwear.laws.depth_profile import of_materials
from warpwear.study.keys import section_in, uses
from warpwear.study.study import Study

#: What a quantity has one value for: a step; a step and patch; a cell of a snapshot; a snapshot; a depth at
#: one; a depth and a place along a plane at one; a piece.
Per = Literal["step", "patch", "cell", "snapshot", "depth", "plane", "piece"]
#: Runs that a quantity may be limited to: name -> what they are called, and whether a study makes one.
ONLY: Mapping[str, tuple[str, Callable[[Study], bool]]] = {
    **ARRANGEMENTS,
    "half-space": ("half-spaces", lambda study: study.contact.law == "half-space"),
    "half-space track": (
        "half-spaces over a track",
        lambda study: study.is_swept and study.contact.law == "half-space",
    ),
    "jump": (
        "runs that jump over cycles (stepping.jump, fretting)",
        lambda study: study.jumps or study.fretting is not None,
    ),
    "fretting": ("fretting (sliding.kinematics)", lambda study: study.fretting is not None),
    "dents": (
        "tracks that keep their dents",
        lambda study: study.is_swept and study.sliding.plastic == "keep",
    ),
    "film": ("runs with a film", lambda study: study.pair.film is not None),
    "by area": (
        "wear of friction energy by a shear strength, layers of one, friction.largest_coefficient",
        lambda study: study.pair.wears_by_area or study.contact_task.shears_unalike,
    ),
    "fatigue": ("runs with fatigue limits", lambda study: study.fatigue is not None),
    "conductance": ("output.joint with conductance", lambda study: "conductance" in study.output.joint),
    "stiffness": ("output.joint with stiffness", lambda study: "stiffness" in study.output.joint),
    "flow": ("output.joint with flow", lambda study: "flow" in study.output.joint),
    "flash": ("output.joint with flash", lambda study: "flash" in study.output.joint),
}


@dataclass(frozen=True)
class Quantity:
    """Declare one quantity of a result.

    only: a name of `ONLY`, or a dotted key that runs use which have it; None where all have it. frame: what
    the cells of a field lie on; of a column of the history, the body over whose cells it is summed; None of
    others. lowers: 1 of depths that the disc lies lower by, −1 of those it lies higher by. signed: whether a
    field may be negative.

    Where people see it: label names it alone, short beside others of its family, whose name stands at the
    axis. Its values times factor are in shown_unit. log: whether an axis of values over decades is
    logarithmic. colour: a name of `warpwear.figures.describe`; dash: how its line is drawn. map: whether a
    figure shows it over the disc, or over the contact.
    """

    name: str
    units: str
    meaning: str
    per: Per = "step"
    only: str | None = None
    frame: Frame | None = None
    lowers: float = 0.0
    signed: bool = False
    label: str = ""
    family: str = ""
    short: str = ""
    factor: float = 1.0
    shown_unit: str = ""
    log: bool = False
    colour: str = "NEUTRAL"
    dash: str = "solid"
    map: bool = False

    def applies_to(self, study: Study) -> bool:
        """Tell whether a run of the study has the quantity."""
        only = self.only or ""
        return ONLY[only][1](study) if only in ONLY else not only or uses(study, only)

    @property
    def runs(self) -> str:
        """Return what the runs that have it are called; empty where all have it."""
        only = self.only or ""
        return ONLY[only][0] if only in ONLY else only

    @property
    def unit(self) -> str:
        """Return the unit that people see; empty for a number without one."""
        return self.shown_unit or printed(self.units)

    @property
    def axis(self) -> str:
        """Write the text of an axis: the label with its unit."""
        return axis(self.label or self.meaning, self.unit)

    @property
    def family_axis(self) -> str:
        """Write the text of an axis that it shares with the others of its family."""
        return axis(self.family or self.label, self.unit)

    def scaled(self, values: FloatArray) -> FloatArray:
        """Return values in the unit that people see."""
        return self.factor * values


def printed(text: str) -> str:
    """Write units as people do: µm for um, mm² for mm^2, and nothing for 1, the unit of a number."""
    text = text.replace("mm^3/N/m", "mm³/(N·m)").replace("^2", "²").replace("^3", "³")
    return "" if text == "1" else re.sub(r"\bum", "µm", text)


def axis(label: str, unit: str) -> str:
    """Write the text of an axis, '–' for a number without unit."""
    return f"{label}, {unit or '–'}"


_DECLARED: dict[str, Any] = tomllib.loads(
    (files("warpwear.history") / "quantities.toml").read_text(encoding="utf-8")
)
#: Name of a quantity -> how it is shown, of those that figures and tables for people have.
LOOKS: dict[str, dict[str, Any]] = _DECLARED.pop("look")
#: Name of an end value -> what is said of it, of which a column of the history has the rest.
ENDS_DECLARED: dict[str, dict[str, Any]] = _DECLARED.pop("ends")


def _quantities() -> Iterator[Quantity]:
    sections = (section_in(info.annotation) for info in Study.model_fields.values())
    own = (getattr(section, "QUANTITIES", {}) for section in dict.fromkeys(sections))
    for where, meanings in chain(_DECLARED.items(), *(quantities.items() for quantities in own)):
        what, _, only = where.partition(", ")
        for heading, meaning in meanings.items():
            name, unit = heading.rstrip("]").split(" [")
            units, frame, mark = (*unit.split(", "), "", "")[:3]
            marks = {"lowers": {"lowers": 1.0, "raises": -1.0}.get(mark, 0.0), "signed": mark == "signed"}
            about = LOOKS.get(name, {}) | (meaning if isinstance(meaning, dict) else {"meaning": meaning})
            place: dict[str, Any] = {"per": what, "only": only or None, "frame": frame or None}
            yield Quantity(name, units, **about, **marks, **place)


QUANTITIES = tuple(_quantities())


def per(what: Per) -> tuple[Quantity, ...]:
    """Return the quantities that have one value for each of these, in the order of their declaration."""
    return tuple(quantity for quantity in QUANTITIES if quantity.per == what)


#: Tables of shape (steps, patches), patches in the order of `Patches`: x · across + y.
PATCH_TABLES = per("patch")
#: Fields of a snapshot, by name.
FIELDS = {quantity.name: quantity for quantity in per("cell")}
#: Columns of the table of pieces.
OF_PIECES = {quantity.name: quantity for quantity in per("piece")}
#: Every quantity by its name; what has one value a step goes before others of its name.
BY_NAME = {quantity.name: quantity for quantity in reversed(QUANTITIES)}
#: The areas that are drawn over each other, in the order of their legend.
AREAS = tuple(name for name, look in LOOKS.items() if look.get("family") == "area")
#: Name -> unit of everything.
UNITS = {quantity.name: quantity.units for quantity in QUANTITIES}


#: Units and meanings of the columns of a material, by the beginning of their names, see `of_materials`.
OF_A_MATERIAL = {
    "load_share": ("1", "part of the load that was borne as the step began by"),
    "area": ("mm^2", "area in contact that was as the step began of"),
    "wear_volume": ("mm^3", "volume worn off"),
}


def unit_of(column: str) -> str:
    """Return the unit of a column of the history, also of a material's, whose names studies choose."""
    kind = re.split("_(?:counter|disc)_", column)[0]
    return UNITS.get(column) or OF_A_MATERIAL.get(kind, "?")[0]


def columns_of(study: Study) -> tuple[Quantity, ...]:
    """Return the columns of the history that a run of the study has."""
    columns = [quantity for quantity in per("step") if quantity.applies_to(study)]
    for body, profile in zip(BODIES, study.pair.profiles or (), strict=False):
        for names, material in zip(of_materials(body, profile), profile.materials, strict=False):
            of = f"{material.name} of the {CALLED[body]}"
            only, pairs = f"{body}.layers", zip(names, OF_A_MATERIAL.values(), strict=True)
            columns += [Quantity(name, unit, f"{meaning} {of}", only=only) for name, (unit, meaning) in pairs]
    return tuple(columns)


def evolution_columns(study: Study) -> tuple[Quantity, ...]:
    """Return the columns of the table of roughness, islands and joint that a run of the study has."""
    return tuple(quantity for quantity in per("snapshot") if quantity.applies_to(study))


#: Measures of a stress, by name; and of a cycle, where there are fatigue limits.
MEASURES, OF_A_CYCLE = ("mises", "max_shear", "principal"), ("crossland", "dang_van")


def stress_columns(study: Study) -> list[str]:
    """Name the quantities of depths and of a plane that a run of the study has, or has with stresses."""
    return [
        q.name
        for what in ("depth", "plane")
        for q in per(what)
        if q.only == "output.stress_depths" or q.applies_to(study)
    ]
