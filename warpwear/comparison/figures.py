"""Figures of a comparison: the courses of runs and experiments, and worn profiles, laid over each other."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from warpwear.comparison.area_load import area_load, has_loads
from warpwear.comparison.table import Comparison
from warpwear.ensembles.figures import OVERLAID, chart_of, figure_of, lines_of
from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, Map, Scale
from warpwear.history.quantities import BY_NAME, Quantity
from warpwear.laws.archard import BODIES, CALLED
from warpwear.results.ensemble import in_legend

#: Bodies of which one lost this many times as much as the other have scales of their own.
UNLIKE = 4.0
#: Largest number of points along a side of a map.
PIXELS = 500
#: Part of the distance that is shown apart, where friction rises.
EARLY = 0.1
FIRST = "the first tenth of the distance"


def cof(comparison: Comparison) -> Figure:
    """Coefficient of friction over the distance slid, and over its first tenth.

    A swept run has the means of its passes, if it made more than one.
    """
    every, inputs = list(lines_of(comparison.groups, "cof")), []
    for group, line in every:
        friction = group.rows[0].study.friction
        if friction.fitted in ("end", "initial"):
            place = slice(-1, None) if friction.calibrate == "end" else slice(1)
            mark = replace(describe.RING, colour=line.look.colour)
            inputs.append(Line(line.x[place], line.y[place], look=mark))
    number = sum(run.study.friction.ends_as_given for run in comparison.rows)
    note = "○: calibrated to this value" if inputs else ""
    if number:
        note = f"the end is an input of {number} of {len(comparison.rows)} runs"
    chart = chart_of(comparison, BY_NAME["cof"], note=note)
    chart = replace(chart, lines=[*chart.lines, *inputs])
    end = EARLY * max(float(places.max(initial=0.0)) for places in describe.values_of(chart, "x"))
    early = replace(chart, title="Coefficient of friction at first", x=replace(chart.x, high=end), note=FIRST)
    return _figure(comparison, [chart, early])


def of_columns(quantities: Sequence[Quantity]) -> Callable[[Comparison], Figure]:
    """Declare the figure of columns of the history over the distance slid, those of bodies on one scale."""
    return lambda comparison: _figure(
        comparison, _on_one_scale([chart_of(comparison, quantity) for quantity in quantities])
    )


def profiles(comparison: Comparison) -> Figure:
    """Wear of both bodies across sliding at each run's end, mean of the scar's middle eighth.

    A track's is the mean cross-section of its groove.
    """
    names = [f"profile_{body}" for body in BODIES]
    every = [run.courses[name] for run in comparison.rows for name in names if name in run.courses]
    worn = [np.abs(across[change < 0.0]) for across, change in every]
    reach = 1.15 * max((float(places.max(initial=0.0)) for places in worn), default=0.0)
    charts = []
    for body, name in zip(BODIES, names, strict=True):
        lines = [line for _, line in lines_of(comparison.groups, name)]
        up = Axis("change of height by wear, µm", high=0.0)
        note = f"{CALLED[body]}, at the end"
        across = Axis(describe.ACROSS, low=-reach or None, high=reach or None)
        charts.append(Chart(f"Wear of the {CALLED[body]}", across, up, lines, note))
    return _figure(comparison, _on_one_scale(charts))


def scar(comparison: Comparison) -> Figure:
    """Depth lost as measured and as computed by the first run on one scale, and their difference."""
    scars = comparison.scar
    assert scars is not None  # or it is not drawn
    first, inside = scars.computed[0], scars.measured.patch
    gap = scars.measured.lost - first.lost
    high = 1e3 * max(float(np.quantile(scars.measured.lost, 0.999)), float(first.lost.max()))
    most = 1e3 * float(np.quantile(np.abs(gap), 0.999))
    depth = Scale("depth lost, µm", 0.0, high, colours="depths", beyond="both")
    difference = Scale("difference, µm", -most, most, colours="signed", beyond="both")
    fields = {
        "measured": (scars.measured.lost, depth),
        in_legend(first.name): (first.lost, depth),
        f"measured − {in_legend(first.name)}": (gap, difference),
    }
    step = [max(1, -(-n // PIXELS)) for n in gap.shape]
    maps = []
    for name, (values, scale) in fields.items():
        note = f"mean {1e3 * float(values[inside].mean()):.3g} µm in the scar"
        seen = 1e3 * values[:: step[0], :: step[1]]
        maps.append(Map(f"Depth lost: {name}", [seen], scars.extent, scale, [name], [note]))
    return Figure(maps, width=describe.PAGE)


def groove(comparison: Comparison) -> Figure:
    """Mean profiles of the scar, measured in its band and computed, and measured less computed."""
    scars = comparison.scar
    assert scars is not None  # or it is not drawn
    y, depth = scars.y, 1e3 * scars.profile.depth
    error = np.full(y.shape, 1e3 * scars.profile.band)
    grey, pale = Look(describe.GREYS[0], width=1.0), Look(describe.GREYS[1], "", alpha=0.4)
    gap = Line(y, 0.0 * y, look=pale, low=-error, high=error)
    band = replace(gap, y=depth, low=depth - error, high=depth + error)
    depths = [band, Line(y, depth, "measured ± standard error", grey)]
    gaps: list[Line | Level] = [gap, Level(0.0, look=Look(describe.GREYS[0], width=0.6))]
    for number, run in enumerate(scars.computed):
        look, profile = describe.look_of_group(number), 1e3 * run.profile
        depths.append(Line(y, profile, in_legend(run.name), look))
        gaps.append(Line(y, depth - profile, look=look))
    charts = [
        Chart("Mean profiles", Axis(describe.ACROSS), Axis("mean depth lost, µm", inverted=True), depths),
        Chart("Measured less computed", Axis(describe.ACROSS), Axis("measured − computed, µm"), gaps),
    ]
    return Figure(charts, legend=3)


#: Figures of a run that have another name here.
CALLED_HERE = {"areas": "area"}
#: Name of the file -> how it is declared.
FIGURES: dict[str, Callable[[Comparison], Figure]] = {
    **{CALLED_HERE.get(name, name): of_columns(quantities) for name, quantities in OVERLAID.items()},
    **{"cof": cof, "area_load": area_load, "profiles": profiles, "scar": scar, "groove": groove},
}


def figures_of(comparison: Comparison) -> dict[str, Figure]:
    """Declare each figure that has something to show."""
    has = {"cof": any("cof" in row.courses for group in comparison.all_groups for row in group.rows)}
    has["profiles"] = any("profile_disc" in run.courses for run in comparison.rows)
    has["area_load"] = has_loads(comparison)
    has["scar"] = has["groove"] = comparison.scar is not None
    return {
        name: declare(comparison) for name, declare in FIGURES.items() if has.get(name, bool(comparison.rows))
    }


def _figure(comparison: Comparison, charts: Sequence[Chart]) -> Figure:
    return figure_of(comparison, charts, (run.study for run in comparison.rows))


def _on_one_scale(charts: Sequence[Chart]) -> list[Chart]:
    """Give charts of two bodies one scale from zero, unless one would hardly be seen on the other's."""
    every = [np.concatenate([np.zeros(1), *describe.values_of(chart, "y")]) for chart in charts]
    ends = [float(np.nanmax(np.abs(values))) for values in every]
    if len(ends) < 2 or not max(ends) < UNLIKE * min(ends):
        return list(charts)
    end = 1.05 * max(ends)
    return [
        replace(chart, y=replace(chart.y, high=end) if chart.y.low == 0.0 else replace(chart.y, low=-end))
        for chart in charts
    ]
