"""Figures of a ball that slides over a track: groove, track, each pass, friction along the stroke."""

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, Map, Scale, lines_in_time, shade
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.history import axis_of
from warpwear.figures.of_run.snapshots import of_parameters
from warpwear.figures.of_run.view import positive
from warpwear.figures.wording import chosen
from warpwear.history.quantities import BY_NAME
from warpwear.results import track as results

#: Passes in one figure.
SHOWN = 4
#: Bins along a track, and most blocks of its map.
BINS, BLOCKS = 200, 600
CHANGE = "change of height, µm"


@words.figure(*words.GROOVE, essential=True, section="groove")
def groove(data: FigureData) -> Figure:
    """Cross-section of the {groove} {when}, and its mean depth along the track {end}."""
    sections = [results.groove(data.result, index) for index in data.indices]
    last, short = sections[-1], data.groove == "scar"
    reach = float(np.abs(last.y[last.depth > 0.0]).max(initial=2.0 * data.study.grid.cell)) * 1.15
    states = [(section.y, -1e3 * section.depth, data.after(section.distance)) for section in sections]
    across = lines_in_time(describe.DISC, states)
    if last.displaced.any():
        across.append(Line(last.y, -1e3 * last.worn, "of which worn", Look(describe.NEUTRAL, width=0.8)))
    places, depths = results.depth_along(data.result, data.indices[-1], BINS)
    mean = Look(describe.NOMINAL, "dash", 0.8)
    along: list[Line | Level] = [
        Line(places, -1e3 * depths, look=Look(shade(describe.DISC, 1.0), width=0.9)),
        Level(-1e3 * last.mean_depth, f"mean depth {1e3 * last.mean_depth:.3g} µm", mean),
    ]
    deepest = -1.2e3 * max(float(np.nanmax(depths)), last.mean_depth)
    width = f"mean over the {data.groove}'s width of {last.width:.3g} mm"
    over, down = Axis(describe.ACROSS, low=-reach, high=reach), Axis(CHANGE, low=deepest or None, high=0.0)
    place = "through the middle of the stroke" if short else "mean along sliding"
    panels = [
        Chart("Middle section" if short else "Mean section", over, Axis(CHANGE), across, place),
        Chart("Depth along the track", Axis(describe.ALONG), down, along, width),
    ]
    return Figure(panels if data.study.cells.ny > 1 else panels[1:], legend=6)


@words.figure(*words.GROOVE, essential=True)
def track_map(data: FigureData) -> Figure:
    """Height of the whole track {end}, and what wear and plastic flow took off it."""
    track = results.blocks(data.result, data.indices[-1], BLOCKS)
    when = f"track {data.after(data.distances[-1])}"
    heights, loss = 1e3 * track.heights, positive(1e3 * track.loss)
    low, high, most = 0.0, 1.0, 1.0
    if np.isfinite(heights).any():
        low, high = (float(end) for end in np.nanpercentile(heights, (0.1, 99.9)))
    if np.isfinite(loss).any():
        most = float(np.nanpercentile(loss, 99.9))
    scale = Scale("height, µm", low, high, colours="heights", beyond="both")
    gone = Scale("depth, µm", 0.0, most, colours="depths", beyond="max")
    note = f"{when} (y drawn {{}} times as large as x)"
    lost = "what is gone of it, worn or pressed down"
    maps = [
        Map("Height of the track", [heights], track.extent, scale, square=False, stretch_note=note, x=""),
        Map("What is gone of it", [loss], track.extent, gone, [lost], square=False),
    ]
    return Figure(maps, columns=1, width=describe.PAGE, height=1.9, shared="x")


@words.figure(words.STILL, words.NO_COURSE, words.NO_COF)
def cof_stroke(data: FigureData) -> Figure:
    """Coefficient of friction over the position in the stroke, of some passes. {friction}"""
    course = data.course
    number = np.maximum(np.ceil(data.study.passes_at(course["distance"]) - 1e-9).astype(int), 1)
    number[course.get("cycles", np.ones(number.size)) > 1.0] = 0  # a jump is no pass
    passes = np.unique(number[number > 0])
    some = {count: number == count for count in passes[chosen(passes.size, SHOWN)]}
    states = [(course["position"][at], course["cof"][at], f"pass {count}") for count, at in some.items()]
    lines = lines_in_time(describe.NEUTRAL, states)
    axes = Axis("position along the track, mm"), axis_of(BY_NAME["cof"])
    return Figure([Chart("Friction along the stroke", *axes, lines)], legend=4)


@words.figure(*words.GROOVE, words.SMOOTH_DISC, section="roughness")
def track_roughness(data: FigureData) -> Figure:
    """Height parameters (ISO 25178-2) of the disc in the middle of the {groove} over the passes."""
    table = results.roughness_in_track(data.result)
    return of_parameters(data.groove, Axis("passes, –", "unworn"), table["passes"], table)
