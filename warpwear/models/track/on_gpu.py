"""Many steps of a displaced contact on a GPU in a row: one captured graph a step, as `device_loop` has it.

The displacement of each step waits on the device with its removals, so that one graph serves them all; it is
captured once. History rows are read a piece of a block at a time, while the device makes the next piece.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE, Balance
from warpwear.engine.executor import Executor, Field
from warpwear.errors import ConvergenceError
from warpwear.kernels import gpu_steps as device_steps
from warpwear.kernels import gpu_steps_sliding as device_sliding
from warpwear.kernels.cells import MAXIMA, SUMS
from warpwear.models.rest.on_gpu import AHEAD, BLOCK, DeviceStep

#: Steps made before their history is read.
LONGEST_BLOCK = 2000
#: Steps whose history is read in one go.
PIECE = 250
#: Blocks over tiles at most.
BLOCKS = 2112
#: Where each column of a row comes from: by block or by row, which line, how it is reduced. First those of
#: `types.SUMS`, then those of `types.MAXIMA`, which begin at column MOST of a row.
STEP, ROWS = device_sliding.OF_STEP.index, device_sliding.OF_ROWS.index
ADDS, LARGEST, GROWS = range(3)
COLUMNS: dict[str, tuple[int, int, int]] = {
    "pressure": (0, STEP("pressure"), ADDS),
    "pressure_times_factor": (0, STEP("pressure"), ADDS),
    "deviation_squared": (0, STEP("deviation_squared"), ADDS),
    "contact": (0, STEP("contact"), ADDS),
    "capped": (0, STEP("capped"), ADDS),
    "touched": (1, ROWS("touched"), GROWS),
    "wear_sphere": (1, ROWS("worn_sphere"), GROWS),
    "wear_disc": (1, ROWS("worn_disc"), GROWS),
    "highest": (0, STEP("highest"), LARGEST),
    "deepest_sphere": (0, STEP("deepest_sphere"), LARGEST),
    "deepest_disc": (0, STEP("deepest_disc"), LARGEST),
    "first_row": (1, ROWS("first_row"), LARGEST),
    "last_row": (1, ROWS("last_row"), LARGEST),
    "first_column": (0, STEP("first_column"), LARGEST),
    "last_column": (0, STEP("last_column"), LARGEST),
    "pressed_disc": (1, ROWS("pressed_disc"), GROWS),
}
MOST = AHEAD + len(SUMS)
GROWING = [i for i, (_, _, how) in enumerate(COLUMNS.values()) if how == GROWS]


class DeviceSliding:
    """Steps of one displaced contact on a foundation.

    fields: heights of sphere and disc, wear of both, dents of the disc, where the sphere was in contact; they
    change in place. bounds: lowest of the sphere's tiles, highest of the disc's. in_tiles, in_rows: what is
    kept of every tile and of every row, by `sliding.KEPT`. compliance: 1/k [mm³/N]; implicit: whether the
    wear of a step adds to it; keeps: whether the disc keeps its dents.
    """

    def __init__(
        self,
        executor: Executor,
        fields: Sequence[Field],
        bounds: Sequence[Field],
        in_tiles: Sequence[Field],
        in_rows: Sequence[Field],
        *,
        load: float,
        hardness: float,
        compliance: float,
        implicit: bool,
        keeps: bool,
    ) -> None:
        self._executor, self._device = executor, executor.device
        self._load, self._cap = load, hardness
        self._fields, self._bounds = [*fields], [*bounds]
        self._in_tiles, self._in_rows = [*in_tiles], [*in_rows]
        self._keeps = int(keeps)
        on_cpu = self._device.is_cpu  # there a block is one thread: for tests
        self._block = 1 if on_cpu else BLOCK
        tiles = executor.grid.nx * executor.tiles_per_row
        self._blocks = 3 if on_cpu else min(-(-tiles // BLOCK), BLOCKS)
        self._known = [
            executor.tiles_per_row,
            compliance,
            float(implicit),
            min(hardness, 1e300),
            self._blocks,
        ]
        searched = len(device_steps.SEARCH) + len(device_sliding.MORE)
        self._partial = self._table(len(device_sliding.OF_STEP), self._blocks)
        self._change = self._table(len(device_sliding.OF_ROWS), executor.grid.nx)
        self._total = self._table(len(COLUMNS), 2)
        self._rows = self._table(LONGEST_BLOCK, AHEAD + len(COLUMNS))
        self._read_rows: Field = wp.zeros(self._rows.shape, dtype=wp.float64, device="cpu", pinned=not on_cpu)
        self._removals = self._table(LONGEST_BLOCK, 2)
        self._search = wp.zeros(searched, dtype=wp.float64, device=self._device)
        self._searching, self._step = (wp.zeros(1, dtype=wp.int32, device=self._device) for _ in range(2))
        self._shifts = wp.zeros(LONGEST_BLOCK, dtype=wp.int32, device=self._device)
        self._how: Field = wp.array(list(COLUMNS.values()), dtype=wp.int32, device=self._device)
        self._graph: Field = None

    def run(
        self,
        shifts: Sequence[int],
        removals: Sequence[tuple[float, float]],
        *,
        approach: float,
        wander: float,
        mean_pressure: float,
    ) -> Iterator[DeviceStep]:
        """Steps at these displacements [rows] that remove so much of sphere and disc each [mm³/N].

        At most LONGEST_BLOCK. approach, wander: of the step before, and how far off the next may be [mm];
        mean_pressure [MPa]. `DeviceStep.totals` has a sum more, "pressed_disc". The fields are those after
        the last step when that one is given. Raises ConvergenceError for an unbalanced one.
        """
        self._fill(self._removals, removals)
        self._fill(self._shifts, shifts)
        names = [*device_steps.SEARCH, *device_sliding.MORE]
        search = dict.fromkeys(names, 0.0)
        search |= {"approach": approach, "previous": approach, "wander": wander, "mean": mean_pressure}
        self._search.assign(np.array([*search.values()]))
        total = np.zeros(self._total.shape)
        total[GROWING, 0] = [float(sums.numpy().sum()) for sums in self._in_rows]
        self._total.assign(total)
        self._step.zero_()
        before: tuple[int, int, Field] | None = None
        for first in range(0, len(shifts), PIECE):
            last = min(first + PIECE, len(shifts))
            self._make(last - first)
            copied = self._fetch(first, last)
            if before is not None:
                yield from self._of(*before)
            before = first, last, copied
        if before is not None:
            yield from self._of(*before)

    def _make(self, steps: int) -> None:
        """Set the device to so many steps."""
        if not self._device.is_cuda:
            for _ in range(steps):
                self._one_step()
            return
        if self._graph is None:
            self._one_step()  # compiles what it needs, which a capture could not
            with wp.ScopedCapture(device=self._device) as capture:
                self._one_step(captured=True)
            self._graph = capture.graph
            steps -= 1
        for _ in range(steps):
            wp.capture_launch(self._graph)

    def _fetch(self, first: int, last: int) -> Field:
        """Set the device to copy rows to the host; an event says when it has."""
        width = self._rows.shape[1]
        wp.copy(self._read_rows, self._rows, first * width, first * width, (last - first) * width)
        return wp.get_stream(self._device).record_event() if self._device.is_cuda else None

    def _of(self, first: int, last: int, copied: Field) -> Iterator[DeviceStep]:
        """Steps whose rows were fetched."""
        if copied is not None:
            wp.synchronize_event(copied)
        for row in self._read_rows.numpy()[first:last].tolist():
            yield self._read(row)

    def _one_step(self, *, captured: bool = False) -> None:
        self._launch(device_sliding.begin, 1, [], [self._search, self._searching])
        if captured:
            wp.capture_while(self._searching, self._try)
        else:
            while self._searching.numpy()[0]:
                self._try()
        tables = [self._removals, self._shifts, self._step, self._search]
        self._launch(
            device_sliding.remove,
            self._block * self._blocks,
            [*self._known, self._keeps, *tables],
            [*self._bounds, *self._fields, *self._in_tiles, self._partial],
        )
        self._launch(
            device_sliding.rows,
            self._block * self._executor.grid.nx,
            [self._executor.tiles_per_row, self._keeps, self._shifts, self._step, *self._in_tiles],
            [*self._in_rows, self._change],
        )
        self._launch(
            device_sliding.record,
            self._block * len(COLUMNS),
            [self._how, self._partial, self._change],
            [self._step, self._total, self._rows],
        )
        self._launch(device_steps.finish, 1, [self._load], [self._search, self._step, self._rows])

    def _try(self) -> None:
        tables = [self._removals, self._shifts, self._step, self._search]
        known = [*self._known, *tables, *self._bounds, *self._fields[:2]]
        self._launch(device_sliding.carried, self._block * self._blocks, known, [self._partial])
        balance = [self._load, TOLERANCE, self._executor.grid.cell_area, self._partial]
        self._launch(device_steps.decide, self._block, balance, [self._search, self._searching])

    def _launch(
        self, kernel: object, threads: int, inputs: Sequence[object], outputs: Sequence[object]
    ) -> None:
        wp.launch(
            kernel,
            dim=threads,
            inputs=[*inputs],
            outputs=[*outputs],
            device=self._device,
            block_dim=self._block,
        )

    def _table(self, lines: int, columns: int) -> Field:
        return wp.zeros((lines, columns), dtype=wp.float64, device=self._device)

    @staticmethod
    def _fill(array: Field, values: Sequence[object]) -> None:
        """The first so many of an array."""
        host = array.numpy()
        host[: len(values)] = values
        array.assign(host)

    def _read(self, row: list[float]) -> DeviceStep:
        base, offset, residual, evaluations = row[:AHEAD]
        if not abs(residual) <= TOLERANCE * self._load:
            raise ConvergenceError(
                f"the load balance did not converge: {residual:.3g} N of {self._load:.6g} N are left "
                f"(allowed {TOLERANCE * self._load:.1g} N) near an approach of {base + offset:.9g} mm."
            )
        totals = dict(zip(SUMS, row[AHEAD:MOST], strict=True))
        totals["pressed_disc"] = row[-1]
        return DeviceStep(
            Balance(base, offset, self._cap, residual, evaluations=int(evaluations)),
            totals,
            dict(zip(MAXIMA, row[MOST:-1], strict=True)),
        )
