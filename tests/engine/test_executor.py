"""Launches that are kept for the next time run the kernel that was asked for, with the arguments of now."""

import numpy as np
import warp as wp

from warpwear.engine.executor import Executor
from warpwear.engine.tiles import TileList, Tiles
from warpwear.grid import Grid
from warpwear.kernels import gap, sliding


def test_kernels_of_one_name_in_two_modules(device: str) -> None:
    assert gap.bounds.key == sliding.bounds.key
    heights = np.random.default_rng(1).normal(size=(5, 40))
    with Executor(Grid(*heights.shape, 0.1), device=device) as executor:
        field, unworn = executor.field(heights), executor.zeros()
        tiles: TileList = Tiles(executor, field, unworn, executor.zeros(1), least=1e9)
        extremes = executor.partials(2)
        shape = heights.shape[0], executor.tiles_per_row
        of_tiles = [wp.zeros(shape, dtype=wp.float64, device=executor.device) for _ in range(2)]
        for _ in range(2):
            extremes.zero_()
            executor.launch(gap.bounds, inputs=[field], outputs=[extremes], over=tiles, often=True)
            assert extremes.numpy()[0].min() == heights.min()
            executor.launch(sliding.bounds, inputs=[field], outputs=of_tiles, often=True)
            executor.launch(gap.bounds, inputs=[field], outputs=[extremes], over=tiles, often=True)
            assert extremes.numpy()[1].max() == heights.max()
