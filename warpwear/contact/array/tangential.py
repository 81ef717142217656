"""Shear the contact of an array, increment by increment: what slips, what sticks, and what is dissipated."""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from warpwear.contact.array.arguments import number, shape_of, shown, tolerance_of
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.memory import claim
from warpwear.contact.array.shear import ShearCertificate, ShearedContact
from warpwear.contact.array.solve import solve_contact
from warpwear.contact.array.workplace import Workplace, workplace
from warpwear.contact.half_space.coupling import Coupling
from warpwear.contact.half_space.influence import Influence
from warpwear.contact.half_space.shear import ON_CIRCLE, Pair, Sheared, ShearInfluence, ShearSearch
from warpwear.contact.half_space.window import Window
from warpwear.engine.device import check_threads, free_memory
from warpwear.engine.executor import Executor
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid, box_of

#: Largest violation of the slip conditions, over what friction's bound displaces.
TOLERANCE = 1.0e-6
#: Fields that a solve holds at its peak, with some to spare: measured on a CPU were 36 periodic and 38 free.
#: What a GPU needs is summed up, not measured.
FIELDS, FIELDS_ON_GPU = 40.0, 70.0
#: Rounds between pressure and traction of dissimilar bodies, at most, and change of either, over the largest
#: bound, over the tolerance.
ROUNDS, CHANGE = 60, 10.0
#: Smallest part of E* by which the bodies may miss that of their contact.
SAME = 1.0e-3


def solve_tangential(
    contact: ArrayContact,
    *,
    friction: float,
    poisson: float | Sequence[tuple[float, float]],
    force: float | tuple[float, float] | None = None,
    displacement: float | tuple[float, float] | None = None,
    previous: ShearedContact | None = None,
    coupled: bool = True,
    tolerance: float = TOLERANCE,
    device: str = "cpu",
    threads: int | None = None,
) -> ShearedContact:
    """Shear a contact of a half-space by an increment, and return traction, slip and what sticks.

    Quasi-static: there is no velocity, and no increment slides for good; the force must be below μ times the
    load.

    Parameters
    ----------
    contact : ArrayContact
        Of `solve_contact` with a modulus, at the load of the end of the increment.
    friction : float
        μ; the traction of no cell exceeds μ p.
    poisson : float or pair of pairs
        Poisson's ratio of both bodies, of the same material; or ``((young, poisson), (young, poisson))`` of
        the body of heights and of the other, where infinite is rigid.
    force, displacement : float or pair of float, optional
        One of the two, at the end of the increment, of the other body over that of heights: a number along
        axis 0, where all tractions along axis 1 are left out; or two, along both axes. The rigid displacement
        counts from the first increment; of a surface that repeats it is that of the mean.
    previous : ShearedContact, optional
        The increment before, None for the first: loads, forces and displacements may change and turn from one
        to the next, and each has an answer of its own, whatever its size. At a constant load one increment is
        exact up to where the force turns; where the load changes, or the direction of the force, finer ones
        are better.
    coupled : bool
        Of dissimilar bodies, whether tractions change the pressure; without, Goodman's approximation.
    tolerance : float
        Largest violation of the slip conditions, over the displacement that μ p would make; from 1e-14 to
        0.01.
    device, threads : str, int
        As of `solve_contact`; no result depends on the threads.

    Returns
    -------
    ShearedContact
        Traction, slip, what sticks, and a certificate of what they are worth.

    Raises
    ------
    InputError
        For a contact without a half-space, a force that friction does not bear, or a number out of its range.
    ConvergenceError
        Where the tolerance is not met.

    References
    ----------
    C. Cattaneo, 1938. R. D. Mindlin, Journal of Applied Mechanics 16 (1949) 259. K. L. Johnson, Contact
    Mechanics, 1985, chapters 5 and 7.

    Examples
    --------
    >>> flat, ball = np.zeros((64, 64)), {"radius": 10.0}
    >>> ball = warpwear.solve_contact(flat, cell=0.1, load=1.0, modulus=1.0, counter=ball)
    >>> pushed = warpwear.solve_tangential(ball, friction=0.5, poisson=0.3, force=0.3)
    >>> print(f"{pushed.stick_area / ball.area:.2f}, {pushed.force[0]:.3f}")
    0.54, 0.300
    """
    workers = check_threads(threads)
    if not isinstance(contact, ArrayContact) or contact.modulus is None or contact.boundary is None:
        raise InputError("contact is not possible without a half-space; it must be solved with a modulus.")
    mu, tolerance = number("friction", friction, optional=False), tolerance_of(tolerance)
    bodies = _bodies_of(poisson, contact.modulus)
    if (force is None) == (displacement is None):
        raise InputError(f"force = {force} and displacement = {displacement} are given; exactly one must be.")
    name, value = ("displacement", displacement) if force is None else ("force", force)
    axes, (x, y) = _along(name, value)
    most = mu * contact.load
    if not most > 0.0:
        raise InputError(f"contact of load = {contact.load:g} is not possible; it must be pressed.")
    if force is not None and not math.hypot(x, y) < most:
        raise InputError(
            f"force = {value} is not possible; it must be less than friction × load, {most:g}, beyond which "
            "the contact slides."
        )
    _check(contact, axes, previous, bodies)
    if bodies.beta and coupled and not math.isfinite(contact.gap.max()):
        raise InputError(
            "contact with a counter-body that ends over heights is not possible with coupled = True."
        )
    options: dict[str, Any] = {"device": device, "threads": workers}
    task = _Shearing(contact, mu, bodies, previous, axes, coupled, tolerance, options)
    if force is not None:
        return task.solve((x, y), (0.0, 0.0))
    before = previous.displacement if previous else (0.0, 0.0)
    return task.solve(None, (x - before[0], y - before[1]))


class _Bodies(NamedTuple):
    """Holds what tangential displacements depend on: B E*, and Dundurs' β."""

    excess: float
    beta: float


def _bodies_of(poisson: Any, modulus: float) -> _Bodies:
    """Return what Poisson's ratio of both bodies, or (young, poisson) of each, say."""
    if shape_of(poisson) == ():
        ratio = _ratio(poisson)
        return _Bodies(ratio / (1.0 - ratio), 0.0)
    if shape_of(poisson) != (2, 2):
        raise InputError(
            f"poisson = {shown(poisson)} is not possible; it must be a number, or (young, poisson) "
            "of two bodies."
        )
    yielding = excess = beta = 0.0
    for sign, (young, ratio) in zip((1.0, -1.0), poisson, strict=True):
        ratio = _ratio(ratio)
        soft = 0.0 if young == math.inf else 1.0 / number("young", young, optional=False)
        soft *= 2.0 * (1.0 + ratio)  # 1/G
        yielding += (1.0 - ratio) * soft / 2.0
        excess += ratio * soft / 2.0
        beta += sign * (1.0 - 2.0 * ratio) * soft / 4.0
    if not abs(yielding * modulus - 1.0) <= SAME:
        raise InputError(
            f"poisson = {poisson!r} is not possible: these bodies have the modulus "
            f"{1.0 / yielding if yielding else math.inf:g}; it must be that of their contact, {modulus:g}."
        )
    return _Bodies(excess * modulus, beta * modulus)


def _ratio(poisson: Any) -> float:
    ratio = float(number("poisson", poisson, any_sign=True, optional=False))
    if not -1.0 < ratio <= 0.5:
        raise InputError(f"poisson = {ratio:g} is not possible; it must be above -1 and at most 0.5.")
    return ratio


def _along(name: str, value: Any) -> tuple[int, Pair]:
    """Return how many axes a number, or two, are about, and both components."""
    if shape_of(value) == ():
        return 1, (number(name, value, any_sign=True, optional=False), 0.0)
    if shape_of(value) != (2,):
        raise InputError(f"{name} = {shown(value)} is not possible; it must be a number, or two.")
    along, across = (number(name, one, any_sign=True, optional=False) for one in value)
    return 2, (along, across)


def _check(contact: ArrayContact, axes: int, previous: ShearedContact | None, bodies: _Bodies) -> None:
    """Raise InputError for a contact whose friction cannot be solved, or not after that one."""
    if contact.boundary == "line" and (axes == 2 or contact.pressure.shape[1] > 1 or bodies.beta):
        raise InputError(
            'contact of boundary "line" is not possible but with one column of cells, bodies of one material '
            "and a number for force or displacement."
        )
    if bodies.beta and axes == 1:
        raise InputError(
            "poisson of dissimilar bodies is not possible along one axis; give two numbers for force or "
            "displacement."
        )
    if previous is None:
        return
    if not isinstance(previous, ShearedContact):
        raise InputError(
            f"previous of type {type(previous).__name__} is not possible; it must be what solve_tangential "
            "returned, or left out."
        )
    last = previous.contact
    if (last.pressure.shape, last.cell, last.boundary) != (
        contact.pressure.shape,
        contact.cell,
        contact.boundary,
    ):
        raise InputError(
            f"previous of {last.pressure.shape} cells of {last.cell:g}, {last.boundary}, is not possible; "
            f"those of contact must be the same, {contact.pressure.shape} of {contact.cell:g}, "
            f"{contact.boundary}."
        )
    if axes == 1 and previous.traction[1].any():
        raise InputError(
            "previous has a traction along axis 1; two numbers must be given for force or displacement."
        )


@dataclass(frozen=True)
class _Shearing:
    """Holds an increment, and solves it in units where E*, the largest bound and a cell's width are 1."""

    contact: ArrayContact
    friction: float
    bodies: _Bodies
    previous: ShearedContact | None
    axes: int
    coupled: bool
    tolerance: float
    options: dict[str, Any]  # device and threads

    def solve(self, force: Pair | None, further: Pair) -> ShearedContact:
        """Solve the increment at a force, or at a further rigid displacement."""
        contact, whole = self.contact, self._grid(1.0)
        pressure, length, window = self._pressure, self._length, self._window
        unit = pressure * contact.cell**2  # of forces
        part, cells = window.grid(whole), np.s_[..., window.cells[0], window.cells[1]]
        with workplace("tangential", part.shape, lambda: self._claim(part), **self.options) as place:
            search = self._search(place)

            def sheared(normal: ArrayContact, start: FloatArray) -> Sheared:
                """Find the traction of a normal contact whose surfaces start from a displacement."""
                answer = search.solve(
                    self.friction / pressure * normal.pressure[cells],
                    last=self._last[cells] / pressure,
                    start=start[cells] / length,
                    force=force and (force[0] / unit, force[1] / unit),
                    displacement=(further[0] / length, further[1] / length),
                )
                traction, slip = np.zeros_like(self._last), np.zeros_like(self._last)
                traction[cells], slip[cells] = answer.traction * pressure, answer.slip * length
                return replace(answer, traction=traction, slip=slip)

            if self.bodies.beta:
                contact, solution = self._in_turns(sheared)
            else:
                solution = sheared(contact, np.zeros_like(self._last))
        return self._result(contact, solution, force)

    def _claim(self, grid: Grid) -> None:
        """Say what memory is needed where it is much; InputError where there is less."""
        host, *gpu = free_memory(self.options["device"])
        needs = {host: 8.0 * FIELDS * grid.cells} | dict.fromkeys(gpu, 8.0 * FIELDS_ON_GPU * grid.cells)
        claim("solve_tangential", f"{grid.nx} × {grid.ny} cells", needs, self.options["device"])

    def _search(self, place: Workplace) -> ShearSearch:
        """Return what looks for tractions on a part of the cells."""
        executor = place.executor
        elastic: dict[str, Any] = {
            "excess": self.bodies.excess,
            "boundary": self.contact.boundary,
            "axes": self.axes,
        }

        def make() -> ShearSearch:
            operator = ShearInfluence(executor, modulus=1.0, **elastic)
            return ShearSearch(executor, operator, tolerance=self.tolerance)

        return place.solver((*elastic.values(), self.tolerance), make)

    def _grid(self, cell: float) -> Grid:
        rows, columns = self.contact.pressure.shape
        return Grid(rows, columns, cell)

    @property
    def _pressure(self) -> float:
        """Return the largest bound, the unit of pressures."""
        return self.friction * float(self.contact.pressure.max())

    @property
    def _length(self) -> float:
        """Return the unit of displacements."""
        assert self.contact.modulus is not None
        return self._pressure * self.contact.cell / self.contact.modulus

    @cached_property
    def _last(self) -> FloatArray:
        """Return the traction before, shape (2, nx, ny)."""
        return self.previous.traction if self.previous else np.zeros((2, *self.contact.pressure.shape))

    @cached_property
    def _window(self) -> Window:
        """Return the cells that touch or have touched, where all others have no part in it."""
        grid, box = self._grid(1.0), None
        if self.contact.boundary == "free" and not self.bodies.beta:
            box = box_of((self.contact.pressure > 0.0) | self._last.any(axis=0))
        return Window.close_to(box or (0, grid.nx - 1, 0, grid.ny - 1), grid)

    def _in_turns(
        self, sheared: Callable[[ArrayContact, FloatArray], Sheared]
    ) -> tuple[ArrayContact, Sheared]:
        """Solve pressure and traction of dissimilar bodies in turns.

        The way is Panagiotopoulos's, 1975, Ing.-Arch. 44, 421.
        """
        contact, traction, iterations = self.contact, self._last, 0
        grid = self._grid(contact.cell)
        elastic: dict[str, Any] = {"modulus": contact.modulus, "boundary": contact.boundary}
        ties = Coupling(grid, beta=self.bodies.beta, threads=self.options["threads"], **elastic)
        before = self.previous.contact.pressure if self.previous else np.zeros(grid.shape)
        gap = self._unloaded(grid) if self.coupled else contact.gap
        for _ in range(ROUNDS):
            normal = self._pressed(gap + ties.lift(traction)) if self.coupled else contact
            solution = sheared(normal, -ties.shear(normal.pressure - before))
            iterations += solution.iterations
            change = max(
                float(np.abs(solution.traction - traction).max()),
                self.friction * float(np.abs(normal.pressure - contact.pressure).max()),
            )
            contact, traction = normal, solution.traction
            if not self.coupled or change <= CHANGE * self.tolerance * self._pressure:
                return contact, replace(solution, iterations=iterations)
        raise ConvergenceError(
            f"pressure and traction of the dissimilar bodies did not converge in {ROUNDS} rounds: one more "
            f"changes them by {change / self._pressure:.3g} of friction × the largest pressure (allowed "
            f"{CHANGE * self.tolerance:g})."
        )

    def _unloaded(self, grid: Grid) -> FloatArray:
        """Return the gap before contact, from that which the pressure of the contact leaves."""
        contact = self.contact
        with Executor(grid, **self.options) as executor:
            assert contact.modulus is not None
            assert contact.boundary is not None
            pressed, displaced = executor.field(contact.pressure), executor.zeros()
            operator = Influence(executor, modulus=contact.modulus, boundary=contact.boundary)
            operator.respond(pressed, displaced)
            return contact.gap + contact.approach - executor.to_numpy(displaced)

    def _pressed(self, gap: FloatArray) -> ArrayContact:
        """Solve the normal contact of a gap at the load."""
        contact = self.contact
        names = "cell", "load", "modulus", "boundary", "hardness"
        options: dict[str, Any] = {name: getattr(contact, name) for name in names}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # which the contact has said
            normal = solve_contact(-gap, tolerance=min(self.tolerance, TOLERANCE), **self.options, **options)
        return replace(normal, approach=normal.approach + float(gap.mean()))

    def _result(self, contact: ArrayContact, solution: Sheared, force: Pair | None) -> ShearedContact:
        """Return a solution, certified."""
        bounds, size = self.friction * contact.pressure, np.hypot(*solution.traction)
        area, work = contact.cell**2, (solution.traction * solution.slip).sum(axis=0)
        most = float(bounds.sum()) * area
        missed = [] if force is None else solution.traction.sum(axis=(1, 2)) * area - force
        gap = float((bounds * np.hypot(*solution.slip) - work).sum()) * area
        before = self.previous.displacement if self.previous else (0.0, 0.0)
        along, across = (a + b * self._length for a, b in zip(before, solution.level, strict=True))
        return ShearedContact(
            contact=contact,
            friction=self.friction,
            traction=solution.traction,
            slip=solution.slip,
            stick=(bounds > 0.0) & (size < (1.0 - ON_CIRCLE) * bounds),
            displacement=(along, across if self.axes == 2 else 0.0),
            energy=float(work.sum()) * area,
            certificate=ShearCertificate(
                violation=solution.violation,
                allowed=solution.allowed,
                beyond_bounds=max(0.0, float((size - bounds).max())),
                force_residual=float(np.abs(missed).max(initial=0.0)) / most,
                energy_gap=gap,
                relative_gap=gap / (most * solution.scale * self._length),
            ),
            evaluations=3 * solution.iterations + 3,
            iterations=solution.iterations,
        )
