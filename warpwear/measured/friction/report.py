"""Say what a record of friction shows: rows for JSON and people, sentences on how it was found, a table."""

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from warpwear.errors import prose
from warpwear.grid import FloatArray
from warpwear.measured.friction.analysis import Analysis, RecordStep
from warpwear.measured.friction.events import FEWEST, LEAST, PENALTY, Steady, line_with_error
from warpwear.measured.friction.states import states_rows, states_text
from warpwear.results.formats.forms import filled
from warpwear.results.report import Row, aligned, shown
from warpwear.results.report import record as record_of

#: Fewer independent means, or a last level of a smaller part of the course, make a steady value doubtful.
FEW, SHARE = 4.0, 0.25
#: Changes of level that a line names.
CHANGES = 6
#: What is said of how hot the contact gets: no record says what its bodies are made of.
NO_HEAT = "not known: no conductivity of the disc, the counter-body; a run of the test tells"
#: What its page says: sections, and how the numbers are found.
TEXTS = prose("reports")["record"]
HOW = [sentence.format(penalty=PENALTY) for sentence in TEXTS["how"]]


def rows_of(analysis: Analysis) -> list[Row]:
    """Declare what is said of a record."""
    head = [
        Row("", "file", str(analysis.rows.path)),
        Row("format", "format", analysis.rows.format),
        Row("rows", "rows", int(analysis.rows.step.size)),
    ]
    if len(analysis.steps) == 1:
        body = step_rows(analysis.steps[0])
    else:
        heads, *texts = aligned(_table_of_steps(analysis.steps))
        body = [Row("steps", "", heads)]
        body += [Row(f"  {step.name}", "", text) for step, text in zip(analysis.steps, texts, strict=True)]
        for step in analysis.steps:
            body += [Row(f"step {step.name}", "", ""), *labelled(step_rows(step))]
        body.append(Row("", "steps", [record_of(step_rows(step)) for step in analysis.steps]))
    loops = [
        Row(f"loop of cycle {loop.cycle}", "", loop.energy, unit="mJ", digits=3) for loop in analysis.loops
    ]
    if loops:
        loops.append(Row("", "loops_mJ", {str(loop.cycle): loop.energy for loop in analysis.loops}))
    return [*head, *body, *loops, *notes_of(analysis)]


def _table_of_steps(steps: Sequence[RecordStep]) -> list[list[str]]:
    """Write what each step comes to, a row a step."""
    names = [*dict.fromkeys(name for step in steps for name in step.others)]
    cells = [["load, N", "distance, m", "steady value", "jump at, m", "energy, J"]]
    cells[0] += [name.replace(" [", ", ").replace("]", "/m") for name in names]
    for step in steps:
        steady, jump = step.events.steady, step.events.jump
        level = Row("", "", steady.value, error=steady.error) if steady else Row("", "", None)
        told = [name in step.others and _other_rows(name, step.others[name], step) for name in names]
        rates = [rows[0].value[1].number if rows else "–" for rows in told]
        numbers = [step.load, 1e-3 * step.slid, jump and 1e-3 * jump.start, step.energy]
        load, length, start, energy = (shown(number) for number in numbers)
        cells.append([load, length, level.number, start, energy, *rates])
    return cells


def labelled(rows: list[Row]) -> list[Row]:
    """Leave a step's rows to people: JSON has them under the list of steps."""
    return [replace(row, key="", unit=row.units, error=("", row.uncertainty[1])) for row in rows if row.label]


def notes_of(analysis: Analysis) -> list[Row]:
    """Declare what was assumed, done and left out."""
    notes = {n.partition(". ")[0]: n for step in reversed(analysis.steps) for n in step.course.notes[::-1]}
    warnings = [w.removeprefix("Warning: ") for step in analysis.steps for w in step.course.warnings]
    doubts: dict[str, list[str]] = {}
    for step in analysis.steps:
        said = filled("unsteady.txt", escape=False, steady=step.events.steady, share=SHARE, few=FEW)
        for doubt in said.splitlines():
            doubts.setdefault(doubt, []).append(step.name)
    for doubt, names in doubts.items():
        warnings.append(doubt + (f" (step {', '.join(names)})" if names[0] else "") + ".")
    return [
        Row("warning", "warnings", list(dict.fromkeys(warnings))),
        Row("note", "notes", list(notes.values())[::-1]),
        Row("steps left out", "steps_left_out", list(analysis.left_out)),
        Row("temperature", "flash_unknown", NO_HEAT),
        Row("", "how", HOW),
    ]


def step_rows(step: RecordStep) -> list[Row]:
    """Declare what is said of one step."""
    laps, events, points = step.laps, step.events, step.course.distance.size
    unit = f"{laps.unit}s"
    together = "" if laps.laps in (None, 1.0) else f", means of {laps.laps:g} {unit}"
    scatter = laps.scatter[np.isfinite(laps.scatter)]
    within = float(np.median(scatter)) if scatter.size else None
    rows = [
        Row("", "step", step.name),
        *_length("distance", "distance", float(step.course.distance[-1]), step, f"{points} points{together}"),
        Row("load", "load_N", step.load),
        Row(f"within a {laps.unit}", "scatter", within, digits=2),
    ]
    seen = laps.cof.size >= FEWEST
    if events.jump is None:
        none = "none: no rise by a fifth within a fifth of the course"
        rows.append(Row("jump", "", none if seen else f"not known: {FEWEST} means or more tell"))
    else:
        jump = events.jump
        levels = f"from {jump.low:.3g} to {jump.high:.3g}"
        rows += _length("incubation", "incubation", jump.start, step)
        rows += _length("jump", "jump", jump.end - jump.start, step, levels)
        rows += [Row("", "level_before", jump.low), Row("", "level_after", jump.high)]
    if step.states is not None:
        said = states_text(step.states)
        rows.append(Row("three states", "states", states_rows(step.states), sentence=said))
    after = "above the level that follows"
    rows.append(Row("overshoot", "overshoot", events.overshoot, digits=2, note="above the steady value"))
    rows.append(Row("  at the jump", "overshoot_after_jump", events.overshoot_after, digits=2, note=after))
    if events.steady is not None:
        rows += _steady_rows(events.steady)
    rows += [row for name, means in step.others.items() for row in _other_rows(name, means, step)]
    changes = ", ".join(f"{1e-3 * at:.4g}" for at in events.changes[:CHANGES])
    more = len(events.changes) - CHANGES
    return [
        *rows,
        Row("level changes at", "", f"{changes} m{f' and {more} more' * (more > 0)}" if changes else None),
        Row("", "level_changes_mm", list(events.changes) if seen else None),
        Row("energy", "energy_J", step.energy, digits=3, note="dissipated"),
    ]


def _other_rows(name: str, means: FloatArray, step: RecordStep) -> list[Row]:
    """Declare what a further column comes to: its mean, and its rate over the steady part, or over all."""
    steady, distance = step.events.steady, step.laps.distance
    part = (distance >= steady.start if steady else distance >= 0.0) & np.isfinite(means)
    title, _, unit = name.removesuffix("]").partition(" [")
    if np.count_nonzero(part) < LEAST:
        return []
    middle, error, rise, of_rise, _ = line_with_error(means[part])
    length = 1e-3 * float(np.ptp(distance[part]))
    told = [
        Row("mean", "mean", middle, error=error, unit=unit),
        Row("rate", "rate_per_m", rise / length if error else 0.0, error=of_rise / length, unit=f"{unit}/m"),
    ]
    text = f"{told[0].text}, {told[1].text}{' over the steady part' if steady else ''}"
    return [Row(title, name, told, sentence=text)]


def _steady_rows(steady: Steady) -> list[Row]:
    error = f"{steady.error:.2g}"
    decimals = len(error.partition(".")[2]) if "e" not in error else 5
    where = f"the end of a line over {1e-3 * steady.start:.4g} to {1e-3 * steady.end:.4g} m"
    value = f"{steady.value:.{decimals}f} ± {error} (95 %: ± {steady.error_95:.2g})"
    drift = f"{steady.drift:+.2g} ± {steady.drift_95:.2g} (95 %) over the length of that line"
    of_drift = ("steady_drift_error_95", steady.drift_95)
    return [
        Row("steady value", "steady_cof", steady.value, error=steady.error, sentence=f"{value}, {where}"),
        Row("", "steady_cof_error_95", steady.error_95),
        Row("drift", "steady_drift", steady.drift, error=of_drift, sentence=drift),
        Row("", "steady_from_mm", steady.start),
        Row("", "steady_to_mm", steady.end),
        Row("independent", "steady_independent", steady.independent, 3, f"means of {steady.groups}"),
        Row("", "last_level_percent", 100.0 * steady.share),
    ]


def _length(label: str, key: str, length: float, step: RecordStep, note: str = "") -> list[Row]:
    """Declare a length: for people in m, and in laps where these are known."""
    count = step.laps.count(length)
    parts = [f"{1e-3 * length:.4g} m", *([f"{count:.4g} {step.laps.unit}s"] if count is not None else [])]
    laps = [Row("", f"{key}_{step.laps.unit}s", count)] if count is not None else []
    return [Row(label, f"{key}_mm", length, sentence=", ".join([*parts, *([note] if note else [])])), *laps]


def table_of(analysis: Analysis) -> str:
    """Write the course as a table, units in the header: a row a lap, cycle or group of them."""
    steps, text = analysis.steps, io.StringIO()
    unit = next((step.laps.unit for step in steps if step.laps.laps is not None), None)
    others = [*dict.fromkeys(name for step in steps for name in step.others)]
    head = ["Distance [mm]", "CoF [-]", "Scatter of CoF [-]", "Points", *others]
    head[4:4] = [f"{unit.capitalize()} [-]"] if unit else []
    head += ["Step"] * (len(steps) > 1)
    writer = csv.DictWriter(text, head, restval="", extrasaction="ignore")
    writer.writeheader()
    for number, step in enumerate(steps):
        laps = step.laps
        columns = {head[0]: step.before + laps.distance, head[1]: laps.cof, head[2]: laps.scatter}
        for k in range(laps.cof.size):
            values = {name: float(column[k]) for name, column in (columns | dict(step.others)).items()}
            row: dict[str, Any] = {name: repr(v) for name, v in values.items() if not math.isnan(v)}
            count = laps.count(float(laps.distance[k]))
            row |= {"Points": int(laps.points[k]), "Step": step.name or number + 1}
            writer.writerow(row | ({head[4]: f"{count:.6g}"} if count is not None else {}))
    return text.getvalue()
