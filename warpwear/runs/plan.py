"""The plan of a run: every step of it, before any is made."""

import math
from collections.abc import Iterable
from typing import TypeAlias

from warpwear.laws.track import increments
from warpwear.study.study import Study

#: Increment of a step, distance at its end [mm], and whether its fields are kept.
Planned: TypeAlias = tuple[float, float, bool]


def plan_of(study: Study) -> list[Planned]:
    """Plan every step: its increment, the distance at its end [mm], and whether its fields are kept."""
    stops, total = study.snapshot_distances, study.sliding.total
    if study.is_swept:
        return kept_after(stops, (step for leg in study.legs for step in leg.steps()), total)
    ends = {block.end for block in study.blocks}
    meets = ends if study.output.snapshots == "auto" else {*stops, *ends}
    return kept_after(stops, increments(study.increments, total, meets), total)


def contacts_of(study: Study) -> int:
    """Count the contacts of a run that computes every cycle."""
    if study.is_swept:
        return sum(int(leg.track.steps(leg.length)) for leg in study.legs)
    return len(plan_of(study))


def kept_after(
    distances: Iterable[float], steps: Iterable[tuple[float, float]], total: float
) -> list[Planned]:
    """Leave the steps as long as they are: fields are kept at the first end at or after each distance."""
    stops, plan = iter(sorted(stop for stop in set(distances) if stop < total)), []
    stop = next(stops, math.inf)
    for increment, distance in steps:
        reached = stop > 0.0 and distance >= stop - 1.0e-6 * increment
        while distance >= stop - 1.0e-6 * increment:
            stop = next(stops, math.inf)
        plan.append((increment, distance, reached or distance == total))
    return plan
