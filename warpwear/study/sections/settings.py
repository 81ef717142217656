"""[study], [patches], [run], [checks] and [output]: which model, its patches, and how a run goes."""

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from warpwear.study.keys import Length, LengthOrZero, Section, excludes, key, needs, needs_compliance, when
from warpwear.study.units import NOT_NEGATIVE, InUnit, Range, one_by_one

ONE_APPROACH = when("patches.coupling", "approach")
SAMPLES = when("samples_area", otherwise="does not apply: the patches tile the contact")
HAS_STRESSES = when("has_stresses", otherwise="does not apply without output.stress_depths")
AT_RANDOM = SAMPLES + when("patches.placement", "random")


COUNTED_TWICE = (
    ", as a free patch contains the displacement of its mean, which a bulk behind it would count twice"
)


#: Why junctions that grow by a film do not go with loads of a smooth contact.
GROWS = when("friction.grows", otherwise="unless friction.junction_growth is 0")
NO_BARE_CELLS = " and friction.junction_growth, as the smooth contact that prescribes loads has no bare cells"


class About(Section):
    """The section [study] names the run and says which model computes it."""

    name: Annotated[str, Field(pattern=r"^\w[\w .+-]*$", max_length=100)] = key("study")
    description: str = key("")
    author: str | None = key(None)
    publisher: str | None = key(None)
    license: str | None = key(None)
    model: Literal["macro", "micro", "two-scale"] = key(
        "micro", demands=needs_compliance("two-scale", "patches that yield")
    )


class PatchesSection(Section):
    """The section [patches] says where patches of the two-scale model lie and how they share the load."""

    macro_cell: Length = key("50 um")
    width: Length | None = key(None)
    bulk: Literal["spring", "none"] = key(
        "spring",
        applies=ONE_APPROACH,
        demands=excludes("contact.boundary", "free", of="spring", why=COUNTED_TWICE),
    )
    coupling: Literal["approach", "load"] = key(
        "approach",
        demands=needs("stepping.scheme", "implicit", of="load")
        + excludes("friction.film", of="load", where=GROWS, why=NO_BARE_CELLS)
        + needs(
            "pair.caps_pressure",
            of="load",
            what="a finite contact.hardness",
            why=": without it the smooth contact asks of patches what asperities cannot carry",
        ),
    )
    placement: Literal["centre", "random"] = key("centre", applies=SAMPLES)
    seed: Annotated[int, Field(ge=0, strict=True)] = key(0, applies=AT_RANDOM)

    @property
    def patch_width(self) -> float:
        """Width that a patch has [mm]: as given, or that of a macro cell."""
        return self.macro_cell if self.width is None else self.width


class Run(Section):
    """The section [run] says how a run is kept safe."""

    checkpoint: Annotated[float, InUnit("s", Range(or_equal=True, infinite=True))] = key("2 min")
    lap_memory: Annotated[float, InUnit("MB", NOT_NEGATIVE)] = key(
        "256 MB", applies=when("contact.law", "half-space") + when("kinematics", "swept")
    )


class Checks(Section):
    """The section [checks] says what a run does when a check fails."""

    strict: bool = key(True)
    step_probe: bool = key(True, applies=when("contact.law", "local") + when("kinematics", "swept"))


#: Most distances at which fields are kept.
MOST_SNAPSHOTS = 10_000


def _snapshots(value: Any) -> Any:
    value = one_by_one(value)
    if isinstance(value, list | tuple) and len(value) > MOST_SNAPSHOTS:
        raise ValueError(f"has {len(value):,} distances; allowed are {MOST_SNAPSHOTS:,}")
    return value


def _depths(value: Any) -> Any:
    value = one_by_one(value)
    if isinstance(value, list | tuple) and not value:
        raise ValueError("has no depth; leave it out for no stresses")
    return value


def _rising(values: Any) -> Any:
    if isinstance(values, tuple) and any(b <= a for a, b in pairwise(values)):
        raise ValueError(f"needs depths that rise, not {', '.join(f'{value:g}' for value in values)} mm")
    return values


#: Stresses, and what a joint does, are those of a half-space on the domain's cells.
STRESSED = needs("contact.law", "half-space") + needs("study.model", "micro")


class Output(Section):
    """The section [output] says which fields and columns are kept."""

    snapshots: Annotated[tuple[LengthOrZero, ...] | Literal["auto"], BeforeValidator(_snapshots)] = key(
        "auto"
    )
    precision: Literal["double", "single"] = key("double")
    static_area_every: Annotated[int, Field(ge=0, strict=True)] = key(
        0, applies=when("contact.law", "half-space") + when("study.model", "micro")
    )
    stress_depths: (
        Annotated[
            tuple[LengthOrZero, ...] | Literal["auto"], BeforeValidator(_depths), AfterValidator(_rising)
        ]
        | None
    ) = key(None, demands=STRESSED)
    joint: tuple[Literal["conductance", "stiffness", "flow", "flash"], ...] = key((), demands=STRESSED)
    stress_plane: Literal["y = 0", "x = 0"] = key("y = 0", applies=HAS_STRESSES)
