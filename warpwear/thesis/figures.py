"""Figures of the report of the thesis: those of its runs, their courses over each other, bars of its rows."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from warpwear.figures import describe
from warpwear.figures.courses import Course, over_each_other
from warpwear.figures.describe import Axis, Bars, Figure, Panel
from warpwear.history.quantities import BY_NAME
from warpwear.laws.archard import BODIES
from warpwear.thesis.items import ALL_ITEMS, folded
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.printed import read
from warpwear.thesis.runs import LABELS, VERSIONS, Runs

#: Declares a figure.
Declare = Callable[[Runs, Numbers], Figure]
#: Figure -> what stands below it.
CAPTIONS = {name: folded(text) for name, text in read("captions.toml").items()}
#: Figure -> a run, and the figures of it whose panels are shown.
OF_A_RUN = {
    "pressure_of_v1": ("v1", "hertz"),
    "radius_and_pressure": ("v1", "contact_radius", "pressure"),
    "disc_of_v1": ("v1", "disc_profiles"),
    "disc_3d_of_v1": ("v1", "disc_3d"),
    "counter_3d_of_v1": ("v1", "counter_3d"),
    "volumes_of_v1": ("v1", "volumes"),
    "cof_of_v1": ("v1", "cof"),
    "contact_areas": ("v1", "contact_map"),
    "distance_factor": ("v2", "distance_factor"),
    "pressure_of_v2": ("v2", "hertz", "pressure_profiles"),
    "counter_of_v2": ("v2", "counter_profiles"),
    "disc_3d_of_v3": ("v3", "disc_3d"),
    "counter_3d_of_v3": ("v3", "counter_3d"),
    "disc_maps_of_v3": ("v3", "disc_map"),
    "straight_line": ("v3", "areas"),
}
#: Figure -> columns of the history, and the runs whose courses of them lie over each other.
COURSES: dict[str, tuple[Sequence[str], Sequence[str]]] = {
    "volumes_of_v2": ([f"wear_volume_{body}" for body in BODIES], ("v1", "v2")),
    "cof_of_v2": (("cof",), ("v1", "v2")),
    "cof_of_all": (("cof",), tuple(VERSIONS)),
    "areas_of_all": (("area_contact",), ("v1", "v3", "fine")),
    "stability": (("area_contact",), ("beyond", "steady")),
}
#: Figure -> the figure of every version of which one panel is shown, and which panel.
OF_VERSIONS = {
    "pressure_maps": ("pressure_map", 0),
    "counter_patches": ("wear_map", 0),
    "disc_profiles": ("disc_profiles", -1),
}
#: Figure -> the item whose rows are bars.
BARS = {"disc_volumes": "figure-4.33", "disc_depths": "figure-4.35", "patch_bars": "figure-4.36"}


def _of_a_run(run: str, names: Sequence[str], runs: Runs, numbers: Numbers) -> Figure:
    """Put panels of figures of a run below each other."""
    figures = [runs[run].plot.declared(name) for name in names]
    panels = [panel for figure in figures for panel in figure.panels]
    return figures[0] if len(figures) == 1 else Figure(panels, columns=2, legend=3)


def _courses(
    columns: Sequence[str], names: Sequence[str], runs: Runs, numbers: Numbers, *, relative: bool = False
) -> Figure:
    """Lay courses of runs over each other, a panel a column. relative: to their end values."""
    panels = []
    for column in columns:
        courses = []
        for number, name in enumerate(names):
            history, look = runs[name].history, describe.look_of_group(number)
            values = history[column] / (history[column][-1] if relative else 1.0)
            courses.append(Course(LABELS[name], look, history["distance"], values[np.newaxis]))
        chart = over_each_other(BY_NAME[column], courses)
        up = Axis("over its value at the end, –", low=0.0) if relative else chart.y
        panels.append(replace(chart, y=up))
    return Figure(panels, legend=len(names), height=1.2 * describe.ROW)


def _of_versions(name: str, panel: int, runs: Runs, numbers: Numbers) -> Figure:
    """Put a panel of a figure of every version beside each other, of maps as they are at the end."""
    panels: list[Panel] = []
    for version, label in VERSIONS.items():
        one = runs[version].plot.declared(name).panels[panel]
        if isinstance(one, describe.Map):
            one = replace(one, fields=one.fields[-1:], labels=[f"{label}, at the end"], notes=one.notes[-1:])
        else:
            one = replace(one, note=label, stretch_note="")
        panels.append(one)
    return Figure(panels, columns=2, legend=3)


def _bars(item: str, runs: Runs, numbers: Numbers) -> Figure:
    """Draw the rows of an item that have the unit of the first one as bars, ours and then what is printed."""
    rows = next(one.rows for one in ALL_ITEMS if one.id == item)
    first, values, printed = rows[0], dict[str, float](), dict[str, float]()
    for row in (row for row in rows if row.unit == first.unit):
        values |= {column: row.factor * numbers[name] for column, name in row.ours.items()}
        printed |= {f"{column}, printed": row.factor * p.value for column, p in row.printed.items()}
    colours = [describe.COUNTER] * len(values) + [describe.UNWORN] * len(printed)
    axis, values = Axis(f"{first.quantity}, {first.unit}"), values | printed
    bars = Bars("", [*values], np.array([*values.values()]), axis, colours=colours, written="{:.4g}")
    return Figure([bars])


#: Figures by name.
FIGURES: dict[str, Declare] = {
    **{name: partial(_of_a_run, run, figures) for name, (run, *figures) in OF_A_RUN.items()},
    **{name: partial(_courses, *entry) for name, entry in COURSES.items()},
    **{name: partial(_of_versions, *entry) for name, entry in OF_VERSIONS.items()},
    **{name: partial(_bars, item) for name, item in BARS.items()},
    "relative_cof": partial(_courses, ("cof",), tuple(VERSIONS), relative=True),
}
