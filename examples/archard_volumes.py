"""Does the worn volume obey Archard's law, V = K F L, and what does the depth do meanwhile?

Runs the smooth model and a rough one. Both lose the same volume, whatever their pressures: volume alone says
nothing about a model. What differs is the area that carries the load, and so the depth.
"""

import matplotlib.pyplot as plt

import warpwear

fig, (left, right) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
changes = {"grid.cell": "20 um", "sliding.distance": "300 mm"}
load = 8.0  # N, as in the presets
for preset in ("v1", "v3-fine"):
    study = warpwear.Study.load(preset).replace(changes)
    history = warpwear.run(study).history
    distance = history["distance"][-1]
    print(f"{preset}: {distance:g} mm in {history['distance'].size} steps")
    for body, coefficient in (("counter", 9.4e-4), ("disc", 12.7e-4)):  # mm³/N/m
        volume = history[f"wear_volume_{body}"][-1]
        expected = coefficient * 1.0e-3 * load * distance
        print(
            f"    {body:6s} lost {volume:.6e} mm³, K F L {expected:.6e} mm³, "
            f"{1e3 * history[f'wear_depth_{body}'][-1]:.2f} µm deep"
        )
    left.plot(
        history["distance"],
        1e3 * history["wear_volume_disc"],
        label=preset,
        ls="-" if preset == "v1" else "--",
    )
    right.loglog(history["distance"], history["area_contact"], label=preset)
    print(f"    area in contact {history['area_contact'][-1]:.4f} mm²")
left.set(xlabel="sliding distance, mm", ylabel="worn volume of the disc, 10⁻³ mm³")
right.set(xlabel="sliding distance, mm", ylabel="area in contact, mm²")
left.legend()
fig.savefig("volumes.png")
