"""Warp kernels of warpwear: gap, contact, removal, reductions. No launches, no policy, no units."""

if __name__ != "warpwear.kernels":
    raise ImportError("import this package as warpwear.kernels")
