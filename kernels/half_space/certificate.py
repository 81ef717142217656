"""Passes and decisions of a certificate: what a pressure violates, how far its energy is above the least.

`contact.certificate` says what is certified, `native/half_space/certificate.h` has the loops over cells.
"""

import warp as wp

from warpwear.kernels.cells import NONE, ONE, ZERO
from warpwear.kernels.half_space import solve as search
from warpwear.kernels.half_space.solve import TOGETHER, Fields, native_pass

#: Levels of a bracket that one pass looks at, as in the header.
LEVELS = wp.constant(wp.int32(8))
#: Passes at most: each leaves a ninth of the bracket.
PASSES = wp.constant(wp.int32(40))
#: Rounding of one number, relatively.
ROUNDING = wp.constant(wp.float64(2.0e-16))
#: What the level may add to the bound, over load times level: less than sums of so many cells are rounded by.
NEGLIGIBLE = wp.constant(wp.float64(1.0e-18))
#: Lines of the table of partial results.
LINES = 11


@wp.struct
class Proven:
    """Holds what is certified of the cells that share one load and one approach, and what that rests on."""

    approach: wp.float64  # λ [mm]
    load: wp.float64  # Σ p that was to be carried [MPa]; negative where none was
    scale: wp.float64  # that violations count over [mm]
    allowed: wp.float64  # violation [mm]
    total: wp.float64  # Σ p [MPa]
    over: wp.float64  # largest p − H [MPa]
    under: wp.float64  # largest −p [MPa]
    highest: wp.float64  # t where p > 0 [mm]
    lowest: wp.float64  # t where p < H [mm]
    low: wp.float64  # bracket of the level of the lower bound [mm]
    high: wp.float64
    slope: wp.float64  # what the cells up to its upper end carry at the cap beyond the load [MPa]
    level: wp.float64  # λ' [mm]
    gap: wp.float64  # Σ p max(t − λ', 0) + (H − p) max(λ' − t, 0) [MPa mm]


@wp.struct
class Proof:
    """Holds a certificate while it is made."""

    columns: wp.int32  # of the grid, without padding
    fields: Fields  # with the response to the pressure
    visited: wp.array(dtype=wp.int32)  # rows, one number
    groups: wp.array(dtype=Proven)
    table: wp.array2d(dtype=wp.float64)  # a line a sum or maximum, a column a slot
    passes: wp.array(dtype=wp.int32)  # that have looked for the level, one number
    searching: wp.array(dtype=wp.int32)  # whether a level is looked for, one number


#: Sum up the pressure; find by how much it exceeds its bounds, and the gaps that violate conditions.
extremes = native_pass("proof_extremes", proof=Proof)
#: Sum up what cells below levels of the bracket carry at the cap.
carried_at = native_pass("proof_carried", proof=Proof)
#: Sum up the bound of the energy at the level that makes it least.
excess = native_pass("proof_gap", proof=Proof)


@wp.kernel(module=TOGETHER)
def bracket(proof: Proof):
    """Note extremes, and between which of them the level λ' lies: it is the lowest gap where there is no cap.

    Cells with t below the lowest gap where p < H all bear their hardness, and none with t above the highest
    where p > 0 bears anything.
    """
    has_cap = proof.fields.cap < NONE
    for i in range(search.first_group(proof), search.groups_of(proof), search.stride(proof)):
        lines = search.lines_of(proof, i, 2, 6)
        group = proof.groups[i]
        nothing = ZERO / (ONE - wp.min(lines[1], ONE))  # 0, or not a number
        group.total = lines[0] + nothing
        group.over = lines[2] + nothing
        group.under = lines[3]
        group.highest = lines[4] + nothing
        group.lowest = -lines[5]
        group.slope = NONE
        group.high = wp.max(group.highest, group.lowest)
        group.low = wp.min(group.highest, group.lowest)
        if group.highest <= -NONE or group.lowest >= NONE:  # no cell touches, or all bear the hardness
            group.high = wp.where(group.lowest < NONE, group.lowest, group.highest)
            group.low = group.high
        group.low = group.low - ROUNDING * wp.abs(group.low)
        group.level = wp.where(has_cap, group.high, group.lowest)
        if search.writes(proof):
            proof.groups[i] = group
    if search.lane() == 0:
        proof.passes[0] = 0
        proof.searching[0] = wp.where(has_cap, 1, 0)


@wp.kernel(module=TOGETHER)
def narrow(proof: Proof):
    """Narrow the bracket of the level of every group to where its cells carry the load at the cap.

    The slope of the bound in λ' is what the cells below λ' carry at the cap less the load. So the bound at
    the upper end exceeds the least one by less than the width of the bracket times that slope.
    """
    wide = ZERO
    for i in range(search.first_group(proof), search.groups_of(proof), search.stride(proof)):
        lines = search.lines_of(proof, i, LEVELS + 1, LEVELS + 3)
        group = proof.groups[i]
        step = (group.high - group.low) / wp.float64(LEVELS + 1)
        low = group.low
        high = group.high
        for n in range(LEVELS):
            level = group.low + wp.float64(n + 1) * step
            carries = lines[0] + lines[1 + n]
            if carries < group.total:
                low = level
            elif high == group.high:
                high = level
                group.slope = carries - group.total
        highest = lines[LEVELS + 1]
        lowest = -lines[LEVELS + 2]
        least = NEGLIGIBLE * wp.max(wp.abs(low), wp.abs(high)) * group.total
        if not (highest > lowest):  # one level is left, or none
            high = wp.where(highest == lowest, highest, group.high)
        elif (high - low) * group.slope > least and step > ROUNDING * wp.abs(high):
            wide += ONE
        group.low = low
        group.high = high
        group.level = high
        if search.writes(proof):
            proof.groups[i] = group
    wide = search.over_groups(proof, wide, True)
    if search.lane() == 0:
        proof.passes[0] = proof.passes[0] + 1
        proof.searching[0] = wp.where(wide > ZERO and proof.passes[0] < PASSES, 1, 0)


@wp.kernel(module=TOGETHER)
def prove(proof: Proof):
    """Note the bound of every group."""
    for i in range(search.first_group(proof), search.groups_of(proof), search.stride(proof)):
        lines = search.lines_of(proof, i, 1, 1)
        if search.writes(proof):
            proof.groups[i].gap = lines[0]


#: All of them, to be compiled without those of searches.
ALONE = (extremes, bracket, carried_at, narrow, excess, prove)
