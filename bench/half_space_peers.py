"""One contact by a peer, in a process of its own: PEER CELLS CAP HEIGHTS.npy PRESSURE.npy TOLERANCE.

Prints a line of JSON: seconds, iterations, growth of memory above what is held after the imports. Needs
the peer only; runs under any interpreter that has it.
"""

import json
import resource
import sys
import time
from typing import Any

import numpy as np

MODULUS = 1.0


def tamaas(heights: Any, mean_pressure: float, cap: float, tolerance: float) -> tuple[Any, float, int]:
    """tamaas: PolonskyKeerRey, or KatoSaturated under a cap. Its error is a mean; tolerance is that."""
    import tamaas as tm

    n = heights.shape[0]
    tm.set_log_level(tm.LogLevel.error)
    start = time.process_time()
    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], [n, n])
    model.E, model.nu = MODULUS, 0.0
    if np.isinf(cap):
        solver = tm.PolonskyKeerRey(model, heights, tolerance)
    else:
        solver = tm.KatoSaturated(model, heights, tolerance, cap)
    solver.max_iter = 20000
    solver.solve(mean_pressure)
    return np.array(model.traction), time.process_time() - start, -1


def contact_mechanics(
    heights: Any, mean_pressure: float, cap: float, tolerance: float
) -> tuple[Any, float, int]:
    """ContactMechanics' make_system or make_plastic_system; tolerance: penetration over rms height."""
    from ContactMechanics import PeriodicFFTElasticHalfSpace
    from ContactMechanics.Factory import make_plastic_system, make_system
    from SurfaceTopography import PlasticTopography, Topography

    n = heights.shape[0]
    start = time.process_time()
    substrate = PeriodicFFTElasticHalfSpace((n, n), young=MODULUS, physical_sizes=(1.0, 1.0))
    topography = Topography(heights, physical_sizes=(1.0, 1.0), periodic=True)
    if np.isinf(cap):
        system = make_system(substrate=substrate, surface=topography)
    else:
        system = make_plastic_system(
            substrate=substrate, surface=PlasticTopography(topography=topography, hardness=cap)
        )
    result = system.minimize_proxy(external_force=mean_pressure, pentol=tolerance * heights.std())
    if not result.success:
        raise SystemExit(f"ContactMechanics: {result.message}")
    seconds = time.process_time() - start
    return np.array(result.jac) * n * n, seconds, int(result.nit)


def main() -> None:
    peer, cap, heights_file, pressure_file, mean_pressure, tolerance = sys.argv[1:]
    solve = {"tamaas": tamaas, "ContactMechanics": contact_mechanics}[peer]
    heights = np.load(heights_file)
    small = heights[::8, ::8].copy()
    solve(small, float(mean_pressure), float(cap), 1e-2)  # imports and plans do not count
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    pressure, seconds, iterations = solve(heights, float(mean_pressure), float(cap), float(tolerance))
    growth = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    np.save(pressure_file, pressure)
    print(json.dumps({"seconds": seconds, "iterations": iterations, "memory_mib": growth / 1024}))


if __name__ == "__main__":
    main()
