"""What flows through the gap of a finished contact is found, by a cell problem of Reynolds' equation.

The unknowns are pressures in the middles of the cells, whose faces conduct by the harmonic mean of both gaps'
cubes. The matrix is factorised with its rows in the order of nested dissections (George 1973, SIAM J. Numer.
Anal. 10, 345): no solution then takes longer because channels are nearly closed.
"""

import math
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
    gap = np.where(contact.pressure > 0.0, 0.0, np.maximum(contact.gap, 0.0))
    mean = float(gap.mean())
    if contact.boundary in ("free", "line") or not math.isfinite(mean):
        raise InputError(
            f"boundary = {contact.boundary} is not possible for flow, under a counter-body neither: the gap "
            "must repeat."
        )
    needs = FACTORS * gap.size * np.log2(gap.size + 1.0)
    claim("flow_factors", f"gaps of shape {gap.shape}", dict.fromkeys(free_memory("cpu"), needs))
    if short_slope(gap) > SHORT_SLOPE:
        warnings.warn(
            f"the gap has waves of fewer than {FEWEST_CELLS} cells; what flows through it is that of the "
            "cells rather than of the surfaces.",
            stacklevel=3,
        )
    return FlowFactors(*through(gap / (mean or 1.0)), mean_gap=mean, nominal_gap=-contact.approach)


def short_slope(gap: FloatArray) -> float:
    """Return the share of the mean square slope in waves too short for the cells; a seam is no slope."""
    short, total = 0.0, 0.0
    for axis in (axis for axis in (0, 1) if gap.shape[axis] > 1):
        slope = np.diff(gap, axis=axis)
        square = np.fft.fftfreq(slope.shape[0])[:, np.newaxis] ** 2 + np.fft.rfftfreq(slope.shape[1]) ** 2
        power = np.abs(np.fft.rfft2(slope - slope.mean())) ** 2
        short += float(power[square > FEWEST_CELLS**-2].sum())
        total += float(power.sum())
    return short / (total or 1.0)


def through(gap: FloatArray) -> tuple[float, float, float, tuple[bool, bool]]:
    """Return what flows through a gap, over what does through a uniform one, and along which axes any does.

    gap: over its mean, so that these are ⟨g³ (1 + ∂χ)⟩ along both axes, and ⟨g³ ∂χ⟩ of a surface that slides
    along axis 0. Fluid that is shut in is carried along with it.
    """
    clusters, is_open = ways(gap > CLOSED)
    if not any(is_open):
        return 0.0, 0.0, float(gap.mean()), is_open
    height = np.where(clusters > 0, gap, math.inf)
    resistance = np.where(clusters > 0, height**-3.0, math.inf)
    conducting = np.stack([2.0 / (resistance + np.roll(resistance, -1, axis)) for axis in (0, 1)])
    dragged = 0.5 * conducting[0] * (height**-2.0 + np.roll(height, -1, 0) ** -2.0)
    sources = ((0, conducting[0]), (1, conducting[1]), (0, -dragged))
    right = np.stack([faces - np.roll(faces, 1, axis) for axis, faces in sources])
    flows = [
        float(np.mean(faces + conducting[axis] * (np.roll(pressure, -1, axis) - pressure)))
        for (axis, faces), pressure in zip(sources, solved(conducting, clusters, right), strict=True)
    ]
    along, across, left = flows * np.array([*is_open, is_open[0]])
    return float(along), float(across), float(gap.mean() + left), is_open


def ways(is_open: npt.NDArray[np.bool_]) -> tuple[IntArray, tuple[bool, bool]]:
    """Label the cells from which a way leads into the next period, from 1 on; tell along which axes one does.

    Labels of one period are joined over its edges, and each is given the number of its period, counted from
    one of those that are joined; where no numbers fit a way goes around.
    """
    labels, count = ndimage.label(is_open)
    pairs = [np.stack([np.take(labels, n, axis) for n in (-1, 0)]) for axis in (0, 1)]
    pairs = [np.unique(edge[:, edge.all(axis=0)], axis=1) for edge in pairs]
    steps = np.repeat(np.eye(2), [edge.shape[1] for edge in pairs], axis=0)
    sides = np.concatenate(pairs, axis=1)
    signs, places = np.repeat([-1.0, 1.0], len(steps)), np.tile(np.arange(len(steps)), 2)
    joins = sparse.coo_array((signs, (places, sides.ravel())), shape=(len(steps), count + 1)).tocsr()
    _, cluster = graphs.connected_components(abs(joins).T @ abs(joins), directed=False)
    held = np.zeros(count + 1)
    held[np.unique(cluster, return_index=True)[1]] = 1.0
    system = (joins.T @ joins + sparse.diags_array(held)).tocsc()
    goes_around = np.abs(joins @ solvers.splu(system).solve(joins.T @ steps) - steps) > 1.0e-6
    is_way = np.isin(cluster, cluster[sides[1][goes_around.any(axis=1)]])
    along, across = goes_around.any(axis=0).tolist()
    return np.where(is_way, cluster + 1, 0)[labels], (along, across)


def solved(conducting: FloatArray, clusters: IntArray, right: FloatArray) -> FloatArray:
    """Return the pressures under sources, shape (sources, nx, ny), 0 in one cell of each cluster."""
    cells = np.arange(clusters.size).reshape(clusters.shape)
    order = np.concatenate([*dissected(cells[1:, 1:]), cells[0], cells[1:, 0]])  # edges join both ends
    order = order[clusters.ravel()[order] > 0]
    place = np.zeros(clusters.shape, dtype=np.int64)
    place.ravel()[order] = np.arange(order.size)
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
    pressure = np.zeros((len(right), clusters.size))
    values = right.reshape(pressure.shape)[:, order]
    pressure[:, order] = solvers.splu(matrix, **options).solve(values.T).T
    return pressure.reshape(right.shape)


def dissected(cells: IntArray) -> list[IntArray]:
    """Return cells in the order of nested dissections: both halves, then the row between them."""
    if cells.size <= UNDIVIDED:
        return [cells.ravel()]
    rows = cells if cells.shape[0] >= cells.shape[1] else cells.T
    middle = len(rows) // 2
    return [*dissected(rows[:middle]), *dissected(rows[middle + 1 :]), rows[middle]]
