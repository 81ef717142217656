"""How figures of the report of the thesis are declared, and what they have in common."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear.figures import style as fs
from warpwear.figures.axes import map_figure
from warpwear.grid import FloatArray
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.printed import read
from warpwear.thesis.runs import VERSIONS, Runs
from warpwear.thesis.verdicts import folded

#: Colour and line of each version in every figure.
LINES: dict[str, dict[str, Any]] = {
    "v1": {"color": "#0072B2", "ls": "-", "lw": 3.0, "alpha": 0.5},  # wide: others lie on it
    "v2": {"color": "#56B4E9", "ls": "--"},
    "v3": {"color": "#D55E00", "ls": "-."},
    "fine": {"color": "#009E73", "ls": "-"},
}
#: Colour of what the thesis prints.
PRINTED = "#999999"
#: Colour of its experiment.
EXPERIMENT = "#000000"

#: Draws a figure.
Drawing = Callable[[Runs, Numbers], Figure]
#: Draws into axes, one or an array of shape (rows × columns,).
Panels = Callable[[Any, Runs, Numbers], None]
#: A label of all panels of a figure, or one for each.
Labels = str | tuple[str, ...]
#: Figure -> what stands below it.
CAPTIONS = {name: folded(text) for name, text in read("captions.toml").items()}


class Gallery(dict[str, Drawing]):
    """Figures by name, each declared with `figure` above the function that draws it."""

    def figure(
        self, *, maps: int = 0, legend: int = 0, xlabel: Labels = "", ylabel: Labels = "", **size: Any
    ) -> Callable[[Panels], Panels]:
        """Add a figure under the name of the decorated function, which draws into its axes.

        maps: number of maps side by side; without them size is what `figures.style.new_figure` takes.
        legend: columns of the legend of all panels, 0 for none. xlabel, ylabel: one for all panels or one for
        each; what the function draws may set others.
        """

        def add(panels: Panels) -> Panels:
            def draw(runs: Runs, numbers: Numbers) -> Figure:
                def draw_panels(axes: Any) -> None:
                    for panel, *labels in np.broadcast(axes, xlabel, ylabel):
                        panel.set(xlabel=labels[0], ylabel=labels[1])
                    panels(axes, runs, numbers)
                    if legend:
                        fs.legend_above(*np.ravel(axes)[0].figure.axes, columns=legend)

                return map_figure(draw_panels, maps) if maps else fs.new_figure(draw_panels, **size)

            self[panels.__name__] = draw
            return panels

        return add


def over_distance(axes: Axes, history: Mapping[str, FloatArray], column: str, **line: Any) -> None:
    """Draw a column of a history over the distance slid."""
    fs.over_distance(axes, history["distance"], history[column], **line)


def versions(axes: Axes, runs: Runs, column: str, *names: str, relative: bool = False) -> None:
    """Draw a column of the history of versions over the distance slid, each in its own colour and line.

    relative: to its end value.
    """
    for name in names:
        history = runs[name].history
        values = history[column] / history[column][-1] if relative else history[column]
        fs.over_distance(axes, history["distance"], values, label=VERSIONS[name], **LINES[name])


#: Figures of single runs, which their results draw themselves.
OF_RUNS: dict[str, Drawing] = {
    "disc_3d_of_v1": lambda runs, _: runs["v1"].plot.disc_3d(),
    "sphere_3d_of_v1": lambda runs, _: runs["v1"].plot.sphere_3d(),
    "volumes_of_v1": lambda runs, _: runs["v1"].plot.volumes(),
    "disc_3d_of_v3": lambda runs, _: runs["v3"].plot.disc_3d(),
    "sphere_3d_of_v3": lambda runs, _: runs["v3"].plot.sphere_3d(),
    "disc_maps_of_v3": lambda runs, _: runs["v3"].plot.disc_map(),
}
