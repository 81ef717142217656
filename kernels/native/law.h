#pragma once
// The law of a cell on a spring: what it carries at an overlap, whatever its neighbours do.
//
// p = on_spring(overlap, stiffness) between 0 and the cap. Every pass over cells on springs goes by these
// functions, for eight cells, for one, and for plain numbers. A term of the law is changed here and nowhere
// else: in the pressure, in its slope, and, where it bends, in IS_STRAIGHT.
#include "lanes.h"

// x between 0 and the cap.
template <typename Real> WARPWEAR_FN Real clipped(Real x, Real cap)
{
    const Real zero = 0.0;
    x = x > zero ? x : zero;
    return x < cap ? x : cap;
}

// The pressure of a cell without bounds: 0 or less where there is no overlap.
template <typename Real> WARPWEAR_FN Real on_spring(Real overlap, Real stiffness)
{ return overlap * stiffness; }

// Its slope with the overlap, over the stiffness of the cell.
template <typename Real> WARPWEAR_FN Real slope_on_spring(Real, Real) { return 1.0; }

// Whether the slope is the same at every overlap: then a step of Newton's method that meets no bound is
// exact.
static const bool IS_STRAIGHT = true;

// By how much a pressure without bounds may change before the slope of a cell does: until it opens, closes or
// reaches its cap.
WARPWEAR_FN Lanes to_bound(Lanes x, Lanes cap)
{
    if (!IS_STRAIGHT) return 0.0;
    const Lanes open = size_of(x), full = size_of(x - cap);
    return open < full ? open : full;
}

// The pressure of a cell by the law that a search has left: cells tied with the approach, those whose overlap
// is within the width of a tie, share one pressure.
template <typename Law> WARPWEAR_FN double pressure_by(const Law& law, double gap, double stiffness)
{
    const double overlap = (law.base - gap) + law.offset;
    if (fabs(overlap) <= law.tie_width) return law.tie_pressure;
    return clipped(on_spring(overlap - law.tie_width, stiffness), law.cap);
}
