"""Measured surfaces: levelled, filled, and interpolated at any points."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.fft
import scipy.ndimage
import scipy.sparse

from warpwear.errors import InputError
from warpwear.surfaces.base import FloatArray, spacing
from warpwear.surfaces.levelling import filled, without_polynomial
from warpwear.surfaces.parameters import roughness
from warpwear.surfaces.reading import Reading, read

EXTENSIONS = ("refuse", "mirror", "periodic")
HIGHEST_DEGREE = 12
LARGEST_SQ = 1.0  # mm: above it a unit is wrong
CUT_OFF_CELLS = 2.0  # cut-off wavelength of the filter against aliasing: the shortest wave cells can carry
BLOCK_VALUES = 2**18  # 2 MiB of float64: what one block of rows may hold beside the output
SLACK = 1e-9  # relative, for lengths that should be equal


@dataclass(frozen=True, kw_only=True, eq=False)
class Measured:
    """A complete measurement: `levelled` heights [mm], shape (nx, ny), of pixels `pixel` (px, py) [mm].

    The middle of the measurement is the middle of the contact. A pixel stands for its whole square, so the
    measurement is (nx·px, ny·py) wide. `extend` says what is beyond: "refuse" (an error), "mirror" (reflected
    at the outer edge, without seams) or "periodic" (repeated, with a seam unless the measurement has none).
    `details` is what `record` tells beside the roughness.
    """

    levelled: FloatArray
    pixel: tuple[float, float]
    extend: str = "refuse"
    details: dict[str, Any]

    def __post_init__(self) -> None:
        _check_extend(self.extend)

    @property
    def size(self) -> tuple[float, float]:
        """Width of the measurement [mm] along axis 0 and axis 1."""
        return self.levelled.shape[0] * self.pixel[0], self.levelled.shape[1] * self.pixel[1]

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Heights [mm] at the points x × y [mm], shape (x.size, y.size), by cubic splines.

        Along an axis whose pixel is finer than the spacing of the points, the measurement is first low-passed
        against aliasing by the Gaussian filter of ISO 16610-61 (separable: 16610-21 along each axis) with a
        cut-off of two cells, where it transmits half. Takes two more fields of the measurement.
        InputError naming ``disc.extend`` where the points leave the measurement and `extend` is "refuse".
        """
        self._check_reach(x, y)
        edge = "grid-wrap" if self.extend == "periodic" else "reflect"
        field = self.levelled
        for axis, cut_off in enumerate(self._cut_offs(x, y)):
            if cut_off is not None:
                field = _low_pass(field, axis=axis, pixel=self.pixel[axis], cut_off=cut_off, edge=edge)
        knots = scipy.ndimage.spline_filter(field, order=3, mode=edge)
        along = _spline_rows(x, count=knots.shape[0], pixel=self.pixel[0], edge=edge)
        across = _spline_rows(y, count=knots.shape[1], pixel=self.pixel[1], edge=edge)
        sampled = np.empty((x.size, y.size))
        rows = max(1, BLOCK_VALUES // max(y.size, knots.shape[1]))
        for start in range(0, x.size, rows):
            sampled[start : start + rows] = (across @ (along[start : start + rows] @ knots).T).T
        return sampled

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Whether the points leave the measurement, were filtered for, or are finer than its pixels."""
        told = []
        reach = _reach(x, y)
        if any(r > s * (1 + SLACK) for r, s in zip(reach, self.size, strict=True)):
            told.append(
                f"the measurement, {_pair(self.size)} mm, is smaller than the grid, {_pair(reach)} mm, "
                + "and is "
                + ("mirrored" if self.extend == "mirror" else "repeated")
            )
        cells = (spacing(x), spacing(y))
        along, across = (
            _sampling(pixel, cell, cut_off)
            for pixel, cell, cut_off in zip(self.pixel, cells, self._cut_offs(x, y), strict=True)
        )
        if along == across:
            return told + along
        return told + [f"along x: {text}" for text in along] + [f"along y: {text}" for text in across]

    def record(self) -> dict[str, Any]:
        """File, format, grid, pixel, what was done, and the roughness of the levelled measurement."""
        found = roughness(self.levelled, pixel=self.pixel)
        return {
            "kind": "measured",
            **self.details,
            "extend": self.extend,
            "sa_um": found["sa"] * 1e3,
            "sq_um": found["sq"] * 1e3,
            "sz_um": found["sz"] * 1e3,
            "ssk": found["ssk"],
            "sku": found["sku"],
            "rms_slope": found["rms_slope"],
        }

    def _check_reach(self, x: FloatArray, y: FloatArray) -> None:
        needed = _reach(x, y)
        if self.extend == "refuse" and any(
            n > s * (1 + SLACK) for n, s in zip(needed, self.size, strict=True)
        ):
            raise InputError(
                f'disc.extend is "refuse" and the measurement, {_pair(self.size)} mm, is smaller than the '
                f'{_pair(needed)} mm needed: allowed is "mirror", "periodic" or a smaller grid'
            )

    def _cut_offs(self, x: FloatArray, y: FloatArray) -> tuple[float | None, float | None]:
        """Cut-off wavelength [mm] of the filter along each axis, None where none is needed."""
        along, across = (
            CUT_OFF_CELLS * spacing(points) if pixel * (1 + SLACK) < spacing(points) else None
            for points, pixel in zip((x, y), self.pixel, strict=True)
        )
        return along, across


def read_measured(
    path: str | Path,
    *,
    extend: str = "refuse",
    level: str | int = "plane",
    sliding_axis: str = "x",
    pixel: float | tuple[float, float] | None = None,
    height_unit: str | None = None,
) -> Measured:
    """The surface in a measured file.

    level: "plane" takes off the least-squares mean plane, a degree from 0 to 12 the polynomial of that total
    degree, "none" the mean height only (heights are over the mean plane by definition). Missing points are
    then filled from their rim, coarse to fine towards a harmonic surface (`levelling.filled`), and counted.
    sliding_axis: which of the file's axes lies along the sliding direction; "y" transposes.
    pixel [mm] (one, or one per axis of the file) and height_unit override the file; .npy needs both.
    InputError, naming the field of ``disc``, for anything that is no plausible areal measurement.
    """
    _check_extend(extend)
    degree = _degree(level)
    if sliding_axis not in ("x", "y"):
        raise InputError(f'disc.sliding_axis is {sliding_axis!r}: allowed is "x" or "y"')
    reading = read(path, pixel=pixel, height_unit=height_unit)
    heights, used = reading.heights, reading.pixel
    if sliding_axis == "y":
        heights, used = np.ascontiguousarray(heights.T), (used[1], used[0])
    levelled = without_polynomial(heights, degree=degree)
    sq = float(np.sqrt(np.nanmean(np.square(levelled))))
    if not sq <= LARGEST_SQ:
        raise InputError(
            f"disc.surface '{path}' has Sq = {sq:.3g} mm after levelling: allowed is at most "
            f"{LARGEST_SQ:g} mm, or give disc.height_unit"
        )
    missing = int(np.isnan(levelled).sum())
    details = _details(Path(path), reading, heights, level=level, sliding_axis=sliding_axis, missing=missing)
    details["sq_valid_points_um"] = sq * 1e3
    complete = filled(levelled)
    complete.flags.writeable = False
    return Measured(levelled=complete, pixel=used, extend=extend, details=details)


def _details(
    path: Path, reading: Reading, heights: FloatArray, *, level: str | int, sliding_axis: str, missing: int
) -> dict[str, Any]:
    nx, ny = reading.heights.shape
    px, py = reading.pixel
    done = {
        "none": "mean height taken off",
        "plane": "least-squares plane taken off",
    }.get(str(level), f"least-squares polynomial of degree {level} taken off")
    operations = [done]
    if sliding_axis == "y":
        operations.insert(0, "transposed: the file's y is along the sliding direction")
    if missing:
        operations.append("missing points filled from their rim (harmonic, coarse to fine)")
    return {
        "file": path.name,
        "format": reading.format,
        "unit": reading.unit,
        "unit_from": "study" if reading.unit_given else "file",
        "pixel_from": "study" if reading.pixel_given else "file",
        "file_grid": [nx, ny],
        "file_pixel_um": [px * 1e3, py * 1e3],
        "file_extent_mm": [nx * px, ny * py],
        "sliding_axis": sliding_axis,
        "level": level,
        "height_min_um": float(np.nanmin(heights)) * 1e3,
        "height_max_um": float(np.nanmax(heights)) * 1e3,
        "sq_as_read_um": float(np.nanstd(heights)) * 1e3,
        "missing": missing,
        "missing_percent": 100.0 * missing / heights.size,
        "operations": operations,
    }


def _check_extend(extend: str) -> None:
    if extend not in EXTENSIONS:
        raise InputError(f'disc.extend is {extend!r}: allowed is "refuse", "mirror" or "periodic"')


def _degree(level: str | int) -> int:
    degree = {"none": 0, "plane": 1}.get(level) if isinstance(level, str) else level
    if degree is None or isinstance(level, bool) or not 0 <= degree <= HIGHEST_DEGREE:
        raise InputError(
            f'disc.level is {level!r}: allowed is "none", "plane" or a polynomial degree from 0 to '
            f"{HIGHEST_DEGREE}"
        )
    return degree


def _reach(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Width [mm], along each axis, of a measurement centred at 0 that holds all the points."""
    return 2.0 * float(np.abs(x).max()), 2.0 * float(np.abs(y).max())


def _sampling(pixel: float, cell: float, cut_off: float | None) -> list[str]:
    if cut_off is not None:
        return [
            f"pixel {_um(pixel)} is finer than the cell {_um(cell)}: Gaussian low-pass (ISO 16610-61), "
            f"cut-off {_um(cut_off)}, against aliasing"
        ]
    if 0.0 < cell * (1 + SLACK) < pixel:
        return [
            f"pixel {_um(pixel)} is coarser than the cell {_um(cell)}: nothing shorter than {_um(2 * pixel)} "
            "is in the result"
        ]
    return []


def _low_pass(field: FloatArray, *, axis: int, pixel: float, cut_off: float, edge: str) -> FloatArray:
    """Gaussian low-pass of heights [mm] along an axis, pixel and cut-off in mm.

    ISO 16610-21: transmission exp(−π (α λc/λ)²), α² = ln 2/π, that is 2^−(λc/λ)². Applied to the waves
    themselves, since weights sampled at pixels are off where the cut-off is only a few of them.
    """
    count = field.shape[axis]
    if edge == "grid-wrap":
        frequency, shape = scipy.fft.rfftfreq(count, pixel), [1, 1]
        waves = scipy.fft.rfft(field, axis=axis)
    else:
        # the cosine transform is the Fourier transform of the field reflected at its outer edge
        frequency, shape = np.arange(count) / (2.0 * count * pixel), [1, 1]
        waves = scipy.fft.dct(field, type=2, axis=axis)
    shape[axis] = frequency.size
    waves *= np.exp2(-np.square(cut_off * frequency)).reshape(shape)
    if edge == "grid-wrap":
        smooth: FloatArray = scipy.fft.irfft(waves, n=count, axis=axis, overwrite_x=True)
    else:
        smooth = scipy.fft.idct(waves, type=2, axis=axis, overwrite_x=True)
    return smooth


def _spline_rows(points: FloatArray, *, count: int, pixel: float, edge: str) -> scipy.sparse.csr_array:
    """Matrix that takes spline coefficients along an axis to values at the points [mm]: (points.size, count).

    Four weights of the cubic B-spline a row, their places folded back into the measurement.
    """
    place = points / pixel + 0.5 * (count - 1)
    first = np.floor(place)
    t = place - first
    weights = np.stack(
        [(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, 3 * (1 - t) ** 3 - 6 * (1 - t) ** 2 + 4, t**3], axis=1
    )
    columns = first.astype(np.int64)[:, None] + np.arange(-1, 3)
    if edge == "grid-wrap":
        columns %= count
    else:
        columns %= 2 * count
        columns = np.minimum(columns, 2 * count - 1 - columns)
    starts = np.arange(0, columns.size + 1, 4)
    return scipy.sparse.csr_array(
        (weights.ravel() / 6.0, columns.ravel(), starts), shape=(points.size, count)
    )


def _um(length: float) -> str:
    return f"{length * 1e3:.4g} µm"


def _pair(lengths: tuple[float, float]) -> str:
    return f"{lengths[0]:.4g} × {lengths[1]:.4g}"
