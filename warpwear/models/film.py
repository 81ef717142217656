"""The films of a contact's bodies: which cells are bare as a step begins, and what cap that leaves them."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.tiles import TileList
from warpwear.kernels.cells import LANES
from warpwear.kernels.contact import Law
from warpwear.kernels.running_in import film as kernels
from warpwear.kernels.running_in.film import Coat
from warpwear.laws.film import Film

#: What is kept of every cell of a body whose film forms anew.
KEPT = ("whole", "seen", "rubbed")


class BareCells:
    """Keeps track of the cells that wear has bared, of bodies one of which may move under the other.

    wear: of each body that carries a film, by name [mm]: of shape (nx, ny), or of more rows, displaced by
    `shift`. thickness: of the film, if not the film's own: of the wear given [mm].
    """

    STATE: ClassVar = {"healing": dict}

    def __init__(
        self, film: Film, executor: Executor, wear: Mapping[str, Field], *, thickness: float | None = None
    ) -> None:
        self._executor, self._film = executor, film
        self._thickness = film.thickness if thickness is None else thickness
        executor.load(kernels.look)
        self._sums = executor.partials(1)
        #: 1 where a cell was bare as the last step began, else 0.
        self.bare = executor.zeros()
        #: Cap of every cell over the hardness; None where it is the same for all.
        self.parts: Field | None = None
        if film.changes_caps:
            self.parts = executor.field(
                np.full(executor.grid.shape, film.part_filmed), padding=film.part_filmed
            )
        #: Of films that form anew: see `Coat`.
        self.healing: dict[str, Field] = {}
        if math.isfinite(film.regrowth):
            self.healing = {
                f"{name}_{body}": executor.zeros(field.shape[0])
                for body, field in wear.items()
                for name in KEPT
            }
        none = executor.zeros(0)
        self._coats = {
            body: arguments(
                Coat, wear=field, **{name: self.healing.get(f"{name}_{body}", none) for name in KEPT}
            )
            for body, field in wear.items()
        }

    @classmethod
    def of_bodies(
        cls, film: Film | None, executor: Executor, sphere: Field, disc: Field
    ) -> "BareCells | None":
        """Follow a sphere and a disc that wear apart [mm]; None without a film."""
        if film is None:
            return None
        wear = {"sphere": sphere, "disc": disc}
        return cls(film, executor, {body: wear[body] for body, on in zip(wear, film.on, strict=True) if on})

    @classmethod
    def of_both(
        cls, film: Film | None, executor: Executor, worn: Field, fractions: tuple[float, float]
    ) -> "BareCells | None":
        """Follow bodies that wear in one proportion; None without a film.

        worn: by both [mm]. fractions: of sphere and disc in it.
        """
        if film is None:
            return None
        least = min(part for part, on in zip(fractions, film.on, strict=True) if on)
        return cls(film, executor, {"both": worn}, thickness=film.thickness / least if least else math.inf)

    def look(self, distance: float, *, shift: int = 0, columns: tuple[int, int] | None = None) -> None:
        """See which cells are bare as a step begins at a sliding distance [mm].

        shift: rows by which the disc is displaced. columns: first that was ever touched and the one after
        the last; by default all.
        """
        first, end = self._vectors(columns)
        launch = self._executor.launch
        for number, (body, coat) in enumerate(self._coats.items()):
            rows = shift if body == "disc" else 0
            if self.healing:
                now = [rows, distance, self._film.regrowth]
                launch(kernels.heal, inputs=[*now, first, end, coat], outputs=[])
            inputs = [rows, self._thickness, first, end, number == 0, coat]
            launch(kernels.look, inputs=inputs, outputs=[self.bare])
        if self.parts is not None:
            caps = [self._film.part_filmed, self._film.part_bare]
            launch(kernels.parts, inputs=[*caps, first, end, self.bare], outputs=[self.parts])

    def rub(self, distance: float, *, shift: int = 0, columns: tuple[int, int] | None = None) -> None:
        """Note what a step that ends at a sliding distance [mm] has worn; other arguments as of `look`."""
        if not self.healing:
            return
        first, end = self._vectors(columns)
        for body, coat in self._coats.items():
            rows = shift if body == "disc" else 0
            self._executor.launch(kernels.rub, inputs=[rows, distance, first, end, coat], outputs=[])

    def under(self, pressure: Field, chunks: Any = None) -> float:
        """Count the bare cells under a pressure. chunks: of the rows that have one, by default all."""
        inputs = [pressure, self.bare]
        self._executor.launch(kernels.bare_under_pressure, inputs=inputs, outputs=[self._sums], chunks=chunks)
        end = chunks[-1][1] if chunks else self._executor.slots
        return float(self._sums.numpy()[0, :end].sum())

    def in_contact(self, law: Law, stiffness: Field, gap: Field, tiles: TileList) -> float:
        """Count the bare cells that a solved approach presses; arguments as of `Balancer.pressures`."""
        self._executor.launch(
            kernels.bare_in_contact,
            inputs=[law, stiffness, gap, self.bare],
            outputs=[self._sums],
            over=tiles,
        )
        return float(self._sums.numpy()[0].sum())

    def _vectors(self, columns: tuple[int, int] | None) -> tuple[int, int]:
        """First vector of a row, and the one after the last, that hold columns."""
        if columns is None:
            return 0, self._executor.vectors
        return columns[0] // LANES, -(-columns[1] // LANES)
