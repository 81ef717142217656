"""Sections of a study are made of keys, each declared once with all that is known of it.

A key has a unit, a default, allowed values and a meaning. Numbers are kept in mm, N, MPa and s. A key whose
default is a choice of ours and not the user's carries `assumed`, which `warpwear show` and the results
repeat. Keys that are not used under the choices made are ignored with a notice (see `Rule`), so that changing
one key can change a kind.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic.fields import FieldInfo

from warpwear.study.units import NOT_NEGATIVE, Quantity

Length = Annotated[float, Quantity("mm")]
LengthOrZero = Annotated[float, Quantity("mm", NOT_NEGATIVE)]
Pressure = Annotated[float, Quantity("MPa")]
Hardness = Annotated[float, Quantity("MPa", hardness=True)]


@dataclass(frozen=True)
class Rule:
    """One condition under which a key is used; see `when`."""

    name: str  # dotted key of a study, or a property of its content or of a section
    values: tuple[Any, ...]  # of that, under which the key is used
    otherwise: str  # end of the sentence about a key that is not used; {} is the value

    def why_not(self, study: BaseModel) -> str | None:
        """Return the end of the sentence about a key that the study does not use; None where it may."""
        value: Any = study
        for part in self.name.split("."):
            value = getattr(value, part, None)
        return None if value in self.values else self.otherwise.format(value)


def when(name: str, *values: Any, otherwise: str | None = None) -> tuple[Rule, ...]:
    """Return the rule that a key is used where `name` has one of the values; without any, where it is true.

    otherwise: what to say of the key elsewhere, by default "does not apply to NAME = 'VALUE'". Rules are
    tuples, which add up.
    """
    return (Rule(name, values or (True,), otherwise or f"does not apply to {name} = '{{}}'"),)


@dataclass(frozen=True)
class Declared:
    """A key declares this beside its type, default and meaning."""

    #: Why this default was chosen, where it is a physical assumption.
    assumed: str | None = None
    #: When the key is used; the first rule that does not hold says why it is not. Those of a section hold for
    #: its keys too.
    applies: tuple[Rule, ...] = ()
    #: "THING" that keys of the section say in different ways; "THING: WAY" where some say it together.
    one_of: str | None = None
    #: Dotted name before the key was renamed.
    formerly: str | None = None
    #: Old and new name of a value.
    former_value: tuple[str, str] | None = None
    #: What pydantic knows of the key; set by `declarations`.
    field: FieldInfo | None = None

    def __call__(self, schema: dict[str, Any]) -> None:
        """Pydantic calls it with the key's JSON schema, to which it adds why the default was assumed."""
        if self.assumed is not None:
            schema["assumed"] = self.assumed


def key(default: Any = ..., meaning: str = "", **declared: Any) -> Any:
    """Declare a key of a section, with all that is known of it. declared: see the fields of `Declared`."""
    return Field(default, description=meaning, json_schema_extra=Declared(**declared))


class Section(BaseModel):
    """A section is frozen and takes no key that is not declared; `_check` says whether its keys agree.

    Copies and pickles hold its keys alone: what a `cached_property` keeps would be stale in a changed copy.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    @model_validator(mode="after")
    def _checked(self) -> Self:
        self._check()
        return self

    def _check(self) -> None:
        """Refuse keys that do not go together: raises ValueError with one sentence."""

    def __getstate__(self) -> dict[Any, Any]:
        return super().__getstate__() | {"__dict__": self._keys_of(self)}

    def __copy__(self) -> Self:
        copied = super().__copy__()
        object.__setattr__(copied, "__dict__", self._keys_of(copied))
        return copied

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        copied = super().__deepcopy__(memo)
        object.__setattr__(copied, "__dict__", self._keys_of(copied))
        return copied

    @staticmethod
    def _keys_of(section: BaseModel) -> dict[str, Any]:
        return {name: value for name, value in vars(section).items() if name in type(section).model_fields}


#: Most letters of a name that a message repeats.
LONGEST_NAME = 80


def no_such_key(model: type[BaseModel], name: str, *, now: str = "") -> str:
    """Return the sentence about a name that no key has, with one so called elsewhere or a near one beside.

    now: the name under the section's new name, where it was typed under an old one.
    """
    section, _, last = (now or name).rpartition(".")
    last = last[:LONGEST_NAME]
    parts = {key: key.rpartition(".") for key in declarations(model)}
    siblings = {end: key for key, (above, _, end) in parts.items() if above == section}
    near = [key for key, (_, _, end) in parts.items() if end == last]
    near += [siblings[end] for end in get_close_matches(last, siblings, n=1)]
    hint = f"did you mean '{near[0]}'?" if near else f"allowed are {', '.join(siblings.values())}."
    shown = name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}…"
    return f"'{shown}' is no key of a study; {hint}"


def key_of(model: type[BaseModel], name: str) -> FieldInfo | None:
    """Return the field of a dotted key; None where there is no such key."""
    declared = declarations(model).get(name)
    return declared.field if declared else None


def section_in(annotation: Any) -> type[BaseModel] | None:
    """Return the section that an annotation, maybe optional, stands for; None for a key."""
    options = getattr(annotation, "__args__", None) or (annotation,)
    return next((o for o in options if isinstance(o, type) and issubclass(o, BaseModel)), None)


def given_keys(section: BaseModel, prefix: str = "") -> set[str]:
    """Return the dotted names of the keys that were given, not left to their defaults."""
    found = set()
    for name in section.model_fields_set:
        value = getattr(section, name)
        found |= given_keys(value, f"{prefix}{name}.") if isinstance(value, BaseModel) else {prefix + name}
    return found


@cache
def declarations(model: type[BaseModel], prefix: str = "") -> Mapping[str, Declared]:
    """Map dotted names of keys and sections to what they declare, with the rules of sections above them."""
    found: dict[str, Declared] = {}
    for name, info in model.model_fields.items():
        extra = info.json_schema_extra
        declared = replace(extra if isinstance(extra, Declared) else Declared(), field=info)
        found[prefix + name] = declared
        section = section_in(info.annotation)
        if section is not None:
            for below, of_key in declarations(section, f"{prefix}{name}.").items():
                found[below] = replace(of_key, applies=(*declared.applies, *of_key.applies))
    return MappingProxyType(found)


def inapplicable(study: BaseModel) -> dict[str, str]:
    """Map keys that nothing uses under the choices made to the end of a sentence that says why."""
    found = {}
    for name, declared in declarations(type(study)).items():
        reasons = [why for rule in declared.applies if (why := rule.why_not(study))]
        if reasons:
            found[name] = reasons[0]
    return found


def unused_key_notices(study: BaseModel) -> list[str]:
    """Return a sentence about each reason why keys are given but not used."""
    given = given_keys(study)
    reasons: dict[str, list[str]] = {}
    for name, why in inapplicable(study).items():
        if name in given:
            reasons.setdefault(why, []).append(name)
    return [
        f"{', '.join(names)} {why if len(names) == 1 else why.replace('does not', 'do not', 1)}."
        for why, names in reasons.items()
    ]


def alternatives_of(model: type[BaseModel], name: str) -> set[str]:
    """Return the keys that say the same as a key, or as a section that it lies in, in other ways."""
    keys = declarations(model)
    found: set[str] = set()
    above = ""
    for part in name.split("."):
        section, above = above, f"{above}.{part}".lstrip(".")
        one_of = keys[above].one_of if above in keys else None
        if one_of is None:
            continue
        for other, declared in keys.items():
            said = declared.one_of or ""
            same_thing = other.rpartition(".")[0] == section and said.split(":")[0] == one_of.split(":")[0]
            if same_thing and other != above and (said != one_of or ":" not in said):
                found.add(other)
    return found


def value_of(nested: Any, name: str) -> Any:
    """Return the value of a dotted key; None where there is none."""
    for part in name.split("."):
        nested = nested.get(part) if isinstance(nested, dict) else None
    return nested
