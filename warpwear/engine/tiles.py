"""The list of tiles that a contact can reach: what a step has to visit of a field."""

import math
from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Executor, Field
from warpwear.kernels import wear
from warpwear.kernels.cells import TileSums

#: Tiles beyond which a sample of the rows tells how deep a list must reach to hold enough.
SAMPLED = 20_000
#: Every fourth row is in that sample.
SAMPLE = 4
#: A list of fewer saves nothing.
LEAST_TILES = 16


class TileList(ABC):
    """Tiles that a contact can reach, row by row: those with a cell whose gap does not exceed `limit` [mm].

    What is not listed cannot touch at an approach up to the limit. At first every tile is listed.

    least: cells that a list holds at least, so that a capped contact can carry its load on them.
    """

    def __init__(self, executor: Executor, *, least: float) -> None:
        self._executor = executor
        self._cells_of_tile = executor.grid.ny / executor.tiles_per_row
        self._least = max(math.ceil(least / self._cells_of_tile), LEAST_TILES)
        device, nx, columns = executor.device, executor.grid.nx, executor.tiles_per_row
        every = np.broadcast_to(np.arange(columns, dtype=np.int32), (nx, columns))
        self.list: Field = wp.array(every, dtype=wp.int32, device=device)
        self.count: Field = wp.array(np.full(nx, columns), dtype=wp.int32, device=device)
        self.limit = math.inf
        self.listed = nx * columns
        self.chunks = executor.split_rows(np.full(nx, executor.grid.ny))

    @property
    @abstractmethod
    def smallest(self) -> float:
        """No gap is lower [mm]."""

    @property
    def least(self) -> int:
        """Number of tiles that a list holds at least, where there are as many."""
        return self._least

    @property
    def asked(self) -> float:
        """Approach that the list was asked to serve [mm]; to hold enough it may serve more."""
        return self.limit

    @abstractmethod
    def begin(self) -> None:
        """To a list of the lowest tiles, where a search from the lowest cell begins."""

    @abstractmethod
    def reach(self, approach: float, *, margin: float = 0.0) -> None:
        """List all that touches up to an approach [mm]; a new list reaches a margin beyond [mm]."""

    def _readopt(self) -> None:
        """The list of another time. Raises ValueError for one that leads beyond the field."""
        listed, count = self.list.numpy(), self.count.numpy()
        if (
            min(listed.min(), count.min()) < 0
            or listed.max() >= listed.shape[1]
            or count.max() > listed.shape[1]
        ):
            raise ValueError("the list of tiles leads beyond the field")
        self._adopt(self.limit)

    def _adopt(self, limit: float) -> None:
        """The list that a kernel has made for a limit."""
        self.limit = limit
        count = self.count.numpy()
        self.listed = int(count.sum())
        self.chunks = self._executor.split_rows(count * self._cells_of_tile)


class Tiles(TileList):
    """Tiles of one gap that lies still and only opens.

    The list serves every approach up to `limit`. It is made anew when the limit is passed. On a GPU every
    tile is always listed: a pass over the memory costs less there than to decide about it.
    """

    #: The list too, as sums depend on it in rounding.
    STATE: ClassVar = {
        "_lowest": Field,
        "_kept": Field,
        "rest": Field,
        "list": Field,
        "count": Field,
        "limit": float,
        "_asked": float,
        "_fresh": bool,
    }

    def __init__(self, executor: Executor, gap: Field, unworn: Field, *, least: float) -> None:
        super().__init__(executor, least=least)
        self._fields = [gap, unworn]
        device, nx, columns = executor.device, executor.grid.nx, executor.tiles_per_row
        self._lowest = wp.zeros((nx, columns), dtype=wp.float64, device=device)
        self._kept = wp.zeros((nx, columns), dtype=TileSums, device=device)
        self.rest = wp.zeros(nx, dtype=TileSums, device=device)
        self._asked = math.inf
        executor.launch(wear.lowest, inputs=[gap], outputs=[self._lowest])
        self._smallest = float(self._lowest.numpy().min())
        self._on_cpu = device.is_cpu
        self._fresh = True

    @property
    def smallest(self) -> float:
        """Lowest gap before anything was worn [mm]; none is lower later."""
        return self._smallest

    @property
    def asked(self) -> float:
        """Approach that the list was asked to serve [mm]."""
        return self._asked

    def restored(self) -> None:
        """Go on with the list of another time, on the fields of that time."""
        self._readopt()

    def begin(self) -> None:
        """From every tile, which is what is listed at first, to the lowest."""
        if self._fresh and self._on_cpu:
            self._select(self._smallest)

    def reach(self, approach: float, *, margin: float = 0.0) -> None:
        """List all that touches up to an approach [mm]; a new list reaches a margin beyond [mm].

        A list that reaches much further than that is made anew as well: it costs more than it saves.
        """
        if self._on_cpu and (approach > self.limit or approach + 2.0 * margin < self._asked):
            self._select(approach + margin)

    def _select(self, limit: float) -> None:
        self._list(limit)
        self._asked = limit
        if self.listed < self._least:
            lowest = self._lowest.numpy()[:: SAMPLE if self._lowest.size > SAMPLED else 1].ravel()
            rank = math.ceil(self._least * lowest.size / self._lowest.size)
            self._list(float(np.partition(lowest, rank)[rank]) if rank < lowest.size else math.inf)

    def _list(self, limit: float) -> None:
        if self._fresh:  # what is known of the tiles is as it was found: nothing to look up in the fields
            self.count.zero_()
            self._fresh = False
        self._executor.launch(
            wear.select,
            inputs=[limit, *self._fields],
            outputs=[self._lowest, self._kept, self.rest, self.list, self.count],
            often=True,
        )
        self._adopt(limit)
