"""The content of a study: its sections, and what follows from them."""

import math
from typing import Any, Self, TypeVar

from pydantic import Field

from warpwear.grid import Grid
from warpwear.laws.archard import WearLaw
from warpwear.laws.elastic import Hertz, effective_modulus
from warpwear.laws.film import Film, grown_cap
from warpwear.laws.foundation import CappedFoundation
from warpwear.laws.junctions import critical_junction, junction_strength
from warpwear.laws.passes import Block, Laps
from warpwear.laws.patches import Patches
from warpwear.laws.pieces import Pieces
from warpwear.laws.task import ContactTask
from warpwear.laws.track import WHOLE, Track
from warpwear.study.bodies import CounterBody, Disc
from warpwear.study.contact import Contact, Friction, Junctions, LineLoad, Wear
from warpwear.study.keys import Section, key, value_of, when
from warpwear.study.motion import (
    FEWEST_CYCLES,
    MOST_SHIFT,
    STEPS_OF_STROKE,
    BlockSection,
    GridSection,
    Sliding,
    Stepping,
)
from warpwear.study.settings import About, Checks, Output, PatchesSection, Run
from warpwear.study.units import text

#: Parts of the sliding distance after which fields are kept of themselves.
SNAPSHOTS = (0.001, 0.01, 0.1)


#: Blocks of a programme that a sentence names.
NAMED = 5
Loaded = TypeVar("Loaded", Contact, BlockSection)


class Content(Section):
    """The content of a study is its sections of keys, in mm, N, MPa and s, and what follows from them.

    Nothing here checks whether the sections agree: `warpwear.study.rules` does.
    """

    study: About = About()
    counter: CounterBody
    disc: Disc
    contact: Contact
    wear: Wear
    grid: GridSection
    sliding: Sliding
    block: tuple[BlockSection, ...] | None = key(
        None, "programme: blocks of other loads, speeds and lengths, one after another"
    )
    stepping: Stepping = Stepping()
    friction: Friction = Friction()
    junctions: Junctions = Junctions()
    patches: PatchesSection = key(
        PatchesSection(),
        "patches of the two-scale model",
        applies=when(
            "study.model", "two-scale", otherwise="does not apply to the {} model: it has no patches"
        ),
    )
    run: Run = Run()
    checks: Checks = Checks()
    output: Output = Output()
    assumed: dict[str, str] = Field(default={}, description="keys that were assumed, and why")

    def _check(self) -> None:
        """Make a load of a length that of the whole domain, which is known here at first."""
        self.__dict__["contact"] = self._whole(self.contact)
        if self.block is not None:
            self.__dict__["block"] = tuple(self._whole(block) for block in self.block)

    def _whole(self, section: Loaded) -> Loaded:
        """Return a section whose load, where it is one of a length, is that of the whole domain."""
        if not isinstance(section.load, LineLoad):
            return section
        return section.model_copy(update={"load": LineLoad(section.load.per_length, self.grid.sides[1])})

    @property
    def parts(self) -> tuple[Self, ...]:
        """Studies that the blocks of a programme are by themselves; this one alone without a programme."""
        if self.block is None:
            return (self,)
        alone = self.model_copy(update={"block": None})
        loads = (self.contact.load if block.load is None else block.load for block in self.block)
        contacts = (self.contact.model_copy(update={"load": load}) for load in loads)
        slidings = (block.over(self.sliding) for block in self.block)
        return tuple(
            alone.model_copy(update={"contact": contact, "sliding": sliding})
            for contact, sliding in zip(contacts, slidings, strict=True)
        )

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Blocks of the programme, in their order; the whole test is one without a programme."""
        return Block.in_a_row((p.contact.load, p.sliding.total, p.sliding.mean_speed) for p in self.parts)

    @property
    def loads(self) -> str:
        """Return the load, or of a programme the smallest and the largest; of a line that of its length."""
        length, unit = (self.grid.sides[1], "N/mm") if self.is_line else (1.0, "N")
        loads = [block.load / length for block in self.blocks]
        least, most = f"{min(loads):.4g}", f"{max(loads):.4g}"
        return f"{least} {unit}" if least == most else f"{least} to {most} {unit}"

    @property
    def same_load(self) -> float | None:
        """Return the load of the whole test [N]; None where blocks differ in it."""
        loads = {block.load for block in self.blocks}
        return loads.pop() if len(loads) == 1 else None

    @property
    def programme(self) -> str | None:
        """Return the blocks of the programme in words, the first of many; None without a programme."""
        if self.block is None:
            return None
        parts = [f"{block.load:.4g} N over {block.length:.6g} mm" for block in self.blocks]
        return ", ".join(parts[:NAMED]) + (f" and {len(parts) - NAMED} more" if len(parts) > NAMED else "")

    def volume(self, law: WearLaw, distance: float) -> float:
        """Return what a law wears off a body over the test's first distance [mm]: Σ K F ΔL [mm³]."""
        return sum(b.load * law.wear_per_pressure(b.start, b.slides(distance)) for b in self.blocks)

    @property
    def is_rough(self) -> bool:
        """True where the disc's roughness plays a part, resolved or as a bearing curve."""
        return self.study.model != "macro" or self.wear.law == "bearing-curve"

    @property
    def caps_pressure(self) -> bool:
        """True where a hardness limits the pressure of a cell."""
        return math.isfinite(self.hardness)

    @property
    def is_swept(self) -> bool:
        """True where the counter-body slides over a track, false where it stays on the same cells."""
        return self.kinematics == "swept"

    @property
    def kinematics(self) -> str:
        """How the bodies move: as named, else "swept" of the micro model with a stroke or a track radius."""
        slides = self.study.model == "micro" and self.sliding.lap is not None
        return self.sliding.kinematics or ("swept" if slides else "stationary")

    @property
    def shift(self) -> int:
        """Cells that a step of a swept study covers: as named, else what leaves a stroke its least steps.

        Of a track whose length is named it is a divisor, if there is one that is more than half as many.
        """
        sliding, cell, lap = self.sliding, self.grid.cell, self.sliding.lap
        assert lap is not None  # checked with the study
        most = max(1, min(MOST_SHIFT, math.floor(lap / cell / STEPS_OF_STROKE * (1.0 + WHOLE))))
        cells = most if sliding.track == "full" else round(float(sliding.track) / cell)
        fits = (n for n in range(most, most // 2, -1) if cells % n == 0)
        return sliding.shift or next(fits, most)

    @property
    def jumps(self) -> bool:
        """True where a computed cycle of a track may stand for more than itself."""
        if not self.is_swept or self.stepping.jump == 1:
            return False
        if self.stepping.jump != "auto":
            return True
        # Which pieces leave next is another matter in each cycle: no error bounds a jump over them.
        return not self.wear.sheds and self.sliding.total >= FEWEST_CYCLES * self.track.cycle

    @property
    def increments(self) -> tuple[float, float, float]:
        """First increment at rest [mm], the factor by which increments grow, and the largest [mm]."""
        return self.stepping.plan(self.sliding.total)

    @property
    def lap(self) -> float | None:
        """Distance that a pass over the track slides [mm]; None where the disc lies still."""
        return self.sliding.lap if self.is_swept else None

    @property
    def laps(self) -> Laps | None:
        """How the passes of a swept study repeat; None where the disc lies still."""
        return None if self.lap is None else Laps(self.lap, self.sliding.track_radius is None)

    @property
    def track(self) -> Track:
        """The track that a swept study asks for; `rules_track` says whether it may."""
        sliding, cell, shift = self.sliding, self.grid.cell, self.shift
        lap = sliding.lap
        assert lap is not None  # checked with the study
        rotates = sliding.track_radius is not None
        if sliding.track != "full":
            cells = round(float(sliding.track) / cell)
        elif rotates:
            cells = max(1, round(lap / (shift * cell))) * shift
        else:
            cells = round(lap / cell)
        periodic = rotates or sliding.track != "full"
        return Track(cells, shift, cell, self.cells.nx, lap, periodic, not rotates)

    @property
    def patch_layout(self) -> Patches:
        """The places of the patches that a two-scale study asks for."""
        domain, patches = self.cells, self.patches
        pitch, side = round(patches.macro_cell / domain.cell), round(patches.patch_width / domain.cell)
        seed = patches.seed if patches.placement == "random" else None
        return Patches.laid_out(domain, pitch=pitch, side=side, seed=seed)

    @property
    def uses_bearing_area(self) -> bool:
        """True where contacts have no compliance: neither a stiffness nor implicit wear."""
        if self.contact.law == "half-space":
            return False
        worn = self.sliding.total > 0.0 and sum(law.fastest for law in self.wear_laws) > 0.0
        worn = worn and not (self.wear.sheds and self.wear.dust_fraction == 0.0)
        return self.contact_law().compliance == 0.0 and not (self.stepping.scheme == "implicit" and worn)

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
        bare = grown_cap(hardness, friction.shear_strength or 0.0, friction.junction_growth)
        if friction.film is None:
            return bare, bare
        return grown_cap(hardness, friction.film.shear_strength, friction.junction_growth), bare

    @property
    def hardness(self) -> float:
        """Largest pressure of any cell [MPa]: that of `caps` which is larger."""
        return max(self.caps)

    @property
    def film(self) -> Film | None:
        """The film that the bodies have; None without one."""
        film, hardness = self.friction.film, self.hardness
        if film is None:
            return None
        on = film.bodies in ("both", "counter"), film.bodies in ("both", "disc")
        regrowth = math.inf if isinstance(film.regrowth, str) else film.regrowth
        parts = [1.0 if cap == hardness else cap / hardness for cap in self.caps]
        return Film(film.thickness, on, regrowth, *parts)

    @property
    def effective_modulus(self) -> float | None:
        """E* of both bodies [MPa]; None where elastic constants are unknown."""
        counter, disc = self.counter.elastic, self.disc.elastic
        return None if counter is None or disc is None else effective_modulus(counter, disc)

    @property
    def boundary(self) -> str:
        """Boundary of the half-space, or of every patch: "free", "periodic" or "line"."""
        whole_counter = not self.counter.form.is_flat and self.study.model != "two-scale"
        return self.contact.boundary or ("free" if whole_counter else "periodic")

    @property
    def is_line(self) -> bool:
        """True where the contact goes on across sliding beyond the domain, which is a part of its length."""
        along, across = self.counter.form.rises
        if self.contact.law == "half-space":
            return self.boundary == "line"
        return along and not across and self.study.model != "two-scale"

    @property
    def repeats(self) -> bool:
        """True where the domain, with the counter-body, is repeated beside itself."""
        elastic = self.contact.law == "half-space" and self.study.model == "micro"
        return elastic and self.boundary == "periodic"

    @property
    def resolved(self) -> dict[str, Any]:
        """Map the keys that were left open to what they come to under the choices made."""
        resolved: dict[str, Any] = {
            "contact.hardness": text(self.indentation_hardness, "MPa"),
            "contact.boundary": self.boundary,
            "sliding.kinematics": self.kinematics,
            "stepping.largest": text(self.increments[2], "mm"),
            "patches.width": text(self.patches.patch_width, "mm"),
        }
        if self.is_swept:
            resolved["sliding.shift"] = self.shift
        values = self.model_dump()
        return {name: value for name, value in resolved.items() if value_of(values, name) is None}

    @property
    def hertz(self) -> Hertz | None:
        """Hertz's contact before any wear, under the largest load; None for other forms or constants."""
        modulus, form, load = self.effective_modulus, self.counter.form, max(b.load for b in self.blocks)
        if modulus is None or not self.counter.has_hertz:
            return None
        if form.along == form.across:
            return Hertz(modulus, 1.0 / form.along, load)
        radii = (1.0 / curvature if curvature else math.inf for curvature in (form.along, form.across))
        # Along which a cylinder lies, it is as long as the domain.
        along, across = radii
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
    def shear_limit(self) -> float:
        """Shear strength of the softer body [MPa]; of contact.hardness where no body's is known.

        H/(3√3), or H/√α where junctions grow: there a cell under that shear bears no pressure.
        """
        growth = self.friction.junction_growth
        softer = self.indentation_hardness if self.softer_hardness is None else self.softer_hardness
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

    def contact_law(self) -> CappedFoundation:
        """Return the law of a cell before any wear."""
        stiffness = self.bulk_stiffness() if self.study.model == "macro" else self.contact.stiffness
        if self.contact.law == "half-space":
            stiffness = math.inf  # what yields is the half-space
        return CappedFoundation(stiffness=stiffness, hardness=self.hardness)

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
            hardness=self.hardness,
            form=self.counter.form,
            wear=self.wear_laws,
            compliance=self.contact_law().compliance,
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
        )

    @property
    def static_area_every(self) -> int:
        """Steps between contacts that are also solved without wear in the step; 0 where none are."""
        elastic = self.contact.law == "half-space" and self.study.model == "micro"
        return self.output.static_area_every if elastic else 0

    @property
    def pieces(self) -> Pieces | None:
        """The pieces by which bodies wear; None where all wear leaves at once."""
        wear = self.wear
        diameter = self.critical_junction if wear.particle == "critical" else wear.particle
        if diameter is None or wear.particle_thickness is None:
            return None
        seed = wear.pending_seed if wear.pending_start == "uniform" else None
        return Pieces(float(diameter), wear.particle_thickness, wear.dust_fraction, seed)

    @property
    def uses_bulk_stiffness(self) -> bool:
        """True where the stiffness K_N of the bulk plays a part."""
        if self.study.model == "two-scale":
            return self.patches.bulk == "spring" or self.patches.coupling == "load"
        return self.study.model == "macro"

    @property
    def samples_area(self) -> bool:
        """True where patches stand for more than themselves, and fields cover only a part of the domain."""
        return self.study.model == "two-scale" and self.patches.patch_width < self.patches.macro_cell

    @property
    def places_at_random(self) -> bool:
        """True where patches that stand for more than themselves lie at random in their macro cells."""
        return self.samples_area and self.patches.placement == "random"

    @property
    def wear_coefficients(self) -> tuple[float, float]:
        """K of counter-body and disc [mm²/N], hardness contained; in the long run, where a law changes it."""
        counter, disc = self.wear_laws
        return counter.steady, disc.steady

    @property
    def wear_laws(self) -> tuple[WearLaw, WearLaw]:
        """The laws by which counter-body and disc wear."""
        return self.wear.laws(self.wear_hardness, self.friction.coefficient)

    @property
    def wear_hardness(self) -> float:
        """Return H of V = k F L / H [MPa]: contact.hardness, or the softer body's."""
        limit = self.contact.hardness
        return (self.softer_hardness or math.inf) if limit is None else limit

    @property
    def cells(self) -> Grid:
        """The grid of cells that the study asks for."""
        nx, ny = (round(side / self.grid.cell) for side in self.grid.sides)
        return Grid(nx, ny, self.grid.cell)

    @property
    def snapshot_distances(self) -> tuple[float, ...]:
        """Sliding distances [mm] that fields are kept at, or where the next step ends, beside the end."""
        snapshots = self.output.snapshots
        return tuple(part * self.sliding.total for part in SNAPSHOTS) if snapshots == "auto" else snapshots

    @property
    def load_tolerance(self) -> float:
        """Load that a bearing area may leave unbalanced [N], by default what one cell carries, H h²."""
        tolerance = self.stepping.load_tolerance
        return self.hardness * self.cells.cell_area if tolerance == "one cell" else float(tolerance)
