"""Films of a contact's bodies say which cells are bare as a step begins, and what cap that leaves them."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels import wear_from_pressure as kernels
from warpwear.kernels.wear_from_pressure import Coat, Films
from warpwear.laws.film import Film
from warpwear.models.attachment import Attachment, Place

#: What is kept of every cell of a body whose film forms anew.
KEPT = ("whole", "seen", "rubbed")
#: Whose film of a contact it is; that of bodies which wear in one proportion does not move, as the ball's.
AS = {"counter": "counter", "disc": "disc", "both": "counter"}


class BareCells(Attachment):
    """Keeps track of the cells that wear has bared, of bodies one of which may move under the other.

    wear: of each body that carries a film, by name [mm]: of shape (nx, ny), or of more rows, displaced by
    `shift`. thickness: of the film, if not the film's own: of the wear given [mm].
    """

    STATE: ClassVar = {
        "healing": {"counter": InFrame("counter"), "disc": InFrame("disc"), "both": InFrame("contact")}
    }
    SCRATCH: ClassVar = ("bare", "parts", "films")

    def __init__(
        self, film: Film, executor: Executor, wear: Mapping[str, Field], *, thickness: float | None = None
    ) -> None:
        heals = math.isfinite(film.regrowth)
        #: 1 where a cell was bare as the last step began, else 0.
        self.bare = executor.zeros()
        #: Cap of every cell over the hardness; None where it is the same for all.
        self.parts: Field | None = None
        if film.changes_caps:
            self.parts = executor.field(
                np.full(executor.grid.shape, film.part_filmed), padding=film.part_filmed
            )
        #: Of films that form anew: see `Coat`.
        self.healing: dict[str, dict[str, Field]] = {
            body: {name: executor.zeros(field.shape[0] if heals else 0) for name in KEPT}
            for body, field in wear.items()
        }
        #: Both films, as kernels take them.
        self.films = arguments(
            Films,
            thickness=film.thickness if thickness is None else thickness,
            regrowth=film.regrowth,
            cap_filmed=film.part_filmed,
            cap_bare=film.part_bare,
            bare=self.bare,
            parts=executor.zeros(0) if self.parts is None else self.parts,
        )
        for body, field in wear.items():
            setattr(self.films, AS[body], arguments(Coat, wear=field, **self.healing[body]))
        self._heals = heals

    @classmethod
    def of_bodies(
        cls, film: Film | None, executor: Executor, counter: Field, disc: Field
    ) -> "BareCells | None":
        """Follow a ball and a disc that wear apart [mm]; None without a film."""
        if film is None:
            return None
        wear = {"counter": counter, "disc": disc}
        return cls(film, executor, {body: wear[body] for body, on in zip(wear, film.on, strict=True) if on})

    @classmethod
    def of_both(
        cls, film: Film | None, executor: Executor, worn: Field, fractions: tuple[float, float]
    ) -> "BareCells | None":
        """Follow bodies that wear in one proportion; None without a film.

        worn: by both [mm]. fractions: of counter-body and disc in it.
        """
        if film is None:
            return None
        least = min(part for part, on in zip(fractions, film.on, strict=True) if on)
        return cls(film, executor, {"both": worn}, thickness=film.thickness / least if least else math.inf)

    def of_cells(self) -> Mapping[str, Field]:
        """Give which cells are bare, and their caps where these differ."""
        return {"bare": self.bare} | ({} if self.parts is None else {"parts": self.parts})

    def before_search(self, program: Program, place: Place) -> None:
        """Add a look at which cells are bare as a step begins."""
        program.launch(kernels.look, place.slides, self.films)

    def after_step(self, program: Program, place: Place) -> None:
        """Add a note of what the step has worn."""
        if self._heals:
            program.launch(kernels.rub, place.slides, self.films)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter the bare cells in contact."""
        total["bare"] = columns["bare"]

    def add_under(self, program: Program, slides: Field, pressure: Field, sums: Field) -> None:
        """Add to a program that it counts the bare cells under a pressure, in the first line of `sums`."""
        program.launch(kernels.bare_under_pressure, slides, self.films, pressure, sums, slots=sums.shape[1])
