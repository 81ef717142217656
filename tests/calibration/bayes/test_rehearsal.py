"""From the machine's files to the band, by tests in which everything is known."""

import runpy
import warnings
from pathlib import Path

import pytest

import warpwear

pytest.importorskip("emcee")


@pytest.mark.slow
def test_bands_hold_a_hidden_test(tmp_path: Path) -> None:
    """Three cases of `python bench/rehearsal.py`; chance makes fewer than six of nine hold once in 100."""
    bench = runpy.run_path(str(Path(__file__).parents[2] / "bench" / "rehearsal.py"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", warpwear.StudyWarning)
        sides = [bench["inside_of"](bench["one"](number, tmp_path)) for number in range(3)]
    inside = [low <= value <= high for case in sides for low, high, value in case.values()]
    assert len(inside) == 9
    assert sum(inside) >= 6
