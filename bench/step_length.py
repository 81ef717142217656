"""What the length of a step does where the ball slides: the local law and the half-space, by shift.

    python bench/step_length.py [--cell "10 um"] [--extent "0.9 mm"] [--passes 12] [--hardness "590 MPa"]
        [--shifts 8 4 2 1] [--json FILE]
    python bench/step_length.py --ra 0 0.1 0.3 0.5 1 3 [--shifts 8 4 2] [--json FILE]

prints, for every shift, the mean area in contact over the first and the last pass of the preset `track`
[mm²], contacts solved a step, and pairs of Fourier transforms and milliseconds a contact. The half-space
divides a step where it must; "undivided" does not, and in "no mean" its ball is worn by the pressures at the
middle of a step besides, not by the mean of those that pass. About a quarter of an hour.

With `--ra` [µm] it prints, for each of these surfaces without a hardness (0 is a smooth one, whose disc does
not wear), the mean area of the second and third pass by steps of one cell [mm²], and by how much longer steps
change it, undivided and as it is. Half a minute a run.
"""

import argparse
import itertools
import json
import math
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
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


#: The surfaces of `--ra` are crossed by this ball.
BY_SURFACE = {
    "grid.cell": "10 um",
    "grid.extent": "0.8 mm",
    "sliding.track": "1.6 mm",
    "output.snapshots": [],
}
BY_SURFACE |= {"contact.law": "half-space", "contact.hardness": "inf MPa", "sliding.distance": "90 mm"}


def run(study: Study, cells_passing: Callable[..., int], largest_error: float) -> dict[str, Any]:
    """Areas of the passes [mm²], and what a contact costs."""
    with (
        patch.object(SlidingHalfSpace, "cells_passing", cells_passing),
        patch.object(half_space, "LARGEST_ERROR", largest_error),
    ):
        start = time.perf_counter()
        result = warpwear.run(study)
        seconds = time.perf_counter() - start
    areas = by_pass(result, "area_contact")["area_contact"]
    pairs = result.history["evaluations"]
    parts = result.history.get("parts", np.ones(pairs.size))
    return {
        "areas": areas.tolist(),
        "parts": float(parts.mean()),
        "pairs": float(pairs.sum() / parts.sum()),
        "contact_ms": 1e3 * seconds / float(parts.sum()),
    }


def of_surface(ra: float, shifts: Sequence[int]) -> list[dict[str, Any]]:
    """Rows of a surface of some roughness [µm]: areas of passes by the cells of a step, and their change."""
    rough: dict[str, Any] = {"disc.synthetic.ra": f"{ra} um", "disc.synthetic.period": "1.6 mm"}
    smooth: dict[str, Any] = {"disc.synthetic": {"kind": "flat"}, "wear.disc": "0 mm^3/N/m"}
    study = Study.load("track").replace(BY_SURFACE | (rough if ra else smooth))
    rows = []
    for shift, name in [
        (1, "half-space"),
        *itertools.product(shifts, ("half-space, undivided", "half-space")),
    ]:
        row = run(study.replace({"sliding.shift": shift}), *KINDS[name][1:])
        rows.append({"ra_um": ra, "law": name, "shift": shift} | row)
        change = 100.0 * (np.array(row["areas"]) / rows[0]["areas"] - 1.0)[1:]
        values = "".join(f"{area:10.5f}" for area in row["areas"][1:]) + "".join(
            f"{c:+9.2f} %" for c in change
        )
        print(f"{ra:<8g}{name:22}{shift:6}{values}{row['parts']:8.2f}", flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cell", default="10 um")
    parser.add_argument("--extent", default="0.9 mm")
    parser.add_argument("--passes", type=int, default=12)
    parser.add_argument("--hardness", default="590 MPa")
    parser.add_argument("--shifts", type=int, nargs="+", default=[8, 4, 2, 1])
    parser.add_argument("--ra", type=float, nargs="+", metavar="MICROMETRES")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    if options.ra is None:
        table = by_shift(options)
    else:
        print(f"{'Ra':8}{'law':22}{'shift':>6}{'passes 2, 3':>20}{'change':>22}{'parts':>8}")
        table = [row for ra in options.ra for row in of_surface(ra, [n for n in options.shifts if n > 1])]
    if options.json:
        record = {"machine": machine(), "options": {**vars(options), "json": None}, "runs": table}
        options.json.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")


def by_shift(options: argparse.Namespace) -> list[dict[str, Any]]:
    """Rows of the preset `track` by every law and shift."""
    base = {"grid.cell": options.cell, "grid.extent": options.extent, "output.snapshots": []}
    base |= {"contact.hardness": options.hardness, "sliding.distance": f"{30 * options.passes} mm"}
    heads = f"{'first pass':>12}{'last pass':>12}{'contacts':>10}{'pairs':>8}{'ms':>8}"
    print(f"{'law':22}{'shift':>6}{heads}")
    table = []
    for name, (law, *how) in KINDS.items():
        for shift in options.shifts:
            study = Study.load("track").replace(base | {"contact.law": law, "sliding.shift": shift})
            row = run(study, *how)
            table.append({"law": name, "shift": shift} | row)
            pairs = f"{row['pairs']:8.1f}" if law == "half-space" else f"{'–':>8}"
            areas = f"{row['areas'][0]:12.5f}{row['areas'][-1]:12.5f}{row['parts']:10.2f}"
            print(f"{name:22}{shift:6}{areas}{pairs}{row['contact_ms']:8.1f}", flush=True)
    return table


if __name__ == "__main__":
    main()
