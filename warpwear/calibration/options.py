"""Options of `warpwear calibrate` as text: to numbers in mm, N, MPa and s, with sentences for bad ones."""

import json
import math
from collections.abc import Mapping
from typing import Any

from warpwear.errors import InputError
from warpwear.study.units import NOT_NEGATIVE, POSITIVE, Range, parse

COF = Range(most=3.0)
PLOUGHING = Range(or_equal=True, most=3.0)


def quantity(option: str, value: str, unit: str, *, allowed: Range = POSITIVE) -> float:
    """An option's value in a unit. Raises InputError."""
    try:
        return allowed.check(parse(value, unit), unit)
    except ValueError as error:
        raise InputError(f"{option} = {value!r}: {error}") from None


def optional(option: str, value: str | None, unit: str, *, allowed: Range = POSITIVE) -> float | None:
    """The same of an option that may be left out."""
    return None if value is None else quantity(option, value, unit, allowed=allowed)


def number(option: str, value: float, allowed: Range) -> float:
    """An option's number without a unit. Raises InputError."""
    try:
        return allowed.check(value)
    except ValueError as error:
        raise InputError(f"{option} = {value:g}: {error}") from None


def load_of(value: str | None) -> float:
    """--load [N], which must be given."""
    if value is None:
        raise InputError("--load is missing: the normal load of the test, a force such as '8 N'")
    return quantity("--load", value, "N")


def distance_of(distance: str | None, passes: int | None, stroke: str | None) -> float:
    """Sliding distance [mm] from --distance, or from --passes and --stroke."""
    if distance is not None:
        if passes is not None:
            raise InputError("--distance and --passes exclude each other: both say how far it slid")
        return quantity("--distance", distance, "mm")
    if passes is None:
        raise InputError("the sliding distance is missing: --distance, or --passes with --stroke")
    if passes <= 0:
        raise InputError(f"--passes is {passes}: allowed is any positive number of single strokes")
    if stroke is None:
        raise InputError("--passes needs --stroke, the length of one pass, such as '30 mm'")
    return passes * quantity("--stroke", stroke, "mm")


def uncertainty(value: str | None, unit: str) -> float | None:
    """--uncertainty in the unit of what was measured."""
    return optional("--uncertainty", value, unit, allowed=NOT_NEGATIVE)


def given(options: Mapping[str, Any]) -> list[str]:
    """The names of the options that were given, in their order."""
    return [name for name, value in options.items() if value is not None and value != ()]


def scientific(value: float, error: float | None = None, *, digits: int = 4) -> str:
    """A number as 3.691e-4, with its error to two digits as (3.69 ± 0.18)e-4."""
    power = math.floor(math.log10(abs(value))) if value else 0
    part = float(f"{value / 10.0**power:.{digits - 1}f}")
    if abs(part) >= 10.0:  # rounded up to the next power
        part, power = part / 10.0, power + 1
    if not error:
        return f"{part:.{digits - 1}f}e{power}"
    small = error / 10.0**power
    if not 1e-6 < small < 1e4:  # two digits of it would be a row of zeros
        return f"({part:.{digits - 1}f} ± {small:.0e})e{power}"
    decimals = max(0, 1 - math.floor(math.log10(small)))
    return f"({value / 10.0**power:.{decimals}f} ± {small:.{decimals}f})e{power}"


def as_json(record: Mapping[str, Any]) -> str:
    """JSON without NaN and infinity: they become null."""
    return json.dumps(_plain(record), indent=2, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
