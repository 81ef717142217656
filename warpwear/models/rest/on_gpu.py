"""Many steps on a GPU in a row: one captured graph a step, nothing read back until the last.

The same contact law, balance and wear as `local`, with the search for the balance on the device, so that
the host only says "once more". History rows wait on the device and are read in one piece.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE, Balance
from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.kernels import gpu_steps
from warpwear.kernels.cells import LANES, WearMost, WearSum, names_of
from warpwear.kernels.gpu_wear_loop import Known
from warpwear.laws.task import ContactTask

BLOCK = 256  # threads
BLOCKS = 1056  # eight for each of the 132 multiprocessors of a large GPU
HEADER = int(gpu_steps.HEADER)  # columns of a row before the others
COLUMNS = (*WearSum, *WearMost)


@dataclass(frozen=True)
class DeviceStep:
    """What one step left: its balance, and the totals that a history row is made of."""

    balance: Balance
    totals: dict[str, float]
    most: dict[str, float]


class DeviceLoop:
    """Steps of one contact on a foundation.

    task: with the same law for every cell. gap, unworn: fields of `RestingBodies`; the gap changes in place.
    """

    def __init__(self, executor: Executor, task: ContactTask, gap: Field, unworn: Field) -> None:
        self._executor = executor
        self._device = executor.device
        self._load, self._cap = task.load, task.hardness
        self._gap, self._unworn = self._numbers(gap), self._numbers(unworn)
        on_cpu = self._device.is_cpu  # there a block is one thread: for tests
        self._block = 1 if on_cpu else BLOCK
        self._blocks = 3 if on_cpu else BLOCKS
        self._known = known_of(executor, task, self._blocks)
        self._partial = wp.zeros((len(COLUMNS), self._blocks), dtype=wp.float64, device=self._device)
        self._search = wp.zeros(len(gpu_steps.SEARCH), dtype=wp.float64, device=self._device)
        self._searching = wp.zeros(1, dtype=wp.int32, device=self._device)
        self._step = wp.zeros(1, dtype=wp.int32, device=self._device)

    def run(
        self, removals: Sequence[tuple[float, float]], *, approach: float, mean_pressure: float
    ) -> list[DeviceStep]:
        """Make steps that wear sphere and disc by K ΔL = removals [mm³/N] each.

        approach [mm], mean_pressure [MPa]: of the step before. Raises ConvergenceError for an unbalanced one.
        """
        steps = len(removals)
        self._removals: Field = wp.array(np.asarray(removals), dtype=wp.float64, device=self._device)
        self._rows = wp.zeros((steps, HEADER + len(COLUMNS)), dtype=wp.float64, device=self._device)
        search = np.zeros(len(gpu_steps.SEARCH))
        search[gpu_steps.SEARCH.index("approach")] = approach
        search[gpu_steps.SEARCH.index("mean")] = mean_pressure
        self._search.assign(search)
        self._step.zero_()
        if self._device.is_cuda:
            with wp.ScopedCapture(device=self._device) as capture:
                self._one_step()
            for _ in range(steps):
                wp.capture_launch(capture.graph)
        else:
            for _ in range(steps):
                self._one_step()
        return [self._read(row) for row in self._rows.numpy()]

    def _one_step(self) -> None:
        self._launch(
            gpu_steps.begin,
            1,
            [self._removals, self._step],
            [self._search, self._searching],
            block=1,
        )
        if self._device.is_cuda:
            wp.capture_while(self._searching, self._try)
        else:
            while self._searching.numpy()[0]:
                self._try()
        self._launch(
            gpu_steps.wear_step,
            self._block * self._blocks,
            [self._known, self._removals, self._step, self._search, self._unworn],
            [self._gap, self._partial],
        )
        self._launch(
            gpu_steps.record,
            len(COLUMNS) * self._block,
            [len(WearSum), self._partial],
            [self._step, self._rows],
        )
        self._launch(gpu_steps.finish, 1, [self._load], [self._search, self._step, self._rows], block=1)

    def _try(self) -> None:
        known = [self._known, self._removals, self._step, self._search, self._gap]
        self._launch(gpu_steps.carried, self._block * self._blocks, known, [self._partial])
        balance = [self._load, TOLERANCE, self._executor.grid.cell_area, self._partial]
        self._launch(gpu_steps.decide, self._block, balance, [self._search, self._searching])

    def _launch(
        self,
        kernel: object,
        threads: int,
        inputs: Sequence[object],
        outputs: Sequence[object],
        *,
        block: int | None = None,
    ) -> None:
        wp.launch(
            kernel,
            dim=threads,
            inputs=list(inputs),
            outputs=list(outputs),
            device=self._device,
            block_dim=block or self._block,
        )

    def _numbers(self, field: Field) -> Field:
        """A field as a flat array of numbers in the same memory."""
        return wp.array(
            ptr=field.ptr, dtype=wp.float64, shape=(field.size * LANES,), device=self._device, copy=False
        )

    def _read(self, row: FloatArray) -> DeviceStep:
        values = row[HEADER:].tolist()
        return DeviceStep(
            balance_of(row.tolist(), self._load, self._cap),
            dict(zip(names_of(WearSum), values, strict=False)),
            dict(zip(names_of(WearMost), values[len(WearSum) :], strict=True)),
        )


def known_of(executor: Executor, task: ContactTask, blocks: int) -> Arguments:
    """What every step on the device needs of a task."""
    return arguments(
        Known,
        columns=executor.vectors * LANES,
        tiles=executor.tiles_per_row,
        blocks=blocks,
        keeps_dents=int(task.keeps_dents),
        compliance=task.compliance,
        implicit=float(task.implicit),
        cap=min(task.hardness, 1e300),
    )


def balance_of(row: Sequence[float], load: float, cap: float) -> Balance:
    """The balance that the header of a row tells of. Raises ConvergenceError for an unbalanced one."""
    base, offset, residual, evaluations = row[:HEADER]
    if not abs(residual) <= TOLERANCE * load:
        raise ConvergenceError(
            f"the load balance did not converge: {residual:.3g} N of {load:.6g} N are left "
            f"(allowed {TOLERANCE * load:.1g} N) near an approach of {base + offset:.9g} mm."
        )
    return Balance(base, offset, cap, residual, evaluations=int(evaluations))
