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
from warpwear.kernels.cells import CellProperties
from warpwear.kernels.wear_from_pressure import Coat, Films
from warpwear.laws.archard import BODIES
from warpwear.laws.film import Film
from warpwear.laws.task import ContactTask
from warpwear.models.attachment import Attachment, Place

#: What is kept of every cell of a body whose film forms anew.
KEPT = ("whole", "seen", "rubbed")
#: Whose film of a contact it is; that of bodies which wear in one proportion does not move, as the ball's.
AS = {"counter": "counter", "disc": "disc", "both": "counter"}


class BareCells(Attachment):
    """Keeps track of the cells that wear has bared, of bodies one of which may move under the other.

    wear: of each body that carries a film, by name [mm]: of shape (nx, ny), or of more rows, displaced by
    `shift`. shears: whether cells wear by their shear. thickness: of the film, if not the film's own: of the
    wear given [mm].
    """

    STATE: ClassVar = {
        "healing": {"counter": InFrame("counter"), "disc": InFrame("disc"), "both": InFrame("contact")}
    }

    def __init__(
        self,
        film: Film,
        executor: Executor,
        wear: Mapping[str, Field],
        *,
        shears: bool = False,
        thickness: float | None = None,
    ) -> None:
        heals = math.isfinite(film.regrowth)
        #: 1 where a cell was bare as the last step began, else 0.
        self.bare = executor.zeros()
        self.properties = {"material": self.bare}
        filmed = {"cap_ratio": film.cap_ratio_filmed} if film.changes_caps else {}
        filmed |= {"shear_ratio": film.shear_ratio} if shears else {}
        for name, ratio in filmed.items():
            self.properties[name] = executor.field(np.full(executor.grid.shape, ratio), padding=ratio)
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
            cap_filmed=film.cap_ratio_filmed,
            cap_bare=film.cap_ratio_bare,
            shear_filmed=film.shear_ratio,
            cells=arguments(CellProperties, **self.properties),
        )
        for body, field in wear.items():
            setattr(self.films, AS[body], arguments(Coat, wear=field, **self.healing[body]))
        self._heals = heals

    @classmethod
    def of_bodies(
        cls, task: ContactTask, executor: Executor, counter: Field, disc: Field
    ) -> "BareCells | None":
        """Follow a ball and a disc that wear apart [mm]; None without a film."""
        if task.film is None:
            return None
        wear = zip(BODIES, (counter, disc), task.film.on, strict=True)
        coated = {body: field for body, field, on in wear if on}
        return cls(task.film, executor, coated, shears=task.shears)

    @classmethod
    def of_both(cls, task: ContactTask, executor: Executor, worn: Field) -> "BareCells | None":
        """Follow bodies that wear in one proportion, by both [mm]; None without a film."""
        film = task.film
        if film is None:
            return None
        least = min(part for part, on in zip(task.wear_fractions, film.on, strict=True) if on)
        return cls(film, executor, {"both": worn}, thickness=film.thickness / least if least else math.inf)

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
