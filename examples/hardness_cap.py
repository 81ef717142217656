"""When does hardness, and when does elasticity, decide how much of a rough surface touches?

Presses a plane on one surface, elastic with and without a largest pressure. Soft bodies never reach their
hardness; stiff ones yield at once, and their area is then load over hardness: the bearing area.
"""

import matplotlib.pyplot as plt
import numpy as np

import warpwear

n, hardness, pressure = 128, 1.0, 0.05
rng = np.random.default_rng(1)
waves = np.hypot(np.fft.fftfreq(n)[:, np.newaxis], np.fft.rfftfreq(n))
heights = np.fft.irfft2(np.fft.rfft2(rng.normal(size=(n, n))) * np.exp(-((waves / 0.06) ** 2)), s=(n, n))
heights *= 0.5 / heights.std()

ratios, areas = (0.3, 3.0, 30.0, 300.0, 3000.0), []
print("E*/H     elastic   with the hardness   of it at the hardness   largest elastic pressure/H")
for modulus in ratios:
    options = {"cell": 1.0, "mean_pressure": pressure, "modulus": modulus}
    elastic = warpwear.solve_contact(heights, **options)
    capped = warpwear.solve_contact(heights, **options, hardness=hardness)
    areas.append((elastic.area / n**2, capped.area / n**2))
    print(
        f"{modulus:6g} {elastic.area / n**2:9.4f} {capped.area / n**2:12.4f} "
        f"{capped.area_at_hardness / capped.area:21.1%} {elastic.pressure.max() / hardness:22.3g}"
    )
bearing = warpwear.solve_contact(heights, cell=1.0, mean_pressure=pressure, hardness=hardness)
print(f"bearing area: {bearing.area / n**2:.4f}, load over hardness {pressure / hardness:.4f}")

fig, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.loglog(ratios, areas, "o-", label=("elastic", "with the hardness"))
axes.axhline(pressure / hardness, color="0.6", label="load over hardness")
axes.set(xlabel="E*/H", ylabel="real area over nominal area")
axes.legend()
fig.savefig("hardness.png")
