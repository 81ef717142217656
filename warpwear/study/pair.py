"""The bodies of a study as a pair: its moduli, hardnesses, strengths, materials by depth and laws of wear."""

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property, partial

from warpwear.laws.archard import WearLaw
from warpwear.laws.depth_profile import DepthProfile, shears_unalike
from warpwear.laws.elastic import Hertz, effective_modulus
from warpwear.laws.film import Film, grown_cap
from warpwear.laws.fretting import displacement, softness_ratio
from warpwear.laws.junctions import critical_junction, junction_strength
from warpwear.laws.pieces import Pieces
from warpwear.study.bodies import CounterBody, Disc
from warpwear.study.contact import Contact
from warpwear.study.motion import BlockSection, GridSection
from warpwear.study.sections.friction import Friction, Junctions
from warpwear.study.sections.layers import depth_profiles
from warpwear.study.sections.settings import About, PatchesSection
from warpwear.study.sections.wear import Wear


@dataclass(frozen=True, eq=False, kw_only=True)
class Pair:
    """The bodies of a study are a pair: what follows from both is made once, where it is first needed.

    Nothing here checks whether the sections agree: `warpwear.study.rules` does.
    """

    study: About
    counter: CounterBody
    disc: Disc
    contact: Contact
    wear: Wear
    grid: GridSection
    friction: Friction
    junctions: Junctions
    patches: PatchesSection
    block: tuple[BlockSection, ...] | None
    is_line: bool

    @cached_property
    def profiles(self) -> tuple[DepthProfile, DepthProfile] | None:
        """What counter-body and disc are made of by worn depth; None where both are alike at all depths."""
        if not (self.counter.has_depths or self.disc.has_depths):
            return None
        hardness = self.contact.hardness
        if hardness is None and self.study.model == "macro":
            hardness = math.inf
        resolved = partial(self.wear.resolved, hardness=self.wear_hardness, friction=self.friction)
        limits = {"hardness": hardness, "shear_strength": self.friction.shear_strength}
        return depth_profiles((self.counter, self.disc), self.wear_coefficients, resolved, **limits)

    @property
    def shears_by_layer(self) -> bool:
        """True where a layer has a shear strength or coefficient of its own."""
        layers = (layer for body in (self.counter, self.disc) for layer in body.layers or ())
        return any(layer.shear_strength or layer.coefficient for layer in layers)

    def displacement(self, force: float = math.inf) -> float:
        """Return the amplitude of unworn bodies under a force [N], by default that which slips [mm]."""
        assert self.hertz is not None  # checked with the study
        friction = self.friction.coefficient
        ratio = force / (friction * self.contact.load)
        return displacement(self.hertz, self.softness_ratio, friction, ratio)

    @cached_property
    def softness_ratio(self) -> float:
        """Return κ, the tangential over the normal compliance of the contact; 1 where it is unknown."""
        counter, disc = self.counter.elastic, self.disc.elastic
        if counter is None or disc is None:
            return 1.0
        return softness_ratio(counter, disc, line=self.is_line)

    @cached_property
    def caps_pressure(self) -> bool:
        """True where a hardness limits the pressure of a cell."""
        return math.isfinite(self.hardness)

    @cached_property
    def softer_hardness(self) -> float | None:
        """The smaller of the bodies' hardnesses that are given [MPa]; None where neither is."""
        return min((h for h in (self.counter.hardness, self.disc.hardness) if h is not None), default=None)

    @cached_property
    def indentation_hardness(self) -> float:
        """H of a cell without shear [MPa]: contact.hardness, or for rough cells the softer body's."""
        if self.contact.hardness is not None:
            return self.contact.hardness
        hardness = None if self.study.model == "macro" else self.softer_hardness
        return math.inf if hardness is None else hardness

    @cached_property
    def caps(self) -> tuple[float, float]:
        """Largest pressures of a cell with its film and without [MPa], which growing junctions lower."""
        friction, hardness = self.friction, self.indentation_hardness
        grown = friction.junction_growth, friction.largest_coefficient or math.inf
        bare = grown_cap(hardness, friction.shear_strength or 0.0, *grown)
        if friction.film is None:
            return bare, bare
        return grown_cap(hardness, friction.film.shear_strength, *grown), bare

    @cached_property
    def cell_caps(self) -> tuple[float, ...]:
        """Largest pressures that cells may have [MPa]: `caps`, or of all pairs of materials that may meet.

        The first pair is that of both surfaces.
        """
        if self.profiles is None:
            return self.caps
        counter, disc = ([m.hardness for m in profile.materials] for profile in self.profiles)
        return tuple(min(pair) for pair in itertools.product(counter, disc))

    @cached_property
    def hardness(self) -> float:
        """Largest pressure of any cell [MPa]: that of `cell_caps` which is largest."""
        return max(self.cell_caps)

    @cached_property
    def film(self) -> Film | None:
        """The film that the bodies have; None without one."""
        film = self.friction.film
        return None if film is None else film.with_caps(self.caps, self.friction.shear_strength)

    @cached_property
    def effective_modulus(self) -> float | None:
        """E* of both bodies [MPa]; None where elastic constants are unknown."""
        counter, disc = self.counter.elastic, self.disc.elastic
        return None if counter is None or disc is None else effective_modulus(counter, disc)

    @cached_property
    def hertz(self) -> Hertz | None:
        """Hertz's contact before any wear, under the largest load; None for other forms or constants."""
        modulus, form = self.effective_modulus, self.counter.form
        load = max(one.load or self.contact.load for one in self.block or (self.contact,))
        if modulus is None or not self.counter.has_hertz:
            return None
        along, across = (1.0 / rise if rise else math.inf for rise in (form.along, form.across))
        # Along which a cylinder lies, it is as long as the domain.
        return Hertz(modulus, along, load, across, self.grid.sides[1 if form.along else 0])

    @cached_property
    def junction_strength(self) -> float | None:
        """Shear strength σ_j of junctions [MPa]: as given, or from the softer body's hardness.

        Not from contact.hardness, which may be fitted to a contact: d* goes with 1/σ_j².
        """
        if self.junctions.strength is not None or self.softer_hardness is None:
            return self.junctions.strength
        return junction_strength(self.softer_hardness)

    @cached_property
    def yield_strength(self) -> float | None:
        """Stress at which the disc yields in tension [MPa]; by default a third of its hardness (Tabor 1951).

        None where neither is known.
        """
        if self.disc.yield_strength is not None:
            return self.disc.yield_strength
        hardness = self.indentation_hardness if self.disc.hardness is None else self.disc.hardness
        return hardness / 3.0 if math.isfinite(hardness) else None

    @cached_property
    def shear_limit(self) -> float:
        """Shear strength of the softer body [MPa]; of contact.hardness where no body's is known.

        H/(3√3), or H/√α where junctions grow: there a cell under that shear bears no pressure. Of layers the
        hardest counts: where it meets the other body no shear is beyond what is borne.
        """
        growth = self.friction.junction_growth
        softer = self.indentation_hardness if self.softer_hardness is None else self.softer_hardness
        if self.profiles is not None:
            softer = min(max(m.hardness for m in profile.materials) for profile in self.profiles)
        return softer / math.sqrt(growth) if growth else junction_strength(softer)

    @cached_property
    def critical_junction(self) -> float | None:
        """Diameter d* [mm] below which junctions of the softer body smooth out; None where it is unknown."""
        energy, strength = self.junctions.surface_energy, self.junction_strength
        softer = self.counter if self.counter.hardness == self.softer_hardness else self.disc
        if energy is None or strength is None or softer.elastic is None:
            return None
        young, poisson = softer.elastic
        shear_modulus = young / (2.0 * (1.0 + poisson))
        return critical_junction(
            surface_energy=energy, shear_modulus=shear_modulus, poisson=poisson, strength=strength
        )

    @cached_property
    def critical_diameter(self) -> float | None:
        """Diameter d* [mm] above which a junction loses pieces: that of pieces, else of eq 2.3, or None."""
        return self.pieces.diameter if self.pieces else self.critical_junction

    @cached_property
    def stiffness(self) -> float:
        """Return the stiffness of a cell before any wear [N/mm³]; p = clip((approach − gap) × it, 0, H).

        It is infinite for a bearing area, and on the half-space, which yields instead.
        """
        if self.contact.law == "half-space":
            return math.inf
        return self.bulk_stiffness if self.study.model == "macro" else self.contact.stiffness

    @cached_property
    def bulk_stiffness(self) -> float:
        """Return K_N [N/mm³] of both bodies' bulk before any wear."""
        stiffness = self.contact.bulk_stiffness
        if not isinstance(stiffness, str):
            return stiffness
        assert self.hertz is not None  # checked with the study
        return self.hertz.foundation(stiffness)

    @cached_property
    def pieces(self) -> Pieces | None:
        """The pieces by which bodies wear; None where all wear leaves at once."""
        return self.wear.pieces(self.critical_junction)

    @cached_property
    def uses_bulk_stiffness(self) -> bool:
        """True where the stiffness K_N of the bulk plays a part."""
        if self.study.model == "two-scale":
            return self.patches.bulk == "spring" or self.patches.coupling == "load"
        return self.study.model == "macro"

    @cached_property
    def wear_coefficients(self) -> tuple[float, float]:
        """K of counter-body and disc [mm²/N], hardness contained; in the long run, where a law changes it."""
        counter, disc = self.wear_laws
        return counter.steady, disc.steady

    @cached_property
    def wear_laws(self) -> tuple[WearLaw, WearLaw]:
        """The laws by which counter-body and disc wear."""
        return self.wear.laws(self.wear_hardness, self.friction)

    @cached_property
    def surface_laws(self) -> tuple[WearLaw, WearLaw]:
        """The laws by which the unworn surfaces of counter-body and disc wear, which layers may be."""
        profiles = self.profiles or (None, None)
        counter, disc = (
            law if profile is None else replace(law, steady=profile.materials[0].wear)
            for law, profile in zip(self.wear_laws, profiles, strict=True)
        )
        return counter, disc

    @cached_property
    def wears_by_area(self) -> bool:
        """True where cells in contact wear by their shear strength, whatever their pressure."""
        return self.wear.law == "energy" and self.friction.law == "shear-strength"

    @cached_property
    def other_shear(self) -> str:
        """Say, behind a shear strength, what shears cells by another one; nothing where none does."""
        film, largest = self.friction.film, self.friction.largest_coefficient
        own = [f", film {film.shear_strength:g} MPa"] if film else []
        own += [", layers by their own"] if shears_unalike(self.profiles or ()) else []
        return "".join([*own, f", at most {largest:g} of the pressure of a cell"] if largest else own)

    @cached_property
    def largest_shear(self) -> float:
        """Largest shear of a cell over its pressure and the bodies' strength [1/MPa]; infinite without."""
        largest, strength = self.friction.largest_coefficient, self.friction.shear_strength
        return largest / strength if largest and strength else math.inf

    @cached_property
    def wear_hardness(self) -> float:
        """Return H of V = k F L / H [MPa]: contact.hardness, or the softer body's."""
        limit = self.contact.hardness
        return (self.softer_hardness or math.inf) if limit is None else limit
