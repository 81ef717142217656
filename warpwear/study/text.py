"""A study is written as TOML text, for files and for people."""

import math
from collections.abc import Collection, Mapping
from pathlib import Path
from reprlib import Repr
from typing import Any

import tomli_w
from pydantic import BaseModel, ValidationError, create_model

from warpwear.errors import InputError, escaped
from warpwear.study.keys import TABLES, key_of, no_such_key, plural, section_in
from warpwear.study.loading import FILES, nested
from warpwear.study.units import is_quantity

#: Writes a value into a sentence, what is long or deep in short.
_SHOWN = Repr()
_SHOWN.maxstring = _SHOWN.maxother = 200


def to_toml(keys: Mapping[str, Any], assumed: Mapping[str, str]) -> str:
    """Return keys and their values as TOML that `Study.load` reads back without loss.

    assumed: why keys were assumed, defaults included, which look like given values in this text.
    """
    files = {name: escaped(str(Path(keys[name]).absolute())) for name in FILES if keys.get(name)}
    sections = nested({**keys, **files})
    return tomli_w.dumps(sections | ({"assumed": dict(assumed)} if assumed else {}))


def to_marked_toml(keys: Mapping[str, Any], assumed: Mapping[str, str], given: Collection[str]) -> str:
    """Return keys as TOML for people: those not given are marked, assumptions give their reasons."""
    lines: list[str] = []
    section = ""
    for name, value in keys.items():
        if name in TABLES:  # of which every key was given
            lines += [
                line for table in value for line in ("", f"[[{name}]]", tomli_w.dumps(readable(table))[:-1])
            ]
            continue
        parent, _, key = name.rpartition(".")
        if parent != section:
            section = parent
            lines += ["", f"[{section}]"]
        text = tomli_w.dumps({key: readable(value)}, indent=0).strip().replace("\n", " ")
        mark = f"ASSUMED: {assumed[name]}" if name in assumed else "" if name in given else "default"
        lines.append(f"{text:<38}# {mark}" if mark else text)
    return "\n".join(lines[1:])


def readable(value: Any) -> Any:
    """Return text with units as a person would write it: 3 um for 0.003 mm, 20 mm/min for 0.333 mm/s."""
    if isinstance(value, tuple | list):
        return [readable(v) for v in value]
    if isinstance(value, dict):
        return {name: readable(v) for name, v in value.items()}
    if not isinstance(value, str):
        return value
    value = escaped(value)
    first, _, unit = value.partition(" ")
    try:
        number = float(first)
    except ValueError:
        return value
    if unit == "mm" and 0.0 < abs(number) < 0.1:
        return _short(1.0e3 * number, "um", back=1.0e-3) or value
    if unit == "MPa" and 1.0e4 <= abs(number) < math.inf:
        return _short(1.0e-3 * number, "GPa", back=1.0e3) or value
    if unit == "mm/s":
        return _short(60.0 * number, "mm/min", back=1.0 / 60.0) or value
    return _short(number, unit, back=1.0) or value


def _short(number: float, unit: str, *, back: float) -> str | None:
    """Return the number in few digits; None where it has more."""
    text = f"{number:g} {unit}"
    exact = abs(float(f"{number:g}") * back - number * back) <= 1e-15 * abs(number * back)
    return text if exact or number == float(f"{number:g}") else None


def read_section(name: str, kind: Any, content: Any) -> Any:
    """Return a section that stands beside those of a study. Raises InputError with one sentence."""
    fields: Any = {name: (kind, ...)}
    whole = create_model("Whole", **fields)
    try:
        return getattr(whole.model_validate({name: content}), name)
    except ValidationError as error:
        raise InputError(sentence(error, whole)) from None


def sentence(error: ValidationError, model: type[BaseModel]) -> str:
    """Return a sentence about the first problem of a study, for its author."""
    # A misspelt section is unknown and leaves the right one missing: the first is the cause.
    first = min(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
    # Branches of a union (an int or one of some words) are pydantic's, not the user's.
    of_table = next((t for t in (*TABLES, "test") if ".".join(map(str, first["loc"])).startswith(t)), "")
    name = ".".join(
        str(p + bool(of_table) if isinstance(p, int) else p)  # people number tables from 1
        for p in first["loc"]
        if p != "str" and not str(p).startswith(("literal[", "constrained-", "function-", "tuple[", "list["))
    )
    kind, value = first["type"], first.get("input")
    text = _SHOWN.repr(str(value) if is_quantity(value) else value)
    if kind == "extra_forbidden":
        return no_such_key(model, name)
    if kind == "missing":
        return f"{name} is missing{_expected(model, name)}."
    if of_table and name == of_table and kind != "value_error":
        return f"{name} = {text} is no list of {plural(name)}; write [[{name}]] and the keys of one below it."
    if kind in ("tuple_type", "list_type"):
        example = "'test-1.csv'" if kind == "list_type" else "'30 mm', '240 mm'"
        return f"{name} = {text}: must be a list in brackets, such as [{example}]."
    if kind in ("model_type", "dict_type", "model_attributes_type"):
        if of_table == "test":
            must = "must be a mapping such as {'volume': '0.018 mm^3'}; in a file: [[test]]"
            return f"tests[{first['loc'][1]}] = {text} {must}."
        return f"{name} = {text} is not a section; write [{name}] and its keys below it."
    if kind == "string_type":
        return f"{name} = {text}: must be text in quotes."
    message = str(first["ctx"]["error"]) if "ctx" in first and "error" in first["ctx"] else first["msg"]
    info = key_of(model, name)
    if kind == "value_error" and (not name or (info and section_in(info.annotation))):
        return f"{message}."  # of a whole section, so it says its names itself
    if kind == "literal_error":
        branches = [e for e in error.errors() if e["type"] == kind and e["loc"][:2] == first["loc"][:2]]
        options = sorted({str(e["ctx"]["expected"]) for e in branches})
        more = " or a degree from 0 to 12" if name.endswith(".level") else ""
        return f"{name} = {text} is not allowed; allowed: {', '.join(options)}{more}."
    if kind in ("string_pattern_mismatch", "string_too_long"):  # of study.name, a folder's
        message = "allowed are up to 100 letters, digits, spaces and the signs . _ + -"
    return f"{name} = {text}: {message[:1].lower()}{message[1:]}."


def _expected(model: type[BaseModel], name: str) -> str:
    info: Any = key_of(model, name)
    section = section_in(info.annotation) if info is not None else None
    if section is not None:
        fields = section.model_fields
        needed = [key for key, info in fields.items() if info.is_required()]
        others = f"; it may have {', '.join(k for k in fields if k not in needed)}" if needed else ""
        return f": a section [{name}] with {', '.join(needed or fields)}{others}"
    meaning = getattr(info, "description", None)
    return f": {meaning}" if meaning else ""
