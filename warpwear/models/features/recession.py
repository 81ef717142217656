"""Wear of a rough disc on a coarse grid: the depth follows the bearing area curve, the volume Archard.

While only a fraction φ of the area bears, the pressure there is 1/φ times the mean, and the surface recedes
by dz = K p dL/φ(z): the volume per area, ∫ φ dz, is K p L as before. So a rough disc runs in, and ends deeper
than a smooth one by a constant. The idea, and a logistic function for the curve, are Varenberg's (Tribology
Letters 70, 2022, doi 10.1007/s11249-022-01602-6); the equations here follow from the balance of volumes.
"""

from collections.abc import Mapping
from typing import Any, ClassVar

from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels.cells import Curve
from warpwear.kernels.running_in import film
from warpwear.kernels.running_in import recession as kernels
from warpwear.laws.bearing_curve import Logistic
from warpwear.models.features.feature import Feature, Place, Site


class Recession(Feature, name="recession"):
    """What a logistic bearing curve adds to the steps of a disc that lies still."""

    STATE: ClassVar = {"extra_depth": InFrame("disc")}
    changes_heights = True

    def __init__(self, curve: Logistic, site: Site) -> None:
        self._curve = for_kernels(curve)
        #: By which the surface stands deeper than its mean worn depth [mm].
        self.extra_depth = site.executor.zeros()

    def before_wear(self, program: Program, place: Place) -> None:
        """Add a count of the cells' area that bears in a solved contact: Σ φ over the cells in contact."""
        heights = place.bodies.counter, place.bodies.disc, place.bodies.wear_disc
        program.launch(kernels.borne, place.springs.law, self._curve, *heights, place.tables.bearing)

    def after_wear(self, program: Program, place: Place) -> None:
        """Add the recession of the disc, after the mean depth of a step was worn off it."""
        bodies = place.bodies
        program.launch(kernels.recede, self._curve, bodies.wear_disc, bodies.disc, self.extra_depth)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter the area that bears."""
        total["bearing"] = columns["bearing"]


class OwnDistances(Feature, name="distances"):
    """Cells of the disc slide distances of their own while it lies still: their K has a factor."""

    def __init__(self, factor: Field, site: Site) -> None:
        self.properties = {"k_disc": factor}


class UnequalStiffness(Feature):
    """The stiffness 1/c of every cell where what wears it in a step differs from cell to cell.

    curve: by which the disc runs in, if it does. alike: whether one row serves all: it is made at once, that
    of every cell with the list of its tile.
    """

    SCRATCH: ClassVar = ("_stiffness",)

    def __init__(
        self, executor: Executor, bodies: Mapping[str, Field], curve: Logistic | None, *, alike: bool
    ) -> None:
        self._executor, self._alike = executor, alike
        self._stiffness = executor.zeros(1 if alike else None)
        self.properties = {"stiffness": self._stiffness}
        self.sources = {"stiffens": int(not alike)}
        if curve is not None:
            self.sources |= {"curve": for_kernels(curve), "wear_disc": bodies["wear_disc"]}

    def before_search(self, program: Program, place: Place) -> None:
        """Add how 1/c of a row of cells follows from what wears it in a step."""
        if self._alike:
            self.add_to(program, place)

    def add_to(self, program: Program, place: Place) -> None:
        """Add that of every cell for the step in an array."""
        slots = self._executor.slots_of(self._stiffness.shape[0])
        program.launch(film.stiffness, place.slides, place.sources, place.cells, slots=slots)


def for_kernels(curve: Logistic) -> Arguments:
    """Return a curve as kernels take it."""
    return arguments(Curve, middle=curve.middle, scale=curve.scale)
