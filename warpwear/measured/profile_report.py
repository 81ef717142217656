"""What is in a profile: its numbers for people and for JSON, and its figure."""

from collections.abc import Iterator

import numpy as np

from warpwear.errors import InputError
from warpwear.figures.describe import DISC, Axis, Chart, Figure, Level, Line, Look
from warpwear.grid import FloatArray
from warpwear.measured.options import quantity
from warpwear.measured.surface_figure import ZERO, stack
from warpwear.measured.surface_report import DOUBTED, ERROR, bearing_rows, needle_row
from warpwear.results.report import Row, lines, record, times
from warpwear.surfaces.levelling import tilt
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.profiles.profile import Parameters, Profile, checked, material_ratio
from warpwear.surfaces.roughness import material_ratio_curve
from warpwear.surfaces.worn.track import WornTrack

#: Heights over the mean line, in Rq, at which the material ratio is told.
LEVELS = (1.0, 0.0, -1.0)
#: Parameters that are heights.
HEIGHTS = ("ra", "rq", "rz", "rp", "rv", "rt")


def line_of(surface: Measured, line: str) -> Profile:
    """Return a line of a map. line: axis along it and its place across from the map's corner, 'y, 0.5 mm'.

    Raises InputError.
    """
    axis, _, place = (part.strip() for part in line.partition(","))
    if axis not in ("x", "y"):
        raise InputError(f"--line is {line!r}: allowed is the axis along it and a place, such as 'y, 0.5 mm'")
    across = 1 if axis == "x" else 0
    index = int(quantity("--line", place, "mm") / surface.pixel[across])
    if index >= surface.measured.shape[across]:
        raise InputError(f"--line is {line!r}: the map has {surface.size[across]:.4g} mm across {axis}")
    own = surface.record()
    about = {"file": own["file"], "format": own["format"], "unit": own["unit"], "line": line}
    about |= {"notes": own["operations"]}
    return checked(Profile(surface.pixel[1 - across], np.take(surface.measured, index, axis=across), about))


def profile_rows(profile: Profile, degree: int, beside: str = "") -> list[Row]:
    """Declare what was read. degree: of the polynomial taken off, beside: fitted to what."""
    form = f"polynomial of degree {degree}{beside} taken off"
    if degree and not beside:
        off = profile.heights - profile.levelled(degree).heights
        form += f", tilted by {tilt(off[:, None], pixel=(profile.spacing, 1.0)):.3g}°"
    about = profile.about
    return [
        *(Row("", key, value) for key, value in about.items()),
        Row("line", "", about.get("line")),
        Row("points", "points", profile.heights.size),
        Row("missing", "missing", int(profile.missing.sum()), note="points"),
        Row("spacing", "spacing_um", 1e3 * profile.spacing),
        Row("length", "length_mm", profile.length),
        Row("form", "form", form),
        Row("done", "", about["notes"] or None),
    ]


def parameter_rows(p: Parameters) -> list[Row]:
    """Declare the parameters of ISO 21920-2."""
    by_level = [(round(level, 1), material_ratio(p.rough, level * p.rq)) for level in LEVELS]
    ratios = ", ".join(f"{ratio:.3g} % at {level:g} Rq" for level, ratio in by_level).replace("-", "−")
    return [
        Row("filtered", "", [*_filters(p), *p.notes]),
        Row("", "lambda_c_mm", p.cut_off),
        Row("", "lambda_s_um", times(1e3, p.short)),
        Row("", "sections", p.sections),
        Row("", "filter_notes", list(p.notes)),
        *(Row(name.title(), f"{name}_um", 1e3 * vars(p)[name]) for name in HEIGHTS),
        *(Row(name.title(), name, vars(p)[name]) for name in ("rsk", "rku")),
        Row("RSm", "rsm_um", times(1e3, p.rsm)),
        Row("RSm", "", "none: fewer than two profile elements" if p.rsm is None else None),
        *bearing_rows(p.bearing, "R"),
        Row("Rmr(c)", "rmr_percent_at_rq", [list(pair) for pair in by_level], sentence=ratios),
    ]


def _filters(p: Parameters) -> Iterator[str]:
    """Say which filters were used, over which length."""
    if p.short is not None:
        yield f"λs {1e3 * p.short:.3g} µm"
    if p.cut_off is not None:
        yield f"λc {p.cut_off:.3g} mm, evaluated over {p.sections} section{'s' * (p.sections > 1)}"


def groove_rows(groove: WornTrack) -> list[Row]:
    """Declare what is said of a groove in a profile."""
    below, above = groove.mean_section
    low, high = groove.window
    net, error = float(groove.net[0]), groove.net_error
    middle = 0.5 * groove.y.size * float(groove.y[1] - groove.y[0])
    window = [low + middle, high + middle]
    doubt = "the section is hardly told from the surface's own waviness"
    return [
        Row("groove", "width_mm", groove.width, digits=3, note="wide at the level of the surface beside it"),
        Row("depth", "depth_um", 1e3 * groove.depth),
        Row("summed", "window_mm", window, sentence=f"from {window[0]:.4g} to {window[1]:.4g} mm"),
        Row("below", "section_below_um2", 1e6 * below, digits=5),
        Row("above", "section_above_um2", 1e6 * above, digits=3),
        Row("section", "section_um2", 1e6 * net, 5, ERROR, 1e6 * error),
        Row("warning", "warning", doubt if error > DOUBTED * abs(net) else None),
        needle_row(groove),
    ]


def profile_lines(rows: list[Row]) -> list[str]:
    """Return the report for people."""
    about = record(rows)
    return [f"{about['file']}: {about['format']}, a profile", *lines(rows)]


def profile_figure(profile: Profile, p: Parameters) -> Figure:
    """Draw a profile, its roughness as it is evaluated, and the material ratio."""
    first = 0.5 * (profile.length - p.rough.size * profile.spacing)
    places = first + profile.places[: p.rough.size]
    ratio, reached = material_ratio_curve(p.rough)
    return stack(
        _chart("Profile", "height less form, µm", profile.places, profile.heights),
        _chart("Roughness", "roughness, µm", places, p.rough),
        Chart(
            "Material ratio",
            Axis("material ratio, %", low=0.0, high=100.0),
            Axis("height, µm"),
            [Line(ratio, 1e3 * reached, look=Look(DISC)), Level(0.0, look=ZERO)],
        ),
    )


def _chart(title: str, up: str, places: FloatArray, heights: FloatArray) -> Chart:
    """Draw heights [mm] over places [mm]."""
    line = Line(places, 1e3 * heights, look=Look(DISC, width=0.6))
    return Chart(title, Axis("place, mm"), Axis(up), [line, Level(0.0, look=ZERO)])
