"""A study: what to compute, read from TOML, checked, frozen."""

import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from importlib import resources
from pathlib import Path
from typing import Any, Self

from pydantic import Field, ValidationError, model_validator

from warpwear import render
from warpwear.consistency import check
from warpwear.contact import CappedFoundation
from warpwear.errors import InputError
from warpwear.grid import Grid
from warpwear.messages import sentence
from warpwear.schema import given_keys
from warpwear.sections import (
    About,
    Checks,
    Contact,
    Disc,
    Friction,
    GridSection,
    Output,
    Section,
    Sliding,
    Sphere,
    Stepping,
    Wear,
)

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
    ),
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
    checks: Checks = Checks()
    output: Output = Output()
    assumed: dict[str, str] = Field(default={}, description="keys that were assumed, and why")

    def __init__(self, **sections: Any) -> None:
        try:
            super().__init__(**sections)
        except ValidationError as error:
            raise InputError(sentence(error, type(self))) from error

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check(self)
        return self

    @property
    def uses_bearing_area(self) -> bool:
        """Whether contacts have no compliance: neither a foundation nor implicit wear."""
        implicit_wear = self.stepping.scheme == "implicit" and sum(self.wear_coefficients) > 0.0
        return self.law.compliance == 0.0 and not (implicit_wear and self.sliding.total > 0.0)

    @property
    def body_hardnesses(self) -> list[float]:
        """Those that are given [MPa]."""
        return [h for h in (self.sphere.hardness, self.disc.hardness) if h is not None]

    @property
    def hardness(self) -> float:
        """Largest pressure of a cell [MPa]: contact.hardness, or the softer body's."""
        return self.contact.hardness if self.contact.hardness is not None else min(self.body_hardnesses)

    @property
    def law(self) -> CappedFoundation:
        """The contact law."""
        return CappedFoundation(stiffness=self.contact.stiffness, hardness=self.hardness)

    @property
    def wear_coefficients(self) -> tuple[float, float]:
        """K of sphere and disc [mm²/N], hardness contained."""
        return self.wear.sphere.resolved(self.hardness), self.wear.disc.resolved(self.hardness)

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
        synthetic = self.disc.synthetic
        if synthetic is not None:
            why = f"does not apply to kind = '{synthetic.kind}'"
            found |= dict.fromkeys((f"disc.synthetic.{k}" for k in UNUSED_BY_KIND[synthetic.kind]), why)
            found |= dict.fromkeys((f"disc.{k}" for k in OF_FILES), "does not apply to a synthetic surface")
        if not self.uses_bearing_area:
            found["stepping.load_tolerance"] = "does not apply: with compliance the balance holds to 1e-12"
        if self.stepping.increment is not None:
            growing = ("stepping.first", "stepping.growth", "stepping.largest")
            found |= dict.fromkeys(growing, "does not apply to a fixed stepping.increment")
        if self.friction.shear_strength is not None:
            measured = ("friction.coefficient", "friction.calibrate")
            found |= dict.fromkeys(measured, "does not apply with a friction.shear_strength")
        return found

    def notices(self) -> list[str]:
        """What is given but not used, each as a sentence."""
        given = given_keys(self)
        found = [f"{key} {why}." for key, why in self.inapplicable().items() if key in given]
        total = self.sliding.total
        late = ", ".join(f"{s:g}" for s in self.output.snapshots if s > total or s == 0.0 < total)
        return [*found, f"output.snapshots that no step ends at: {late} mm."] if late else found

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

        A key that says the same in another way is dropped: a new sphere.diameter replaces sphere.radius.
        """
        flat = dict(changes or {})
        for section, keys in sections.items():
            flat |= {f"{section}.{k}": v for k, v in keys.items()}
        nested = self.model_dump(exclude_unset=True)
        for name, value in flat.items():
            for other in _alternatives_of(name) - set(flat):
                _remove(nested, other)
            _insert(nested, name, value)
            assumed = nested.get("assumed")
            if not isinstance(assumed, dict):
                continue
            replaced = {name} | _alternatives_of(name)
            for key in [k for k in assumed if k in replaced or k.startswith(f"{name}.")]:
                del assumed[key]
        return type(self)(**nested)


def presets() -> list[str]:
    """Names of the presets."""
    folder = resources.files("warpwear") / "presets"
    return sorted(p.name.removesuffix(".toml") for p in folder.iterdir() if p.name.endswith(".toml"))


def _no_such_study(name: str) -> str:
    near = get_close_matches(name, presets(), n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return f"STUDY = '{name}' is neither a file nor a preset ({', '.join(presets())}).{hint}"


def _alternatives_of(name: str) -> set[str]:
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


def _remove(nested: dict[str, Any], name: str) -> None:
    *parents, last = name.split(".")
    for parent in parents:
        nested = nested.get(parent, {})
        if not isinstance(nested, dict):
            return
    nested.pop(last, None)
