"""Many steps of a displaced contact on a GPU in a row: one captured graph a step, as `rest.on_gpu` has it.

The displacement of each step waits on the device with its removals, so that one graph serves them all; it is
captured once. History rows are read a piece of a block at a time, while the device makes the next piece.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.kernels import gpu_steps, gpu_steps_sliding
from warpwear.kernels.cells import TrackMost, TrackSum
from warpwear.kernels.gpu_steps_sliding import RowSum
from warpwear.kernels.sliding import Bodies, OfRows, OfTiles
from warpwear.laws.task import ContactTask
from warpwear.models.rest.on_gpu import BLOCK, HEADER, DeviceStep, balance_of, known_of

#: Steps made before their history is read.
LONGEST_BLOCK = 2000
#: Steps whose history is read in one go.
PIECE = 250
#: Blocks over tiles at most.
BLOCKS = 2112
#: Sums over rows, in the order in which they grow.
KEPT = ("touched", "worn_sphere", "worn_disc", "pressed_disc")
#: How a column is reduced.
ADDS, LARGEST, GROWS = range(3)
FIRST_MOST = len(TrackSum)
#: Where the columns of a row come from: partial results by block or by row, which line, how it is reduced.
#: The first are those of `TrackSum`, as `gpu_steps.finish` needs them.
TOTALS: dict[str, tuple[int, int, int]] = {
    **{row.name.lower(): (0, row, ADDS) for row in TrackSum if row != TrackSum.PRESSURE_TIMES_FACTOR},
    "touched": (1, RowSum.TOUCHED, GROWS),
    "wear_sphere": (1, RowSum.WEAR_SPHERE, GROWS),
    "wear_disc": (1, RowSum.WEAR_DISC, GROWS),
    "pressed_disc": (1, RowSum.PRESSED_DISC, GROWS),
}
MOST: dict[str, tuple[int, int, int]] = {
    **{row.name.lower(): (0, FIRST_MOST + row, LARGEST) for row in TrackMost},
    "first_row": (1, RowSum.FIRST_ROW, LARGEST),
    "last_row": (1, RowSum.LAST_ROW, LARGEST),
}
COLUMNS = (*TOTALS.values(), *MOST.values())
GROWING = [column for column, (_, _, how) in enumerate(COLUMNS) if how == GROWS]


class DeviceSliding:
    """Steps of one displaced contact on a foundation.

    bodies: fields, which change in place. of_tiles, of_rows: what is kept of every tile and of every row.
    """

    def __init__(
        self, executor: Executor, task: ContactTask, bodies: Bodies, of_tiles: OfTiles, of_rows: OfRows
    ) -> None:
        self._executor, self._device = executor, executor.device
        self._load, self._cap = task.load, task.hardness
        self._bodies, self._of_tiles, self._of_rows = bodies, of_tiles, of_rows
        on_cpu = self._device.is_cpu  # there a block is one thread: for tests
        self._block = 1 if on_cpu else BLOCK
        tiles = executor.grid.nx * executor.tiles_per_row
        self._blocks = 3 if on_cpu else min(-(-tiles // BLOCK), BLOCKS)
        self._known = known_of(executor, task, self._blocks)
        searched = len(gpu_steps.SEARCH) + len(gpu_steps_sliding.MORE)
        self._partial = self._table(len(TrackSum) + len(TrackMost), self._blocks)
        self._change = self._table(len(RowSum), executor.grid.nx)
        self._total = self._table(len(COLUMNS), 2)
        self._rows = self._table(LONGEST_BLOCK, HEADER + len(COLUMNS))
        self._read_rows: Field = wp.zeros(self._rows.shape, dtype=wp.float64, device="cpu", pinned=not on_cpu)
        self._searching = wp.zeros(1, dtype=wp.int32, device=self._device)
        self._now = arguments(
            gpu_steps_sliding.Now,
            wear_per_pressure=self._table(LONGEST_BLOCK, 2),
            shift=wp.zeros(LONGEST_BLOCK, dtype=wp.int32, device=self._device),
            step=wp.zeros(1, dtype=wp.int32, device=self._device),
            search=wp.zeros(searched, dtype=wp.float64, device=self._device),
        )
        self._how: Field = wp.array(COLUMNS, dtype=wp.int32, device=self._device)
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
        """Make steps at displacements [rows] that wear sphere and disc by K ΔL = removals [mm³/N] each.

        At most LONGEST_BLOCK. approach, wander: of the step before, and how far off the next may be [mm];
        mean_pressure [MPa]. `DeviceStep.totals` has a sum more, "pressed_disc". The fields are those after
        the last step when that one is given. Raises ConvergenceError for an unbalanced one.
        """
        self._fill(self._now.wear_per_pressure, removals)
        self._fill(self._now.shift, shifts)
        names = [*gpu_steps.SEARCH, *gpu_steps_sliding.MORE]
        search = dict.fromkeys(names, 0.0)
        search |= {"approach": approach, "previous": approach, "wander": wander, "mean": mean_pressure}
        self._now.search.assign(np.array([*search.values()]))
        total = np.zeros(self._total.shape)
        total[GROWING, 0] = [float(getattr(self._of_rows, name).numpy().sum()) for name in KEPT]
        self._total.assign(total)
        self._now.step.zero_()
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
        """Set the device to a number of steps."""
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
        now = self._now
        self._launch(gpu_steps_sliding.begin, 1, [], [now.search, self._searching])
        if captured:
            wp.capture_while(self._searching, self._try)
        else:
            while self._searching.numpy()[0]:
                self._try()
        self._launch(
            gpu_steps_sliding.wear_step,
            self._block * self._blocks,
            [self._known, now],
            [self._bodies, self._of_tiles, self._partial],
        )
        self._launch(
            gpu_steps_sliding.rows,
            self._block * self._executor.grid.nx,
            [self._known, now, self._of_tiles],
            [self._of_rows, self._change],
        )
        self._launch(
            gpu_steps_sliding.record,
            self._block * len(COLUMNS),
            [self._how, self._partial, self._change],
            [now.step, self._total, self._rows],
        )
        self._launch(gpu_steps.finish, 1, [self._load], [now.search, now.step, self._rows])

    def _try(self) -> None:
        known = [self._known, self._now, self._bodies, self._of_tiles]
        self._launch(gpu_steps_sliding.carried, self._block * self._blocks, known, [self._partial])
        balance = [self._load, TOLERANCE, self._executor.grid.cell_area, self._partial]
        self._launch(gpu_steps.decide, self._block, balance, [self._now.search, self._searching])

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
        """Write values to the beginning of an array."""
        host = array.numpy()
        host[: len(values)] = values
        array.assign(host)

    def _read(self, row: list[float]) -> DeviceStep:
        totals, most = row[HEADER : HEADER + len(TOTALS)], row[HEADER + len(TOTALS) :]
        return DeviceStep(
            balance_of(row, self._load, self._cap),
            dict(zip(TOTALS, totals, strict=True)),
            dict(zip(MOST, most, strict=True)),
        )
