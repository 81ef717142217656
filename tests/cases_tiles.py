"""Surfaces and laws that lists of tiles must not change, shared by tests."""

from collections.abc import Callable

import numpy as np

from warpwear.grid import FloatArray

SHAPE, CELL = (150, 203), 0.005
LAWS = {
    "implicit": {"stepping.scheme": "implicit"},
    "implicit, no cap": {"stepping.scheme": "implicit", "contact.hardness": "inf MPa"},
    "elastic": {"stepping.scheme": "implicit", "contact.stiffness": "1.9e6 N/mm^3"},
    "explicit": {"stepping.scheme": "explicit", "contact.stiffness": "2e5 N/mm^3"},
    "bearing area": {"stepping.scheme": "explicit", "stepping.load_tolerance": "0.5 N"},
}


def rough(rng: np.random.Generator) -> FloatArray:
    return rng.normal(0.0, 1e-3, SHAPE).cumsum(axis=1) * 0.1


def plateaus(rng: np.random.Generator) -> FloatArray:
    return np.round(rng.normal(0.0, 2.0, SHAPE)) * 1e-3


def one_spike(rng: np.random.Generator) -> FloatArray:
    heights = rng.normal(0.0, 1e-4, SHAPE)
    heights[70, 101] = 0.05
    return heights


def flat(rng: np.random.Generator) -> FloatArray:
    return np.zeros(SHAPE)


def far_corners(rng: np.random.Generator) -> FloatArray:
    """Contact far from the middle first, and everywhere later."""
    heights = rng.normal(0.0, 1e-4, SHAPE)
    heights[3:9, 3:9] = heights[-9:-3, -9:-3] = 0.08
    return heights


SURFACES: list[Callable[[np.random.Generator], FloatArray]] = [rough, plateaus, one_spike, flat, far_corners]
