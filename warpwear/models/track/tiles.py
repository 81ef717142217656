"""The list of tiles that a ball can touch on a disc displaced under it."""

from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Arguments, Executor, Field, arguments, as_numbers
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.engine.tiles import NO_LIMIT, TileList, tile_extremes
from warpwear.grid import FloatArray
from warpwear.kernels import bounds, sliding
from warpwear.kernels.cells import LANES, PADDING, Cells
from warpwear.kernels.running_in import film
from warpwear.models.features.features import Features

#: Cost of looking at the bounds of a pair of tiles, in cells.
BOUNDS_IN_CELLS = 1.0


class PerTile:
    """One number a tile of a body, rows × tiles, seen also as eight neighbouring tiles in a vector."""

    STATE: ClassVar = {"numbers": Field}

    def __init__(self, rows: int, tiles: int, device: Any) -> None:
        groups = -(-tiles // LANES)
        self.vectors = wp.zeros((rows, groups), dtype=Cells, device=device)
        self.numbers: Field = as_numbers(self.vectors, (rows, groups * LANES))

    def fill(self, values: FloatArray, *, padding: float) -> None:
        """Take values of shape (rows, tiles). padding: stands beyond the last tile."""
        host = np.full(self.numbers.shape, padding)
        host[:, : values.shape[1]] = values
        self.numbers.assign(host)

    def to_numpy(self) -> FloatArray:
        """Shape (rows, tiles and padding)."""
        values: FloatArray = self.vectors.numpy().reshape(self.numbers.shape)
        return values


class SlidingTiles(TileList):
    """Tiles of a ball that the disc beneath them can reach, displaced as a `Slide` says.

    Each displacement has its own list, which a search asks for as `engine.tiles.Tiles` has it; with a tile is
    made its gap. The gap of other tiles is not made. A list holds no tile without a cell within the limit.

    The gap has lower bounds: of tiles, of eight tiles and of rows. Invariant: gaps only grow, so that bounds
    which were made before wear hold after it. Whoever raises a surface refreshes them.

    bodies: heights as worn, of nx rows and of at least as many, and room for the gap; places without a
    surface stand infinitely high on the ball and low on the disc. slides: a `Slide` in an array. features:
    which know what cells have of their own. keeps_gap: whether the disc lies still and nothing but the pass
    that wears changes a gap, which is made once then.
    """

    STATE: ClassVar = {
        **dict.fromkeys(("lowest", "lowest_of_eight"), InFrame("counter")),
        **dict.fromkeys(("highest", "highest_of_row"), InFrame("disc")),
    }
    SCRATCH: ClassVar = ("list", "count", "lists", "_slides", "_bodies", "features")

    def __init__(
        self,
        executor: Executor,
        bodies: Arguments,
        slides: Field,
        features: Features,
        *,
        least: float,
        keeps_gap: bool = False,
    ) -> None:
        super().__init__(executor, least=least, limit=-NO_LIMIT, asked=-NO_LIMIT)
        self._bodies, self._slides = bodies, slides
        #: Those of the programs that are made next.
        self.features = features
        device, nx, columns = executor.device, executor.grid.nx, executor.tiles_per_row
        self._depth: Field = wp.array([float(sliding.FIRST_DEPTH)], dtype=wp.float64, device=device)
        self.lowest = PerTile(nx, columns, device)  # of the counter-body
        self.highest = PerTile(bodies.disc.shape[0], columns, device)  # of the disc
        self.gap = PerTile(nx, columns, device)  # the lowest of each pair, where it was made
        self.lowest.fill(tile_extremes(np.minimum, bodies.counter), padding=PADDING)
        self.highest.fill(tile_extremes(np.maximum, bodies.disc), padding=-PADDING)
        # The counter-body's lowest of eight tiles and the disc's highest of a row, as they were first made.
        lowest = self.lowest.to_numpy().reshape(nx, -1, LANES).min(axis=2)
        highest = self.highest.to_numpy().max(axis=1)
        self.lowest_of_eight: Field = wp.array(lowest, dtype=wp.float64, device=device)
        self.highest_of_row: Field = wp.array(highest, dtype=wp.float64, device=device)
        self._bounds = arguments(
            sliding.Bounds,
            lowest_of_eight=self.lowest_of_eight,
            highest_of_row=self.highest_of_row,
            lowest=self.lowest.vectors,
            highest=self.highest.vectors,
            gap=self.gap.vectors,
            keeps_gap=int(keeps_gap),
        )

    def add_to(self, program: Program) -> None:
        """Make the list that is asked for, in a program."""
        with program.loop(self.listing):
            program.launch(
                sliding.select,
                *(self.lists.array, self._slides, self._bounds, self.features.sources, self.features.cells),
                *(self._bodies, self.list, self.count),
                chunks=self._chunks_of_bounds,
            )
            self.make_listed(program)
            program.decide(
                sliding.check_list, self.lists.array, self.listing, self._depth, self.count, self._least
            )

    def restored(self) -> None:
        """Make lists and their gaps anew: those that there are may be of another time."""
        self.gap.numbers.zero_()
        self.lists.set(limit=-NO_LIMIT, asked=-NO_LIMIT)

    def make_listed(self, program: Program) -> None:
        """Make what the cells listed have of their own, in a program, where a list serves several steps."""
        unlike = self.features.cells.material is not None or self.features.sources.stiffens == 1
        if self._bounds.keeps_gap and unlike:
            place = self._slides, self.features.sources, self.features.cells
            program.launch(film.make, self.list, self.count, *place, chunks=lambda: self.chunks)

    def refresh(self, program: Program) -> None:
        """Make all bounds anew from the heights, in a program, after what may have raised a surface."""
        slots = self._executor.slots_of(self._bodies.disc.shape[0])
        program.launch(bounds.remake, self._bodies, self._bounds, slots=slots)

    def below_bounds(self) -> float:
        """Return by how much a body stands out of a bound of a tile, or a gap below its own, at most."""
        bodies = self._bodies
        counter, disc = tile_extremes(np.minimum, bodies.counter), tile_extremes(np.maximum, bodies.disc)
        nx, tiles = counter.shape
        lowest = np.maximum(self.lowest.to_numpy(), np.repeat(self.lowest_of_eight.numpy(), LANES, axis=1))
        highest = np.minimum(self.highest.to_numpy(), self.highest_of_row.numpy()[:, None])
        below, above = lowest[:, :tiles] - counter, disc - highest[:, :tiles]
        worst = max(float(below.max()), float(above.max()))
        if self._bounds.keeps_gap:  # gaps, too, stay as they were made
            rows = (np.arange(nx) + self._slides.numpy()["shift"][0]) % disc.shape[0]
            now = tile_extremes(np.minimum, bodies.counter.numpy() - bodies.disc.numpy()[rows])
            known = self.gap.to_numpy()[:, :tiles]
            worst = max(worst, float((known - now)[known != 0.0].max(initial=0.0)))
        return worst

    def begin_at(self, shift: int) -> tuple[float, float]:
        """Return what no gap is lower than at a displacement, and a limit that lists enough tiles [mm]."""
        rows = self.lowest.vectors.shape[0]
        beneath = np.arange(shift, shift + rows) % self.highest.vectors.shape[0]
        bounds, rank = (self.lowest.to_numpy() - self.highest.to_numpy()[beneath]).ravel(), self._least
        enough = float(np.partition(bounds, rank)[rank]) if rank < bounds.size else NO_LIMIT
        return float(bounds.min()), enough

    def _chunks_of_bounds(self) -> list[tuple[int, int]]:
        """Ranges of rows for a list: every bound is looked at, and gaps are made as last time."""
        tiles = self._executor.tiles_per_row * BOUNDS_IN_CELLS + self.count.numpy() * self._cells_of_tile
        return self._executor.split_rows(tiles)
