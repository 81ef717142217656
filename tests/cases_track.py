"""Small studies of a ball that slides over a track, shared by tests."""

from typing import Any

import numpy as np

from warpwear import Study
from warpwear.grid import FloatArray

CELL, WINDOW = 0.02, 31
#: Tracks of a small study: its changes, and the lengths of the steps of one pass in cells.
TRACKS: dict[str, tuple[dict[str, Any], list[int]]] = {
    "full": ({"sliding.stroke": "0.9 mm", "sliding.shift": 7}, [7] * 6 + [3]),
    "representative": (
        {"sliding.stroke": "3 mm", "sliding.track": "0.8 mm", "sliding.shift": 8},
        [8] * 5,
    ),
    "rotating": ({"sliding.track_radius": "0.161 mm", "sliding.shift": 5}, [5] * 10),
}
LOSES = {
    "forgets": {},
    "keeps": {"sliding.plastic": "keep"},
    "springs back": {"sliding.plastic": "keep", "contact.stiffness": "2e5 N/mm^3"},
}


def small(track: str, **changes: Any) -> Study:
    """A rough study of 31² cells on one of the TRACKS; changes: keys with __ for the dot."""
    dotted = {k.replace("__", "."): v for k, v in changes.items()}
    base = {"grid.cell": "20 um", "grid.extent": "0.62 mm", "sliding.kinematics": "swept"}
    base |= {"sliding.distance": "7.37 mm", "counter.radius": "1 mm", "output.snapshots": []}
    base |= {"output.precision": "double"}
    return Study.load("v3-fine").replace(base | TRACKS[track][0] | dotted)


def rough(rows: int) -> FloatArray:
    """Heights [mm] of a track, shape (rows, WINDOW)."""
    rng = np.random.default_rng(3)
    return rng.normal(0.0, 1e-3, (rows, WINDOW)).cumsum(axis=1) * 0.1
