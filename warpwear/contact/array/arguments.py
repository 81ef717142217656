"""Check what is handed to `solve_contact`, and say what is not possible."""

import math
from collections.abc import Mapping
from numbers import Real
from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.form import Form, form_of

#: They bring Warp, which who checks numbers alone has no need of.
influence = lazy.module("warpwear.contact.half_space.influence")
staging = lazy.module("warpwear.engine.staging")

#: Sizes of numbers whose squares and products stay far from what float64 cannot hold.
LARGEST = 1e100
#: Tolerances that mean something: rounding is above smaller ones, the area is wrong with larger ones.
TOLERANCES = (1e-14, 1e-2)
#: Most characters of a value that a sentence repeats.
MOST_SHOWN = 80


def checked_heights(
    heights: npt.ArrayLike, threads: int, *, name: str = "heights"
) -> tuple[FloatArray, float, float, float]:
    """Return the heights as an array; the lowest, the highest and the sum of them. name: of the argument."""
    try:
        values = np.asanyarray(heights)
        if np.ma.is_masked(values) or np.iscomplexobj(values):
            raise TypeError("masked or complex")
        if values.dtype.kind not in "fiubO":
            raise TypeError(f"of {values.dtype}")
        if values.dtype.kind == "O" and not all(isinstance(value, Real) for value in values.flat):
            raise TypeError("not all of them numbers")
        values = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"{name} of type {type(heights).__name__} are not possible ({error}); "
            "they must be real numbers, none of them masked."
        ) from error
    if values.ndim != 2 or values.size == 0:
        raise InputError(
            f"{name} of shape {values.shape} are not possible; they must be (nx, ny), with a cell or more."
        )
    looks = staging.each(
        lambda rows: [f(values[rows]) for f in (np.min, np.max, np.sum)], values.shape, threads
    )
    lows, highs, sums = np.array(looks).T
    if not (math.isfinite(lows.min()) and math.isfinite(highs.max())):
        wrong = np.argwhere(~np.isfinite(values))
        i, j = wrong[0].tolist()
        raise InputError(
            f"{name}[{i}, {j}] = {values[i, j]:g} is not possible ({len(wrong)} of {values.size} are not "
            "finite); fill what is missing first."
        )
    if max(-lows.min(), highs.max()) > LARGEST:
        raise InputError(
            f"{name} up to {max(-lows.min(), highs.max()):g} are not possible; at most {LARGEST:g} are."
        )
    return values, float(lows.min()), float(highs.max()), float(sums.sum())


def map_of(heights: Any, cell: float | None) -> tuple[Any, float | None]:
    """Return heights and cell, of a measured surface its heights and its pixel. Raises InputError."""
    if not hasattr(heights, "heights") or not hasattr(heights, "pixel"):
        return heights, cell
    pixel = heights.pixel
    if cell not in (None, pixel[0]) or not math.isclose(*pixel, rel_tol=1e-9):
        raise InputError(f"cell = {cell!r} is not possible with pixels of {pixel} mm; squares are the cell.")
    return heights.heights, pixel[0]


def number(
    name: str, value: Any, *, any_sign: bool = False, optional: bool = True, limit: bool = False
) -> Any:
    """Return an argument as a float, None where it is left out. Raises InputError for what is not allowed.

    limit: whether an infinite one stands for none, too.
    """
    if value is None and optional:
        return None
    real = is_number(value)
    if real:
        value = as_float(value)
        if limit and value == math.inf:
            return None
    if not real or not math.isfinite(value) or not (any_sign or value > 0.0):
        text = f"{value:g}" if real else shown(value)
        allowed = f"{'' if any_sign else 'positive, '}finite number{', or left out' if optional else ''}"
        allowed += ", without a unit" if isinstance(value, str) else ""
        raise InputError(f"{name} = {text} is not possible; it must be a {allowed}.")
    if value != 0.0 and not 1.0 / LARGEST <= abs(value) <= LARGEST:
        size = f"from {1.0 / LARGEST:g} to {LARGEST:g}"
        raise InputError(f"{name} = {value:g} is not possible; its size must be {size}.")
    return value


def is_number(value: Any) -> bool:
    """Tell whether a value is a real number, which a truth value is not."""
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def as_float(value: Any) -> float:
    """Return a real number as a float; infinite where that holds no such number."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def shown(value: Any) -> str:
    """Return any value on one short line, as a sentence shows it."""
    text = " ".join(repr(value).split())
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]}…"


def shape_of(value: Any) -> tuple[int, ...] | None:
    """Return the shape of what may be an array; None where it has none."""
    try:
        return np.shape(value)
    except (TypeError, ValueError):
        return None


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


#: Keys of a study's [counter] that say its form, of which a radius may be infinite.
FORM_KEYS = ("radius", "radius_along", "radius_across", "edge_radius")


def counter_of(counter: Any, *, counter_radius: Any, shape: tuple[int, int]) -> Form | FloatArray | None:
    """Return the counter-body's form, or its heights over the lowest, of a shape; None for a plane."""
    if counter_radius is not None:
        if counter is not None:
            raise InputError(
                f"counter_radius = {shown(counter_radius)} and counter are given; give one of them."
            )
        counter = {"radius": number("counter_radius", counter_radius)}
    if counter is None:
        return None
    if isinstance(counter, Mapping):
        form = _form_of(counter)
        return None if form.is_flat else form
    values, lowest, *_ = checked_heights(counter, 1, name="counter")
    if values.shape != shape:
        raise InputError(
            f"counter of shape {values.shape} is not possible; it must be that of heights, {shape}."
        )
    return values - lowest


def _form_of(keys: Mapping[str, Any]) -> Form:
    """Return the form that the keys of a study's [counter] say, in the caller's units."""
    unknown = [key for key in keys if key not in ("shape", *FORM_KEYS)]
    if unknown:
        raise InputError(f"counter has no {unknown[0]!r}; its keys are shape, {', '.join(FORM_KEYS)}.")
    shape = keys.get("shape", "ball")
    shape = shape if isinstance(shape, str) else shown(shape)
    needed = FORM_KEYS[1:3] if shape == "crowned" else FORM_KEYS[:1]
    if missing := [key for key in needed if key not in keys]:
        raise InputError(f"counter of shape {shape!r} needs {missing[0]}.")
    values = {key: value for key, value in keys.items() if key != "shape"}
    for key, value in values.items():
        of_edge = key == "edge_radius" and is_number(value) and value == 0.0
        values[key] = 0.0 if of_edge else number(f"counter {key}", value, optional=False, limit=True)
    unlimited = {key: math.inf if value is None else value for key, value in values.items()}
    return form_of(shape, **unlimited)


def _named(form: Form | FloatArray) -> str:
    """Name a counter-body in a sentence."""
    curvature = form.curvature if isinstance(form, Form) else 0.0
    return f"counter_radius = {1.0 / curvature:g}" if curvature else "a counter-body"


def is_boundary(value: Any) -> TypeGuard[str]:
    """Tell whether a value is the name of a boundary."""
    return isinstance(value, str) and value in influence.BOUNDARIES


def boundary_of(boundary: str | None, modulus: float | None, form: Form | FloatArray | None) -> str | None:
    """Return the boundary of the half-space; None where there is no half-space."""
    if modulus is None:
        if boundary is not None:
            raise InputError(
                f"boundary = {shown(boundary)} is only for a half-space; leave it out, or give a modulus."
            )
        return None
    if boundary is not None and not is_boundary(boundary):
        raise InputError(
            f'boundary = {shown(boundary)} is unknown; allowed are "periodic", "free" and "line".'
        )
    if form is None:
        return boundary or "periodic"
    may_repeat = not isinstance(form, Form) or not form.rises[1]
    if boundary == "periodic" or (boundary == "line" and not may_repeat):
        allowed = '"free" or "line"' if may_repeat else '"free"'
        raise InputError(
            f'boundary = "{boundary}" is not possible with {_named(form)}; it must be {allowed}.'
        )
    return boundary or "free"
