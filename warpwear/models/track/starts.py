"""Contacts of a track start from what costs least: the pressure of the place before, of laps ago, or none."""

import logging
import math
from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

from warpwear.engine.executor import Executor, Field
from warpwear.engine.state import Aside, InFrame
from warpwear.kernels.cells import LANES

LOG = logging.getLogger("warpwear.run")

#: Kinds of starts: the last pressure, none, that of the same place and way one lap ago, and what this and the
#: one before lead to.
KINDS = NEIGHBOUR, NOTHING, LAP, AHEAD = "neighbour", "nothing", "lap", "ahead"
#: Furthest that two laps lead, over the distance between them.
FURTHEST = 2.0
#: After so many steps by the kind that costs least the next of the others is tried.
AGAIN = 48
#: Part of the cost of a kind that its last step makes.
FRESH = 0.25


class Way(NamedTuple):
    """Tells which way of a cycle a step goes, and the distance slid at the end of that cycle [mm]."""

    lane: int = 0
    end: float = 0.0


class LapOf(NamedTuple):
    """Tells where pressures of a place begin among laps, and how far ahead of the last a start is, if it is.

    row, row_before: of the last and of the one before. keeps: whether the next one stays there instead.
    """

    row: int
    row_before: int
    ahead: float | None
    keeps: bool


#: The only way of a cycle of one step, and where no pressures are kept.
WAY, NO_LAP = Way(), LapOf(0, 0, None, keeps=False)


class Starts:
    """Keeps the pressures of a lap, and chooses between starts by their pairs of transforms.

    memory: for pressures of laps [B]. places: of contacts in a lap, at most.
    """

    STATE: ClassVar = {
        "_costs": Aside(dict[str, float]),
        **dict.fromkeys(("_steps", "_taken"), Aside(int)),
        "_places": Aside(dict[str, Any]),
        "stored": Aside(InFrame("contact")),
    }
    SCRATCH: ClassVar = ("laps",)

    def __init__(self, executor: Executor, *, memory: float, places: int) -> None:
        self._executor, self._rows = executor, executor.grid.nx
        most = int(memory // (8 * LANES * 2 * self._rows * executor.vectors))
        self._most = min(places, most)
        if places > most:
            LOG.info(
                "pressures of %d of %d places of a lap are kept by run.lap_memory; the others start from the "
                "place before",
                self._most,
                places,
            )
        #: Pressures, one below another, up to two of a place; memory that holds none is never touched.
        self.laps: Field = executor.zeros(max(2 * self._most, 1) * self._rows)
        self._costs: dict[str, float] = {}
        self._steps = self._taken = 0
        #: Of each place the numbers of its pressures, and the distances at the ends of their cycles.
        self._places: dict[str, list[list[Any]]] = {}

    @property
    def stored(self) -> Any:
        """Return the pressures of the places known."""
        return self.laps.numpy()[: self._taken * self._rows]

    @stored.setter
    def stored(self, pressures: Any) -> None:
        host = self.laps.numpy()
        if len(pressures) > len(host):  # of a longer track, whose places are not those of this one
            self.forget()
            return
        host[: len(pressures)] = pressures
        if not self._executor.device.is_cpu:
            self.laps.assign(host)

    def forget(self) -> None:
        """Begin another lap, on another track or by parts of another length."""
        self._places, self._costs, self._taken = {}, {}, 0

    def lap_of(self, place: str, end: float, kind: str, *, keeps: bool) -> "LapOf":
        """Return where the pressures of a place lie, for a start of a kind.

        end: as of `Way`. keeps: whether the next pressure may stay there.
        """
        at = self._places.get(place)
        if at is None:
            if not keeps or len(self._places) == self._most:
                return NO_LAP
            at = [[], []]
        numbers, ends = at
        if keeps and len(numbers) == len(ends) < 2:
            numbers = [*numbers, self._taken]
            self._places[place], self._taken = [numbers, ends], self._taken + 1
        ahead = 0.0 if ends and kind in (LAP, AHEAD) else None
        if kind == AHEAD and len(ends) > 1 and ends[0] > ends[1]:
            ahead = min(max((end - ends[0]) / (ends[0] - ends[1]), 0.0), FURTHEST)
        return LapOf(numbers[0] * self._rows, numbers[-1] * self._rows, ahead, keeps=keeps)

    @property
    def keeps(self) -> bool:
        """Tell whether pressures of laps may be of use: where starts from nothing cost least they are not."""
        return len(self._costs) < len(KINDS) or min(self._costs, key=self._costs.__getitem__) != NOTHING

    def note(self, places: Sequence[str], end: float) -> None:
        """Note that pressures of places stay as their last. end: as of `Way`."""
        for place in places:
            if place in self._places:
                numbers, ends = self._places[place]
                self._places[place] = [[*numbers[-1:], *numbers[:-1]], [end, *ends[:1]]]

    def choose(self, place: str, *, tries: bool) -> str:
        """Choose how parts of a step start, the first of them at a place. tries: also dearer ways."""
        known = len(self._places[place][1]) if place in self._places else 0
        kinds = KINDS[: 2 + known]
        new = [kind for kind in kinds if kind not in self._costs]
        if new and tries:
            return new[0]
        number, left = divmod(self._steps, AGAIN)
        best = min(kinds, key=lambda kind: self._costs.get(kind, math.inf))
        others = [kind for kind in kinds if kind != best]
        return others[number % len(others)] if tries and left == 0 else best

    def learn(self, kind: str, pairs: float) -> None:
        """Note how many pairs of transforms the parts of a step have taken in the mean."""
        self._steps += 1
        before = self._costs.get(kind, pairs)
        self._costs[kind] = before + FRESH * (pairs - before)
