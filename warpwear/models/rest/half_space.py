"""One grid on the elastic–plastic half-space: the sphere and every asperity of the disc deform together."""

from typing import ClassVar

import warp as wp

from warpwear.contact.balance import Balance, residual_of
from warpwear.contact.half_space_passes import NO_CAP
from warpwear.contact.half_space_window import WindowedHalfSpace
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.history.snapshot import Snapshot
from warpwear.kernels import wear_half_space as wear_by_pressure
from warpwear.kernels.cells import MAXIMA, SUMS
from warpwear.laws.task import ContactTask
from warpwear.models.model import Model
from warpwear.models.rest.bodies import State


class HalfSpaceModel(Model):
    """Contact and wear of one study with contact.law = "half-space" on one executor.

    A step finds the pressure with which it ends: the wear of the step, (K_s + K_d) ΔL p, adds to what the
    half-space yields (implicit Archard), so a step may be of any length. Every step starts from the
    last one's pressure.

    heights: of the disc over its mean plane [mm], shape (nx, ny). The caller may let go of the array.
    """

    STATE: ClassVar = {"state": State, "_half_space": WindowedHalfSpace, "_ledger": Ledger}

    def __init__(self, task: ContactTask, heights: FloatArray, executor: Executor) -> None:
        self.task = task
        self._executor = executor
        assert task.modulus is not None  # checked with the study
        wp.load_module(wear_by_pressure, device=executor.device)
        self._share_changes = not task.in_proportion
        self.state = State.of(executor, heights, task.wear, curvature=task.curvature)
        self.state.changing += ("share",) * self._share_changes
        self._half_space = WindowedHalfSpace(
            executor, modulus=task.modulus, boundary=task.boundary, hardness=task.hardness
        )
        self._sums, self._maxima = executor.partials(len(SUMS)), executor.partials(len(MAXIMA))
        self._ledger = Ledger(task, executor.grid)

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Solve the contact at the end of an increment [mm], and wear both bodies.

        Raises ConvergenceError when the contact cannot be solved.
        """
        executor, state, load = self._executor, self.state, self.task.load
        sphere, disc = self.task.removals(self._ledger.row["distance"], increment)
        contact = self._half_space.solve(state.gap, load=load, compliance=sphere + disc)
        pressure = contact.pressure.copy() if with_pressure else None
        # The scatter is summed about a value near the mean.
        reference = self._ledger.row["pressure_mean"]
        cap = min(self.task.hardness, NO_CAP)
        executor.launch(
            wear_by_pressure.remove,
            inputs=[
                cap,
                sphere,
                disc,
                reference,
                int(self._share_changes),
                contact.pressure_field,
                state.unworn,
            ],
            outputs=[state.share, state.gap, self._sums, self._maxima],
        )
        total = state.divide(dict(zip(SUMS, self._sums.numpy().sum(axis=1).tolist(), strict=True)))
        most = state.divide(dict(zip(MAXIMA, self._maxima.numpy().max(axis=1).tolist(), strict=True)))
        carried = total["pressure"] * executor.grid.cell_area
        residual = residual_of(carried, load, approach=contact.approach)
        balance = Balance(contact.approach, 0.0, cap, residual, evaluations=contact.transforms)
        return self._ledger.enter(
            balance, increment, (sphere, disc), reference, total, most, pressure=pressure
        )

    def worn(self) -> tuple[FloatArray, FloatArray]:
        """Depths worn off sphere and disc so far [mm], shape (nx, ny)."""
        return self.state.worn(self._executor)

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        sphere, disc = self.worn()
        gap = self._executor.to_numpy(self.state.gap)
        return Snapshot(distance, pressure=step.pressure, wear_sphere=sphere, wear_disc=disc, gap=gap)
