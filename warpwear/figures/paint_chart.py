"""Paint charts with Matplotlib: lines, levels and clouds over one pair of axes."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from warpwear.figures import describe, style, wording
from warpwear.figures.describe import Chart, Density, Level, Line, Look

#: Kinds of line as Matplotlib has them.
DASHES: dict[str, Any] = {"solid": "-", "dash": "--", "dashdot": "-.", "dot": ":", "": "none"}
DASHES |= {"longdash": (0, (6, 1)), "longdashdot": (0, (3, 1, 1, 1))}
#: Fewer decades than this keep all ticks of a logarithmic axis; more than this have no number between them.
LEAST_THINNED, NUMBERED = 0.5, 2.3
#: More decades than this from the first state of a scar have a number at each only.
DECADES = 2.2


def paint_chart(axes: Axes, chart: Chart) -> None:
    """Draw a chart into axes."""
    older = [line for line in axes.lines if line.get_transform() == axes.transData]
    for part in chart.lines:
        PARTS[type(part)](axes, part)
    for which, axis in (("x", chart.x), ("y", chart.y)):
        values = [np.asarray(getattr(line, f"get_{which}data")(), dtype=np.float64) for line in older]
        values += describe.values_of(chart, which)
        if getattr(axes, f"get_{which}scale")() == "log" and axis.scale == "auto":
            axis = replace(axis, scale="log")
        set_axis(axes, which, describe.scaled(axis, *values))
    axes.set_title(chart.note or (" " if chart.stretch_note else ""))


def set_axis(axes: Axes, which: str, axis: describe.Axis) -> None:
    """Give one axis, "x" or "y", of a panel its label, scale, ends and ticks."""
    mpl_axis: Any = getattr(axes, f"{which}axis")
    set_ends = getattr(axes, f"set_{which}lim")
    getattr(axes, f"set_{which}label")(axis.label)
    if axis.scale == "unworn":
        return _scale_from_unworn(axes, axis)
    if axis.scale == "log":
        getattr(axes, f"set_{which}scale")("log")
        style.plain_numbers(mpl_axis)
    else:
        mpl_axis.set_major_locator(MaxNLocator(axis.ticks, steps=[1, 2, 5, 10], integer=axis.integer))
        mpl_axis.set_major_formatter(style.Thousands())
    is_log = getattr(axes, f"get_{which}scale")() == "log"
    set_ends(None if is_log and not (axis.low or 0.0) > 0.0 else axis.low, axis.high)
    if axis.least and is_log:
        set_ends(max(min(mpl_axis.get_view_interval()), axis.least), None)
    if axis.places:
        mpl_axis.set_ticks([place for place, _ in axis.places], [text for _, text in axis.places])
    _thin_ticks(mpl_axis, numbered=axis.numbered)
    if not axis.numbered and axis.scale == "linear":
        mpl_axis.set_tick_params(labelbottom=False, labelleft=False)
    mpl_axis.set_inverted(axis.inverted)


def _thin_ticks(axis: Any, *, numbered: bool) -> None:
    """Keep two ticks between decades of a logarithmic axis, numbered where decades are few."""
    low, high = sorted(axis.get_view_interval())
    if axis.get_scale() == "log" and low > 0.0 and high > 10.0**LEAST_THINNED * low:
        axis.set_minor_locator(LogLocator(subs=(2.0, 5.0), numticks=50))
        if high < 10.0**NUMBERED * low and numbered:
            style.plain_numbers(axis, decades=NUMBERED)
        elif not numbered:
            axis.set_tick_params(which="minor", labelbottom=False, labelleft=False)


def _scale_from_unworn(axes: Axes, axis: describe.Axis) -> None:
    """Make x logarithmic from the first place above 0 on; before it 0, the unworn state, has its place."""
    places = np.unique(np.concatenate([np.asarray(line.get_xdata()) for line in axes.lines]))
    least, last = axis.least or float(places[places > 0.0][0]), float(places[-1])
    start = 10.0 ** np.floor(np.log10(least))
    axes.set_xscale("symlog", linthresh=start, linscale=0.5)
    digits = (1.0, 2.0, 5.0) if np.log10(last / least) < DECADES else (1.0,)
    ticks = [digit * 10.0**power for power in range(round(np.log10(start)), 10) for digit in digits]
    axes.set_xticks([0.0, *(tick for tick in ticks if tick <= 1.05 * last)])
    axes.xaxis.set_major_formatter(lambda value, _: wording.short(value) if value else "unworn")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlim(0.0, 1.15 * last)


def _line(axes: Axes, line: Line) -> None:
    if line.written:
        axes.text(float(line.x[0]), float(line.y[0]), line.label, ha="center", va="center")
        return
    look, kind = line.look, f"steps-{line.step}" if line.step else "default"
    is_band = not (look.dash or look.marker)
    if line.low is not None and line.high is not None:
        hatched: dict[str, Any] = {"facecolor": "none", "edgecolor": look.colour, "hatch": line.hatch}
        fill = hatched if line.hatch else {"color": look.colour, "alpha": look.alpha if is_band else 0.2}
        axes.fill_between(line.x, line.low, line.high, lw=0, label=line.label if is_band else None, **fill)
    if not is_band:
        how: Any = {"label": line.label or None, "clip_on": line.clipped, "markevery": line.every}
        axes.plot(line.x, line.y, drawstyle=kind, **how, **of_look(look))


def of_look(look: Look) -> dict[str, Any]:
    """Give a look as Matplotlib's keyword arguments of a line."""
    mark: dict[str, Any] = {"marker": look.marker, "ms": look.size} if look.marker else {}
    if look.hollow:
        mark |= {"mfc": "white", "zorder": 3}
    alpha = None if look.alpha == 1.0 else look.alpha
    return {"color": look.colour, "ls": DASHES[look.dash], "lw": look.width, "alpha": alpha, **mark}


def paint_level(axes: Axes, level: Level) -> None:
    """Draw a level across the axes."""
    draw = axes.axhline if level.axis == "y" else axes.axvline
    draw(level.value, label=level.label or None, **of_look(level.look))


def _cloud(axes: Axes, cloud: Density) -> None:
    top = float(cloud.counts.max()) * 1.01
    axes.contourf(cloud.x, cloud.y, cloud.counts.T, levels=[*cloud.levels, top], colors=cloud.colours)
    axes.contour(cloud.x, cloud.y, cloud.counts.T, levels=cloud.levels, colors=cloud.edge, linewidths=0.7)


PARTS: dict[type, Callable[[Axes, Any], None]] = {Line: _line, Level: paint_level, Density: _cloud}
