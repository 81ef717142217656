"""A contact of half-spaces is solved on the part of a large grid that it can reach.

Pressures displace a free half-space away from the other body everywhere, so that a cell whose gap exceeds the
approach cannot be in contact. A contact that was solved on a window which holds every cell below its approach
is therefore that of the whole grid, and its cost follows the contact.
"""

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt
import warp as wp

from warpwear import lazy
from warpwear.contact.balance import TOLERANCE as LOAD_TOLERANCE
from warpwear.contact.half_space.search import Search
from warpwear.contact.half_space.solver import TOLERANCE, HalfSpace, HalfSpaceContact, wide_cells_pay
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Mirror
from warpwear.engine.program import Program, launch_once
from warpwear.engine.state import InFrame
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import LANES, PADDING, Cells
from warpwear.kernels.half_space import passes

fft = lazy.module("scipy.fft")

#: Sizes of windows along a side of the grid.
SIZES = 8
#: Room beside what can be in contact, over its width, so that a window lasts for many steps.
ROOM = 0.1
#: A window gives way to a smaller one that has at most this fraction of its area.
SMALLER = 0.5
#: Load that a window made for a load can carry at the hardness, over the load asked for.
CAPACITY = 2.0
#: Solvers of windows that are there for the next time, and cells of all of them.
MOST_STORED = 16
MOST_CELLS_STORED = 2**20
#: Rows of a grid that repeats across, over its columns, from which windows pay: under a line of pressure
#: everything sinks within the grid's length, and waves across are gone at that distance.
LEAST_LONG = 2
#: Fields that cells may have of their own, see `solver.BoundedPressure.solve`.
OWN = ("cap_ratio", "yields", "streak_yields")


@dataclass(frozen=True)
class Window:
    """A window holds rows first_row … end_row − 1 and vectors first … end − 1 of a field."""

    first_row: int
    end_row: int
    first: int
    end: int

    @classmethod
    def around(cls, box: Sequence[int], grid: Grid, *, rows: int = 1, pieces: int = 1) -> Self:
        """Return a window that holds a box: first and last row, first and last column.

        rows: that it has at least. pieces: least of its `SIZES` sizes along a side of the grid.
        """
        along = _placed(box[0], box[1], grid.nx, step=1, least=rows, pieces=pieces)
        across = _placed(box[2], box[3], grid.ny, step=LANES, least=1, pieces=pieces)
        return cls(*along, across[0] // LANES, -(-across[1] // LANES))

    @classmethod
    def close_to(cls, box: Sequence[int], grid: Grid) -> Self:
        """Return the smallest window that holds a box and is quick to transform."""
        along, across = (_quick(box[2 * n], box[2 * n + 1], grid.shape[n]) for n in range(2))
        return cls(*along, across[0] // LANES, -(-across[1] // LANES))

    @property
    def area(self) -> int:
        """Return the area in vectors."""
        return (self.end_row - self.first_row) * (self.end - self.first)

    @property
    def box(self) -> tuple[int, int, int, int]:
        """Return the first and last row, and the first and last column."""
        return self.first_row, self.end_row - 1, self.first * LANES, self.end * LANES - 1

    def holds(self, box: Sequence[int]) -> bool:
        """Tell whether a box of rows and columns lies inside."""
        rows = self.first_row <= box[0] and box[1] < self.end_row
        return rows and self.first * LANES <= box[2] and box[3] < self.end * LANES

    @property
    def cells(self) -> tuple[slice, slice]:
        """Return the window's rows and columns; where it reaches the grid's end it may go beyond."""
        return slice(self.first_row, self.end_row), slice(self.first * LANES, self.end * LANES)

    def of(self, field: Field) -> Field:
        """Return what a field of the whole grid holds in the window, seen where it lies."""
        return field[self.first_row : self.end_row, self.first : self.end]

    def give(self, executor: Executor, part: Field, field: Field) -> None:
        """Copy a part, of an executor, to where it lies in a field of the whole grid."""
        first: Field = wp.array([self.first_row, self.first], dtype=wp.int32, device=executor.device)
        transfer = arguments(passes.Transfer, field=part, target=field, first=first)
        launch_once(executor, passes.give_window, transfer)

    def grid(self, whole: Grid) -> Grid:
        """Return the grid of the window on a whole one."""
        columns = min(self.end * LANES, whole.ny) - self.first * LANES
        return Grid(self.end_row - self.first_row, columns, whole.cell)


def _placed(first: int, last: int, size: int, *, step: int, least: int, pieces: int) -> tuple[int, int]:
    """Begin and end of a stretch around first … last, of one of `SIZES` sizes, on multiples of a step."""
    wanted = max((last - first + 1) * (1.0 + 2.0 * ROOM), least)
    for n in range(pieces, SIZES):
        length = -(-size * n // (SIZES * step)) * step
        begin = max(0, (first + last + 1 - length) // 2 // step * step)
        begin = min(begin, (size - length) // step * step)
        if length >= wanted and begin >= 0 and begin <= first and last < begin + length <= size:
            return begin, begin + length
    return 0, size


def _quick(first: int, last: int, size: int) -> tuple[int, int]:
    """Begin and end of a stretch around first … last, on multiples of LANES, of a length of small factors."""
    wanted = last + 1 - first + 2 * (LANES - 1)
    length = LANES * int(fft.next_fast_len(-(-wanted // LANES), real=True))
    begin = max(min((first + last + 1 - length) // 2, size - length), 0) // LANES * LANES
    return begin, begin + length if begin + length <= size - LANES else size


class OnWindow:
    """Holds a solver on the grid of a window, its fields there, and the programs before and after it."""

    def __init__(self, whole: Executor, grid: Grid, **law: Any) -> None:
        device, threads = str(whole.device), whole.threads
        self._whole, self.executor = whole, Executor(grid, device=device, threads=threads, fields_needed=0.0)
        self.solver = HalfSpace(self.executor, **law)
        #: Gap, cap ratios and compliances of cells there, as far as there are such.
        self.fields: dict[str, Field] = {}
        #: Row and vector of the whole grid where it begins.
        self.first = wp.zeros(2, dtype=wp.int32, device=whole.device)
        self._programs: dict[Any, tuple[tuple[Any, ...], Program]] = {}

    def take(self, pressure: Field, fields: Mapping[str, Field]) -> None:
        """Copy what fields of the whole grid hold there."""
        if self.fields.keys() != fields.keys():
            self.fields = {name: self.executor.zeros() for name in fields}

        def add(program: Program) -> None:
            self.add_copy(program, passes.take_window, pressure, self.solver.pressure_field)
            for name, field in fields.items():
                self.add_copy(program, passes.take_window, field, self.fields[name])

        self.program(passes.take_window, add, pressure, *fields.values(), *self.fields.values()).run()

    def add_search(self, program: Program, search: Search) -> None:
        """Add to a program a search there."""
        with program.on(self.executor):
            search.add_to(program)

    def add_copy(self, program: Program, kernel: Any, field: Field, target: Field) -> None:
        """Add to a program: copy a field to one there, or the other way."""
        self.add(program, kernel, arguments(passes.Transfer, field=field, target=target, first=self.first))

    def add(self, program: Program, kernel: Any, about: Any) -> None:
        """Add to a program a pass over rows there."""
        slots = self.executor.slots_of(self.executor.grid.nx)
        program.launch(kernel, about, slots=slots, chunks=self.executor.equal_chunks(slots))

    def program(self, name: Any, add: Callable[[Program], None], *about: Any) -> Program:
        """Return a program of the whole grid's executor, which is said once about one thing."""
        last = self._programs.get(name)
        if last is None or len(last[0]) != len(about) or any(map(operator.is_not, last[0], about)):
            last = self._programs[name] = about, Program(self._whole)
            add(last[1])
        return last[1]


@dataclass(frozen=True)
class Stay:
    """Holds what solves contacts in one window, for programs. fields: of the whole grid, which go there."""

    here: OnWindow
    search: Search
    fields: dict[str, Field]
    box: tuple[int, int, int, int]
    extents: Field
    add_after: Callable[[Program], None]

    def add_to(self, program: Program, lap: Any, *flag: Any) -> None:
        """Add a contact: from a pressure of a `passes.Lap` where a flag says so, else from the last one."""
        for name, field in self.fields.items():
            self.here.add_copy(program, passes.take_window, field, self.here.fields[name])
        with program.branch(*flag):
            self.here.add(program, passes.take_lap, lap)
        self.here.add_search(program, self.search)
        self.add_after(program)


class WindowedHalfSpace:
    """Solves contacts of half-spaces on a large grid; each solve starts from the last one's pressure.

    modulus: E* of both bodies [MPa]. boundary: "periodic", whose window is the whole grid, "free", or "line",
    whose windows hold whole rows. hardness: H [MPa]. tolerance: as of `solver.BoundedPressure`.
    """

    STATE: ClassVar = {"_started": bool, "_window": Window, "_pressure": InFrame("contact", columns=True)}
    SCRATCH: ClassVar = ("_gradient", "_extents", "_mirror", "_here", "_stored", "_bodies")

    def __init__(
        self,
        executor: Executor,
        *,
        modulus: float,
        boundary: str,
        hardness: float = math.inf,
        tolerance: float = TOLERANCE,
    ) -> None:
        self._executor, self._boundary, self._hardness = executor, boundary, hardness
        grid = executor.grid
        #: Tolerance of contacts that are asked for no other.
        self.tolerance = tolerance
        self._law: dict[str, Any] = {"modulus": modulus, "boundary": boundary, "hardness": hardness}
        self._law["datum"] = grid.nx * grid.cell
        is_long = grid.nx >= LEAST_LONG * grid.ny
        self._has_windows = boundary == "free" or (boundary == "line" and is_long)
        self._pressure = executor.zeros()
        self._gradient = executor.zeros()
        device, slots = executor.device, executor.slots_of(executor.grid.nx)
        #: Of the cells below a level of the gap that was looked at last.
        self._extents = wp.zeros((4, slots), dtype=wp.float64, device=device)
        self._mirror = Mirror(self._extents)
        self._started = False  # whether there is a pressure to start from
        self._window: Window | None = None  # to look at first
        self._written: Window | None = None  # that the fields are of
        self._here: OnWindow | None = None  # of that window
        #: Of the last windows, by their grids.
        self._stored: dict[Grid, OnWindow] = {}
        #: Whether there is a body in a cell, the same in every solve; None before, and without a hardness.
        self._bodies: npt.NDArray[np.bool_] | None = None
        #: Cells with a body, of the window that was looked at last.
        self._bearing: dict[Window, int] = {}

    @property
    def start(self) -> Field | None:
        """Return the pressures that the next solve starts from; None where that is nothing."""
        return self._pressure if self._started else None

    @property
    def pressure(self) -> FloatArray:
        """Return a copy of the last pressure [MPa]."""
        return self._executor.to_numpy(self._pressure).copy()

    @property
    def fields(self) -> tuple[Field, Field]:
        """Return where pressure and gradient lie."""
        return self._pressure, self._gradient

    @property
    def columns(self) -> tuple[int, int]:
        """Return the first column that may have a pressure to start from, and the one after the last."""
        if self._window is None or not self._started:
            return 0, 0
        return self._window.first * LANES, self._window.end * LANES

    def restored(self) -> None:
        """Look first where another one did at that time."""
        self._written = None
        window, self._window = self._window, None
        if window is not None:
            self._look_at(window)

    def begin_like(self, other: Self) -> None:
        """Start the next solve from nothing, and look first where another one would."""
        self.forget()
        if other._window is not None:
            self._look_at(other._window)

    def forget(self) -> None:
        """Start the next solve from nothing."""
        self._started = False

    def solve(
        self,
        gap: Field,
        *,
        load: float,
        least_cap_ratio: float = 1.0,
        certified: bool | None = True,
        tolerance: float | None = None,
        **options: Any,
    ) -> HalfSpaceContact:
        """Solve the contact at a load [N], otherwise as `solver.BoundedPressure.solve` does.

        Fields are of the whole grid; the gradient is NaN beyond the window. least_cap_ratio: the smallest
        cap_ratio. Raises InputError for a load that not all cells at the least of their caps carry.
        """
        whole, least = self._executor.grid, least_cap_ratio * self._hardness
        own = {name: options.pop(name, None) for name in OWN}
        fields = {"gap": gap} | {name: field for name, field in own.items() if field is not None}
        options["certified"] = not self._started if certified is None else certified

        self._see_bodies(gap, least)
        # No more of a mean along x may reach beyond the window than it holds.
        has_streaks = "streak_yields" in fields
        along = whole.nx if has_streaks or options.get("streak_compliance") else 1
        rows = 2 * (options.get("streak_window") or along)
        has_windows = self._has_windows and not has_streaks  # which reach beyond them
        if not has_windows:
            self._look_at(self._everything)
        elif self._window is None:
            self._look_at(self._first(gap, load, rows, least))
        elif self._window.end_row - self._window.first_row < min(rows, whole.nx):
            self._look_at(self._around(self._window.box, rows=rows))
        transforms = iterations = 0
        while True:
            assert self._window is not None
            if not self._carries(self._window, load, least):
                self._look_at(self._that_carries(self._window.box, load, rows, least))
            window, here = self._window, self._here
            assert here is not None
            here.take(self._pressure, fields)
            self._clear_beside(window)
            here.solver.started = self._started
            here.solver.tolerance = self.tolerance if tolerance is None else tolerance
            mean = load / window.grid(whole).area
            contact, reached = None, window.box
            try:
                contact = here.solver.solve(
                    **here.fields, mean_pressure=mean, then=partial(self._after, here, gap), **options
                )
            except ConvergenceError:
                if window == self._everything:
                    raise
                options["certified"] = certified is not False  # of what is found from nothing
            self._started = contact is not None
            if contact is not None:
                transforms, iterations = transforms + contact.transforms, iterations + contact.iterations
                reached = self._reached()
                if not has_windows or window.holds(reached):
                    break
            # Too few cells give too large an approach: what lies below it holds the contact of them all. They
            # may give no contact either, where more do.
            del here, contact  # and their memory, before others take theirs
            self._look_at(self._around(reached, rows=rows))
        if has_windows:
            self._shrink(reached, load, rows, least)
        return replace(
            contact,
            mean_pressure=contact.mean_pressure * window.grid(whole).area / whole.area,
            transforms=transforms,
            iterations=iterations,
            pressure_field=self._pressure,
            gradient_field=self._gradient,
            executor=self._executor,
        )

    def _after(self, here: OnWindow, gap: Field, search: Search) -> Program:
        """Return what follows a search."""
        return here.program(passes.extents, partial(self._add_after, here, gap, search), gap, search)

    def _add_after(self, here: OnWindow, gap: Field, search: Search, program: Program) -> None:
        """Add what follows a search: its fields on the whole grid, and the extents of the cells reached.

        Beyond the window no cell may count in the certificate either.
        """
        fields = {"gap": gap, "columns": self._executor.grid.ny, "extents": self._extents}
        here.add_copy(program, passes.give_window, here.solver.pressure_field, self._pressure)
        here.add_copy(program, passes.give_window, search.arguments.fields.gradient, self._gradient)
        program.launch(passes.extents, arguments(passes.ContactReach, **fields, **search.reached))

    def stay(
        self, gap: Field, heights: Field, *, load: float, rows: int, least: float, anew: bool, **own: Any
    ) -> "Stay | None":
        """Make ready for contacts in the present window that a program solves, one after another.

        heights: of a body. rows: of a mean along x. least: as least_cap_ratio of `solve`. anew: whether one
        starts from nothing. own: cap_ratio and yields. None where such contacts must be solved by `solve`.
        """
        least *= self._hardness
        self._see_bodies(heights, least)
        window, here = self._window, self._here
        if window is None or here is None or not self._carries(window, load, least):
            return None
        if window.end_row - window.first_row < min(2 * rows, self._executor.grid.nx):
            return None
        if (anew or not self._started) and wide_cells_pay(here.executor):
            return None
        fields = {"gap": gap} | {name: field for name, field in own.items() if field is not None}
        here.take(self._pressure, fields)
        self._clear_beside(window)
        here.solver.started = self._started
        there = {name: here.fields.get(name) for name in OWN}
        search = here.solver.search_for(here.fields["gap"], there, groups=False)
        area = self._executor.grid.cell_area
        search.bear(min(load / area, self._hardness * here.executor.grid.cells))
        return Stay(
            here, search, fields, window.box, self._extents, partial(self._add_after, here, gap, search)
        )

    def end_stay(self, *, load: float, rows: int, least: float, whole: bool) -> None:
        """Take note that a program has solved contacts here. whole: whether it has made all."""
        self._started = True
        if whole and self._has_windows:
            self._shrink(self._reached(), load, 2 * rows, least * self._hardness)

    def outgrows(self, *, rows: int) -> bool:
        """Tell whether the contact found last reaches beyond the window; look at a larger one then.

        rows: of a mean along x.
        """
        reached = self._reached()
        if not self._has_windows or self._window is None or self._window.holds(reached):
            return False
        self._started = True
        self._look_at(self._around(reached, rows=2 * rows))
        return True

    def _reached(self) -> tuple[int, int, int, int]:
        """Return the extents of the cells that the last contact reaches."""
        first_row, last_row, first, last = self._mirror.read()[0].max(axis=1).tolist()
        return round(-first_row), round(last_row), round(-first), round(last)

    def _shrink(self, reached: Sequence[int], load: float, rows: int, hardness: float) -> None:
        """Look at a smaller window where it holds what was reached, and carries the load."""
        assert self._window is not None
        length, width = reached[1] + 1 - reached[0], reached[3] + 1 - reached[2]
        if max(length, rows) * width * (1.0 + 2.0 * ROOM) ** 2 > SMALLER * LANES * self._window.area:
            return  # nor is a window around it smaller
        fitting = self._around(reached, rows=rows)
        if fitting.area <= SMALLER * self._window.area and self._carries(fitting, load, hardness):
            self._look_at(fitting)

    def _see_bodies(self, field: Field, hardness: float) -> None:
        """See once in which cells a gap, or a body, has a surface."""
        if self._bodies is None and math.isfinite(hardness):
            self._bodies = self._executor.to_numpy(field) < PADDING

    def _carries(self, window: Window, load: float, hardness: float) -> bool:
        """Tell whether cells at the least of their caps carry the load: none falls below it later."""
        return self._most(window, hardness) * (1.0 + LOAD_TOLERANCE) >= load

    def _clear_beside(self, window: Window) -> None:
        """Leave no pressure, and no gradient, of the last window where that was another."""
        if window != self._written:
            self._written = window
            self._pressure.zero_()
            self._gradient.fill_(Cells(math.nan))

    def _look_at(self, window: Window) -> None:
        """Solve there from now on."""
        grid = window.grid(self._executor.grid)
        if self._window is None or grid != self._window.grid(self._executor.grid):
            self._here = self._stored.pop(grid, None)
            cells = np.cumsum([grid.cells, *(at.cells for at in reversed(self._stored))])
            fits = min(max(int(np.count_nonzero(cells <= MOST_CELLS_STORED)), 1), MOST_STORED)
            self._stored = dict([*self._stored.items()][len(cells) - fits :])
            self._here = self._stored[grid] = self._here or OnWindow(self._executor, grid, **self._law)
        self._window = window
        assert self._here is not None
        self._executor.put(self._here.first, [window.first_row, window.first])

    def _around(self, box: Sequence[int], **least: int) -> Window:
        """Return a window that holds a box, over whole rows where these repeat; least: of `Window.around`."""
        grid = self._executor.grid
        if self._boundary == "line":
            box = (*box[:2], 0, grid.ny - 1)
        return Window.around(box, grid, **least)

    @property
    def _everything(self) -> Window:
        """Return the window that is the whole grid."""
        grid = self._executor.grid
        return Window.around((0, grid.nx - 1, 0, grid.ny - 1), grid)

    def _first(self, gap: Field, load: float, rows: int, hardness: float) -> Window:
        """Return a window around the lowest cell, of a size that carries the load at a hardness [MPa]."""
        row, column = divmod(int(np.argmin(self._executor.to_numpy(gap))), self._executor.grid.ny)
        return self._that_carries((row, row, column, column), load, rows, hardness)

    def _that_carries(self, box: Sequence[int], load: float, rows: int, hardness: float) -> Window:
        """Return a window around a box, of a size that carries the load at a hardness [MPa].

        Raises InputError for a load that the whole grid does not carry.
        """
        for pieces in range(1, SIZES if self._has_windows else 1):
            window = self._around(box, rows=rows, pieces=pieces)
            if self._most(window, hardness) >= CAPACITY * load:
                return window
        most = self._most(self._everything, hardness)
        if most * (1.0 + LOAD_TOLERANCE) < load:
            raise InputError(
                f"a load of {load:.6g} N is not possible: all cells where there is a body carry {most:.6g} N "
                f"at the hardness, {hardness:g} MPa."
            )
        return self._everything

    def _most(self, window: Window, hardness: float) -> float:
        """Return the load [N] that the cells with a body in a window carry at a hardness [MPa]."""
        if self._bodies is None:
            return math.inf
        if window not in self._bearing:
            self._bearing = {window: int(np.count_nonzero(self._bodies[window.cells]))}
        return hardness * self._bearing[window] * self._executor.grid.cell_area
