"""NumPy's loop on the cells that can touch alone: what one writes who knows that they are few."""

import numpy as np

from contenders.baselines import FloatArray, NumpyLoop, Problem, Solved

#: How far beyond the last approach cells are candidates, in lengths that the approach is expected to go.
MARGIN = 4.0


class CandidateLoop(NumpyLoop):
    """One pass over the gap finds the candidates; balance and wear work on them alone.

    For contacts with compliance and a disc without distance factor. Volumes are running sums.
    """

    def __init__(self, problem: Problem, gap: FloatArray) -> None:
        super().__init__(problem, gap)
        self._problem_of_some = problem.without_factor()
        self._volumes = 0.0, 0.0

    def allocate(self) -> None:
        """Flags of the candidates; work arrays are theirs alone."""
        self._flags = np.empty(self.gap.shape, dtype=bool)

    def advance(self, increment: float) -> Solved:
        """Balance the load, then wear over an increment [mm]."""
        problem = self.problem
        if self.last is None:  # cold: everything is a candidate
            bound = float(self.gap.max())
            margin = 0.0
        else:
            approach, mean = self.last
            margin = MARGIN * (problem.wear_sphere + problem.wear_disc) * increment * mean
            bound = approach + margin
        while True:
            np.less_equal(self.gap, bound, out=self._flags)
            some = np.flatnonzero(self._flags)
            loop = NumpyLoop(self._problem_of_some, self.gap.ravel()[some])
            loop.last = self.last
            try:
                found = loop.advance(increment)
            except ArithmeticError:
                if some.size == self.gap.size:
                    raise
                found = None
            if found is not None and (found.approach <= bound or some.size == self.gap.size):
                break
            margin *= 4.0
            bound += margin
        del loop.overlap, loop.work
        self.gap.ravel()[some] = loop.gap
        self.wear_sphere.ravel()[some] += loop.wear_sphere
        self.wear_disc.ravel()[some] += loop.wear_disc
        self.last = loop.last
        self._volumes = self._volumes[0] + found.volume_sphere, self._volumes[1] + found.volume_disc
        return Solved(found.approach, *self._volumes, found.area, found.evaluations)
