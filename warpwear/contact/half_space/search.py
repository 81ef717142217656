"""Projected conjugate gradients for a pressure between bounds that carries a load.

A trial step is clipped to 0 ≤ p ≤ H and shifted to the load, then the minimum along the way to it is taken,
so that every iterate is feasible, none is worse than the last, and an iteration costs one pair of transforms,
two with the preconditioner |q| E*/2. The root is Polonsky and Keer 1999, Wear 231, 206; Almqvist et al. 2007,
Tribol. Int. 40, 574 added the cap, Vollebregt 2014, J. Comput. Phys. 257, 333 the preconditioner.

Parts with loads of their own have levels and shifts of their own, and the length and the memory of a step in
common: together they are one problem, whose matrix has a block for each.
"""

import math

import numpy as np

from warpwear.contact.balance import TOLERANCE
from warpwear.contact.half_space import few
from warpwear.contact.half_space.passes import NO_CAP, Iterate, Products, SearchSums
from warpwear.grid import FloatArray
from warpwear.kernels.cells import PADDING

#: Where a smaller fraction of the cells in contact is below the cap, |q| is no guide: steps then follow the
#: plain gradient.
ELASTIC_FRACTION = 0.1
#: Plain steps of a solve; |q| leads on where so many have not led to its end.
PATIENCE = 16
#: A step is taken whole, bounds and all, if it is at least this fraction of the best length; else the best
#: length is taken.
WHOLE_STEP = 0.9
#: A preconditioned step whose best length is below this led nowhere: plain steps follow.
SHORTEST_USEFUL_STEP = 0.05
#: Plain steps that follow then.
PLAIN_STEPS = 5
#: Cells at a bound are pushed outward this many times harder than free cells move, in a preconditioned step.
OUTWARD = 1.0e3


class Search:
    """The iterations of one solve: what the next step remembers of the last."""

    def __init__(
        self, iterate: Iterate, asked: FloatArray | None, approach: float | None, stiffness: float
    ) -> None:
        self._iterate = iterate
        self._asked = asked
        self._approach = approach
        #: Length of a trial step by kind, plain or not, and whether it has been measured.
        self._length = {True: stiffness, False: 1.0}
        self._measured = {True: False, False: False}
        self._curvature = 0.0
        self._last: bool | None = None  # kind of the last step; None: nothing to remember
        self._plain_left = 0
        self._plain_steps = 0  # so far
        #: Violation from which moving few cells alone is not tried [mm].
        self._few_below = math.inf

    def level(self, state: SearchSums) -> FloatArray:
        """Approach λ of each part [mm]: given, or the mean gap of the cells between the bounds.

        Where there are none, it is the gap of the cell which is next to take load, or to give it.
        """
        if self._approach is not None or self._asked is None:
            return np.full(1, self._approach or 0.0)
        if state.between.all():
            return state.level / state.between
        # Where no cell touches, or all that there are carry the hardness, one of the two is missing.
        highest = np.where(state.highest > -NO_CAP, state.highest, state.lowest)
        lowest = np.where(state.lowest < PADDING, state.lowest, state.highest)
        loaded = np.abs(state.total - self._asked) <= TOLERANCE * self._asked
        following = np.where(state.total < self._asked, lowest, highest)
        following = np.where(loaded, 0.5 * (highest + lowest), following)
        return np.where(state.between > 0.0, state.level / np.maximum(state.between, 1.0), following)

    def move(self, state: SearchSums, level: FloatArray, *, loaded: bool) -> SearchSums | None:
        """Make one iteration; None where no step leads on.

        loaded: whether the pressure carries the load. If not, the step is taken whole, so that it does.
        """
        while True:
            between = state.between.sum()
            capped = between <= ELASTIC_FRACTION * state.touching.sum()
            patient = self._plain_steps < PATIENCE or between == 0.0
            plain = self._plain_left > 0 or (capped and patient)
            self._plain_left = max(self._plain_left - 1, 0)
            self._plain_steps += plain
            if (plain or capped) and loaded and (settled := self._settle_few(state, level)) is not None:
                return settled
            remembers = self._last is plain
            aimed = self._aim(level, plain)
            if aimed is not None:
                slope, curvature, used = self._iterate.step(level, aimed)
                best = -slope / curvature if curvature > 0.0 else math.nan
                if best > 0.0 or not loaded:
                    self._curvature = curvature
                    return self._go(plain, aimed, best, used, loaded)
            # The step leads up. Without memory and preconditioner it cannot, but for rounding.
            if plain and not remembers:
                if aimed is None or used < 1.0:
                    return None
                # A pressure off its bound by the last digit of the load hides where the others want to go.
                return self._go(plain, aimed, 1.0, used, loaded)
            self._last, self._plain_left = None, PLAIN_STEPS

    def _settle_few(self, state: SearchSums, level: FloatArray) -> SearchSums | None:
        """Move the few cells alone whose place is open; None where that is no way."""
        if self._asked is None or not self._iterate.can_aim_at_few or state.between.sum() > few.FEW:
            return None
        violation = max(float((state.highest - level).max()), float((level - state.lowest).max()))
        if violation > self._few_below:
            return None
        self._few_below = 0.5 * violation
        if not few.aim(self._iterate, level.item(), violation):
            return None
        shift = np.zeros_like(level)
        slope, curvature, _ = self._iterate.step(level, shift)
        if not -slope > 0.5 * curvature > 0.0:  # it leads up
            return None
        self._last = None
        return self._iterate.advance(1.0, shift=shift)

    def _aim(self, level: FloatArray, plain: bool) -> FloatArray | None:
        """Make the trial pressure; return the shifts that restore its load, None where it leads up."""
        z, z_level = self._iterate.descent(level, plain=plain)
        sums = self._iterate.products(level, z, z_level)
        mean = np.zeros_like(level) if self._asked is None else sums.z / np.maximum(sums.cells, 1.0)
        memory = 0.0
        if self._last is plain:
            memory = max(0.0, float((sums.zy - mean * sums.y).sum()) / self._curvature)
        downhill = float((sums.zr - mean * sums.r).sum())
        if memory * float(sums.sr.sum()) >= downhill:
            memory = 0.0
        if not plain and not downhill > 0.0:
            return None
        outward = 1.0 if plain else OUTWARD * _ratio(sums)
        carried = self._iterate.aim(
            level, z, z_level + mean, memory=memory, length=self._length[plain], outward=outward
        )
        if self._asked is None:
            return np.zeros_like(level)
        unit = self._length[plain] * np.maximum(sums.largest_z, sums.largest_r * outward)
        return self._iterate.balance(self._asked, *carried, unit=unit)

    def _go(self, plain: bool, shift: FloatArray, best: float, used: float, loaded: bool) -> SearchSums:
        """Go along the step as far as is best.

        best: length at which the minimum along it lies, in steps. used: largest fraction of its room to a
        bound that a cell uses in a whole step.
        """
        if not loaded or WHOLE_STEP < best <= 1.0 or (best > 1.0 and best * used > 1.0):
            state = self._iterate.advance(1.0, shift=shift)
        else:
            state = self._iterate.advance(best)
        if not loaded:
            return state
        if not plain and best <= SHORTEST_USEFUL_STEP:
            self._plain_left = PLAIN_STEPS
        # The best length of a step that the bounds cut short may say nothing.
        factor = min(max(best, 0.5), 2.0) if self._measured[plain] else min(best, 2.0)
        self._length[plain] *= factor
        self._measured[plain] = True
        self._last = plain
        return state


def _ratio(sums: Products) -> float:
    """Largest descent over largest gradient [MPa/mm]."""
    largest_z, largest_r = float(sums.largest_z.max()), float(sums.largest_r.max())
    return largest_z / largest_r if largest_r > 0.0 else 0.0
