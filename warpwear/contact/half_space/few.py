"""The exact move of the few cells of a half-space contact whose place between the bounds is open.

Where nearly all cells in contact bear the hardness, the others are few: those between the bounds, and those
near enough to change sides. The pressure that is best for them, while all others stay, solves a small dense
problem, to which conjugate steps take one transform after another.
"""

import numpy as np

from warpwear.contact.half_space.passes import Iterate
from warpwear.grid import FloatArray
from warpwear.laws.linear import solve

#: Cells that are moved at once, at most.
FEW = 256
#: Gap left or overlap of a cell that may change sides, over the largest violation of complementarity.
NEAR = 0.25
#: Changes of sides at most.
ROUNDS = 30


def aim(iterate: Iterate, level: float, violation: float) -> bool:
    """Make the trial pressure the best one for the cells that are open; whether there are few enough.

    level: approach [mm]. violation: the largest [mm].
    """
    pressure, gradient, caps, trial = iterate.on_host()
    off, near = gradient - level, NEAR * violation
    places = ((pressure > 0.0) | (off < near)) & ((pressure < caps) | (off > -near))
    rows, columns = np.nonzero(places)
    if not 0 < rows.size <= FEW:
        return False
    p, cap = pressure[places], np.broadcast_to(caps, places.shape)[places]
    moved = best_of_few(iterate.coefficients(rows, columns), off[places], -p, cap - p)
    if moved is None:
        return False
    trial[:] = pressure
    # exact at the bounds, which a sum may miss by its last digit
    trial[places] = np.where(moved <= -p, 0.0, np.where(moved >= cap - p, cap, p + moved))
    return True


def best_of_few(
    matrix: FloatArray, slope: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray | None:
    """Changes x between bounds, whose sum is 0, with the least ½ x·matrix x + slope·x.

    The bounds that hold are changed until they suit (Hintermüller, Ito and Kunisch 2002, SIAM J. Optim. 13,
    865). None where none lie between them, or no end is in sight.
    """
    below = above = np.zeros(slope.size, dtype=bool)
    # a constant added, which a fixed sum does not feel, makes the matrix of all cells regular as well
    regular = float(matrix.max())
    for _ in range(ROUNDS):
        x = np.where(below, low, np.where(above, high, 0.0))
        free = ~(below | above)
        count = int(free.sum())
        if not count:
            return None
        right = np.stack([-slope[free] - np.einsum("ij,j->i", matrix[free], x), np.ones(count)], axis=1)
        alone, shifted = solve(matrix[np.ix_(free, free)] + regular, right).T
        level = (alone.sum() + x.sum()) / shifted.sum()
        x[free] = alone - level * shifted
        level += regular * x[free].sum()
        pull = np.einsum("ij,j->i", matrix, x) + slope + level  # negative where a cell would rise
        was_below, below = below, np.where(free, x < low, below & (pull >= 0.0))
        was_above, above = above, np.where(free, x > high, above & (pull <= 0.0))
        if (below == was_below).all() and (above == was_above).all():
            return x
    return None
