"""What a tree of sections declares, by dotted name."""

from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo


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
