"""One grid on the elastic–plastic half-space: a sphere, and a disc that moves or lies still under it."""

from typing import ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import Balance, residual_of
from warpwear.contact.half_space_passes import NO_CAP
from warpwear.contact.half_space_window import WindowedHalfSpace
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.kernels import wear_from_pressure
from warpwear.kernels.cells import MAXIMA, PressureSum, names_of
from warpwear.kernels.sliding import Bodies
from warpwear.kernels.wear_from_pressure import Increment
from warpwear.kernels.wear_loops import Layout
from warpwear.laws.task import ContactTask
from warpwear.models.track.bodies import SlidingBodies


class SlidingHalfSpace:
    """Contact and wear of one study with contact.law = "half-space" on one executor.

    A step finds the pressure p with which it ends (implicit Archard). During it the asperities, and p with
    them, move on by w cells. A disc cell is worn by its own p, a sphere cell by S p, the mean over w cells
    along x. On its way a disc cell meets S of what the sphere has lost, before the step as in it: the gap is
    made with S of the sphere's wear, and p adds (G + K_disc ΔL + K_sphere ΔL S²) p to it. With the wear at
    the middle of the way instead, waves of the sphere between w/2 and w, of which S is negative, would grow.
    Under a flat w is the whole line: its contact goes on beyond the domain, while under a sphere a mean over
    the line would smear the contact's outline, which does not move with the disc. Where the disc lies
    still w is one cell, so that both bodies are worn by p, and a step starts from the last one's pressure.

    disc, periodic, track_fraction, moves: as of `local.SlidingContact`. Raises ValueError for the same discs.
    """

    STATE: ClassVar = {
        "state": SlidingBodies,
        "_of_rows": dict,
        "_half_space": WindowedHalfSpace,
        "_ledger": Ledger,
    }
    #: Steps are made one by one, on a GPU too.
    in_blocks = False

    def __init__(
        self,
        task: ContactTask,
        disc: FloatArray,
        executor: Executor,
        *,
        periodic: bool = False,
        track_fraction: float = 1.0,
        moves: bool = True,
    ) -> None:
        self.state = SlidingBodies.of(task, executor, disc)
        self.task = task
        self.periodic = periodic
        self._executor = executor
        self._track_fraction, self._moves = track_fraction, moves
        assert task.modulus is not None  # checked with the study
        wp.load_module(wear_from_pressure, device=executor.device)
        self.keeps_dents = task.keeps_dents
        self._half_space = WindowedHalfSpace(
            executor, modulus=task.modulus, boundary=task.boundary, hardness=task.hardness
        )
        #: The gap, and a mean along x.
        self._gap, self._means = executor.zeros(), executor.zeros(executor.grid.nx if moves else 1)
        self._bodies = arguments(Bodies, **self.state.fields)
        rows: Field = wp.array(np.arange(executor.grid.nx, dtype=np.int32), device=executor.device)
        self._layout = arguments(
            Layout, vectors=executor.vectors, first_row=rows, first_column=wp.zeros_like(rows)
        )
        self._sums, self._maxima = executor.partials(len(PressureSum)), executor.partials(len(MAXIMA))
        #: Sums over the rows of the disc, of its fields as they are: increments added up would drift.
        self._of_rows = {name: np.zeros(disc.shape[0]) for name in ("wear_disc", "pressed_disc")}
        self._ledger = Ledger(task, executor.grid, track_fraction=track_fraction)

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        Raises ConvergenceError when the contact cannot be solved, ValueError as `SlidingContact.step`.
        """
        executor, state, task = self._executor, self.state, self.task
        shift = state.row_of(shift, periodic=self.periodic)
        distance = self._ledger.row["distance"]
        of_sphere, of_disc = task.removals(distance, increment)
        wear_per_pressure_disc = self._track_fraction * of_disc
        window = self.cells_passing(increment)
        met = self._mean_along(state.wear_sphere, window)
        executor.launch(wear_from_pressure.gaps, inputs=[shift, self._bodies, met], outputs=[self._gap])
        own = of_sphere if window == 1 else 0.0  # a mean over one cell is none
        contact = self._half_space.solve(
            self._gap,
            load=task.load,
            compliance=wear_per_pressure_disc + own,
            streak_compliance=of_sphere - own,
            streak_window=window,
        )
        if self._moves:
            # This pressure is no better a start: neither where it is, nor carried along with the disc.
            self._half_space.forget()
        pressure = contact.pressure.copy() if with_pressure else None
        # The scatter is summed about a value near the mean.
        reference = self._ledger.row["pressure_mean"]
        cap = min(task.hardness, NO_CAP)
        made = arguments(Increment, shift=shift, cap=cap, approach=contact.approach, reference=reference)
        made.wear_per_pressure_sphere, made.wear_per_pressure_disc = of_sphere, wear_per_pressure_disc
        passing = self._mean_along(contact.pressure_field, window)
        fields = [contact.pressure_field, passing, contact.gradient_field]
        executor.launch(
            wear_from_pressure.wear,
            inputs=[made, self._layout, *fields],
            outputs=[self._bodies, self._sums, self._maxima],
        )
        total = self._totals(shift)
        most = dict(zip(MAXIMA, self._maxima.numpy().max(axis=1).tolist(), strict=True))
        carried = total["pressure"] * executor.grid.cell_area
        residual = residual_of(carried, task.load, approach=contact.approach)
        balance = Balance(contact.approach, 0.0, cap, residual, evaluations=contact.transforms)
        step = self._ledger.enter(
            balance, increment, (of_sphere, of_disc), reference, total, most, pressure=pressure
        )
        state.columns = self._ledger.columns
        return step

    def cells_passing(self, increment: float) -> int:
        """Cells of the disc that pass over one of the sphere in an increment [mm]; under a flat the line."""
        grid = self._executor.grid
        if not self._moves:
            return 1
        if self.task.curvature == 0.0:
            return grid.nx
        return min(max(round(self._track_fraction * increment / grid.cell), 1), grid.nx)

    def _totals(self, shift: int) -> dict[str, float]:
        """Sums over all cells by the names of `PressureSum`; those of the disc are over all of its rows."""
        table = self._sums.numpy()
        total = dict(zip(names_of(PressureSum), table.sum(axis=1).tolist(), strict=True))
        nx = self._executor.grid.nx
        for name, rows in self._of_rows.items():
            under = (np.arange(nx) + shift) % rows.size
            rows[under] = table[PressureSum[name.upper()]].reshape(nx, -1).sum(axis=1)
            total[name] = float(rows.sum())
        return total

    def _mean_along(self, field: Field, window: int) -> Field:
        """S of a field, by rows, or one row for all; it lasts until the next."""
        if window == 1:
            return field
        if window < self._executor.grid.nx:
            kernel = wear_from_pressure.mean_passing
            self._executor.launch(kernel, inputs=[window, field], outputs=[self._means])
            return self._means
        lines, every = self._means[:1], [(0, self._executor.vectors)]
        kernel = wear_from_pressure.mean_of_lines
        self._executor.launch(kernel, inputs=[field], outputs=[lines], chunks=every)
        return lines
