"""Solve the contact of a rigid plane or counter-body with heights in an array, without a study.

Numbers are in consistent units of the caller's choice; the solvers work in units of their own, see `Task`.
"""

import math
import warnings
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from warpwear.contact.array.arguments import (
    boundary_of,
    check_choice,
    checked_heights,
    counter_of,
    map_of,
    number,
    tolerance_of,
)
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.elastic import solve_half_space
from warpwear.contact.array.memory import check_memory, giving_back
from warpwear.contact.array.task import ROUNDING, Gap, Solution, Task, surface_of
from warpwear.contact.array.workplace import Workplace, workplace
from warpwear.contact.balance import RIGID, Balance
from warpwear.contact.certificate import Certificate, Certifier
from warpwear.contact.half_space.search import NO_CAP
from warpwear.contact.half_space.solver import TOLERANCE
from warpwear.contact.search import LoadSearch
from warpwear.engine.device import check_threads
from warpwear.engine.executor import arguments
from warpwear.engine.staging import download, each
from warpwear.engine.tiles import Tiles
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.bearing import TIE
from warpwear.kernels.cells import LANES, Cells
from warpwear.kernels.half_space.certificate import ALONE
from warpwear.kernels.half_space.solve import Fields, SearchRules
from warpwear.laws.form import Form

#: Largest difference between the load carried and the load asked for, relatively.
LOAD_TOLERANCE = 1.0e-9
#: Cells that the lists of tiles hold at least, over those that carry the load at the hardness.
SPARE = 2.0
#: Cells in contact of which fewer resolve no area.
FEWEST_CELLS = 9


def solve_contact(
    heights: npt.ArrayLike | Any,
    *,
    cell: float | None = None,
    load: float | None = None,
    mean_pressure: float | None = None,
    approach: float | None = None,
    hardness: float | None = None,
    modulus: float | None = None,
    stiffness: float | None = None,
    boundary: str | None = None,
    counter_radius: float | None = None,
    counter: Mapping[str, Any] | npt.ArrayLike | None = None,
    tolerance: float = TOLERANCE,
    device: str = "cpu",
    threads: int | None = None,
) -> ArrayContact:
    """Press a rigid plane, or a counter-body, on heights and return the pressure and the gap of every cell.

    All numbers are in consistent units of the caller's choice (mm, N and MPa, say, or m, N and Pa). What
    memory is needed is said on standard error where that is 2 GiB or more, before it starts. A warning tells
    where the contact with a counter-body reaches the edge of the array, and where it is of fewer than nine
    cells.

    Parameters
    ----------
    heights : array or MeasuredSurface
        Heights of the surface, positive out of the material, shape (nx, ny), axis 0 = x; a constant offset
        does not matter. A measured surface [mm] has square pixels; of another take arrays of its
        ``.surface.heights(x, y)``.
    cell : float
        Width of the square cells; of a measured surface its pixel.
    load, mean_pressure, approach : float, optional
        One of the three; a mean pressure is the load over the nominal area, that of the array.
    hardness : float, optional
        Largest pressure of a cell; None, or infinite, for no such limit.
    modulus : float, optional
        E*, of an elastic half-space; of two elastic bodies `effective_modulus`.
    stiffness : float, optional
        Instead of it pressure over length, of independent springs under the cells (a Winkler foundation).
        Without both every cell that is touched carries the hardness: the bearing area.
    boundary : {"periodic", "free", "line"}, optional
        Of the half-space. "periodic", where the surface repeats without end (by default under a plane):
        opposite edges of a measured map then meet in a seam, whose steps count as roughness; "free", where
        nothing lies beside the array (by default under a counter-body); or "line", where it repeats along
        axis 1 and nothing lies beyond the ends of axis 0: a line contact, plane strain where ny is 1. Its
        approach has no absolute zero: a line of pressure displaces nothing at the distance of the array's
        length, nx × cell.
    counter_radius : float, optional
        Of a ball, whose apex comes down on the middle of the array; None for a plane.
    counter : dict or array, optional
        Another body instead, by the keys of a study's [counter], ``{"shape": "pin", "radius": 0.3,
        "edge_radius": 0.1}``; or how high each cell of it lies over the surface's, an array of the shape of
        heights that counts from its lowest.
    tolerance : float
        Largest violation of the contact conditions of the half-space over the rms height of the gap, from
        1e-14 to 0.01; a tolerance below rounding is raised to rounding, see ``certificate.allowed``. The
        other laws are solved to rounding.
    device : str
        ``"cpu"`` or ``"cuda:0"``.
    threads : int, optional
        Of the CPU, by default every core; no result depends on it.

    Returns
    -------
    ArrayContact
        Pressure, gap, areas, and a certificate of what they are worth.

    Raises
    ------
    InputError
        For heights that are not finite, a load beyond what the hardness carries, a number out of its range,
        or arguments that exclude each other.
    ConvergenceError
        Where the tolerance is not met.
    MemoryError
        Where memory runs out.

    References
    ----------
    I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206, and A. Almqvist and others, Tribology International 40
    (2007) 574 (half-space). K. L. Johnson, Contact Mechanics, 1985, section 4.3 (springs).

    Examples
    --------
    >>> heights = np.random.default_rng(0).normal(size=(64, 64))
    >>> contact = warpwear.solve_contact(heights, cell=1.0, mean_pressure=0.25, hardness=1.0)
    >>> print(contact.area / contact.nominal_area, contact.mean_pressure)
    0.25 0.25
    >>> warpwear.solve_contact(heights, cell=1.0, mean_pressure=0.01, modulus=1.0).residual < 1.0e-6
    True
    """
    workers = check_threads(threads)
    heights, cell = map_of(heights, cell)
    surface, lowest, highest, total = checked_heights(heights, workers)
    cell = number("cell", cell, optional=False)
    tolerance = tolerance_of(tolerance)
    load, mean_pressure = number("load", load), number("mean_pressure", mean_pressure)
    approach = number("approach", approach, any_sign=True)
    modulus, stiffness = number("modulus", modulus), number("stiffness", stiffness)
    hardness = number("hardness", hardness, limit=True)
    form = counter_of(counter, counter_radius=counter_radius, shape=surface.shape)
    check_choice("exactly one", load=load, mean_pressure=mean_pressure, approach=approach)
    check_choice("at most one", modulus=modulus, stiffness=stiffness)
    if hardness is modulus is stiffness is None:
        raise InputError(
            "hardness = None is not possible without modulus or stiffness; the bearing area needs a hardness."
        )
    edge = boundary_of(boundary, modulus, form)
    nx, ny = surface.shape
    grid, middle = Grid(nx, ny, cell), total / surface.size
    nearest, furthest, carriers = middle - highest, middle - lowest, surface.size
    unscaled = Gap(surface, middle, grid, form)
    if form is not None:
        nearest, furthest, carriers = _extent(unscaled, workers)
    mean = mean_pressure if load is None else load / grid.area
    if mean is not None and hardness is not None:
        most = hardness * (carriers / surface.size)
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
    # Heights may be next to nothing beside the displacements, or all the same.
    pushed = max(0.0, (mean or 0.0) * response if approach is None else approach - nearest)
    length = max(furthest - nearest, pushed) or 1.0
    pressure = length / response if response else hardness
    assert pressure is not None
    task = Task(
        unscaled=unscaled,
        length=length,
        pressure=pressure,
        mean=None if mean is None else mean / pressure,
        approach=None if approach is None else approach / length,
        cap=math.inf if hardness is None else hardness / pressure,
        response=float(response > 0.0),
        edge=edge,
        threads=workers,
    )
    lent = workplace(
        "normal", (nx, ny), lambda: check_memory((nx, ny), device, edge), device=device, threads=threads
    )
    with lent as place, giving_back(place.executor):
        try:
            solve = partial(solve_half_space, tolerance=tolerance) if edge else _solve_cells
            contact, carried, touched = _contact_of(task, solve(task, place), place, hardness, tolerance)
            contact = replace(contact, modulus=modulus, boundary=edge)
        except ConvergenceError as error:
            raise ConvergenceError(
                f"solve_contact failed: with {task.length:.6g} for a mm and {task.pressure:.6g} for a MPa, "
                f"{error}"
            ) from error
    if form is not None and _touches_edge(contact.pressure, form, edge):
        warnings.warn(
            f"the contact with the counter-body reaches the edge of heights, of the shape {surface.shape}, "
            "beyond which nothing carries; a larger array is needed for the whole contact.",
            stacklevel=2,
        )
    if response and 0 < touched < FEWEST_CELLS < contact.pressure.size:
        warnings.warn(
            f"the contact is of {touched} cells, whose area and pressures are those of the cells rather than "
            f"of the surface; finer cells, {FEWEST_CELLS} in contact or more, are needed to tell them.",
            stacklevel=2,
        )
    if mean is not None and not abs(carried / contact.pressure.size / mean - 1.0) <= LOAD_TOLERANCE:
        raise ConvergenceError(
            f"solve_contact found a mean pressure of {contact.mean_pressure:g} instead of {mean:g}."
        )
    return contact


def _solve_cells(task: Task, place: Workplace) -> Solution:
    """Solve with springs, or the bearing area: to rounding."""
    executor, gap, stiffest = place.executor, place.gap(task.gap), 1.0 if task.response else RIGID
    executor.foresee(ALONE, together=True)
    load = (task.mean or 0.0) * task.gap.size
    search = LoadSearch(
        executor,
        gap,
        Tiles(executor, gap, gap, least=SPARE * load / task.cap),
        load=load,
        hardness=task.cap,
        stiffness=executor.field(np.full((1, 1), stiffest), padding=stiffest),
        # No number of cells but the very one: else their pressure would exceed the hardness.
        tolerance=None if task.response else ROUNDING * load,
    )
    if task.approach is None:
        balance = search.solve()
    else:
        # Where nothing yields a cell at the very approach is touched.
        width, tied = (0.0, 0.0) if task.response else (TIE, task.cap)
        balance = Balance(task.approach, 0.0, task.cap, 0.0, width, tied, evaluations=1)
    pressure = search.pressures(balance._replace(cap=task.cap)).copy()
    approach = balance.approach
    if task.approach is None and not task.response:  # the lowest of those that touch these cells
        approach = float(task.gap[pressure > 0.0].max())
    return Solution(pressure, pressure * task.response, approach, balance.evaluations)


def _extent(gap: Gap, threads: int) -> tuple[float, float, int]:
    """Return the smallest and largest gap under the counter-body, and the number of cells there."""

    def extent(rows: slice) -> tuple[float, float, int]:
        heights = surface_of(gap(rows))
        return heights.min(initial=math.inf), heights.max(initial=-math.inf), heights.size

    lows, highs, counts = zip(*each(extent, gap.grid.shape, threads), strict=True)
    if not sum(counts):
        radius = gap.form.reach if isinstance(gap.form, Form) else 0.0
        raise InputError(f"counter_radius = {radius:g} is not possible; it must reach the middle of a cell.")
    return float(min(lows)), float(max(highs)), sum(counts)


def _touches_edge(pressure: FloatArray, form: Form | FloatArray, edge: str | None) -> bool:
    """Tell whether a cell at the rim of the array, towards which the body rises, carries a pressure."""
    along, across = form.rises if isinstance(form, Form) else (True, edge != "line")
    return bool((along and pressure[[0, -1]].any()) or (across and pressure[:, [0, -1]].any()))


def _contact_of(
    task: Task, solution: Solution, place: Workplace, hardness: float | None, tolerance: float
) -> tuple[ArrayContact, float, int]:
    """Return a solved task in the caller's units, certified, Σ p and the cells that carry. May raise."""
    certificate = solution.certificate or _certify(task, solution, place, tolerance)
    executor = place.executor
    if certificate.fault:
        raise ConvergenceError(f"the pressure cannot be certified: {certificate.fault}.")
    here = isinstance(solution.pressure, np.ndarray)
    pressure, cell = np.empty(task.shape), task.unscaled.grid.cell
    gap_after = task.gap if here else np.empty(task.shape)

    def take(rows: slice, p: FloatArray, displaced: FloatArray) -> tuple[float, int]:
        np.add(gap_after[rows] if here else task.gap_of(rows), displaced, out=gap_after[rows])
        gap_after[rows] -= solution.approach
        gap_after[rows] *= task.length
        np.multiply(p, task.pressure, out=pressure[rows])
        if hardness is not None:
            below = np.nextafter(hardness, 0.0)  # so that what is at the hardness is known to the cell
            np.minimum(pressure[rows], below, out=pressure[rows])
            pressure[rows][p >= task.cap] = hardness
        return float(pressure[rows].sum()), int(np.count_nonzero(p > 0.0))

    fields = [solution.pressure, solution.displacement]
    if here:
        blocks = each(lambda rows: take(rows, *(field[rows] for field in fields)), task.shape, task.threads)
    else:
        pitches = [executor.vectors * LANES if f.dtype is Cells else task.shape[1] for f in fields]
        blocks = download(executor, fields, take, pitches)
    contact = ArrayContact(
        pressure=pressure,
        gap=gap_after,
        approach=solution.approach * task.length,
        cell=cell,
        hardness=hardness,
        certificate=certificate.scaled(length=task.length, pressure=task.pressure, area=cell**2),
        evaluations=solution.evaluations,
    )
    carried, touched = map(sum, zip(*blocks, strict=True))
    return contact, carried, touched


def _certify(task: Task, solution: Solution, place: Workplace, tolerance: float) -> Certificate:
    """Certify a solution of springs, of a bearing area or of a window."""
    yielded = abs(solution.approach) + float(solution.pressure.mean())
    scale = task.rms or yielded
    cap = min(task.cap, NO_CAP)
    fields = {
        "pressure": place.field("pressure", solution.pressure),
        "response": place.field("displacement", solution.displacement),
        "gap": place.gap(task.gap),
    }
    certifier = place.solver(cap, lambda: Certifier(place.executor, arguments(Fields, **fields, cap=cap)))
    return certifier.at(
        approach=solution.approach,
        load=None if task.mean is None else task.mean * task.gap.size,
        scale=scale,
        allowed=max(tolerance * scale, SearchRules.rounding * yielded, solution.allowed),
    )
