"""Figures of measured surfaces, worn tracks and worn balls: panels of one column's width in a stack."""

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from warpwear.figures.style import (
    DEPTHS,
    DISC,
    HEIGHTS,
    NEUTRAL,
    PAGE,
    SPHERE,
    Sheet,
    new_figure,
    plain_numbers,
    style,
)
from warpwear.grid import FloatArray
from warpwear.measured.surface_report import SurfaceReport
from warpwear.results.report import record
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.roughness import material_ratio_curve
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.ball import WornBall
from warpwear.surfaces.worn.find_scar import mean_profile
from warpwear.surfaces.worn.patch import Patch
from warpwear.surfaces.worn.track import Track

Pair: TypeAlias = tuple[float, float]

#: Largest number of pixels along a side of a map: more than its width on paper holds.
PIXELS = 700
#: A field that is longer than this many widths is drawn out of proportion.
LONG = 4.0
#: Height of a panel of a stack, and of the sheet of a surface [inch].
ROW, SHEET = 2.4, 5.4
#: Characters of a line of numbers, its place behind its label and its height [points].
TOLD, INDENT, LINE = 56, 44.0, 10.0
#: Filters of a profile's roughness: name, key of the record, unit.
FILTERS = (("λs", "lambda_s_um", "µm"), ("λc", "lambda_c_mm", "mm"))


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the path's ending names."""
    with style():
        figure.savefig(path)


def surface_figure(report: SurfaceReport) -> Figure:
    """Draw the sheet of a measured surface: map, numbers, bearing curve, spectrum, slope over cut-off."""
    with style():
        figure = Sheet(figsize=(PAGE, SHEET), layout="constrained")
        FigureCanvasAgg(figure)
        halves: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1.0))
        upper, lower = halves
        left, right = upper.subplots(1, 2)
        right.set_axis_off()
        surface = report.surface
        _map_of_heights(left, surface.levelled, surface.size, surface.filled)
        _write_numbers(upper, report)
        bearing, density, slope = lower.subplots(1, 3)
        _bearing(bearing, report)
        _spectrum(density, report)
        slope.semilogx(1e3 * report.cut_offs, report.slopes, color=DISC)
        slope.set(xlabel="S-filter, µm", ylabel="rms gradient Sdq, –")
        slope.set_ylim(bottom=0.0)
        plain_numbers(slope.xaxis)
    return figure


def _spectrum(axes: Axes, report: SurfaceReport) -> None:
    spectrum = report.spectrum
    if spectrum.density.size:
        axes.loglog(1e3 * spectrum.wavelength, 1e12 * spectrum.density, color=DISC)
        # a band-limited surface has nothing but rounding below its shortest wave
        top, bottom = (1e12 * float(v) for v in (spectrum.density.max(), spectrum.density.min()))
        axes.set_ylim(bottom=max(bottom / 2, 1e-12 * top), top=4 * top)
        for axis in (axes.xaxis, axes.yaxis):
            plain_numbers(axis)
    else:
        axes.text(0.5, 0.5, "a flat: no waves", transform=axes.transAxes, ha="center")
    if (knee := report.roll_off.wavelength) is not None:
        axes.axvline(1e3 * knee, color=NEUTRAL, ls="--", lw=0.8, label="suggested roll-off")
        _legend(axes)
    axes.set(xlabel="wavelength, µm", ylabel="power spectral density, µm⁴")


def _write_numbers(figure: Any, report: SurfaceReport) -> None:
    """Write what was read, what was done to it and what came out into the right half of a figure."""
    font: dict[str, Any] = {"xycoords": "subfigure fraction", "textcoords": "offset points", "fontsize": 7}
    down = 0.0
    for label, told in _numbers(record(report.rows)):
        for number, line in enumerate(textwrap.wrap(told, TOLD)):
            down -= LINE
            for place, text, color in ((0.0, "" if number else label, NEUTRAL), (INDENT, line, "black")):
                note = figure.axes[0].annotate(text, (0.5, 0.98), (place, down), color=color, **font)
                note.set_in_layout(False)
                note.set_annotation_clip(False)


def _numbers(r: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Give the numbers of a sheet as label and text. r: the record of the report."""
    (nx, ny), (px, py), (lx, ly) = r["grid"], r["pixel_um"], r["extent_mm"]
    yield "file", f"{r['file']} ({r['format']})"
    yield "window", f"{lx:.4g} × {ly:.4g} mm"
    yield "points", f"{nx} × {ny}, {px:.4g} × {py:.4g} µm apart"
    yield "missing", f"{r['missing']} points ({r['missing_percent']:.2g} %)"
    yield "done", "; ".join(r["operations"]) or "nothing"
    yield "height", f"Sa {r['sa_um']:.3g}, Sq {r['sq_um']:.3g}, Sz {r['sz_um']:.3g} µm"
    yield "", f"Ssk {r['ssk']:.3g}, Sku {r['sku']:.3g}".replace("-", "−")
    developed = f", Sdr {r['sdr_percent']:.3g} %" if "sdr_percent" in r else ""  # a flat has none
    yield "slope", f"Sdq {r['rms_slope']:.3g}{developed}, between points"
    if (length := r["autocorrelation_length_um"]) is not None:
        yield "length", f"Sal {length:.3g} µm (autocorrelation falls to 0.2)"
    bearing = r["bearing"]
    yield "bearing", f"Spk {bearing['spk_um']:.3g}, Sk {bearing['sk_um']:.3g}, Svk {bearing['svk_um']:.3g} µm"
    yield "", f"Smr1 {bearing['smr1_percent']:.3g}, Smr2 {bearing['smr2_percent']:.3g} %"
    for axis, found in r["ra"].items():
        if found.get("ra_um") is not None:
            filters = [f"{name} {found[key]:.3g} {unit}" for name, key, unit in FILTERS if found.get(key)]
            told = f"{found['ra_um']:.3g} ± {found['scatter_um']:.2g} µm"
            yield f"Ra along {axis}", f"{told} ({', '.join(filters) or 'unfiltered'})"
    if r["roll_off"]["wavelength_um"] is not None:
        hurst = r["roll_off"]["hurst"]
        beside = f", Hurst exponent {hurst:.2g}" if hurst is not None else ""
        yield "roll-off", f"{r['roll_off']['wavelength_um']:.3g} µm{beside}"


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


def scar_figure(scar: Patch, *, filled: BoolArray | None = None) -> Figure:
    """Draw what a disc has lost: a map with the outlines of scar and rim, the mean profile in its band.

    filled: points that were not measured, shape (nx, ny).
    """

    def draw(panels: Any) -> None:
        (nx, ny), (px, py) = scar.lost.shape, scar.pixel
        size, profile = (nx * px, ny * py), mean_profile(scar)
        high = 1e3 * float(np.quantile(scar.lost[scar.patch], 0.998))
        piled = 1e3 * float(np.quantile(-scar.lost[scar.rim], 0.995)) if scar.rim.any() else 0.0
        span = (-max(piled, 0.05 * high), high)
        _map(panels[0], 1e3 * scar.lost, size, label="depth lost, µm", colours=DEPTHS, span=span)
        _hatch(panels[0], filled if filled is not None and filled.any() else None, size)
        x, y = places((nx, ny), scar.pixel)
        for region, dash in ((scar.patch, "-"), (scar.patch | scar.rim, "--")):
            outline = region.T.astype(np.float64)
            panels[0].contour(x, y, outline, levels=[0.5], colors=[NEUTRAL], linewidths=0.8, linestyles=dash)
        depth, band = 1e3 * profile.depth, 1e3 * profile.band
        panels[1].fill_between(
            profile.y, depth - band, depth + band, color=DISC, alpha=0.3, lw=0, label="± one standard error"
        )
        panels[1].plot(profile.y, depth, color=DISC, lw=0.9, label="mean profile")
        panels[1].axhline(0.0, color=NEUTRAL, lw=0.6)
        panels[1].invert_yaxis()
        panels[1].set(xlabel="across, y, mm", ylabel="depth lost, µm")
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
        interpolation="antialiased",  # "auto" of Matplotlib 3.10 and later
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
    _legend(axes)
