"""What tests of the front door share: a quick study, rough heights, and when two results are the same."""

from typing import Any

import numpy as np

from warpwear import Result, Study

QUICK = {
    **{"grid.cell": "20 um", "sliding.distance": "3 mm", "output.snapshots": ["0.3 mm"]},
    "output.precision": "double",
}
TRACK = {"grid.cell": "20 um", "sliding.distance": "12 mm", "output.snapshots": ["3.1 mm"]}


def study_of(preset: str = "v3-fine", **changes: Any) -> Study:
    base = TRACK if preset == "track" else QUICK
    return Study.load(preset).replace(base | {k.replace("__", "."): v for k, v in changes.items()})


def same(one: Result, other: Result) -> None:
    """Every number of two results, to the last digit."""
    assert list(one.history) == list(other.history)
    for name, values in one.history.items():
        np.testing.assert_array_equal(values, other.history[name], err_msg=name)
    assert len(one.snapshots) == len(other.snapshots)
    for mine, theirs in zip(one.snapshots, other.snapshots, strict=True):
        for name, field in mine.fields.items():
            np.testing.assert_array_equal(field, theirs.fields[name], err_msg=name)
