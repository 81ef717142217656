"""Convolutions of fields in single precision on a CPU, by the kernels of `kernels.fourier`."""

import math
from typing import Any

import numpy as np
import warp as wp

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.grid import FloatArray, IntArray
from warpwear.kernels import fourier
from warpwear.kernels.fourier import LINES

#: What a length may be made of, in the order of the stages.
RADICES = (4, 2, 3, 5)
#: Rows of a table that are put in order together.
TOGETHER = 64


def radices_of(length: int) -> list[int]:
    """Stages of a transform of a length; empty where it has other factors."""
    stages = []
    for radix in RADICES:
        while length % radix == 0:
            stages.append(radix)
            length //= radix
    return stages if length == 1 else []


def fits(shape: tuple[int, int]) -> bool:
    """Whether fields padded to a shape can be convolved here."""
    return shape[1] % 2 == 0 and bool(radices_of(shape[0])) and bool(radices_of(shape[1] // 2))


class Convolution:
    """Multiplies the modes of fields of one executor, zero-padded to a shape that `fits`, by a table.

    within: another one of no smaller a shape, whose memory it works in.
    """

    def __init__(
        self, executor: Executor, shape: tuple[int, int], within: "Convolution | None" = None
    ) -> None:
        self._executor, self.shape = executor, shape
        half, nx = shape[1] // 2, executor.grid.nx
        stages = _stages(half, -(-executor.grid.ny // 2))
        order = _order(half, stages)
        place = np.argsort(order)
        angle = math.pi / half * order
        self._along = arguments(
            fourier.Rows,
            plan=_plan(half, stages),
            partners=_array(place[-order % half], wp.int32),
            turns=_array(np.stack([np.cos(angle), -np.sin(angle)], axis=1).ravel(), wp.float32),
        )
        stages_across = _stages(shape[0], nx)
        self._across = _plan(shape[0], stages_across)
        across = _order(shape[0], stages_across)
        self._folded = _array(np.minimum(across, shape[0] - across), wp.int32)
        self._order = order
        self._groups = -(-(half + 1) // LINES)
        self._batches = -(-nx // LINES)
        threads = len(executor.split_rows(np.full(nx, executor.grid.ny)))
        longest = max(self._groups * LINES, shape[0] if shape[0] > nx else 0)
        if within is None:
            self._scratch = wp.zeros((threads, 2 * LINES * longest), dtype=wp.float32, device="cpu")
            self._modes = wp.zeros((self._groups, nx, 2 * LINES), dtype=wp.float32, device="cpu")
        else:
            self._scratch, self._modes = within._scratch, within._modes[: self._groups]

    @property
    def memory(self) -> FloatArray:
        """Where it works, as one line of numbers; free for others between convolutions."""
        return np.asarray(self._modes.numpy().reshape(-1))

    def table(self, values: FloatArray) -> Any:
        """A table to apply, from rows 0 … n//2 of an even one, for a transform that is scaled back."""
        half, lines = self._order.size, self.shape[0] // 2 + 1
        columns = np.resize(np.append(self._order, half), self._groups * LINES)
        made = np.empty((self._groups, lines, LINES), dtype=np.float32)
        scale = 1.0 / (4.0 * half * self.shape[0])
        for first in range(0, lines, TOGETHER):
            rows = (values[first : min(first + TOGETHER, lines)] * scale).astype(np.float32)[:, columns]
            made[:, first : first + TOGETHER] = rows.reshape(-1, self._groups, LINES).swapaxes(0, 1)
        return wp.array(made, dtype=wp.float32, device="cpu", copy=False)

    def apply(self, field_in: Field, table: Any, field_out: Field) -> None:
        """Convolve a field; may be in place."""
        columns = self._executor.grid.ny
        self._launch(
            fourier.forward, self._batches, [columns, self._along, field_in], [self._scratch, self._modes]
        )
        self._launch(
            fourier.across, self._groups, [self._across, self._folded, table], [self._scratch, self._modes]
        )
        self._launch(
            fourier.back, self._batches, [columns, self._along, self._modes], [self._scratch, field_out]
        )

    def _launch(self, kernel: Any, slots: int, inputs: list[Any], outputs: list[Any]) -> None:
        of_slab = -(-slots // self._scratch.shape[0])
        chunks = [(first, min(first + of_slab, slots)) for first in range(0, slots, of_slab)]
        self._executor.launch(kernel, inputs=[of_slab, *inputs], outputs=outputs, chunks=chunks, often=True)


def _stages(length: int, filled: int) -> list[int]:
    """Stages of a transform of a length, of which the first numbers are filled; −2 leaves out zeros."""
    halved = length % 2 == 0 and filled <= length // 2
    return [-2, *radices_of(length // 2)] if halved else radices_of(length)


def _order(length: int, stages: list[int]) -> IntArray:
    """Mode that lies in each place after a transform."""
    if not stages:
        return np.zeros(1, dtype=np.int64)
    radix, rest = abs(stages[0]), stages[1:]
    inner = radix * _order(length // radix, rest)
    return np.concatenate([inner + q for q in range(radix)])


def _plan(length: int, stages: list[int]) -> Any:
    turns, size = [], length
    for radix in (abs(stage) for stage in stages):
        angle = -2.0 * math.pi / size * np.arange(size // radix)[:, np.newaxis] * np.arange(1, radix)
        turns.append(np.stack([np.cos(angle), np.sin(angle)], axis=2).ravel())
        size //= radix
    return arguments(
        fourier.Plan,
        length=length,
        radices=_array(np.array(stages), wp.int32),
        turns=_array(np.concatenate(turns), wp.float32),
    )


def _array(values: Any, dtype: Any) -> Any:
    return wp.array(values, dtype=dtype, device="cpu")
