"""Turn options of commands, texts with a unit, into numbers, with a sentence for bad ones."""

from collections.abc import Mapping
from numbers import Real
from typing import Any

from warpwear.errors import InputError
from warpwear.study.units import POSITIVE, InUnit, Range, is_pair

#: A coefficient of friction.
COF = Range(most=3.0)
#: The part of it that does not shear.
PLOUGHING = Range(or_equal=True, most=3.0)


def with_unit(value: Any, unit: str) -> Any:
    """Give a bare number, or those of a sequence, a unit; leave texts, pairs and pint's quantities alone."""
    if isinstance(value, list | tuple) and not is_pair(value):
        return [with_unit(one, unit) for one in value]
    return (value, unit) if isinstance(value, Real) and not isinstance(value, bool) else value


def quantity(option: str, value: Any, unit: str, *, allowed: Range = POSITIVE) -> float:
    """Turn an option's text, or number in a unit, into that number. Raises InputError."""
    try:
        read = InUnit(unit, allowed, hardness=option == "--hardness").read
        return float(read(with_unit(value, unit)))
    except ValueError as error:
        raise InputError(f"{option} = {value!r}: {error}") from error


def optional(option: str, value: Any, unit: str, *, allowed: Range = POSITIVE) -> float | None:
    """Turn an option's text into a number in a unit; None, where it was left out, stays None."""
    return None if value is None else quantity(option, value, unit, allowed=allowed)


def refuse(options: Mapping[str, Any], why: str) -> None:
    """Raise InputError for the first option that has a value; options: option -> value, None where left out.

    why: what is wrong with it, to go on after its name.
    """
    for option, value in options.items():
        if value is not None:
            raise InputError(f"{option} {why}")


def flag(name: str) -> str:
    """Return what an option of Python's name is called on the command line."""
    return f"--{name.replace('_', '-')}"


class Options(dict[str, Any]):
    """Options of a command by Python's names are looked up by those of the command line; None if left out."""

    def __getitem__(self, option: str) -> Any:
        return self.get(option.removeprefix("--").replace("-", "_"))

    def refuse(self, *options: str, why: str) -> None:
        """Raise InputError for the first of these options that has a value; why: goes on after its name."""
        refuse({option: self[option] for option in options}, why)

    @property
    def load(self) -> float:
        """Return --load as a force [N]. Raises InputError where it is not given."""
        if self["--load"] is None:
            raise InputError("--load is missing: the normal load of the test, a force such as '8 N'")
        return quantity("--load", self["--load"], "N")

    @property
    def distance(self) -> float:
        """Return the sliding distance [mm] of --distance, or of --passes and --stroke. Raises InputError."""
        passes = self["--passes"]
        if self["--distance"] is not None:
            if passes is not None:
                raise InputError("--distance and --passes exclude each other: both say how far it slid")
            return quantity("--distance", self["--distance"], "mm")
        if passes is None:
            raise InputError("the sliding distance is missing: --distance, or --passes with --stroke")
        if passes <= 0:
            raise InputError(f"--passes is {passes}: allowed is any positive number of single strokes")
        if self["--stroke"] is None:
            raise InputError("--passes needs --stroke, the length of one pass, such as '30 mm'")
        return float(passes * quantity("--stroke", self["--stroke"], "mm"))


def number(option: str, value: float, allowed: Range) -> float:
    """Check an option's number without a unit. Raises InputError."""
    try:
        return allowed.check(value)
    except ValueError as error:
        raise InputError(f"{option} = {value:g}: {error}") from None
