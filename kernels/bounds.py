"""The bounds of the gaps of pairs of tiles are made anew where something has raised a surface.

Wear only opens gaps, so that bounds which were made before it still hold. The loops are C++: native/bounds.h.
"""

from warpwear.kernels import native_code
from warpwear.kernels.sliding import Bodies, Bounds

native_pass = native_code.passes_of(__name__, "bounds.h")


#: Make the bounds of every tile of both bodies, of eight tiles and of rows, from the heights.
remake = native_pass("remake_bounds", bodies=Bodies, bounds=Bounds)
