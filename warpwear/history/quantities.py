"""Every quantity of a result is declared once: name, unit, meaning, what has a value of it, and looks.

The columns of the history, the fields of a snapshot, the tables of patches and of roughness, the headers of
CSV files, the attributes in HDF5 files, `Result.units`, the axes of figures and the table of the docs
follow from this.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from warpwear.grid import FloatArray
from warpwear.history.arrangements import ARRANGEMENTS
from warpwear.laws.archard import CALLED
from warpwear.study.study import Study

#: What a quantity has one value for: a step; a step and patch; a cell of a snapshot; a snapshot; a piece.
Per = Literal["step", "patch", "cell", "snapshot", "piece"]
#: Runs that a quantity may be limited to: name -> what they are called, and whether a study makes one.
ONLY: Mapping[str, tuple[str, Callable[[Study], bool]]] = {
    **{name: (one.called, one.serves) for name, one in ARRANGEMENTS.items()},
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
    "programme": ("programmes of blocks", lambda study: study.block is not None),
    "film": ("runs with a film", lambda study: study.film is not None),
    "pieces": ("wear in pieces", lambda study: study.wear.sheds),
    "static area": ("output.static_area_every", lambda study: study.static_area_every > 0),
}


@dataclass(frozen=True)
class Quantity:
    """Declare one quantity of a result.

    only: a name of `ONLY`, None where all runs have it. booked: whether the step itself says it, so that
    checkpoints keep it; if not, it follows from the whole history at the end of a run.

    Where people see it: label names it alone, short beside others of its family, whose name stands at the
    axis. Its values times factor are in shown_unit. log: whether an axis of values over decades is
    logarithmic. colour: a name of `warpwear.figures.describe`; dash: how its line is drawn.
    entry: keys of its end value in a run's summary, with dots between them.
    """

    name: str
    units: str
    meaning: str
    per: Per = "step"
    only: str | None = None
    booked: bool = True
    label: str = ""
    family: str = ""
    short: str = ""
    factor: float = 1.0
    shown_unit: str = ""
    log: bool = False
    colour: str = "NEUTRAL"
    dash: str = "solid"
    entry: str = ""

    def applies_to(self, study: Study) -> bool:
        """Tell whether a run of the study has the quantity."""
        return self.only is None or ONLY[self.only][1](study)

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


def _look(label: str, colour: str = "NEUTRAL", dash: str = "solid", **others: Any) -> dict[str, Any]:
    return {"label": label, "colour": colour, "dash": dash, **others}


def _of_bodies(prefix: str, label: str, **others: Any) -> dict[str, dict[str, Any]]:
    """Declare how a quantity of both bodies is shown, each by a colour and dash of its own."""
    lines, others = {"counter": ("COUNTER", "dash"), "disc": ("DISC", "solid")}, {"family": label} | others
    return {
        f"{prefix}_{body}": _look(f"{label} of the {CALLED[body]}", *line, short=body, **others)
        for body, line in lines.items()
    }


_AREA: dict[str, Any] = {"family": "area", "log": True}
_PRESSURE: dict[str, Any] = {"family": "pressure in contact", "log": True}
_MICRONS: dict[str, Any] = {"factor": 1.0e3, "shown_unit": "µm"}
#: Name of a quantity -> how it is shown, of those that figures and tables for people have.
LOOKS: dict[str, dict[str, Any]] = {
    "distance": _look("sliding distance"),
    "approach": _look("approach of the bodies", **_MICRONS),
    "load": _look("normal load"),
    "area_contact": _look("area in contact", "CONTACT", short="in contact", **_AREA),
    "area_plastic": _look("area at hardness", "HARDNESS", "dot", short="at hardness", **_AREA),
    "area_touched": _look("area ever touched", "TOUCHED", "dash", short="ever touched", **_AREA),
    "area_nominal": _look("nominal area (scar)", "NOMINAL", "dashdot", short="nominal (scar)", **_AREA),
    "area_cumulative": _look("running sum of areas", "SUM", "longdash", short="running sum", **_AREA),
    "area_static": _look("area without wear in the step", short="without wear in the step", log=True),
    "patch_along": _look("scar, along sliding"),
    "patch_across": _look("scar, across sliding"),
    "pressure_mean": _look("mean pressure in contact", "MEAN_PRESSURE", short="mean", **_PRESSURE),
    "pressure_max": _look("largest pressure in contact", dash="dot", short="largest", **_PRESSURE),
    **_of_bodies("wear_volume", "worn volume", factor=1.0e3, shown_unit="10⁻³ mm³"),
    **_of_bodies("wear_depth", "deepest wear", family="depth of the deepest cell", **_MICRONS),
    "cof": _look("coefficient of friction"),
    "friction_energy": _look("energy dissipated by friction"),
    "tangential_force": _look("amplitude of the tangential force"),
    "displacement": _look("amplitude of the displacement", **_MICRONS),
    "energy": _look("energy of a cycle"),
    "energy_ratio": _look("energy ratio of a cycle"),
    "slip_mean": _look("mean slip of a cycle", **_MICRONS),
    "stick_area": _look("stick area", "CONTACT"),
    "slip": _look("slip of a cycle", **_MICRONS),
    "bare_fraction": _look("bare fraction of the area in contact", "DISC"),
    "diameter": _look("diameter as cut", **_MICRONS),
}


#: What has one value for each, and which runs have it -> heading in tables, 'name [unit]' -> meaning.
_DECLARED: dict[tuple[Per, str | None], dict[str, str]] = {
    ("step", None): {
        "distance [mm]": "sliding distance at the end of the step",
        "time [s]": "distance over speed; NaN without a speed",
        "increment [mm]": "sliding distance of the step",
        "approach [mm]": "rigid approach from the mean planes",
        "load [N]": "normal load",
        "load_residual [N]": "load carried at the hardness minus load asked for",
        "area_contact [mm^2]": "real area of contact: cells with pressure",
        "area_plastic [mm^2]": "area of the cells at the hardness",
        "area_touched [mm^2]": "area of the cells that were ever in contact",
        "area_cumulative [mm^2]": "running sum of area_contact over the steps",
        "area_nominal [mm^2]": "ellipse (of a line: rectangle) in the extents of the touched cells: the "
        "scar as one measures it",
        "patch_along [mm]": "extent of the touched cells along the sliding direction",
        "patch_across [mm]": "extent of the touched cells across the sliding direction",
        "pressure_mean [MPa]": "mean pressure of the cells in contact",
        "pressure_std [MPa]": "standard deviation of the pressure of the cells in contact",
        "pressure_max [MPa]": "largest pressure of a cell",
        "wear_volume_counter [mm^3]": "volume worn off the counter-body, summed over its wear field",
        "wear_volume_disc [mm^3]": "volume worn off the disc, summed over its wear field",
        "wear_depth_counter [mm]": "deepest wear of a cell of the counter-body",
        "wear_depth_disc [mm]": "deepest wear of a cell of the disc",
        "cof [1]": "coefficient of friction; NaN until its shear strength is calibrated",
        "friction_energy [J]": "dissipated by friction since the start, ∫ μ F dL; NaN as long as cof is",
        "cells_in_contact [1]": "number of cells with pressure",
        "archard_volume_counter [mm^3]": "K F ΔL summed: what Archard's law asks of the counter-body",
        "archard_volume_disc [mm^3]": "what Archard's law asks of the disc, with its distance factor",
        "evaluations [1]": (
            "passes over the gap that the balance took; of the half-space, pairs of transforms"
        ),
    },
    ("step", "track"): {
        "position [mm]": "place of the counter-body's apex along the track, 0 in the middle of the stroke",
        "plastic_volume_disc [mm^3]": "volume displaced of the disc for good, not worn",
    },
    ("step", "jump"): {
        "cycles [1]": "cycles that the step stands for, each: its increment is of them all",
    },
    ("step", "fretting"): {
        "tangential_force [N]": "amplitude Q of the tangential force in a cycle",
        "displacement [mm]": "amplitude Δ of the bodies' displacement in a cycle; NaN of a line",
        "displacement_border [mm]": "amplitude of displacement from which on all of the contact slips",
        "energy [mJ]": "energy that friction dissipates in a cycle",
        "energy_ratio [1]": "that energy over 4QΔ: 0.2 where a ball begins to slip as a whole, at most 1",
        "slip_mean [mm]": "way slipped in a cycle, to and fro: the mean over the load",
        "stick_area [mm^2]": "area in contact that does not slip",
    },
    ("step", "half-space track"): {
        "parts [1]": "contacts solved in the step, each over a part of its cells; the row holds their means",
        "area_error [1]": "estimated relative error of the contact area by the length of these parts",
    },
    ("step", "half-space"): {
        "violation [1]": (
            "certified: largest violation of the contact conditions over the rms height; NaN between"
        ),
        "energy_gap [mJ]": "certified: energy of the pressure above the least possible, at most; NaN between",
        "energy_gap_relative [1]": "that energy over load times rms height of the gap; NaN between",
    },
    ("step", "programme"): {
        "block [1]": "number of the block of the programme, from 1",
    },
    ("step", "film"): {
        "bare_fraction [1]": "part of the area in contact that was bare of film as the step began",
    },
    ("step", "pieces"): {
        "pending_volume_counter [mm^3]": "worn by Archard's law, but no piece has left with it yet; start 0",
        "pending_volume_disc [mm^3]": "the same of the disc: worn and pending volume are K F L together",
        "pieces_counter [1]": "pieces that left the counter-body in the step",
        "pieces_disc [1]": "pieces that left the disc in the step, on the whole stroke",
    },
    ("step", "static area"): {
        "area_static [mm^2]": "real area of contact without wear in the step; NaN where it was not solved",
    },
    ("patch", "patches"): {
        "load_share [N]": "load of each patch, or of the macro cell that it stands for",
        "area_patch [mm^2]": "real area of contact of each patch, or of its macro cell",
    },
    ("cell", None): {
        "pressure [MPa]": "contact pressure, solved in the step that ends at the snapshot",
        "wear_counter [mm]": "depth worn off the counter-body",
        "wear_disc [mm]": "depth worn off the disc; of a swept run, over the whole track",
        "gap [mm]": "gap between the bodies after the step's wear, without elastic deformation",
    },
    ("cell", "dents"): {
        "plastic_disc [mm]": "depth displaced of the track for good, not worn",
    },
    ("cell", "fretting"): {
        "slip [mm]": "way that a place in contact slips in a cycle, to and fro; 0 where it sticks",
    },
    ("cell", "film"): {
        "bare [1]": "1 where a cell was bare of film as the step began, else 0",
    },
    ("snapshot", None): {
        "distance [mm]": "sliding distance of the snapshot",
        "sa [um]": "arithmetic mean height Sa of the disc in the middle of the scar, its bowl taken off",
        "sq [um]": "root mean square height Sq in the middle of the scar",
        "ssk [1]": "skewness Ssk of the heights in the middle of the scar",
        "sk [um]": "core height Sk in the middle of the scar",
        "spk [um]": "reduced peak height Spk in the middle of the scar",
        "svk [um]": "reduced valley depth Svk in the middle of the scar",
        "sq_counter [um]": "Sq of the counter-body in the inner scar, half its size, "
        "form of degree 4 removed",
        "sq_disc [um]": "the same of the disc; of a track the root mean square over places along it",
        "sq_disc_unworn [um]": "that of the same cells of the disc before any wear",
        "sdq_counter [1]": "root mean square gradient Sdq of the counter-body in the inner scar, "
        "as sq_counter",
        "sdq_disc [1]": "the same of the disc, as sq_disc",
        "rq_counter [um]": "Rq of profiles along sliding there, each less its form of degree 4, "
        "of the counter-body",
        "rq_disc [um]": "the same of the disc, as sq_disc",
        "islands [1]": "connected regions in contact (cells that share an edge)",
        "islands_of_one_cell [1]": "islands of a single cell: the mesh does not resolve them",
        "island_area_median [mm^2]": "median area of an island",
        "island_area_largest [mm^2]": "area of the largest island",
        "share_above_critical [1]": (
            "part of the area in contact in islands wider than d* (that of pieces, or eq 2.3); NaN without"
        ),
    },
    ("piece", "pieces"): {
        "step [1]": "number of the step in which the piece left, from 0",
        "body [1]": "0 of the counter-body, 1 of the disc",
        "x [mm]": "place of its middle along sliding: on the domain of the counter-body, or on the track",
        "y [mm]": "place of its middle across the sliding direction",
        "volume [mm^3]": "volume of the piece",
        "diameter [mm]": "diameter of the circle of the area that was cut",
    },
}
#: Columns that follow from the whole history at the end of a run.
UNBOOKED = ("cof", "friction_energy")


def _quantities() -> Iterator[Quantity]:
    for (what, only), declared in _DECLARED.items():
        for heading, meaning in declared.items():
            name, units = heading.rstrip("]").split(" [")
            yield Quantity(name, units, meaning, what, only, name not in UNBOOKED, **LOOKS.get(name, {}))


QUANTITIES = tuple(_quantities())


def per(what: Per) -> tuple[Quantity, ...]:
    """Return the quantities that have one value for each of these, in the order of their declaration."""
    return tuple(quantity for quantity in QUANTITIES if quantity.per == what)


#: Tables of shape (steps, patches), patches in the order of `Patches`: x · across + y.
PATCH_TABLES = per("patch")
#: Fields of a snapshot, by name.
FIELDS = {quantity.name: quantity for quantity in per("cell")}
#: Fields that cover the track of a swept run, not the domain.
OF_THE_TRACK = ("wear_disc", "plastic_disc")
#: Columns of the table of pieces.
OF_PIECES = {quantity.name: quantity for quantity in per("piece")}
#: Columns of the table of roughness and islands.
EVOLUTION = per("snapshot")
#: Every quantity by its name; what has one value a step goes before others of its name.
BY_NAME = {quantity.name: quantity for quantity in reversed(QUANTITIES)}
#: The areas that are drawn over each other, in the order of their legend.
AREAS = tuple(name for name, look in LOOKS.items() if look.get("family") == "area")
#: Name -> unit of everything.
UNITS = {quantity.name: quantity.units for quantity in QUANTITIES}


def columns_of(study: Study) -> tuple[Quantity, ...]:
    """Return the columns of the history that a run of the study has."""
    return tuple(quantity for quantity in per("step") if quantity.applies_to(study))
