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

#: Gaps that differ by less are tied [mm]: a picometre-thousandth, below anything a surface has.
TIE = 1.0e-12
#: First step of a search from an approach that may be exact [mm].
LEAST_REACH = 1.0e-6


class BearingArea:
    """Solves that balance on gaps of one grid. Holds the table that the reductions write."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._sums = executor.partials(3)
        self._cell_area = executor.grid.cell_area

    def solve(
        self,
        gap_field: Field,
        tiles: TileList,
        *,
        start: float,
        scatter: float,
        load: float,
        hardness: float,
        tolerance: float,
    ) -> Balance:
        """Balance of the bearing area, area × hardness = load (thesis eqs 4.8–4.11).

        start: an approach near the solution [mm], which may be off by `scatter`. A bracket is looked for in
        growing steps, then interpolated and halved in turns. The first approach that meets the tolerance [N]
        is taken and the pressure is load/area. Where cells tie, so that no approach meets it, the tied cells
        share what is missing.

        Raises ConvergenceError where the load has no balance.
        """
        needed = load / (hardness * self._cell_area)
        allowed = tolerance / (hardness * self._cell_area)
        low, below = -math.inf, 0.0
        high, above = math.inf, math.inf
        approach, reach = start, max(scatter, LEAST_REACH)
        for evaluation in range(1, MAX_EVALUATIONS):
            tiles.reach(approach, margin=scatter)
            count = self._count(gap_field, tiles, approach)
            if abs(count - needed) < allowed and count > 0:
                return Balance(
                    approach,
                    0.0,
                    load / (count * self._cell_area),
                    (count - needed) * hardness * self._cell_area,
                    evaluations=evaluation,
                )
            if count > needed:
                high, above = approach, count
            else:
                low, below = approach, count
            if math.isinf(low) or math.isinf(high):
                approach += math.copysign(reach, needed - count)
                reach *= DEEPER
                if not reach < HOPELESS:
                    break
                continue
            if high - low <= TIE:
                return self._tied(gap_field, tiles, approach, load, hardness, evaluation)
            part = (needed - below) / (above - below) if evaluation % 3 else 0.5
            approach = low + part * (high - low)
            if not low < approach < high:
                approach = 0.5 * (low + high)
        raise ConvergenceError(f"the bearing area has no balance near an approach of {start:.9g} mm.")

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
        self._executor.launch(
            contact.count_below, inputs=[approach, gap_field], outputs=[self._sums], over=tiles, often=True
        )
        return float(self._sums.numpy()[0].sum())
