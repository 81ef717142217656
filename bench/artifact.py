"""The coarse-mesh artifact of the thesis's rough model, and the four parts of its cure.

    python bench/artifact.py [--out FOLDER] [--quick]

prints a table a part, writes them as artifact.json and draws artifact.png. About two minutes on two cores.
"""

import json
import time
from itertools import product
from pathlib import Path
from typing import Any

import click
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from measure.machine import machine
from scipy import ndimage

import warpwear
from warpwear.results.track import shape_of_growth
from warpwear.study.surface import surface_of

Table = list[dict[str, Any]]


def run(preset: str, changes: dict[str, Any]) -> warpwear.Result:
    """A preset with changes, in memory, with no snapshots beside the end."""
    study = warpwear.Study.load(preset).replace({"output.snapshots": [], **changes})
    return warpwear.run(study)


def um(length: float) -> str:
    return f"{length:g} um"


def tolerance_part(cells: list[float], distance: float) -> Table:
    """Scatter of the mean pressure over the steps, p = F/A, at either load tolerance."""
    table = []
    for tolerance, cell in product(("0.5 N", "one cell"), cells):
        changes = {"grid.cell": um(cell), "stepping.load_tolerance": tolerance}
        means = run("v3", changes | {"sliding.distance": f"{distance} mm"}).history["pressure_mean"]
        row = {"tolerance": tolerance, "cell_um": cell, "steps": means.size}
        table.append(row | {"pressure_mean_MPa": means.mean(), "pressure_std_MPa": means.std()})
    return table


def mesh_part(cells: list[float], cut_offs: list[float], seeds: list[int]) -> Table:
    """Static contact of one surface at several cells: rms slope as sampled, islands, single-cell islands."""
    table = []
    for seed in seeds:
        for cut_off in cut_offs:
            for cell in cells:
                changes = {
                    "grid.cell": um(cell),
                    "disc.synthetic.seed": seed,
                    "disc.synthetic.cut_off": um(cut_off),
                    "sliding.distance": "0 mm",
                }
                result = run("v3-fine", changes)
                labels, islands = ndimage.label(result.snapshot(-1).pressure > 0.0)
                sizes = np.bincount(labels.ravel())[1:]
                study = result.study
                heights = surface_of(study.disc).heights(study.cells.x, study.cells.y)
                slopes = np.diff(heights, axis=0) / study.grid.cell
                table.append(
                    {
                        "seed": seed,
                        "cut_off_um": cut_off,
                        "cell_um": cell,
                        # Of both directions, of which an isotropic surface needs one.
                        "rms_slope": float(np.sqrt(2.0 * np.mean(slopes**2))),
                        "islands": islands,
                        "single_cell": int((sizes == 1).sum()),
                        "area_mm2": result.history["area_contact"][-1],
                    }
                )
    return table


def time_part(increments: list[float], cell: float, distance: float) -> Table:
    """Explicit and implicit wear at several increments: the area worn, and the wear against the finest.

    Without a foundation and away from the cap an implicit step is exact, whatever its size: what is left of
    its error is round-off.
    """
    finest = min(increments) / 8.0
    changes = {
        "grid.cell": um(cell),
        "sliding.distance": f"{distance} mm",
        "wear.distance_factor": "none",
        "stepping.load_tolerance": "one cell",
    }

    def worn(scheme: str, increment: float) -> tuple[np.ndarray, float, float]:
        result = run("v3", changes | {"stepping.scheme": scheme, "stepping.increment": f"{increment} mm"})
        history = result.history
        return result.snapshot(-1).wear_disc, history["area_touched"][-1], history["area_contact"][-1]

    reference, _, _ = worn("implicit", finest)
    table = []
    for scheme in ("explicit", "implicit"):
        for increment in increments:
            wear, touched, contact = worn(scheme, increment)
            error = float(np.sqrt(np.mean((wear - reference) ** 2) / np.mean(reference**2)))
            row = {"scheme": scheme, "increment_mm": increment, "wear_error": error}
            table.append(row | {"area_touched_mm2": touched, "area_contact_mm2": contact})
    return table


def area_part(distance: float) -> tuple[Table, dict[str, np.ndarray]]:
    """Which area of the published model makes its coefficient a straight line."""
    history = run("v3", {"sliding.distance": f"{distance} mm"}).history
    slid = history["distance"]
    table = []
    for area in ("contact", "touched", "cumulative"):
        values = history[f"area_{area}"]
        table.append(
            {
                "area": area,
                "first_mm2": values[0],
                "end_mm2": values[-1],
                "r_squared": float(np.corrcoef(slid, values)[0, 1] ** 2) if np.ptp(values) > 0 else None,
            }
        )
    return table, history


def cured_part(cells: list[float], distance: float) -> tuple[Table, dict[str, Any]]:
    """All four together, on one surface at several cells; V1 is the same with a smooth disc."""
    table = []
    curves: dict[str, Any] = {}
    for name, kind, cell in [("smooth disc", "flat", 5.0)] + [("rough", "self-affine", c) for c in cells]:
        changes = {
            "grid.cell": um(cell),
            "sliding.distance": f"{distance} mm",
            "disc.synthetic.kind": kind,
            "output.snapshots": ["30 mm", "240 mm"],
        }
        result = warpwear.run(warpwear.Study.load("v3-fine").replace(changes))
        slid, area = result.history["distance"], result.history["area_contact"]
        table.append(
            {
                "disc": name,
                "cell_um": cell,
                "area_first_mm2": area[0],
                "area_30_mm2": float(np.interp(30.0, slid, area)),
                "area_240_mm2": float(np.interp(240.0, slid, area)),
                "area_end_mm2": area[-1],
                "pressure_end_MPa": result.history["pressure_mean"][-1],
                **shape_of_growth(slid, area),
                "elapsed_s": result.record["elapsed_s"],
            }
        )
        curves[f"{name}, {cell:g} µm"] = slid, area
    return table, curves


VERDICT = """
What this shows. The published pressure is pinned because the hardness law sets p = H on every cell in
contact, and the area in contact is F/H at any mesh: neither moves when the mesh is refined. The straight
line of the published coefficient of friction is what a running sum of areas gives; that the thesis plots
that sum is an inference, its text does not say. Cured in all four parts (a tolerance of one cell, cells that
resolve the surface, implicit steps, the area in contact at the moment) the area starts at F/H, grows with m
near 0.5 and levels with λ near 0.24, and the mesh no longer matters.

What it does not show. On a stationary footprint the bodies conform within about one pass (the disc keeps the
fraction K_s/(K_s + K_d) of its roughness, the ball carries its imprint, and the gap is gone), and the
converged equations become those of a smooth disc (V1): at the end everything touches, at a few MPa. That is
what the equations imply, not what steel does. That the surface converges at all is owed to its shortest
wave: with a shorter cut-off there are more and smaller islands, and finer cells are needed.
"""


def show(title: str, table: Table) -> None:
    """Print a table."""
    click.echo(f"\n{title}")
    click.echo("  ".join(f"{key:>18}" for key in table[0]))
    for row in table:
        cells = (f"{v:.5g}" if isinstance(v, float) else str(v) for v in row.values())
        click.echo("  ".join(f"{cell:>18}" for cell in cells))


COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#444444")
AREA_LABELS = {"contact": "in contact", "touched": "ever touched", "cumulative": "running sum"}


def lines(axes: Axes, table: Table, by: str, x: str, y: str, label: str, **style: Any) -> None:
    """One line for each value of the column `by`, over ticks at the values of the column `x`."""
    for value, colour in zip(dict.fromkeys(row[by] for row in table), COLOURS, strict=False):
        rows = [row for row in table if row[by] == value]
        text = label.format(value) if label else None
        axes.plot([r[x] for r in rows], [r[y] for r in rows], color=colour, label=text, **style)
    ticks = sorted({row[x] for row in table})
    axes.set_xscale("log")
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()


def draw(parts: dict[str, Table], published: dict[str, np.ndarray], curves: dict[str, Any]) -> Figure:
    """The four parts and the cure in one figure."""
    figure = Figure(figsize=(10.5, 6.0), layout="constrained")
    (tolerance, mesh, steps), (area, cured, start) = figure.subplots(2, 3)

    lines(tolerance, parts["tolerance"], "tolerance", "cell_um", "pressure_std_MPa", "{}", marker="o")
    tolerance.set(yscale="log", xlabel="cell, µm", title="1. load tolerance")
    tolerance.set_ylabel("scatter of pressure over steps, MPa")

    one_surface = [row for row in parts["mesh"] if row["seed"] == parts["mesh"][0]["seed"]]
    lines(mesh, one_surface, "cut_off_um", "cell_um", "islands", "λs = {:g} µm", marker="o")
    lines(mesh, one_surface, "cut_off_um", "cell_um", "single_cell", "", marker="x", ls=":")
    mesh.set(xlabel="cell, µm", ylabel="islands (dotted: of one cell)", title="2. mesh")

    lines(steps, parts["time"], "scheme", "increment_mm", "wear_error", "{}", marker="o")
    steps.set(yscale="log", xlabel="sliding increment, mm", title="3. time")
    steps.set_ylabel("rms error of the wear depth, relative")

    for (name, label), colour in zip(AREA_LABELS.items(), COLOURS, strict=False):
        values = published[f"area_{name}"]
        area.plot(published["distance"], values / values[-1], color=colour, label=label)
    area.set(xlabel="sliding distance, mm", title="4. area, published model", ylim=(0.0, 1.5))
    area.set_ylabel("area relative to its end")

    for (name, (slid, values)), colour in zip(curves.items(), COLOURS, strict=False):
        style = {"color": colour, "label": name, "lw": 2.5 if "smooth" in name else 1.0}
        cured.plot(slid, values, **style)
        start.loglog(slid, values, **style)
    for axes in (cured, start):
        axes.set(xlabel="sliding distance, mm", ylabel="area in contact, mm²", title="all four cured")
    for axes in figure.axes:
        axes.legend(fontsize=7, frameon=False)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


@click.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("artifact"), show_default=True)
@click.option("--quick", is_flag=True, help="Cells of 10 and 5 µm and a short distance, to try it.")
def main(out: Path, quick: bool) -> None:
    """The coarse-mesh artifact of the published rough model, and its cure in four parts."""
    started = time.perf_counter()
    cells = [10.0, 5.0] if quick else [10.0, 5.0, 2.0, 1.0]
    parts: dict[str, Table] = {}
    parts["tolerance"] = tolerance_part(cells, 30.0 if quick else 60.0)
    show("1. load tolerance: scatter of the mean pressure over the steps, p = F/A", parts["tolerance"])
    fine = [10.0, 5.0] if quick else [10.0, 5.0, 2.5, 1.0, 0.5]
    parts["mesh"] = mesh_part(fine, [8.0], [1, 2]) + mesh_part(fine, [4.0, 2.0], [1])
    show("2. mesh: one surface at several cells, static contact", parts["mesh"])
    parts["time"] = time_part([0.6, 0.3, 0.15, 0.075], 10.0 if quick else 5.0, 12.0)
    show("3. time: wear of the disc after 12 mm against implicit steps an eighth as long", parts["time"])
    distance = 240.0 if quick else 2400.0
    parts["area"], published = area_part(distance)
    show("4. area: the published model, straightness over the distance", parts["area"])
    parts["cured"], curves = cured_part(cells, distance)
    show("All four: v3-fine", parts["cured"])
    click.echo()
    click.echo(VERDICT)
    out.mkdir(parents=True, exist_ok=True)
    report = {"machine": machine(), "elapsed_s": time.perf_counter() - started, **parts}
    (out / "artifact.json").write_text(json.dumps(report, indent=2, default=float), encoding="utf-8")
    draw(parts, published, curves).savefig(out / "artifact.png", dpi=150)
    click.echo(f"written to {out}/ after {report['elapsed_s']:.0f} s")


if __name__ == "__main__":
    main()
