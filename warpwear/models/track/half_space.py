"""One grid on the elastic–plastic half-space: a sphere, and a disc that moves or lies still under it."""

from typing import ClassVar

import warp as wp

from warpwear.contact.balance import Balance, residual_of
from warpwear.contact.half_space_passes import NO_CAP
from warpwear.contact.half_space_window import WindowedHalfSpace
from warpwear.engine.executor import Executor, Field
from warpwear.grid import FloatArray
from warpwear.history.recorder import Step, TrackLedger
from warpwear.kernels import sliding_half_space as passes
from warpwear.kernels.cells import MAXIMA, SUMS
from warpwear.laws.task import ContactTask
from warpwear.models.track.bodies import SlidingBodies

#: Rows of the table of partial sums.
OF_STEP = (*SUMS, "pressed_disc")


class ElasticSliding:
    """Contact and wear of one study with contact.law = "half-space" on one executor.

    A step finds the pressure p with which it ends (implicit Archard). During it the asperities, and p with
    them, move on by w cells. A disc cell is worn by its own p, a sphere cell by S p, the mean over w cells
    along x. On its way a disc cell meets S of what the sphere has lost, before the step as in it: the gap is
    made with S of the sphere's wear, and p adds (G + K_disc ΔL + K_sphere ΔL S²) p to it. With the wear at
    the middle of the way instead, waves of the sphere between w/2 and w, of which S is negative, would grow.
    Under a flat w is the whole line: its contact goes on beyond the domain, while under a sphere a mean over
    the line would smear the contact's outline, which does not move with the disc. Where the disc lies
    still w is one cell, so that both bodies are worn by p, and a step starts from the last one's pressure.

    disc, periodic, share: as of `local.SlidingContact`. Raises ValueError for the same discs. moves: whether
    the disc does.
    """

    STATE: ClassVar = {
        "state": SlidingBodies,
        "_of_rows": dict,
        "_half_space": WindowedHalfSpace,
        "_ledger": TrackLedger,
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
        share: float = 1.0,
        moves: bool = True,
    ) -> None:
        self.state = SlidingBodies.of(task, executor, disc)
        self.task = task
        self.periodic = periodic
        self._executor = executor
        self._share, self._moves = share, moves
        assert task.modulus is not None  # checked with the study
        wp.load_module(passes, device=executor.device)
        self.keeps_dents = task.keeps_dents
        self._half_space = WindowedHalfSpace(
            executor, modulus=task.modulus, boundary=task.boundary, hardness=task.hardness
        )
        #: The gap, a mean along x by rows, and that of whole lines.
        self._gap, self._means = executor.zeros(), executor.zeros(executor.grid.nx if moves else 1)
        self._sums, self._maxima = executor.partials(len(OF_STEP)), executor.partials(len(MAXIMA))
        rows = disc.shape[0]
        self._of_rows = {
            name: wp.zeros(rows, dtype=wp.float64, device=executor.device)
            for name in ("wear_disc", "pressed_disc")
        }
        self._ledger = TrackLedger(task, executor.grid, track_fraction=share)

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        Raises ConvergenceError when the contact cannot be solved, ValueError as `SlidingContact.step`.
        """
        executor, state, task = self._executor, self.state, self.task
        shift = state.row_of(shift, periodic=self.periodic)
        distance = self._ledger.row["distance"]
        of_sphere, of_disc = task.removals(distance, increment)
        removal_disc = self._share * of_disc
        window = self.cells_passing(increment)
        met = self._mean_along(state.wear_sphere, window)
        executor.launch(
            passes.gaps,
            inputs=[shift, met, state.wear_sphere, state.sphere, state.disc],
            outputs=[self._gap],
        )
        own = of_sphere if window == 1 else 0.0  # a mean over one cell is none
        contact = self._half_space.solve(
            self._gap,
            load=task.load,
            compliance=removal_disc + own,
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
        executor.launch(
            passes.remove,
            inputs=[
                cap,
                contact.approach,
                of_sphere,
                removal_disc,
                reference,
                shift,
                contact.pressure_field,
                self._mean_along(contact.pressure_field, window),
                contact.gradient_field,
            ],
            outputs=[*state.fields.values(), self._sums, self._maxima],
        )
        executor.launch(
            passes.totals,
            inputs=[shift, *(OF_STEP.index(name) for name in self._of_rows), self._sums],
            outputs=[*self._of_rows.values()],
        )
        total = dict(zip(OF_STEP, self._sums.numpy().sum(axis=1).tolist(), strict=True))
        total |= {name: float(rows.numpy().sum()) for name, rows in self._of_rows.items()}
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
        return min(max(round(self._share * increment / grid.cell), 1), grid.nx)

    def _mean_along(self, field: Field, window: int) -> Field:
        """S of a field, by rows, or one row for all; it lasts until the next."""
        if window == 1:
            return field
        if window < self._executor.grid.nx:
            self._executor.launch(passes.mean_passing, inputs=[window, field], outputs=[self._means])
            return self._means
        lines, every = self._means[:1], [(0, self._executor.vectors)]
        self._executor.launch(passes.mean_of_lines, inputs=[field], outputs=[lines], chunks=every)
        return lines
