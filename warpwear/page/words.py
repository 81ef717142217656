"""What a run's page says in words and numbers: what was asked, the answer, and what it rests on."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from warpwear.contact.balance import TOLERANCE
from warpwear.page.limits import limits_of
from warpwear.results.report import shown
from warpwear.results.summary_text import summary_text
from warpwear.study.keys import declarations, value_of
from warpwear.study.study import Study
from warpwear.study.text import readable

#: What checks allow: part of a volume off Archard's, and of the area by the length of steps.
CONSERVED, STEPS = 1e-10, 0.02
#: Signs that LaTeX takes for commands, and others that its fonts may lack -> what to write.
LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "µ": r"$\mu$"}
LATEX |= {sign: f"\\{sign}" for sign in "{}$&#%_"} | {"²": "$^2$", "³": "$^3$", "⁻": "$^-$", "×": r"$\times$"}
LATEX |= {
    "±": r"$\pm$",
    "−": "--",
    "–": "--",
    "τ": r"$\tau$",
    "·": r"$\cdot$",
    "α": r"$\alpha$",
    "√": r"$\surd$",
}

#: Commands to be typed inside the run folder, and what they do.
COMMANDS = (
    ("warpwear run study.toml --out again", "the same run again; study.toml holds every key"),
    ("warpwear show study.toml", "the study, with every assumption marked"),
    ("warpwear report .", "this page"),
    ("warpwear plot .", "all figures"),
    ("warpwear export .", "the worn bodies as files for other software"),
)


@dataclass(frozen=True)
class Answer:
    """A number at the top. error: its uncertainty as far as known. given: how far it is an input."""

    label: str
    value: str
    unit: str
    error: str = ""
    note: str = ""
    given: str = ""


def words_of(study: Study, summary: dict[str, Any]) -> dict[str, Any]:
    """Collect all texts of the page by name. summary: as of `summarise`."""
    answers = _answers(study, summary)
    return {
        "name": study.study.name,
        "description": study.study.description,
        "asked": _asked(study, summary),
        "finished": summary["finished"],
        "answers": [vars(answer) for answer in answers],
        "warnings": summary["warnings"],
        "trust": _trust(study, summary),
        "limits": limits_of(study),
        "assumptions": _assumptions(study, summary["assumptions"]),
        "checks": _checks(study, summary),
        "summary": summary_text(summary),
        "methods": _methods(study, summary),
        "table": _table(study, summary, answers),
        "latex": _latex(study, summary, answers),
        "citation": _citation(summary["version"]),
        "commands": COMMANDS,
        "version": summary["version"],
        "made_with": summary.get("made_with", {}),
    }


def _disc(study: Study) -> str:
    disc = study.disc
    if study.study.model == "macro" or (disc.synthetic and disc.synthetic.kind == "flat"):
        return "a smooth disc"
    if disc.synthetic is None:
        return f"the measured disc {disc.surface}"
    kind, ra, sq = disc.synthetic.kind, disc.synthetic.ra, disc.synthetic.sq
    height = f"Ra {1e3 * ra:.3g} µm" if ra else f"Sq {1e3 * (sq or 0.0):.3g} µm"
    return f"a made {kind} disc of {height}"


def _slider(study: Study) -> str:
    curvature = study.sphere.curvature
    return f"A sphere of {1.0 / curvature:.4g} mm radius" if curvature else "A rigid flat"


def _motion(study: Study, summary: dict[str, Any]) -> str:
    if not study.sliding.total:
        return "is pressed at rest"
    slid = f"slides {summary['distance_mm']:.6g} mm"
    return f"{slid} along a track" if study.is_swept else f"{slid} on the same place of the disc"


def _asked(study: Study, summary: dict[str, Any]) -> str:
    """Say in one sentence what the run was to find."""
    load = f"under {study.contact.load:.4g} N"
    more = ", how much is worn off" if study.sliding.total else ""
    return (
        f"{_slider(study)} on {_disc(study)} {_motion(study, summary)} {load}: how large is the scar, how "
        f"much of it "
        f"touches and under what pressure{more}, and what is the coefficient of friction at the end?"
    )


def _answers(study: Study, s: dict[str, Any]) -> list[Answer]:
    """Give the five numbers that answer the question."""
    cell, rounding = s["cell_um"], ""
    parts = s.get("track", {}).get("parts")
    if parts and parts["estimated_error_at_most"] > 0.0:
        rounding = f"± {100.0 * parts['estimated_error_at_most']:.2g} % by the length of the steps"
    of_pass = ", mean of the last pass" if "track" in s else ""
    spread = s["pressure_MPa"]["std"]
    spread_text = (
        f"standard deviation {spread:.3g} MPa" if spread > 1e-6 * s["pressure_MPa"]["mean"] else "uniform"
    )
    found = [
        Answer(
            "Scar, along × across sliding",
            shown([s["scar_mm"]["along"], s["scar_mm"]["across"]]),
            "mm",
            f"± {2.0 * cell:.3g} µm, a cell at each rim",
        ),
        Answer(
            "Area in contact",
            shown(s["area_mm2"]["contact"]),
            "mm²",
            rounding,
            f"{100.0 * s['area_real_over_nominal']:.3g} % of the scar{of_pass}",
        ),
        Answer(
            "Mean pressure in contact",
            shown(s["pressure_MPa"]["mean"]),
            "MPa",
            "",
            f"{spread_text}, largest {shown(s['pressure_MPa']['max'])} MPa",
        ),
    ]
    depths, volumes = s["depth_um"], [s["volume_mm3"][body] for body in ("sphere", "disc")]
    slider = "sphere" if study.sphere.curvature else "flat"
    if study.sliding.total:
        found.append(
            Answer(
                f"Worn volume, {slider} and disc",
                ", ".join(f"{1e3 * volume:.4g}" for volume in volumes),
                "10⁻³ mm³",
                "as good as the wear coefficients",
                f"deepest {shown(depths['sphere'])} and {shown(depths['disc'])} µm",
                "Not predicted: wear coefficient × load × distance, whatever the contact",
            )
        )
    else:
        found.append(
            Answer("Approach of the bodies", shown(s["approach_um"]), "µm", "", "from the mean planes")
        )
    cof = s["cof"]["end"]
    if cof is None:
        note = "calibrated at the end, which the run did not reach"
        return [*found, Answer("Coefficient of friction", "–", "", "", note)]
    strength = s["shear_strength_MPa"]
    tau = "its shear strength" if strength is None else f"its shear strength, {strength:.3g} MPa,"
    given = f"Not predicted: {tau} is {_source(s)}"
    if s["cof_input"] == "end":
        given = f"An input: {tau} is fitted so that it is met"
    note = f"the area that shears: {s['cof_area']}"
    error = "" if s["cof_input"] == "end" else "as good as the shear strength"
    return [*found, Answer("Coefficient of friction at the end", f"{cof:.3g}", "", error, note, given)]


def _source(s: dict[str, Any]) -> str:
    """Say where the shear strength comes from."""
    if s["cof_input"]:
        when = "end" if s["cof_input"] == "end" else "start"
        return f"fitted to a coefficient of {s['cof_reference']:g} at the {when}"
    return "assumed" if "friction.shear_strength" in s["assumptions"] else "given by the study"


def _trust(study: Study, s: dict[str, Any]) -> list[str]:
    """Say what speaks for the numbers and what against them, in a few sentences."""
    good = all(row["good"] for row in _checks(study, s))
    cells = s["area_mm2"]["contact"] / study.cells.cell_area
    warned, assumed = (_count(len(s[of]), of.removesuffix("s")) for of in ("warnings", "assumptions"))
    found = [
        "The equations are solved: all checks below hold."
        if good
        else "Not all checks below hold: see residuals and conservation.",
        f"The contact covers {cells:,.0f} cells of {s['cell_um']:g} µm. How much the mesh changes is told by "
        "a run with half the cell, not by this one.",
        f"{warned}, {assumed}. Nothing on this page checks what is assumed.",
    ]
    if filled := s.get("load_on_filled_percent"):
        most = filled["largest"]
        found.append(
            f"At most {most:.2g} % of the load rests on points that were not measured but filled in."
        )
    return found


def _count(number: int, what: str) -> str:
    return f"{number or 'No'} {what}{'s' * (number != 1)}"


def _assumptions(study: Study, reasons: dict[str, str]) -> list[dict[str, str]]:
    """List each assumed key with its value, what it means and where it comes from."""
    declared, values = declarations(type(study)), study.model_dump(exclude={"assumed"})
    resolved = study.resolved
    rows = []
    for name, why in reasons.items():
        value = resolved[name] if name in resolved else value_of(values, name)
        text = shown(readable(value), 6)
        meaning = getattr(declared[name].field, "description", None) if name in declared else None
        rows.append({"key": name, "value": text, "meaning": meaning or "", "why": why})
    return rows


def _checks(study: Study, s: dict[str, Any]) -> list[dict[str, Any]]:
    """List residuals and conservation, and whether each is within its limit."""
    balance = max(study.load_tolerance if study.uses_bearing_area else 0.0, TOLERANCE * s["load_N"])
    residual = s["load_residual_N"]["largest"]
    rows = [("load carried − load asked for, largest of a step", residual, balance, "N")]
    for body, value in s["conservation_relative"].items():
        rows.append((f"worn volume of the {body} over Archard's K F L, less 1", abs(value), CONSERVED, ""))
    if parts := s.get("track", {}).get("parts"):
        error = parts["estimated_error_at_most"]
        rows.append(("error of the area by the length of steps, estimated", error, STEPS, ""))
    return [
        {
            "what": what,
            "value": f"{value:.2g} {unit}".rstrip(),
            "most": f"{most:.2g} {unit}".rstrip(),
            "good": value <= most,
        }
        for what, value, most, unit in rows
    ]


def _law(study: Study, s: dict[str, Any]) -> str:
    if study.contact.law == "half-space":
        modulus = s["half_space"]["effective_modulus_MPa"]
        return f"as elastic half-spaces (E* = {1e-3 * modulus:.4g} GPa, {study.boundary} boundary)"
    return "cell by cell by a local law, without elastic coupling between cells"


def _methods(study: Study, s: dict[str, Any]) -> str:
    """Write the paragraph that a paper's section on methods may begin with."""
    sphere, disc = (s["wear_coefficient_mm3_per_Nm"][body] for body in ("sphere", "disc"))
    hardness = (
        f", with the pressure of a cell limited to {s['hardness_MPa']:.4g} MPa" if s["hardness_MPa"] else ""
    )
    sentences = [
        f"Contact and wear were computed with warpwear {s['version']} ({study.study.model} model).",
        f"{_slider(study)} on {_disc(study)} {_motion(study, s)} under {s['load_N']:.4g} N.",
        f"The contact was solved {_law(study, s)}{hardness}, on {study.cells.nx} × {study.cells.ny} square "
        f"cells of "
        f"{s['cell_um']:.4g} µm, in {s['steps']} step{'s' * (s['steps'] != 1)}.",
    ]
    if study.sliding.total:
        sentences.append(
            f"Wear followed Archard's law in every cell, with {sphere:.3g} mm³/(N·m) for the sphere and "
            f"{disc:.3g} "
            f"mm³/(N·m) for the disc{_wear_law(study)}."
        )
    if s["shear_strength_MPa"] is not None:
        sentences.append(
            f"Friction is the area ({s['cof_area']}) times an interfacial shear strength of "
            f"{s['shear_strength_MPa']:.3g} MPa, {_source(s)}, over the load."
        )
    sentences.append(f"The load was balanced to {s['load_residual_N']['largest']:.1g} N in every step.")
    return " ".join(sentences)


def _wear_law(study: Study) -> str:
    return "" if study.wear.law == "archard" else f", by the law '{study.wear.law}'"


def _table(study: Study, s: dict[str, Any], answers: Iterable[Answer]) -> list[tuple[str, str, str]]:
    """List quantity, value and unit of what went in and what came out."""
    rows = [
        ("Load", shown(s["load_N"]), "N"),
        ("Radius of the sphere", shown(1.0 / study.sphere.curvature), "mm")
        if study.sphere.curvature
        else None,
        ("Sliding distance", shown(s["distance_mm"], 6), "mm"),
        ("Cell", shown(s["cell_um"]), "µm"),
        ("Hardness (cap of the pressure)", shown(s["hardness_MPa"]), "MPa") if s["hardness_MPa"] else None,
        *(
            (f"Wear coefficient, {body}", shown(value), "mm³/(N·m)")
            for body, value in s["wear_coefficient_mm3_per_Nm"].items()
        ),
        *((answer.label, answer.value, answer.unit) for answer in answers),
    ]
    return [row for row in rows if row is not None]


def to_latex(text: str) -> str:
    """Write a text so that LaTeX sets it as it is."""
    return "".join(LATEX.get(sign, sign) for sign in text)


def _latex(study: Study, s: dict[str, Any], answers: Iterable[Answer]) -> str:
    """Write methods and table as LaTeX."""
    rows = "\n".join(
        "  " + " & ".join(to_latex(part) for part in row) + r" \\" for row in _table(study, s, answers)
    )
    return "\n".join(
        [
            to_latex(_methods(study, s)),
            "",
            r"\begin{table}",
            rf"  \caption{{{to_latex(study.study.name)}}}",
            r"  \begin{tabular}{lrl}",
            "  \\hline\n  Quantity & Value & Unit \\\\\n  \\hline",
            rows,
            "  \\hline\n  \\end{tabular}\n\\end{table}",
        ]
    )


def _citation(version: str) -> str:
    fields = {
        "author": "{The warpwear developers}",
        "title": "warpwear: fine-mesh contact, wear and friction of rough surfaces",
        "version": version,
    }
    entries = ",\n".join(f"  {name} = {{{value}}}" for name, value in fields.items())
    return f"@software{{warpwear,\n{entries}\n}}"
