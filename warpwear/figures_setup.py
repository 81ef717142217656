"""The set-up: ball, rough disc, domain and sliding direction, in 3-D."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import proj3d  # type: ignore[import-untyped]

from warpwear import figure_style as fs
from warpwear.figure_axes import draw_surface, exaggeration, finish_3d, new_3d_figure
from warpwear.figure_data import FigureData, sag_or_nan

#: Length of the arrow over the domain's side.
ARROW = 0.4


def setup(data: FigureData) -> Figure:
    """The sphere over the unworn disc at first contact, true to scale in x and y.

    Only the sphere's far half is drawn, so that the disc below it is seen; the disc is shown as far as it is
    computed.
    """
    study = data.study
    disc, window = data.relief
    x0, x1, y0, y1 = window.extent
    x, y = np.linspace(x0, x1, 61), np.linspace(0.5 * (y0 + y1), y1, 31)
    curvature, approach = study.sphere.curvature, float(data.history["approach"][0])
    sphere = 1e3 * (sag_or_nan(x, y, curvature) - approach)

    figure, (axes,) = new_3d_figure(1)
    draw_surface(axes, disc, window, fs.DISC, low=np.nanmin(disc), high=np.nanmax(disc))
    grid = np.meshgrid(x, y, indexing="ij")
    # The far half only lies over the disc: its order of drawing is known, so it is not left to be guessed.
    axes.plot_surface(*grid, sphere, color=fs.SPHERE, alpha=0.3, linewidth=0.0, shade=False, zorder=5)
    axes.plot_wireframe(*grid, sphere, rstride=6, cstride=6, color=fs.SPHERE, lw=0.4, zorder=6)
    axes.plot(x, np.full(x.size, y[0]), sphere[:, 0], color=fs.SPHERE, lw=1.4, zorder=7)
    low, high = 1e3 * float(np.nanmin(disc)), float(np.nanmax(sphere))
    top = 1e3 * float(np.nanmax(disc))
    axes.set_zlim(low, max(high, top) + 0.05 * (high - low))
    shape = f"sphere, R = {1.0 / curvature:.3g} mm," if curvature else "rigid flat"
    title = (
        f"{shape} on the disc; domain {study.grid.extent:.4g} mm wide\n"
        f"{study.contact.load:.3g} N; heights drawn {exaggeration(axes, window):g} times as large"
    )
    finish_3d(axes, window, "height, µm", title)
    middle, half = 0.5 * (x0 + x1), 0.5 * ARROW * (x1 - x0)
    _arrow(axes, middle - half, middle + half, y0, top + 0.15 * (high - low))
    return figure


def _arrow(axes: Any, start: float, end: float, y: float, height: float) -> None:
    """Along +x over the disc's near edge, where the sphere's far half hides nothing; of the final view."""
    (x0, x1), (y0, y1), _ = proj3d.proj_transform([start, end], [y, y], [height, height], axes.get_proj())
    arrow = {"arrowstyle": "-|>", "color": "black", "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    with fs.style():
        axes.annotate("", (x1, y1), (x0, y0), arrowprops=arrow, zorder=20)
        paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
        axes.annotate("sliding", (x0, y0), ha="right", va="bottom", fontsize=7, bbox=paper, zorder=21)
