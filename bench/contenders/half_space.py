"""Contacts by one contender, in a process of its own: NAME, then a line of JSON on standard input for each.

Answers each with a line of JSON: seconds by the clock and of processor time, iterations, growth of memory
above what is held before. A first line of its own says the contender's version. Needs the contender only:
any interpreter that has it will do. A case: heights (file), pressure (file to write, or none), boundary, cap,
mean_pressure, tolerance (the contender's own), threads, device, setting (the contender's own), wear (whether
to time steps of wear as well).
"""

import importlib
import json
import math
import sys
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

MODULUS = 1.0
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
        raise RuntimeError(f"ContactMechanics: {found.message}")
    return np.array(found.jac) * n * n, int(found.nit)


def aspher(heights: Any, case: dict[str, Any]) -> tuple[Any, int]:
    """Nested grids of ASPHER, elastic. setting: keywords of its `solve_nested`."""
    from aspher import solve_nested

    n = heights.shape[0]
    found = solve_nested(
        grid_size=n,
        gap=-heights.ravel(),
        p_nominal=case["mean_pressure"],
        E_star=MODULUS,
        tol=case["tolerance"],
        light_result=True,
        **({"backend": "periodic" if case["boundary"] == "periodic" else "fft"} | case["setting"]),
    )
    return np.asarray(found.pressure).reshape(n, n), int(found.iterations)


def warpwear(heights: Any, case: dict[str, Any]) -> tuple[Any, int]:
    """Ours, with the operator and the fields made anew; under a free boundary what a caller calls.

    That takes the part of the half-space that touches. It tells pairs of transforms, not iterations.
    """
    if case["boundary"] == "free":
        from warpwear import solve_contact

        found = solve_contact(
            heights,
            cell=1.0 / heights.shape[0],
            modulus=MODULUS,
            mean_pressure=case["mean_pressure"],
            boundary="free",
            hardness=None if math.isinf(case["cap"]) else case["cap"],
            tolerance=case["tolerance"],
            device=case["device"],
            threads=case["threads"],
        )
        return found.pressure, found.evaluations
    solver, executor = _ours(heights, case)
    with executor:
        contact = solver.solve(executor.field(-heights), mean_pressure=case["mean_pressure"])
        return contact.pressure, contact.iterations


def _ours(heights: Any, case: dict[str, Any]) -> tuple[Any, Any]:
    from warpwear.contact.half_space.solver import HalfSpace
    from warpwear.engine.executor import Executor
    from warpwear.grid import Grid

    n = heights.shape[0]
    executor = Executor(Grid(n, n, 1.0 / n), device=case["device"], threads=case["threads"])
    options = {"boundary": case["boundary"], "hardness": case["cap"], "tolerance": case["tolerance"]}
    return HalfSpace(executor, modulus=MODULUS, **options), executor


def wear_steps(heights: Any, case: dict[str, Any]) -> list[float]:
    """Seconds of implicit steps of wear by warpwear, each a hundredth of the rms height."""
    gap = -heights
    compliance = 0.01 * heights.std() / case["mean_pressure"]
    seconds = []
    solver, executor = _ours(heights, case)
    with executor:
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
    "ASPHER": aspher,
}


def version_of(name: str) -> str:
    """The version of a contender, which may lie on the path without being installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return str(getattr(importlib.import_module(name), "__version__", "unknown"))


def memory_mib(entry: str) -> float:
    """Return the memory of this process: VmRSS now, VmHWM at the peak since the last reset."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(entry):
            return float(line.split()[1]) / 1024.0
    return math.nan


def main() -> None:
    name = sys.argv[1]
    solve = CONTENDERS[name]
    # what is imported and made once, before anything is measured
    rough = np.random.default_rng(0).normal(size=(128, 128)) * 1e-3
    small = {"boundary": "periodic", "cap": math.inf, "mean_pressure": 5e-3, "tolerance": 1e-2, "threads": 1}
    solve(rough, {**small, "device": "cpu", "setting": {}})
    print(json.dumps({"version": version_of(name)}), flush=True)
    for line in sys.stdin:
        case = json.loads(line)
        heights = np.load(case["heights"])
        before = memory_mib("VmRSS")
        Path("/proc/self/clear_refs").write_text("5")
        start, start_processor = time.perf_counter(), time.process_time()
        try:
            pressure, iterations = solve(heights, case)
        except Exception as error:
            print(json.dumps({"failed": f"{type(error).__name__}: {error}"}), flush=True)
            continue
        record = {
            "processor_seconds": time.process_time() - start_processor,
            "seconds": time.perf_counter() - start,
            "iterations": iterations,
            "memory_mib": memory_mib("VmHWM") - before,
        }
        if case["pressure"]:
            np.save(case["pressure"], pressure)
        if case.get("wear"):
            record["wear_step_seconds"] = wear_steps(heights, case)
        print(json.dumps(record), flush=True)


if __name__ == "__main__":
    main()
