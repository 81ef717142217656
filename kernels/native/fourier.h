#pragma once
#include "transforms.h"
// Convolutions of fields on a CPU by the transforms of `transforms.h`. Modes of a grid lie in groups of as
// many columns as lines are transformed together, L: spectrum[group][row], L real parts and L imaginary ones.

#if !defined(__CUDA_ARCH__)

// How many of `length` numbers can be other than zero, by the first stage, if there is one.
WARPWEAR_FN int filled_of(const wp::array_t<int>& radices, int length)
{ return length > 1 && radices.data[0] < 0 ? length / 2 : length; }

// As many cells of a row as lines are together, of which so many are there; the others are zeros.
template <typename Real> WARPWEAR_FN LinesOf<Real> read_cells(const double* cells, int there)
{
    const int lines = VectorOf<Real>::LINES;
    if (there >= lines)
        return __builtin_convertvector(*(const typename VectorOf<Real>::Row*)cells, LinesOf<Real>);
    LinesOf<Real> u = Real(0.0);
    for (int j = 0; j < there; ++j) u[j] = cells[j];
    return u;
}

// The way back; the others stay as they are.
template <typename Real> WARPWEAR_FN void write_cells(double* cells, int there, LinesOf<Real> u)
{
    typedef typename VectorOf<Real>::Row Row;
    if (there >= VectorOf<Real>::LINES)
        *(Row*)cells = __builtin_convertvector(u, Row);
    else
        for (int j = 0; j < there; ++j) cells[j] = u[j];
}

// Rows of cells, from the first of a batch on, as complex numbers x of their pairs of cells, or of cells.
template <typename Real, bool PAIRS>
WARPWEAR_FN void take_rows(const double* cells, int rows, int stride, int ny, int filled, Real* x)
{
    typedef VectorOf<Real> Vector;
    typedef LinesOf<Real> Lines;
    const int lines = Vector::LINES;
    for (int k = 0; k < filled; k += lines) {
        Lines a[lines], b[lines];
        for (int i = 0; i < lines; ++i) {
            const int first = PAIRS ? 2 * k : k, there = i < rows ? ny - first : 0;
            const double* const line = cells + (size_t)i * stride + first;
            const Lines u = read_cells<Real>(line, there);
            const Lines v = PAIRS ? read_cells<Real>(line + lines, there - lines) : Lines(Real(0.0));
            a[i] = PAIRS ? Vector::evens(u, v) : u;
            b[i] = PAIRS ? Vector::odds(u, v) : v;
        }
        transpose<Real>(a);
        if (PAIRS) transpose<Real>(b);
        for (int i = 0; i < lines && k + i < filled; ++i) {
            lines_at(x + 2 * lines * (k + i)) = a[i];
            lines_at(x + 2 * lines * (k + i) + lines) = b[i];
        }
    }
}

// The way back, of n complex numbers.
template <typename Real, bool PAIRS>
WARPWEAR_FN void give_rows(Real* x, int n, double* cells, int rows, int stride, int ny)
{
    typedef VectorOf<Real> Vector;
    typedef LinesOf<Real> Lines;
    const int lines = Vector::LINES, of_number = PAIRS ? 2 : 1;
    for (int k = 0; k < n && of_number * k < ny; k += lines) {
        Lines a[lines], b[lines];
        for (int i = 0; i < lines; ++i) {
            const int j = k + i < n ? k + i : n - 1;
            a[i] = lines_at(x + 2 * lines * j);
            b[i] = lines_at(x + 2 * lines * j + lines);
        }
        transpose<Real>(a);
        if (PAIRS) transpose<Real>(b);
        for (int i = 0; i < rows; ++i) {
            const int first = of_number * k;
            double* const line = cells + (size_t)i * stride + first;
            write_cells<Real>(line, ny - first, PAIRS ? Vector::first_in_turn(a[i], b[i]) : a[i]);
            if (PAIRS) write_cells<Real>(line + lines, ny - first - lines, Vector::last_in_turn(a[i], b[i]));
        }
    }
}

// Modes 0 … n of 2n real numbers, twice as large, from those of n complex ones, in the order of the
// transform. partners: place of mode n − k, by that of k. turns: cosine and sine of π k/n, negated.
template <typename Real> WARPWEAR_FN void part(const wp::array_t<int>& partners, const Real* turns, Real* x)
{
    typedef LinesOf<Real> Lines;
    const int lines = VectorOf<Real>::LINES, n = partners.shape[0];
    const Lines a0 = lines_at(x), b0 = lines_at(x + lines);
    for (int k = 1; k < n; ++k) {
        const int l = partners.data[k];
        if (l < k) continue;
        Real *const y = x + 2 * lines * k, *const z = x + 2 * lines * l;
        const Real c = turns[2 * k], s = turns[2 * k + 1];
        const Lines a = lines_at(y), b = lines_at(y + lines), e = lines_at(z), f = lines_at(z + lines);
        const Lines p = a + e, q = b - f, u = b + f, v = e - a;
        const Lines g = u * c - v * s, h = u * s + v * c;
        lines_at(y) = p + g, lines_at(y + lines) = q + h;
        if (l > k) lines_at(z) = p - g, lines_at(z + lines) = h - q;
    }
    lines_at(x) = Real(2.0) * (a0 + b0), lines_at(x + lines) = Lines(Real(0.0));
    lines_at(x + 2 * lines * n) = Real(2.0) * (a0 - b0);
    lines_at(x + 2 * lines * n + lines) = Lines(Real(0.0));
}

// The way back: modes of n complex numbers from those of 2n real ones.
template <typename Real> WARPWEAR_FN void join(const wp::array_t<int>& partners, const Real* turns, Real* x)
{
    typedef LinesOf<Real> Lines;
    const int lines = VectorOf<Real>::LINES, n = partners.shape[0];
    const Lines a0 = lines_at(x), an = lines_at(x + 2 * lines * n);
    for (int k = 1; k < n; ++k) {
        const int l = partners.data[k];
        if (l < k) continue;
        Real *const y = x + 2 * lines * k, *const z = x + 2 * lines * l;
        const Real c = turns[2 * k], s = -turns[2 * k + 1];
        const Lines a = lines_at(y), b = lines_at(y + lines), e = lines_at(z), f = lines_at(z + lines);
        const Lines p = a + e, q = b - f, g = a - e, h = b + f;
        const Lines u = g * c - h * s, v = g * s + h * c;
        lines_at(y) = p - v, lines_at(y + lines) = q + u;
        if (l > k) lines_at(z) = p + v, lines_at(z + lines) = u - q;
    }
    lines_at(x) = a0 + an, lines_at(x + lines) = a0 - an;
}

// Numbers of as many modes as lines are together, from x to the groups of the spectrum or the way back.
template <typename Real, bool BACK>
WARPWEAR_FN void between(Real* x, int groups, Real* spectrum, int nx, int first, int rows)
{
    const int lines = VectorOf<Real>::LINES, pair = 2 * lines;
    for (int g = 0; g < groups; ++g) {
        LinesOf<Real> a[lines], b[lines];
        Real *const place = spectrum + pair * ((size_t)g * nx + first), *const y = x + pair * lines * g;
        Real *const from = BACK ? place : y, *const to = BACK ? y : place;
        for (int i = 0; i < lines; ++i) {
            const bool is_there = !BACK || i < rows;
            a[i] = is_there ? lines_at(from + pair * i) : LinesOf<Real>(Real(0.0));
            b[i] = is_there ? lines_at(from + pair * i + lines) : LinesOf<Real>(Real(0.0));
        }
        transpose<Real>(a);
        transpose<Real>(b);
        for (int i = 0; i < (BACK ? lines : rows); ++i) {
            lines_at(to + pair * i) = a[i];
            lines_at(to + pair * i + lines) = b[i];
        }
    }
}

// Modes of the rows of a batch of a grid. x: memory to work in.
template <typename Real, typename Plan>
WARPWEAR_FN void forward_batch(const Plan& plan, const Real* turns, const double* grid, int batch, Real* x,
                               Real* spectrum)
{
    const int lines = VectorOf<Real>::LINES, n = plan.partners.shape[0], first = lines * batch;
    const int rows = plan.rows - first < lines ? plan.rows - first : lines;
    const int filled = filled_of(plan.along, n);
    const double* const cells = grid + (size_t)first * plan.stride;
    told(!plan.is_odd, [&](auto pairs) {
        take_rows<Real, decltype(pairs)::value>(cells, rows, plan.stride, plan.columns, filled, x);
    });
    transform<Real, false>(plan.along, x, n, turns + 2 * n);
    if (!plan.is_odd) part(plan.partners, turns, x);
    for (int k = 2 * lines * (plan.is_odd ? n : n + 1); k < 2 * lines * lines * plan.groups; k += lines)
        lines_at(x + k) = LinesOf<Real>(Real(0.0));
    between<Real, false>(x, plan.groups, spectrum, plan.rows, first, rows);
}

// Cells of the rows of a batch from their modes.
template <typename Real, typename Plan>
WARPWEAR_FN void back_batch(const Plan& plan, const Real* turns, Real* spectrum, int batch, Real* x,
                            double* grid)
{
    const int lines = VectorOf<Real>::LINES, n = plan.partners.shape[0], first = lines * batch;
    const int rows = plan.rows - first < lines ? plan.rows - first : lines;
    between<Real, true>(x, plan.groups, spectrum, plan.rows, first, rows);
    if (!plan.is_odd) join(plan.partners, turns, x);
    transform<Real, true>(plan.along, x, n, turns + 2 * n);
    double* const cells = grid + (size_t)first * plan.stride;
    told(!plan.is_odd, [&](auto pairs) {
        give_rows<Real, decltype(pairs)::value>(x, n, cells, rows, plan.stride, plan.columns);
    });
}

// Modes of a group of columns, in place, or in the scratch memory where these have more rows than cells.
template <typename Real, typename Plan>
WARPWEAR_FN Real* columns_forward(const Plan& plan, const Real* turns, Real* place, Real* scratch)
{
    const int lines = VectorOf<Real>::LINES, n = plan.folded.shape[0], nx = plan.rows;
    Real* const x = n == nx ? place : scratch;
    if (n > nx) {
        __builtin_memcpy(x, place, sizeof(Real) * 2 * lines * nx);
        const int filled = filled_of(plan.across, n);
        __builtin_memset(x + 2 * lines * nx, 0, sizeof(Real) * 2 * lines * (filled - nx));
    }
    transform<Real, false>(plan.across, x, n, turns + plan.turns_across);
    return x;
}

// The way back.
template <typename Real, typename Plan>
WARPWEAR_FN void columns_back(const Plan& plan, const Real* turns, Real* x, Real* place)
{
    const int n = plan.folded.shape[0];
    transform<Real, true>(plan.across, x, n, turns + plan.turns_across);
    if (n > plan.rows) __builtin_memcpy(place, x, sizeof(Real) * 2 * VectorOf<Real>::LINES * plan.rows);
}

// Multiply, or divide, the modes of a group of columns by the table and the line of each row, in place; where
// that is 0, a division makes 0. The table is even: mode k of the rows is that of `folded`.
template <typename Real, typename Plan>
WARPWEAR_FN void across_group(const Plan& plan, const Real* turns, const Real* table, const double* line,
                              Real* place, Real* scratch)
{
    typedef LinesOf<Real> Lines;
    const int lines = VectorOf<Real>::LINES, n = plan.folded.shape[0];
    const Real scale = plan.scale;
    const bool divides = plan.divides;
    Real* const x = columns_forward(plan, turns, place, scratch);
    for (int k = 0; k < n; ++k) {
        const int mode = plan.folded.data[k];
        const Lines response = lines_at(const_cast<Real*>(table) + lines * mode) + Real(line[mode]);
        Lines factor = scale * response;
        if (divides) factor = response > Real(0.0) ? scale / response : Lines(Real(0.0));
        lines_at(x + 2 * lines * k) *= factor;
        lines_at(x + 2 * lines * k + lines) *= factor;
    }
    columns_back(plan, turns, x, place);
}

// Multiply the modes of a group of columns of two fields by a symmetric matrix of tables, in place. The one
// off the diagonal is odd in both directions: beyond the middle of the rows its sign is the other one.
template <typename Real, typename Plan>
WARPWEAR_FN void across_both(const Plan& plan, const Real* turns, const Real* const (&tables)[3],
                             const double* signs, Real* first, Real* second, Real* scratch)
{
    typedef LinesOf<Real> Lines;
    const int lines = VectorOf<Real>::LINES, n = plan.folded.shape[0];
    const Real scale = plan.scale;
    Real* const x = columns_forward(plan, turns, first, scratch);
    Real* const y = columns_forward(plan, turns, second, scratch + 2 * lines * n);
    for (int k = 0; k < n; ++k) {
        const int at = lines * plan.folded.data[k];
        const Lines xx = scale * lines_at(const_cast<Real*>(tables[0]) + at);
        const Lines xy = (scale * Real(signs[k])) * lines_at(const_cast<Real*>(tables[1]) + at);
        const Lines yy = scale * lines_at(const_cast<Real*>(tables[2]) + at);
        for (int i = 2 * lines * k; i < 2 * lines * (k + 1); i += lines) {
            const Lines a = lines_at(x + i), b = lines_at(y + i);
            lines_at(x + i) = xx * a + xy * b;
            lines_at(y + i) = xy * a + yy * b;
        }
    }
    columns_back(plan, turns, x, first);
    columns_back(plan, turns, y, second);
}

// The part of `count` things that a slot does, from first_of(slot) to first_of(slot + 1).
WARPWEAR_FN int first_of(int slot, int slots, int count) { return (int)((long long)count * slot / slots); }

template <typename Plan> WARPWEAR_FN int batches_of(const Plan& plan, int lines)
{ return (plan.rows + lines - 1) / lines; }
#endif

// Modes of the rows of a grid, or the way back. A slot has a row of the scratch memory, and takes its part of
// the batches.
template <bool BACK, typename Real, typename Plan, typename Field>
WARPWEAR_FN void transform_rows(int slot, int slots, const Plan& plan, const wp::array_t<Real>& turns,
                                const Field& field, wp::array_t<Real>& scratch, wp::array_t<Real>& spectrum)
{
#if !defined(__CUDA_ARCH__)
    const int batches = batches_of(plan, VectorOf<Real>::LINES);
    Real* const x = &wp::index(scratch, slot, 0);
    for (int n = first_of(slot, slots, batches); n < first_of(slot + 1, slots, batches); ++n)
        if (BACK)
            back_batch(plan, turns.data, spectrum.data, n, x, (double*)field.data);
        else
            forward_batch(plan, turns.data, (const double*)field.data, n, x, spectrum.data);
#endif
}

// Transform the columns of modes, multiply them and transform them back.
template <typename Real, typename Plan>
WARPWEAR_FN void across_columns(int slot, int slots, const Plan& plan, const wp::array_t<Real>& turns,
                                const wp::array_t<Real>& table, const wp::array_t<double>& line,
                                wp::array_t<Real>& scratch, wp::array_t<Real>& spectrum)
{
#if !defined(__CUDA_ARCH__)
    const int groups = plan.groups;
    for (int g = first_of(slot, slots, groups); g < first_of(slot + 1, slots, groups); ++g)
        across_group(plan, turns.data, &wp::index(table, g, 0, 0), line.data, &wp::index(spectrum, g, 0, 0),
                     &wp::index(scratch, slot, 0));
#endif
}

// The same of the columns of two fields together, whose modes lie one after another, by a matrix of tables.
template <typename Real, typename Plan>
WARPWEAR_FN void across_pairs(int slot, int slots, const Plan& plan, const wp::array_t<Real>& turns,
                              const wp::array_t<Real>& table, const wp::array_t<double>& signs,
                              wp::array_t<Real>& scratch, wp::array_t<Real>& spectrum)
{
#if !defined(__CUDA_ARCH__)
    const int groups = plan.groups;
    for (int g = first_of(slot, slots, groups); g < first_of(slot + 1, slots, groups); ++g) {
        const Real* const tables[] = {&wp::index(table, 0, g, 0, 0), &wp::index(table, 1, g, 0, 0),
                                      &wp::index(table, 2, g, 0, 0)};
        across_both(plan, turns.data, tables, signs.data, &wp::index(spectrum, g, 0, 0),
                    &wp::index(spectrum, groups + g, 0, 0), &wp::index(scratch, slot, 0));
    }
#endif
}

// Convolve grids that lie one after another, each while it is in the cache: those that are visited, of which
// a slot takes every one of `slots`. A slot has a row of the scratch memory and a grid's groups of the modes.
template <typename Real, typename Plan, typename Field>
WARPWEAR_FN void convolve_grids(int slot, int slots, const Plan& plan, const wp::array_t<Real>& turns,
                                const wp::array_t<Real>& table, const wp::array_t<double>& line,
                                const Field& field_in, wp::array_t<Real>& scratch,
                                wp::array_t<Real>& spectrum, Field& field_out)
{
#if !defined(__CUDA_ARCH__)
    const int batches = batches_of(plan, VectorOf<Real>::LINES);
    const size_t of_grid = (size_t)plan.rows * plan.stride;
    Real *const x = &wp::index(scratch, slot, 0), *const modes =
                                                      &wp::index(spectrum, slot * plan.groups, 0, 0);
    for (int grid = slot; grid < plan.visited.data[0]; grid += slots) {
        const double* const cells = (const double*)field_in.data + of_grid * grid;
        for (int n = 0; n < batches; ++n) forward_batch(plan, turns.data, cells, n, x, modes);
        for (int g = 0; g < plan.groups; ++g)
            across_group(plan, turns.data, &wp::index(table, g, 0, 0), line.data,
                         modes + 2 * VectorOf<Real>::LINES * (size_t)g * plan.rows, x);
        for (int n = 0; n < batches; ++n)
            back_batch(plan, turns.data, modes, n, x, (double*)field_out.data + of_grid * grid);
    }
#endif
}

// What stands around transforms of a library: cells of grids go into padded ones, whose padding stays zero,
// or back.
template <bool BACK, typename Grids, typename Field, typename Real>
WARPWEAR_FN void pad_rows(int slot, int slots, const Grids& grids, const Field& field,
                          wp::array_t<Real>& padded)
{
    for (int row = slot; row < grids.visited.data[0] * grids.rows; row += slots) {
        double* const cells = (double*)field.data + (size_t)row * grids.stride;
        Real* const there = &wp::index(padded, row / grids.rows, row % grids.rows, 0);
        for (int j = lane_of_slot(); j < grids.columns; j += width_of_slot())
            if (BACK)
                cells[j] = there[j];
            else
                there[j] = cells[j];
    }
}

// Multiply, or divide, modes by the table and the line of their row. Each is two numbers, one after another.
template <typename Grids, typename Real>
WARPWEAR_FN void multiply_modes(int slot, int slots, const Grids& grids, const wp::array_t<double>& table,
                                const wp::array_t<double>& line, wp::array_t<Real>& modes)
{
    const int n = modes.shape[1];
    for (int row = slot; row < grids.visited.data[0] * n; row += slots) {
        const int k = row % n, mode = k < n - k ? k : n - k;
        Real* const numbers = &wp::index(modes, row / n, k, 0);
        const double* const responses = &wp::index(table, mode, 0);
        for (int j = lane_of_slot(); j < modes.shape[2]; j += width_of_slot()) {
            const double response = responses[j / 2] + line.data[mode];
            const double divided = response > 0.0 ? grids.scale / response : 0.0;
            numbers[j] *= Real(grids.divides ? divided : grids.scale * response);
        }
    }
}

// Multiply modes of two grids, one after the other, by a symmetric matrix of tables, in place. The one off
// the diagonal is odd in both directions.
template <typename Grids, typename Real>
WARPWEAR_FN void multiply_pairs(int slot, int slots, const Grids& grids, const wp::array_t<double>& table,
                                wp::array_t<Real>& modes)
{
    const int n = modes.shape[1];
    for (int row = slot; row < n; row += slots) {
        const int mode = row < n - row ? row : n - row;
        const double sign = row > n - row ? -grids.scale : grids.scale;
        Real *const x = &wp::index(modes, 0, row, 0), *const y = &wp::index(modes, 1, row, 0);
        for (int j = lane_of_slot(); j < modes.shape[2]; j += width_of_slot()) {
            const double a = x[j], b = y[j], xy = sign * wp::index(table, 1, mode, j / 2);
            x[j] = Real(grids.scale * wp::index(table, 0, mode, j / 2) * a + xy * b);
            y[j] = Real(xy * a + grids.scale * wp::index(table, 2, mode, j / 2) * b);
        }
    }
}
