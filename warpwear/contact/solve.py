"""The contact of a rigid plane or sphere with heights in an array, without a study.

Numbers are in consistent units of the caller's choice. Every solver below works on cells of width 1 that a
unit of pressure displaces by a unit of length, so that none of its thresholds is a length or a pressure of
the caller's: see `_Task`.
"""

import math
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt
import warp as wp

from warpwear.contact.balance import RIGID, Balancer, Foundation
from warpwear.contact.bearing_area import TIE, BearingArea
from warpwear.contact.certificate import Certificate, cells_of, certify
from warpwear.contact.half_space import ROUNDING as OF_DIGITS
from warpwear.contact.half_space import TOLERANCE, HalfSpace
from warpwear.contact.half_space_window import WindowedHalfSpace
from warpwear.contact.influence import Influence
from warpwear.contact.transforms import release
from warpwear.engine.device import check_threads, find_device, free_memory
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.staging import download, each, upload
from warpwear.engine.tiles import Tiles
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import LANES, PADDING
from warpwear.kernels.contact import Law
from warpwear.surfaces.sphere import sag

#: Fields alive at the peak of a solve: measured were 11 (springs) to 18 (free boundary), without a GPU's.
FIELDS_NEEDED = 24.0
#: Beside a GPU, and on it, by the boundary of the half-space; measured likewise.
FIELDS_BESIDE_GPU: dict[str | None, float] = {None: 12.0, "periodic": 10.0, "free": 17.0}
FIELDS_ON_GPU: dict[str | None, float] = {None: 12.0, "periodic": 15.5, "free": 62.0}
#: Memory from which a solve says on standard error what it needs before it starts [B].
SAID = 2.0 * 2**30
#: Cells from which a solve begins and ends with nothing kept on a GPU.
LARGE = 2**22
#: Relative rounding of a load: it may exceed as much what the hardness carries.
ROUNDING = 1.0e-12
#: Largest difference between the load carried and the load asked for, relatively.
LOAD_TOLERANCE = 1.0e-9
#: What transforms on all cells instead of those in reach may change of a violation, relatively.
SLACK = 1.0e-9
#: Cells that the lists of tiles hold at least, over those that carry the load at the hardness.
SPARE = 2.0


@dataclass(frozen=True, eq=False)
class ArrayContact:
    """A solved contact of an array of heights. Units are the caller's; fields have the shape of the heights.

    approach: how far the plane, or the sphere's apex, lies below the heights' mean plane; negative while it
    lies above. gap: distance between the bodies after elastic deformation; 0 under a pressure below the
    hardness, negative where the hardness is reached (how deep the material has to flow), infinite beyond the
    sphere's edge. residual: the largest violation of (gap = 0 under pressure, gap ≥ 0 elsewhere, gap ≤ 0 at
    the hardness) over the rms height of the gap before contact. certificate: that and more, reckoned anew
    from the pressure: by how much its energy can exceed the least, above all. evaluations: pairs of Fourier
    transforms on a half-space, else passes over the cells that a trial approach took.
    """

    pressure: FloatArray  # pressure, shape (nx, ny)
    gap: FloatArray  # length, shape (nx, ny)
    approach: float  # length
    cell: float  # length
    hardness: float | None  # pressure
    certificate: Certificate
    evaluations: int

    @property
    def residual(self) -> float:
        """Largest violation of the contact conditions over the rms height of the gap before contact."""
        return self.certificate.violation

    @cached_property
    def load(self) -> float:
        """Sum of the pressures, each times the area of a cell: a force."""
        return float(self.pressure.sum()) * self.cell**2

    @property
    def mean_pressure(self) -> float:
        """Load over the nominal area."""
        return self.load / self.nominal_area

    @property
    def nominal_area(self) -> float:
        """Area of all cells of the array: a length²."""
        return self.pressure.size * self.cell**2

    @cached_property
    def area(self) -> float:
        """Real area of contact, of the cells that carry a pressure: a length²."""
        return np.count_nonzero(self.pressure) * self.cell**2

    @cached_property
    def area_at_hardness(self) -> float:
        """Area of the cells whose pressure is the hardness: a length²; 0 without a hardness.

        Of a bearing area it may be a cell short of `area`: one cell carries what is left of the load.
        """
        if self.hardness is None:
            return 0.0
        return np.count_nonzero(self.pressure >= self.hardness) * self.cell**2

    def __repr__(self) -> str:
        return (
            f"<contact: area {self.area:.4g} of {self.nominal_area:.4g}, "
            f"mean pressure {self.mean_pressure:.4g}, approach {self.approach:.4g}, "
            f"{self.evaluations} evaluations>"
        )


def solve_contact(
    heights: npt.ArrayLike,
    *,
    cell: float,
    load: float | None = None,
    mean_pressure: float | None = None,
    approach: float | None = None,
    hardness: float | None = None,
    modulus: float | None = None,
    stiffness: float | None = None,
    boundary: str | None = None,
    sphere_radius: float | None = None,
    tolerance: float = TOLERANCE,
    device: str = "cpu",
    threads: int | None = None,
) -> ArrayContact:
    """Press a rigid plane, or a sphere, on heights and return the pressure and the gap of every cell.

    All numbers are in consistent units of the caller's choice (mm, N and MPa, say, or m, N and Pa).

    heights: of the surface, positive out of the material, shape (nx, ny), axis 0 = x; of any mean plane.
    cell: width of the square cells. load, mean_pressure, approach: one of the three; a mean pressure is the
    load over the area of the array. hardness: largest pressure of a cell; None for no such limit.
    modulus: E*, of an elastic half-space (two elastic bodies have 1/E* = Σ (1 − ν²)/E). stiffness: instead of
    it, pressure over length, of independent springs under the cells (a Winkler foundation). Without both
    every cell that is touched carries the hardness: the bearing area.
    boundary: of the half-space; "periodic", where the surface repeats without end (by default under a
    plane), or "free", where nothing lies beside the array (by default, and always, under a sphere).
    sphere_radius: of the sphere, whose apex comes down on the middle of the array; None for a plane.
    tolerance: largest violation of the contact conditions of the half-space over the rms height of the gap;
    one that rounding hides is raised to what it shows, `certificate.allowed`. The other laws are solved to
    rounding. device: "cpu" or "cuda:0". threads: of the CPU, by default every
    core; no result depends on it.

    Says on standard error what memory is needed where that is 2 GiB or more, before it starts.
    Warns where the contact with a sphere reaches the edge of the array. Raises InputError for what is not
    possible, ConvergenceError where the tolerance is not met, MemoryError where memory runs out. Sources:
    Polonsky and Keer 1999, Wear 231, 206 and Almqvist et al. 2007, Tribol. Int. 40, 574 (half-space);
    Johnson, Contact Mechanics, 1985, section 4.3 (springs).

    >>> heights = np.random.default_rng(0).normal(size=(64, 64))
    >>> contact = warpwear.solve_contact(heights, cell=1.0, mean_pressure=0.25, hardness=1.0)
    >>> print(contact.area / contact.nominal_area, contact.mean_pressure)
    0.25 0.25
    >>> warpwear.solve_contact(heights, cell=1.0, mean_pressure=0.01, modulus=1.0).residual < 1.0e-6
    True
    """
    workers = check_threads(threads)
    surface, lowest, highest, total = _checked_heights(heights, workers)
    cell = _number("cell", cell, optional=False)
    tolerance = _number("tolerance", tolerance, optional=False)
    load, mean_pressure = _number("load", load), _number("mean_pressure", mean_pressure)
    approach = _number("approach", approach, any_sign=True)
    modulus, stiffness = _number("modulus", modulus), _number("stiffness", stiffness)
    hardness, sphere_radius = _number("hardness", hardness), _number("sphere_radius", sphere_radius)
    _check_choice("exactly one", load=load, mean_pressure=mean_pressure, approach=approach)
    _check_choice("at most one", modulus=modulus, stiffness=stiffness)
    if hardness is modulus is stiffness is None:
        raise InputError(
            "hardness = None is not possible without modulus or stiffness; the bearing area needs a hardness."
        )
    edge = _boundary_of(boundary, modulus, sphere_radius)
    nx, ny = surface.shape
    grid = Grid(nx, ny, cell)
    middle = total / surface.size
    nearest, furthest, there = middle - highest, middle - lowest, surface.size
    given = _Gap(surface, middle, grid, sphere_radius)
    if sphere_radius is not None:
        extents = each(lambda rows: _extent(given(rows)), surface.shape, workers)
        nearest, furthest = min(one[0] for one in extents), max(one[1] for one in extents)
        there = sum(one[2] for one in extents)
        if not there:
            raise InputError(
                f"sphere_radius = {sphere_radius:g} is not possible; it must reach the middle of a cell."
            )
    mean = mean_pressure if load is None else load / grid.area
    if mean is not None and hardness is not None:
        most = hardness * (there / surface.size)
        if mean > most * (1.0 + ROUNDING):
            name, area = ("mean_pressure", 1.0) if load is None else ("load", grid.area)
            raise InputError(
                f"{name} = {mean * area:g} is not possible; with all cells at the hardness it is "
                f"{most * area:g}."
            )
        mean = min(mean, most)  # larger by rounding
    if approach is not None and approach >= 0.0 and edge == "periodic" and hardness is None:
        raise InputError(
            f"approach = {approach:g} is not possible; a periodic half-space without a hardness is in full "
            "contact when the plane reaches the mean plane, so it must be negative."
        )
    response = cell / modulus if modulus else 1.0 / stiffness if stiffness else 0.0
    task = _Task.scaled(
        given, (nearest, furthest), mean, approach, hardness, response=response, edge=edge, threads=workers
    )
    _check_memory(surface.shape, device, edge)
    with Executor(Grid(nx, ny, 1.0), device=device, threads=threads) as executor, _giving_back(executor):
        try:
            found = _solve_half_space(task, executor, tolerance) if edge else _solve_cells(task, executor)
            contact, carried = _contact_of(
                task, found, executor, cell=cell, hardness=hardness, tolerance=tolerance
            )
            del found
        except ConvergenceError as error:
            raise ConvergenceError(
                f"solve_contact failed: with {task.length:.6g} for a mm and {task.pressure:.6g} for a MPa, "
                f"{error}"
            ) from error
    if sphere_radius is not None and _touches_edge(contact.pressure):
        warnings.warn(
            f"the contact with the sphere reaches the edge of heights, of the shape {(nx, ny)}, beyond "
            "which nothing carries; a larger array is needed for the whole contact.",
            stacklevel=2,
        )
    if mean is not None and not abs(carried / contact.pressure.size / mean - 1.0) <= LOAD_TOLERANCE:
        raise ConvergenceError(
            f"solve_contact found a mean pressure of {contact.mean_pressure:g} instead of {mean:g}."
        )
    return contact


@contextmanager
def _giving_back(executor: Executor) -> Iterator[None]:
    """Leave nothing of a large solve on a GPU, of one that failed neither."""
    try:
        yield
    finally:
        if executor.grid.cells >= LARGE:
            release(executor.device)


class _Gap(NamedTuple):
    """The gap before contact in the caller's units, from the heights' mean plane, block by block of rows."""

    heights: FloatArray
    middle: float  # of the mean plane
    grid: Grid
    sphere_radius: float | None

    def __call__(self, rows: slice) -> FloatArray:
        """The gap in some rows, infinite beyond the sphere's edge."""
        gap = self.middle - self.heights[rows]
        if self.sphere_radius is not None:
            gap += sag(self.grid.x[rows], self.grid.y, radius=self.sphere_radius)
        return gap


@dataclass(frozen=True)
class _Task:
    """A contact in units in which its cells are 1 wide and a unit of pressure displaces by a unit of length.

    length: the caller's lengths over those here, of the order of what heights and displacements span.
    pressure: the caller's pressures over those here, so that E* or the stiffness is 1 here, or the hardness
    where there is neither.
    """

    given: _Gap
    mean: float | None  # pressure; None at an approach
    approach: float | None
    cap: float
    response: float  # displacement under a unit of pressure: 1, or 0 for the bearing area
    edge: str | None  # boundary of the half-space; None: the cells do not feel each other
    length: float
    pressure: float
    threads: int

    @classmethod
    def scaled(
        cls,
        given: _Gap,
        extent: tuple[float, float],
        mean: float | None,
        approach: float | None,
        hardness: float | None,
        *,
        response: float,
        edge: str | None,
        threads: int,
    ) -> Self:
        """Scale what is in the caller's units.

        extent: smallest and largest gap. response: displacement under a unit of pressure.
        """
        # Heights may be next to nothing beside the displacements, or all the same.
        pushed = max(0.0, (mean or 0.0) * response if approach is None else approach - extent[0])
        length = max(extent[1] - extent[0], pushed) or 1.0
        pressure = length / response if response else hardness
        assert pressure is not None
        return cls(
            given,
            None if mean is None else mean / pressure,
            None if approach is None else approach / length,
            math.inf if hardness is None else hardness / pressure,
            float(response > 0.0),
            edge,
            length,
            pressure,
            threads,
        )

    @property
    def shape(self) -> tuple[int, int]:
        """The cells of all fields along both axes."""
        return self.given.grid.shape

    def gap_of(self, rows: slice) -> FloatArray:
        """The gap in some rows, infinite beyond the sphere's edge."""
        gap = self.given(rows)
        return np.divide(gap, self.length, out=gap)

    @cached_property
    def gap(self) -> FloatArray:
        """The gap of all cells, shape (nx, ny)."""
        made = np.empty(self.shape)

        def fill(rows: slice) -> None:
            made[rows] = self.gap_of(rows)

        each(fill, self.shape, self.threads)
        return made


class _Found(NamedTuple):
    """A solved task, in its units. Its fields are arrays of NumPy, or of Warp on a GPU."""

    pressure: Any
    displacement: Any
    approach: float
    evaluations: int
    allowed: float = 0.0  # violation that its solver allowed itself
    certificate: Certificate | None = None  # of all cells, where its solver has made one


def _solve_half_space(task: _Task, executor: Executor, tolerance: float) -> _Found:
    """Solve on the cells that the other body can reach, then displace all of them."""
    assert task.edge is not None
    options: dict[str, Any] = {"modulus": 1.0, "boundary": task.edge, "hardness": task.cap}
    options["tolerance"] = tolerance
    if task.mean is not None and task.edge == "periodic":
        solver, here = HalfSpace(executor, **options), executor.device.is_cpu
        gap = _field(task.gap, executor) if here else upload(executor, task.gap_of, padding=PADDING)
        found = solver.solve(gap, mean_pressure=task.mean)
        return _Found(
            found.pressure if here else found.pressure_field,
            executor.to_numpy(solver.displacement()) if here else solver.displacement(),
            found.approach,
            found.transforms + 1,
            certificate=found.certificate,
        )
    pressure, approach, transforms, allowed = np.zeros(task.gap.shape), task.approach, 0, 0.0
    if task.mean is not None:
        field = _field(task.gap, executor)
        found = WindowedHalfSpace(executor, **options).solve(field, load=task.mean * task.gap.size)
        pressure[:], approach = found.pressure, found.approach
        transforms, allowed = found.transforms, found.allowed.item()
        del found, field  # before there are more
        wp.synchronize_device(executor.device)  # which gives their memory back
    assert approach is not None
    reached = task.gap < approach
    if task.mean is None and reached.any():
        window = (slice(None), slice(None)) if task.edge == "periodic" else _box(reached)
        part = task.gap[window]
        with Executor(
            Grid(part.shape[0], part.shape[1], 1.0), device=str(executor.device), threads=executor.threads
        ) as smaller:
            found = HalfSpace(smaller, **options).solve(_field(part, smaller), approach=approach)
            pressure[window], transforms, allowed = found.pressure, found.transforms, found.allowed.item()
    field = executor.zeros()
    Influence(executor, modulus=1.0, boundary=task.edge).respond(executor.field(pressure), field)
    return _Found(
        pressure, executor.to_numpy(field).copy(), approach, transforms + 1, (1.0 + SLACK) * allowed
    )


def _touches_edge(pressure: FloatArray) -> bool:
    """Whether a cell at the rim of the array carries a pressure."""
    return bool(pressure[[0, -1]].any() or pressure[:, [0, -1]].any())


def _box(cells: npt.NDArray[np.bool_]) -> tuple[slice, slice]:
    """The rows and the columns that hold all the cells."""
    rows, columns = (np.flatnonzero(cells.any(axis=axis)) for axis in (1, 0))
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


def _solve_cells(task: _Task, executor: Executor) -> _Found:
    """Solve with springs, or the bearing area: to rounding."""
    gap, stiffest = _field(task.gap, executor), 1.0 if task.response else RIGID
    stiffness = executor.field(np.full((1, 1), stiffest), padding=stiffest)
    load = (task.mean or 0.0) * task.gap.size
    tiles = Tiles(executor, gap, gap, least=SPARE * load / task.cap)
    law, evaluations, balancer = arguments(Law, offset=0.0), 1, Balancer(executor)
    law.base, law.cap, law.tie_pressure = float(task.approach or 0.0), task.cap, task.cap
    # Where nothing yields a cell at the very approach is touched.
    law.tie_width = 0.0 if task.response else TIE
    if task.approach is None:
        if task.response:
            found = balancer.solve(Foundation(gap, stiffness, tiles, load, task.cap))
        else:
            # No number of cells but the very one: else their pressure would exceed the hardness.
            bearing = BearingArea(executor)
            found = bearing.solve(
                gap,
                tiles,
                highest=bearing.bounds(gap, tiles)[1],
                load=load,
                hardness=task.cap,
                tolerance=ROUNDING * load,
            )
        found.fill(law)
        law.cap, evaluations = task.cap, found.evaluations
    if not law.tie_width:
        law.tie_pressure = 0.0
    pressure = balancer.pressures(law, stiffness, gap, tiles).copy()
    approach = law.base + law.offset
    if task.approach is None and not task.response:  # the lowest of those that touch these cells
        approach = float(task.gap[pressure > 0.0].max())
    return _Found(pressure, pressure * task.response, approach, evaluations)


def _contact_of(
    task: _Task,
    found: _Found,
    executor: Executor,
    *,
    cell: float,
    hardness: float | None,
    tolerance: float,
) -> tuple[ArrayContact, float]:
    """A solved task in the caller's units, certified, and the sum of its pressures. May raise."""
    certificate = found.certificate or _certify(task, found, tolerance)
    if certificate.fault:
        raise ConvergenceError(f"the pressure cannot be certified: {certificate.fault}.")
    here = isinstance(found.pressure, np.ndarray)
    pressure = np.empty(task.shape)
    left = task.gap if here else np.empty(task.shape)

    def take(rows: slice, p: FloatArray, displaced: FloatArray) -> float:
        gap = left[rows] if here else task.gap_of(rows)
        np.add(gap, displaced, out=left[rows])
        left[rows] -= found.approach
        left[rows] *= task.length
        np.multiply(p, task.pressure, out=pressure[rows])
        if hardness is not None:
            np.minimum(pressure[rows], hardness, out=pressure[rows])
            pressure[rows][p >= task.cap] = hardness
        return float(pressure[rows].sum())

    if here:
        sums = each(
            lambda rows: take(rows, found.pressure[rows], found.displacement[rows]), task.shape, task.threads
        )
    else:
        pitches = [executor.vectors * LANES, task.shape[1]]
        sums = download(executor, [found.pressure, found.displacement], take, pitches)
    contact = ArrayContact(
        pressure=pressure,
        gap=left,
        approach=found.approach * task.length,
        cell=cell,
        hardness=hardness,
        certificate=certificate.scaled(length=task.length, pressure=task.pressure, area=cell**2),
        evaluations=found.evaluations,
    )
    return contact, sum(sums)


def _certify(task: _Task, found: _Found, tolerance: float) -> Certificate:
    there = _there(task.gap)
    yielded = abs(found.approach) + float(found.pressure.mean())
    # Of a flat, over what it yields.
    scale = float(there.std()) if np.ptp(there) else yielded
    asked = None if task.mean is None else np.full(1, task.mean * task.gap.size)
    return certify(
        [cells_of(found.pressure, task.gap, found.displacement, task.cap)],
        approaches=np.full(1, found.approach),
        asked=asked,
        scale=np.full(1, scale),
        allowed=np.full(1, max(tolerance * scale, OF_DIGITS * yielded, found.allowed)),
        cell_area=1.0,
    )


def _there(gap: FloatArray) -> FloatArray:
    """The gap where there is a surface; the array itself where there is one everywhere."""
    return gap if math.isfinite(gap.max()) else gap[np.isfinite(gap)]


def _field(gap: FloatArray, executor: Executor) -> Field:
    """A field of a gap, with no surface beyond the sphere's edge and in the padding."""
    values = gap if math.isfinite(gap.max()) else np.minimum(gap, PADDING)
    return executor.field(values, padding=PADDING)


def _extent(gap: FloatArray) -> tuple[float, float, int]:
    """Smallest and largest gap where there is a surface, and how many cells those are."""
    there = _there(gap)
    return (float(there.min()), float(there.max()), there.size) if there.size else (math.inf, -math.inf, 0)


def _checked_heights(heights: npt.ArrayLike, threads: int) -> tuple[FloatArray, float, float, float]:
    """The heights as an array; the lowest, the highest and the sum of them."""
    try:
        given = np.asanyarray(heights)
        if np.ma.is_masked(given) or np.iscomplexobj(given):
            raise TypeError("masked or complex")
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"heights of type {type(heights).__name__} are not possible ({error}); "
            "they must be real numbers, none of them masked."
        ) from error
    if values.ndim != 2 or values.size == 0:
        raise InputError(
            f"heights of shape {values.shape} are not possible; they must be (nx, ny), with a cell or more."
        )
    looks = each(lambda rows: [f(values[rows]) for f in (np.min, np.max, np.sum)], values.shape, threads)
    lows, highs, sums = np.array(looks).T
    if not (math.isfinite(lows.min()) and math.isfinite(highs.max())):
        wrong = np.argwhere(~np.isfinite(values))
        i, j = wrong[0].tolist()
        raise InputError(
            f"heights[{i}, {j}] = {values[i, j]:g} is not possible ({len(wrong)} of {values.size} are not "
            "finite); fill what is missing first."
        )
    return values, float(lows.min()), float(highs.max()), float(sums.sum())


def _number(name: str, value: Any, *, any_sign: bool = False, optional: bool = True) -> Any:
    """An argument as a float, None where it is left out. Raises InputError for what is not allowed."""
    if value is None and optional:
        return None
    is_number = isinstance(value, Real) and not isinstance(value, bool | np.bool_)
    if not is_number or not math.isfinite(value) or not (any_sign or value > 0.0):
        shown = f"{float(value):g}" if is_number else repr(value)
        allowed = f"{'' if any_sign else 'positive, '}finite number{', or left out' if optional else ''}"
        raise InputError(f"{name} = {shown} is not possible; it must be a {allowed}.")
    return float(value)


def _check_choice(how_many: str, **choice: float | None) -> None:
    """InputError where more are given than may be, or none where one must be."""
    given = [f"{name} = {value:g}" for name, value in choice.items() if value is not None]
    if len(given) > 1 or (how_many == "exactly one" and not given):
        names = " and ".join([", ".join(list(choice)[:-1]), list(choice)[-1]])
        raise InputError(f"{' and '.join(given) or 'nothing'} is given; {how_many} of {names} must be.")


def _boundary_of(boundary: str | None, modulus: float | None, sphere_radius: float | None) -> str | None:
    """The boundary of the half-space; None where there is no half-space."""
    if modulus is None:
        if boundary is not None:
            raise InputError(
                f"boundary = {boundary!r} is only for a half-space; leave it out, or give a modulus."
            )
        return None
    if boundary not in (None, "periodic", "free"):
        raise InputError(f'boundary = {boundary!r} is unknown; allowed are "periodic" and "free".')
    if sphere_radius is None:
        return boundary or "periodic"
    if boundary == "periodic":
        raise InputError(
            f'boundary = "periodic" is not possible with sphere_radius = {sphere_radius:g}; '
            'it must be "free".'
        )
    return "free"


def _check_memory(shape: tuple[int, ...], device: str, edge: str | None) -> None:
    if math.prod(shape) >= LARGE:
        release(find_device(device))  # what is kept of earlier solves counts as free
    host, *gpu = free_memory(device).items()
    fields = [FIELDS_BESIDE_GPU[edge] if gpu else FIELDS_NEEDED, *(FIELDS_ON_GPU[edge] for _ in gpu)]
    plan = []
    for (place, there), count in zip([host, *gpu], fields, strict=True):
        needed = count * 8.0 * math.prod(shape)
        if needed > there:
            raise InputError(
                f"heights of shape {shape} need {needed / 2**30:.1f} GiB of memory; {place} has "
                f"{there / 2**30:.1f} GiB free."
            )
        plan.append(f"{needed / 2**30:.1f} GiB of {place} ({there / 2**30:.1f} GiB free)")
    if max(fields) * 8.0 * math.prod(shape) >= SAID:
        print(
            f"solve_contact: {shape[0]} × {shape[1]} cells need up to {' and '.join(plan)}", file=sys.stderr
        )
