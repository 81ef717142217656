"""The bearing area curve and its parameters."""

from dataclasses import dataclass

import numpy as np

from warpwear.surfaces.base import FloatArray

SECANT = 0.4  # of the material ratio, ISO 13565-2
STARTS = 2001  # of secants tried; the flattest is broad


@dataclass(frozen=True)
class Bearing:
    """Parameters of the bearing area curve: heights [mm], material ratios in percent.

    sk: core height; spk, svk: reduced peak height and valley depth; smr1, smr2: material ratios between which
    the core lies. top, bottom: heights of the equivalent line at 0 and 100 %.
    """

    sk: float
    spk: float
    svk: float
    smr1: float
    smr2: float
    top: float
    bottom: float


def material_ratio_curve(heights: FloatArray, *, points: int = 501) -> tuple[FloatArray, FloatArray]:
    """Material ratio [%] from 0 to 100 and the height [mm] reached by so much of the area: shape (points,).

    heights [mm], any shape, complete: highest at 0 %, lowest at 100 %.
    """
    falling = np.sort(heights, axis=None)[::-1]
    ratio = np.linspace(0.0, 100.0, points)
    return ratio, np.interp(ratio / 100.0, _ratios(falling.size), falling)


def bearing_parameters(heights: FloatArray) -> Bearing:
    """Sk, Spk, Svk, Smr1 and Smr2 of ISO 25178-2 (the construction of ISO 13565-2).

    heights [mm], any shape, complete, levelled. The equivalent line is that of least squares through the 40 %
    of the curve whose secant is flattest (the first, should there be several); it cuts the axes 0 and 100 %
    Sk apart. Spk and Svk are heights of the triangles over Smr1 and 100 % − Smr2 with the areas of the peaks
    above and valleys below the core. Meant for S-shaped curves: on a pure sine the flattest 40 % is an end.
    """
    falling = np.sort(heights, axis=None)[::-1]
    count = falling.size
    ratio = _ratios(count)
    start = np.linspace(0.0, 1.0 - SECANT, STARTS)
    drop = np.interp(start, ratio, falling) - np.interp(start + SECANT, ratio, falling)
    # equal to rounding counts as equal, or a straight curve would choose by chance
    first = int(np.argmax(drop <= drop.min() + 1e-9 * (falling[0] - falling[-1])))
    low, high = np.searchsorted(ratio, [start[first], start[first] + SECANT])
    core_ratio, core = ratio[low:high], falling[low:high]
    centred = core_ratio - core_ratio.mean()
    slope = float(centred @ core / (centred @ centred))
    top = float(core.mean() - slope * core_ratio.mean())
    bottom = top + slope
    peaks = int(np.searchsorted(-falling, -top))  # points above the core
    valleys = count - int(np.searchsorted(-falling, -bottom, side="right"))
    area_peaks = float((falling[:peaks] - top).sum()) / count
    area_valleys = float((bottom - falling[count - valleys :]).sum()) / count
    return Bearing(
        sk=top - bottom,
        spk=2.0 * area_peaks * count / peaks if peaks else 0.0,
        svk=2.0 * area_valleys * count / valleys if valleys else 0.0,
        smr1=100.0 * peaks / count,
        smr2=100.0 * (1.0 - valleys / count),
        top=top,
        bottom=bottom,
    )


def _ratios(count: int) -> FloatArray:
    return np.asarray((np.arange(count) + 0.5) / count)
