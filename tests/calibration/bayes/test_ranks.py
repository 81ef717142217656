"""Ranks of the truth among samples of the posterior are even."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

pytest.importorskip("emcee")


@pytest.mark.slow
def test_ranks_of_the_truth_are_even(tmp_path: Path) -> None:
    """Eight tests of `python bench/cases/inference.py --case rest`: no rank is beyond chance.

    Of eight intervals of 90 % fewer than four hold the truth with a probability of 4e-4, and the distance of
    ranks from even ones is Kolmogorov's.
    """
    bench = runpy.run_path(str(Path(__file__).parents[2] / "bench" / "cases" / "inference.py"))
    case = bench["case_of"]("rest", tmp_path)
    found = [bench["one"](case, number) for number in range(8)]
    for key in found[0]["ranks"]:
        ranks = np.array([one["ranks"][key] + 0.5 for one in found]) / (bench["AMONG"] + 1)
        assert stats.kstest(ranks, "uniform").pvalue > 1e-3 / len(found[0]["ranks"]), key
        assert sum(one["inside"][key] for one in found) >= 4, key
