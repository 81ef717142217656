"""Searches for the approach that carries a load: bisection, and Newton's method inside a bracket."""

import math
from collections.abc import Callable

#: Residual of the balance of a contact with compliance, relative to the load; the package's.
TOLERANCE = 1.0e-12
#: Added to the bracket of a bisection so that the highest cell counts [mm]; the package's.
TIE = 1.0e-12
MAX_TRIALS = 400


def bisected(
    carried: Callable[[float], float], low: float, high: float, wanted: float, tolerance: float
) -> tuple[float, float, int]:
    """First middle of the bracket with |carried − wanted| < tolerance, what it carries, and the trials.

    Units are the caller's: cells in contact of a bearing area, or mm of overlap of a foundation.
    """
    for trial in range(1, MAX_TRIALS):
        approach = 0.5 * (low + high)
        found = carried(approach)
        if abs(found - wanted) < tolerance and found > 0.0:
            return approach, found, trial
        if not low < approach < high:
            break
        low, high = (low, approach) if found > wanted else (approach, high)
    raise ArithmeticError(f"no approach carries {wanted} to {tolerance}: {found} is left at {approach} mm")


def newton_in_bracket(
    carried: Callable[[float], tuple[float, float]], load: float, guess: float, low: float, high: float
) -> tuple[float, float, int]:
    """Offset [mm], force [N] there, evaluations: Newton's step while it stays inside the halving bracket."""
    offset, reach, width_before = guess, abs(guess) or 1.0e-18, math.inf
    for evaluation in range(1, MAX_TRIALS):
        force, slope = carried(offset)
        residual = force - load
        if abs(residual) <= TOLERANCE * load:
            break
        low, high = (offset, high) if residual < 0.0 else (low, offset)
        newton = offset - residual / slope if slope > 0.0 else math.nan
        if math.isinf(low) or math.isinf(high):
            near = abs(newton - offset) <= reach
            offset = newton if near else offset + math.copysign(reach, -residual)
            reach *= 4.0
            continue
        stalled = evaluation % 2 == 0 and high - low > 0.5 * width_before
        if evaluation % 2 == 0:
            width_before = high - low
        offset = newton if low < newton < high and not stalled else 0.5 * (low + high)
        if not low < offset < high:
            break
    return offset, force, evaluation
