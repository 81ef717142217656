"""How many cells of the disc a part of a step may go over, by what doubling it changes.

Some steps in a row are made again from the state before the first of them, in parts twice as long. The change
of their mean area tells what the length of parts does, see docs/theory/limits.md. What wore both bodies in
parts of n cells loses area by parts of any other length, so that longer ones err to the safe side, and
shorter ones do not.
"""

import json
import math
from collections.abc import Mapping
from typing import Any, ClassVar

from warpwear.engine.state import Aside
from warpwear.laws.task import ContactTask

#: Steps in a row that are made again: a part of those so far, at least and at most.
OF_STEPS, LEAST_STEPS, MOST_STEPS = 0.25, 8, 24
#: Steps so far over those at the last change, from which parts may be longer again.
GROWTH = 2.0
#: Change of the area from which parts are measured anew, and steps over which its mean goes.
OF_AREA, RECENT = 0.05, 24
#: Part of the allowed error that measurements may come to.
SAFETY = 0.9
#: What all steps so far lose of the area over what few lose in parts twice as long.
ADDS_UP = 2.0


class PartLength:
    """Chooses the cells of a part of a step, and keeps what was measured of it.

    is_free: whether steps are divided at all; else each is one part, without an error.
    """

    STATE: ClassVar = {
        **dict.fromkeys(("_cells", "_steps", "_next"), Aside(int)),
        **dict.fromkeys(("_load", "_area", "_measured"), Aside(float)),
        **dict.fromkeys(("_slid", "_changes"), Aside(list)),
        **{"_has_fallen": Aside(bool), "_arrays": Aside(dict), "_numbers": Aside(str)},
    }

    def __init__(self, task: ContactTask, *, is_free: bool) -> None:
        self._allowed, self._load, self.is_free = task.area_error, task.load, is_free
        self._task = task
        #: Cells of a part while steps are made again; None while they are not.
        self.trial: int | None = None
        self.forget()

    def forget(self) -> None:
        """Begin as a first contact does: the disc, or the way over it, is another."""
        self._cells, self._steps, self._next, self._has_fallen = 1, 0, 0, False
        #: Mean area of late, and when parts were measured last [mm²].
        self._area = self._measured = 0.0
        #: What doubling parts changed of the area in the last two measurements, relative.
        self._changes: list[float] = []
        self._drop()

    def _drop(self) -> None:
        self._slid: list[Any] = []
        self._arrays: dict[str, Any] = {}
        self._numbers, self._load = "", self._task.load

    @property
    def error(self) -> float:
        """Estimate the error of the area by the length of parts, relative; NaN where it is not known."""
        if not self.is_free:
            return 0.0
        return ADDS_UP * max(self._changes) if self._changes else math.nan

    def cells(self, left: int) -> int:
        """Return the cells of the next part of a step that has some left: about as many as of those after."""
        if not self.is_free:
            return left
        return -(-left // -(-left // (self.trial or self._cells)))

    @property
    def begins(self) -> bool:
        """Tell whether the state before the next step is to be kept."""
        differs = abs(self._area - self._measured) > OF_AREA * self._measured
        return self.is_free and not self._slid and (self._steps >= self._next or differs)

    @property
    def is_due(self) -> bool:
        """Tell whether the steps since are to be made again."""
        if self._slid and self._load != self._task.load:
            self._drop()  # they were another load's
        return len(self._slid) >= min(max(OF_STEPS * self._steps, LEAST_STEPS), MOST_STEPS)

    def keep(self, arrays: Mapping[str, Any], numbers: Mapping[str, Any]) -> None:
        """Keep the state before the next step."""
        self._arrays, self._numbers = dict(arrays), json.dumps(numbers)

    def note(self, increment: float, turned: int, area: float, cells: int | None) -> None:
        """Note a step: its increment in a cycle alone [mm], rows it is turned by, and its area [mm²].

        cells: that it has gone over; None where it stands for more than itself.
        """
        self._steps += 1
        self._area += (area - self._area) / min(self._steps, RECENT)
        if self._numbers and not self.is_due:
            self._slid.append((increment, turned, cells and cells * area))

    @property
    def of_part(self) -> int:
        """Return the cells of a part."""
        return self._cells

    @property
    def kept(self) -> tuple[dict[str, Any], dict[str, Any], list[tuple[float, int]], float | None]:
        """Return the state before the steps to be made again, those, and their area × cells [mm²].

        None stands for the last where they are to be made again as they were: one has stood for others.
        """
        areas = [area for *_, area in self._slid]
        slid = [(float(increment), int(turned)) for increment, turned, _ in self._slid]
        return self._arrays, json.loads(self._numbers), slid, None if None in areas else sum(areas)

    def judge(self, area: float, doubled: float, *, shift: int, cell_area: float) -> bool:
        """Learn from areas by parts as they are and twice as long; tell whether this has changed them.

        shift: cells of a step. cell_area: of one cell [mm²], which is the least change that an area tells.
        """
        before = self._cells
        change = max(abs(doubled / area - 1.0), cell_area / self._area)
        rises = not self._has_fallen or self._steps >= self._next
        if rises and before < shift and _error(2 * before, 2.0 * change) <= SAFETY * self._allowed:
            self._cells, change = 2 * before, 2.0 * change
            self._changes = []
        while _error(self._cells, change) > SAFETY * self._allowed:
            self._cells, change, self._has_fallen = self._cells // 2, 0.5 * change, True
            self._changes = []
        self._changes = [*self._changes, change][-2:]
        self._measured = self._area
        self._drop()
        changes = self._cells != before
        if changes or rises:
            self._next = int(GROWTH * self._steps) if self._has_fallen or not changes else self._steps
        return changes


def _error(cells: int, change: float) -> float:
    """Return what parts of some cells do to the area against those of one. change: by doubling them."""
    return ADDS_UP * change * (1.0 - 1.0 / cells)
