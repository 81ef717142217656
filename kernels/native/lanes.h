#pragma once
// What all native functions share: cells in vectors, slots of a pass, and where their sums go.
//
// A pass over cells is written once for both devices. On a CPU a slot is one thread, and `Lanes` are the
// eight cells of a stored vector; on a GPU a slot is a block of threads, and `Lanes` are one cell. Rows of a
// field are shared among slots: slot, slot + slots, ... (on a CPU there are as many slots as rows).

#define WARPWEAR_FN static inline CUDA_CALLABLE

#if defined(__CUDA_ARCH__)
typedef double Lanes;
typedef double Stored;
typedef float SingleLanes;
typedef float StoredSingle;
typedef int Counts; // of one thread
#define CONTRACT_FAST
#define CONTRACT_OFF
#define EACH_SLOT const int slot = first;
#define OF_SLOT __shared__
#else
typedef double Lanes __attribute__((ext_vector_type(8)));
typedef double Stored __attribute__((ext_vector_type(8), aligned(8)));
typedef float SingleLanes __attribute__((ext_vector_type(8)));
typedef float StoredSingle __attribute__((ext_vector_type(8), aligned(4)));
typedef long long Counts __attribute__((ext_vector_type(8)));
// Whether a CPU fuses the operations of a function, which begins with it; fused ones change last digits.
#define CONTRACT_FAST _Pragma("clang fp contract(fast)")
#define CONTRACT_OFF _Pragma("clang fp contract(off)")
// The slots that a call does, from `first` on: on a CPU a range of them, on a GPU a block of threads does
// one. A loop there, even over one slot, takes a sixth more registers, and twice the time of what needs many.
#define EACH_SLOT for (int slot = first; slot < end; ++slot)
// Of a variable that all threads of a slot have together.
#define OF_SLOT
#endif
typedef decltype(Lanes() < Lanes()) Mask; // what a comparison gives

// Cells of `Lanes`, `Lanes` of a stored vector and of a tile of four stored vectors.
static const int LANES = sizeof(Lanes) / sizeof(double);
static const int OF_VECTOR = 8 / LANES;
static const int OF_TILE = 4 * OF_VECTOR;

static const double ABSENT = 1.0e30;    // gap of a place where there is no surface [mm]
static const double NO_LIMIT = 1.0e300; // stands for no cell, no cap and no limit
static const double NO_INDEX = -1.0e9;  // stands for no cell among first and last indices

// Threads that do a small part of a slot's work together: on a CPU the one of the slot, on a GPU a warp.
static const int TEAM = LANES == 1 ? 32 : 1;

#if defined(__CUDA_ARCH__)
WARPWEAR_FN int lane_of_slot() { return threadIdx.x; }
WARPWEAR_FN int width_of_slot() { return blockDim.x; }
WARPWEAR_FN void wait_for_slot() { __syncthreads(); }
WARPWEAR_FN bool lane_of(Mask mask, int) { return mask; }
WARPWEAR_FN Lanes lanes_from(double first) { return first; }
template <typename Do, typename... Of> WARPWEAR_FN Lanes each_lane(const Do& of, Of... v) { return of(v...); }
WARPWEAR_FN Lanes size_of(Lanes v) { return fabs(v); }
WARPWEAR_FN bool any(Mask v) { return v; }
WARPWEAR_FN double total(Lanes v) { return v; }
WARPWEAR_FN double count(Counts v) { return double(v); }
WARPWEAR_FN double most(Lanes v) { return v; }
WARPWEAR_FN Lanes doubled(SingleLanes v) { return double(v); }
WARPWEAR_FN SingleLanes halved(Lanes v) { return float(v); }
template <typename T> WARPWEAR_FN void fetch(const T*) {}
#else
// Thread of a slot, and how many a slot has.
WARPWEAR_FN int lane_of_slot() { return 0; }
WARPWEAR_FN int width_of_slot() { return 1; }
// Wait for all threads of a slot: what they have read may change then.
WARPWEAR_FN void wait_for_slot() {}
// Whether a mask holds for one of its cells.
WARPWEAR_FN bool lane_of(Mask mask, int lane) { return mask[lane]; }
// A number for the first of some cells, one more for the next, ...
WARPWEAR_FN Lanes lanes_from(double first)
{
    const Lanes lane = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
    return lane + first;
}
// What a function makes of each cell.
template <typename Do, typename... Of> WARPWEAR_FN Lanes each_lane(const Do& of, Of... v)
{
    Lanes made;
    for (int j = 0; j < LANES; ++j) made[j] = of(v[j]...);
    return made;
}
WARPWEAR_FN Lanes size_of(Lanes v) { return __builtin_elementwise_abs(v); }
WARPWEAR_FN bool any(Mask v) { return __builtin_reduce_or(v) != 0; }
WARPWEAR_FN double total(Lanes v)
{
    double sum = 0.0;
    for (int j = 0; j < LANES; ++j) sum += v[j];
    return sum;
}
WARPWEAR_FN double count(Counts v) { return double(__builtin_reduce_add(v)); }
// By halves: the built-in reduction minds NaN and takes three times as long.
WARPWEAR_FN double most(Lanes v)
{
    Lanes w = __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3);
    v = v > w ? v : w;
    w = __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5);
    v = v > w ? v : w;
    return v[0] > v[1] ? v[0] : v[1];
}
WARPWEAR_FN Lanes doubled(SingleLanes v) { return __builtin_convertvector(v, Lanes); }
WARPWEAR_FN SingleLanes halved(Lanes v) { return __builtin_convertvector(v, SingleLanes); }
WARPWEAR_FN Lanes root_of(Lanes v)
{
    for (int j = 0; j < LANES; ++j) v[j] = wp::sqrt(v[j]);
    return v;
}
template <typename T> WARPWEAR_FN void fetch(const T* place) { __builtin_prefetch(place, 1); }
#endif
WARPWEAR_FN double root_of(double v) { return wp::sqrt(v); }

WARPWEAR_FN int team_of_slot() { return lane_of_slot() / TEAM; }
WARPWEAR_FN int teams_of_slot() { return (width_of_slot() + TEAM - 1) / TEAM; }
WARPWEAR_FN int lane_of_team() { return lane_of_slot() % TEAM; }

WARPWEAR_FN Lanes larger_of(Lanes a, Lanes b) { return a > b ? a : b; }
WARPWEAR_FN Lanes smaller_of(Lanes a, Lanes b) { return a < b ? a : b; }

// 1 of cells for which a mask holds, to be added up.
WARPWEAR_FN Counts one_if(Mask where)
{
    const Counts no = 0, yes = 1;
    return where ? yes : no;
}

template <bool IS> struct Is {
    static const bool value = IS;
};

// Do something told by a type whether a condition holds.
template <typename Do> WARPWEAR_FN void told(bool is, const Do& act)
{ is ? act(Is<true>()) : act(Is<false>()); }

// A row of a field as cells; of a field of one row that row serves all.
template <typename Field> WARPWEAR_FN Stored* row_of(const Field& field, int row)
{ return (Stored*)&wp::index(field, row < field.shape[0] ? row : field.shape[0] - 1, 0); }

// A row of a field, or none of a field without rows.
template <typename Field> WARPWEAR_FN Stored* row_or_none(const Field& field, int row)
{ return field.shape[0] > 0 ? row_of(field, row) : nullptr; }

template <typename Field> WARPWEAR_FN StoredSingle* single_row_of(const Field& field, int row)
{ return (StoredSingle*)&wp::index(field, row < field.shape[0] ? row : field.shape[0] - 1, 0); }

// Bring what the threads of a warp have to one number, in the first of them.
WARPWEAR_FN double reduce_warp(double value, bool adds)
{
#if defined(__CUDA_ARCH__)
    for (int apart = 16; apart > 0; apart /= 2) {
        const double other = __shfl_down_sync(0xffffffff, value, apart);
        value = adds ? value + other : (value > other ? value : other);
    }
#endif
    return value;
}

// Bring what the threads of a slot have to one number.
WARPWEAR_FN double reduce_slot(double value, bool adds)
{
#if defined(__CUDA_ARCH__)
    __shared__ double of_warps[32];
    const int warp = threadIdx.x / 32, lane = threadIdx.x % 32, warps = (blockDim.x + 31) / 32;
    value = reduce_warp(value, adds);
    __syncthreads(); // others may still read what was there
    if (lane == 0) of_warps[warp] = value;
    __syncthreads();
    value = of_warps[0];
    for (int i = 1; i < warps; ++i)
        value = adds ? value + of_warps[i] : (value > of_warps[i] ? value : of_warps[i]);
#endif
    return value;
}

// Leave a sum, or a maximum, in the column of the slot in a table of partial results.
template <typename Table> WARPWEAR_FN void store_sum(Table& table, int line, int slot, double value)
{
    value = reduce_slot(value, true);
    if (lane_of_slot() == 0) wp::index(table, line, slot) = value;
}

template <typename Table> WARPWEAR_FN void store_most(Table& table, int line, int slot, double value)
{
    value = reduce_slot(value, false);
    if (lane_of_slot() == 0) wp::index(table, line, slot) = value;
}

// The sum of n numbers in pairs, as NumPy adds up: it is exact to a few digits more than one after another.
WARPWEAR_FN double sum_in_pairs(const double* v, int n)
{
    if (n > 128) {
        const int half = n / 2 - n / 2 % 8;
        return sum_in_pairs(v, half) + sum_in_pairs(v + half, n - half);
    }
    double r[8] = {0.0}, sum = 0.0;
    int i = 0;
    if (n >= 8) {
        for (; i < 8; ++i) r[i] = v[i];
        for (; i < n - n % 8; i += 8)
            for (int j = 0; j < 8; ++j) r[j] += v[i + j];
        sum = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));
    }
    for (; i < n; ++i) sum += v[i];
    return sum;
}

// The sum of n numbers. Every thread of a deciding slot calls it, and gets the number.
WARPWEAR_FN double sum_of_numbers(const double* v, int n)
{
#if defined(__CUDA_ARCH__)
    double sum = 0.0;
    for (int i = threadIdx.x; i < n; i += blockDim.x) sum += v[i];
    return reduce_slot(sum, true);
#else
    return sum_in_pairs(v, n);
#endif
}

// Sum and maximum of `columns` columns of a line of a table, from `first` on, likewise.
template <typename Table> WARPWEAR_FN double sum_of_line(const Table& table, int line, int first, int columns)
{ return sum_of_numbers(&wp::index(table, line, first), columns); }

template <typename Table>
WARPWEAR_FN double most_of_line(const Table& table, int line, int first, int columns)
{
    const double* const v = &wp::index(table, line, first);
    double largest = -NO_LIMIT;
    int i = lane_of_slot();
#if !defined(__CUDA_ARCH__)
    Lanes most_here = largest;
    for (; i + LANES <= columns; i += LANES) {
        const Lanes here = *(const Stored*)(v + i);
        most_here = most_here > here ? most_here : here;
    }
    largest = most(most_here);
#endif
    for (; i < columns; i += width_of_slot()) largest = largest > v[i] ? largest : v[i];
    return reduce_slot(largest, false);
}

// What a slot leaves in a column of a table: the sum of what its threads have, or the largest.
struct Partial {
    double value;
    double* place;
    bool adds;
};

// Sums over the cells of a slot, by the names of the lines of a table (kernels/cells.py): of numbers, and of
// cells that are counted. A line is the sum of both, and 0 where neither grows.
template <typename Line> struct Sums {
    static const int LINES = int(Line::LINES);
    Lanes numbers[LINES] = {};
    Counts cells[LINES] = {};

    CUDA_CALLABLE inline Lanes& of(Line line) { return numbers[int(line)]; }
    CUDA_CALLABLE inline Counts& counted(Line line) { return cells[int(line)]; }

    // What the slot leaves in its column of the table: in the first lines, where the others stay 0.
    template <int FIRST = LINES, typename Table>
    CUDA_CALLABLE inline void list(Partial* partials, Table& table, int slot) const
    {
#pragma unroll
        for (int line = 0; line < FIRST; ++line)
            partials[line] = {total(numbers[line]) + count(cells[line]), &wp::index(table, line, slot), true};
    }
};

// What the slot leaves in its column of a table of maxima, from the first line on.
template <int N, typename Table>
WARPWEAR_FN void list_largest(Partial* partials, Table& table, int slot, const double (&largest)[N])
{
#pragma unroll
    for (int n = 0; n < N; ++n) partials[n] = {largest[n], &wp::index(table, n, slot), false};
}

template <int N> WARPWEAR_FN void store_partials(const Partial (&partials)[N])
{
#if defined(__CUDA_ARCH__)
    // All at once: each warp brings every value to one, then has some of the values of all warps.
    __shared__ double of_warps[N][32];
    const int warp = threadIdx.x / 32, lane = threadIdx.x % 32, warps = blockDim.x / 32;
#pragma unroll
    for (int n = 0; n < N; ++n) {
        const double v = reduce_warp(partials[n].value, partials[n].adds);
        if (lane == 0) of_warps[n][warp] = v;
    }
    __syncthreads();
#pragma unroll
    for (int n = 0; n < N; ++n) {
        if (n % warps != warp) continue;
        const double nothing = partials[n].adds ? 0.0 : -NO_LIMIT;
        const double v = reduce_warp(lane < warps ? of_warps[n][lane] : nothing, partials[n].adds);
        if (lane == 0) *partials[n].place = v;
    }
#else
    for (const Partial& one : partials) *one.place = one.value;
#endif
}

// Leave the first lines of a column of a table likewise: so many sums, then maxima.
template <int N, typename Table>
WARPWEAR_FN void store_lines(Table& table, int slot, int sums, const double (&values)[N])
{
    Partial partials[N];
    for (int n = 0; n < N; ++n) partials[n] = {values[n], &wp::index(table, n, slot), n < sums};
    store_partials(partials);
}

// The sum of the first columns of a line of a table, or the largest: on a GPU by the threads of a warp, of
// which the first gets it.
template <typename Table>
WARPWEAR_FN double total_of_line(const Table& table, int line, int columns, bool adds)
{
#if defined(__CUDA_ARCH__)
    double v = adds ? 0.0 : -NO_LIMIT;
#pragma unroll 8
    for (int i = threadIdx.x % 32; i < columns; i += 32) {
        const double other = wp::index(table, line, i);
        v = adds ? v + other : (v > other ? v : other);
    }
    return reduce_warp(v, adds);
#else
    return adds ? sum_in_pairs(&wp::index(table, line, 0), columns) : most_of_line(table, line, 0, columns);
#endif
}

// Bring the first lines of a table to one number each, over their first columns: so many sums, then maxima.
// Every thread of a deciding slot calls it; each of its teams has some of the lines.
template <typename Table>
WARPWEAR_FN void total_lines(const Table& table, int sums, double* totals, int columns, int lines)
{
    wait_for_slot(); // others may still read what was there
    for (int line = team_of_slot(); line < lines; line += teams_of_slot()) {
        const double total = total_of_line(table, line, columns, line < sums);
        if (lane_of_team() == 0) totals[line] = total;
    }
    wait_for_slot();
}

template <typename Table> WARPWEAR_FN void total_lines(const Table& table, int sums, double* totals)
{ total_lines(table, sums, totals, table.shape[1], table.shape[0]); }

template <int N, typename Table>
WARPWEAR_FN wp::vec_t<N, double> lines_of_table(const Table& table, int columns, int sums, int lines)
{
    OF_SLOT double totals[N];
    wp::vec_t<N, double> values;
    total_lines(table, sums, totals, columns, lines);
    for (int line = 0; line < lines; ++line) values[line] = totals[line];
    return values;
}
