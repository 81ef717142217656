"""A study: what to compute, read from TOML, checked, frozen."""

import math
import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from importlib import resources
from pathlib import Path
from typing import Any, Self

from pydantic import Field, ValidationError, model_validator

from warpwear import consistency, render, track_checks
from warpwear.contact import CappedFoundation
from warpwear.defaults import CONSTANTS, fill
from warpwear.description import is_described, with_changes
from warpwear.errors import InputError
from warpwear.grid import Grid
from warpwear.hertz import Hertz, effective_modulus
from warpwear.junctions import critical_junction, junction_strength
from warpwear.messages import sentence
from warpwear.quantities import text
from warpwear.schema import given_keys
from warpwear.sections import (
    About,
    ArchardCoefficient,
    Checks,
    Contact,
    Disc,
    Friction,
    GridSection,
    Junctions,
    Macro,
    Output,
    Run,
    Section,
    Sliding,
    Sphere,
    Stepping,
    Synthetic,
    Wear,
)
from warpwear.wear import WearLaw

#: Keys that say the same in different ways. Setting one with `replace` drops the others.
ALTERNATIVES: tuple[tuple[frozenset[str], ...], ...] = (
    (frozenset({"sphere.radius"}), frozenset({"sphere.diameter"})),
    (frozenset({"disc.surface"}), frozenset({"disc.synthetic"})),
    (frozenset({"disc.synthetic.ra"}), frozenset({"disc.synthetic.sq"})),
    (
        frozenset({"sliding.distance"}),
        frozenset({"sliding.passes"}),
        frozenset({"sliding.cycles"}),
        frozenset({"sliding.duration", "sliding.frequency"}),
        frozenset({"sliding.revolutions"}),
    ),
    (frozenset({"sliding.stroke"}), frozenset({"sliding.track_radius"})),
    (
        frozenset({"stepping.increment"}),
        frozenset({"stepping.first", "stepping.growth", "stepping.largest"}),
    ),
    (
        frozenset({"friction.shear_strength"}),
        frozenset({"friction.coefficient", "friction.calibrate"}),
    ),
)

#: Keys of [disc] that say how a measured file is read and prepared.
OF_FILES = (
    "extend",
    "pixel",
    "height_unit",
    "array",
    "height_sign",
    "crop",
    "sliding_axis",
    "outliers",
    "level",
    "s_filter",
    "l_filter",
)

#: Keys of [wear] -> the law that has them.
OF_WEAR_LAWS = {
    "decay": "exponential",
    "running_in": "running-in",
    "initial_sphere": "running-in",
    "initial_disc": "running-in",
}

UNUSED_BY_KIND: dict[str, tuple[str, ...]] = {
    "flat": ("ra", "sq", "hurst", "roll_off", "cut_off", "seed", "period", "feed", "fine_ra", "lay"),
    "self-affine": ("feed", "fine_ra", "lay"),
    "milled": (),
}


class Study(Section):
    """One study: sections of keys (see `warpwear.sections`), each number in mm, N, MPa or s.

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
        return {name: value for name, value in found.items() if _value(values, name) is None}

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

    def inapplicable(self) -> dict[str, str]:
        """Keys that nothing uses under the choices made -> why, as the end of a sentence."""
        found: dict[str, str] = {}
        macro = self.study.model == "macro"
        synthetic = self.disc.synthetic
        if macro and self.wear.law != "bearing-curve":
            of_surface = [f"disc.{k}" for k in ("surface", *OF_FILES)]
            of_surface += [f"disc.synthetic.{k}" for k in Synthetic.model_fields]
            found |= dict.fromkeys(of_surface, "does not apply to the macro model, which has a smooth disc")
        elif synthetic is not None:
            why = f"does not apply to kind = '{synthetic.kind}'"
            found |= dict.fromkeys((f"disc.synthetic.{k}" for k in UNUSED_BY_KIND[synthetic.kind]), why)
            found |= dict.fromkeys((f"disc.{k}" for k in OF_FILES), "does not apply to a synthetic surface")
        if macro:
            found["contact.stiffness"] = "does not apply to the macro model: its K_N is contact.foundation"
        if self.study.model != "two-scale":
            of_patches = [f"macro.{k}" for k in Macro.model_fields]
            found |= dict.fromkeys(
                of_patches, f"does not apply to the {self.study.model} model: it has no patches"
            )
        else:
            if self.macro.patch_width == self.macro.cell:
                found["macro.placement"] = "does not apply: the patches tile the contact"
            if self.macro.patch_width == self.macro.cell or self.macro.placement == "centre":
                found["macro.seed"] = "does not apply: no patch is placed at random"
            if self.macro.coupling == "load":
                found["macro.bulk"] = "does not apply to macro.coupling = 'load', whose macro contact has K_N"
        if not self.uses_foundation:
            of_macro = ("contact.foundation", "contact.foundation_update")
            why = "the micro model" if self.study.model == "micro" else "macro.bulk = 'none'"
            found |= dict.fromkeys(of_macro, f"does not apply to {why}")
        if self.contact.law == "half-space":
            found["contact.stiffness"] = (
                "does not apply to contact.law = 'half-space': E* of both bodies does"
            )
        else:
            found["contact.boundary"] = "does not apply to contact.law = 'foundation'"
        for name, law in OF_WEAR_LAWS.items():
            if law != self.wear.law:
                found[f"wear.{name}"] = f"does not apply to wear.law = '{self.wear.law}'"
        if not self.uses_bearing_area:
            found["stepping.load_tolerance"] = "does not apply: with compliance the balance holds to 1e-12"
        found |= track_checks.inapplicable(self)
        if self.stepping.increment is not None and not self.is_swept:
            growing = ("stepping.first", "stepping.growth", "stepping.largest")
            found |= dict.fromkeys(growing, "does not apply to a fixed stepping.increment")
        if self.friction.shear_strength is not None:
            measured = ("friction.coefficient", "friction.calibrate")
            found |= dict.fromkeys(measured, "does not apply with a friction.shear_strength")
        return found

    def notices(self) -> list[str]:
        """What is given but not used, and what is asked for but cannot be trusted, each as a sentence."""
        given = given_keys(self)
        reasons: dict[str, list[str]] = {}
        for key, why in self.inapplicable().items():
            if key in given:
                reasons.setdefault(why, []).append(key)
        found = [
            f"{', '.join(keys)} {why if len(keys) == 1 else why.replace('does not', 'do not', 1)}."
            for why, keys in reasons.items()
        ]
        total = self.sliding.total
        found += track_checks.doubts(self)
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
        if str(path_or_preset) in presets():
            source = resources.files("warpwear") / "presets" / f"{path_or_preset}.toml"
            return cls(**tomllib.loads(source.read_text(encoding="utf-8")))
        path = Path(path_or_preset)
        try:
            if path.is_dir():
                if not (path / "study.toml").is_file():
                    raise InputError(f"STUDY = '{path}' is a folder without a study.toml.")
                path = path / "study.toml"
            sections = tomllib.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise InputError(_no_such_study(str(path_or_preset))) from None
        except OSError as error:
            raise InputError(f"{str(path)[:200]} cannot be read: {error.strerror}.") from error
        except UnicodeDecodeError as error:
            raise InputError(f"{path} is not text, which a study is.") from error
        except (
            ValueError,
            RecursionError,
        ) as error:  # TOMLDecodeError, numbers of thousands of digits, nesting
            raise InputError(f"{path} is not TOML: {error}.") from error
        surface = sections.get("disc", {}).get("surface") if isinstance(sections.get("disc"), dict) else None
        if isinstance(surface, str):
            sections["disc"]["surface"] = str(path.parent.resolve() / surface)
        return cls(**sections)

    def replace(self, changes: Mapping[str, Any] | None = None, /, **sections: Mapping[str, Any]) -> Self:
        """A copy with keys changed: {"grid.cell": "2 um"}, or by section: grid={"cell": "2 um"}.

        A key that says the same in another way is dropped: a new sphere.diameter replaces sphere.radius. A
        description that is not set itself tells what has changed.
        """
        flat = dict(changes or {})
        for section, keys in sections.items():
            flat |= {f"{section}.{k}": v for k, v in keys.items()}
        nested = self.model_dump(exclude_unset=True)
        for name, value in flat.items():
            for other in _dropped_by(name) - set(flat):
                _remove(nested, other)
            _insert(nested, name, value)
            assumed = nested.get("assumed")
            if not isinstance(assumed, dict):
                continue
            replaced = {name} | _dropped_by(name)
            for key in [k for k in assumed if k in replaced or k.startswith(f"{name}.")]:
                del assumed[key]
        found = type(self)(**nested)
        if not self.study.description or "study.description" in flat:
            return found
        before, after = self.model_dump(), found.model_dump()
        changed = [
            name for name in flat if is_described(name) and _value(before, name) != _value(after, name)
        ]
        told = with_changes(self.study.description, changed)
        return found.model_copy(update={"study": found.study.model_copy(update={"description": told})})


def presets() -> list[str]:
    """Names of the presets."""
    folder = resources.files("warpwear") / "presets"
    return sorted(p.name.removesuffix(".toml") for p in folder.iterdir() if p.name.endswith(".toml"))


def _no_such_study(name: str) -> str:
    near = get_close_matches(name, presets(), n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return f"STUDY = '{name}' is neither a file nor a preset ({', '.join(presets())}).{hint}"


def _dropped_by(name: str) -> set[str]:
    """Keys that a new value of this one makes void."""
    body, _, key = name.partition(".")
    if key == "material":  # another material has other constants
        return {f"{body}.{constant}" for constant in CONSTANTS}
    for group in ALTERNATIVES:
        for way in group:
            if any(name == k or name.startswith(k + ".") for k in way):
                return set().union(*group) - way
    return set()


def _insert(nested: dict[str, Any], name: str, value: Any) -> None:
    *parents, last = name.split(".")
    for depth, parent in enumerate(parents):
        nested = nested.setdefault(parent, {})
        if not isinstance(nested, dict):
            raise InputError(f"'{name}' is no key: {'.'.join(parents[: depth + 1])} has none below it.")
    nested[last] = value


def _value(nested: Any, name: str) -> Any:
    for part in name.split("."):
        nested = nested.get(part) if isinstance(nested, dict) else None
    return nested


def _remove(nested: dict[str, Any], name: str) -> None:
    *parents, last = name.split(".")
    for parent in parents:
        nested = nested.get(parent, {})
        if not isinstance(nested, dict):
            return
    nested.pop(last, None)
