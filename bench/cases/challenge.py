"""The surface of the contact-mechanics challenge, without adhesion: areas and gaps of ours and of a peer.

    python bench/cases/challenge.py [--cells 2048 4096] [--peer-cells 2048] [--peers PYTHON] [--json FILE]

A self-affine surface of the challenge's numbers (Müser et al. 2017, Tribol. Lett. 65, 118) with waves of our
own draws: L 0.1 mm, roll-off 20 µm, cut-off 0.1 µm, Hurst exponent 0.8, slope 1, E* 25 MPa, 0.25 MPa. Each
finer grid has the same waves. Gaps are made of everybody's pressure by NumPy.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[n]) for n in (1, 2)]

from contenders.process import Contender  # noqa: E402
from measure.machine import machine  # noqa: E402

from warpwear.contact.half_space.influence import periodic_spectrum  # noqa: E402
from warpwear.grid import Grid  # noqa: E402
from warpwear.surfaces.made.self_affine import SelfAffine  # noqa: E402

#: Lengths in L, pressures in E*.
SIDE_UM = 100.0
ROLL_OFF, CUT_OFF, HURST, SLOPE = 0.2, 0.001, 0.8, 1.0
MEAN_PRESSURE = 0.25 / 25.0
RESIDUAL = 1e-6
#: Edges of the classes of gaps [µm].
EDGES_UM = np.linspace(0.0, 4.0, 81)
#: ASPHER's own tolerance, and its setting that was quickest on a like surface.
PEER_TOLERANCE = 1e-7
PEER_SETTING = {"precision": "float_then_double", "precond_engine": "fft"}


def heights_of(cells: int) -> Any:
    """Heights [L]."""
    waves = SelfAffine(hurst=HURST, roll_off=ROLL_OFF, cut_off=CUT_OFF, period=1.0, sq=1.0, seed=1)
    at = (np.arange(cells) + 0.5) / cells
    return waves.heights(at, at) * (SLOPE / waves.rms_slope)


def row_of(heights: Any, pressure: Any) -> dict[str, Any]:
    """Area, residual and gaps of a pressure, by NumPy alone."""
    n = heights.shape[0]
    spectrum = periodic_spectrum(Grid(n, n, 1.0 / n), 1.0)
    gap = np.fft.irfft2(np.fft.rfft2(pressure) * spectrum, s=heights.shape) - heights
    touching = pressure > 0.0
    highest, lowest = gap[touching].max(), gap.min()
    level = 0.5 * (highest + lowest)
    gap = np.maximum(gap - level, 0.0)[~touching] * SIDE_UM
    density = np.histogram(gap, EDGES_UM)[0] / pressure.size / np.diff(EDGES_UM)
    return {
        "cells": n,
        "area": float(touching.mean()),
        "residual": float(0.5 * max(highest - lowest, 0.0) / heights.std()),
        "mean_gap_um": float(gap.sum()) / pressure.size,
        "largest_pressure": float(pressure.max()),
        "load": float(pressure.mean()) / MEAN_PRESSURE,
        "density_of_gaps": density.tolist(),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cells", type=int, nargs="+", default=[2048, 4096])
    parser.add_argument("--peer-cells", type=int, nargs="*", default=[2048])
    parser.add_argument("--peers", nargs="+", default=[sys.executable], help="interpreters that have ASPHER")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    rows = []
    for cells in options.cells:
        heights = heights_of(cells)
        with tempfile.TemporaryDirectory() as folder:
            np.save(f"{folder}/heights.npy", heights)
            asked = {"heights": f"{folder}/heights.npy", "pressure": f"{folder}/pressure.npy"}
            asked |= {"boundary": "periodic", "cap": float("inf"), "mean_pressure": MEAN_PRESSURE}
            asked |= {"device": "cpu", "setting": {}, "tolerance": RESIDUAL}
            for solver in ("warpwear", "ASPHER"):
                if solver != "warpwear":
                    if cells not in options.peer_cells:
                        continue
                    asked |= {"setting": PEER_SETTING, "tolerance": PEER_TOLERANCE}
                start = time.perf_counter()
                with Contender(solver, options.peers, options.threads) as contender:
                    record = contender.solve(asked)
                row = {"solver": solver, "version": contender.version, **record}
                row |= row_of(heights, np.load(asked["pressure"]))
                rows.append(row)
                told = {k: v for k, v in row.items() if k != "density_of_gaps"}
                print(f"{time.perf_counter() - start:.0f} s", json.dumps(told), flush=True)
    if options.json:
        record = {"machine": machine(), "rms_um": float(heights.std()) * SIDE_UM, "rows": rows}
        record["edges_um"] = EDGES_UM.tolist()
        options.json.write_text(json.dumps(record) + "\n")


if __name__ == "__main__":
    main()
