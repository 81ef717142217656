"""Charts drawn into axes that are there, over what they show, under the name and in the colour of a run."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure as Sheet

from warpwear.figures.describe import Chart, Figure, Line
from warpwear.figures.paint import handles_of
from warpwear.figures.paint_chart import paint_chart
from warpwear.figures.units import far, in_unit

#: Mark of a title that is ours, before its text.
OURS = "warpwear: "


def paint_over(figure: Figure, axes: Sequence[Axes]) -> Sheet:
    """Draw charts into axes that are there, over what they show; return the outermost figure of these."""
    for panel, chart in zip(axes, far(figure).panels, strict=True):
        assert isinstance(chart, Chart)
        _over(panel, chart)
    handles = handles_of(axes)
    if handles and figure.legend:
        for legend in [panel.get_legend() for panel in axes]:
            if legend is not None:
                legend.remove()
        axes[-1].legend([*handles.values()], [*handles])
    return axes[0].figure.figure


def of_run(figure: Figure, *, label: str | None = None, color: Any = None) -> Figure:
    """Give a figure of charts the name of its run, and its lines a colour."""
    colour = None if color is None else to_hex(color)
    charts = [chart for chart in figure.panels if isinstance(chart, Chart)]
    charts = [replace(chart, lines=_named(chart.lines, label, colour)) for chart in charts]
    return replace(figure, panels=charts, legend=figure.legend if label is None else 2)


def _named(lines: Sequence[Any], label: str | None, colour: str | None) -> list[Any]:
    """Put a name before the labels of lines; where none has one, the last plain line is called so."""
    lines = [replace(line, look=replace(line.look, colour=colour or line.look.colour)) for line in lines]
    if label is None:
        return lines
    if any(line.label for line in lines):
        return [replace(line, label=f"{label}: {line.label}" if line.label else "") for line in lines]
    solid = [isinstance(line, Line) and line.look.alpha == 1.0 and line.x.size > 1 for line in lines]
    plain = [number for number, is_plain in enumerate(solid) if is_plain]
    last = (plain or [len(lines) - 1])[-1]
    return [replace(line, label=label) if i == last else line for i, line in enumerate(lines)]


def _over(axes: Axes, chart: Chart) -> None:
    """Draw a chart over what axes show, which stays in sight; a title of ours for one of both goes."""
    has_data, title = axes.has_data(), axes.get_title()
    ends = {n: (getattr(axes, f"get_{n}scale")(), *getattr(axes, f"get_{n}lim")()) for n in "xy" if has_data}
    is_ours = axes.title.get_label() == OURS + title
    axes.autoscale(True)
    paint_chart(axes, in_unit(chart, axes.get_xlabel()))
    for axis, (scale, start, end) in ends.items():
        if scale == getattr(axes, f"get_{axis}scale")():
            both = sorted([start, end, *getattr(axes, f"get_{axis}lim")()])
            getattr(axes, f"set_{axis}lim")(*(both[0], both[-1])[:: 1 if start < end else -1])
    if title and not is_ours:
        axes.set_title(title)
    else:
        if has_data and axes.get_title() != title:
            axes.set_title("")
        axes.title.set_label(OURS + axes.get_title())
