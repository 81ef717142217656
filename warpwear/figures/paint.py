"""Matplotlib's painter: draws what `describe` declares, in a figure or in axes that are there."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import Any

import numpy as np
from matplotlib import figure as sheets
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator

from warpwear.figures import describe, style, wording
from warpwear.figures.describe import Box, Chart, Empty, Figure, Map, Panel, Scale, Scene
from warpwear.figures.paint_chart import paint_chart
from warpwear.figures.paint_map import paint_map
from warpwear.figures.paint_others import PAINT_OTHERS, paint_box
from warpwear.figures.units import far

#: Inches that a character of a legend takes, and a line with its room beside the text.
CHARACTER, LEGEND_LINE = 0.05, 0.45
#: Inches around square maps: labels at the left, a colour bar, what lies below, a line of a title, a gap.
LEFT, BAR, BELOW, TITLE, GAP = 0.6, 0.66, 0.42, 0.135, 0.1
#: Height of a row of a map that is too long to stand beside others [inch].
LONG_ROW = 1.35
#: Dots per inch of figures that a notebook shows.
SCREEN = 120
#: A row of a legend [inch].
LEGEND_ROW = 0.165
#: Left, bottom, width and height of a colour bar over those of a map beside it, and of one that fills a row.
BESIDE, BESIDE_LONG = (1.04, 0.0, 0.05, 1.0), (1.012, 0.0, 0.012, 1.0)
#: One bar beside all maps: length over width, length over theirs, room before it, and its part of the sheet.
ONE_BAR: Any = {"aspect": 30, "shrink": 0.85, "pad": 0.015, "fraction": 0.05}
#: Part of a map's width at either end that bears no tick where maps stand side by side.
CORNER = 0.05
#: Decades of a colour bar up to which 2 and 5 have numbers.
BAR_NUMBERED = 2.5


class Sheet(sheets.Figure):
    """A figure that a notebook shows, whichever backend Matplotlib has there."""

    def _repr_png_(self) -> bytes:
        return style.bytes_of(self, dpi=SCREEN)


def paint(figure: Figure) -> sheets.Figure:
    """Draw a figure."""
    cells = [cell for panel in far(figure).panels for cell in _cells(panel)]
    if all(isinstance(cell, Map) and cell.square and cell.is_long for cell in cells):
        cells = [_stretched(cell) for cell in cells]
        figure = replace(figure, columns=1, width=describe.PAGE, height=LONG_ROW, shared="x")
    with style.style():
        if all(isinstance(cell, Box) for cell in cells):
            return _sheet_3d(cells)
        columns = figure.columns or max(len(_cells(panel)) for panel in figure.panels)
        columns = len(cells) if columns == 1 and not figure.columns else columns
        rows = -(-len(cells) // columns)
        width = figure.width or (describe.COLUMN if columns == 1 else describe.PAGE)
        layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.04, wspace=0.02, hspace=0.02)
        sheet = Sheet(figsize=(width, figure.height * rows), layout=layout)
        FigureCanvasAgg(sheet)
        grid = sheet.subplots(rows, columns, squeeze=False)
        for axes, cell in zip_longest(grid.ravel(), cells, fillvalue=Empty()):
            PAINTERS[type(cell)](axes, cell)
        _share(grid, figure.shared)
        _bars(sheet, grid, cells)
        legend = _legend(sheet, figure, _states(cells) or handles_of(grid.ravel()))
        if all(isinstance(cell, Map) and cell.square for cell in cells):
            sheet.set_figheight(_height(cells, rows, columns, width) + LEGEND_ROW * legend)
        elif legend > 1:  # makes the figure higher, not its panels lower
            sheet.set_figheight(figure.height * rows + LEGEND_ROW * (legend - 1))
        _show_scales(layout, sheet, grid, cells)
    return sheet


def _legend(sheet: sheets.Figure, figure: Figure, handles: dict[str, Any]) -> int:
    """Put one legend over all panels, in fewer columns where names are long; return its number of rows."""
    if not handles or not figure.legend:
        return 0
    columns = legend_columns([*handles], figure.legend, sheet.get_figwidth())
    where: Any = "outside upper center"
    sheet.legend([*handles.values()], [*handles], loc=where, ncols=columns, borderaxespad=0.1)
    return -(-len(handles) // columns)


def _cells(panel: Panel) -> list[Panel]:
    """Give the panels that paper needs for one: a map one a field."""
    if isinstance(panel, Scene):
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


def _stretched(cell: Any) -> Map:
    """Give a map that fills a row, higher than it is, and says so."""
    title = ", ".join(filter(None, [*cell.labels, *cell.notes])).replace("\n", ", ")
    note = f"{title} (y drawn {{}} times as large as x)"
    return replace(cell, square=False, labels=[], notes=[], stretch_note=note, y="across, mm")


def _from_above(panel: Scene, name: str) -> Map:
    """Give the map of a body's heights, on a scale of its own."""
    heights = panel.heights[name]
    scale = Scale("height, µm", float(np.nanmin(heights)), float(np.nanmax(heights)), colours="heights")
    return Map(name, [heights], panel.extent, scale, [f"{name}, seen from above"], [""], lit=True)


#: Kind of panel -> what draws it into axes.
PAINTERS: dict[type, Callable[..., Any]] = {Chart: paint_chart, Map: paint_map, **PAINT_OTHERS}
PAINTERS[Empty] = lambda axes, _: axes.set_axis_off()


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
    scaled = [(axes, cell) for axes, cell in maps if not cell.states and cell.scale.label]
    one = len({cell.scale for _, cell in scaled}) == 1 and len(scaled) == len(cells) > 1
    for axes, cell in scaled[:1] if one else scaled:
        if one:
            where = {"ax": grid.ravel().tolist(), **ONE_BAR}
        else:
            where = {"cax": axes.inset_axes(BESIDE if cell.square else BESIDE_LONG)}
        _number_bar(sheet.colorbar(axes.images[-1], extend=cell.scale.beyond, **where), cell.scale)
    for axes, cell in maps:
        if cell.square:  # labels of two panels meet at their corners
            axes.set_xticks(style.inner_ticks(axes.get_xlim(), CORNER))
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


def handles_of(panels: Any) -> dict[str, Any]:
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


def _show_scales(layout: ConstrainedLayoutEngine, sheet: Any, grid: Any, cells: Sequence[Any]) -> None:
    """Say above panels how many times larger y is drawn than x, once they have their places."""
    stretched = [
        (a, cell) for a, cell in zip(grid.ravel(), cells, strict=False) if getattr(cell, "stretch_note", "")
    ]
    if stretched:
        layout.execute(sheet)
        sheet.set_layout_engine("none")
    for axes, cell in stretched:
        unit = cell.stretch_factor if isinstance(cell, Chart) else 1.0
        axes.set_title(cell.stretch_note.format(wording.short(float(f"{unit * stretch(axes):.2g}"))))


def stretch(panel: Axes) -> float:
    """Return how many times larger a panel whose place is known draws a unit of y than one of x."""
    box = panel.get_window_extent()
    (x0, x1), (y0, y1) = panel.get_xlim(), panel.get_ylim()
    return float((box.height / (y1 - y0)) / (box.width / (x1 - x0)))


def _sheet_3d(cells: Sequence[Any]) -> sheets.Figure:
    """Draw one or two boxes, placed by hand: layouts cut off the labels of 3-D."""
    sheet = Sheet(figsize=(describe.COLUMN if len(cells) == 1 else describe.PAGE, 2.75))
    FigureCanvasAgg(sheet)
    width = 1.0 / len(cells)
    for number, cell in enumerate(cells):
        place = (number * width, 0.1, 0.92 * width, 0.76)
        paint_box(sheet.add_axes(place, projection="3d", computed_zorder=False), cell)
    return sheet
