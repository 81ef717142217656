"""Rough heights that tests of solve_contact share, and its laws."""

import pytest
from cases_half_space import rough

from warpwear.grid import Grid

GRID = Grid(64, 48, 0.25)
HEIGHTS = rough(GRID, shortest=12)


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device
