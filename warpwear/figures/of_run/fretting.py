"""Figures of a fretting run: loops, their log, the map of running conditions, slip, energy, both scars."""

from dataclasses import replace

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, Scale, lines_in_time
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.fields import of_views
from warpwear.figures.of_run.history import axis_of, look_of
from warpwear.figures.of_run.shape import cuts_of
from warpwear.figures.of_run.view import positive
from warpwear.figures.wording import short
from warpwear.grid import FloatArray
from warpwear.history.quantities import BY_NAME
from warpwear.laws.archard import BODIES
from warpwear.laws.fretting import RING, displacement, loop

#: Loops in one figure.
LOOPS = 4
CYCLES = "cycles, –"


def _cycles(data: FigureData) -> FloatArray:
    """Return how many cycles are done at the end of each step."""
    return np.cumsum(data.history["cycles"])


def _loop(data: FigureData, row: int) -> tuple[FloatArray, FloatArray]:
    """Return force [N] and displacement of the drive [µm] around the cycle of a row of the history."""
    names = "tangential_force", "displacement", "displacement_border", "energy_ratio"
    drive = data.study.fretting
    assert drive is not None  # else there is no figure
    limit = drive.friction * float(data.history["load"][row])
    force, place = loop(*(float(data.history[name][row]) for name in names), limit=limit)
    return force, 1e3 * (place + drive.rig * force)


@words.figure(words.NO_FRETTING, words.NO_DRIVE, essential=True, section="fretting")
def fretting_loops(data: FigureData) -> Figure:
    """Tangential force over the displacement of the drive in some cycles, spread over the decades of the
    test. Tips and area of a loop are computed; between them it is a power law of that area.
    """
    cycles = _cycles(data)
    spread = np.searchsorted(cycles, np.geomspace(max(cycles[0], 1.0), cycles[-1] * (1.0 - 1e-9), LOOPS))
    rows = {int(row): short(float(f"{max(cycles[row], 1.0):.2g}")) for row in np.unique(spread)}
    states = [(*_loop(data, row)[::-1], f"cycle {number}") for row, number in rows.items()]
    lines = lines_in_time(describe.CONTACT, states)
    limit = data.study.friction.coefficient * float(data.history["load"][-1])
    levels = [Level(sign * limit, look=Look(describe.NOMINAL, "dash", 0.8)) for sign in (1.0, -1.0)]
    note = "dashed: coefficient × load"
    panels = [Chart("Loops", Axis("displacement, µm"), Axis("tangential force, N"), [*lines, *levels], note)]
    return Figure(panels, legend=LOOPS // 2, height=3.0)


@words.figure(words.NO_FRETTING, words.NO_DRIVE, words.NO_HERTZ, essential=True, section="fretting")
def running_conditions(data: FigureData) -> Figure:
    """Load over displacement amplitude: the run, from its first cycle (ring) to its last (dot), and the
    borders of unworn smooth bodies (Mindlin): at the first a twentieth of the radius slips, at the second all
    of the contact. As the scar grows that border moves to the cross.
    """
    study, history, hertz = data.study, data.history, data.study.hertz
    assert hertz is not None  # else there is no figure
    load = float(history["load"][-1])
    loads = np.linspace(0.0, 1.6 * load, 80)[1:]
    border = 1e3 * displacement(hertz, study.pair.softness_ratio, study.friction.coefficient)
    borders = border * (loads / hertz.load) ** (2.0 / 3.0)
    place, now = (1e3 * history[name] for name in ("displacement", "displacement_border"))
    cross, held = Look(describe.DISC, "", marker="x", size=5.0), history["load"]
    lines = [
        Line(ringed := (1.0 - (1.0 - RING) ** 2) * borders, loads, look=Look(describe.TOUCHED)),
        Line(borders, loads, look=Look(describe.DISC)),
        Line(place, held, look=Look(describe.NEUTRAL, width=0.8)),
        Line(place[:1], held[:1], "first cycle", replace(describe.RING, size=7.0)),
        Line(place[-1:], held[-1:], "last cycle", describe.DOT),
        Line(now[-1:], held[-1:], "border of the worn scar", cross),
    ]
    ends = [*place, now[-1], borders[-1], ringed[-1]]
    low, high = 0.3 * float(min(ends)), 3.0 * float(max(ends))
    between = np.sqrt([low * ringed[-1], ringed[-1] * borders[-1], borders[-1] * high])
    fields = zip(between, ("sticks", "partial slip", "gross slip"), strict=True)
    lines += [Line(np.array([at]), 1.06 * loads[-1:], name, written=True) for at, name in fields]
    along = Axis("displacement amplitude, µm", "log", low, high)
    axes = along, Axis("normal load, N", low=0.0, high=1.15 * float(loads[-1]))
    return Figure([Chart("Running conditions", *axes, lines)], legend=2, height=3.4)


@words.figure(words.NO_FRETTING, *words.FIELD, words.ALL_SLIPS, essential=True, section="fretting")
def slip_map(data: FigureData) -> Figure:
    """Way that places in contact slip in a cycle {when}; what sticks is white, and above each is how
    much of the area in contact that is.{blocks}
    """
    slips, notes = [], []
    for index, view in zip(data.indices, data.views, strict=True):
        slip = data.snapshot(index).slip
        assert slip is not None  # of a run that frets
        slips.append(positive(1e3 * data.window.largest(slip)))
        part = data.history["stick_area"][view.row] / data.history["area_contact"][view.row]
        notes.append(f"{100.0 * part:.3g} % sticks")
    most = max(float(np.nanmax(slip)) if np.isfinite(slip).any() else 0.0 for slip in slips)
    scale = Scale("slip of a cycle, µm", 0.0, most or 1.0)
    return of_views(data, "Slip and stick", slips, notes, scale=scale)


@words.figure(words.NO_FRETTING, words.NO_COURSE, essential=True, section="fretting")
def cycle_energy(data: FigureData) -> Figure:
    """Energy that a cycle dissipates and its ratio to 4QΔ over the cycles, and the worn volume of both
    bodies over the energy in all, whose slope is the wear by energy.
    """
    history, cycles = data.history, _cycles(data)
    over, energies = Axis(CYCLES, "log"), Line(cycles, history["energy"], look=Look(describe.CONTACT))
    panels = [Chart("Energy of a cycle", over, axis_of(BY_NAME["energy"]), [energies])]
    if np.isfinite(history["energy_ratio"]).any():
        ratio = replace(energies, y=history["energy_ratio"])
        slips = Level(0.2, "unworn ball begins to slip", Look(describe.NOMINAL, "dash", 0.8))
        part = Axis("energy over 4QΔ, –", low=0.0, high=1.05)
        panels.append(Chart("Energy ratio", over, part, [ratio, slips]))
    total, lines = history["friction_energy"], []
    for body in BODIES:
        of = BY_NAME[f"wear_volume_{body}"]
        slope = history[of.name][-1] / total[-1]
        label = f"{data.name_of(body)}, {short(float(f'{slope:.3g}'))} mm³/J"
        lines.append(Line(total, of.scaled(history[of.name]), label, look_of(of)))
    axes = Axis("energy in all, J", low=0.0), Axis(BY_NAME["wear_volume_disc"].family_axis, low=0.0)
    return Figure([*panels, Chart("Wear by energy", *axes, lines)], legend=3)


@words.figure(words.NO_FRETTING, words.UNWORN, *words.FIELD, essential=True, section="fretting")
def fretting_scars(data: FigureData) -> Figure:
    """Depths worn off both bodies {end}, through the middle along and across sliding: the scar of the disc
    is longer by the slip.
    """
    last, panels = data.views[-1], []
    looks = {body: look_of(BY_NAME[f"wear_depth_{body}"]) for body in BODIES}
    for name, label, _ in cuts_of(data):
        cut = last.cuts[name]
        depths = {body: -1e3 * cut[f"wear_{body}"] for body in BODIES}
        lines = [Line(cut["place"], depths[body], data.name_of(body), looks[body]) for body in BODIES]
        panels.append(Chart(f"Worn {name} sliding", Axis(label), Axis("worn depth, µm"), lines))
    return Figure(panels, legend=2, shared="y")
