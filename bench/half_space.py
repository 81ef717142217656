"""The half-space beside its peers: one rough surface, elastic and capped, judged by one measure.

    python bench/half_space.py --cells 512 1024 [--peers PYTHON] [--without tamaas-capped] [--json FILE]
    python bench/half_space.py --cells 4096 --cases capped --contenders warpwear --device cuda:0

Each contender solves in a process of its own; a peer that is not installed is left out (PYTHON: an
interpreter that has tamaas and ContactMechanics). The residual is ours, of everybody's pressure: the largest
violation of complementarity over the rms height. The peers compute on one thread, ours on two: ratios are
given of processor time, which other work on the machine hardly lengthens and which flatters one thread, and
of the peer's processor time to our best time by the clock.
"""

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from contenders.half_space import MODULUS
from measure.machine import machine

from warpwear.contact.influence import periodic_spectrum
from warpwear.grid import Grid
from warpwear.surfaces.made.self_affine import SelfAffine

HURST, SLOPE = 0.8, 0.1
MEAN_PRESSURE = 0.005 * MODULUS
CAPS = {"elastic": math.inf, "capped": 0.05 * MODULUS}
#: ContactMechanics' own choice at 1024²; tamaas' measure is a mean, on which the same number is as strict.
TOLERANCE = 1e-4
OUR_REPEATS = 3
CONTENDERS = ("warpwear", "ContactMechanics", "tamaas")
#: Only ours wears.
WEAR = ("wear_step_seconds",)
HERE = Path(__file__).parent


def surface(cells: int) -> Any:
    """Heights on 1 × 1, all waves down to two cells, rms slope 0.1."""
    waves = SelfAffine(hurst=HURST, roll_off=0.999, cut_off=2.0 / cells, period=1.0, sq=1.0)
    grid = Grid(cells, cells, 1.0 / cells)
    return waves.heights(grid.x, grid.y) * (SLOPE / waves.rms_slope)


def judge(heights: Any, pressure: Any, cap: float) -> dict[str, float]:
    """Residual, area and load of a pressure, by NumPy alone."""
    n = heights.shape[0]
    pressure = np.clip(pressure, 0.0, cap)
    spectrum = np.fft.rfft2(pressure) * periodic_spectrum(Grid(n, n, 1.0 / n), MODULUS)
    gap = np.fft.irfft2(spectrum, s=heights.shape) - heights
    level = gap[(pressure > 0.0) & (pressure < cap)].mean()
    above = (gap[pressure > 0.0] - level).max()
    below = (level - gap[pressure < cap]).max()
    return {
        "residual": max(above, below) / heights.std(),
        "area": float((pressure > 0.0).mean()),
        "load_residual": pressure.mean() / MEAN_PRESSURE - 1.0,
    }


def solve(
    name: str, interpreter: str, heights: Any, cap: float, folder: Path, device: str
) -> dict[str, Any] | None:
    """One contender; None where it is not installed or fails."""
    np.save(folder / "heights.npy", heights)
    case = {
        "cap": cap,
        "mean_pressure": MEAN_PRESSURE,
        "tolerance": TOLERANCE,
        "repeats": OUR_REPEATS if name == "warpwear" else 1,
        "device": device,
    }
    script = str(HERE / "contenders" / "half_space.py")
    files = [str(folder / "heights.npy"), str(folder / "pressure.npy")]
    environment = dict(os.environ)
    # Peers take minutes of processor time; whoever else works here need not wait for them.
    polite = ["nice", "-n", "15"] if name != "warpwear" and shutil.which("nice") else []
    if name == "warpwear":
        environment["PYTHONPATH"] = os.pathsep.join([str(HERE.parent), environment.get("PYTHONPATH", "")])
    done = subprocess.run(
        [*polite, interpreter, script, name, *files, json.dumps(case)],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
    )
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["?"])[-1]
        print(f"{name}: left out ({reason})", file=sys.stderr)
        return None
    record: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return record | judge(heights, np.load(folder / "pressure.npy"), cap)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cells", type=int, nargs="+", default=[512])
    parser.add_argument("--peers", default=sys.executable, help="an interpreter that has them")
    parser.add_argument("--without", nargs="*", default=[], help="such as tamaas-capped, which takes minutes")
    parser.add_argument("--cases", nargs="+", choices=CAPS, default=[*CAPS])
    parser.add_argument("--contenders", nargs="+", choices=CONTENDERS, default=CONTENDERS)
    parser.add_argument("--device", default="cpu", help="of warpwear")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    rows = []
    heads = ("clock s", "cpu s", "×cpu", "×clock", "iter", "residual", "area", "MiB", "wear step")
    print("cells case     contender        " + "".join(f"{head:>10}" for head in heads))
    for cells in options.cells:
        heights = surface(cells)
        for case, cap in ((case, CAPS[case]) for case in options.cases):
            clock = processor = math.nan
            for name in options.contenders:
                if f"{name}-{case}" in options.without:
                    continue
                interpreter = sys.executable if name == "warpwear" else options.peers
                with tempfile.TemporaryDirectory() as folder:
                    row = solve(name, interpreter, heights, cap, Path(folder), options.device)
                if row is None:
                    continue
                clocked, used = min(row["seconds"]), min(row["processor_seconds"])
                if name == "warpwear":
                    clock, processor = clocked, used
                ratios = [used / processor, used / clock]
                rows.append({"cells": cells, "case": case, "contender": name, "ratios": ratios, **row})
                values = [f"{clocked:.3f}", f"{used:.3f}", *(f"{ratio:.1f}" for ratio in ratios)]
                values += [str(row["iterations"] or "–"), f"{row['residual']:.1e}", f"{row['area']:.5f}"]
                values += [
                    f"{row['memory_mib']:.0f}",
                    *(f"{min(row[key]):.3f}" for key in WEAR if key in row),
                ]
                print(f"{cells:5d} {case:8} {name:16} " + "".join(f"{v:>10}" for v in values), flush=True)
    if options.json:
        options.json.write_text(
            json.dumps({"machine": machine(), "device": options.device, "rows": rows}, indent=1)
        )


if __name__ == "__main__":
    main()
