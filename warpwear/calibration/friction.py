"""Shear strength and ploughing offset from a measured coefficient of friction and a run's areas.

μ(L) = μ_p + τ0 A(L)/F (thesis eq 4.18 with the offset of eq 2.8) is linear in both unknowns: least squares.
"""

import math
from dataclasses import dataclass

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
    of a constant coefficient. effective_points: how many independent ones scatter as much.
    """

    shear_strength: float
    shear_strength_error: float
    rms: float
    r_squared: float | None
    effective_points: float


@dataclass(frozen=True, kw_only=True)
class FrictionFit(ShearFit):
    """Hold τ0 [MPa] and μ_p with their standard errors, and how well they fit.

    The errors allow for points that scatter together: they are those of `effective_points` ones.
    first, last: distances used [mm]; points used, and left_out beyond the run's distances. condition:
    condition index of the two unknowns; area_variation: standard deviation over mean of the areas used.
    """

    ploughing: float
    ploughing_error: float
    first: float
    last: float
    points: int
    left_out: int
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
    distance: FloatArray, cof: FloatArray, *, run_distance: FloatArray, run_area: FloatArray, load: float
) -> FrictionFit:
    """Fit a measured coefficient over a run's area by least squares, the area interpolated at its distances.

    distance [mm], cof: measured, (n,); run_distance [mm], run_area [mm²]: a run's history, (m,); distances
    rise; load [N]. Points before the run's first step or beyond its end are left out. Errors are those of
    least squares times √(n/n_eff), n_eff from the residuals' autocorrelation summed to its first zero.
    InputError for too few points in the run's range, or areas that hardly vary.
    """
    used = (distance >= run_distance[0]) & (distance <= run_distance[-1])
    count = int(used.sum())
    if count < FEWEST:
        raise InputError(
            f"{count} measured points lie within the run's distances, {run_distance[0]:g} to "
            f"{run_distance[-1]:g} mm: at least {FEWEST} are needed"
        )
    where, measured = distance[used], cof[used]
    area_over_load = np.interp(where, run_distance, run_area) / load
    mean = float(area_over_load.mean())
    varying = area_over_load - mean
    spread = math.sqrt(_product(varying, varying) / count) / mean
    # of the columns 1 and A/F, each scaled to length 1
    condition = (1.0 + math.hypot(1.0, spread)) / spread if spread else math.inf
    if condition > HOPELESS:
        raise InputError(
            f"the area varies by {spread:.1g} of its mean over {where[0]:g} to {where[-1]:g} mm: τ0 and μ_p "
            "cannot be told apart; --cof with --ploughing fixes both instead"
        )
    shear = _slope(varying, measured - measured.mean(), unknowns=2)
    return FrictionFit(
        **vars(shear),
        ploughing=float(measured.mean()) - shear.shear_strength * mean,
        ploughing_error=shear.shear_strength_error * math.hypot(spread * mean, mean),
        first=float(where[0]),
        last=float(where[-1]),
        points=count,
        left_out=int(distance.size) - count,
        condition=condition,
        area_variation=spread,
        without_ploughing=_slope(area_over_load, measured, unknowns=1),
    )


def _slope(column: FloatArray, measured: FloatArray, *, unknowns: int) -> ShearFit:
    """Fit τ0, of so many unknowns. column: A/F [mm²/N], measured: coefficient, (n,), of two without means."""
    square, about_mean = _product(column, column), measured - measured.mean()
    slope = _product(column, measured) / square
    residual = measured - slope * column
    count, left, total = measured.size, _product(residual, residual), _product(about_mean, about_mean)
    effective = effective_points(residual)
    return ShearFit(
        shear_strength=slope,
        shear_strength_error=math.sqrt(left / (count - unknowns) * count / effective / square),
        rms=math.sqrt(left / count),
        r_squared=1.0 - left / total if total else None,
        effective_points=effective,
    )


def _within(value: float, error: float) -> str:
    """Say whether a value is within its error of 0."""
    return " (within two standard errors of 0)" if abs(value) < 2.0 * error else ""


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
    return max(count / (1.0 + 2.0 * float(correlation[: ends[0] if ends.size else None].sum())), 1.0)
