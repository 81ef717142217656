"""Does the disc become smooth where the ball has worn it?

On a disc that lies still the two bodies come to fit each other. That does not make them smooth: each body
wears by its share, so the disc keeps a part of its roughness and the ball gets the imprint of the rest.
"""

import matplotlib.pyplot as plt

import warpwear

study = warpwear.Study.load("v3-fine").replace({"grid.cell": "5 um", "sliding.distance": "600 mm"})
result = warpwear.run(study)
table = result.surface_evolution.table
print("distance, mm   Sq of the disc, µm   of the ball   of the disc unworn")
for row in range(len(table["distance"])):
    print(
        f"{table['distance'][row]:12g} {table['sq_disc'][row]:20.3f} {table['sq_counter'][row]:13.3f} "
        f"{table['sq_disc_unworn'][row]:20.3f}"
    )
print(f"the part of the wear that the ball takes: {9.4 / (9.4 + 12.7):.3f}")

last = result.snapshots[-1]
middle = result.y.size // 2
fig, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.plot(result.x, -1e3 * last.wear_disc[:, middle], label="lost by the disc")
axes.plot(result.x, 1e3 * last.wear_counter[:, middle], label="lost by the ball")
axes.plot(result.x, 1e3 * last.gap[:, middle], label="gap")
axes.set(xlabel="x (sliding), mm", ylabel="µm", ylim=(-22, 22), xlim=(-0.6, 0.6))
axes.legend()
fig.savefig("imprint.png")
