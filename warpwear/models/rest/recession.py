"""Wear of a rough disc on a coarse grid: the depth follows the bearing area curve, the volume Archard.

While only a share φ of the area bears, the pressure there is 1/φ times the mean, and the surface recedes by
dz = K p dL/φ(z): the volume per area, ∫ φ dz, is K p L as before. So a rough disc runs in, and ends deeper
than a smooth one by a constant. The idea, and a logistic function for the curve, are Varenberg's (Tribology
Letters 70, 2022, doi 10.1007/s11249-022-01602-6); the equations here follow from the balance of volumes.
"""

from typing import ClassVar

from warpwear.contact.balance import Balance
from warpwear.engine.executor import Executor, Field
from warpwear.kernels import recession as running_in
from warpwear.laws.bearing_curve import Logistic


class Recession:
    """What a logistic bearing curve adds to the steps of a model."""

    STATE: ClassVar = {"beyond": Field}

    def __init__(self, curve: Logistic, executor: Executor, distance_factor: Field) -> None:
        self._curve = curve
        self._executor = executor
        self._factor = distance_factor
        self.beyond = executor.zeros()  # by which the surface stands deeper than its mean worn depth [mm]
        self._stiffness = executor.zeros()
        self._share = executor.partials(1)

    def stiffness(self, compliance: float, removal_disc: float, wear_disc: Field) -> Field:
        """1/c of an implicit step. compliance: all but the disc's wear; removal_disc: its K ΔL [mm³/N]."""
        self._executor.launch(
            running_in.stiffness,
            inputs=[
                compliance,
                removal_disc,
                self._curve.middle,
                self._curve.scale,
                self._factor,
                wear_disc,
            ],
            outputs=[self._stiffness],
        )
        return self._stiffness

    def cells_bearing(self, balance: Balance, gap: Field, wear_disc: Field) -> float:
        """How many cells' area bears in a solved contact, before its wear: Σ φ over the cells in contact."""
        self._executor.launch(
            running_in.borne,
            inputs=[balance.base, balance.offset, self._curve.middle, self._curve.scale, gap, wear_disc],
            outputs=[self._share],
        )
        return float(self._share.numpy().sum())

    def recede(self, wear_disc: Field, gap: Field, unworn: Field) -> None:
        """Open the gap, and the one without wear, after the mean depth of a step was worn off the disc."""
        self._executor.launch(
            running_in.recede,
            inputs=[self._curve.middle, self._curve.scale, wear_disc],
            outputs=[gap, unworn, self.beyond],
        )
