"""One plain sentence out of a failed validation: the field, the value, what is allowed."""

from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError

from warpwear.schema import all_keys, key_of, section_in


def sentence(error: ValidationError, model: type[BaseModel]) -> str:
    """The first problem of a study, for its author."""
    # A misspelt section is unknown and leaves the right one missing: the first is the cause.
    first = min(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
    # Branches of a union (an int or one of some words) are pydantic's, not the user's.
    name = ".".join(
        str(p) for p in first["loc"] if not str(p).startswith(("literal[", "constrained-", "function-"))
    )
    kind, value = first["type"], first.get("input")
    if kind == "extra_forbidden":
        near = get_close_matches(name, all_keys(model), n=1, cutoff=0.5)
        hint = (
            f"; did you mean '{near[0]}'?" if near else f"; allowed are {', '.join(_siblings(model, name))}."
        )
        return f"'{name}' is no key of a study{hint}"
    if kind == "missing":
        return f"{name} is missing{_expected(model, name)}."
    if kind in ("tuple_type", "list_type"):
        return f"{name} = {value!r}: must be a list in brackets, such as ['30 mm', '240 mm']."
    if kind in ("model_type", "dict_type", "model_attributes_type"):
        return f"{name} = {value!r} is not a section; write [{name}] and its keys below it."
    message = str(first["ctx"]["error"]) if "ctx" in first and "error" in first["ctx"] else first["msg"]
    info = key_of(model, name)
    if kind == "value_error" and (not name or (info and section_in(info.annotation))):
        return f"{message}."  # of a whole section, so it says its names itself
    if kind == "literal_error":
        options = sorted(
            {
                str(e["ctx"]["expected"])
                for e in error.errors()
                if e["type"] == "literal_error" and e["loc"][:2] == first["loc"][:2]
            }
        )
        more = " or a degree from 0 to 12" if name == "disc.level" else ""
        return f"{name} = {value!r} is not allowed; allowed: {', '.join(options)}{more}."
    if kind == "string_pattern_mismatch":  # of study.name, which names a folder
        message = "allowed are up to 100 letters, digits, spaces and the signs . _ + -"
    return f"{name} = {value!r}: {message[:1].lower()}{message[1:]}."


def _siblings(model: type[BaseModel], name: str) -> list[str]:
    depth = name.count(".")
    parent = name.rpartition(".")[0]
    return [k for k in all_keys(model) if k.count(".") == depth and k.rpartition(".")[0] == parent]


def _expected(model: type[BaseModel], name: str) -> str:
    info: Any = key_of(model, name)
    section = section_in(info.annotation) if info is not None else None
    if section is not None:
        return f": a section [{name}] with {', '.join(section.model_fields)}"
    meaning = getattr(info, "description", None)
    return f": {meaning}" if meaning else ""
