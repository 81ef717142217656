"""Circles of a rotating disc: unworn where a programme first slides on one, then found as it was left.

All circles of a programme are parts of one length of the same surface, so that a model has room for one of
them. What it holds of the disc is put aside when the counter-body leaves a circle.
"""

from typing import Any, ClassVar

import numpy as np

from warpwear.engine import state

#: What is of the disc among the arrays of a model, by parts of their names.
OF_THE_DISC = ("disc", "highest")


class Circles:
    """Holds what a model has of the disc on the circles that were left, and on an unworn one.

    model: of a track, on the unworn disc.
    """

    STATE: ClassVar = {"left": dict[str, dict[str, Any]], "booked": dict[str, dict[str, Any]]}

    def __init__(self, model: Any) -> None:
        self._unworn = _of_the_disc(model)
        #: Arrays, and what the ledger had returned, by the number of the circle.
        self.left: dict[str, dict[str, Any]] = {}
        self.booked: dict[str, dict[str, float]] = {}

    def change(self, model: Any, before: int, after: int) -> None:
        """Let a model leave one circle of the disc for another, by their numbers."""
        arrays, numbers = state.save(model, whole=True)
        other = self.left.pop(str(after), self._unworn)
        self.left[str(before)] = {name: arrays[name] for name in other}
        state.restore(model, arrays | other, numbers)
        self.booked[str(before)] = model.change_circle(self.booked.get(str(after), {}))


def _of_the_disc(model: Any) -> dict[str, "np.ndarray[Any, Any]"]:
    arrays, _ = state.save(model, whole=True)
    return {name: values for name, values in arrays.items() if any(part in name for part in OF_THE_DISC)}
