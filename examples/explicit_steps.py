"""What happens when an explicit step of wear is too long?

Wears a smooth ball on springs by the pressure at the start of each step. Beyond a length that follows from
stiffness and wear the cells let go and come back in turns: the area is chaos, and the worn volume looks
perfect.
"""

import matplotlib.pyplot as plt
import numpy as np

import warpwear

study = warpwear.Study.load("v1").replace({"sliding.distance": "600 mm"})
cases = {
    "explicit, 0.2 mm": {"stepping.increment": "0.2 mm"},
    "explicit, 0.5 mm": {"stepping.increment": "0.5 mm", "stepping.force": True},
    "implicit, 3 mm": {"stepping.increment": "3 mm", "stepping.scheme": "implicit"},
}
fig, axes = plt.subplots(figsize=(6, 3), layout="constrained")
for name, changes in cases.items():
    history = warpwear.run(study.replace(changes)).history
    late = history["distance"] > 500.0
    area, volume = history["area_contact"][late], history["wear_volume_counter"][-1]
    print(
        f"{name}: area over the last 100 mm {area.mean():.3f} mm², {area.min():.3f} to {area.max():.3f}; "
        f"volume over K F L {volume / (9.4e-7 * 8.0 * 600.0):.6f}"
    )
    axes.plot(history["distance"], history["area_contact"], label=name, lw=0.7)
distance = np.linspace(0.0, 600.0)
axes.plot(distance, np.sqrt(4 * np.pi * 3.0 * 22.1e-7 * 8.0 * distance), "k:", label="closed form")
axes.set(xlabel="sliding distance, mm", ylabel="area in contact, mm²")
axes.legend(fontsize="small")
fig.savefig("explicit_steps.png")
