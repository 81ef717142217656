"""What was measured in a test, each number with its standard uncertainty: one list `[[test]]` serves all."""

import math
import re
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypeAlias

from pydantic import ConfigDict, GetCoreSchemaHandler, InstanceOf
from pydantic_core import CoreSchema, core_schema

from warpwear.errors import InputError
from warpwear.measured.experiment import Experiment
from warpwear.study import loading
from warpwear.study.keys import Length, Section, declarations, key
from warpwear.study.study import Study
from warpwear.study.text import read_section
from warpwear.study.units import LONGEST_TEXT, NOT_NEGATIVE, POSITIVE, InUnit, Number, Range, is_pair, parse

#: A value with its standard uncertainty: 0.018 +- 0.001 mm^3, 0.81 mm +- 10 um.
_WRITTEN = re.compile(
    r"\(?\s*(?P<value>\S+)(?:\s+(?P<own>[^\s±+][^±+]*?))?\s*(?:\+-|±)\s*(?P<error>[^\s)]+)\s*\)?(?P<unit>.*)"
)
_AT = re.compile(r"(?P<value>.*)\bat\s+(?P<at>\S.*)")
#: A load, or a length, that differs by more than this part from the study's is of another test.
OFF = 0.05


class Value(NamedTuple):
    """Hold a measured number; error: its standard uncertainty, None where unknown; at: a distance [mm]."""

    value: float
    error: float | None = None
    at: float | None = None


@dataclass(frozen=True)
class WithError:
    """Annotates a measured number in a unit, maybe with its uncertainty; without a unit a friction."""

    unit: str = ""

    def read(self, value: Any) -> Value | None:
        """Return the number. Raises ValueError, saying what is allowed."""
        if value is None or isinstance(value, Value):
            return value
        at, error = None, None
        text = value.strip() if isinstance(value, str) and len(value) <= LONGEST_TEXT else ""
        if not self.unit and (place := _AT.fullmatch(text)):
            value = text = place["value"].strip()
            at = parse(place["at"], "mm")
        if parts := _WRITTEN.fullmatch(text):
            value = f"{parts['value']} {parts['own'] or parts['unit']}"
            error = self._number(f"{parts['error']} {parts['unit']}", NOT_NEGATIVE)
        return Value(self._number(value, POSITIVE), error, at)

    def _number(self, value: Any, allowed: Range) -> float:
        if self.unit:
            return float(InUnit(self.unit, allowed).read(value))
        try:
            return Number(allowed).read(float(value) if isinstance(value, str) else value)
        except ValueError as error:
            plain = "is no number; no unit is expected, such as '0.60 +- 0.02'"
            raise ValueError(plain if "could not convert" in str(error) else str(error)) from None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


class Diameters(WithError):
    """Annotates one diameter of a scar, or two across each other."""

    def read(self, value: Any) -> Any:
        """Return one or two numbers. Raises ValueError, saying what is allowed."""
        if value is None or not isinstance(value, list | tuple) or isinstance(value, Value) or is_pair(value):
            return value if value is None else (super().read(value),)
        if not 1 <= len(value) <= 2:
            raise ValueError("must be one diameter, or a list of two across each other")
        return tuple(super(Diameters, self).read(each) for each in value)


Force = Annotated[Value | None, WithError("N")]
Distance = Annotated[Value | None, WithError("mm")]
Height = Annotated[Value | None, WithError("um")]
Area = Annotated[Value | None, WithError("mm^2")]
Speed = Annotated[Value | None, WithError("mm/s")]
Volume = Annotated[Value | None, WithError("mm^3")]
Ratio = Annotated[Value | None, WithError()]
Scar = Annotated[tuple[Value, ...] | None, Diameters("mm")]
File = str | Path | None


class MeasuredTest(Section):
    """One test: what was done, and what was measured in it."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    name: str | None = key(None, "of the test: entries of one name are places of it, whose mean counts once")
    load: Force = key(None, "normal load")
    distance: Distance = key(None, "sliding distance")
    radius: Length | None = key(None, "radius of the ball")
    track_radius: Length | None = key(None, "radius of the circle that the track runs on")
    track_length: Length | None = key(None, "length of the whole track")
    stroke: Distance = key(None, "length of one stroke, where a record has no position, for `repeats`")
    speed: Speed = key(None, "sliding speed, where a record has a time alone, for `repeats`")
    track_width: Length | None = key(
        None, "width of a track with its pile-up, where it is not found in `profile`"
    )
    volume: Volume = key(None, "worn volume of either body, for `calibrate wear`")
    volume_counter: Volume = key(None, "worn volume of the ball")
    volume_disc: Volume = key(None, "worn volume of the disc")
    area: Area = key(None, "area that shears, for `calibrate friction` without a run")
    volume_coat: Volume = key(None, "worn volume of a coat, for `calibrate wear --source coat`")
    volume_substrate: Volume = key(None, "worn volume of what lies beneath the coat")
    crater: Scar = key(None, "diameters of a ball's crater, and of the substrate in it")
    section: Area = key(None, "mean cross-section of the groove")
    scar: Scar = key(None, "diameter of the scar")
    width: Distance = key(None, "width of a circular track")
    sq_counter: Height = key(None, "Sq in the scar of the ball")
    sq_disc: Height = key(None, "Sq in the scar of the disc")
    friction: Ratio = key(None, "coefficient of friction")
    record: File | InstanceOf[Experiment] = key(None, "file of a course of friction", is_file=True)
    loop: File = key(None, "file of one cycle of fretting, for `calibrate loop`", is_file=True)
    profile: File = key(None, "file of a profile across the track, or of its topography", is_file=True)
    after: File = key(None, "file of the topography of the disc's scar; needs `before`", is_file=True)
    before: File = key(
        None, "file of the same place before the test, for `profile` and `after`", is_file=True
    )
    ball: File = key(None, "file of the topography of the worn ball", is_file=True)

    @property
    def way_of_groove(self) -> float | None:
        """Return the length of the whole track [mm], of a circle 2πR; None where neither is known."""
        return self.track_length or (self.track_radius and 2.0 * math.pi * self.track_radius)


Tests: TypeAlias = str | Path | Sequence[Mapping[str, Any]]
#: Keys that name a file.
FILES = [name for name, declared in declarations(MeasuredTest).items() if declared.is_file]
#: What an inference compares: its unit and what it is.
_NAMES = ("volume_counter", "volume_disc", "section", "scar", "sq_counter", "sq_disc", "friction")
_FIELDS = {name: MeasuredTest.model_fields[name] for name in _NAMES}
KINDS = {name: (field.metadata[0].unit, str(field.description)) for name, field in _FIELDS.items()}


def tests_of(tests: Any, **alike: Any) -> list[MeasuredTest]:
    """Check tables of tests. alike: keys that all of them have. Raises InputError."""
    if isinstance(tests, Sequence) and not isinstance(tests, str):
        tests = [{**alike, **test} if isinstance(test, Mapping) else test for test in tests]
    return list(read_section("test", list[MeasuredTest], tests))


def in_file(path: str | Path) -> tuple[dict[str, Any], Any]:
    """Read a TOML file: its sections but for the tests, and these, with their files beside it."""
    sections = loading.read_sections(path)
    tests = sections.pop("test", [])
    for test in tests if isinstance(tests, list) else ():
        for name in set(FILES) & set(test if isinstance(test, dict) else ()):
            if isinstance(test[name], str):
                test[name] = Path(path).parent / test[name]
    return sections, tests


def checked_tests(tests: Tests, **alike: Any) -> dict[str, MeasuredTest]:
    """Check tests, by what sentences call them; those in a file have what the study around them says.

    alike: keys that all of them have. Raises InputError.
    """
    if isinstance(tests, str | Path):
        sections, tests = in_file(tests)
        own = {name: sections[name] for name in sections.keys() - {"infer", "sweep"}}
        alike = (conditions_of(Study(**own)) if own else {}) | alike
    return {f"test.{number}": test for number, test in enumerate(tests_of(tests, **alike), 1)}


def check_conditions(test: MeasuredTest, named: str, study: Study) -> None:
    """Raise InputError for a test that is not the study's own."""
    own = tests_of([conditions_of(study)])[0]
    for name in ("load", "distance", "radius", "track_length", "track_radius"):
        here, there = getattr(test, name), getattr(own, name)
        if isinstance(here, Value):
            if here.error is not None:
                raise InputError(f"{named}.{name} has an uncertainty: allowed is an exact one beside a study")
            here, there = here.value, there.value
        if None not in (here, there) and not math.isclose(here, there, rel_tol=OFF):
            raise InputError(f"{named}.{name} is {here:g}, and the study has {there:g}: they have to agree")


def conditions_of(study: Study) -> dict[str, Any]:
    """Return what a study says of a test, as a table of it has it: load, distance and lengths."""
    sliding, load = study.sliding, study.contact.load
    lengths = {"radius": study.counter.nominal_radius, "track_length": sliding.stroke}
    lengths["track_radius"] = sliding.track_radius
    known = {name: (size, "mm") for name, size in lengths.items() if size and math.isfinite(size)}
    return {"load": Value(load), "distance": Value(sliding.total)} | known


def size_and_error(value: Any) -> tuple[float, float | None]:
    """Return a number and its standard uncertainty, of two diameters [mm] of their mean.

    That of two is what they have alike, or else their standard error: half their difference.
    """
    sizes = [value] if isinstance(value, Value) else value
    numbers = [size.value for size in sizes]
    errors = [size.error**2 for size in sizes if size.error is not None]
    apart = 0.5 * abs(numbers[0] - numbers[-1]) or None
    return statistics.fmean(numbers), math.sqrt(statistics.fmean(errors)) if errors else apart
