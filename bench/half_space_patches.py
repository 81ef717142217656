"""What patches on the half-space give beside the half-space of the whole contact, and what they cost.

    python bench/half_space_patches.py [--cell "5 um"] [--hardness "590 MPa"] [--json FILE]

prints two rows a run, by the distance slid: the area in contact over that of one scale on the half-space, and
the part of the load that lies on other squares of 50 µm than there; then the seconds of all steps, the
milliseconds of one of the last hundred, and pairs of Fourier transforms a step.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from measure.machine import machine

from warpwear import Study
from warpwear.figures.data import load_share_error
from warpwear.runs.make import executor_of, model_of
from warpwear.runs.plan import plan_of
from warpwear.study.surface import surface_in

AT = (0.01, 0.3, 3.0, 30.0, 240.0, 2400.0)  # [mm]
SQUARE = 0.05  # [mm]
ELASTIC = {"contact.law": "half-space"}
NO_BULK = {"patches.bulk": "none"}
WHOLE = "one scale, half-space"
RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    WHOLE: ("v3-fine", ELASTIC),
    "one scale, local law": ("v3-fine", {}),
    "50 µm, half-space, bulk K_N": ("two-scale", ELASTIC),
    "100 µm, half-space, bulk K_N": (
        "two-scale",
        ELASTIC | {"patches.macro_cell": "100 um", "patches.width": "100 um"},
    ),
    "150 µm, half-space, bulk K_N": (
        "two-scale",
        ELASTIC | {"patches.macro_cell": "150 um", "patches.width": "150 um"},
    ),
    "50 µm, half-space, K_N updated": ("two-scale", ELASTIC | {"contact.bulk_update": "updated"}),
    "50 µm, half-space, no bulk": ("two-scale", ELASTIC | NO_BULK),
    "50 µm, half-space, free": ("two-scale", ELASTIC | NO_BULK | {"contact.boundary": "free"}),
    "50 µm, local law, bulk K_N": ("two-scale", {}),
}


def run(study: Study) -> dict[str, Any]:
    """Steps of a run without its files: areas [mm²] and loads at the distances above, seconds, transforms."""
    areas, loads, pairs, seconds = [], [], [], []
    n = round(study.grid.extent / SQUARE)
    with executor_of(study, device="cpu", threads=None) as executor:
        model = model_of(study, surface_in(study), executor).model
        start = time.perf_counter()
        for step in model.steps((increment, kept) for increment, _, kept in plan_of(study)):
            seconds.append(time.perf_counter() - start)
            pairs.append(step.row["evaluations"])
            if step.pressure is not None:
                areas.append(step.row["area_contact"])
                loads.append(step.pressure.reshape(n, -1, n, study.cells.nx // n).sum(axis=(1, 3)))
    return {
        "areas": areas,
        "loads": loads,
        "seconds": seconds[-1],
        "late_step": float(np.median(np.diff(seconds[-101:]))),
        "pairs": float(np.median(pairs)) if study.contact.law == "half-space" else None,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cell", default="5 um")
    parser.add_argument("--hardness", default="590 MPa")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print(f"{'run':32}" + "".join(f"{f'{d:g} mm':>10}" for d in AT) + "     all s  late ms     pairs")
    found: dict[str, dict[str, Any]] = {}
    of_whole: dict[str, Any] = {}
    for name, (preset, changes) in RUNS.items():
        common = {"grid.cell": options.cell, "contact.hardness": options.hardness}
        common |= {"output.snapshots": [f"{d:g} mm" for d in AT]}
        found[name] = row = run(Study.load(preset).replace(common | changes))
        if name == WHOLE:
            of_whole = dict(row)
        ratios = np.array(row["areas"]) / of_whole["areas"]
        values = [f"{v:10.5f}" for v in (row["areas"] if name == WHOLE else ratios)]
        cost = f"{row['seconds']:10.1f}{1e3 * row['late_step']:9.1f}{row['pairs'] or '–':>10}"
        print(f"{name:32}" + "".join(values) + cost)
        row["elsewhere"] = [
            load_share_error(load, other)
            for load, other in zip(row.pop("loads"), of_whole["loads"], strict=True)
        ]
        print(f"{'  load elsewhere':32}" + "".join(f"{e:10.2%}" for e in row["elsewhere"]), flush=True)
    if options.json:
        record = {"machine": machine(), "cell": options.cell, "at_mm": AT, "runs": found}
        options.json.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
