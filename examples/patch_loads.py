"""Which patch of a rough contact carries which part of the load?

Two scales: the domain is tiled by patches of rough cells, each on a spring of the smooth bodies behind it. As
the ball wears, the load spreads over more of them.
"""

import numpy as np

import warpwear

study = warpwear.Study.load("two-scale").replace(
    {
        "grid.cell": "10 um",
        "grid.extent": "1.5 mm",
        "patches.macro_cell": "100 um",
        "patches.width": "100 um",
        "sliding.distance": "60 mm",
    }
)
result = warpwear.run(study)
distance, share = result.history["distance"], result.load_share  # N, shape (steps, patches)
for where in (0.01, 0.1, 1.0, 10.0, 60.0):  # mm
    row = share[np.searchsorted(distance, where * (1.0 - 1e-9))]
    loaded = np.sort(row[row > 0.0])[::-1]
    print(
        f"after {where:5g} mm: {loaded.size:3d} of {row.size} patches carry {row.sum():.6f} N; "
        f"the four most loaded {loaded[:4].sum() / row.sum():.0%}"
    )
result.plot.load_share().savefig("load_share.png")
