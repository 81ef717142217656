"""Files of a laboratory whose pair is known: records of friction, and profiles across their tracks."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.laws.states import shares

#: Of every test: track and ball [mm], load [N], speed [mm/s], laps, K of the disc [mm³/(N·m)].
TRACK_RADIUS, BALL, LOAD, SPEED, LAPS, K = 6.0, 3.0, 5.0, 100.0, 320, 3.0e-5
LAP = 2.0 * math.pi * TRACK_RADIUS
#: Constants of three states, waits of three tests [laps], and part by which K of each is off.
STATES = {"film": 0.15, "metal": 0.95, "cover": 0.55, "spread": 0.2, "cover_rate": 0.1}
WAITS, OFF = (36.0, 40.0, 44.0), (-0.06, 0.0, 0.06)
#: What no file says of it.
GIVEN = {
    "counter.diameter": "6 mm",
    "counter.material": "AISI 52100",
    "disc.material": "AISI 304",
    "disc.synthetic.sq": "0.02 um",
    "wear.counter": 0,
}


def lab_record(
    path: Path, number: int, *, jumps: bool = True, load: float = LOAD, pace: float = SPEED
) -> Path:
    """Write a record as a logger does: time, laps, forces; 10 rows a lap with noise."""
    dice = np.random.default_rng(number)
    laps = np.arange(10 * LAPS + 1) / 10.0
    cof = np.full(laps.size, STATES["cover"])
    if jumps:
        r, wait = STATES["spread"], WAITS[number]
        rates = {"rate": r * (1.0 + math.exp(-r * wait)), "middle": r * wait}
        own = shares(laps, **rates, cover_rate=STATES["cover_rate"])
        cof = own.filmed * STATES["film"] + own.metal * STATES["metal"] + own.covered * STATES["cover"]
    force = load * (cof + dice.normal(0.0, 0.01, laps.size))
    table = np.column_stack([laps * LAP / pace, laps, force, np.full(laps.size, load)])
    head = "Time [s],Revolutions,Friction force [N],Normal force [N]"
    np.savetxt(path, table, delimiter=",", header=head, comments="", fmt="%.5f")
    return path


def lab_strokes(path: Path, *, stroke: float, cycles: int, cof: float, frequency: float = 1.0) -> Path:
    """Write a record of a ball that goes to and fro: time, position and forces, 40 rows a cycle."""
    phase = np.arange(40 * cycles + 1) / 40.0
    way = 0.5 * stroke * (1.0 - np.cos(2.0 * math.pi * phase))
    noise = np.random.default_rng(5).normal(0.0, 0.01, phase.size)
    force = LOAD * (cof + noise) * np.sign(np.sin(2.0 * math.pi * phase + 1e-6))
    table = np.column_stack([phase / frequency, way, force, np.full(phase.size, LOAD)])
    head = "Time [s],Position [mm],Fx [N],Fz [N]"
    np.savetxt(path, table, delimiter=",", header=head, comments="", fmt="%.5f")
    return path


def lab_recipe(path: Path, number: int, loads: tuple[float, ...] = (5.0, 10.0)) -> Path:
    """Write a record in steps of 10 m under rising loads: the coefficient is 0.5 + 0.01 F, and wear 0.2 F."""
    dice = np.random.default_rng(100 + number)
    lines = ["Distance [mm],CoF,Fz [N],Linear wear [um],Step"]
    for step, load in enumerate(loads):
        own = load * (1.0 + 0.002 * number)  # a machine never sets the same
        for k in range(1000):
            cof = 0.5 + 0.01 * load + 0.01 * number + dice.normal(0.0, 0.01)
            wear = 0.2e-3 * load * 10.0 * k + dice.normal(0.0, 0.02)
            lines.append(f"{1e4 * step + 10.0 * k:.1f},{cof:.5f},{own:.4f},{wear:.5f},{step + 1}")
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def lab_profile(path: Path, number: int, *, work: float = LOAD * LAPS * LAP, length: float = LAP) -> Path:
    """Write a profile across the track: a segment of the ball's circle with the section K F L/length.

    work: F L [N·mm].
    """
    section = 1e-3 * K * (1.0 + OFF[number]) * work / length  # [mm²]
    half = (1.5 * BALL * section) ** (1.0 / 3.0)
    x = np.arange(0.0, 2.0, 0.0005)
    z = -np.maximum((half**2 - (x - 1.0) ** 2) / (2.0 * BALL), 0.0)
    z += np.random.default_rng(number).normal(0.0, 1e-5, x.size)
    np.savetxt(path, np.column_stack([x, 1e3 * z]), delimiter=",", header="x [mm],z [um]", comments="")
    return path


def lab(folder: Path, **how: Any) -> list[dict[str, Path]]:
    """Write three records and three profiles; return the tests. how: as of `lab_record`."""
    return [
        {
            "record": lab_record(folder / f"test-{k + 1}.csv", k, **how),
            "profile": lab_profile(folder / f"track-{k + 1}.csv", k),
        }
        for k in range(3)
    ]
