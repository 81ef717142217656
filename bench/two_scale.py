"""What patch size, macro cell, coupling and representative patches do to a coupled two-scale run.

    python bench/two_scale.py [--out FOLDER] [--cell "2.5 um"] [--time-cell "1 um"] [--quick]

prints a table a part, writes them as two_scale.json and draws two_scale.png. Every run has the same shear
strength, so that coefficients of friction compare as the areas do. About five minutes on two cores.
"""

import json
import statistics
import time
from pathlib import Path
from typing import Any

import click
import numpy as np
from matplotlib.figure import Figure
from measure.machine import machine

import warpwear
from warpwear.figures import describe as fs
from warpwear.figures.of_run.data import load_share_error
from warpwear.figures.style import style
from warpwear.runs.order import RunOrder

Table = list[dict[str, Any]]
#: Distances of the tables [mm], and those at which the couplings' loads are compared.
AT = (0.3, 3.0, 30.0, 240.0, 2400.0)
ERROR_AT = (0.01, 0.3, 3.0, 15.0, 60.0)
#: Domain [mm] whose outermost macro cells of 300 µm stay untouched, as representative patches ask for.
WIDE = {"grid.extent": "2.1 mm"}
SAMPLED = WIDE | {"patches.macro_cell": "300 um", "patches.width": "100 um"}
COUPLINGS: dict[str, dict[str, Any]] = {
    "approach, bulk K_N": {},
    "approach, no bulk": {"patches.bulk": "none"},
    "approach, K_N updated": {"contact.bulk_update": "updated"},
    "load": {"patches.coupling": "load"},
}
MACRO = (25.0, 125.0, 250.0)  # [µm], patches as large; the preset has 50
PATCH = (100.0, 150.0, 300.0)  # [µm] in macro cells of 300 µm


def run(changes: dict[str, Any]) -> warpwear.Result:
    """The preset with changes, in memory, with no snapshots beside the end."""
    return warpwear.run(warpwear.Study.load("two-scale").replace({"output.snapshots": []} | changes))


def um(length: float) -> str:
    return f"{length:g} um"


def at(result: warpwear.Result, name: str, distance: float) -> float:
    """A column of the history at a distance [mm]."""
    return float(np.interp(distance, result.history["distance"], result.history[name]))


class Course:
    """A run beside a reference, over the distance slid."""

    def __init__(self, part: str, name: str, result: warpwear.Result, beside: warpwear.Result | None) -> None:
        self.part, self.name = part, name
        self.distance = result.history["distance"]
        self.cof = result.history["cof"]
        reference = result if beside is None else beside
        own = reference.history
        self.ratio = self.cof / np.interp(self.distance, own["distance"], own["cof"])
        self.row = {
            "part": part,
            "run": name,
            **{f"cof_{d:g}mm": at(result, "cof", d) for d in AT},
            "area_end_over_reference": at(result, "area_contact", AT[-1])
            / at(reference, "area_contact", AT[-1]),
            "evaluations_median": float(np.median(result.history["evaluations"])),
        }


def courses(cell: str) -> list[Course]:
    """CoF over the distance by coupling, by macro cell and by patch."""
    base = {"grid.cell": cell}
    preset = run(base)
    found = [Course("coupling", next(iter(COUPLINGS)), preset, None)]
    for name, changes in COUPLINGS.items():
        if changes:
            found.append(Course("coupling", name, run(base | changes), preset))
    for macro in MACRO:
        changes = {"patches.macro_cell": um(macro), "patches.width": um(macro)}
        found.append(Course("macro cell, all covered", f"{macro:g} µm", run(base | changes), preset))
    whole = run(base | SAMPLED | {"patches.width": um(PATCH[-1])})
    for patch in PATCH:
        result = whole if patch == PATCH[-1] else run(base | SAMPLED | {"patches.width": um(patch)})
        cover = 100.0 * (patch / PATCH[-1]) ** 2
        found.append(Course("patch in a cell of 300 µm", f"{patch:g} µm, {cover:.0f} %", result, whole))
    return found


def load_part(cell: str, seeds: list[int]) -> Table:
    """½ Σ|ΔF_k|/F of the load coupling against the approach coupling, each with its own wear."""
    table = []
    for seed in seeds:
        base = {"grid.cell": cell, "sliding.distance": f"{ERROR_AT[-1]} mm", "disc.synthetic.seed": seed}
        base |= {"output.snapshots": [f"{d} mm" for d in ERROR_AT[:-1]]}
        approach, load = (run(base | {"patches.coupling": coupling}) for coupling in ("approach", "load"))
        rows = [int(np.abs(approach.history["distance"] - d).argmin()) for d in ERROR_AT]
        errors = [load_share_error(load.load_share[row], approach.load_share[row]) for row in rows]
        table.append({"seed": seed} | {f"error_{d:g}mm": e for d, e in zip(ERROR_AT, errors, strict=True)})
    return table


def sample_part(cell: str, seeds: list[int]) -> tuple[Table, dict[tuple[str, int], Any]]:
    """Area of patches that cover a ninth against those that cover everything, and its course."""
    table, drawn = [], {}
    for seed in seeds:
        base = WIDE | {"grid.cell": cell, "disc.synthetic.seed": seed}
        whole = run(base | {"patches.macro_cell": "300 um", "patches.width": "300 um"})
        for placement in ("centre", "random"):
            some = run(base | SAMPLED | {"patches.placement": placement, "patches.seed": seed})
            ratio = some.history["area_contact"] / whole.history["area_contact"]
            drawn[placement, seed] = (some.history["distance"], ratio)
            table.append(
                {
                    "seed": seed,
                    "placement": placement,
                    "cover": 1.0 / 9.0,
                    "area_30mm": at(some, "area_contact", 30.0) / at(whole, "area_contact", 30.0) - 1.0,
                    "area_240mm": at(some, "area_contact", 240.0) / at(whole, "area_contact", 240.0) - 1.0,
                    "area_end": float(ratio[-1]) - 1.0,
                    "cof_end": float(some.history["cof"][-1]),
                    "cof_end_all_covered": float(whole.history["cof"][-1]),
                }
            )
    return table, drawn


def seconds_of_steps(changes: dict[str, Any]) -> float:
    """All steps of a run, without its files and fields."""
    study = warpwear.Study.load("two-scale").replace(changes)
    order = RunOrder(study)
    with order.arrangement.executor(study, device="cpu", threads=None) as executor:
        model = order.model(executor).model
        plan = [(increment, False) for increment, _, _ in order.plan]
        start = time.perf_counter()
        for _ in model.steps(plan):
            pass
        return time.perf_counter() - start


def time_part(cell: str, repeats: int) -> Table:
    """Seconds of the steps of a run that covers everything and of one that covers a ninth, in turns."""
    seconds: dict[str, list[float]] = {"all covered, 50 µm": [], "100 µm of 300 µm": []}
    for _ in range(repeats):
        for name, changes in zip(seconds, (WIDE, SAMPLED), strict=True):
            seconds[name].append(seconds_of_steps({"grid.cell": cell} | changes))
    medians = {name: statistics.median(taken) for name, taken in seconds.items()}
    whole = max(medians.values())
    return [
        {
            "cell": cell,
            "run": name,
            "median_s": medians[name],
            "lowest_s": min(taken),
            "highest_s": max(taken),
        }
        | {"saved": 1.0 - medians[name] / whole}
        for name, taken in seconds.items()
    ]


def show(title: str, table: Table) -> None:
    click.echo(f"\n{title}")
    names = list(table[0])
    cells = [[f"{v:.4g}" if isinstance(v, float) else str(v) for v in row.values()] for row in table]
    widths = [max(len(name), *(len(row[i]) for row in cells)) for i, name in enumerate(names)]
    for row in [names, *cells]:
        click.echo("  " + "  ".join(f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True)))


def draw(found: list[Course], load: Table, drawn: dict[tuple[str, int], Any], times: Table) -> Figure:
    """Six panels."""
    colours = [fs.COUNTER, fs.DISC, fs.CONTACT, fs.MEAN_PRESSURE]
    kinds = ["-", "--", "-.", ":"]

    def curves(axes: Any) -> None:
        parts = list(dict.fromkeys(course.part for course in found))
        first = axes[0]
        for course, colour, kind in zip(
            (c for c in found if c.part == parts[0]), colours, kinds, strict=False
        ):
            first.loglog(course.distance, course.cof, color=colour, ls=kind, label=course.name)
        first.set_ylabel("coefficient of friction, –")
        first.set_title("one shear strength, 3.83 MPa")
        for panel, part in zip(axes[1:4], parts, strict=True):
            shown = [c for c in found if c.part == part]
            for course, colour, kind in zip(shown, colours, kinds, strict=False):
                panel.semilogx(course.distance, course.ratio, color=colour, ls=kind, label=course.name)
            panel.axhline(1.0, color="#BBBBBB", lw=0.6, zorder=0)
            panel.set_title(part)
            panel.set_ylabel("CoF over that of\n" + ("all covered" if part == parts[2] else "the preset"))
        for panel in (axes[0], axes[2], axes[3]):
            panel.legend(loc="best", handlelength=2.2)
        errors = 100.0 * np.array([[row[f"error_{d:g}mm"] for d in ERROR_AT] for row in load])
        for of_seed, row in zip(errors, load, strict=True):
            label = "one surface each" if row is load[0] else None
            axes[4].semilogx(ERROR_AT, of_seed, "o-", color=fs.DISC, alpha=0.4, ms=2.5, lw=0.7, label=label)
        axes[4].semilogx(ERROR_AT, errors.mean(axis=0), "o-", color=fs.DISC, ms=4, label="mean")
        axes[4].set_ylim(0.0)
        axes[4].set_title("load coupling against approach coupling")
        axes[4].set_ylabel("load on other patches, %")
        axes[4].legend()
        for (placement, seed), (distance, ratio) in drawn.items():
            centred = placement == "centre"
            label = {"centre": "in the middle", "random": "at random"}[placement] if seed == 1 else None
            axes[5].semilogx(
                distance, 100.0 * (ratio - 1.0), color=fs.CONTACT if centred else fs.SUM,
                ls="-" if centred else ":", lw=0.9, label=label,
            )  # fmt: skip
        axes[5].axhspan(-5.0, 5.0, color="#EEEEEE", zorder=0)
        axes[5].set_ylim(-60.0, 60.0)
        saved = 100.0 * max(row["saved"] for row in times)
        axes[5].set_title(f"patches on a ninth: {saved:.0f} % of the time saved")
        axes[5].set_ylabel("area against all covered, %")
        axes[5].legend()
        for panel in axes:
            panel.set_xlabel("sliding distance, mm")
            panel.set_xlim(3e-3, 3e3)
        axes[4].set_xlim(5e-3, 1e2)

    figure = Figure(figsize=(7.0, 7.05), layout="constrained")
    curves(figure.subplots(3, 2).ravel())
    return figure


@click.command()
@click.option("--out", default=".", help="folder for two_scale.json and two_scale.png")
@click.option("--cell", default="2.5 um", show_default=True, help="of all parts but the time")
@click.option("--time-cell", default="1 um", show_default=True, help="of the runs that are timed")
@click.option("--repeats", default=3, show_default=True, help="of the runs that are timed")
@click.option("--quick", is_flag=True, help="5 µm cells and two seeds")
def main(out: str, cell: str, time_cell: str, repeats: int, quick: bool) -> None:
    """What patch size, macro cell, coupling and representative patches do to a coupled two-scale run."""
    seeds = [1, 2] if quick else [1, 2, 3, 4, 5]
    if quick:
        cell = time_cell = "5 um"
    found = courses(cell)
    parts: dict[str, Table] = {"courses": [course.row for course in found]}
    show(f"CoF over the distance, {cell} cells, one shear strength", parts["courses"])
    parts["load"] = load_part(cell, seeds)
    show("load coupling: load on other patches than the approach coupling's, 50 µm patches", parts["load"])
    parts["representative"], drawn = sample_part(cell, seeds)
    show("patches of 100 µm in macro cells of 300 µm against all covered", parts["representative"])
    parts["time"] = time_part(time_cell, repeats)
    show("time of the steps of a run", parts["time"])
    folder = Path(out)
    record = {"machine": machine(), "cell": cell, **parts}
    (folder / "two_scale.json").write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    with style():
        draw(found, parts["load"], drawn, parts["time"]).savefig(folder / "two_scale.png", dpi=200)


if __name__ == "__main__":
    main()
