"""Draw a record of friction: its course with scatter, jump and steady value, and friction loops."""

import math
from dataclasses import replace

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look
from warpwear.measured.friction.analysis import Analysis, RecordStep


def figures_of(analysis: Analysis) -> dict[str, Figure]:
    """Declare the figures of a record by name."""
    figures = {"course": course_figure(analysis)}
    if analysis.loops:
        figures["loops"] = loops_figure(analysis)
    return figures


def course_figure(analysis: Analysis) -> Figure:
    """Draw the coefficient of friction over the distance: means of laps, their scatter, what happens.

    Each step of a recipe has a panel.
    """
    steps, several, charts = analysis.steps, len(analysis.steps) > 1, []
    highest = max(float(step.laps.cof.max()) for step in steps)
    y = Axis("coefficient of friction, –", low=0.0, high=1.1 * highest if several else None)
    for number, step in enumerate(steps):
        title = f"Step {step.name}" if several else "Coefficient of friction"
        note = f"step {step.name}" + (f", {step.load:.3g} N" if step.load else "")
        x, lines = Axis("distance slid, m", low=1e-3 * step.before), _lines(step, named=number == 0)
        charts.append(Chart(title, x, y, lines, note=note * several))
    for name in dict.fromkeys(name for step in steps for name in step.others):
        title, up = name.partition(" [")[0].capitalize(), Axis(name.replace(" [", ", ").removesuffix("]"))
        having = [step for step in steps if name in step.others]
        places = [1e-3 * (step.before + step.laps.distance) for step in having]
        pairs = zip(places, having, strict=True)
        means: list[Line | Level] = [Line(x, s.others[name], look=Look()) for x, s in pairs]
        charts.append(Chart(title, Axis("distance slid, m", low=0.0), up, means))
    columns = math.ceil(math.sqrt(len(steps)))
    return Figure(charts, columns, legend=5, width=describe.PAGE, height=3.0)


def _lines(step: RecordStep, *, named: bool) -> list[Line | Level]:
    """Draw what a step came to. named: for the legend."""
    laps, events, cof = step.laps, step.events, step.laps.cof
    x = 1e-3 * (step.before + laps.distance)
    spread = np.nan_to_num(laps.scatter)
    lines: list[Line | Level] = []
    if spread.any():
        pale = Look(describe.NEUTRAL, "", alpha=0.25)
        lines.append(Line(x, cof, f"scatter in a {laps.unit}", pale, cof - spread, cof + spread))
    if events.steady is not None:
        ends = 1e-3 * (step.before + np.array([events.steady.start, events.steady.end]))
        values = events.steady.value - np.array([events.steady.drift, 0.0])
        lines.append(Line(ends, values, "steady value", Look(describe.SUM, width=3.0)))
    lines.append(Line(x, cof, f"mean of a {laps.unit}", Look(width=0.9)))
    if events.jump is not None:
        for at, label in ((events.jump.start, "10 and 90 % of the jump"), (events.jump.end, "")):
            place = 1e-3 * (step.before + at)
            lines.append(Level(place, label, Look(describe.NEUTRAL, "dash", 0.8), "x"))
    return lines if named else [replace(line, label="") for line in lines]


def loops_figure(analysis: Analysis) -> Figure:
    """Draw the friction force over the position, in the first, the middle and the last cycle."""
    looks = (Look(describe.DISC), Look(describe.COUNTER, "dash"), Look(describe.CONTACT, "dot"))
    lines = []
    for loop, look in zip(analysis.loops, looks, strict=False):
        x, force = (np.append(values, values[0]) for values in (loop.position, loop.force))
        lines.append(Line(x, force, f"cycle {loop.cycle}", look))
    chart = Chart("Friction loops", Axis("position, mm"), Axis("friction force, N"), lines)
    return Figure([chart], 1, legend=3, width=describe.COLUMN, height=2.6)
