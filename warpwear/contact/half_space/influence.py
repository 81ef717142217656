"""A pressure displaces an elastic half-space, and the inverse of that preconditions the solver.

Displacement and pressure are tied by a convolution, done in Fourier space by `filters`.
"""

import math
from functools import cached_property
from typing import Any

import numpy as np
import warp as wp

from warpwear import lazy
from warpwear.contact.half_space.convolution import fits
from warpwear.contact.half_space.filters import filter_of
from warpwear.contact.half_space.lines import line_quarter
from warpwear.contact.half_space.transforms import Filter, Grids, array_module
from warpwear.engine.executor import Executor, Field
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid, IntArray

fft = lazy.module("scipy.fft")

#: Modes in each direction that tell the weights of neighbours.
MODES_OF_WEIGHTS = 64
#: First and last row, first and last column.
Box = tuple[int, int, int, int]
#: What lies beyond the edges of the grid along and across sliding, by boundary: whether it is repeated.
BOUNDARIES = {"periodic": (True, True), "free": (False, False), "line": (False, True)}


class Influence:
    """Applies the operator G + c + streak of one grid and boundary, and an approximate inverse, as filters.

    Tables of the waves are made once. What compliances add to them is a line of numbers by row, in arrays
    that programs read when they run.

    modulus: E* of both bodies together [MPa]. boundary: "periodic" (the mean displacement is left out, since
    it has no limit: gaps count from the mean planes), "free" (nothing outside the grid; the displacement is
    that of uniform pressures on square cells, exact; Love 1929, Phil. Trans. R. Soc. A 228, 377; Johnson,
    Contact Mechanics, 1985, section 3.3) or "line" (nothing beyond the ends along x, repeated across; exact
    as well). datum: of a line, distance at which a line of pressure displaces nothing [mm]; by default the
    grid's length along x. side: of squares, of which each is a row of the executor's fields and displaces
    itself alone; by default all rows are one grid.
    """

    #: Ranges of slots for the threads, from 0 on; None: all, by whole rows.
    chunks: list[tuple[int, int]] | None = None

    def __init__(
        self,
        executor: Executor,
        *,
        modulus: float,
        boundary: str,
        datum: float | None = None,
        side: int | None = None,
    ) -> None:
        self._executor, self.is_one, device = executor, side is None, executor.device
        self._grid = grid = executor.grid if side is None else Grid(side, side, executor.grid.cell)
        self._grids = Grids.whole(executor) if side is None else Grids.squares(executor, side)
        #: Whether that repeats beyond the edges of the grid, along and across.
        self.wraps, periodic = BOUNDARIES[boundary], boundary == "periodic"
        #: Shape of what is transformed for the response.
        self.far_shape = padded_shape(grid, self.wraps)
        #: Of the surface: what padding there is in the fields does not count.
        self.cells = grid.cells * (1 if side is None else executor.grid.nx)
        #: Displacement under a pressure that alternates from cell to cell [mm/MPa].
        self.shortest_response = 2.0 * grid.cell / (math.pi * modulus)
        #: What compliances add to modes of the response and of its inverse, by row up to the middle.
        self.line, self.near_line = (
            wp.zeros(rows // 2 + 1, dtype=wp.float64, device=device) for rows in (self.far_shape[0], grid.nx)
        )
        #: The weights as programs read them: along x, along y and across corners.
        self.neighbours = wp.zeros(3, dtype=wp.float32, device=device)
        #: How many rows of the fields it is about, the first ones; an array of one number.
        self.visited = wp.full(1, executor.grid.nx, dtype=wp.int32, device=device)
        with array_module(executor) as xp:
            near = periodic_spectrum(grid, modulus, xp, rows=grid.nx // 2 + 1)
            if not periodic:
                # The mean that a periodic surface leaves out: that of a uniform pressure, about.
                near[0, 0] = 3.0 * near.max()
            #: Tables of the response without compliances and of what the inverse divides by, rows up to the
            #: middle. Squares have means of their own.
            self.near_elastic, self.elastic = near, near if self.is_one else near.copy()
            if boundary == "free":
                self.elastic = xp.asarray(free_quarter(grid, modulus, self.far_shape))
            elif boundary == "line":
                length = grid.nx * grid.cell if datum is None else datum
                self.elastic = xp.asarray(line_quarter(grid.cell, modulus, self.far_shape, length))
            along, across = (np.arange(0, n, max(1, n // MODES_OF_WEIGHTS)) for n in grid.shape)
            across = across[2 * across <= grid.ny]
            #: Lines of modes of the inverse far apart, and these modes, on the host.
            self._few_lines = np.minimum(along, grid.nx - along)
            few = near[xp.asarray(self._few_lines)[:, np.newaxis], xp.asarray(across)]
            self._few: FloatArray = few if xp is np else few.get()
        self._sums = _sums(grid.shape, along, across)
        #: What compliances add to the coefficients in a column, by distance along x, where that is read.
        self._along: Any = None
        self._compliance: tuple[float, float, int] | None = None
        self.set_compliance(0.0, 0.0)

    def add_response(
        self, program: Program, field_in: Field, field_out: Field, *, single: bool = False
    ) -> None:
        """Add to a program: displacement [mm] under a pressure [MPa], compliances included; may be in place.

        single: whether single precision will do.
        """
        (self._far_single if single else self._far).add_to(program, field_in, self.line, field_out)

    def add_inverse(self, program: Program, field_in: Field, field_out: Field) -> None:
        """Add to a program: about the pressure [MPa] of a displacement [mm], in single precision.

        It is |q| E*/2 without compliances. May be in place.
        """
        self._near.add_to(program, field_in, self.near_line, field_out, divides=True)

    def respond(self, pressure: Field, displacement: Field) -> None:
        """Compute the displacement [mm] under a pressure [MPa], compliances included, at once."""
        program = Program(self._executor)
        self.add_response(program, pressure, displacement)
        program.run()

    @cached_property
    def _far(self) -> Filter:
        """Return what makes the response, in double precision."""
        return self._filter(self.elastic, self.far_shape, np.float64)

    @cached_property
    def _far_single(self) -> Filter:
        """Return what makes the response in single precision, where that is quicker."""
        padded = self.far_shape != self._grid.shape
        if not self._executor.device.is_cpu or (padded and not fits(self.far_shape)):
            return self._far
        return self._filter(self.elastic, self.far_shape, np.float32, within=self._far)

    @cached_property
    def _near(self) -> Filter:
        """Return what makes the inverse, by a table of what it divides by."""
        # The inverse runs before the response, which then writes all that it reads: one memory for both.
        if self.is_one and all(self.wraps) and self._executor.device.is_cpu:
            return self._far_single
        return self._filter(self.near_elastic, self._grid.shape, np.float32, within=self._far)

    def _filter(self, table: Any, shape: tuple[int, int], kind: Any, within: Filter | None = None) -> Filter:
        return filter_of(self._executor, table, shape, kind, grids=self._grids, within=within)

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """Add to the elastic response [mm/MPa]: own × p of the cell, and streak × S S p.

        S is a mean along x over `window` cells, around each of them: of an even number the cell at either end
        counts half. None, or as many cells as the grid has rows: S is the mean of the line, and so is S S.
        Programs of this operator heed it, those recorded before as well.
        """
        rows = self._grid.nx
        compliance = own, streak, rows if window is None else min(window, rows)
        if self._compliance == compliance:
            return
        self._compliance = compliance
        for line, of_rows in ((self.line, self.far_shape[0]), (self.near_line, rows)):
            self._executor.put(line, self._line(of_rows, *compliance))
        self._executor.put(self.neighbours, self._weights(*compliance))
        if self._along is not None:
            self._executor.put(self._along, self._along_x)

    def _line(self, rows: int, own: float, streak: float, window: int) -> FloatArray:
        """Return what compliances add to the modes of rows, up to the middle."""
        if streak == 0.0:
            return np.full(rows // 2 + 1, own)
        return own + streak * self._mean_of(rows, window)[: rows // 2 + 1]

    def coefficients(self) -> tuple[Any, Any]:
        """Return the displacement under a unit pressure on a cell [mm/MPa], as arrays of the device.

        By distance in cells along both axes without compliances, which is even in both directions; and what
        compliances add to it in a column, by distance along x, which programs heed when they change.
        """
        if self._along is None:
            with array_module(self._executor) as xp:
                table = self.elastic if xp is np else self.elastic.get()
            (rows, columns), device = self.far_shape, self._executor.device
            quarter = fft.irfft(table, n=columns, axis=1)[:, : columns // 2 + 1]
            quarter = np.ascontiguousarray(fft.irfft(quarter, n=rows, axis=0)[: rows // 2 + 1])
            self._table: Field = wp.array(quarter, dtype=wp.float64, device=device)
            self._along = wp.array(self._along_x, dtype=wp.float64, device=device)
        return self._table, self._along

    @property
    def _along_x(self) -> FloatArray:
        rows = self.far_shape[0]
        # A line by row is a response of the cells of one column alone.
        return np.asarray(fft.irfft(self.line.numpy(), n=rows)[: rows // 2 + 1])

    def _weights(self, own: float, streak: float, window: int) -> FloatArray:
        """Return weights of neighbours along x, y and across corners, by which a cell needs no pressure.

        They are coefficients of the inverse under compliances over that of the cell itself, by few modes.
        """
        line = self._line(self._grid.nx, own, streak, window)
        response = self._few + line[self._few_lines, np.newaxis]
        inverse = np.divide(1.0, response, out=np.zeros_like(response), where=response > 0.0)
        sums = self._sums @ inverse.ravel()
        weights = -sums[1:] / sums[0]
        if self.wraps == BOUNDARIES["line"] and self._grid.ny < 3:
            weights[1:] *= 0.5 * (self._grid.ny - 1)  # the cell itself, or one neighbour on two sides
        return np.asarray(weights, dtype=np.float32)

    def _mean_of(self, rows: int, window: int) -> FloatArray:
        """Return the spectrum of S S, which is that of its coefficients, of `rows` modes."""
        distance = np.minimum(np.arange(rows), rows - np.arange(rows))
        if window == self._grid.nx:
            return np.asarray(np.fft.fft(np.where(distance < window, 1.0 / window, 0.0)).real)
        inside = np.where(2 * distance < window, 1.0, np.where(2 * distance == window, 0.5, 0.0))
        return np.asarray(np.fft.fft(inside / window).real ** 2)


def _sums(shape: tuple[int, int], along: IntArray, across: IntArray) -> FloatArray:
    """Return what adds modes up to coefficients, a row each: of a cell, along x, along y, across a corner.

    along, across: the modes; of those of columns half is there, without the other side of first and last.
    """
    counts = np.where((across == 0) | (2 * across == shape[1]), 1.0, 2.0)
    x = np.cos(2.0 * math.pi / shape[0] * along)[:, np.newaxis]
    y = counts * np.cos(2.0 * math.pi / shape[1] * across)
    one = np.ones((along.size, 1))
    return np.stack([one * counts, x * counts, one * y, x * y]).reshape(4, -1)


def displacing(
    executor: Executor, pressure: Field, displacement: Field, *, modulus: float, shape: tuple[int, int]
) -> Program:
    """Make what displaces all cells of a free half-space [mm] by pressures in a box [MPa], in float64.

    shape: on which the convolution is padded, the `apart_shape` of the box.
    """
    program = Program(executor)
    line = wp.zeros(shape[0] // 2 + 1, dtype=wp.float64, device=executor.device)
    table = free_quarter(executor.grid, modulus, shape)
    filter_of(executor, table, shape, np.float64).add_to(program, pressure, line, displacement)
    return program


def apart_shape(grid: Grid, box: Box) -> tuple[int, int]:
    """Return an even shape on which the convolution of a box with the grid does not wrap, quick to transform.

    Two cells are no further apart than half of it, so that they feel each other one way round only.
    """
    furthest = (max(box[2 * n + 1], grid.shape[n] - 1 - box[2 * n]) for n in range(2))
    along, across = (
        2 * fft.next_fast_len(max(far, -(-size // 2)), real=True)
        for far, size in zip(furthest, grid.shape, strict=True)
    )
    return along, across


def periodic_spectrum(grid: Grid, modulus: float, xp: Any = np, *, rows: int | None = None) -> Any:
    """Return 2/(E*|q|) of the modes of a real transform [mm/MPa], shape (nx, ny//2 + 1), 0 for the mean.

    rows: of modes, the first ones; by default all. xp: NumPy, or CuPy: a billion modes take NumPy longer than
    their contact takes a GPU.
    """
    q_x = 2.0 * math.pi * xp.fft.fftfreq(grid.nx, grid.cell)[:rows]
    q_y = 2.0 * math.pi * xp.fft.rfftfreq(grid.ny, grid.cell)
    spectrum = q_x[:, None] ** 2 + q_y**2
    spectrum[0, 0] = math.inf
    xp.sqrt(spectrum, out=spectrum)
    return xp.divide(2.0 / modulus, spectrum, out=spectrum)


def padded_shape(grid: Grid, wraps: tuple[bool, bool] = (False, False)) -> tuple[int, int]:
    """Return a shape on which the convolution wraps in these directions alone, there even and quick."""
    along, across = (
        size if repeats else 2 * fft.next_fast_len(size, real=True)
        for size, repeats in zip(grid.shape, wraps, strict=True)
    )
    return along, across


def free_quarter(grid: Grid, modulus: float, shape: tuple[int, int]) -> FloatArray:
    """Return responses of modes on an even shape [mm/MPa], a quarter: (shape[0]//2 + 1, shape[1]//2 + 1).

    The coefficients are even in both directions: a cosine transform of a quarter of them is their spectrum.
    """
    coefficients = free_coefficients(grid.cell, modulus, shape[0] // 2 + 1, shape[1] // 2 + 1)
    return np.asarray(fft.dctn(coefficients, type=1, overwrite_x=True))


def free_coefficients(
    cell: float, modulus: float, rows: int, columns: int, *, parts: tuple[float, float] = (1.0, 1.0)
) -> FloatArray:
    """Return displacements at a cell's centre under unit pressures on others [mm/MPa], by distance in cells.

    Four corner terms, x ln(y + r) + y ln(x + r), over π E* (Johnson eq 3.25). Shape (rows, columns). parts:
    what the two count by, which are integrals of y²/r³ and of x²/r³, whose sum is 1/r.
    """
    corners_x, corners_y = ((np.arange(n + 1) - 0.5)[:, np.newaxis] * cell for n in (rows, columns))
    x, y = corners_x, corners_y.T

    def by_hyperbolic_sine(factor: Any, over: Any, under: Any) -> FloatArray:
        """Return terms by inverse hyperbolic sines: logarithms differ by what cancels between corners."""
        term = over / np.abs(under)
        np.arcsinh(term, out=term)
        term *= factor
        return np.asarray(term)

    corner = by_hyperbolic_sine(parts[0] * x, y, x)
    is_even = rows == columns and parts[0] == parts[1]
    corner += corner.T if is_even else by_hyperbolic_sine(parts[1] * y, x, y)
    total = corner[1:, 1:] - corner[1:, :-1]
    total -= corner[:-1, 1:]
    total += corner[:-1, :-1]
    total /= math.pi * modulus
    return total
