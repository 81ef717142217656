"""How far a cell slides while the sphere slides by an increment."""

from typing import Literal

import numpy as np

from warpwear.grid import FloatArray, Grid


def distance_factor(grid: Grid, kind: Literal["none", "across", "radial"], *, curvature: float) -> FloatArray:
    """Sliding distance of a disc cell relative to that of the middle, cos θ with sin θ = d/R.

    Thesis eqs 4.21 and 4.22, used relative to the value at the centre. d is the distance from the middle
    across the sliding direction (as its figure 4.30b shows) or radially (as its text says). It is the chord
    of the ball, not of the contact: a published option, not geometry.

    curvature: 1/R [1/mm]. Shape (1, 1), (1, ny) or (nx, ny).
    """
    if kind == "none":
        return np.ones((1, 1))
    d2 = grid.y[None, :] ** 2
    if kind == "radial":
        d2 = d2 + grid.x[:, None] ** 2
    return np.sqrt(np.maximum(0.0, 1.0 - d2 * curvature**2))
