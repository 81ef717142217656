"""Arrays of the host are read by blocks of rows, on every core, and brought to a field of a GPU and back.

A billion cells pass a GPU in a hundredth of a second and a core of the host in one, or in four where their
memory is new; so nothing here is done by one core, and nothing is laid down on the way but in buffers.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import warp as wp

from warpwear.engine.executor import Executor, Field, as_numbers
from warpwear.grid import FloatArray, blocks_of_rows
from warpwear.kernels.cells import LANES, Cells

T = TypeVar("T")

#: Cells of a block.
TOGETHER = 2**21


def each(work: Callable[[slice], T], shape: tuple[int, ...], threads: int) -> list[T]:
    """Return what the work gives for each block of rows, in their order."""
    blocks = blocks_of_rows(shape[0], values=shape[1], together=TOGETHER)
    if min(len(blocks), threads) == 1:
        return [work(rows) for rows in blocks]
    with ThreadPoolExecutor(min(len(blocks), threads)) as pool:
        return list(pool.map(work, blocks))


def upload(executor: Executor, make: Callable[[slice], FloatArray], *, padding: float = 0.0) -> Field:
    """Make a field of what `make` gives for each block of rows. padding: value beyond the last column."""
    grid, columns = executor.grid, executor.vectors * LANES
    field = wp.empty((grid.nx, executor.vectors), dtype=Cells, device=executor.device)
    place = as_numbers(field, grid.nx * columns)

    def fill(rows: slice, buffers: list[Any]) -> None:
        host = buffers[0].numpy()[: (rows.stop - rows.start) * columns].reshape(-1, columns)
        host[:, : grid.ny] = make(rows)
        host[:, grid.ny :] = padding

    for pool, staged, group in _groups(executor, [columns]):
        list(pool.map(fill, group, staged))
        for rows, (buffer,) in zip(group, staged, strict=False):
            count = (rows.stop - rows.start) * columns
            wp.copy(place, buffer, dest_offset=rows.start * columns, count=count)
        wp.synchronize_device(executor.device)
    return field


def download(executor: Executor, arrays: list[Any], take: Callable[..., T], pitches: list[int]) -> list[T]:
    """Return what `take` gives for each block of rows and what the arrays hold there, each (rows, ny).

    arrays: Warp's, of as many rows as the grid and so many numbers a row as `pitches` say. `take` must copy.
    """
    grid = executor.grid
    blocks_taken: list[T] = []
    sources = [as_numbers(a, grid.nx * pitch) for a, pitch in zip(arrays, pitches, strict=True)]

    def read(rows: slice, buffers: list[Any]) -> T:
        lines = rows.stop - rows.start
        blocks = [
            buffer.numpy()[: lines * pitch].reshape(lines, pitch)[:, : grid.ny]
            for buffer, pitch in zip(buffers, pitches, strict=True)
        ]
        return take(rows, *blocks)

    for pool, staged, group in _groups(executor, pitches):
        for rows, buffers in zip(group, staged, strict=False):
            for source, buffer, pitch in zip(sources, buffers, pitches, strict=True):
                count = (rows.stop - rows.start) * pitch
                wp.copy(buffer, source, src_offset=rows.start * pitch, count=count)
        wp.synchronize_device(executor.device)
        blocks_taken.extend(pool.map(read, group, staged))
    return blocks_taken


def _groups(
    executor: Executor, pitches: list[int]
) -> Iterator[tuple[ThreadPoolExecutor, list[list[Any]], list[slice]]]:
    """Give a block for each thread at a time, and page-locked buffers for rows of these lengths."""
    blocks = blocks_of_rows(executor.grid.nx, values=executor.grid.ny, together=TOGETHER)
    threads, lines = min(executor.threads, len(blocks)), blocks[0].stop
    pinned = executor.device.is_cuda
    staged = [
        [wp.empty(lines * pitch, dtype=wp.float64, device="cpu", pinned=pinned) for pitch in pitches]
        for _ in range(threads)
    ]
    with ThreadPoolExecutor(threads) as pool:
        for first in range(0, len(blocks), threads):
            yield pool, staged, blocks[first : first + threads]
