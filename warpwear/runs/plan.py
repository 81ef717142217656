"""The plan of a run: every step of it, before any is made."""

from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import NamedTuple, TypeAlias

from warpwear.laws.track import Track, increments
from warpwear.study.study import Study

#: Increment of a step, distance at its end [mm], and whether its fields are kept.
Planned: TypeAlias = tuple[float, float, bool]


class Leg(NamedTuple):
    """Blocks in a row that slide over one track have these distances at their start and end [mm]."""

    track: Track
    start: float
    end: float

    @property
    def length(self) -> float:
        """Return what is slid in it [mm]."""
        return self.end - self.start

    def steps(self, cycle: int = 0) -> Iterator[tuple[float, float]]:
        """Yield the increment of each step from a cycle on, and the test's distance at its end [mm]."""
        for increment, slid in self.track.increments(self.length, cycle=cycle):
            yield increment, self.end if slid == self.length else self.start + slid


def legs_of(study: Study) -> list[Leg]:
    """Return the legs of a swept study."""
    pairs = groupby(zip(study.tracks, study.blocks, strict=True), lambda pair: pair[0])
    legs = [(track, [block for _, block in blocks]) for track, blocks in pairs]
    return [Leg(track, blocks[0].start, blocks[-1].end) for track, blocks in legs]


def plan_of(study: Study) -> list[Planned]:
    """Plan every step: its increment, the distance at its end [mm], and whether its fields are kept."""
    stops, total = study.snapshot_distances, study.sliding.total
    if study.is_swept:
        return kept_after(stops, (step for leg in legs_of(study) for step in leg.steps()), total)
    ends = {block.end for block in study.blocks}
    meets = ends if study.output.snapshots == "auto" else {*stops, *ends}
    return kept_after(stops, increments(study.increments, total, meets), total)


def kept_after(
    distances: Iterable[float], steps: Iterable[tuple[float, float]], total: float
) -> list[Planned]:
    """Leave the steps as long as they are: fields are kept at the first end at or after each distance."""
    stops, plan = sorted(stop for stop in set(distances) if stop < total), []
    for increment, distance in steps:
        reached = bool(stops) and stops[0] > 0.0 and distance >= stops[0] - 1.0e-6 * increment
        while stops and distance >= stops[0] - 1.0e-6 * increment:
            del stops[0]
        plan.append((increment, distance, reached or distance == total))
    return plan
