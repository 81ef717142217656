"""What a run's page offers for a paper: a paragraph on methods, a table, both as LaTeX."""

import re
from collections.abc import Iterable
from typing import Any, TypeAlias

from warpwear.history.distances import with_unit
from warpwear.history.end_values import Summary
from warpwear.history.quantities import printed
from warpwear.laws.archard import BODIES, CALLED, said
from warpwear.page.words import WORDS, Answer
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


def methods_of(study: Study, s: Summary) -> str:
    """Write the paragraph that a paper's section on methods may begin with."""
    about: Any = {"wear": said(study.wear_laws)}
    about["layers"] = "; the ".join("{1}'s {2} ({3}, {4})".format(*layer) for layer in layers_of(study))
    return " ".join(filled("methods.txt", WORDS, escape=False, study=study, s=s, **about).split())


def layers_of(study: Study) -> list[tuple[str, ...]]:
    """List key and name of a body, name, thickness and wear coefficient of each of its layers."""
    return [
        (body, CALLED[body], layer.name, um(layer.thickness), printed(str(layer.wear.write())))
        for body in BODIES
        for layer in getattr(study, body).layers or ()
    ]


def table_of(study: Study, s: Summary, answers: Iterable[Answer]) -> list[Line]:
    """List quantity, value and unit of what went in and what came out."""
    unit, counter = printed("mm^3/N/m"), study.counter
    coefficients = zip(BODIES, study.wear_coefficients, strict=True)
    by_energy = study.wear.per_energy if study.wear.law == "energy" else {}
    length, newton = (study.strip, "N/mm") if study.strip else (1.0, "N")
    begun = [block for block in study.blocks if not block.start or block.start < s.distance]
    distance, of_distance = with_unit(s.distance).split()
    return [
        ("Load", ", ".join(shown(block.load / length) for block in begun), newton),
        *([] if counter.form.is_flat else [("Counter-body", counter.title, "")]),
        ("Sliding distance", distance, of_distance),
        ("Cell", shown(s.cell), "µm"),
        *(
            [("Hardness (cap of the pressure)", shown(study.hardness), "MPa")]
            if study.pair.caps_pressure
            else []
        ),
        *((f"Wear coefficient, {b}", shown(1e3 * k), unit) for b, k in coefficients),
        *(
            (f"{what} of {name}, {body}", number, its_unit)
            for body, _, name, *texts in layers_of(study)
            for what, text in zip(("Thickness", "Wear coefficient"), texts, strict=True)
            for number, _, its_unit in [text.partition(" ")]
        ),
        *((f"Wear of friction energy, {b}", shown(a), "mm³/J") for b, a in by_energy.items()),
        *((answer.label, answer.value, answer.unit) for answer in answers),
    ]


def to_latex(text: str) -> str:
    """Write a text so that LaTeX sets it as it is, raised digits and powers of ten as formulas."""
    written = "".join(LATEX.get(sign, sign) for sign in text)
    written = RAISED.sub(lambda match: f"$^{{{match[0].translate(LOWERED)}}}$", written)
    return POWER.sub(lambda match: rf"${match[1]} \cdot 10^{{{int(match[2])}}}$", written)


def latex_of(study: Study, methods: str, table: Iterable[Line]) -> str:
    """Write methods and table as LaTeX, with the laws of wear and friction between them."""
    return filled("paper.tex", {"tex": to_latex}, escape=False, study=study, methods=methods, table=table)
