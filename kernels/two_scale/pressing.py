"""Patches carry what a smooth contact prescribes: it has a balance, and every patch a search."""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import ONE, ZERO
from warpwear.kernels.native_code import lane, sum_of, width
from warpwear.kernels.newton import HALF, LOOKS, MET, STUCK, Bracket, bracket_at, next_trial
from warpwear.kernels.two_scale.curves import PRESSURE, SLOPE, Curves, wait_for_slot
from warpwear.kernels.two_scale.sharing import Flags, SharedLoad, SharingSearch, set_flags
from warpwear.kernels.two_scale.steps import Steps, first_guess, flexibility_of, guess_of, next_step

wp.set_module_options(native_code.options("patches.h"))

#: Searches of a patch, each from a base nearer the solution.
ROUNDS = wp.constant(wp.int32(3))
#: Of the tolerance, that each patch may be off by, so that their sum is well within it.
PART = HALF


@wp.struct
class Smooth:
    """Smooth bodies are a Winkler foundation on the macro cells, with their own wear."""

    initial: wp.array(dtype=wp.float64)  # gap before any wear [mm]
    worn: wp.array(dtype=wp.float64)  # by both bodies [mm]
    approach: wp.array(dtype=wp.float64)  # one number [mm]
    balanced: wp.array(dtype=wp.int32)  # one number: whether its search has ended well
    left: wp.array(dtype=wp.float64)  # one number: carried − load where it has not [N]
    target: wp.array2d(dtype=wp.float64)  # one line: the pressures [MPa]
    room: wp.array2d(dtype=wp.float64)  # where numbers lie that are added up


@wp.func_native("return removal_of(removal, pressure);")
def _removal_of(removal: wp.float64, pressure: wp.float64) -> wp.float64: ...


@wp.func
def smooth_pressure(smooth: Smooth, k: wp.int32, base: wp.float64, offset: wp.float64, stiffness: wp.float64):
    """Return the pressure of a macro cell without its cap [MPa]."""
    return ((base - (smooth.initial[k] + smooth.worn[k])) + offset) * stiffness


@wp.func
def prescribe(smooth: Smooth, load: SharedLoad, flexibility: wp.float64, removal: wp.float64):
    """Solve the smooth contact, leave its pressures, and wear it by removal [mm³/N] times them, implicitly.

    The pressures add up to the load to rounding: what the search leaves is taken off those below the
    hardness. flexibility: 1/K_N [mm³/N].
    """
    count = smooth.initial.shape[0]
    base = smooth.approach[0]
    stiffness = ONE / (flexibility + removal)
    step = load.load / (load.area * stiffness * wp.float64(count))
    b = bracket_at(step, step)
    force = ZERO + ZERO  # a variable of its own
    while b.state == LOOKS:
        for k in range(lane(), count, width()):
            q = smooth_pressure(smooth, k, base, b.offset, stiffness)
            smooth.room[0, k] = wp.min(wp.max(q, ZERO), load.hardness)
            smooth.room[1, k] = wp.where(q > ZERO and q < load.hardness, ONE, ZERO)
        force = load.area * sum_of(smooth.room, 0)
        slope = load.area * stiffness * sum_of(smooth.room, 1)
        b = next_trial(b, force, slope, load.load, load.tolerance * load.load, ZERO)
    for k in range(lane(), count, width()):
        q = smooth_pressure(smooth, k, base, b.offset, stiffness)
        p = wp.min(wp.max(q, ZERO), load.hardness)
        smooth.target[0, k] = p
        smooth.room[1, k] = wp.where(p > ZERO and p < load.hardness, p, ZERO)
    total = sum_of(smooth.target, 0)
    between = sum_of(smooth.room, 1)
    scale = ONE - (total - load.load / load.area) / wp.where(between > ZERO, between, ONE)
    for k in range(lane(), count, width()):
        p = smooth.target[0, k]
        if p > ZERO and p < load.hardness:
            p = wp.min(p * scale, load.hardness)
            smooth.target[0, k] = p
        smooth.worn[k] = smooth.worn[k] + _removal_of(removal, p)
    if lane() == 0:
        smooth.approach[0] = base + b.offset
        smooth.balanced[0] = wp.where(b.state == MET, 1, 0)
        smooth.left[0] = force - load.load
    return base + b.offset


@wp.kernel
def press_smoothly(smooth: Smooth, load: SharedLoad, step: wp.array(dtype=wp.float64)):
    """Prescribe the loads of a step by itself. step: 1/K_N, and K ΔL of both bodies [mm³/N]."""
    prescribe(smooth, load, step[0], step[1])


@wp.kernel
def begin(steps: Steps, curves: Curves, smooth: Smooth, brackets: wp.array(dtype=Bracket)):
    """Begin a step whose loads a smooth contact prescribes: a search of every patch."""
    trend = steps.memory[0].trend
    now = next_step(steps)
    s = SharingSearch()
    s.common_base = prescribe(smooth, steps.load, flexibility_of(steps, now), now.removal)
    for k in range(lane(), curves.base.shape[0], width()):
        is_pressed = smooth.target[0, k] > ZERO
        touched = is_pressed and trend.is_begun == 1 and curves.answer[PRESSURE, k] > ZERO
        curves.base[k] = wp.where(touched, curves.base[k] + curves.offset[k], curves.lowest[k])
        beyond = wp.where(is_pressed, first_guess(steps, now), ZERO)
        curves.offset[k] = wp.where(touched, guess_of(trend, now), beyond)
        brackets[k] = bracket_at(curves.offset[k], wp.abs(curves.offset[k]))
    wait_for_slot()
    if lane() == 0:
        steps.now[0] = now
        steps.search[0] = s
        set_flags(steps.flags, wp.where(smooth.balanced[0] == 1, LOOKS, STUCK))


@wp.kernel
def judge(
    load: SharedLoad,
    curves: Curves,
    smooth: Smooth,
    brackets: wp.array(dtype=Bracket),
    search_out: wp.array(dtype=SharingSearch),
    flags: Flags,
):
    """Decide after an evaluation which patches carry what is prescribed, and where to look for the others."""
    s = search_out[0]
    s.evaluations += 1
    count = curves.base.shape[0]
    for k in range(lane(), count, width()):
        b = brackets[k]
        target = smooth.target[0, k]
        if b.state == LOOKS:
            p = curves.answer[PRESSURE, k]
            b = next_trial(b, p, curves.answer[SLOPE, k], target, PART * load.tolerance * target, ZERO)
            brackets[k] = b
            curves.offset[k] = b.offset
        curves.room[0, k] = wp.where(b.state == LOOKS, ONE, ZERO)
        curves.room[1, k] = wp.where(b.state == MET, ZERO, ONE)
    looking = sum_of(curves.room, 0)
    unmet = sum_of(curves.room, 1)
    s.residual = load.area * sum_of(curves.answer, PRESSURE) - load.load
    spent = s.evaluations >= load.evaluations
    state = LOOKS
    if looking == ZERO or spent:
        s.number += 1
        if unmet == ZERO:
            state = MET
        elif s.number >= ROUNDS or spent:
            state = STUCK
        else:
            for k in range(lane(), count, width()):
                if brackets[k].state != MET:  # from a base at the solution the offset has digits again
                    curves.base[k] = curves.base[k] + curves.offset[k]
                    curves.offset[k] = ZERO
                    brackets[k] = bracket_at(curves.offset[k], wp.abs(curves.offset[k]))
    if lane() == 0:
        search_out[0] = s
        set_flags(flags, state)
