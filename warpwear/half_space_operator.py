"""What a half-space solver asks of the operator that ties displacements to pressures."""

from typing import Protocol

from warpwear.execution import Field


class Operator(Protocol):
    """A symmetric operator on the fields of an executor, and an approximate inverse of it."""

    cells: int  # of the surface: what padding there is in the fields does not count
    shortest_response: float  # displacement under a pressure that alternates from cell to cell [mm/MPa]
    chunks: list[tuple[int, int]] | None  # ranges of slots for the threads, from 0 on; None: all

    @property
    def transforms(self) -> int:
        """Pairs of Fourier transforms done so far."""

    @property
    def rigid_mean(self) -> bool:
        """Whether a uniform pressure displaces nothing."""

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """What adds to the elastic response [mm/MPa]: to a cell's own pressure, and to means along x."""

    def respond(self, pressure: Field, displacement: Field) -> None:
        """Displacement [mm] under a pressure [MPa], compliances included."""

    def respond_elastically(self, pressure: Field, displacement: Field) -> None:
        """The same without compliances [mm]."""

    def invert(self, displacement: Field, pressure: Field) -> None:
        """About the pressure [MPa] of a displacement [mm]. May be in place."""
