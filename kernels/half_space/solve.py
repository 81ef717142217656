"""A search of the half-space solver knows its rules, its fields, and the numbers of its groups of rows.

A group carries one load at one approach: all rows together, or each row for itself.
"""

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any

import numpy as np
import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import Cells
from warpwear.kernels.native_code import Lines, lane, lines_of_table, reduce_slot, width
from warpwear.kernels.newton import Bracket

#: Kernels of a search are compiled together: each file of its own would compile Warp's headers again.
TOGETHER = wp.get_module("warpwear.kernels.half_space.solve")
HEADERS = (
    "half_space/extension.h",
    "half_space/active_set.h",
    "half_space/windows.h",
    "half_space/certificate.h",
)
native_pass = native_code.passes_of(TOGETHER.name, *HEADERS)
#: Kernels for caps and compliances that cells have of their own, which few searches ask for.
own_pass = native_code.passes_of("warpwear.kernels.half_space.own", "half_space/search.h")

#: How a search ended.
RUNS = wp.constant(wp.int32(0))
CONVERGED = wp.constant(wp.int32(1))
LED_NOWHERE = wp.constant(wp.int32(2))
UNBALANCED = wp.constant(wp.int32(3))
#: Lines of the table of partial results.
LINES = 9


class Request(IntEnum):
    """Names what the host asks of a search: places in `Solve.request`."""

    RESPONSE = 0  # to a pressure that alternates from cell to cell, compliance included [mm/MPa]
    AT_LOAD = 1  # 1 at loads, 0 at approaches
    ANEW = 2  # 1 where it starts from nothing
    ROUGH = 3  # 1 where single precision may do
    CERTIFIED = 4  # 1 where its pressure is to be certified
    RENEWED = 5  # 1 where it follows one whose pressure could not be certified, or did not balance
    LONGER_RESPONSE = 6  # to waves about as long as asperities are, compliance included [mm/MPa]
    TOLERANCE = 7  # largest violation of complementarity, over the rms height of the gap


class Flag(IntEnum):
    """Names what a decision says of what follows: places in `Solve.flags`."""

    ANEW = 0
    SEARCHING = 1
    RENEWS = 2
    RENEWS_EXACTLY = 3
    RENEWS_ROUGHLY = 4
    MOVES = 5
    MOVES_FEW = 6
    AIMED_AT_FEW = 7
    STEPS = 8
    DESCENDS = 9
    PRECONDITIONS = 10
    EXTENDS = 11
    EXTENDS_NOT = 12
    BALANCING = 13
    SOLVING = 14
    CERTIFIES = 15
    HOLDS = 16


@dataclass(frozen=True)
class SearchRules:
    """Holds the rules of a search, which decisions go by."""

    #: Where a smaller fraction of the cells in contact is below the cap, |q| is no guide: steps then follow
    #: the plain gradient.
    elastic_fraction: float = 0.1
    #: Plain steps of a solve; |q| leads on where this many have not led to its end.
    patience: int = 16
    #: A step is taken whole, bounds and all, if it is at least this fraction of the best length; else the
    #: best length is taken.
    whole_step: float = 0.9
    #: A preconditioned step whose best length is below this led nowhere: plain steps follow.
    shortest_useful_step: float = 0.05
    #: Plain steps that follow then.
    plain_steps: int = 5
    #: Cells at a bound are pushed outward this many times harder than free cells move, in a preconditioned
    #: step.
    outward: float = 1.0e3
    #: Largest violation of complementarity, over the rms height of the gap.
    tolerance: float = 1.0e-6
    #: Smaller differences of displacements, relative to them, are those of the last digits.
    rounding: float = 16.0 * float(np.finfo(np.float64).eps)
    #: What a trial may miss of the load, relatively: the next step makes up for it.
    rough_balance: float = 1.0e-3
    iterations: int = 1000
    #: Ends of the lines of cells between the bounds, over these cells, from which their gradient is extended
    #: to others: 0.4 where waves are two cells long, 0.08 where they are sixteen, 0.01 under a smooth ball.
    scattered: float = 0.15
    #: One of this many rows is looked at for that.
    every: int = 8
    #: Error of the gradient, over the violation left, from which it is made anew.
    drift: float = 0.2
    #: Error of a response in single precision, over its largest value: measured were 4e-7 to 7e-7.
    single_rounding: float = 8.0 * float(np.finfo(np.float32).eps)
    #: Cells that are moved at once, exactly, at most.
    few: int = 256
    #: Gap or overlap of a cell that may change sides then, over the largest violation of complementarity.
    near: float = 0.25
    #: Restarts after a failed certificate.
    renewals: int = 3


@wp.struct
class Rules:
    """Holds the rules of a search as kernels take them, and what depends on what is searched."""

    __annotations__ = {f.name: wp.int32 if f.type is int else wp.float64 for f in fields(SearchRules)} | {
        "load_tolerance": wp.float64,  # residual of the load, relative to it
        "certified_load": wp.float64,  # that a certified pressure may miss, relatively
        "tiled": wp.int32,  # 1 where what is extended is gathered tile by tile, apart from the trial
        "group_cells": wp.float64,  # of the surface, in a group
    }


@wp.struct
class RowGroup:
    """Holds the numbers of rows that carry one load at one approach."""

    load: wp.float64  # Σ p that is to be carried [MPa]
    level: wp.float64  # approach λ [mm]
    mean: wp.float64  # of the gap [mm]
    rms: wp.float64  # height [mm]
    lowest: wp.float64  # gap [mm]
    total: wp.float64  # Σ p [MPa]
    touching: wp.float64  # cells
    violation: wp.float64  # of complementarity [mm]
    scale: wp.float64  # that it counts over [mm]
    allowed: wp.float64  # [mm]
    descent_mean: wp.float64  # [mm] or, of the preconditioner, [MPa]
    unit: wp.float64  # of shifts of the trial [MPa]
    shift: wp.float64  # of the trial [MPa]
    bracket: Bracket  # of the shift, in units


@wp.struct
class SearchNumbers:
    """Holds what all groups have in common."""

    response: wp.float64  # to a pressure that alternates from cell to cell [mm/MPa]
    stiffness: wp.float64  # its reciprocal [MPa/mm]
    longer_stiffness: wp.float64  # of longer waves [MPa/mm]
    at_load: wp.int32
    plain_length: wp.float64  # of a trial step along the plain gradient
    near_length: wp.float64  # of a preconditioned one
    measured_plain: wp.int32  # whether a length has been measured
    measured_near: wp.int32
    trial_length: wp.float64
    curvature: wp.float64  # along the last step
    memory: wp.float64  # of the last step in the next
    outward: wp.float64
    length: wp.float64  # of the step that is gone, in steps
    whole: wp.int32  # whether the trial itself is taken
    last: wp.int32  # kind of the last step: 1 plain, 0 preconditioned, −1 nothing to remember
    plain: wp.int32  # kind of this one
    extended: wp.int32  # whether its descent was extended
    plain_left: wp.int32
    plain_done: wp.int32
    loaded: wp.int32  # whether every group carries its load
    few_below: wp.float64  # violation from which moving few cells alone is not tried [mm]
    near: wp.float64  # gap or overlap of a cell that may change sides [mm]
    drift: wp.float64  # by how much the gradient may be off [mm]
    step_drift: wp.float64  # what a whole step adds to that [mm]
    moved: wp.int32  # whether this was an iteration
    iteration: wp.int32
    transforms: wp.int32  # pairs
    before: wp.int32  # iterations of searches whose pressures could not be certified, or did not balance
    transforms_before: wp.int32
    renewals: wp.int32
    status: wp.int32


@wp.struct
class Fields:
    """Holds what a search moves, and the caps; arrays of the executor's fields."""

    gap: wp.array2d(dtype=Cells)  # g [mm]
    pressure: wp.array2d(dtype=Cells)  # p [MPa]
    gradient: wp.array2d(dtype=Cells)  # t [mm]
    trial: wp.array2d(dtype=Cells)  # pressure that a step aims at, before it is shifted and clipped [MPa]
    step: wp.array2d(dtype=Cells)  # the last one [MPa]
    response: wp.array2d(dtype=Cells)  # of the gradient to it [mm]
    gathered: wp.array2d(dtype=wp.float32)  # descent that was extended and gathered; no rows where none is
    cap: wp.float64  # H [MPa]
    cap_ratio: wp.array2d(dtype=Cells)  # of the cap, that cells bear; no rows where all bear all of it
    yields: wp.array2d(dtype=Cells)  # compliance of each cell [mm/MPa]; no rows where none has its own


@wp.struct
class ActiveSet:
    """Lists the few cells whose place between the bounds is open, with room to move them."""

    count: wp.array(dtype=wp.int32)  # one number
    row: wp.array(dtype=wp.int32)
    column: wp.array(dtype=wp.int32)
    slope: wp.array(dtype=wp.float64)  # t − λ [mm]
    low: wp.array(dtype=wp.float64)  # change of the pressure that takes a cell to a bound [MPa]
    high: wp.array(dtype=wp.float64)
    change: wp.array(dtype=wp.float64)  # [MPa]
    side: wp.array(dtype=wp.int32)
    next: wp.array(dtype=wp.int32)
    free: wp.array(dtype=wp.int32)
    order: wp.array(dtype=wp.int32)
    rest: wp.array(dtype=wp.float64)
    pair: wp.array(dtype=wp.float64)
    matrix: wp.array(dtype=wp.float64)
    equations: wp.array(dtype=wp.float64)
    factor: wp.array(dtype=wp.float64)
    elastic: wp.array2d(dtype=wp.float64)  # coefficients by distance in cells [mm/MPa]
    along: wp.array(dtype=wp.float64)  # what compliances add in a column, by distance along x [mm/MPa]
    rows: wp.int32  # beyond which distances wrap
    columns: wp.int32


@wp.struct
class Streaks:
    """Holds compliances of cells under the mean pressure that passes them along x.

    They stand beside `Solve`, each of whose arrays costs every launch that is recorded.
    """

    yields: wp.array2d(dtype=Cells)  # [mm/MPa]
    yielded: wp.array2d(dtype=Cells)  # by them [mm]
    window: wp.array(dtype=wp.int32)  # cells of the mean, one number


@wp.struct
class Solve:
    """Holds a search, and where its passes leave what they find."""

    columns: wp.int32  # of the grid, without padding
    wraps_along: wp.int32  # 1 where the surface repeats beyond its first and last row
    wraps_across: wp.int32  # beyond its first and last column
    neighbours: wp.array(dtype=wp.float32)  # weights of those along x, along y and across corners
    rules: wp.array(dtype=Rules)  # one
    fields: Fields
    request: wp.array(dtype=wp.float64)  # by `Request`
    loads: wp.array(dtype=wp.float64)  # of each group, Σ p [MPa]; at approaches those [mm]
    visited: wp.array(dtype=wp.int32)  # rows, one number
    groups: wp.array(dtype=RowGroup)
    numbers: wp.array(dtype=SearchNumbers)  # one
    table: wp.array2d(dtype=wp.float64)  # a line a sum or maximum, a column a slot
    flags: wp.array(dtype=wp.int32)  # of the program, by `Flag`


# A decision is one slot. Where there is one group all of its threads look at it together; of many groups each
# thread looks at some.


@wp.func
def is_one(solve: Any):
    """Tell whether all rows are one group."""
    return solve.groups.shape[0] == 1


@wp.func
def groups_of(solve: Any):
    """Count the groups that are visited."""
    return wp.where(is_one(solve), 1, solve.visited[0])


@wp.func
def first_group(solve: Any):
    """Name the first group that a thread looks at."""
    return wp.where(is_one(solve), 0, lane())


@wp.func
def stride(solve: Any):
    """Count from one group of a thread to its next."""
    return wp.where(is_one(solve), 1, width())


@wp.func
def writes(solve: Any):
    """Tell whether a thread writes what it has found of a group."""
    return not is_one(solve) or lane() == 0


@wp.func
def all_lines(solve: Any, sums: wp.int32, lines: wp.int32):
    """Bring the first lines of the table to a number each, over all slots: so many sums, then maxima."""
    return lines_of_table(solve.table, wp.min(solve.visited[0], solve.table.shape[1]), sums, lines)


@wp.func
def lines_of(solve: Any, group: wp.int32, sums: wp.int32, lines: wp.int32):
    """Bring the first lines of the table to a number each, over the slots of a group, likewise."""
    values = Lines()
    if is_one(solve):
        values = all_lines(solve, sums, lines)
    else:
        for line in range(lines):
            values[line] = solve.table[line, group]
    return values


@wp.func
def over_groups(solve: Any, value: wp.float64, adds: wp.bool):
    """Bring what the threads have of their groups to one number."""
    if is_one(solve):
        return value
    return reduce_slot(value, adds)
