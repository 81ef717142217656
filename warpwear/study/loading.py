"""Studies come from TOML files, run folders and presets; here they are read, completed and changed."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from warpwear.errors import InputError
from warpwear.study.content import Content
from warpwear.study.keys import Declared, alternatives_of, declarations, no_such_key, value_of
from warpwear.study.materials import material
from warpwear.study.motion import LENGTHS
from warpwear.study.units import text


def presets() -> list[str]:
    """Return the names of the presets, sorted."""
    folder = resources.files("warpwear") / "presets"
    return sorted(p.name.removesuffix(".toml") for p in folder.iterdir() if p.name.endswith(".toml"))


#: Most characters of a study; the longest preset has 2,400.
MOST_CHARACTERS = 1_000_000
#: Most parts of a key, of which a study has three.
MOST_PARTS = 32
#: A key of TOML with more parts; what the parser does with them grows as their square.
_ENDLESS_KEY = re.compile(
    rf"""(?<![\w"'-])(?:(?:"[^"\n]*"|'[^'\n]*'|[\w-]++)[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}"""
)


def parse_toml(content: str) -> dict[str, Any]:
    """Return the tables in the text of a study.

    Raises ValueError, with what to write instead where that is plain, and RecursionError for endless nesting.
    """
    if len(content) > MOST_CHARACTERS:
        raise ValueError(f"it is longer than {MOST_CHARACTERS:,} characters")
    if endless := _ENDLESS_KEY.search(content):
        raise ValueError(
            f"line {content.count(chr(10), 0, endless.start()) + 1} has a key of more than {MOST_PARTS} parts"
        )
    try:
        return tomllib.loads(content)
    except tomllib.TOMLDecodeError as error:
        at = re.search(r"at line (\d+)", str(error))
        line = content.splitlines()[int(at[1]) - 1] if at else ""
        match = re.search(
            r"=\s*(?P<quantity>[+-]?\d+([.,]\d+)?(e[+-]?\d+)?\s*(?P<unit>[^\W\d_][^#,]*)?)", line
        )
        wrong = match["quantity"].strip() if match else ""
        right = wrong.replace(",", ".")
        if match and match["unit"]:
            right = f'"{right}", in quotes'
        raise ValueError(f"{error}{f': {wrong} is written {right}' if right != wrong else ''}") from None


def read_sections(path_or_preset: str | Path) -> dict[str, Any]:
    """Return the sections in a TOML file, a run folder or the preset of that name. Raises InputError."""
    if str(path_or_preset) in presets():
        source = resources.files("warpwear") / "presets" / f"{path_or_preset}.toml"
        return parse_toml(source.read_text(encoding="utf-8"))
    path = Path(path_or_preset)
    try:
        if path.is_dir():
            if not (path / "study.toml").is_file():
                raise InputError(f"STUDY = '{path}' is a folder without a study.toml.")
            path = path / "study.toml"
        elif path.exists() and not path.is_file() and path.parts[:2] != ("/", "dev"):
            raise InputError(f"STUDY = '{path}' is a pipe or a device; a file is expected")  # no endless wait
        with path.open(encoding="utf-8-sig") as file:
            sections = parse_toml(file.read(MOST_CHARACTERS + 1))
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(_no_such_study(str(path_or_preset))) from None
    except OSError as error:
        raise InputError(f"{str(path)[:200]} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not text, which a study is.") from error
    except (ValueError, RecursionError) as error:  # also numbers of thousands of digits, endless nesting
        raise InputError(f"{path} is not TOML: {error}.") from error
    for name in FILES:
        if isinstance(file := value_of(sections, name), str):
            insert(sections, name, str(path.parent.resolve() / file))
    return sections


def value_of_text(text: str) -> Any:
    """Return a value as TOML reads it; anything else is text, so that quotes may be left to the shell."""
    try:
        return parse_toml(f"value = {text}")["value"]
    except (ValueError, RecursionError):  # no TOML, a number of thousands of digits, endless nesting
        return text


def _no_such_study(name: str) -> str:
    near = get_close_matches(name, presets(), n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return f"STUDY = '{name}' is neither a file nor a preset ({', '.join(presets())}).{hint}"


#: Keys that name a file, relative to the study's.
FILES = ("disc.surface", "disc.synthetic.like", "counter.surface")
CONSTANTS = ("young", "poisson", "hardness")
MACRO_CELL = "10 um"


def fill(sections: dict[str, Any]) -> set[str]:
    """Fill sections, in place, with what follows from them; return the dotted names of the keys filled in.

    A value that cannot be understood is left to the validation of the study.
    """
    names: set[str] = set()
    for body in ("counter", "disc"):
        keys = sections.get(body)
        if not isinstance(keys, dict) or not isinstance(keys.get("material"), str):
            continue
        try:
            known = material(keys["material"])
        except ValueError:
            continue
        young, hardness = text(known.young, "MPa"), text(known.hardness, "MPa")
        values = {"young": young, "poisson": known.poisson, "hardness": hardness}
        missing = {name: value for name, value in values.items() if keys.get(name) is None}
        keys.update(missing)
        names |= {f"{body}.{name}" for name in missing}
    blocks = sections.get("block")
    if isinstance(blocks, list | tuple) and blocks and all(isinstance(block, dict) for block in blocks):
        sections.setdefault("sliding", {})
        contact = sections.setdefault("contact", {})
        loads = [block.get("load") for block in blocks]
        if isinstance(contact, dict) and contact.get("load") is None and None not in loads:
            contact["load"] = loads[0]
            names.add("contact.load")
    about, grid = sections.get("study"), sections.get("grid")
    macro = isinstance(about, dict) and about.get("model") == "macro"
    if macro and isinstance(grid, dict) and grid.get("cell") is None:
        grid["cell"] = MACRO_CELL
        names.add("grid.cell")
    return names


def with_new_names(sections: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return a copy of sections with new names for old ones, and a sentence about each of these.

    Raises InputError for a key that is given by its old name and by its new one.
    """
    renamed = {name: dict(keys) if isinstance(keys, dict) else keys for name, keys in sections.items()}
    reasons = renamed.get("assumed")
    notices: list[str] = []
    moves: dict[str, str] = {}
    for new, declared in declarations(Content).items():
        old = _former_name(new, declared)
        moved = old != new and _is_given(renamed, old)
        if moved:
            if _is_given(renamed, new):
                raise InputError(_given_twice(old, new))
            insert(renamed, new, _remove(renamed, old))
        if isinstance(reasons, dict) and old != new and old in reasons:
            reasons.setdefault(new, reasons.pop(old))
            moved = True
        value, now = declared.former_value or ("", "")
        current = value_of(renamed, new)
        if value and isinstance(current, str) and current == value:
            insert(renamed, new, now)
            notices.append(_renamed({f"{old if moved else new} = '{value}'": f"{new} = '{now}'"}))
        elif moved:
            moves[old] = new
    for old, new in _former_names().items():
        if "." not in old and old in renamed:  # what is left in a section that has another name
            left = renamed.pop(old)
            if not isinstance(left, dict):
                raise InputError(f"{old} = {left!r} is not a section; write [{new}] and its keys below it.")
            for key in left:
                raise InputError(no_such_key(Content, f"{old}.{key}", now=f"{new}.{key}"))
            renamed.setdefault(new, {})
    return renamed, [*notices, *([_renamed(moves)] if moves else [])]


def changes_with_new_names(flat: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return changes by dotted names with new names for old ones, and a sentence about each of these."""
    renamed: dict[str, Any] = {}
    notices: list[str] = []
    for old, value in flat.items():
        nested: dict[str, Any] = {}
        insert(nested, old, value)
        nested, more = with_new_names(nested)
        new = _former_names().get(old, old)
        if new in renamed or (new != old and new in flat):
            raise InputError(_given_twice(old, new))
        renamed[new] = value_of(nested, new)
        notices += more
    return renamed, notices


@cache
def _former_names() -> Mapping[str, str]:
    """Map names of keys and sections before they were renamed to their names now."""
    former = {_former_name(new, declared): new for new, declared in declarations(Content).items()}
    renamed = {old: new for old, new in former.items() if old != new}
    sections = {old.partition(".")[0]: new.partition(".")[0] for old, new in renamed.items()}
    return renamed | {old: new for old, new in sections.items() if old not in Content.model_fields}


def _former_name(name: str, declared: Declared) -> str:
    """Return the name of a key before it was renamed; of one that never was its own."""
    return declared.formerly or re.sub(r"^counter\.", "sphere.", name)


def _renamed(moves: Mapping[str, str]) -> str:
    old, new = ", ".join(moves), ", ".join(moves.values())
    if len(moves) == 1:
        return f"{old} has a new name, and the next release refuses the old one: type {new}."
    return f"{old} have new names, and the next release refuses the old ones: type {new}."


def _given_twice(old: str, new: str) -> str:
    return f"{old} and {new} are the old and the new name of one key: give {new} alone."


def change(nested: dict[str, Any], flat: Mapping[str, Any]) -> None:
    """Set keys, {"grid.cell": "2 um"}, in place; keys that say the same in another way are dropped."""
    numbered = {name.split(".")[1] for name in flat if name.startswith("block.")}
    if numbered:
        nested["block"] = {str(number): keys for number, keys in enumerate(nested.get("block", ()), 1)}
    for number in numbered - nested["block"].keys() if numbered else ():
        raise InputError(f"block.{number}: the study has {len(nested['block'])} blocks, numbered from 1.")
    for name, value in flat.items():
        for other in _dropped_by(name) - set(flat) - ({"block"} if numbered else set()):
            _remove(nested, other)
        insert(nested, name, value)
        assumed = nested.get("assumed")
        if not isinstance(assumed, dict):
            continue
        replaced = {name} | _dropped_by(name)
        for key in [k for k in assumed if k in replaced or k.startswith(f"{name}.")]:
            del assumed[key]
    if numbered:
        nested["block"] = [*nested["block"].values()]


def _dropped_by(name: str) -> set[str]:
    """Return the keys that a new value of this one makes void."""
    body, _, key = name.partition(".")
    if key == "material":  # another material has other constants
        return {f"{body}.{constant}" for constant in CONSTANTS}
    section, _, last = name.rpartition(".")
    lengths = {f"{section or 'sliding'}.{length}" for length in LENGTHS} - {name}
    if name == "block" or (body == "block" and last in LENGTHS):
        return lengths
    return alternatives_of(Content, name) | ({"block"} if section == "sliding" and last in LENGTHS else set())


def insert(nested: dict[str, Any], name: str, value: Any) -> None:
    """Set a dotted key in nested sections. Raises InputError where a value stands for one of these."""
    *parents, last = name.split(".")
    if len(parents) >= MOST_PARTS:
        raise InputError(no_such_key(Content, name))
    for depth, parent in enumerate(parents):
        nested = nested.setdefault(parent, {})
        if not isinstance(nested, dict):
            raise InputError(f"'{name}' is no key: {'.'.join(parents[: depth + 1])} has none below it.")
    nested[last] = value


def _is_given(nested: dict[str, Any], name: str) -> bool:
    section, last = _parent_of(nested, name)
    return last in section


def _remove(nested: dict[str, Any], name: str) -> Any:
    """Take a dotted key out and return its value; None where there is none."""
    section, last = _parent_of(nested, name)
    return section.pop(last, None)


def _parent_of(nested: dict[str, Any], name: str) -> tuple[dict[str, Any], str]:
    """Return the section that holds a dotted key, empty where there is none, and the key's name in it."""
    parent, _, last = name.rpartition(".")
    section = value_of(nested, parent) if parent else nested
    return section if isinstance(section, dict) else {}, last


#: Between a description and the keys changed since it was written.
CHANGED = "; changed: "
#: Most keys that are named; the rest are "others".
NAMED = 4
OTHERS = " and others"


#: Sections of whose changes a description does not speak: names, checks, and what is written.
NOT_DESCRIBED = ("study", "checks", "output", "assumed")


def with_changes(description: str, changed: Sequence[str]) -> str:
    """Return a description followed by the keys changed since, each once, those that it names included."""
    text, _, listed = description.partition(CHANGED)
    more = listed.endswith(OTHERS)
    known = [name for name in listed.removesuffix(OTHERS).split(", ") if name]
    known += [n for n in changed if n == "study.model" or n.partition(".")[0] not in NOT_DESCRIBED]
    names = list(dict.fromkeys(known))
    if not names:
        return description
    return f"{text}{CHANGED}{', '.join(names[:NAMED])}{OTHERS if more or len(names) > NAMED else ''}"
