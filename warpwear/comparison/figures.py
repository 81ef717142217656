"""Figures of a comparison: the courses of runs and experiments, and worn profiles, laid over each other."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from warpwear.comparison.area_load import area_load, has_loads
from warpwear.comparison.gather import Comparison, means_of_parts
from warpwear.comparison.groups import Course, Group, RunData
from warpwear.figures import courses, describe
from warpwear.figures.blocks import with_blocks
from warpwear.figures.courses import over_each_other
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, Map, Scale
from warpwear.history.quantities import BY_NAME, Quantity
from warpwear.laws.archard import BODIES, CALLED
from warpwear.measured.experiment import Experiment, mean_of_last_tenth
from warpwear.results.ensemble import band_told, in_legend

#: Parts that a measured course of many more points is averaged in, its scatter a band.
POINTS = 120
#: Markers along a measured course, about.
MARKED = 30
#: Bodies of which one lost this many times as much as the other have scales of their own.
UNLIKE = 4.0
#: Largest number of points along a side of a map.
PIXELS = 500
RELATIVE = "over its mean in the last tenth of the distance"


def cof(comparison: Comparison) -> Figure:
    """Coefficient of friction over the distance slid, and over its mean in the last tenth of it.

    A swept run has the means of its passes, if it made more than one.
    """
    every, inputs = list(_courses(comparison, cof_of)), []
    measured: list[Line] = []
    relative: list[Line] = []
    for number, experiment in enumerate(comparison.experiments):
        look, end = describe.look_of_measured(number), experiment.final_cof
        measured.append(measured_line(experiment, look))
        if end > 0.0:
            relative.append(replace(measured_line(experiment, look, end), label=""))
    for group, course in every:
        mean = course.line().y
        friction = group.runs[0].study.friction
        if friction.fitted in ("end", "initial"):
            place = slice(-1, None) if friction.calibrate == "end" else slice(1)
            mark = replace(describe.RING, colour=course.look.colour)
            inputs.append(Line(course.places[place], mean[place], look=mark))
        level = mean_of_last_tenth(course.places, mean)
        if mean.size > 1 and level > 0.0:
            relative.append(replace(course, label="", values=course.values / level).line())
    number = sum(run.study.friction.ends_as_given for run in comparison.runs)
    note = "○: calibrated to this value" if inputs else ""
    if number:
        note = f"the end is an input of {number} of {len(comparison.runs)} runs"
    chart = over_each_other(BY_NAME["cof"], (course for _, course in every), more=measured, note=note)
    axes = Axis(describe.DISTANCE, low=0.0), Axis("relative coefficient, –", low=0.0)
    second = Chart("Relative coefficient of friction", *axes, relative, RELATIVE)
    return _figure(comparison, [replace(chart, lines=[*chart.lines, *inputs]), second])


def of_columns(quantities: Sequence[Quantity]) -> Callable[[Comparison], Figure]:
    """Declare the figure of columns of the history over the distance slid, those of bodies on one scale."""
    return lambda comparison: _figure(comparison, _on_one_scale([_course(comparison, q) for q in quantities]))


def profiles(comparison: Comparison) -> Figure:
    """Wear of both bodies across sliding at each run's end, mean of the scar's middle eighth.

    A track's is the mean cross-section of its groove.
    """
    worn = [np.abs(run.across[wear > 0.0]) for run in comparison.runs for wear in run.wear.values()]
    reach = 1.15 * max((float(places.max(initial=0.0)) for places in worn), default=0.0)
    charts = []
    for body in BODIES:
        lines = [course.line() for _, course in _courses(comparison, _profile_of(body))]
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
    **{CALLED_HERE.get(name, name): of_columns(quantities) for name, quantities in courses.OVERLAID.items()},
    **{"cof": cof, "area_load": area_load, "profiles": profiles, "scar": scar, "groove": groove},
}


def figures_of(comparison: Comparison) -> dict[str, Figure]:
    """Declare each figure that has something to show."""
    known = bool(comparison.experiments) or any(run.cof is not None for run in comparison.runs)
    has = {"cof": known, "profiles": any(run.wear for run in comparison.runs)}
    has["area_load"] = has_loads(comparison)
    has["scar"] = has["groove"] = comparison.scar is not None
    return {
        name: declare(comparison) for name, declare in FIGURES.items() if has.get(name, bool(comparison.runs))
    }


def cof_of(run: RunData) -> Course | None:
    """Draw the course of the coefficient of friction of a run, if it is known."""
    if run.cof is None:
        return None
    distance, values = run.course
    return (run.history["distance"], run.cof) if values.size < min(run.cof.size, 2) else (distance, values)


def _profile_of(body: str) -> Callable[[RunData], Course | None]:
    """Make what gives the worn profile of a body [µm] over the places across sliding [mm]."""
    return lambda run: (run.across, -1.0e3 * run.wear[body]) if run.wear else None


def _courses(
    comparison: Comparison, course_of: Callable[[RunData], Course | None]
) -> Iterable[tuple[Group, courses.Course]]:
    """Give the groups that have a course with its line, which is the same in every figure."""
    for index, group in enumerate(comparison.groups):
        if (course := group.courses(course_of)) is not None:
            look = describe.look_of_group(index)
            yield group, courses.Course(in_legend(group.name), look, *course, group.name)


def _course(comparison: Comparison, quantity: Quantity) -> Chart:
    every = _courses(comparison, lambda run: (run.history["distance"], run.history[quantity.name]))
    return over_each_other(quantity, (course for _, course in every))


def _figure(comparison: Comparison, charts: Sequence[Chart]) -> Figure:
    """Make a figure with one legend, and say above the first panel what bands are."""
    text = band_told([len(group.runs) for group in comparison.groups])
    note = "\n".join(filter(None, [charts[0].note, text]))
    several = len(comparison.groups) + len(comparison.experiments)
    figure = Figure([replace(charts[0], note=note), *charts[1:]], legend=several)
    studies = {run.study.programme: run.study for run in comparison.runs}
    return with_blocks(figure, *studies.values()) if len(studies) == 1 else figure


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


def measured_line(experiment: Experiment, look: Look, end: float = 1.0) -> Line:
    """Give measured points over `end`; of many more the means of parts, in a band of scatter."""
    distance, values = experiment.distance, experiment.cof
    label, every = in_legend(experiment.name), max(1, min(distance.size, POINTS) // MARKED)
    if distance.size <= 2 * POINTS:
        return Line(distance, values / end, label, look, every=max(1, distance.size // MARKED))
    distance, values, squares = means_of_parts(POINTS, distance, values, values**2)
    scatter = np.sqrt(np.clip(squares - values**2, 0.0, None))
    low, high = (values - scatter) / end, (values + scatter) / end
    return Line(distance, values / end, label, look, low, high, every=every)
