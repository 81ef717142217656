"""Who takes part in the benchmark: the package, its loop in C and in NumPy, the published way, peers."""
