"""What the cells of a contact conduct at one potential is found; by Barber's analogy it is their stiffness.

The potential of a unit of flux on a half-space of unit conductivity is the displacement under a unit of
pressure where E* is 1 (Barber 2003, Proc. R. Soc. A 459, 53), and so is its operator here, cell for cell.
"""

import math
import warnings
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from warpwear import lazy
from warpwear.contact.array.arguments import is_boundary, number, shown
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.memory import check_memory, giving_back
from warpwear.contact.array.workplace import Workplace, workplace
from warpwear.contact.half_space.influence import Influence
from warpwear.contact.half_space.solver import MAX_ITERATIONS
from warpwear.contact.half_space.transforms import array_module
from warpwear.contact.half_space.window import Window
from warpwear.engine.device import check_threads
from warpwear.engine.executor import Executor
from warpwear.engine.program import Program
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid, box_of
from warpwear.kernels.cells import LANES

measurements = lazy.module("scipy.ndimage")

#: Part of a conductance that may be missing, see `conduction`; and that of a flux which is asked for, whose
#: error is the root.
TOLERANCE, FINE = 1.0e-4, 1.0e-12
#: Cells of the median spot below which the mesh decides what it conducts.
FEWEST_CELLS = 3


@dataclass(frozen=True, eq=False)
class Conduction:
    """Holds what some cells conduct: flux over potential and conductivity, and the flux over its mean."""

    length: float
    flux: FloatArray  # shape (nx, ny)
    iterations: int = 0


class Answers:
    """Holds a flux, and the potential under it or the other way about: the operator, and about its inverse.

    single: whether single precision will do.
    """

    def __init__(self, executor: Executor, boundary: str, *, single: bool) -> None:
        self.operator = Influence(executor, modulus=1.0, boundary=boundary)
        self.fields = executor.zeros(), executor.zeros()
        self.response, self.inverse = Program(executor), Program(executor)
        self.operator.add_response(self.response, *self.fields, single=single)
        self.operator.add_inverse(self.inverse, *self.fields)


def conduction(
    cells: npt.NDArray[np.bool_],
    *,
    cell: float,
    boundary: str,
    film: float = 0.0,
    tolerance: float = TOLERANCE,
    device: str = "cpu",
    threads: int | None = None,
) -> Conduction:
    """Return what some cells of a surface conduct. film: resistance of their area × conductivity, a length.

    Conjugate gradients find the flux of one potential, of these cells alone. Its energy lies above the least
    one by no more than that of the residual under the inverse on all cells, where the surface repeats exactly
    so: that is the stop test. Raises ConvergenceError.
    """
    box, grid, part = box_of(cells), Grid(cells.shape[0], cells.shape[1], 1.0), np.s_[:, :]
    if box is None or (boundary == "periodic" and cells.all()):
        whole = cells.size * cell**2 / film if film else math.inf
        return Conduction(whole if box else 0.0, cells.astype(np.float64))
    if boundary == "free":
        window = Window.close_to(box, grid)
        grid, part = window.grid(grid), window.cells
    check = partial(check_memory, grid.shape, device, boundary)
    lent = workplace("normal", grid.shape, check, device=device, threads=threads)
    with lent as place, giving_back(place.executor):
        local, energy, iterations = _at_one_potential(place, cells[part], boundary, film / cell, tolerance)
    total, flux = float(local.sum()), np.zeros(cells.shape)
    flux[cells] = local * (cells.size / total)
    return Conduction(cell * total**2 / energy, flux, iterations)


def _at_one_potential(
    place: Workplace, touches: npt.NDArray[np.bool_], boundary: str, film: float, tolerance: float
) -> tuple[FloatArray, float, int]:
    """Return the flux of cells as `conduction` does, its product with the potential, and iterations.

    What it takes of a device ends with it, so that its caller can give that back.
    """
    with array_module(place.executor) as xp:
        executor, single = place.executor, tolerance > FINE
        answers = place.solver((boundary, single), lambda: Answers(executor, boundary, single=single))
        answers.operator.set_compliance(film, 0.0)
        answers.fields[0].zero_()
        given, answer = (xp.asarray(field).reshape(-1) for field in answers.fields)
        row, column = np.nonzero(touches)
        places = xp.asarray(row * (executor.vectors * LANES) + column)

        def answered(program: Program, values: Any) -> Any:
            given[places] = values
            program.run()
            return answer[places]

        local = step = xp.ones(places.size)
        potential = response = answered(answers.response, local)
        for iteration in range(MAX_ITERATIONS):
            residual = potential.mean() - potential
            descent = answered(answers.inverse, residual)
            descent -= descent.mean()
            energy, missing = (float((a * b).sum()) for a, b in ((local, potential), (residual, descent)))
            if missing <= tolerance * energy:
                return local if xp is np else local.get(), energy, iteration
            if iteration:
                descent -= step * ((descent * response).sum() / (step * response).sum())
            step, response = descent, answered(answers.response, descent)
            length = (residual * step).sum() / (step * response).sum()
            local = local + length * step
            potential = potential + length * response
    raise ConvergenceError(f"no flux of one potential was found in {MAX_ITERATIONS} iterations.")


def of_contact(
    contact: ArrayContact,
    *,
    capped: bool = True,
    film: float = 0.0,
    boundary: str | None = None,
    tolerance: float = TOLERANCE,
    device: str = "cpu",
    threads: int | None = None,
) -> Conduction:
    """Return what a contact conducts, computed once; capped: its cells at the hardness, too."""
    check_threads(threads)
    boundary = contact.boundary if boundary is None else boundary
    if not is_boundary(boundary):
        raise InputError(
            f"boundary = {shown(boundary)} is not possible for a contact without a half-space; it must be "
            '"periodic", "free" or "line".'
        )
    cells = contact.pressure > 0.0
    if not capped and contact.hardness is not None:
        cells &= contact.pressure < contact.hardness
    asked = np.count_nonzero(cells), film, boundary, tolerance
    if asked not in contact.conductions:
        options: dict[str, Any] = {"film": film, "boundary": boundary, "tolerance": tolerance}
        options |= {"cell": contact.cell, "device": device, "threads": threads}
        contact.conductions[asked] = conduction(cells, **options)
    return contact.conductions[asked]


def conductance(
    contact: ArrayContact,
    conductivity: float,
    *,
    film_resistance: float | None = None,
    gap_conductivity: float | None = None,
    jump: float | None = None,
    **where: Any,
) -> float:
    """Return what `ArrayContact.conductance` does."""
    k = float(number("conductivity", conductivity, optional=False))
    film, filling = number("film_resistance", film_resistance), number("gap_conductivity", gap_conductivity)
    labels, spots = measurements.label(contact.pressure > 0.0)
    if spots and np.median(np.bincount(labels.ravel())[1:]) < FEWEST_CELLS:
        warnings.warn(
            f"half of the spots in contact are of fewer than {FEWEST_CELLS} cells; finer ones are needed to "
            "tell what they conduct.",
            stacklevel=3,
        )
    total = k * of_contact(contact, film=k * (film or 0.0), **where).length
    if filling is None:
        return total
    # Beside a rim the gap grows by d^{3/2}: without a length on top of it the sum is of the rim's cells.
    apart = contact.gap[contact.pressure == 0.0] + number("jump", jump, optional=False)
    return total + filling * contact.cell**2 * float(np.sum(1.0 / apart))


def stiffness(contact: ArrayContact, *, unloading: bool, **where: Any) -> float:
    """Return what `ArrayContact.stiffness` does."""
    if contact.modulus is None:
        raise InputError("stiffness needs a half-space; the contact must be solved with a modulus.")
    return contact.modulus * of_contact(contact, capped=unloading, **where).length


def flux(contact: ArrayContact, *, film: float | None = None, **options: Any) -> FloatArray:
    """Return what `ArrayContact.flux` does."""
    return of_contact(contact, film=number("film", film) or 0.0, tolerance=FINE, **options).flux
