"""How figures of the report of the thesis are declared, and what they have in common."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look
from warpwear.grid import FloatArray
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.printed import read
from warpwear.thesis.runs import VERSIONS, Runs
from warpwear.thesis.verdicts import folded

#: Line of each version in every figure.
LOOKS: dict[str, Look] = {
    "v1": Look(describe.COUNTER, width=3.0, alpha=0.5),  # wide: others lie on it
    "v2": Look(describe.TOUCHED, "dash"),
    "v3": Look(describe.DISC, "dashdot"),
    "fine": Look(describe.CONTACT),
}
#: Colours of what the thesis prints, and of its experiment.
PRINTED, EXPERIMENT = describe.UNWORN, describe.HARDNESS

#: Declares a figure.
Declare = Callable[[Runs, Numbers], Figure]
#: Figure -> what stands below it.
CAPTIONS = {name: folded(text) for name, text in read("captions.toml").items()}
#: Figures by name; single runs have declared theirs.
FIGURES: dict[str, Declare] = {
    "disc_3d_of_v1": lambda runs, _: runs["v1"].plot.declared("disc_3d"),
    "counter_3d_of_v1": lambda runs, _: runs["v1"].plot.declared("counter_3d"),
    "pressure_of_v1": lambda runs, _: runs["v1"].plot.declared("hertz"),
    "contact_areas": lambda runs, _: runs["v1"].plot.declared("contact_map"),
    "volumes_of_v1": lambda runs, _: runs["v1"].plot.declared("volumes"),
    "disc_3d_of_v3": lambda runs, _: runs["v3"].plot.declared("disc_3d"),
    "counter_3d_of_v3": lambda runs, _: runs["v3"].plot.declared("counter_3d"),
    "disc_maps_of_v3": lambda runs, _: runs["v3"].plot.declared("disc_map"),
}


def figure(declare: Declare) -> Declare:
    """Enter a function among the figures under its name."""
    FIGURES[declare.__name__] = declare
    return declare


def chart(
    lines: Sequence[Line | Level], y: str | Axis, x: str | Axis = describe.DISTANCE, note: str = ""
) -> Chart:
    """Make a chart of lines over the distance slid, or over what x says, from zero up where y is a label."""
    up = Axis(y, low=0.0) if isinstance(y, str) else y
    return Chart("", Axis(x) if isinstance(x, str) else x, up, lines, note)


def course(history: Mapping[str, FloatArray], column: str, label: str, look: Look) -> Line:
    """Make the line of a column of a history over the distance slid."""
    return Line(history["distance"], history[column], label, look)


def versions(runs: Runs, column: str, *names: str, relative: bool = False) -> list[Line]:
    """Make the lines of a column of versions over the distance slid. relative: to its end value."""
    lines = [course(runs[name].history, column, VERSIONS[name], LOOKS[name]) for name in names]
    return [replace(line, y=line.y / line.y[-1]) if relative else line for line in lines]


def root_through_end(distance: FloatArray, values: FloatArray, label: str, colour: str) -> Line:
    """Make the line of a square root of the distance through the last of these values."""
    return Line(distance, values[-1] * np.sqrt(distance / distance[-1]), label, Look(colour, "dot"))
