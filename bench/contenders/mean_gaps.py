"""Contacts by tamaas, in a process of its own: HEIGHTS.npy PRESSURE ..., an area of 1 and an E* of 1.

Prints a line of JSON: its version, and for each mean pressure the mean gap and the share of area in contact.
Needs any interpreter that has tamaas; what it prints is tamaas' own.
"""

import json
import sys

import numpy as np
import tamaas as tm

#: On its mean error, of complementarity; on 512² cells 1e-12 did not end.
TOLERANCE = 1e-9


def main(path: str, *pressures: str) -> None:
    tm.set_log_level(tm.LogLevel.error)
    heights = np.load(path)
    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], list(heights.shape))
    model.E, model.nu = 1.0, 0.0
    found = []
    for pressure in map(float, pressures):
        solver = tm.PolonskyKeerRey(model, heights, TOLERANCE)
        solver.max_iter = 20000
        error = solver.solve(pressure)
        if error > TOLERANCE:
            sys.exit(f"tamaas does not end at {pressure:g}: an error of {error:.2g}")
        found.append([float(model["gap"].mean()), float((model.traction > 0.0).mean())])
    print(json.dumps({"version": tm.__version__, "found": found}))


if __name__ == "__main__":
    main(*sys.argv[1:])
