"""A pressure on a half-space with its gradient, and the passes over the cells that move them."""

import math
from typing import Any, NamedTuple

import numpy as np
import warp as wp

from warpwear.contact.balance import PART, TOLERANCE, Carried, find_offsets, newton_in_bracket
from warpwear.contact.certificate import TOGETHER, TOGETHER_ON_GPU, Certificate, cells_of, certify
from warpwear.contact.half_space.influence import Operator
from warpwear.contact.half_space.transforms import arrays_of
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray, IntArray
from warpwear.kernels.half_space import extension, setup
from warpwear.kernels.half_space import search as passes

#: Stands for no cap: kernels compare with it.
NO_CAP = 1.0e300
#: What a trial may miss of the load, relatively: the next step makes up for it.
ROUGH_BALANCE = 1.0e-3
#: Cells of a grid from which responses to steps are made in single precision.
LEAST_SINGLE = 2**14
#: Error of a convolution in single precision, over its largest value: measured were 4e-7 to 7e-7.
SINGLE_ROUNDING = 8.0 * float(np.finfo(np.float32).eps)
#: Ends of the lines of cells between the bounds, over these cells, from which their values are extended to
#: others: 0.4 where waves are two cells long, 0.08 where they are sixteen, 0.01 under a smooth ball.
SCATTERED = 0.15
#: Of so many rows one is looked at for that.
EVERY = 8
#: Columns of the table that a GPU reduces partial results to.
FOLDED = 256


class SearchSums(NamedTuple):
    """Sums and extremes of the present pressure, part by part."""

    total: FloatArray  # Σ p [MPa]
    touching: FloatArray  # cells with p > 0
    between: FloatArray  # cells with 0 < p < H
    level: FloatArray  # Σ t of those [mm]
    highest: FloatArray  # largest t where p > 0 [mm]; −NO_CAP where there is none
    lowest: FloatArray  # smallest t where p < H [mm]; NO_CAP where there is none


class Products(NamedTuple):
    """Sums over the free cells of each part: descent z, gradient r = t − λ, last step s, its response y."""

    cells: FloatArray
    z: FloatArray
    r: FloatArray
    y: FloatArray
    zy: FloatArray
    zr: FloatArray
    sr: FloatArray
    largest_z: FloatArray
    largest_r: FloatArray


class Moments(NamedTuple):
    """Moments of the gap of each part, where there is a surface [mm]."""

    mean: FloatArray
    rms: FloatArray
    lowest: FloatArray


class Iterate:
    """Pressure p, gradient t = Gp + g, trial pressure, step and its response, on the grid of an executor.

    parts: 1, all cells together, or as many as rows are visited, each of which has a load and a level of its
    own. Numbers of each part are arrays of that length. cells: of a part.
    """

    def __init__(self, executor: Executor, influence: Operator, hardness: float) -> None:
        self._executor = executor
        self._influence = influence
        self.parts, self.cells = 1, influence.cells
        self._arguments = self._for_parts()
        #: Whether responses to steps are made in single precision.
        self._single = influence.of_one_grid and executor.device.is_cpu and influence.cells >= LEAST_SINGLE
        #: By how much the gradient may be off for that [mm], and what a whole step adds to it.
        self.drift = self._step_drift = 0.0
        executor.foresee([passes.advance, setup.moments])
        names = "pressure", "gradient", "trial", "step", "response"
        made = [executor.zeros() for _ in names]
        self.pressure, self.gradient, self._trial, self._step, self._response = made
        self.fields = dict(zip(names, made, strict=True))
        self._fields = arguments(passes.Fields, cap=min(hardness, NO_CAP), **self.fields)
        #: Where descents are gathered that were extended, no such, and ranges of blocks of rows.
        self._gathered, self._none = self._singles(0), self._singles(0)
        cells = np.full(-(-executor.grid.nx // extension.ROWS), extension.ROWS * executor.grid.ny)
        self._blocks = [span for span in executor.split_rows(cells) if span[0] < span[1]]
        self._parts: Field | None = None
        self._sums = executor.partials(len(Products._fields) - 2)
        self._maxima = executor.partials(2)
        #: On a CPU, their own memory: asking for it anew each time is felt on small grids.
        self._tables = [t.numpy() for t in (self._sums, self._maxima)] if executor.device.is_cpu else []
        #: On a GPU, where tables of many slots are reduced before they are read.
        self._folded = (
            None
            if executor.device.is_cpu
            else wp.zeros((len(Products._fields), FOLDED), dtype=wp.float64, device=executor.device)
        )

    def set_parts(self, parts: Field | None) -> None:
        """Let each cell bear a part of the cap from now on; None: all of it, as before the first call."""
        if parts is not None or self._parts is not None:
            self._parts = parts
            self._fields.parts = self._executor.zeros(0) if parts is None else parts

    def divide(self, rows: int | None) -> None:
        """Make each row a part from now on. rows: all that are visited; None makes all cells one part."""
        assert rows is None or rows * self._executor.slots_per_row == self._slots
        if self.parts != (rows or 1):
            self.parts = rows or 1
            self._arguments = self._for_parts()
        self.cells = self._influence.cells // (self._executor.grid.nx if rows else 1)
        width = FOLDED if self.parts == 1 else self.parts
        if self._folded is not None and self._folded.shape[1] != width:
            shape = len(Products._fields), width
            self._folded = wp.zeros(shape, dtype=wp.float64, device=self._executor.device)

    def moments(self, gap: Field) -> Moments:
        """Mean, rms height and lowest point of a gap."""
        mean = variance = lowest = np.zeros(self.parts)
        for _ in range(2):  # about 0, then about the mean
            inputs = [self._executor.grid.ny, mean, gap]
            count, first, second, deepest, _unused = self._pass(setup.moments, inputs, [], sums=3, maxima=2)
            mean = mean + first / count
            variance, lowest = second / count - (first / count) ** 2, -deepest
        return Moments(mean, np.sqrt(np.maximum(variance, 0.0)), lowest)

    def foundation(self, gap: Field, *, stiffness: float, level: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Trial pressure of a foundation [N/mm³] at an approach [mm]; what it carries, as `carried`."""
        self._pass(setup.spring, [self._executor.grid.ny, stiffness, level, gap], [self._trial])
        return self.carried(np.zeros(self.parts))

    def begin(self, gap: Field, *, single: bool = False) -> SearchSums:
        """Make the gradient of the present pressure. single: in single precision, where responses may be."""
        if self._parts is not None:
            self._pass(setup.bound, [self._fields.cap, self._parts], [self.pressure])
        single = single and self._single
        self._influence.respond(self.pressure, self._response, single=single)
        inputs = [self._executor.grid.ny, gap, self._response]
        (largest, _unused) = self._pass(setup.gradient, inputs, [self.gradient], maxima=2)
        self.drift, self._step_drift = SINGLE_ROUNDING * single * float(largest.max()), 0.0
        return self._advance(whole=False, length=0.0, shift=np.zeros(self.parts))

    def _is_scattered(self) -> bool:
        """Whether the cells between the bounds lie in spots so small that extending their values pays."""
        if not (self._influence.of_one_grid and self._executor.device.is_cpu):
            return False
        values = self._executor.to_numpy
        rows, caps = values(self.pressure)[::EVERY], self._fields.cap
        if self._parts is not None:
            caps = caps * values(self._parts)[::EVERY]
        between = (rows > 0.0) & (rows < caps)
        ends = np.count_nonzero(between[:, 1:] != between[:, :-1])
        return bool(ends > SCATTERED * np.count_nonzero(between))

    def _by_kind(self, descent: Field) -> tuple[Field, Field]:
        """A descent as passes take it: in double and in single precision, of which one is not read."""
        return (self._trial, descent) if descent is self._gathered else (descent, self._none)

    def _singles(self, rows: int) -> Field:
        """Zeros in single precision, with as many rows."""
        return wp.zeros(
            (rows, self._executor.vectors), dtype=passes.SingleCells, device=self._executor.device
        )

    def certificate(
        self, gap: Field, asked: FloatArray | None, *, displaced: Any = None, **terms: FloatArray
    ) -> Certificate:
        """Certify the pressure as it stands; nothing changes but the last step's response, which is lost.

        displaced: under it, as an array of the device, shape (nx, ny), or made here. asked, terms: as of
        `certificate.certify`.
        """
        executor, cap = self._executor, float(self._fields.cap)
        cap = math.inf if cap >= NO_CAP else cap
        if displaced is None:
            self._influence.respond(self.pressure, self._response, counted=False)
        with arrays_of(executor) as (xp, view):
            visited = self._slots // executor.slots_per_row
            p, g = view(self.pressure), view(gap)
            u = view(self._response) if displaced is None else xp.asarray(displaced)
            of_cap = None if self._parts is None else view(self._parts)
            together = TOGETHER if xp is np else TOGETHER_ON_GPU
            rows = [slice(visited)] if self.parts == 1 else [slice(n, n + 1) for n in range(visited)]
            parts = [
                cells_of(p[r], g[r], u[r], cap, None if of_cap is None else of_cap[r], together) for r in rows
            ]
            return certify(parts, asked=asked, cell_area=executor.grid.cell_area, xp=xp, **terms)

    def take_trial(self, shift: FloatArray) -> None:
        """The trial pressure, shifted and clipped, becomes the pressure. Its gradient is then out of date."""
        self._advance(whole=True, length=0.0, shift=shift)

    def advance(self, length: float, *, shift: FloatArray | None = None) -> SearchSums:
        """Go `length` steps on. shift: of the trial, which is then taken whole, exact at the bounds."""
        whole = shift is not None
        self.drift += length * self._step_drift
        return self._advance(
            whole=whole, length=length, shift=np.zeros(self.parts) if shift is None else shift
        )

    def _advance(self, *, whole: bool, length: float, shift: FloatArray) -> SearchSums:
        inputs = [whole, length, shift, self._fields]
        *values, negative = self._pass(passes.advance, inputs, [], sums=4, maxima=2)
        return SearchSums._make([*values, -negative])

    def descent(self, approach: FloatArray, *, plain: bool) -> tuple[Field, FloatArray]:
        """Field that says where to go, and levels to take off it; it may lie in the trial, or be of singles.

        plain: whether to follow the gradient, not its preconditioned one.
        """
        if plain:
            return self.gradient, approach
        if not self._is_scattered():
            self._pass(passes.residual, [approach], [self._fields])
            self._influence.invert(self._trial, self._trial)
            return self._trial, np.zeros(self.parts)
        if not self._gathered.size:
            self._gathered = self._singles(self._executor.grid.nx)
        columns, wraps, weights = self._executor.grid.ny, self._influence.wraps, self._influence.of_neighbours
        inputs, blocks = [columns, wraps, weights, approach, self._fields], self._blocks
        self._pass(extension.extend, inputs, [self._trial], chunks=blocks)
        self._influence.invert(self._trial, self._trial)
        self._pass(extension.gather, [*inputs, self._trial], [self._gathered], chunks=blocks)
        return self._gathered, np.zeros(self.parts)

    def products(self, approach: FloatArray, descent: Field, level: FloatArray) -> Products:
        """Sums and maxima over the free cells."""
        inputs = [approach, level, self._fields, *self._by_kind(descent)]
        return Products(*self._pass(passes.products, inputs, [], sums=7, maxima=2))

    def aim(
        self,
        approach: FloatArray,
        descent: Field,
        level: FloatArray,
        *,
        memory: float,
        length: float,
        outward: float,
    ) -> tuple[FloatArray, FloatArray]:
        """Trial pressure along −descent + memory × last step; what it carries, as `carried`."""
        way = wp.vec3d(memory, length, outward)
        inputs = [approach, level, way, self._fields, *self._by_kind(descent)]
        total, between = self._pass(passes.direction, inputs, [], sums=2)
        return total, between

    def carried(self, shift: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Sums of the shifted and clipped trial pressures [MPa], and the cells between the bounds."""
        total, between = self._pass(passes.carried, [shift, self._fields], [], sums=2)
        return total, between

    def balance(
        self, asked: FloatArray, total: FloatArray, between: FloatArray, *, unit: FloatArray
    ) -> FloatArray:
        """Shifts of the trial pressure with which each part carries what is asked [MPa].

        total, between: what is carried without a shift. unit: a shift that may be needed [MPa]. Met to
        `balance.TOLERANCE` where the digits of the trial allow it, which they do near the solution. Raises
        ConvergenceError.
        """
        at_zero = total, between
        unit = np.maximum(unit, np.divide(total, between, out=np.zeros(self.parts), where=between > 0.0))
        unit = np.maximum(unit, np.where(asked > 0.0, asked, total) / self.cells)

        def carried(shift: FloatArray) -> tuple[FloatArray, FloatArray]:
            total, slope = self.carried(shift * unit) if shift.any() else at_zero
            return total, slope * unit

        if self.parts == 1:

            def of_one(shift: float) -> Carried:
                return Carried(*(float(value.item()) for value in carried(np.full(1, shift))))

            found = newton_in_bracket(of_one, asked.item(), 0.0, -math.inf, math.inf, 1.0)
            shift, force = np.full(1, found.offset), np.full(1, found.force)
        else:
            none, unity = np.zeros(self.parts), np.ones(self.parts)
            shift, force, _ = find_offsets(carried, asked, PART * TOLERANCE * asked, none, unity)
        missed = np.abs(force - asked)
        if not (missed <= ROUGH_BALANCE * asked).all():
            raise ConvergenceError(f"the load balance of the half-space missed {missed.max():.3g} MPa.")
        return shift * unit

    def step(self, approach: FloatArray, shift: FloatArray) -> tuple[float, float, float]:
        """Take aim at the shifted trial, and respond.

        Returns the sums of step × (t − λ) and of step × response, and the largest fraction of its room to a
        bound that a cell uses.
        """
        inputs = [approach, shift, self._fields]
        slope, used, _unused = self._pass(passes.step, inputs, [], sums=1, maxima=2)
        self._influence.respond(self._step, self._response, single=self._single)
        outputs = self._step, self._response
        products, largest, _unused = self._pass(setup.product, [*outputs], [], sums=1, maxima=2)
        curvature, self._step_drift = float(products.sum()), 0.0
        if self._single:
            self._step_drift = SINGLE_ROUNDING * float(largest.max())
        return float(slope.sum()), curvature, float(used.max())

    @property
    def can_aim_at_few(self) -> bool:
        """Whether `on_host` and `coefficients` give the fields of one part."""
        return self._executor.device.is_cpu and self.parts == 1 and self._influence.of_one_grid

    def on_host(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Pressure, gradient, caps and trial on a CPU, shape (nx, ny), in the fields' own memory."""
        values = self._executor.to_numpy
        caps = np.full((1, 1), float(self._fields.cap))
        if self._parts is not None:
            caps = caps * values(self._parts)
        return values(self.pressure), values(self.gradient), caps, values(self._trial)

    def coefficients(self, rows: IntArray, columns: IntArray) -> FloatArray:
        """The operator between cells of these rows and columns [mm/MPa]."""
        return self._influence.coefficients(rows, columns)

    def _pass(
        self,
        kernel: Any,
        inputs: list[Any],
        outputs: list[Field],
        *,
        sums: int = 0,
        maxima: int = 0,
        chunks: list[tuple[int, int]] | None = None,
    ) -> list[FloatArray]:
        """Launch a kernel and reduce what it leaves in its tables to a number for each part.

        sums, maxima: how many first rows of the tables of partial results it fills.
        """
        places = iter(self._arguments)
        inputs = [self._placed(v, *next(places)) if isinstance(v, np.ndarray) else v for v in inputs]
        tables = ([self._sums] if sums else []) + ([self._maxima] if maxima else [])
        chunks = self._influence.chunks if chunks is None else chunks
        self._executor.launch(kernel, inputs=inputs, outputs=[*outputs, *tables], chunks=chunks, often=True)
        slots = self._slots
        if self._folded is None:
            table, largest = self._tables[0][:sums, :slots], self._tables[1][:maxima, :slots]
        else:  # one short table to read back
            both, of_row = sums + maxima, self._executor.slots_per_row
            width = self._folded.shape[1]
            spans = (1, width, slots) if self.parts == 1 else (of_row, 1, of_row)
            self._executor.launch(
                setup.fold,
                inputs=[width, sums, slots, wp.vec3i(*spans), self._sums, self._maxima],
                outputs=[self._folded],
                chunks=[(0, both * width)],
            )
            folded = self._folded.numpy()
            table, largest = folded[:sums], folded[sums:both]
        found: list[FloatArray] = []
        if sums:
            found.extend(table.reshape(sums, self.parts, -1).sum(axis=2))
        if maxima:
            found.extend(largest.reshape(maxima, self.parts, -1).max(axis=2))
        return found

    @property
    def _slots(self) -> int:
        """How many slots are visited."""
        chunks = self._influence.chunks
        return chunks[-1][1] if chunks else self._executor.slots

    def _for_parts(self) -> list[tuple[Any, FloatArray]]:
        """Two arrays from which a pass reads numbers of each part, each with its copy on the host."""
        device = self._executor.device
        hosts = np.zeros(self.parts), np.zeros(self.parts)
        return [(wp.array(h, dtype=wp.float64, device=device, copy=not device.is_cpu), h) for h in hosts]

    def _placed(self, values: FloatArray, place: Any, host: FloatArray) -> Any:
        host[:] = values
        if not self._executor.device.is_cpu:
            place.assign(host)
        return place
