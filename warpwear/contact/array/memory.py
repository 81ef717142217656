"""Say what memory the contact of an array needs before it starts, and give it back at its end."""

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from warpwear.contact.half_space.transforms import release
from warpwear.engine.device import find_device, free_memory
from warpwear.engine.executor import Executor
from warpwear.errors import InputError

#: Fields that a solve holds at its peak beside the heights, at a load as at an approach, with some to spare,
#: by the boundary of the half-space (None: springs and the bearing area): measured were 8.2, 8.3 and 11.1.
FIELDS: dict[str | None, float] = {None: 10.0, "periodic": 11.0, "free": 14.0, "line": 20.0}
#: On the host beside a GPU: of a periodic half-space nothing lies there but pressure, gap and buffers
#: (measured: 2.3); the others are certified there, in the fields that a CPU needs for it.
FIELDS_BESIDE_GPU: dict[str | None, float] = {None: 10.0, "periodic": 3.0, "free": 10.0, "line": 12.0}
#: On the GPU; measured.
FIELDS_ON_GPU: dict[str | None, float] = {None: 12.0, "periodic": 15.5, "free": 62.0, "line": 36.0}
#: Memory from which a solve says on standard error what it needs before it starts [B].
SAID = 2.0 * 2**30
#: Cells from which a solve begins and ends with nothing kept on a GPU.
LARGE = 2**22


@contextmanager
def giving_back(executor: Executor) -> Iterator[None]:
    """Leave nothing of a large solve on a GPU, of one that failed neither.

    Raises MemoryError where memory runs out, which Warp says in a RuntimeError.
    """
    try:
        yield
    except RuntimeError as error:
        if "Failed to allocate" not in str(error):
            raise
        raise MemoryError(str(error)) from error
    finally:
        if executor.grid.cells >= LARGE:
            release(executor.device)


def check_memory(shape: tuple[int, ...], device: str, edge: str | None) -> None:
    """Say what memory a large contact needs; InputError where there is less."""
    if math.prod(shape) >= LARGE:
        release(find_device(device))  # what is kept of earlier solves counts as free
    host, *gpu = free_memory(device)
    fields = {host: (FIELDS_BESIDE_GPU if gpu else FIELDS)[edge]} | dict.fromkeys(gpu, FIELDS_ON_GPU[edge])
    needs = {place: count * 8.0 * math.prod(shape) for place, count in fields.items()}
    claim("solve_contact", f"heights of shape {shape}", needs, device)


def claim(caller: str, work: str, needs: dict[str, float], device: str = "cpu") -> None:
    """Say what memory [B] a call needs of each place where it is much; InputError where there is less."""
    plan = []
    for place, there in free_memory(device).items():
        if needs[place] > there:
            raise InputError(
                f"{work} need {needs[place] / 2**30:.1f} GiB of memory; {place} has "
                f"{there / 2**30:.1f} GiB free."
            )
        plan.append(f"{needs[place] / 2**30:.1f} GiB of {place} ({there / 2**30:.1f} GiB free)")
    if max(needs.values()) >= SAID:
        print(f"{caller}: {work} need up to {' and '.join(plan)}", file=sys.stderr)
