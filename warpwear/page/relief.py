"""The picture of worn bodies where no script turns them: heights in colour, under slanting light."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LightSource, Normalize

from warpwear.figures import style as fs
from warpwear.grid import FloatArray

#: Light from the upper left, this high over the plane [degrees]; how much steeper slopes look.
LIGHT = LightSource(azdeg=315.0, altdeg=45.0)
STEEPER = 4.0
DPI = 160


def relief(plot: Mapping[str, Any]) -> bytes:
    """Draw the bodies of `warpwear.page.parts.Bodies`, as a mapping, that stand still; returns a PNG file."""
    names = plot["still"]

    def draw(axes: Any) -> None:
        for panel, name in zip(np.atleast_1d(axes), names, strict=True):
            _draw(panel, _heights(plot["bodies"][name]), plot["extent"])
            panel.set_title(f"{name}, seen from above")

    return fs.bytes_of(fs.new_figure(draw, columns=len(names), fixed=True, square=True), dpi=DPI)


def _heights(coded: Mapping[str, Any]) -> FloatArray:
    codes = np.asarray(coded["codes"], dtype=np.float64)
    return np.asarray(np.where(codes > 0.0, coded["low"] + coded["step"] * codes, np.nan))


def _draw(panel: Axes, heights: FloatArray, extent: tuple[float, ...]) -> None:
    """Draw heights [µm], (x, y), over the extent: first x, last x, first y, last y [mm]."""
    scale = Normalize(float(np.nanmin(heights)), float(np.nanmax(heights)) or 1.0)
    side = 1e3 * (extent[1] - extent[0]) / heights.shape[0]
    filled = np.where(np.isfinite(heights), heights, np.nanmin(heights)).T
    colours = LIGHT.shade(
        filled, fs.HEIGHTS, norm=scale, blend_mode="soft", vert_exag=STEEPER, dx=side, dy=side
    )
    panel.imshow(colours, origin="lower", extent=(extent[0], extent[1], extent[2], extent[3]))
    panel.set(xlabel="along sliding, mm", ylabel="across, mm")
    bar = panel.inset_axes((1.03, 0.1, 0.03, 0.8))
    panel.figure.figure.colorbar(ScalarMappable(scale, fs.HEIGHTS), cax=bar, label="height, µm")
