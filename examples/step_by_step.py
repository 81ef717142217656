"""How do I watch a run, and stop it as soon as I know enough?

Compares two loads step by step, without a result: each run ends when the area in contact has grown to
0.1 mm². The distance that takes is what a lighter load buys.
"""

import matplotlib.pyplot as plt

import warpwear

ENOUGH = 0.1  # mm²
study = warpwear.Study.load("v3-fine").replace({"grid.cell": "15 um"})

fig, axes = plt.subplots(figsize=(5, 3), layout="constrained")
print("load   distance, mm   wear of the disc, µm")
for load in ("4 N", "8 N"):
    course = []
    for step in warpwear.steps(study.replace({"contact.load": load})):
        row = step.row  # name -> the value of this step, as in the history of a result
        course.append((row["distance"], row["area_contact"]))
        if row["area_contact"] >= ENOUGH:
            break
    else:
        print(f"{load}: the area stays below {ENOUGH} mm²")
        continue
    axes.loglog(*zip(*course, strict=True), label=load)
    print(f"{load} {row['distance']:14.2f} {1e3 * row['wear_depth_disc']:22.2f}")
axes.set(xlabel="sliding distance, mm", ylabel="area in contact, mm²")
axes.legend()
fig.savefig("until_enough.png")
