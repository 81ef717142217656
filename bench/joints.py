"""Joints of random surfaces beside lines of the literature: `python bench/joints.py`, a few minutes.

Prints the tables of docs/validation/joints.md: conductance over the plastic and the elastic line for spectra,
and from plastic to elastic by H/(E* g). Surfaces are Gaussian, periodic, of an area of 1 and an E* of 1.
"""

import math
import sys

import numpy as np

import warpwear

#: Longest wave, roll-off (0: none), shortest wave in cells, Hurst exponent, over the side.
SPECTRA = [
    (0.25, 0.0, 16, 0.8),
    (0.25, 0.0, 32, 0.8),
    (0.25, 0.0, 64, 0.8),
    (0.5, 1 / 16, 16, 0.8),
    (0.25, 0.0, 16, 0.3),
    (0.125, 0.0, 32, 0.8),
]
RATIOS = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, math.inf)


def surface(
    n: int, seed: int, *, longest: float, roll_off: float, cut_off: int, hurst: float
) -> tuple[np.ndarray, float]:
    """Heights of an rms gradient of 1 over an area of 1, and their rms."""
    i = np.fft.fftfreq(n, 1.0 / n)[:, np.newaxis]
    j = np.fft.rfftfreq(n, 1.0 / n)
    k = np.hypot(i, j)
    knee = 1.0 / (roll_off or longest)
    there = (k >= 1.0 / longest) & (k <= n / cut_off)
    amplitude = np.where(there, np.maximum(k, knee) ** -(1.0 + hurst), 0.0)
    generator = np.random.default_rng(seed)
    waves = amplitude * (generator.standard_normal(k.shape) + 1j * generator.standard_normal(k.shape))
    heights = np.fft.irfft2(waves, s=(n, n))
    gradient = [np.fft.irfft2(waves * 2j * math.pi * q, s=(n, n)) for q in (i, j)]
    g = math.sqrt(sum(float(np.mean(part**2)) for part in gradient))
    return heights / g, float(heights.std() / g)


def shown(values: list[float]) -> str:
    return f"{np.mean(values):.2f} ± {np.std(values, ddof=1) / math.sqrt(len(values)):.2f}"


def over_lines(heights: np.ndarray, sigma: float, g: float, pressure: float, hardness: float) -> list[float]:
    """Conductance over the plastic line and over the elastic one, part of the area at H, A E* g/p."""
    contact = warpwear.solve_contact(
        g * heights, cell=1.0 / len(heights), mean_pressure=pressure, modulus=1.0,
        hardness=hardness, boundary="periodic", tolerance=1e-5,
    )  # fmt: skip
    m, length = g / math.sqrt(math.pi), contact.conductance()
    plastic = 1.25 * m / (g * sigma) * (pressure / hardness) ** 0.95
    elastic = 1.55 * m / (g * sigma) * (math.sqrt(2.0) * pressure / m) ** 0.94
    at = contact.area_at_hardness / contact.area
    return [length / plastic if plastic else math.nan, length / elastic, at, contact.area * g / pressure]


def bearing(heights: np.ndarray, sigma: float, part: float) -> float:
    """Conductance over the plastic line of the bearing area."""
    contact = warpwear.solve_contact(heights, cell=1.0 / len(heights), mean_pressure=part, hardness=1.0)
    line = 1.25 / math.sqrt(math.pi) / sigma * part**0.95
    return contact.conductance(boundary="periodic") / line


def main(n: int, crossing: int, seeds: int) -> None:
    print("| spectrum | plastic, P/H .003, .01, .03 | elastic, p/(E* g) .0015, .005, .015 |\n|---|---|---|")
    for longest, roll_off, cut_off, hurst in SPECTRA:
        like = {"longest": longest, "roll_off": roll_off, "cut_off": cut_off, "hurst": hurst}
        made = [surface(n, seed, **like) for seed in range(seeds)]
        plastic = [[bearing(*one, part) for one in made] for part in (0.003, 0.01, 0.03)]
        elastic = [
            [over_lines(*one, 0.1, 0.1 * load, math.inf)[1] for one in made]
            for load in (0.0015, 0.005, 0.015)
        ]
        texts = ["  ".join(map(shown, rows)) for rows in (plastic, elastic)]
        print(f"| {longest:g}, {roll_off:g}, {cut_off}, {hurst:g} | {texts[0]} | {texts[1]} |", flush=True)
    print("\n| H/(E* g) | share at H | G/plastic line | G/elastic line | A E* g/p |\n|---|---|---|---|---|")
    like = {"longest": 0.5, "roll_off": 1 / 8, "cut_off": 16, "hurst": 0.8}
    made = [surface(crossing, 100 + seed, **like) for seed in range(seeds)]
    for ratio in RATIOS:
        rows = np.array([over_lines(*one, 0.1, 0.1 * 0.01, 0.1 * ratio) for one in made])
        plastic, elastic, at, area = (list(column) for column in rows.T)
        print(
            f"| {ratio:g} | {shown(at)} | {shown(plastic)} | {shown(elastic)} | {shown(area)} |", flush=True
        )


if __name__ == "__main__":
    main(*(int(one) for one in sys.argv[1:] or ("1024", "512", "5")))
