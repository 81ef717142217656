"""Load balance: the approach at which the pressures carry the load.

The load rises monotonically with the approach, and piecewise linearly where the contact has a compliance.
That case is solved here, by Newton's method inside a bracket; without compliance see `bearing_area`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from warpwear.engine.executor import Arguments, Executor, Field, arguments, set_numbers
from warpwear.engine.tiles import TileList
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.kernels import contact
from warpwear.kernels.contact import Law
from warpwear.kernels.running_in import caps

#: Residual of the balance of a contact with compliance, relative to the load.
TOLERANCE = 1.0e-12
#: Of it, that each of many may be off by, so that their sum is well within it.
PART = 0.5
#: Stands for 1/c where c = 0: any overlap reaches the cap.
RIGID = 1.0e300
MAX_EVALUATIONS = 400
#: An approach beyond that is none [mm]: the load cannot be carried.
HOPELESS = 1.0e6
#: From a cold start each list of tiles reaches this many times deeper than the last.
DEEPER = 4.0
#: And at least this deep [mm].
LEAST_DEPTH = 1.0e-6
#: Steps ahead that a new list of tiles reaches.
STEPS_AHEAD = 16.0
#: Searches, each from a base nearer the solution.
MAX_ROUNDS = 3
#: First step of a search that starts where the solution is [mm]; steps grow until they bracket it.
FIRST_REACH = 1.0e-18
#: Where many are solved at once, one evaluation in this many halves a bracket instead of following a slope.
BISECT_EVERY = 3
#: Part of the way to the next change of state that Newton's step may take and be sure of it.
SURELY = 0.999
#: Load of the offset's length over the load, up to which the offset has digits enough for `TOLERANCE`.
DIGITS = 1.0e3


class Carried(NamedTuple):
    """What a trial approach carries."""

    force: float  # [N]
    slope: float  # [N/mm]
    straight: float = 0.0  # change of the pressures as far as which the force is a straight line [MPa]


class Balance(NamedTuple):
    """A solved contact: what `contact.pressure_of` needs, and how well the load is met."""

    base: float  # approach = base + offset [mm]
    offset: float  # [mm]
    cap: float  # pressure of a cell at its cap [MPa]
    load_residual: float  # carried at hardness − asked for [N]
    tie_width: float = 0.0  # [mm]
    tie_pressure: float = 0.0  # pressure that tied cells share [MPa]
    evaluations: int = 0

    @property
    def approach(self) -> float:
        """Rigid approach from the mean planes [mm]."""
        return self.base + self.offset

    def fill(self, law: Arguments) -> None:
        """Give kernels what they evaluate the pressure by."""
        set_numbers(
            law,
            base=self.base,
            offset=self.offset,
            cap=self.cap,
            tie_width=self.tie_width,
            tie_pressure=self.tie_pressure,
        )


@dataclass(frozen=True)
class Foundation:
    """A capped foundation on a gap, and the load that it carries."""

    gap: Field  # [mm]
    stiffness: Field  # 1/c [N/mm³], one row for all or one a row of cells
    tiles: TileList  # of the gap; more of them are listed as they are needed
    load: float  # [N]
    hardness: float  # [MPa]
    stiffest: float = math.inf  # no cell's stiffness is larger [N/mm³]
    parts: Field | None = None  # of the hardness, that cells bear; None: all of it


def stiffness_of(compliance: float) -> float:
    """1/c [N/mm³] of a compliance [mm³/N], `RIGID` at most."""
    return min(1.0 / compliance, RIGID) if compliance else RIGID


def residual_of(carried: float, load: float, *, approach: float) -> float:
    """What the pressures that wore carry beyond the load [N]. approach: theirs [mm].

    Raises ConvergenceError where it is more than a balance and its rounding leave.
    """
    residual = carried - load
    if not abs(residual) <= 2.0 * TOLERANCE * load:
        raise ConvergenceError(
            f"{residual:.3g} N of {load:.6g} N are left at an approach of {approach:.9g} mm."
        )
    return residual


class Balancer:
    """Solves the load balance on gaps of one grid. Holds the tables that the reductions write."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._law = arguments(Law)
        self._sums = executor.partials(3)
        self._cell_area = executor.grid.cell_area

    def solve(
        self,
        task: Foundation,
        *,
        start: float | None = None,
        step: float = 0.0,
        scatter: float = 0.0,
        known: Carried | None = None,
    ) -> Balance:
        """Balance of a contact with compliance, to `TOLERANCE`.

        start: approach near the solution [mm], from the step before; step: how far beyond it the solution is
        expected [mm]; scatter: how far from there it may be, where that is known; known: what start + step
        carries. Without a start the search begins at the lowest cell.

        Raises ConvergenceError, never returns an unbalanced contact.
        """
        load, tiles = task.load, task.tiles
        low, margin = -math.inf, max(STEPS_AHEAD * abs(step), scatter)
        far = start is None or scatter > 0.0  # a list too short may lead far beyond the solution
        if start is None:
            start, low = tiles.smallest, 0.0
            values = task.stiffness.numpy()
            softest = float(values[values > 0.0].min())
            step = 0.5 * min(task.hardness, load / self._cell_area) / softest
            tiles.begin()
        else:
            tiles.reach(start + step, margin=margin)
        base = start
        evaluations = 0
        while True:
            found, base = self._search(task, base, step, low, scatter, known)
            known = None
            evaluations += found.evaluations
            approach = base + found.offset
            if not found.converged(load):
                if tiles.limit < math.inf:  # what is listed cannot carry the load, even at the hardness
                    tiles.reach(math.inf)
                    base, step, low = start, 0.0, -math.inf
                    continue
                raise ConvergenceError(
                    f"the load balance did not converge: {found.force - load:.3g} N of {load:.6g} N are left "
                    f"(allowed {TOLERANCE * load:.1g} N) near an approach of {approach:.9g} mm."
                )
            if approach <= tiles.limit:
                residual = found.force - load
                return Balance(base, found.offset, task.hardness, residual, evaluations=evaluations)
            # Tiles that touch are missing: with them the approach is smaller, at first by far, but not below
            # what this list served, give or take rounding.
            low = 1.5 * (tiles.limit - approach)
            depth = max(DEEPER * (tiles.limit - start), LEAST_DEPTH)
            tiles.reach(min(approach, start + depth) if far else approach, margin=margin)
            base, step = approach, 0.0

    def _search(
        self, task: Foundation, base: float, step: float, low: float, scatter: float, known: Carried | None
    ) -> "tuple[SearchResult, float]":
        """How far the balance came on the tiles listed, and the base that its offset counts from."""
        for _ in range(MAX_ROUNDS):

            def carried(offset: float, base: float = base) -> Carried:
                return self._carried(task, base, offset)

            found = newton_in_bracket(carried, task.load, step, low, math.inf, scatter, task.stiffest, known)
            known = None
            if found.converged(task.load) or not abs(found.offset) < HOPELESS:
                break
            # Down to neighbouring numbers: from a base at the solution the offset has digits again.
            base, step, low, scatter = base + found.offset, 0.0, -math.inf, 0.0
        return found, base

    def _carried(self, task: Foundation, base: float, offset: float) -> Carried:
        """Force and its slope at an approach."""
        set_numbers(self._law, base=base, offset=offset, cap=task.hardness)
        own = [] if task.parts is None else [task.parts]
        self._executor.launch(
            caps.carried if own else contact.carried,
            inputs=[self._law, task.stiffness, task.gap, *own],
            outputs=[self._sums],
            over=task.tiles,
            often=True,
        )
        return self.evaluated(self._sums)

    def pressures(
        self, law: Arguments, stiffness: Field, gap: Field, tiles: TileList, parts: Field | None = None
    ) -> FloatArray:
        """The pressure of every cell [MPa], shape (nx, ny), at the approach and cap of the law.

        parts: of the cap, that cells bear; None: all of it.
        """
        field, own = self._executor.zeros(), [] if parts is None else [parts]
        kernel = caps.pressures if own else contact.pressures
        self._executor.launch(kernel, inputs=[law, stiffness, gap, *own], outputs=[field], over=tiles)
        return self._executor.to_numpy(field)

    def evaluated(self, partials: Field) -> Carried:
        """What a table of partial results adds up to."""
        table = partials.numpy()
        force, slope = table[:2].sum(axis=1) * self._cell_area
        return Carried(float(force), float(slope), float(table[2].min()))


class SearchResult(NamedTuple):
    """Where a search ended."""

    offset: float  # [mm]
    force: float  # [N]
    evaluations: int

    def converged(self, load: float) -> bool:
        return abs(self.force - load) <= TOLERANCE * load


def newton_in_bracket(
    carried: Callable[[float], Carried],
    load: float,
    guess: float,
    low: float,
    high: float,
    scatter: float,
    stiffest: float = math.inf,
    known: Carried | None = None,
) -> SearchResult:
    """Looks for the offset with |force − load| ≤ TOLERANCE load until the bracket is down to one number.

    Newton's step is taken while it stays inside the bracket and the bracket halves at least every second
    evaluation: alone it crawls where c H is a few nanometres. Sides of the bracket that are not known yet are
    looked for in growing steps, the first as long as the guess is or may be wrong by. Where no cell changes
    its state on the way Newton's step is the solution and is not looked at again.

    known: what the guess carries; not counted as an evaluation.
    """
    offset = guess
    reach = max(abs(guess), scatter) or FIRST_REACH
    width_before = math.inf
    found = SearchResult(offset, math.nan, 0)
    for trial in range(1, MAX_EVALUATIONS):
        force, slope, straight = known if known is not None and trial == 1 else carried(offset)
        evaluation = trial - (known is not None)
        found = SearchResult(offset, force, evaluation)
        if found.converged(load):
            break
        residual = force - load
        if not abs(offset) < HOPELESS:
            break
        if residual < 0.0:
            low = offset
        else:
            high = offset
        newton = offset - residual / slope if slope > 0.0 else math.nan
        if abs(newton - offset) * stiffest < SURELY * straight and slope * abs(newton) < DIGITS * load:
            return SearchResult(newton, load, evaluation)
        if math.isinf(low) or math.isinf(high):
            limit = offset + math.copysign(reach, -residual)
            inside = newton if abs(newton - offset) <= reach else limit
            offset = limit if math.isnan(newton) else inside
            reach *= 4.0
            continue
        stalled = trial % 2 == 0 and high - low > 0.5 * width_before
        if trial % 2 == 0:
            width_before = high - low
        offset = newton if low < newton < high and not stalled else 0.5 * (low + high)
        if not low < offset < high:  # the bracket is down to neighbouring numbers
            break
    return found


def find_offsets(
    carried: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    target: FloatArray,
    allowed: FloatArray,
    offset: FloatArray,
    reach: FloatArray,
    *,
    most: int = MAX_EVALUATIONS,
) -> tuple[FloatArray, FloatArray, int]:
    """Offsets at which each of many carries its target, give or take what is allowed.

    carried: what they carry, and the slopes, at offsets; it rises with them. offset, reach: where to begin,
    and how long the first step may be. most: evaluations. Returns the offsets, what is carried there and the
    evaluations, also where brackets came down to neighbouring numbers before all was met.
    """
    low, high = np.full_like(offset, -math.inf), np.full_like(offset, math.inf)
    for evaluation in range(1, most):
        p, slope = carried(offset)
        left = p - target
        done = np.abs(left) <= allowed
        low, high = np.where(left < 0.0, offset, low), np.where(left > 0.0, offset, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = offset - left / slope  # not finite without a slope
        bracketed = np.isfinite(low) & np.isfinite(high)
        bisect = ~((newton > low) & (newton < high)) | (evaluation % BISECT_EVERY == 0)
        with np.errstate(invalid="ignore"):
            inside = np.where(bisect, 0.5 * (low + high), newton)
        limit = offset - np.copysign(reach, left)
        outside = np.where(np.abs(newton - offset) <= reach, newton, limit)
        new = np.where(done, offset, np.where(bracketed, inside, outside))
        reach = np.where(bracketed, reach, 4.0 * reach)
        if np.all(done | (new == offset) | (bracketed & ((new <= low) | (new >= high)))):
            break
        offset = new
    return offset, p, evaluation
