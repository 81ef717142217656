"""Check what is handed to `solve_contact`, and say what is not possible."""

import math
from numbers import Real
from typing import Any

import numpy as np
import numpy.typing as npt

from warpwear.contact.half_space.influence import BOUNDARIES
from warpwear.engine.staging import each
from warpwear.errors import InputError
from warpwear.grid import FloatArray

#: Sizes of numbers whose squares and products stay far from what float64 cannot hold.
LARGEST = 1e100
#: Tolerances that mean something: rounding is above smaller ones, the area is wrong with larger ones.
TOLERANCES = (1e-14, 1e-2)


def checked_heights(heights: npt.ArrayLike, threads: int) -> tuple[FloatArray, float, float, float]:
    """Return the heights as an array; the lowest, the highest and the sum of them."""
    try:
        values = np.asanyarray(heights)
        if np.ma.is_masked(values) or np.iscomplexobj(values):
            raise TypeError("masked or complex")
        if values.dtype.kind not in "fiubO":
            raise TypeError(f"of {values.dtype}")
        if values.dtype.kind == "O" and not all(isinstance(value, Real) for value in values.flat):
            raise TypeError("not all of them numbers")
        values = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"heights of type {type(heights).__name__} are not possible ({error}); "
            "they must be real numbers, none of them masked."
        ) from error
    if values.ndim != 2 or values.size == 0:
        raise InputError(
            f"heights of shape {values.shape} are not possible; they must be (nx, ny), with a cell or more."
        )
    looks = each(lambda rows: [f(values[rows]) for f in (np.min, np.max, np.sum)], values.shape, threads)
    lows, highs, sums = np.array(looks).T
    if not (math.isfinite(lows.min()) and math.isfinite(highs.max())):
        wrong = np.argwhere(~np.isfinite(values))
        i, j = wrong[0].tolist()
        raise InputError(
            f"heights[{i}, {j}] = {values[i, j]:g} is not possible ({len(wrong)} of {values.size} are not "
            "finite); fill what is missing first."
        )
    if max(-lows.min(), highs.max()) > LARGEST:
        raise InputError(
            f"heights up to {max(-lows.min(), highs.max()):g} are not possible; at most {LARGEST:g} are."
        )
    return values, float(lows.min()), float(highs.max()), float(sums.sum())


def number(name: str, value: Any, *, any_sign: bool = False, optional: bool = True) -> Any:
    """Return an argument as a float, None where it is left out. Raises InputError for what is not allowed."""
    if value is None and optional:
        return None
    is_number = isinstance(value, Real) and not isinstance(value, bool | np.bool_)
    if not is_number or not math.isfinite(value) or not (any_sign or value > 0.0):
        text = f"{float(value):g}" if is_number else repr(value)
        allowed = f"{'' if any_sign else 'positive, '}finite number{', or left out' if optional else ''}"
        raise InputError(f"{name} = {text} is not possible; it must be a {allowed}.")
    if value != 0.0 and not 1.0 / LARGEST <= abs(float(value)) <= LARGEST:
        size = f"from {1.0 / LARGEST:g} to {LARGEST:g}"
        raise InputError(f"{name} = {float(value):g} is not possible; its size must be {size}.")
    return float(value)


def tolerance_of(value: Any) -> float:
    """Return a tolerance as a float. Raises InputError for one that rounding hides or that means nothing."""
    tolerance = float(number("tolerance", value, optional=False))
    least, most = TOLERANCES
    if not least <= tolerance <= most:
        raise InputError(f"tolerance = {tolerance:g} is not possible; it must be from {least:g} to {most:g}.")
    return tolerance


def check_choice(how_many: str, **choice: float | None) -> None:
    """Raise InputError where more are given than may be, or none where one must be."""
    present = [f"{name} = {value:g}" for name, value in choice.items() if value is not None]
    if len(present) > 1 or (how_many == "exactly one" and not present):
        *names, last = choice
        values = f"{' and '.join(present)} are" if present else "nothing is"
        may = "may" if how_many == "at most one" else "must"
        raise InputError(f"{values} given; {how_many} of {', '.join(names)} and {last} {may} be.")


def boundary_of(boundary: str | None, modulus: float | None, counter_radius: float | None) -> str | None:
    """Return the boundary of the half-space; None where there is no half-space."""
    if modulus is None:
        if boundary is not None:
            raise InputError(
                f"boundary = {boundary!r} is only for a half-space; leave it out, or give a modulus."
            )
        return None
    if boundary not in (None, *BOUNDARIES):
        raise InputError(f'boundary = {boundary!r} is unknown; allowed are "periodic", "free" and "line".')
    if counter_radius is None:
        return boundary or "periodic"
    if boundary in ("periodic", "line"):
        raise InputError(
            f'boundary = "{boundary}" is not possible with counter_radius = {counter_radius:g}; '
            'it must be "free".'
        )
    return "free"
