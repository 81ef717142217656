"""How does the coefficient of friction of a rough disc grow as the ball wears it?

Runs a preset on coarse cells for a tenth of its distance, prints the friction at a few distances and draws
its curve. Coarser cells than the roughness make the answer a sketch: the preset itself has cells of 1 µm.
"""

import matplotlib.pyplot as plt
import numpy as np

import warpwear

study = warpwear.Study.load("v3-fine").replace({"grid.cell": "15 um", "sliding.distance": "240 mm"})
result = warpwear.run(study)

history = result.history  # name -> one value a step
distance, friction = history["distance"], history["cof"]
for where in (0.1, 1.0, 10.0, 100.0, 240.0):  # mm
    print(f"after {where:5g} mm: coefficient of friction {np.interp(where, distance, friction):.3f}")

fig, axes = plt.subplots(layout="constrained")
axes.semilogx(distance, friction)
axes.set(xlabel="sliding distance, mm", ylabel="coefficient of friction")
fig.savefig("friction.png")
