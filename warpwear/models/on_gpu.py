"""Many steps on a GPU in a row: one captured graph a step, whose history is read while the device goes on.

The same contact law, balance and wear as step by step, with the search for the balance on the device. What
changes from step to step waits there, so that one graph serves them all: a search with passes over the cells
until the load is carried, the passes that wear, and a row of the history.
"""

from collections.abc import Iterator, Sequence
from enum import IntEnum
from typing import Any

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE, Balance, residual_of
from warpwear.contact.foresight import Foresight
from warpwear.engine.executor import Executor, Field, arguments, set_numbers
from warpwear.kernels.cells import LANES, NO_INDEX, WearMost, WearSum, names_of
from warpwear.kernels.gpu import steps as gpu_steps
from warpwear.kernels.gpu import steps_rest
from warpwear.kernels.gpu.steps import Search, Steps
from warpwear.laws.task import ContactTask
from warpwear.models.booking import Found

#: Steps made before the first of them is given, at most.
LONGEST_BLOCK = 2000
#: Steps whose history is read in one go: while the host books them the device makes the next.
PIECE = 128
#: Steps of a graph: launching one takes the host about as long as a small step takes the device.
STEPS_OF_GRAPH = 8
BLOCK = 256  # threads
BLOCKS_AT_REST = 4  # of each multiprocessor: as many as their registers let run at a time
HEADER = int(gpu_steps.HEADER)  # columns of a row before the others

#: A kernel, the blocks that run it, and its arguments after `Steps`.
Pass = tuple[Any, int, Sequence[Any]]


class DeviceSteps:
    """Steps of one contact on a foundation, with the same law for every cell. `at_rest`, `displaced` make it.

    lines: sums and maxima in the order in which the passes leave them, pressure and contact as in `WearSum`.
    passes: the one that a search evaluates, then those that wear, over fields that change in place. kept: of
    the last sums, of which the passes leave what a step changes, the values by row that they are of.
    """

    def __init__(
        self,
        executor: Executor,
        task: ContactTask,
        lines: tuple[type[IntEnum], type[IntEnum]],
        passes: Sequence[Pass],
        *,
        kept: Sequence[Field] = (),
        moves: bool = False,
    ) -> None:
        device = self._device = executor.device
        for kernel in (gpu_steps.begin, *(kernel for kernel, *_ in passes)):
            executor.load(kernel)  # which no graph can while it is captured
        self._task, self._passes, self._kept = task, passes, kept
        self._cell_area = executor.grid.cell_area
        self._names = [names_of(kind) for kind in lines]
        sums, columns = len(lines[0]), sum(map(len, lines))
        found = np.zeros((columns, max(blocks for _, blocks, _ in passes)))
        found[sums:] = NO_INDEX
        self._steps = arguments(
            Steps,
            columns=executor.vectors * LANES,
            tiles=executor.tiles_per_row,
            blocks=passes[0][1],
            sums=sums,
            moves=int(moves),
            keeps_dents=int(task.keeps_dents),
            compliance=task.compliance,
            implicit=float(task.implicit),
            cap=min(task.hardness, 1e300),
            load=task.load,
            tolerance=TOLERANCE * task.load,
            cell_area=self._cell_area,
            wear_per_pressure=wp.zeros(LONGEST_BLOCK, dtype=wp.vec2d, device=device),
            shift=wp.zeros(LONGEST_BLOCK, dtype=wp.int32, device=device),
            step=wp.zeros(2, dtype=wp.int32, device=device),
            searching=wp.zeros(1, dtype=wp.int32, device=device),
            search=wp.zeros(1, dtype=Search, device=device),
            trial=wp.zeros((3, passes[0][1]), dtype=wp.float64, device=device),
            found=wp.array(found, device=device),
            rows=wp.zeros((LONGEST_BLOCK, HEADER + columns), dtype=wp.float64, device=device),
        )
        shape, pinned = self._steps.rows.shape, device.is_cuda
        self._read: Field = wp.zeros(shape, dtype=wp.float64, device="cpu", pinned=pinned)
        self._graphs: dict[int, Any] = {}  # by their number of steps

    def run(
        self,
        removals: Sequence[tuple[float, float]],
        *,
        approach: float,
        mean_pressure: float,
        foresight: Foresight | None = None,
        shifts: Sequence[int] = (),
        wander: float = 0.0,
    ) -> Iterator[Found]:
        """Make steps that wear sphere and disc by K ΔL = removals [mm³/N] each, at most LONGEST_BLOCK.

        approach [mm], mean_pressure [MPa]: of the step before. foresight: what is known of the approaches.
        shifts: displacements of the disc [rows], and wander: how far off the next approach may be [mm]. Steps
        are given a few at a time; the fields are those after the last one when that is given. Raises
        ConvergenceError for an unbalanced one.
        """
        steps, count = self._steps, len(removals)
        wp.copy(steps.wear_per_pressure, wp.array([*removals], dtype=wp.vec2d, device="cpu"), count=count)
        if shifts:
            wp.copy(steps.shift, wp.array([*shifts], dtype=wp.int32, device="cpu"), count=count)
        removed = sum(removals[0])
        last = arguments(Search, approach=approach, wander=wander, mean=mean_pressure, rate=mean_pressure)
        set_numbers(last, place=-1.0, ahead=removed * mean_pressure)
        line, ahead = (foresight.line, foresight.expected(removed)) if foresight else (None, None)
        if line is not None and ahead is not None:
            set_numbers(last, slid=line.slid, place=line.place, rate=line.rate, trend=line.trend, ahead=ahead)
        steps.search.assign([last])
        steps.step.zero_()
        self._launch(gpu_steps.begin, 1)
        self._grown = np.array([field.numpy().sum() for field in self._kept], dtype=np.longdouble)
        self._mean = mean_pressure
        fetched: tuple[int, int, Any] | None = None
        for first in range(0, count, PIECE):
            end = min(first + PIECE, count)
            left = end - first
            for size in (STEPS_OF_GRAPH, 1):
                for _ in range(left // size):
                    self._make(size)
                left %= size
            width = self._read.shape[1]
            wp.copy(self._read, steps.rows, first * width, first * width, (end - first) * width)
            event = wp.get_stream(self._device).record_event() if self._device.is_cuda else None
            if fetched:  # while the device makes this piece
                yield from self._given(*fetched)
            fetched = first, end, event
        if fetched:
            yield from self._given(*fetched)

    def _make(self, count: int) -> None:
        """Set the device to some steps, on a GPU by a graph, which is captured once."""
        if self._device.is_cpu:
            self._launch_steps(count)
            return
        if count not in self._graphs:
            with wp.ScopedCapture(device=self._device) as capture:
                self._launch_steps(count)
            self._graphs[count] = capture.graph
        wp.capture_launch(self._graphs[count])

    def _launch_steps(self, count: int) -> None:
        evaluation, *wear = self._passes
        for _ in range(count):
            wp.capture_while(self._steps.searching, self._evaluate, evaluation=evaluation)
            for kernel, blocks, fields in wear:
                self._launch(kernel, blocks, *fields)
            self._launch(gpu_steps.record, self._steps.found.shape[0])

    def _evaluate(self, evaluation: Pass) -> None:
        kernel, blocks, fields = evaluation
        self._launch(kernel, blocks, *fields)
        self._launch(gpu_steps.decide, 1)

    def _launch(self, kernel: Any, blocks: int, *fields: Any) -> None:
        device, block = self._device, 1 if self._device.is_cpu else BLOCK  # one thread on a CPU: for tests
        wp.launch(kernel, dim=blocks * block, inputs=[self._steps, *fields], device=device, block_dim=block)

    def _given(self, first: int, end: int, fetched: Any) -> Iterator[Found]:
        """Steps whose rows are fetched, when the event says so."""
        if fetched is not None:
            wp.synchronize_event(fetched)
        rows = self._read.numpy()[first:end]
        totals, most = self._names
        growing = slice(HEADER + len(totals) - len(self._kept), HEADER + len(totals))
        grown = self._grown + np.cumsum(rows[:, growing], axis=0, dtype=np.longdouble)
        rows[:, growing], self._grown = grown, grown[-1]
        base, offset, evaluations, *columns = np.ascontiguousarray(rows.T)
        total = dict(zip(totals, columns, strict=False))
        with np.errstate(divide="ignore", invalid="ignore"):  # of steps that are refused below
            means = total["pressure"] / total["contact"]
        reference = np.concatenate([[self._mean], means[:-1]])
        self._mean = float(means[-1])
        load = self._task.load
        residual = total["pressure"] * self._cell_area - load
        wrong = np.flatnonzero(~(np.abs(residual) <= 2.0 * TOLERANCE * load))
        made = int(wrong[0]) if wrong.size else end - first
        cap, none = np.full(end - first, self._task.hardness), np.zeros(end - first)
        parts: Any = base, offset, cap, residual, none, none, evaluations
        balance = Balance._make(part[:made] for part in parts)
        maxima = dict(zip(most, columns[len(totals) :], strict=True))
        if made:
            yield Found(made, balance, reference, total, maxima)
        if wrong.size:
            residual_of(residual[made] + load, load, approach=base[made] + offset[made])


def at_rest(executor: Executor, task: ContactTask, gap: Field, unworn: Field) -> DeviceSteps:
    """Steps that wear a gap. gap, unworn: fields of `RestingBodies`."""

    def numbers(field: Field) -> Field:
        shape = field.size * LANES
        return wp.array(ptr=field.ptr, dtype=wp.float64, shape=shape, device=executor.device, copy=False)

    gap, unworn = numbers(gap), numbers(unworn)
    blocks = 3 if executor.device.is_cpu else BLOCKS_AT_REST * executor.device.sm_count
    passes = [(steps_rest.carried, blocks, [gap]), (steps_rest.wear_step, blocks, [unworn, gap])]
    return DeviceSteps(executor, task, (WearSum, WearMost), passes)
