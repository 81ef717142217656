"""Shear strength and ploughing offset from a measured coefficient of friction and a run's areas.

μ(L) = μ_p + τ0 A(L)/F (thesis eq 4.18 with the offset of eq 2.8) is linear in both unknowns: least squares.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray

#: Condition index from which two unknowns are poorly told apart (Belsley, Kuh and Welsch, Regression
#: Diagnostics, 1980, section 3.2).
POOR = 30.0
#: Condition index from which they are not told apart at all.
HOPELESS = 1000.0
#: Fewest points of a fit.
FEWEST = 3
#: Residuals of coefficients below this are rounding, which goes together too.
ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class ShearFit:
    """Hold τ0 [MPa] with its standard error, and how well it fits; alone, with μ_p = 0, or beside μ_p.

    rms: of the residuals. r_squared compares with the mean coefficient, and may be negative of τ0 alone; None
    of a constant coefficient.
    """

    shear_strength: float
    shear_strength_error: float
    rms: float
    r_squared: float | None


@dataclass(frozen=True, kw_only=True)
class FrictionFit(ShearFit):
    """Hold τ0 [MPa] and μ_p with their standard errors, and how well they fit.

    The errors allow for points that scatter together: they are those of `effective_points` independent ones.
    first, last: distances used [mm]; points used, and left_out beyond the run's distances. condition:
    condition index of the two unknowns; area_variation: standard deviation over mean of the areas used.
    """

    ploughing: float
    ploughing_error: float
    first: float
    last: float
    points: int
    left_out: int
    effective_points: float
    condition: float
    area_variation: float
    without_ploughing: ShearFit

    @property
    def doubts(self) -> tuple[str, ...]:
        """Sentences that say why not to trust the fit; none where nothing speaks against it."""
        lines = []
        if self.condition > POOR:
            lines.append(
                f"the areas vary by {self.area_variation:.2g} of their mean only (condition index "
                f"{self.condition:.0f}, above {POOR:.0f}): τ0 and μ_p are poorly told apart"
            )
        if self.ploughing < 0.0:
            lines.append(
                f"μ_p is negative{_within(self.ploughing, self.ploughing_error)}, which no ploughing is: the "
                "coefficient grows faster than in proportion to this area; the fit with μ_p = 0 is given too"
            )
        if self.shear_strength < 0.0:
            lines.append(
                f"τ0 is negative{_within(self.shear_strength, self.shear_strength_error)}: a coefficient "
                "that falls while this area grows follows no constant shear strength of it"
            )
        if self.effective_points < 10.0 and self.points >= 20 and self.rms > ROUNDING:
            lines.append(
                f"the residuals go together over long distances ({self.effective_points:.2g} independent of "
                f"{self.points} points): the curve has another shape than the area's"
            )
        return tuple(lines)


def fit_friction(
    distance: FloatArray,
    cof: FloatArray,
    *,
    run_distance: FloatArray,
    run_area: FloatArray,
    load: float,
) -> FrictionFit:
    """Fit a measured coefficient over a run's area by least squares, the area interpolated at its distances.

    distance [mm], cof: measured, (n,); run_distance [mm], rising, run_area [mm²]: a run's history, (m,);
    load [N]. Points before the run's first step or beyond its end are left out. Errors are those of least
    squares times √(n/n_eff), n_eff from the residuals' autocorrelation summed to its first zero.
    InputError for values that are no numbers, too few points in the run's range, or areas that hardly vary.
    """
    distance, cof = np.asarray(distance, dtype=np.float64), np.asarray(cof, dtype=np.float64)
    if distance.ndim != 1 or distance.shape != cof.shape:
        raise InputError(
            f"measured distances and coefficients have shapes {distance.shape} and {cof.shape}: one "
            "coefficient a distance is needed"
        )
    bad = int((~(np.isfinite(distance) & np.isfinite(cof))).sum())
    if bad:
        raise InputError(f"the measured curve has {bad} points that are no finite numbers: allowed are none")
    if not 0.0 < load < math.inf:
        raise InputError(f"load is {load:g} N: allowed is any positive number")
    used = (distance >= run_distance[0]) & (distance <= run_distance[-1])
    count = int(used.sum())
    if count < FEWEST:
        raise InputError(
            f"{count} measured points lie within the run's distances, {run_distance[0]:g} to "
            f"{run_distance[-1]:g} mm: at least {FEWEST} are needed"
        )
    order = np.argsort(distance[used], kind="stable")
    where, measured = distance[used][order], cof[used][order]
    area_over_load = np.interp(where, run_distance, run_area) / load
    mean = float(area_over_load.mean())
    varying = area_over_load - mean
    scatter = _product(varying, varying)
    spread = math.sqrt(scatter / count) / mean
    condition = _condition(spread)
    if condition > HOPELESS:
        raise InputError(
            f"the area varies by {spread:.1g} of its mean over {where[0]:g} to {where[-1]:g} mm: τ0 and μ_p "
            "cannot be told apart; --cof with --ploughing fixes both instead"
        )
    slope = _product(varying, measured - measured.mean()) / scatter
    offset = float(measured.mean()) - slope * mean
    residual = measured - offset - slope * area_over_load
    effective = effective_points(residual)
    deviation = math.sqrt(_product(residual, residual) / (count - 2) * count / effective)
    return FrictionFit(
        shear_strength=slope,
        shear_strength_error=deviation / math.sqrt(scatter),
        ploughing=offset,
        ploughing_error=deviation * math.sqrt(1.0 / count + mean**2 / scatter),
        **_quality(residual, measured),
        first=float(where[0]),
        last=float(where[-1]),
        points=count,
        left_out=int(distance.size) - count,
        effective_points=effective,
        condition=condition,
        area_variation=spread,
        without_ploughing=_shear_alone(area_over_load, measured),
    )


def _shear_alone(area_over_load: FloatArray, measured: FloatArray) -> ShearFit:
    """Fit τ0 alone. area_over_load: A/F [mm²/N], measured: coefficient, both (n,)."""
    square = _product(area_over_load, area_over_load)
    slope = _product(area_over_load, measured) / square
    residual = measured - slope * area_over_load
    count, effective = measured.size, effective_points(residual)
    variance = _product(residual, residual) / (count - 1) * count / effective
    error = math.sqrt(variance / square)
    return ShearFit(shear_strength=slope, shear_strength_error=error, **_quality(residual, measured))


def _within(value: float, error: float) -> str:
    """Say whether a value is within its error of 0."""
    return " (within two standard errors of 0)" if abs(value) < 2.0 * error else ""


def _condition(spread: float) -> float:
    """Find the condition index of the columns 1 and A/F, each scaled to length 1.

    spread: standard deviation over mean of the area.

    Their product is cos = 1/√(1 + spread²), the singular values are √(1 ± cos).
    """
    cos = 1.0 / math.sqrt(1.0 + spread * spread)
    lack = spread * spread * cos / (math.sqrt(1.0 + spread * spread) + 1.0)  # 1 − cos, without cancelling
    return math.sqrt((1.0 + cos) / lack) if lack else math.inf


def _product(one: FloatArray, other: FloatArray) -> float:
    """Add up products in one order, as a dot product of BLAS, shared among threads, does not."""
    return float((one * other).sum())


def effective_points(residual: FloatArray) -> float:
    """Find how many independent points scatter as much: n/(1 + 2 Σ ρ_k), ρ up to its first zero."""
    count = residual.size
    power = _product(residual, residual)
    if power == 0.0:
        return float(count)
    length = 1 << (2 * count - 1).bit_length()
    correlation = np.fft.irfft(np.abs(np.fft.rfft(residual, length)) ** 2, length)[1:count] / power
    ends = np.flatnonzero(correlation <= 0.0)
    together = float(correlation[: ends[0] if ends.size else None].sum())
    return max(count / (1.0 + 2.0 * together), 1.0)


def _quality(residual: FloatArray, measured: FloatArray) -> dict[str, Any]:
    """Find rms and R² of residuals about a measured coefficient, both (n,), as fields of a fit."""
    about_mean = measured - measured.mean()
    total, left = _product(about_mean, about_mean), _product(residual, residual)
    return {"rms": math.sqrt(left / residual.size), "r_squared": 1.0 - left / total if total else None}
