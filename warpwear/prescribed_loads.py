"""Patches pressed to mean pressures that are prescribed, all at once, each inside a bracket of its own."""

import math
from collections.abc import Callable

import numpy as np

from warpwear.balance import FIRST_REACH, MAX_EVALUATIONS, MAX_ROUNDS, TOLERANCE
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.load_shares import BISECT_EVERY, Response, Shares

#: Of `TOLERANCE`, that a patch may be off by, so that their sum is well within it.
PART = 0.5


def press(
    response: Response,
    target: FloatArray,
    lowest: FloatArray,
    start: Shares | None,
    *,
    step: float,
    first: float,
    common: float,
    area: float,
    load: float,
) -> Shares:
    """Approaches at which patches carry target [MPa], each to half of `TOLERANCE` of it.

    lowest: below that approach a patch carries nothing [mm]. start: of the step before; step: how far beyond
    it [mm]; first: first step of a patch that did not touch [mm]. common: approach of the bodies, for the
    record [mm]; area: that a patch stands for [mm²]; load: of all [N]. Raises ConvergenceError.
    """
    asked = target > 0.0
    touched = np.zeros(target.size, dtype=bool) if start is None else asked & (start.pressure > 0.0)
    base = lowest.copy() if start is None else np.where(touched, start.approaches, lowest)
    offset = np.where(touched, step, np.where(asked, first, 0.0))
    allowed = PART * TOLERANCE * target
    evaluations = 0
    for _ in range(MAX_ROUNDS):

        def carried(offset: FloatArray, base: FloatArray = base) -> tuple[FloatArray, FloatArray]:
            p, slope, _ = response(base, offset)
            return p, slope

        reach = np.maximum(np.abs(offset), FIRST_REACH)
        offset, p, done = find_offsets(carried, target, allowed, offset, reach)
        evaluations += done
        if np.all(np.abs(p - target) <= allowed):
            return Shares(base, offset, common, 0.0, p, area * float(p.sum()) - load, 0.0, evaluations)
        base, offset = base + offset, np.zeros_like(offset)
    worst = int(np.argmax(np.abs(p - target) - allowed))
    raise ConvergenceError(
        f"the patches did not converge to their prescribed loads in {evaluations} evaluations: patch {worst} "
        f"carries {p[worst]:.9g} MPa of {target[worst]:.9g} MPa, at an approach of {base[worst]:.9g} mm."
    )


def find_offsets(
    carried: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    target: FloatArray,
    allowed: FloatArray,
    offset: FloatArray,
    reach: FloatArray,
) -> tuple[FloatArray, FloatArray, int]:
    """Offsets at which each of many carries its target, give or take what is allowed.

    carried: what they carry, and the slopes, at offsets; it rises with them. offset, reach: where to begin,
    and how long the first step may be. Returns the offsets, what is carried there and the evaluations, also
    where brackets came down to neighbouring numbers before all was met.
    """
    low, high = np.full_like(offset, -math.inf), np.full_like(offset, math.inf)
    for evaluation in range(1, MAX_EVALUATIONS):
        p, slope = carried(offset)
        left = p - target
        done = np.abs(left) <= allowed
        low, high = np.where(left < 0.0, offset, low), np.where(left > 0.0, offset, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = offset - left / slope  # not finite without a slope
        bracketed = np.isfinite(low) & np.isfinite(high)
        bisect = ~((newton > low) & (newton < high)) | (evaluation % BISECT_EVERY == 0)
        with np.errstate(invalid="ignore"):
            inside = np.where(bisect, 0.5 * (low + high), newton)
        limit = offset - np.copysign(reach, left)
        outside = np.where(np.abs(newton - offset) <= reach, newton, limit)
        new = np.where(done, offset, np.where(bracketed, inside, outside))
        reach = np.where(bracketed, reach, 4.0 * reach)
        if np.all(done | (new == offset) | (bracketed & ((new <= low) | (new >= high)))):
            break
        offset = new
    return offset, p, evaluation
