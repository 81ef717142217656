"""What a study may add to the steps of a contact: each addition adds its part to a program, and books it."""

from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple

from warpwear.engine.executor import Arguments, Field
from warpwear.engine.program import Program
from warpwear.grid import FloatArray


class Place(NamedTuple):
    """Holds what the passes of a step work on, as kernels take it; on a half-space there is less of it."""

    slides: Field  # a `Slide` in an array
    steps: Arguments = None  # their history and flags
    springs: Arguments = None  # of the search for the load
    listed: tuple[Field, ...] = ()  # the list of tiles, and how many each row has
    cells: Arguments = None  # `CellProperties`
    bodies: Arguments = None
    tables: Arguments = None


class Attachment:
    """Adds an optional part to a step: a contact asks all that it has, in their order.

    A step is a search, the wear of both bodies where it has found a balance, and a row of the history.
    """

    #: Columns beside those touched that it may change.
    margin = 0
    #: Whether it may raise a surface, so that gaps close: its host remakes the bounds of tiles after it.
    raises = False
    #: Its own columns of the history, after those of every contact.
    columns: ClassVar[tuple[str, ...]] = ()
    #: Index of the first of them, as its host gives it.
    first_column = 0
    #: What it makes of cells, by the names of `CellProperties`.
    properties: Mapping[str, Field] = MappingProxyType({})

    def beside(self, columns: tuple[int, int]) -> tuple[int, int]:
        """Return the first column that the part may change beside these, and the one after the last."""
        return columns

    def at_beginning(self, program: Program) -> AbstractContextManager[None]:
        """Enclose what is done once in a step up to its wear, where it may stop a step on its way."""
        return nullcontext()

    def before_search(self, program: Program, place: Place) -> None:
        """Add to a program what comes before the search."""

    def before_wear(self, program: Program, place: Place) -> None:
        """Add to a program what comes between a balance and the wear by it."""

    def after_wear(self, program: Program, place: Place) -> None:
        """Add to a program what follows the wear."""

    def between(self, program: Program, place: Place) -> None:
        """Add to a program what comes between the wear and the row of the history, and may stop the step."""

    def at_end(self, program: Program) -> AbstractContextManager[None]:
        """Enclose the row of the history, and what follows it."""
        return nullcontext()

    def after_step(self, program: Program, place: Place) -> None:
        """Add to a program what follows the row of the history."""

    def drain(self) -> bool:
        """Take over what a program has left; tell whether it stopped on its way and is to be run again."""
        return False

    def end_steps(self, count: int) -> None:
        """Take note that a program has made so many steps."""

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter among the sums and maxima of steps what the columns of their history say of it."""


def give_columns(attachments: Iterable[Attachment], own: tuple[str, ...]) -> tuple[str, ...]:
    """Give attachments their columns of the history, behind a contact's own; return the names of all.

    Raises ValueError for two columns of one name.
    """
    names = [*own]
    for one in attachments:
        one.first_column = len(names)
        names += one.columns
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"columns of the history that two would write: {', '.join(twice)}")
    return tuple(names)
