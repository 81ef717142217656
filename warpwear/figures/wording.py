"""How numbers, times and choices of many are told in figures and on pages."""

import math
from collections.abc import Sequence

import numpy as np

from warpwear.history.distances import with_unit

#: How powers of ten are written, and from where on thousands are set apart by a narrow space, as SI does.
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
THOUSANDS = 1e4


def chosen(count: int, most: int) -> list[int]:
    """Choose at most so many of `count` numbers, the first and the last among them."""
    return sorted({round(float(number)) for number in np.linspace(0, count - 1, min(most, count))})


def after(distance: float) -> str:
    """Say in words when a snapshot was taken. distance: in mm."""
    return f"after {with_unit(distance, 4)}" if distance else "static contact"


def counted(number: int, what: str) -> str:
    """Count things: 1 run, 2 runs."""
    return f"{number} {what}{'s' * (number != 1)}"


def listed(names: Sequence[str]) -> str:
    """List names as people do: a, b and c."""
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def few_of(texts: Sequence[str], most: int) -> str:
    """List so many texts at most, and say how many more there are."""
    return ", ".join(texts[:most]) + (f" and {len(texts) - most} more" if len(texts) > most else "")


def short(value: float) -> str:
    """Write a number as people do: 0.001, 20, 20 000, 10⁻⁵, 2·10⁶."""
    if THOUSANDS <= abs(value) < 1e5 and value == round(value):
        return f"{value:,.0f}".replace(",", "\u202f")  # a narrow space
    if 1e-3 <= abs(value) < 1e5 or value == 0.0:
        return f"{value:g}"
    digits, _, power = f"{value:e}".partition("e")
    return power_of_ten(power) if float(digits) == 1.0 else f"{float(digits):g}·{power_of_ten(power)}"


def power_of_ten(power: str | int) -> str:
    """Write a power of ten as print does: 10⁻⁵."""
    return f"10{str(int(power)).translate(RAISED)}"


def with_scatter(mean: float, scatter: float) -> str:
    """Write mean ± standard deviation, to the same digit; the latter left out where it is only round-off."""
    if not scatter > 1e-6 * mean:
        return f"{float(f'{mean:.3g}'):g}"
    decimals = 1 - math.floor(math.log10(scatter))
    places = max(decimals, 0)
    return f"{round(mean, decimals):.{places}f} ± {float(f'{scatter:.2g}'):.{places}f}"
