"""A study: what to compute, read from TOML, checked, frozen."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import Field, ValidationError, model_validator

from warpwear import consistency, render, track_checks, unused_keys
from warpwear.contact import CappedFoundation
from warpwear.defaults import fill
from warpwear.description import is_described, with_changes
from warpwear.errors import InputError
from warpwear.grid import Grid
from warpwear.hertz import Hertz, effective_modulus
from warpwear.junctions import critical_junction, junction_strength
from warpwear.keys import Section
from warpwear.messages import sentence
from warpwear.quantities import text
from warpwear.sections_bodies import Disc, Sphere
from warpwear.sections_contact import ArchardCoefficient, Contact, Friction, Junctions, Wear
from warpwear.sections_run import About, Checks, Macro, Output, Run
from warpwear.sections_sliding import GridSection, Sliding, Stepping
from warpwear.study_changes import change, value_of
from warpwear.study_file import read_sections
from warpwear.wear import WearLaw


class Study(Section):
    """One study: sections of keys (see `warpwear.keys`), each number in mm, N, MPa or s.

    Make one with `Study.load(path_or_preset)` or from sections: `Study(sphere={"radius": "3 mm"}, ...)`.
    Frozen; `replace` gives a changed copy. Raises InputError for anything that cannot be computed.
    """

    study: About = About()
    sphere: Sphere
    disc: Disc
    contact: Contact
    wear: Wear
    grid: GridSection
    sliding: Sliding
    stepping: Stepping = Stepping()
    friction: Friction = Friction()
    junctions: Junctions = Junctions()
    macro: Macro = Macro()
    run: Run = Run()
    checks: Checks = Checks()
    output: Output = Output()
    assumed: dict[str, str] = Field(default={}, description="keys that were assumed, and why")

    def __init__(self, **sections: Any) -> None:
        filled, names = fill(sections)
        try:
            super().__init__(**filled)
        except ValidationError as error:
            raise InputError(sentence(error, type(self))) from error
        for name in names:  # so that they are told from what was given
            section, _, key = name.partition(".")
            getattr(self, section).model_fields_set.discard(key)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        consistency.check(self)
        return self

    @property
    def is_swept(self) -> bool:
        """Whether the sphere slides over a track, or stays on the same cells of the disc."""
        return self.sliding.kinematics == "swept"

    @property
    def lap(self) -> float | None:
        """What is slid in a pass over the track [mm]; None where the disc lies still."""
        return self.sliding.lap if self.is_swept else None

    @property
    def uses_bearing_area(self) -> bool:
        """Whether contacts have no compliance: neither a foundation nor implicit wear."""
        if self.contact.law == "half-space":
            return False
        worn = self.sliding.total > 0.0 and sum(law.fastest for law in self.wear_laws) > 0.0
        return self.law().compliance == 0.0 and not (self.stepping.scheme == "implicit" and worn)

    @property
    def softer_hardness(self) -> float | None:
        """Hardness of the softer body [MPa], of those that are given."""
        return min((h for h in (self.sphere.hardness, self.disc.hardness) if h is not None), default=None)

    @property
    def hardness(self) -> float:
        """Largest pressure of a cell [MPa]: contact.hardness, or the softer body's for rough cells."""
        if self.contact.hardness is not None:
            return self.contact.hardness
        found = None if self.study.model == "macro" else self.softer_hardness
        return math.inf if found is None else found

    @property
    def effective_modulus(self) -> float | None:
        """E* of both bodies [MPa], where their elastic constants are known."""
        sphere, disc = self.sphere.elastic, self.disc.elastic
        return None if sphere is None or disc is None else effective_modulus(sphere, disc)

    @property
    def boundary(self) -> str:
        """Of the half-space, or of every patch: "free" or "periodic"."""
        whole_sphere = self.sphere.curvature and self.study.model != "two-scale"
        return self.contact.boundary or ("free" if whole_sphere else "periodic")

    @property
    def resolved(self) -> dict[str, str]:
        """Keys that were left open -> what they come to under the choices made, as text."""
        found = {
            "contact.hardness": text(self.hardness, "MPa"),
            "contact.boundary": self.boundary,
            "macro.patch": text(self.macro.patch_width, "mm"),
        }
        values = self.model_dump()
        return {name: value for name, value in found.items() if value_of(values, name) is None}

    @property
    def hertz(self) -> Hertz | None:
        """Hertz's contact of the bodies before any wear, where their elastic constants are known."""
        modulus, curvature = self.effective_modulus, self.sphere.curvature
        if modulus is None or curvature == 0.0:
            return None
        return Hertz(modulus, 1.0 / curvature, self.contact.load)

    @property
    def junction_strength(self) -> float | None:
        """Shear strength σ_j of junctions [MPa]: as given, or from the softer body's hardness.

        Not from contact.hardness, which may be fitted to a contact: d* goes with 1/σ_j².
        """
        if self.junctions.strength is not None or self.softer_hardness is None:
            return self.junctions.strength
        return junction_strength(self.softer_hardness)

    @property
    def critical_junction(self) -> float | None:
        """Diameter d* [mm] below which junctions of the softer body smooth out, if all it needs is known."""
        energy, strength = self.junctions.surface_energy, self.junction_strength
        softer = self.sphere if self.sphere.hardness == self.softer_hardness else self.disc
        if energy is None or strength is None or softer.elastic is None:
            return None
        young, poisson = softer.elastic
        shear_modulus = young / (2.0 * (1.0 + poisson))
        return critical_junction(
            surface_energy=energy, shear_modulus=shear_modulus, poisson=poisson, strength=strength
        )

    def law(self, *, radius: float | None = None) -> CappedFoundation:
        """The law of a cell. radius: of the area in contact [mm], for a foundation that follows it."""
        macro = self.study.model == "macro"
        stiffness = self.foundation(radius=radius) if macro else self.contact.stiffness
        if self.contact.law == "half-space":
            stiffness = math.inf  # what yields is the half-space
        return CappedFoundation(stiffness=stiffness, hardness=self.hardness)

    def foundation(self, *, radius: float | None = None) -> float:
        """K_N of the macro contact [N/mm³]. radius: of the contact [mm], for a foundation that follows it."""
        stiffness = self.contact.foundation
        if isinstance(stiffness, str):
            assert self.hertz is not None  # checked with the study
            follows = self.contact.foundation_update == "updated"
            stiffness = self.hertz.foundation(stiffness, radius=radius if follows else None)
        return stiffness

    @property
    def uses_foundation(self) -> bool:
        """Whether K_N plays a part."""
        if self.study.model == "two-scale":
            return self.macro.bulk == "foundation" or self.macro.coupling == "load"
        return self.study.model == "macro"

    @property
    def samples_area(self) -> bool:
        """Whether patches stand for more than themselves, so that fields cover only a part of the domain."""
        return self.study.model == "two-scale" and self.macro.patch_width < self.macro.cell

    @property
    def wear_coefficients(self) -> tuple[float, float]:
        """K of sphere and disc [mm²/N], hardness contained; in the long run, where a law changes it."""
        sphere, disc = self.wear_laws
        return sphere.steady, disc.steady

    @property
    def wear_laws(self) -> tuple[WearLaw, WearLaw]:
        """Of sphere and disc."""
        wear, given = self.wear, self.contact.hardness
        hardness = (self.softer_hardness or math.inf) if given is None else given

        def of(steady: ArchardCoefficient, initial: ArchardCoefficient | None) -> WearLaw:
            known = steady.resolved(hardness)
            if wear.law == "exponential":
                return WearLaw(known, decay=wear.decay)
            if wear.law == "running-in":
                at_first = initial.resolved(hardness) if initial else known
                return WearLaw(known, initial=at_first, running_in=wear.running_in)
            return WearLaw(known)

        return of(wear.sphere, wear.initial_sphere), of(wear.disc, wear.initial_disc)

    @property
    def cells(self) -> Grid:
        """The grid of cells."""
        n = round(self.grid.extent / self.grid.cell)
        return Grid(n, n, self.grid.cell)

    @property
    def load_tolerance(self) -> float:
        """Load that a bearing area may leave unbalanced [N]; one cell carries H h²."""
        asked = self.stepping.load_tolerance
        return self.hardness * self.cells.cell_area if asked == "one cell" else float(asked)

    def notices(self) -> list[str]:
        """What is given but not used, and what is asked for but cannot be trusted, each as a sentence."""
        total = self.sliding.total
        found = [*unused_keys.told(self), *track_checks.doubts(self)]
        late = ", ".join(f"{s:g}" for s in self.output.snapshots if s > total or s == 0.0 < total)
        if late:
            found.append(f"output.snapshots that no step ends at: {late} mm.")
        return [*found, *consistency.doubts(self)]

    def to_toml(self) -> str:
        """The whole study after defaults, as TOML that `load` reads back without loss."""
        return render.to_toml(self)

    @classmethod
    def load(cls, path_or_preset: str | Path) -> Self:
        """The study in a TOML file, or the preset of that name. Raises InputError."""
        return cls(**read_sections(path_or_preset))

    def replace(self, changes: Mapping[str, Any] | None = None, /, **sections: Mapping[str, Any]) -> Self:
        """A copy with keys changed: {"grid.cell": "2 um"}, or by section: grid={"cell": "2 um"}.

        A key that says the same in another way is dropped: a new sphere.diameter replaces sphere.radius. A
        description that is not set itself tells what has changed.
        """
        flat = dict(changes or {})
        for section, keys in sections.items():
            flat |= {f"{section}.{k}": v for k, v in keys.items()}
        nested = self.model_dump(exclude_unset=True)
        change(nested, flat)
        found = type(self)(**nested)
        if not self.study.description or "study.description" in flat:
            return found
        before, after = self.model_dump(), found.model_dump()
        changed = [
            name for name in flat if is_described(name) and value_of(before, name) != value_of(after, name)
        ]
        told = with_changes(self.study.description, changed)
        return found.model_copy(update={"study": found.study.model_copy(update={"description": told})})
