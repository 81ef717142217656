"""Fields in fewer places than they have, as figures show them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from warpwear.grid import FloatArray


def over_blocks(combine: np.ufunc, field: NDArray[Any], n: int) -> NDArray[Any]:
    """Combine the places of squares of n × n, shape (blocks, blocks); part of a square is left out."""
    nx, ny = field.shape[0] // n, field.shape[1] // n
    # Rows first: what is left for the slow direction is smaller by n.
    rows = combine.reduce(field[: nx * n, : ny * n].reshape(nx, n, ny * n), axis=1)
    return np.asarray(combine.reduce(rows.reshape(nx, ny, n), axis=2))


def coarsen(field: FloatArray, most: int) -> tuple[FloatArray, int]:
    """Return means over squares, at most `most` along a side that is not narrow, and the places of a side."""
    n = min(-(-max(field.shape) // most), *field.shape)
    return over_blocks(np.add, field, n) / n**2, n
