"""What is in a measured file: its numbers, declared once for people and for JSON."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.measured.report import FileReport
from warpwear.results.report import Row, lines, record, times
from warpwear.surfaces import roughness
from warpwear.surfaces import spectrum as spectra
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.ball import Cap, WornBall
from warpwear.surfaces.worn.find_scar import mean_profile, sides_reached
from warpwear.surfaces.worn.patch import Patch
from warpwear.surfaces.worn.registration import Difference
from warpwear.surfaces.worn.track import WornTrack

#: Cut-off of roughness profiles [mm], Table A.1 of the thesis.
LAMBDA_C = 2.5
#: Shortest wave of roughness profiles [mm], from the same table.
LAMBDA_S = 0.008
#: What the error of a volume is, for people.
ERROR = "(± one standard error: what the same sum finds on unworn surface)"
#: Part of a volume above which its error leaves little to say.
DOUBTED = 1.0 / 3.0
#: Part of a scar's points above which those that were filled are told of.
MUCH_FILLED = 0.05
#: Slopes along the lay are less than this part of those across it, or there is no lay to speak of.
LAY = 0.7
#: Number of shortest waves after which the rms slope is found.
CUT_OFFS = 25
#: What is said of the roughness of a surface without any.
FLAT = "none: the surface is flat"
#: Every sixth of them is shown to people.
SHOWN_CUT_OFF = 6
#: Key in a measured surface's own record -> name for people.
ROUGHNESS = {f"{name}_um": name.title() for name in ("sa", "sq", "sz")}
ROUGHNESS |= {"ssk": "Ssk", "sku": "Sku", "rms_slope": "rms slope"}


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class MeasuredSurface(FileReport):
    """A measured surface has heights, roughness and a spectrum; `print` shows what `warpwear surface` prints.

    Attributes
    ----------
    surface : Measured
        Heights at any points, for ``run(study, surface=...)``.
    bearing : Bearing
        Parameters of the core [mm, %].
    spectrum : Spectrum
        Wavelength [mm] and density [mm⁴] of the waves in all directions, shape (bins,).
    cut_offs, slopes : array
        Cut-offs [mm], and the rms slope [-] of all waves longer than each, shape (m,).
    roll_off : RollOff
        The wavelength that it suggests.
    """

    surface: Measured
    bearing: roughness.Bearing
    spectrum: spectra.Spectrum
    cut_offs: FloatArray
    slopes: FloatArray
    roll_off: spectra.RollOff

    @property
    def heights(self) -> FloatArray:
        """Heights [mm] less the form, axis 0 along sliding, (nx, ny), filled where points are missing."""
        return self.surface.levelled

    @property
    def missing(self) -> BoolArray:
        """Return which points were not measured, shape (nx, ny)."""
        return np.isnan(self.surface.measured)

    @property
    def pixel(self) -> tuple[float, float]:
        """Return the distances of the points along both axes [mm]."""
        return self.surface.pixel


def examine(surface: Measured, *, cut_off: float = LAMBDA_C, short: float = LAMBDA_S) -> MeasuredSurface:
    """Find everything about a measured surface. cut_off, short: λc and λs [mm] of the roughness profiles.

    Raises InputError where short is not below cut_off, before anything long is computed.
    """
    whole, heights, pixel = surface.levelled, surface.measured, surface.pixel
    valid = None if surface.filled is None else ~surface.filled
    filters = {"cut_off": cut_off, "short": short}
    profiles = [roughness.profile_roughness(heights, pixel=pixel, axis=axis, **filters) for axis in (0, 1)]
    bearing = roughness.bearing_parameters(heights)
    spectrum = spectra.power_spectrum(whole, pixel=pixel, measured=valid)
    correlation = spectra.autocorrelation_length(heights, pixel=pixel)
    own = surface.record()
    resolved = max(2.0 * max(pixel), own.get("s_filter_um", 0.0) * 1e-3)
    roll_off = spectra.suggested_roll_off(spectrum, correlation=correlation, resolved=resolved)
    cut_offs = np.geomspace(2.0 * max(pixel), max(0.25 * min(surface.size), 4.0 * max(pixel)), CUT_OFFS)
    slopes = spectra.slope_against_cut_off(whole, pixel=pixel, cut_offs=cut_offs, measured=valid)
    lay = _lay(*(roughness.slope_along(heights, pixel=pixel, axis=axis) for axis in (0, 1)))
    some = list(zip(slopes, 1e3 * cut_offs, strict=True))[::SHOWN_CUT_OFF]
    few = ", ".join(f"{slope:.3g} from {um:.3g} µm" for slope, um in some)
    roll_off_rows = [
        Row("wavelength", "wavelength_um", times(1e3, roll_off.wavelength), digits=3),
        Row("from:", "from", roll_off.source),
        Row("Hurst exponent", "hurst", roll_off.hurst, digits=2),
    ]
    how = {"rms_slope": "(by differences of neighbours)"}
    rough_rows = [Row(label, key, own[key], note=how.get(key, "")) for key, label in ROUGHNESS.items()]
    sdr = 100.0 * roughness.developed_area(heights, pixel=pixel)
    rough_rows.append(Row("Sdr", "sdr_percent", sdr, digits=3))
    ra_rows = [row for axis, profile in zip("xy", profiles, strict=True) for row in _ra(axis, profile, lay)]
    by_cut_off = {"cut_off_um": (1e3 * cut_offs).tolist(), "rms_slope": slopes.tolist()}
    by_wave = {"wavelength_um": 1e3 * spectrum.wavelength, "density_um4": 1e12 * spectrum.density}
    rows = [
        *(Row("", key, value) for key, value in own.items()),
        Row("roughness", "", rough_rows if own["sz_um"] > 0.0 else FLAT),
        Row("", "grid", list(heights.shape)),
        Row("", "pixel_um", [1e3 * p for p in pixel]),
        Row("", "extent_mm", list(surface.size)),
        Row("", "ra", ra_rows),
        Row("lay", "lay", lay, sentence="no clear lay" if lay == "none" else f"along {lay}"),
        Row("bearing", "bearing", bearing_rows(bearing)),
        Row(
            "Sal", "autocorrelation_length_um", times(1e3, correlation), note="(autocorrelation falls to 0.2)"
        ),
        Row("roll-off", "roll_off", roll_off_rows),
        Row("rms slope", "slope_against_cut_off", by_cut_off, sentence=f"{few} on (from the spectrum)"),
        Row("", "power_spectrum", {key: values.tolist() for key, values in by_wave.items()}),
        Row("warning", "warnings", surface.notices(*places((heights.shape[0], heights.shape[1]), pixel))),
    ]
    return MeasuredSurface(
        text="\n".join([*file_lines(record(rows)), *lines(rows)]),
        rows=rows,
        surface=surface,
        bearing=bearing,
        spectrum=spectrum,
        cut_offs=cut_offs,
        slopes=slopes,
        roll_off=roll_off,
    )


def file_lines(surface: dict[str, Any], *then: str) -> list[str]:
    """Say for people what was read and what was done to it.

    surface: the record of a measured surface. then: what was done after its own operations.
    """
    r = surface
    said = {"file": "as the file says", "study": "as given"}
    grid = Row("", "", r["file_grid"], note="points")
    pixel = Row("", "file_pixel_um", r["file_pixel_um"], digits=5, note=f"({said[r['pixel_from']]})")
    extent = Row("", "file_extent_mm", r["file_extent_mm"], digits=5)
    as_read = [
        Row("lowest", "height_min_um", r["height_min_um"], digits=5),
        Row("highest", "height_max_um", r["height_max_um"], digits=5),
        Row("unit", "", r["unit"], note=f"({said[r['unit_from']]})"),
        Row("Sq", "sq_as_read_um", r["sq_as_read_um"]),
        Row("missing", "", r["missing"], note=f"points ({r['missing_percent']:.3g} %)"),
    ]
    head = f"{r['file']}: {r['format']}, {grid.text}, pixel {pixel.text}, {extent.text}"
    return [head, *lines([Row("as read", "", as_read), Row("done", "", [*r["operations"], *then])])]


def track_rows(track: WornTrack, *, length: float | None) -> list[Row]:
    """Declare what is said of a worn track. length: of the whole track [mm], None for the piece alone."""
    low, high = track.window
    edges = f"y {low:.4g} to {high:.4g} mm"
    below, above = track.mean_section
    mean_section = [
        Row("below", "mean_section_below_um2", 1e6 * below, digits=5),
        Row("above", "mean_section_above_um2", 1e6 * above, digits=3),
    ]
    net = [_spread(track.net), Row("", "error", 1e6 * track.net_error)]
    volume, error = track.volume()
    rough, measured = "with the roughness in it", f"{ERROR} over the measured {track.length:.4g} mm"
    doubt = "neither volume nor width is told from the surface's own waviness: --before FILE takes that off"
    rows = [
        Row("track", "width_mm", track.width, digits=3, note="wide at the level of the surface beside it"),
        Row("summed over", "window_mm", high - low, note=f"with pile-up and margins ({edges})"),
        Row("", "window_edges_mm", list(track.window)),
        Row("mean profile", "depth_of_mean_profile_um", 1e3 * track.depth, note="deep"),
        Row("single sections", "section_below_um2", [_spread(track.below)], unit="", note=f"below, {rough}"),
        Row("single sections", "section_above_um2", [_spread(track.above)], unit="", note=f"above, {rough}"),
        Row("mean section", "", mean_section, note="(averaged along the track first: trough and pile-up)"),
        Row("single sections", "section_net_um2", net, unit="", note="below − above, ± standard deviation"),
        Row("", "sections", int(track.net.size)),
        Row("", "length_mm", track.length),
        Row("volume", "volume_mm3", volume, digits=5, error=error, note=measured),
        Row("warning", "warning", doubt if error > DOUBTED * abs(volume) else None),
        needle_row(track),
    ]
    if length is None:
        return rows
    volume, error = track.volume(length)
    alike = f"over {length:.4g} mm, were it all like the measured piece"
    whole = Row("whole track", "whole_volume_mm3", volume, digits=5, error=error, note=alike)
    return [*rows, Row("", "whole_length_mm", length), whole]


def needle_row(track: WornTrack) -> Row:
    """Declare that a scratch or a lost point may pass for wear."""
    if track.needle is None:
        return Row("warning", "needle", None)
    part = f"{100.0 * track.needle[1]:.2g} % of the section lies in a tenth of its width"
    return Row("warning", "needle", f"{part}: a scratch, or wear? --outliers takes off what stands out")


def before_rows(changed: Difference, *, file: str) -> list[Row]:
    """Declare how a measurement from before the wear was laid over the later one."""
    return [
        Row("", "file", file),
        Row("shifted", "shift_um", [1e3 * s for s in changed.shift], digits=4),
        Row("turned", "rotation_degrees", math.degrees(changed.rotation), digits=3, unit="°"),
        Row("correlation beside the wear", "correlation", changed.correlation, digits=4),
        Row("shared", "grid", list(changed.heights.shape), note="points"),
    ]


def patch_rows(patch: Patch, *, filled: float = 0.0) -> list[Row]:
    """Declare what is said of a wear scar, or of a worn ball. filled: part of its points not measured."""
    profile, notes, form, radius = mean_profile(patch), [], "the unworn surface", None
    if isinstance(patch, WornBall):
        form, radius = "the sphere", patch.sphere.radius
    if (sides := sides_reached(patch.patch)) > 0:
        more = f"{sides} sides" if sides > 1 else "a side"
        notes.append(f"the scar reaches {more} of the field: volumes and area are of what lies in it")
    if filled > MUCH_FILLED:
        notes.append(
            f"{100.0 * filled:.2g} % of the scar's points were not measured and are filled from their rim, "
            "which the errors hold as known points filled alike, and those beside them, tell it"
        )
    depth, error = 1e3 * profile.depth, 1e3 * profile.band
    along, across = patch.length_errors
    size = [
        Row("depth", "depth_um", 1e3 * patch.depth),
        Row("along", "patch_along_mm", patch.along, error=along),
        Row("across", "patch_across_mm", patch.across, error=across),
    ]
    net_note = f"net above {form} in the rim beside the patch"
    over = f"deep, over {profile.length:.3g} mm along sliding"
    by_place = {"y_mm": profile.y.tolist(), "depth_um": depth.tolist(), "error_um": error}
    return [
        Row("sphere's radius", "radius_mm", radius, digits=5, note="through the unworn part"),
        Row("worn patch", "", size),
        Row("worn", "volume_mm3", patch.volume, 5, f"lost in the patch {ERROR}", patch.volume_error),
        Row("piled up", "piled_up_mm3", patch.piled_up, 2, net_note, patch.piled_up_error),
        Row("net", "net_mm3", patch.net, error=patch.net_error, note="worn − piled up"),
        Row("worn area", "area_mm2", patch.area, error=patch.area_error),
        Row("mean profile", "profile_depth_um", float(depth.max()), 4, over, ("profile_error_um", error)),
        Row("unworn part", "scatter_of_unworn_um", 1e3 * patch.noise, digits=3, note=f"(rms about {form})"),
        Row("", "profile", by_place),
        Row("warning", "warnings", notes or None),
    ]


def cap_rows(cap: Cap) -> list[Row]:
    """Declare what is said of a worn cap from two diagonals."""
    return [
        Row("rim's radius", "rim_radius_mm", cap.rim, digits=5),
        Row("depth", "height_um", 1e3 * cap.height, digits=5),
        Row("volume", "volume_mm3", cap.volume, digits=5),
    ]


def _ra(axis: str, profiles: roughness.ProfileRoughness, lay: str) -> list[Row]:
    """Declare Ra of the profiles along an axis, and how they were filtered."""
    way = "" if lay == "none" else "along the lay" if lay == axis else "across the lay"
    mean, number, c, s = ("mean", "profiles", "λc", "λs") if profiles.ra is not None else [""] * 4
    scatter = "scatter_um", times(1e3, profiles.scatter)
    rows = [
        Row(mean, "ra_um", times(1e3, profiles.ra), error=scatter, note=way),
        Row(number, "profiles", profiles.profiles),
        Row(c, "lambda_c_mm", profiles.cut_off),
        Row(s, "lambda_s_um", times(1e3, profiles.short)),
        Row("", "notes", list(profiles.notes)),
    ]
    label, none = f"Ra along {axis}", "no Ra" if profiles.ra is None else None
    of_axis = Row(label if none is None else "", axis, rows)
    return [of_axis, Row(label, "", none), Row("  filtered", "", list(profiles.notes))]


def bearing_rows(bearing: roughness.Bearing, letter: str = "S") -> list[Row]:
    """Declare the parameters of the core: S of a surface, R of a profile."""
    core, key = vars(bearing), letter.lower()
    return [
        *(Row(letter + end, f"{key}{end}_um", 1e3 * core[f"s{end}"]) for end in ("k", "pk", "vk")),
        *(Row(letter + end, f"{key}{end}_percent", core[f"s{end}"], digits=3) for end in ("mr1", "mr2")),
    ]


def _spread(areas: FloatArray) -> Row:
    """Declare mean and standard deviation of section areas [mm²], (n,)."""
    std = ("std", 1e6 * areas.std())
    return Row(f"{areas.size}:", "mean", 1e6 * areas.mean(), digits=5, error=std, unit="µm²")


def _lay(along_x: float, along_y: float) -> str:
    """Name the axis of the lay, or none. along_x, along_y: rms slopes along the axes."""
    if min(along_x, along_y) >= LAY * max(along_x, along_y):
        return "none"
    return "x" if along_x < along_y else "y"
