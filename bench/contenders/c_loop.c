/* The passes over the cells of a step, in C. Lengths in mm.
 *
 * Compiled with -fopenmp-simd, which lets the sums be reordered into SIMD registers and nothing else.
 */

#include <math.h>

/* Sum of the overlaps clip((base − g) + offset, 0, deepest), which are pressures times c, and number of cells
 * that are neither open nor capped. Row by row: a worn contact's overlaps are all alike, and one sum of half a
 * million equal numbers rounds off the same way each time, to more than 1e-12 of it. */
void carried(long n, long columns, double base, double offset, double deepest, const double *restrict gap,
             double *restrict sums)
{
    sums[0] = sums[1] = 0.0;
    for (long row = 0; row < n; row += columns) {
        const double *restrict g = gap + row;
        double pressed = 0.0, between = 0.0;
#pragma omp simd reduction(+ : pressed, between)
        for (long i = 0; i < columns; i++) {
            double q = (base - g[i]) + offset;
            double p = q > 0.0 ? q : 0.0;
            pressed += p < deepest ? p : deepest;
            between += (q > 0.0) & (q < deepest) ? 1.0 : 0.0;
        }
        sums[0] += pressed;
        sums[1] += between;
    }
}

/* Number of cells not higher than the approach. */
void count(long n, double approach, const double *restrict gap, double *restrict sums)
{
    double found = 0.0;
#pragma omp simd reduction(+ : found)
    for (long i = 0; i < n; i++)
        found += gap[i] <= approach ? 1.0 : 0.0;
    sums[0] = found;
}

/* Smallest and largest gap. */
void bounds(long n, const double *restrict gap, double *restrict sums)
{
    double low = INFINITY, high = -INFINITY;
#pragma omp simd reduction(min : low) reduction(max : high)
    for (long i = 0; i < n; i++) {
        low = gap[i] < low ? gap[i] : low;
        high = gap[i] > high ? gap[i] : high;
    }
    sums[0] = low;
    sums[1] = high;
}

/* One increment of wear in place, rows of `columns` cells: overlaps up to `deepest` times `counter` and
 * `disc × factor[column]` come off the bodies and open the gap. Sums: cells in contact, wear of the counter, of
 * the disc; what is worn is gap − unworn, of which `share[column]` is the counter's. */
void wear_overlap(long n, long columns, double base, double offset, double deepest, double counter,
                  double disc, const double *restrict factor, const double *restrict share,
                  double *restrict gap, const double *restrict unworn, double *restrict sums)
{
    sums[0] = sums[1] = sums[2] = 0.0;
    for (long row = 0; row < n; row += columns) {
        double contact = 0.0, worn_counter = 0.0, worn = 0.0;
        double *restrict g = gap + row;
        const double *restrict u = unworn + row;
#pragma omp simd reduction(+ : contact, worn_counter, worn)
        for (long i = 0; i < columns; i++) {
            double q = (base - g[i]) + offset;
            double p = q > 0.0 ? q : 0.0;
            p = p < deepest ? p : deepest;
            g[i] += (counter + disc * factor[i]) * p;
            double w = g[i] - u[i];
            contact += q > 0.0 ? 1.0 : 0.0;
            worn_counter += share[i] * w;
            worn += w;
        }
        sums[0] += contact;
        sums[1] += worn_counter;
        sums[2] += worn - worn_counter;
    }
}

/* The same where every cell not higher than the approach carries one pressure. */
void wear_bearing(long n, long columns, double approach, double counter, double disc,
                  const double *restrict factor, const double *restrict share, double *restrict gap,
                  const double *restrict unworn, double *restrict sums)
{
    sums[0] = sums[1] = sums[2] = 0.0;
    for (long row = 0; row < n; row += columns) {
        double contact = 0.0, worn_counter = 0.0, worn = 0.0;
        double *restrict g = gap + row;
        const double *restrict u = unworn + row;
#pragma omp simd reduction(+ : contact, worn_counter, worn)
        for (long i = 0; i < columns; i++) {
            double here = g[i] <= approach ? 1.0 : 0.0;
            g[i] += (counter + disc * factor[i]) * here;
            double w = g[i] - u[i];
            contact += here;
            worn_counter += share[i] * w;
            worn += w;
        }
        sums[0] += contact;
        sums[1] += worn_counter;
        sums[2] += worn - worn_counter;
    }
}
