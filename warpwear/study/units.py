"""Quantities, such as "9.4e-4 mm^3/N/m", become numbers in the units of the solver: mm, N, MPa, s."""

import math
import re
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, lru_cache
from numbers import Real
from os import PathLike
from typing import Any, Self

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from warpwear import lazy
from warpwear.errors import prose

pint = lazy.module("pint")

_TABLE = prose("units")
#: What to write in a message about a unit of each kind.
EXAMPLES: dict[str, str] = {unit: about["example"] for unit, about in _TABLE.items()}
#: Factors of units as they are mostly written.
FACTORS: dict[str, dict[str, float]] = {unit: about.get("factors", {}) for unit, about in _TABLE.items()}


# One number, then units of letters; digits in a unit are exponents. Not left to a parser of expressions,
# which would read "8,5 N" as 85 N and "2 400 mm" as 800 mm.
_NUMBER_AND_UNIT = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?|inf|nan))"
    r"(?:\s+1(?=/))?\s*(?P<unit>/?\s*(?:[^\W\d_]|[²³])+"
    r"(?:(?:\s*(?:\^|\*\*)\s*-?\d)|[^\W\d_]|(?<=[^\W\d_])[23]|[⁻¹²³\s()*/·⋅])*)?\s*"
)
#: Most characters of a quantity: more are read as none.
LONGEST_TEXT = 200
#: A hardness number of a standard, with the load of the test after its name or not: "200 HV10".
_HARDNESS_NUMBER = re.compile(
    r"\s*(?P<number>\d+\.?\d*)\s*(?P<scale>HV|HBW?|HR[A-Z])[\d\s./]*", re.IGNORECASE
)
#: 1 HV (ISO 6507-1) and 1 HB (ISO 6506-1) are a kilogram-force per mm² of the imprint's surface [MPa].
HARDNESS_UNIT = 9.80665


@cache
def _registry() -> Any:
    return pint.UnitRegistry()


def is_known(unit: str) -> bool:
    """Return whether text is the name of a unit, of whatever kind."""
    with suppress(Exception):  # whatever pint's parser meets
        return len(unit) < 16 and any(spelt in _registry() for spelt in (unit, unit.lower()))
    return False


def parse(value: Any, unit: str) -> float:
    """Return a quantity as a number in `unit`: it is text, a pair of number and unit, or a quantity of pint.

    Raises ValueError with a sentence about what is allowed, also for a bare number.
    """
    if is_quantity(value):
        return _converted(value, unit)
    if is_pair(value):
        value = f"{float(value[0])!r} {value[1]}"
    if not isinstance(value, str):
        raise ValueError(f"needs its unit: {EXAMPLES[unit]}")
    return _read(value, unit)


@lru_cache(maxsize=4096)  # a study is read again with every change, and again from its result
def _read(value: str, unit: str) -> float:
    """Return a quantity that is text as a number in `unit`. Raises ValueError as `parse` does."""
    if "," in value:
        raise ValueError(f"has a comma: write the number with a decimal point, {EXAMPLES[unit]}")
    match = _NUMBER_AND_UNIT.fullmatch(value) if len(value) <= LONGEST_TEXT else None
    if match is None:
        raise ValueError(f"is not one number with one unit: {EXAMPLES[unit]} is expected")
    wanted = match["unit"]
    if not wanted:
        raise ValueError(f"needs its unit: {EXAMPLES[unit]}")
    if wanted in FACTORS.get(unit, {}):
        return float(match["number"]) * FACTORS[unit][wanted]
    # "mm3/Nm" is mm³/(N m), where pint has a unit Nm of yarn.
    wanted = re.sub(r"(?<=[^\W\d_])[23]", r"^\g<0>", re.sub(r"\bNm\b", "N*m", wanted.replace("⋅", "·")))
    above, slash, below = wanted.partition("/")
    # As papers write it: all that stands behind the slash is below it, as in "mm³/N·m".
    readings = [wanted, f"{above}/({below.replace('/', '*')})"] if slash else [wanted]
    problems = []
    for reading in readings:
        try:
            quantity = _registry().Quantity(
                float(match["number"]), f"1{reading}" if reading[0] == "/" else reading
            )
        except Exception:  # whatever pint's parser meets: AttributeError, errors of tokenize
            problems.append(ValueError(f"cannot be read: {EXAMPLES[unit]} is expected"))
            continue
        try:
            return _converted(quantity, unit)
        except ValueError as error:
            problems.append(error)
    raise problems[0] from None


def _converted(quantity: Any, unit: str) -> float:
    """Return a quantity as a number in `unit`. A turn is a cycle of a frequency, and 2π of an angle alone."""
    try:
        if unit != "deg":
            root = quantity.to_root_units()
            units = dict(root.unit_items())
            if unit == "Hz" and units == {"radian": 1, "second": -1}:
                return float(root.magnitude) / (2.0 * math.pi)
            if "radian" in units:
                raise pint.DimensionalityError(quantity.units, unit)
            if quantity.dimensionless:
                raise ValueError(f"needs its unit: {EXAMPLES[unit]}")
        return float(quantity.to(unit).magnitude)
    except pint.DimensionalityError:
        raise ValueError(f"has the wrong dimension: {EXAMPLES[unit]} is expected") from None
    except ValueError:
        raise
    except Exception:  # an array, or an error of a foreign registry
        raise ValueError(f"cannot be read: {EXAMPLES[unit]} is expected") from None


def _hardness(value: Any) -> Any:
    """Return a hardness number of Vickers or Brinell as a pressure; any other value as it is.

    Raises ValueError for a Rockwell number, which is a depth.
    """
    written = f"{float(value[0])!r} {value[1]}" if is_pair(value) else value
    short = isinstance(written, str) and len(written) <= LONGEST_TEXT
    match = _HARDNESS_NUMBER.fullmatch(written) if short else None
    if match is None:
        return value
    if match["scale"].upper().startswith("HR"):
        raise ValueError(
            "is a Rockwell number, which no factor makes a pressure: convert it to HV by ISO 18265 or ASTM "
            "E140, where 20, 30, 40, 50 and 60 HRC of steel are 238, 302, 392, 513 and 697 HV"
        )
    return text(HARDNESS_UNIT * float(match["number"]), "MPa")


def is_quantity(value: Any) -> bool:
    """Tell whether a value is a quantity of pint, of whatever registry."""
    return hasattr(value, "magnitude") and hasattr(value, "to")


def is_pair(value: Any) -> bool:
    """Tell whether a value is a number and its unit, such as (8, "N")."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        return False
    number, unit = value
    return isinstance(number, Real) and not isinstance(number, bool) and isinstance(unit, str)


def several(given: Any) -> tuple[Any, ...]:
    """Return one text, path, number or pair in a tuple; what is several as it is."""
    one = isinstance(given, str | PathLike | Real) or is_pair(given)
    return (given,) if one else tuple(given)


def one_by_one(value: Any) -> Any:
    """Return the elements of an array with a unit as a list; any other value as it is."""
    return list(value) if is_quantity(value) and getattr(value.magnitude, "ndim", 0) == 1 else value


def text(value: float, unit: str) -> str:
    """Return the number as text that `parse` reads back without loss."""
    return f"{value!r} {unit}"


#: Smallest and largest number that is neither 0 nor infinite, in the solver's units: far beyond any contact,
#: while no product of a few of them leaves the range of floating-point numbers.
TINIEST = 1.0e-30
LARGEST = 1.0e30


@dataclass(frozen=True)
class Range:
    """A range says which numbers a field allows."""

    least: float = 0.0
    or_equal: bool = False  # whether `least` itself is allowed
    most: float = math.inf
    infinite: bool = False

    def check(self, number: float, unit: str = "") -> float:
        """Return the number. Raises ValueError, saying what is allowed, unless it lies in the range."""
        if math.isnan(number):
            raise ValueError("is not a number")
        if math.isinf(number) and not self.infinite:
            raise ValueError("must be finite")
        if number < self.least or (number == self.least and not self.or_equal):
            bound = "at least" if self.or_equal else "greater than"
            raise ValueError(f"must be {bound} {self.least:g} {unit}".rstrip())
        if number > self.most:
            raise ValueError(f"must be at most {self.most:g} {unit}".rstrip())
        if number != 0.0 and math.isfinite(number) and not TINIEST <= abs(number) <= LARGEST:
            raise ValueError(
                f"is beyond what can be computed with: from {TINIEST:g} to {LARGEST:g} {unit}".rstrip()
            )
        return number


POSITIVE = Range()
NOT_NEGATIVE = Range(or_equal=True)


@dataclass(frozen=True)
class InUnit:
    """Annotates a field: a quantity in the study, a float in `unit` here; or one of `words`."""

    unit: str
    range: Range = POSITIVE
    words: tuple[str, ...] = ()
    hardness: bool = False  # whether hardness numbers are pressures, "200 HV"

    def read(self, value: Any) -> float | str:
        """Return the number in `unit`, or the word. Raises ValueError, saying what is allowed."""
        if isinstance(value, str) and value in self.words:
            return value
        try:
            pressure = _hardness(value) if self.hardness else value
            return self.range.check(parse(pressure, self.unit), self.unit)
        except ValueError as error:
            or_word = f", or {', '.join(repr(word) for word in self.words)}" if self.words else ""
            raise ValueError(f"{error}{or_word}") from None

    def write(self, value: float | str) -> str:
        """Return text that `read` reads back without loss."""
        return value if isinstance(value, str) else text(value, self.unit)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        written = core_schema.plain_serializer_function_ser_schema(self.write)
        return core_schema.no_info_plain_validator_function(self.read, serialization=written)


class LineLoad(float):
    """A load [N] that was given as one of a length [N/mm] is that times the length it acts on [mm]."""

    per_length: float
    length: float

    def __new__(cls, per_length: float, length: float = 1.0) -> Self:
        """Make a load of a force by a length [N/mm] and a length [mm]."""
        load = super().__new__(cls, per_length * length)
        load.per_length, load.length = per_length, length
        return load

    def __reduce__(self) -> tuple[type[Self], tuple[float, float]]:
        return type(self), (self.per_length, self.length)


@dataclass(frozen=True)
class Load(InUnit):
    """Annotates a load: a force, or a force of a length, which is times a length known later."""

    def read(self, value: Any) -> Any:
        """Return the load [N], or a `LineLoad`. Raises ValueError, saying what is allowed."""
        if isinstance(value, LineLoad):
            return value
        try:
            return super().read(value)
        except ValueError as refused:
            if "dimension" not in str(refused):
                raise
            try:
                return LineLoad(float(InUnit("N/mm").read(value)))
            except ValueError as error:
                either = ValueError(f"{refused}, or of a line contact one of its length, '18.5 N/mm'")
                raise (either if "dimension" in str(error) else error) from None

    def write(self, value: Any) -> str:
        """Return text that `read` reads back without loss."""
        return text(value.per_length, "N/mm") if isinstance(value, LineLoad) else text(value, self.unit)


@dataclass(frozen=True)
class Number:
    """Annotates a field: a number without a unit."""

    range: Range = POSITIVE

    def read(self, value: Any) -> float:
        """Return the number. Raises ValueError, saying what is allowed."""
        if isinstance(value, bool) or not isinstance(value, Real):
            written = value.strip() if isinstance(value, str) else ""
            comma = re.fullmatch(r"[+-]?\d+,\d+", written[:LONGEST_TEXT])
            point = f", with a decimal point: {written.replace(',', '.')}" if comma else ""
            raise ValueError(f"must be a number without a unit{point}")
        try:
            return self.range.check(float(value))
        except OverflowError:
            raise ValueError("is too large") from None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(float))
