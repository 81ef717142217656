"""The plan of a run: every step of it, before any is made."""

from collections.abc import Iterable

from warpwear.laws.track import increments
from warpwear.study.study import Study


def plan_of(study: Study) -> list[tuple[float, float, bool]]:
    """Plan every step: its increment, the distance at its end [mm], and whether its fields are kept."""
    stops, total = study.snapshot_distances, study.sliding.total
    if study.is_swept:
        return _kept_after(stops, study.track.increments(total), total)
    if study.output.snapshots == "auto":
        return _kept_after(stops, increments(study.increments, total), total)
    return [
        (increment, distance, distance in stops or distance == total)
        for increment, distance in increments(study.increments, total, stops)
    ]


def _kept_after(
    distances: tuple[float, ...], steps: Iterable[tuple[float, float]], total: float
) -> list[tuple[float, float, bool]]:
    """Leave the steps as long as they are: fields are kept at the first end at or after each distance."""
    stops, plan = sorted(stop for stop in set(distances) if stop < total), []
    for increment, distance in steps:
        reached = bool(stops) and stops[0] > 0.0 and distance >= stops[0] - 1.0e-6 * increment
        while stops and distance >= stops[0] - 1.0e-6 * increment:
            del stops[0]
        plan.append((increment, distance, reached or distance == total))
    return plan
