#pragma once
#include "lanes.h"
// Convolutions of fields on a CPU: as many lines at a time as a vector has lanes, one in each of them.
//
// A convolution needs its modes in no order. What goes in is in order and comes out of the transform with the
// digits of its index reversed; there it is multiplied by a table in that order, and what comes back is in
// order again, so that nothing is ever moved about (Gentleman and Sande 1966, AFIPS Conf. Proc. 29, 563). A
// row of 2n real cells is transformed as n complex numbers (Cooley, Lewis and Welch 1970, J. Sound Vib. 12,
// 315), one of an odd number of cells as that many, of no imaginary part.
//
// Number i of the lines together has its real parts at x + 2 L i and its imaginary ones at x + 2 L i + L, of
// L lines; a transform that takes the one for the other goes backwards. Modes of a grid lie in groups of L
// columns: spectrum[group][row], again L real parts and L imaginary ones.

#if !defined(__CUDA_ARCH__)

// A prime of a length is no larger; `convolution.LARGEST_PRIME` says the same.
static const int LARGEST_RADIX = 199;

// Vectors of a type of number, and how their lanes are put in another order.
template <typename Real> struct VectorOf;

template <> struct VectorOf<float> {
    static const int LINES = 16;
    typedef float Lines __attribute__((ext_vector_type(16)));
    typedef float Stored __attribute__((ext_vector_type(16), aligned(4)));
    typedef double Row __attribute__((ext_vector_type(16), aligned(8)));
    static Lines evens(Lines u, Lines v)
    { return __builtin_shufflevector(u, v, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30); }
    static Lines odds(Lines u, Lines v)
    { return __builtin_shufflevector(u, v, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31); }
    static Lines first_in_turn(Lines u, Lines v)
    { return __builtin_shufflevector(u, v, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23); }
    static Lines last_in_turn(Lines u, Lines v)
    { return __builtin_shufflevector(u, v, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31); }
};

template <> struct VectorOf<double> {
    static const int LINES = 8;
    typedef double Lines __attribute__((ext_vector_type(8)));
    typedef double Stored __attribute__((ext_vector_type(8), aligned(8)));
    typedef Stored Row;
    static Lines evens(Lines u, Lines v) { return __builtin_shufflevector(u, v, 0, 2, 4, 6, 8, 10, 12, 14); }
    static Lines odds(Lines u, Lines v) { return __builtin_shufflevector(u, v, 1, 3, 5, 7, 9, 11, 13, 15); }
    static Lines first_in_turn(Lines u, Lines v)
    { return __builtin_shufflevector(u, v, 0, 8, 1, 9, 2, 10, 3, 11); }
    static Lines last_in_turn(Lines u, Lines v)
    { return __builtin_shufflevector(u, v, 4, 12, 5, 13, 6, 14, 7, 15); }
};

template <typename Real> using LinesOf = typename VectorOf<Real>::Lines;

// A number of all lines together.
template <typename Real> WARPWEAR_FN typename VectorOf<Real>::Stored& lines_at(Real* place)
{ return *(typename VectorOf<Real>::Stored*)place; }

// Vectors by lines become vectors by columns.
template <typename Real> WARPWEAR_FN void transpose(LinesOf<Real>* a)
{
    typedef VectorOf<Real> Vector;
    const int half = Vector::LINES / 2;
    for (int size = 1; size < 2 * half; size *= 2) {
        LinesOf<Real> b[2 * half];
        for (int i = 0; i < half; ++i) {
            b[2 * i] = Vector::first_in_turn(a[i], a[i + half]);
            b[2 * i + 1] = Vector::last_in_turn(a[i], a[i + half]);
        }
        for (int i = 0; i < 2 * half; ++i) a[i] = b[i];
    }
}

// The transform of RADIX complex numbers a + i b to c + i d.
template <typename Real, int RADIX>
WARPWEAR_FN void butterfly(const LinesOf<Real>* a, const LinesOf<Real>* b, LinesOf<Real>* c, LinesOf<Real>* d)
{
    typedef LinesOf<Real> Lines;
    if constexpr (RADIX == 2) {
        c[0] = a[0] + a[1], d[0] = b[0] + b[1];
        c[1] = a[0] - a[1], d[1] = b[0] - b[1];
    } else if constexpr (RADIX == 3) {
        const Real sine = Real(0.86602540378443864676);
        const Lines s = a[1] + a[2], t = b[1] + b[2];
        const Lines u = sine * (a[1] - a[2]), v = sine * (b[1] - b[2]);
        const Lines e = a[0] - Real(0.5) * s, f = b[0] - Real(0.5) * t;
        c[0] = a[0] + s, d[0] = b[0] + t;
        c[1] = e + v, d[1] = f - u;
        c[2] = e - v, d[2] = f + u;
    } else if constexpr (RADIX == 4) {
        const Lines s = a[0] + a[2], t = b[0] + b[2], u = a[0] - a[2], v = b[0] - b[2];
        const Lines e = a[1] + a[3], f = b[1] + b[3], g = a[1] - a[3], h = b[1] - b[3];
        c[0] = s + e, d[0] = t + f;
        c[1] = u + h, d[1] = v - g;
        c[2] = s - e, d[2] = t - f;
        c[3] = u - h, d[3] = v + g;
    } else {
        const Real c1 = Real(0.30901699437494742410), c2 = Real(-0.80901699437494742410);
        const Real s1 = Real(0.95105651629515357212), s2 = Real(0.58778525229247312917);
        const Lines p = a[1] + a[4], q = b[1] + b[4], s = a[2] + a[3], t = b[2] + b[3];
        const Lines e = a[1] - a[4], f = b[1] - b[4], g = a[2] - a[3], h = b[2] - b[3];
        const Lines u = a[0] + c1 * p + c2 * s, v = b[0] + c1 * q + c2 * t;
        const Lines w = a[0] + c2 * p + c1 * s, z = b[0] + c2 * q + c1 * t;
        const Lines i = s1 * e + s2 * g, j = s1 * f + s2 * h;
        const Lines k = s2 * e - s1 * g, l = s2 * f - s1 * h;
        c[0] = a[0] + p + s, d[0] = b[0] + q + t;
        c[1] = u + j, d[1] = v - i;
        c[2] = w + l, d[2] = z - k;
        c[3] = w - l, d[3] = z + k;
        c[4] = u - j, d[4] = v + i;
    }
}

// Multiply complex numbers of all lines by one.
template <typename Real> WARPWEAR_FN void turn(const Real* by, LinesOf<Real>& a, LinesOf<Real>& b)
{
    const Real cosine = by[0], sine = by[1];
    const LinesOf<Real> c = a * cosine - b * sine;
    b = a * sine + b * cosine;
    a = c;
}

// Multiply complex numbers 1 … RADIX − 1 by the factors between two stages.
template <typename Real, int RADIX>
WARPWEAR_FN void turn_by(const Real* turns, LinesOf<Real>* a, LinesOf<Real>* b)
{
    for (int q = 1; q < RADIX; ++q) turn(turns + 2 * q - 2, a[q], b[q]);
}

// One stage: blocks of `size` numbers become RADIX blocks each. First come the sums and then the factors; on
// the way back the factors come first. HALF: the second half of each block is zeros, and not asked for.
template <typename Real, int RADIX, bool HALF, bool BACK>
WARPWEAR_FN void stage(Real* x, int length, int size, const Real* turns)
{
    typedef LinesOf<Real> Lines;
    const int lines = VectorOf<Real>::LINES, pair = 2 * lines;
    const int m = size / RADIX, real = BACK ? lines : 0, imag = lines - real;
    for (int first = 0; first < length; first += size) {
        const Real* turn = turns;
        Real* here = x + pair * first;
        for (int j = 0; j < m; ++j, here += pair, turn += 2 * (RADIX - 1)) {
            Lines a[RADIX], b[RADIX], c[RADIX], d[RADIX];
            for (int q = 0; q < RADIX; ++q) {
                if (HALF && q && !BACK) {
                    a[q] = b[q] = Lines(Real(0.0));
                    continue;
                }
                a[q] = lines_at(here + pair * q * m + real);
                b[q] = lines_at(here + pair * q * m + imag);
            }
            if (BACK) turn_by<Real, RADIX>(turn, a, b);
            butterfly<Real, RADIX>(a, b, c, d);
            if (!BACK) turn_by<Real, RADIX>(turn, c, d);
            for (int q = 0; q < (HALF && BACK ? 1 : RADIX); ++q) {
                lines_at(here + pair * q * m + real) = c[q];
                lines_at(here + pair * q * m + imag) = d[q];
            }
        }
    }
}

// How many numbers the factors of a stage are, with the waves of a prime above 5, of an even number of modes.
WARPWEAR_FN int turns_of(int radix, int size)
{
    const int half = radix / 2, waves = radix > 5 ? 2 * half * (half + half % 2) : 0;
    return 2 * (radix - 1) * (size / radix) + waves;
}

// One stage of any odd prime. Numbers q and p − q have the cosines of each mode in common, and the sines but
// for a sign; so do modes k and p − k of all numbers. Modes are made two and two, that numbers are read half
// as often; where their number is odd, the last ones are made again.
template <typename Real, bool BACK>
WARPWEAR_FN void prime_stage(Real* x, int length, int size, int radix, const Real* turns)
{
    typedef LinesOf<Real> Lines;
    const int lines = VectorOf<Real>::LINES, pair = 2 * lines;
    const int m = size / radix, half = radix / 2, real = BACK ? lines : 0, imag = lines - real;
    const Real* const waves = turns + 2 * (radix - 1) * m;
    Lines a[LARGEST_RADIX], b[LARGEST_RADIX];
    for (int first = 0; first < length; first += size) {
        const Real* factors = turns;
        Real* here = x + pair * first;
        for (int j = 0; j < m; ++j, here += pair, factors += 2 * (radix - 1)) {
            const auto put = [&](int k, Lines c, Lines d) {
                if (!BACK) turn(factors + 2 * k - 2, c, d);
                lines_at(here + pair * k * m + real) = c;
                lines_at(here + pair * k * m + imag) = d;
            };
            for (int q = 0; q < radix; ++q) {
                a[q] = lines_at(here + pair * q * m + real);
                b[q] = lines_at(here + pair * q * m + imag);
                if (BACK && q) turn(factors + 2 * q - 2, a[q], b[q]);
            }
            Lines s = a[0], t = b[0];
            for (int q = 1; q <= half; ++q) {
                const Lines c = a[q], d = b[q], e = a[radix - q], f = b[radix - q];
                a[q] = c + e, b[q] = d + f, a[radix - q] = c - e, b[radix - q] = d - f;
                s += a[q], t += b[q];
            }
            lines_at(here + real) = s;
            lines_at(here + imag) = t;
            const Real* wave = waves;
            for (int k = 1; k <= half; k += 2) {
                Lines c = a[0], d = b[0], g = a[0], h = b[0];
                Lines e = Lines(Real(0.0)), f = e, u = e, v = e;
                for (int q = 1; q <= half; ++q, wave += 4) {
                    c += wave[0] * a[q], d += wave[0] * b[q];
                    e += wave[1] * a[radix - q], f += wave[1] * b[radix - q];
                    g += wave[2] * a[q], h += wave[2] * b[q];
                    u += wave[3] * a[radix - q], v += wave[3] * b[radix - q];
                }
                put(k, c + f, d - e), put(radix - k, c - f, d + e);
                put(k + 1, g + v, h - u), put(radix - k - 1, g - v, h + u);
            }
        }
    }
}

// All stages of a transform, from the longest on; on the way back from the shortest on. radices: −2 stands
// for 2 with half of its numbers zeros. turns: those of the first stage.
template <typename Real, bool BACK>
__attribute__((noinline)) static void transform(const wp::array_t<int>& radices, Real* x, int length,
                                                const Real* turns)
{
    const int stages = radices.shape[0];
    int size = length;
    if (BACK) {
        for (int n = 0; n < stages; ++n) {
            const int kind = radices.data[n], radix = kind > 0 ? kind : 2;
            turns += turns_of(radix, size);
            size /= radix;
        }
    }
    for (int n = 0; n < stages; ++n) {
        const int kind = radices.data[BACK ? stages - 1 - n : n], radix = kind > 0 ? kind : 2;
        if (BACK) size *= radix;
        const int of_stage = turns_of(radix, size);
        if (BACK) turns -= of_stage;
        if (kind < 0)
            stage<Real, 2, true, BACK>(x, length, size, turns);
        else if (radix == 4)
            stage<Real, 4, false, BACK>(x, length, size, turns);
        else if (radix == 2)
            stage<Real, 2, false, BACK>(x, length, size, turns);
        else if (radix == 3)
            stage<Real, 3, false, BACK>(x, length, size, turns);
        else if (radix == 5)
            stage<Real, 5, false, BACK>(x, length, size, turns);
        else
            prime_stage<Real, BACK>(x, length, size, radix, turns);
        if (!BACK) {
            turns += of_stage;
            size /= radix;
        }
    }
}
#endif
