"""A study as TOML text, for files and for people."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w

from warpwear.defaults import CONSTANTS
from warpwear.materials import material
from warpwear.schema import given_keys, key_of
from warpwear.unused_keys import inapplicable

if TYPE_CHECKING:
    from warpwear.study import Study


def to_toml(study: "Study") -> str:
    """Every key that applies, after defaults, as TOML that `Study.load` reads back without loss.

    Keys that were left open stay open: they follow from the others, also when those are changed later.
    """
    nested: dict[str, Any] = {}
    left_open = study.resolved
    for name, value in _applicable(study):
        if name in left_open:
            continue
        *parents, key = name.split(".")
        section = nested
        for parent in parents:
            section = section.setdefault(parent, {})
        section[key] = str(Path(value).absolute()) if name == "disc.surface" else value
    assumed = assumptions(study)  # of defaults too, which look like given values in this text
    return tomli_w.dumps(nested | ({"assumed": assumed} if assumed else {}))


def to_marked_toml(study: "Study") -> str:
    """The same for people: keys that apply, each default marked, each assumption with its reason."""
    given = given_keys(study)
    reasons = assumptions(study)
    lines: list[str] = []
    section = ""
    for name, value in _applicable(study):
        parent, _, key = name.rpartition(".")
        if parent != section:
            section = parent
            lines += ["", f"[{section}]"]
        text = tomli_w.dumps({key: _readable(value)}, indent=0).strip().replace("\n", " ")
        mark = f"ASSUMED: {reasons[name]}" if name in reasons else "" if name in given else "default"
        lines.append(f"{text:<38}# {mark}" if mark else text)
    return "\n".join(lines[1:])


def assumptions(study: "Study") -> dict[str, str]:
    """Dotted key -> why it was assumed: in the study's own words, or by a default that is a choice."""
    given = given_keys(study)
    found = {}
    for name, _ in _applicable(study):
        body, _, constant = name.partition(".")
        if name in study.assumed:
            found[name] = study.assumed[name]
        elif name not in given and body != "contact" and constant in CONSTANTS:
            known = material(getattr(study, body).material)
            found[name] = f"{known.name}, {known.condition}: {known.sources[constant]}"
        elif name not in given:
            info = key_of(type(study), name)
            extra = info.json_schema_extra if info else None
            if isinstance(extra, dict) and "assumed" in extra:
                found[name] = str(extra["assumed"])
    return found


def _applicable(study: "Study") -> Iterator[tuple[str, Any]]:
    """Dotted names and values of the keys that something uses."""
    skipped = inapplicable(study)
    content = study.model_dump(exclude={"assumed"})
    for name, value in study.resolved.items():
        section, _, key = name.partition(".")
        content[section][key] = value
    nested = _without_nothing(content)

    def walk(prefix: str, content: dict[str, Any]) -> Iterator[tuple[str, Any]]:
        for key, value in sorted(content.items(), key=lambda item: isinstance(item[1], dict)):
            if isinstance(value, dict):
                yield from walk(f"{prefix}{key}.", value)
            elif prefix + key not in skipped:
                yield prefix + key, value

    for name, content in nested.items():
        yield from walk(f"{name}.", content)


def _readable(value: Any) -> Any:
    """Text with units as a person would write it: 3 um for 0.003 mm, 20 mm/min for 0.333 mm/s."""
    if isinstance(value, list):
        return [_readable(v) for v in value]
    if not isinstance(value, str):
        return value
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
    """Few digits, if they are all there are."""
    text = f"{number:g} {unit}"
    exact = abs(float(f"{number:g}") * back - number * back) <= 1e-15 * abs(number * back)
    return text if exact or number == float(f"{number:g}") else None


def _without_nothing(nested: dict[str, Any]) -> dict[str, Any]:
    """TOML has no word for None: such keys are left out. Tuples become lists."""
    kept: dict[str, Any] = {}
    for key, value in nested.items():
        if isinstance(value, dict):
            kept[key] = _without_nothing(value)
        elif value is not None:
            kept[key] = list(value) if isinstance(value, tuple) else value
    return kept
