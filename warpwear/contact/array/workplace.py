"""Contacts of arrays are solved in places that are kept for the next call where the array is small.

To make fields and solvers and to record their programs takes ten times as long as a solve of 64 x 64 cells.
"""

import math
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from typing import Any, Self, TypeVar

import numpy as np

from warpwear.contact.array.memory import LARGE, SAID
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.device import free_memory
from warpwear.engine.executor import Executor, Field
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING

T = TypeVar("T")

#: Cells of the largest array whose place is kept.
MOST_CELLS = 2**15
#: Places that are kept, and solvers in each of them; all together take at most some 100 MB.
MOST_PLACES = 4
MOST_SOLVERS = 6


class Workplace:
    """Has an executor and, where it is kept, fields by name and the last few solvers that were made on them.

    One call uses it at a time. is_kept: whether another may follow.
    """

    def __init__(self, grid: Grid, *, device: str, threads: int | None, is_kept: bool) -> None:
        self.executor = Executor(grid, device=device, threads=threads, fields_needed=0.0)  # it was asked for
        self.is_kept = is_kept and not self.executor.is_shared  # whose threads end with a call
        self._fields: dict[str, Field] = {}
        self._solvers: dict[Hashable, Any] = {}

    def solver(self, key: Hashable, make: Callable[[], T]) -> T:
        """Return what was made under a key, or make it."""
        if not self.is_kept:
            return make()
        solver: T = self._solvers.pop(key, None) or make()
        self._solvers[key] = solver
        for old in list(self._solvers)[:-MOST_SOLVERS]:
            del self._solvers[old]
        return solver

    def part(self, grid: Grid) -> Self:
        """Return a place for another grid on the same device."""
        like: dict[str, Any] = {"device": str(self.executor.device), "threads": self.executor.threads}
        return self.solver(grid, lambda: type(self)(grid, **like, is_kept=self.is_kept))

    def field(self, name: str, values: FloatArray | None = None, *, padding: float = 0.0) -> Field:
        """Make a field of an array of all cells, or of zeros; of a kept place it is the same one again."""
        executor = self.executor
        if not self.is_kept:
            return executor.zeros() if values is None else executor.field(values, padding=padding)
        if name not in self._fields:
            self._fields[name] = executor.field(np.zeros(executor.grid.shape), padding=padding)
        executor.fill(self._fields[name], np.zeros(()) if values is None else values)
        return self._fields[name]

    def gap(self, values: FloatArray) -> Field:
        """Make a field of a gap, with no surface beyond the counter-body's edge and in the padding."""
        finite = values if math.isfinite(values.max()) else np.minimum(values, PADDING)
        return self.field("gap", finite, padding=PADDING)

    def half_space(self, boundary: str, cap: float, *, tolerance: float, **options: Any) -> HalfSpace:
        """Return a solver of E* = 1 that begins from nothing."""
        like: dict[str, Any] = {"modulus": 1.0, "boundary": boundary, "hardness": cap, **options}
        solver = self.solver(tuple(like.values()), lambda: HalfSpace(self.executor, **like))
        solver.forget()
        solver.tolerance = tolerance
        return solver


#: Those that are not lent. Each change of it is one step of Python: neither threads nor forks need a lock.
_kept: dict[Hashable, Workplace] = {}


@contextmanager
def workplace(
    work: str, shape: tuple[int, int], check: Callable[[], None], *, device: str, threads: int | None
) -> Iterator[Workplace]:
    """Lend a place for cells of width 1; no other thread has it, and one whose call fails is not kept.

    work: what is done there. check: raises InputError where there is too little memory for a new one.
    """
    key, grid = (work, shape, str(device), threads), Grid(*shape, 1.0)
    place = _kept.pop(key, None)
    if place is None:
        if grid.cells >= LARGE or min(free_memory(device).values()) < SAID:
            _kept.clear()
        check()
        place = Workplace(grid, device=device, threads=threads, is_kept=grid.cells <= MOST_CELLS)
    with place.executor:
        yield place
    if place.is_kept:
        _kept[key] = place
        for old in list(_kept)[:-MOST_PLACES]:
            _kept.pop(old, None)
