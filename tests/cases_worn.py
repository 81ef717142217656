"""Unworn surfaces of several kinds, with a groove, a flat or a scar of known volume cut into them."""

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage

from warpwear.errors import InputError
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.sphere import Sphere, places
from warpwear.surfaces.worn.find_scar import find_scar, mean_profile
from warpwear.surfaces.worn.patch import extents
from warpwear.surfaces.worn.registration import difference
from warpwear.surfaces.worn.track import find_track

PIXEL = 0.004
SHAPE = (200, 400)
SHARED = Path(__file__).parents[2] / "shared" / "surfaces"
MEASURED = ("sur-2.sur", "x3p-2.x3p", "al3d-1.al3d")
#: Heights of the measured files once they are read; a benchmark puts them here from a file of its own.
FIELDS: list[np.ndarray] = []


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


def measured_fields():
    """Return heights of measured surfaces; skip where their files, or what reads them, are not here."""
    if not FIELDS:
        pytest.importorskip("SurfaceTopography")
        if not all((SHARED / name).is_file() for name in MEASURED):
            pytest.skip("the measured files are not here")
        FIELDS.extend(read_measured(SHARED / name).levelled for name in MEASURED)
    return FIELDS


def real(rng, shape=SHAPE):
    """Return a part of a measured surface, turned and mirrored; it may be smaller than asked for."""
    field = measured_fields()[rng.integers(3)]
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


FIELD = (130, 170)
#: Points along each side of a pixel, of which those within an outline are its part.
FINE = 8
SCARS = ("bowl", "piled", "stadium", "groove", "asperities")


@dataclass(frozen=True)
class Pair:
    """Heights after and before [mm], what the scar has taken and piled up [mm], and how they lie.

    worn: the part of each pixel within the scar's outline.
    """

    after: np.ndarray
    before: np.ndarray
    gone: np.ndarray
    piled: np.ndarray
    worn: np.ndarray
    shift: tuple[float, float]
    angle: float

    def truth(self, window):
        """Volumes worn, piled up and net [mm³] in a window, and the worn area [mm²]."""
        gone, piled = self.gone[window], self.piled[window]
        worn, above = gone.sum() * PIXEL**2, piled.sum() * PIXEL**2
        return worn, above, worn - above, float(self.worn[window].sum()) * PIXEL**2


def seen(field, shape, *, shift=(0.0, 0.0), angle=0.0):
    """Return the heights of a field seen by an instrument that is shifted [mm] and turned [rad]."""
    x, y = np.meshgrid(*places(shape, (PIXEL, PIXEL)), indexing="ij")
    moved = (
        math.cos(angle) * x - math.sin(angle) * y + shift[0],
        math.sin(angle) * x + math.cos(angle) * y + shift[1],
    )
    at = [p / PIXEL + 0.5 * (n - 1) for p, n in zip(moved, field.shape, strict=True)]
    return ndimage.map_coordinates(field, at, order=3)


def scar(rng, kind, clean, sq):
    """Return what a scar takes from heights and piles up [mm], and its part of pixels, (nx, ny). sq: [mm]."""
    nx, ny = clean.shape
    middle = [rng.uniform(-0.08, 0.08) * n * PIXEL for n in (nx, ny)]
    radius = rng.uniform(0.13, 0.2) * min(nx, ny) * PIXEL
    depth = sq * math.exp(rng.uniform(math.log(0.5), math.log(20.0)))
    # a groove runs through the field
    straight, aspect = {"stadium": 0.6 * radius, "groove": np.inf}.get(kind, 0.0), rng.uniform(0.8, 1.2)

    def from_middle(fine):
        x, y = (p - m for p, m in zip(places((fine * nx, fine * ny), (PIXEL / fine, PIXEL / fine)), middle,
                strict=True))  # fmt: skip
        return np.hypot.outer(np.maximum(np.abs(x) - straight, 0.0), y * aspect) / radius

    r = from_middle(1)
    gone, piled = depth * np.maximum(1.0 - np.square(r), 0.0), np.zeros_like(clean)
    part = (from_middle(FINE) < 1.0).reshape(nx, FINE, ny, FINE).mean(axis=(1, 3))
    if kind == "asperities":  # a smooth bowl about the mean height takes what stands out of it, valleys stay
        gone = np.maximum(clean - clean.mean() + sq - 2.0 * sq * np.square(r), 0.0)
    if kind in ("piled", "stadium", "groove"):
        lip = np.where(r > 1.0, 0.3 * depth * np.exp(-np.square((r - 1.15) / 0.12)), 0.0)
        piled = lip * np.clip((r - 1.0) / 0.05, 0.0, 1.0)
    return gone, piled, part


def pair(rng, kind, worn, *, shape=FIELD, noise=0.03, half=None):
    """Return a `Pair` of a surface of a kind and a scar of a kind; noise: of the instrument, in Sq.

    half: 0 or 1 for a place in this half of a measured surface, None for any place.
    """
    sq = 1.5e-3
    if kind == "real":
        field = measured_fields()[rng.integers(3)]
        if half is not None:
            field = np.array_split(field, 2, axis=int(np.argmax(field.shape)))[half]
        field = (field.T if rng.random() < 0.5 else field)[:: rng.choice([1, -1]), :: rng.choice([1, -1])]
        start = [rng.integers(0, max(n - 400, 0) + 1) for n in field.shape]
        field = field[start[0] : start[0] + 400, start[1] : start[1] + 400]
        shape = tuple(min(round(0.8 * n), 200) for n in field.shape)
        field = sq * (field - field.mean()) / field.std()
    else:
        field = sq * KINDS[kind](rng, tuple(round(1.5 * n) for n in shape))
    angle = math.radians(rng.uniform(-3.0, 3.0))
    shift = tuple(rng.uniform(-0.06, 0.06, 2) * np.array(shape) * PIXEL)
    clean = seen(field, shape)
    gone, piled, part = scar(rng, worn, clean, sq)
    before = seen(field, shape, shift=shift, angle=angle)
    tilted = [
        np.add.outer(*(rng.uniform(-0.01, 0.01) * p for p in places(shape, (PIXEL, PIXEL)))) for _ in "ab"
    ]
    scatter = [noise * sq * rng.normal(size=shape) for _ in "ab"]
    return Pair(
        clean - gone + piled + tilted[0] + scatter[0],
        before + tilted[1] + scatter[1],
        gone,
        piled,
        part,
        shift,
        angle,
    )


@dataclass(frozen=True)
class Off:
    """By how many errors measured quantities are off, and these errors over the true values."""

    off: dict
    relative: dict
    points: list  # by which lengths are off; empty for a scar without an outline of its own


def lose(rng, heights, *, scattered=0.0, clumped=0.0, width=1.0, pits=0.0):
    """Return heights with parts of their points lost: any, in clumps of about a width [points], or pits."""
    if pits:
        low = ndimage.gaussian_filter(heights, 8.0) - heights
        low += 0.3 * low.std() * rng.normal(size=low.shape)
        return np.where(low > np.quantile(low, 1.0 - pits), np.nan, heights)
    rough = ndimage.gaussian_filter(rng.normal(size=heights.shape), width, mode="wrap")
    clumps = rough > np.quantile(rough, 1.0 - clumped) if clumped else False
    return np.where((rng.random(heights.shape) < scattered) | clumps, np.nan, heights)


def off_by_errors(seed, number, kind, worn, **lost):
    """Measure a case: volumes, area, lengths, mean profile at every tenth place.

    lost: of both files, see `lose`. Return the sentence of a refusal.
    """
    rng = np.random.default_rng([seed, number, list(KINDS).index(kind), SCARS.index(worn)])
    case = pair(rng, kind, worn)
    if lost:
        case = replace(case, after=lose(rng, case.after, **lost), before=lose(rng, case.before, **lost))
    try:
        both = difference(case.after, case.before, pixel=(PIXEL, PIXEL), earlier_pixel=(PIXEL, PIXEL))
        found = find_scar(both.heights, pixel=(PIXEL, PIXEL))
    except InputError as error:
        return str(error)
    truth = case.truth(both.window)
    points = []
    off = {
        "worn": (found.volume - truth[0]) / found.volume_error,
        "piled up": (found.piled_up - truth[1]) / found.piled_up_error,
        "net": (found.net - truth[2]) / found.net_error,
    }
    relative = {"worn": found.volume_error / truth[0], "net": found.net_error / abs(truth[2])}
    if truth[1]:
        relative["piled up"] = found.piled_up_error / truth[1]
    if worn != "asperities":  # of those the scar has the valleys, too
        off["area"] = (found.area - truth[3]) / found.area_error
        relative["area"] = found.area_error / truth[3]
        lengths = zip(
            (found.along, found.across), extents(case.gone[both.window] > 0.0, (PIXEL, PIXEL)), strict=True
        )
        points = [(length - true) / PIXEL for length, true in lengths]
        off["lengths"] = np.array(points) * PIXEL / found.length_errors
    if worn == "groove":
        with suppress(InputError):  # the narrow window beside a wide one is refused
            track, error = find_track(both.heights, pixel=(PIXEL, PIXEL)).volume()
            off["track"], relative["track"] = (track - truth[2]) / error, error / abs(truth[2])
    profile = mean_profile(found)
    lost = (case.gone - case.piled)[both.window][profile.rows].mean(axis=0)
    off["profile"] = (profile.depth - lost)[::10] / profile.band
    relative["profile"] = profile.band / lost.max()
    return Off(off, relative, points)
