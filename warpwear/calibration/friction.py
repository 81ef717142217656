"""Shear strength and ploughing offset from a measured coefficient of friction and a run's areas.

μ(L) = μ_p + τ0 A(L)/F (thesis eq 4.18 with the offset of eq 2.8) is linear in both unknowns: least squares.
"""

import math
from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.results.formats.forms import filled

special = lazy.module("scipy.special")

#: Condition index from which two unknowns are poorly told apart (Belsley, Kuh and Welsch, Regression
#: Diagnostics, 1980, section 3.2).
POOR = 30.0
#: Condition index from which they are not told apart at all.
HOPELESS = 1000.0
#: Fewest points of a fit.
FEWEST = 3
#: Residuals of coefficients below this are rounding, which goes together too.
ROUNDING = 1e-9
#: Part of the test over which residuals go together from where on the computed course has another shape.
OTHER_SHAPE = 0.5
#: Points of a course for its errors, by means of neighbours.
POINTS = 100
#: Lengths over which residuals may go together, and parts of their variance that do not; none is no matrix.
LENGTHS, ALONE = 24, (1e-9, 0.1, 0.3, 0.6)
#: Probability below one standard deviation.
BELOW = 0.8413


@dataclass(frozen=True, kw_only=True)
class ShearFit:
    """Hold τ0 [MPa] with its standard error, and how well it fits; alone, with μ_p = 0, or beside μ_p.

    rms: of the residuals. r_squared compares with the mean coefficient, and may be negative of τ0 alone; None
    of a constant coefficient. effective_points: how many independent ones tell τ0 as well. length: distance
    [mm] over which residuals go together, times the part of their variance that does.
    """

    shear_strength: float
    shear_strength_error: float
    rms: float
    r_squared: float | None
    effective_points: float
    length: float


@dataclass(frozen=True, kw_only=True)
class FrictionFit(ShearFit):
    """Hold τ0 [MPa] and μ_p with their standard errors, and how well they fit.

    The errors allow for points that go together: they hold as often as those of independent ones.
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
        together = self.length > OTHER_SHAPE * self.last and self.points >= 20 and self.rms > ROUNDING
        text = filled("fit.txt", escape=False, fit=self, poor=POOR, together=together)
        return tuple(text.splitlines())


def fit_friction(
    distance: FloatArray, cof: FloatArray, *, run_distance: FloatArray, run_area: FloatArray, load: float
) -> FrictionFit:
    """Fit a measured coefficient over a run's area by least squares, the area interpolated at its distances.

    distance [mm], cof: measured, (n,); run_distance [mm], run_area [mm²]: a run's history, (m,); distances
    rise; load [N]. Points before the run's first step or beyond its end are left out. Errors are those of
    least squares with residuals that go together over the likeliest length, a part of them on its own.
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
    shear, error = _slope(where, varying, measured, np.column_stack([area_over_load, np.ones(count)]))
    return FrictionFit(
        **vars(shear),
        ploughing=float(measured.mean()) - shear.shear_strength * mean,
        ploughing_error=error,
        first=float(where[0]),
        last=float(where[-1]),
        points=count,
        left_out=int(distance.size) - count,
        condition=condition,
        area_variation=spread,
        without_ploughing=_slope(where, area_over_load, measured, area_over_load[:, None])[0],
    )


def _slope(
    where: FloatArray, column: FloatArray, measured: FloatArray, design: FloatArray
) -> tuple[ShearFit, float]:
    """Fit τ0, and give the error of the last unknown.

    column: A/F [mm²/N], of two unknowns less its mean, measured: coefficient, (n,); design: (n, unknowns).
    """
    count, unknowns = design.shape
    square, about_mean = _product(column, column), measured - measured.mean()
    slope = _product(column, measured) / square
    residual = measured - slope * column - (measured.mean() if unknowns > 1 else 0.0)
    left, total = _product(residual, residual), _product(about_mean, about_mean)
    errors, length = _errors(where, design, measured)
    independent = left / (count - unknowns) / square
    effective = min(count * independent / errors[0] ** 2, count) if left else count
    fit = ShearFit(
        shear_strength=slope,
        shear_strength_error=float(errors[0]),
        rms=math.sqrt(left / count),
        r_squared=1.0 - left / total if total else None,
        effective_points=float(max(effective, 1.0)),
        length=length,
    )
    return fit, float(errors[-1])


def _errors(where: FloatArray, design: FloatArray, measured: FloatArray) -> tuple[FloatArray, float]:
    """Return standard errors of least squares, (unknowns,), and how far residuals go together.

    That length, and the part on its own, have the largest restricted likelihood (Patterson and Thompson,
    Biometrika 58, 1971, 545); the freedom is Satterthwaite's (Biometrics 2, 1946, 110), and the errors hold
    as often as those of normal residuals whose deviation is known. design: (n, unknowns).
    """
    table = np.column_stack([where, design, measured])
    table = np.array([block.mean(axis=0) for block in np.array_split(table, min(POINTS, len(table)))])
    where, design, (count, unknowns) = table[:, 0], table[:, 1:-1], table[:, 1:-1].shape
    lengths = np.geomspace(0.2 * (where[-1] - where[0]) / (count - 1), where[-1], LENGTHS)
    alone = np.array(ALONE)[:, None, None, None]
    noise = (1.0 - alone) * together(where, lengths[:, None, None]) + alone * np.eye(count)
    roots = np.linalg.cholesky(noise.reshape(-1, count, count))
    triangles = np.asarray(np.linalg.qr(np.linalg.solve(roots, table[:, 1:]), mode="r"))
    sizes = np.log(np.abs(np.diagonal(triangles, axis1=1, axis2=2)) + 1e-300)
    likely = -np.log(np.diagonal(roots, axis1=1, axis2=2)).sum(axis=1) - sizes[:, :unknowns].sum(axis=1)
    best = int(np.argmax(likely - (count - unknowns) * sizes[:, unknowns]))
    left = roots[best] - design @ (inverse := np.linalg.pinv(design)) @ roots[best]
    freedom = (left**2).sum() ** 2 / ((left.T @ left) ** 2).sum()
    spread = inverse @ roots[best] * triangles[best, -1, -1] * special.stdtrit(freedom, BELOW)
    length = ((1.0 - alone) * lengths[:, None, None]).ravel()[best]
    return np.sqrt((spread**2).sum(axis=1) / (count - unknowns)), float(length)


def _product(one: FloatArray, other: FloatArray) -> float:
    """Add up products in one order, as a dot product of BLAS, shared among threads, does not."""
    return float((one * other).sum())


def together(distance: FloatArray, length: FloatArray) -> FloatArray:
    """Correlate points of a course that go together over lengths (…, 1, 1): (…, points, points)."""
    return np.exp(-np.abs(distance[:, None] - distance) / length)
