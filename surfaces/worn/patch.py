"""A worn patch and the rim beside it: how far they reach, their volumes, and the errors of these."""

import math
from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.outliers import robust_deviation
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.waviness import waviness

ndimage = lazy.module("scipy.ndimage")

RINGS = 40  # around the patch, looked at for its edge; each is 3 % of its mean radius wide, or 2 pixels
RING_WIDTH = 0.03  # of the patch's mean radius
RIM = 0.15  # of the patch's mean radius: the width beside it that is neither worn nor fitted
SURE = 3.0  # standard errors by which pile-up beyond the crossing ring stands out
CLEAR = 4.0  # times the scatter of the unworn surface: a point farther from the form is clearly on one side
FEWEST_POINTS = 16  # along each side of a field
PILE_MARGIN = 0.4  # of the width of pile-up, added to it
SMOOTHED = 5  # pixels along each side of the mean that tells a scar's edge
INWARDS = 3  # rings within the edge of a smoothed scar at which it may end already: smoothing spreads it
BLOCKS = 8  # along each side of the field, whose means tell how far roughness averages out
CELLS = 14  # along each side of the field, about, at which the error of a volume looks at the unworn surface
LEAST_CELL = 0.5  # of a cell that must be unworn
LEAST_BLOCK = 0.25  # of a block that must be unworn


@dataclass(frozen=True, kw_only=True, eq=False)
class Patch:
    """A worn patch lies below the unworn form of its body, and its rim beside it, with pile-up if any."""

    pixel: tuple[float, float]  # [mm]
    lost: FloatArray  # depth below the unworn form [mm], shape (nx, ny)
    patch: BoolArray  # the worn points, shape (nx, ny)
    rim: BoolArray  # those beside them that are neither worn nor fitted, shape (nx, ny)
    unworn: BoolArray  # those that the form went through, shape (nx, ny)
    volume: float  # sum of `lost` over the patch, roughness averaged out [mm³]
    volume_error: float  # its standard error: of outline, roughness and waviness, also under the fit [mm³]
    piled_up: float  # net volume above the form in the rim [mm³]; roughness may make it negative
    piled_up_error: float  # its standard error [mm³]
    net: float  # volume less what is piled up [mm³]
    net_error: float  # its standard error [mm³]
    area: float  # of the patch [mm²]
    area_error: float  # its standard error: how sharply the depth tells the edge [mm²]
    edge_error: float  # standard error of the form's height over the outline [mm]
    depth: float  # largest [mm]
    along: float  # extent of the patch along axis 0 [mm]
    across: float  # extent of the patch along axis 1 [mm]
    length_errors: tuple[float, float]  # standard errors of both extents: of the outline [mm]
    noise: float  # robust scatter of the unworn surface [mm]


@dataclass(frozen=True, eq=False)
class Reach:
    """A patch reaches as far as its rings lie below the unworn form, and its rim beyond."""

    patch: BoolArray  # shape (nx, ny)
    rim: BoolArray  # shape (nx, ny)
    other: BoolArray  # the patch with another outline that is as likely, shape (nx, ny)
    doubtful: float  # area of the patch's last ring, of which a part alone lies below the form [mm²]
    blur: float  # standard error of the patch's area [mm²]


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedBody:
    """A worn body lies below its unworn form, which was fitted to what is not worn of it."""

    lost: FloatArray  # depth below the form [mm], shape (nx, ny)
    unworn: BoolArray  # points that the form went through, shape (nx, ny)
    pixel: tuple[float, float]  # [mm]
    terms: FloatArray  # of the form, shape (terms, nx, ny)

    @property
    def pixel_area(self) -> float:
        """Return the area of a pixel [mm²]."""
        return self.pixel[0] * self.pixel[1]

    def worn_patch(self, reach: Reach, *, noise: float, hurst: float) -> Patch:
        """Measure a patch that reaches so far: its volumes and its area, with their errors.

        noise: scatter of the unworn surface [mm]; hurst: likely exponent of its waviness. Raises InputError
        where too little is unworn to tell the errors.
        """
        lost, patch, rim, area = self.lost, reach.patch, reach.rim, self.pixel_area
        # where no outline is crossed, where within the rim the patch ends is not known: half, on average
        ending = 0.5 * rim if reach.doubtful else 0.0
        inside, outside = (ndimage.distance_transform_edt(side) for side in (patch, ~patch))
        edge = inside + outside <= INWARDS
        weights = [np.asarray(w, dtype=np.float64) for w in (patch + ending, rim, patch | rim, edge)]
        errors = self._errors(weights, hurst=hurst)
        worn, piled_up = float(lost[patch].sum()) * area, -float(lost[rim].sum()) * area
        outlined = worn - float(lost[reach.other].sum()) * area
        along, across = extents(patch, self.pixel)
        # both ends are off as the whole outline is, of an ellipse of these axes, and told to a pixel each
        outline = 4.0 * reach.blur / (math.pi * max(along + across, max(self.pixel)))
        end_errors = [math.hypot(outline, d / math.sqrt(6.0)) for d in self.pixel]
        return Patch(
            pixel=self.pixel,
            lost=lost,
            patch=patch,
            rim=rim,
            unworn=self.unworn,
            volume=worn,
            volume_error=math.hypot(errors[0], outlined),
            piled_up=piled_up,
            piled_up_error=math.hypot(errors[1], outlined),
            net=worn - piled_up,
            net_error=errors[2],
            area=float(patch.sum()) * area - 0.5 * reach.doubtful,
            area_error=reach.blur,
            edge_error=errors[3] / (float(edge.sum()) * area),
            depth=float(lost[patch].max()),
            along=along,
            across=across,
            length_errors=(end_errors[0], end_errors[1]),
            noise=noise,
        )

    def grown(self, seed: BoolArray, near: BoolArray, *, noise: float = 0.0, inwards: int = 0) -> Reach:
        """Return the whole patch about its deeper part, and the rim beside it, with pile-up if there is any.

        seed: the deeper part, near: what may belong to the patch, shapes (nx, ny); inwards: rings within the
        deeper part at which it may end already; noise: scatter of the unworn surface [mm], for `inwards`.
        Rings about the deeper part are added while they lie below the unworn form on average by more than a
        standard error; then, to the rim, while they lie above it so. With `inwards` the outline beside
        pile-up is found point by point.
        """
        lost, pixel, area = self.lost, self.pixel, self.pixel_area
        mean_radius = math.sqrt(float(seed.sum()) * area / math.pi)
        width = max((1.0 if inwards else 2.0) * max(pixel), RING_WIDTH * mean_radius)
        distance = ndimage.distance_transform_edt(~seed, sampling=pixel)
        if inwards:
            distance -= np.maximum(ndimage.distance_transform_edt(seed, sampling=pixel) - max(pixel), 0.0)
        ring = np.maximum(np.ceil(distance / width) + inwards, 0.0).astype(np.int64)
        count = np.bincount(ring.ravel())
        mean = np.bincount(ring.ravel(), weights=lost.ravel()) / np.maximum(count, 1)
        error = np.sqrt(self._density() / (np.maximum(count, 1) * area))
        last = min(count.size, RINGS)
        edge = int(ring.min()) + 1
        while edge < last and mean[edge] > error[edge]:
            edge += 1
        patch = near & (ring < edge)
        end = edge
        if edge + 1 < last and mean[edge + 1] < -SURE * error[edge + 1]:
            end += 1  # the ring where heights cross the form has as much above as below
        while end < last and mean[end] < -error[end]:
            end += 1
        crossed = inwards > 0 and bool((mean[edge:end] < -SURE * error[edge:end]).any())
        other = patch
        if crossed:  # the ends of pile-up are low
            end += max(2, math.ceil(PILE_MARGIN * (end - edge)))
            # beside pile-up the outline is where heights cross the form, which no ring follows everywhere
            crossing = np.abs(ring - edge + 0.5) < inwards
            doubtful = crossing & (np.abs(lost) <= CLEAR * noise)
            patch = np.where(crossing, lost > 0.0, patch)
            patch, other = (np.where(doubtful, mostly(lost > 0.0, size), patch) for size in (SMOOTHED, 3))
        whole = math.sqrt(float(patch.sum()) * area / math.pi)
        outer = min(edge, count.size - 1)
        steps = float(error[outer]) / max(float(mean[edge - 1] - mean[outer]), float(error[outer]) + 1e-300)
        last_ring = float(count[edge - 1]) * area if edge > 1 else 2.0 * math.pi * whole * width
        # an outline that is crossed is told to a pixel, which a straight side of it, as of four, is wrong by
        # as a whole, and by how many points about it are asked; elsewhere any part of the last ring may be
        # worn
        side = 0.5 / math.sqrt(12.0) * last_ring / (width * min(pixel))
        outlines = math.hypot(float(patch.sum()) - float(other.sum()), side) * area
        return Reach(
            patch=patch,
            other=other,
            rim=~patch & (ring < max(end, edge + math.ceil(RIM * whole / width))),
            doubtful=0.0 if crossed else last_ring,
            blur=math.hypot(outlines if crossed else 0.5 * last_ring, steps * last_ring),
        )

    def _density(self) -> float:
        """Return the variance of a mean over an area, times that area [mm⁴], from blocks of unworn surface.

        The blocks have lost the terms of the fit as degrees of freedom. Roughness that is correlated over
        less than a block is counted in full. It is that of the median block: pile-up that is not yet told
        from unworn surface would else hide itself.
        """
        lost, unworn = self.lost, self.unworn
        nx, ny = lost.shape
        block = np.add.outer(np.arange(nx) * BLOCKS // nx * BLOCKS, np.arange(ny) * BLOCKS // ny).ravel()
        count = np.bincount(block, weights=unworn.ravel())
        total = np.bincount(block, weights=np.where(unworn, lost, 0.0).ravel())
        used = count >= max(LEAST_BLOCK * nx * ny / BLOCKS**2, 1.0)
        used = used if used.any() else count > 0
        blocks = int(used.sum())
        typical = robust_deviation(total[used] / np.sqrt(count[used]), 0.0)
        return typical**2 * self.pixel_area * blocks / max(blocks - len(self.terms), 1)

    def _errors(self, parts: list[FloatArray], *, hurst: float) -> list[float]:
        """Return the standard errors of volumes [mm³] over parts of the field: weights, shape (nx, ny).

        They are what fit and sum would find on unworn surface, as it lies beside the patch. The surface is
        taken as alike in all directions.
        """
        lost, unworn, pixel, terms = self.lost, self.unworn, self.pixel, self.terms
        x, y = places((lost.shape[0], lost.shape[1]), pixel)
        px, py = np.meshgrid(x, y, indexing="ij")
        spacing = max(math.sqrt(float(np.ptp(x) * np.ptp(y))) / CELLS, *pixel)
        row, column = (
            ((p - p[0] + 0.5 * d) // spacing).astype(np.int64) for p, d in zip((x, y), pixel, strict=True)
        )
        cell = np.unique(np.add.outer(row * (column[-1] + 1), column).ravel(), return_inverse=True)[1]

        def by_cell(values: FloatArray | BoolArray) -> FloatArray:
            return np.asarray(np.bincount(cell, weights=values.ravel()), dtype=np.float64)

        size, known = by_cell(np.ones(lost.shape)), by_cell(unworn)
        heights = by_cell(np.where(unworn, lost, 0.0)) / np.maximum(known, 1.0)
        middles = np.stack([by_cell(p) / size for p in (px, py)], axis=1)
        waves = waviness(
            heights,
            distances=np.hypot(*(np.subtract.outer(p, p) for p in middles.T)),
            unworn=known >= LEAST_CELL * size,
            terms=np.stack([by_cell(term) / size for term in terms], axis=1),
            spacing=spacing,
            hurst=hurst,
            plane=True,
        )
        fit = terms[:, unworn]
        factors_of_parts = [np.linalg.solve(fit @ fit.T, np.tensordot(terms, part, 2)) for part in parts]
        errors = []
        for part, factors in zip(parts, factors_of_parts, strict=True):
            weights: FloatArray = part - np.where(unworn, np.tensordot(factors, terms, 1), 0.0)
            alone = float(size @ by_cell(np.square(weights)))
            errors.append(waves.error(by_cell(weights), alone) * self.pixel_area)
        return errors


def extents(region: BoolArray, pixel: tuple[float, float]) -> tuple[float, float]:
    """Return how far a region, shape (nx, ny), extends along and across [mm], 0 where it is empty."""
    ends = [np.flatnonzero(region.any(axis=1 - axis)) for axis in (0, 1)]
    along, across = (float(e[-1] - e[0] + 1) * d if e.size else 0.0 for e, d in zip(ends, pixel, strict=True))
    return along, across


def mostly(chosen: BoolArray, size: int) -> BoolArray:
    """Return where most points of a square of so many pixels are chosen, shape (nx, ny)."""
    return np.asarray(ndimage.uniform_filter(chosen * 1.0, size, mode="nearest") > 0.5)


def check_points(shape: tuple[int, ...]) -> None:
    """Raise InputError where a field has too few points to tell a worn patch from."""
    if min(shape) < FEWEST_POINTS:
        raise InputError(f"the field has {shape[0]} × {shape[1]} points: {FEWEST_POINTS} a side are needed")
