"""Write docs/reference/keys.md, the page of every key of a study, from the declarations of the keys."""

import types
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from warpwear import Study
from warpwear.inference.command import InferSection
from warpwear.inference.data import KINDS
from warpwear.inference.unknowns import NOISE
from warpwear.study.keys import Rule, declarations, key_of, section_in
from warpwear.study.units import Quantity

PAGE = Path(__file__).parent / "reference" / "keys.md"
HEAD = """# Keys of a study

This page is written by `python docs/make_keys.py` from the declarations of the keys.

Quantities are text with a unit. In Python they may be pairs such as `(8, "N")`, or quantities of pint. The
unit in the table is the one of Python and results. A default that is marked *assumed* is a choice of ours,
and `warpwear show` gives its reason. A key that is given but not used gets a notice.
"""


def parts(annotation: Any) -> Iterator[Any]:
    """Yield the units and allowed values that an annotation of a key holds."""
    if get_origin(annotation) is Literal:
        yield from (f'`"{value}"`' for value in get_args(annotation))
    elif get_origin(annotation) is Annotated:
        inner, *metadata = get_args(annotation)
        yield from (part for part in metadata if isinstance(part, Quantity))
        yield from parts(inner)
    elif get_origin(annotation) in (Union, types.UnionType, tuple):
        for inner in get_args(annotation):
            yield from parts(inner)
    elif annotation is bool:
        yield "`true`, `false`"
    elif hasattr(annotation, "unit"):
        yield annotation


def condition(rule: Rule) -> str:
    """Return when a key is used, as a rule has it."""
    if rule.values == (True,):
        return rule.otherwise.replace("not: ", "not where ").format("…")
    if rule.values == (None,):
        return f"without `{rule.name}`"
    return f"with `{rule.name}` = " + " or ".join(f'`"{value}"`' for value in rule.values)


def row(name: str, of_section: int) -> str:
    """Return the line of the table about a key. of_section: number of its rules that its section has."""
    info, declared = key_of(Study, name), declarations(Study)[name]
    assert info is not None
    found = [*info.metadata, *parts(info.annotation)]
    unit = next((f"`{part.unit}`" for part in found if hasattr(part, "unit")), "")
    allowed = ", ".join(part for part in found if isinstance(part, str))
    default = "*required*" if info.is_required() else f"`{info.default}`" if info.default else ""
    if isinstance(info.default, bool | float | int):
        default = f"`{str(info.default).lower()}`"
    default += " *assumed*" if declared.assumed else ""
    used = "; ".join(condition(rule) for rule in declared.applies[of_section:])
    cells = (f"`{name}`", info.description or "", unit, allowed, default.strip(), used)
    return "| " + " | ".join(cells) + " |"


def page() -> str:
    """Return the whole page."""
    keys = {name: info for name in declarations(Study) if (info := key_of(Study, name)) and name != "assumed"}
    sections = [name for name, info in keys.items() if section_in(info.annotation) is not None]
    lines = [HEAD]
    for section in sections:
        rules = declarations(Study)[section].applies
        lines.append(f"## [{section}]\n")
        for told in (condition(rule) for rule in rules):
            lines.append(f"This section {told if told.startswith('does not') else f'is used {told}'}.\n")
        lines += ["| key | meaning | unit | allowed | default | used |", "|---|---|---|---|---|---|"]
        here = [name for name in keys if name.rpartition(".")[0] == section and name not in sections]
        lines += [*(row(name, len(rules)) for name in here), ""]
    return "\n".join([*lines, *of_infer(), ""])


def of_infer() -> list[str]:
    """Return the lines about the section [infer], which is of a study file and not of a study."""
    head = ["| key | meaning | unit |", "|---|---|---|"]
    keys = [f"| `infer.{name}` | {info.description} | |" for name, info in InferSection.model_fields.items()]
    values = [f"| `infer.measured.{kind}` | {what} | `{unit}` |" for kind, (unit, what) in KINDS.items()]
    noise = [f'| `infer.unknown."{name}"` | {what} | |' for name, what in NOISE.items()]
    told = (
        "This section stands in a study file for `warpwear calibrate bayes`, which "
        "[Inference](../how-to/inference.md) explains. A coefficient of friction may end in its distance, "
        'such as `"0.2 +- 0.02 at 30 mm"`.'
    )
    return ["## [infer]\n", told + "\n", *head, *keys, *(line.replace("``", "") for line in values), *noise]


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
