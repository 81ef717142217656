"""An approach that steps move is foreseen: on the line through the last two rates at which it grew.

A rate is over what a unit of pressure removes, so it is the mean pressure where wear alone moves a contact.
"""

import warp as wp

from warpwear.kernels.cells import ZERO
from warpwear.kernels.newton import HALF

wp.set_module_options({"enable_backward": False})


@wp.struct
class Trend:
    """Tells where an approach is, and how it has grown with what steps removed."""

    is_begun: wp.int32  # 0 before the first step
    approach: wp.float64  # of the last step [mm]
    slid: wp.float64  # Σ K ΔL of both bodies [mm³/N]
    rates: wp.int32  # that are known, 2 at most: where [mm³/N], and which [MPa], the earlier one first
    where_0: wp.float64
    rate_0: wp.float64
    where_1: wp.float64
    rate_1: wp.float64


@wp.func
def foreseen_step(t: Trend, removal: wp.float64):
    """Return how far a step goes on [mm] that removes K ΔL [mm³/N]; 0 where no rate is known."""
    rate = t.rate_0
    if t.rates == 2:  # Lagrange's line
        where = t.slid + HALF * removal
        rate = t.rate_0 * ((where - t.where_1) / (t.where_0 - t.where_1))
        rate = rate + t.rate_1 * ((where - t.where_0) / (t.where_1 - t.where_0))
    return removal * rate


@wp.func
def learnt(t: Trend, approach: wp.float64, removal: wp.float64):
    """Return what is known after a step that ended at an approach [mm], and removed K ΔL [mm³/N]."""
    where = t.slid + HALF * removal
    last = wp.where(t.rates == 2, t.where_1, t.where_0)
    # A law that decays ends with steps too small to be told apart by where they are.
    if t.is_begun == 1 and removal > ZERO and (t.rates == 0 or where > last):
        rate = (approach - t.approach) / removal
        if t.rates == 2:
            t.where_0 = t.where_1
            t.rate_0 = t.rate_1
        if t.rates == 0:
            t.where_0 = where
            t.rate_0 = rate
        else:
            t.where_1 = where
            t.rate_1 = rate
        t.rates = wp.min(t.rates + 1, 2)
    t.is_begun = 1
    t.approach = approach
    t.slid = t.slid + removal
    return t
