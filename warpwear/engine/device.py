"""A run asks for a device: it is there or not, has so many threads, and its memory will do or not."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any

import psutil

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import Grid

wp = lazy.module("warp")

#: Held while Warp starts, by a thread of a user's perhaps: it would start once more in another.
STARTING = Lock()


@contextmanager
def report_out_of_memory(grid: Grid) -> Iterator[None]:
    """Raise InputError, naming the grid, where the memory of the host or of a GPU runs out all the same."""
    try:
        yield
    except (MemoryError, RuntimeError) as error:
        # Warp says it in a RuntimeError, and so does Python where there is no room for another thread.
        if isinstance(error, RuntimeError) and not any(
            words in str(error) for words in ("Failed to allocate", "can't start new thread")
        ):
            raise
        raise InputError(
            f"grid.cell = {1e3 * grid.cell:g} µm makes {grid.nx} × {grid.ny} cells, for which the memory ran "
            "out; larger cells or a smaller grid.extent are needed."
        ) from error


def find_device(name: str) -> Any:
    """Return Warp's device of this name. Raises InputError, naming those that are there."""
    if wp.config.log_level == wp.LOG_INFO:  # no greeting on a user's terminal, unless one was asked for
        wp.config.log_level = wp.LOG_ERROR
    try:
        with STARTING, _native_messages_hidden():
            wp.init()
    except (RuntimeError, OSError) as error:  # its library cannot be loaded, for want of memory, say
        raise InputError(f"device = {name!r} cannot be used, as Warp does not start: {error}.") from error
    try:
        with _native_messages_hidden():
            return wp.get_device(name)
    except (ValueError, RuntimeError, TypeError) as error:  # no name at all, too
        there = ", ".join(str(d.alias) for d in wp.get_devices())
        raise InputError(f"device = {name!r} is not there; this machine has {there}.") from error


def free_memory(device: str) -> dict[str, int]:
    """Return the memory that is free on the host and on a device [B], by what a sentence calls them.

    Raises InputError for a device that is not there.
    """
    free, memory_device = {"the host": psutil.virtual_memory().available}, find_device(device)
    if memory_device.is_cuda:
        free[str(memory_device)] = memory_device.free_memory
    return free


@contextmanager
def _native_messages_hidden() -> Iterator[None]:
    """Warp's native part warns of a missing GPU or driver; where that matters, our own words follow."""
    try:
        stderr = os.dup(2)
    except OSError:  # no standard error to guard
        yield
        return
    try:
        with open(os.devnull, "w") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(stderr, 2)
        os.close(stderr)


#: What computes in this process, by the ids of executors.
BUSY: set[int] = set()
#: What computed in the process that this one was forked from.
_FORKED: set[int] = set()


def _forget_threads() -> None:
    """Note in a forked process what computed: its threads are gone, and the locks that they held are shut."""
    _FORKED.update(BUSY)
    BUSY.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_threads)


def check_threads(threads: int | None) -> int:
    """Return the number of threads asked for, or of usable cores. Raises InputError.

    Also in a process that was forked in the middle of a computation, which would wait without end.
    """
    if _FORKED:
        raise InputError(
            "this process was forked while another thread computed, and would wait for it without end; "
            "allowed are processes that are started anew: multiprocessing.set_start_method('spawn')"
        )
    cores = usable_cores()
    if threads is None:
        return cores
    if not isinstance(threads, int) or not 1 <= threads <= cores:
        raise InputError(f"threads = {threads!r} is not possible; allowed are 1 to {cores}, the cores here.")
    return threads


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    process = psutil.Process()
    return len(process.cpu_affinity()) if hasattr(process, "cpu_affinity") else psutil.cpu_count() or 1


def gpu_count() -> int:
    """Return the number of GPUs of CUDA here."""
    find_device("cpu")
    return int(wp.get_cuda_device_count())
