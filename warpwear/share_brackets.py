"""Between which approaches each of many patches is at a common one."""

import math

import numpy as np
from numpy.typing import NDArray

from warpwear.grid import FloatArray

BoolArray = NDArray[np.bool_]


class Brackets:
    """Of every patch, the nearest points of its curve that lie below and above a common approach.

    Rows of `low` and `high`: approach of the patch, point on its curve (both offsets [mm]), pressure [MPa].
    """

    def __init__(self, count: int, hardness: float) -> None:
        self._lowest = np.repeat([[-math.inf], [-math.inf], [0.0]], count, axis=1)
        self._highest = np.repeat([[math.inf], [math.inf], [hardness]], count, axis=1)
        self.low, self.high = self._lowest, self._highest

    def enter(self, common: float, met: FloatArray) -> None:
        """Keep points met, rows as of `low`, for another common approach."""
        fallen, risen = self.low[1] > common, self.high[1] <= common
        self.high, self.low = (
            np.where(fallen, self.low, np.where(risen, self._highest, self.high)),
            np.where(risen, self.high, np.where(fallen, self._lowest, self.low)),
        )
        self.low = np.where((met[1] <= common) & (met[1] >= self.low[1]), met, self.low)
        self.high = np.where((met[1] > common) & (met[1] <= self.high[1]), met, self.high)

    def total(self, common: float, pressure: FloatArray, *, far: BoolArray, wanted: float) -> float:
        """Sum of the pressures at the common approach [MPa], on its side of the wanted one; NaN while open.

        pressure: of the last points, which are there but for those that are `far`. Where a patch's approach
        is down to neighbouring numbers, its cells are almost rigid and the curve between them is straight.
        """
        (low, below, least), (high, above, most) = self.low, self.high
        if float(least.sum()) > wanted:
            return float(least.sum())
        if float(most.sum()) < wanted:
            return float(most.sum())
        if np.any(np.nextafter(low[far], high[far]) < high[far]):
            return math.nan
        part = (common - below[far]) / (above[far] - below[far])
        there = pressure.copy()
        there[far] = least[far] + part * (most[far] - least[far])
        return float(there.sum())
