"""Kernels run on a device, by its threads, over fields that it stores. Programs launch there, see `program`.

A pass works on slots, one slot a row of cells on a CPU and a block of threads on a GPU; each slot writes its
own column of the table of partial results, so that no result depends on the number of threads. On a CPU a
launch is one loop on one core that lets go of Python's lock, so chunks of rows run on a pool of threads.
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from threading import RLock
from typing import Any, Self

import numpy as np
import warp as wp

from warpwear.engine.device import BUSY, check_threads, find_device, free_memory
from warpwear.engine.kernel_cache import begin_to_load
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels import native_code
from warpwear.kernels.cells import LANES, TILE_VECTORS, Cells

#: Below this many cells a thread, handing work to a pool costs more than it saves.
CELLS_PER_THREAD = 100_000
#: Below this many cells threads gain nothing.
SMALL = 2 * CELLS_PER_THREAD
#: Threads of a slot of a pass on a GPU, and slots of a pass there at most: each takes several rows then.
BLOCK = 256
MOST_SLOTS_CUDA = 528
#: Held while launches are made by the host, and while they are recorded: Warp records those of every thread.
GATE = RLock()

#: Fields alive at the peak of a run: gap as worn and unworn, pressure, wear of both bodies, and room to work.
FIELDS_NEEDED = 6.0

Field = Any  # wp.array2d(dtype=Cells); Warp's arrays carry no static type
Arguments = Any  # an instance of a wp.struct


def arguments(kind: Any, device: Any = None, **members: Any) -> Arguments:
    """Make an instance of a wp.struct. Launches see what changes in it later, recordings do not.

    device: where arrays are made of zeros that are given by their shape; those of one dimension that are not
    given are of one zero each. Without it these have no rows.
    """
    instance = kind()
    for name, member in kind.vars.items() if device else ():
        if getattr(member.type, "ndim", 0) == 1 and name not in members:
            setattr(instance, name, wp.zeros(1, dtype=member.type.dtype, device=device))
    for name, value in members.items():
        of = kind.vars[name].type
        makes = device is not None and isinstance(of, wp.array) and isinstance(value, int | tuple)
        setattr(instance, name, wp.zeros(value, dtype=of.dtype, device=device) if makes else value)
    return instance


def as_numbers(field: Field, shape: int | tuple[int, int]) -> Field:
    """Return a field as single numbers, which lie without gaps, in the same memory."""
    view: Field = wp.array(ptr=field.ptr, dtype=wp.float64, shape=shape, device=field.device, copy=False)
    view._owner = field  # which keeps the memory
    return view


def require_memory(device: str, needed: float, what: str, instead: str) -> None:
    """Refuse what the host or a device does not hold: raises InputError.

    needed: [B]. what: begins the sentence, up to what needs it. instead: what is allowed.
    """
    for place, free in free_memory(device).items():
        if needed > free:
            raise InputError(
                f"{what}, which need {needed / 2**30:.1f} GiB of memory; {place} has {free / 2**30:.1f} GiB "
                f"free, so {instead}"
            )


class Executor:
    """Launches kernels over the rows of one grid on one device, and makes fields for them.

    Use as a context manager, so that its threads end with it.

    fields_needed: fields that a run holds at its peak. Raises InputError for a device that is not there, more
    threads than cores, and a grid whose fields no memory holds.
    """

    def __init__(
        self,
        grid: Grid,
        *,
        device: str = "cpu",
        threads: int | None = None,
        fields_needed: float = FIELDS_NEEDED,
    ) -> None:
        self.grid = grid
        self.device = find_device(device)
        self.threads = check_threads(threads)
        what = f"grid.cell = {1e3 * grid.cell:g} µm makes {grid.nx} × {grid.ny} cells"
        instead = "larger cells or a smaller grid.extent are needed."
        require_memory(device, 8.0 * fields_needed * grid.cells, what, instead)
        self.vectors = -(-grid.ny // LANES)
        self.tiles_per_row = -(-self.vectors // int(TILE_VECTORS))
        workers = min(self.threads, grid.cells // CELLS_PER_THREAD) - 1 if self.device.is_cpu else 0
        self._pool = ThreadPoolExecutor(workers) if workers > 0 else None
        #: Whether passes over many cells are shared among threads.
        self.is_shared = workers > 0
        self._loaded: set[Any] = set()
        self._loader: ThreadPoolExecutor | None = None
        self._foreseen: dict[Any, Callable[[], None]] = {}
        self._copies: dict[Any, Any] = {}

    def __enter__(self) -> Self:
        BUSY.add(id(self))
        return self

    def __exit__(self, *_: object) -> None:
        BUSY.discard(id(self))
        for pool in (self._pool, self._loader):
            if pool is not None:
                pool.shutdown(cancel_futures=True)

    def foresee(self, kernels: Iterable[Any], *, together: bool = False) -> None:
        """Begin to load, or compile, the files of kernels on a CPU in that order, beside other work.

        together: whether these are all that a run launches of their files; they are compiled as one.
        """
        if together and self.device.is_cpu:
            with GATE:  # another thread's copies of the same would change the module below its launches
                self._copies |= native_code.together(tuple(kernels))
        modules = dict.fromkeys(self._copies.get(kernel, kernel).module for kernel in kernels)
        new = [module for module in modules if module not in self._loaded | self._foreseen.keys()]
        if not self.device.is_cpu or not new:
            return
        self._loader = self._loader or ThreadPoolExecutor(check_threads(None))
        for module in new:
            self._foreseen[module] = begin_to_load(module, self.device, self._loader)

    def expects(self, kernel: Any) -> bool:
        """Tell whether the file of a kernel is loaded, or begun to be."""
        return kernel.module in self._loaded | self._foreseen.keys()

    def load(self, kernel: Any) -> Any:
        """Load, or compile, the file of a kernel before any thread needs it; return what to launch."""
        kernel = self._copies.get(kernel, kernel)
        module = kernel.module
        if module not in self._loaded:
            (self._foreseen.pop(module, None) or begin_to_load(module, self.device))()
            self._loaded.add(module)
        return kernel

    def slots_of(self, rows: int, *, most: int = MOST_SLOTS_CUDA) -> int:
        """Return the slots of a pass over rows: on a CPU one each, on a GPU of equally many rows each.

        most: slots of a GPU at most.
        """
        return rows if self.device.is_cpu else -(-rows // -(-rows // most))

    def equal_chunks(self, slots: int) -> list[tuple[int, int]]:
        """Return ranges of slots for the threads, of passes over whole rows."""
        return self.split_rows(np.full(slots, -(-self.grid.cells // slots)))

    def on_threads(self, work: Sequence[Callable[[], Any]]) -> None:
        """Do pieces of work side by side, the first on this thread."""
        waiting = [self._pool.submit(piece) for piece in work[1:]] if self._pool else []
        work[0]()
        for future in waiting:
            future.result()

    def split_rows(self, cells: Any) -> list[tuple[int, int]]:
        """Return ranges of slots for the threads, of about as many cells each. cells: of each row visited."""
        rows = len(cells)
        if not self.device.is_cpu:
            return [(0, rows)]
        chunks = max(1, min(self.threads, int(np.sum(cells)) // CELLS_PER_THREAD))
        if chunks == 1:
            return [(0, rows)]
        done = np.concatenate([[0], np.cumsum(cells)])
        edges = [0, *np.searchsorted(done, [done[-1] * i // chunks for i in range(1, chunks)]), rows]
        return [(int(first), int(last)) for first, last in pairwise(edges) if last > first]

    def zeros(self, rows: int | None = None) -> Field:
        """Make a field of zeros, with as many rows as the grid by default.

        On a CPU what is never touched takes neither time nor memory.
        """
        shape = (self.grid.nx if rows is None else rows, self.vectors)
        if not self.device.is_cpu:
            return wp.zeros(shape, dtype=Cells, device=self.device)
        return wp.array(np.zeros((*shape, LANES)), dtype=Cells, device=self.device, copy=False)

    def field(self, values: FloatArray, *, padding: float = 0.0) -> Field:
        """Make a field from an array of shape (nx, ny), (1, ny) (every row the same) or (1, 1).

        padding: value beyond the last column. On a CPU it shares the memory of an array that needs none.
        """
        rows = values.shape[0]
        padded = values
        if values.shape[1] != self.vectors * LANES:
            padded = np.full((rows, self.vectors * LANES), padding)
            padded[:, : self.grid.ny] = values
        vectors = np.ascontiguousarray(padded, dtype=np.float64).reshape(rows, self.vectors, LANES)
        return wp.array(vectors, dtype=Cells, device=self.device, copy=not self.device.is_cpu)

    def to_numpy(self, field: Field) -> FloatArray:
        """Return the values of a field, shape (nx, ny); on a CPU a view of its memory."""
        return field.numpy().reshape(field.shape[0], -1)[:, : self.grid.ny]

    def fill(self, field: Field, values: FloatArray) -> None:
        """Give a field other values, shape (nx, ny), in place; its padding stays."""
        host = field.numpy()
        host.reshape(field.shape[0], -1)[:, : self.grid.ny] = values
        if not self.device.is_cpu:
            field.assign(host)

    def put(self, array: Any, values: Any) -> None:
        """Give an array of Warp's other values, in place; a number goes to all its places."""
        if self.device.is_cpu:
            array.numpy()[...] = values
        elif np.ndim(values) == 0:
            array.fill_(values)
        else:
            array.assign(np.ascontiguousarray(values, dtype=wp.dtype_to_numpy(array.dtype)))
