"""Cycles of a track that stand for many: how many each may stand for, and what that does to the depths.

A jump of n cycles is one cycle whose increments are n times as long: at each of its places both bodies lose
n K p dL, and laws of the distance are integrated over all that it stands for. A second state of the same
model, the coarse one, goes along in jumps twice as long. The difference of both in worn depth, rms over the
scar, times a margin, is the error that is reported. The run's own error goes with n − 1, the coarse one's
with 2n − 1. It is that of the whole run so far: what later cycles have mended counts no longer.
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
#: The error told is so many times the difference of both states: errors of single cells grow by less than
#: the length of jumps, so that the two states differ by less than the run errs.
MARGIN = 1.5
#: Most that the coarse state's area in contact and bare fraction may differ by, relative: so many times the
#: error allowed in the depths, and no less than this.
OF_CONTACT, LEAST_OF_CONTACT = 4.0, 0.02
#: While cycles are computed one by one, the coarse state is given up if its error is so many times the
#: allowed one after so many of its jumps. Another begins when this part of the cycles done is done again.
HOPELESS, PATIENCE, AGAIN = 4.0, 4, 0.25
#: Contacts beyond those of every cycle that the coarse state may take in all, as a part of these.
BEYOND = 0.1
#: Most that a size grows by at once.
FASTEST = 4.0
#: A jump takes one in so many of the cycles done at most.
EARLY = 3
#: Part of the error so far that two jumps are taken to make at least, as what is mended may come again.
OF_ALL = 0.125
#: A jump takes one in so many of the cycles before a stop at most: jumps shorten there, down to one cycle.
LANDING = 4
#: Least exponent of the distance with which rms depths grow: a ball's have 3/4, those of its groove 5/6.
GROWTH = 0.4
#: Columns of the history that both states are compared by.
COMPARED = ("area_contact", "bare_fraction")


class CycleJumps:
    """Plans the cycles of a run one by one, as steps of a model, and keeps the books of their error.

    Cycles with a snapshot or the end of a block or run, and the last whole one, stand for themselves alone.
    model: of a track. begin: makes the model ready for a step.
    """

    STATE: ClassVar = {
        "model": object,
        **dict.fromkeys(("stands_for", "contacts", "_every", "_number", "_cycle", "_step", "_size"), int),
        **dict.fromkeys(("_behind", "_left", "_age", "_again"), int),
        **dict.fromkeys(("_means", "_coarse", "_errors", "_earlier", "_circles"), dict),
        "_numbers": str,
        "_jumped": bool,
        "_ratio": float,
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
        #: Contacts that every cycle would have taken so far.
        self._every = 0
        self._cycle = self._step = self._left = self._age = self._again = 0
        self._size, self._jumped, self._ratio = self._fixed or 1, False, 0.0
        #: The coarse state, and the cycle that it has come to; sums of `COMPARED` over the steps
        #: since, each so many times as it stands for.
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
            begins = self._step == 0
            if begins:
                self._begin(self._planned(self._cycle, 1)[0])
                self._choose()
            # Both states are to divide steps alike: a change waits until the coarse one has followed.
            level = not self._coarse or self._behind == self._cycle
            self.model.divides = self._cycle == 0 or (begins and level)
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
        self._every, self.model.divides = self._every + self.stands_for, self._cycle == 0
        self._means = _added(self._means, row, self.stands_for)
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
        """Foresee the steps that are left, at least and at most: where jumps grow from now on, or stay."""
        every = (1.0 + BEYOND) * (self._every_cycle - self._every)
        return self._left_where(FASTEST if self._fixed is None else 1.0), min(self._left_where(1.0), every)

    def _left_where(self, growth: float) -> float:
        """Count the contacts that are left where each size of jumps is so many times the one before."""
        cycle, size, cycles = self._cycle, float(self._size), 0
        for leg in self._legs[self._number :]:
            last = max(math.floor(leg.length / leg.track.cycle - 1.0 + 1.0e-9), 0)
            stops = {stop for stop in self._alone if stop < last} if leg is self._leg else set()
            for stop in sorted({*stops, last}):
                while cycle < stop:  # two jumps, and the coarse state's one, which is twice as long
                    cycle += 2 * max(min(int(size), (stop - cycle) // LANDING), 1)
                    cycles, size = cycles + 3, max(min(size * growth, cycle / EARLY), size)
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
            auto, jump, ahead = self._fixed is None, self._cycle - self._behind, self._ahead
            # A stop's own cycle is waited for.
            whole = 2 * max(self.stands_for, min(self._size, 2)) + (self._cycle == self._stop)
            due = jump + ahead * min(ahead, 2) > whole or self._cycle >= self._last
            if self._coarse and self._behind < self._last and due:
                if auto and not self._affords(1):
                    self._give_up()
                else:
                    self._follow()
            if auto and self._size > 1 and self._breaks_through():
                self._size = 1
            begins = not self._coarse and self._cycle >= self._again and self._cycle + 1 < self._stop
            if begins and not (auto and (not self._affords(PATIENCE) or self._of_depth() >= SAFETY)):
                self._keep_coarse()
                self._age = 0
            self.stands_for = self._ahead
            self._left = min(self.stands_for, 2)
        self._left -= 1

    @property
    def _ahead(self) -> int:
        """Return how many cycles the next one may stand for."""
        return max(min(self._size, (self._stop - self._cycle) // LANDING), 1) if self._coarse else 1

    def _affords(self, jumps: int) -> bool:
        """Tell whether so many jumps of the coarse state stay within what it may take in all.

        Half of that is there from the beginning.
        """
        beyond = self.contacts + jumps * self._steps - self._every
        return beyond <= 0.5 * BEYOND * (self._every + self._every_cycle)

    def _give_up(self) -> None:
        """Compute cycles one by one without a coarse state; errors of jumps that were made remain."""
        self._coarse, self._numbers, self._size = {}, "", 1
        self._earlier = dict(self._errors_reported)
        self._errors = dict(self._earlier)
        self._again = self._cycle + max(PATIENCE, int(AGAIN * self._cycle))

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
        self._numbers, self._behind = json.dumps(numbers), self._cycle
        self._means = dict.fromkeys(COMPARED, 0.0)

    def _follow(self) -> None:
        """Let the coarse state jump to where the run is, see how they differ, and choose the next size."""
        fine, worn, jump = state.save(self.model, whole=True), self._worn(), self._cycle - self._behind
        state.restore(self.model, self._coarse, json.loads(self._numbers))
        self._set_out(self._behind, jump)
        self.model.measures = False
        means, made = dict.fromkeys(COMPARED, 0.0), self._means
        try:
            for step in self.model.steps([(step[0], False) for step in self._planned(self._behind, jump)]):
                means, self.contacts = _added(means, step.row, jump), self.contacts + 1
            apart = {body: _norm(depth - worn[body]) for body, depth in self._worn().items()}
            self._errors = {body: self._earlier[body] + MARGIN * error for body, error in apart.items()}
            self._age += 1
            self._keep_coarse()
        except ConvergenceError:
            means = dict.fromkeys(COMPARED, math.inf)
        self.model.measures = True
        state.restore(self.model, *fine)
        self._adapt(max(self._of_depth(), self._of_contact(means, made)))

    def _adapt(self, ratio: float) -> None:
        """Choose the size of the next jumps. ratio: of the error to what is allowed."""
        if self._fixed is not None:
            return
        before, made = self._size, max(ratio - self._ratio, OF_ALL * ratio, 1.0e-6)
        if ratio < SAFETY:  # the error that a jump adds goes with its length squared
            more = min(math.sqrt(0.5 * (SAFETY - ratio) / made), FASTEST)
            self._size = max(min(int(self.stands_for * more), self._cycle // EARLY), before)
        elif ratio > min(self._ratio, 1.0):  # else it comes down by itself
            self._size = max(int(before * SAFETY / ratio), 1)
        self._ratio = ratio
        self._age *= self._size == before
        if ratio > HOPELESS and not self._jumped and self._age >= PATIENCE:
            self._give_up()

    def _of_depth(self) -> float:
        """Return the larger relative error of both depths, over what is allowed.

        More is allowed while the next stop is far: depths grow until then, and the error is to hold there.
        """
        allowed = self._tolerance * max(self._stop / max(self._cycle, 1), 1.0) ** GROWTH
        return max(self._relative(self._errors).values()) / allowed

    def _of_contact(self, coarse: Mapping[str, float], fine: Mapping[str, float]) -> float:
        """Return the largest relative change of what is compared of the contact, over what is allowed."""
        changes = [abs(coarse[name] / value - 1.0) for name, value in fine.items() if value]
        return max(changes, default=0.0) / max(OF_CONTACT * self._tolerance, LEAST_OF_CONTACT)

    def _relative(self, errors: Mapping[str, float]) -> dict[str, float]:
        """Return errors over the depths, rms over the scar."""
        depths = {body: _norm(worn) for body, worn in self._worn().items()}
        return {body: errors[body] / depth if depth else 0.0 for body, depth in depths.items()}

    def _worn(self) -> dict[str, FloatArray]:
        """Return copies of what both bodies have lost [mm]."""
        return {body: worn.copy() for body, worn in zip(BODIES, self.model.worn_depths(), strict=True)}


def _added(sums: Mapping[str, float], row: Mapping[str, float], times: int) -> dict[str, float]:
    return {name: total + times * row.get(name, 0.0) for name, total in sums.items()}


def _norm(field: FloatArray) -> float:
    """Return the root of the sum of squares; beyond the scar a field is 0 and adds nothing."""
    return float(np.sqrt(np.square(field).sum()))
