"""What the length of a step does to an area: from the end of a run a part of its way is slid in others."""

import math
from dataclasses import replace
from itertools import islice, takewhile
from typing import Any

import numpy as np

from warpwear.engine import state
from warpwear.errors import ConvergenceError
from warpwear.laws.track import Track, spread_over
from warpwear.study.study import Study

#: Steps of the run for each that is made again. Twice as many follow that are half as long.
OF_RUN = 100
#: Lengths of the domain that are slid at least, so that both bodies follow the length of steps.
LEAST = 2


def change_by_step(study: Study, model: Any, steps: int) -> float | None:
    """Return by what part the area changes in steps half as long, or in steps of two cells instead of one.

    Both kinds slide on over the same way from the state at the end, for a cycle or less, and the bodies are
    put back. None where nothing was looked at: on the half-space, in wear in pieces, whose pieces would be
    others, and where a run or its last block is shorter than a cycle. model: on a track. steps: of the run.
    """
    law = study.contact.law
    if not study.is_swept or law != "local" or study.wear.sheds or not study.checks.step_probe:
        return None
    leg, block = study.legs[-1], study.blocks[-1]
    track, short = leg.track, 1.0 - 1.0e-9
    if block.length < short * leg.track.cycle:
        return None
    cycle = math.ceil(short * leg.length / track.cycle)
    count = max(steps // OF_RUN, LEAST * math.ceil(track.window / track.shift))
    count = min(count, track.passes_of_cycle * track.steps_of_pass)
    end = [*islice(track.increments(math.inf, cycle=cycle), count)][-1][1]
    shift = track.shift // 2 or 2
    other = replace(track, shift=shift, move=spread_over(shift))
    try:
        before = state.save(model, whole=True)
    except MemoryError:
        return None
    areas = []
    for way in (track, other):
        try:
            areas.append(_area(model, way, cycle, end / short))
        except (ConvergenceError, KeyboardInterrupt):  # the run itself has come to its end
            areas.append(math.nan)
        model.go_on(track, 0)
        state.restore(model, *before)
    change = areas[1] / areas[0] - 1.0
    return change if math.isfinite(change) else None


def _area(model: Any, track: Track, cycle: int, end: float) -> float:
    """Return the mean area [mm²] over the way from the beginning of a cycle to a distance [mm]."""
    model.go_on(track, cycle)
    plan = takewhile(lambda step: step[1] <= end, track.increments(math.inf, cycle=cycle))
    increments = [increment for increment, _ in plan]
    areas = [step.row["area_contact"] for step in model.steps((one, False) for one in increments)]
    return float(np.average(areas, weights=increments))
