"""What the checks of every step (`warpwear.runs.invariants`) cost beside the step, on the CPU.

python bench/checks.py [CELL]...      (sides of the cells in µm; by default 1 10)
"""

import argparse
import statistics
import time

from warpwear import Study
from warpwear.runs.invariants import Invariants
from warpwear.runs.make import executor_of, model_of
from warpwear.runs.plan import plan_of
from warpwear.study.surface import surface_in


def measure(cell: str) -> None:
    """Medians over the first and the last quarter of the steps of v3-fine. cell: side of the cells [µm]."""
    study = Study.load("v3-fine").replace({"grid.cell": f"{cell} um", "output.snapshots": []})
    invariants, plan = Invariants(study), plan_of(study)
    steps_took, checks_took = [], []
    with executor_of(study, device="cpu", threads=None) as executor:
        model = model_of(study, surface_in(study), executor).model
        steps = model.steps((increment, keep) for increment, _, keep in plan)
        for _, distance, _ in plan:
            start = time.perf_counter()
            step = next(steps)
            made = time.perf_counter()
            row = step.row | {"distance": distance}
            found = [*invariants.of_row(row, touches_edge=step.touches_edge, touches_rim=step.touches_rim)]
            checks_took.append(time.perf_counter() - made)
            steps_took.append(made - start)
            assert not found, found
    quarter = len(plan) // 4
    for name, part in (("early", slice(0, quarter)), ("late", slice(-quarter, None))):
        step_took, check_took = (statistics.median(took[part]) for took in (steps_took, checks_took))
        print(
            f"{cell} µm, {name}: step {1e3 * step_took:.3f} ms, checks {1e6 * check_took:.2f} µs, "
            f"{100.0 * check_took / step_took:.2f} %"
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "cells", nargs="*", default=["1", "10"], metavar="CELL", help="side of the cells [µm]"
    )
    for cell in parser.parse_args().cells:
        measure(cell)
