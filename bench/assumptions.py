"""What each assumed value of `v3-fine` would change: area in contact and scar against another value.

Prints a table for docs/limits.md; `warpwear.page.effects` says the same on the page of a run.
"""

import argparse

import numpy as np

import warpwear
from warpwear.grid import FloatArray

#: Distances at which runs are compared [mm].
PLACES = (3.0, 30.0, 240.0, 2400.0)
#: Other values of the keys that v3-fine assumes.
OTHERS: dict[str, tuple[str | float | int, ...]] = {
    "disc.synthetic.seed": (2, 3, 4, 5, 6),
    "disc.synthetic.hurst": (0.6, 1.0),
    "disc.synthetic.roll_off": ("50 um", "200 um"),
    "disc.synthetic.cut_off": ("16 um",),
    "contact.hardness": ("544 MPa", "638 MPa", "1180 MPa"),
    "contact.stiffness": ("1e6 N/mm^3", "1e5 N/mm^3"),
    "stepping.first": ("1.5 um", "6 um"),
    "stepping.growth": (1.01, 1.04),
    "stepping.largest": ("1.5 mm", "6 mm"),
    "grid.extent": ("2 mm",),
}


def course(cell: str, changes: dict[str, str | float | int]) -> FloatArray:
    """Area in contact and across the scar [mm², mm] at `PLACES`, shape (2, places)."""
    study = warpwear.Study.load("v3-fine").replace({"grid.cell": cell, "output.snapshots": []} | changes)
    with warpwear.run(study) as result:
        history = result.history
        columns = ("area_contact", "patch_across")
        return np.array([np.interp(PLACES, history["distance"], history[name]) for name in columns])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cell", default="4 um")
    cell = parser.parse_args().cell
    base = course(cell, {})
    print("| key | value | " + " | ".join(f"area, {place:g} mm" for place in PLACES) + " | scar at the end |")
    print("|---" * (3 + len(PLACES)) + "|")
    for key, values in OTHERS.items():
        for value in values:
            area, across = 100.0 * (course(cell, {key: value}) / base - 1.0)
            told = " | ".join(f"{percent:+.1f} %" for percent in area)
            print(f"| `{key}` | {value} | {told} | {across[-1]:+.1f} % |", flush=True)


if __name__ == "__main__":
    main()
