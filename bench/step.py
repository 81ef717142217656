"""What a step costs, in passes over memory, and what a run needs of it.

    python bench/step.py [--cells 2048] [--repeats 15] [--out FILE]

A pass is `numpy.subtract(S, D, out=G)` on fields of the same size in the same run, so that the figures are
ratios. "late" is the step of a worn contact, most of the footprint touching; "early" is the first steps of
3 µm. Peak memory is that of a whole run in a process of its own, above what it holds after its imports.
"""

import json
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import numpy as np
import psutil
from machine import machine

import warpwear
from warpwear.execution import Executor
from warpwear.one_scale import OneScaleModel
from warpwear.surface_of import surface_of

EXTENT = 1.4336  # [mm]: the final scar of 1.26 to 1.38 mm nearly fills it


def median_ms(work: Callable[[], object], repeats: int) -> float:
    """Median time of `repeats` calls [ms]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1.0e3 * statistics.median(times)


def one_pass_ms(cells: int, repeats: int) -> float:
    """The unit: one NumPy pass over three fields."""
    sphere, disc, gap = (np.random.default_rng(i).random((cells, cells)) for i in range(3))
    return median_ms(lambda: np.subtract(sphere, disc, out=gap), repeats)


def study_of(cells: int) -> warpwear.Study:
    """The main job on cells² cells."""
    changes = {"grid.extent": f"{EXTENT} mm", "grid.cell": f"{EXTENT / cells} mm", "output.snapshots": []}
    return warpwear.Study.load("v3-fine").replace(changes)


def step_times(cells: int, threads: int, repeats: int) -> dict[str, float]:
    """Median time of an early and of a late step [ms], with what the late contact looks like."""
    study = study_of(cells)
    grid = study.cells
    heights = surface_of(study.disc).heights(grid.x, grid.y)
    with Executor(grid, threads=threads) as executor:
        model = OneScaleModel(study, heights, executor)
        model.advance(3.0e-3)
        early = median_ms(lambda: model.advance(3.0e-3), repeats)
        for _ in range(24):  # implicit steps may be long
            model.advance(100.0)
        steps = []
        late = median_ms(lambda: steps.append(model.advance(3.0)), repeats)
        row = steps[-1].row
    return {
        "early_ms": early,
        "late_ms": late,
        "late_evaluations": statistics.median(step.balance.evaluations for step in steps),
        "late_contact_over_scar": row["area_contact"] / row["area_nominal"],
        "late_contact_over_domain": row["area_contact"] / grid.area,
    }


def peak_memory_fields(cells: int) -> float:
    """Peak of a whole run in float64 fields of this size, above the memory after the imports."""
    command = [sys.executable, __file__, "--cells", str(cells), "--measure-memory"]
    answer = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(answer.stdout)


def measure_memory(cells: int) -> None:
    """In a process of its own: a small run first, so that imports and compiled kernels do not count."""
    small = {"grid.cell": f"{EXTENT / 64} mm", "sliding.distance": "0.003 mm"}
    warpwear.run(study_of(cells).replace(small)).close()
    process = psutil.Process()
    before = process.memory_info().rss
    peak = before
    finished = threading.Event()

    def watch() -> None:
        nonlocal peak
        while not finished.wait(0.001):
            peak = max(peak, process.memory_info().rss)

    watcher = threading.Thread(target=watch)
    watcher.start()
    warpwear.run(study_of(cells).replace({"sliding.distance": "0.03 mm"})).close()
    finished.set()
    watcher.join()
    click.echo((peak - before) / (8 * cells**2))


@click.command()
@click.option("--cells", default=2048, show_default=True, help="Cells along a side.")
@click.option("--repeats", default=15, show_default=True, help="Repeats of which the median is taken.")
@click.option("--out", type=click.Path(path_type=Path), help="JSON file to write.")
@click.option("--measure-memory", "memory_only", is_flag=True, hidden=True)
def main(cells: int, repeats: int, out: Path | None, memory_only: bool) -> None:
    """What a step costs, in passes over memory, and what a run needs of it."""
    if memory_only:
        measure_memory(cells)
        return
    unit = one_pass_ms(cells, repeats)
    click.echo(f"{cells} × {cells} cells, one pass of numpy.subtract: {unit:.2f} ms")
    report: dict[str, Any] = {"machine": machine(), "cells": cells, "pass_ms": unit, "steps": []}
    for threads in (1, 2):
        found = step_times(cells, threads, repeats)
        report["steps"].append({"threads": threads, **found})
        for when in ("early", "late"):
            took = found[f"{when}_ms"]
            click.echo(f"{threads} threads, {when} step: {took:.2f} ms = {took / unit:.2f} passes")
    late = report["steps"][-1]
    click.echo(
        f"late: {late['late_evaluations']:g} evaluations of the balance, "
        f"{100 * late['late_contact_over_scar']:.0f} % of the scar and "
        f"{100 * late['late_contact_over_domain']:.0f} % of the domain in contact"
    )
    report["peak_memory_fields"] = peak_memory_fields(cells)
    click.echo(f"peak memory of a run above its imports: {report['peak_memory_fields']:.2f} fields")
    if out is not None:
        out.write_text(json.dumps(report, indent=2), encoding="utf-8")


if __name__ == "__main__":
    main()
