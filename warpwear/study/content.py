"""The content of a study: which keys it gives, uses and assumes, and what models need of its sections."""

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from warpwear.errors import printable
from warpwear.laws.archard import BODIES
from warpwear.laws.friction import LAP, FrictionLaw
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.study.bodies import CONSTANTS, HEAT
from warpwear.study.keys import TABLES, Section, attribute_of, declarations, is_given
from warpwear.study.materials import material
from warpwear.study.movement import Movement
from warpwear.study.units import text

#: Depths below the surface at which stresses are computed of themselves.
STRESS_DEPTHS = 20


class Content(Movement):
    """The content of a study is its sections, how its bodies move, and what else follows from them."""

    @cached_property
    def given_keys(self) -> set[str]:
        """The dotted names of the keys that were given, not left open or to their defaults."""
        names = {name for name in declarations(type(self)) if is_given(self, name)}
        return {name for name in names if not isinstance(attribute_of(self, name), Section)}

    @cached_property
    def unused_keys(self) -> dict[str, str]:
        """Map keys that nothing uses under the choices made to the end of a sentence that says why."""
        keys = declarations(type(self)).items()
        return {name: why for name, declared in keys if (why := declared.why_not(self))}

    @cached_property
    def used_keys(self) -> dict[str, Any]:
        """Map the keys that something uses to what they come to, as text with units; sections come last."""
        content = self.model_dump(exclude={"assumed"})
        for name, value in self.resolved.items():
            section, _, last = name.partition(".")
            content[section][last] = value
        # Of a material's constants some need no place unless a column is kept that goes by them.
        needed = {"flash": HEAT, "conductance": ("conductivity", "resistivity")}
        needless = {*HEAT, "resistivity"}.difference(*(needed.get(name, ()) for name in self.output.joint))
        left = {f"{body}.{name}" for body in BODIES for name in needless} - self.given_keys

        def walk(prefix: str, content: dict[str, Any]) -> Iterator[tuple[str, Any]]:
            names = sorted(content, key=lambda one: (isinstance(content[one], dict), prefix + one in TABLES))
            for name, value in ((prefix + one, content[one]) for one in names):
                if isinstance(value, dict):
                    yield from walk(f"{name}.", value)
                elif value is not None and name not in self.unused_keys and name not in left:
                    tables = attribute_of(self, name) if name in TABLES else ()
                    yield name, [table.model_dump(exclude_none=True) for table in tables] or value

        return dict(walk("", content))

    @cached_property
    def assumptions(self) -> dict[str, str]:
        """Map keys to why they were assumed, in the study's own words or by a default that is a choice."""
        given, reasons = self.given_keys, {}
        for name in self.used_keys:
            body, _, constant = name.partition(".")
            if name in self.assumed:
                reasons[name] = printable(self.assumed[name])
            elif name in given:
                continue
            elif body != "contact" and constant in CONSTANTS:
                known = material(getattr(self, body).material)
                reasons[name] = f"{known.name}, {known.condition}: {known.sources[constant]}"
            elif assumed := declarations(type(self))[name].assumed:
                reasons[name] = assumed
        return reasons

    @property
    def files(self) -> dict[str, str]:
        """Map the keys by which the study names files that it uses to the paths of these."""
        named = [name for name, key in declarations(type(self)).items() if key.is_file]
        paths = {name: attribute_of(self, name) for name in named if name not in self.unused_keys}
        return {name: path for name, path in paths.items() if path}

    @property
    def hardness(self) -> float:
        """Largest pressure of any cell [MPa]."""
        return self.pair.hardness

    @property
    def friction_law(self) -> FrictionLaw:
        """The law by which cells shear."""
        return self.friction_law_with({})

    def friction_law_with(self, values: Mapping[str, Any]) -> FrictionLaw:
        """Return the law by which friction follows from a history. values: as of `Wear.laws`."""
        return self.friction.law_with({f"friction.{LAP}": self.cycle, **values})

    @property
    def wear_coefficients(self) -> tuple[float, float]:
        """K of counter-body and disc [mm²/N], hardness contained; in the long run, where a law changes it."""
        return self.pair.wear_coefficients

    @property
    def samples_area(self) -> bool:
        """True where patches stand for more than themselves, and fields cover only a part of the domain."""
        return self.study.model == "two-scale" and self.patches.patch_width < self.patches.macro_cell

    @property
    def has_stresses(self) -> bool:
        """True where stresses below the surface are computed."""
        return self.output.stress_depths is not None

    @property
    def stress_depths(self) -> tuple[float, ...]:
        """Depths at which stresses are computed [mm], rising; none where they are not."""
        depths, cell = self.output.stress_depths, self.grid.cell
        if depths != "auto":
            return depths or ()
        half = 0.5 * min(self.grid.sides[: 1 if self.is_line else 2])
        return 0.0, *np.geomspace(cell, max(half, 2.0 * cell), STRESS_DEPTHS).tolist()

    @property
    def patch_layout(self) -> Patches:
        """The places of the patches that a two-scale study asks for."""
        domain, patches = self.cells, self.patches
        pitch, side = round(patches.macro_cell / domain.cell), round(patches.patch_width / domain.cell)
        seed = patches.seed if patches.placement == "random" else None
        return Patches.laid_out(domain, pitch=pitch, side=side, seed=seed)

    @property
    def strip(self) -> float | None:
        """Length of a line that areas, volumes, forces and energies are those of [mm]; None of what ends."""
        return self.grid.sides[1] if self.is_line else None

    @property
    def repeats(self) -> bool:
        """True where the domain, with the counter-body, is repeated beside itself."""
        elastic = self.contact.law == "half-space" and self.study.model == "micro"
        return elastic and self.boundary == "periodic"

    @property
    def is_rough(self) -> bool:
        """True where the disc's roughness plays a part, resolved or as a bearing curve."""
        return self.study.model != "macro" or self.wear.law == "bearing-curve"

    @property
    def uses_bearing_area(self) -> bool:
        """True where contacts have no compliance: neither a stiffness nor implicit wear."""
        if self.contact.law == "half-space":
            return False
        worn = self.sliding.total > 0.0 and sum(law.fastest for law in self.wear_laws) > 0.0
        worn = worn and not (self.wear.sheds and self.wear.dust_fraction == 0.0)
        return math.isinf(self.pair.stiffness) and not (self.stepping.scheme == "implicit" and worn)

    @property
    def resolved(self) -> dict[str, Any]:
        """Map the keys that were left open to what they come to under the choices made."""
        resolved: dict[str, Any] = {
            "contact.hardness": text(self.pair.indentation_hardness, "MPa"),
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
        return {name: value for name, value in resolved.items() if attribute_of(self, name) is None}

    @property
    def contact_task(self) -> ContactTask:
        """What models, their history and their steps need of this study."""
        pair, elastic = self.pair, self.contact.law == "half-space" and self.study.model == "micro"
        return ContactTask(
            load=self.contact.load,
            hardness=pair.hardness if pair.profiles is None else pair.cell_caps[0],
            form=self.counter.form,
            wear=pair.surface_laws,
            compliance=1.0 / pair.stiffness,
            implicit=self.stepping.scheme == "implicit",
            rigid=self.uses_bearing_area,
            load_tolerance=self.load_tolerance,
            distance_factor=self.wear.distance_factor,
            keeps_dents=self.sliding.plastic == "keep" and math.isfinite(pair.hardness),
            bulk_stiffness=self.contact.bulk_stiffness,
            bulk_updated=pair.uses_bulk_stiffness and self.contact.bulk_update == "updated",
            uses_bulk_stiffness=pair.uses_bulk_stiffness,
            hertz=pair.hertz,
            prescribed_loads=self.patches.coupling == "load",
            half_space=self.contact.law == "half-space",
            modulus=pair.effective_modulus,
            boundary=self.boundary,
            film=pair.film,
            pieces=pair.pieces,
            static_area_every=self.output.static_area_every if elastic else 0,
            lap_memory=1.0e6 * self.run.lap_memory,
            area_error=self.stepping.area_error,
            fretting=self.fretting,
            profiles=pair.profiles,
            largest_shear=pair.largest_shear,
            features=self.features,
        )

    @property
    def load_tolerance(self) -> float:
        """Load that a bearing area may leave unbalanced [N], by default what one cell carries, H h²."""
        tolerance = self.stepping.load_tolerance
        return self.hardness * self.cells.cell_area if tolerance == "one cell" else float(tolerance)
