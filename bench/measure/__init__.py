"""How the benchmark measures: time beside a pass over memory, kernels, memory, and what it ran on."""
