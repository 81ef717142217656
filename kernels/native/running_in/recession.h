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
