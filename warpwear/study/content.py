"""The content of a study: its sections, and what follows from them."""

import itertools
import math
from dataclasses import replace
from functools import partial
from typing import Any

from warpwear.laws.archard import BODIES, WearLaw
from warpwear.laws.depth_profile import DepthProfile, shears_unalike
from warpwear.laws.elastic import Hertz, effective_modulus
from warpwear.laws.film import Film, grown_cap
from warpwear.laws.fretting import HONEST_MEAN, Fretting, displacement, softness_ratio
from warpwear.laws.junctions import critical_junction, junction_strength
from warpwear.laws.pieces import Pieces
from warpwear.laws.task import ContactTask, FeatureLaw
from warpwear.study.keys import uses, value_of
from warpwear.study.programme import Programme
from warpwear.study.sections.layers import depth_profiles
from warpwear.study.units import text
from warpwear.surfaces.form import Form


class Content(Programme):
    """The content of a study is its sections of keys, in mm, N, MPa and s, and what follows from them.

    Nothing here checks whether the sections agree: `warpwear.study.rules` does.
    """

    def volumes(
        self, distance: float, form: Form | None = None, extent: tuple[float, float] | None = None
    ) -> tuple[float, float]:
        """Return what counter-body and disc lose over the test's first distance [mm]: Σ K F ΔL [mm³].

        Where K changes with depth it is an estimate, by the caps that a plane cuts off a form, by default the
        counter-body's, over an extent, by default the domain's [mm].
        """
        form, extent = form or self.counter.form, extent or self.grid.sides
        profiles = self.profiles or (None, None)
        counter, disc = (
            self._volume(law, distance)
            if profile is None
            else profile.volume(self.load_distance(body, distance), lambda v: form.deepest(v, extent))
            for body, law, profile in zip(BODIES, self.wear_laws, profiles, strict=True)
        )
        return counter, disc

    def load_distance(self, body: str, distance: float) -> float:
        """Return F L [N mm] of the test's first distance [mm], a body's wear law relative to its K."""
        return self._volume(replace(self.wear_laws[BODIES.index(body)], steady=1.0), distance)

    def _volume(self, law: WearLaw, distance: float) -> float:
        """Return Σ K F ΔL of a law over the test's first distance [mm³]."""
        return sum(b.load * law.wear_per_pressure(b.start, b.slides(distance)) for b in self.blocks)

    @property
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

    def _check(self) -> None:
        """Give a force the stroke of the unworn bodies, by which distances count."""
        super()._check()
        elastic = self.effective_modulus is not None and self.counter.has_hertz
        if self.sliding.force is not None and elastic:
            self.sliding._travel = 2.0 * self._displacement(self.sliding.force)

    def _displacement(self, force: float = math.inf) -> float:
        """Return the amplitude of unworn bodies under a force [N], by default that which slips [mm]."""
        assert self.hertz is not None  # checked with the study
        friction = self.friction.coefficient
        ratio = force / (friction * self.contact.load)
        return displacement(self.hertz, self.softness_ratio, friction, ratio)

    @property
    def slides_by(self) -> float:
        """Return by how much a drive slides unworn bodies as a whole [mm]; below 0 a part sticks."""
        sliding, limit = self.sliding, self.friction.coefficient * self.contact.load
        if sliding.force is not None:
            return -math.inf
        return 0.5 * (sliding.stroke or 0.0) - sliding.rig_compliance * limit - self._displacement()

    @property
    def softness_ratio(self) -> float:
        """Return κ, the tangential over the normal compliance of the contact; 1 where it is unknown."""
        counter, disc = self.counter.elastic, self.disc.elastic
        if counter is None or disc is None:
            return 1.0
        return softness_ratio(counter, disc, line=self.is_line)

    @property
    def kinematics(self) -> str:
        """How the bodies move: "fretting" where one contact stands for all places of a stroke."""
        if not self.sliding.frets:
            return super().kinematics
        return "fretting" if self.positions == "mean" else "swept"

    @property
    def positions(self) -> str:
        """Places of a fretting stroke that have a contact: "mean" or "cells", as named or as is honest."""
        sliding = self.sliding
        if sliding.drives_bodies:
            return "mean"
        if self.block is not None:
            return sliding.positions or "cells"
        smooth = self.disc.synthetic is not None and self.disc.synthetic.kind == "flat"
        return sliding.positions or ("mean" if smooth and self.stroke_ratio <= HONEST_MEAN else "cells")

    @property
    def stroke_ratio(self) -> float:
        """Return the stroke over the width of smooth bodies' scar along sliding, or of their contact."""
        width = self.counter.form.worn(sum(self.volumes(self.sliding.total)), self.grid.sides)[0]
        if self.hertz is not None:
            width = max(width, 2.0 * self.hertz.semi_axes[0])
        return (self.sliding.stroke or 0.0) / width

    @property
    def fretting(self) -> Fretting | None:
        """Return what drives a fretting contact; None where nothing frets."""
        sliding = self.sliding
        if self.kinematics != "fretting" or sliding.lap is None:
            return None
        return Fretting(
            friction=self.friction.coefficient,
            kappa=self.softness_ratio,
            stroke=sliding.lap,
            force=sliding.force,
            of_body=sliding.stroke_of == "body",
            rig=sliding.rig_compliance,
            has_displacement=self.boundary == "free",
        )

    @property
    def is_rough(self) -> bool:
        """True where the disc's roughness plays a part, resolved or as a bearing curve."""
        return self.study.model != "macro" or self.wear.law == "bearing-curve"

    @property
    def caps_pressure(self) -> bool:
        """True where a hardness limits the pressure of a cell."""
        return math.isfinite(self.hardness)

    @property
    def uses_bearing_area(self) -> bool:
        """True where contacts have no compliance: neither a stiffness nor implicit wear."""
        if self.contact.law == "half-space":
            return False
        worn = self.sliding.total > 0.0 and sum(law.fastest for law in self.wear_laws) > 0.0
        worn = worn and not (self.wear.sheds and self.wear.dust_fraction == 0.0)
        return math.isinf(self.stiffness) and not (self.stepping.scheme == "implicit" and worn)

    @property
    def softer_hardness(self) -> float | None:
        """The smaller of the bodies' hardnesses that are given [MPa]; None where neither is."""
        return min((h for h in (self.counter.hardness, self.disc.hardness) if h is not None), default=None)

    @property
    def indentation_hardness(self) -> float:
        """H of a cell without shear [MPa]: contact.hardness, or for rough cells the softer body's."""
        if self.contact.hardness is not None:
            return self.contact.hardness
        hardness = None if self.study.model == "macro" else self.softer_hardness
        return math.inf if hardness is None else hardness

    @property
    def caps(self) -> tuple[float, float]:
        """Largest pressures of a cell with its film and without [MPa], which growing junctions lower."""
        friction, hardness = self.friction, self.indentation_hardness
        grown = friction.junction_growth, friction.largest_coefficient or math.inf
        bare = grown_cap(hardness, friction.shear_strength or 0.0, *grown)
        if friction.film is None:
            return bare, bare
        return grown_cap(hardness, friction.film.shear_strength, *grown), bare

    @property
    def cell_caps(self) -> tuple[float, ...]:
        """Largest pressures that cells may have [MPa]: `caps`, or of all pairs of materials that may meet.

        The first pair is that of both surfaces.
        """
        if self.profiles is None:
            return self.caps
        counter, disc = ([m.hardness for m in profile.materials] for profile in self.profiles)
        return tuple(min(pair) for pair in itertools.product(counter, disc))

    @property
    def hardness(self) -> float:
        """Largest pressure of any cell [MPa]: that of `cell_caps` which is largest."""
        return max(self.cell_caps)

    @property
    def film(self) -> Film | None:
        """The film that the bodies have; None without one."""
        film = self.friction.film
        return None if film is None else film.with_caps(self.caps, self.friction.shear_strength)

    @property
    def effective_modulus(self) -> float | None:
        """E* of both bodies [MPa]; None where elastic constants are unknown."""
        counter, disc = self.counter.elastic, self.disc.elastic
        return None if counter is None or disc is None else effective_modulus(counter, disc)

    @property
    def resolved(self) -> dict[str, Any]:
        """Map the keys that were left open to what they come to under the choices made."""
        resolved: dict[str, Any] = {
            "contact.hardness": text(self.indentation_hardness, "MPa"),
            "contact.boundary": self.boundary,
            "sliding.kinematics": "fretting" if self.sliding.frets else self.kinematics,
            "stepping.first": text(self.increments[0], "mm"),
            "stepping.growth": self.increments[1],
            "stepping.largest": text(self.increments[2], "mm"),
            "patches.width": text(self.patches.patch_width, "mm"),
        }
        if self.is_swept:
            resolved["sliding.shift"] = self.shift
        if self.sliding.frets:
            resolved["sliding.positions"] = self.positions
        values = self.model_dump()
        return {name: value for name, value in resolved.items() if value_of(values, name) is None}

    @property
    def hertz(self) -> Hertz | None:
        """Hertz's contact before any wear, under the largest load; None for other forms or constants."""
        modulus, form, load = self.effective_modulus, self.counter.form, max(b.load for b in self.blocks)
        if modulus is None or not self.counter.has_hertz:
            return None
        along, across = (1.0 / rise if rise else math.inf for rise in (form.along, form.across))
        # Along which a cylinder lies, it is as long as the domain.
        return Hertz(modulus, along, load, across, self.grid.sides[1 if form.along else 0])

    @property
    def junction_strength(self) -> float | None:
        """Shear strength σ_j of junctions [MPa]: as given, or from the softer body's hardness.

        Not from contact.hardness, which may be fitted to a contact: d* goes with 1/σ_j².
        """
        if self.junctions.strength is not None or self.softer_hardness is None:
            return self.junctions.strength
        return junction_strength(self.softer_hardness)

    @property
    def yield_strength(self) -> float | None:
        """Stress at which the disc yields in tension [MPa]; by default a third of its hardness (Tabor 1951).

        None where neither is known.
        """
        if self.disc.yield_strength is not None:
            return self.disc.yield_strength
        hardness = self.indentation_hardness if self.disc.hardness is None else self.disc.hardness
        return hardness / 3.0 if math.isfinite(hardness) else None

    @property
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

    @property
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

    @property
    def critical_diameter(self) -> float | None:
        """Diameter d* [mm] above which a junction loses pieces: that of pieces, else of eq 2.3, or None."""
        return self.pieces.diameter if self.pieces else self.critical_junction

    @property
    def stiffness(self) -> float:
        """Return the stiffness of a cell before any wear [N/mm³]; p = clip((approach − gap) × it, 0, H).

        It is infinite for a bearing area, and on the half-space, which yields instead.
        """
        if self.contact.law == "half-space":
            return math.inf
        return self.bulk_stiffness() if self.study.model == "macro" else self.contact.stiffness

    def stable_increment(self, wear_coefficient: float) -> float:
        """Return the largest stable increment of explicit Archard wear, 2c/K with c = 1/stiffness [mm].

        Infinite without a foundation: there the step has no stability limit, only an accuracy of K H ΔL.
        wear_coefficient: K of both bodies together [mm²/N].
        """
        if math.isinf(self.stiffness) or wear_coefficient == 0.0:
            return math.inf
        return 2.0 / self.stiffness / wear_coefficient

    def bulk_stiffness(self) -> float:
        """Return K_N [N/mm³] of both bodies' bulk before any wear."""
        stiffness = self.contact.bulk_stiffness
        if not isinstance(stiffness, str):
            return stiffness
        assert self.hertz is not None  # checked with the study
        return self.hertz.foundation(stiffness)

    @property
    def contact_task(self) -> ContactTask:
        """What models, their history and their steps need of this study."""
        return ContactTask(
            load=self.contact.load,
            hardness=self.hardness if self.profiles is None else self.cell_caps[0],
            form=self.counter.form,
            wear=self.surface_laws,
            compliance=1.0 / self.stiffness,
            implicit=self.stepping.scheme == "implicit",
            rigid=self.uses_bearing_area,
            load_tolerance=self.load_tolerance,
            distance_factor=self.wear.distance_factor,
            keeps_dents=self.sliding.plastic == "keep" and math.isfinite(self.hardness),
            bulk_stiffness=self.contact.bulk_stiffness,
            bulk_updated=self.uses_bulk_stiffness and self.contact.bulk_update == "updated",
            uses_bulk_stiffness=self.uses_bulk_stiffness,
            hertz=self.hertz,
            prescribed_loads=self.patches.coupling == "load",
            half_space=self.contact.law == "half-space",
            modulus=self.effective_modulus,
            boundary=self.boundary,
            film=self.film,
            pieces=self.pieces,
            static_area_every=self.static_area_every,
            lap_memory=1.0e6 * self.run.lap_memory,
            area_error=self.stepping.area_error,
            fretting=self.fretting,
            profiles=self.profiles,
            largest_shear=self.largest_shear,
            features=self.features,
        )

    @property
    def features(self) -> dict[str, FeatureLaw]:
        """The laws of features of its sections, by the keys that ask for them."""
        laws = (pair for section in vars(self).values() for pair in getattr(section, "features", {}).items())
        return {name: law for name, law in laws if uses(self, name)}

    @property
    def jumps(self) -> bool:
        """True where a computed cycle may stand for more than itself: of itself not of what acts in steps."""
        return super().jumps and (
            self.stepping.jump != "auto" or all(f.jumps for f in self.features.values())
        )

    @property
    def pieces(self) -> Pieces | None:
        """The pieces by which bodies wear; None where all wear leaves at once."""
        return self.wear.pieces(self.critical_junction)

    @property
    def uses_bulk_stiffness(self) -> bool:
        """True where the stiffness K_N of the bulk plays a part."""
        if self.study.model == "two-scale":
            return self.patches.bulk == "spring" or self.patches.coupling == "load"
        return self.study.model == "macro"

    @property
    def wear_coefficients(self) -> tuple[float, float]:
        """K of counter-body and disc [mm²/N], hardness contained; in the long run, where a law changes it."""
        counter, disc = self.wear_laws
        return counter.steady, disc.steady

    @property
    def wear_laws(self) -> tuple[WearLaw, WearLaw]:
        """The laws by which counter-body and disc wear."""
        return self.wear.laws(self.wear_hardness, self.friction)

    @property
    def surface_laws(self) -> tuple[WearLaw, WearLaw]:
        """The laws by which the unworn surfaces of counter-body and disc wear, which layers may be."""
        profiles = self.profiles or (None, None)
        counter, disc = (
            law if profile is None else replace(law, steady=profile.materials[0].wear)
            for law, profile in zip(self.wear_laws, profiles, strict=True)
        )
        return counter, disc

    @property
    def wears_by_area(self) -> bool:
        """True where cells in contact wear by their shear strength, whatever their pressure."""
        return self.wear.law == "energy" and self.friction.law == "shear-strength"

    @property
    def shears_unalike(self) -> bool:
        """True where the shear of a cell follows from the layers that meet there, or is bounded."""
        return shears_unalike(self.profiles or (), self.largest_shear)

    @property
    def other_shear(self) -> str:
        """Say, behind a shear strength, what shears cells by another one; nothing where none does."""
        film, largest = self.friction.film, self.friction.largest_coefficient
        own = [f", film {film.shear_strength:g} MPa"] if film else []
        own += [", layers by their own"] if shears_unalike(self.profiles or ()) else []
        return "".join([*own, f", at most {largest:g} of the pressure of a cell"] if largest else own)

    @property
    def largest_shear(self) -> float:
        """Largest shear of a cell over its pressure and the bodies' strength [1/MPa]; infinite without."""
        largest, strength = self.friction.largest_coefficient, self.friction.shear_strength
        return largest / strength if largest and strength else math.inf

    @property
    def wear_hardness(self) -> float:
        """Return H of V = k F L / H [MPa]: contact.hardness, or the softer body's."""
        limit = self.contact.hardness
        return (self.softer_hardness or math.inf) if limit is None else limit

    @property
    def load_tolerance(self) -> float:
        """Load that a bearing area may leave unbalanced [N], by default what one cell carries, H h²."""
        tolerance = self.stepping.load_tolerance
        return self.hardness * self.cells.cell_area if tolerance == "one cell" else float(tolerance)
