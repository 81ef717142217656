"""Files of a laboratory whose pair is known: records of friction, and profiles across their tracks."""

import math
from pathlib import Path

import numpy as np

from warpwear.laws.states import shares

#: Of every test: track and ball [mm], load [N], speed [mm/s], laps, K of the disc [mm³/(N·m)].
TRACK_RADIUS, BALL, LOAD, SPEED, LAPS, K = 6.0, 3.0, 5.0, 100.0, 320, 3.0e-5
LAP = 2.0 * math.pi * TRACK_RADIUS
#: Constants of three states, waits of three tests [laps], and part by which K of each is off.
STATES = {"film": 0.15, "metal": 0.95, "cover": 0.55, "spread": 0.2, "cover_rate": 0.1}
WAITS, OFF = (36.0, 40.0, 44.0), (-0.06, 0.0, 0.06)


def lab_record(path: Path, number: int, *, jumps: bool = True, load: float = LOAD, seed: int = 0) -> Path:
    """Write a record as a logger does: time, laps, forces; 10 rows a lap with noise."""
    dice = np.random.default_rng(seed + number)
    laps = np.arange(10 * LAPS + 1) / 10.0
    cof = np.full(laps.size, STATES["cover"])
    if jumps:
        r, wait = STATES["spread"], WAITS[number]
        own = shares(
            laps, rate=r * (1.0 + math.exp(-r * wait)), middle=r * wait, cover_rate=STATES["cover_rate"]
        )
        cof = own.filmed * STATES["film"] + own.metal * STATES["metal"] + own.covered * STATES["cover"]
    force = load * (cof + dice.normal(0.0, 0.01, laps.size))
    table = np.column_stack([laps * LAP / SPEED, laps, force, np.full(laps.size, load)])
    head = "Time [s],Revolutions,Friction force [N],Normal force [N]"
    np.savetxt(path, table, delimiter=",", header=head, comments="", fmt="%.5f")
    return path


def lab_profile(path: Path, number: int, *, k: float = K, load: float = LOAD) -> Path:
    """Write a profile across the track: a segment of the ball's circle with the section K F L/(2π R)."""
    section = 1e-3 * k * (1.0 + OFF[number]) * load * LAPS  # [mm²]
    half = 0.5 * (12.0 * BALL * section) ** (1.0 / 3.0)
    x = np.arange(0.0, 2.0, 0.0005)
    z = -np.maximum((half**2 - (x - 1.0) ** 2) / (2.0 * BALL), 0.0)
    z += np.random.default_rng(number).normal(0.0, 1e-5, x.size)
    np.savetxt(path, np.column_stack([x, 1e3 * z]), delimiter=",", header="x [mm],z [um]", comments="")
    return path
