"""Roughness parameters of a field of heights."""

import math
from dataclasses import dataclass

import numpy as np

from warpwear.surfaces.base import FloatArray
from warpwear.surfaces.filtering import low_pass

#: λc [mm] of ISO 3274, largest first, and the λs [mm] that belongs to each.
CUT_OFFS = {8.0: 0.025, 2.5: 0.008, 0.8: 0.0025, 0.25: 0.0025, 0.08: 0.0025}
LEAST_SAMPLING_LENGTHS = 2  # five are usual; with fewer than two λc is reduced


def slope_along(heights: FloatArray, *, pixel: tuple[float, float], axis: int) -> float:
    """Root mean square slope [-] along one axis by forward differences; see `rms_slope`."""
    return math.sqrt(float(np.mean(np.square(np.diff(heights, axis=axis))))) / pixel[axis]


@dataclass(frozen=True)
class ProfileRoughness:
    """Ra [mm] of profiles along one axis: mean and standard deviation over them, and their number.

    cut_off, short: λc and λs used [mm], None where not filtered; notes: why they are not those asked for.
    """

    ra: float
    scatter: float
    profiles: int
    cut_off: float | None
    short: float | None
    notes: tuple[str, ...]


def rms_slope(heights: FloatArray, *, pixel: tuple[float, float]) -> float:
    """Root mean square gradient [-] by forward differences.

    heights [mm], shape (nx, ny), complete; pixel (px, py) [mm]. ISO 25178-2 calls it Sdq. A difference
    over a pixel is blind to waves near two pixels, so the value grows with finer pixels until the shortest
    waves of the surface are resolved.
    """
    along = (
        float(np.mean(np.square(np.diff(heights, axis=0)))) / pixel[0] ** 2 if heights.shape[0] > 1 else 0.0
    )
    across = (
        float(np.mean(np.square(np.diff(heights, axis=1)))) / pixel[1] ** 2 if heights.shape[1] > 1 else 0.0
    )
    return math.sqrt(along + across)


def roughness(heights: FloatArray, *, pixel: tuple[float, float]) -> dict[str, float]:
    """Height parameters of ISO 25178-2 about the mean height, and the rms slope.

    heights [mm], shape (nx, ny), complete (no NaN), already levelled; pixel (px, py) [mm]. Keys: those of
    `height_parameters` and ``rms_slope`` [-].
    """
    return height_parameters(heights) | {"rms_slope": rms_slope(heights, pixel=pixel)}


def height_parameters(heights: FloatArray) -> dict[str, float]:
    """Height parameters of ISO 25178-2 about the mean height.

    heights [mm], any shape, complete, levelled. Keys: ``sa``, ``sq``, ``sz`` (highest minus lowest) [mm];
    ``ssk``, ``sku`` (skewness and kurtosis, 0 and 3 for Gaussian heights; both 0 for a flat).
    """
    centred = heights - heights.mean()
    power = np.square(centred)
    variance = float(power.mean())
    flat = variance == 0.0
    return {
        "sa": float(np.abs(centred).mean()),
        "sq": math.sqrt(variance),
        "sz": float(centred.max() - centred.min()),
        "ssk": 0.0 if flat else float((power * centred).mean()) / variance**1.5,
        "sku": 0.0 if flat else float(np.square(power).mean()) / variance**2,
    }


def profile_roughness(
    heights: FloatArray, *, pixel: tuple[float, float], axis: int, cut_off: float, short: float
) -> ProfileRoughness:
    """Ra (ISO 21920-2, formerly ISO 4287) of every profile along an axis.

    heights [mm], shape (nx, ny), complete, levelled; cut_off and short: λc and λs [mm] of the Gaussian
    profile filters (ISO 16610-21), mirrored at the ends, so that whole profiles are evaluated. Where λc
    leaves fewer than two sampling lengths, the next λc of ISO 3274 that does not is used, with its λs; λs is
    left out where a wave of it has fewer than two pixels.
    """
    length = heights.shape[axis] * pixel[axis]
    notes = []
    used: float | None = cut_off
    asked = cut_off
    if length < LEAST_SAMPLING_LENGTHS * cut_off:
        smaller = [c for c in CUT_OFFS if c < cut_off and LEAST_SAMPLING_LENGTHS * c <= length]
        used = smaller[0] if smaller else None
        if used is None:
            short = min(short, min(CUT_OFFS.values()))
            notes.append(f"no λc: profiles of {length:.3g} mm are too short for any of ISO 3274")
        else:
            short = min(short, CUT_OFFS[used])
            notes.append(f"λc reduced from {asked:g} to {used:g} mm: profiles are {length:.3g} mm long")
    if used is not None and length < 4.999 * used:
        notes.append(f"{length / used:.2g} sampling lengths instead of 5")
    smooth = short >= 2.0 * pixel[axis]
    if not smooth:
        notes.append(f"no λs: {1e3 * short:g} µm is shorter than two pixels")
    rough = low_pass(heights, axis=axis, pixel=pixel[axis], cut_off=short) if smooth else heights
    if used is not None:
        rough = rough - low_pass(heights, axis=axis, pixel=pixel[axis], cut_off=used)
    values = np.abs(rough - rough.mean(axis=axis, keepdims=True)).mean(axis=axis)
    return ProfileRoughness(
        ra=float(values.mean()),
        scatter=float(values.std()),
        profiles=values.size,
        cut_off=used,
        short=short if smooth else None,
        notes=tuple(notes),
    )
