"""Steps that were made many at a time, entered into the books in one piece."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from warpwear.history.recorder import Entry, Ledger, Step, StepColumns


def booked(ledger: Ledger, steps: Entry, enter: Callable[..., Step]) -> Iterator[Step | StepColumns]:
    """Enter steps into the books, arrays of one number a step, and yield all but the last, and the last.

    enter: books one as a step made by itself, here the last: it may be one that fails.
    """
    count = len(steps.increment)
    if count > 1:
        yield ledger.enter_all(*_of(steps, slice(0, count - 1)))
    if count:
        yield enter(*_of(steps, count - 1))


def _of(values: Any, which: Any) -> Any:
    """Return some of the numbers of every array, one as a float."""
    if isinstance(values, Mapping):
        return {name: _of(column, which) for name, column in values.items()}
    if isinstance(values, np.ndarray):
        return values[which] if isinstance(which, slice) else float(values[which])
    parts = [_of(column, which) for column in values]
    return type(values)._make(parts) if hasattr(values, "_make") else tuple(parts)
