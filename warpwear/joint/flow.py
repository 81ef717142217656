"""What flows through the gap of a finished contact is found, by a cell problem of Reynolds' equation.

The unknowns are pressures in the middles of the cells, whose faces conduct by the harmonic mean of both gaps'
cubes. The matrix is factorised with its rows in the order of nested dissections (George 1973, SIAM J. Numer.
Anal. 10, 345): no solution then takes longer because channels are nearly closed.
"""

import warnings
from typing import Any

import numpy as np
import numpy.typing as npt

from warpwear import lazy
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.found import FlowFactors
from warpwear.contact.array.memory import claim
from warpwear.engine.device import free_memory
from warpwear.errors import InputError
from warpwear.grid import FloatArray, IntArray

ndimage, sparse = lazy.module("scipy.ndimage"), lazy.module("scipy.sparse")
graphs, solvers = lazy.module("scipy.sparse.csgraph"), lazy.module("scipy.sparse.linalg")

#: Gap over its mean at which no flow is left that rounding does not hide.
CLOSED = 1.0e-5
#: Cells that are no longer divided.
UNDIVIDED = 16
#: Memory of the factors: of each cell, each time that the cells double [B].
FACTORS = 170.0
#: Cells of a wave below which the mesh decides, and the share of the gap's mean square slope in shorter waves
#: from which it is said.
FEWEST_CELLS = 4
SHORT_SLOPE = 0.1


def flow_factors(contact: ArrayContact) -> FlowFactors:
    """Return what `ArrayContact.flow_factors` does."""
    if contact.boundary in ("free", "line"):
        raise InputError(
            f'boundary = "{contact.boundary}" is not possible for flow, which needs a gap that repeats; it '
            'must be "periodic".'
        )
    gap = np.where(contact.pressure > 0.0, 0.0, np.maximum(contact.gap, 0.0))
    mean = float(gap.mean())
    if not np.isfinite(mean):
        raise InputError("the gap is infinite beyond the counter-body; flow needs one that repeats.")
    needs = FACTORS * gap.size * np.log2(gap.size + 1.0)
    claim("flow_factors", f"a gap of shape {gap.shape}", dict.fromkeys(free_memory("cpu"), needs))
    if short_slope(gap) > SHORT_SLOPE:
        warnings.warn(
            f"the gap has waves of fewer than {FEWEST_CELLS} cells; what flows through it is that of the "
            "cells rather than of the surfaces.",
            stacklevel=3,
        )
    (along, across, shear), is_open = through(gap / (mean or 1.0))
    return FlowFactors(
        along=along,
        across=across,
        shear=shear,
        is_open=is_open,
        mean_gap=mean,
        nominal_gap=-contact.approach,
    )


def short_slope(gap: FloatArray) -> float:
    """Return the share of the mean square slope that lies in waves too short for the cells."""
    along, across = np.fft.fftfreq(gap.shape[0]), np.fft.rfftfreq(gap.shape[1])
    square = along[:, np.newaxis] ** 2 + across**2
    slopes = square * np.abs(np.fft.rfft2(gap)) ** 2
    return float(slopes[square > FEWEST_CELLS**-2].sum() / (slopes.sum() or 1.0))


def through(gap: FloatArray) -> tuple[tuple[float, float, float], tuple[bool, bool]]:
    """Return what flows through a gap over what does through a uniform one, and along which axes any does.

    gap: over its mean, so that these are ⟨g³ (1 + ∂χ)⟩ along both axes, and ⟨g³ ∂χ⟩ of a surface that slides
    along axis 0. Fluid that is shut in is carried along with it.
    """
    clusters, is_open = ways(gap > CLOSED)
    cubes = np.where(clusters > 0, gap, 0.0) ** 3
    conducting, dragged = np.zeros((2, *gap.shape)), np.zeros_like(gap)
    for axis, faces in enumerate(conducting):
        beyond, gap_beyond = np.roll(cubes, -1, axis), np.roll(gap, -1, axis)
        there = (cubes > 0.0) & (beyond > 0.0)
        np.divide(2.0 * cubes * beyond, cubes + beyond, out=faces, where=there)
        if axis == 0:  # what is dragged out of one half of a face and into the other
            np.divide(beyond * gap + cubes * gap_beyond, cubes + beyond, out=dragged, where=there)
    sources = ((0, conducting[0]), (1, conducting[1]), (0, -dragged))
    right = np.stack([faces - np.roll(faces, 1, axis) for axis, faces in sources], axis=-1)
    pressure = solved(conducting, clusters, right)
    along, across, left = (
        float(np.mean(faces + conducting[axis] * (np.roll(pressure[..., n], -1, axis) - pressure[..., n])))
        for n, (axis, faces) in enumerate(sources)
    )
    return (along * is_open[0], across * is_open[1], float(gap.mean()) + left * is_open[0]), is_open


def ways(is_open: npt.NDArray[np.bool_]) -> tuple[IntArray, tuple[bool, bool]]:
    """Label the cells from which a way leads into the next period, from 1 on; tell along which axes one does.

    Labels of one period are joined over its edges, and each is given the number of its period, counted from
    one of those that are joined; where no numbers fit a way goes around.
    """
    labels, count = ndimage.label(is_open)
    pairs = [np.stack([np.take(labels, n, axis) for n in (-1, 0)], axis=1) for axis in (0, 1)]
    pairs = [np.unique(edge[edge.all(axis=1)], axis=0) for edge in pairs]
    steps = np.repeat(np.eye(2), [len(edge) for edge in pairs], axis=0)
    last, first = np.concatenate(pairs).T
    number, shape = np.arange(last.size), (last.size, count + 1)
    joins = sum(
        sparse.csr_array((np.full(last.size, sign), (number, side)), shape=shape)
        for sign, side in ((-1.0, last), (1.0, first))
    )
    _, cluster = graphs.connected_components(abs(joins).T @ abs(joins), directed=False)
    held = np.zeros(count + 1)
    held[np.unique(cluster, return_index=True)[1]] = 1.0
    system = (joins.T @ joins + sparse.diags_array(held)).tocsc()
    periods = solvers.splu(system).solve(joins.T @ steps)
    goes_around = np.abs(joins @ periods - steps) > 1.0e-6
    along, across = goes_around.any(axis=0).tolist()
    is_way = np.isin(cluster, cluster[first[goes_around.any(axis=1)]])
    return np.where(is_way, cluster + 1, 0)[labels], (along, across)


def solved(conducting: FloatArray, clusters: IntArray, right: FloatArray) -> FloatArray:
    """Return the pressures under sources, shape (nx, ny, sources), 0 in one cell of each cluster."""
    cells = np.arange(clusters.size).reshape(clusters.shape)
    order = np.concatenate([*dissected(cells[1:, 1:]), cells[0], cells[1:, 0]])  # edges join both ends
    order = order[clusters.ravel()[order] > 0]
    place = np.empty(clusters.shape, dtype=np.int64)
    place.ravel()[order] = np.arange(order.size)
    pressure = np.zeros(right.shape)
    if not order.size:
        return pressure
    matrix: Any = 0.0
    for axis, faces in enumerate(conducting):
        there = faces > 0.0
        sides = place[there], np.roll(place, -1, axis)[there]
        matrix += sparse.coo_array((-faces[there], sides), shape=(order.size, order.size)).tocsr()
    matrix = matrix + matrix.T
    total = -matrix.sum(axis=0)
    total[np.unique(clusters.ravel()[order], return_index=True)[1]] *= 2.0
    matrix = (matrix + sparse.diags_array(total)).tocsc()
    options = {"permc_spec": "NATURAL", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    pressure.reshape(-1, right.shape[-1])[order] = solvers.splu(matrix, **options).solve(
        right.reshape(-1, right.shape[-1])[order]
    )
    return pressure


def dissected(cells: IntArray) -> list[IntArray]:
    """Return cells in the order of nested dissections: both halves, then the row between them."""
    if cells.size <= UNDIVIDED:
        return [cells.ravel()]
    rows = cells if cells.shape[0] >= cells.shape[1] else cells.T
    middle = len(rows) // 2
    return [*dissected(rows[:middle]), *dissected(rows[middle + 1 :]), rows[middle]]
