"""How many cells of the disc a part of a step may go over, by an estimate of the error that it makes."""

import math
from typing import ClassVar

from warpwear.laws.task import ContactTask

#: What a part of a step takes off the area of a contact, relative, over its length in contact lengths and the
#: real over the nominal area: of a smooth one 1.2 in a first pass, 2.6 after twenty, as losses add up.
OF_OUTLINE = 2.4
#: What each cell beyond the first of a part changes of the area of asperities below the hardness.
OF_ELASTIC_CELL = 0.025
#: Error of the area that the length of a part may make, relative.
LARGEST_ERROR = 0.02


class PartLength:
    """Keeps the estimate of a contact, whose cases are in docs/theory/limits.md.

    shortens: whether a mean over what passes shortens the contact.
    """

    STATE: ClassVar = {"_outline": float, "_asperities": float}

    def __init__(self, task: ContactTask, *, moves: bool, shortens: bool) -> None:
        self._task, self._moves, self._shortens = task, moves, shortens
        #: Relative error of the area by each cell of a part, and by each beyond the first, as of late.
        self._outline = self._asperities = 0.0
        self.forget()

    def forget(self) -> None:
        """Let the next contact begin as the first one does: the disc is another."""
        if self._moves and not self._task.form.is_flat and self._shortens:
            self._outline = math.inf

    def error(self, cells: int) -> float:
        """Estimate the error of the area by a part over cells, relative, as the last contact was."""
        return cells * self._outline + (cells - 1) * self._asperities if cells > 1 else 0.0

    def cells(self, left: int) -> int:
        """Return the cells of the next part of a step that has some left: about as many as of those after."""
        if self.error(left) <= LARGEST_ERROR:
            return left
        most = max(int((LARGEST_ERROR + self._asperities) / (self._outline + self._asperities)), 1)
        return -(-left // -(-left // most))

    def learn(self, *, along: float, bearing: float, elastic: float) -> None:
        """See what a contact says of the next.

        along: its length in cells. bearing: real over nominal area. elastic: part of it below the hardness.
        """
        if self._task.form.is_flat:  # which has no outline
            return
        if self._shortens:
            self._outline = OF_OUTLINE * bearing / along
        self._asperities = self._task.dust * OF_ELASTIC_CELL * elastic * max(1.0 - bearing, 0.0)
