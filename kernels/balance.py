"""The load balance of cells on springs with a cap, none of which feels the others.

A search is a pass over the listed cells and a decision in turns. What is carried rises piecewise linearly
with the approach: Newton's method is kept inside a bracket, see `newton`. Without springs, see `bearing`.
The lists of tiles that passes visit are made here, too: kernels of one file are compiled together.

An approach is base + offset: one ulp of 0.07 mm changes the load of a worn contact by more than 1e-12 of it,
`base − gap` is exact near contact, and the offset adds the missing digits.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import (
    LISTED,
    NONE,
    ONE,
    ZERO,
    Cells,
    fields,
)
from warpwear.kernels.contact import Bends, Law
from warpwear.kernels.native_code import most_of, sum_of
from warpwear.kernels.newton import HALF, HOPELESS, LOOKS, STUCK, SURE, Bracket, bracket_at, next_trial
from warpwear.kernels.tiles import LISTS, SAMPLE, SAMPLED, Listing, TileLists, limit_of, list_from, reached

native_pass = native_code.passes_of(__name__, "springs.h", "tiles.h")

#: Searches on springs, each from a base nearer the solution.
ROUNDS = wp.constant(wp.int32(3))
#: From a cold start each list of tiles reaches this many times deeper than the last, and at least this [mm].
DEEPER = wp.constant(wp.float64(4.0))
LEAST_DEPTH = wp.constant(wp.float64(1.0e-6))
#: A list that follows a search that has missed tiles: no approach lies this many times further down.
FURTHER = wp.constant(wp.float64(1.5))
#: Steps ahead that a new list of tiles reaches.
STEPS_AHEAD = wp.constant(wp.float64(16.0))


@wp.struct
class BalanceSearch:
    """A search for the balance, and what it found: `bracket.state` says how far it is."""

    base: wp.float64  # [mm]
    bracket: Bracket  # of the offset; of a bearing area of the approach
    stiffness: wp.float64  # 1/c of cells that are alike, else 0 [N/mm³]
    start: wp.float64  # where it began [mm]
    margin: wp.float64  # by which its lists reach further than it needs [mm]
    scatter: wp.float64  # how far from the start the approach may be, where that is known [mm]
    is_cold: wp.int32  # 1 where it began at the lowest cell: it may lead far
    round: wp.int32
    evaluations: wp.int32
    residual: wp.float64  # of the load at the end [N]
    phase: wp.int32  # of a bearing area, and the numbers of cells at the ends of its bracket
    below: wp.float64
    above: wp.float64


@wp.struct
class Springs:
    """A contact whose load is balanced: what does not change, and where a search has got to."""

    load: wp.float64  # [N]
    cap: wp.float64  # [MPa]
    cell_area: wp.float64  # [mm²]
    tolerance: wp.float64  # of the load [N]
    highest: wp.float64  # gap before any wear, of a bearing area [mm]
    search: wp.array(dtype=BalanceSearch)  # one
    law: wp.array(dtype=Law)  # one: what the pressures follow from, when the search has ended
    lists: wp.array(dtype=Listing)  # one
    searching: wp.array(dtype=wp.int32)  # flag: a pass is needed
    listing: wp.array(dtype=wp.int32)  # flag: a list of tiles is needed, before any pass
    trial: wp.array2d(dtype=wp.float64)  # what a pass finds, a column a slot
    bends: Bends  # of cells whose K goes with their pressure
    near: wp.array2d(dtype=Cells)  # gaps inside the bracket of a bearing area, a line a slot, or none [mm]


@wp.func
def ask_for(springs: Springs, lists: Listing):
    """Ask for a list of tiles, where it is another than there is."""
    if lists.limit != springs.lists[0].limit or lists.asked != springs.lists[0].asked:
        springs.listing[0] = 1
    springs.lists[0] = lists


@wp.func
def search_from(approach: wp.float64, step: wp.float64, scatter: wp.float64, stiffness: wp.float64):
    """Return a search that expects the balance a step beyond an approach, give or take a scatter."""
    s = BalanceSearch()
    s.base = approach
    s.start = approach
    s.bracket = bracket_at(step, wp.max(wp.abs(step), scatter))
    s.stiffness = stiffness
    s.scatter = scatter
    s.margin = wp.max(STEPS_AHEAD * wp.abs(step), scatter)
    return s


@wp.func
def search_from_lowest(springs: Springs, lowest: wp.float64, stiffness: wp.float64, softest: wp.float64):
    """Begin a search at the lowest cell, of which nothing is known. softest: stiffness of a cell."""
    s = search_from(
        lowest, HALF * wp.min(springs.cap, springs.load / springs.cell_area) / softest, ZERO, stiffness
    )
    s.bracket.low = ZERO
    s.is_cold = 1
    s.margin = ZERO  # how far the first step leads says nothing
    return s


@wp.func
def judged(
    springs: Springs,
    s: BalanceSearch,
    lists: Listing,
    force: wp.float64,
    slope: wp.float64,
    near: wp.float64,
):
    """Return the search on springs after a pass, and the list of tiles that it needs.

    force, slope: carried at the trial [N, N/mm]. near: change of pressure that the nearest cell needs to
    change its state [MPa].
    """
    alike = s.stiffness > ZERO
    linear_range = wp.where(alike, near / wp.where(alike, s.stiffness, ONE), ZERO)
    b = next_trial(s.bracket, force, slope, springs.load, springs.tolerance, linear_range)
    approach = s.base + b.offset
    s.residual = wp.where(b.state == SURE, ZERO, force - springs.load)
    if b.state == STUCK:
        if wp.abs(b.offset) < HOPELESS and s.round + 1 < ROUNDS:
            # Down to neighbouring numbers: from a base at the solution the offset has digits again.
            s.base = approach
            s.round = s.round + 1
            b = bracket_at(ZERO, ZERO)
        elif lists.limit < NONE:  # what is listed cannot carry the load, even at the cap
            lists.limit = NONE
            lists.asked = NONE
            s.base = s.start
            s.round = 0
            b = bracket_at(ZERO, s.scatter)
    elif b.state != LOOKS and approach > lists.limit:
        # Tiles that touch are missing: with them the approach is smaller, at first by far, but not below what
        # this list served, give or take rounding.
        low = FURTHER * (lists.limit - approach)
        depth = wp.max(DEEPER * (lists.limit - s.start), LEAST_DEPTH)
        wanted = approach
        if s.is_cold == 1 or s.scatter > ZERO:
            wanted = wp.min(approach, s.start + depth)
        lists = reached(lists, wanted, s.margin)
        s.base = approach
        s.round = 0
        b = bracket_at(ZERO, s.scatter)
        b.low = low
    s.bracket = b
    return s, lists


@wp.func
def conclude(springs: Springs, s: BalanceSearch, lists: Listing):
    """Keep a search on springs, and where it has ended, the law of the pressures."""
    ask_for(springs, lists)
    springs.search[0] = s
    b = s.bracket
    springs.searching[0] = wp.where(b.state == LOOKS, 1, 0)
    law = Law()
    law.base = s.base
    law.offset = b.offset
    law.cap = springs.cap
    springs.law[0] = law


#: List anew, row by row, the tiles whose smallest gap does not exceed the limit. On a CPU.
#:
#: Of a tile that leaves the list it is kept what the pass that wears sums over listed tiles only.
select = native_pass("list_tiles", lists=LISTS, **fields("gap", "unworn"), tiles=TileLists)


@wp.kernel
def check_list(
    lists: wp.array(dtype=Listing), listing: wp.array(dtype=wp.int32), tiles: TileLists, least: wp.int32
):
    """Decides whether a list holds enough tiles, or must reach deeper than it was asked to. On a CPU."""
    now = lists[0]
    now.is_fresh = 0
    now.lists = now.lists + 1
    now.listed = 0
    rows = tiles.count.shape[0]
    for row in range(rows):
        now.listed = now.listed + tiles.count[row]
    listing[0] = 0
    if now.listed < least and now.limit == now.asked and now.limit < NONE:
        apart = wp.where(rows * tiles.lowest.shape[1] > SAMPLED, SAMPLE, 1)
        deeper = limit_of(tiles.lowest, apart, least / apart + 1, now.limit)
        if deeper > now.limit:
            now.limit = deeper
            listing[0] = 1
    lists[0] = now


@wp.func
def start_search(springs: Springs, lowest: wp.float64, s: BalanceSearch):
    """Begin a search of which nothing is known, on any list. lowest: gap [mm]."""
    ask_for(springs, list_from(springs.lists[0], lowest))
    springs.search[0] = s
    springs.searching[0] = 1


@wp.kernel
def begin(springs: Springs, lowest: wp.float64, softest: wp.float64):
    """Begins a search of which nothing is known. lowest: gap [mm]; softest: stiffness of a cell [N/mm³]."""
    if wp.tid() == 0:
        start_search(springs, lowest, search_from_lowest(springs, lowest, ZERO, softest))


#: Add up pressures at the trial and stiffnesses of cells between open and cap; find how far they are so.
#:
#: stiffness, cap_ratio: of every cell, or no rows where the search has one, and all bear the cap.
carried = native_pass("carry", **LISTED, springs=Springs, **fields("gap", "stiffness", "cap_ratio"))


@wp.func
def judged_pass(springs: Springs):
    """Return the search on springs after a pass, and the tiles that it needs. All threads follow it."""
    force = sum_of(springs.trial, 0) * springs.cell_area
    slope = sum_of(springs.trial, 1) * springs.cell_area
    near = -most_of(springs.trial, 2)
    s = springs.search[0]
    s.evaluations = s.evaluations + 1
    return judged(springs, s, springs.lists[0], force, slope, near)


@wp.kernel
def judge(springs: Springs):
    """Decides what follows from a pass on springs."""
    s, lists = judged_pass(springs)
    if wp.tid() == 0:
        conclude(springs, s, lists)


#: Store the pressures of the cells listed, at the end of a search; fields as of `carried`.
pressures = native_pass(
    "press", **LISTED, springs=Springs, **fields("gap", "stiffness", "cap_ratio", "pressure")
)
