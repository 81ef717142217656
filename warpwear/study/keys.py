"""Sections of a study are made of keys, each declared once with all that is known of it.

A key has a unit, a default, allowed values and a meaning. Numbers are kept in mm, N, MPa and s. A key whose
default is a choice of ours and not the user's carries `assumed`, which `warpwear show` and the results
repeat. Keys that are not used under the choices made are ignored with a notice (see `Rule`), so that changing
one key can change a kind.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cache, partial, reduce
from itertools import chain
from types import MappingProxyType
from typing import Annotated, Any, Self, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic.fields import FieldInfo

from warpwear.errors import sentences
from warpwear.study.units import EXAMPLES, NOT_NEGATIVE, InUnit

Length = Annotated[float, InUnit("mm")]
LengthOrZero = Annotated[float, InUnit("mm", NOT_NEGATIVE)]
Pressure = Annotated[float, InUnit("MPa")]
Hardness = Annotated[float, InUnit("MPa", hardness=True)]


@dataclass(frozen=True)
class Rule:
    """One condition under which a key is used; see `when`."""

    name: str  # dotted key of a study, or a property of its content or of a section
    values: tuple[Any, ...]  # of that, under which the key is used; none: whatever is true
    otherwise: str  # end of the sentence about a key that is not used; {} is the value

    def why_not(self, study: BaseModel) -> str | None:
        """Return the end of the sentence about a key that the study does not use; None where it may."""
        value = attribute_of(study, self.name)
        holds = value in self.values if self.values else bool(value)
        return None if holds else self.otherwise.format(value)


def when(name: str, *values: Any, otherwise: str | None = None) -> tuple[Rule, ...]:
    """Return the rule that a key is used where `name` has one of the values; without any, where it is true.

    otherwise: what to say of the key elsewhere, by default "does not apply to NAME = 'VALUE'". Rules are
    tuples, which add up.
    """
    label = "sliding.kinematics" if name == "kinematics" else name  # as the study comes to it
    return (Rule(name, values, otherwise or f"does not apply to {label} = '{{}}'"),)


@dataclass(frozen=True)
class Demand:
    """One thing that a key needs of another one, or cannot stand beside; see `needs` and `excludes`."""

    name: str  # dotted key of a study, or a property of its content or of a section
    values: tuple[Any, ...]  # of that, which are needed or excluded; none: whatever says something
    of: tuple[Any, ...]  # values of the key that demand it; none: whatever is given and says something
    what: str = ""  # is needed, in words; by default the name and its values
    why: str = ""  # end of the sentence, with its comma or colon
    excludes: bool = False  # whether the values, or any, are excluded instead
    where: tuple[Rule, ...] = ()  # that have to hold, or nothing is demanded

    def refusal(self, study: BaseModel, key: str) -> str | None:
        """Return the sentence about a study that does not meet the demand of a key; None where it does."""
        demanding = attribute_of(study, key)
        if any(rule.why_not(study) for rule in self.where):
            return None
        if demanding not in self.of if self.of else not (demanding and is_given(study, key)):
            return None
        value, other = attribute_of(study, self.name), declarations(type(study)).get(self.name)
        if self.excludes and other and other.why_not(study):
            value = None
        if (value in self.values if self.values else bool(value)) != self.excludes:
            return None
        if self.excludes:
            allowed = _allowed(study, key, self.of) if self.of else "none"
            if self.values and not self.of:
                allowed = f"{self.name} = {_allowed(study, self.name, self.values)}"
            beside = f"{_named(study, self.name)}{self.why}"
            return f"{_named(study, key)} does not go with {beside}; allowed is {allowed}"
        what = self.what or _example(self.name, other.field if other else None)
        if self.values and not self.what:
            what = f"{self.name} = {_one_of(self.values)}, not {_shown(study, self.name)}"
        return f"{_named(study, key)} needs {what}{self.why}"


def attribute_of(study: BaseModel, name: str) -> Any:
    """Return the value of a dotted key or property; None where it, or its section, is not there."""
    value: Any = study
    return reduce(_attribute, filter(None, name.split(".")), value)


def uses(study: BaseModel, name: str) -> bool:
    """Tell whether a study uses a key or section: it says something, and applies under the choices made."""
    declared = declarations(type(study)).get(name, Declared())
    return bool(attribute_of(study, name)) and declared.why_not(study) is None


def _attribute(value: Any, part: str) -> Any:
    """Return a value's attribute, or of tables that of a number from 1; None where there is none."""
    if isinstance(value, tuple) and part.isdecimal():
        return dict(enumerate(value, 1)).get(int(part))
    return getattr(value, part, None)


def is_given(study: BaseModel, name: str) -> bool:
    """Tell whether a key or section was given, and not left to its default."""
    section, _, last = name.rpartition(".")
    names = getattr(attribute_of(study, section), "model_fields_set", ())
    return last in names and attribute_of(study, name) is not None


def _named(study: BaseModel, name: str) -> str:
    """Return a key with its value as a sentence names it, or a section in brackets."""
    value = attribute_of(study, name)
    if name in TABLES:
        return f"[[{name}]]"
    return f"[{name}]" if isinstance(value, BaseModel) else f"{name} = {_shown(study, name)}"


def _shown(study: BaseModel, name: str) -> str:
    """Return the value of a key as a sentence shows it: words in quotes, numbers with their unit."""
    value = attribute_of(study, name)
    if isinstance(value, str | bool):
        return _one_of([value])
    written = value_of(study.model_dump(), name)
    if isinstance(written, list | tuple):
        return ", ".join(map(str, written))
    number, _, unit = str(written).partition(" ")
    return f"{float(number):g} {unit}".rstrip()


def _example(name: str, field: FieldInfo | None) -> str:
    """Return the name of a key, followed by an example of it where it is a quantity."""
    kinds = get_args(field.annotation) if field else ()
    parts = chain.from_iterable(getattr(kind, "__metadata__", ()) for kind in kinds)
    return next((f"{name}, {EXAMPLES[part.unit]}" for part in parts if isinstance(part, InUnit)), name)


def _one_of(values: Iterable[Any]) -> str:
    """Return values as a list in a sentence: 'a', 'b' or 'c'."""
    *first, last = (str(v).lower() if isinstance(v, bool) else f"'{v}'" for v in values)
    return f"{', '.join(first)} or {last}" if first else last


def _allowed(study: BaseModel, name: str, barred: tuple[Any, ...]) -> str:
    """Return the values of a key that are left where some are barred."""
    options = get_args(declarations(type(study))[name].field.annotation)
    options = tuple(get_args(option) or (option,) for option in options or (bool,))  # or None
    left = (v for option in options for v in ((True, False) if option == (bool,) else option))
    return _one_of(value for value in left if not isinstance(value, type) and value not in barred)


def needs(name: str, *values: Any, of: Any = (), **others: Any) -> tuple[Demand, ...]:
    """Return the demand that `name` has one of the values, or says something at all, beside a key.

    of: value of the key, or a tuple of them, that demands it; by default any that is given. others: see the
    fields of `Demand`. Demands add up.
    """
    return (Demand(name, values, of if isinstance(of, tuple) else (of,), **others),)


def needs_compliance(of: Any, what: str = "compliance") -> tuple[Demand, ...]:
    """Return the demand that contacts yield, for values of a key. what: has the compliance, in words."""
    what += ": a finite contact.stiffness, or wear with stepping.scheme = 'implicit'"
    return needs("uses_bearing_area", False, of=of, what=what)


#: As `needs`: the demand that `name` has none of the values, or says nothing at all, beside a key.
excludes = partial(needs, excludes=True)


_refusal = sentences("refusals")


def refused(why: str, /, **values: Any) -> ValueError:
    """Return the error of a study that a rule refuses, by the name of its sentence. values: of its fields."""
    return ValueError(_refusal(why, **values))


NO_FIELD = FieldInfo()


@dataclass(frozen=True)
class Declared:
    """A key declares this beside its type, default and meaning."""

    #: Why this default was chosen, where it is a physical assumption.
    assumed: str | None = None
    #: When the key is used; the first rule that does not hold says why it is not. Those of a section hold for
    #: its keys too. Of a key that sections share it is the name of what they have them in.
    applies: tuple[Rule, ...] = ()
    #: What the key demands of others where it is used.
    demands: tuple[Demand, ...] = ()
    #: "THING" that keys of the section say in different ways; "THING: WAY" where some say it together.
    one_of: str = ""
    #: Whether the thing that the key says must be said, by this one or by another.
    must_be_said: bool = False
    #: Whether it names a file, relative to the study, which `surfaces.reading.read` reads.
    is_file: bool = False
    #: What pydantic knows of the key; set by `declarations`.
    field: FieldInfo = NO_FIELD

    def why_not(self, study: BaseModel) -> str | None:
        """Return the end of the sentence about the key where the study does not use it; None where it may."""
        return next((why for rule in self.applies if (why := rule.why_not(study))), None)


def key(default: Any = ..., meaning: str = "", **declared: Any) -> Any:
    """Declare a key of a section, with all that is known of it. declared: see the fields of `Declared`."""
    extra: Any = Declared(**declared)
    return Field(default, description=meaning, json_schema_extra=extra)


class Section(BaseModel):
    """A section is frozen and takes no key that is not declared; `_check` says whether its numbers agree.

    Its `features` are laws of features of a contact, by the dotted keys that ask for them and name them;
    `QUANTITIES` are what runs with these have, as `history/quantities.toml` says it, their looks included.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    @model_validator(mode="after")
    def _checked(self) -> Self:
        self._check()
        return self

    def _check(self) -> None:
        """Refuse keys that do not go together: raises ValueError with one sentence."""


#: Keys that are lists of tables, whose keys have their number from 1 before them: block.2.load.
TABLES = ("block", "counter.layers", "disc.layers")
_NUMBER = re.compile(r"\.\d+(?=\.)")
#: Most letters of a name that a message repeats.
LONGEST_NAME = 80


def no_such_key(model: type[BaseModel], name: str) -> str:
    """Return the sentence about a name that no key has, with one so called elsewhere or a near one beside."""
    section, _, last = _NUMBER.sub("", name).rpartition(".")
    last = last[:LONGEST_NAME]
    declared = declarations(model)
    siblings = {key.rpartition(".")[2]: key for key in declared if key.rpartition(".")[0] == section}
    near = [key for key in declared if key.rpartition(".")[2] == last]
    near += [key for key in siblings.values() if f"{declared[key].field.description} ".startswith(f"{last} ")]
    near += [siblings[end] for end in get_close_matches(last, siblings, n=1)]
    hint = f"did you mean '{near[0]}'?" if near else f"allowed are {', '.join(siblings.values())}."
    short = name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}…"
    whose = "test" if section == "test" else "study"
    return f"'{short}' is no key of a {whose}; {hint.replace('test.', '')}"


def plural(table: str) -> str:
    """Return what the tables of `TABLES` are called: blocks, layers."""
    return f"{table.rpartition('.')[2].removesuffix('s')}s"


def key_of(model: type[BaseModel], name: str) -> FieldInfo | None:
    """Return the field of a dotted key; None where there is no such key."""
    declared = declarations(model).get(_NUMBER.sub("", f"{name}.")[:-1])
    return declared.field if declared else None


def section_in(annotation: Any) -> type[BaseModel] | None:
    """Return the section that an annotation, maybe optional, stands for; None for a key."""
    options = getattr(annotation, "__args__", None) or (annotation,)
    inner = (get_args(o) if get_origin(o) is tuple else (o,) for o in options)  # of a list of tables
    options = tuple(chain.from_iterable(inner))
    return next((o for o in options if isinstance(o, type) and issubclass(o, BaseModel)), None)


@cache
def declarations(model: type[BaseModel], prefix: str = "") -> Mapping[str, Declared]:
    """Map dotted names of keys and sections to what they declare, with the rules of sections above them."""
    keys: dict[str, Declared] = {}
    for name, info in model.model_fields.items():
        extra: Any = info.json_schema_extra or Declared()
        declared: Declared = replace(extra, field=info)
        if isinstance(declared.applies, str):
            declared = replace(declared, applies=getattr(model, declared.applies))
        keys[prefix + name] = declared
        section = section_in(info.annotation)
        if section is not None:
            for below, of_key in declarations(section, f"{prefix}{name}.").items():
                keys[below] = replace(of_key, applies=(*declared.applies, *of_key.applies))
    return MappingProxyType(keys)


def check_keys(study: BaseModel) -> None:
    """Refuse keys that do not go together by their declarations: raises ValueError with one sentence.

    What keys of sections demand of each other comes first: what follows from the study builds on it.
    """
    _check_choices(study)
    for demand, name, declared in _demands(type(study)):
        if not declared.why_not(study) and (refusal := demand.refusal(study, name)):
            raise ValueError(refusal)


@cache
def _demands(model: type[BaseModel]) -> list[tuple[Demand, str, Declared]]:
    """Return all demands with the keys that make them, those on other keys first."""
    keys = declarations(model).items()
    demands = [(demand, name, declared) for name, declared in keys for demand in declared.demands]
    return sorted(demands, key=lambda d: "." not in d[0].name.removeprefix("pair."))


def _check_choices(study: BaseModel) -> None:
    """Refuse what is said in two ways, and what must be said and is not: raises ValueError."""
    model, keys = type(study), declarations(type(study))
    for name, declared in keys.items():
        if not declared.one_of or attribute_of(study, name.rpartition(".")[0]) is None:
            continue
        names = [name, *_other_ways(model, name)]
        said = [way for way in names if is_given(study, way)]
        titles = [f"[{way}]" if section_in(keys[way].field.annotation) else way for way in names]
        if name in said and len(said) > 1:
            raise ValueError(f"{name} and {titles[names.index(said[1])]} exclude each other")
        if declared.must_be_said and not said and not declared.why_not(study):
            raise ValueError(f"{', '.join(titles[:-1])} or {titles[-1]} must be given")


def alternatives_of(model: type[BaseModel], name: str) -> set[str]:
    """Return the keys that say the same as a key, or as a section that it lies in, in other ways."""
    within = f"{name}."
    above = [key for key in declarations(model) if within.startswith(f"{key}.")]
    return {other for key in above for other in _other_ways(model, key)}


@cache
def _other_ways(model: type[BaseModel], name: str) -> tuple[str, ...]:
    """Return the keys of the same section that say the same as a key or section in another way."""
    keys = declarations(model)
    if name not in keys or not (thing := keys[name].one_of.split(":")[0]):
        return ()
    siblings = [key for key in keys if key.rpartition(".")[0] == name.rpartition(".")[0] and key != name]
    ways = {key: keys[key].one_of for key in siblings if keys[key].one_of.split(":")[0] == thing}
    return tuple(key for key, way in ways.items() if way != keys[name].one_of or ":" not in way)


def dotted(sections: Mapping[str, Any], above: str = "", *, whole: str = "") -> dict[str, Any]:
    """Return the values of tables in tables by their dotted keys, an empty one by its own.

    whole: a key of tables that are values.
    """
    flat: dict[str, Any] = {}
    for key, value in sections.items():
        is_table = isinstance(value, Mapping) and bool(value) and whole not in value
        flat |= dotted(value, f"{above}{key}.", whole=whole) if is_table else {f"{above}{key}": value}
    return flat


def value_of(nested: Any, name: str) -> Any:
    """Return the value of a dotted key, of a list of tables by number from 1; None where there is none."""
    for part in name.split("."):
        if isinstance(nested, list | tuple):
            nested = {str(number): table for number, table in enumerate(nested, 1)}
        nested = nested.get(part) if isinstance(nested, dict) else None
    return nested
