"""How much do area and friction scatter from one place on a rough disc to another?

Runs a study on ten surfaces that differ in nothing but their seed: ten places on one disc, as it were. A
difference between two tests that is smaller than this scatter says nothing.
"""

import matplotlib.pyplot as plt
import numpy as np

import warpwear

study = warpwear.Study.load("v3-fine").replace(
    {"grid.cell": "10 um", "sliding.distance": "100 mm", "output.snapshots": []}
)
courses = []
for seed in range(1, 11):
    history = warpwear.run(study.replace({"disc.synthetic.seed": seed})).history
    courses.append(history["area_contact"])
distance, areas = history["distance"], np.array(courses)
for where in (0.1, 1.0, 10.0, 100.0):  # mm
    here = areas[:, np.argmin(abs(distance - where))]
    print(f"after {where:5g} mm: {here.mean():.4f} mm², scatter {100 * here.std(ddof=1) / here.mean():.1f} %")

fig, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.loglog(distance, areas.T, color="0.7", lw=0.7)
axes.loglog(distance, areas.mean(axis=0), lw=2, label="mean of ten surfaces")
axes.set(xlabel="sliding distance, mm", ylabel="area in contact, mm²")
axes.legend()
fig.savefig("scatter.png")
