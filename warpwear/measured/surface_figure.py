"""Draw measured surfaces, worn tracks and worn balls: panels of one column's width in a stack."""

from typing import Any, TypeAlias

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, Map, Scale
from warpwear.grid import FloatArray
from warpwear.measured.surface_report import MeasuredSurface
from warpwear.results.report import VALUES
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.roughness import material_ratio_curve
from warpwear.surfaces.worn.find_scar import mean_profile
from warpwear.surfaces.worn.patch import Patch
from warpwear.surfaces.worn.track import WornTrack

Pair: TypeAlias = tuple[float, float]

#: Largest number of pixels along a side of a map: more than its width on paper holds.
PIXELS = 700
#: A field that is longer than this many widths is drawn out of proportion.
LONG = 4.0
#: Height of a panel of a stack, and of a row of the sheet of a surface [inch].
ROW, SHEET = 2.4, 2.7
#: Labels of what the sheet of a surface draws, or leaves to the screen.
UNWRITTEN = ("as read", "done", "filtered", "rms slope", "warning")
#: Lines at zero, and through what is found.
ZERO, MARK = Look(width=0.6), Look(describe.NEUTRAL, "dash", 0.8)


def surface_figure(report: MeasuredSurface) -> Figure:
    """Draw the sheet of a measured surface: map, numbers, bearing curve, spectrum, slope over cut-off."""
    surface = report.surface
    slopes = Line(1e3 * report.cut_offs, report.slopes, look=Look(describe.DISC))
    slope = Chart("Slope", Axis("S-filter, µm", "log"), Axis("rms gradient Sdq, –", low=0.0), [slopes])
    done = "; ".join(text.partition(":")[0].partition(" (")[0] for text in report.numbers["operations"])
    head, *others = report.text.splitlines()
    text, label = [("file", head), ("done", done)], ""
    for line in others:
        label = line[:VALUES].strip() or label
        text += [(line[:VALUES].strip(), line[VALUES:])] if label not in UNWRITTEN else []
    above: list[describe.Panel] = [
        _map_of_heights(surface.levelled, surface.size, surface.filled),
        describe.Text(text),
        describe.Empty(),
    ]
    return Figure([*above, _bearing(report), _spectrum(report), slope], 3, width=describe.PAGE, height=SHEET)


def _spectrum(report: MeasuredSurface) -> Chart:
    spectrum = report.spectrum
    lines: list[Line | Level] = []
    low, high, note = None, None, "a flat: no waves"
    if spectrum.density.size:
        lines.append(Line(1e3 * spectrum.wavelength, 1e12 * spectrum.density, look=Look(describe.DISC)))
        # a band-limited surface has nothing but rounding below its shortest wave
        top, bottom = (1e12 * float(v) for v in (spectrum.density.max(), spectrum.density.min()))
        low, high, note = max(bottom / 2, 1e-12 * top), 4 * top, ""
    if (knee := report.roll_off.wavelength) is not None:
        lines.append(Level(1e3 * knee, "suggested roll-off", MARK, "x"))
        note = f"dashed: suggested roll-off, {1e3 * knee:.3g} µm"
    scale: Any = "log" if lines else "linear"
    up = Axis("power spectral density, µm⁴", scale, low=low, high=high)
    return Chart("Spectrum", Axis("wavelength, µm", scale), up, lines, note)


def track_figure(track: WornTrack, *, filled: BoolArray | None = None) -> Figure:
    """A worn track: map over the reference, mean profile across, section lost along the track.

    filled: points that were not measured, shape (nx, ny).
    """
    nx, ny = track.levelled.shape
    size = (track.length, float(track.y[-1] - track.y[0]) * ny / max(ny - 1, 1))
    edges = [
        Level(edge, look=look)
        for edge in track.window
        for look in (Look("#FFFFFF", width=1.6), Look("#000000", "dash", 0.8))
    ]
    x = (np.arange(nx) + 0.5) * track.length / nx - 0.5 * track.length
    net = 1e6 * track.net
    along: list[Line | Level] = [
        Line(x, net, "each section", Look(describe.DISC, width=0.6)),
        Level(float(net.mean()), "mean", Look(describe.NEUTRAL, "dash", 1.0)),
    ]
    bottom, top = min(0.0, float(net.min())), 1.1 * float(net.max()) if net.max() > 0 else None
    return stack(
        _map_of_heights(track.levelled, size, filled, levels=edges),
        _profile_of(track),
        Chart("Section", Axis(describe.ALONG), Axis("section lost, µm²", low=bottom, high=top), along),
    )


def _profile_of(track: WornTrack) -> Chart:
    """Draw the mean profile of a track over the reference, and what of it is summed."""
    profile, y = 1e3 * track.levelled.mean(axis=0), track.y
    parts = []
    for label, inside, colour, hatch in (
        ("below", profile < 0, describe.COUNTER, ""),
        ("above", profile > 0, describe.DISC, "////"),
    ):
        ends = np.where(track.inside & inside, profile, np.nan)
        parts.append(
            Line(y, profile, label, Look(colour, "", alpha=0.35), ends, 0.0 * y + 0.0 * ends, hatch=hatch)
        )
    across: list[Line | Level] = [
        Line(y, profile, "mean profile", Look(describe.DISC)),
        *parts,
        Level(0.0, look=ZERO),
    ]
    return Chart("Mean profile", Axis("across, y, mm"), Axis("height over the reference, µm"), across)


def groove_figure(groove: WornTrack) -> Figure:
    """Draw a groove in a profile over the reference, and what was summed."""
    return stack(_profile_of(groove))


def patch_figure(scar: Patch, *, filled: BoolArray | None = None) -> Figure:
    """What a disc, or a ball, has lost: a map with outlines of scar and rim, the mean profile in its band.

    filled: points that were not measured, shape (nx, ny).
    """
    (nx, ny), (px, py) = scar.lost.shape, scar.pixel
    profile = mean_profile(scar)
    high = 1e3 * float(np.quantile(scar.lost[scar.patch], 0.998))
    piled = 1e3 * float(np.quantile(-scar.lost[scar.rim], 0.995)) if scar.rim.any() else 0.0
    most = max(piled, high)
    scale = Scale("depth lost, µm", -most, most, colours="signed", beyond="both")
    regions = ((scar.patch, Look(width=0.8)), (scar.patch | scar.rim, Look(describe.NEUTRAL, "dash", 0.8)))
    y, depth, error = profile.y, 1e3 * profile.depth, 1e3 * profile.band
    lines: list[Line | Level] = [
        Line(
            y, depth, "± one standard error", Look(describe.DISC, "", alpha=0.3), depth - error, depth + error
        ),
        Line(y, depth, "mean profile", Look(describe.DISC, width=0.9)),
        Level(0.0, look=ZERO),
    ]
    return stack(
        _map(1e3 * scar.lost, (nx * px, ny * py), scale, filled, regions=regions),
        Chart("Mean profile", Axis("across, y, mm"), Axis("depth lost, µm", inverted=True), lines),
    )


def stack(*panels: Map | Chart) -> Figure:
    """Put panels below each other, with one legend."""
    return Figure(panels, 1, legend=3, width=describe.COLUMN, height=ROW)


def _map_of_heights(heights: FloatArray, size: Pair, filled: BoolArray | None, **more: Any) -> Map:
    """Map heights [mm] over a field of a size [mm]; a few spikes and pits do not set the colours."""
    low, high = 1e3 * np.quantile(heights if filled is None else heights[~filled], [0.002, 0.998])
    scale = Scale("height, µm", float(low), float(high), colours="heights", beyond="both")
    return _map(1e3 * heights, size, scale, filled, **more)


def _map(values: FloatArray, size: Pair, scale: Scale, filled: BoolArray | None, **more: Any) -> Map:
    """Map values over a field of a size [mm], in no more points than paper holds."""
    steps = [max(1, -(-count // PIXELS)) for count in values.shape]
    if scale.high <= scale.low:
        scale = Scale(scale.label, scale.low, scale.low + 1.0, colours=scale.colours, beyond="both")
    if filled is not None and not filled.any():
        filled = None
    return Map(
        scale.label.partition(",")[0],
        [values[:: steps[0], :: steps[1]]],
        (-size[0] / 2, size[0] / 2, -size[1] / 2, size[1] / 2),
        scale,
        notes=["hatched: not measured, filled in"] if filled is not None else [],
        hatched=None if filled is None else _reduced(filled, steps),
        square=max(size) <= LONG * min(size),  # a long track at its true proportions would be a line
        x=describe.ALONG,
        y=describe.ACROSS,
        **more,
    )


def _reduced(filled: BoolArray, steps: list[int]) -> BoolArray:
    """Mark each pixel of a map with any point that was not measured."""
    for axis, step in enumerate(steps):
        filled = np.logical_or.reduceat(filled, np.arange(0, filled.shape[axis], step), axis=axis)
    return filled


def _bearing(report: MeasuredSurface) -> Chart:
    b = report.bearing
    ratio, reached = material_ratio_curve(report.surface.measured)
    height, line = 1e3 * reached, np.array([1e3 * b.top, 1e3 * b.bottom])
    lines = [
        Line(ratio, height, "surface", Look(describe.DISC)),
        Line(np.array([0.0, 100.0]), line, "equivalent line", Look(describe.NEUTRAL, "dash", 0.9)),
        *(
            Line(np.array([end, core_end]), np.full(2, level), look=Look(describe.NEUTRAL, "dot", 0.6))
            for end, level, core_end in zip((0.0, 100.0), line, (b.smr1, b.smr2), strict=True)
        ),
    ]
    # A few spikes and pits would squeeze the curve into a line: the ends are cut where they are far off.
    core = height[(ratio >= 0.5) & (ratio <= 99.5)]
    room = 0.35 * (core.max() - core.min()) or 1.0
    low, high = max(height.min(), core.min() - room), min(height.max() + 0.1 * room, core.max() + room)
    up = Axis("height, µm", low=float(low), high=float(high))
    note = "dashed: equivalent line of the core"
    return Chart("Bearing curve", Axis("material ratio, %", low=0.0, high=100.0), up, lines, note)
