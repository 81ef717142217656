"""The form of a counter-body is its height over the point that touches first, before any wear."""

import math
from dataclasses import dataclass, field

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray

#: Height of what is not there [mm], as kernels pad gaps.
NOTHING = 1.0e30


def sag(x: FloatArray, y: FloatArray, *, radius: float) -> FloatArray:
    """Return the height [mm] of a sphere's lower side over its apex at the points x × y.

    x, y: points [mm], 1-D, 0 = below the apex. radius: R [mm]; infinite for a rigid flat (sag 0). The shape
    is (x.size, y.size). It is r²/(R + √(R² − r²)), equal to R − √(R² − r²) (thesis eq 3.1) without its
    cancellation near the apex, and infinite beyond the sphere's edge (r > R). Raises InputError for a radius
    that is not positive.
    """
    if not radius > 0:
        raise InputError(f"counter.radius is {radius:g} mm: allowed is any positive length, inf for a flat")
    if math.isinf(radius):
        return np.zeros((x.size, y.size))
    squared = np.add.outer(np.square(x), np.square(y)).astype(np.float64, copy=False)
    below = radius * radius - squared
    outside = below < 0.0
    np.maximum(below, 0.0, out=below)
    np.sqrt(below, out=below)
    below += radius
    np.divide(squared, below, out=squared)
    squared[outside] = np.inf
    return squared


@dataclass(frozen=True)
class Form:
    """A crowned body: a paraboloid x²/2R + y²/2R', where either radius may be infinite; by default a flat."""

    along: float = 0.0  # curvature 1/R of a section along sliding [1/mm]
    across: float = 0.0  # 1/R' of one across it

    @property
    def curvature(self) -> float:
        """Return 1/R of a ball [1/mm], whose heights kernels make; 0 of every other form."""
        return 0.0

    @property
    def is_flat(self) -> bool:
        """Tell whether it is the rigid flat, whose contact has no outline."""
        return type(self) is Form and not any(self.rises)

    @property
    def rises(self) -> tuple[bool, bool]:
        """Tell whether it rises along sliding and across it; where it does not, it ends with the domain."""
        return self.along > 0.0, self.across > 0.0

    @property
    def is_line(self) -> bool:
        """Tell whether its scar is a rectangle: it rises one way and goes on the other."""
        along, across = self.rises
        return along != across

    @property
    def reach(self) -> float:
        """Return the half width [mm] beyond which there is no body."""
        return math.inf

    @property
    def most_worn(self) -> float:
        """Return the width [mm] of a scar up to which `worn` means something."""
        return 1.0 / max(self.along, self.across) if self.along or self.across else math.inf

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return f [mm] at the points x × y [mm], shape (x.size, y.size); infinite where there is no body."""
        sections = (0.5 * curvature * np.square(p) for curvature, p in ((self.along, x), (self.across, y)))
        return np.asarray(np.add.outer(*sections))

    def beneath(self, heights: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [mm] under a flat that leave the gap of this body over a disc's, at x × y [mm].

        heights: of the disc [mm], shape (x.size, y.size). A ball's are as they are: kernels make its own.
        """
        made = self.is_flat or self.curvature > 0.0
        return heights if made else heights - np.minimum(self.heights(x, y), NOTHING)

    def worn(self, volume: float, extent: tuple[float, float]) -> tuple[float, float]:
        """Return the widths [mm] along and across of what a plane cuts off, of a volume [mm³].

        extent: of the domain [mm], with which the body ends where it does not rise. Of a ball it is that of
        its paraboloid, V = π a⁴/4R; of a cylinder V = 2 a³/3R times its length.
        """
        if self.along and self.across:
            depth = math.sqrt(volume * math.sqrt(self.along * self.across) / math.pi)
            along, across = (2.0 * math.sqrt(2.0 * depth / k) for k in (self.along, self.across))
            return along, across
        curvature, length = (self.along, extent[1]) if self.along else (self.across, extent[0])
        if not curvature:
            return extent
        width = 2.0 * (1.5 * volume / (length * curvature)) ** (1.0 / 3.0)
        return (width, extent[1]) if self.along else (extent[0], width)

    def deepest(self, volume: float, extent: tuple[float, float]) -> tuple[float, float]:
        """Return the depth of what a plane cuts off [mm], and the power of it that volumes go by.

        volume, extent: as of `worn`; a form of which that knows no width is as wide as the domain.
        """
        along, across = self.worn(volume, extent)
        power = 1.0 + 0.5 * ((self.along > 0.0) + (self.across > 0.0))
        area = along * across * (0.25 * math.pi if all(self.rises) else 1.0)
        return power * volume / (area or extent[0] * extent[1]), power


@dataclass(frozen=True)
class Ball(Form):
    """A ball of radius R; both curvatures are 1/R."""

    @property
    def curvature(self) -> float:
        """Return 1/R [1/mm]."""
        return self.along

    @property
    def reach(self) -> float:
        """Return R [mm]."""
        return 1.0 / self.along

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the ball's `sag` [mm] at the points x × y [mm]."""
        return sag(x, y, radius=1.0 / self.along)


@dataclass(frozen=True)
class Pin(Form):
    """A flat pin is 0 high on its face, then a quarter of a circle, with nothing beyond."""

    face: float = 0.0  # radius a of the flat face [mm]
    edge: float = 0.0  # radius ρ of the edge [mm]

    @property
    def rises(self) -> tuple[bool, bool]:
        """Tell that it ends on all sides."""
        return True, True

    @property
    def reach(self) -> float:
        """Return a + ρ [mm]."""
        return self.face + self.edge

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return 0 for r ≤ a, then ρ − √(ρ² − (r − a)²), without its cancellation near the face [mm]."""
        beyond = np.maximum(np.hypot(x[:, np.newaxis], y) - self.face, 0.0)
        below = np.sqrt(np.maximum(self.edge**2 - beyond**2, 0.0))
        rise = np.where(beyond > 0.0, np.inf, 0.0)
        on_edge = (beyond > 0.0) & (beyond <= self.edge)
        return np.divide(beyond**2, self.edge + below, out=rise, where=on_edge)

    def worn(self, volume: float, extent: tuple[float, float]) -> tuple[float, float]:
        """Return the width [mm] of the face when it is lower by a volume [mm³] over its section."""
        depth = min(volume / (math.pi * self.reach**2), self.edge)
        width = 2.0 * (self.face + math.sqrt(depth * (2.0 * self.edge - depth)))
        return width, width


@dataclass(frozen=True)
class Given(Form):
    """A form given by its heights on the domain's cells; curvatures are those of its nominal form, or 0."""

    values: FloatArray = field(default_factory=lambda: np.zeros((0, 0)), compare=False, repr=False)
    goes_on: bool = False  # whether the body goes on beyond the domain, whose edge it may then touch

    @property
    def rises(self) -> tuple[bool, bool]:
        """Tell whether the domain's edge is one that the contact must not reach."""
        return not self.goes_on, not self.goes_on

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return f [mm] on the domain's cells, whose places x × y have to be."""
        return self.values

    def worn(self, volume: float, extent: tuple[float, float]) -> tuple[float, float]:
        """Return those of the nominal form; 0 where nothing tells how wide the scar will be."""
        return super().worn(volume, extent) if self.along or self.across else (0.0, 0.0)


def form_of(
    shape: str,
    *,
    radius: float = math.inf,
    radius_along: float = math.inf,
    radius_across: float = math.inf,
    edge_radius: float = 0.0,
) -> Form:
    """Return the form of a ball, or of what is crowned, a cylinder or a pin, of [counter]'s radii [mm].

    Raises InputError for another shape, and a pin without a finite radius.
    """
    if shape == "pin":
        if math.isinf(radius):
            raise InputError("counter.radius = inf mm is no pin's: allowed is a finite radius of its face")
        return Pin(face=radius, edge=edge_radius)
    if shape == "ball":
        return Form() if math.isinf(radius) else Ball(1.0 / radius, 1.0 / radius)
    if shape == "crowned":
        return Form(1.0 / radius_along, 1.0 / radius_across)
    if shape == "cylinder":
        return Form(1.0 / radius)
    raise InputError(f"shape = {shape!r} is unknown; allowed are 'ball', 'crowned', 'cylinder' and 'pin'")
