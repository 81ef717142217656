"""Running-in of a rough surface that the grid does not resolve: it recedes faster than its volume goes.

The fraction of the area that bears at a depth z below the highest peak is φ(z) = 1/(1 + e^(−(z − m)/s)).
A depth z has then lost the volume v(z) = ∫ φ dz of each unit of area, and back:
z(v) = m + s ln(q + (1 + q)(e^(v/s) − 1)) with q = e^(−m/s).
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import TABLE, Curve, fields
from warpwear.kernels.contact import Law

native_pass = native_code.passes_of(__name__, "running_in/recession.h")

#: Lower the disc, already lowered by its mean worn depth, by what it stands deeper than that: no volume goes.
recede = native_pass("recede", curve=Curve, **fields("wear_disc", "disc", "beyond"))
#: Sum of φ over the cells in contact, before they wear: how many cells' area bears.
borne = native_pass(
    "borne", laws=wp.array(dtype=Law), curve=Curve, **fields("counter", "disc", "wear_disc"), sums=TABLE
)
