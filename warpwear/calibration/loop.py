"""A measured fretting loop tells the coefficient of friction, the slip, and what the rig yields."""

from pathlib import Path
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.elastic import Hertz
from warpwear.measured.columns import choose
from warpwear.measured.options import Options
from warpwear.measured.record import read_record
from warpwear.results.report import Row, lines, record, to_json
from warpwear.study.study import Study

#: Part of the way from a tip to the other force over which unloading is taken as a straight line.
STRAIGHT = 0.25
#: Fewest points of a loop, and of the straight line behind each of its tips.
FEWEST, FEWEST_STRAIGHT = 20, 4
#: Energy over 4QΔ below which no loop of a ball can slip as a whole.
PARTIAL = 0.2
#: Energy over Q Δ up to which a line that is gone to and fro has one, by rounding.
ROUNDING = 1.0e-9


def calibrate_loop(file: Path, *, study: str | None = None, as_json: bool = False, **options: Any) -> str:
    """Say what one cycle in a file tells, as text for people or JSON.

    file: a table with a displacement and a friction force, of one whole cycle. study: a file or preset, whose
    load and bodies hold; options: load, text with a unit, instead. Raises InputError.
    """
    o = Options(options)
    if study is not None:
        o.refuse("--load", why="and --study exclude each other: the study has its load")
    known = None if study is None else Study.load(study)
    if known is not None and known.is_line:
        raise InputError(f"--study {study} is a line contact: type --load, that of all of it, instead")
    force = o.load if known is None else known.contact.load
    place, friction = _read(file)
    rows = [
        Row("source", "source", str(file)),
        Row("load F", "load_N", force),
        *_of_loop(place, friction, force),
    ]
    numbers = record(rows)
    if known is not None and known.hertz is not None and known.hertz.is_line is False:
        rows += _of_rig(numbers["compliance_um_per_N"], known, known.hertz)
    if as_json:
        return to_json(record(rows))
    return "\n".join([f"one cycle of {numbers['points']} points", *lines([*rows, _in_study(record(rows))])])


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


def _of_loop(place: FloatArray, force: FloatArray, load: float) -> list[Row]:
    """Declare coefficient, slip and compliance of a loop. Raises InputError for one without an area."""
    energy = abs(float(np.sum(0.5 * (force + np.roll(force, -1)) * (np.roll(place, -1) - place))))
    tip, most = float(place.max()), float(force.max())
    crossings = _at_no_force(place, force)
    if energy <= ROUNDING * most * tip or crossings.size < 2:
        raise InputError("the loop does not enclose an area about no force: a whole cycle is needed")
    slip, ratio = float(np.ptp(crossings)), energy / (4.0 * most * tip)
    compliance = _compliance(place, force)
    return [
        Row("", "points", int(place.size)),
        Row("coefficient", "coefficient", energy / (2.0 * slip * load) if ratio > PARTIAL else None),
        Row("least coefficient", "coefficient_least", most / load, note="the largest force over the load"),
        Row("force", "force_N", most),
        Row("slip", "stroke_um", 1e3 * slip, note="width at no force: sliding.stroke"),
        Row("travel of drive", "travel_um", 2e3 * tip, note="sliding.stroke with stroke_of = 'body'"),
        Row("energy", "energy_mJ", energy, unit="mJ"),
        Row(
            "energy over 4QΔ",
            "energy_ratio",
            ratio,
            note="" if ratio > PARTIAL else "partial slip: it tells no μ",
        ),
        Row("behind the tips", "compliance_um_per_N", 1e3 * compliance, unit="µm/N", note="yields in all"),
    ]


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


def _of_rig(compliance: float, study: Study, hertz: Hertz) -> list[Row]:
    """Declare what the contact of unworn bodies yields of that, κ/(2 E* a), and what is left for the rig."""
    contact = 1e3 * study.softness_ratio / (2.0 * hertz.modulus * hertz.radius)
    return [
        Row("of the contact", "contact_um_per_N", contact, unit="µm/N", note="(Mindlin, unworn)"),
        Row("of the rig", "rig_compliance_um_per_N", max(compliance - contact, 0.0), unit="µm/N"),
    ]


def _in_study(numbers: dict[str, float | None]) -> Row:
    """Declare keys of a study with these numbers."""
    keys = f'[sliding] stroke = "{numbers["stroke_um"]:.4g} um"'
    if numbers["coefficient"] is not None:
        keys = f'[friction] law = "coulomb", coefficient = {numbers["coefficient"]:.3g}; {keys}'
    else:
        keys = f'[sliding] force = "{numbers["force_N"]:.4g} N"'
    rig = numbers.get("rig_compliance_um_per_N")
    return Row("in a study", "", keys + (f', rig_compliance = "{rig:.3g} um/N"' if rig is not None else ""))
