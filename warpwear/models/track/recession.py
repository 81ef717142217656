"""Wear of a rough disc on a coarse grid: the depth follows the bearing area curve, the volume Archard.

While only a fraction φ of the area bears, the pressure there is 1/φ times the mean, and the surface recedes
by dz = K p dL/φ(z): the volume per area, ∫ φ dz, is K p L as before. So a rough disc runs in, and ends deeper
than a smooth one by a constant. The idea, and a logistic function for the curve, are Varenberg's (Tribology
Letters 70, 2022, doi 10.1007/s11249-022-01602-6); the equations here follow from the balance of volumes.
"""

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels.running_in import recession as kernels
from warpwear.kernels.sliding import Bodies
from warpwear.laws.bearing_curve import Logistic
from warpwear.models.attachment import Attachment, Place


class Recession(Attachment):
    """What a logistic bearing curve adds to the steps of a disc that lies still."""

    STATE: ClassVar = {"beyond": InFrame("disc")}

    def __init__(self, curve: Logistic, executor: Executor, bodies: Bodies) -> None:
        #: For kernels.
        self.curve: Arguments = arguments(kernels.Curve, middle=curve.middle, scale=curve.scale)
        self._bodies = bodies
        self.beyond = executor.zeros()  # by which the surface stands deeper than its mean worn depth [mm]

    def before_wear(self, program: Program, place: Place) -> None:
        """Add a count of the cells' area that bears in a solved contact: Σ φ over the cells in contact."""
        heights = self._bodies.counter, self._bodies.disc, self._bodies.wear_disc
        program.launch(kernels.borne, place.springs.law, self.curve, *heights, place.tables.bearing)

    def after_wear(self, program: Program, place: Place) -> None:
        """Add the recession of the disc, after the mean depth of a step was worn off it."""
        bodies = self._bodies
        program.launch(kernels.recede, self.curve, bodies.wear_disc, bodies.disc, self.beyond)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter the area that bears."""
        total["bearing"] = columns["bearing"]


class UnequalStiffness(Attachment):
    """The stiffness 1/c of every cell where what wears it in a step differs from cell to cell.

    factor: of the sliding distance of the disc's cells. recession: by which the disc runs in, if it does.
    """

    def __init__(
        self, executor: Executor, bodies: Bodies, factor: Field, recession: Recession | None
    ) -> None:
        alike = factor.shape[0] == 1 and recession is None
        self._executor, self._bodies, self._factor = executor, bodies, factor
        self._curve = arguments(kernels.Curve) if recession is None else recession.curve
        self._stiffness = executor.zeros(1 if alike else None)
        self.properties = {"stiffness": self._stiffness}

    def before_search(self, program: Program, place: Place) -> None:
        """Add how 1/c of every cell follows from what wears it in a step."""
        self.add_to(program, place.slides)

    def add_to(self, program: Program, slides: Field) -> None:
        """Add it for the step in an array."""
        program.launch(
            kernels.stiffness,
            *(slides, self._curve, self._factor, self._bodies.wear_disc, self._stiffness),
            slots=self._executor.slots_of(self._stiffness.shape[0]),
        )

    def softest(self, slides: Field) -> float:
        """Find the smallest stiffness of a cell in the step in an array [N/mm³]."""
        program = Program(self._executor, records=False)
        self.add_to(program, slides)
        program.run()
        values = self._stiffness.numpy()
        return float(np.min(values[values > 0.0]))
