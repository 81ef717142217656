"""What a pressure does to an elastic half-space, and the inverse that preconditions the solver.

Displacement and pressure are tied by a convolution, done in Fourier space by `transforms`.
"""

import math
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.contact.half_space.transforms import CupyTransforms, ScipyTransforms, Transforms, unfolded
from warpwear.engine.executor import Executor, Field
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid, IntArray
from warpwear.kernels.half_space import extension

fft = lazy.module("scipy.fft")

#: Modes in each direction that tell the weights of neighbours.
MODES_OF_WEIGHTS = 64
#: First and last row, first and last column.
Box = tuple[int, int, int, int]


class Operator(ABC):
    """A symmetric operator on the fields of an executor, and an approximate inverse, as filters of waves."""

    cells: int  # of the surface: what padding there is in the fields does not count
    shortest_response: float  # displacement under a pressure that alternates from cell to cell [mm/MPa]
    #: Ranges of slots for the threads, from 0 on; None: all, by whole rows.
    chunks: list[tuple[int, int]] | None = None

    _far: Transforms  # of the response, with a table of it
    _response: Any
    _near: Transforms  # of the inverse, with a table of what it divides by; may be those of the response
    _nearby: Any
    #: Whether it is one convolution of all cells, so that there are `coefficients`.
    of_one_grid = False
    #: Whether that repeats beyond the edges of the grid.
    wraps = False
    #: Weights with which next neighbours extend what the inverse is given; none where it is not extended.
    of_neighbours: Any = None
    #: A table of the response, and its coefficients by distance in cells.
    _coefficients: tuple[Any, Any] = None, None

    @abstractmethod
    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """Add to the elastic response [mm/MPa]: own × p of the cell, and streak × S S p.

        S is a mean along x over `window` cells, around each of them: of an even number the cell at either end
        counts half. None, or as many cells as the grid has rows: S is the mean of the line, and so is S S.
        """

    @property
    def transforms(self) -> int:
        """Pairs of transforms done so far, of the response and of its inverse."""
        return self._far.transforms + (self._near.transforms if self._near is not self._far else 0)

    def respond(
        self, pressure: Field, displacement: Field, *, counted: bool = True, single: bool = False
    ) -> None:
        """Displacement [mm] under a pressure [MPa], compliances included. counted: among the transforms.

        single: whether single precision will do, where the transforms have it.
        """
        self._far.filter(pressure, self._response, displacement, single=single)
        self._far.transforms -= not counted

    def coefficients(self, rows: IntArray, columns: IntArray) -> FloatArray:
        """Displacement of each cell listed under a unit pressure on each [mm/MPa], compliances included."""
        table, shape = self._response, self._far.shape
        if self._coefficients[0] is not table:
            # The response is even in both directions, so that a quarter of it is all.
            quarter = fft.irfft(table[: shape[0] // 2 + 1], n=shape[1], axis=1)[:, : shape[1] // 2 + 1]
            quarter = fft.irfft(quarter, n=shape[0], axis=0)[: shape[0] // 2 + 1]
            self._coefficients = table, np.ascontiguousarray(quarter)
        away = [np.abs(places[:, np.newaxis] - places) for places in (rows, columns)]
        along, across = (np.minimum(d, size - d) for d, size in zip(away, shape, strict=True))
        found: FloatArray = self._coefficients[1][along, across]
        return found

    def invert(self, displacement: Field, pressure: Field) -> None:
        """About the pressure [MPa] of a displacement [mm]: |q| E*/2 without compliances. May be in place."""
        self._near.filter(displacement, self._nearby, pressure, divide=True)


class Influence(Operator):
    """The operator G + c + streak of one grid and boundary, and an approximate inverse.

    modulus: E* of both bodies together [MPa]. boundary: "periodic" (the mean displacement is left out, since
    it has no limit: gaps count from the mean planes) or "free" (nothing outside the grid; the displacement is
    that of uniform pressures on square cells, exact; Love 1929, Phil. Trans. R. Soc. A 228, 377; Johnson,
    Contact Mechanics, 1985, section 3.3). Call `set_compliance` before use.
    """

    of_one_grid = True

    def __init__(self, executor: Executor, *, modulus: float, boundary: str) -> None:
        grid = executor.grid
        if not (math.isfinite(modulus) and modulus > 0.0):
            raise InputError(f"E* = {modulus:g} MPa is not possible; it must be positive and finite.")
        if boundary not in ("periodic", "free"):
            raise InputError(
                f'contact.boundary = {boundary!r} is unknown; allowed are "periodic" and "free".'
            )
        self._streak_cells = grid.nx
        self.wraps = boundary == "periodic"
        self.cells = grid.cells
        self.shortest_response = shortest_response(grid.cell, modulus)
        make = _transforms_of(executor)
        #: Shape of what is transformed for the response.
        self.far_shape = grid.shape if boundary == "periodic" else padded_shape(grid)
        self._far = make(executor, self.far_shape)
        if boundary == "periodic":
            self._near = self._far
            elastic = self._near.on_device(lambda xp: periodic_spectrum(grid, modulus, xp))
            self._elastic = self._near_elastic = self._near.table(elastic)
        else:
            self._near = make(executor, grid.shape, within=self._far)
            elastic = self._near.on_device(lambda xp: periodic_spectrum(grid, modulus, xp))
            # The mean that a periodic surface leaves out: that of a uniform pressure, about.
            elastic[0, 0] = 3.0 * elastic.max()
            self._near_elastic = self._near.table(elastic)
            self._elastic = self._far.table(free_quarter(grid, modulus, self.far_shape))
        self._steps = [max(1, size // MODES_OF_WEIGHTS) for size in grid.shape]
        few = elastic[:: self._steps[0], :: self._steps[1]]
        #: Modes of the inverse far apart, on the host.
        self._few: FloatArray = self._near.on_device(lambda xp: few.copy() if xp is np else few.get())
        self._weights: tuple[Any, extension.Weights] | None = None
        self._compliance: tuple[float, float, int] | None = None
        self.set_compliance(0.0, 0.0)

    @property
    def elastic(self) -> Any:
        """The table of the response without compliances, all rows of it."""
        return unfolded(self._elastic, self._far.shape[0])

    @property
    def near_elastic(self) -> Any:
        """The table of what the inverse divides by, likewise."""
        return unfolded(self._near_elastic, self._near.shape[0])

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """Add to the elastic response, as `Operator.set_compliance` says."""
        line = self._streak_cells
        asked = own, streak, line if window is None else min(window, line)
        if self._compliance == asked:
            return
        self._compliance = asked
        self._response = self._with(self._far, self._elastic, *asked)
        self._nearby = self._response
        if self._near is not self._far:
            self._nearby = self._with(self._near, self._near_elastic, *asked)

    def _with(self, transforms: Transforms, elastic: Any, own: float, streak: float, window: int) -> Any:
        if own == 0.0 and streak == 0.0:
            return elastic
        return transforms.added(elastic, own, streak * self._mean_of(transforms.shape[0], window))

    def lines(self, own: float, streak: float, window: int | None) -> tuple[FloatArray, FloatArray]:
        """What compliances, as of `set_compliance`, add to the response and its inverse, by row."""
        line = self._streak_cells
        window = line if window is None else min(window, line)
        of_response, of_inverse = (
            own + (streak * self._mean_of(rows, window) if streak else np.zeros(rows))
            for rows in (self._far.shape[0], self._near.shape[0])
        )
        return of_response, of_inverse

    def weights(self, own: float, streak: float, window: int | None) -> extension.Weights:
        """Weights of neighbours along x, along y and across corners, with which a cell needs no pressure.

        They are coefficients of the inverse under compliances, as of `set_compliance`, over that of the cell
        itself, by few modes.
        """
        if self._weights is None or self._weights[0] != (own, streak, window):
            shape = self._near.shape
            line = self.lines(own, streak, window)[1][:: self._steps[0], np.newaxis]
            response = self._few + line
            inverse = np.divide(1.0, response, out=np.zeros_like(response), where=response > 0.0)
            # A real transform holds half of the modes, without the other side of the first and the last.
            inverse[:, 1 : (shape[1] - 1) // (2 * self._steps[1]) + 1] *= 2.0
            along, across = (
                np.cos(2.0 * math.pi / size * step * np.arange(count))
                for size, step, count in zip(shape, self._steps, inverse.shape, strict=True)
            )
            rows = inverse.sum(axis=1), (inverse * across).sum(axis=1)
            sums = (along * rows[0]).sum(), rows[1].sum(), (along * rows[1]).sum()
            self._weights = (own, streak, window), extension.Weights(*(-one / inverse.sum() for one in sums))
        return self._weights[1]

    @property
    def of_neighbours(self) -> extension.Weights | None:
        """The `weights` of the compliances as they are set."""
        return None if self._compliance is None else self.weights(*self._compliance)

    def _mean_of(self, rows: int, window: int) -> FloatArray:
        """The spectrum of S S, which is that of its coefficients, of `rows` modes."""
        distance = np.minimum(np.arange(rows), rows - np.arange(rows))
        if window == self._streak_cells:
            return np.asarray(np.fft.fft(np.where(distance < window, 1.0 / window, 0.0)).real)
        inside = np.where(2 * distance < window, 1.0, np.where(2 * distance == window, 0.5, 0.0))
        return np.asarray(np.fft.fft(inside / window).real ** 2)


def _transforms_of(executor: Executor) -> Any:
    """The kind of transforms that works on the executor's fields."""
    return ScipyTransforms if executor.device.is_cpu else CupyTransforms


def displace(executor: Executor, pressure: Field, displacement: Field, *, modulus: float, box: Box) -> None:
    """Displacement [mm] of all cells of a free half-space under pressures [MPa] in a box of them, in float64.

    The convolution is padded no further than cells of the box and of the grid lie apart.
    """
    grid = executor.grid
    shape = apart_shape(grid, box)
    far = _transforms_of(executor)(executor, shape)
    far.filter(pressure, far.table(free_quarter(grid, modulus, shape)), displacement)


def apart_shape(grid: Grid, box: Box) -> tuple[int, int]:
    """An even shape on which the convolution of a box with the grid does not wrap, quick to transform.

    Two cells are no further apart than half of it, so that they feel each other one way round only.
    """
    furthest = (max(box[2 * n + 1], grid.shape[n] - 1 - box[2 * n]) for n in range(2))
    along, across = (
        2 * fft.next_fast_len(max(far, -(-size // 2)), real=True)
        for far, size in zip(furthest, grid.shape, strict=True)
    )
    return along, across


def periodic_spectrum(grid: Grid, modulus: float, xp: Any = np) -> Any:
    """2/(E*|q|) of the modes of a real transform [mm/MPa], shape (nx, ny//2 + 1), 0 for the mean.

    xp: NumPy, or CuPy: a billion modes take NumPy longer than their contact takes a GPU.
    """
    q_x = 2.0 * math.pi * xp.fft.fftfreq(grid.nx, grid.cell)
    q_y = 2.0 * math.pi * xp.fft.rfftfreq(grid.ny, grid.cell)
    spectrum = q_x[:, None] ** 2 + q_y**2
    spectrum[0, 0] = math.inf
    xp.sqrt(spectrum, out=spectrum)
    return xp.divide(2.0 / modulus, spectrum, out=spectrum)


def shortest_response(cell: float, modulus: float) -> float:
    """Displacement under a pressure that alternates from cell to cell [mm/MPa]."""
    return 2.0 * cell / (math.pi * modulus)


def padded_shape(grid: Grid) -> tuple[int, int]:
    """An even shape on which the convolution of the grid does not wrap, quick to transform."""
    along, across = (2 * fft.next_fast_len(size, real=True) for size in grid.shape)
    return along, across


def free_spectrum(grid: Grid, modulus: float, shape: tuple[int, int]) -> FloatArray:
    """Response of the modes of a real transform [mm/MPa], on an even shape: (shape[0], shape[1]//2 + 1)."""
    return np.asarray(unfolded(free_quarter(grid, modulus, shape), shape[0]))


def free_quarter(grid: Grid, modulus: float, shape: tuple[int, int]) -> FloatArray:
    """Its rows up to the middle, which the others repeat: (shape[0]//2 + 1, shape[1]//2 + 1).

    The coefficients are even in both directions: a cosine transform of a quarter of them is their spectrum.
    """
    coefficients = free_coefficients(grid.cell, modulus, shape[0] // 2 + 1, shape[1] // 2 + 1)
    return np.asarray(fft.dctn(coefficients, type=1, overwrite_x=True))


def free_coefficients(cell: float, modulus: float, rows: int, columns: int) -> FloatArray:
    """Displacement at a cell's centre under a unit pressure on another [mm/MPa], by distance in cells.

    Four corner terms, x ln(y + r) + y ln(x + r), over π E* (Johnson eq 3.25). Shape (rows, columns).
    """
    corners_x, corners_y = ((np.arange(n + 1) - 0.5)[:, np.newaxis] * cell for n in (rows, columns))
    x, y = corners_x, corners_y.T

    def by_hyperbolic_sine(factor: Any, over: Any, under: Any) -> FloatArray:
        """Terms by inverse hyperbolic sines: the logarithms differ by what cancels between the corners."""
        term = over / np.abs(under)
        np.arcsinh(term, out=term)
        term *= factor
        return np.asarray(term)

    corner = by_hyperbolic_sine(x, y, x)
    corner += corner.T if rows == columns else by_hyperbolic_sine(y, x, y)
    total = corner[1:, 1:] - corner[1:, :-1]
    total -= corner[:-1, 1:]
    total += corner[:-1, :-1]
    total /= math.pi * modulus
    return total
