"""The area within a scar's outline: where its depth comes to nothing, also where no point was measured."""

import math

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.filling import filled
from warpwear.surfaces.outliers import robust_deviation
from warpwear.surfaces.worn.patch import INWARDS, SMOOTHED, mostly

interpolate = lazy.module("scipy.interpolate")
ndimage = lazy.module("scipy.ndimage")
special = lazy.module("scipy.special")

LEVELS = 5  # of depth, whose areas are taken on to depth 0
LOWEST, HIGHEST = 3.0, 6.0  # of these, in standard deviations of the unworn surface: it hardly reaches them
RANGE = 0.2  # of the depth, that they cover at least: fewer pixels lie between levels of a steep edge
BENT = 2.0  # standard errors by which areas bend over these levels, to count
HALF = 0.5  # of the depth, that they do not exceed
CLEAR_OF_NOISE = 16.0  # standard deviations of the depth, for which means over more points are taken
WIDEST = 9  # points along each side of these means
BAND = 3.0  # points on both sides of an outline, whose distances to it are taken on into holes
FAR = 12  # points outside an outline, into which they are taken on
KNOTS = 400  # of these points, at most
FEWEST_KNOTS = 20  # that tell how an outline bends
SMOOTHING = 3.0  # of the surface through these distances, which are known to a pixel
PASSES = 2  # of taking them on: distances next to a hole depend on what is in it
HOLES = 8  # places that the holes are laid over, where the outline is known


def outlined(
    lost: FloatArray,
    *,
    main: BoolArray,
    core: BoolArray,
    measured: BoolArray,
    unworn: BoolArray,
    level: float,
) -> tuple[float, float]:
    """Return the area within a scar's outline and its standard error, in points.

    lost: depth below the unworn form [mm], main: the scar, a little wide, core: what is worn or enclosed by
    what is, measured, unworn: shapes (nx, ny); level: standard error of the form about the outline [mm].

    The points deeper than several levels above the noise are counted, less those that noise brings there; the
    count is taken on to depth 0 by a straight line over the level, as of any parabola. Noise at an edge moves
    points both ways, so that no count is drawn by it. Where holes hide the outline it goes on as it bends
    beside them. The error is of noise and form over the slope of the edge, of how the count bends over the
    level where that is clear, of the straight runs of pixels, and of the holes: of what is found if they lie
    elsewhere on the outline.
    """
    near = ndimage.binary_dilation(main | core, iterations=INWARDS + 1)
    for width in range(1, WIDEST + 1, 2):
        smooth = ndimage.uniform_filter(lost, width, mode="nearest")
        noise = robust_deviation(smooth[unworn], 0.0)
        depth = float(np.quantile(smooth[main & measured], 0.9))
        if depth > CLEAR_OF_NOISE * noise:
            break
    noise = max(noise, 1e-6 * depth)
    # points whose noise is one: what a mean over some scatters more than over as many independent ones
    means = robust_deviation(ndimage.uniform_filter(lost, SMOOTHED, mode="nearest")[unworn], 0.0)
    alike = max(width, SMOOTHED * means / noise) ** 2
    top = min(max(HIGHEST * noise, RANGE * depth), HALF * depth)
    levels = np.linspace(min(LOWEST * noise, 0.5 * top), top, LEVELS)
    # valleys between worn asperities, which are as deep as none of these levels
    inner = ndimage.binary_erosion(core, iterations=SMOOTHED, border_value=1)
    inner &= measured & (smooth <= levels[0])
    chances = [float((smooth[unworn] > at).mean()) for at in levels]
    # what lies farther off than distances are taken on has no part in it
    box = tuple(slice(max(0, s.start - FAR), s.stop + FAR) for s in ndimage.find_objects(near * 1)[0])
    smooth, near, inner, measured = (field[box] for field in (smooth, near, inner, measured))
    regions = [_whole((smooth > at) & near | inner, measured) for at in levels]
    counts = np.zeros(LEVELS)
    for n, (region, chance) in enumerate(zip(regions, chances, strict=True)):
        close = ndimage.binary_dilation(_largest(region), iterations=INWARDS) & near
        counts[n] = ((region & close).sum() - chance * float(close.sum())) / (1.0 - chance)
    # the weights of the values at level 0 of a straight line and of a parabola
    powers = np.stack([(levels / top) ** n for n in range(3)], axis=1)
    weights, bent = (np.linalg.pinv(powers[:, :terms])[0] for terms in (2, 3))
    slope = float(np.polyfit(levels, counts, 1)[0])
    region = _largest(regions[0])
    whole = _bent(region, measured)
    area = float(weights @ counts) + float(whole.sum()) - float(region.sum())
    moved = []
    if whole.sum() != _largest(whole & measured).sum():
        for shift in range(1, HOLES + 1):
            by = [round(shift * n / (HOLES + 1)) for n in measured.shape]
            known = np.roll(measured, by, axis=(0, 1))
            moved.append(float(_bent(_largest(_whole(whole, known)), known).sum()) - float(whole.sum()))
    # counts over two levels that are d deviations apart share ∫ p (1 - q) of independent heights
    apart = np.abs(np.subtract.outer(levels, levels)) / (math.sqrt(2.0) * noise)
    density = np.exp(-0.5 * np.square(apart)) / math.sqrt(2.0 * math.pi)
    shared = math.sqrt(2.0) * (density - apart * special.ndtr(-apart))
    # pixels are off like a sawtooth as an edge moves over them: by how many it does from level to level
    by_pixels, perimeter = _by_pixels(mostly(whole, SMOOTHED))
    steps = np.abs(np.subtract.outer(counts, counts)) / perimeter % 1.0
    shared = alike * abs(slope) * noise * shared + by_pixels * (1.0 - 6.0 * steps * (1.0 - steps))
    bend = float((bent - weights) @ counts) ** 2
    by_bend = bend if bend > BENT**2 * float((bent - weights) @ shared @ (bent - weights)) else 0.0
    by_holes = float(np.mean(np.square(moved))) if moved else 0.0
    variance = float(weights @ shared @ weights) + by_bend + (slope * level) ** 2 + by_holes
    return area, math.sqrt(variance)


def _whole(region: BoolArray, measured: BoolArray) -> BoolArray:
    """Return a region, shape (nx, ny), with what the points about a hole say of the hole."""
    return np.asarray(filled(np.where(measured, region * 1.0, np.nan)) > 0.5)


def _largest(region: BoolArray) -> BoolArray:
    """Return the largest connected part of a region, shape (nx, ny)."""
    labels = ndimage.label(region)[0]
    sizes = np.bincount(labels.ravel())
    return np.asarray(labels == 1 + int(np.argmax(sizes[1:]))) if sizes.size > 1 else region


def _bent(region: BoolArray, measured: BoolArray) -> BoolArray:
    """Return a region, shape (nx, ny), whose outline goes on through holes as it bends beside them.

    Distances to the outline, less than 0 outside, are taken on from where both the point and the outline next
    to it are known, by a thin plate over a quadratic form, which any ellipse nearly has.
    """
    for _ in range(PASSES):
        distance, signed = np.zeros(region.shape), measured.copy()
        for side, sign in ((region, 1.0), (~region, -1.0)):
            far, nearest = ndimage.distance_transform_edt(side, return_indices=True)
            distance[side] = sign * (far[side] - 0.5)
            signed &= ~side | measured[tuple(nearest)]
        knots = np.argwhere(signed & (np.abs(distance) < BAND))
        hidden = np.argwhere(~measured & ndimage.binary_dilation(region, iterations=FAR))
        if len(knots) < FEWEST_KNOTS or not len(hidden):
            break
        knots = knots[:: math.ceil(len(knots) / KNOTS)]
        plate = interpolate.RBFInterpolator(
            1.0 * knots, distance[tuple(knots.T)], smoothing=SMOOTHING, kernel="thin_plate_spline", degree=2
        )
        region = region.copy()
        region[tuple(hidden.T)] = plate(1.0 * hidden) > 0.0
        region = _largest(region)
    return region


def _by_pixels(region: BoolArray) -> tuple[float, float]:
    """Return the variance that pixels give an area, and its perimeter, in points.

    Where the outline runs along pixels it is off as a whole.

    That is a run between two steps to the same side, or to an end of the field: up to half a pixel off, each
    alike. Along a slope the runs between steps to and fro make up for each other, but for a pixel.
    """
    total, perimeter = 0.0, 0
    for side in (region, region[::-1], region.T, region.T[::-1]):
        inner, outer = (np.pad(rows, [(0, 0), (1, 1)]) for rows in (side[1:], side[:-1]))
        edges = inner & ~outer
        perimeter += int(edges.sum())
        first, last = (np.argwhere(edges & ~np.roll(edges, by, axis=1)) for by in (1, -1))
        for (row, begin), (_, end) in zip(first, last, strict=True):
            steps = {bool(outer[row, at]) for at in (begin - 1, end + 1) if 0 < at <= side.shape[1]}
            total += (float(end - begin + 1) if len(steps) < 2 else 1.0) ** 2 / 12.0
    return total, max(perimeter, 1)
