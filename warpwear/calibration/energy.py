"""Compute the dissipated energy ∫ μ F dL, frictional power and PV at one or several sliding speeds."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.laws.archard import BODIES
from warpwear.measured.options import COF, Options, number, quantity
from warpwear.result import Result
from warpwear.results.report import Row, lines, record, table, to_json

#: Speeds that are shown where none is named.
SPEEDS = ("10 mm/min", "20 mm/min", "50 mm/min", "100 mm/min")


@dataclass(frozen=True, kw_only=True)
class Dissipation:
    """An energy [J] that friction dissipates over a distance [mm] under a load [N].

    cof_end: coefficient at the end. pressures: name -> MPa, at the end.
    """

    energy: float
    distance: float
    load: float
    cof_end: float
    pressures: dict[str, float]

    @property
    def cof(self) -> float:
        """Coefficient of friction, mean over the distance."""
        return 1e3 * self.energy / (self.load * self.distance)

    @property
    def rows(self) -> list[Row]:
        """What holds at every speed, declared for a report."""
        cof = [Row("mean over the distance", "cof_mean", self.cof), Row("end", "cof_end", self.cof_end)]
        rate = "the energy is the same at every speed; only time, power and PV change with it"
        return [
            Row("distance", "distance_mm", self.distance, digits=6),
            Row("load", "load_N", self.load, digits=6),
            Row("coefficient", "", cof),
            Row("mean pressure", "pressure_MPa", self.pressures, note="at the end"),
            Row("rate-independent", "rate_independent", True, sentence=rate),
        ]

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


def calibrate_energy(*, as_json: bool = False, **options: Any) -> str:
    """Say what a run, or a constant coefficient, dissipates: as text for people, or as JSON.

    options: result, the run's folder, or load, distance, cof and area; speed, any number of them. Lengths,
    forces and speeds are texts with a unit. Raises InputError.
    """
    o = Options(options)
    speeds = [quantity("--speed", text, "mm/s") for text in o["--speed"] or SPEEDS]
    if o["--result"] is not None:
        why = "and --result exclude each other: the run has its own"
        o.refuse("--load", "--distance", "--cof", "--area", why=why)
        work, source, worn = _of_run(o["--result"])
    else:
        force, slid = o.load, o.distance
        if o["--cof"] is None:
            raise InputError("--cof is missing: the coefficient of friction, such as 0.6, or --result")
        mu = number("--cof", o["--cof"], COF)
        size = o.optional("--area", "mm^2")
        pressures = {} if size is None else {"given": force / size}
        energy = 1e-3 * mu * force * slid
        work = Dissipation(energy=energy, distance=slid, load=force, cof_end=mu, pressures=pressures)
        source, worn = f"a constant coefficient of {mu:g}", []
    in_joule = Row("", "energy_J", work.energy, digits=5)
    rows = [Row("source", "source", source), in_joule, *worn, *work.rows]
    at_speeds = [work.at(speed) for speed in speeds]
    if as_json:
        return to_json(record([*rows, Row("", "speeds", at_speeds)]))
    title = f"dissipated energy ∫ μ F dL = {in_joule.text}"
    return "\n".join([title, *lines(rows), *table(at_speeds)])


def _of_run(folder: Path) -> tuple[Dissipation, str, list[Row]]:
    """Find what a run dissipates, say where that is from, and what it wears. Raises InputError."""
    with Result.open(folder) as result:
        history, finished = result.history, result.finished
    slid, cof = float(history["distance"][-1]), history["cof"]
    if slid == 0.0:
        raise InputError(f"{folder} is a static contact: nothing slides, and no energy is dissipated")
    if not np.isfinite(cof).all():
        raise InputError(f"{folder} has no coefficient of friction: it was stopped before its τ0 was fixed")
    load = float(history["load"][-1])
    work = Dissipation(
        energy=float(history["friction_energy"][-1]),
        distance=slid,
        load=load,
        cof_end=float(cof[-1]),
        pressures={name: load / float(history[f"area_{name}"][-1]) for name in ("nominal", "contact")},
    )
    worn = {body: float(history[f"wear_volume_{body}"][-1]) / work.energy for body in BODIES}
    of_energy = [Row("worn volume", "wear_mm3_per_J", worn, unit="mm³/J", note="of friction energy")]
    return work, f"the run {folder}, {'whole' if finished else 'interrupted'}", of_energy
