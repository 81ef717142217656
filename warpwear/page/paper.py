"""What a run's page offers for a paper: a paragraph on methods, a table, both as LaTeX, how to cite."""

import re
from collections.abc import Iterable
from typing import Any, TypeAlias

from warpwear.history.quantities import printed
from warpwear.laws.archard import said
from warpwear.page.words import disc_of, motion_of, slider_of, source_of
from warpwear.results.report import shown
from warpwear.study.bodies import CounterBody
from warpwear.study.study import Study

Line: TypeAlias = tuple[str, str, str]  # quantity, value and unit
#: Signs that LaTeX takes for commands, and others that its fonts may lack -> what to write.
LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "µ": r"$\mu$"}
LATEX |= {sign: f"\\{sign}" for sign in "{}$&#%_"} | {"×": r"$\times$", "±": r"$\pm$", "−": "--", "–": "--"}
LATEX |= {"τ": r"$\tau$", "·": r"$\cdot$", "α": r"$\alpha$", "√": r"$\surd$"}
#: Raised signs, and the number with a power of ten as programs write it; neither stands in a formula yet.
RAISED, POWER = re.compile("[⁺⁻⁰¹²³⁴-⁹]+"), re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)(?!\w)")
LOWERED = str.maketrans("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789")


def _law(study: Study, s: dict[str, Any]) -> str:
    if study.contact.law == "half-space":
        modulus = s["half_space"]["effective_modulus_MPa"]
        return f"as elastic half-spaces (E* = {1e-3 * modulus:.4g} GPa, {study.boundary} boundary)"
    return "cell by cell by a local law, without elastic coupling between cells"


def methods_of(study: Study, s: dict[str, Any]) -> str:
    """Write the paragraph that a paper's section on methods may begin with."""
    counter, disc = (s["wear_coefficient_mm3_per_Nm"][body] for body in ("counter", "disc"))
    cap, motion = s["hardness_MPa"], motion_of(study, s["distance_mm"])
    load = f"{study.loads}" + (f", in blocks of {study.programme}" if study.block else "")
    hardness = f", with the pressure of a cell limited to {cap:.4g} MPa" if cap else ""
    sentences = [
        f"Contact and wear were computed with warpwear {s['version']} ({study.study.model} model).",
        f"{slider_of(study)} on {disc_of(study)} {motion} under {load}.",
        f"The contact was solved {_law(study, s)}{hardness}, on {study.cells.nx} × {study.cells.ny} square "
        f"cells of {s['cell_um']:.4g} µm, in {s['steps']} step{'s' * (s['steps'] != 1)}.",
    ]
    if study.sliding.total:
        sentences.append(
            f"Wear followed Archard's law in every cell, with {counter:.3g} mm³/(N·m) for the "
            f"counter-body and {disc:.3g} mm³/(N·m) for the disc{_wear_law(study)}."
        )
    if film := s.get("film"):
        sentences.append(
            "Friction is the sum over the cells in contact of an interfacial shear strength times their "
            f"area, over the load: {film['shear_strength_MPa']['film']:.3g} MPa under a film of "
            f"{film['thickness_nm']:.3g} nm, {s['shear_strength_MPa']:.3g} MPa where wear has broken it, "
            f"{source_of(s)}{_friction_law(study)}."
        )
    elif s["cof_input"] == "coulomb":
        source = "assumed" if "friction.coefficient" in s["assumptions"] else "given by the study"
        sentences.append(f"The coefficient of friction is constant, {s['cof_reference']:g}, {source}.")
    elif s["shear_strength_MPa"] is not None:
        sentences.append(
            f"Friction is the area ({s['cof_area']}) times an interfacial shear strength of "
            f"{s['shear_strength_MPa']:.3g} MPa, {source_of(s)}, over the load{_friction_law(study)}."
        )
    sentences.append(f"The load was balanced to {s['load_residual_N']['largest']:.1g} N in every step.")
    return " ".join(sentences)


def _wear_law(study: Study) -> str:
    sentence = said(study.wear_laws)
    law = f", by the law '{study.wear.law}': {sentence}" if sentence else ""
    if (pieces := study.pieces) is None:
        return law
    size = f"{1e3 * pieces.diameter:.3g} µm wide and {1e3 * pieces.thickness:.3g} µm thick"
    return f"{law}; worn volume gathered until it left in pieces {size}"


def _friction_law(study: Study) -> str:
    sentence = study.friction.law_with().said
    return f"; {sentence}" if sentence else ""


def table_of(counter: CounterBody, s: dict[str, Any], answers: Iterable[dict[str, str]]) -> list[Line]:
    """List quantity, value and unit of what went in and what came out."""
    hardness, unit = s["hardness_MPa"], printed("mm^3/N/m")
    return [
        ("Load", ", ".join(shown(block["load_N"]) for block in s.get("blocks", [s])), "N"),
        *([] if counter.form.is_flat else [("Counter-body", counter.title, "")]),
        ("Sliding distance", shown(s["distance_mm"], 6), "mm"),
        ("Cell", shown(s["cell_um"]), "µm"),
        *([("Hardness (cap of the pressure)", shown(hardness), "MPa")] if hardness else []),
        *((f"Wear coefficient, {b}", shown(k), unit) for b, k in s["wear_coefficient_mm3_per_Nm"].items()),
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
    rows = ["  " + " & ".join(map(to_latex, row)) + r" \\" for row in table]
    lines = [
        to_latex(methods),
        rf"\[ \mathrm{{d}}V / \mathrm{{d}}L = F \left({study.wear_laws[0].formula}\right), \quad "
        rf"\mu = {study.friction.law_with().formula} \]",
        "",
        r"\begin{table}",
        rf"  \caption{{{to_latex(study.study.name)}}}",
        r"  \begin{tabular}{lrl}",
        "  \\hline\n  Quantity & Value & Unit \\\\\n  \\hline",
        *rows,
        "  \\hline\n  \\end{tabular}\n\\end{table}",
    ]
    return "\n".join(lines)


def citation_of(version: str) -> str:
    fields = {
        "author": "{The warpwear developers}",
        "title": "warpwear: fine-mesh contact, wear and friction of rough surfaces",
        "version": version,
    }
    entries = ",\n".join(f"  {name} = {{{value}}}" for name, value in fields.items())
    return f"@software{{warpwear,\n{entries}\n}}"
