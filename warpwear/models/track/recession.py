"""Wear of a rough disc on a coarse grid: the depth follows the bearing area curve, the volume Archard.

While only a fraction φ of the area bears, the pressure there is 1/φ times the mean, and the surface recedes
by dz = K p dL/φ(z): the volume per area, ∫ φ dz, is K p L as before. So a rough disc runs in, and ends deeper
than a smooth one by a constant. The idea, and a logistic function for the curve, are Varenberg's (Tribology
Letters 70, 2022, doi 10.1007/s11249-022-01602-6); the equations here follow from the balance of volumes.
"""

from typing import ClassVar

from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.kernels.running_in import recession as kernels
from warpwear.kernels.sliding import Bodies
from warpwear.laws.bearing_curve import Logistic


class Recession:
    """What a logistic bearing curve adds to the steps of a disc that lies still."""

    STATE: ClassVar = {"beyond": Field}

    def __init__(self, curve: Logistic, executor: Executor, bodies: Bodies) -> None:
        #: For kernels.
        self.curve: Arguments = arguments(kernels.Curve, middle=curve.middle, scale=curve.scale)
        self._bodies = bodies
        self.beyond = executor.zeros()  # by which the surface stands deeper than its mean worn depth [mm]

    def say_bearing(self, program: Program, laws: Field, sums: Field) -> None:
        """Add to a program how many cells' area bears in a solved contact: Σ φ over the cells in contact."""
        bodies = self._bodies
        program.launch(kernels.borne, laws, self.curve, bodies.sphere, bodies.disc, bodies.wear_disc, sums)

    def say_recede(self, program: Program) -> None:
        """Add to a program that the disc recedes, after the mean depth of a step was worn off it."""
        bodies = self._bodies
        program.launch(kernels.recede, self.curve, bodies.wear_disc, bodies.disc, self.beyond)
