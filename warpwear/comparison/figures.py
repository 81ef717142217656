"""Figures of a comparison: the courses of runs and experiments, and worn profiles, laid over each other."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear.comparison.area_load import area_load, has_loads
from warpwear.comparison.gather import BODIES, Comparison
from warpwear.comparison.groups import Course, Group, RunData
from warpwear.figures import style as fs
from warpwear.figures.axes import ACROSS
from warpwear.grid import FloatArray
from warpwear.measured.experiment import Experiment, mean_of_last_tenth
from warpwear.results.ensemble import band, band_told, in_legend

COLOURS = (fs.SPHERE, fs.DISC, fs.CONTACT, fs.MEAN_PRESSURE, fs.SUM, fs.TOUCHED)
LINES = ("-", "--", "-.", ":", (0, (6, 1)), (0, (3, 1, 1, 1)))
#: Measured courses are grey: they are what the runs are held against.
GREYS = ("#000000", "#888888", "#555555")
MARKERS = ("o", "s", "^")
#: Parts that a measured course of many more points is averaged in, its scatter a band.
POINTS = 120
#: Markers along a measured course, about.
MARKED = 30
#: Bodies of which one lost this many times as much as the other have scales of their own.
UNLIKE = 4.0
#: Largest number of points along a side of a map.
PIXELS = 700
#: Height of a row of the legend [inch].
LEGEND_ROW = 0.15


def cof(axes: Any, comparison: Comparison) -> None:
    """Draw the coefficient of friction over the distance slid, and over its mean in the last tenth of it.

    A swept run has the means of its passes, if it made more than one.
    """
    for experiment, line in looks_of_measured(comparison):
        for panel, end in zip(axes, (1.0, experiment.final_cof), strict=True):
            if end > 0.0:
                _measured(panel, experiment, end, line)
    for group, line in looks_of(comparison):
        found = _drawn(axes[0], group, cof_of, line)
        if found is None:
            continue
        distance, values = found
        friction = group.runs[0].study.friction
        if friction.shear_strength is None:
            place = -1 if friction.calibrate == "end" else 0
            axes[0].plot(distance[place], values[place], "o", ms=4, mfc="white", mec=line["color"], zorder=3)
            axes[0].set_title("○: calibrated to this value")
        end = mean_of_last_tenth(distance, values)
        if values.size > 1 and end > 0.0:
            _drawn(axes[1], group, cof_of, line, scale=1.0 / end)
    given = sum(run.study.friction.fitted == "end" for run in comparison.runs)
    if given:
        axes[0].set_title(f"the end is an input of {given} of {len(comparison.runs)} runs")
    axes[0].set_ylabel("coefficient of friction, –")
    axes[1].set_ylabel("relative coefficient, –")
    axes[1].set_title("over its mean in the last tenth of the distance")
    for panel in axes:
        panel.set(xlabel="sliding distance, mm", xlim=(0.0, None), ylim=(0.0, None))


def cof_of(run: RunData) -> Course | None:
    """The course of the coefficient of friction of a run, if it is known."""
    if run.cof is None:
        return None
    distance, values = run.course
    return (run.history["distance"], run.cof) if values.size < min(run.cof.size, 2) else (distance, values)


def column_of(name: str, scale: float = 1.0) -> Callable[[RunData], Course]:
    """Make what gives a column of a run's history over the distance slid."""
    return lambda run: (run.history["distance"], scale * run.history[name])


def area(axes: Axes, comparison: Comparison) -> None:
    """Draw the area in contact over the distance slid, both logarithmic."""
    for group, line in looks_of(comparison):
        _drawn(axes, group, column_of("area_contact"), line, positive=True)
    if _longest(comparison)[-1] > 0.0:  # not static contacts alone
        axes.set_xscale("log")
        fs.plain_numbers(axes.xaxis)
    fs.logarithmic(axes)
    axes.set_ylabel("area in contact, mm²")


def pressure(axes: Axes, comparison: Comparison) -> None:
    """Draw the mean pressure of the cells in contact over the distance slid."""
    for group, line in looks_of(comparison):
        _drawn(axes, group, column_of("pressure_mean"), line)
    fs.scale_distance(axes, _longest(comparison))
    fs.scale_values(axes, *(run.history["pressure_mean"] for run in comparison.runs))
    axes.set_ylabel("mean pressure in contact, MPa")


def volumes(axes: Any, comparison: Comparison) -> None:
    """Draw the worn volume of sphere and disc over the distance slid."""
    for group, line in looks_of(comparison):
        for panel, body in zip(axes, BODIES, strict=True):
            _drawn(panel, group, column_of(f"wear_volume_{body}", 1.0e3), line)
    for panel, body in zip(axes, BODIES, strict=True):
        panel.set_title(body)
        panel.set(ylabel="worn volume, 10⁻³ mm³", xlim=(0.0, None), ylim=(0.0, None))
    _on_one_scale(axes)


def profiles(axes: Any, comparison: Comparison) -> None:
    """Draw the wear of sphere and disc across sliding at each run's end, mean of the scar's middle eighth.

    A track's is the mean cross-section of its groove.
    """
    worn = [run for run in comparison.runs if run.wear]
    reach = 0.0
    for panel, body in zip(axes, BODIES, strict=True):
        for group, line in looks_of(comparison):
            profile = partial(profile_of, body)
            _drawn(panel, group, profile, line | {"marker": ""}, xlabel=ACROSS)
        ends = (float(np.abs(run.across[run.wear[body] > 0.0]).max(initial=0.0)) for run in worn)
        reach = max(reach, *ends)
    for panel, body in zip(axes, BODIES, strict=True):
        panel.set_title(f"{body}, at the end")
        panel.set(ylabel="change of height by wear, µm", ylim=(None, 0.0))
        if reach > 0.0:
            panel.set_xlim(-1.15 * reach, 1.15 * reach)
    _on_one_scale(axes)


def _on_one_scale(axes: Any) -> None:
    """Give panels of two bodies one scale from zero, unless one would hardly be seen on the other's."""
    ends = [max(map(abs, panel.get_ylim())) for panel in axes]
    if max(ends) < UNLIKE * min(ends):
        for panel in axes:
            top = panel.get_ylim()[1] > 0.0
            panel.set_ylim((0.0, max(ends)) if top else (-max(ends), 0.0))


def profile_of(body: str, run: RunData) -> Course | None:
    """The worn profile of a body [µm] over the places across sliding [mm]."""
    return (run.across, -1.0e3 * run.wear[body]) if run.wear else None


def _laid_over(
    draw: Callable[[Any, Comparison], None],
    comparison: Comparison,
    *,
    panels: int = 1,
    measured: bool = False,
) -> Figure:
    """Make a figure with the legend over it, which makes the figure higher, not its panels lower.

    draw: gets the axes, one or an array of them. measured: the legend names the experiments, too.
    """
    lines: list[Experiment | Group] = [*(comparison.experiments if measured else ()), *comparison.groups]
    width = fs.PAGE if panels > 1 else fs.COLUMN
    # The width holds this many names beside each other, a character some 0.055 inch and a line 0.45.
    longest = max(len(in_legend(line.name)) for line in lines)
    beside = max(1, min(len(lines), int(width / (0.055 * longest + 0.45))))

    told = band_told([len(group.runs) for group in comparison.groups])

    def draw_all(axes: Any) -> None:
        draw(axes, comparison)
        if told:
            first = np.atleast_1d(axes)[0]
            first.set_title("\n".join(filter(None, [first.get_title(), told])))
        fs.legend_above(*np.atleast_1d(axes), columns=beside)

    rows = -(-len(lines) // beside)
    return fs.new_figure(draw_all, columns=panels, height=fs.ROW + LEGEND_ROW * (rows - 1))


def scar(axes: Any, comparison: Comparison) -> None:
    """Draw depth lost as measured and as computed by the first run on one scale, and their difference."""
    found = comparison.scar
    assert found is not None  # or it is not drawn
    first = found.computed[0]
    gap = found.measured.lost - first.lost
    high = 1e3 * max(float(np.quantile(found.measured.lost, 0.999)), float(first.lost.max()))
    most = 1e3 * float(np.quantile(np.abs(gap), 0.999))
    titles = ("measured", first.name, f"measured − {first.name}")
    scales: Any = [{"cmap": fs.DEPTHS, "vmin": 0.0, "vmax": high}] * 2
    scales.append({"cmap": "RdBu_r", "vmin": -most, "vmax": most})
    for panel, field, title, scale in zip(
        axes, (found.measured.lost, first.lost, gap), titles, scales, strict=True
    ):
        step = [max(1, -(-n // PIXELS)) for n in field.shape]
        image = panel.imshow(
            1e3 * field[:: step[0], :: step[1]].T, origin="lower", extent=found.extent, **scale
        )
        label = "difference, µm" if field is gap else "depth lost, µm"
        panel.figure.colorbar(image, ax=panel, location="top", label=label, shrink=0.8, extend="both")
        panel.set(xlabel=f"{title}\nalong sliding, x, mm", ylabel=ACROSS)


def groove(axes: Any, comparison: Comparison) -> None:
    """Draw the mean profiles of the scar, measured in its band and computed, and measured less computed."""
    found = comparison.scar
    assert found is not None  # or it is not drawn
    depth, band = 1e3 * found.profile.depth, 1e3 * found.profile.band
    axes[0].fill_between(found.y, depth - band, depth + band, color=GREYS[1], alpha=0.4, lw=0)
    axes[0].plot(found.y, depth, color=GREYS[0], lw=1.0, label="measured ± standard error")
    axes[1].fill_between(found.y, -band, band, color=GREYS[1], alpha=0.4, lw=0)
    axes[1].axhline(0.0, color=GREYS[0], lw=0.6)
    for number, run in enumerate(found.computed):
        look: Any = {"color": COLOURS[number % len(COLOURS)], "ls": LINES[number % len(LINES)]}
        axes[0].plot(found.y, 1e3 * run.profile, label=in_legend(run.name), **look)
        axes[1].plot(found.y, depth - 1e3 * run.profile, **look)
    axes[0].invert_yaxis()
    axes[0].set(xlabel=ACROSS, ylabel="mean depth lost, µm")
    axes[1].set(xlabel=ACROSS, ylabel="measured − computed, µm")
    fs.legend_above(*axes, columns=3)


def _of_scar(draw: Callable[[Any, Comparison], None], comparison: Comparison, *, panels: int) -> Figure:
    return fs.new_figure(lambda axes: draw(axes, comparison), columns=panels, height=fs.ROW)


#: Name of the file -> how it is drawn.
FIGURES: dict[str, Callable[[Comparison], Figure]] = {
    "cof": partial(_laid_over, cof, panels=2, measured=True),
    "area": partial(_laid_over, area),
    "area_load": area_load,
    "pressure": partial(_laid_over, pressure),
    "volumes": partial(_laid_over, volumes, panels=2),
    "profiles": partial(_laid_over, profiles, panels=2),
    "scar": partial(_of_scar, scar, panels=3),
    "groove": partial(_of_scar, groove, panels=2),
}


def drawn(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Draw each figure that has something to show, with its name."""
    known = bool(comparison.experiments) or any(run.cof is not None for run in comparison.runs)
    shown = {"cof": known, "profiles": any(run.wear for run in comparison.runs)}
    shown["area_load"] = has_loads(comparison)
    shown["scar"] = shown["groove"] = comparison.scar is not None
    for name, draw in FIGURES.items():
        if shown.get(name, bool(comparison.runs)):
            yield name, draw(comparison)


def looks_of(comparison: Comparison) -> Iterator[tuple[Group, dict[str, Any]]]:
    """Give each group with its line, which is the same in every figure."""
    for index, group in enumerate(comparison.groups):
        # Colours repeat after six groups, together with their lines only after thirty-six.
        style = LINES[(index + index // len(COLOURS)) % len(LINES)]
        line = {"color": COLOURS[index % len(COLOURS)], "ls": style, "label": in_legend(group.name)}
        alone = all(run.history["distance"].size == 1 for run in group.runs)
        yield group, line | ({"marker": "o", "ms": 4} if alone else {})


def _drawn(
    panel: Axes,
    group: Group,
    of: Callable[[RunData], Course | None],
    line: dict[str, Any],
    *,
    scale: float = 1.0,
    positive: bool = False,
    xlabel: str = "sliding distance, mm",
) -> Course | None:
    """Draw the course of a run, or the mean of a group's in a band; return it, None where there is none.

    scale: what values are multiplied by. positive: leave gaps where they are not.
    """
    found = group.courses(of)
    if found is None:
        return None
    places, values = found[0], scale * found[1]
    mean, low, high = band(np.where(values > 0.0, values, np.nan) if positive else values)
    fs.over_distance(panel, places, mean, xlabel=xlabel, **line)
    if len(values) > 1:
        panel.fill_between(places, low, high, color=line["color"], alpha=0.2, lw=0)
    return places, mean


def looks_of_measured(comparison: Comparison) -> Iterator[tuple[Experiment, dict[str, Any]]]:
    """Give each experiment with its line, which is the same in every figure."""
    for index, experiment in enumerate(comparison.experiments):
        colour, marker = GREYS[index % len(GREYS)], MARKERS[index % len(MARKERS)]
        line = {"color": colour, "marker": marker, "ms": 2.2, "lw": 0.6, "label": in_legend(experiment.name)}
        yield experiment, line


def measured_course(experiment: Experiment) -> tuple[FloatArray, FloatArray, FloatArray | None]:
    """Return distances, coefficients and no scatter; of very many, means of parts of the way with theirs."""
    distance, values = experiment.distance, experiment.cof
    if distance.size <= 2 * POINTS:
        return distance, values, None
    edges = np.linspace(0.0, distance[-1], POINTS + 1)
    part = np.clip(np.searchsorted(edges, distance, side="right") - 1, 0, POINTS - 1)
    number = np.bincount(part, minlength=POINTS)
    filled = number > 0
    sums = [np.bincount(part, weights=v, minlength=POINTS)[filled] for v in (distance, values, values**2)]
    distance, values, squares = (s / number[filled] for s in sums)
    return distance, values, np.sqrt(np.clip(squares - values**2, 0.0, None))


def _measured(panel: Axes, experiment: Experiment, end: float, line: dict[str, Any]) -> None:
    """Draw measured points over `end`; very many as means of parts of the way in a band of their scatter."""
    distance, values, scatter = measured_course(experiment)
    if scatter is not None:
        low, high = (values - scatter) / end, (values + scatter) / end
        panel.fill_between(distance, low, high, color=line["color"], alpha=0.15, lw=0)
    panel.plot(distance, values / end, markevery=max(1, distance.size // MARKED), **line)


def _longest(comparison: Comparison) -> FloatArray:
    return max((run.history["distance"] for run in comparison.runs), key=lambda d: d[-1])
