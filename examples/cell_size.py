"""How fine must the cells be for my surface?

Samples one and the same surface, whose shortest wave is 40 µm, on finer and finer cells. The area in
contact hardly depends on them. Islands of a single cell do: where there are any, the cells do not resolve
the asperities.
"""

import matplotlib.pyplot as plt

import warpwear

study = warpwear.Study.load("v3-fine").replace(
    {
        "disc.synthetic.cut_off": "40 um",
        "grid.extent": "0.9 mm",
        "sliding.distance": "30 mm",
        "output.snapshots": ["0.3 mm"],
    }
)
fig, axes = plt.subplots(figsize=(5, 3), layout="constrained")
print("cell, µm   area after 0.3 mm   after 30 mm, mm²   islands of contact   of one cell")
for cell in (30, 20, 10, 5, 3):
    result = warpwear.run(study.replace({"grid.cell": f"{cell} um"}))
    distance, area = result.history["distance"], result.history["area_contact"]
    islands = result.surface_evolution.table
    early = area[(distance >= 0.3).argmax()]
    print(
        f"{cell:8d} {early:19.5f} {area[-1]:18.5f} {islands['islands'][0]:20.0f} "
        f"{islands['islands_of_one_cell'][0]:13.0f}"
    )
    axes.loglog(distance, area, label=f"{cell} µm")
axes.set(xlabel="sliding distance, mm", ylabel="area in contact, mm²")
axes.legend(title="cell")
fig.savefig("cell_size.png")
