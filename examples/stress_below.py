"""How deep does a fretting contact stress the disc, and where would fatigue begin?

Presses a steel ball of 5 mm on a steel flat with 20 N, shears it to and fro by 0.6 of what friction holds,
and asks where von Mises' and Crossland's stresses are largest. Units are mm, N and MPa.
"""

import matplotlib.pyplot as plt
import numpy as np

import warpwear

radius, load, friction, poisson = 5.0, 20.0, 0.6, 0.3
modulus = 210.0e3 / (1.0 - poisson**2) / 2.0  # E* of both bodies [MPa]
a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
n, cell = 97, 2.6 * a / 97

contact = warpwear.solve_contact(
    np.zeros((n, n)), cell=cell, load=load, modulus=modulus, counter_radius=radius
)
sheared = warpwear.solve_tangential(
    contact, friction=friction, force=(0.6 * friction * load, 0.0), poisson=poisson
)
depths = a * np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0])
there = warpwear.stresses(sheared, depths, poisson=poisson)
back = warpwear.stresses(contact, depths, poisson=poisson, traction=-sheared.traction)

print(f"von Mises at most {there.mises.max():.0f} MPa, {there.mises[depths > 0.2 * a].max():.0f} below 0.2 a")
for length in (None, 0.030):
    cycle = there.cycle(back, bending=500.0, torsion=300.0, length=length)
    value, (x, y, z) = cycle.largest(cycle.crossland)
    place = ", ".join(f"{at / a:.2f}" for at in (x, y, z))
    print(f"means over {length} mm: Crossland {value:.0f} MPa at (x, y, z)/a = {place}")

fig, axes = plt.subplots(figsize=(5, 2.8), layout="constrained")
x = (np.arange(n) - 0.5 * (n - 1)) * cell / a
image = axes.contourf(x, -depths / a, there.plane(there.mises, "y"), 15)
fig.colorbar(image, label="von Mises, MPa")
axes.set(xlabel="x/a", ylabel="−z/a", title="in the plane y = 0")
fig.savefig("stress_below.png")
