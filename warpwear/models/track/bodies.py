"""The bodies of a contact that slides: a counter-body over a displaced disc, and what each has lost."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from warpwear.engine.executor import Executor, Field
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels.cells import PADDING
from warpwear.laws.task import ContactTask
from warpwear.models.unworn import gap_over


@dataclass
class SlidingBodies:
    """Holds fields [mm] on the executor's device: of nx × ny cells, and of the disc's rows × ny cells."""

    counter: Field  # height over the unworn apex, as worn
    disc: Field  # height over the mean plane, as worn
    wear_counter: Field
    wear_disc: Field
    plastic_disc: Field  # displaced for good where a cell was at the hardness; one row where none is kept
    reached: Field  # 1 where the counter-body was in contact; one row where its wear shows that
    #: First column that was ever touched, and the one after the last: beyond them all is as it was made.
    columns: tuple[int, int] = (0, 0)

    FIELDS: ClassVar = ("counter", "disc", "wear_counter", "wear_disc", "plastic_disc", "reached")
    STATE: ClassVar = {
        "columns": tuple,
        **dict.fromkeys(("counter", "wear_counter", "reached"), InFrame("counter", columns=True)),
        **dict.fromkeys(("disc", "wear_disc", "plastic_disc"), InFrame("disc", columns=True)),
    }

    @property
    def fields(self) -> dict[str, Field]:
        """All fields by name, in the order in which kernels take them."""
        return {name: getattr(self, name) for name in self.FIELDS}

    @classmethod
    def of(cls, task: ContactTask, executor: Executor, disc: FloatArray) -> Self:
        """Return unworn bodies of a task.

        disc: heights over the mean plane [mm], shape (rows ≥ nx, ny). Raises ValueError for one that is
        shorter than the grid or of another width.
        """
        grid, rows = executor.grid, disc.shape[0]
        if rows < grid.nx or disc.shape[1] != grid.ny:
            raise ValueError(f"a disc of {disc.shape} cells does not fit under a grid of {grid.shape}")
        wears = task.wear[0].wears and task.pieces is None
        return cls(
            gap_over(task.form, np.zeros(grid.shape), executor),  # over a smooth disc
            executor.field(disc.copy(), padding=-PADDING),
            executor.zeros(),
            executor.zeros(rows),
            executor.zeros(rows if task.keeps_dents else 1),
            executor.zeros(1 if wears else grid.nx),
        )

    def row_of(self, shift: int, *, periodic: bool) -> int:
        """Find the disc's row under the counter-body's first, displaced by `shift` rows.

        Raises ValueError where a disc that is not periodic would leave a part of the ball without one.
        """
        rows, nx = self.disc.shape[0], self.counter.shape[0]
        if periodic:
            return shift % rows
        if not 0 <= shift <= rows - nx:
            raise ValueError(f"a shift of {shift} rows leaves the disc of {rows} rows")
        return shift
