"""Does the half-space solver find Hertz's contact of a smooth ball on a flat?

Presses a ball of 3 mm on a flat with 8 N and compares radius, peak pressure and approach with the closed
form (Johnson, Contact Mechanics, 1985, section 4.2). Units here are mm, N and MPa; any consistent ones do.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import warpwear

modulus, radius, load = 115.0e3, 3.0, 8.0  # E* [MPa], ball [mm], [N]

a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
exact = {"radius, mm": a, "peak pressure, MPa": 1.5 * load / (math.pi * a**2), "approach, mm": a**2 / radius}

for cells_per_radius in (10, 20, 40):
    n = 3 * cells_per_radius
    contact = warpwear.solve_contact(
        np.zeros((n, n)), cell=a / cells_per_radius, load=load, modulus=modulus, counter_radius=radius
    )
    found = (math.sqrt(contact.area / math.pi), contact.pressure.max(), contact.approach)
    print(f"{cells_per_radius} cells a radius: {contact}")
    for (name, value), number in zip(exact.items(), found, strict=True):
        print(f"    {name:20s} {number:9.5g}, Hertz {value:9.5g} ({100.0 * (number / value - 1.0):+.2f} %)")

x = a / cells_per_radius * (np.arange(n) - 0.5 * (n - 1))
fig, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(x, contact.pressure[n // 2], ".", label="computed")
axes.plot(x, exact["peak pressure, MPa"] * np.sqrt(np.maximum(1.0 - (x / a) ** 2, 0.0)), label="Hertz")
axes.set(xlabel="x, mm", ylabel="pressure, MPa")
axes.legend()
fig.savefig("hertz.png")
