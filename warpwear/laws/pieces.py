"""Wear in pieces: what Archard's law takes off a body is pending until a piece of it leaves.

A piece is a bowl of diameter d* and thickness t at its middle, t (1 − (2r/d*)²), cut down to a crack surface:
never subtracted, which digs pits that run away.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.laws.archard import Scales

#: Rounds of a step in which pieces leave; what is left waits for the next step.
ROUNDS = 60


@dataclass(frozen=True)
class Pieces(Scales):
    """Describes the pieces by which a body wears, instead of the dust of Archard's law."""

    diameter: float  # d* [mm]
    thickness: float  # t [mm]
    dust: float = 0.0  # share of K p ΔL that leaves at once
    seed: int | None = None  # of a uniform start; None: nothing is pending at first

    def footprint(self, cell: float) -> tuple["np.ndarray[Any, Any]", FloatArray]:
        """Return offsets of the cells closer than d*/2 to the middle, shape (n, 2), and bowl depths [mm]."""
        half = math.ceil(0.5 * self.diameter / cell)
        places = np.mgrid[-half : half + 1, -half : half + 1].reshape(2, -1).T
        # In cells, and squared: whether a cell is in must not hang on a rounding of cell lengths.
        across = (self.diameter / cell) ** 2 * (1.0 - 1.0e-9)
        reached = 4.0 * np.square(places).sum(axis=1)
        inside = reached < across
        bowl = self.thickness * (1.0 - reached[inside] * (cell / self.diameter) ** 2)
        return places[inside], bowl

    def reach(self, cell: float) -> int:
        """Return how many cells beside a peak the middle of a piece may lie, along x or y."""
        return int(0.5 * self.diameter / cell + 1.0 + 1.0e-9)

    def apart(self, cell: float) -> int:
        """Return within how many cells of a peak, along x and y, no other is one: footprints stay apart."""
        return int(2.0 * self.diameter / cell + 2.0 + 1.0e-9)

    def margin(self, cell: float) -> int:
        """Return how many cells beside one in contact a piece may reach, along x or y."""
        return 2 * math.ceil(0.5 * self.diameter / cell) + self.reach(cell)

    def volume(self, cell: float) -> float:
        """Return V* of a piece on a grid of cells [mm³]; (π/8) d*² t of a fine one."""
        return float(self.footprint(cell)[1].sum()) * cell**2

    def start(self, shape: tuple[int, int], cell: float, *, body: int) -> FloatArray:
        """Return the depth pending at first [mm], of the cells of a body.

        Zero; or a depth for each square of side d*, drawn between none and that of which a piece leaves, so
        that pieces are at every stage on grids of any cell. body: 0 of the counter-body, 1 of the disc.
        """
        if self.seed is None:
            return np.zeros(shape)
        side = max(round(self.diameter / cell), 1)
        squares = (-(-shape[0] // side), -(-shape[1] // side))
        drawn = np.random.default_rng([self.seed, body]).random(squares)
        bowl = self.footprint(cell)[1]
        depths = np.repeat(np.repeat(drawn, side, axis=0), side, axis=1)[: shape[0], : shape[1]]
        return np.ascontiguousarray(depths * bowl.mean())
