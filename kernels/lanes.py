"""What loops over cells in C++ are written with: lanes, how many there are, and what they add up to."""

#: `Lanes` are the eight cells of a vector on a CPU, on a GPU one cell after another.
LANES_IN_C = """
#if defined(__CUDA_ARCH__)
    typedef double Lanes;
    typedef double Stored;
    typedef long long Counts;
    const auto size_of = [](double v) { return fabs(v); };
    const auto fetch = [](const Stored*) {};
#else
    typedef double Lanes __attribute__((ext_vector_type(8)));
    typedef double Stored __attribute__((ext_vector_type(8), aligned(8)));
    typedef long long Counts __attribute__((ext_vector_type(8)));
    const auto size_of = [](Lanes v) { return __builtin_elementwise_abs(v); };
    const auto fetch = [](const Stored* place) { __builtin_prefetch(place, 1); };
#endif
    const int lanes = sizeof(Lanes) / sizeof(double);
    const Lanes zero = 0.0;
    const Counts no = 0, yes = 1;
    const auto total = [&](const Lanes& v) {
        double sum = 0.0;
        for (int j = 0; j < lanes; ++j) sum += ((const double*)&v)[j];
        return sum;
    };
    const auto count = [&](const Counts& v) {
        long long sum = 0;
        for (int j = 0; j < lanes; ++j) sum += ((const long long*)&v)[j];
        return double(sum);
    };
    const auto most = [&](const Lanes& v) {
        double top = ((const double*)&v)[0];
        for (int j = 1; j < lanes; ++j) top = wp::max(top, ((const double*)&v)[j]);
        return top;
    };
"""
