"""The largest contact on one GPU: a cold `solve_contact` from the host's memory and back, to 1e-4, certified.

python bench/cases/largest.py [--cells 32768] [--out FILE.json] needs CuPy, which makes the heights.
"""

import json
import math
import resource
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import click
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import warpwear

HURST, SLOPE, SHORTEST = 0.8, 0.1, 2  # exponent, rms slope, cells in the shortest wave
PRESSURE, HARDNESS = 0.005, 0.05  # over E*
CASES: dict[str, dict[str, float]] = {"elastic": {}, "capped": {"hardness": HARDNESS}}
ROWS = 1024  # of the field that are looked at at once
WARM = 4096  # cells of a part that is solved beforehand, so that kernels are compiled


def heights(cells: int, *, xp: Any = np, seed: int = 1) -> Any:
    """Self-affine heights of a field of 1 × 1, made by CuPy or NumPy (xp), as an array of NumPy.

    They are made of real noise: of waves that are no transform of a real field the inverse of a GPU makes,
    on large grids, stripes.
    """
    rng, blocks = xp.random.default_rng(seed), range(0, cells, ROWS)
    noise = xp.empty((cells, cells), xp.float32)
    for first in blocks:
        noise[first : first + ROWS] = rng.standard_normal(noise[first : first + ROWS].shape, dtype=xp.float32)
    waves = xp.fft.rfft2(noise)
    del noise
    across, squares = xp.arange(cells // 2 + 1, dtype=xp.float32), 0.0
    twice = xp.where((across == 0) | (2 * across == cells), 1.0, 2.0)  # the other half of the plane
    for first in blocks:
        rows = slice(first, first + ROWS)
        along = xp.fft.fftfreq(cells, 1.0 / cells)[rows].astype(xp.float32)
        squared = along[:, None] ** 2 + across**2
        there = (squared > 0) & (squared <= (cells / SHORTEST) ** 2)
        waves[rows] *= xp.where(there, xp.maximum(squared, 1e-9) ** (-0.5 * (1.0 + HURST)), 0.0)
        squares += float((xp.abs(waves[rows]) ** 2 * (twice * squared)).sum(dtype=xp.float64))
    made, found = xp.fft.irfft2(waves, s=(cells, cells)), np.empty((cells, cells))
    del waves
    scale = SLOPE * cells**2 / (2.0 * math.pi * math.sqrt(squares))
    for first in blocks:
        part = made[first : first + ROWS].astype(xp.float64) * scale
        found[first : first + ROWS] = part if xp is np else xp.asnumpy(part)
    return found


@click.command()
@click.option("--cells", default=32768, show_default=True, help="Cells along a side.")
@click.option("--device", default="cuda:0", show_default=True)
@click.option("--out", type=click.Path(path_type=Path), default=Path("largest.json"), show_default=True)
def main(cells: int, device: str, out: Path) -> None:
    """Solve the largest contacts that a GPU holds, and record what they took."""
    cupy = import_module("cupy")
    field = heights(cells, xp=cupy)
    cupy.fft.config.get_plan_cache().clear()
    cupy.get_default_memory_pool().free_all_blocks()
    asked: dict[str, Any] = {"cell": 1.0 / cells, "modulus": 1.0, "mean_pressure": PRESSURE, "device": device}
    warpwear.solve_contact(field[:WARM, :WARM].copy(), tolerance=1e-2, **asked)
    rows = []
    for case, more in CASES.items():
        began, processor = time.perf_counter(), time.process_time()
        found = warpwear.solve_contact(field, tolerance=1e-4, **asked, **more)
        row = {
            "cells": cells,
            "case": case,
            "tolerance": 1e-4,
            "device": cupy.cuda.runtime.getDeviceProperties(0)["name"].decode(),
            "seconds": time.perf_counter() - began,
            "processor_seconds": time.process_time() - processor,
            "area": found.area,
            "pairs": found.evaluations,
            "violation": found.certificate.violation,
            "relative_gap": found.certificate.relative_gap,
            "host_gib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        }
        rows.append(row)
        click.echo(json.dumps(row))
        out.write_text(json.dumps({"rows": rows}, indent=1) + "\n", encoding="utf-8")
        del found


if __name__ == "__main__":
    main()
