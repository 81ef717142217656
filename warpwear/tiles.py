"""The list of tiles that a contact can reach: what a step has to visit of a field."""

import math

import numpy as np
import warp as wp

from warpwear.execution import Executor, Field
from warpwear.kernels import tiles
from warpwear.kernels.types import LANES, WIDTH, Kept

#: Cells of a tile.
TILE = LANES * int(WIDTH)


class Tiles:
    """Tiles of one gap whose lowest cell lies below a limit, row by row.

    The list serves every approach up to `limit`: what is not listed cannot touch, because gaps only open. It is
    made anew when the limit is passed. On a GPU every tile is always listed: a pass over the memory costs less
    there than to decide about it.

    least: cells that a list holds at least, so that a capped contact can carry its load on them.
    """

    def __init__(
        self, executor: Executor, gap: Field, wear_sphere: Field, wear_disc: Field, *, least: float
    ) -> None:
        self._executor = executor
        self._least = least
        self._fields = [gap, wear_sphere, wear_disc]
        device, nx, columns = executor.device, executor.grid.nx, executor.tiles_per_row
        self._lowest = wp.zeros((nx, columns), dtype=wp.float64, device=device)
        self._kept = wp.zeros((nx, columns), dtype=Kept, device=device)
        self.rest = wp.zeros(nx, dtype=Kept, device=device)
        every = np.broadcast_to(np.arange(columns, dtype=np.int32), (nx, columns))
        self.list = wp.array(every, dtype=wp.int32, device=device)
        self.count = wp.array(np.full(nx, columns), dtype=wp.int32, device=device)
        self.limit = math.inf
        self._asked = -math.inf
        self.cells = nx * columns * TILE
        self.chunks = executor.share(np.full(nx, columns * TILE))
        executor.launch(tiles.lowest, inputs=[gap], outputs=[self._lowest])
        self._smallest = float(self._lowest.numpy().min())
        if device.is_cpu:
            self._select(-math.inf)

    @property
    def smallest(self) -> float:
        """Lowest gap before anything was worn [mm]; none is lower later."""
        return self._smallest

    def reach(self, approach: float, *, ahead: float = 0.0) -> None:
        """List all that touches up to an approach [mm]; where that takes a new list, up to so much more [mm].

        A list that reaches much further than that is made anew as well: it costs more than it saves.
        """
        if approach > self.limit or approach + 2.0 * ahead < self._asked:
            self._select(approach + ahead)

    def _select(self, limit: float) -> None:
        self._list(limit)
        self._asked = limit
        if self.cells < self._least:
            lowest = self._lowest.numpy().ravel()
            rank = math.ceil(self._least / TILE)
            self._list(float(np.partition(lowest, rank)[rank]) if rank < lowest.size else math.inf)

    def _list(self, limit: float) -> None:
        self._executor.launch(
            tiles.select,
            inputs=[limit, *self._fields],
            outputs=[self._lowest, self._kept, self.rest, self.list, self.count],
        )
        self.limit = limit
        count = self.count.numpy() * TILE
        self.cells = int(count.sum())
        self.chunks = self._executor.share(count)
