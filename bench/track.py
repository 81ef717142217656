"""The reference test on a representative track, all variants beside each other: what the equations say.

    python bench/track.py [--out FOLDER] [--cells 10,5] [--shifts 4,8,16] [--seeds 3] [--pass-of-full]

Stiffness k, cell, step, plastic memory and the disc's surface are varied, nothing is fitted. Prints a table,
writes it as track.json and draws track.png. A quarter of an hour on two cores; `--cells 10 --seeds 1` takes
two minutes.
"""

import itertools
import json
import time
from pathlib import Path
from typing import Any

import click
import numpy as np
from artifact import COLOURS, Table, show
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from measure.machine import machine

import warpwear
from warpwear.results.track import by_pass

SURFACES: dict[str, dict[str, Any]] = {
    "self-affine": {},
    # A whole number of feeds closes the lap without a seam; the thesis has 0.65 mm.
    "milled": {"disc.synthetic.kind": "milled", "disc.synthetic.feed": "0.64 mm"},
}
STIFFNESSES = {"∞": "inf N/mm^3", "2e5": "2e5 N/mm^3"}
Curve = tuple[np.ndarray, np.ndarray]


def shape(slid: np.ndarray, areas: np.ndarray) -> dict[str, float]:
    """Area at the marks, exponent over the last nine tenths, slopes late and early [mm²/m]."""
    total = slid[-1] + 0.5 * (slid[1] - slid[0])

    def at(distance: float) -> float:
        return float(np.interp(distance, slid, areas))

    late = slid >= 0.1 * total
    slopes = {
        name: 1e3 * (at(end * total) - at(start * total)) / ((end - start) * total)
        for name, (start, end) in {"early": (1.0 / 80.0, 0.1), "late": (0.5, 1.0)}.items()
    }
    return {
        "area_30": at(total / 80.0),
        "area_100": at(total / 24.0),
        "area_240": at(0.1 * total),
        "area_end": float(areas[-1]),
        "exponent": float(np.polyfit(np.log(slid[late]), np.log(areas[late]), 1)[0]),
        "slope_early": slopes["early"],
        "slope_late": slopes["late"],
        "late_over_early": slopes["late"] / slopes["early"],
    }


def variant(
    surface: str, stiffness: str, cell: float, shift: int, plastic: str, seed: int, distance: float
) -> Any:
    """Numbers and curve of one run."""
    study = warpwear.Study.load("track").replace(
        {
            "grid.cell": f"{cell} um",
            "sliding.distance": f"{distance} mm",
            "sliding.shift": shift,
            "sliding.plastic": plastic,
            "contact.stiffness": STIFFNESSES[stiffness],
            "disc.synthetic.seed": seed,
            "output.snapshots": [],
            **SURFACES[surface],
        }
    )
    started = time.perf_counter()
    result = warpwear.run(study)
    took = time.perf_counter() - started
    passes = by_pass(result, "area_contact")
    curve = ((passes["number"] - 0.5) * study.track.stroke, passes["area_contact"])
    history = result.history
    first = np.searchsorted(history["distance"], study.sliding.stroke)
    found = {
        "surface": surface,
        "k_N_per_mm3": stiffness,
        "cell_um": cell,
        "shift": shift,
        "plastic": plastic,
        "seed": seed,
        **shape(*curve),
        "plastic_over_wear_first_pass": float(
            history["plastic_volume_disc"][first] / history["wear_volume_disc"][first]
        ),
        "patch_across": float(history["patch_across"][-1]),
        "seconds": took,
    }
    return found, curve


def draw(table: Table, curves: list[Curve]) -> Figure:
    """Area over distance, one panel a surface and stiffness: colours are steps, thick lines finer cells."""
    figure = Figure(figsize=(11.0, 8.0), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    coarsest = max(row["cell_um"] for row in table)
    steps = sorted({row["cell_um"] * row["shift"] for row in table})
    for panel, (surface, stiffness) in zip(
        axes.ravel(), itertools.product(SURFACES, STIFFNESSES), strict=True
    ):
        for row, (slid, areas) in zip(table, curves, strict=True):
            if (row["surface"], row["k_N_per_mm3"]) == (surface, stiffness):
                panel.loglog(
                    slid,
                    areas,
                    color=COLOURS[steps.index(row["cell_um"] * row["shift"]) % len(COLOURS)],
                    ls="-" if row["plastic"] == "forget" else "--",
                    lw=0.8 if row["cell_um"] == coarsest else 1.8,
                )
        panel.axhline(8.0 / 590.0, color="#999999", lw=0.6)
        panel.annotate("F/H", (2400.0, 8.0 / 590.0), ha="right", va="bottom", fontsize=7, color="#777777")
        unit = "" if stiffness == "∞" else " N/mm³"
        panel.set_title(f"{surface}, k = {stiffness}{unit}")
        panel.spines[["top", "right"]].set_visible(False)
    for panel in axes[1]:
        panel.set_xlabel("sliding distance, mm")
    for panel in axes[:, 0]:
        panel.set_ylabel("area in contact, mm² (mean of a pass)")
    handles = [
        Line2D([], [], color=COLOURS[number % len(COLOURS)], label=f"steps of {step:g} µm")
        for number, step in enumerate(steps)
    ]
    for plastic, style in (("forget", "-"), ("keep", "--")):
        handles.append(Line2D([], [], color="#444444", ls=style, label=f"plastic = '{plastic}'"))
    for cell in sorted({row["cell_um"] for row in table}):
        width = 0.8 if cell == coarsest else 1.8
        handles.append(Line2D([], [], color="#444444", lw=width, label=f"cells of {cell:g} µm"))
    axes[0, 0].legend(handles=handles, fontsize=8, frameon=False)
    return figure


def pass_of_full() -> Table:
    """One pass of the whole track at 1 µm."""
    study = warpwear.Study.load("track").replace(
        {"grid.cell": "1 um", "sliding.track": "full", "sliding.distance": "30 mm", "output.snapshots": []}
    )
    started = time.perf_counter()
    result = warpwear.run(study)
    return [
        {
            "track": "full, 1 µm, one pass",
            "steps": result.history["distance"].size,
            "seconds_of_steps": result.record["elapsed_s"],
            "seconds": time.perf_counter() - started,
        }
    ]


@click.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("track"), show_default=True)
@click.option("--cells", default="10,5", show_default=True, help="Cell sizes, µm.")
@click.option("--shifts", default="4,8,16", show_default=True, help="Steps, cells.")
@click.option("--seeds", type=click.IntRange(1), default=3, show_default=True, help="At the coarsest cell.")
@click.option("--distance", type=float, default=2400.0, show_default=True, help="mm")
@click.option("--pass-of-full", "full", is_flag=True, help="One pass of the whole track at 1 µm too.")
def main(out: Path, cells: str, shifts: str, seeds: int, distance: float, full: bool) -> None:
    """All variants of the sliding counter-body in one table and one plot."""
    started = time.perf_counter()
    sizes = [float(cell) for cell in cells.split(",")]
    steps = [int(shift) for shift in shifts.split(",")]
    table: Table = []
    curves: list[Curve] = []
    for cell in sizes:
        count = seeds if cell == max(sizes) else 1
        for surface, stiffness, shift, plastic, seed in itertools.product(
            SURFACES, STIFFNESSES, steps, ("forget", "keep"), range(1, 1 + count)
        ):
            found, curve = variant(surface, stiffness, cell, shift, plastic, seed, distance)
            table.append(found)
            curves.append(curve)
    show("Area in contact (mm², mean of a pass), exponent, slopes (mm²/m)", table)
    parts: dict[str, Any] = {"variants": table}
    if full:
        parts["full"] = pass_of_full()
        show("One pass of the whole track", parts["full"])
    out.mkdir(parents=True, exist_ok=True)
    parts |= {"machine": machine(), "elapsed_s": time.perf_counter() - started}
    parts["curves"] = [[slid.tolist(), areas.tolist()] for slid, areas in curves]
    (out / "track.json").write_text(json.dumps(parts, indent=1, default=float), encoding="utf-8")
    draw(table, curves).savefig(out / "track.png", dpi=150)
    click.echo(f"written to {out}/ after {parts['elapsed_s']:.0f} s")


if __name__ == "__main__":
    main()
