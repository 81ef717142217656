"""Contacts by one contender, in a process of its own: NAME HEIGHTS.npy PRESSURE.npy and the case as JSON.

Prints a line of JSON: seconds by the clock and of processor time, iterations, growth of memory above what is
held after the imports and a small solve. Needs the contender only: any interpreter that has it will do.
"""

import json
import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

MODULUS = 1.0
THREADS = 2
WEAR_STEPS = 5


def tamaas(heights: Any, case: dict[str, Any]) -> tuple[Any, int]:
    """PolonskyKeerRey, or KatoSaturated under a cap: a mean error, other than ours, on the same number."""
    import tamaas as tm

    n = heights.shape[0]
    tm.set_log_level(tm.LogLevel.error)
    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], [n, n])
    model.E, model.nu = MODULUS, 0.0
    if math.isinf(case["cap"]):
        solver = tm.PolonskyKeerRey(model, heights, case["tolerance"])
    else:
        solver = tm.KatoSaturated(model, heights, case["tolerance"], case["cap"])
    solver.max_iter = 20000
    solver.solve(case["mean_pressure"])
    return np.array(model.traction), 0  # it does not tell its iterations


def contact_mechanics(heights: Any, case: dict[str, Any]) -> tuple[Any, int]:
    """System or plastic system of ContactMechanics: largest penetration over the rms height."""
    from ContactMechanics import PeriodicFFTElasticHalfSpace
    from ContactMechanics.Factory import make_plastic_system, make_system
    from SurfaceTopography import PlasticTopography, Topography

    n = heights.shape[0]
    substrate = PeriodicFFTElasticHalfSpace((n, n), young=MODULUS, physical_sizes=(1.0, 1.0))
    surface = Topography(heights, physical_sizes=(1.0, 1.0), periodic=True)
    if math.isinf(case["cap"]):
        system = make_system(substrate=substrate, surface=surface)
    else:
        surface = PlasticTopography(topography=surface, hardness=case["cap"])
        system = make_plastic_system(substrate=substrate, surface=surface)
    found = system.minimize_proxy(
        external_force=case["mean_pressure"], pentol=case["tolerance"] * heights.std()
    )
    if not found.success:
        raise SystemExit(f"ContactMechanics: {found.message}")
    return np.array(found.jac) * n * n, int(found.nit)


def warpwear(heights: Any, case: dict[str, Any]) -> tuple[Any, int]:
    """Ours, with the operator and the fields made anew."""
    from warpwear.contact.half_space import HalfSpace
    from warpwear.engine.executor import Executor
    from warpwear.grid import Grid

    n = heights.shape[0]
    with Executor(Grid(n, n, 1.0 / n), device=case["device"], threads=THREADS) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, hardness=case["cap"], tolerance=case["tolerance"])
        contact = solver.solve(executor.field(-heights), mean_pressure=case["mean_pressure"])
        return contact.pressure, contact.iterations


def wear_steps(heights: Any, case: dict[str, Any]) -> list[float]:
    """Seconds of implicit steps of wear by warpwear, each a hundredth of the rms height."""
    from warpwear.contact.half_space import HalfSpace
    from warpwear.engine.executor import Executor
    from warpwear.grid import Grid

    n = heights.shape[0]
    gap = -heights
    compliance = 0.01 * heights.std() / case["mean_pressure"]
    seconds = []
    with Executor(Grid(n, n, 1.0 / n), device=case["device"], threads=THREADS) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, hardness=case["cap"], tolerance=case["tolerance"])
        solver.solve(executor.field(gap), mean_pressure=case["mean_pressure"])
        for _ in range(WEAR_STEPS):
            field = executor.field(gap)
            start = time.perf_counter()
            contact = solver.solve(field, mean_pressure=case["mean_pressure"], compliance=compliance)
            gap = gap + compliance * contact.pressure
            seconds.append(time.perf_counter() - start)
    return seconds


CONTENDERS: dict[str, Callable[..., tuple[Any, int]]] = {
    "warpwear": warpwear,
    "tamaas": tamaas,
    "ContactMechanics": contact_mechanics,
}


def memory_mib(entry: str) -> float:
    """Return the memory of this process: VmRSS now, VmHWM at the peak since the last reset."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(entry):
            return float(line.split()[1]) / 1024.0
    return math.nan


def main() -> None:
    name, heights_file, pressure_file, text = sys.argv[1:]
    case = json.loads(text)
    heights = np.load(heights_file)
    CONTENDERS[name](heights[::8, ::8].copy(), {**case, "tolerance": 1e-2})
    before = memory_mib("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")
    seconds, processor = [], []
    pressure = None
    for _ in range(int(case["repeats"])):
        del pressure  # of the repeat before: not to count
        start, start_processor = time.perf_counter(), time.process_time()
        pressure, iterations = CONTENDERS[name](heights, case)
        seconds.append(time.perf_counter() - start)
        processor.append(time.process_time() - start_processor)
    record = {
        "seconds": seconds,
        "processor_seconds": processor,
        "iterations": iterations,
        "memory_mib": memory_mib("VmHWM") - before,
    }
    np.save(pressure_file, pressure)
    if name == "warpwear":
        record["wear_step_seconds"] = wear_steps(heights, case)
    print(json.dumps(record))


if __name__ == "__main__":
    main()
