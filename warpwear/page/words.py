"""What a run's page says in words and numbers: what was asked, the answer, and what it rests on."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from warpwear.contact.balance import TOLERANCE
from warpwear.figures.wording import listed
from warpwear.history.distances import with_unit
from warpwear.history.end_values import ENDS, value_in
from warpwear.history.quantities import BY_NAME
from warpwear.laws.archard import BODIES, CALLED
from warpwear.page.effects import Weight, effect_of, numbers_of
from warpwear.results.formats.forms import filled
from warpwear.results.report import shown
from warpwear.study.keys import declarations, value_of
from warpwear.study.study import Study
from warpwear.study.text import readable

Lines: TypeAlias = list[dict[str, Any]]  # of a table, name of a column -> value
#: What checks allow: part of a volume off Archard's, and of the area by the length of steps.
CONSERVED, STEPS = 1e-10, 0.1
APPROACH = "from the mean planes; below zero only peaks reach across"


@dataclass(frozen=True)
class Answer:
    """Hold a number at the top. error: its uncertainty, if known. input_note: how far it is an input."""

    label: str
    value: str
    unit: str
    error: str = ""
    note: str = ""
    input_note: str = ""


def disc_of(study: Study) -> str:
    """Say what the disc is."""
    disc = study.disc
    if study.study.model == "macro" or (disc.synthetic and disc.synthetic.kind == "flat"):
        return "a smooth disc"
    if disc.synthetic is None:
        return f"the measured disc {Path(disc.surface or '').name}"
    if disc.synthetic.like:
        return f"a disc made like the profile {Path(disc.synthetic.like).name}"
    kind, ra, sq = disc.synthetic.kind, disc.synthetic.ra, disc.synthetic.sq
    height = f"Ra {1e3 * ra:.3g} µm" if ra else f"Sq {1e3 * (sq or 0.0):.3g} µm"
    return f"a made {kind} disc of {height}"


def motion_of(study: Study, distance: float) -> str:
    """Say how it moves. distance: that it has slid [mm]."""
    if not study.sliding.total:
        return "is pressed at rest"
    slid = f"slides {with_unit(distance)}"
    if study.fretting is not None:
        drive, cycles = study.fretting, distance / study.fretting.cycle
        stroke = f"a stroke of {1e3 * drive.stroke:.4g} µm"
        way = stroke if drive.force is None else f"a force of ± {drive.force:.4g} N"
        return f"frets {cycles:.6g} cycles by {way}"
    if study.circles:
        return f"{slid} along tracks of {listed([f'{radius:.4g}' for radius in study.circles])} mm radius"
    return f"{slid} along a track" if study.is_swept else f"{slid} on the same place of the disc"


def asked_of(study: Study, distance: float) -> str:
    """Say in one sentence what the run was to find. distance: that it has slid [mm]."""
    load = f"under {study.loads}" + (f" in {len(study.block)} blocks" if study.block else "")
    more = ", how much is worn off" if study.sliding.total else ""
    law = "the local law" if study.contact.law == "local" else "the half-space"
    what = f"A {study.counter.title} on {disc_of(study)} {motion_of(study, distance)} {load}"
    return (
        f"{what}: how large is the scar, how much of it touches and under what pressure{more}, and what is "
        f"the coefficient of friction at the end? Model: {study.study.model}, {law}."
    )


def answers_of(study: Study, s: dict[str, Any]) -> list[Answer]:
    """Give the five numbers that answer the question."""
    pressure = s["pressure_MPa"]
    of_pass = f", mean of the {s['end_values']}" if "track" in s else ""
    spread = f"standard deviation {pressure['std']:.3g} MPa"
    spread = spread if pressure["std"] > 1e-6 * pressure["mean"] else "uniform"
    scar, rim = shown([*s["scar_mm"].values()]), f"± {2 * s['cell_um']:.3g} µm, a cell at each rim"
    strip = f", of {study.strip:.4g} mm of the line" if study.strip else ""
    part = f"{100.0 * s['area_real_over_nominal']:.3g} % of the scar{of_pass}{strip}"
    return [
        Answer("Scar, along × across sliding", scar, "mm", rim),
        _answer("area_contact", s, error=s["verdict"]["area"], note=part),
        _answer("pressure_mean", s, note=f"{spread}, largest {shown(pressure['max'])} MPa"),
        _worn(study, s) if study.sliding.total else _approach(s),
        _cof(s),
    ]


def _answer(name: str, s: dict[str, Any], **words: str) -> Answer:
    """Answer with an end value of the registry."""
    quantity = ENDS[name]
    value: Any = value_in(s, quantity)
    return Answer(quantity.label.capitalize(), shown(quantity.factor * value), quantity.unit, **words)


def _approach(s: dict[str, Any]) -> Answer:
    quantity = BY_NAME["approach"]
    return Answer(
        quantity.label.capitalize(), shown(s["approach_um"]).replace("-", "−"), quantity.unit, note=APPROACH
    )


def _worn(study: Study, s: dict[str, Any]) -> Answer:
    """Answer how much is worn off both bodies, which the study says rather than the run."""
    less = ", less what no piece has carried off yet" if study.wear.sheds else ", whatever the contact"
    volumes = [ENDS[f"volume_{body}"] for body in BODIES]
    per = "_per_mm" if study.strip else ""
    return Answer(
        f"Worn volume, {study.counter.name} and disc",
        ", ".join(f"{volume.factor * s[f'volume_mm3{per}'][volume.short]:.4g}" for volume in volumes),
        volumes[0].unit + (" per mm of line" if per else ""),
        "as good as the wear coefficients",
        f"deepest {' and '.join(shown(s['depth_um'][body]) for body in BODIES)} µm",
        f"Not predicted: wear coefficient × load × distance{less}",
    )


def _cof(s: dict[str, Any]) -> Answer:
    """Answer with the coefficient of friction at the end, and say how far it is an input."""
    if s["cof"]["end"] is None:
        note = "calibrated at the end, which the run did not reach"
        return Answer(BY_NAME["cof"].label.capitalize(), "–", "", note=note)
    label, value = ENDS["cof"].label.capitalize(), f"{s['cof']['end']:.3g}"
    if s["cof_input"] == "coulomb":
        return Answer(label, value, "", input_note="An input, constant")
    strength, note = s["shear_strength_MPa"], f"the area that shears: {s['cof_area']}"
    tau = "its shear strength" if strength is None else f"its shear strength, {strength:.3g} MPa,"
    if s["cof_input"] == "end":
        return Answer(label, value, "", "", note, f"An input: {tau} is fitted so that it is met")
    subject = f"{tau} is"
    if film := s.get("film"):
        under = film["shear_strength_MPa"]["film"]
        subject = f"its shear strengths, {under:.3g} MPa of film and {strength:.3g} bare, are"
    error = "as good as the shear strength"
    return Answer(label, value, "", error, note, f"Not predicted: {subject} {source_of(s)}")


def source_of(s: dict[str, Any]) -> str:
    """Say where the shear strength comes from."""
    if s["cof_input"]:
        when = "end" if s["cof_input"] == "end" else "start"
        return f"fitted to a coefficient of {s['cof_reference']:g} at the {when}"
    return "assumed" if "friction.shear_strength" in s["assumptions"] else "given by the study"


def trust_of(study: Study, s: dict[str, Any], assumptions: Lines, checks: Lines) -> list[str]:
    """Say what speaks for the numbers and what against them, in a few sentences."""
    numbers = {
        "good": all(row["good"] for row in checks),
        "cells": s["area_mm2"]["contact"] / study.cells.cell_area,
        "noted": sum(warning in s["notes"] for warning in s["warnings"]),
        "decisive": [row["key"] for row in assumptions if row["weight"] is Weight.DECIDES],
        "slides": study.sliding.total > 0.0,
        "strip": study.strip,
    }
    return filled("trust.txt", escape=False, s=s, assumptions=assumptions, **numbers).splitlines()


def assumptions_of(study: Study, s: dict[str, Any]) -> Lines:
    """List each assumed key: value, meaning, source, what another value would change, heaviest first."""
    declared, values = declarations(type(study)), study.model_dump(exclude={"assumed"})
    resolved, numbers = study.resolved, numbers_of(study, s)
    rows = []
    for name, why in s["assumptions"].items():
        value = resolved[name] if name in resolved else value_of(values, name)
        meaning = getattr(declared[name].field, "description", None) if name in declared else None
        weight, effect = effect_of(name, study, numbers)
        row = {"key": name, "value": shown(readable(value), 6), "meaning": meaning or "", "why": why}
        rows.append(row | {"weight": weight, "effect": effect})
    return sorted(rows, key=lambda row: row["weight"])


def checks_of(study: Study, s: dict[str, Any]) -> Lines:
    """List residuals and conservation, and whether each is within its limit."""
    allowed = study.load_tolerance if study.uses_bearing_area else 0.0
    balance = max(allowed, TOLERANCE * max(b.load for b in study.blocks))
    residual = s["load_residual_N"]["largest"]
    rows = [("load carried − load asked for, largest of a step", residual, balance, " N")]
    expected = "Σ K(p) p ΔL of its cells" if study.wear_laws[0].over_pressure[0] else "Archard's K F L"
    for body, value in s["conservation_relative"].items():
        deep = getattr(study, body).has_depths  # then books of each cell stand for K F L
        what = "what its materials lose by the pressures" if deep else expected
        rows.append((f"worn volume of the {CALLED[body]} over {what}, less 1", abs(value), CONSERVED, ""))
        off = s.get(f"layers_{body}", {}).get("volumes_over_K_less_FL")
        if off is not None:
            what = (
                f"Σ V/K of the {CALLED[body]}'s materials, from pressures and depths alone, over F L, less 1"
            )
            rows.append((what, abs(off), CONSERVED, ""))
    if (error := s.get("track", {}).get("parts", {}).get("estimated_error_at_most")) is not None:
        rows.append(("error of the area by the length of steps, estimated", error, STEPS, ""))
    return [
        {"what": what, "value": f"{value:.2g}{unit}", "most": f"{most:.2g}{unit}", "good": value <= most}
        for what, value, most, unit in rows
    ]
