"""The bounds of the gaps of pairs of tiles are made anew where something has raised a surface.

Wear only opens gaps, so that bounds which were made before it still hold. The loops are C++: native/bounds.h.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.sliding import Bodies, Bounds

wp.set_module_options(native_code.options("bounds.h"))


@native_code.native_pass("remake_bounds")
def remake(bodies: Bodies, bounds: Bounds):
    """Make the bounds of every tile of both bodies, of eight tiles and of rows, from the heights."""
