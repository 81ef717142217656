"""How patches share a load: each at an approach of its own, joined by what lies between it and the body.

A patch k carries the mean pressure p_k(u_k) at its approach u_k. Behind it is a spring of stiffness K_N
[N/mm³], the bulk, so that all patches have

    u_k + p_k / K_N = δ,   A Σ p_k = F

with one approach δ of the bodies, both measured from the mean planes. Every evaluation of the patches at any
u_k is a point of the curve p_k(δ), at δ_k = u_k + p_k / K_N: Newton's method follows all these curves to a
common δ. Without a spring all u_k are δ. What a patch answers is the micro law's affair: any increasing
p_k(u_k).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from warpwear.contact.balance import (
    BISECT_EVERY,
    DIGITS,
    FIRST_REACH,
    HOPELESS,
    MAX_EVALUATIONS,
    MAX_ROUNDS,
    PART,
    SURELY,
    TOLERANCE,
    find_offsets,
)
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray


class PatchResponse(NamedTuple):
    """What patches answer to an approach of each, shape (patches,)."""

    pressure: FloatArray  # mean of each [MPa]
    slope: FloatArray  # [N/mm³]
    straight: FloatArray  # how far the approach may move while the pressure follows this slope [mm]


#: Of all patches at the approaches base + offset [mm].
Response = Callable[[FloatArray, FloatArray], PatchResponse]
#: Searches, each from bases nearer the solution: where cells are almost rigid, patches get digits in turns.
MOST_SEARCHES = 8
#: Evaluations after which the approach of the bodies is held while the patches are solved at it, in brackets.
JOINT = 12

BoolArray = NDArray[np.bool_]


class Brackets:
    """Keeps, of every patch, the nearest points of its curve below and above a common approach.

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


@dataclass(frozen=True, eq=False)
class Shares:
    """Solved approaches [mm], each as base + offset, which together hold more digits than their sum."""

    base: FloatArray  # of the patches, shape (patches,)
    offset: FloatArray
    common_base: float  # of the bodies: δ
    common_offset: float
    pressure: FloatArray  # mean of each patch [MPa]
    load_residual: float = 0.0  # [N]
    spring_residual: float = 0.0  # largest |u_k + p_k / K_N − δ| [mm]
    evaluations: int = 0

    @property
    def approach(self) -> float:
        """δ [mm]."""
        return self.common_base + self.common_offset

    @property
    def approaches(self) -> FloatArray:
        """u_k [mm]. Of a patch without pressure it is δ or lower."""
        return self.base + self.offset

    @property
    def bases(self) -> FloatArray:
        """From which the next step counts [mm]: u_k, but a patch without pressure hangs on the body alone."""
        return np.where(self.pressure > 0.0, self.approaches, self.approach)


@dataclass(frozen=True)
class SharingTask:
    """Asks patches to carry a load together."""

    load: float  # F [N]
    area: float  # that each stands for [mm²]
    flexibility: float  # 1/K_N [mm³/N], 0 without a spring
    hardness: float  # that no patch exceeds [MPa]
    lowest: FloatArray  # below that approach a patch carries nothing [mm]


def share_load(
    response: Response,
    task: SharingTask,
    start: Shares | None,
    *,
    step: float,
    steps: FloatArray | None = None,
) -> Shares:
    """Share a load among patches, to `TOLERANCE` of it and of the largest deflection of a spring.

    start: of the step before; step: how far beyond it the solution is expected [mm], steps: that of each
    patch beyond its base. Without a start the search begins at the lowest cell, with that step.

    Raises ConvergenceError, with what is left, never returns unbalanced shares.
    """
    if start is None:
        lowest, low = float(task.lowest.min()), 0.0
        search = _Search(response, task, np.full(task.lowest.size, lowest), lowest)
    else:
        search, low = _Search(response, task, start.bases, start.approach), -math.inf
    evaluations = 0
    for number in range(MOST_SEARCHES):
        if number:  # down to neighbouring numbers: from bases at the solution the offsets have digits again
            search = _Search(response, task, search.base + search.offset, search.common_base + search.common)
            step, steps, low = 0.0, None, -math.inf
        found = search.run(step, low, steps)
        evaluations += search.evaluations
        if found is not None:
            return replace(found, evaluations=evaluations)
        if not abs(search.common) < HOPELESS:
            break
    raise ConvergenceError(
        f"the load shares of {task.lowest.size} patches did not converge in {evaluations} evaluations: "
        f"{search.residual:.3g} N of {task.load:.6g} N are left (allowed {TOLERANCE * task.load:.1g} N), and "
        f"{search.spring_residual:.3g} mm between a patch's approach with its bulk spring and that of the "
        f"bodies (allowed {search.spring_allowed:.1g} mm), near an approach of {search.common_base:.9g} mm."
    )


class _Search:
    """One search from given bases. Lengths are offsets from them [mm]."""

    def __init__(self, response: Response, task: SharingTask, base: FloatArray, common_base: float) -> None:
        self._response, self._task = response, task
        self.base, self.common_base = base, common_base
        self._shift = common_base - base  # exact where both are of one size
        self._floor = task.lowest - common_base  # δ below which a patch is free, as an offset
        self.offset = np.zeros_like(base)
        self.common = self.residual = self.spring_residual = self.spring_allowed = math.nan
        self.evaluations = 0

    def run(self, guess: float, low: float, offsets: FloatArray | None = None) -> Shares | None:
        """The shares, or None where numbers have no more digits, or none are found."""
        task = self._task
        flexibility, load = task.flexibility, task.load
        x, high = guess, math.inf
        reach = abs(guess) or FIRST_REACH
        width_before, rounds, waited = math.inf, 0, 0
        self.offset = np.full_like(self.base, guess) if offsets is None else offsets
        brackets = Brackets(self.base.size, task.hardness)
        for self.evaluations in range(1, MAX_EVALUATIONS):
            p, slope, straight = self._response(self.base, self.offset)
            self.residual, self.common = task.area * float(p.sum()) - load, x
            residual = self.residual  # at x, as soon as the patches are there
            free = p == 0.0
            point = (self.offset - self._shift) + flexibility * p
            # A free patch is free up to its lowest cell: that point of its curve is known as well.
            point = np.where(free, np.maximum(point, self._floor), point)
            joined = slope / (1.0 + flexibility * slope)
            newton = math.nan
            if (stiffness := float(joined.sum())) > 0.0:
                missing = load / task.area - float(p.sum())
                newton = x + (missing + float((joined * (point - x)).sum())) / stiffness
            rigid = flexibility == 0.0
            held = not rigid and self.evaluations > JOINT
            common = x if rigid or held or math.isnan(newton) else newton
            apart = self._measure(p, point, free, common)
            solved = self.spring_residual <= self.spring_allowed
            if solved and abs(self.residual) <= TOLERANCE * load:
                return self._found(p, common)
            sure = self._sure(p, slope, straight, free, newton)
            if sure is not None:
                return sure
            if not abs(x) < HOPELESS:
                return None
            at_point = np.where(free, point + self._shift, self.offset)
            met = np.stack([at_point, point, p])
            if held and not solved:
                brackets.enter(x, met)
                total = brackets.total(x, p, far=apart > self.spring_allowed, wanted=load / task.area)
                if not math.isnan(total):
                    solved, residual = True, task.area * total - load
            # No curve falls, so beyond the range of these points the common approach cannot lie.
            if residual < 0.0:
                low = max(low, x if held and solved else float(point.min()))
            else:
                high = min(high, x if held and solved else float(point[~free].max()))
            waited += 1
            if not held or solved:
                waited = 0
                if math.isinf(low) or math.isinf(high):
                    limit = x + math.copysign(reach, -residual)
                    x = newton if abs(newton - x) <= reach else limit
                    reach *= 4.0
                else:
                    rounds += 1
                    # While patches move as well, a bracket is wide and what halves it no measure.
                    stalled = (rigid or held) and rounds % 2 == 0 and high - low > 0.5 * width_before
                    if rounds % 2 == 0:
                        width_before = high - low
                    x = newton if low < newton < high and not stalled else 0.5 * (low + high)
                    if (rigid or held) and not low < x < high:  # down to neighbouring numbers
                        return None
            brackets.enter(x, met)
            # Where nothing is carried, and where the hardness is.
            bound = x + self._shift
            deepest = flexibility * task.hardness if flexibility else 0.0  # there may be no hardness
            highest = np.minimum(brackets.high[0], bound)
            lowest = np.maximum(task.lowest - self.base, bound - deepest)
            lowest = np.minimum(np.maximum(brackets.low[0], lowest), highest)
            guesses = at_point + (x - point) / (1.0 + flexibility * slope)
            # A step too short for another number goes to the next one, so that brackets close.
            beside = np.nextafter(at_point, np.where(x == point, at_point, np.copysign(math.inf, x - point)))
            guesses = np.where(guesses == at_point, beside, guesses)
            outside = (guesses < lowest) | (guesses > highest)
            if held and waited % BISECT_EVERY == BISECT_EVERY - 1:
                outside |= np.abs(point - x) > self.spring_allowed
            self.offset = np.where(outside, 0.5 * (lowest + highest), guesses)
        return None

    def _sure(
        self, p: FloatArray, slope: FloatArray, straight: FloatArray, free: BoolArray, newton: float
    ) -> Shares | None:
        """Newton's step, where no patch leaves its straight line on the way: it needs no second look."""
        flexibility, load = self._task.flexibility, self._task.load
        if math.isnan(newton):
            return None
        point = (self.offset - self._shift) + flexibility * p
        move = (newton - point) / (1.0 + flexibility * slope)
        if np.any((np.abs(move) >= SURELY * straight) & ~(free & (move <= 0.0))):
            return None
        after = self.offset + move
        if self._task.area * float((slope * np.abs(after)).sum()) > DIGITS * load:
            return None
        self.offset = after
        p = p + slope * move
        self.residual = self._task.area * float(p.sum()) - load
        self._measure(p, (self.offset - self._shift) + flexibility * p, free, newton)
        if abs(self.residual) > TOLERANCE * load or self.spring_residual > self.spring_allowed:
            return None
        return self._found(p, newton)

    def _measure(self, p: FloatArray, point: FloatArray, free: BoolArray, common: float) -> FloatArray:
        """How far patches are from a common approach, those aside that it does not reach."""
        apart = np.where(free & (point >= common), 0.0, np.abs(point - common))
        self.spring_residual = float(apart.max())
        self.spring_allowed = TOLERANCE * self._task.flexibility * float(p.max())
        return apart

    def _found(self, p: FloatArray, common: float) -> Shares:
        left = self.residual, self.spring_residual
        return Shares(self.base, self.offset, self.common_base, common, p, *left, self.evaluations)


def press(
    response: Response,
    task: SharingTask,
    target: FloatArray,
    start: Shares | None,
    *,
    step: float,
    first: float,
    common: float,
) -> Shares:
    """Approaches at which patches carry target [MPa], each to half of `TOLERANCE` of it.

    start: of the step before; step: how far beyond it [mm]; first: first step of a patch that did not touch
    [mm]. common: approach of the bodies, for the record [mm]. Raises ConvergenceError.
    """
    asked = target > 0.0
    touched = np.zeros(target.size, dtype=bool) if start is None else asked & (start.pressure > 0.0)
    base = task.lowest.copy() if start is None else np.where(touched, start.approaches, task.lowest)
    offset = np.where(touched, step, np.where(asked, first, 0.0))
    allowed = PART * TOLERANCE * target
    evaluations = 0
    for _ in range(MAX_ROUNDS):

        def carried(offset: FloatArray, base: FloatArray = base) -> tuple[FloatArray, FloatArray]:
            p, slope, _ = response(base, offset)
            return p, slope

        reach = np.maximum(np.abs(offset), FIRST_REACH)
        offset, p, done = find_offsets(carried, target, allowed, offset, reach)
        evaluations += done
        if np.all(np.abs(p - target) <= allowed):
            residual = task.area * float(p.sum()) - task.load
            return Shares(base, offset, common, 0.0, p, residual, evaluations=evaluations)
        base, offset = base + offset, np.zeros_like(offset)
    worst = int(np.argmax(np.abs(p - target) - allowed))
    raise ConvergenceError(
        f"the patches did not converge to their prescribed loads in {evaluations} evaluations: patch {worst} "
        f"carries {p[worst]:.9g} MPa of {target[worst]:.9g} MPa, at an approach of {base[worst]:.9g} mm."
    )
