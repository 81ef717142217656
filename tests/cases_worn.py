"""Unworn surfaces of several kinds, with a groove or a flat of known volume cut into them."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.sphere import Sphere, places

PIXEL = 0.004
SHAPE = (200, 400)
SHARED = Path(__file__).parents[2] / "shared" / "surfaces"


def self_affine(rng, shape=SHAPE, *, roll_off=None, hurst=None):
    """Return a Gaussian surface, self-affine up to a wavelength [pixels], None: beyond the field."""
    hurst = rng.uniform(0.4, 0.9) if hurst is None else hurst
    whole = [2 * n for n in shape]  # a part of a longer one: no wave closes at the edges
    wave = np.hypot.outer(np.fft.fftfreq(whole[0]), np.fft.rfftfreq(whole[1]))
    wave[0, 0] = np.inf
    level = np.maximum(wave, 0.0 if roll_off is None else 1.0 / roll_off) ** (-1.0 - hurst)
    level *= np.exp(-np.square(3.0 * np.where(np.isinf(wave), 0.0, wave)))
    level[0, 0] = 0.0
    field = np.fft.irfft2(np.fft.rfft2(rng.normal(size=whole)) * level, s=whole)[: shape[0], : shape[1]]
    return field / field.std()


def rolled_off(rng, shape=SHAPE):
    """Return a self-affine surface without waves longer than a fraction of the field."""
    return self_affine(rng, shape, roll_off=rng.uniform(0.05, 0.15) * shape[1], hurst=0.8)


def turned(rng, shape=SHAPE):
    """Return a turned surface: marks of a nose in irregular steps and depths, waviness, fine roughness.

    Its lay is along the track, up to 20° off, or across.
    """
    x, y = places(shape, (PIXEL, PIXEL))
    angle = np.radians(rng.choice([0.0, rng.uniform(-20.0, 20.0), 90.0]))
    across = np.add.outer(np.sin(angle) * x, np.cos(angle) * y)
    feed, number = rng.uniform(0.06, 0.25), np.arange(-60, 61)
    line = np.linspace(-4.0, 4.0, 8000)
    middles = feed * (number + 0.05 * rng.normal(size=number.size))
    depths = 0.15 * rng.normal(size=number.size)
    marks = np.square(np.subtract.outer(line, middles) / feed) * 4.0 + depths
    marks = marks.min(axis=1)
    waves = np.interp(line, np.linspace(-4.0, 4.0, 2000), self_affine(rng, (8, 2000), hurst=0.8)[0])
    profile = (marks - marks.mean()) / marks.std() + rng.uniform(0.0, 0.6) * waves
    field = np.interp(across, line, profile)
    field += 0.25 * self_affine(rng, shape, roll_off=0.1 * shape[1], hurst=0.7)
    return field / field.std()


@cache
def _files():
    pytest.importorskip("SurfaceTopography")
    names = ("sur-2.sur", "x3p-2.x3p", "al3d-1.al3d")
    if not all((SHARED / name).is_file() for name in names):
        pytest.skip("the measured files are not here")
    return [read_measured(SHARED / name).levelled for name in names]


def real(rng, shape=SHAPE):
    """Return a part of a measured surface, turned and mirrored; it may be smaller than asked for."""
    field = _files()[rng.integers(3)]
    field = field.T if rng.random() < 0.5 else field
    field = field[:: rng.choice([1, -1]), :: rng.choice([1, -1])]
    size = [min(n, int(rng.uniform(0.5, 1.0) * n)) for n in field.shape]
    size[0] = min(size[0], 300)
    start = [rng.integers(0, n - m + 1) for n, m in zip(field.shape, size, strict=True)]
    field = field[start[0] : start[0] + size[0], start[1] : start[1] + size[1]]
    return field / field.std()


KINDS = {"turned": turned, "self-affine": self_affine, "rolled-off": rolled_off, "real": real}


def grooved(rng, kind, *, shape=SHAPE, depth=(2.0, 8.0)):
    """Return heights [mm] with a parabolic groove, its width [mm] and volume [mm³]. depth: in Sq."""
    field = 1.5e-3 * KINDS[kind](rng, shape)
    y = places(field.shape, (PIXEL, PIXEL))[1]
    extent = field.shape[1] * PIXEL
    width, middle = rng.uniform(0.15, 0.4) * extent, rng.uniform(-0.1, 0.1) * extent
    groove = 1.5e-3 * rng.uniform(*depth) * np.maximum(1.0 - np.square(2.0 * (y - middle) / width), 0.0)
    volume = float(groove.sum()) * PIXEL * field.shape[0] * PIXEL
    return field - groove + 0.01 * y, width, volume


def flattened(rng, kind, *, shape=(120, 110)):
    """Return heights [mm] of a rough ball of 3 mm that is cut flat, its pixel [mm] and the volume [mm³]."""
    pixel = 2.0 / shape[0]
    x, y = places(shape, (pixel, pixel))
    whole = Sphere((*rng.uniform(-0.1, 0.1, 2), 0.2), 3.0).heights(x, y)
    depth = rng.uniform(0.004, 0.03)
    worn = np.minimum(whole, 0.2 - depth)
    rough = KINDS[kind](rng, shape) * depth * rng.uniform(0.02, 0.12)
    return worn + rough, pixel, float((whole - worn).sum()) * pixel**2
