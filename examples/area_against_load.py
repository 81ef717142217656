"""How does the real area of contact of a rough surface grow with the load?

Presses a plane on a periodic self-affine surface and compares with Persson's erf(√2 p̄/(E* h')), which is
proportional to the load while little of the surface touches (Manners and Greenwood 2006, Wear 261, 600).
Computed areas are larger than his at small loads: here 1.6 times at 0.001 E*. With eight cells in the
shortest wave, as here, a tenth of the area comes from the cells; on ever finer cells it goes to 1.4 times
his. Surfaces with other waves have other ratios.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import warpwear

n, modulus = 256, 1.0
q = 2.0 * math.pi * np.hypot(np.fft.fftfreq(n)[:, np.newaxis], np.fft.rfftfreq(n))  # of cells of width 1
band = (q > 2.0 * math.pi / 64.0) & (q < 2.0 * math.pi / 8.0)  # waves of 8 to 64 cells
amplitude = np.divide(1.0, q**1.8, out=np.zeros_like(q), where=band)  # Hurst exponent 0.8
spectrum = amplitude * np.exp(2j * math.pi * np.random.default_rng(0).random(q.shape))
slope = 0.1  # rms of the surface's gradient
spectrum *= slope / np.fft.irfft2(q * spectrum, s=(n, n)).std()
heights = np.fft.irfft2(spectrum, s=(n, n))

print("mean pressure/E*   real area   Persson")
pressures, areas = (0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.2), []
for pressure in pressures:
    contact = warpwear.solve_contact(heights, cell=1.0, mean_pressure=pressure, modulus=modulus)
    fraction = contact.area / contact.nominal_area
    areas.append(fraction)
    print(f"{pressure:16g} {fraction:11.4f} {math.erf(math.sqrt(2.0) * pressure / (modulus * slope)):9.4f}")

fig, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.loglog(pressures, areas, "o", label="computed")
axes.loglog(pressures, [math.erf(math.sqrt(2.0) * p / (modulus * slope)) for p in pressures], label="Persson")
axes.set(xlabel="mean pressure over E*", ylabel="real area over nominal area")
axes.legend()
fig.savefig("area.png")
