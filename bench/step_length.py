"""What the length of a step does where the ball slides: the local law and the half-space, by shift.

    python bench/step_length.py [--cell "10 um"] [--extent "0.9 mm"] [--passes 12] [--hardness "590 MPa"]
        [--shifts 8 4 2 1] [--json FILE]

prints, for every shift, the mean area in contact over the first and the last pass of the preset `track`
[mm²], pairs of Fourier transforms and milliseconds a step. The half-space divides a step where it must;
"undivided" does not, and in "no mean" its ball is worn by the pressures at the middle of a step besides, not
by the mean of those that pass. About a quarter of an hour.
"""

import argparse
import json
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

from measure.machine import machine

import warpwear
from warpwear import Study
from warpwear.models.track import half_space
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.results.track import by_pass

AS_IT_IS = SlidingHalfSpace.cells_passing, half_space.LARGEST_ERROR
KINDS: dict[str, tuple[str, Callable[..., int], float]] = {
    "local law": ("local", *AS_IT_IS),
    "half-space": ("half-space", *AS_IT_IS),
    "half-space, undivided": ("half-space", AS_IT_IS[0], math.inf),
    "half-space, no mean": ("half-space", lambda *_: 1, math.inf),
}


def run(study: Study, cells_passing: Callable[..., int], largest_error: float) -> dict[str, Any]:
    """Areas of the first and the last pass [mm²], and what a step costs."""
    with (
        patch.object(SlidingHalfSpace, "cells_passing", cells_passing),
        patch.object(half_space, "LARGEST_ERROR", largest_error),
    ):
        start = time.perf_counter()
        result = warpwear.run(study)
        seconds = time.perf_counter() - start
    areas = by_pass(result, "area_contact")["area_contact"]
    pairs = result.history["evaluations"]
    return {
        "first": float(areas[0]),
        "last": float(areas[-1]),
        "pairs": float(pairs.mean()),
        "step_ms": 1e3 * seconds / pairs.size,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cell", default="10 um")
    parser.add_argument("--extent", default="0.9 mm")
    parser.add_argument("--passes", type=int, default=12)
    parser.add_argument("--hardness", default="590 MPa")
    parser.add_argument("--shifts", type=int, nargs="+", default=[8, 4, 2, 1])
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    base = {"grid.cell": options.cell, "grid.extent": options.extent, "output.snapshots": []}
    base |= {"contact.hardness": options.hardness, "sliding.distance": f"{30 * options.passes} mm"}
    print(f"{'law':22}{'shift':>6}{'first pass':>12}{'last pass':>12}{'pairs':>8}{'ms a step':>11}")
    table = []
    for name, (law, *how) in KINDS.items():
        for shift in options.shifts:
            study = Study.load("track").replace(base | {"contact.law": law, "sliding.shift": shift})
            row = run(study, *how)
            table.append({"law": name, "shift": shift} | row)
            pairs = f"{row['pairs']:8.1f}" if law == "half-space" else f"{'–':>8}"
            areas = f"{row['first']:12.5f}{row['last']:12.5f}"
            print(f"{name:22}{shift:6}{areas}{pairs}{row['step_ms']:11.1f}", flush=True)
    if options.json:
        record = {"machine": machine(), "options": {**vars(options), "json": None}, "runs": table}
        options.json.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
