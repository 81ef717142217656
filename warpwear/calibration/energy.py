"""Compute the dissipated energy ∫ μ F dL, frictional power and PV at one or several sliding speeds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpwear.calibration.measurements import Tests
from warpwear.calibration.repeated import CalibratedTests, each_test
from warpwear.errors import InputError, named_in_python
from warpwear.laws.archard import BODIES
from warpwear.measured.options import COF, Options, number, optional, quantity
from warpwear.measured.report import Report
from warpwear.result import Run, opened
from warpwear.results.report import Row, lines, table
from warpwear.study.units import several

#: Speeds that are shown where none is named.
SPEEDS = ("10 mm/min", "20 mm/min", "50 mm/min", "100 mm/min")
#: Key of a test -> option.
KEYS = {"friction": "cof", "load": "load", "distance": "distance"}


@dataclass(frozen=True, kw_only=True, repr=False)
class EnergyCalibration(Report):
    """Hold the energy that friction dissipates, which is the same at every speed.

    Attributes
    ----------
    energy, distance, load : float
        The energy [J] over a sliding distance [mm] under a load [N].
    cof_end : float
        Coefficient of friction at the end; `cof` is the mean over the distance.
    pressures : dict
        Name of an area -> mean pressure on it at the end [MPa].
    speeds : tuple of float
        Sliding speeds of the table [mm/s].
    wear_per_energy : dict
        Body -> worn volume of the energy [mm³/J]; empty without a run.
    source : str
        Where the coefficient is from.
    """

    energy: float
    distance: float
    load: float
    cof_end: float
    pressures: Mapping[str, float]
    speeds: Sequence[float] = ()
    wear_per_energy: Mapping[str, float] = field(default_factory=dict)
    source: str = ""

    @property
    def cof(self) -> float:
        """Coefficient of friction, mean over the distance."""
        return 1e3 * self.energy / (self.load * self.distance)

    @property
    def headline(self) -> Row:
        """Declare the energy."""
        return Row("energy", "energy_J", self.energy, digits=5)

    def _title(self) -> str:
        return f"dissipated energy ∫ μ F dL = {self.headline.text}"

    def _table(self) -> list[list[Row]]:
        return [self.at(speed) for speed in self.speeds]

    def _rows(self) -> list[Row]:
        worn, of = self.wear_per_energy, "of friction energy"
        cof = [Row("mean over the distance", "cof_mean", self.cof), Row("end", "cof_end", self.cof_end)]
        rate = "the energy is the same at every speed; only time, power and PV change with it"
        return [
            Row("source", "source", self.source),
            Row("", "energy_J", self.energy, digits=5),
            *([Row("worn volume", "wear_mm3_per_J", worn, unit="mm³/J", note=of)] if worn else ()),
            Row("distance", "distance_mm", self.distance, digits=6),
            Row("load", "load_N", self.load, digits=6),
            Row("coefficient", "", cof),
            Row("mean pressure", "pressure_MPa", self.pressures, note="at the end"),
            Row("rate-independent", "rate_independent", True, sentence=rate),
            Row("", "speeds", self._table()),
        ]

    def __str__(self) -> str:
        return "\n".join([self._title(), *lines(self._rows()[:-1]), *table(self._table())])

    def at(self, speed: float) -> list[Row]:
        """Declare what depends on the speed [mm/s], which the energy does not."""
        time, end = self.distance / speed, 1e-3 * self.cof_end * self.load * speed
        pv = {name: 1e-3 * pressure * speed for name, pressure in self.pressures.items()}
        return [
            Row("speed", "speed_mm_per_min", 60.0 * speed, digits=5),
            Row("time", "", time / 60.0, digits=5, unit="min"),
            Row("", "time_s", time),
            Row("mean power", "power_mean_W", self.energy * speed / self.distance),
            Row("power at the end", "power_end_W", end),
            Row("PV", "pv_MPa_m_per_s", pv),
        ]


@named_in_python()
def calibrate_energy(
    tests: Tests | None = None,
    *,
    result: Run | None = None,
    load: Any = None,
    distance: Any = None,
    cof: float | None = None,
    area: Any = None,
    speeds: Sequence[Any] = SPEEDS,
) -> EnergyCalibration | CalibratedTests:
    """Find the energy that friction dissipates in a run, or by a constant coefficient.

    Parameters
    ----------
    tests : list of dict, or path, optional
        One a test: ``friction``, such as ``"0.6 +- 0.02"``, with ``load`` and ``distance``. The keys are
        those of ``[[test]]``, which docs/reference/keys.md explains; a path is that of a TOML file with such
        a list, maybe in a study, whose load and distance hold.
    result : Result or path, optional
        A run, or its folder, or else:
    load, distance : str, optional
        Normal load and sliding distance, such as ``"8 N"`` and ``"2400 mm"``.
    cof : float, optional
        The constant coefficient of friction.
    area : str, optional
        Area of the mean pressure, such as ``"1.254 mm^2"``.
    speeds : list of str, optional
        Sliding speeds at which time, power and PV are told.

    Returns
    -------
    EnergyCalibration or CalibratedTests
        The energy, and a row a speed. Of a list of tests each, their mean and scatter.

    Raises
    ------
    InputError
        For what is missing or does not go together, and for a run that slides nowhere.

    Examples
    --------
    >>> warpwear.calibrate_energy(load="8 N", distance="2400 mm", cof=0.6)
    <dissipated energy ∫ μ F dL = 11.52 J>
    """
    o = Options(result=result, load=load, distance=distance, cof=cof, area=area)
    if tests is not None:
        return each_test(calibrate_energy, tests, KEYS, o | {"speeds": speeds})
    each = tuple(quantity("--speed", text, "mm/s") for text in several(speeds or SPEEDS))
    if result is not None:
        why = "and --result exclude each other: the run has its own"
        o.refuse("--load", "--distance", "--cof", "--area", why=why)
        return _of_run(result, each)
    force, slid = o.load, o.distance
    if cof is None:
        raise InputError("--cof is missing: the coefficient of friction, such as 0.6, or --result")
    mu, size = number("--cof", cof, COF), optional("--area", area, "mm^2")
    return EnergyCalibration(
        energy=1e-3 * mu * force * slid,
        distance=slid,
        load=force,
        cof_end=mu,
        pressures={} if size is None else {"given": force / size},
        speeds=each,
        source=f"a constant coefficient of {mu:g}",
    )


def _of_run(run: Run, speeds: Sequence[float]) -> EnergyCalibration:
    """Find what a run dissipates, and what it wears. Raises InputError."""
    with opened(run) as result:
        history, finished, folder = result.history, result.finished, result.name
    slid, cof = float(history["distance"][-1]), history["cof"]
    if slid == 0.0:
        raise InputError(f"{folder} is a static contact: nothing slides, and no energy is dissipated")
    if not np.isfinite(cof).all():
        raise InputError(f"{folder} has no coefficient of friction: it was stopped before its τ0 was fixed")
    load = float(history["load"][-1])
    energy = float(history["friction_energy"][-1])
    return EnergyCalibration(
        energy=energy,
        distance=slid,
        load=load,
        cof_end=float(cof[-1]),
        pressures={name: load / float(history[f"area_{name}"][-1]) for name in ("nominal", "contact")},
        speeds=speeds,
        wear_per_energy={body: float(history[f"wear_volume_{body}"][-1]) / energy for body in BODIES},
        source=f"the run {folder}, {'whole' if finished else 'interrupted'}",
    )
