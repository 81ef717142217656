"""Arrays on their way to a device and back, block by block."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from warpwear.engine import staging
from warpwear.engine.executor import Executor
from warpwear.grid import Grid

#: A block and some lines of another; and blocks of one or two lines.
TALL, WIDE = (2100, 1003), (3, staging.TOGETHER // 2)


@pytest.mark.parametrize("shape", [(1, 1), (50, 37), TALL, WIDE])
def test_a_field_goes_there_and_back(device: str, shape: tuple[int, int]) -> None:
    values = np.random.default_rng(0).normal(size=shape)
    with Executor(Grid(*shape, 1.0), device=device) as executor:
        field = staging.upload(executor, lambda rows: 2.0 * values[rows], padding=7.0)
        assert_array_equal(executor.to_numpy(field), 2.0 * values)
        assert (field.numpy().reshape(shape[0], -1)[:, shape[1] :] == 7.0).all()
        twice = np.empty(shape)
        pitch = field.numpy().size // shape[0]

        def take(rows: slice, one: np.ndarray, other: np.ndarray) -> float:
            twice[rows] = one + other
            return float(one.sum())

        sums = staging.download(executor, [field, field], take, [pitch, pitch])
    assert_array_equal(twice, 4.0 * values)
    assert sum(sums) == pytest.approx(2.0 * values.sum())


@pytest.mark.parametrize("threads", [1, 2])
def test_blocks_come_in_their_order(threads: int) -> None:
    firsts = staging.each(lambda rows: rows.start, (17, staging.TOGETHER // 3), threads)
    assert firsts == list(range(0, 17, 3))
