"""[grid], [sliding], [[block]] and [stepping] set the cells, the way of the counter-body, and its steps."""

import math
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr

from warpwear.laws.fretting import HONEST_MEAN
from warpwear.laws.track import is_whole
from warpwear.study.keys import (
    Length,
    LengthOrZero,
    Section,
    excludes,
    key,
    needs,
    needs_compliance,
    refused,
    when,
)
from warpwear.study.units import NOT_NEGATIVE, InUnit, Load, Number, Range, is_pair, one_by_one

#: Parts of a distance at rest that no increment exceeds, unless given.
LARGEST_PARTS = 800
#: First of growing increments [mm].
FIRST = 3.0e-3
#: Growth of increments; of jumps over cycles of gross slip, twelve a decade, and of those in which a part may
#: stick: depths and volumes are then 0.07 and up to 0.6 % off.
GROWTH, GROWTH_OF_JUMPS, GROWTH_OF_STICKING = 1.02, 1.2, 1.05
#: Most cells along a side: a million squared is more than any memory holds.
MOST_CELLS = 1_000_000

#: Cells of a step at most, if not given, and steps of a stroke at least: docs/theory/track.md says why.
MOST_SHIFT, STEPS_OF_STROKE = 8, 8
#: Fewer cycles are each computed, unless a number is named.
FEWEST_CYCLES = 100

Count = Annotated[int, Field(ge=1, le=1_000_000_000, strict=True)]
Strokes = Annotated[int, Field(ge=0, le=1_000_000_000, strict=True)]

SWEPT = when("kinematics", "swept")
ON_A_CIRCLE = when(
    "sliding.uses_track_radius", otherwise="does not apply to sliding.kinematics = 'stationary'"
)
CAPPED = when("pair.caps_pressure", otherwise="does not apply without a contact.hardness: no cell reaches it")
STEPS = when(
    "kinematics",
    "stationary",
    "fretting",
    otherwise="does not apply to sliding.kinematics = '{}', whose steps are sliding.shift cells long",
)
FIXED = when("stepping.increment", None, otherwise="does not apply to a fixed stepping.increment")
NO_COMPLIANCE = when(
    "uses_bearing_area", otherwise="does not apply: with compliance the balance holds to 1e-12"
)
STROKE = needs("sliding.turns", what="sliding.stroke, such as '10 mm', or a sliding.force")
#: What fretting is computed of.
FRETS = (
    needs("study.model", "micro")
    + needs("contact.law", "half-space")
    + needs("friction.law", "coulomb", why=": friction.coefficient is its local coefficient")
    + excludes("wear.particle", why=", whose pieces have no stroke")
    + excludes("sliding.track_radius")
)
DRIVES = FRETS + excludes("sliding.kinematics", "stationary", "swept") + excludes("block")
MEANS = when("sliding.frets", otherwise="does not apply without sliding.kinematics = 'fretting'")
#: Keys of [sliding] and of a block that say one thing.
LENGTHS = ("distance", "passes", "cycles", "revolutions", "duration")
PACES = ("speed", "frequency")
WAYS = ("stroke", "track_radius", "force")
A_DISC_OF_CELLS = ": patches lie still, and a smooth disc is one of cells with disc.synthetic.kind = 'flat'"
#: A programme says lengths in its blocks.
ALONE = when("block", None, otherwise="does not apply beside [[block]], whose lengths add up")
total_key = partial(key, one_of="total", applies=ALONE)
growing_key = partial(key, applies=STEPS + FIXED, one_of="plan: growing")


@dataclass(frozen=True)
class Sides(InUnit):
    """Annotates the sides of a domain: a quantity, or a list of two, along sliding and across it."""

    def read(self, value: Any) -> Any:
        """Return the number in `unit`, or two. Raises ValueError, saying what is allowed."""
        value = one_by_one(value)
        if not isinstance(value, list | tuple) or is_pair(value):
            return super().read(value)
        if len(value) != 2:
            raise ValueError("needs a length, or two: along sliding and across it")
        return tuple(super(Sides, self).read(side) for side in value)

    def write(self, value: Any) -> Any:
        """Return text that `read` reads back without loss, or two."""
        if isinstance(value, tuple):
            return [super(Sides, self).write(side) for side in value]
        return super().write(value)


class GridSection(Section):
    """The section [grid] says how large the cells and the domain are."""

    cell: Length = key(..., "size of a cell; 10 um in the macro model, if not given")
    extent: Annotated[float | tuple[float, float], Sides("mm")] = key(
        ..., 'side of the square domain, or two, ["3 mm", "0.2 mm"]: along sliding and across it'
    )

    @property
    def sides(self) -> tuple[float, float]:
        """Return the sides of the domain along sliding and across it [mm]."""
        return self.extent if isinstance(self.extent, tuple) else (self.extent, self.extent)

    @property
    def size(self) -> str:
        """Return the extent as sentences say it: "1.5 mm", or "3 × 0.2 mm"."""
        return in_words(self.extent)

    def _check(self) -> None:
        for side, least in zip(self.sides, (4, 1 if isinstance(self.extent, tuple) else 4), strict=True):
            if side / self.cell > MOST_CELLS:
                raise refused("many_cells", grid=self, most=MOST_CELLS)
            refuse_parts("grid.extent", side, self.cell, least=least)


def in_words(length: float | tuple[float, float]) -> str:
    """Return a length [mm] in mm, or below 0.1 mm in µm; or both sides of a rectangle."""
    if isinstance(length, tuple):
        return f"{' × '.join(f'{side:g}' for side in length)} mm"
    return f"{length:.9g} mm" if length >= 0.1 else f"{1e3 * length:.6g} µm"


def refuse_parts(name: str, length: float, part: float, *, of: str = "", least: int = 1) -> None:
    """Refuse a length [mm] that is no whole number of parts, or of too few: raises ValueError.

    of: what the parts are, by default cells of their length. least: how many there have to be.
    """
    count = length / part
    if not is_whole(count) or round(count) < least:
        raise ValueError(
            f"{name} = {in_words(length)} is not a whole number{f' ({least} or more)' if least > 1 else ''} "
            f"of {of or f'cells of {in_words(part)}'}; the nearest that is, is "
            f"{in_words(max(round(count), least) * part)}"
        )


class Sliding(Section):
    """The section [sliding] says how far the counter-body slides, and which way it takes."""

    distance: LengthOrZero | None = total_key(
        None, "total sliding distance; 0 is a static contact", must_be_said=True
    )
    passes: Strokes | None = total_key(None, "instead of distance: number of strokes", demands=STROKE)
    cycles: Strokes | None = total_key(
        None, "instead of distance: number of pairs of strokes", demands=STROKE
    )
    duration: Annotated[float, InUnit("s")] | None = total_key(
        None,
        "instead of distance, with frequency: time of the test",
        demands=needs("sliding.frequency", why=" or '60 rpm'"),
    )
    frequency: Annotated[float, InUnit("Hz")] | None = key(
        None,
        "cycles (pairs of strokes), or with a track_radius revolutions, in a second: '60 rpm' is 1 Hz",
        demands=needs("sliding.lap", what="sliding.stroke or, of a rotation, sliding.track_radius"),
    )
    revolutions: Annotated[float, Number()] | None = total_key(
        None,
        "instead of distance: revolutions of a rotating disc",
        demands=needs("sliding.track_radius"),
    )
    stroke: Length | None = key(None, "length of one pass", one_of="lap")
    track_radius: Length | None = key(
        None,
        "instead of stroke: radius of the track on a rotating disc, which slides one way only",
        applies=ON_A_CIRCLE,
        one_of="lap",
    )
    speed: Annotated[float, InUnit("mm/s")] | None = key(
        None, "sliding speed, for the time axis and heat alone; by default the mean of the frequency"
    )
    kinematics: Literal["stationary", "swept", "fretting"] | None = key(
        None,
        "swept: the counter-body slides along a track on the disc, as it does by itself with a stroke or "
        "track_radius; stationary: the same disc cells stay under it; fretting: it moves to and fro by less "
        "than its contact is long, as it does by itself with a force or stroke_of = 'body'",
        demands=needs("study.model", "micro", of="swept", why=A_DISC_OF_CELLS)
        + needs("sliding.lap", of="swept", what="sliding.stroke, or sliding.track_radius of a rotating disc")
        + tuple(replace(demand, of=("fretting",)) for demand in FRETS)
        + needs("sliding.turns", of="fretting", what="a sliding.stroke or a sliding.force"),
    )
    positions: Literal["mean", "cells"] | None = key(
        None,
        "fretting: one contact for all places of a stroke, at their mean pressure, or one at each cell; "
        f"if not given the mean where the disc is smooth and the stroke at most {HONEST_MEAN:g} of the "
        "width of the scar",
        applies=MEANS,
        demands=excludes("block", of="mean"),
    )
    stroke_of: Literal["slip", "body"] = key(
        "slip",
        "fretting: whether the stroke is slipped, or what the drive moves the bodies by: what they and the "
        "rig yield is taken off, so that they may slip in part, or not",
        assumed="gross slip, as read off the width of a friction loop",
        applies=MEANS,
        demands=tuple(replace(demand, of=("body",)) for demand in DRIVES)
        + needs("sliding.stroke", of="body")
        + needs("pair.effective_modulus", of="body", what="the elastic constants of both bodies")
        + excludes("contact.boundary", "line", of="body", why=", whose displacement has no absolute value")
        + excludes("sliding.positions", "cells", of="body"),
    )
    force: Annotated[float, InUnit("N")] | None = key(
        None,
        "instead of stroke: amplitude of a tangential force that turns, below the coefficient times the load",
        one_of="lap",
        demands=DRIVES
        + excludes("sliding.positions", "cells")
        + needs("pair.effective_modulus", what="the elastic constants of both bodies")
        + needs("counter.has_hertz", what="a ball, a crowned body or a cylinder"),
    )
    rig_compliance: Annotated[float, InUnit("mm/N", NOT_NEGATIVE)] = key(
        "0 mm/N",
        "fretting: what the rig yields beside the bodies; of a stroke_of = 'body' it is taken off",
        applies=MEANS,
    )
    #: Stroke that a force gives unworn bodies [mm].
    _travel: float | None = PrivateAttr(None)
    track: Annotated[float | Literal["full"], InUnit("mm", words=("full",))] = key(
        "full",
        "swept: the whole stroke, or the length of a periodic disc on which one lap stands for one pass",
        applies=SWEPT,
    )
    shift: Annotated[int, Field(ge=1, le=100_000, strict=True)] | None = key(
        None,
        "swept: cells that the counter-body moves on in a step, which the half-space divides where it must; "
        f"{MOST_SHIFT}, or less for a stroke of fewer than {STEPS_OF_STROKE} such steps",
        assumed="well within the contact's length",
        applies=SWEPT,
    )
    plastic: Literal["forget", "keep"] = key(
        "forget",
        "swept: a disc cell at the hardness springs back, or keeps the depth it was pressed to",
        assumed="Archard's wear alone; 'keep' is the other end",
        demands=needs_compliance("keep", "a contact with compliance"),
        applies=SWEPT + CAPPED,
    )

    @property
    def uses_track_radius(self) -> bool:
        """True where the counter-body slides on a circle, or revolutions are counted or timed."""
        return self.kinematics != "stationary" or self.revolutions is not None or self.frequency is not None

    @property
    def lap(self) -> float | None:
        """Distance of one pass [mm]: the stroke, or one revolution; of a force that of unworn bodies."""
        circle = None if self.track_radius is None else 2.0 * math.pi * self.track_radius
        return circle or self.stroke or self._travel

    @property
    def turns(self) -> bool:
        """True where the bodies turn after a pass."""
        return self.stroke is not None or self.force is not None

    @property
    def frets(self) -> bool:
        """True where a stroke is short, or need not slip at all."""
        return self.kinematics == "fretting" or self.force is not None or self.stroke_of == "body"

    @property
    def drives_bodies(self) -> bool:
        """True where a force, or a stroke of the bodies, decides how much slips."""
        return self.force is not None or self.stroke_of == "body"

    @property
    def pace(self) -> float | None:
        """Mean sliding speed by the frequency [mm/s]; None without one."""
        if self.frequency is None or self.lap is None:
            return None
        return self.lap * self.frequency * (2.0 if self.track_radius is None else 1.0)

    @property
    def mean_speed(self) -> float | None:
        """Sliding speed [mm/s]: as given, or by the frequency; None where neither is known."""
        return self.pace if self.speed is None else self.speed

    @property
    def total(self) -> float:
        """Distance that the whole test slides [mm]."""
        if self.distance is not None:
            return self.distance
        if self.revolutions is not None:
            assert self.lap is not None
            return self.revolutions * self.lap
        if self.duration is not None and self.pace is not None:
            return self.pace * self.duration
        return (self.stroke or self._travel or 0.0) * (self.passes or 2 * (self.cycles or 0))


class BlockSection(Section):
    """A table [[block]] says what differs in it from [contact] and [sliding], and how far it slides."""

    load: Annotated[float, Load("N")] | None = key(None, "normal load in the block")
    stroke: Length | None = key(None, "length of one pass; over a track in the middle of the longest")
    track_radius: Length | None = key(
        None, "instead of stroke: radius of the track on a rotating disc; another one is unworn at first"
    )
    speed: Annotated[float, InUnit("mm/s")] | None = key(
        None, "sliding speed, for the time axis and heat alone"
    )
    frequency: Annotated[float, InUnit("Hz")] | None = key(
        None, "cycles, or with a track_radius revolutions, in a second"
    )
    distance: Length | None = key(None, "sliding distance of the block; or one of the next four")
    passes: Count | None = key(None, "number of strokes")
    cycles: Count | None = key(None, "number of pairs of strokes")
    revolutions: Annotated[float, Number()] | None = key(None, "revolutions of a rotating disc")
    duration: Annotated[float, InUnit("s")] | None = key(None, "with a frequency: time of the block")

    def over(self, sliding: Sliding) -> Sliding:
        """Return [sliding] as it is in the block: what this says replaces all that said the same."""
        own = {name: value for name, value in self if value is not None and name != "load"}
        said = [names for names in (PACES, WAYS) if own.keys() & set(names)]
        return sliding.model_copy(update=dict.fromkeys(chain(LENGTHS, *said)) | own)


class Stepping(Section):
    """The section [stepping] says which steps the way is cut into."""

    scheme: Literal["explicit", "implicit"] = key("implicit", "pressure of the step's start, or of its end")
    increment: Length | None = key(None, "fixed sliding increment", applies=STEPS, one_of="plan")
    first: Length | None = growing_key(
        None,
        "growing increments: the first; if not given 3 µm, and of fretting a cycle",
        assumed="nanometres of wear",
    )
    growth: Annotated[float, Number(Range(least=1.0, or_equal=True, most=10.0))] | None = growing_key(
        None,
        f"ratio of an increment to the last; if not given {GROWTH:g}, of fretting {GROWTH_OF_JUMPS:g}, and "
        f"where a part may stick {GROWTH_OF_STICKING:g}",
        assumed="grow with the distance slid",
    )
    largest: Length | None = growing_key(
        None,
        f"growing increments: the largest; 3 mm, or of a longer implicit run its {LARGEST_PARTS}th part; "
        "fretting has none",
        assumed="a tenth of a usual stroke, small beside the distance",
    )
    load_tolerance: Annotated[float | Literal["one cell"], InUnit("N", words=("one cell",))] = key(
        "one cell", "bearing area only: load left unbalanced, at most", applies=NO_COMPLIANCE
    )
    jump: Annotated[int, Field(ge=1, le=1_000_000, strict=True)] | Literal["auto"] = key(
        "auto",
        "swept: cycles (or laps) that a computed one stands for; 1: each is computed; auto: as many as "
        f"jump_error allows, from {FEWEST_CYCLES} cycles on and without wear.particle",
        applies=SWEPT,
    )
    jump_error: Annotated[float, Number(Range(most=0.5))] = key(
        0.005,
        "swept: error that jumps may make in the worn depth, rms over the scar, over that depth",
        applies=SWEPT,
    )
    area_error: Annotated[float, Number(Range(most=0.5))] = key(
        0.025,
        "swept, half-space: change of the area in contact that parts of a step of several cells may make, "
        "which are as long as it allows",
        applies=SWEPT + when("contact.law", "half-space"),
    )
    force: bool = key(False, "go on beyond the explicit stability limit")

    def _check(self) -> None:
        first = self.first or FIRST
        if self.largest is not None and first > self.largest:
            raise refused("first_increment", first=first, largest=self.largest)

    def plan(
        self, distance: float, *, cycle: float | None = None, sticks: bool = False
    ) -> tuple[float, float, float]:
        """First increment over a distance [mm], the factor by which increments grow, and the largest [mm].

        cycle: of fretting [mm], where increments jump over cycles. sticks: whether a part may stick.
        """
        if self.increment is not None:
            return self.increment, 1.0, self.increment
        parts = 1 if cycle else LARGEST_PARTS
        part = distance / parts if self.scheme == "implicit" else 0.0  # stable at any length
        growth = GROWTH_OF_STICKING if sticks else GROWTH_OF_JUMPS if cycle else GROWTH
        first = self.first or cycle or FIRST
        return first, self.growth or growth, self.largest or max(3.0, part, first)
