"""Turn options of commands, texts with a unit, into numbers, with a sentence for bad ones."""

from collections.abc import Mapping
from typing import Any

from warpwear.errors import InputError
from warpwear.study.units import POSITIVE, Quantity, Range


def quantity(option: str, value: str, unit: str, *, allowed: Range = POSITIVE) -> float:
    """Turn an option's text into a number in a unit. Raises InputError."""
    try:
        return float(Quantity(unit, allowed, hardness=option == "--hardness").read(value))
    except ValueError as error:
        raise InputError(f"{option} = {value!r}: {error}") from error


def optional(option: str, value: str | None, unit: str, *, allowed: Range = POSITIVE) -> float | None:
    """Turn an option's text into a number in a unit; None, where it was left out, stays None."""
    return None if value is None else quantity(option, value, unit, allowed=allowed)


def refuse(options: Mapping[str, Any], why: str) -> None:
    """Raise InputError for the first option that has a value; options: option -> value, None where left out.

    why: what is wrong with it, to go on after its name.
    """
    for option, value in options.items():
        if value is not None:
            raise InputError(f"{option} {why}")
