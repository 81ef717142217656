#pragma once
// Materials of a body by worn depth: what a cell has of them as a step begins, and what wears through them.
//
// A depth of which nothing is worn through is K ΔL p as elsewhere, to the last bit.
#include "lanes.h"

// Rows of the numbers of a body's materials, one column each, see `depth_numbers`.
enum { BEGINS, RATIO, RATIO_SLOPE, CAP, CAP_SLOPE, STRENGTH, COEFFICIENT, EXPOSURE };

// Numbers of the materials of a body, none where it is alike at all depths.
struct Materials {
    const double* numbers;
    int count;

    template <typename Table>
    CUDA_CALLABLE explicit Materials(const Table& table)
        : numbers(table.data), count(table.shape[0] > 0 ? table.shape[1] : 0)
    {
    }
    CUDA_CALLABLE double of(int what, int material) const { return numbers[what * count + material]; }
    CUDA_CALLABLE double end_of(int material) const
    { return material + 1 < count ? of(BEGINS, material + 1) : NO_LIMIT; }

    // The material at a depth, 0 of the uppermost.
    CUDA_CALLABLE int at(double depth) const
    {
        int material = 0;
        while (depth >= end_of(material)) ++material;
        return material;
    }

    // A number at depths that changes with them, linear in each material.
    CUDA_CALLABLE Lanes number_at(int what, Lanes depth) const
    {
        Lanes value = of(what, 0) + of(what + 1, 0) * depth;
        for (int m = 1; m < count; ++m) {
            const double begin = of(BEGINS, m), top = of(what, m), slope = of(what + 1, m);
            value = depth >= begin ? top + slope * (depth - begin) : value;
        }
        return value;
    }
};

// log(1 + x) and e^x − 1, exact for small x too.
WARPWEAR_FN double log_beside_one(double x)
{
    const double y = 1.0 + x;
    return y == 1.0 ? x : wp::log(y) * (x / (y - 1.0));
}

WARPWEAR_FN double exp_less_one(double x)
{
    const double y = wp::exp(x), grown = y - 1.0;
    return y == 1.0 ? x : grown == -1.0 ? grown : grown * (x / wp::log(y));
}

// K ΔL p of a material with a ratio of 1 [mm] that wears a depth, and the depth that it wears. ratio: of K
// where the depth begins; slope: its change by depth.
WARPWEAR_FN double needed_for(double depth, double ratio, double slope)
{
    if (ratio <= 0.0) return NO_LIMIT;
    return slope == 0.0 ? depth / ratio : log_beside_one(slope * depth / ratio) / slope;
}

WARPWEAR_FN double worn_by(double exposure, double ratio, double slope)
{ return slope == 0.0 ? ratio * exposure : ratio * (exp_less_one(slope * exposure) / slope); }

// The depth that K ΔL p of the uppermost material [mm] wears off a cell from a depth. What wears through a
// material goes on in the next by what is left.
WARPWEAR_FN double lost_from(const Materials& materials, double depth, double exposure)
{
    double lost = 0.0;
    for (int m = materials.at(depth);; ++m) {
        const double slope = materials.of(RATIO_SLOPE, m), end = materials.end_of(m);
        const double ratio = materials.of(RATIO, m) + slope * (depth - materials.of(BEGINS, m));
        const double needed = end < NO_LIMIT ? needed_for(end - depth, ratio, slope) : NO_LIMIT;
        if (exposure < needed) return lost + worn_by(exposure, ratio, slope);
        lost += end - depth;
        depth = end;
        exposure -= needed;
    }
}

// What cells lose where none of them wears through a material of one K, as nearly always; tells whether so.
WARPWEAR_FN bool lost_within(const Materials& materials, Lanes depth, Lanes exposure, Lanes& lost)
{
    if (materials.count == 0) return false;
    lost = materials.of(RATIO, 0) * exposure;
    Lanes end = materials.end_of(0);
    bool graded = materials.of(RATIO_SLOPE, 0) != 0.0;
    if (!graded && !any(depth + lost >= end)) return true;
    for (int m = 1; m < materials.count; ++m) {
        const Mask here = depth >= Lanes(materials.of(BEGINS, m));
        lost = here ? materials.of(RATIO, m) * exposure : lost;
        end = here ? Lanes(materials.end_of(m)) : end;
        graded = graded || materials.of(RATIO_SLOPE, m) != 0.0;
    }
    return !graded && !any(depth + lost >= end);
}

// The same of cells.
WARPWEAR_FN Lanes lost_from_each(const Materials& materials, Lanes depth, Lanes exposure)
{
    Lanes lost;
    if (LANES > 1 && lost_within(materials, depth, exposure, lost)) return lost;
    return each_lane([&](double d, double e) { return e > 0.0 ? lost_from(materials, d, e) : 0.0; }, depth,
                     exposure);
}
