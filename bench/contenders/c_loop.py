"""The loop of `contenders.baselines.NumpyLoop` with its passes over the cells in C, through ctypes.

`c_loop.c` is compiled once a process by the first of cc, gcc, clang that is there.
"""

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from contenders.baselines import FloatArray, NumpyLoop, Problem

FLAGS = ("-O3", "-march=native", "-fopenmp-simd")
SOURCE = Path(__file__).with_name("c_loop.c")
#: Below this many cells a thread, handing work to a pool costs more than it saves; the package's.
CELLS_PER_THREAD = 50_000

DOUBLE, LONG = ctypes.c_double, ctypes.c_long


class NoCompilerError(RuntimeError):
    """No C compiler, or one that does not compile the loop; the message says which."""


@cache
def library() -> ctypes.CDLL:
    """The compiled passes. Raises NoCompilerError."""
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        raise NoCompilerError("no C compiler is here (cc, gcc, clang): the loop in C is left out")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "c_loop.so"
        command = [compiler, *FLAGS, "-shared", "-fPIC", "-o", str(out), str(SOURCE)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            first = (done.stderr.strip() or f"status {done.returncode}").splitlines()[0]
            raise NoCompilerError(f"{compiler} does not compile the loop in C, which is left out: {first}")
        return ctypes.CDLL(str(out))


@cache
def compiler_version() -> str | None:
    """First line of the compiler's own words, None without one."""
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        return None
    said = subprocess.run([compiler, "--version"], capture_output=True, text=True).stdout
    return f"{said.splitlines()[0]} {' '.join(FLAGS)}" if said else compiler


class CLoop(NumpyLoop):
    """NumPy's loop with each pass a loop in C over chunks of rows, one chunk a thread.

    As in the package, one gap is worn, and what is worn is told from the gap without wear.
    """

    def __init__(self, problem: Problem, gap: FloatArray, *, threads: int = 1) -> None:
        """Raises NoCompilerError."""
        self._library = library()
        chunks = max(1, min(threads, gap.size // CELLS_PER_THREAD))
        rows = [gap.shape[0] * i // chunks for i in range(chunks + 1)]
        self._rows = [slice(*edges) for edges in pairwise(rows)]
        self._pool = ThreadPoolExecutor(chunks - 1) if chunks > 1 else None
        self._base = 0.0
        self._factor = np.ascontiguousarray(problem.factor)
        self._share = problem.wear_counter / (problem.wear_counter + problem.wear_disc * self._factor)
        self._unworn = gap.copy()
        super().__init__(problem, gap)

    def allocate(self) -> None:
        """Places for the sums of each chunk; nothing else is stored."""
        self._sums = np.zeros((len(self._rows), 8))

    def bounds(self) -> tuple[float, float]:
        found = self._each("bounds", (), (self.gap,), 2)
        return float(found[:, 0].min()), float(found[:, 1].max())

    def set_base(self, base: float) -> None:
        self._base = base

    def carried(self, offset: float, deepest: float) -> tuple[float, float]:
        numbers = LONG(self.gap.shape[1]), *map(DOUBLE, (self._base, offset, deepest))
        pressed, between = self._each("carried", numbers, (self.gap,), 2).sum(axis=0)
        return float(pressed), float(between)

    def count(self, approach: float) -> float:
        return float(self._each("count", (DOUBLE(approach),), (self.gap,), 1).sum())

    def wear_overlap(
        self, offset: float, deepest: float, counter: float, disc: float
    ) -> tuple[float, float, float]:
        return self._worn("wear_overlap", (self._base, offset, deepest, counter, disc))

    def wear_bearing(self, approach: float, counter: float, disc: float) -> tuple[float, float, float]:
        return self._worn("wear_bearing", (approach, counter, disc))

    def _worn(self, name: str, numbers: tuple[float, ...]) -> tuple[float, float, float]:
        rows = _address(self._factor), _address(self._share)
        arguments = LONG(self.gap.shape[1]), *map(DOUBLE, numbers), *rows
        fields = self.gap, self._unworn
        contact, counter, disc = self._each(name, arguments, fields, 3).sum(axis=0)
        return float(contact), float(counter), float(disc)

    def _each(
        self, name: str, numbers: tuple[Any, ...], fields: tuple[FloatArray, ...], columns: int
    ) -> FloatArray:
        """A pass over every chunk; its sums, a row a chunk."""
        function: Callable[..., None] = self._library[name]

        def chunk(i: int) -> None:
            rows = self._rows[i]
            places = [_address(field[rows]) for field in fields]
            cells = LONG((rows.stop - rows.start) * self.gap.shape[1])
            function(cells, *numbers, *places, _address(self._sums[i]))

        waiting = [self._pool.submit(chunk, i) for i in range(1, len(self._rows))] if self._pool else []
        chunk(0)
        for future in waiting:
            future.result()
        found: FloatArray = self._sums[:, :columns]
        return found


def _address(values: FloatArray) -> ctypes.c_void_p:
    return ctypes.c_void_p(values.ctypes.data)
