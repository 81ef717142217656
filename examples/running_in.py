"""What makes friction rise slowly and level off, as tests often show?

Runs the preset `running-in` for a part of its distance, on coarse cells: wear in pieces, a film that it
breaks, and junctions that grow. Then the same with wear that leaves as dust. The numbers are a sketch; the
preset has finer cells.
"""

import matplotlib.pyplot as plt
import numpy as np

import warpwear

study = warpwear.Study.load("running-in").replace(
    {"grid.cell": "10 um", "wear.particle": "40 um", "wear.particle_thickness": "1.2 um", "sliding.shift": 8}
)
study = study.replace({"sliding.distance": "180 mm", "output.snapshots": []})
fig, axes = plt.subplots(figsize=(5, 3), layout="constrained")
for name, dust in (("pieces", 0.0), ("dust", 1.0)):
    history = warpwear.run(study.replace({"wear.dust_fraction": dust})).history
    number = np.ceil(history["distance"] / 30.0 - 1e-9).astype(int)  # of the pass of 30 mm
    friction = [history["cof"][number == one].mean() for one in range(1, 7)]
    print(f"{name}: coefficient of friction, means of passes:", *(f"{value:.2f}" for value in friction))
    axes.plot(30.0 * np.arange(1, 7) - 15.0, friction, "o-", label=name)
axes.set(xlabel="sliding distance, mm", ylabel="coefficient of friction", ylim=(0, None))
axes.legend()
fig.savefig("running_in.png")
