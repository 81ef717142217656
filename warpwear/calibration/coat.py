"""Wear coefficients of a coat and of what lies beneath, from craters or tracks that reach through it.

What coat and substrate lose adds up: F L = V_c/K_c + V_s/K_s, so that F L/V_c over V_s/V_c is a straight line
(Rutherford and Hutchings, Journal of Testing and Evaluation 25 (1997) 250).
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from warpwear.calibration.measurements import MeasuredTest, Tests, checked_tests
from warpwear.calibration.wear import cap
from warpwear.errors import InputError, named_in_python
from warpwear.figures import describe
from warpwear.figures.describe import DOT, Axis, Chart, Line, Look
from warpwear.grid import FloatArray
from warpwear.measured.report import Report
from warpwear.results.report import Row, scientific

#: Places of the posterior along each of its axes, and how far they reach [standard deviations].
PLACES, REACH = 201, 6.0
#: Condition number of both volumes above which craters do not tell coat and substrate apart.
HOPELESS = 1000.0
#: Fewest craters: two unknowns, and one that tells how they scatter.
FEWEST = 3


class Coefficient(NamedTuple):
    """Hold a wear coefficient [mm²/N]: its median, and the ends of its interval of 90 %."""

    median: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True, repr=False)
class CoatCalibration(Report):
    """Hold wear coefficients of a coat and of the substrate beneath.

    Attributes
    ----------
    coat, substrate : Coefficient
        K [mm²/N] (1e-3 mm³/(N·m)) as median, 5th and 95th percentile.
    work : array
        F L of each crater [N·mm], shape (craters,).
    volumes : array
        Worn of coat and substrate [mm³], shape (2, craters).
    birge : float
        How many times as much the craters scatter as their uncertainties say, which are widened by that.
    """

    coat: Coefficient
    substrate: Coefficient
    work: FloatArray
    volumes: FloatArray
    birge: float

    def _title(self) -> str:
        both = (f"{scientific(1e3 * k.median)} mm³/(N·m)" for k in (self.coat, self.substrate))
        return "wear coefficients of coat {} and substrate {}".format(*both)

    def _rows(self) -> list[Row]:
        rows = []
        for name, k in (("coat", self.coat), ("substrate", self.substrate)):
            low, high = 1e3 * k.low, 1e3 * k.high
            note = f"(median; 90 %: {scientific(low, digits=3)} to {scientific(high, digits=3)})"
            rows.append(Row(name, f"{name}_mm3_per_Nm", 1e3 * k.median, note=note, scientific=True))
            rows += [Row("", f"{name}_low_mm3_per_Nm", low), Row("", f"{name}_high_mm3_per_Nm", high)]
        scatter = "times as much as their uncertainties say; these are widened only where it exceeds 1"
        wear = [f"{scientific(1e3 * k.median)} mm^3/N/m" for k in (self.coat, self.substrate)]
        keys = '[[disc.layers]] wear = "{}"; [wear] disc = "{}"'.format(*wear)
        rows.append(Row("craters scatter", "birge_ratio", self.birge, digits=2, note=scatter))
        return [*rows, Row("in a study", "", keys), Row("", "craters", self._table())]

    def _table(self) -> list[list[Row]]:
        return [
            [
                Row("crater", "work_Nm", 1e-3 * float(work), unit="N·m"),
                Row("  of coat", "coat_volume_mm3", float(coat)),
                Row("  of substrate", "substrate_volume_mm3", float(substrate)),
            ]
            for work, coat, substrate in zip(self.work, *self.volumes, strict=True)
        ]

    def _declared(self) -> describe.Figure:
        """Declare F L/V_c of the craters over V_s/V_c, on the line of both medians."""
        coat, substrate = self.volumes
        ratio, across = substrate / coat, np.array([0.0, 1.05 * float((substrate / coat).max())])
        line = 1e-3 * (1.0 / self.coat.median + across / self.substrate.median)
        lines = [Line(ratio, 1e-3 * self.work / coat, "craters", DOT)]
        lines.append(Line(across, line, "by both K", Look(describe.CONTACT)))
        across_axis = Axis("volumes of substrate and coat, V_s/V_c", low=0.0)
        chart = Chart("", across_axis, Axis("F L/V_c, N·m/mm³", low=0.0), lines)
        return describe.Figure([chart], legend=2)


@named_in_python()
def calibrate_coat(tests: Tests, **alike: Any) -> CoatCalibration:
    """Find the wear coefficients of a coat and of what lies beneath from several craters or tracks.

    Parameters
    ----------
    tests : list of dict, or path
        One a crater: load, distance, and with their uncertainties ``volume_coat`` and ``volume_substrate``,
        or ``crater``, the diameters of the crater and of the substrate in it, with the ``radius`` of the
        ball. A path is that of a TOML file with such tables ``[[test]]``.
    **alike
        Keys that all have alike, such as ``load="0.4 N"``.

    Returns
    -------
    CoatCalibration
        Both coefficients with intervals of 90 %: their posterior under priors that are flat in log K.

    Raises
    ------
    InputError
        For fewer than three craters, and for such as do not tell coat and substrate apart.

    References
    ----------
    K. L. Rutherford and I. M. Hutchings, Theory and application of a micro-scale abrasive wear test, Journal
    of Testing and Evaluation 25 (1997) 250-260.

    Examples
    --------
    >>> diameters = ("0.9 +- 0.01 mm", "0.5 +- 0.01 mm"), ("1.1 +- 0.01 mm", "0.8 +- 0.01 mm")
    >>> deeper = ("1.3 +- 0.01 mm", "1.06 +- 0.01 mm")
    >>> distances = ("20 m", "40 m", "75 m")
    >>> tests = [{"crater": d, "distance": s} for d, s in zip((*diameters, deeper), distances)]
    >>> warpwear.calibrate_coat(tests, load="0.4 N", radius="12.5 mm")
    <wear coefficients of coat 3.130e-4 mm³/(N·m) and substrate 5.203e-4 mm³/(N·m)>
    """
    craters = [_crater(test, named) for named, test in checked_tests(tests, **alike).items()]
    if len(craters) < FEWEST:
        raise InputError(f"two coefficients need {FEWEST} craters at least; given: {len(craters)}")
    work, error, coat, substrate, *spread = np.array(craters).T
    both = np.column_stack([coat, substrate])
    if not both.any(axis=0).all() or np.linalg.cond(both / np.linalg.norm(both, axis=0)) > HOPELESS:
        raise InputError("the craters do not tell coat and substrate apart: some have to reach deeper")
    medians, birge = _posterior(work, error, both, spread)
    volumes = np.array([coat, substrate])
    return CoatCalibration(coat=medians[0], substrate=medians[1], work=work, volumes=volumes, birge=birge)


def _crater(test: MeasuredTest, named: str) -> tuple[float, ...]:
    """Return F L and its error, volumes of coat and substrate, their variances and their covariance."""
    if test.load is None or test.distance is None:
        raise InputError(f"{named} needs load and distance, such as '0.4 N' and '20 m'")
    work = test.load.value * test.distance.value
    error = work * math.hypot(*((v.error or 0.0) / v.value for v in (test.load, test.distance)))
    if test.crater is None:
        coat, substrate = test.volume_coat, test.volume_substrate
        if coat is None or not coat.error or (substrate is not None and not substrate.error):
            what = "volume_coat and volume_substrate, each such as '0.018 +- 0.001 mm^3'"
            raise InputError(f"{named} needs a crater, or {what}")
        below = (0.0, 0.0) if substrate is None else (substrate.value, (substrate.error or 0.0) ** 2)
        return work, error, coat.value, below[0], coat.error**2, below[1], 0.0
    if test.radius is None or not all(size.error for size in test.crater):
        raise InputError(f"{named}.crater needs {named}.radius, and diameters such as '0.80 +- 0.01 mm'")
    whole, *below_too = (cap(size.value, radius=test.radius, error=size.error) for size in test.crater)
    inner, square = (below_too[0].volume, (below_too[0].error or 0.0) ** 2) if below_too else (0.0, 0.0)
    if not 0.0 <= inner < whole.volume:
        raise InputError(f"{named}.crater is the diameter of the crater, and then that of the substrate")
    return work, error, whole.volume - inner, inner, (whole.error or 0.0) ** 2 + square, square, -square


def _posterior(
    work: FloatArray, error: FloatArray, both: FloatArray, spread: list[FloatArray]
) -> tuple[list[Coefficient], float]:
    """Return both coefficients, and Birge's ratio. both: (craters, 2); spread: variances and covariance.

    Volumes have errors, which the slopes 1/K of F L over them carry into the misfit.
    """

    def variance(slopes: FloatArray) -> FloatArray:
        p, q = slopes[..., :1], slopes[..., 1:]
        return np.asarray(error**2 + p**2 * spread[0] + q**2 * spread[1] + 2.0 * p * q * spread[2])

    start = np.linalg.lstsq(both / work[:, None], np.ones(work.size), rcond=None)[0]
    slopes: FloatArray = np.asarray(start, dtype=np.float64)
    for _ in range(50):
        normal = both.T @ (both / variance(slopes)[:, None])
        slopes = np.asarray(np.linalg.solve(normal, both.T @ (work / variance(slopes))))
    if not (slopes > 0.0).all():
        raise InputError("the craters ask for a K below 0: they do not follow F L = V_c/K_c + V_s/K_s")
    ratio = float(np.sqrt(np.sum((work - both @ slopes) ** 2 / variance(slopes)) / (work.size - 2)))
    wider = max(1.0, ratio)
    root = wider * np.linalg.cholesky(np.linalg.inv(normal))
    places = np.stack(np.meshgrid(*[np.linspace(-REACH, REACH, PLACES)] * 2), axis=-1).reshape(-1, 2)
    tried = slopes + places @ root.T
    tried = tried[(tried > 0.0).all(axis=1)]
    square = wider**2 * variance(tried)
    logs = -0.5 * np.sum((work - tried @ both.T) ** 2 / square + np.log(square), axis=1)
    logs -= np.log(tried).sum(axis=1)
    weights = np.exp(logs - logs.max())
    coefficients = []
    for column in 1.0 / tried.T:
        order = np.argsort(column)
        part = np.cumsum(weights[order]) / weights.sum()
        median, low, high = np.interp([0.5, 0.05, 0.95], part, column[order]).tolist()
        coefficients.append(Coefficient(median, low, high))
    return coefficients, ratio
