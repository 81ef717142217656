"""Figures of the report: those of its runs, their courses over each other, maps side by side, bars."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import matplotlib
import numpy as np
from compared import Numbers
from items import ALL_ITEMS, folded
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from printed import read
from recomputed import LABELS, VERSIONS, Runs

#: Draws a figure.
Draw = Callable[[Runs, Numbers], Figure]
#: Widths of a column and of the text, height of a row of panels [inch].
COLUMN, PAGE, ROW = 3.5, 7.0, 2.6
STYLE = {
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.2,
}
#: Lines of runs over each other, in their order, and colours of bars: ours and what is printed.
LINES = (("#0072B2", "-"), ("#D55E00", "--"), ("#009E73", "-."), ("#A3487F", ":"))
OURS, PRINTED = "#0072B2", "#999999"
DISTANCE = "sliding distance, mm"
#: Figure -> what stands below it.
CAPTIONS = {name: folded(text) for name, text in read("captions.toml").items()}
#: Figure -> a run, and the figure of it.
OF_A_RUN = {
    "pressure_of_v1": ("v1", "hertz"),
    "disc_of_v1": ("v1", "disc_profiles"),
    "disc_3d_of_v1": ("v1", "disc_3d"),
    "counter_3d_of_v1": ("v1", "counter_3d"),
    "volumes_of_v1": ("v1", "volumes"),
    "cof_of_v1": ("v1", "cof"),
    "contact_areas": ("v1", "contact_map"),
    "distance_factor": ("v2", "distance_factor"),
    "counter_of_v2": ("v2", "counter_profiles"),
    "disc_3d_of_v3": ("v3", "disc_3d"),
    "counter_3d_of_v3": ("v3", "counter_3d"),
    "disc_maps_of_v3": ("v3", "disc_map"),
    "straight_line": ("v3", "areas"),
}
#: Figure -> a run, and figures of it with their numbers of panels, which are laid out together.
TOGETHER = {
    "radius_and_pressure": ("v1", {"contact_radius": 1, "pressure": 1}),
    "pressure_of_v2": ("v2", {"hertz": 2, "pressure_profiles": 2}),
}
#: Column of a history -> its axis, and what it is multiplied with.
COLUMNS = {
    "wear_volume_counter": ("worn volume of the counter-body, 10⁻³ mm³", 1e3),
    "wear_volume_disc": ("worn volume of the disc, 10⁻³ mm³", 1e3),
    "cof": ("coefficient of friction, –", 1.0),
    "area_contact": ("area in contact, mm²", 1.0),
}
#: Figure -> columns of the history, and the runs whose courses of them lie over each other.
COURSES: dict[str, tuple[Sequence[str], Sequence[str]]] = {
    "volumes_of_v2": (("wear_volume_counter", "wear_volume_disc"), ("v1", "v2")),
    "cof_of_v2": (("cof",), ("v1", "v2")),
    "cof_of_all": (("cof",), tuple(VERSIONS)),
    "areas_of_all": (("area_contact",), ("v1", "v3", "fine")),
    "stability": (("area_contact",), ("beyond", "steady")),
}
#: Figure -> the item whose rows are bars.
BARS = {"disc_volumes": "figure-4.33", "disc_depths": "figure-4.35", "patch_bars": "figure-4.36"}


def _of_a_run(run: str, name: str, runs: Runs, numbers: Numbers) -> Figure:
    """Draw a figure of a run."""
    figure: Figure = getattr(runs[run].plot, name)()
    return figure


def _together(run: str, names: dict[str, int], runs: Runs, numbers: Numbers) -> Figure:
    """Put panels of figures of a run beside and below each other."""
    figure, axes = _sheet(sum(names.values()))
    for name, count in names.items():
        getattr(runs[run].plot, name)(ax=axes[:count])
        axes = axes[count:]
    return figure


def _courses(
    columns: Sequence[str], names: Sequence[str], runs: Runs, numbers: Numbers, *, relative: bool = False
) -> Figure:
    """Lay courses of runs over each other, a panel a column. relative: to their end values."""
    figure, panels = _sheet(len(columns), height=1.2 * ROW)
    for axes, column in zip(panels, columns, strict=True):
        label, factor = COLUMNS[column]
        for name, (colour, dash) in zip(names, LINES, strict=False):
            history = runs[name].history
            values = factor * history[column] / (history[column][-1] if relative else 1.0)
            axes.plot(history["distance"], values, dash, color=colour, label=LABELS[name])
        axes.set(xlabel=DISTANCE, ylabel="over its value at the end, –" if relative else label)
        if column == "area_contact":
            axes.set(xscale="log", yscale="log")
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_major_formatter("{x:g}")
        else:
            axes.set(xlim=(0.0, None), ylim=(0.0, None))
    columns_of_legend = len(names) if max(len(LABELS[name]) for name in names) < 10 else 1
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=columns_of_legend)
    return figure


def _profiles(runs: Runs, numbers: Numbers) -> Figure:
    """Put the disc across sliding of every version beside each other."""
    figure, panels = _sheet(len(VERSIONS))
    for axes, (version, label) in zip(panels, VERSIONS.items(), strict=True):
        _, (along, _) = _sheet(2)  # the figure's other panel, which is not shown
        runs[version].plot.disc_profiles(ax=[along, axes])
        axes.set_title(label)
    for axes in panels:
        if axes.get_legend():
            axes.get_legend().remove()
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def _maps(label: str, colours: str, values: Callable[[Any], Any], runs: Runs, numbers: Numbers) -> Figure:
    """Put a field at the end of every version beside each other. values: of a snapshot, 0 for none."""
    figure, panels = _sheet(len(VERSIONS), height=0.9 * ROW)
    for axes, (version, name) in zip(panels, VERSIONS.items(), strict=True):
        result = runs[version]
        field, side = values(result.snapshots[-1]), 0.5e-3 * np.round(1e3 * np.ptp(result.x))
        shown = np.where(field > 0.0, field, np.nan)
        top = float(max(values(snapshot).max() for snapshot in result.snapshots))
        norm = LogNorm(1.0, top) if "pressure" in label else Normalize(0.0, top)
        extent = (-side, side, -side, side)
        image = axes.imshow(shown.T, origin="lower", extent=extent, cmap=colours, norm=norm)
        reach = 0.55 * float(max(result.history[f"patch_{way}"][-1] for way in ("along", "across")))
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), title=f"{name}, at the end")
        axes.set(xlabel="along sliding, x, mm", ylabel="across sliding, y, mm")
        figure.colorbar(image, ax=axes, label=label, format="{x:g}")
    return figure


def _bars(item: str, runs: Runs, numbers: Numbers) -> Figure:
    """Draw the rows of an item that have the unit of the first one as bars, ours and then what is printed."""
    rows = next(one.rows for one in ALL_ITEMS if one.id == item)
    first, values, printed = rows[0], dict[str, float](), dict[str, float]()
    for row in (row for row in rows if row.unit == first.unit):
        values |= {column: row.factor * numbers[name] for column, name in row.ours.items()}
        printed |= {f"{column}, printed": row.factor * p.value for column, p in row.printed.items()}
    figure, (axes,) = _sheet(1)
    colours = [OURS] * len(values) + [PRINTED] * len(printed)
    values |= printed
    bars = axes.barh([*values], [*values.values()], color=colours)
    axes.bar_label(bars, fmt="{:.4g}", padding=2)
    axes.set(xlabel=f"{first.quantity}, {first.unit}", xlim=(0.0, 1.2 * max(values.values())))
    axes.invert_yaxis()
    return figure


def _sheet(count: int, *, height: float = ROW) -> tuple[Figure, list[Any]]:
    """Open a figure of as many panels, two in a row; return it and its axes."""
    rows, columns = -(-count // 2), min(count, 2)
    figure = Figure(figsize=(COLUMN if count == 1 else PAGE, height * rows), layout="constrained")
    return figure, [*figure.subplots(rows, columns, squeeze=False).ravel()]


#: Figures by name.
FIGURES: dict[str, Draw] = {
    **{name: partial(_of_a_run, run, figure) for name, (run, figure) in OF_A_RUN.items()},
    **{name: partial(_together, run, figures) for name, (run, figures) in TOGETHER.items()},
    **{name: partial(_courses, *entry) for name, entry in COURSES.items()},
    **{name: partial(_bars, item) for name, item in BARS.items()},
    "relative_cof": partial(_courses, ("cof",), tuple(VERSIONS), relative=True),
    "disc_profiles": _profiles,
    "pressure_maps": partial(_maps, "pressure, MPa", "viridis_r", lambda snapshot: snapshot.pressure),
    "counter_patches": partial(_maps, "wear depth, µm", "magma_r", lambda end: 1e3 * end.wear_counter),
}


def drawn(name: str, runs: Runs, numbers: Numbers) -> Figure:
    """Draw a figure by its name, in the style of all."""
    with matplotlib.rc_context(STYLE):
        return FIGURES[name](runs, numbers)
