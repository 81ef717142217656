"""Many steps on a GPU in a row: one captured graph a step, nothing read back until the last.

The same contact law, balance and wear as `one_scale`, with the search for the balance on the device, so that
the host only says "once more". History rows wait on the device and are read in one piece.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE, Balance
from warpwear.engine.executor import Executor, Field
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.kernels import gpu_steps as device_steps
from warpwear.kernels.cells import LANES, MAXIMA, SUMS

BLOCK = 256  # threads
BLOCKS = 1056  # eight for each of the 132 multiprocessors of a large GPU
AHEAD = 4  # columns of a row before the sums


@dataclass(frozen=True)
class DeviceStep:
    """What one step left: its balance, and the totals that a history row is made of."""

    balance: Balance
    totals: dict[str, float]
    most: dict[str, float]


class DeviceLoop:
    """Steps of one contact on a foundation.

    gap, unworn, share: fields as of `worn_state.State`; gap and share change in place, the share only where
    the wear of the two is not in one proportion (`share_changes`). factor: of the disc's sliding distance, a
    field of one row or of all. compliance: 1/k [mm³/N]; implicit: whether the wear of a step adds to it.
    """

    def __init__(
        self,
        executor: Executor,
        gap: Field,
        unworn: Field,
        share: Field,
        factor: Field,
        *,
        load: float,
        hardness: float,
        compliance: float,
        implicit: bool,
        share_changes: bool,
    ) -> None:
        self._executor = executor
        self._device = executor.device
        self._load, self._cap = load, hardness
        columns = executor.vectors * LANES
        self._gap, self._unworn, self._share = (self._numbers(field) for field in (gap, unworn, share))
        self._share_changes = int(share_changes)
        self._factor = self._numbers(factor)
        on_cpu = self._device.is_cpu  # there a block is one thread: for tests
        self._block = 1 if on_cpu else BLOCK
        self._blocks = 3 if on_cpu else BLOCKS
        rows = 0 if bool((executor.to_numpy(factor) == 1.0).all()) else factor.shape[0]
        self._cells = [columns, rows, compliance, float(implicit), min(hardness, 1e300), self._blocks]
        self._partial = wp.zeros(
            (len(SUMS) + len(MAXIMA), self._blocks), dtype=wp.float64, device=self._device
        )
        self._search = wp.zeros(len(device_steps.SEARCH), dtype=wp.float64, device=self._device)
        self._searching = wp.zeros(1, dtype=wp.int32, device=self._device)
        self._step = wp.zeros(1, dtype=wp.int32, device=self._device)

    def run(
        self, removals: Sequence[tuple[float, float]], *, approach: float, mean_pressure: float
    ) -> list[DeviceStep]:
        """Steps that remove so much of sphere and disc each [mm³/N].

        approach [mm], mean_pressure [MPa]: of the step before. Raises ConvergenceError for an unbalanced one.
        """
        steps = len(removals)
        self._removals: Field = wp.array(np.asarray(removals), dtype=wp.float64, device=self._device)
        self._rows = wp.zeros((steps, AHEAD + len(SUMS) + len(MAXIMA)), dtype=wp.float64, device=self._device)
        search = np.zeros(len(device_steps.SEARCH))
        search[device_steps.SEARCH.index("approach")] = approach
        search[device_steps.SEARCH.index("mean")] = mean_pressure
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
            device_steps.begin,
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
        steps = [self._removals, self._step, self._search, self._factor]
        self._launch(
            device_steps.remove,
            self._block * self._blocks,
            [*self._cells, self._share_changes, *steps, self._unworn],
            [self._gap, self._share, self._partial],
        )
        quantities = len(SUMS) + len(MAXIMA)
        self._launch(
            device_steps.record,
            quantities * self._block,
            [len(SUMS), self._partial],
            [self._step, self._rows],
        )
        self._launch(device_steps.finish, 1, [self._load], [self._search, self._step, self._rows], block=1)

    def _try(self) -> None:
        known = [*self._cells, self._removals, self._step, self._search, self._factor, self._gap]
        self._launch(device_steps.carried, self._block * self._blocks, known, [self._partial])
        balance = [self._load, TOLERANCE, self._executor.grid.cell_area, self._partial]
        self._launch(device_steps.decide, self._block, balance, [self._search, self._searching])

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
        base, offset, residual, evaluations = row[:AHEAD].tolist()
        if not abs(residual) <= TOLERANCE * self._load:
            raise ConvergenceError(
                f"the load balance did not converge: {residual:.3g} N of {self._load:.6g} N are left "
                f"(allowed {TOLERANCE * self._load:.1g} N) near an approach of {base + offset:.9g} mm."
            )
        sums = row[AHEAD : AHEAD + len(SUMS)].tolist()
        maxima = row[AHEAD + len(SUMS) :].tolist()
        return DeviceStep(
            Balance(base, offset, self._cap, residual, evaluations=int(evaluations)),
            dict(zip(SUMS, sums, strict=True)),
            dict(zip(MAXIMA, maxima, strict=True)),
        )
