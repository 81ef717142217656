"""Where the time of a step goes, by the file of the kernel that is running."""

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import warp as wp

from warpwear.engine.program import Block

#: Kernels or kernel files of a phase; a file that is not here is a phase of its own.
PHASES = {
    "contact": "gap",
    "recession": "wear",
    "sliding.select": "gap",
    "sliding.wear_step": "wear",
}


@contextmanager
def not_recorded() -> Iterator[None]:
    """Programs first run in this context are not recorded: the host makes each launch, and can time it."""
    replaced: Any = Block
    record = Block.record
    replaced.record = lambda block, device: None
    try:
        yield
    finally:
        replaced.record = record


@contextmanager
def kernel_times() -> Iterator[dict[str, float]]:
    """Seconds in kernels while the context is open, by phase. Launches must be made one after another.

    Of programs that are run first in the context `not_recorded`.
    """
    spent: defaultdict[str, float] = defaultdict(float)
    launch, relaunch = wp.launch, wp.Launch.launch

    def timed(kernel: Any, call: Callable[[], Any]) -> Any:
        start = time.perf_counter()
        try:
            return call()
        finally:
            file = kernel.module.name.rpartition(".")[2]
            phase = PHASES.get(f"{file}.{kernel.key}", PHASES.get(file, file))
            spent[phase] += time.perf_counter() - start

    def first_launch(kernel: Any, *args: Any, **options: Any) -> Any:
        return timed(kernel, lambda: launch(kernel, *args, **options))

    def launch_again(command: Any, *args: Any, **options: Any) -> Any:
        return timed(command.kernel, lambda: relaunch(command, *args, **options))

    replaced: Any = wp.Launch
    wp.launch, replaced.launch = first_launch, launch_again
    try:
        yield spent
    finally:
        wp.launch, replaced.launch = launch, relaunch
