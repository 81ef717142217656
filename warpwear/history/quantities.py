"""Every quantity of a result, declared once: its name, unit, meaning, and what it has a value for.

The columns of the history, the fields of a snapshot, the tables of patches and of roughness, the headers of
CSV files, the attributes in HDF5 files, `Result.units` and the table in the documentation follow from this.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from warpwear.history.arrangements import ARRANGEMENTS
from warpwear.study.study import Study

#: What a quantity has one value for: a step; a step and patch; a cell of a snapshot; a snapshot; a piece.
Per = Literal["step", "patch", "cell", "snapshot", "piece"]
#: Runs that a quantity is limited to: over a track, on the half-space, both, with patches, over a track that
#: keeps its dents, with a film, of bodies that wear in pieces, with contacts that are also solved without
#: wear.
Only = Literal["track", "half-space", "half-space track", "patches", "dents", "film", "pieces", "static area"]


@dataclass(frozen=True)
class Quantity:
    """One quantity of a result.

    booked: whether the step itself says it, so that checkpoints keep it; if not, it follows from the whole
    history at the end of a run.
    """

    name: str
    units: str
    meaning: str
    per: Per = "step"
    only: Only | None = None
    booked: bool = True

    def applies_to(self, study: Study) -> bool:
        """Whether a run of the study has it."""
        return {
            None: True,
            **{name: one.serves(study) for name, one in ARRANGEMENTS.items()},
            "half-space": study.contact.law == "half-space",
            "half-space track": study.is_swept and study.contact.law == "half-space",
            "pieces": study.wear.sheds,
            "static area": study.static_area_every > 0,
            "dents": study.is_swept and study.sliding.plastic == "keep",
            "film": study.film is not None,
        }[self.only]


def _per(per: Per, *declared: tuple[str, str, str], only: Only | None = None) -> Iterator[Quantity]:
    return (Quantity(name, units, meaning, per, only) for name, units, meaning in declared)


QUANTITIES: tuple[Quantity, ...] = (
    *_per(
        "step",
        ("distance", "mm", "sliding distance at the end of the step"),
        ("time", "s", "distance over speed; NaN without a speed"),
        ("increment", "mm", "sliding distance of the step"),
        ("approach", "mm", "rigid approach from the mean planes"),
        ("load", "N", "normal load"),
        ("load_residual", "N", "load carried at the hardness minus load asked for"),
        ("area_contact", "mm^2", "real area of contact: cells with pressure"),
        ("area_plastic", "mm^2", "area of the cells at the hardness"),
        ("area_touched", "mm^2", "area of the cells that were ever in contact"),
        ("area_cumulative", "mm^2", "running sum of area_contact over the steps"),
        ("area_nominal", "mm^2", "ellipse in the extents of the touched cells: the scar as one measures it"),
        ("patch_along", "mm", "extent of the touched cells along the sliding direction"),
        ("patch_across", "mm", "extent of the touched cells across the sliding direction"),
        ("pressure_mean", "MPa", "mean pressure of the cells in contact"),
        ("pressure_std", "MPa", "standard deviation of the pressure of the cells in contact"),
        ("pressure_max", "MPa", "largest pressure of a cell"),
        ("wear_volume_sphere", "mm^3", "volume worn off the sphere, summed over its wear field"),
        ("wear_volume_disc", "mm^3", "volume worn off the disc, summed over its wear field"),
        ("wear_depth_sphere", "mm", "deepest wear of a cell of the sphere"),
        ("wear_depth_disc", "mm", "deepest wear of a cell of the disc"),
    ),
    Quantity("cof", "1", "coefficient of friction; NaN until its shear strength is calibrated", booked=False),
    *_per(
        "step",
        ("cells_in_contact", "1", "number of cells with pressure"),
        ("archard_volume_sphere", "mm^3", "K F ΔL summed: what Archard's law asks of the sphere"),
        ("archard_volume_disc", "mm^3", "what Archard's law asks of the disc, with its distance factor"),
        (
            "evaluations",
            "1",
            "passes over the gap that the balance took; of the half-space, pairs of transforms",
        ),
    ),
    *_per(
        "step",
        ("position", "mm", "place of the sphere's apex along the track, 0 in the middle of the stroke"),
        ("plastic_volume_disc", "mm^3", "volume displaced of the disc for good, not worn"),
        only="track",
    ),
    *_per(
        "step",
        (
            "parts",
            "1",
            "contacts solved in the step, each over a part of its cells; the row holds their means",
        ),
        ("area_error", "1", "estimated relative error of the contact area by the length of these parts"),
        only="half-space track",
    ),
    *_per(
        "step",
        (
            "violation",
            "1",
            "certified: largest violation of the contact conditions over the rms height; NaN between",
        ),
        (
            "energy_gap",
            "mJ",
            "certified: energy of the pressure above the least possible, at most; NaN between",
        ),
        ("energy_gap_relative", "1", "that energy over load times rms height of the gap; NaN between"),
        only="half-space",
    ),
    *_per(
        "step",
        ("bare_fraction", "1", "part of the area in contact that was bare of film as the step began"),
        only="film",
    ),
    *_per(
        "step",
        (
            "pending_volume_sphere",
            "mm^3",
            "worn by Archard's law, but no piece has left with it yet; start 0",
        ),
        ("pending_volume_disc", "mm^3", "the same of the disc: worn and pending volume are K F L together"),
        ("pieces_sphere", "1", "pieces that left the sphere in the step"),
        ("pieces_disc", "1", "pieces that left the disc in the step, on the whole stroke"),
        only="pieces",
    ),
    *_per(
        "step",
        ("area_static", "mm^2", "real area of contact without wear in the step; NaN where it was not solved"),
        only="static area",
    ),
    *_per(
        "patch",
        ("load_share", "N", "load of each patch, or of the macro cell that it stands for"),
        ("area_patch", "mm^2", "real area of contact of each patch, or of its macro cell"),
        only="patches",
    ),
    *_per(
        "cell",
        ("pressure", "MPa", "contact pressure, solved in the step that ends at the snapshot"),
        ("wear_sphere", "mm", "depth worn off the sphere"),
        ("wear_disc", "mm", "depth worn off the disc; of a swept run, over the whole track"),
        ("gap", "mm", "gap between the bodies after the step's wear, without elastic deformation"),
    ),
    *_per("cell", ("plastic_disc", "mm", "depth displaced of the track for good, not worn"), only="dents"),
    *_per("cell", ("bare", "1", "1 where a cell was bare of film as the step began, else 0"), only="film"),
    *_per(
        "snapshot",
        ("distance", "mm", "sliding distance of the snapshot"),
        ("sa", "um", "arithmetic mean height Sa of the disc in the middle of the scar, its bowl taken off"),
        ("sq", "um", "root mean square height Sq in the middle of the scar"),
        ("ssk", "1", "skewness Ssk of the heights in the middle of the scar"),
        ("sk", "um", "core height Sk in the middle of the scar"),
        ("spk", "um", "reduced peak height Spk in the middle of the scar"),
        ("svk", "um", "reduced valley depth Svk in the middle of the scar"),
        (
            "sq_sphere",
            "um",
            "Sq of the ball in the inner scar, half as long and wide, form of degree 4 removed",
        ),
        ("sq_disc", "um", "the same of the disc; of a track the root mean square over places along it"),
        ("sq_disc_unworn", "um", "that of the same cells of the disc before any wear"),
        ("sdq_sphere", "1", "root mean square gradient Sdq of the ball in the inner scar, as sq_sphere"),
        ("sdq_disc", "1", "the same of the disc, as sq_disc"),
        (
            "rq_sphere",
            "um",
            "Rq of profiles along sliding there, each less its form of degree 4, of the ball",
        ),
        ("rq_disc", "um", "the same of the disc, as sq_disc"),
        ("islands", "1", "connected regions in contact (cells that share an edge)"),
        ("islands_of_one_cell", "1", "islands of a single cell: the mesh does not resolve them"),
        ("island_area_median", "mm^2", "median area of an island"),
        ("island_area_largest", "mm^2", "area of the largest island"),
        (
            "share_above_critical",
            "1",
            "part of the area in contact in islands wider than d* (that of pieces, or eq 2.3); NaN without",
        ),
    ),
    *_per(
        "piece",
        ("step", "1", "number of the step in which the piece left, from 0"),
        ("body", "1", "0 of the sphere, 1 of the disc"),
        (
            "x",
            "mm",
            "place of its middle along the sliding direction: on the sphere's domain, or on the track",
        ),
        ("y", "mm", "place of its middle across the sliding direction"),
        ("volume", "mm^3", "volume of the piece"),
        ("diameter", "mm", "diameter of the circle of the area that was cut"),
        only="pieces",
    ),
)


def per(what: Per) -> tuple[Quantity, ...]:
    """The quantities that have one value for each of these, in the order of their declaration."""
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
#: Name -> unit of everything.
UNITS = {quantity.name: quantity.units for quantity in QUANTITIES}


def columns_of(study: Study) -> tuple[Quantity, ...]:
    """The columns of the history that a run of the study has."""
    return tuple(quantity for quantity in per("step") if quantity.applies_to(study))
