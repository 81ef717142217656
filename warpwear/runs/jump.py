"""Cycles of a track that stand for many: how many each may stand for, and what that does to the depths.

A jump of n cycles is one cycle whose increments are n times as long: at each of its places both bodies lose
n K p dL, and laws of the distance are integrated over all that it stands for. A second state of the same
model, the coarse one, goes along in jumps twice as long. The difference of both in worn depth, rms over the
scar, is the error that is reported. The run's own error is no larger, as it goes with n − 1, and the coarse
one's with 2n − 1. It is that of the whole run so far: what later cycles have mended counts no longer.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from typing import Any, ClassVar

import numpy as np

from warpwear.engine import state
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray
from warpwear.laws.archard import BODIES
from warpwear.laws.track import GOLDEN, Leg, Track
from warpwear.runs.order import RunOrder
from warpwear.runs.plan import Planned, contacts_of, kept_after

#: Part of the allowed error that a jump aims at, as the next ones differ from the last.
SAFETY = 0.8
#: Most that the coarse state's area in contact and bare fraction may differ by, relative.
OF_CONTACT = 0.02
#: While cycles are computed one by one, the coarse state is given up if its error is so many times the
#: allowed one after so many of its jumps. Another begins when this part of the cycles done is done again.
HOPELESS, PATIENCE, AGAIN = 4.0, 4, 0.25
#: Jumps of one size that the coarse state makes before the size may grow.
YOUNG = 2
#: A jump takes one in so many of the cycles before a stop at most: jumps shorten there, down to one cycle.
LANDING = 4
#: Least exponent of the distance with which rms depths grow: a ball's have 3/4, those of its groove 5/6.
GROWTH = 1.0 / 3.0
#: Columns of the history that both states are compared by.
COMPARED = ("area_contact", "bare_fraction")


class CycleJumps:
    """Plans the cycles of a run one by one, as steps of a model, and keeps the books of their error.

    Cycles with a snapshot or the end of a block or run, and the last whole one, stand for themselves alone.
    model: of a track. begin: makes the model ready for a step.
    """

    STATE: ClassVar = {
        "model": object,
        **dict.fromkeys(("stands_for", "contacts", "_number", "_cycle", "_step", "_size"), int),
        **dict.fromkeys(("_behind", "_left", "_age", "_again"), int),
        **dict.fromkeys(("_means", "_coarse", "_errors", "_earlier", "_circles"), dict),
        "_numbers": str,
        "_jumped": bool,
    }

    def __init__(self, order: RunOrder, model: Any, begin: Callable[[Planned], None]) -> None:
        study = order.study
        self.model, self._begin = model, begin
        laws = study.contact_task.features
        if lost := [name for name, law in laws.items() if not law.jumps]:
            why = f"does not go with {', '.join(lost)}, which acts in each step"
            raise InputError(f"stepping.jump = {study.stepping.jump!r} {why}.")
        self._legs, self._total, self._every_cycle = study.legs, study.sliding.total, contacts_of(study)
        self._stops, self._profiles = study.snapshot_distances, study.pair.profiles or ()
        self._ends = [block.end for block in study.blocks]
        jump = study.stepping.jump
        self._fixed = jump if isinstance(jump, int) else None
        self._tolerance = study.stepping.jump_error
        #: Number of the leg that the run is in, whose cycles are counted anew.
        self._number = 0
        #: Cycles that the one being made stands for; contacts computed, the coarse state's included.
        self.stands_for, self.contacts = 1, 0
        self._cycle = self._step = self._left = self._age = self._again = 0
        self._size, self._jumped = self._fixed or 1, False
        #: The coarse state, and the cycle that it has come to; sums of `COMPARED` over the steps made since.
        self._coarse: dict[str, FloatArray] = {}
        self._numbers, self._behind, self._means = "", 0, dict.fromkeys(COMPARED, 0.0)
        #: Differences of worn depths, by body [mm, root of the sum over cells].
        self._errors = dict.fromkeys(BODIES, 0.0)
        #: Those of the blocks before.
        self._earlier = dict.fromkeys(BODIES, 0.0)
        #: Of circles of the disc that were left: the error there, and the depth, root of the sum over cells.
        self._circles: dict[str, list[float]] = {}

    def parts(self) -> Iterator[list[Planned]]:
        """Yield the steps that are left of the cycle at hand, then those of each cycle to be computed."""
        while True:
            if self._cycle * self._track.cycle >= self._leg.length * (1.0 - 1.0e-12):
                if self._number + 1 == len(self._legs):
                    return
                self._number, self._cycle = self._number + 1, 0
            # Both states are to divide steps alike: a change waits until the coarse one has followed.
            self.model.divides = self._cycle == 0 or (self._step == 0 and self._left == 0)
            if self._step == 0:
                self._begin(self._planned(self._cycle, 1)[0])
                self._choose()
            self._set_out(self._cycle, self.stands_for)
            part = self._planned(self._cycle, self.stands_for)[self._step :]
            if not part:  # the last cycle was cut
                return
            yield part

    def switch_block(self, before: int, after: int) -> None:
        """Begin a coarse state anew, as the model is another block's; the errors so far are kept.

        before, after: numbers of the circles of the disc of both blocks. The model is still on the first.
        """
        self._coarse, self._numbers, self._left = {}, "", 0
        self._again, self._age, self._earlier = self._cycle, 0, dict(self._errors_reported)
        self._jumped = False
        if before != after:
            self._circles[str(before)] = [self._earlier["disc"], _norm(self._worn()["disc"])]
            self._earlier["disc"] = self._circles.pop(str(after), [0.0])[0]
            self._errors = dict(self._earlier)

    def count(self, row: Mapping[str, float]) -> None:
        """Count a step that was made."""
        self._step, self.contacts = self._step + 1, self.contacts + 1
        self._means, self.model.divides = _added(self._means, row), self._cycle == 0
        if self._step == self._steps:
            self._jumped = self._jumped or self.stands_for > 1
            self._cycle, self._step = self._cycle + self.stands_for, 0

    def told(self) -> dict[str, Any]:
        """Return what a result says of its jumps: errors relative to the rms depth of the whole run."""
        every = {body: [error] for body, error in self._relative(self._errors_reported).items()}
        every["disc"] += [error / depth for error, depth in self._circles.values() if depth]
        return {
            "contacts": self.contacts,
            "contacts_of_every_cycle": self._every_cycle,
            "cycles": sum(leg.length / leg.track.cycle for leg in self._legs),
            "depth_error": {body: max(errors) for body, errors in every.items()},
        }

    def foreseen(self) -> tuple[float, float]:
        """Foresee the contacts that are left, at least and at most: where jumps grow from now on, or stay."""
        return self._left_where(2.0 if self._fixed is None else 1.0), self._left_where(1.0)

    def _left_where(self, growth: float) -> float:
        """Count the contacts that are left where each size of jumps is so many times the one before."""
        cycle, size, cycles = self._cycle, float(self._size), 0
        for leg in self._legs[self._number :]:
            last = max(math.floor(leg.length / leg.track.cycle - 1.0 + 1.0e-9), 0)
            stops = {stop for stop in self._alone if stop < last} if leg is self._leg else set()
            for stop in sorted({*stops, last}):
                while cycle < stop:  # two jumps, and the coarse state's one, which is twice as long
                    cycle += 2 * max(min(int(size), (stop - cycle) // LANDING), 1)
                    cycles, size = cycles + 3, size * growth ** (1.0 / YOUNG)
            cycle = 0
        return cycles * self._steps

    @property
    def _leg(self) -> Leg:
        return self._legs[self._number]

    @property
    def _track(self) -> Track:
        return self._leg.track

    @property
    def _alone(self) -> set[int]:
        """Return the cycles that stand for themselves: those with a stop, and all from the last whole one."""
        stops = (stop - self._leg.start for stop in (*self._stops, *self._ends))
        return {max(math.ceil(stop / self._track.cycle - 1.0e-9) - 1, 0) for stop in stops if stop >= 0.0}

    @property
    def _last(self) -> int:
        return max(math.floor(self._leg.length / self._track.cycle - 1.0 + 1.0e-9), 0)

    @property
    def _errors_reported(self) -> dict[str, float]:
        """Return the errors to report: those of a block count only once the run itself has jumped in it."""
        return self._errors if self._jumped else self._earlier

    @property
    def _steps(self) -> int:
        return self._track.passes_of_cycle * self._track.steps_of_pass

    def _planned(self, cycle: int, stands_for: int) -> list[Planned]:
        """Plan the steps of a cycle that stands for so many."""
        begin = self._leg.start + cycle * self._track.cycle
        steps = list(islice(self._leg.steps(cycle), self._steps))
        if stands_for == 1:
            ahead = [stop for stop in self._stops if stop > begin + 1.0e-6 * steps[0][0]]
            return kept_after(ahead, steps, self._total)
        ends = [begin + stands_for * (end - begin) for _, end in steps[:-1]]
        ends.append(self._leg.start + (cycle + stands_for) * self._track.cycle)
        return [(stands_for * step, end, False) for (step, _), end in zip(steps, ends, strict=True)]

    def _set_out(self, cycle: int, stands_for: int) -> None:
        """Tell the model of the next cycle, and begin jumps each time elsewhere: each leaves a ramp there."""
        track, elsewhere = self._track, self._track.periodic and stands_for > 1 and not self._track.reverses
        self.model.stands_for = stands_for
        # By whole steps, no two near each other: a contact then has the places that it has in other cycles.
        steps = int(track.steps_of_pass * (cycle * GOLDEN % 1.0)) if elsewhere else 0
        self.model.turned = steps * track.shift

    def _choose(self) -> None:
        """Choose how many cycles the next one stands for: half as many as a jump of the coarse state."""
        if self._left == 0:
            if self._coarse and self._behind < self._last:
                self._follow()
            if self._fixed is None and self._size > 1 and self._breaks_through():
                self._size = 1
            free = self._stop - self._cycle
            self._left = min(max(free, 1), 2)
            self.stands_for = max(min(self._size, free // LANDING), 1)
            if not self._coarse and free > 1 and self._cycle >= self._again:
                self._keep_coarse()
                self._behind, self._age = self._cycle, 0
            self._means = dict.fromkeys(COMPARED, 0.0)
        self._left -= 1

    def _breaks_through(self) -> bool:
        """Tell whether the next two jumps may take the deepest cell of a body into another layer."""
        grows = 1.0 + 2.0 * self._size / max(self._cycle, 1)  # no faster than all cycles so far
        deepest = (np.array([1.0, grows]) * worn.max() for worn in self._worn().values())
        layered = zip(self._profiles, deepest, strict=False)
        return any(not p.graded and np.ptp(p.material_at(depths)) > 0 for p, depths in layered)

    @property
    def _stop(self) -> int:
        """Return the next cycle that stands for itself; where none is left, the one at hand."""
        return min((c for c in (*self._alone, self._last) if c >= self._cycle), default=self._cycle)

    def _keep_coarse(self) -> None:
        self._coarse, numbers = state.save(self.model, whole=True)
        self._numbers = json.dumps(numbers)

    def _follow(self) -> None:
        """Let the coarse state jump to where the run is, see how they differ, and choose the next size."""
        fine, worn, jump = state.save(self.model, whole=True), self._worn(), self._cycle - self._behind
        state.restore(self.model, self._coarse, json.loads(self._numbers))
        self._set_out(self._behind, jump)
        self.model.measures = False
        means = dict.fromkeys(COMPARED, 0.0)
        try:
            for step in self.model.steps([(step[0], False) for step in self._planned(self._behind, jump)]):
                means, self.contacts = _added(means, step.row), self.contacts + 1
            apart = {body: _norm(depth - worn[body]) for body, depth in self._worn().items()}
            self._errors = {body: self._earlier[body] + error for body, error in apart.items()}
            self._keep_coarse()
            self._behind, self._age = self._cycle, self._age + 1
        except ConvergenceError:
            means = dict.fromkeys(COMPARED, math.inf)
        self.model.measures = True
        state.restore(self.model, *fine)
        self._adapt(max(self._of_depth(), self._of_contact(means, jump)))

    def _adapt(self, ratio: float) -> None:
        """Choose the size of the next jumps. ratio: of the error to what is allowed."""
        grows, before = ratio < SAFETY, self._size
        # The error of a size shows after some jumps of it; those cut short before a stop say nothing of it.
        if self._fixed is None and not (grows and (self._age < YOUNG or self.stands_for < self._size)):
            self._size = max(min(int(before * SAFETY / max(ratio, 1.0e-3)), 2 * before), 1)
            self._age *= self._size == before
        if ratio > HOPELESS and self._fixed is None and not self._jumped and self._age >= PATIENCE:
            self._coarse, self._numbers, self._errors = {}, "", dict(self._earlier)
            self._again = self._cycle + max(PATIENCE, int(AGAIN * self._cycle))

    def _of_depth(self) -> float:
        """Return the larger relative error of both depths, over what is allowed.

        More is allowed while the next stop is far: depths grow until then, and the error is to hold there.
        """
        allowed = self._tolerance * max(self._stop / self._cycle, 1.0) ** GROWTH
        return max(self._relative(self._errors).values()) / allowed

    def _of_contact(self, means: Mapping[str, float], jump: int) -> float:
        """Return the largest relative change of what is compared of the contact, over what is allowed."""
        cycles = 2.0 if jump > 1 else 1.0
        pairs = [(mean, self._means[name] / cycles) for name, mean in means.items() if self._means[name]]
        return max(abs(coarse / fine - 1.0) for coarse, fine in pairs) / OF_CONTACT

    def _relative(self, errors: Mapping[str, float]) -> dict[str, float]:
        """Return errors over the depths, rms over the scar."""
        depths = {body: _norm(worn) for body, worn in self._worn().items()}
        return {body: errors[body] / depth if depth else 0.0 for body, depth in depths.items()}

    def _worn(self) -> dict[str, FloatArray]:
        """Return copies of what both bodies have lost [mm]."""
        return {body: worn.copy() for body, worn in zip(BODIES, self.model.worn_depths(), strict=True)}


def _added(sums: Mapping[str, float], row: Mapping[str, float]) -> dict[str, float]:
    return {name: total + row.get(name, 0.0) for name, total in sums.items()}


def _norm(field: FloatArray) -> float:
    """Return the root of the sum of squares; beyond the scar a field is 0 and adds nothing."""
    return float(np.sqrt(np.square(field).sum()))
