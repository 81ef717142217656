"""What the cells of a contact conduct at one potential is found; by Barber's analogy it is their stiffness.

The potential of a unit of flux on a half-space of unit conductivity is the displacement under a unit of
pressure where E* is 1 (Barber 2003, Proc. R. Soc. A 459, 53), and so is its operator here, cell for cell.
"""

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from warpwear import lazy
from warpwear.contact.array.arguments import is_boundary, number, shown
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.memory import check_memory, giving_back
from warpwear.contact.array.workplace import workplace
from warpwear.contact.half_space.window import Window
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid, box_of

measurements = lazy.module("scipy.ndimage")

#: Largest difference of potentials over the rms potential of a uniform flux; by its square the conductance is
#: wrong. The second of a flux that is asked for itself.
TOLERANCE, FINE = 1.0e-2, 1.0e-6
#: Cells of the median spot below which the mesh decides what it conducts.
FEWEST_CELLS = 3


@dataclass(frozen=True, eq=False)
class Conduction:
    """Holds what some cells conduct: flux over potential and conductivity, and the flux over its mean."""

    length: float
    flux: FloatArray  # shape (nx, ny)
    iterations: int = 0


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

    A flux that gives them one potential is the pressure of a flat punch of their shape, less 1: the punch has
    as much more depth as a pressure of 1 displaces, so that no cell comes near to lifting off.
    """
    box, grid, part = box_of(cells), Grid(cells.shape[0], cells.shape[1], 1.0), np.s_[:, :]
    if box is None or (boundary == "periodic" and cells.all()):
        whole = cells.size * cell**2 / film if film else math.inf
        return Conduction(whole if box else 0.0, cells.astype(np.float64))
    if boundary == "free":
        window = Window.close_to(box, grid)
        grid, part = window.grid(grid), window.cells
    punch = cells[part]
    lent = workplace(
        "normal",
        grid.shape,
        lambda: check_memory(grid.shape, device, boundary),
        device=device,
        threads=threads,
    )
    with lent as place, giving_back(place.executor):
        solver, executor = place.half_space(boundary, math.inf, tolerance=tolerance), place.executor
        executor.fill(solver.pressure_field, punch.astype(np.float64))
        displaced = place.field("displacement")
        solver.operator.set_compliance(film / cell, 0.0)
        solver.operator.respond(solver.pressure_field, displaced)
        gap = np.where(punch, -executor.to_numpy(displaced), np.inf)
        solver.started = True
        mean = 2.0 * np.count_nonzero(punch) / punch.size
        found = solver.solve(place.gap(gap), mean_pressure=mean, compliance=film / cell)
        local = found.pressure - punch
        potential = executor.to_numpy(solver.displacement()) + np.where(punch, gap, 0.0)
    flux, total = np.zeros(cells.shape), float(local.sum())
    flux[part] = local * (cells.size / total)
    length = cell * total**2 / float(np.sum(local * potential))
    return Conduction(length, flux, found.iterations)


def of_contact(
    contact: ArrayContact,
    *,
    capped: bool = True,
    film: float = 0.0,
    boundary: str | None = None,
    tolerance: float = TOLERANCE,
    **where: Any,
) -> Conduction:
    """Return what a contact conducts, computed once; capped: its cells at the hardness, too."""
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
        contact.conductions[asked] = conduction(cells, cell=contact.cell, **options, **where)
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
    apart = contact.gap[contact.pressure == 0.0] + (number("jump", jump) or 0.0)
    return total + filling * contact.cell**2 * float(np.sum(1.0 / apart))


def stiffness(contact: ArrayContact, *, unloading: bool, **where: Any) -> float:
    """Return what `ArrayContact.stiffness` does."""
    if contact.modulus is None:
        raise InputError("contact is not possible without a half-space; it must be solved with a modulus.")
    return contact.modulus * of_contact(contact, capped=unloading, **where).length


def flux(contact: ArrayContact, **options: Any) -> FloatArray:
    """Return what `ArrayContact.flux` does."""
    return of_contact(contact, tolerance=FINE, **options).flux
