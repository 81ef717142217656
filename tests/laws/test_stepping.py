"""Increments end exactly where they must."""

import pytest

from warpwear.laws.track import increments


def test_fixed_increments_are_whole_and_end_exactly() -> None:
    steps = list(increments((0.3, 1.0, 0.3), 2400.0, [30.0, 600.0]))
    assert len(steps) == 8000
    assert steps[99][1] == 30.0
    assert steps[-1][1] == 2400.0
    assert [i for i, _ in steps] == pytest.approx([0.3] * 8000, rel=1e-9)


def test_growing_increments_stop_at_every_stop_and_go_on_as_planned() -> None:
    steps = list(increments((0.003, 1.02, 3.0), 2400.0, [30.0, 30.0, 5000.0]))
    ends = [end for _, end in steps]
    assert 30.0 in ends
    assert ends[-1] == 2400.0
    assert max(i for i, _ in steps) == 3.0
    cut = ends.index(30.0)
    # The step after a cut one has its planned size.
    assert steps[cut + 1][0] == pytest.approx(0.003 * 1.02 ** (cut + 1))
    assert sum(i for i, _ in steps) == pytest.approx(2400.0)


def test_a_last_short_step() -> None:
    assert [end for _, end in increments((0.4, 1.0, 0.4), 1.0)] == pytest.approx([0.4, 0.8, 1.0])


def test_no_distance_is_one_static_contact() -> None:
    assert list(increments((0.3, 1.0, 0.3), 0.0, [1.0])) == [(0.0, 0.0)]
