#pragma once
// A rough surface that the grid does not resolve recedes faster than its volume goes: see `recession.py`.

#include "lanes.h"

// Beyond this many scales the rest of the curve is a straight line to rounding, and an exponential may
// overflow.
static const double STRAIGHT = 60.0;

// How much deeper a surface stands than its mean worn depth, z(v) − v.
template <typename Curve> WARPWEAR_FN double depth_beyond(double volume, const Curve& curve)
{
    const double q = wp::exp(-curve.middle / curve.scale);
    const double worn = wp::min(volume / curve.scale, STRAIGHT);
    const double bent = curve.middle + curve.scale * wp::log(q + (1.0 + q) * (wp::exp(worn) - 1.0)) - volume;
    const double straight = curve.middle + curve.scale * wp::log(1.0 + q);
    return volume > curve.scale * STRAIGHT ? straight : bent;
}

// The fraction φ of the area that bears where a mean depth was worn off.
template <typename Curve> WARPWEAR_FN double bearing_ratio(double volume, const Curve& curve)
{
    const double z = volume + depth_beyond(volume, curve);
    return 1.0 / (1.0 + wp::exp(-(z - curve.middle) / curve.scale));
}

// Lower the disc by what it stands deeper than its mean worn depth, and note that.
template <typename Curve, typename Field>
WARPWEAR_FN void recede(int slot, int slots, const Curve& curve, const Field& wear_disc, const Field& disc,
                        const Field& beyond)
{
    for (int row = slot; row < disc.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < disc.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes v = row_of(wear_disc, row)[i];
            const Lanes now = each_lane([&](double volume) { return depth_beyond(volume, curve); }, v);
            Stored &height = row_of(disc, row)[i], &before = row_of(beyond, row)[i];
            height = height - (now - before);
            before = now;
        }
}

// Sum the fractions φ of the cells in contact.
template <typename Laws, typename Curve, typename Field, typename Table>
WARPWEAR_FN void borne(int slot, int slots, const Laws& laws, const Curve& curve, const Field& counter,
                       const Field& disc, const Field& wear_disc, Table& sums)
{
    const auto& law = wp::index(laws, 0);
    double bears = 0.0;
    for (int row = slot; row < counter.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < counter.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes gap = row_of(counter, row)[i] - row_of(disc, row)[i], v = row_of(wear_disc, row)[i];
            const Mask touches = (law.base - gap) + law.offset > Lanes(0.0);
            for (int j = 0; j < LANES; ++j)
                if (lane_of(touches, j)) bears += bearing_ratio(((const double*)&v)[j], curve);
        }
    store_sum(sums, 0, slot, bears);
}
