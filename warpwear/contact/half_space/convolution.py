"""Fields are convolved on a CPU by the transforms of `kernels.fourier`."""

import math
from typing import Any

import numpy as np
import warp as wp

from warpwear.contact.half_space.transforms import Filter, Grids, lying
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, IntArray
from warpwear.kernels import fourier

#: Largest prime that a length may contain, as `native/transforms.h` says: grids of 199 x 199 take nine tenths
#: of SciPy's time on one core, of 194 x 194 a third, of 57 x 57 a fifth.
LARGEST_PRIME = 199
#: Stages that have butterflies of their own.
SMALL_RADICES = (4, 2, 3, 5)
#: Rows of a table that are put in order together.
TOGETHER = 64


def radices_of(length: int) -> list[int]:
    """Return the stages of a transform of a length; none where it has larger primes, or is 1."""
    stages = []
    for radix in (*SMALL_RADICES, *range(7, LARGEST_PRIME + 1, 2)):
        while length % radix == 0:
            stages.append(radix)
            length //= radix
    return stages if length == 1 else []


def fits(shape: tuple[int, int]) -> bool:
    """Tell whether fields padded to a shape can be convolved here."""
    return all(length == 1 or radices_of(length) for length in (shape[0], _numbers(shape[1])))


class Convolution(Filter):
    """Multiplies the modes of grids, zero-padded to a shape that `fits`, by a table and a line.

    One grid is shared among threads, of several each thread has its own.
    """

    def __init__(
        self,
        executor: Executor,
        grids: Grids,
        table: FloatArray,
        shape: tuple[int, int],
        kind: Any,
        within: Filter | None = None,
    ) -> None:
        self._grids, self._kind, numbers = grids, kind, _numbers(shape[1])
        is_odd = numbers == shape[1]
        self._slots = len(executor.split_rows(np.full(executor.grid.nx, executor.grid.ny)))
        filled = grids.columns if is_odd else -(-grids.columns // 2)
        along, across = _stages(numbers, filled), _stages(shape[0], grids.rows)
        order, order_across = _order(numbers, along), _order(shape[0], across)
        columns = np.minimum(order, numbers - order) if is_odd else np.append(order, numbers)
        lines = fourier.LINES[kind]
        groups = -(-columns.size // lines)
        angle = math.pi / numbers * order
        turns = [_pairs(-angle), _turns(numbers, along), _turns(shape[0], across)]
        self._turns = _array(np.concatenate(turns), kind)
        self._plan = {
            "visited": grids.visited,
            "rows": grids.rows,
            "columns": grids.columns,
            "stride": grids.stride,
            "groups": groups,
            "scale": (1.0 if is_odd else 0.25) / (numbers * shape[0]),
            "is_odd": is_odd,
            "along": _array(along, np.int32),
            "across": _array(across, np.int32),
            "partners": _array(np.argsort(order)[-order % numbers], np.int32),
            "folded": _array(np.minimum(order_across, shape[0] - order_across), np.int32),
            "turns_across": turns[0].size + turns[1].size,
        }
        tables = table if table.ndim == 3 else [table]
        grouped = [_in_groups(one, np.resize(columns, groups * lines), lines, kind) for one in tables]
        self._is_pair = len(grouped) > 1
        if self._is_pair and is_odd:  # then modes beyond the middle are there, too
            grouped[1] *= np.where(2 * np.resize(order, groups * lines) > numbers, -1, 1).reshape(
                -1, 1, lines
            )
        self._table = _array(grouped if self._is_pair else grouped[0], kind)
        self._signs = _array(np.where(2 * order_across > shape[0], -1.0, 1.0), np.float64)
        longest = max(groups * lines, (1 + self._is_pair) * shape[0] if shape[0] > grids.rows else 0)
        own = groups * (2 if self._is_pair else self._slots if grids.count > 1 else 1)
        real = wp.dtype_from_numpy(kind)
        places = within.memory if isinstance(within, Convolution) else (None, None)
        self.memory: tuple[Field, Field] = (
            lying(places[0], (self._slots, 2 * lines * longest), real, executor.device),
            lying(places[1], (own, grids.rows, 2 * lines), real, executor.device),
        )

    def set_mean(self, value: float) -> None:
        """Set the answer to a uniform pressure [mm/MPa]."""
        self._table.numpy()[0, 0, 0] = value

    def add_to(
        self, program: Program, field_in: Field, line: Any, field_out: Field, *, divides: bool = False
    ) -> None:
        """Add the transforms and the product between them to a program."""
        plan = arguments(fourier.FourierPlan, divides=divides, **self._plan)
        scratch, modes = self.memory

        def launch(kernel: Any, *arrays: Any) -> None:
            chunks = [(slot, slot + 1) for slot in range(self._slots)]
            program.launch(kernel[self._kind], plan, self._turns, *arrays, slots=self._slots, chunks=chunks)

        if self._is_pair:
            rows, groups = self._grids.rows, modes.shape[0] // 2
            halves = [(slice(0, rows), modes[:groups]), (slice(rows, None), modes[groups:])]
            for half, part in halves:
                launch(fourier.forward, field_in[half], scratch, part)
            launch(fourier.across_pair, self._table, self._signs, scratch, modes)
            for half, part in halves:
                launch(fourier.back, field_out[half], scratch, part)
            return
        if self._grids.count > 1:
            launch(fourier.convolve, self._table, line, field_in, scratch, modes, field_out)
            return
        launch(fourier.forward, field_in, scratch, modes)
        launch(fourier.across, self._table, line, scratch, modes)
        launch(fourier.back, field_out, scratch, modes)


def _numbers(columns: int) -> int:
    """Return the complex numbers as which a row is transformed."""
    return columns if columns % 2 else columns // 2


def _stages(length: int, filled: int) -> list[int]:
    """Return the stages of a transform, of which the first numbers are filled; −2 leaves out zeros."""
    halved = length % 2 == 0 and filled <= length // 2
    return [-2, *radices_of(length // 2)] if halved else radices_of(length)


def _order(length: int, stages: list[int]) -> IntArray:
    """Return the mode that lies in each place after a transform."""
    if not stages:
        return np.zeros(1, dtype=np.int64)
    radix, rest = abs(stages[0]), stages[1:]
    inner = radix * _order(length // radix, rest)
    return np.concatenate([inner + q for q in range(radix)])


def _turns(length: int, stages: list[int]) -> FloatArray:
    """Return the factors between a transform's stages, and waves of large primes, stage after stage."""
    turns, size = [np.empty(0)], length
    for radix in (abs(stage) for stage in stages):
        turns.append(_pairs(-2.0 * math.pi / size * np.outer(np.arange(size // radix), np.arange(1, radix))))
        if radix not in SMALL_RADICES:
            turns.append(_waves(radix))
        size //= radix
    return np.concatenate(turns)


def _waves(radix: int) -> FloatArray:
    """Return cosines and sines of numbers 1 … p//2 of a prime, for an even number of modes, two at a time."""
    numbers, modes = np.arange(1, radix // 2 + 1), np.arange(1, radix // 2 + radix // 2 % 2 + 1)
    angles = 2.0 * math.pi / radix * (np.outer(numbers, modes) % radix)
    return _pairs(angles.reshape(numbers.size, -1, 2).swapaxes(0, 1))


def _pairs(angle: Any) -> FloatArray:
    """Return the cosine and the sine of each angle."""
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1).ravel()


def _in_groups(table: FloatArray, columns: IntArray, lines: int, kind: Any) -> FloatArray:
    """Return rows 0 … n//2 of an even table, by groups of columns."""
    rows = table.shape[0]
    grouped = np.empty((columns.size // lines, rows, lines), dtype=kind)
    for first in range(0, rows, TOGETHER):
        part = table[first : first + TOGETHER, columns]
        grouped[:, first : first + TOGETHER] = part.reshape(len(part), -1, lines).swapaxes(0, 1)
    return grouped


def _array(values: Any, kind: Any) -> Any:
    """Return values as an array of a CPU."""
    values = np.ascontiguousarray(values, dtype=kind)
    return wp.array(values, dtype=wp.dtype_from_numpy(kind), device="cpu", copy=False)
