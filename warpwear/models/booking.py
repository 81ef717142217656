"""Steps that were made many at a time, entered into the books in one piece."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from warpwear.contact.balance import Balance
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step


def booked(
    ledger: Ledger,
    numbers: Sequence[Any],
    increments: FloatArray,
    removals: FloatArray,
    total: dict[str, Any],
    most: dict[str, Any],
    enter: Callable[..., Step],
) -> Iterator[Step]:
    """Enter steps into the books, and yield them.

    numbers: columns of a balance, and what the scatter of the pressure counts from [MPa], of each step; total
    and most likewise. removals: a row a step. enter: books one as a step made by itself, here the last: it
    may be one that fails.
    """
    count = len(numbers[0])
    if not count:
        return
    *balance, reference = numbers

    def part(values: dict[str, FloatArray], which: Any) -> dict[str, Any]:
        return {name: column[which] for name, column in values.items()}

    before, last = slice(0, count - 1), count - 1
    if last:
        yield from ledger.enter_all(
            Balance(*(column[before] for column in balance)),
            increments[before],
            tuple(removals[before].T),
            reference[before],
            part(total, before),
            part(most, before),
        )
    alone = Balance._make(float(column[last]) for column in balance)
    sums, maxima = ({n: float(v) for n, v in part(values, last).items()} for values in (total, most))
    removed = tuple(removals[last].tolist())
    yield enter(alone, float(increments[last]), removed, float(reference[last]), sums, maxima)
