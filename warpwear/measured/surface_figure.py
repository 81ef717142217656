"""Figures of measured surfaces, worn tracks and worn balls: panels of one column's width in a stack."""

from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from warpwear.figures.style import DEPTHS, DISC, HEIGHTS, NEUTRAL, SPHERE, new_figure, style
from warpwear.grid import FloatArray
from warpwear.measured.surface_report import SurfaceReport
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.roughness import material_ratio_curve
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.ball import WornBall
from warpwear.surfaces.worn.track import Track

Pair: TypeAlias = tuple[float, float]

#: Largest number of pixels along a side of a map: more than its width on paper holds.
PIXELS = 700
#: A field that is longer than this many widths is drawn out of proportion.
LONG = 4.0
#: Height of a panel [inch].
ROW = 2.4


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the path's ending names."""
    with style():
        figure.savefig(path)


def surface_figure(report: SurfaceReport) -> Figure:
    """Draw a measured surface: map, bearing area curve, power spectrum, rms slope against cut-off."""

    def draw(panels: Any) -> None:
        surface = report.surface
        _map_of_heights(panels[0], surface.levelled, surface.size, surface.filled)
        _bearing(panels[1], report)
        spectrum = report.spectrum
        if spectrum.density.size:
            panels[2].loglog(1e3 * spectrum.wavelength, 1e12 * spectrum.density, color=DISC)
            # a band-limited surface has nothing but rounding below its shortest wave
            top, bottom = (1e12 * float(v) for v in (spectrum.density.max(), spectrum.density.min()))
            panels[2].set_ylim(bottom=max(bottom / 2, 1e-12 * top), top=4 * top)
        else:
            panels[2].text(0.5, 0.5, "a flat: no waves", transform=panels[2].transAxes, ha="center")
        if (knee := report.roll_off.wavelength) is not None:
            panels[2].axvline(1e3 * knee, color=NEUTRAL, ls="--", lw=0.8, label="suggested roll-off")
            _legend(panels[2])
        panels[2].set(xlabel="wavelength, µm", ylabel="power spectral density, µm⁴")
        panels[3].semilogx(1e3 * report.cut_offs, report.slopes, color=DISC)
        panels[3].set(xlabel="shortest wavelength (S-filter), µm", ylabel="rms slope, 1")
        panels[3].set_ylim(bottom=0.0)

    return new_figure(draw, rows=4, height=ROW)


def track_figure(track: Track, *, filled: BoolArray | None = None) -> Figure:
    """Draw a worn track: map over the reference, mean profile across, section lost along the track.

    filled: points that were not measured, shape (nx, ny).
    """

    def draw(panels: Any) -> None:
        nx, ny = track.levelled.shape
        size = (track.length, float(track.y[-1] - track.y[0]) * ny / max(ny - 1, 1))
        _map_of_heights(panels[0], track.levelled, size, filled)
        for edge in track.window:
            panels[0].axhline(edge, color="white", lw=1.6)
            panels[0].axhline(edge, color="black", lw=0.8, ls="--")
        profile, y = 1e3 * track.levelled.mean(axis=0), track.y
        panels[1].plot(y, profile, color=DISC, label="mean profile")
        inside = track.inside
        below, above = inside & (profile < 0), inside & (profile > 0)
        panels[1].fill_between(y, profile, 0.0, where=below, color=SPHERE, alpha=0.35, lw=0, label="below")
        hatched: dict[str, Any] = {"facecolor": "none", "edgecolor": DISC, "hatch": "////"}
        panels[1].fill_between(y, profile, 0.0, where=above, lw=0, label="above", **hatched)
        panels[1].axhline(0.0, color=NEUTRAL, lw=0.6)
        panels[1].set(xlabel="across, y, mm", ylabel="height over the reference, µm")
        _legend(panels[1])
        x = (np.arange(nx) + 0.5) * track.length / nx - 0.5 * track.length
        panels[2].plot(x, 1e6 * track.net, color=DISC, lw=0.6, label="each section")
        panels[2].axhline(1e6 * float(track.net.mean()), color=NEUTRAL, ls="--", lw=1.0, label="mean")
        panels[2].set(xlabel="along sliding, x, mm", ylabel="section lost, µm²")
        top = 1e6 * float(track.net.max())
        panels[2].set_ylim(min(0.0, 1e6 * float(track.net.min())), 1.1 * top if top > 0 else None)
        _legend(panels[2])

    return new_figure(draw, rows=3, height=ROW)


def ball_figure(ball: WornBall, *, size: Pair, filled: BoolArray | None = None) -> Figure:
    """Draw the depth below the unworn sphere: a map, profiles through the patch.

    size: of the field [mm]; filled: points that were not measured, shape (nx, ny).
    """

    def draw(panels: Any) -> None:
        span = (0.0, 1e3 * ball.depth)
        _map(panels[0], 1e3 * ball.lost, size, label="depth worn, µm", colours=DEPTHS, span=span)
        _hatch(panels[0], filled, size)
        nx, ny = ball.lost.shape
        x, y = places((nx, ny), (size[0] / nx, size[1] / ny))
        rows, columns = np.nonzero(ball.patch)
        i, j = round(float(rows.mean())), round(float(columns.mean()))
        panels[1].plot(x, 1e3 * ball.lost[:, j], color=SPHERE, label="along sliding, x")
        panels[1].plot(y, 1e3 * ball.lost[i, :], color=DISC, ls="--", label="across, y")
        panels[1].axhline(0.0, color=NEUTRAL, lw=0.6)
        panels[1].invert_yaxis()
        panels[1].set(xlabel="place, mm", ylabel="depth worn, µm")
        _legend(panels[1])

    return new_figure(draw, rows=2, height=ROW)


def _legend(axes: Axes) -> None:
    """Put the legend above the panel, where it hides no line."""
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, borderaxespad=0.2)


def _map_of_heights(axes: Axes, heights: FloatArray, size: Pair, filled: BoolArray | None) -> None:
    """Draw heights [mm] over a field of a size [mm]; a few spikes and pits do not set the colours."""
    low, high = 1e3 * np.quantile(heights if filled is None else heights[~filled], [0.002, 0.998])
    _map(axes, 1e3 * heights, size, label="height, µm", colours=HEIGHTS, span=(low, high))
    _hatch(axes, filled, size)


def _hatch(axes: Axes, filled: BoolArray | None, size: Pair) -> None:
    """Hatch the points of a field of a size [mm] that were not measured, each pixel of the map with any."""
    if filled is None:
        return
    for axis, count in enumerate(filled.shape):
        filled = np.logical_or.reduceat(filled, np.arange(0, count, _step(count)), axis=axis)
    edged = np.pad(filled, 1, mode="edge").astype(np.float64)  # or what lies at the rim would be cut in half
    x, y = places(edged.shape, (size[0] / filled.shape[0], size[1] / filled.shape[1]))
    axes.contourf(x, y, edged.T, levels=[0.5, 1.5], colors=["0.8"], alpha=0.6, hatches=["//////"])
    axes.set(xlim=(-size[0] / 2, size[0] / 2), ylim=(-size[1] / 2, size[1] / 2))
    axes.set_title("hatched: not measured, filled in", loc="left", fontsize=7)


def _map(axes: Axes, values: FloatArray, size: Pair, *, label: str, colours: Any, span: Pair) -> None:
    """Draw values over a field of a size [mm], with colours that span a range of them."""
    low, high = span
    step = [_step(n) for n in values.shape]
    image = axes.imshow(
        values[:: step[0], :: step[1]].T,
        origin="lower",
        extent=(-size[0] / 2, size[0] / 2, -size[1] / 2, size[1] / 2),
        cmap=colours,
        vmin=low,
        vmax=high if high > low else low + 1.0,
        interpolation="auto",
        # a long track at its true proportions would be a line
        aspect="auto" if max(size) > LONG * min(size) else "equal",
    )
    axes.figure.colorbar(image, ax=axes, label=label, extend="both", location="top", shrink=0.6, aspect=30)
    axes.set(xlabel="along sliding, x, mm", ylabel="across, y, mm")
    axes.xaxis.set_major_locator(MaxNLocator(4 if size[0] > 0.7 * size[1] else 2))
    axes.yaxis.set_major_locator(MaxNLocator(4))


def _step(count: int) -> int:
    """Return how many of `count` points along an axis come to a pixel of a map."""
    return max(1, -(-count // PIXELS))


def _bearing(axes: Axes, report: SurfaceReport) -> None:
    b = report.bearing
    ratio, reached = material_ratio_curve(report.surface.measured)
    height, line = 1e3 * reached, [1e3 * b.top, 1e3 * b.bottom]
    axes.plot(ratio, height, color=DISC, label="surface")
    axes.plot([0, 100], line, color=NEUTRAL, ls="--", lw=0.9, label="equivalent line")
    for end, level, core_end in zip((0, 100), line, (b.smr1, b.smr2), strict=True):
        axes.plot([end, core_end], [level, level], color=NEUTRAL, lw=0.6, ls=":")
    axes.set_xlim(0, 100)
    # A few spikes and pits would squeeze the curve into a line: the ends are cut where they are far off.
    core = height[(ratio >= 0.5) & (ratio <= 99.5)]
    room = 0.35 * (core.max() - core.min()) or 1.0
    axes.set_ylim(max(height.min(), core.min() - room), min(height.max() + 0.1 * room, core.max() + room))
    axes.set(xlabel="material ratio, %", ylabel="height, µm")
    text = f"Spk {1e3 * b.spk:.3g} µm\nSk {1e3 * b.sk:.3g} µm\nSvk {1e3 * b.svk:.3g} µm"
    axes.text(0.98, 0.97, text, transform=axes.transAxes, ha="right", va="top", fontsize=7)
    _legend(axes)
