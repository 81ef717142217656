"""Units of axes, which follow from how far or how long they reach."""

from dataclasses import replace

from warpwear.figures.describe import DISTANCE, Chart, Cloud, Figure, Level, Line, values_of
from warpwear.history.distances import METRES, unit_of

#: What a unit of an axis holds of the least one of its kind: times, and lengths.
UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0, "mm": 1.0} | METRES


def far(figure: Figure) -> Figure:
    """Show distances slid of a figure in m or km where they are long, in all its charts alike."""
    charts = [panel for panel in figure.panels if isinstance(panel, Chart) and panel.x.label == DISTANCE]
    ends = (float(values.max()) for chart in charts for values in values_of(chart, "x") if values.size)
    label = f"{DISTANCE.removesuffix('mm')}{unit_of(max(ends, default=0.0))}"
    panels = (
        in_unit(p, label) if isinstance(p, Chart) and p.x.label == DISTANCE else p for p in figure.panels
    )
    return replace(figure, panels=[*panels])


def in_unit(chart: Chart, label: str) -> Chart:
    """Give places of a chart the unit of a label that says the same of them."""
    (what, _, unit), (there, _, wanted) = (text.rpartition(", ") for text in (chart.x.label, label))
    if what != there or unit == wanted or not {unit, wanted} <= UNITS.keys():
        return chart
    factor = UNITS[unit] / UNITS[wanted]
    low, high = (None if end is None else factor * end for end in (chart.x.low, chart.x.high))
    x = replace(chart.x, label=label, low=low, high=high, least=factor * chart.x.least)
    return replace(chart, lines=[_scaled(part, factor) for part in chart.lines], x=x)


def _scaled(part: Line | Level | Cloud, factor: float) -> Line | Level | Cloud:
    if isinstance(part, Line):
        return replace(part, x=factor * part.x)
    return replace(part, value=factor * part.value) if isinstance(part, Level) and part.axis == "x" else part
