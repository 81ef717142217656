"""What does a ball do to a surface that I made myself, as a NumPy array?

A disc turned on a lathe: grooves 60 µm wide and 2 µm deep, across the sliding direction. The array goes
straight into the run, whose folder keeps it: `warpwear run grooves/study.toml` would repeat it.
"""

import matplotlib.pyplot as plt
import numpy as np

import warpwear

study = warpwear.Study.load("v3-fine").replace({"grid.cell": "10 um", "sliding.distance": "30 mm"})

cells, cell = 150, 0.01  # the grid of the study: 1.5 mm, cells of 0.01 mm
x = cell * (np.arange(cells) - 0.5 * (cells - 1))  # along the sliding direction, mm
groove = 1.0e-3 * np.cos(2.0 * np.pi * x / 0.06)  # mm, positive out of the material
heights = np.repeat(groove[:, np.newaxis], cells, axis=1)

result = warpwear.run(study, surface=heights, out="grooves", plots=False)
fig, panels = plt.subplots(1, len(result.snapshots), figsize=(9, 2.8), layout="constrained")
for axes, snapshot in zip(panels, result.snapshots, strict=True):
    touching = snapshot.pressure > 0.0
    ridges = np.flatnonzero(np.diff(touching.any(axis=1).astype(int)) == 1).size
    print(
        f"after {snapshot.distance:5.3g} mm: {touching.sum()} cells touch, ridges: {ridges}; "
        f"the disc has lost {1e3 * snapshot.wear_disc.max():.2f} µm at most"
    )
    axes.pcolormesh(result.x, result.y, np.where(touching, snapshot.pressure, np.nan).T)
    axes.set(
        title=f"{snapshot.distance:.3g} mm",
        xlim=(-0.3, 0.3),
        ylim=(-0.3, 0.3),
        aspect="equal",
        xlabel="x, mm",
    )
fig.savefig("grooves.png")
