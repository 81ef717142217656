"""Two measurements of one place, before and after it was worn: shifted, turned, tilted, with a known scar."""

import math
from dataclasses import dataclass

import numpy as np
from cases_worn import KINDS, PIXEL, _files
from scipy import ndimage

from warpwear.errors import InputError
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.find_scar import find_scar, mean_profile
from warpwear.surfaces.worn.registration import difference

SHAPE = (130, 170)
SCARS = ("bowl", "piled", "stadium", "asperities")


@dataclass(frozen=True)
class Pair:
    """Heights after and before [mm], what the scar has taken and piled up [mm], and how they lie."""

    after: np.ndarray
    before: np.ndarray
    gone: np.ndarray
    piled: np.ndarray
    shift: tuple[float, float]
    angle: float

    def truth(self, window):
        """Volumes worn, piled up and net [mm³] in a window, and the worn area [mm²]."""
        gone, piled = self.gone[window], self.piled[window]
        worn, above = gone.sum() * PIXEL**2, piled.sum() * PIXEL**2
        return worn, above, worn - above, float((gone > 0).sum()) * PIXEL**2


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
    """Return what a scar takes from heights [mm] and piles up [mm], shape (nx, ny) each. sq: [mm]."""
    nx, ny = clean.shape
    x, y = (p - rng.uniform(-0.08, 0.08) * n * PIXEL for p, n in
            zip(places(clean.shape, (PIXEL, PIXEL)), clean.shape, strict=True))  # fmt: skip
    radius = rng.uniform(0.13, 0.2) * min(nx, ny) * PIXEL
    depth = sq * math.exp(rng.uniform(math.log(0.5), math.log(20.0)))
    far = np.maximum(np.abs(x) - (0.6 * radius if kind == "stadium" else 0.0), 0.0)
    r = np.hypot.outer(far, y * rng.uniform(0.8, 1.2)) / radius
    gone, piled = depth * np.maximum(1.0 - np.square(r), 0.0), np.zeros_like(clean)
    if kind == "asperities":  # a smooth bowl about the mean height takes what stands out of it, valleys stay
        gone = np.maximum(clean - clean.mean() - sq + 2.0 * sq * np.square(r), 0.0) * (r < 1.0)
    if kind in ("piled", "stadium"):
        lip = np.where(r > 1.0, 0.3 * depth * np.exp(-np.square((r - 1.15) / 0.12)), 0.0)
        piled = lip * np.clip((r - 1.0) / 0.05, 0.0, 1.0)
    return gone, piled


def pair(rng, kind, worn, *, shape=SHAPE, noise=0.03):
    """Return a `Pair` of a surface of a kind and a scar of a kind; noise: of the instrument, in Sq."""
    sq = 1.5e-3
    if kind == "real":
        field = _files()[rng.integers(3)]
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
    gone, piled = scar(rng, worn, clean, sq)
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
        shift,
        angle,
    )


@dataclass(frozen=True)
class Off:
    """By how many errors measured quantities are off, and these errors over the true values."""

    off: dict
    relative: dict


def off_by_errors(seed, kind, worn):
    """Measure a case: volumes, area, mean profile at every tenth place. Return the sentence of a refusal."""
    case = pair(np.random.default_rng(seed), kind, worn)
    try:
        both = difference(case.after, case.before, pixel=(PIXEL, PIXEL), earlier_pixel=(PIXEL, PIXEL))
        found = find_scar(both.heights, pixel=(PIXEL, PIXEL))
    except InputError as error:
        return str(error)
    truth = case.truth(both.window)
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
    profile = mean_profile(found)
    lost = (case.gone - case.piled)[both.window][profile.rows].mean(axis=0)
    off["profile"] = (profile.depth - lost)[::10] / profile.band
    relative["profile"] = profile.band / lost.max()
    return Off(off, relative)
