"""Wear of a rough disc on a coarse grid: the depth follows the bearing area curve, the volume Archard.

While only a fraction φ of the area bears, the pressure there is 1/φ times the mean, and the surface recedes
by dz = K p dL/φ(z): the volume per area, ∫ φ dz, is K p L as before. So a rough disc runs in, and ends deeper
than a smooth one by a constant. The idea, and a logistic function for the curve, are Varenberg's (Tribology
Letters 70, 2022, doi 10.1007/s11249-022-01602-6); the equations here follow from the balance of volumes.
"""

from typing import ClassVar

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.kernels import recession as kernels
from warpwear.kernels.contact import Law
from warpwear.kernels.sliding import Bodies
from warpwear.laws.bearing_curve import Logistic


class Recession:
    """What a logistic bearing curve adds to the steps of a disc that lies still.

    factor: of the sliding distance of the disc's cells, a field of one row or of all.
    """

    STATE: ClassVar = {"beyond": Field}

    def __init__(self, curve: Logistic, executor: Executor, bodies: Bodies, factor: Field) -> None:
        executor.load(kernels.recede)
        self._curve = arguments(kernels.Curve, middle=curve.middle, scale=curve.scale)
        self._executor, self._bodies, self._factor = executor, bodies, factor
        self.beyond = executor.zeros()  # by which the surface stands deeper than its mean worn depth [mm]
        self._stiffness = executor.zeros()
        self._bearing = executor.partials(1)

    def stiffness(self, compliance: float, wear_per_pressure_disc: float) -> Field:
        """Make 1/c of an implicit step.

        compliance: without the disc's wear; wear_per_pressure_disc: its K ΔL [mm³/N].
        """
        self._executor.launch(
            kernels.stiffness,
            inputs=[compliance, wear_per_pressure_disc, self._curve, self._factor, self._bodies.wear_disc],
            outputs=[self._stiffness],
        )
        return self._stiffness

    def cells_bearing(self, law: Law) -> float:
        """How many cells' area bears in a solved contact, before its wear: Σ φ over the cells in contact."""
        bodies = self._bodies
        self._executor.launch(
            kernels.borne,
            inputs=[law, self._curve, bodies.sphere, bodies.disc, bodies.wear_disc],
            outputs=[self._bearing],
        )
        return float(self._bearing.numpy().sum())

    def recede(self) -> None:
        """Lower the disc after the mean depth of a step was worn off it."""
        self._executor.launch(
            kernels.recede,
            inputs=[self._curve, self._bodies.wear_disc],
            outputs=[self._bodies.disc, self.beyond],
        )
