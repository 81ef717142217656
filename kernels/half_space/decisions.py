"""Decisions after passes of the half-space search say where it begins, goes on and ends.

These are rules of `contact.half_space.search`; `steps` has those of how far it goes. Every decision is one
slot. Symbols as in `native/half_space/search.h`.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, NONE, ONE, ZERO
from warpwear.kernels.half_space import solve as search
from warpwear.kernels.half_space.certificate import Proof, Proven
from warpwear.kernels.half_space.solve import TOGETHER, Flag, Request, Solve
from warpwear.kernels.newton import HALF, LOOKS, STUCK, bracket_at, next_trial


@wp.kernel(module=TOGETHER)
def begin(solve: Solve):
    """Begin to search, as often as it takes until a pressure is certified."""
    if search.lane() == 0:
        solve.flags[Flag.SOLVING] = 1


@wp.kernel(module=TOGETHER)
def start(solve: Solve):
    """Begin a search as the host asks."""
    at_load = solve.request[Request.AT_LOAD] > ZERO
    anew = solve.request[Request.ANEW] > ZERO
    rough = solve.request[Request.ROUGH] > ZERO and solve.rules[0].single_rounding > ZERO
    for i in range(search.lane(), search.groups_of(solve), search.width()):
        group = search.RowGroup()
        group.load = solve.loads[i]
        group.level = wp.where(at_load, ZERO, group.load)
        solve.groups[i] = group
    if search.lane() == 0:
        n = search.SearchNumbers()
        if solve.request[Request.RENEWED] > ZERO:
            last = solve.numbers[0]
            n.before = last.before + last.iteration
            n.transforms_before = last.transforms_before + last.transforms
            n.renewals = last.renewals + 1
        n.response = solve.request[Request.RESPONSE]
        n.stiffness = ONE / n.response
        n.longer_stiffness = ONE / solve.request[Request.LONGER_RESPONSE]
        n.at_load = wp.where(at_load, 1, 0)
        n.plain_length = n.stiffness
        n.near_length = ONE
        n.last = -1
        n.few_below = NONE
        solve.numbers[0] = n
        solve.flags[Flag.RENEWS] = 1
        solve.flags[Flag.RENEWS_ROUGHLY] = wp.where(rough, 1, 0)
        solve.flags[Flag.RENEWS_EXACTLY] = wp.where(rough, 0, 1)
        solve.flags[Flag.MOVES] = 0
        solve.flags[Flag.ANEW] = wp.where(anew, 1, 0)
        solve.flags[Flag.SEARCHING] = 1


@wp.kernel(module=TOGETHER)
def measure(solve: Solve):
    """Measure the gap: its mean, its rms height and its lowest point, about 0, then about the mean."""
    n = solve.numbers[0]
    for i in range(search.first_group(solve), search.groups_of(solve), search.stride(solve)):
        lines = search.lines_of(solve, i, 3, 4)
        first = lines[1] / lines[0]
        second = lines[2] / lines[0]
        lowest = -lines[3]
        if search.writes(solve):
            group = solve.groups[i]
            group.mean = group.mean + first
            group.rms = wp.sqrt(wp.max(second - first * first, ZERO))
            group.lowest = lowest
            if n.at_load == 1:
                group.level = group.mean
            group.unit = n.stiffness * (group.mean - lowest)
            solve.groups[i] = group


@wp.func
def begun(rules: search.Rules, group: search.RowGroup, total: wp.float64, between: wp.float64):
    """Begin to balance a group whose trial carries a total without a shift, with so many cells between."""
    group.unit = wp.max(group.unit, wp.where(between > ZERO, total / wp.max(between, ONE), ZERO))
    group.unit = wp.max(group.unit, wp.where(group.load > ZERO, group.load, total) / rules.group_cells)
    group.bracket = bracket_at(ZERO, ONE)
    return group


@wp.func
def balanced(solve: Solve, begins: wp.bool):
    """Judge what the shifted trial carries of each group; tell how many look on, and how many are stuck."""
    n = solve.numbers[0]
    many = solve.groups.shape[0] > 1
    looking = ZERO
    stuck = ZERO
    for i in range(search.first_group(solve), search.groups_of(solve), search.stride(solve)):
        lines = search.lines_of(solve, i, 2, 2)
        total = lines[0]
        between = lines[1]
        group = solve.groups[i]
        if begins:
            group = begun(solve.rules[0], group, total, between)
        if n.at_load == 0:
            group.shift = ZERO
        elif group.bracket.state == LOOKS:
            # Of each of many, so that their sum is well within it.
            allowed = wp.where(many, HALF, ONE) * solve.rules[0].load_tolerance * group.load
            group.bracket = next_trial(group.bracket, total, between * group.unit, group.load, allowed, ZERO)
            group.shift = group.bracket.offset * group.unit
            looking += wp.where(group.bracket.state == LOOKS, ONE, ZERO)
            misses = not (wp.abs(total - group.load) <= solve.rules[0].rough_balance * group.load)
            stuck += wp.where(group.bracket.state == STUCK and misses, ONE, ZERO)
        if search.writes(solve):
            solve.groups[i] = group
    looking = search.over_groups(solve, looking, True)
    stuck = search.over_groups(solve, stuck, True)
    if search.lane() == 0:
        solve.flags[Flag.BALANCING] = wp.where(looking > ZERO and stuck == ZERO, 1, 0)
        if stuck > ZERO:
            solve.numbers[0].status = search.UNBALANCED
            solve.flags[Flag.SEARCHING] = 0


@wp.kernel(module=TOGETHER)
def begin_balance(solve: Solve):
    """Begin to shift the trial of each group until it carries its load."""
    balanced(solve, True)


@wp.kernel(module=TOGETHER)
def balance(solve: Solve):
    """Shift the trial of each group on until it carries its load."""
    balanced(solve, False)


@wp.kernel(module=TOGETHER)
def renew(solve: Solve):
    """Note how far off the gradient may be that was made anew."""
    largest = search.all_lines(solve, 0, 1)
    if search.lane() == 0:
        n = solve.numbers[0]
        n.drift = wp.where(
            solve.flags[Flag.RENEWS_ROUGHLY] == 1, solve.rules[0].single_rounding * largest[0], ZERO
        )
        n.step_drift = ZERO
        n.length = ZERO
        n.whole = 0
        n.moved = 0
        n.transforms = n.transforms + 1
        solve.numbers[0] = n


@wp.func
def level_of(
    group: search.RowGroup,
    between: wp.float64,
    level: wp.float64,
    high: wp.float64,
    low: wp.float64,
    loaded: wp.bool,
):
    """Find the approach of a group [mm]: the mean gap of the cells between the bounds.

    Where there are none, it is the gap of the cell which is next to take load, or to give it.
    """
    if between > ZERO:
        return level / between
    # Where no cell touches, or all that there are carry the hardness, one of the two is missing.
    highest = wp.where(high > -NONE, high, low)
    lowest = wp.where(low < ABSENT, low, highest)
    if loaded:
        return HALF * (highest + lowest)
    return wp.where(group.total < group.load, lowest, highest)


@wp.struct
class Judged:
    """Holds what all groups of a search say of its pressure."""

    between: wp.float64  # cells that are neither open nor capped
    touching: wp.float64  # cells with a pressure
    off_load: wp.float64  # groups that do not carry their load
    off_bounds: wp.float64  # and those that breach the bounds of the gap by more than is allowed
    reach: wp.float64  # largest breach of a group [mm]
    least: wp.float64  # smallest breach, or the smallest that is allowed, whichever is larger [mm]


@wp.func
def judge_groups(solve: Solve, n: search.SearchNumbers):
    """See how far the groups are from their solution, and keep what that says of each."""
    rules = solve.rules[0]
    judged = Judged()
    judged.reach = -NONE
    least_violation = -NONE
    least_allowed = -NONE
    for i in range(search.first_group(solve), search.groups_of(solve), search.stride(solve)):
        lines = search.lines_of(solve, i, 4, 6)
        group = solve.groups[i]
        group.total = lines[0]
        group.touching = lines[1]
        between = lines[2]
        level = lines[3]
        highest = lines[4]
        lowest = -lines[5]
        loaded = n.at_load == 0 or wp.abs(group.total - group.load) <= rules.load_tolerance * group.load
        if n.at_load == 1:
            group.level = level_of(group, between, level, highest, lowest, loaded)
        off = wp.max(highest - group.level, group.level - lowest)
        group.violation = wp.max(off, ZERO)
        yielded = wp.abs(group.level) + n.response * group.total / rules.group_cells
        group.scale = wp.where(group.rms > ZERO, group.rms, yielded)
        allowed = solve.request[Request.TOLERANCE] * group.scale
        group.allowed = wp.max(allowed, rules.rounding * yielded)
        if search.writes(solve):
            solve.groups[i] = group
        judged.between += between
        judged.touching += group.touching
        judged.off_load += wp.where(loaded, ZERO, ONE)
        judged.off_bounds += wp.where(group.violation <= group.allowed, ZERO, ONE)
        judged.reach = wp.max(judged.reach, off)
        least_violation = wp.max(least_violation, -group.violation)
        least_allowed = wp.max(least_allowed, -group.allowed)
    judged.between = search.over_groups(solve, judged.between, True)
    judged.touching = search.over_groups(solve, judged.touching, True)
    judged.off_load = search.over_groups(solve, judged.off_load, True)
    judged.off_bounds = search.over_groups(solve, judged.off_bounds, True)
    judged.reach = search.over_groups(solve, judged.reach, False)
    judged.least = wp.max(
        -search.over_groups(solve, least_violation, False), -search.over_groups(solve, least_allowed, False)
    )
    return judged


@wp.func
def with_status(n: search.SearchNumbers, rules: search.Rules, judged: Judged, drifts: wp.bool):
    """Return the numbers of a search that has ended, or goes on."""
    n.iteration = n.iteration + n.moved
    n.moved = 0
    n.loaded = wp.where(judged.off_load == ZERO, 1, 0)
    if not drifts and n.status == search.RUNS:
        if n.loaded == 1 and judged.off_bounds == ZERO:
            n.status = search.CONVERGED
        elif n.iteration >= rules.iterations:
            n.status = search.LED_NOWHERE
    return n


@wp.func
def with_kind(solve: Solve, n: search.SearchNumbers, judged: Judged):
    """Return the numbers by which the next step goes, of the kind that suits: plain, or of few cells."""
    rules = solve.rules[0]
    capped = judged.between <= rules.elastic_fraction * judged.touching
    patient = n.plain_done < rules.patience or judged.between == ZERO
    n.plain = wp.where(n.plain_left > 0 or (capped and patient), 1, 0)
    n.plain_left = wp.max(n.plain_left - 1, 0)
    n.plain_done = n.plain_done + n.plain
    solve.flags[Flag.PRECONDITIONS] = 1 - n.plain
    few = (n.plain == 1 or capped) and n.loaded == 1 and n.at_load == 1
    if few and judged.between <= wp.float64(rules.few) and judged.reach <= n.few_below and rules.few > 0:
        n.few_below = HALF * judged.reach
        n.near = rules.near * judged.reach
        solve.flags[Flag.MOVES_FEW] = 1
    return n


@wp.kernel(module=TOGETHER)
def judge(solve: Solve):
    """Judge whether the pressure is the solution, and if not of what kind the next step is."""
    n = solve.numbers[0]
    judged = judge_groups(solve, n)
    if search.lane() == 0:
        drifts = n.drift > solve.rules[0].drift * judged.least
        n = with_status(n, solve.rules[0], judged, drifts)
        goes_on = not drifts and n.status == search.RUNS
        solve.flags[Flag.RENEWS] = wp.where(drifts, 1, 0)
        if drifts:
            solve.flags[Flag.RENEWS_ROUGHLY] = 0
            solve.flags[Flag.RENEWS_EXACTLY] = 1
        solve.flags[Flag.MOVES] = wp.where(goes_on, 1, 0)
        solve.flags[Flag.MOVES_FEW] = 0
        solve.flags[Flag.STEPS] = 1
        if goes_on:
            n = with_kind(solve, n, judged)
        solve.flags[Flag.SEARCHING] = wp.where(n.status == search.RUNS, 1, 0)
        solve.numbers[0] = n


@wp.kernel(module=TOGETHER)
def conclude(solve: Solve, proof: Proof):
    """End a search: what has been found is certified, where that is asked for."""
    at_load = solve.numbers[0].at_load == 1
    for i in range(search.lane(), search.groups_of(solve), search.width()):
        group = solve.groups[i]
        proven = Proven()
        proven.level = -NONE
        proven.approach = group.level
        proven.load = wp.where(at_load, group.load, -ONE)
        proven.scale = group.scale
        proven.allowed = group.allowed
        proof.groups[i] = proven
    if search.lane() == 0:
        converged = solve.numbers[0].status == search.CONVERGED
        certified = solve.request[Request.CERTIFIED] > ZERO
        solve.flags[Flag.CERTIFIES] = wp.where(converged and certified, 1, 0)
        solve.flags[Flag.HOLDS] = wp.where(converged, 1, 0)
        solve.flags[Flag.SOLVING] = 0


@wp.kernel(module=TOGETHER)
def accept(solve: Solve, proof: Proof):
    """Search on from a pressure that could not be certified: what the search added up has drifted."""
    rules = solve.rules[0]
    faults = ZERO
    for i in range(search.first_group(proof), search.groups_of(proof), search.stride(proof)):
        group = proof.groups[i]
        off = ZERO
        if group.load >= ZERO:
            off = wp.where(
                group.load > ZERO,
                group.total / wp.where(group.load > ZERO, group.load, ONE) - ONE,
                group.total,
            )
        violation = wp.max(group.highest - group.approach, group.approach - group.lowest)
        holds = group.over <= ZERO and group.under <= ZERO and wp.abs(off) <= rules.certified_load
        holds = holds and violation <= group.allowed and group.gap < NONE
        faults += wp.where(holds, ZERO, ONE)
    faults = search.over_groups(proof, faults, True)
    if search.lane() == 0 and faults > ZERO:
        solve.flags[Flag.HOLDS] = 0
    if search.lane() == 0 and faults > ZERO and solve.numbers[0].renewals < rules.renewals:
        solve.request[Request.ANEW] = ZERO
        solve.request[Request.ROUGH] = ZERO
        solve.request[Request.RENEWED] = ONE
        solve.flags[Flag.SOLVING] = 1
