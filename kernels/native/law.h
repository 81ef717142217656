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

// What slopes are over.
template <typename Real> WARPWEAR_FN Real stiffness_of(Real stiffness) { return stiffness; }

// Cells whose K goes with their pressure p: over that of the step it is linear between knots, and constant
// beyond the last, so that between them the overlap of a cell is a parabola of p, which wear stretches.
// Passes take it in the place of a stiffness.
struct Bend {
    static const int MOST = 16; // knots
    int knots = 0;
    double stiffness;                 // of all cells, where nothing presses
    double from[MOST], length[MOST];  // p at a knot, and up to the next [MPa]
    double k[2][MOST], rise[2][MOST]; // K of counter-body and disc there over that of the step, and its slope
    double overlap[MOST], width[MOST], linear[MOST], square[MOST]; // there, up to the next, and of p beyond

    // knots: rows of p and K. own: compliance that is not wear; counter, disc: what K of the step adds.
    template <typename Knots> CUDA_CALLABLE Bend(const Knots& table, double own, double counter, double disc)
    {
        const double by[2] = {counter, disc};
        stiffness = own + counter + disc > 0.0 ? 1.0 / (own + counter + disc) : NO_LIMIT;
        knots = table.shape[0];
        double at = 0.0;
        for (int j = 0; j < knots; ++j) {
            const bool is_last = j + 1 == knots;
            from[j] = wp::index(table, j, 0);
            length[j] = is_last ? NO_LIMIT : wp::index(table, j + 1, 0) - from[j];
            linear[j] = own;
            square[j] = 0.0;
            for (int body = 0; body < 2; ++body) {
                k[body][j] = wp::index(table, j, body + 1);
                rise[body][j] = is_last ? 0.0 : (wp::index(table, j + 1, body + 1) - k[body][j]) / length[j];
                linear[j] += by[body] * (k[body][j] + rise[body][j] * from[j]);
                square[j] += by[body] * rise[body][j];
            }
            linear[j] = linear[j] > 1.0 / NO_LIMIT ? linear[j] : 1.0 / NO_LIMIT; // where nothing yields
            overlap[j] = at;
            width[j] = is_last ? NO_LIMIT : length[j] * (linear[j] + square[j] * length[j]);
            at += width[j];
        }
    }

    // K of a body at a pressure over that of the step: 0 is the counter-body, 1 the disc.
    template <typename Real> CUDA_CALLABLE Real k_at(int body, Real p) const
    {
        Real sum = k[body][0];
        for (int j = 0; j + 1 < knots; ++j) sum += rise[body][j] * clipped(p - from[j], Real(length[j]));
        return sum;
    }
};

// That of a step.
template <typename Bends> WARPWEAR_FN Bend bend_of(const Bends& bends)
{ return Bend(bends.knots, bends.step.data[0], bends.step.data[1], bends.step.data[2]); }

template <typename Real> WARPWEAR_FN Real on_spring(Real overlap, const Bend& bend)
{
    Real p = 0.0;
    for (int j = 0; j < bend.knots; ++j) {
        const Real beyond = clipped(overlap - bend.overlap[j], Real(bend.width[j]));
        const double b = bend.linear[j];
        p += 2.0 * beyond / (b + root_of(b * b + 4.0 * bend.square[j] * beyond));
    }
    return p;
}

template <typename Real> WARPWEAR_FN Real slope_on_spring(Real overlap, const Bend& bend)
{
    Real slope = 0.0;
    for (int j = 0; j < bend.knots; ++j) {
        const Real beyond = overlap - bend.overlap[j], zero = 0.0;
        const Real root = root_of(bend.linear[j] * bend.linear[j] +
                                  4.0 * bend.square[j] * clipped(beyond, Real(bend.width[j])));
        slope = beyond > zero ? 1.0 / (root * bend.stiffness) : slope;
    }
    return slope;
}

WARPWEAR_FN double stiffness_of(const Bend& bend) { return bend.stiffness; }

template <typename Spring> constexpr bool is_straight = IS_STRAIGHT;
template <> constexpr bool is_straight<Bend> = false;
template <typename Spring> constexpr bool is_straight<const Spring&> = is_straight<Spring>;

// By how much a pressure without bounds may change before the slope of a cell does: until it opens, closes or
// reaches its cap.
template <typename Spring> WARPWEAR_FN Lanes to_bound(Lanes x, Lanes cap, const Spring& spring)
{
    if (!is_straight<Spring>) return 0.0;
    const Lanes open = size_of(x), full = size_of(x - cap);
    return open < full ? open : full;
}

// The pressure of a cell by the law that a search has left: cells tied with the approach, those whose overlap
// is within the width of a tie, share one pressure.
template <typename Law, typename Spring>
WARPWEAR_FN double pressure_by(const Law& law, double gap, const Spring& stiffness)
{
    const double overlap = (law.base - gap) + law.offset;
    if (fabs(overlap) <= law.tie_width) return law.tie_pressure;
    return clipped(on_spring(overlap - law.tie_width, stiffness), law.cap);
}
