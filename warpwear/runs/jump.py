"""Cycles of a track that stand for many: how many each may stand for, and what that does to the depths.

A jump of n cycles is one cycle whose increments are n times as long: at each of its places both bodies lose
n K p dL, and laws of the distance are integrated over all that it stands for. Its local error is C n (n − 1),
none for n = 1. Now and then a look computes the next cycles twice, from one state: as one jump of 2 m cycles
and as two of m. What their worn depths differ by is 2 C m², rms over the scar; then the state is put back.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import Any, ClassVar

import numpy as np

from warpwear.engine import state
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.laws.archard import BODIES
from warpwear.models.model import Model
from warpwear.runs.plan import Planned, kept_after
from warpwear.study.study import Study

#: Part of the tolerance that a jump is made for, as the next ones differ from the one looked at.
SAFETY = 0.8
#: Jumps between looks: of a size that the error bounds, and of one that may double still.
JUMPS, DOUBLING = 8, 2
#: Cycles computed each by itself between looks, over those done.
OF_DONE = 0.25
#: Most that a jump may change mean area and bare fraction of the contact, relative.
OF_CONTACT = 0.02


class CycleJumps:
    """Plans the cycles of a run one by one, as steps of a model, and keeps the books of their error.

    Snapshots and the end are met: their cycles, and the last whole one, stand for themselves.
    """

    STATE: ClassVar = {
        "model": Model,
        "stands_for": int,
        "made": int,
        "errors": dict,
        "_cycle": int,
        "_step": int,
        "_size": int,
        "_next_look": int,
        "_seen": dict,
    }

    def __init__(self, study: Study, model: Model) -> None:
        self.model, self._track, self._total = model, study.track, study.sliding.total
        self._stops = study.snapshot_distances
        jump = study.stepping.jump
        self._fixed = jump if isinstance(jump, int) else None
        self._tolerance = study.stepping.jump_error
        cycle, end = self._track.cycle, self._total / self._track.cycle
        #: Cycles that stand for themselves: those with a stop, and all from the last whole one on.
        self._alone = sorted({max(math.ceil(stop / cycle - 1.0e-9) - 1, 0) for stop in self._stops})
        self._last = max(math.floor(end - 1.0 + 1.0e-9), 0)
        #: Cycles that the one being made stands for; contacts computed, looks included.
        self.stands_for, self.made = 1, 0
        #: Sums of the local errors of worn depths, by body [mm, root of the sum over cells].
        self.errors = dict.fromkeys(BODIES, 0.0)
        self._cycle = self._step = self._next_look = 0
        self._size = self._fixed or 1
        #: C of each body, as last seen.
        self._seen = dict.fromkeys(BODIES, 0.0)

    def parts(self) -> Iterator[list[Planned]]:
        """Yield the steps that are left of the cycle at hand, then those of each cycle to be computed."""
        while self._begin_at(self._cycle) < self._total * (1.0 - 1.0e-12):
            if self._step == 0:
                self._choose()
            self.model.stands_for = self.stands_for
            yield self._planned(self._cycle, self.stands_for)[self._step :]

    def count(self) -> None:
        """Book a step that was made."""
        self._step, self.made = self._step + 1, self.made + 1
        if self._step == self._steps:
            n = self.stands_for
            self.errors = {body: e + n * (n - 1) * self._seen[body] for body, e in self.errors.items()}
            self._cycle, self._step = self._cycle + n, 0

    def told(self) -> dict[str, Any]:
        """Return what a result says of its jumps: errors relative to the rms depth of the whole run."""
        depths = {body: _norm(worn) for body, worn in self._worn().items()}
        error = {body: self.errors[body] / depths[body] if depths[body] else 0.0 for body in BODIES}
        cycles = self._total / self._track.cycle
        return {
            "contacts": self.made,
            "contacts_of_every_cycle": int(self._track.steps(self._total)),
            "cycles": cycles,
            "depth_error": error,
        }

    @property
    def _steps(self) -> int:
        return self._track.passes_of_cycle * self._track.steps_of_pass

    def _begin_at(self, cycle: int) -> float:
        return cycle * self._track.cycle

    def _planned(self, cycle: int, stands_for: int) -> list[Planned]:
        """Plan the steps of a cycle that stands for so many."""
        begin = self._begin_at(cycle)
        steps = list(islice(self._track.increments(self._total, cycle=cycle), self._steps))
        if stands_for == 1:
            ahead = [stop for stop in self._stops if stop > begin + 1.0e-6 * steps[0][0]]
            return kept_after(ahead, steps, self._total)
        ends = [begin + stands_for * (end - begin) for _, end in steps[:-1]]
        ends.append(self._begin_at(cycle + stands_for))
        return [(stands_for * step, end, False) for (step, _), end in zip(steps, ends, strict=True)]

    def _free(self) -> int:
        """Return how many cycles from here on may be jumped over."""
        ends = [cycle for cycle in (*self._alone, self._last) if cycle >= self._cycle]
        return min(ends, default=self._cycle) - self._cycle

    def _choose(self) -> None:
        """Choose what the cycle that begins stands for, after a look where one is due."""
        free = self._free()
        if self._cycle >= self._next_look and free >= 2:
            self._look(min(self._size, free // 2))
        self.stands_for = max(min(self._size, free), 1)

    def _look(self, m: int) -> None:
        """Compute the next cycles twice, and see which size of a jump the error allows."""
        before = state.save(self.model, whole=True)
        start = self._worn()
        try:
            one, of_one = self._tried([(self._cycle, 2 * m)])
            state.restore(self.model, *before)
            two, of_two = self._tried([(self._cycle, m), (self._cycle + m, m)])
        except ConvergenceError:
            one, two, of_one, of_two = start, start, {"area": math.inf}, {"area": 0.0}
        state.restore(self.model, *before)
        allowed = math.inf
        for body in BODIES:
            error, growth = _norm(one[body] - two[body]), _norm(two[body] - start[body])
            self._seen[body] = error / (2.0 * m * m)
            if error > 0.0:
                allowed = min(allowed, 1.0 + SAFETY * self._tolerance * m * growth / error)
        for name, value in of_two.items():
            if change := abs(of_one[name] - value):
                allowed = min(allowed, 1.0 + OF_CONTACT * m * value / change)
        doubles = allowed >= 2 * m
        if self._fixed is None:
            self._size = max(int(min(allowed, 2 * m)), 1)
        jumps = DOUBLING if doubles else JUMPS
        self._next_look = self._cycle + max(
            jumps * self._size, int(OF_DONE * self._cycle * (self._size == 1))
        )

    def _tried(self, cycles: list[tuple[int, int]]) -> tuple[dict[str, FloatArray], dict[str, float]]:
        """Compute cycles, each with what it stands for; return worn depths, and means over their contacts."""
        rows: list[Mapping[str, float]] = []
        for cycle, stands_for in cycles:
            self.model.stands_for = stands_for
            plan = [(increment, False) for increment, *_ in self._planned(cycle, stands_for)]
            rows += [step.row for step in self.model.steps(plan)]
        self.made += len(rows)
        names = {"area": "area_contact", "bare": "bare_fraction"}
        return self._worn(), {
            key: float(np.mean([row[name] for row in rows])) for key, name in names.items() if name in rows[0]
        }

    def _worn(self) -> dict[str, FloatArray]:
        """Return copies of what both bodies have lost [mm]."""
        return {body: worn.copy() for body, worn in zip(BODIES, self.model.worn(), strict=True)}


def _norm(field: FloatArray) -> float:
    """Return the root of the sum of squares, which of the scar alone is as large as of the whole field."""
    return float(np.sqrt(np.square(field).sum()))
