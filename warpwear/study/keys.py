"""What the sections of a study are made of: keys, each with its unit, default, allowed values and meaning.

The sections themselves are in `sections_*.py`. Numbers are kept in mm, N, MPa and s. A key whose default is
a choice of ours and not the user's carries `assumed`, which `warpwear show` and the results repeat. Keys
that no rule of the chosen kind uses are ignored with a notice (see `unused_keys`), so that changing one key
can change a kind.
"""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo

from warpwear.study.units import NOT_NEGATIVE, POSITIVE_OR_INFINITE, Number, Quantity, Range

Length = Annotated[float, Quantity("mm")]
LengthOrZero = Annotated[float, Quantity("mm", NOT_NEGATIVE)]
LengthOrInfinite = Annotated[float, Quantity("mm", POSITIVE_OR_INFINITE)]
Force = Annotated[float, Quantity("N")]
Pressure = Annotated[float, Quantity("MPa")]
PressureOrInfinite = Annotated[float, Quantity("MPa", POSITIVE_OR_INFINITE)]
Stiffness = Annotated[float, Quantity("N/mm^3", POSITIVE_OR_INFINITE)]
Angle = Annotated[float, Quantity("deg", Range(least=-360.0, or_equal=True, most=360.0))]
Time = Annotated[float, Quantity("s")]
Interval = Annotated[float, Quantity("s", Range(or_equal=True, infinite=True))]
Frequency = Annotated[float, Quantity("Hz")]
Speed = Annotated[float, Quantity("mm/s")]
PoissonRatio = Annotated[float, Number(Range(or_equal=True, most=0.5))]
HurstExponent = Annotated[float, Number(Range(most=1.0))]
Growth = Annotated[float, Number(Range(least=1.0, or_equal=True, most=10.0))]
Deviations = Annotated[float, Number(Range(least=3.0, or_equal=True))]
FrictionCoefficient = Annotated[float, Number(Range(most=3.0))]
Strokes = Annotated[int, Field(ge=0, le=1_000_000_000, strict=True)]
FrictionOffset = Annotated[float, Number(Range(or_equal=True, most=3.0))]
Ratio = Annotated[float, Number(Range(or_equal=True, most=1000.0))]
PerLength = Annotated[float, Quantity("1/mm")]
SurfaceEnergy = Annotated[float, Quantity("N/mm")]


def key(default: Any = ..., meaning: str = "", *, assumed: str | None = None) -> Any:
    """A key of a section. assumed: why this default was chosen, where it is a physical assumption."""
    extra: Any = {"assumed": assumed} if assumed else None
    return Field(default, description=meaning, json_schema_extra=extra)


class Section(BaseModel):
    """Frozen, and no key that is not declared."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


def all_keys(model: type[BaseModel], prefix: str = "") -> list[str]:
    """Dotted names of all keys and sections."""
    found = []
    for name, info in model.model_fields.items():
        found.append(prefix + name)
        section = section_in(info.annotation)
        if section is not None:
            found += all_keys(section, f"{prefix}{name}.")
    return found


def key_of(model: type[BaseModel], name: str) -> FieldInfo | None:
    """The declaration of a dotted key, if there is one."""
    info = None
    current: type[BaseModel] | None = model
    for part in name.split("."):
        if current is None or part not in current.model_fields:
            return None
        info = current.model_fields[part]
        current = section_in(info.annotation)
    return info


def section_in(annotation: Any) -> type[BaseModel] | None:
    """The section that an annotation, maybe optional, stands for."""
    options = getattr(annotation, "__args__", None) or (annotation,)
    return next((o for o in options if isinstance(o, type) and issubclass(o, BaseModel)), None)


def given_keys(section: BaseModel, prefix: str = "") -> set[str]:
    """Dotted names of the keys that were given, not left to their defaults."""
    found = set()
    for name in section.model_fields_set:
        value = getattr(section, name)
        found |= given_keys(value, f"{prefix}{name}.") if isinstance(value, BaseModel) else {prefix + name}
    return found
