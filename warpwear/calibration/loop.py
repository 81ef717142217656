"""A measured fretting loop tells the coefficient of friction, the slip, and what the rig yields."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.calibration.measurements import Tests
from warpwear.calibration.repeated import CalibratedTests, each_test
from warpwear.errors import InputError, named_in_python
from warpwear.grid import FloatArray
from warpwear.measured.columns import choose
from warpwear.measured.friction.analysis import Loop
from warpwear.measured.options import Options
from warpwear.measured.record import read_record
from warpwear.measured.report import Report
from warpwear.results.report import Row, times
from warpwear.study.study import Study

#: Part of the way from a tip to the other force over which unloading is taken as a straight line.
STRAIGHT = 0.25
#: Fewest points of a loop, and of the straight line behind each of its tips.
FEWEST, FEWEST_STRAIGHT = 20, 4
#: Energy over 4QΔ below which no loop of a ball can slip as a whole.
PARTIAL = 0.2
#: Energy over Q Δ up to which a line that is gone to and fro has one, by rounding.
ROUNDING = 1.0e-9
#: Key of a test -> option.
KEYS = {"loop": "tests", "load": "load"}


@dataclass(frozen=True, kw_only=True, repr=False)
class LoopCalibration(Report):
    """Hold what one cycle of fretting tells.

    Attributes
    ----------
    force, load : float
        Largest friction force, and normal load [N].
    slip, travel : float
        Width of the loop at no force, and what the drive moves to and fro [mm].
    energy : float
        Energy of the cycle [mJ]; `energy_ratio` is that over 4 Q Δ.
    compliance, contact : float
        What yields behind the tips [mm/N], in all, and by the contact, None where no study tells.
    points : int
        Points of the cycle.
    source : str
        The file.
    """

    source: str
    load: float
    points: int
    force: float
    slip: float
    travel: float
    energy: float
    compliance: float
    contact: float | None = None

    @property
    def energy_ratio(self) -> float:
        """Return the energy over 4 Q Δ of the largest force and displacement."""
        return self.energy / (2.0 * self.force * self.travel)

    @property
    def coefficient(self) -> float | None:
        """Return the coefficient of friction by the energy, None of partial slip."""
        return self.energy / (2.0 * self.slip * self.load) if self.energy_ratio > PARTIAL else None

    @property
    def rig(self) -> float | None:
        """Return the compliance of the rig [mm/N]; None where that of the contact is not known."""
        return None if self.contact is None else max(self.compliance - self.contact, 0.0)

    @property
    def headline(self) -> Row:
        """Declare the coefficient of friction. Raises InputError for partial slip, which tells none."""
        if self.coefficient is None:
            raise InputError(f"{self.source} is a loop of partial slip, which tells no coefficient")
        return Row("coefficient", "coefficient", self.coefficient)

    def _title(self) -> str:
        return f"one cycle of {self.points} points"

    def __repr__(self) -> str:
        least, slip = self.force / self.load, 1e3 * self.slip
        return f"<fretting loop: slip {slip:.4g} µm, largest force over the load {least:.3g}>"

    def _rows(self) -> list[Row]:
        partial = "" if self.coefficient is not None else "partial slip: it tells no μ"
        least, ratio = self.force / self.load, self.energy_ratio
        behind, contact, rig = (times(1e3, c) for c in (self.compliance, self.contact, self.rig))
        rows = [
            Row("source", "source", self.source),
            Row("load F", "load_N", self.load),
            Row("", "points", self.points),
            Row("coefficient", "coefficient", self.coefficient),
            Row("least coefficient", "coefficient_least", least, note="the largest force over the load"),
            Row("force", "force_N", self.force),
            Row("slip", "stroke_um", 1e3 * self.slip, note="width at no force: sliding.stroke"),
            Row(
                "travel of drive",
                "travel_um",
                1e3 * self.travel,
                note="sliding.stroke with stroke_of = 'body'",
            ),
            Row("energy", "energy_mJ", self.energy, unit="mJ"),
            Row("energy over 4QΔ", "energy_ratio", ratio, note=partial),
            Row("behind the tips", "compliance_um_per_N", behind, unit="µm/N", note="yields in all"),
        ]
        if contact is not None:
            note = "(Mindlin, unworn)"
            rows.append(Row("of the contact", "contact_um_per_N", contact, unit="µm/N", note=note))
            rows.append(Row("of the rig", "rig_compliance_um_per_N", rig, unit="µm/N"))
        keys = f'[sliding] force = "{self.force:.4g} N"'
        if self.coefficient is not None:
            law = f'[friction] law = "coulomb", coefficient = {self.coefficient:.3g}'
            keys = f'{law}; [sliding] stroke = "{1e3 * self.slip:.4g} um"'
        keys += "" if rig is None else f', rig_compliance = "{rig:.3g} um/N"'
        return [*rows, Row("in a study", "", keys)]


@named_in_python()
def calibrate_loop(
    tests: Tests, *, study: Study | str | Path | None = None, load: Any = None
) -> LoopCalibration | CalibratedTests:
    """Find coefficient of friction, slip and compliance of the rig from one cycle of fretting.

    Parameters
    ----------
    tests : path, or list of dict
        A table with a displacement and a friction force, of one whole cycle. Or a list with one a test:
        ``loop``, such a file, and without `study` ``load``; the keys are those of ``[[test]]``, which
        docs/reference/keys.md explains. A path that ends in .toml is that of a file with such a list, maybe
        in a study, whose load holds.
    study : Study, path or name of a preset, optional
        Whose load and bodies hold; what its contact yields is told apart from the rig.
    load : str, optional
        The normal load instead, such as ``"20 N"``.

    Returns
    -------
    LoopCalibration or CalibratedTests
        The numbers of the cycle. Of a list of tests each, and mean and scatter of the coefficient.

    Raises
    ------
    InputError
        For a file without such columns, for what is no whole cycle, and in a list for partial slip.

    References
    ----------
    R. D. Mindlin and H. Deresiewicz, Elastic spheres in contact under varying oblique forces, Journal of
    Applied Mechanics 20 (1953) 327-344.

    Examples
    --------
    >>> angle = np.arange(0.0, 2.0 * np.pi, 0.01)
    >>> force = 12.0 * np.clip(3.0 * np.cos(angle - 0.9), -1.0, 1.0)
    >>> rows, names = np.column_stack([20.0 * np.cos(angle), force]), "Displacement [um],Friction force [N]"
    >>> np.savetxt("loop.csv", rows, delimiter=",", header=names, comments="")
    >>> warpwear.calibrate_loop("loop.csv", load="20 N")
    <fretting loop: slip ... µm, largest force over the load 0.6>
    """
    if study is not None and load is not None:
        raise InputError("--load and --study exclude each other: the study has its load")
    known = study if study is None or isinstance(study, Study) else Study.load(study)
    if known is not None and known.is_line:
        raise InputError(f"--study {study} is a line contact: type --load, that of all of it, instead")
    if not isinstance(tests, str | Path) or Path(tests).suffix == ".toml":
        return each_test(calibrate_loop, tests, KEYS, {"load": load, "study": known})
    place, friction = _read(Path(tests))
    normal = Options(load=load).load if known is None else known.contact.load
    return _of_loop(place, friction, source=str(tests), load=normal, contact=_of_contact(known))


def _read(file: Path) -> tuple[FloatArray, FloatArray]:
    """Return displacement [mm] and friction force [N], centred, of the rows of a file. Raises InputError."""
    table = read_record(file)
    columns = choose(table)
    for role, name in (("position", "Displacement [um]"), ("friction force", "Friction force [N]")):
        if role not in columns:
            raise InputError(f"{file} has no column for the {role}: a name such as '{name}' is expected")
    both = [columns["position"], columns["friction force"]]
    values = table.columns([column.index for column in both]) * [column.factor for column in both]
    values = values[np.isfinite(values).all(axis=1)]
    if len(values) < FEWEST:
        raise InputError(f"{file} has {len(values)} points: a loop of {FEWEST} or more is needed")
    values -= 0.5 * (values.min(axis=0) + values.max(axis=0))
    if not (values.max(axis=0) > 0.0).all():
        raise InputError(f"{file}: displacement or friction force does not change, and no loop is there")
    return values[:, 0], values[:, 1]


def _of_loop(place: FloatArray, force: FloatArray, **more: Any) -> LoopCalibration:
    """Measure a loop. more: other fields of the result. Raises InputError for one without an area."""
    energy = Loop(1, place, force).energy
    tip, most = float(place.max()), float(force.max())
    crossings = _at_no_force(place, force)
    if energy <= ROUNDING * most * tip or crossings.size < 2:
        raise InputError("the loop does not enclose an area about no force: a whole cycle is needed")
    return LoopCalibration(
        points=int(place.size),
        force=most,
        slip=float(np.ptp(crossings)),
        travel=2.0 * tip,
        energy=energy,
        compliance=_compliance(place, force),
        **more,
    )


def _at_no_force(place: FloatArray, force: FloatArray) -> FloatArray:
    """Return the displacements at which the force is none, between neighbouring points [mm]."""
    later, there = np.roll(force, -1), np.roll(place, -1)
    crosses = np.flatnonzero((force < 0.0) != (later < 0.0))
    part = force[crosses] / (force[crosses] - later[crosses])
    return np.asarray(place[crosses] + part * (there[crosses] - place[crosses]))


def _compliance(place: FloatArray, force: FloatArray) -> float:
    """Return the compliance [mm/N] as unloading begins, the mean of both tips. Raises InputError."""
    slopes = []
    for sign in (1.0, -1.0):
        x, q = sign * place, sign * force
        start = int(np.argmax(x))
        x, q = np.roll(x, -start), np.roll(q, -start)
        steps = int(np.argmax(q < (1.0 - 2.0 * STRAIGHT) * q.max()))
        if steps < FEWEST_STRAIGHT:
            raise InputError(f"{steps} points lie behind a tip of the loop: {FEWEST_STRAIGHT} are needed")
        slopes.append(np.polyfit(q[:steps], x[:steps], 1)[0])
    return float(np.mean(slopes))


def _of_contact(study: Study | None) -> float | None:
    """Return what the contact of unworn bodies yields, κ/(2 E* a) [mm/N]; None where that is not known."""
    hertz = None if study is None else study.hertz
    if study is None or hertz is None or hertz.is_line:
        return None
    return float(study.pair.softness_ratio / (2.0 * hertz.modulus * hertz.radius))
