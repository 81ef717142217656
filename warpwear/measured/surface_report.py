"""What is in a measured file: numbers as a record, and as one page for people."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from warpwear.surfaces.measured import Measured
from warpwear.surfaces.roughness import (
    Bearing,
    bearing_parameters,
    material_ratio_curve,
    profile_roughness,
    slope_along,
)
from warpwear.surfaces.spectrum import (
    RollOff,
    Spectrum,
    autocorrelation_length,
    power_spectrum,
    slope_against_cut_off,
    suggested_roll_off,
)
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.ball import Cap, WornBall
from warpwear.surfaces.worn.track import Track

FloatArray = npt.NDArray[np.float64]

LAMBDA_C, LAMBDA_S = 2.5, 0.008  # mm, Table A.1 of the thesis
LAY = 0.7  # slopes along the lay are less than this part of those across it, or there is none to speak of
CUT_OFFS = 25


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfaceReport:
    """All that `page` and the figure show.

    ratio [%] and height [mm] of the bearing curve, (n,); cut_offs [mm] and the rms slope [-] after each,
    (m,); record: the same, JSON-ready, units in the key names.
    """

    surface: Measured
    bearing: Bearing
    ratio: FloatArray
    height: FloatArray
    spectrum: Spectrum
    cut_offs: FloatArray
    slopes: FloatArray
    roll_off: RollOff
    record: dict[str, Any]


def examine(surface: Measured, *, cut_off: float = LAMBDA_C, short: float = LAMBDA_S) -> SurfaceReport:
    """Everything about a measured surface. cut_off, short: λc and λs [mm] of the roughness profiles.

    Raises InputError where short is not below cut_off, before anything long is computed.
    """
    heights, pixel = surface.levelled, surface.pixel
    profiles = [
        profile_roughness(heights, pixel=pixel, axis=axis, cut_off=cut_off, short=short) for axis in (0, 1)
    ]
    bearing = bearing_parameters(heights)
    ratio, height = material_ratio_curve(heights)
    spectrum = power_spectrum(heights, pixel=pixel)
    correlation = autocorrelation_length(heights, pixel=pixel)
    own = surface.record()
    resolved = max(2.0 * max(pixel), own.get("s_filter_um", 0.0) * 1e-3)
    roll_off = suggested_roll_off(spectrum, correlation=correlation, resolved=resolved)
    cut_offs = np.geomspace(2.0 * max(pixel), max(0.25 * min(surface.size), 4.0 * max(pixel)), CUT_OFFS)
    slopes = slope_against_cut_off(heights, pixel=pixel, cut_offs=cut_offs)
    ra = {
        name: {
            "ra_um": 1e3 * found.ra,
            "scatter_um": 1e3 * found.scatter,
            "profiles": found.profiles,
            "lambda_c_mm": found.cut_off,
            "lambda_s_um": None if found.short is None else 1e3 * found.short,
            "notes": list(found.notes),
        }
        for name, found in zip(("x", "y"), profiles, strict=True)
    }
    x, y = places((heights.shape[0], heights.shape[1]), pixel)
    record = own | {
        "grid": list(heights.shape),
        "pixel_um": [1e3 * p for p in pixel],
        "extent_mm": list(surface.size),
        "ra": ra,
        "lay": _lay(*(slope_along(heights, pixel=pixel, axis=axis) for axis in (0, 1))),
        "bearing": {
            "sk_um": 1e3 * bearing.sk,
            "spk_um": 1e3 * bearing.spk,
            "svk_um": 1e3 * bearing.svk,
            "smr1_percent": bearing.smr1,
            "smr2_percent": bearing.smr2,
        },
        "autocorrelation_length_um": None if correlation is None else 1e3 * correlation,
        "roll_off": {
            "wavelength_um": None if roll_off.wavelength is None else 1e3 * roll_off.wavelength,
            "from": roll_off.source,
            "hurst": roll_off.hurst,
        },
        "slope_against_cut_off": {
            "cut_off_um": (1e3 * cut_offs).tolist(),
            "rms_slope": slopes.tolist(),
        },
        "power_spectrum": {
            "wavelength_um": (1e3 * spectrum.wavelength).tolist(),
            "density_um4": (1e12 * spectrum.density).tolist(),
        },
        "warnings": surface.notices(x, y),
    }
    return SurfaceReport(
        surface=surface,
        bearing=bearing,
        ratio=ratio,
        height=height,
        spectrum=spectrum,
        cut_offs=cut_offs,
        slopes=slopes,
        roll_off=roll_off,
        record=record,
    )


def page(record: dict[str, Any]) -> str:
    """The record of a surface (see `examine`) as one page of text."""
    r, b = record, record["bearing"]
    lines = [
        *_file_lines(r),
        f"  Sa {r['sa_um']:.4g} µm   Sq {r['sq_um']:.4g} µm   Sz {r['sz_um']:.4g} µm   Ssk {r['ssk']:.3g}   "
        f"Sku {r['sku']:.3g}   rms slope {r['rms_slope']:.3g}",
        f"  bearing curve    Sk {b['sk_um']:.4g} µm   Spk {b['spk_um']:.4g} µm   Svk {b['svk_um']:.4g} µm   "
        f"Smr1 {b['smr1_percent']:.1f} %   Smr2 {b['smr2_percent']:.1f} %",
    ]
    for axis, found in r["ra"].items():
        way = {axis: " (along the lay)", "none": ""}.get(r["lay"], " (across the lay)")
        used = [] if found["lambda_c_mm"] is None else [f"λc {found['lambda_c_mm']:g} mm"]
        used += [] if found["lambda_s_um"] is None else [f"λs {found['lambda_s_um']:g} µm"]
        lines.append(
            f"  Ra along {axis}       {found['ra_um']:.4g} ± {found['scatter_um']:.2g} µm over "
            f"{found['profiles']} profiles{way}; {', '.join(used) or 'no filter'}"
        )
        lines += [f"                   {note}" for note in found["notes"]]
    if r["lay"] == "none":
        lines.append("                   no clear lay")
    cut_offs, slopes = r["slope_against_cut_off"]["cut_off_um"], r["slope_against_cut_off"]["rms_slope"]
    shown = range(0, len(cut_offs), 6)
    lines.append(
        "  rms slope        " + ", ".join(f"{slopes[i]:.3g} from {cut_offs[i]:.3g} µm" for i in shown) + " on"
    )
    roll = r["roll_off"]
    found_at = "none" if roll["wavelength_um"] is None else _length(roll["wavelength_um"])
    hurst = "" if roll["hurst"] is None else f"; Hurst exponent {roll['hurst']:.2g}"
    lines.append(f"  roll-off         {found_at}, from: {roll['from']}{hurst}")
    lines += [f"  warning: {text}" for text in r["warnings"]]
    return "\n".join(lines)


def track_record(track: Track, *, length: float | None) -> dict[str, Any]:
    """A worn track, JSON-ready. length: of the whole track [mm], None for the measured piece alone."""
    measured, error = track.volume()
    found: dict[str, Any] = {
        "width_mm": track.edges[1] - track.edges[0],
        "edges_mm": list(track.edges),
        "depth_of_mean_profile_um": 1e3 * track.depth,
        "section_below_um2": {"mean": 1e6 * track.below.mean(), "std": 1e6 * track.below.std()},
        "section_above_um2": {"mean": 1e6 * track.above.mean(), "std": 1e6 * track.above.std()},
        "mean_section_below_um2": 1e6 * track.below_of_mean,
        "mean_section_above_um2": 1e6 * track.above_of_mean,
        "section_net_um2": {
            "mean": 1e6 * track.net.mean(),
            "std": 1e6 * track.net.std(),
            "error": 1e6 * track.net_error,
        },
        "sections": int(track.net.size),
        "length_mm": track.length,
        "volume_mm3": measured,
        "volume_error_mm3": error,
    }
    if length is not None:
        whole, whole_error = track.volume(length)
        found |= {
            "whole_length_mm": length,
            "whole_volume_mm3": whole,
            "whole_volume_error_mm3": whole_error,
        }
    return found


def track_page(file: dict[str, Any], record: dict[str, Any], *, degree: int) -> str:
    """A worn track as one page of text. file: the record of its surface; degree: taken off outside it."""
    r = record
    lines = [
        *_file_lines(file),
        f"  then             polynomial of degree {degree} through the surface beside the track taken off",
        f"  track            {r['width_mm']:.4g} mm wide with its pile-up (y {r['edges_mm'][0]:.4g} to "
        f"{r['edges_mm'][1]:.4g} mm), mean profile {r['depth_of_mean_profile_um']:.4g} µm deep",
        f"  mean section     {r['mean_section_below_um2']:.5g} µm² below, "
        f"{r['mean_section_above_um2']:.3g} µm² above (averaged along the track first: trough and pile-up)",
        f"  single sections  {r['sections']} across the sliding direction (mean ± standard deviation)",
    ]
    for name, words in (
        ("below", "below, with the roughness in it"),
        ("above", "above, with the roughness in it"),
        ("net", "below − above"),
    ):
        found = r[f"section_{name}_um2"]
        lines.append(f"    {words:<31} {found['mean']:.5g} ± {found['std']:.2g} µm²")
    lines.append(
        f"  volume           {r['volume_mm3']:.5g} ± {r['volume_error_mm3']:.1g} mm³ (standard error) over "
        f"the measured {r['length_mm']:.4g} mm"
    )
    if "whole_length_mm" in r:
        lines.append(
            f"  whole track      {r['whole_volume_mm3']:.5g} ± {r['whole_volume_error_mm3']:.1g} mm³ over "
            f"{r['whole_length_mm']:.4g} mm, were it all like the measured piece"
        )
    return "\n".join(lines)


def ball_record(ball: WornBall) -> dict[str, Any]:
    """A worn ball from its topography, JSON-ready."""
    return {
        "radius_mm": ball.sphere.radius,
        "depth_um": 1e3 * ball.depth,
        "patch_along_mm": ball.along,
        "patch_across_mm": ball.across,
        "volume_mm3": ball.volume,
        "volume_error_mm3": ball.volume_error,
        "piled_up_mm3": ball.piled_up,
        "piled_up_error_mm3": ball.piled_up_error,
        "scatter_of_unworn_um": 1e3 * ball.noise,
    }


def ball_page(file: dict[str, Any], record: dict[str, Any], cap: Cap) -> str:
    """A worn ball as one page of text. cap: of the patch's two extents, for comparison."""
    r = record
    return "\n".join(
        [
            *_file_lines(file),
            f"  sphere           radius {r['radius_mm']:.5g} mm through the unworn part, which scatters by "
            f"{r['scatter_of_unworn_um']:.3g} µm",
            f"  worn patch       {r['patch_along_mm']:.4g} × {r['patch_across_mm']:.4g} mm (along × across), "
            f"{r['depth_um']:.4g} µm deep",
            f"  volume           {r['volume_mm3']:.5g} ± {r['volume_error_mm3']:.1g} mm³ lost in the patch "
            "(standard error, of roughness and of the sphere's fit)",
            f"  piled up         {r['piled_up_mm3']:.2g} ± {r['piled_up_error_mm3']:.1g} mm³ net above the "
            "sphere in the rim beside the patch",
            f"  by two diagonals {cap.volume:.5g} mm³, {1e3 * cap.height:.4g} µm deep, were the patch flat",
        ]
    )


def cap_record(cap: Cap) -> dict[str, Any]:
    """A worn cap from two diagonals, JSON-ready."""
    return {"height_um": 1e3 * cap.height, "rim_radius_mm": cap.rim, "volume_mm3": cap.volume}


def cap_page(cap: Cap) -> str:
    """A worn cap from two diagonals as text."""
    return (
        f"worn ball by two diagonals: half their mean {cap.rim:.5g} mm, depth {1e3 * cap.height:.5g} µm, "
        f"volume {cap.volume:.5g} mm³ (a flat patch)"
    )


def _file_lines(r: dict[str, Any]) -> list[str]:
    said = {"file": "as the file says", "study": "as given"}
    grid, pixel, extent = r["file_grid"], r["file_pixel_um"], r["file_extent_mm"]
    return [
        f"{r['file']}: {r['format']}, {grid[0]} × {grid[1]} points, pixel {pixel[0]:.5g} × {pixel[1]:.5g} µm "
        f"({said[r['pixel_from']]}), {extent[0]:.5g} × {extent[1]:.5g} mm",
        f"  as read          heights {r['height_min_um']:.5g} to {r['height_max_um']:.5g} µm, unit "
        f"{r['unit']} ({said[r['unit_from']]}), Sq {r['sq_as_read_um']:.4g} µm, missing {r['missing']} "
        f"({r['missing_percent']:.3g} %)",
        *(f"  {'then' if i else 'done':<16} {text}" for i, text in enumerate(r["operations"])),
    ]


def _length(um: float) -> str:
    return f"{um:.3g} µm" if um < 1000.0 else f"{1e-3 * um:.3g} mm"


def _lay(along_x: float, along_y: float) -> str:
    if min(along_x, along_y) >= LAY * max(along_x, along_y):
        return "none"
    return "x" if along_x < along_y else "y"
