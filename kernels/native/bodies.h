#pragma once
// A ball and a disc displaced under it by whole rows.

#include "lanes.h"

// The disc's row under a row of the counter-body; 0 <= shift < rows of the disc.
WARPWEAR_FN int under_row(int row, int shift, int rows)
{
    const int displaced = row + shift;
    return displaced < rows ? displaced : displaced - rows;
}

// The gap of a ball from the mean plane of a roughness. columns: of a line, of which a row may have several.
// Neither near the apex nor of a flat does the height of the ball lose digits.
template <typename Ball, typename Layout, typename Field>
WARPWEAR_FN void gap_under_ball(int slot, int slots, int columns, const Ball& ball, const Layout& layout,
                                const Field& roughness, const Field& gaps)
{
    const int of_line = layout.vectors * OF_VECTOR * LANES, cells = gaps.shape[1] * OF_VECTOR * LANES;
    for (int row = slot; row < gaps.shape[0]; row += slots) {
        const double* const heights = (const double*)row_of(roughness, row);
        double* const gap = (double*)row_of(gaps, row);
        for (int n = lane_of_slot(); n < cells; n += width_of_slot()) {
            const int line = n / of_line, column = n % of_line;
            const double x = ball.x_first + double(wp::index(layout.first_row, row) + line) * ball.cell;
            const double y = ball.y_first + double(wp::index(layout.first_column, row) + column) * ball.cell;
            const double r2 = x * x + y * y, under_root = 1.0 - r2 * ball.curvature * ball.curvature;
            const double sag = r2 * ball.curvature / (1.0 + sqrt(under_root > 0.0 ? under_root : 0.0));
            gap[n] = column < columns ? (under_root > 0.0 ? sag : ABSENT) - heights[n] : ABSENT;
        }
    }
}

// Some cells of a row, as a thread visits them.
struct Span {
    int first, end, stride;
};

// Those of a tile, by the threads of a team.
WARPWEAR_FN Span span_of_tile(int t, int vectors_per_row)
{
    const int end = (t + 1) * OF_TILE;
    return {t * OF_TILE + lane_of_team(), end < vectors_per_row ? end : vectors_per_row, TEAM};
}

// The mean of a field at a cell over `window` rows around its own; of an even number the row at either end
// counts half. At the first and the last row the field is mirrored, so that its sum is kept there too. Over
// as many rows as there are it is that of all.
template <typename Field> WARPWEAR_FN Lanes mean_at(const Field& field, int row, int i, int window)
{
    CONTRACT_FAST
    const int rows = field.shape[0], half = window / 2;
    Lanes sum = 0.0;
    if (window >= rows) {
        for (int other = 0; other < rows; ++other) sum += row_of(field, other)[i];
        return sum / double(rows);
    }
    const double at_ends = window % 2 == 0 ? 0.5 : 1.0;
    for (int other = row - half; other <= row + half; ++other) {
        const int inside = other < 0 ? -1 - other : (other < rows ? other : 2 * rows - 1 - other);
        const double weight = other == row - half || other == row + half ? at_ends : 1.0;
        sum += weight * row_of(field, inside)[i];
    }
    return sum / double(window);
}

// Those of all cells; a mean of all rows is made in the first. Over one row none is made: the field is its
// own.
template <typename Slides, typename Field>
WARPWEAR_FN void mean_along(int slot, int slots, const Slides& slides, const Field& field, const Field& means)
{
    const int window = wp::index(slides, 0).window, cells = field.shape[1] * OF_VECTOR;
    const int width = width_of_slot();
    if (window == 1) return;
    if (window >= field.shape[0])
        for (int i = slot * width + lane_of_slot(); i < cells; i += slots * width)
            row_of(means, 0)[i] = mean_at(field, 0, i, window);
    for (int row = slot; row < field.shape[0] && window < field.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < cells; i += width)
            row_of(means, row)[i] = mean_at(field, row, i, window);
}

// The row of the means that a row of cells sees, see `mean_along`.
template <typename Field>
WARPWEAR_FN Stored* mean_of(const Field& field, const Field& means, int row, int window)
{
    if (window == 1) return row_of(field, row);
    return row_of(means, window < field.shape[0] ? row : 0);
}

// A depth [mm] to divide by where shear wears nothing.
static const double NEARLY_NONE = 1e-200;

// What of a depth [mm] that shear wears all cells lose, at least.
template <typename Slide> WARPWEAR_FN double least_shear(const Slide& slide)
{ return (slide.removal.shear_counter + slide.removal.shear_disc) * slide.removal.least_shear_ratio; }
