"""Matplotlib's painter: draws what `describe` declares, in a figure or in axes that are there."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib import figure as sheets
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LightSource, ListedColormap, LogNorm, Normalize, to_hex
from matplotlib.patches import Ellipse, Patch, Rectangle
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from warpwear.figures import describe, style
from warpwear.figures.describe import (
    Bodies,
    Chart,
    Cloud,
    Empty,
    Figure,
    Level,
    Line,
    Look,
    Map,
    Panel,
    Scale,
)
from warpwear.figures.paint_others import PAINT_3D, PAINT_OTHERS

#: Kinds of line as Matplotlib has them.
DASHES: dict[str, Any] = {"solid": "-", "dash": "--", "dashdot": "-.", "dot": ":", "": "none"}
DASHES |= {"longdash": (0, (6, 1)), "longdashdot": (0, (3, 1, 1, 1))}
#: Inches that a character of a legend takes, and a line with its room beside the text.
CHARACTER, LEGEND_LINE = 0.05, 0.45
#: Inches around square maps: labels at the left, a colour bar, what lies below, a line of a title, a gap.
LEFT, BAR, BELOW, TITLE, GAP = 0.6, 0.66, 0.42, 0.135, 0.1
#: A row of a legend [inch].
LEGEND_ROW = 0.165
#: Left, bottom, width and height of a colour bar beside a map, over the map's.
BESIDE = (1.04, 0.0, 0.05, 1.0)
#: Part of a map's width at either end that bears no tick where maps stand side by side.
CORNER = 0.05
#: Fewer decades than this keep all ticks of a logarithmic axis; more than this have no number between them.
LEAST_THINNED, NUMBERED = 0.5, 2.3
#: Decades of a colour bar up to which 2 and 5 have numbers.
BAR_NUMBERED = 2.5
#: More decades than this from the first state of a scar have a number at each only.
DECADES = 2.2
#: Points along a side from which lines of equal height are drawn.
CONTOURED = 60
HIDDEN = ListedColormap(["#E4E4E4"])
#: Light from the upper left on bodies seen from above; how much steeper slopes look.
LIGHT, STEEPER = LightSource(azdeg=315.0, altdeg=45.0), 4.0
#: Seconds of a unit of time.
SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0}
#: Mark of a title that is ours, before its text.
OURS = "warpwear: "


def paint(figure: Figure) -> sheets.Figure:
    """Draw a figure."""
    cells = [cell for panel in figure.panels for cell in _cells(panel)]
    with style.style():
        if all(type(cell) in PAINT_3D for cell in cells):
            return _sheet_3d(cells)
        columns = figure.columns or max(len(_cells(panel)) for panel in figure.panels)
        columns = len(cells) if columns == 1 and not figure.columns else columns
        rows = -(-len(cells) // columns)
        labels = _states(cells)
        width = figure.width or (describe.COLUMN if columns == 1 else describe.PAGE)
        sheet = sheets.Figure(figsize=(width, figure.height * rows), layout="constrained")
        FigureCanvasAgg(sheet)
        sheet.get_layout_engine().set(w_pad=0.06, h_pad=0.04, wspace=0.02, hspace=0.02)
        grid = sheet.subplots(rows, columns, squeeze=False)
        for axes, cell in zip(grid.ravel(), [*cells, *[Empty()] * (grid.size - len(cells))], strict=True):
            _paint_panel(axes, cell)
        _share(grid, figure.shared)
        _bars(sheet, grid, cells)
        handles = labels or _handles(grid.ravel())
        beside = legend_columns([*handles], figure.legend or len(handles), width)
        if handles and (figure.legend or labels):
            sheet.legend(
                [*handles.values()], [*handles], loc="outside upper center", ncols=beside, borderaxespad=0.1
            )
        legend = LEGEND_ROW * -(-len(handles) // beside) if figure.legend or labels else 0.0
        if cells and all(isinstance(cell, Map) and cell.square for cell in cells):
            sheet.set_figheight(_height(cells, rows, columns, width) + legend)
        elif legend > LEGEND_ROW:  # makes the figure higher, not its panels lower
            sheet.set_figheight(figure.height * rows + legend - LEGEND_ROW)
        _tell_scales(sheet, grid, cells)
    return sheet


def paint_over(figure: Figure, axes: Sequence[Axes]) -> sheets.Figure:
    """Draw charts into axes that are there, over what they show; return the outermost figure of these."""
    for panel, chart in zip(axes, figure.panels, strict=True):
        assert isinstance(chart, Chart)
        _over(panel, chart)
    handles = _handles(axes)
    if handles and figure.legend:
        for legend in [panel.get_legend() for panel in axes]:
            if legend is not None:
                legend.remove()
        axes[-1].legend([*handles.values()], [*handles])
    whole: sheets.Figure = axes[0].figure.figure
    return whole


def of_run(figure: Figure, *, label: str | None = None, color: Any = None) -> Figure:
    """Give a figure of charts the name of its run, and its lines a colour."""
    colour = None if color is None else to_hex(color)
    charts = [replace(chart, lines=_named(chart.lines, label, colour)) for chart in figure.panels]
    return replace(figure, panels=charts, legend=figure.legend if label is None else 2)


def _named(lines: Sequence[Any], label: str | None, colour: str | None) -> list[Any]:
    """Put a name before the labels of lines; where none has one, the last plain line is called so."""
    lines = [replace(line, look=replace(line.look, colour=colour or line.look.colour)) for line in lines]
    if label is None:
        return lines
    if any(line.label for line in lines):
        return [replace(line, label=f"{label}: {line.label}" if line.label else "") for line in lines]
    plain = [
        i for i, of in enumerate(lines) if isinstance(of, Line) and of.look.alpha == 1.0 and of.x.size > 1
    ]
    last = (plain or [len(lines) - 1])[-1]
    return [replace(line, label=label) if i == last else line for i, line in enumerate(lines)]


def _over(axes: Axes, chart: Chart) -> None:
    """Draw a chart over what axes show, which stays in sight; a title of ours for one of both goes."""
    there, title = axes.has_data(), axes.get_title()
    ends = {n: (getattr(axes, f"get_{n}scale")(), *getattr(axes, f"get_{n}lim")()) for n in "xy" if there}
    is_ours = axes.title.get_label() == OURS + title
    axes.autoscale(True)
    paint_chart(axes, _in_unit_of(axes, chart))
    for axis, (scale, start, end) in ends.items():
        if scale == getattr(axes, f"get_{axis}scale")():
            both = sorted([start, end, *getattr(axes, f"get_{axis}lim")()])
            getattr(axes, f"set_{axis}lim")(*(both[0], both[-1])[:: 1 if start < end else -1])
    if title and not is_ours:
        axes.set_title(title)
    else:
        if there and axes.get_title() != title:
            axes.set_title("")
        axes.title.set_label(OURS + axes.get_title())


def _in_unit_of(axes: Axes, chart: Chart) -> Chart:
    """Give times of a chart the unit of time that stands at the axis already."""
    (what, _, unit), (there, _, held) = (
        label.rpartition(", ") for label in (chart.x.label, axes.get_xlabel())
    )
    if what != there or unit == held or unit not in SECONDS:
        return chart
    factor = SECONDS[unit] / SECONDS[held]
    lines = [replace(line, x=factor * line.x) if isinstance(line, Line) else line for line in chart.lines]
    return replace(chart, lines=lines, x=replace(chart.x, label=axes.get_xlabel()))


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
    at: Any = getattr(axes, f"{which}axis")
    set_ends = getattr(axes, f"set_{which}lim")
    getattr(axes, f"set_{which}label")(axis.label)
    if axis.scale == "unworn":
        return _scale_from_unworn(axes, axis)
    if axis.scale == "log":
        getattr(axes, f"set_{which}scale")("log")
        style.plain_numbers(at)
    else:
        at.set_major_locator(MaxNLocator(axis.ticks, steps=[1, 2, 5, 10], integer=axis.integer))
        at.set_major_formatter(style.Thousands())
    is_log = getattr(axes, f"get_{which}scale")() == "log"
    set_ends(None if is_log and not (axis.low or 0.0) > 0.0 else axis.low, axis.high)
    if axis.least and is_log:
        set_ends(max(min(at.get_view_interval()), axis.least), None)
    if axis.places:
        at.set_ticks([place for place, _ in axis.places], [text for _, text in axis.places])
    _thin_ticks(at, numbered=axis.numbered)
    at.set_inverted(axis.inverted)


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
    axes.xaxis.set_major_formatter(lambda value, _: describe.short(value) if value else "unworn")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlim(0.0, 1.15 * last)


def _line(axes: Axes, line: Line) -> None:
    look, kind = line.look, f"steps-{line.step}" if line.step else "default"
    is_band = not (look.dash or look.marker)
    if line.low is not None and line.high is not None:
        hatched: dict[str, Any] = {"facecolor": "none", "edgecolor": look.colour, "hatch": line.hatch}
        fill = hatched if line.hatch else {"color": look.colour, "alpha": look.alpha if is_band else 0.2}
        axes.fill_between(line.x, line.low, line.high, lw=0, label=line.label if is_band else None, **fill)
    if not is_band:
        axes.plot(
            line.x,
            line.y,
            drawstyle=kind,
            label=line.label or None,
            clip_on=line.clipped,
            markevery=line.every,
            **of_look(look),
        )


def of_look(look: Look) -> dict[str, Any]:
    """Give a look as Matplotlib's keyword arguments of a line."""
    mark: dict[str, Any] = {"marker": look.marker, "ms": look.size} if look.marker else {}
    if look.hollow:
        mark |= {"mfc": "white", "zorder": 3}
    alpha = None if look.alpha == 1.0 else look.alpha
    return {"color": look.colour, "ls": DASHES[look.dash], "lw": look.width, "alpha": alpha, **mark}


def _level(axes: Axes, level: Level) -> None:
    draw = axes.axhline if level.axis == "y" else axes.axvline
    draw(level.value, label=level.label or None, **of_look(level.look))


def _cloud(axes: Axes, cloud: Cloud) -> None:
    top = float(cloud.counts.max()) * 1.01
    axes.contourf(cloud.x, cloud.y, cloud.counts.T, levels=[*cloud.levels, top], colors=cloud.colours)
    axes.contour(cloud.x, cloud.y, cloud.counts.T, levels=cloud.levels, colors=cloud.edge, linewidths=0.7)


PARTS: dict[type, Callable[[Axes, Any], None]] = {Line: _line, Level: _level, Cloud: _cloud}


def paint_map(axes: Axes, field: Map) -> Any:
    """Draw a map of one field into axes, x to the right; returns the image."""
    values, ends = field.fields[0], field.extent
    colours, norm = _colours(field)
    if field.lit:
        step = 1e3 * (ends[1] - ends[0]) / values.shape[0]
        filled = np.where(np.isfinite(values), values, np.nanmin(values)).T
        lit = LIGHT.shade(filled, colours, norm, blend_mode="soft", vert_exag=STEEPER, dx=step, dy=step)
        axes.imshow(lit, origin="lower", extent=ends)
    # Cells as they are: smoothing would invent pressures and break the categories of contact.
    kind: Any = {"origin": "lower", "extent": ends, "interpolation": "nearest"}
    if field.hidden is not None:
        axes.imshow(np.where(field.hidden, 1.0, np.nan).T, cmap=HIDDEN, **kind)
    image = axes.imshow(values.T, cmap=colours, norm=norm, visible=not field.lit, **kind)
    if field.contours:
        _contours(axes, field)
    for outline in field.outlines:
        x0, x1, y0, y1 = outline.ends
        line: Any = {
            "fill": False,
            "ec": outline.look.colour,
            "lw": outline.look.width,
            "ls": DASHES[outline.look.dash],
        }
        middle = (0.5 * (x0 + x1), 0.5 * (y0 + y1))
        round_one = Ellipse(middle, x1 - x0, y1 - y0, **line)
        axes.add_patch(round_one if outline.round else Rectangle((x0, y0), x1 - x0, y1 - y0, **line))
    for level in field.levels:
        _level(axes, level)
    axes.set(xlabel=field.x, ylabel=field.y)
    axes.set_title(
        "\n".join(filter(None, [*field.labels, *field.notes])) or (" " if field.stretch_note else "")
    )
    for axis, most in ((axes.xaxis, 4 if field.square else 8), (axes.yaxis, 4)):
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10]))
    if not field.square:
        axes.set_aspect("auto")
    return image


def _colours(field: Map) -> tuple[Any, Normalize]:
    """Choose colours and scale of a map."""
    if field.states:
        return ListedColormap([colour for _, colour in field.states]), Normalize(
            -0.5, len(field.states) - 0.5
        )
    scale = field.scale
    return style.COLOURS[scale.colours], (LogNorm if scale.log else Normalize)(scale.low, scale.high)


def _contours(axes: Axes, field: Map) -> None:
    """Draw lines of equal value over a map: where they lie far apart what it shows is flat."""
    values, (x0, x1, y0, y1) = field.fields[0], field.extent
    n = -(-max(values.shape) // CONTOURED)
    nx, ny = (size // n for size in values.shape)
    whole = np.nan_to_num(values[: nx * n, : ny * n], nan=field.scale.low)
    coarse = whole.reshape(nx, n, ny, n).mean(axis=(1, 3))
    x, y = np.linspace(x0, x1, 2 * nx + 1)[1::2], np.linspace(y0, y1, 2 * ny + 1)[1::2]
    levels = MaxNLocator(field.contours).tick_values(field.scale.low, field.scale.high)
    kind: Any = {"colors": "black", "linewidths": 0.4, "linestyles": "-", "alpha": 0.7}
    axes.contour(x, y, coarse.T, levels=levels, **kind)


def _cells(panel: Panel) -> list[Panel]:
    """Give the panels that paper needs for one: a map one a field."""
    if isinstance(panel, Bodies):
        return [_from_above(panel, name) for name in panel.still]
    if not isinstance(panel, Map):
        return [panel]
    count = len(panel.fields)
    labels, notes = ([*texts] or [""] * count for texts in (panel.labels, panel.notes))
    head = [panel.title] if panel.heading else []
    return [
        replace(panel, fields=[values], labels=[*head, label], notes=[note])
        for values, label, note in zip(panel.fields, labels, notes, strict=True)
    ]


def _from_above(panel: Bodies, name: str) -> Map:
    """Give the map of a body's heights, on a scale of its own."""
    heights = panel.heights[name]
    scale = Scale("height, µm", float(np.nanmin(heights)), float(np.nanmax(heights)), colours="heights")
    return Map(name, [heights], panel.extent, scale, [f"{name}, seen from above"], [""], lit=True)


def _paint_panel(axes: Axes, cell: Panel) -> None:
    if isinstance(cell, Chart):
        paint_chart(axes, cell)
    elif isinstance(cell, Map):
        paint_map(axes, cell)
    elif isinstance(cell, Empty):
        axes.set_axis_off()
    else:
        PAINT_OTHERS[type(cell)](axes, cell)


def _share(grid: Any, shared: str) -> None:
    """Give the panels of a row one y and those of a column one x, numbered at the left and at the bottom."""
    for row in grid if "y" in shared else ():
        ends = [panel.get_ylim() for panel in row]
        for panel in row:
            panel.set_ylim(min(low for low, _ in ends), max(high for _, high in ends))
        for panel in row[1:]:
            panel.tick_params(which="both", labelleft=False)
            panel.set_ylabel("")
    for column in grid.T if "x" in shared else ():
        for panel in column[:-1]:
            panel.tick_params(which="both", labelbottom=False)
            panel.set_xlabel("")


def _bars(sheet: Any, grid: Any, cells: Sequence[Panel]) -> None:
    """Draw colour bars: one for all maps of one scale, else one for each; and tidy maps side by side."""
    maps = [(axes, cell) for axes, cell in zip(grid.ravel(), cells, strict=False) if isinstance(cell, Map)]
    scaled = [(axes, cell) for axes, cell in maps if not cell.states]
    one = len({cell.scale for _, cell in scaled}) == 1 and len(scaled) == len(cells) > 1
    if one:
        bar = sheet.colorbar(
            scaled[0][0].images[-1],
            ax=grid.ravel().tolist(),
            aspect=30,
            shrink=0.85,
            pad=0.015,
            fraction=0.05,
            extend=scaled[0][1].scale.beyond,
        )
        _number_bar(bar, scaled[0][1].scale)
    for axes, cell in maps:
        if not one and not cell.states and cell.scale.label:
            place = BESIDE if cell.square else (1.012, 0.0, 0.012, 1.0)
            bar = sheet.colorbar(axes.images[-1], cax=axes.inset_axes(place), extend=cell.scale.beyond)
            _number_bar(bar, cell.scale)
        low, high = axes.get_xlim()
        room = CORNER * (high - low)  # for labels of two panels that meet
        if cell.square:
            axes.set_xticks([tick for tick in axes.get_xticks() if low + room < tick < high - room])
        if len({other.extent for _, other in maps}) == 1 and len(maps) == len(cells) and cell.square:
            axes.label_outer()


def _number_bar(bar: Any, scale: Scale) -> None:
    bar.set_label(scale.label)
    if scale.log:
        bar.ax.yaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter(style.PlainNumbers())
        bar.ax.yaxis.set_minor_formatter(style.PlainNumbers(minor_thresholds=(BAR_NUMBERED, BAR_NUMBERED)))
    else:
        bar.locator = MaxNLocator(5, steps=[1, 2, 5, 10])
        bar.update_ticks()


def _states(cells: Sequence[Panel]) -> dict[str, Any]:
    """Name the states that any map shows, each with its colour."""
    handles: dict[str, Any] = {}
    for states in dict.fromkeys(cell.states for cell in cells if isinstance(cell, Map) and cell.states):
        maps = [cell for cell in cells if isinstance(cell, Map) and cell.states == states]
        present = {int(code) for cell in maps for code in np.unique(cell.fields[0])}
        for code, (label, colour) in enumerate(states):
            if code in present:
                handles[label] = Patch(facecolor=colour, edgecolor="#777777", lw=0.5, label=label)
    return handles


def _handles(panels: Any) -> dict[str, Any]:
    """Collect what the legend of panels shows, each label once."""
    handles: dict[str, Any] = {}
    for panel in panels:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    return handles


def legend_columns(labels: Sequence[str], most: int, width: float) -> int:
    """Say how many columns of a legend a width [inch] holds: at most so many, at least one."""
    for columns in range(min(most, len(labels)), 1, -1):
        parts = np.array_split(np.array(labels, dtype=object), columns)  # one column after another
        if sum(CHARACTER * max(map(len, part), default=0) + LEGEND_LINE for part in parts) <= width:
            return columns
    return 1


def _height(cells: Sequence[Any], rows: int, columns: int, width: float) -> float:
    """Find the height of a figure of square maps from its width [inch]."""
    own = len({cell.scale for cell in cells}) > 1 or len(cells) == 1
    bars = 0.0 if cells[0].states else BAR * (columns if own else 1)
    lefts = LEFT * (1 if len({cell.extent for cell in cells}) == 1 else columns)
    side = (width - lefts - bars - GAP * (columns - 1)) / columns
    lines = max(sum(map(bool, (*cell.labels, *cell.notes))) for cell in cells)
    x0, x1, y0, y1 = cells[0].extent
    below = BELOW if len({cell.extent for cell in cells}) == 1 else rows * BELOW
    return rows * (side * (y1 - y0) / (x1 - x0) + TITLE * lines + GAP) + below


def _tell_scales(sheet: Any, grid: Any, cells: Sequence[Panel]) -> None:
    """Say above panels how many times larger y is drawn than x, once they have their places."""
    stretch_note = [
        (axes, cell)
        for axes, cell in zip(grid.ravel(), cells, strict=False)
        if getattr(cell, "stretch_note", "")
    ]
    if stretch_note:
        sheet.get_layout_engine().execute(sheet)
        sheet.set_layout_engine("none")
    for axes, cell in stretch_note:
        unit = cell.stretch_factor if isinstance(cell, Chart) else 1.0
        axes.set_title(cell.stretch_note.format(describe.short(float(f"{unit * stretch(axes):.2g}"))))


def stretch(panel: Axes) -> float:
    """Return how many times larger a panel whose place is known draws a unit of y than one of x."""
    box = panel.get_window_extent()
    (x0, x1), (y0, y1) = panel.get_xlim(), panel.get_ylim()
    return float((box.height / (y1 - y0)) / (box.width / (x1 - x0)))


def _sheet_3d(cells: Sequence[Any]) -> sheets.Figure:
    """Draw one or two boxes, placed by hand: layouts cut off the labels of 3-D."""
    sheet = sheets.Figure(figsize=(describe.COLUMN if len(cells) == 1 else describe.PAGE, 2.75))
    FigureCanvasAgg(sheet)
    width = 1.0 / len(cells)
    for number, cell in enumerate(cells):
        place = (number * width, 0.1, 0.92 * width, 0.76)
        axes = sheet.add_axes(place, projection="3d", computed_zorder=False)
        PAINT_3D[type(cell)](axes, cell)
    return sheet
