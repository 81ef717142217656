"""Steps that were made many at a time, entered into the books in one piece."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.kernels.cells import EXTENTS


class Found(NamedTuple):
    """Hold what was found of the steps that were made: of each quantity an array."""

    steps: int
    balance: Any  # a Balance of arrays
    reference: FloatArray  # that the scatter of the pressure counts from [MPa]
    total: dict[str, Any]
    most: dict[str, Any]


def booked(
    block: Found,
    ledger: Ledger,
    increments: FloatArray,
    removals: FloatArray,
    enter: Callable[..., Step],
) -> Iterator[Step]:
    """Enter steps into the books, and yield them.

    removals: a row a step. enter: books one as a step made by itself: the last, and those from the first that
    widens the contact to where that is told.
    """
    count, balance, reference, total, most = block
    if not count:
        return
    wide = np.zeros(count, dtype=bool)
    for name, limit in zip(EXTENTS, ledger.within, strict=True):
        wide |= most[name][:count] > limit
    whole = int(np.argmax(wide)) if wide.any() else count
    before = slice(0, min(whole, count - 1))

    def part(values: dict[str, FloatArray], which: Any) -> dict[str, Any]:
        return {name: column[which] for name, column in values.items()}

    if before.stop:
        yield from ledger.enter_all(
            balance._make(column[before] for column in balance),
            increments[before],
            tuple(removals[before].T),
            reference[before],
            part(total, before),
            part(most, before),
        )
    for one in range(before.stop, count):
        alone = balance._make(float(column[one]) for column in balance)
        sums, maxima = ({n: float(v) for n, v in part(values, one).items()} for values in (total, most))
        removed = tuple(removals[one].tolist())
        yield enter(alone, float(increments[one]), removed, float(reference[one]), sums, maxima)
