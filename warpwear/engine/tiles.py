"""A list holds the tiles that a contact can reach, which a step has to visit of a field."""

import math
from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Chunks, Program
from warpwear.grid import FloatArray
from warpwear.kernels import balance
from warpwear.kernels import tiles as lists_of_tiles
from warpwear.kernels.cells import LANES, TILE_VECTORS, TileSums

#: Stands for the limit of a list of every tile [mm], as in kernels.
NO_LIMIT = 1.0e300
#: A list of fewer saves nothing.
LEAST_TILES = 16


def tile_extremes(extreme: np.ufunc, field: Field | FloatArray, *, lines: int = 1) -> FloatArray:
    """Return the lowest or the highest number of each tile, by `np.minimum` or `np.maximum`: (rows, tiles).

    lines: of which a row of the field is made, one after another, each with tiles of its own.
    """
    values = field if isinstance(field, np.ndarray) else field.numpy()
    values = values.reshape(field.shape[0] * lines, -1)
    tiles = extreme.reduceat(values, np.arange(0, values.shape[1], LANES * int(TILE_VECTORS)), axis=1)
    return np.asarray(tiles.reshape(field.shape[0], -1))


class TileList(ABC):
    """Holds the tiles of a gap that are listed, row by row, and the flag by which a list is asked for.

    least: cells that a list holds at least, so that a capped contact can carry its load on them. listing:
    what is known of the list at first, by the names of `Listing`.
    """

    #: Lowest gap before anything was worn [mm]; none is lower later.
    smallest: float

    def __init__(self, executor: Executor, *, least: float, **listing: Any) -> None:
        self._executor = executor
        device, nx, columns = executor.device, executor.grid.nx, executor.tiles_per_row
        self._cells_of_tile = executor.grid.ny / columns
        self._least = max(math.ceil(least / self._cells_of_tile), LEAST_TILES)
        self.list: Field = wp.zeros((nx, columns), dtype=wp.int32, device=device)
        self.count: Field = wp.zeros(nx, dtype=wp.int32, device=device)
        self.lists = Numbers(lists_of_tiles.Listing, device, **listing)
        #: Flag: a list is asked for.
        self.listing: Field = wp.zeros(1, dtype=wp.int32, device=device)
        self._split: tuple[int, Chunks] | None = None  # for the number of a list

    @abstractmethod
    def add_to(self, program: Program) -> None:
        """Make the list that is asked for, in a program."""

    @property
    def cells(self) -> float:
        """Return the cells that the last list holds."""
        return float(self.lists["listed"]) * self._cells_of_tile

    @property
    def chunks(self) -> Chunks:
        """Return ranges of slots for the threads, of passes over what is listed."""
        number = self.lists["lists"]
        if self._split is None or self._split[0] != number:
            self._split = number, self._executor.split_rows(self.count.numpy() * self._cells_of_tile)
        return self._split[1]


class Tiles(TileList):
    """Tiles of one gap that lies still and only opens: those with a cell whose gap does not exceed a limit.

    The list serves every approach up to the limit. Kernels decide when it is made anew, see
    `kernels.tiles.reached`; what they decide by is in `lists`. At first every tile is listed. On a GPU
    every one always is: a pass over the memory costs less there than to decide about it.
    """

    #: The list too, as sums depend on it in rounding.
    STATE: ClassVar = {
        "_lowest": Field,
        "_kept": Field,
        "rest": Field,
        "list": Field,
        "count": Field,
        "lists": Numbers,
    }

    def __init__(self, executor: Executor, gap: Field, unworn: Field, *, least: float) -> None:
        device, nx, columns = executor.device, executor.grid.nx, executor.tiles_per_row
        every = {"limit": NO_LIMIT, "asked": NO_LIMIT, "is_fixed": int(device.is_cuda), "is_fresh": 1}
        super().__init__(executor, least=least, **every, listed=nx * columns)
        self._gap, self._unworn = gap, unworn
        executor.put(self.list, np.broadcast_to(np.arange(columns), (nx, columns)))
        executor.put(self.count, columns)
        lowest = tile_extremes(np.minimum, gap)
        self.smallest = float(lowest.min())
        self._lowest: Field = wp.array(lowest, dtype=wp.float64, device=device)
        self._kept = wp.zeros((nx, columns), dtype=TileSums, device=device)
        #: Of the tiles of each row that are not listed: cells touched, and their wear [mm].
        self.rest = wp.zeros(nx, dtype=TileSums, device=device)

    def add_to(self, program: Program) -> None:
        """Make the list that is asked for, in a program."""
        if not self._executor.device.is_cpu:
            return
        tiles = arguments(
            lists_of_tiles.TileLists,
            list=self.list,
            count=self.count,
            lowest=self._lowest,
            kept=self._kept,
            rest=self.rest,
        )
        with program.loop(self.listing):
            program.launch(balance.select, self.lists.array, self._gap, self._unworn, tiles)
            program.decide(balance.check_list, self.lists.array, self.listing, tiles, self._least)

    def below_bounds(self) -> float:
        """Return by how much a gap lies below the lowest of its tile, at most [mm]."""
        return float((self._lowest.numpy() - tile_extremes(np.minimum, self._gap)).max())

    def restored(self) -> None:
        """Go on with the list of another time. Raises ValueError for one that leads beyond the field."""
        self._split = None
        listed, count = self.list.numpy(), self.count.numpy()
        if (
            min(listed.min(), count.min()) < 0
            or listed.max() >= listed.shape[1]
            or count.max() > listed.shape[1]
        ):
            raise ValueError("the list of tiles leads beyond the field")
