"""Rough heights that tests of solve_contact share, and its laws."""

from cases_half_space import rough

from warpwear.grid import Grid

GRID = Grid(64, 48, 0.25)
HEIGHTS = rough(GRID, shortest=12)
