"""The same study gives the same result, whatever the number of threads, and says what it was made with."""

import platform
from typing import Any

import numpy as np
import pytest
import warp as wp
from cases_stopped import CASES, COVERED, soon_done

import warpwear
from warpwear import Study

#: On a CPU the others are run on one thread and on two where they are stopped, see `test_resume.py`.
TWICE = [("cpu", case) for case in COVERED] + [("cuda:0", case) for case in CASES]


def numbers(study: Study, **options: Any) -> dict[str, Any]:
    """Every number of the history and of the snapshots."""
    with warpwear.run(study, **options) as result:
        found: dict[str, Any] = dict(result.history)
        for index in range(result.snapshot_distances.size):
            fields = result.snapshot(index).fields.items()
            found |= {f"{name} {index}": values for name, values in fields if values is not None}
        return found


@pytest.mark.parametrize(("device", "case"), TWICE, indirect=["device"])
def test_twice_the_same(case: str, device: str, cores: int) -> None:
    """On a CPU bit for bit, with one thread and two; on a GPU, which orders its sums itself, to 1e-10."""
    one = numbers(soon_done(case), device=device, threads=1)
    two = numbers(soon_done(case), device=device, threads=min(2, cores))
    assert one.keys() == two.keys()
    for name, values in one.items():
        if device == "cpu":
            np.testing.assert_array_equal(values, two[name], err_msg=name)
        elif name not in ("load_residual", "evaluations"):  # rounding, and how the search went
            largest = float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
            np.testing.assert_allclose(values, two[name], rtol=1e-10, atol=1e-10 * largest, err_msg=name)


def test_a_result_says_what_it_was_made_with() -> None:
    study = Study.load("v3-fine").replace(
        {"grid.cell": "20 um", "sliding.distance": "0 mm", "disc.synthetic.seed": 7}
    )
    summary = warpwear.run(study).summary
    assert summary["surface"]["seed"] == 7
    made_with = summary["made_with"]
    assert made_with["warpwear"] == warpwear.__version__ == summary["version"]
    assert made_with["warp-lang"] == wp.config.version
    assert made_with["numpy"] == np.__version__
    assert made_with["python"] == platform.python_version()
    assert made_with["system"] == platform.platform()
    assert made_with["device"]
    assert summary["threads"] >= 1
    assert summary["precision"] == "float64"
