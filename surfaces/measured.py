"""Measured surfaces are prepared by a chain of operations, and interpolated at any points."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray, blocks_of_rows
from warpwear.surfaces.base import BoolArray, IntArray, refused, say, spacing
from warpwear.surfaces.levelling import low_pass, without_polynomial
from warpwear.surfaces.preparation import Preparation, prepare
from warpwear.surfaces.profiles.profile import prepared
from warpwear.surfaces.reading import Reading, read
from warpwear.surfaces.roughness import roughness
from warpwear.surfaces.spectrum import slope_against_cut_off

ndimage = lazy.module("scipy.ndimage")
sparse = lazy.module("scipy.sparse")

DEFAULT = Preparation()  # takes the plane off
CUT_OFF_CELLS = 2.0  # cut-off wavelength of the filter against aliasing: the shortest wave cells can carry
SLACK = 1e-9  # relative, for lengths that should be equal
SLOPE_CHANGE = 0.1  # of the rms slope when the shortest wavelength doubles: more is worth a notice
MUCH_MISSING = 2.0  # percent of the points
TILTED = 1.0  # percent by which heights over a tilted plane may be too large
MANY_OUTLIERS = 0.5  # percent of the points
SPIKE = 7.0  # times Sq: heights over the mean that random roughness of ten million points does not reach
SEAM = 3.0  # times the rms step between neighbours: a higher one, where copies meet, is a seam
ROWS = 32  # at each end of a lap, whose steps are compared with that where it closes
#: Columns that a profile is taken for, enough for a spline, and their distance [mm]: wider than any domain.
COLUMNS, WIDE = 16, 100.0
COARSE = 0.05  # mm: pixel and Sq both above it look like micrometres called millimetres


@dataclass(frozen=True, kw_only=True, eq=False)
class Measured:
    """A complete measurement is a surface: `levelled` heights [mm], shape (nx, ny), of pixels (px, py) [mm].

    The middle of the measurement is the middle of the contact. A pixel stands for its whole square, so the
    measurement is (nx·px, ny·py) wide. `extend` says what is beyond: "refuse" (an error), "mirror" (reflected
    at the outer edge, without seams) or "periodic" (repeated, with a seam unless the measurement has none).
    `filled` are the points that were not measured, shape (nx, ny), None without any. `is_profile` says that
    only a line along axis 0 was measured, which is taken alike across. `details` is what `record` says beside
    the roughness. Raises InputError, naming ``disc.extend``, for another word.
    """

    levelled: FloatArray
    pixel: tuple[float, float]
    extend: str = "refuse"
    filled: BoolArray | None = None
    is_profile: bool = False
    details: dict[str, Any]

    @property
    def size(self) -> tuple[float, float]:
        """Return the width of the measurement [mm] along axis 0 and axis 1."""
        return self.levelled.shape[0] * self.pixel[0], self.levelled.shape[1] * self.pixel[1]

    @property
    def _edge(self) -> str:
        """Return what is beyond the measurement, in the words of `scipy.ndimage`."""
        return "grid-wrap" if self.extend == "periodic" else "reflect"

    @property
    def measured(self) -> FloatArray:
        """Return the heights [mm] that were measured, shape (nx, ny), NaN elsewhere."""
        return self.levelled if self.filled is None else np.where(self.filled, np.nan, self.levelled)

    def filled_at(self, x: FloatArray, y: FloatArray) -> BoolArray | None:
        """Return whether the pixel at each point of x × y [mm] was filled, shape (x.size, y.size).

        It is None where none was.
        """
        if self.filled is None:
            return None
        triples = zip((x, y), self.levelled.shape, self.pixel, strict=True)
        return np.asarray(self.filled[np.ix_(*(_nearest(p, n, d, edge=self._edge) for p, n, d in triples))])

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [mm] at the points x × y [mm], shape (x.size, y.size), by cubic splines.

        Along an axis whose pixel is finer than the spacing of the points, the measurement is first low-passed
        against aliasing by the Gaussian filter of ISO 16610-61 (separable: 16610-21 along each axis) with a
        cut-off of two cells, where it transmits half. That takes the memory of two more fields. Points that
        are its pixels have the heights of these, to the last digit. Raises InputError, naming
        ``disc.extend``, where the points leave the measurement and `extend` is "refuse".
        """
        reach = _reach(x, y)
        if self.extend == "refuse" and self._is_exceeded(reach):
            raise refused("too_small", size=_pair(self.size), reach=_pair(reach))
        pixels = [_pixels(p, n, d) for p, n, d in zip((x, y), self.levelled.shape, self.pixel, strict=True)]
        if pixels[0] is not None and pixels[1] is not None:
            return self.levelled[pixels[0], pixels[1]].copy()
        edge, field = self._edge, self.levelled
        for axis, cut_off in enumerate(self._cut_offs((spacing(x), spacing(y)))):
            if cut_off is not None:
                field = low_pass(field, axis=axis, pixel=self.pixel[axis], cut_off=cut_off, edge=edge)
        knots = ndimage.spline_filter(field, order=3, mode=edge)
        along = _spline_rows(x, count=knots.shape[0], pixel=self.pixel[0], edge=edge)
        across = _spline_rows(y, count=knots.shape[1], pixel=self.pixel[1], edge=edge)
        sampled = np.empty((x.size, y.size))
        for block in blocks_of_rows(x.size, values=max(y.size, knots.shape[1])):
            sampled[block] = (across @ (along[block] @ knots).T).T
        return sampled

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Say whether the points x × y [mm] leave the measurement or are finer or coarser than its pixels.

        Further notices are of overridden units, many missing points or outliers, and an rms slope that
        depends on the shortest wavelength.
        """
        notices = list(self.details.get("doubts", []))
        if self.is_profile:
            notices.append("disc.surface is a profile: the disc is taken alike across sliding, as by a lay")
        reach = _reach(x, y)
        if self.extend != "refuse" and self._is_exceeded(reach):
            copies = " × ".join(f"{r / s:.1f}" for r, s in zip(reach, self.size, strict=True))
            how = "mirrored" if self.extend == "mirror" else "repeated"
            notices.append(say("copies", size=_pair(self.size), reach=_pair(reach), how=how, copies=copies))
        cells = (spacing(x), spacing(y))
        if self.extend == "periodic":
            triples = zip(reach, cells, self.size, strict=True)
            notices += self._seam([r + cell >= size * (1 - SLACK) for r, cell, size in triples])
        along, across = map(_sampling, self.pixel, cells, self._cut_offs(cells))
        if along != across and not self.is_profile:
            along = [f"along x: {text}" for text in along] + [f"along y: {text}" for text in across]
        filled_here = self.filled_at(x, y)
        here = 0.0 if filled_here is None else 100.0 * float(filled_here.mean())
        return (
            notices
            + along
            + self._doubts(max(*cells, *self.pixel[: 1 if self.is_profile else 2]), filled_percent=here)
        )

    def _seam(self, repeated: list[bool]) -> list[str]:
        """Say how high the seam is where the ends of a measurement that is repeated do not fit."""
        field = self.measured
        texts, highest = [], 0.0
        for axis in np.flatnonzero(repeated):
            heights = np.moveaxis(field, axis, 0)
            seam = _rms(heights[0] - heights[-1])
            if seam > SEAM * _rms(np.diff(heights, axis=0)):
                texts.append(f"{_um(seam)} rms along {'xy'[axis]}")
                highest = max(highest, seam)
        if not texts:
            return []
        times = highest / (float(np.nanstd(without_polynomial(field, degree=1))) or math.inf)
        return [
            f"the ends of the measurement do not fit: where it is repeated, the surface has a step of "
            f"{' and '.join(texts)}, {times:.2g} times Sq about the mean plane; "
            + ('disc.level = "plane" takes off a tilt, ' if self.details.get("level") == "none" else "")
            + 'disc.extend = "mirror" has no such step'
        ]

    def lap_seam(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Say how high the step from the last of the rows x [mm] to the first is, where it stands out."""
        first, last = self.heights(x[:ROWS], y), self.heights(x[-ROWS:], y)
        seam = _rms(first[0] - last[-1])
        if seam <= SEAM * _rms(np.diff([first, last], axis=1)):
            return []
        return [say("lap_seam", length=x.size * spacing(x), seam=_um(seam))]

    def record(self) -> dict[str, Any]:
        """Return file, format, grid, pixel, what was done, and the roughness of the measured points."""
        parameters = roughness(self.measured, pixel=self.pixel)
        return {
            "kind": "measured",
            **self.details,
            "extend": self.extend,
            **{f"{name}_um": parameters[name] * 1e3 for name in ("sa", "sq", "sz")},
            **{name: parameters[name] for name in ("ssk", "sku", "rms_slope")},
        }

    def _doubts(self, cell: float, *, filled_percent: float) -> list[str]:
        """Say what is uncertain about the measurement itself, sampled at points one cell [mm] apart.

        filled_percent: of those points.
        """
        doubts = []
        filled = 0.0 if self.filled is None else 100.0 * float(self.filled.mean())
        if max(filled, filled_percent) >= MUCH_MISSING:
            doubts.append(say("filled", filled=filled, filled_percent=filled_percent))
        more = 100.0 / math.cos(math.radians(self.details.get("tilt_degrees", 0.0))) - 100.0
        if more > TILTED:
            doubts.append(say("tilted", tilt=self.details["tilt_degrees"], more=more))
        sq = float(np.nanstd(self.measured))
        if min(self.pixel) > COARSE and sq > COARSE:
            pixel = _pair((1e3 * self.pixel[0], 1e3 * self.pixel[1]))
            doubts.append(say("large", pixel=pixel, sq=1e3 * sq, unit=self.details.get("unit")))
        highest = float(np.nanmax(self.measured)) / sq if sq > 0.0 else 0.0
        removed = self.details.get("outliers_removed", 0)
        if highest > SPIKE and not removed:
            doubts.append(say("spike", highest=highest))
        if (share := 100.0 * removed / self.levelled.size) > MANY_OUTLIERS:
            doubts.append(say("outliers_removed", removed=removed, share=share))
        shortest = max(2.0 * cell, self.details.get("s_filter_um", 0.0) * 1e-3)
        fine, coarse = slope_against_cut_off(
            self.levelled,
            pixel=self.pixel,
            cut_offs=np.array([shortest, 2.0 * shortest]),
            measured=None if self.filled is None else ~self.filled,
        )
        if fine - coarse > SLOPE_CHANGE * fine:
            doubts.append(
                say("short_waves", fine=fine, wave=_um(shortest), coarse=coarse, longer=_um(2 * shortest))
            )
        return doubts

    def _is_exceeded(self, reach: tuple[float, float]) -> bool:
        """Return whether a reach [mm] is wider than the measurement."""
        return any(r > s * (1 + SLACK) for r, s in zip(reach, self.size, strict=True))

    def _cut_offs(self, cells: tuple[float, float]) -> list[float | None]:
        """Return the cut-off [mm] of the filter along each axis for cells [mm], None where none is needed."""
        pairs = zip(cells, self.pixel, strict=True)
        return [CUT_OFF_CELLS * cell if pixel * (1 + SLACK) < cell else None for cell, pixel in pairs]


def read_measured(
    path: str | Path,
    preparation: Preparation = DEFAULT,
    *,
    extend: str = "refuse",
    pixel: float | tuple[float, float] | None = None,
    height_unit: str | None = None,
    array: str | None = None,
    profile: bool = False,
) -> Measured:
    """Read and prepare the surface in a measured file; its heights are over their mean.

    profile: whether it is a line along sliding, and the surface alike across.

    pixel [mm] (one, or one per axis of the file) and height_unit override the file; .npy needs both. array:
    which of several in the file. extend: see `Measured`. Raises InputError, naming the field of ``disc``, for
    anything that is no plausible areal measurement.
    """
    reading = read(path, pixel=pixel, height_unit=height_unit, array=array, profile=profile)
    whole, then = reading, preparation
    if profile:
        line = prepared(reading, crop=preparation.crop, deviations=preparation.outliers)
        whole, then = _alike_across(line, preparation), replace(preparation, crop=None, outliers=None)
    heights, filled, pixel, record = prepare(whole, then, name=str(path))
    details = {
        **_of_file(Path(path), reading),
        "sliding_axis": preparation.sliding_axis,
        "level": preparation.level,
        **record,
        "doubts": list(reading.doubts),
    }
    if preparation.s_filter is not None:
        details["s_filter_um"] = preparation.s_filter * 1e3
    heights.flags.writeable = False
    return Measured(
        levelled=heights, pixel=pixel, extend=extend, filled=filled, is_profile=profile, details=details
    )


def _alike_across(reading: Reading, preparation: Preparation) -> Reading:
    """Return a profile as columns of a map that is wider than any domain. Raises InputError."""
    for name in ("sliding_axis", "s_filter", "l_filter", "level"):
        value = getattr(preparation, name)
        if value in ("sphere", "cylinder") if name == "level" else value != getattr(DEFAULT, name):
            raise InputError(f"disc.{name} = {value!r} is for a map, disc.surface is a profile: leave it out")
    return replace(
        reading, heights=np.repeat(reading.heights[:, None], COLUMNS, axis=1), pixel=(reading.pixel[0], WIDE)
    )


def _of_file(path: Path, reading: Reading) -> dict[str, Any]:
    """Return what a file holds, for the record, before anything is done to it."""
    sides = list(zip(reading.pixel, reading.heights.shape, strict=False))  # one of a profile
    return {
        "file": path.name,
        "sha256": reading.digest,
        "format": reading.format,
        "unit": reading.unit,
        "unit_from": "study" if reading.unit_given else "file",
        "pixel_from": "study" if reading.pixel_given else "file",
        "file_grid": list(reading.heights.shape),
        "file_pixel_um": [1e3 * pixel for pixel, _ in sides],
        "file_extent_mm": [pixel * n for pixel, n in sides],
        "height_min_um": float(np.nanmin(reading.heights)) * 1e3,
        "height_max_um": float(np.nanmax(reading.heights)) * 1e3,
        "sq_as_read_um": float(np.nanstd(reading.heights)) * 1e3,
    }


def _reach(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Return the width [mm], along each axis, of a measurement centred at 0 that holds all the points."""
    return 2.0 * float(np.abs(x).max()), 2.0 * float(np.abs(y).max())


def _sampling(pixel: float, cell: float, cut_off: float | None) -> list[str]:
    """Say what the distances of pixels and of points [mm] along an axis make of the shortest waves."""
    if cut_off is not None:
        how = f"Gaussian low-pass (ISO 16610-61), cut-off {_um(cut_off)}, against aliasing"
        return [f"pixel {_um(pixel)} is finer than the cell {_um(cell)}: {how}"]
    if 0.0 < cell * (1 + SLACK) < pixel:
        lost = f"nothing shorter than {_um(2 * pixel)} is in the result"
        return [f"pixel {_um(pixel)} is coarser than the cell {_um(cell)}: {lost}"]
    return []


def _pixels(points: FloatArray, count: int, pixel: float) -> slice | None:
    """Return which pixels have their middles at the points along an axis [mm], None where not all do."""
    places = points / pixel + 0.5 * (count - 1)
    first = round(float(places[0]))
    if not 0 <= first <= count - points.size:
        return None
    apart = np.abs(places - np.arange(first, first + points.size)).max()
    return slice(first, first + points.size) if apart <= SLACK * count else None


def _spline_rows(points: FloatArray, *, count: int, pixel: float, edge: str) -> Any:
    """Return the matrix from spline coefficients along an axis to values at the points [mm].

    Its shape is (points.size, count): four weights of the cubic B-spline a row, their places folded back into
    the measurement.
    """
    place = points / pixel + 0.5 * (count - 1)
    first = np.floor(place)
    t = place - first
    # four pieces of the cubic B-spline
    pieces = (1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, 3 * (1 - t) ** 3 - 6 * (1 - t) ** 2 + 4, t**3
    weights = np.stack(pieces, axis=1)
    columns = _folded(first.astype(np.int64)[:, None] + np.arange(-1, 3), count, edge=edge)
    starts = np.arange(0, columns.size + 1, 4)
    return sparse.csr_array((weights.ravel() / 6.0, columns.ravel(), starts), shape=(points.size, count))


def _nearest(points: FloatArray, count: int, pixel: float, *, edge: str) -> IntArray:
    """Return the pixel at each of the points [mm] along an axis, shape (points.size,)."""
    return _folded(np.rint(points / pixel + 0.5 * (count - 1)).astype(np.int64), count, edge=edge)


def _folded(places: IntArray, count: int, *, edge: str) -> IntArray:
    """Return places beyond an axis of `count` pixels as those inside that they stand for."""
    if edge == "grid-wrap":
        return np.asarray(places % count)
    places = places % (2 * count)
    return np.minimum(places, 2 * count - 1 - places)


def _rms(values: FloatArray) -> float:
    """Return the root mean square of those values that are there, 0 without any."""
    finite = values[np.isfinite(values)]
    return math.sqrt(float(np.square(finite).mean())) if finite.size else 0.0


def _um(length: float) -> str:
    return f"{length * 1e3:.4g} µm"


def _pair(lengths: tuple[float, float]) -> str:
    return f"{lengths[0]:.4g} × {lengths[1]:.4g}"
