#pragma once
// A sphere and a disc displaced under it by whole rows.

#include "lanes.h"

// The disc's row under a row of the sphere; 0 <= shift < rows of the disc.
WARPWEAR_FN int under_row(int row, int shift, int rows)
{
    const int displaced = row + shift;
    return displaced < rows ? displaced : displaced - rows;
}

// Numbers of the lanes, added to the index of the first cell.
WARPWEAR_FN Lanes columns_from(int first)
{
#if defined(__CUDA_ARCH__)
    return double(first);
#else
    const Lanes lane = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
    return lane + double(first);
#endif
}

WARPWEAR_FN Lanes larger_of(Lanes a, Lanes b) { return a > b ? a : b; }
WARPWEAR_FN Lanes smaller_of(Lanes a, Lanes b) { return a < b ? a : b; }
