"""Load balance of a contact without compliance: area × hardness = load.

The area rises with the approach in steps, cell by cell, so the approach is looked for in a bracket.
"""

import math

import numpy as np

from warpwear.contact.balance import DEEPER, HOPELESS, MAX_EVALUATIONS, Balance
from warpwear.engine.executor import Executor, Field
from warpwear.engine.tiles import TileList
from warpwear.errors import ConvergenceError
from warpwear.kernels import contact
from warpwear.kernels.running_in import caps

#: Gaps that differ by less are tied [mm]: a picometre-thousandth, below anything a surface has.
TIE = 1.0e-12


class BearingArea:
    """Solves that balance on gaps of one grid. Holds the table that the reductions write."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._sums = executor.partials(3)
        #: Of the hardness, that each cell bears: it counts as that part of one; None: all of it.
        self.parts: Field | None = None
        self._cell_area = executor.grid.cell_area

    def bounds(self, gap_field: Field, tiles: TileList) -> tuple[float, float]:
        """Smallest and largest gap of the tiles listed [mm]."""
        self._executor.launch(
            contact.bounds, inputs=[gap_field], outputs=[self._sums], over=tiles, often=True
        )
        extremes = self._sums.numpy()
        return float(extremes[0].min()), float(extremes[1].max())

    def between(
        self, gap_field: Field, tiles: TileList, *, highest: float, needed: float
    ) -> tuple[float, float]:
        """Approaches between which a balance lies [mm]: of no cell, and of as many as are needed.

        highest: gap before wear [mm].
        """
        tiles.begin()
        # What is listed may be worn beyond the limit of the list, where lower tiles that are not may lie.
        low = min(self.bounds(gap_field, tiles)[0], tiles.limit)
        high = highest + 2.0 * TIE  # so that the highest cell counts
        if self._count(gap_field, tiles, high) < needed:  # all cells are worn beyond it
            tiles.reach(math.inf)
            high = self.bounds(gap_field, tiles)[1] + 2.0 * TIE
        return low, high

    def solve(
        self,
        gap_field: Field,
        tiles: TileList,
        *,
        load: float,
        hardness: float,
        tolerance: float,
        start: float | None = None,
        scatter: float = 0.0,
        highest: float = math.inf,
    ) -> Balance:
        """Balance of the bearing area, area × hardness = load (thesis eqs 4.8–4.11).

        start: an approach near the solution [mm], which may be off by `scatter`: a bracket is looked for in
        growing steps, then interpolated and halved in turns. Without one all that lies up to the highest gap
        before wear [mm] is bisected. The first approach that meets the tolerance [N] is taken and the
        pressure is load/area. Where cells tie, so that no approach meets it, the tied cells share what is
        missing.

        Raises ConvergenceError where the load has no balance.
        """
        needed = load / (hardness * self._cell_area)
        allowed = tolerance / (hardness * self._cell_area)
        below, above = 0.0, math.inf
        if start is None:
            low, high = self.between(gap_field, tiles, highest=highest, needed=needed)
            approach, reach = 0.5 * (low + high), 0.0
        else:
            low, high, approach, reach = -math.inf, math.inf, start, scatter
        for evaluation in range(1, MAX_EVALUATIONS):
            if start is not None:
                tiles.reach(approach, margin=scatter)
            count = self._count(gap_field, tiles, approach)
            if approach > tiles.limit and count - needed < allowed:  # others may touch as well
                tiles.reach(approach, margin=scatter)
                count = self._count(gap_field, tiles, approach)
            if abs(count - needed) < allowed and count > 0:
                residual = (count - needed) * hardness * self._cell_area
                cap = load / (count * self._cell_area)
                return Balance(approach, 0.0, cap, residual, evaluations=evaluation)
            before = high - low
            if count > needed:
                high, above = approach, count
            else:
                low, below = approach, count
            if (before if start is None else high - low) <= TIE:
                return self._tied(gap_field, tiles, approach, load, hardness, evaluation)
            if math.isinf(low) or math.isinf(high):
                approach += math.copysign(reach, needed - count)
                reach *= DEEPER
                if not reach < HOPELESS:
                    break
                continue
            # Over the whole of a surface the counts at the ends say nothing of what lies between.
            halved = start is None or evaluation % 3 == 0
            approach = 0.5 * (low + high)
            if not halved:
                straight = low + (needed - below) / (above - below) * (high - low)
                approach = straight if low < straight < high else approach
        raise ConvergenceError(f"the bearing area has no balance near an approach of {approach:.9g} mm.")

    def _tied(
        self, gap_field: Field, tiles: TileList, approach: float, load: float, hardness: float, done: int
    ) -> Balance:
        above = float(np.nextafter(approach + TIE, math.inf))
        tiles.reach(above)
        below = self._count(gap_field, tiles, approach - TIE)
        tied = self._count(gap_field, tiles, above) - below
        needed = load / (hardness * self._cell_area)
        part = (needed - below) / tied if tied else math.nan
        if not 0.0 <= part <= 1.0:
            raise ConvergenceError(
                f"the bearing area has no balance near an approach of {approach:.9g} mm: {below:.0f} cells "
                f"lie below it, {tied:.0f} are tied with it, and the load asks for {needed:.3f}."
            )
        # The full cells carry the hardness, so the load is met without a rescaling of the pressure.
        return Balance(
            approach,
            0.0,
            hardness,
            (below + part * tied) * hardness * self._cell_area - load,
            tie_width=TIE,
            tie_pressure=part * hardness,
            evaluations=done + 2,
        )

    def _count(self, gap_field: Field, tiles: TileList, approach: float) -> float:
        """Cells in contact at an approach, of the tiles listed."""
        own = [] if self.parts is None else [self.parts]
        self._executor.launch(
            caps.below if own else contact.count_below,
            inputs=[approach, gap_field, *own],
            outputs=[self._sums],
            over=tiles,
            often=True,
        )
        return float(self._sums.numpy()[0].sum())
