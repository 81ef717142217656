"""Options that several commands of `warpwear calibrate` have: to numbers, with sentences for bad ones."""

from warpwear.errors import InputError
from warpwear.measured.options import quantity
from warpwear.study.units import Range

#: A coefficient of friction.
COF = Range(most=3.0)
#: The part of it that does not shear.
PLOUGHING = Range(or_equal=True, most=3.0)


def number(option: str, value: float, allowed: Range) -> float:
    """Check an option's number without a unit. Raises InputError."""
    try:
        return allowed.check(value)
    except ValueError as error:
        raise InputError(f"{option} = {value:g}: {error}") from None


def load_of(value: str | None) -> float:
    """Turn --load into a force [N]. Raises InputError where it is not given."""
    if value is None:
        raise InputError("--load is missing: the normal load of the test, a force such as '8 N'")
    return quantity("--load", value, "N")


def distance_of(distance: str | None, passes: int | None, stroke: str | None) -> float:
    """Find the sliding distance [mm] from --distance, or from --passes and --stroke. Raises InputError."""
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
