"""Studies come from TOML files, run folders and presets; here they are read, completed and changed."""

import re
import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from importlib import resources
from pathlib import Path
from typing import Any

from warpwear.errors import InputError, explained, unescaped
from warpwear.study.bodies import CONSTANTS
from warpwear.study.content import Content
from warpwear.study.keys import TABLES, alternatives_of, declarations, no_such_key, plural, value_of
from warpwear.study.motion import LENGTHS


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
        return tomllib.loads(unescaped(content))
    except tomllib.TOMLDecodeError as error:
        twice = re.search(r"Cannot declare (\(.+\)) twice", str(error))
        name = ".".join(re.findall(r"'(\w+)'", twice[1])) if twice else ""
        if name in TABLES:
            raise ValueError(f"{error}: a list of tables has [[{name}]] above each") from None
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
    with explained(f"{str(path)[:200]} cannot be read"):
        if path.is_dir():
            path = path / "study.toml"
        if not path.is_file() and path.parts[:2] != ("/", "dev"):  # a pipe would be an endless wait
            raise InputError(_no_such_study(str(path_or_preset)))
        try:
            with path.open(encoding="utf-8-sig") as file:
                sections = parse_toml(file.read(MOST_CHARACTERS + 1))
        except (ValueError, RecursionError) as error:  # also numbers of thousands of digits, endless nesting
            raise InputError(f"{path} is not TOML: {error}.") from error
    for name in (*FILES, *TABULATED):
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
    return f"STUDY = '{name}' is no file, no run folder and no preset ({', '.join(presets())}).{hint}"


#: Keys that name a file, relative to the study's.
FILES = tuple(name for name, key in declarations(Content).items() if key.is_file)
#: Keys that may name a file of numbers, which become those of the study.
TABULATED = ("counter.gradient", "disc.gradient")
MACRO_CELL = "10 um"


def fill(sections: dict[str, Any]) -> set[str]:
    """Fill sections, in place, with what follows from them; return the dotted names of the keys filled in.

    A value that cannot be understood is left to the validation of the study.
    """
    names: set[str] = set()
    blocks = sections.get("block")
    if isinstance(blocks, Mapping):
        raise InputError("[block] is one table, and block a list of them: write [[block]] above each block.")
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


def nested(names: Mapping[str, Any]) -> dict[str, Any]:
    """Return the nested sections of keys by dotted names."""
    sections: dict[str, Any] = {}
    for name, value in names.items():
        insert(sections, name, value)
    return sections


def change(nested: dict[str, Any], flat: Mapping[str, Any]) -> None:
    """Set keys, {"grid.cell": "2 um"}, in place; keys that say the same in another way are dropped."""
    numbered = {table for table in TABLES if any(name.startswith(f"{table}.") for name in flat)}
    for table in numbered:
        rows = {str(number): keys for number, keys in enumerate(value_of(nested, table) or (), 1)}
        insert(nested, table, rows)
        named = (name[len(table) + 1 :].split(".")[0] for name in flat if name.startswith(f"{table}."))
        for number in (number for number in named if number not in rows):
            raise InputError(f"{table}.{number}: the study has {len(rows)} {plural(table)}, numbered from 1.")
    for name, value in flat.items():
        for other in _dropped_by(name) - set(flat) - ({"block"} & numbered):
            _remove(nested, other)
        value = getattr(value, "in_study", value)  # a calibration's text
        insert(nested, name, dict(value) if isinstance(value, Mapping) else value)  # keys may be set in it
        assumed = nested.get("assumed")
        if not isinstance(assumed, dict):
            continue
        replaced = {name} | _dropped_by(name)
        for key in [k for k in assumed if k in replaced or k.startswith(f"{name}.")]:
            del assumed[key]
    for table in numbered:
        if isinstance(rows := value_of(nested, table), dict):
            insert(nested, table, [*rows.values()])


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


def _remove(nested: dict[str, Any], name: str) -> None:
    """Take a dotted key out, where it is there."""
    parent, _, last = name.rpartition(".")
    section = value_of(nested, parent) if parent else nested
    if isinstance(section, dict):
        section.pop(last, None)
