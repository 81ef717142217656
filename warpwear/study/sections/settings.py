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

    name: Annotated[str, Field(pattern=r"^\w[\w .+-]*$", max_length=100)] = key(
        "study", "name of the run and of its folder: letters, digits, spaces and . + - _"
    )
    description: str = key("", "one line for people")
    author: str | None = key(None, "who answers for the run, where its folder is passed on")
    publisher: str | None = key(
        None, "the laboratory that passes it on, such as 'A Laboratory <https://its.address>'"
    )
    license: str | None = key(None, "what others may do with it: the address of a licence, or its name")
    model: Literal["macro", "micro", "two-scale"] = key(
        "micro",
        "macro: smooth bodies on an elastic foundation; micro: every asperity resolved; two-scale: patches "
        "of resolved asperities that share the load",
        demands=needs_compliance("two-scale", "patches that yield"),
    )


class PatchesSection(Section):
    """The section [patches] says where patches of the two-scale model lie and how they share the load."""

    macro_cell: Length = key("50 um", "size of a macro cell, each of which has one patch of the grid's cells")
    width: Length | None = key(
        None, "size of a patch; by default the macro cell, which tiles the contact; smaller ones stand for it"
    )
    bulk: Literal["spring", "none"] = key(
        "spring",
        "behind each patch: a spring of K_N, the elastic bulk of both bodies, in series; none where "
        "the patch's own law carries that compliance, as free patches of the half-space do",
        assumed="springs of the patches yield as the smooth bodies do; without hardness or asperities",
        applies=ONE_APPROACH,
        demands=excludes("contact.boundary", "free", of="spring", why=COUNTED_TWICE),
    )
    coupling: Literal["approach", "load"] = key(
        "approach",
        "approach: one for all patches, whose own answers share the load; load: a smooth macro contact "
        "prescribes the load of each patch",
        demands=needs("stepping.scheme", "implicit", of="load")
        + excludes("friction.film", of="load", where=GROWS, why=NO_BARE_CELLS)
        + needs(
            "pair.caps_pressure",
            of="load",
            what="a finite contact.hardness",
            why=": without it the smooth contact asks of patches what asperities cannot carry",
        ),
    )
    placement: Literal["centre", "random"] = key(
        "centre",
        "place of a smaller patch in its macro cell: in the middle, or at random by patches.seed",
        applies=SAMPLES,
    )
    seed: Annotated[int, Field(ge=0, strict=True)] = key(0, "seed of the random placement", applies=AT_RANDOM)

    @property
    def patch_width(self) -> float:
        """Width that a patch has [mm]: as given, or that of a macro cell."""
        return self.macro_cell if self.width is None else self.width


class Run(Section):
    """The section [run] says how a run is kept safe."""

    checkpoint: Annotated[float, InUnit("s", Range(or_equal=True, infinite=True))] = key(
        "2 min", "time between checkpoints, from which a run is resumed; 0 s is after every step, inf s never"
    )
    lap_memory: Annotated[float, InUnit("MB", NOT_NEGATIVE)] = key(
        "256 MB",
        "half-space on a track: for the pressures of laps, from which contacts of the next may start; places "
        "that it has no room for start otherwise",
        applies=when("contact.law", "half-space") + when("kinematics", "swept"),
    )


class Checks(Section):
    """The section [checks] says what a run does when a check fails."""

    strict: bool = key(
        True,
        "stop when a step breaks what must hold: finite numbers, balance, volumes, a contact off the edge "
        "and on measured points; false records a warning",
    )
    step_probe: bool = key(
        True,
        "local law, swept: slide on in shorter steps at the end, a cycle at most, for the error of the area",
        applies=when("contact.law", "local") + when("kinematics", "swept"),
    )


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
        "auto",
        "sliding distances at which fields are kept; the end always is, and [] is the end alone; auto: also "
        "after 1/1000, 1/100 and 1/10 of the test; auto and swept: at the end of the step that reaches each",
    )
    precision: Literal["double", "single"] = key(
        "double",
        "digits of the fields of snapshots: single makes a folder less than half as large; pressures, and "
        "all that is computed, are double",
    )
    static_area_every: Annotated[int, Field(ge=0, strict=True)] = key(
        0,
        "half-space: also solve the contact without wear in the step, every so many steps, for its area; "
        "0 is never",
        applies=when("contact.law", "half-space") + when("study.model", "micro"),
    )
    stress_depths: (
        Annotated[
            tuple[LengthOrZero, ...] | Literal["auto"], BeforeValidator(_depths), AfterValidator(_rising)
        ]
        | None
    ) = key(
        None,
        "half-space: depths below the disc's surface at which stresses of the snapshots are computed; "
        "auto: the surface, and 20 from a cell to half the domain's shorter side",
        demands=STRESSED,
    )
    joint: tuple[Literal["conductance", "stiffness", "flow", "flash"], ...] = key(
        (),
        "half-space: what the contact of each snapshot, solved anew, conducts (a length, times the bodies' "
        "conductivity), how stiff it is and what flows through its gap; flash: how hot that of the step gets",
        demands=STRESSED,
    )
    stress_plane: Literal["y = 0", "x = 0"] = key(
        "y = 0",
        "plane through the middle in which stresses are kept: along sliding, or across it",
        applies=HAS_STRESSES,
    )
