"""Wear coefficients from what was measured after a test: volumes, scars of a ball, sections of a groove.

K = V/(F L) with the hardness contained (thesis eqs 2.5 and 4.13). The relations of ASTM G99 and G133 are
under their names: both take one body as unworn, G99 the disc for its ball and the ball for its disc.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from warpwear.calibration.measurements import Value
from warpwear.calibration.scatter import Scatter
from warpwear.errors import InputError
from warpwear.surfaces.worn.ball import cap_of_diagonals

#: Largest K [mm²/N] and 1/K that are told.
LARGEST = 1e30
#: Ratio of a scar's diameters above which it is no flat cap.
LONGER = 1.1
#: Angle [rad] of a circular segment below which its area is summed as a series: φ − sin φ cancels.
SMALL_ANGLE = 0.02


@dataclass(frozen=True, kw_only=True)
class WornVolume:
    """A worn volume and how it was found.

    volume [mm³], exact for the shape assumed; error: its standard uncertainty [mm³], None where unknown;
    error_from: where that comes from; approximate: by the usual relation for small scars [mm³]; bulging: of a
    ball's scar much longer one way, where the disc has worn, too [mm³]; depth: of the scar [mm]; measured:
    what was measured, for people.
    """

    volume: float
    error: float | None = None
    error_from: str = "unknown"
    approximate: float | None = None
    bulging: float | None = None
    depth: float | None = None
    measured: str = ""

    @property
    def doubt(self) -> str | None:
        """Say that it may be nothing; None where it is not."""
        doubted = self.error is not None and self.error > self.volume / 3.0
        return "the volume is within three standard uncertainties of nothing" if doubted else None


def wear_coefficient(worn: WornVolume, load: Value, distance: Value) -> Value:
    """Return K = V/(F L) [mm²/N] with its standard uncertainty, None where that of the volume is unknown."""
    k = worn.volume / (load.value * distance.value)
    others = [k * (each.error or 0.0) / each.value for each in (load, distance)]
    return Value(k, None if worn.error is None else math.hypot(k * worn.error / worn.volume, *others))


def mean_of_places(volumes: Sequence[WornVolume]) -> WornVolume:
    """Make one volume of those that several places of one test came to."""
    if len(volumes) == 1:
        return volumes[0]
    mean = Scatter([each.volume for each in volumes], [each.error for each in volumes])
    return WornVolume(
        volume=mean.mean,
        error=mean.error,
        error_from="the larger of their scatter and their own errors",
        measured=f"mean of {len(volumes)} places of one test: {'; '.join(each.measured for each in volumes)}",
    )


def volume_given(volume: float, *, error: float | None = None) -> WornVolume:
    """Take a volume [mm³] as it was measured elsewhere, with its standard uncertainty [mm³] or None."""
    return WornVolume(volume=volume, measured=f"volume {volume:.6g} mm³", **_uncertainty(error, 1.0))


def cap(
    first: float, second: float | None = None, *, radius: float, error: float | None = None
) -> WornVolume:
    """Find the volume of a flat scar on a ball from one or two diameters across it; all lengths in mm.

    The rim's radius a is half the mean diameter, h = R − √(R² − a²) (thesis eq 3.1) and V = π h² (3R − h)/3,
    which is (π h/6)(3 d²/4 + h²) of ASTM G99 (spherical pin end, disc unworn) and of G133. Approximately
    π d⁴/(64 R). error: standard uncertainty of the mean diameter; without it half the difference of two
    different diameters, the standard error of their mean. It goes into V by dV/dd = (π/2) a³/√(R² − a²),
    nearly 4 V/d. Where one diameter is more than a tenth longer the groove of a disc that wears, too, bulges
    into the scar across the sliding, and π d₁³ d₂/(64 R) is better, d₂ the longer one (validation, a ball
    that wears with its plate): it is given beside. InputError for a scar wider than the ball.
    """
    other = first if second is None else second
    scar = cap_of_diagonals(first, other, radius=radius)
    source = "as given"
    if error is None and other != first:
        error, source = 0.5 * abs(first - other), "half the difference of the two diameters"
    diameters = f"{first:.5g} mm" if second is None else f"{first:.5g} and {second:.5g} mm"
    flat = radius * radius - scar.rim * scar.rim
    if error is not None and flat <= 0.0:
        raise InputError(f"a scar as wide as the ball, {2 * radius:g} mm, has no finite uncertainty")
    slope = 0.5 * math.pi * scar.rim**3 / math.sqrt(flat) if error is not None else 0.0
    short, long = sorted((first, other))
    return WornVolume(
        volume=scar.volume,
        **_uncertainty(error, slope, source=source),
        approximate=math.pi * (2.0 * scar.rim) ** 4 / (64.0 * radius),
        bulging=math.pi * short**3 * long / (64.0 * radius) if long > LONGER * short else None,
        depth=scar.height,
        measured=f"diameter {diameters}",
    )


def circular_track(
    width: float, *, radius: float, track_radius: float, error: float | None = None
) -> WornVolume:
    """Find the volume of a circular track that an unworn ball cut into a disc; all lengths in mm.

    ASTM G99: V = 2π R_t [r² asin(d/2r) − (d/4) √(4r² − d²)], approximately π R_t d³/(6r). error: standard
    uncertainty of the width, by dA/dd = d²/(2 √(4r² − d²)). InputError for a track wider than the ball, or
    than the circle it runs on.
    """
    if width >= 2.0 * radius:
        raise InputError(f"width is {width:g} mm: allowed is below the ball's diameter, {2 * radius:g} mm")
    if width > 2.0 * track_radius:
        raise InputError(f"width is {width:g} mm: allowed is up to the track's, {2 * track_radius:g} mm")
    around = 2.0 * math.pi * track_radius
    # √(4r² − d²) of lengths whose squares may overflow or cancel
    chord = math.sqrt(2.0 * radius - width) * math.sqrt(2.0 * radius + width)
    return WornVolume(
        volume=around * segment(width, radius=radius),
        **_uncertainty(error, around * 0.5 * width**2 / chord),
        approximate=math.pi * track_radius * width**3 / (6.0 * radius),
        depth=width**2 / (4.0 * radius + 2.0 * chord),
        measured=f"width {width:.5g} mm",
    )


def groove(section: float, *, track_length: float, error: float | None = None) -> WornVolume:
    """Find the volume of a straight groove, section [mm²] × length [mm] (ASTM G133: mean section × stroke).

    error: standard uncertainty of the section [mm²]. The ends, where the ball turns, are not in it.
    """
    return WornVolume(
        volume=section * track_length,
        **_uncertainty(error, track_length),
        measured=f"section {1e6 * section:.6g} µm² × {track_length:g} mm",
    )


def segment(width: float, *, radius: float) -> float:
    """Find the area [mm²] of the segment that a chord of a width [mm] cuts off a circle of a radius [mm]."""
    angle = 2.0 * math.asin(width / (2.0 * radius))
    if angle < SMALL_ANGLE:
        excess = angle**3 / 6.0 * (1.0 - angle**2 / 20.0 * (1.0 - angle**2 / 42.0))
    else:
        excess = angle - math.sin(angle)
    return 0.5 * radius * radius * excess


def _uncertainty(error: float | None, slope: float, *, source: str = "as given") -> dict[str, Any]:
    """Return the uncertainty of a worn volume, and where it is from, as fields of `WornVolume`.

    error: of what was measured, None where unknown; slope: of the volume over it. Raises InputError.
    """
    return {} if error is None else {"error": slope * error, "error_from": source}
