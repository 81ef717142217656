"""The list of tiles that a sphere can touch on a disc displaced under it."""

import math
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.tiles import TileList
from warpwear.grid import FloatArray
from warpwear.kernels import sliding
from warpwear.kernels.cells import LANES, Cells

#: A list that holds too little reaches deeper, by this much at first [mm].
FIRST_DEPTH = 1.0e-5
#: And this many times more each time.
DEEPER = 4.0
#: Deeper than that every tile is listed [mm].
DEEPEST = 0.1
#: Cost of looking at the bounds of a pair of tiles, in cells.
BOUNDS_IN_CELLS = 1.0


class PerTile:
    """One number a tile of a body, rows × tiles, seen also as eight neighbouring tiles in a vector."""

    STATE: ClassVar = {"numbers": Field}

    def __init__(self, rows: int, tiles: int, device: Any) -> None:
        groups = -(-tiles // LANES)
        self.vectors = wp.zeros((rows, groups), dtype=Cells, device=device)
        self.numbers: Field = wp.array(
            ptr=self.vectors.ptr, shape=(rows, groups * LANES), dtype=wp.float64, device=device
        )

    def fill(self, value: float) -> None:
        self.vectors.fill_(Cells(*[value] * LANES))

    def to_numpy(self) -> FloatArray:
        """Shape (rows, tiles and padding)."""
        values: FloatArray = self.vectors.numpy().reshape(self.numbers.shape)
        return values


class SlidingTiles(TileList):
    """Tiles of a sphere that the disc beneath them, `shift` rows on, can reach.

    `displace` forgets the list; `reach` makes it and the gap of the tiles on it, in `gap`. The gap of other
    tiles is not made. A list holds no tile without a cell within the limit.

    sphere, disc: heights as worn, of nx rows and of at least as many; places without a surface stand
    infinitely high on the sphere and low on the disc.
    """

    STATE: ClassVar = {"lowest": PerTile, "highest": PerTile}

    def __init__(self, executor: Executor, sphere: Field, disc: Field, *, least: float) -> None:
        super().__init__(executor, least=least)
        self._heights = [sphere, disc]
        self.gap = executor.zeros()
        self.shift = 0
        device, columns = executor.device, executor.tiles_per_row
        self.lowest = PerTile(sphere.shape[0], columns, device)  # of the sphere
        self.highest = PerTile(disc.shape[0], columns, device)  # of the disc
        for field, kept, low in ((sphere, self.lowest, True), (disc, self.highest, False)):
            other = PerTile(field.shape[0], columns, device)
            executor.launch(
                sliding.bounds,
                inputs=[field],
                outputs=[kept.numbers, other.numbers] if low else [other.numbers, kept.numbers],
                chunks=[(0, field.shape[0] * executor.slots_per_row)],
            )
        # The sphere's lowest of eight tiles and the disc's highest of a row, before any wear.
        lowest = self.lowest.to_numpy().reshape(sphere.shape[0], -1, LANES).min(axis=2)
        highest = self.highest.to_numpy().max(axis=1)
        self._bound = arguments(
            sliding.Bounds,
            lowest_of_eight=wp.array(lowest, dtype=wp.float64, device=device),
            highest_of_row=wp.array(highest, dtype=wp.float64, device=device),
            lowest=self.lowest.vectors,
            highest=self.highest.vectors,
        )
        self._split_scan()

    @property
    def smallest(self) -> float:
        """No gap is lower at this displacement [mm]."""
        return float(self._bounds().min())

    def _bounds(self) -> FloatArray:
        """What no gap of a tile is lower than [mm]."""
        rows = self.lowest.vectors.shape[0]
        beneath = np.arange(self.shift, self.shift + rows) % self.highest.vectors.shape[0]
        return self.lowest.to_numpy() - self.highest.to_numpy()[beneath]

    def displace(self, shift: int) -> None:
        """Move the disc `shift` rows on, 0 ≤ shift < its rows, and forget the list."""
        self.shift = shift
        self.limit = -math.inf

    def begin(self) -> None:
        bounds, rank = self._bounds().ravel(), self._least
        self._select(float(np.partition(bounds, rank)[rank]) if rank < bounds.size else math.inf)

    def reach(self, approach: float, *, margin: float = 0.0) -> None:
        if approach > self.limit:
            self._select(approach + margin)

    def _select(self, limit: float) -> None:
        depth = FIRST_DEPTH
        self._list(limit)
        while self.listed < self._least and limit < math.inf:
            limit = limit + depth if depth < DEEPEST else math.inf
            depth *= DEEPER
            self._list(limit)
        self._split_scan()

    def _list(self, limit: float) -> None:
        self._executor.launch(
            sliding.select,
            inputs=[limit, self.shift, self._bound, *self._heights],
            outputs=[self.gap, self.list, self.count],
            chunks=self._scan,
            often=True,
        )
        self._adopt(limit)

    def _split_scan(self) -> None:
        """Ranges of rows for the next scan: every bound is looked at, and gaps are made as last time."""
        tiles = self._executor.tiles_per_row * BOUNDS_IN_CELLS + self.count.numpy() * self._cells_of_tile
        self._scan = self._executor.split_rows(tiles)
