"""Iterations of capped contacts by mean pressure and hardness, where a search is most easily lost.

    python bench/cases/capped.py [--cells 1024] [--tolerance 1e-8] [--jobs 8] [--limit 570] [--json FILE]

One self-affine surface with waves down to two cells, cold starts, one thread a row. Residuals are certified.
"""

import argparse
import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor, TimeoutError, as_completed
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).parents[n]) for n in (1, 2)]

from measure.machine import machine  # noqa: E402

from cases.half_space import CASES  # noqa: E402
from warpwear.contact.half_space.solver import HalfSpace  # noqa: E402
from warpwear.engine.executor import Executor  # noqa: E402
from warpwear.errors import ConvergenceError  # noqa: E402
from warpwear.grid import Grid  # noqa: E402

#: Mean pressure over the hardness, and hardness over E*.
LOADS = (0.5, 0.8, 0.9, 0.97, 0.99, 0.999)
HARDNESSES = (0.0005, 0.002, 0.005, 0.02, 0.05, 0.1)


def solve(cells: int, tolerance: float, load: float, hardness: float) -> dict[str, Any]:
    """Solve a row, from nothing."""
    heights = CASES["capped"].heights(cells)
    row: dict[str, Any] = {"cells": cells, "load": load, "hardness": hardness, "tolerance": tolerance}
    start = time.process_time()
    with Executor(Grid(cells, cells, 1.0 / cells), threads=1) as executor:
        solver = HalfSpace(executor, modulus=1.0, hardness=hardness, tolerance=tolerance)
        try:
            contact = solver.solve(executor.field(-heights), mean_pressure=load * hardness)
        except ConvergenceError as error:
            return row | {"failed": str(error)}
    assert contact.certificate is not None
    found = {
        "iterations": contact.iterations,
        "transforms": contact.transforms,
        "area": contact.area_fraction,
    }
    found |= {"residual": contact.certificate.violation, "processor_seconds": time.process_time() - start}
    return row | found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cells", type=int, default=1024)
    parser.add_argument("--tolerance", type=float, default=1e-8)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--limit", type=float, default=570.0, help="seconds for all rows")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    rows = []
    pool = ProcessPoolExecutor(options.jobs)
    waiting = [
        pool.submit(solve, options.cells, options.tolerance, load, hardness)
        for hardness in HARDNESSES
        for load in LOADS
    ]
    try:
        for done in as_completed(waiting, options.limit):
            rows.append(done.result())
            print(json.dumps(rows[-1]), flush=True)
    except TimeoutError:
        print(f"{len(waiting) - len(rows)} rows not done in time")
        for process in pool._processes.values():
            process.kill()
    pool.shutdown(cancel_futures=True)
    table = {(row["hardness"], row["load"]): row.get("iterations", "–") for row in rows}
    print("H/E* \\ p/H" + "".join(f"{load:>8}" for load in LOADS))
    for hardness in HARDNESSES:
        print(f"{hardness:<10}" + "".join(f"{table.get((hardness, load), ''):>8}" for load in LOADS))
    if options.json:
        options.json.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
