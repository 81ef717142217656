"""A measured wear scar beside the computed ones: depth maps and mean profiles on one scale, and numbers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.comparison.groups import RunData
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.snapshot import extents
from warpwear.measured.surface import Preparation, worn_in
from warpwear.measured.surface_report import patch_rows
from warpwear.result import Result
from warpwear.results.evolution import surface_evolution
from warpwear.results.report import Row, lines, record
from warpwear.results.track import blocks, extent
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.find_scar import ScarProfile, mean_profile
from warpwear.surfaces.worn.patch import Patch
from warpwear.surfaces.worn.scar import texture

fft, ndimage = lazy.module("scipy.fft"), lazy.module("scipy.ndimage")

#: Times by which a measured scar may be wider or narrower than a computed one: more is another unit.
ALIKE = 30.0
#: Part of the scar's length and width in whose middle its roughness is taken, as in a run.
MIDDLE = 0.5
#: Most blocks along a side of a track that is read.
BLOCKS = 2000
#: Part of the scar's length and width by which a computed one is shifted from middle to middle, at most.
REACH = 0.25
#: Parts of a computed patch's largest depth below which it is not part of the scar.
FOOT = 1e-3


@dataclass(frozen=True, eq=False)
class ComputedScar:
    """Hold what a run has taken off the disc, at the points of the measured scar."""

    name: str
    lost: FloatArray  # [mm], shape (nx, ny)
    profile: FloatArray  # mean over the rows of the measured profile [mm], shape (ny,)
    volume: float  # in the measured field [mm³]
    along: float  # [mm]
    across: float  # [mm]
    sq: float  # in the inner scar, without its form [µm], NaN where the run has none


@dataclass(frozen=True, eq=False)
class ScarComparison:
    """Hold a measured scar and those of runs, each laid where it agrees with the measured one best."""

    after: Path
    before: Path | None
    measured: Patch
    profile: ScarProfile
    sq: float  # in the inner scar of the later measurement, without its form [µm]
    x: FloatArray  # places from the middle of the scar [mm], shape (nx,)
    y: FloatArray  # [mm], shape (ny,)
    computed: tuple[ComputedScar, ...]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Return the first x, last x, first y, last y of the field [mm]."""
        return extent(self.x, self.y, self.measured.pixel[0] / 2, self.measured.pixel[1] / 2)


def compare_scar(
    after: Path, before: Path | None, preparation: Preparation, runs: Sequence[RunData]
) -> ScarComparison:
    """Measure a scar and lay those that runs have computed over it. before: the same place, None without.

    Raises InputError where no scar is found, no run has a whole field of wear, or sizes differ as units do.
    """
    known = [run for run in runs if "profile_disc" in run.courses]
    if not known:
        raise InputError("--scar needs a run with a snapshot of its whole field to compare with")
    worn = worn_in(after, "scar", preparation, before=before)
    scar, surface, changed = worn.body, worn.source, worn.changed
    profile = mean_profile(scar)
    heights = surface.measured if changed is None else surface.measured[changed.window]
    x, y = places((scar.lost.shape[0], scar.lost.shape[1]), scar.pixel)
    middle = _middle(np.where(scar.patch, np.maximum(scar.lost, 0.0), 0.0), x, y)
    through = profile.length > scar.along - 1.5 * scar.pixel[0]
    x, y = x - middle[0] * (not through), y - middle[1]
    computed = tuple(_computed(run, scar, profile, x, y, through=through) for run in known)
    sq = 1e3 * texture(_inner(heights, scar), cell=scar.pixel[0]).sq
    return ScarComparison(after, before, scar, profile, sq, x, y, computed)


def _computed(
    run: RunData, scar: Patch, profile: ScarProfile, x: FloatArray, y: FloatArray, *, through: bool
) -> ComputedScar:
    """Sample what a run has taken off the disc where it lies best at places x × y [mm]. Raises InputError.

    through: whether the scar is a groove through the field, of which no place along it is another.
    """
    lost, ends, sq = _taken_off(run)
    steps = [(b - a) / n for (a, b), n in zip((ends[:2], ends[2:]), lost.shape, strict=True)]
    grid = [a + (np.arange(n) + 0.5) * d for a, n, d in zip(ends[::2], lost.shape, steps, strict=True)]
    worn = lost > FOOT * lost.max()
    along, across = (float(worn.any(axis=1 - k).sum()) * steps[k] for k in (0, 1))
    _check_units(scar, run.name, across, float(lost.max()))
    centre = _middle(lost, *grid)
    size = [max(1, round(p / d)) for p, d in zip(scar.pixel, steps, strict=True)]
    smooth = ndimage.uniform_filter(lost, size, mode="nearest")

    def sampled_at(*middle: float) -> FloatArray:
        indices = [(p + c - g[0]) / d for p, c, g, d in zip((x, y), middle, grid, steps, strict=True)]
        points = np.meshgrid(*indices, indexing="ij")
        return np.asarray(ndimage.map_coordinates(smooth, points, order=1, mode="constant"))

    inside = np.where(scar.patch | scar.rim, scar.lost, 0.0)
    off = _shift(inside, sampled_at(*centre), (0 if through else scar.along, scar.across), scar.pixel)
    sampled = sampled_at(centre[0] - off[0], centre[1] - off[1])
    mean, volume = sampled[profile.rows].mean(axis=0), float(sampled.sum()) * scar.pixel[0] * scar.pixel[1]
    return ComputedScar(run.name, sampled, mean, volume, along, across, sq)


def _taken_off(run: RunData) -> tuple[FloatArray, tuple[float, float, float, float], float]:
    """Return what a run has taken off its disc [mm], (nx, ny), the extent of that [mm], and Sq there [µm].

    Raises InputError for a run that has worn nothing.
    """
    with Result.open(run.folder) as result:
        last, half = len(result.snapshots) - 1, 0.5 * run.study.grid.cell
        if run.study.is_swept:
            track = blocks(result, last, BLOCKS)
            lost, ends = track.loss, track.extent
        else:
            lost, ends = result.snapshot(last).wear_disc, extent(result.x, result.y, half, half)
        sq = float(surface_evolution(result).table["sq_disc"][-1])
    if not lost.max() > 0.0:
        raise InputError(f"{run.folder} has worn nothing off the disc: there is no scar to compare with")
    return lost, ends, sq


def _check_units(scar: Patch, name: str, across: float, depth: float) -> None:
    """Raise InputError for a scar so much wider or deeper than the computed one that its unit is another."""
    if not 1.0 / ALIKE <= scar.across / across <= ALIKE:
        raise InputError(
            f"--scar is {scar.across:.3g} mm wide, that of {name} {across:.3g} mm: the file's pixel has "
            "another unit; --pixel overrides what it says"
        )
    if not 1e-3 * ALIKE < scar.depth / depth < 1e3 / ALIKE:
        raise InputError(
            f"--scar is {1e3 * scar.depth:.3g} µm deep, that of {name} {1e3 * depth:.3g} µm: "
            "the file's heights have another unit; --height-unit overrides what it says"
        )


def _middle(lost: FloatArray, x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Return the mean place [mm] of x × y, weighted by the depth lost, shape (x.size, y.size)."""
    along, across = lost.sum(axis=1), lost.sum(axis=0)
    return float(along @ x / along.sum()), float(across @ y / across.sum())


def _shift(
    first: FloatArray, second: FloatArray, reach: tuple[float, float], pixel: tuple[float, float]
) -> tuple[float, float]:
    """Return the shift [mm] of the second field at which it correlates best with the first, (nx, ny) both.

    reach: `REACH` of these lengths [mm], 0 for none, are looked at. The best pixel is refined by a parabola.
    """
    size = [n + round(REACH * r / d) + 1 for n, r, d in zip(first.shape, reach, pixel, strict=True)]
    spectra = [fft.rfft2(field, s=size) for field in (first, second)]
    product = fft.irfft2(spectra[0] * np.conj(spectra[1]), s=size)
    most = [round(REACH * r / d) for r, d in zip(reach, pixel, strict=True)]
    lags = [np.arange(-n, n + 1) for n in most]
    near = product[np.ix_(lags[0] % size[0], lags[1] % size[1])]
    best = np.unravel_index(int(np.argmax(near)), near.shape)
    shift = []
    for axis, (place, lag, step) in enumerate(zip(best, lags, pixel, strict=True)):
        line = np.take(near, best[1 - axis], axis=1 - axis)
        fine = 0.0
        if 0 < place < line.size - 1:
            below, here, above = line[place - 1 : place + 2]
            fine = 0.5 * float(below - above) / min(float(below - 2.0 * here + above), -1e-300)
        shift.append((float(lag[place]) + fine) * step)
    return shift[0], shift[1]


def _inner(heights: FloatArray, scar: Patch) -> FloatArray:
    """Return heights [mm] in the middle of a scar, half as long and wide."""
    parts = extents(scar.patch)
    cuts = [round(0.5 * (1.0 - MIDDLE) * (part.stop - part.start)) for part in parts]
    rows, columns = (slice(part.start + n, part.stop - n) for part, n in zip(parts, cuts, strict=True))
    return heights[rows, columns]


def record_of(scar: ScarComparison) -> dict[str, Any]:
    """Return what is said of a measured scar and of each computed one, ready for JSON."""
    return {
        "measured": record(_rows_measured(scar)),
        "computed": {c.name: record(_rows_computed(scar, c)) for c in scar.computed},
    }


def lines_of(scar: ScarComparison) -> list[str]:
    """Write the lines of a comparison's text about a scar."""
    text = ["the scar measured", *lines(_rows_measured(scar))]
    for computed in scar.computed:
        text += [f"the scar of {computed.name}", *lines(_rows_computed(scar, computed))]
    return text


def _rows_measured(scar: ScarComparison) -> list[Row]:
    return [
        Row("file", "file", str(scar.after)),
        Row("before", "before", None if scar.before is None else str(scar.before)),
        *patch_rows(scar.measured),
        Row("Sq in the scar", "sq_um", scar.sq, digits=3, note="(its middle, form taken off)"),
    ]


def _rows_computed(scar: ScarComparison, computed: ComputedScar) -> list[Row]:
    m, c, band = scar.measured, computed, 1e3 * scar.profile.band
    gap, apart = (m.lost - c.lost)[m.patch], scar.profile.depth - c.profile
    depths, profiles = (1e3 * math.sqrt(float(np.square(v).mean())) for v in (gap, apart))
    of_net, error = "(net, in the measured field)", ("error_mm3", m.net_error)
    of_each, each = "(rms; ± of each place)", ("profile_error_um", band)
    size = [Row("along", "patch_along_mm", c.along), Row("across", "patch_across_mm", c.across)]
    return [
        Row("worn patch", "", size),
        Row("volume", "volume_mm3", c.volume),
        Row("Sq in the scar", "sq_um", None if math.isnan(c.sq) else c.sq, digits=3),
        Row("measured less it", "difference_mm3", m.net - c.volume, error=error, note=of_net),
        Row("depths differ by", "rms_um", depths, digits=3, note="(rms in the scar)"),
        Row("profiles by", "profile_rms_um", profiles, digits=3, error=each, note=of_each),
    ]
