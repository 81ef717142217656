"""Holds the errors that verdicts tell of an area to finer runs of the same test.

    python bench/verdict.py [--processes 2] [--only "film;cylinder"] [--finer 4] [--shorter 8]

Each case is run as it is and once more, in cells `--finer` times smaller and on a track in steps `--shorter`
times shorter; the half-space divides its steps by itself. The table has the told parts in % of the area,
their sum, the change to the finer run (of the corrected area where the verdict has it), and told over true:
below 1 a verdict has told too little. The coarse cells resolve the waves of all surfaces: both runs have the
same one.
"""

import argparse
import statistics
import sys
import tempfile
import time
import warnings
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import zoom

import warpwear
from warpwear import Study

#: A ball on a rough lap, by the local law: 30 cycles to and fro on a representative track.
BALL: dict[str, Any] = {
    **{"counter.radius": "3 mm", "contact.load": "5 N", "wear.counter": "1e-6 mm^3/N/m"},
    **{"wear.disc": "1e-4 mm^3/N/m", "grid.cell": "5 um", "grid.extent": "0.32 mm"},
    **{"sliding.stroke": "1 mm", "sliding.track": "0.4 mm", "sliding.distance": "60 mm", "sliding.shift": 8},
    **{"disc.synthetic.ra": "0.1 um", "disc.synthetic.cut_off": "20 um", "disc.synthetic.period": "0.4 mm"},
    **{"output.snapshots": [], "stepping.jump": 1, "friction.shear_strength": "60 MPa"},
}
FULL = {"sliding.track": "full", "sliding.stroke": "0.4 mm", "disc.synthetic.period": "0.8 mm"}
ROUND = {"sliding.stroke": None, "sliding.track": "full", "sliding.track_radius": "80 um"}
SMOOTH = {"disc.synthetic": {"kind": "flat"}}
WIDER = {"grid.extent": "0.4 mm", "sliding.track": "0.48 mm", "disc.synthetic.period": "0.48 mm"}
SOFT = {"contact.hardness": "inf MPa"}
#: The same at rest.
SPOT: dict[str, Any] = {
    **{"counter.radius": "3 mm", "contact.load": "5 N", "wear.counter": "1e-5 mm^3/N/m"},
    **{"wear.disc": "1e-4 mm^3/N/m", "grid.cell": "5 um", "grid.extent": "0.32 mm"},
    **{"sliding.distance": "30 mm", "sliding.kinematics": "stationary", "sliding.stroke": None},
    **{"disc.synthetic.ra": "0.1 um", "disc.synthetic.cut_off": "20 um", "output.snapshots": []},
}
HALF_SPACE = {
    **{"contact.law": "half-space", "counter.young": "210 GPa", "counter.poisson": 0.3},
    **{"disc.young": "210 GPa", "disc.poisson": 0.3},
}
LINE = {
    **{"counter.shape": "cylinder", "contact.load": "20 N/mm", "grid.extent": ["0.32 mm", "80 um"]},
    **{"counter.radius": "6 mm"},
}
FRETTING = {
    **{"sliding.kinematics": "fretting", "sliding.stroke": "40 um", "sliding.distance": "4000 mm"},
    **{"wear.counter": "1e-7 mm^3/N/m", "wear.disc": "1e-7 mm^3/N/m"},
    **{"friction.law": "coulomb", "friction.coefficient": 0.6, "friction.shear_strength": None},
}
FILM = {
    **{"friction.film.thickness": "30 nm", "friction.film.shear_strength": "12 MPa"},
    **{"friction.film.regrowth": "1 mm"},
}
LAYERS = [{"name": "coat", "thickness": "0.15 um", "wear": "2e-5 mm^3/N/m"}]
RUNNING_IN = {
    **{"wear.law": "running-in", "wear.running_in": "20 mm", "wear.initial_disc": "5e-4 mm^3/N/m"},
}
BLOCKS = [{"load": "3 N", "passes": 20}, {"load": "6 N", "passes": 40}]
CIRCLES = [
    {"load": "5 N", "passes": 30, "stroke": "0.4 mm"},
    {"load": "5 N", "passes": 30, "stroke": "0.6 mm"},
]
MILLED = {
    "disc.synthetic": {
        **{"kind": "milled", "ra": "0.2 um", "feed": "80 um", "fine_ra": "0.05 um", "cut_off": "20 um"},
        **{"period": "0.4 mm"},
    },
}
#: Name: the preset, and what is changed in it.
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "lap": ("track", BALL),
    "lap, seed 5": ("track", BALL | {"disc.synthetic.seed": 5}),
    "lap, not capped": ("track", BALL | SOFT),
    "lap, ball wears": ("track", BALL | {"wear.counter": "1e-4 mm^3/N/m"}),
    "lap, ball alone wears": ("track", BALL | {"wear.counter": "1e-4 mm^3/N/m", "wear.disc": "0 mm^3/N/m"}),
    "lap, both wear by little": (
        "track",
        BALL | {"wear.counter": "1e-5 mm^3/N/m", "wear.disc": "1e-5 mm^3/N/m"},
    ),
    "lap, harder": ("track", BALL | {"contact.hardness": "1500 MPa"}),
    "lap, exponential": ("track", BALL | {"wear.law": "exponential", "wear.decay": "0.02 1/mm"}),
    "lap, long": ("track", BALL | {"sliding.distance": "240 mm"}),
    "revolutions": ("track", BALL | ROUND),
    "revolutions, not capped, film": ("track", BALL | ROUND | SOFT | FILM),
    "stroke, not capped": ("track", BALL | FULL | SOFT),
    "lap, milled": ("track", BALL | MILLED),
    "lap, measured": ("track", BALL | {"disc.surface": "measured"}),
    "lap, film": ("track", BALL | FILM),
    "lap, layers": ("track", BALL | {"disc.layers": LAYERS}),
    "lap, layers, not capped": ("track", BALL | SOFT | {"disc.layers": LAYERS}),
    "lap, running-in": ("track", BALL | RUNNING_IN),
    "lap, energy": (
        "track",
        BALL | {"wear.law": "energy", "wear.counter": "1e-6 mm^3/J", "wear.disc": "2e-4 mm^3/J"},
    ),
    "lap, on springs, jumps": (
        "track",
        BALL | {"contact.stiffness": "1e6 N/mm^3", "stepping.jump": "auto", "sliding.distance": "400 mm"},
    ),
    "lap, keeps dents": ("track", BALL | WIDER | {"sliding.plastic": "keep", "sliding.distance": "20 mm"}),
    "lap, programme": ("track", BALL | {"block": BLOCKS}),
    "lap, crowned": (
        "track",
        BALL
        | {
            "counter.shape": "crowned",
            "counter.radius": None,
            "counter.radius_along": "2 mm",
            "counter.radius_across": "6 mm",
        },
    ),
    "lap, cylinder": ("track", BALL | LINE),
    "lap, pin": (
        "track",
        BALL | {"counter.shape": "pin", "counter.radius": "60 um", "counter.edge_radius": "40 um"},
    ),
    "stroke": ("track", BALL | FULL),
    "stroke, programme": ("track", BALL | FULL | {"block": CIRCLES}),
    "stroke shorter than the contact": (
        "track",
        BALL | FULL | {"sliding.stroke": "80 um", "sliding.distance": "12 mm", "sliding.shift": 4},
    ),
    "revolutions, smooth": (
        "track",
        BALL | SMOOTH | ROUND,
    ),
    "spot": ("v3-fine", SPOT),
    "spot, measured": ("v3-fine", SPOT | {"disc.surface": "measured"}),
    "spot, layers": ("v3-fine", SPOT | {"disc.layers": LAYERS}),
    "spot, film": ("v3-fine", SPOT | FILM | {"friction.shear_strength": "60 MPa"}),
    "spot, running-in": ("v3-fine", SPOT | RUNNING_IN),
    "spot, cylinder": ("v3-fine", SPOT | LINE),
    "spot, smooth": ("v3-fine", SPOT | SMOOTH),
    "spot, half-space, measured": ("v3-fine", SPOT | HALF_SPACE | {"disc.surface": "measured"}),
    "spot, half-space, cylinder": ("v3-fine", SPOT | HALF_SPACE | LINE | {"contact.boundary": "line"}),
    "spot, half-space, layers": ("v3-fine", SPOT | HALF_SPACE | {"disc.layers": LAYERS}),
    "spot, half-space, not capped": ("v3-fine", SPOT | HALF_SPACE | SOFT | {"wear.counter": "1e-6 mm^3/N/m"}),
    "fretting": ("v3-fine", SPOT | HALF_SPACE | FRETTING),
    "fretting, cylinder": (
        "v3-fine",
        SPOT | HALF_SPACE | FRETTING | SMOOTH | LINE | {"contact.boundary": "line"},
    ),
    "lap, half-space": ("track", BALL | HALF_SPACE),
    "lap, half-space, measured": ("track", BALL | HALF_SPACE | {"disc.surface": "measured"}),
    "lap, half-space, film": ("track", BALL | HALF_SPACE | FILM),
    "lap, half-space, layers": ("track", BALL | HALF_SPACE | {"disc.layers": LAYERS}),
    "lap, half-space, cylinder": ("track", BALL | HALF_SPACE | LINE | {"contact.boundary": "line"}),
    "lap, half-space, programme": ("track", BALL | HALF_SPACE | {"block": BLOCKS}),
    "revolutions, half-space, smooth": (
        "track",
        BALL | HALF_SPACE | SMOOTH | ROUND,
    ),
}


def measured_surface(folder: Path) -> Path:
    """Write heights [mm] on points of 1.25 µm, 0.4 by 0.4 mm, with no wave shorter than 20 µm, and skewed."""
    rng = np.random.default_rng(11)
    coarse = np.abs(rng.normal(size=(40, 40))) ** 0.7  # plateaus with valleys, on points of 10 µm
    heights = zoom(-coarse, 8, order=3, mode="grid-wrap", grid_mode=True)
    path = folder / "measured.npy"
    np.save(path, 2.0e-4 * heights)
    return path


def study_of(name: str, surface: Path, *, finer: float = 1.0, shorter: float = 1.0) -> Study:
    """Return the study of a case in cells and steps so much smaller."""
    preset, changes = CASES[name]
    changes, cell = dict(changes), float(changes["grid.cell"].split()[0])
    changes["grid.cell"] = f"{cell / finer:.9g} um"
    if "sliding.shift" in changes:
        changes["sliding.shift"] = max(round(changes["sliding.shift"] * finer / shorter), 1)
    if "disc.surface" in changes:
        changes = {key: value for key, value in changes.items() if not key.startswith("disc.synthetic")}
        changes |= {"disc.surface": str(surface), "disc.pixel": "1.25 um", "disc.height_unit": "mm"}
        changes |= {"disc.synthetic": None, "disc.extend": "periodic"}
    if "disc.synthetic" in changes:
        changes = {key: value for key, value in changes.items() if not key.startswith("disc.synthetic.")}
    blocks = changes.pop("block", None)
    study = Study.load(preset).replace(changes)
    return study.replace(block=blocks) if blocks else study


def judge(name: str, surface: Path, finer: float, shorter: float) -> dict[str, Any]:
    """Run a case twice: what was told, and what the finer run says."""
    start, found = time.perf_counter(), dict[str, Any]()
    warnings.simplefilter("ignore")
    try:
        pair = [
            warpwear.run(study_of(name, surface, finer=f, shorter=s), threads=1).summary
            for f, s in ((1.0, 1.0), (finer, shorter))
        ]
    except (warpwear.InputError, ValueError, ArithmeticError) as error:
        return {"refused": str(error)}
    told, areas = (
        pair[0]["verdict"],
        [s["verdict"]["area_corrected_mm2"] or s["area_mm2"]["contact"] for s in pair],
    )
    scars = [[*s["scar_mm"].values()] for s in pair]
    found |= {"told": told["area_relative"], "parts": told["area_parts"], "true": areas[1] / areas[0] - 1.0}
    pair_of = zip(*scars, strict=True)
    found["scar"] = max(abs(a - b) for a, b in pair_of), told["scar_error_mm"]
    return found | {"s": time.perf_counter() - start}


def line(name: str, found: dict[str, Any]) -> str:
    """Say in a row of the table what was found."""
    if "refused" in found:
        return f"| {name} | {found['refused']} |"
    parts = ", ".join(
        f"{what} {'not known' if part is None else f'{100.0 * part:.2g}'}"
        for what, part in found["parts"].items()
        if part is None or part > 5e-4
    )
    told, true = found["told"], found["true"]
    ratio = "" if told is None else f"{told / max(abs(true), 1e-9):.2g}"
    total = "not known" if told is None else f"{100.0 * told:.2g}"
    scar = " of ".join("not known" if error is None else f"{1e3 * error:.3g}" for error in found["scar"])
    row = name, parts, total, f"{100.0 * true:+.2f}", ratio, scar, f"{found['s']:.0f}"
    return f"| {' | '.join(row)} |"


def main() -> None:
    """Print the table, a row as soon as it is found, and how many errors hold."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--only", default="", help="parts of names of cases, separated by ;")
    parser.add_argument("--finer", type=float, default=4.0, help="cell over that of the finer run")
    parser.add_argument("--shorter", type=float, default=8.0, help="step over that of the finer run, in mm")
    options = parser.parse_args()
    names = [name for name in CASES if any(word in name for word in options.only.split(";"))]
    print(
        "| case | told parts, % | told | true | told/true | scar off, of told, µm | s |\n" + "|---" * 7 + "|"
    )
    ratios = []
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(options.processes) as pool:
        surface = measured_surface(Path(folder))
        waiting = {pool.submit(judge, name, surface, options.finer, options.shorter): name for name in names}
        for done in as_completed(waiting):
            found = done.result()
            print(line(waiting[done], found), flush=True)
            if found.get("told") is not None:
                ratios.append(found["told"] / max(abs(found["true"]), 1e-9))
    if ratios:
        hold = sum(ratio >= 1.0 for ratio in ratios)
        median = statistics.median(ratios)
        print(
            f"\nheld in {hold} of {len(ratios)}, told over true {median:.2g} in the median", file=sys.stdout
        )


if __name__ == "__main__":
    main()
