"""Stresses below a solved contact, or below any pressure and traction, from arguments to fields."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from warpwear import lazy
from warpwear.contact.array.arguments import checked_heights, is_boundary, number, shape_of, shown
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.memory import claim
from warpwear.contact.array.shear import ShearedContact
from warpwear.contact.stress import measures
from warpwear.contact.stress.responses import COMPONENTS, Loads
from warpwear.engine.device import check_threads
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid

ndimage = lazy.module("scipy.ndimage")

#: Boundaries of half-spaces below which stresses are computed.
BOUNDARIES = ("periodic", "free", "line")
#: Fields that are held at a time beside the six of each depth: for each load, and otherwise.
FIELDS = {"free": (14.0, 20.0), "line": (14.0, 20.0), "periodic": (4.0, 14.0)}


class Yielding(NamedTuple):
    """Says how far von Mises' stress exceeds a yield stress, of the elastic field: nothing has yielded in it.

    depth: the deepest place, between depths by a straight line; 0 where there is none, the last depth where
    it may lie deeper. shares: of each depth's area, shape (depths,). volume: between the first and the last
    depth, a length³.
    """

    depth: float
    shares: FloatArray
    volume: float


@dataclass(frozen=True, eq=False)
class Stresses:
    """Holds stresses below a surface; tension is positive, z points into the body.

    Attributes
    ----------
    depths : array
        Lengths, shape (depths,).
    tensor : array
        Components xx, yy, zz, xy, xz, yz at the middles of the cells, shape (6, depths, nx, ny).
    cell, boundary : float, str
        Of the contact.
    traction : pair of array, or None
        (qx, qy) on the surface; None where there is none.
    """

    depths: FloatArray  # length
    tensor: FloatArray  # pressure
    cell: float  # length
    boundary: str
    traction: tuple[FloatArray, FloatArray] | None

    def component(self, name: str) -> FloatArray:
        """Return a component of the stress.

        Parameters
        ----------
        name : {"xx", "yy", "zz", "xy", "xz", "yz"}
            Which one.

        Returns
        -------
        array
            Of shape (depths, nx, ny).

        Raises
        ------
        InputError
            For another name.
        """
        if name not in COMPONENTS:
            raise InputError(f"component {name!r} is not known; allowed: {', '.join(COMPONENTS)}.")
        return self.tensor[COMPONENTS.index(name)]

    def _of_depths(self, measure: Callable[..., Any], *others: "Stresses") -> FloatArray:
        """Return a measure of the stress at every depth, one after another."""
        states = (self, *others)
        at = range(self.depths.size)
        return np.stack([measure(*(state.tensor[:, n] for state in states)) for n in at], axis=-3)

    @cached_property
    def mises(self) -> FloatArray:
        """Return von Mises' equivalent stress, shape (depths, nx, ny)."""
        return self._of_depths(measures.mises)

    @cached_property
    def _principal(self) -> FloatArray:
        return self._of_depths(lambda stress: np.stack(measures.principal(stress)))

    @property
    def principal(self) -> FloatArray:
        """Return the largest principal stress, positive in tension, shape (depths, nx, ny)."""
        return self._principal[0]

    @property
    def shear(self) -> FloatArray:
        """Return the largest shear stress, Tresca's (σ₁ − σ₃)/2, shape (depths, nx, ny)."""
        return self._principal[1]

    def plane(self, field: FloatArray, normal: str, at: float = 0.0) -> FloatArray:
        """Return a field in a plane across x or y.

        Parameters
        ----------
        field : array
            Of shape (…, depths, nx, ny).
        normal : {"x", "y"}
            Across which axis the plane lies.
        at : float
            Where it lies, from the middle of the array; between cells it is a straight line between their
            values.

        Returns
        -------
        array
            Of shape (…, depths, n).

        Raises
        ------
        InputError
            For another normal, and for a place beyond the array.
        """
        if normal not in ("x", "y"):
            raise InputError(f"normal = {normal!r} is not known; allowed: 'x' and 'y'.")
        axis = -2 if normal == "x" else -1
        grid = Grid(self.tensor.shape[2], self.tensor.shape[3], self.cell)
        places = grid.x if normal == "x" else grid.y
        place = number("at", at, any_sign=True, optional=False)
        if not places[0] - 0.5 * self.cell <= place <= places[-1] + 0.5 * self.cell:
            raise InputError(f"at = {place:g} is not possible; it must lie on the array, to ±{-places[0]:g}.")
        position = np.interp(place, places, np.arange(places.size))
        low = int(position)
        high, part = min(low + 1, places.size - 1), position - low
        return (1.0 - part) * field.take(low, axis) + part * field.take(high, axis)

    def yielding(self, limit: float) -> Yielding:
        """Return where von Mises' stress exceeds a yield stress.

        Parameters
        ----------
        limit : float
            The yield stress.

        Returns
        -------
        Yielding
            Depth of the deepest such place, shares of each depth's area, and volume.

        Raises
        ------
        InputError
            For a limit that is no positive number.
        """
        limit = number("limit", limit, optional=False)
        shares: FloatArray = (self.mises > limit).mean(axis=(1, 2))
        volume = float(np.trapezoid(shares, self.depths)) * self.mises[0].size * self.cell**2
        return Yielding(deepest(self.depths, self.mises.max(axis=(1, 2)), limit), shares, volume)

    def cycle(
        self, other: "Stresses", *, bending: float, torsion: float, length: float | None = None
    ) -> "Cycle":
        """Return the fatigue measures of a straight cycle between this state and another.

        Parameters
        ----------
        other : Stresses
            The other end of the cycle.
        bending, torsion : float
            Limits of fully reversed loading.
        length : float, optional
            Of the material, over whose square, parallel to the surface, both stresses are averaged first;
            without it hot spots at the edge of a contact grow as cells shrink.

        Returns
        -------
        Cycle
            The measures of Crossland and of Dang Van at every depth and cell.

        Raises
        ------
        InputError
            For limits that exclude each other, and for a state of another shape.
        """
        bending = number("bending", bending, optional=False)
        torsion = number("torsion", torsion, optional=False)
        measures.check_limits(bending, torsion)
        if other.tensor.shape != self.tensor.shape or not np.array_equal(other.depths, self.depths):
            raise InputError(
                f"other, of shape {other.tensor.shape}, is not possible; it must have the shape and the "
                f"depths of this state, {self.tensor.shape}."
            )
        states = self.averaged(length), other.averaged(length)
        limits = {"bending": bending, "torsion": torsion}
        fields = (
            states[0]._of_depths(lambda one, two, of=of: of(one, two, **limits), states[1])
            for of in (measures.crossland, measures.dang_van)
        )
        return Cycle(self.depths, self.cell, torsion, *fields)

    def averaged(self, length: float | None) -> "Stresses":
        """Return the stresses averaged over squares parallel to the surface.

        Parameters
        ----------
        length : float or None
            Side of the squares; None for the stresses as they are.

        Returns
        -------
        Stresses
            Of the same shape.

        Raises
        ------
        InputError
            For a side larger than the array.
        """
        length = number("length", length)
        if length is None or length <= self.cell:
            return self
        sides = self.tensor.shape[2:]
        most = min(sides[:1] if self.boundary == "line" else sides) * self.cell
        if length > most:
            raise InputError(
                f"length = {length:g} is not possible; it must be at most that of the array, {most:g}."
            )
        tensor = averaged(self.tensor, length / self.cell, self.boundary)
        return Stresses(self.depths, tensor, self.cell, self.boundary, self.traction)

    def ruiz(self, slip: npt.ArrayLike) -> FloatArray:
        """Return Ruiz and Chen's second parameter: tension at the surface × traction × slip.

        It ranks places of one contact, and is no criterion: it has no limit of a material.

        Parameters
        ----------
        slip : array
            Of each cell, a length, shape (nx, ny).

        Returns
        -------
        array
            Of shape (nx, ny).

        Raises
        ------
        InputError
            For stresses without a traction or without the depth 0, and for a slip of another shape.

        References
        ----------
        C. Ruiz, P. H. B. Boddington and K. C. Chen, Experimental Mechanics 24 (1984) 208.
        """
        sizes, *_ = checked_heights(slip, 1, name="slip")
        if self.traction is None or self.depths[0] != 0.0 or sizes.shape != self.tensor.shape[2:]:
            raise InputError(
                f"slip of shape {sizes.shape} is not possible with these stresses; they must have a "
                f"traction, the depth 0 first, and the shape of slip, {self.tensor.shape[2:]}."
            )
        tension = np.maximum(measures.principal(self.tensor[:, 0])[0], 0.0)
        return tension * np.hypot(*self.traction) * np.abs(sizes)

    def __repr__(self) -> str:
        _, count, nx, ny = self.tensor.shape
        return f"<stresses: {count} depths to {self.depths[-1]:.4g}, {nx} × {ny} cells>"


@dataclass(frozen=True, eq=False)
class Cycle:
    """Holds equivalent shear stresses of a cycle, of shape (depths, nx, ny): fatigue beyond `torsion`."""

    depths: FloatArray
    cell: float
    torsion: float  # pressure
    crossland: FloatArray  # pressure
    dang_van: FloatArray  # pressure

    def largest(self, field: FloatArray) -> tuple[float, tuple[float, float, float]]:
        """Return the largest value of a field of this cycle, and where it lies: x, y from the middle, z."""
        depth, i, j = np.unravel_index(int(field.argmax()), field.shape)
        grid = Grid(field.shape[1], field.shape[2], self.cell)
        return float(field[depth, i, j]), (float(grid.x[i]), float(grid.y[j]), float(self.depths[depth]))


def deepest(depths: FloatArray, largest: FloatArray, limit: float) -> float:
    """Return the depth below which the largest value stays under a limit: see `Yielding`."""
    beyond = np.flatnonzero(largest > limit)
    if not beyond.size:
        return 0.0
    last = int(beyond[-1])
    if last == depths.size - 1:
        return float(depths[last])
    part = (largest[last] - limit) / (largest[last] - largest[last + 1])
    return float(depths[last] + part * (depths[last + 1] - depths[last]))


def averaged(field: FloatArray, cells: float, boundary: str) -> FloatArray:
    """Return a field averaged along its last two axes over squares of a side in cells, whole or not."""
    reach = math.ceil(0.5 * (cells - 1.0))
    weights = np.ones(2 * reach + 1)
    weights[[0, -1]] = 0.5 * (cells - 2 * reach + 1)
    for axis, repeats in ((-1, boundary != "free"), (-2, boundary == "periodic")):
        mode = "wrap" if repeats else "nearest"
        field = ndimage.convolve1d(field, weights / cells, axis=axis, mode=mode)
    return field


def stresses(
    contact: ArrayContact | ShearedContact | npt.ArrayLike,
    depths: npt.ArrayLike,
    *,
    poisson: float,
    traction: Any = None,
    cell: float | None = None,
    boundary: str | None = None,
    threads: int | None = None,
) -> Stresses:
    """Return the elastic stresses at depths below a contact, from its pressure and its traction.

    Numbers are in the contact's units. A free surface's loads are uniform over each cell; a periodic one's
    are its waves, and its sides are held. At the surface the tension beside an edge under traction is too
    small by a part that falls as the square root of the cell, and at z = 0 the stress is that at a cell's
    middle. A second body needs a call of its own, with its Poisson's ratio and the opposite traction. Memory:
    six numbers for each cell and depth, said where it is 2 GiB or more.

    Parameters
    ----------
    contact : ArrayContact, ShearedContact or array
        What `solve_contact` returned for a half-space, or `solve_tangential`, with its traction; or any
        pressure, shape (nx, ny), which needs cell and boundary.
    depths : float or array
        Lengths from 0, rising; one or several.
    poisson : float
        Poisson's ratio of the body below.
    traction : pair of array, or ShearedContact, optional
        ``(qx, qy)``, each of the pressure's shape, or None for no traction along that axis; or what has such
        a pair as its `traction`. It acts on the body below; on the other body acts its opposite.
    cell : float, optional
        Width of the cells, of a pressure.
    boundary : {"free", "periodic", "line"}, optional
        "free", where nothing lies beside the array, "periodic", or "line", periodic along axis 1 alone; by
        default the contact's.
    threads : int, optional
        Of the CPU, by default every core; no result depends on it.

    Returns
    -------
    Stresses
        The six components at every depth and cell, and measures of them.

    Raises
    ------
    InputError
        For what is not possible, and where there is less memory than it needs.

    References
    ----------
    A. E. H. Love, 1929 (uniform pressure on a rectangle). K. L. Johnson, Contact Mechanics, 1985, chapter 3.

    Examples
    --------
    >>> contact = warpwear.solve_contact(
    ...     np.zeros((65, 65)), cell=0.05, load=1.0, modulus=1.0, counter_radius=1.0
    ... )
    >>> below = warpwear.stresses(contact, [0.0, 0.44], poisson=0.3)
    >>> print(below.shear.shape)
    (2, 65, 65)
    """
    workers = check_threads(threads)
    if isinstance(contact, ShearedContact):
        traction = contact if traction is None else traction
        contact = contact.contact
    if isinstance(contact, ArrayContact):
        if cell is not None:
            raise InputError(
                f"cell = {shown(cell)} is not possible with a solved contact, which has its own."
            )
        pressure, cell = contact.pressure, contact.cell
        boundary = contact.boundary if boundary is None else boundary
    else:
        pressure, *_ = checked_heights(contact, workers, name="contact")
        cell = number("cell", cell, optional=False)
    if not is_boundary(boundary):
        raise InputError(
            f'boundary = {shown(boundary)} has no stresses; it must be "periodic", "free" or "line".'
        )
    ratio = number("poisson", poisson, any_sign=True, optional=False)
    if not 0.0 <= ratio <= 0.5:
        raise InputError(f"poisson = {ratio:g} is not possible; it must be from 0 to 0.5.")
    places = _depths_of(depths)
    pair = _traction_of(traction, pressure.shape, workers)
    loads = {"p": pressure} | {name: q for name, q in zip("xy", pair or (), strict=False) if q.any()}
    of_load, other = FIELDS[boundary]
    claim(
        "stresses",
        f"{places.size} depths below a pressure of shape {pressure.shape}",
        {"the host": 8.0 * pressure.size * (len(COMPONENTS) * places.size + of_load * len(loads) + other)},
    )
    sources = Loads(loads, cell, poisson=ratio, boundary=boundary, threads=workers)
    tensor = np.empty((len(COMPONENTS), places.size, *pressure.shape))
    for place, depth in enumerate(places):
        tensor[:, place] = sources.at(depth)
    return Stresses(places, tensor, cell, boundary, pair)


def _depths_of(depths: npt.ArrayLike) -> FloatArray:
    """Return the depths as an array. Raises InputError."""
    try:
        places = np.atleast_1d(np.asarray(depths, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        places = np.empty((0, 0))
    if (
        places.ndim != 1
        or not places.size
        or not np.isfinite(places).all()
        or places[0] < 0.0
        or (np.diff(places) <= 0.0).any()
    ):
        raise InputError(f"depths = {shown(depths)} are not possible; they must be lengths from 0, rising.")
    return places


def _traction_of(traction: Any, shape: tuple[int, ...], threads: int) -> tuple[FloatArray, FloatArray] | None:
    """Return a traction as two arrays of a shape, None where there is none. Raises InputError."""
    traction = getattr(traction, "traction", traction)
    if traction is None:
        return None
    if not isinstance(traction, Sequence | np.ndarray) or shape_of(traction) == () or len(traction) != 2:
        raise InputError(
            "traction is not possible; it must be a pair (qx, qy), or what has one as its traction."
        )
    pair = []
    for axis, values in zip("xy", traction, strict=True):
        field = (
            np.zeros(shape)
            if values is None
            else checked_heights(values, threads, name=f"traction {axis}")[0]
        )
        if field.shape != shape:
            raise InputError(f"traction {axis} of shape {field.shape} is not possible; it must be {shape}.")
        pair.append(field)
    return pair[0], pair[1]
