"""Draw a record of friction: its course with scatter, jump and steady value, and friction loops."""

import math

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
    steps = analysis.steps
    highest = max(float(step.laps.cof.max()) for step in steps)
    y = Axis("coefficient of friction, –", low=0.0, high=1.1 * highest if len(steps) > 1 else None)
    charts = [
        Chart(
            f"Step {step.name}" if len(steps) > 1 else "Coefficient of friction",
            Axis("distance slid, m", low=0.0 if number == 0 else 1e-3 * step.before),
            y,
            _lines(step, first=number == 0),
            note=f"step {step.name}" + (f", {step.load:.3g} N" if step.load else "")
            if len(steps) > 1
            else "",
        )
        for number, step in enumerate(steps)
    ]
    x = Axis("distance slid, m", low=0.0)
    names = dict.fromkeys(name for step in analysis.steps for name in step.others)
    others = [
        Chart(
            name.partition(" [")[0].capitalize(),
            x,
            Axis(name.replace(" [", ", ").removesuffix("]")),
            [
                Line(1e-3 * (step.before + step.laps.distance), step.others[name], look=Look())
                for step in analysis.steps
            ],
        )
        for name in names
    ]
    columns = math.ceil(math.sqrt(len(steps)))
    return Figure([*charts, *others], columns, legend=5, width=describe.PAGE, height=3.0)


def _lines(step: RecordStep, *, first: bool) -> list[Line | Level]:
    laps, events = step.laps, step.events
    x = 1e-3 * (step.before + laps.distance)
    spread = np.nan_to_num(laps.scatter)
    lines: list[Line | Level] = []
    if spread.any():
        label = f"scatter in a {laps.unit}" if first else ""
        lines.append(
            Line(
                x,
                laps.cof,
                label,
                Look(describe.NEUTRAL, "", alpha=0.25),
                laps.cof - spread,
                laps.cof + spread,
            )
        )
    if events.steady is not None:
        ends = 1e-3 * (step.before + np.array([events.steady.start, events.steady.end]))
        label = "steady value" if first else ""
        values = events.steady.value - np.array([events.steady.drift, 0.0])
        lines.append(Line(ends, values, label, Look(describe.SUM, width=3.0)))
    lines.append(Line(x, laps.cof, f"mean of a {laps.unit}" if first else "", Look(width=0.9)))
    if events.jump is not None:
        for at, label in ((events.jump.start, "10 and 90 % of the jump"), (events.jump.end, "")):
            place = 1e-3 * (step.before + at)
            lines.append(Level(place, label if first else "", Look(describe.NEUTRAL, "dash", 0.8), "x"))
    return lines


def loops_figure(analysis: Analysis) -> Figure:
    """Draw the friction force over the position, in the first, the middle and the last cycle."""
    looks = (Look(describe.DISC), Look(describe.COUNTER, "dash"), Look(describe.CONTACT, "dot"))
    lines = [
        Line(
            np.append(loop.position, loop.position[0]),
            np.append(loop.force, loop.force[0]),
            f"cycle {loop.cycle}",
            look,
        )
        for loop, look in zip(analysis.loops, looks, strict=False)
    ]
    chart = Chart("Friction loops", Axis("position, mm"), Axis("friction force, N"), lines)
    return Figure([chart], 1, legend=3, width=describe.COLUMN, height=2.6)
