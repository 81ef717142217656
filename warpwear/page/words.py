"""What a run's page says in words and numbers: what was asked, the answer, what it rests on, and for a paper.

The latter is a paragraph on methods and a table, both as LaTeX, too.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from warpwear.contact.balance import TOLERANCE
from warpwear.figures.wording import listed
from warpwear.history.distances import with_unit
from warpwear.history.end_values import ENDS, Summary
from warpwear.history.quantities import BY_NAME, Quantity, printed
from warpwear.laws.archard import BODIES, CALLED, said
from warpwear.page.effects import effect_of, numbers_of
from warpwear.results.ending import friction_of
from warpwear.results.formats.forms import filled
from warpwear.results.report import shown
from warpwear.study.keys import declarations, value_of
from warpwear.study.rules import um
from warpwear.study.study import Study
from warpwear.study.text import readable

Lines: TypeAlias = list[dict[str, Any]]  # of a table, name of a column -> value
#: What checks allow: part of a volume off Archard's, and of the area by the length of steps.
CONSERVED, STEPS = 1e-10, 0.1
#: Filters of words.txt.
WORDS: dict[str, Any] = {
    "file_name": lambda path: Path(path or "").name,
    "radii": lambda circles: listed([f"{radius:.4g}" for radius in circles]),
    "with_unit": with_unit,
}
APPROACH = "from the mean planes; below zero only peaks reach across"
Line: TypeAlias = tuple[str, str, str]  # quantity, value and unit
#: Signs that LaTeX takes for commands, and others that its fonts may lack -> what to write.
LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "µ": r"$\mu$"}
LATEX |= {sign: f"\\{sign}" for sign in "{}$&#%_"} | {"×": r"$\times$", "±": r"$\pm$", "−": "--", "–": "--"}
LATEX |= {"τ": r"$\tau$", "·": r"$\cdot$", "α": r"$\alpha$", "√": r"$\surd$"}
#: Raised signs, and the number with a power of ten as programs write it; neither stands in a formula yet.
RAISED, POWER = re.compile("[⁺⁻⁰¹²³⁴-⁹]+"), re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)(?!\w)")
LOWERED = str.maketrans("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789")


@dataclass(frozen=True)
class Answer:
    """Hold a number at the top. error: its uncertainty, if known. input_note: how far it is an input."""

    label: str
    value: str
    unit: str
    error: str = ""
    note: str = ""
    input_note: str = ""


def asked_of(study: Study, distance: float) -> str:
    """Say in one sentence what the run was to find. distance: that it has slid [mm]."""
    return filled("asked.txt", WORDS, escape=False, study=study, distance=distance)


def answers_of(study: Study, s: Summary) -> list[Answer]:
    """Give the five numbers that answer the question."""
    uniform = s.pressure_std <= 1e-6 * s.pressure_mean
    spread = "uniform" if uniform else f"standard deviation {s.pressure_std:.3g} MPa"
    scar, better = s.verdict.scar_error_mm, s.verdict.area_corrected_mm2
    note = f", mean of the {s.end_values}" * study.is_swept
    note += f"; {shown(s.area_contact)} mm² in whole cells" * bool(better)
    rim = "± not known" if scar is None else f"± {1e3 * scar:.3g} µm"
    strip = f", of {study.strip:.4g} mm of the line" if study.strip else ""
    part = f"{100.0 * (s.area_contact / s.area_nominal):.3g} % of the scar{note}{strip}"
    largest = f"{spread}, largest {shown(s.pressure_max)} MPa"
    if study.hertz is not None:
        largest += f"; Hertz (smooth, unworn) {shown(study.hertz.peak_pressure)} MPa"
    approach = shown(s.approach).replace("-", "−")
    return [
        Answer("Scar, along × across sliding", shown([s.patch_along, s.patch_across]), "mm", rim),
        _answer(ENDS["area_contact"], shown(better or s.area_contact), error=s.verdict.area, note=part),
        _answer(ENDS["pressure_mean"], shown(s.pressure_mean), error="as that of the area", note=largest),
        _worn(study, s) if study.sliding.total else _answer(BY_NAME["approach"], approach, note=APPROACH),
        _cof(study, s),
    ]


def _answer(quantity: Quantity, value: str, **words: str) -> Answer:
    """Answer with a quantity of the registry."""
    return Answer(quantity.label.capitalize(), value, quantity.unit, **words)


def _worn(study: Study, s: Summary) -> Answer:
    """Answer how much is worn off both bodies, which the study says rather than the run."""
    less = ", less what no piece has carried off yet" if study.wear.sheds else ", whatever the contact"
    quantity, volumes = ENDS["volume_disc"], (s.volume_counter, s.volume_disc)
    return Answer(
        f"Worn volume, {study.counter.name} and disc",
        ", ".join(f"{quantity.factor * volume / (study.strip or 1.0):.4g}" for volume in volumes),
        quantity.unit + " per mm of line" * bool(study.strip),
        "as good as the wear coefficients",
        f"deepest {shown(s.depth_counter)} and {shown(s.depth_disc)} µm",
        f"Not predicted: wear coefficient × load × distance{less}",
    )


def _cof(study: Study, s: Summary) -> Answer:
    """Answer with the coefficient of friction at the end, and say how far it is an input."""
    if s.cof is None:
        return _answer(BY_NAME["cof"], "–", note=friction_of(study, s))
    fitted = study.friction.fitted in ("end", "coulomb", "states")
    note = "An input" if fitted else "Not predicted: as good as the shear strength"
    error = "as good as that input" if fitted else s.verdict.area
    return _answer(ENDS["cof"], f"{s.cof:.3g}", error=error, note=friction_of(study, s), input_note=note)


def trust_of(study: Study, s: Summary, assumptions: Lines, checks: Lines) -> list[str]:
    """Say what speaks for the numbers and what against them, in a few sentences."""
    rows: Any = {"assumptions": assumptions, "checks": checks}
    return filled("trust.txt", escape=False, study=study, s=s, **rows).splitlines()


def assumptions_of(study: Study, s: Summary) -> Lines:
    """List each assumed key: value, meaning, source, what another value would change, heaviest first."""
    declared, values = declarations(type(study)), study.model_dump(exclude={"assumed"})
    resolved, numbers = study.resolved, numbers_of(study, s)
    rows = []
    for name, why in s.assumptions.items():
        value = resolved[name] if name in resolved else value_of(values, name)
        meaning = getattr(declared[name].field, "description", None) if name in declared else None
        weight, effect = effect_of(name, study, numbers)
        row = {"key": name, "value": shown(readable(value), 6), "meaning": meaning or "", "why": why}
        rows.append(row | {"weight": weight, "effect": effect})
    return sorted(rows, key=lambda row: row["weight"])


def checks_of(study: Study, s: Summary) -> Lines:
    """List residuals and conservation, and whether each is within its limit."""
    allowed = study.load_tolerance if study.uses_bearing_area else 0.0
    balance = max(allowed, TOLERANCE * max(b.load for b in study.blocks))
    rows = [("load carried − load asked for, largest of a step", s.load_residual, balance, " N")]
    expected = "Σ K(p) p ΔL of its cells" if study.wear_laws[0].over_pressure[0] else "Archard's K F L"
    for body, value in s.conservation.items():
        deep = getattr(study, body).has_depths  # then books of each cell stand for K F L
        what = "what its materials lose by the pressures" if deep else expected
        rows.append((f"worn volume of the {CALLED[body]} over {what}, less 1", abs(value), CONSERVED, ""))
        if (off := getattr(s, f"books_{body}")) is not None:
            books = f"Σ V/K of the {CALLED[body]}'s materials, from pressures and depths alone"
            rows.append((f"{books}, over F L, less 1", abs(off), CONSERVED, ""))
    if s.step_error is not None:
        rows.append(("error of the area by the length of steps, estimated", s.step_error, STEPS, ""))
    return [
        {"what": what, "value": f"{value:.2g}{unit}", "most": f"{most:.2g}{unit}", "good": value <= most}
        for what, value, most, unit in rows
    ]


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
