"""Kinds of runs of which figures are drawn; shared by tests."""

from typing import Any

SMALL = {"grid.cell": "20 um", "sliding.distance": "30 mm"}
RUNS: dict[str, dict[str, Any]] = {
    "rough": {"output.snapshots": ["0.3 mm", "3 mm", "10 mm"]},
    "end only": {"output.snapshots": []},
    "static": {"sliding.distance": "0 mm", "output.snapshots": []},
    "flat": {"counter.radius": "inf mm", "sliding.distance": "3 mm", "output.snapshots": ["1 mm"]},
    "smooth": {
        "study.model": "macro",
        "wear.distance_factor": "across",
        "output.snapshots": ["0.3 mm", "3 mm"],
    },
    "published": {
        "stepping.scheme": "explicit",
        "stepping.load_tolerance": "0.5 N",
        "friction.area": "cumulative",
        "output.snapshots": ["1 mm", "10 mm"],
    },
}
