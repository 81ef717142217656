"""How do I run a measured topography from a file, and what was done to it?

Writes a small file as a microscope's software might export it (a tilted array of heights in micrometres),
names it in a study and runs that. A file with its own units, such as .sur or .x3p, needs only its name.
"""

import numpy as np

import warpwear

rng = np.random.default_rng(4)
noise = np.fft.rfft2(rng.normal(size=(200, 200)))
waves = np.hypot(np.fft.fftfreq(200)[:, np.newaxis], np.fft.rfftfreq(200))
rough = np.fft.irfft2(noise * np.exp(-((waves / 0.04) ** 2)), s=(200, 200))
tilt = 0.02 * np.arange(200)
np.save("disc.npy", 3.0 * rough / rough.std() + tilt)  # µm

study = warpwear.Study.load("v3-fine").replace(
    {
        "disc.surface": "disc.npy",
        "disc.pixel": "10 um",
        "disc.height_unit": "um",
        "disc.level": "plane",  # takes the tilt away
        "grid.cell": "10 um",
        "sliding.distance": "30 mm",
    }
)
result = warpwear.run(study)
surface = result.record["surface"]
print("what was done:", ", ".join(str(key) for key in surface))
print(f"area in contact at the end: {result.history['area_contact'][-1]:.4f} mm²")
result.plot.pressure_map().savefig("pressure_map.png")
