"""Courses of friction whose levels, jump and noise are known."""

from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray
from warpwear.measured.friction.events import LapMeans


@dataclass(frozen=True)
class Truth:
    """What a made course is: places in laps, the level that it comes to."""

    start: float  # 10 % of the jump
    width: float  # from 10 to 90 %
    low: float
    level: float
    overshoot: float


def made(seed: int, drift: float = 0.0) -> tuple[FloatArray, Truth]:
    """Return means of laps: low, a jump, an overshoot that decays, a level; noise of laps goes together.

    The noise is of first order, with a correlation of 0.3 to 0.9 from lap to lap: 2 to 19 laps are one.
    drift: the level comes to its end from below or above by less than this part of it, in a straight line.
    """
    dice = np.random.default_rng(seed)
    laps = int(dice.integers(300, 800))
    start, width = dice.uniform(15.0, 90.0), dice.uniform(1.5, 6.0)
    low, level = dice.uniform(0.12, 0.25), dice.uniform(0.45, 0.8)
    over, decay = dice.uniform(0.0, 0.15) * level, dice.uniform(10.0, 50.0)
    place = np.arange(laps) + 0.5
    ramp = np.clip(0.1 + 0.8 * (place - start) / width, 0.0, 1.0)
    after = np.clip(place - start - 1.125 * width, 0.0, None)
    high = level + over * np.exp(-after / decay)
    together, scatter = dice.uniform(0.3, 0.9), dice.uniform(0.01, 0.04) * level
    steps = dice.normal(size=laps + 200) * scatter * np.sqrt(1.0 - together**2)
    noise = np.zeros(laps + 200)
    for k in range(1, noise.size):
        noise[k] = together * noise[k - 1] + steps[k]
    to_end = (place - laps) / laps * dice.uniform(-drift, drift) * level
    cof = low + ramp * (high + to_end - low) + noise[200:] * np.where(ramp > 0.5, 1.0, 0.4)
    return cof, Truth(start, width, low, level, over)


def in_laps(cof: FloatArray) -> LapMeans:
    """Return a course with one mean a lap of 1 mm."""
    ones = np.ones(cof.size)
    return LapMeans(np.arange(cof.size) + 0.5, cof, 0.0 * ones, ones, 1.0, 1.0, "lap")
