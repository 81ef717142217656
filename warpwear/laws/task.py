"""A task holds the numbers of one contact, which its model, its history and its steps read."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Literal

from warpwear.grid import FloatArray
from warpwear.laws.archard import WearLaw, knots_of
from warpwear.laws.depth_profile import DepthProfile, shears_unalike
from warpwear.laws.elastic import Hertz
from warpwear.laws.film import Film
from warpwear.laws.form import Form
from warpwear.laws.fretting import Fretting
from warpwear.laws.pieces import Pieces


class FeatureLaw:
    """Says what a study adds to a contact: the law of a feature, which a section has under its name.

    Unless it says otherwise, its cells are not alike, area and scar do not go with the sum of both wears, and
    no step may stand for many (jumps), as if all that it does followed from the distance that it slides.
    """

    is_uniform: ClassVar[bool] = False
    scales: ClassVar[bool] = False
    jumps: ClassVar[bool] = False

    def balances(self, row: Mapping[str, float]) -> Iterable[tuple[str, float, float]]:
        """Yield what columns of a row that it adds are, what they come to, and what they are due to [mm³]."""
        return ()


#: Members of a task by which area and scar do not cease to go with the sum of both wears.
PLAIN = {
    *("load", "hardness", "form", "compliance", "implicit", "rigid", "load_tolerance", "distance_factor"),
    *("keeps_dents", "bulk_stiffness", "bulk_updated", "uses_bulk_stiffness", "prescribed_loads"),
    *("half_space", "modulus", "boundary", "static_area_every", "lap_memory", "area_error"),
}


@dataclass(frozen=True)
class ContactTask:
    """Holds the numbers of one contact, made from a study once; models read nothing else."""

    load: float  # F [N]
    hardness: float  # largest pressure of an unworn cell H [MPa]; inf without one
    form: Form  # of the unworn counter-body
    wear: tuple[WearLaw, WearLaw]  # of counter-body and disc, of their unworn surfaces
    compliance: float  # 1/k of the cells of the unworn contact, without wear [mm³/N]
    implicit: bool = True  # whether the wear of a step adds to its compliance
    rigid: bool = False  # whether there is no compliance at all: a bearing area
    load_tolerance: float = 0.0  # that a bearing area may leave unbalanced [N]
    #: Of the disc's cells, see `archard.distance_factor`.
    distance_factor: Literal["none", "across", "radial"] = "none"
    keeps_dents: bool = False  # whether a disc cell at the hardness stays as deep as it was pressed
    bulk_stiffness: float | str = math.inf  # K_N of the macro contact [N/mm³], or what it follows from
    bulk_updated: bool = False  # whether it follows the contact as it grows
    uses_bulk_stiffness: bool = False  # whether K_N plays a part
    hertz: Hertz | None = None  # of the unworn bodies, where K_N follows from it
    prescribed_loads: bool = False  # whether a smooth contact prescribes the load of each patch
    half_space: bool = False  # whether the surfaces deform as half-spaces
    modulus: float | None = None  # E* of both bodies [MPa], where it is known
    boundary: str = "free"  # of the half-space: "free" or "periodic"
    film: Film | None = None  # on the bodies, under which the hardness of a cell may be another
    static_area_every: int = 0  # steps between contacts that are also solved without wear; 0: none are
    lap_memory: float = 256.0e6  # for pressures of a lap, from which contacts of the next begin [B]
    area_error: float = (
        0.025  # that the length of parts of a step may make in the area of a contact, relative
    )
    pieces: Pieces | None = None  # by which bodies wear; None: all wear leaves at once
    fretting: Fretting | None = None  # what drives a fretting contact; None where nothing frets
    #: What counter-body and disc are made of by worn depth; None where they are alike at all depths.
    profiles: tuple[DepthProfile, DepthProfile] | None = None
    features: Mapping[str, FeatureLaw] = field(default_factory=dict)  # what sections add beside, by name
    largest_shear: float = math.inf  # of a cell over its pressure and the bodies' strength [1/MPa]

    @property
    def dust(self) -> float:
        """Return the fraction of the wear that leaves in the step, and lends its contact a compliance."""
        return 1.0 if self.pieces is None else self.pieces.dust

    def bulk_stiffness_at(self, radius: float | None) -> float:
        """Return K_N of the macro contact [N/mm³]. radius: of the contact [mm], which K_N may follow."""
        if not isinstance(self.bulk_stiffness, str):
            return self.bulk_stiffness
        assert self.hertz is not None  # checked with the study
        return self.hertz.foundation(self.bulk_stiffness, radius=radius if self.bulk_updated else None)

    def compliance_at(self, area: float) -> float:
        """Return 1/k of the cells [mm³/N]. area: in contact [mm²], which a macro contact's K_N may follow."""
        if not self.bulk_updated:
            return self.compliance
        return 1.0 / self.bulk_stiffness_at(math.sqrt(area / math.pi) if area else None)

    def wear_per_pressure(self, start: float, increment: float) -> tuple[float, float]:
        """Return K ΔL of counter-body and disc [mm³/N] over an increment that begins at a distance [mm]."""
        counter, disc = (law.wear_per_pressure(start, increment) for law in self.wear)
        return counter, disc

    def wear_per_contact(self, start: float, increment: float) -> tuple[float, float]:
        """Return the depths [mm] that an increment [mm] wears off cells in contact by their shear.

        start: distance slid before it [mm].
        """
        counter, disc = (law.wear_per_contact(start, increment) for law in self.wear)
        return counter, disc

    @property
    def knots(self) -> FloatArray:
        """Return how K of a cell goes with its pressure, see `archard.knots_of`."""
        return knots_of(self.wear)

    @property
    def shears(self) -> bool:
        """Tell whether cells in contact wear by their shear, whatever their pressure."""
        return sum(self.wear_per_contact(0.0, 1.0)) > 0.0

    @property
    def shears_unalike(self) -> bool:
        """Tell whether cells have a shear strength by their materials, or a part of their pressure."""
        return shears_unalike(self.profiles or (), self.largest_shear)

    @property
    def surface_shear(self) -> float | None:
        """Return the shear strength of unworn surfaces over the bodies'; None where cells of these differ."""
        tops = [profile.materials[0] for profile in self.profiles or ()]
        bounds = (self.largest_shear, *(top.coefficient for top in tops))
        if not self.shears_unalike or self.film is not None or min(bounds) < math.inf:
            return None if self.shears_unalike else 1.0
        assert self.profiles is not None
        return min(top.shear_strength for top in tops) / self.profiles[0].materials[-1].shear_strength

    @property
    def is_uniform(self) -> bool:
        """Tell whether, at rest, every cell has the same law: one stiffness, and wear in one proportion."""
        counter, disc = self.wear
        alike = self.distance_factor == "none" and self.film is None and not self.shears
        alike = alike and not self.shears_unalike
        laws = (*(self.profiles or ()), *self.features.values())
        alike = alike and all(law.is_uniform for law in laws)
        return alike and counter.in_proportion_to(disc) and not len(self.knots)

    @property
    def scales(self) -> bool:
        """Tell whether area and scar follow from the sum of both wears alone: if all its laws say so.

        See `archard.Scales`. A member beside the `PLAIN` ones that differs from its default is a law.
        """
        laws: list[Any] = [*self.features.values()]
        for one in fields(self):
            value = getattr(self, one.name)
            if one.name not in {"features", *PLAIN} and value != one.default:
                laws += value if isinstance(value, tuple) else (value,)
        of_steps = self.implicit and self.distance_factor == "none"
        return of_steps and all(getattr(law, "scales", False) for law in laws)

    @property
    def least_hardness(self) -> float:
        """Return the smallest cap of a cell [MPa]."""
        film = self.film
        if self.profiles is not None:
            return min(profile.least_hardness for profile in self.profiles)
        return self.hardness * (1.0 if film is None else min(film.cap_ratio_filmed, film.cap_ratio_bare))

    @property
    def shear_ratios(self) -> dict[str, float]:
        """Return the smallest and the largest shear ratio of a cell, as a `Slide` has them."""
        filmed = 1.0 if self.film is None else self.film.shear_ratio
        return {"least_shear_ratio": min(filmed, 1.0), "most_shear_ratio": max(filmed, 1.0)}

    @property
    def wear_fractions(self) -> tuple[float, float]:
        """Return the fractions of counter and disc in what is worn, of bodies that wear in one proportion."""
        counter, disc = (law.fastest for law in self.wear)
        both = counter + disc
        return (counter / both, disc / both) if both else (0.5, 0.5)
