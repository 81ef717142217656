"""Units of axes, which follow from how far or how long they reach."""

from dataclasses import replace

from warpwear.figures.describe import DISTANCE, TIME, Chart, Density, Figure, Level, Line, values_of
from warpwear.history.distances import METRES

#: Axes that may reach far, in their least unit -> its kind, with what each unit holds of it.
FAR = {DISTANCE: {"mm": 1.0} | METRES, TIME: {"s": 1.0, "min": 60.0, "h": 3600.0}}
UNITS = FAR[DISTANCE] | FAR[TIME]


def far(figure: Figure) -> Figure:
    """Show distances slid and times of a figure in the largest unit of which they reach ten, all alike."""
    for least, units in FAR.items():
        charts = [panel for panel in figure.panels if isinstance(panel, Chart) and panel.x.label == least]
        ends = (float(values.max()) for chart in charts for values in values_of(chart, "x") if values.size)
        end, what = max(ends, default=0.0), least.rpartition(", ")[0]
        unit = [*units][max(sum(end >= 10.0 * size for size in units.values()) - 1, 0)]
        panels = [in_unit(p, f"{what}, {unit}") if isinstance(p, Chart) else p for p in figure.panels]
        figure = replace(figure, panels=panels)
    return figure


def in_unit(chart: Chart, label: str) -> Chart:
    """Give places of a chart the unit of a label that says the same of them."""
    (what, _, unit), (there, _, wanted) = (text.rpartition(", ") for text in (chart.x.label, label))
    if what != there or unit == wanted or not {unit, wanted} <= UNITS.keys():
        return chart
    factor = UNITS[unit] / UNITS[wanted]
    low, high = (None if end is None else factor * end for end in (chart.x.low, chart.x.high))
    x = replace(chart.x, label=label, low=low, high=high, least=factor * chart.x.least)
    return replace(chart, lines=[_scaled(part, factor) for part in chart.lines], x=x)


def _scaled(part: Line | Level | Density, factor: float) -> Line | Level | Density:
    if isinstance(part, Line):
        return replace(part, x=factor * part.x)
    return replace(part, value=factor * part.value) if isinstance(part, Level) and part.axis == "x" else part
