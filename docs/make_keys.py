"""Write docs/reference/keys.md, the page of every key of a study, from the declarations of the keys."""

import math
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

import warpwear
from warpwear import Study
from warpwear.calibration.bayes.command import InferSection
from warpwear.calibration.bayes.unknowns import NOISE
from warpwear.calibration.measurements import MeasuredTest
from warpwear.study.keys import TABLES, Demand, Rule, Section, declarations, key_of, section_in
from warpwear.study.units import Number, Range

PAGE = Path(__file__).parent / "reference" / "keys.md"
HEAD = """# Keys of a study

This page is written by `python docs/make_keys.py` from the declarations of the keys.

Quantities are text with a unit. In Python they may be pairs such as `(8, "N")`, or quantities of pint. The
unit here is the one of Python and results; any other of its kind may be given. *allowed* is what one key may
be by itself; a study that has not what its keys need is refused in a sentence when it is read. A default
that is marked *assumed* is a choice of ours, with its reason. A key that is given but not used gets a notice.
"""
OF_TESTS = """\
Each table is a test; repeated tests have one each. They stand in a file of their own or in that of a study,
for `warpwear calibrate wear FILE`, `friction`, `energy` and `loop` alike, and for `warpwear calibrate bayes
STUDY`; in Python they are dictionaries. Each takes what it needs: `calibrate friction` friction, or record
with `--result`; `calibrate energy` friction, `calibrate loop` loop. A number may end in its standard
uncertainty: `"0.80 +- 0.02 mm"`. A scar may have two diameters across each other, `["0.80 mm", "0.82 mm"]`,
and in an inference a coefficient of friction its distance, `"0.2 +- 0.02 at 30 mm"`; without it is that of
the end. Files lie beside the one that names them. Load, distance and lengths are those of a test, or else of
the study around the list; beside `--result` or `--study`, and in an inference, they have to agree with it.
"""
OF_INFER = """\
This section stands in a study file for `warpwear calibrate bayes`; see [Inference](../how-to/inference.md).
"""


def parts(annotation: Any) -> Iterator[Any]:
    """Yield what an annotation of a key says of its unit and of the allowed values."""
    if get_origin(annotation) is Literal:
        yield from (f'`"{value}"`' for value in get_args(annotation))
    elif get_origin(annotation) is Annotated:
        inner, *metadata = get_args(annotation)
        for part in metadata:
            yield from part.metadata if isinstance(part, FieldInfo) else [part]
        yield from parts(inner)
    elif get_origin(annotation) in (Union, types.UnionType, tuple):
        for inner in get_args(annotation):
            yield from parts(inner)
    elif annotation is bool:
        yield "`true`, `false`"
    elif annotation is int:
        yield int
    elif hasattr(annotation, "unit"):
        yield annotation


def bounds(
    least: float, most: float, *, or_equal: bool = True, infinite: bool = False, unit: str = ""
) -> str:
    """Return between which numbers a value must lie, in words."""
    behind = f" {unit}" if unit else ""
    if or_equal and math.isfinite(most):
        return f"{least:,g} to {most:,.0f}{behind}" if most >= 1e4 else f"{least:g} to {most:g}{behind}"
    low = f"{least:g}{behind} or more" if or_equal else f"above {least:g}{behind}"
    high = f", at most {most:g}{behind}" if math.isfinite(most) else ", also `inf`" if infinite else ""
    return low + high


def allowed(found: list[Any]) -> str:
    """Return what a key may be. found: the parts of its annotation."""
    told = [part for part in found if isinstance(part, str)]
    for part in found:
        span = getattr(part, "range", None)
        if isinstance(span, Range):
            unit = "" if isinstance(part, Number) else part.unit
            told.append(
                bounds(span.least, span.most, or_equal=span.or_equal, infinite=span.infinite, unit=unit)
            )
            if getattr(part, "hardness", False):
                told.append("a number of Vickers or Brinell")
    least, most = ([getattr(part, name) for part in found if hasattr(part, name)] for name in ("ge", "le"))
    if least:
        told.append("whole numbers " + bounds(least[0], most[0] if most else math.inf))
    elif int in found:
        told.append("any whole number")
    return ", ".join(dict.fromkeys(told))


def condition(rule: Rule) -> str:
    """Return when a key is used, as a rule has it."""
    if not rule.values:
        return rule.otherwise.replace("not: ", "not where ").format("…")
    if rule.values == (None,):
        return f"without `{rule.name}`"
    name = "sliding.kinematics" if rule.name == "kinematics" else rule.name  # as the study comes to it
    return f"with `{name}` = " + " or ".join(f'`"{value}"`' for value in rule.values)


def demand_text(demand: Demand) -> str:
    """Return what a key demands of others, in words."""
    values = " or ".join(f'`"{value}"`' for value in demand.values)
    what = demand.what or f"`{demand.name}`" + f" = {values}" * bool(values)
    of = " or ".join("`inf`" if value == math.inf else f'`"{value}"`' for value in demand.of)
    where = "".join(f" {condition(rule)}" for rule in demand.where)
    return f"{of} " * bool(of) + ("does not go with" if demand.excludes else "needs") + f" {what}{where}"


def entry(name: str, of_section: int) -> str:
    """Return the lines about a key. of_section: number of its rules that its section has."""
    info, declared = key_of(Study, name), declarations(Study)[name]
    assert info is not None
    found = [*info.metadata, *parts(info.annotation)]
    default = "none" if info.default is None else f"`{info.default}`" if info.default != "" else "empty"
    if isinstance(info.default, bool | float | int):
        default = f"`{str(info.default).lower()}`"
    if declared.assumed:
        default += f", *assumed*: {declared.assumed}"
    used = [condition(rule) for rule in declared.applies[of_section:]]
    facts = {
        "allowed": allowed(found),
        "default": "" if info.is_required() else default,
        "used": " and ".join(rule for rule in used if rule.startswith("with")),
    }
    told = ["**required**"] if info.is_required() else []
    told += [f"*{what}* {value}" for what, value in facts.items() if value]
    told += [rule for rule in used if not rule.startswith("with")]
    told += [demand_text(demand) for demand in declared.demands]
    return f"- `{name}`: {info.description}\\\n  " + " · ".join(told)


def page() -> str:
    """Return the whole page."""
    keys = {name: info for name in declarations(Study) if (info := key_of(Study, name)) and name != "assumed"}
    sections = [name for name, info in keys.items() if section_in(info.annotation) is not None]
    lines = [HEAD]
    for section in sections:
        rules = declarations(Study)[section].applies
        lines.append(f"## [[{section}]]\n" if section in TABLES else f"## [{section}]\n")
        for told in (condition(rule) for rule in rules):
            lines.append(f"This section {told if told.startswith('does not') else f'is used {told}'}.\n")
        if section.endswith("layers"):
            lines.append(f"Each table is one of the {keys[section].description}.\n")
        here = [name for name in keys if name.rpartition(".")[0] == section and name not in sections]
        lines += [*(entry(name, len(rules)) for name in here), ""]
    return "\n".join([*lines, *beside(), ""])


def beside() -> list[str]:
    """Return the lines about [[test]] and [infer], which are of a file and not of a study."""
    noise = [f'- `infer.unknown."{name}"`: {what}' for name, what in NOISE.items()]
    tests = ["## [[test]]\n", OF_TESTS, *of(MeasuredTest, "test"), ""]
    return [*tests, "## [infer]\n", OF_INFER, *of(InferSection, "infer"), *noise]


def of(section: type[Section], name: str) -> list[str]:
    """Return a line a key of a section that stands beside a study."""
    lines = []
    for key, info in section.model_fields.items():
        every = [*info.metadata, *parts(info.annotation)]
        unit = next((unit for part in every if (unit := getattr(part, "unit", ""))), "")
        lines.append(f"- `{name}.{key}`: {info.description}" + f", in `{unit}`" * bool(unit))
    return lines


if __name__ == "__main__":
    if not Path(warpwear.__file__).is_relative_to(PAGE.parents[2]):
        sys.exit(f"{warpwear.__file__} is not of this checkout: set PYTHONPATH to the checkout's folder.")
    PAGE.write_text(page(), encoding="utf-8")
