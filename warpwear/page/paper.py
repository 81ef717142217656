"""What a run's page offers for a paper: a paragraph on methods, a table, both as LaTeX."""

import re
from collections.abc import Iterable
from typing import Any, TypeAlias

from warpwear.history.distances import with_unit
from warpwear.history.quantities import printed
from warpwear.laws.archard import BODIES, CALLED, said
from warpwear.page.words import disc_of, motion_of, source_of
from warpwear.results.formats.forms import filled
from warpwear.results.report import shown
from warpwear.study.rules import um
from warpwear.study.study import Study

Line: TypeAlias = tuple[str, str, str]  # quantity, value and unit
#: Signs that LaTeX takes for commands, and others that its fonts may lack -> what to write.
LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "µ": r"$\mu$"}
LATEX |= {sign: f"\\{sign}" for sign in "{}$&#%_"} | {"×": r"$\times$", "±": r"$\pm$", "−": "--", "–": "--"}
LATEX |= {"τ": r"$\tau$", "·": r"$\cdot$", "α": r"$\alpha$", "√": r"$\surd$"}
#: Raised signs, and the number with a power of ten as programs write it; neither stands in a formula yet.
RAISED, POWER = re.compile("[⁺⁻⁰¹²³⁴-⁹]+"), re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)(?!\w)")
LOWERED = str.maketrans("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789")


def methods_of(study: Study, s: dict[str, Any]) -> str:
    """Write the paragraph that a paper's section on methods may begin with."""
    said_of: Any = {"slider": f"A {study.counter.title}", "disc": disc_of(study), "source": source_of(s)}
    said_of |= {"wear": said(study.wear_laws), "friction": study.friction.law_with().said}
    layers = ["{1}'s {2} ({3}, {4})".format(*layer) for layer in layers_of(study)]
    said_of["layers"] = "; the ".join(layers)
    said_of["motion"] = motion_of(study, s["distance_mm"])
    return " ".join(filled("methods.txt", escape=False, study=study, s=s, **said_of).split())


def layers_of(study: Study) -> list[tuple[str, ...]]:
    """List key and name of a body, name, thickness and wear coefficient of each of its layers."""
    return [
        (body, CALLED[body], layer.name, um(layer.thickness), printed(str(layer.wear.write())))
        for body in BODIES
        for layer in getattr(study, body).layers or ()
    ]


def table_of(study: Study, s: dict[str, Any], answers: Iterable[dict[str, str]]) -> list[Line]:
    """List quantity, value and unit of what went in and what came out."""
    hardness, unit, counter = s["hardness_MPa"], printed("mm^3/N/m"), study.counter
    length, newton = (study.strip, "N/mm") if study.strip else (1.0, "N")
    distance, of_distance = with_unit(s["distance_mm"]).split()
    return [
        ("Load", ", ".join(shown(block["load_N"] / length) for block in s.get("blocks", [s])), newton),
        *([] if counter.form.is_flat else [("Counter-body", counter.title, "")]),
        ("Sliding distance", distance, of_distance),
        ("Cell", shown(s["cell_um"]), "µm"),
        *([("Hardness (cap of the pressure)", shown(hardness), "MPa")] if hardness else []),
        *((f"Wear coefficient, {b}", shown(k), unit) for b, k in s["wear_coefficient_mm3_per_Nm"].items()),
        *(
            (f"{what} of {name}, {body}", number, its_unit)
            for body, _, name, *texts in layers_of(study)
            for what, text in zip(("Thickness", "Wear coefficient"), texts, strict=True)
            for number, _, its_unit in [text.partition(" ")]
        ),
        *(
            (f"Wear of friction energy, {b}", shown(a), "mm³/J")
            for b, a in s.get("wear_coefficient_mm3_per_J", {}).items()
        ),
        *((answer["label"], answer["value"], answer["unit"]) for answer in answers),
    ]


def to_latex(text: str) -> str:
    """Write a text so that LaTeX sets it as it is, raised digits and powers of ten as formulas."""
    written = "".join(LATEX.get(sign, sign) for sign in text)
    written = RAISED.sub(lambda match: f"$^{{{match[0].translate(LOWERED)}}}$", written)
    return POWER.sub(lambda match: rf"${match[1]} \cdot 10^{{{int(match[2])}}}$", written)


def latex_of(study: Study, methods: str, table: Iterable[Line]) -> str:
    """Write methods and table as LaTeX, with the laws of wear and friction between them."""
    laws: Any = {"wear": study.wear_laws[0].formula, "friction": study.friction.law_with().formula}
    laws |= {"name": study.study.name, "methods": methods, "table": table}
    laws["layered"] = bool(study.counter.layers or study.disc.layers)
    return filled("paper.tex", {"tex": to_latex}, escape=False, **laws)
