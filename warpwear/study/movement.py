"""The sections of a study, and how its bodies move by them: blocks, passes, tracks and increments."""

import math
from dataclasses import fields, replace
from functools import cached_property
from itertools import groupby, pairwise
from typing import Any, Self

import numpy as np
from pydantic import Field

from warpwear.grid import FloatArray, Grid
from warpwear.laws.archard import BODIES, WearLaw
from warpwear.laws.elastic import Hertz
from warpwear.laws.form import Form
from warpwear.laws.fretting import HONEST_MEAN, Fretting
from warpwear.laws.passes import Block, Laps
from warpwear.laws.task import FeatureLaw
from warpwear.laws.track import WHOLE, Leg, Track, spread_over
from warpwear.study import motion
from warpwear.study.bodies import CounterBody, Disc
from warpwear.study.contact import Contact
from warpwear.study.keys import Section, key, needs, uses, when
from warpwear.study.pair import Pair
from warpwear.study.sections.fatigue import Fatigue
from warpwear.study.sections.friction import Friction, Junctions
from warpwear.study.sections.settings import About, Checks, Output, PatchesSection, Run
from warpwear.study.sections.wear import Wear

#: Parts of the sliding distance after which fields are kept of themselves.
SNAPSHOTS = (0.001, 0.01, 0.1)
#: What fatigue needs of the contact.
STAYS = "a contact that stays where it is, by sliding.kinematics = 'stationary' or 'fretting'"
#: Blocks of a programme that a sentence names.
NAMED = 5


class Movement(Section):
    """The sections of a study, in mm, N, MPa and s, say how its bodies move.

    Nothing here checks whether they agree: `warpwear.study.rules` does.
    """

    study: About = About()
    counter: CounterBody
    disc: Disc
    contact: Contact
    wear: Wear
    grid: motion.GridSection
    sliding: motion.Sliding
    block: tuple[motion.BlockSection, ...] | None = key(
        None, "programme: blocks of other loads, speeds and lengths, one after another"
    )
    stepping: motion.Stepping = motion.Stepping()
    friction: Friction = Friction()
    junctions: Junctions = Junctions()
    fatigue: Fatigue | None = key(
        None,
        "fatigue limits of the disc, for the stress of a cycle",
        demands=needs("output.stress_depths", what="output.stress_depths = 'auto', or depths")
        + needs("is_swept", False, what=STAYS, why=": on a track it leaves before its friction turns round"),
    )
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

    def __copy__(self) -> Self:
        # Sections are frozen and shared; what was made of them is not: a changed copy makes its own.
        sections = {name: getattr(self, name) for name in type(self).model_fields}
        return self.model_construct({*self.model_fields_set}, **sections)

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        return self.__copy__()

    @cached_property
    def pair(self) -> Pair:
        """The bodies as a pair: their moduli, hardnesses, strengths, materials by depth and laws of wear."""
        return Pair(**{field.name: getattr(self, field.name) for field in fields(Pair)})

    @property
    def hertz(self) -> Hertz | None:
        """Hertz's contact before any wear, under the largest load; None for other forms or constants."""
        return self.pair.hertz

    @property
    def wear_laws(self) -> tuple[WearLaw, WearLaw]:
        """The laws by which counter-body and disc wear."""
        return self.pair.wear_laws

    @property
    def cycle(self) -> float | None:
        """What is slid in a lap, or in two strokes [mm]; None where there are none, or blocks differ."""
        laps = {part.sliding.lap for part in self.parts}
        lap = laps.pop() if len(laps) == 1 else None
        return None if lap is None else lap * (1.0 if self.sliding.track_radius else 2.0)

    @cached_property
    def parts(self) -> tuple[Self, ...]:
        """Studies that the blocks of a programme are by themselves; this one alone without a programme."""
        if self.block is None:
            return (self,)
        alone = self.model_copy(update={"block": None})
        loads = (self.contact.load if block.load is None else block.load for block in self.block)
        contacts = (self.contact.model_copy(update={"load": load}) for load in loads)
        slidings = (block.over(self.sliding) for block in self.block)
        if self.is_swept:  # steps of one length, and circles of one, as each is a part of the same disc
            same = {"shift": self.shift} | ({"track": self._shortest_lap} if self.circles else {})
            slidings = (sliding.model_copy(update=same) for sliding in slidings)
        return tuple(
            alone.model_copy(update={"contact": contact, "sliding": sliding})
            for contact, sliding in zip(contacts, slidings, strict=True)
        )

    @cached_property
    def telling_parts(self) -> tuple[tuple[int, Self], ...]:
        """Return those of `parts`, with their numbers from 1, by which rules and doubts know of all of them.

        Of blocks that differ in load, length and speed alone the extreme ones tell: what is too much, or too
        little, is so there first.
        """
        alike: dict[Any, list[int]] = {}
        for at, block in enumerate(self.block or (motion.BlockSection(),)):
            own = {name: getattr(block, name) for name in block.model_fields_set}
            free = {"load", *motion.LENGTHS, *({"speed"} if block.frequency is None else ())}
            alike.setdefault(frozenset((n, n in free or v) for n, v in own.items()), []).append(at)
        numbers = {
            choose(group, key=of)
            for group in alike.values()
            for choose in (min, max)
            for of in (
                lambda at: self.blocks[at].load,
                lambda at: self.blocks[at].length,
                lambda at: self.blocks[at].speed or 0.0,
            )
        }
        return tuple((at + 1, self.parts[at]) for at in sorted(numbers))

    @cached_property
    def circles(self) -> tuple[float, ...]:
        """Return the track radii of a swept programme that has several [mm], in the order of their first use.

        Each is a circle of the disc by itself, unworn at first.
        """
        radii = dict.fromkeys(block.over(self.sliding).track_radius for block in self.block or ())
        several = tuple(radius for radius in radii if radius is not None) if self.is_swept else ()
        return several if len(several) > 1 else ()

    @property
    def _shortest_lap(self) -> float | str:
        """Return the length of disc that stands for every circle [mm]: as named, or the shortest lap."""
        if self.sliding.track != "full":
            return self.sliding.track
        step = self.shift * self.grid.cell
        return max(1, math.floor(2.0 * math.pi * min(self.circles) / step * (1.0 + WHOLE))) * step

    def circle_of(self, block: Block) -> int:
        """Return the number of the circle of the disc that a block slides on, from 0; 0 of other tracks."""
        return self._circle_numbers.get(block.lap, 0)

    @cached_property
    def _circle_numbers(self) -> dict[float | None, int]:
        return {2.0 * math.pi * radius: number for number, radius in enumerate(self.circles)}

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Blocks of the programme, in their order; the whole test is one without a programme."""
        return Block.in_a_row(
            (p.contact.load, p.sliding.total, p.sliding.mean_speed, p.sliding.lap) for p in self.parts
        )

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
    def same_radius(self) -> float | None:
        """Return the track radius of the whole test [mm]; None without one, and where blocks differ in it."""
        return None if self.circles else self.sliding.track_radius

    @property
    def programme(self) -> str | None:
        """Return the blocks of the programme in words, the first of many; None without a programme."""
        if self.block is None:
            return None
        parts = [
            f"{block.load:.4g} N over {block.length:.6g} mm"
            + (f" on a track of {self.circles[self.circle_of(block)]:.6g} mm radius" if self.circles else "")
            for block in self.blocks
        ]
        return ", ".join(parts[:NAMED]) + (f" and {len(parts) - NAMED} more" if len(parts) > NAMED else "")

    @property
    def is_swept(self) -> bool:
        """True where the counter-body slides over a track, false where it stays on the same cells."""
        return self.kinematics == "swept"

    @property
    def kinematics(self) -> str:
        """How the bodies move: as named, "fretting" where one contact stands for all places of a stroke.

        If not named it is "swept" of the micro model with a stroke or a track radius.
        """
        if self.sliding.frets:
            return "fretting" if self.positions == "mean" else "swept"
        slides = self.study.model == "micro" and self.sliding.lap is not None
        return self.sliding.kinematics or ("swept" if slides else "stationary")

    @cached_property
    def shift(self) -> int:
        """Cells that a step of a swept study covers: as named, else what leaves a stroke its least steps.

        Of a track whose length is named it is a divisor, if there is one that is more than half as many.
        """
        sliding, cell = self.sliding, self.grid.cell
        laps = (block.over(sliding).lap for block in self.block) if self.block else (sliding.lap,)
        lap = min(lap for lap in laps if lap is not None)
        most = max(1, min(motion.MOST_SHIFT, math.floor(lap / cell / motion.STEPS_OF_STROKE * (1.0 + WHOLE))))
        cells = most if sliding.track == "full" else round(float(sliding.track) / cell)
        return sliding.shift or next((n for n in range(most, most // 2, -1) if cells % n == 0), most)

    @property
    def jumps(self) -> bool:
        """True where a computed cycle of a track may stand for more: of itself not of what acts in steps."""
        if not self.is_swept or self.stepping.jump == 1:
            return False
        if self.stepping.jump != "auto":
            return True
        # A load larger by 0.1 % moves depths in pieces by as much as a jump does: no error bounds that.
        cycles = self.passes_at(self.sliding.total) / self.track.passes_of_cycle
        return (
            not self.wear.sheds
            and bool(cycles >= motion.FEWEST_CYCLES * (1.0 - WHOLE))
            and all(feature.jumps for feature in self.features.values())
        )

    @property
    def increments(self) -> tuple[float, float, float]:
        """First increment at rest [mm], the factor by which increments grow, and the largest [mm]."""
        cycle = 2.0 * (self.sliding.lap or 0.0) if self.kinematics == "fretting" else None
        return self.stepping.plan(self.sliding.total, cycle=cycle, sticks=self.sliding.drives_bodies)

    @property
    def lap(self) -> float | None:
        """Distance that a pass over the track slides at most [mm]; None where the disc lies still."""
        return self.track.stroke if self.is_swept else None

    @property
    def laps(self) -> Laps | None:
        """How the passes of a swept study repeat; None where the disc lies still."""
        first, *_, last = (*self.blocks, self.blocks[-1])
        if not self.is_swept or first.lap is None or last.lap is None:
            return None
        start = max((block.end for block in self.blocks if block.lap != last.lap), default=0.0)
        return Laps(last.lap, self.tracks[-1].reverses, start, first.lap)

    def passes_at(self, distance: Any) -> Any:
        """Return how many passes of a swept study a distance is [mm], or each of many."""
        laps = [block.length / block.lap for block in self.blocks if block.lap]
        ends = [block.end for block in self.blocks]
        return np.interp(distance, [0.0, *ends], np.cumsum([0.0, *laps]))

    @cached_property
    def track(self) -> Track:
        """The track that a swept study asks for, of its longest stroke; `rules_track` says whether it may."""
        if self.block is not None:
            return max((part.track for part in self.parts), key=lambda track: track.stroke)
        sliding, cell, shift = self.sliding, self.grid.cell, self.shift
        lap = sliding.lap
        assert lap is not None  # checked with the study
        full, rotates = sliding.track == "full", sliding.track_radius is not None
        length, unit = lap if full else float(sliding.track), shift if full and rotates else 1
        cells = max(1, round(length / (unit * cell))) * unit
        move = spread_over(shift) if self.contact.law == "local" else 0
        return Track(cells, shift, cell, self.cells.nx, lap, rotates or not full, not rotates, move=move)

    @cached_property
    def tracks(self) -> tuple[Track, ...]:
        """Return the track of each block, in the middle of one disc."""
        longest = self.track
        return tuple(
            track if track.periodic else replace(track, spare=longest.cells - track.cells)
            for track in (part.track for part in self.parts)
        )

    @property
    def places(self) -> tuple[FloatArray, FloatArray]:
        """Return the places of the disc's heights [mm] along and across: of the track, or domain."""
        return self.track.x if self.is_swept else self.cells.x, self.cells.y

    @property
    def legs(self) -> list[Leg]:
        """Return the legs of a swept study: blocks in a row that slide over one track."""
        pairs = groupby(zip(self.tracks, self.blocks, strict=True), lambda pair: pair[0])
        legs = [(track, [block for _, block in blocks]) for track, blocks in pairs]
        return [Leg(track, blocks[0].start, blocks[-1].end) for track, blocks in legs]

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
    def cells(self) -> Grid:
        """The grid of cells that the study asks for."""
        nx, ny = (round(side / self.grid.cell) for side in self.grid.sides)
        return Grid(nx, ny, self.grid.cell)

    @property
    def snapshot_distances(self) -> tuple[float, ...]:
        """Sliding distances [mm] that fields are kept at, or where the next step ends, beside the end.

        Of themselves they are also those at which the counter-body leaves a circle of the disc.
        """
        snapshots, blocks = self.output.snapshots, self.blocks
        if snapshots != "auto":
            return snapshots
        left = (b.end for b, after in pairwise(blocks) if self.circle_of(b) != self.circle_of(after))
        return *(part * self.sliding.total for part in SNAPSHOTS), *left

    def volumes(
        self, distance: float, form: Form | None = None, extent: tuple[float, float] | None = None
    ) -> tuple[float, float]:
        """Return what counter-body and disc lose over the test's first distance [mm]: Σ K F ΔL [mm³].

        Where K changes with depth it is an estimate, by the caps that a plane cuts off a form, by default the
        counter-body's, over an extent, by default the domain's [mm].
        """
        form, extent = form or self.counter.form, extent or self.grid.sides
        profiles = self.pair.profiles or (None, None)
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
            kappa=self.pair.softness_ratio,
            stroke=sliding.lap,
            force=sliding.force,
            of_body=sliding.stroke_of == "body",
            rig=sliding.rig_compliance,
            has_displacement=self.boundary == "free",
        )

    @property
    def features(self) -> dict[str, FeatureLaw]:
        """The laws of features of its sections, by the keys that ask for them."""
        sections = (getattr(self, name) for name in type(self).model_fields)
        laws = (law for section in sections for law in getattr(section, "features", {}).items())
        return {name: law for name, law in laws if uses(self, name)}
