"""A measured fretting loop tells the coefficient of friction, the slip, and what the rig yields."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
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

signal = lazy.module("scipy.signal")

#: Part of the way from a tip to the other force over which unloading is taken as a straight line.
STRAIGHT = 0.25
#: What a contact that slips as a whole yields over that, by Mindlin, over what it does as unloading begins.
CURVED = (1.0 - 0.5 * STRAIGHT) ** (-1 / 3)
#: Part of the force about none in which a parabola tells the width.
MIDDLE = 0.5
#: Fewest points of a loop, and of the straight line behind each of its tips.
FEWEST, FEWEST_STRAIGHT = 20, 4
#: Part of the travel by which the end of a cycle may lie off its beginning.
OPEN = 0.25
#: Energy over 4QΔ up to which a ball on a stiff rig does not slip as a whole.
PARTIAL = 0.2
#: Displacement from which on a ball slips as a whole, over its force and the compliance of its contact.
BORDER = 1.5
#: What the contact adds to the width of a loop of gross slip, by Mindlin and Deresiewicz, over that.
YIELDS = 2.0 * (2.0 ** (1 / 3) - 1.0)
#: Energy over Q Δ up to which a line that is gone to and fro has one, by rounding.
ROUNDING = 1.0e-9
#: Numbers that have errors -> what these are multiplied with for people.
ERRORS = {"coefficient": 1.0, "force": 1.0, "slip": 1e3, "energy": 1.0, "compliance": 1e3}
#: Key of a row -> number whose error it has.
ERRORS_OF = {"coefficient": "coefficient", "force_N": "force", "stroke_um": "slip", "energy_mJ": "energy"}
ERRORS_OF |= dict.fromkeys(("compliance_um_per_N", "rig_compliance_um_per_N"), "compliance")
#: Error as a part of a number up to which it is that of written digits.
EXACT = 1e-6
#: Part of the points that half of a window has at most.
SMOOTH = 60
#: Loops with the scatter of their points once more, from which come the errors.
COPIES = 100
#: Key of a test -> option.
KEYS = {"loop": "tests", "load": "load"}


@dataclass(frozen=True, kw_only=True, repr=False)
class LoopCalibration(Report):
    """Hold what one cycle of fretting tells.

    Attributes
    ----------
    force, load : float
        Friction force at the tips, and normal load [N].
    width, travel : float
        Width of the loop at no force, and what the drive moves to and fro [mm].
    energy : float
        Energy of the cycle [mJ]; `energy_ratio` is that over 4 Q Δ.
    compliance, contact : float
        What yields behind the tips [mm/N], in all, and by the contact, None where no study tells.
    points : int
        Points of the cycle.
    source : str
        The file.
    is_sure : bool
        Whether the scatter of the points leaves no doubt that all of the contact slips.
    errors : dict
        Standard uncertainties of these numbers by their names, from the scatter of the points.
    """

    source: str
    load: float
    points: int
    force: float
    width: float
    travel: float
    energy: float
    compliance: float
    contact: float | None = None
    is_sure: bool = True
    errors: Mapping[str, float] = field(default_factory=dict)

    @property
    def energy_ratio(self) -> float:
        """Return the energy over 4 Q Δ of force and displacement of the tips."""
        return self.energy / (2.0 * self.force * self.travel)

    @property
    def regime(self) -> str:
        """Tell whether all of the contact slips: then it dissipates more than it can in partial slip."""
        if self.contact is None and self.energy_ratio <= PARTIAL:
            return "not known: partial slip, or a soft rig; a study tells what the contact yields"
        if self.contact and self.energy <= 4.0 * PARTIAL * BORDER * self.contact * self.force**2:
            return "partial slip, which tells no coefficient"
        return "gross slip" if self.is_sure else "not known: the points scatter too much to tell partial slip"

    @property
    def coefficient(self) -> float | None:
        """Return the coefficient of friction by energy and width, None where it may be partial slip.

        What the contact yields is a part of both, of the energy less.
        """
        if self.regime != "gross slip":
            return None
        yields = 2.0 * (YIELDS - 2.0 * PARTIAL) * BORDER * (self.contact or 0.0) * self.energy
        return self.energy / (self.width + max(self.width**2 - yields, 0.0) ** 0.5) / self.load

    @property
    def slip(self) -> float | None:
        """Return how far all of the contact slips [mm], peak to peak; None where it may be partial slip."""
        if self.coefficient is None:
            return None
        return self.width - YIELDS * BORDER * (self.contact or 0.0) * self.coefficient * self.load

    @property
    def rig(self) -> float | None:
        """Return the compliance of the rig [mm/N]; None where that of the contact is not known."""
        return None if self.contact is None else max(self.compliance - CURVED * self.contact, 0.0)

    @property
    def headline(self) -> Row:
        """Declare the coefficient of friction. Raises InputError for partial slip, which tells none."""
        if self.coefficient is None:
            raise InputError(f"{self.source} has no coefficient: {self.regime}")
        return Row("coefficient", "coefficient", self.coefficient, error=self.errors.get("coefficient"))

    def _title(self) -> str:
        return f"one cycle of {self.points} points"

    def __repr__(self) -> str:
        told = self.regime if self.slip is None else f"slip {1e3 * self.slip:.4g} µm"
        return f"<fretting loop: {told}, force of the tips over the load {self.force / self.load:.3g}>"

    def _rows(self) -> list[Row]:
        least = self.force / self.load if self.coefficient is None else None
        bound = "at {}: what the contact yields is not taken off" if self.contact is None else ""
        behind, contact, rig = (times(1e3, c) for c in (self.compliance, self.contact, self.rig))
        rows = [
            Row("source", "source", self.source),
            Row("load F", "load_N", self.load),
            Row("", "points", self.points),
            Row("regime", "regime", self.regime),
            Row("coefficient", "coefficient", self.coefficient, note=bound.format("least")),
            Row("least coefficient", "coefficient_least", least, note="the force of the tips over the load"),
            Row("force", "force_N", self.force),
            Row("slip", "stroke_um", times(1e3, self.slip), note=bound.format("most") or "sliding.stroke"),
            Row("width", "width_um", 1e3 * self.width, note="at no force"),
            Row(
                "travel of drive",
                "travel_um",
                1e3 * self.travel,
                note="sliding.stroke with stroke_of = 'body'",
            ),
            Row("energy", "energy_mJ", self.energy, unit="mJ"),
            Row("energy over 4QΔ", "energy_ratio", self.energy_ratio),
            Row("behind the tips", "compliance_um_per_N", behind, note="yields in all"),
            Row("of the contact", "contact_um_per_N", contact, note="(Mindlin, unworn)"),
            Row("of the rig", "rig_compliance_um_per_N", rig),
        ]
        factors = {name: times(factor, self.errors.get(name)) for name, factor in ERRORS.items()}
        errors = {key: factors[name] for key, name in ERRORS_OF.items()}
        errors["coefficient_least"] = times(1.0 / self.load, factors["force"]) if least else None
        rows = [replace(row, error=errors.get(row.key)) for row in rows]
        keys = f'[sliding] force = "{self.force:.4g} N"'
        if self.coefficient is not None and self.slip is not None:
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
    <fretting loop: slip ... µm, force of the tips over the load 0.6>
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
    about: Any = {"source": str(tests), "load": normal, "contact": _of_contact(known)}
    loop, random = _of_loop(place, friction, **about), np.random.default_rng(0)
    copies: list[LoopCalibration] = []
    for _ in range(COPIES):
        with suppress(InputError):
            copies.append(
                _of_loop(
                    *(v + _scatter(v) * random.standard_normal(v.size) for v in (place, friction)), **about
                )
            )
    known_of = [name for name in ERRORS if all(getattr(copy, name) is not None for copy in copies)]
    errors = {name: float(np.std([getattr(copy, name) for copy in copies])) for name in known_of if copies}
    told = {name: error for name, error in errors.items() if error > EXACT * abs(getattr(loop, name) or 0.0)}
    return replace(loop, errors=told, is_sure=all(copy.coefficient is not None for copy in copies))


def _scatter(values: FloatArray) -> float:
    """Return the deviation of points about a smooth course, by the middle one of their second differences."""
    return float(1.4826 * np.median(np.abs(np.diff(values, 2))) / 6.0**0.5)


def _read(file: Path) -> tuple[FloatArray, FloatArray]:
    """Return displacement [mm] and friction force [N], centred, of the rows of a file. Raises InputError."""
    table = read_record(file)
    try:
        columns = choose(table)
    except InputError as error:
        names = "'Displacement [um]' and 'Friction force [N]', each once"
        raise InputError(f"{file} has no header that names both columns with units: {names}") from error
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
    place, force = values.T
    sides = np.sign(place[np.abs(place) > 0.5 * place.max()])
    if np.count_nonzero(np.diff(sides)) > 2 or abs(place[-1] - place[0]) > OPEN * np.ptp(place):
        raise InputError(f"{file} holds a part of a cycle, or more than one: the points of one are needed")
    # a force on the other body points the other way, and has its tips where there are none
    done = force @ (np.roll(place, -1) - np.roll(place, 1))
    return place, force if done > 0.0 else -force


def _of_loop(place: FloatArray, force: FloatArray, **more: Any) -> LoopCalibration:
    """Measure a loop. more: other fields of the result. Raises InputError for one without an area."""
    energy = Loop(1, place, force).energy
    if energy <= ROUNDING * force.max() * place.max():
        raise InputError("the loop does not enclose an area about no force: a whole cycle is needed")
    return LoopCalibration(
        points=int(place.size),
        force=_at_tips(place, force),
        width=_width(place, force),
        travel=float(np.ptp(place)),
        energy=energy,
        compliance=_compliance(place, force),
        **more,
    )


def _from_tips(place: FloatArray, force: FloatArray) -> Iterator[tuple[FloatArray, FloatArray, int]]:
    """Give displacement and force, towards the tip positive, from either tip on around the loop.

    A tip is where both are largest, smoothed over a window as far as they scatter, which is the third.
    """
    both = place / np.ptp(place) + force / np.ptp(force)
    steps = 2.0 * _scatter(both) / float(np.mean(np.abs(np.diff(both))))
    window = 2 * min(int(steps), place.size // SMOOTH) + 1
    smooth = signal.savgol_filter(both, window, 2, mode="wrap") if window > 2 else both
    for sign in (1.0, -1.0):
        start = int(np.argmax(sign * smooth))
        yield np.roll(sign * place, -start), np.roll(sign * force, -start), window


def _at_tips(place: FloatArray, force: FloatArray) -> float:
    """Return the force at the tips by straight lines through what leads to them, the mean of both.

    What chose the tip is left out: it is the largest by its scatter, too.
    """
    ends = []
    for _, q, window in _from_tips(place, force):
        back = window // 2 + np.arange(2 * window)
        ends.append(np.polyfit(back, np.roll(q[::-1], 1)[back], 1)[1])
    return float(np.mean(ends))


def _width(place: FloatArray, force: FloatArray) -> float:
    """Return the width at no force [mm]: by a parabola on each side, of few points by those next to it."""
    width = 0.0
    for x, q, _ in _from_tips(place, force):
        last = int(np.argmax(q < -MIDDLE * q.max()))
        near = np.flatnonzero(np.abs(q[:last]) < MIDDLE * q.max())
        if near.size < FEWEST_STRAIGHT:
            near = int(np.argmax(q < 0.0)) - np.arange(2)
        width += np.polyfit(q[near], x[near], 2 if near.size > 2 else 1)[-1]
    return float(width)


def _compliance(place: FloatArray, force: FloatArray) -> float:
    """Return the compliance [mm/N] as unloading begins, the mean of both tips. Raises InputError."""
    slopes = []
    for x, q, _ in _from_tips(place, force):
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
