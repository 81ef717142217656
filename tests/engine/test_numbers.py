"""Numbers and tables that kernels share with the host, and the lists of tiles that are decided by them."""

import json

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from warpwear.engine import state
from warpwear.engine.executor import Executor
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.engine.tiles import NO_LIMIT, Tiles
from warpwear.grid import Grid
from warpwear.kernels.wear import RestMemory


def test_numbers_are_saved_bit_for_bit(device: str) -> None:
    with Executor(Grid(8, 8, 0.1), device=device) as executor:
        one, other = (Numbers(RestMemory, executor.device, force=0.1) for _ in range(2))
        one.set(force=np.nextafter(0.3, 1.0), steps=2, slope=-1e-300, extents=[0.1, 0.2, 0.3, 1e300])
        saved = json.loads(json.dumps(state.save(one)))
        state.restore(other, *saved)
        assert other.values == one.values
        assert other["steps"] == 2
        with pytest.raises(KeyError):
            other.values = {"force": 1.0}


@pytest.mark.parametrize("seed", range(5))
def test_a_list_holds_the_lowest_tiles_and_enough_of_them(seed: int, threads: int) -> None:
    """Those within the limit asked for; where they are too few, up to the lowest limit that is enough."""
    rng = np.random.default_rng(seed)
    grid = Grid(60, 400, 0.01)
    gaps = rng.lognormal(-6.0, 2.0, grid.shape)
    with Executor(grid, threads=threads) as executor:
        gap = executor.field(gaps.copy(), padding=1e30)
        tiles = Tiles(executor, gap, gap, least=3000.0)
        program = Program(executor)
        tiles.add_to(program)
        padded = np.pad(gaps, ((0, 0), (0, 16)), constant_values=1e30)
        lowest = padded.reshape(60, -1, 32).min(axis=2)
        least = int(np.ceil(3000.0 / (400 / 13)))
        for limit in (lowest.min(), np.quantile(lowest, 0.3), NO_LIMIT):
            tiles.lists.set(limit=limit, asked=limit)
            tiles.listing.fill_(1)
            program.run()
            expected = lowest <= max(limit, np.sort(lowest, axis=None)[least])
            listed = np.zeros_like(expected)
            for row, count in enumerate(tiles.count.numpy()):
                listed[row, tiles.list.numpy()[row, :count]] = True
            assert_array_equal(listed, expected)
            assert tiles.lists["listed"] == expected.sum()
            assert tiles.lists["asked"] == limit
