"""A counter slides over a disc by whole cells: a track tells where it is at every step, and how far it slid.

A step covers up to `shift` cells of the track and is solved once, with the ball in their middle; the last
step of a pass is shorter where the shift does not divide the stroke, so that volumes stay exact. A track that
turns reverses at the end of each pass and covers the same cells the other way. Of an odd number of cells the
middle is rounded towards where the counter-body comes from: to and fro the places are as many on either side
of the stroke's middle. In steps of one cell each is passed twice a cycle and the ends once.

Were all passes solved at the same places, wear there would make others of the cells between them. So a track
may have each pass solved some cells further within its steps than the one before, round and round.

A representative track is a periodic disc shorter than the stroke: one lap is one pass. While it slides by a
cell, the ball slides by `cell / track_fraction` of the test. So is the track of a rotating disc, one lap a
revolution, whose length is rounded to whole steps: the rounding goes into the fraction too.

A disc at rest is a track of no cells, on which the counter-body stays where it is.
"""

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from warpwear.grid import FloatArray, Grid

#: Of a step, or one a step of an array of them.
Number = Any

#: Largest error of a length that should be a whole number of cells, relative.
WHOLE = 1.0e-6
#: Part of a way by which to move on so that no two places of it are near each other.
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


def is_whole(number: float) -> bool:
    """Tell whether a number of cells, steps or waves is 1 or more, and whole but for rounding."""
    return abs(number - round(number)) <= WHOLE * number and round(number) >= 1


def spread_over(cells: int) -> int:
    """Return by how many cells to move on from pass to pass so that few passes lie all over so many cells."""
    return next(n for n in range(round(GOLDEN * cells), 2 * cells) if math.gcd(n, cells) == 1) % cells


@dataclass(frozen=True)
class Track:
    """A track tells at every step of a study where the counter-body is on the disc.

    cells: rows of the disc slid over in a pass; 0 at rest. window: rows under the counter-body's domain.
    """

    cells: int
    shift: int  # cells that the counter-body moves on in a step
    cell: float  # [mm]
    window: int
    stroke: float  # slid in a pass of the test [mm]
    periodic: bool  # whether the disc's rows close on themselves
    reverses: bool  # whether the counter-body turns at the end of a pass
    spare: int = 0  # rows of the disc that a longer stroke has, half of them at either end
    move: int = 0  # cells of the disc by which each pass is solved further than the one before, within steps

    @classmethod
    def at_rest(cls, grid: Grid) -> Self:
        """Return the track of a disc that lies still under the counter-body's domain, a grid."""
        return cls(0, 0, grid.cell, window=grid.nx, stroke=0.0, periodic=False, reverses=False)

    @property
    def moves(self) -> bool:
        """Tell whether the disc moves under the counter-body."""
        return self.cells > 0

    @property
    def rows(self) -> int:
        """Return the number of rows of the disc."""
        return self.cells if self.periodic else self.cells + self.window + self.spare

    @property
    def track_fraction(self) -> float:
        """Return the part of the sliding distance that a disc of this length slides; 1: a whole stroke."""
        return self.cells * self.cell / self.stroke if self.periodic else 1.0

    @cached_property
    def steps_of_pass(self) -> int:
        """Return the number of steps in a pass; 0 at rest."""
        return -(-self.cells // self.shift) if self.moves else 0

    @property
    def passes_of_cycle(self) -> int:
        """Return the number of passes after which the counter-body is where it was, on the same way."""
        return 2 if self.reverses else 1

    @property
    def cycle(self) -> float:
        """Return what is slid in such a cycle of the test [mm]."""
        return self.passes_of_cycle * self.stroke

    @property
    def x(self) -> FloatArray:
        """Return the centres of the disc's rows [mm], shape (rows,), 0 = the middle of the stroke."""
        return (np.arange(self.rows, dtype=np.float64) - 0.5 * (self.rows - 1)) * self.cell

    def cells_of(self, step: int) -> int:
        """Return the number of cells that step number `step` covers."""
        return self._covered(step)[1]

    def row(self, step: Number, done: int = 0, cells: int | None = None) -> Number:
        """Return the disc's row under the first row of the ball at step number `step`, 0 ≤ row < rows.

        done, cells: of the part of the step that begins after `done` of its cells and covers `cells` of them.
        """
        first = self._first_row(step, done, cells)
        return first % self.rows if self.periodic else first

    def place(self, step: int) -> float:
        """Return the place of the counter-body's apex at step number `step`, on the scale of `x` [mm]."""
        return (self._first_row(step) + 0.5 * (self.window - self.rows)) * self.cell

    def beneath(self, disc: FloatArray, row: int) -> FloatArray:
        """Return the part of a field of the disc that lies under a ball whose first row is on `row`.

        disc: shape (rows, ny). The part has the shape (window, ny), and is a view unless it wraps round.
        """
        if row + self.window <= self.rows:
            return disc[row : row + self.window]
        return np.asarray(disc[np.arange(row, row + self.window) % self.rows])

    def _first_row(self, step: Number, done: int = 0, cells: int | None = None) -> Number:
        """Return what `row` does, of a periodic disc before it is wrapped."""
        start, covered, back = self._covered(step)
        ahead = done + (covered if cells is None else cells) // 2
        if self.move:
            ahead = (ahead + (1 - 2 * back) * self.move * (step // self.steps_of_pass)) % covered
        middle = start + ahead + back * (covered - 2 * ahead)
        return middle - self.window // 2 if self.periodic else middle + self.spare // 2

    def _covered(self, step: Number) -> tuple[Number, Number, Number]:
        """Return the first cell of the pass that a step covers, their number, and 1 where it goes back."""
        last = self.steps_of_pass - 1
        if last < 0:
            return 0 * step, 0 * step, 0 * step
        number, segment = divmod(step, last + 1)
        back = number % 2 * self.reverses
        segment += back * (last - 2 * segment)
        start = segment * self.shift
        return start, self.shift - (segment == last) * ((last + 1) * self.shift - self.cells), back

    def increments(self, distance: float, *, cycle: int = 0) -> Iterator[tuple[float, float]]:
        """Yield the increment of every step and the distance at its end [mm].

        distance: slid in all [mm], where the last step is cut; 0 is one increment of 0, a static contact.
        cycle: number of the one to begin with, from 0.
        """
        if distance == 0.0:
            yield 0.0, 0.0
            return
        per_cell = self.stroke / self.cells
        done = cycle * self.cycle
        for step in itertools.count(cycle * self.passes_of_cycle * self.steps_of_pass):
            start, cells, back = self._covered(step)
            slid = self.cells - start if back else start + cells
            # Counted from the start, not added up: passes end where they should.
            end = (step // self.steps_of_pass + slid / self.cells) * self.stroke
            increment = cells * per_cell
            if end >= distance - WHOLE * increment:
                left = distance - done
                yield (increment if abs(left - increment) <= WHOLE * increment else left), distance
                return
            yield increment, end
            done = end

    def steps(self, distance: float) -> float:
        """Return the number of steps, about, that a distance [mm] takes."""
        return math.ceil(distance / self.stroke * self.steps_of_pass)


class Leg(NamedTuple):
    """Blocks in a row that slide over one track have these distances at their start and end [mm]."""

    track: Track
    start: float
    end: float

    @property
    def length(self) -> float:
        """Return what is slid in it [mm]."""
        return self.end - self.start

    def steps(self, cycle: int = 0) -> Iterator[tuple[float, float]]:
        """Yield the increment of each step from a cycle on, and the test's distance at its end [mm]."""
        for increment, slid in self.track.increments(self.length, cycle=cycle):
            yield increment, self.end if slid == self.length else self.start + slid


def increments(
    plan: tuple[float, float, float], distance: float, stops: Iterable[float] = ()
) -> Iterator[tuple[float, float]]:
    """Yield increments and the distances at their ends [mm], which meet every stop and the last exactly.

    plan: first increment [mm], growth, largest increment [mm]. stops: distances [mm]; those beyond the
    distance are ignored. A step cut short by a stop does not change the planned size of those after it. A
    distance of 0 is one increment of 0: a static contact.
    """
    if distance == 0.0:
        yield 0.0, 0.0
        return
    planned, growth, largest = plan
    done = 0.0
    for stop in sorted({s for s in stops if 0.0 < s < distance} | {distance}):
        while done < stop:
            left = stop - done
            # A remainder too small to be a step of its own is rounding.
            if planned >= left - 1.0e-6 * planned:
                same = abs(left - planned) <= 1.0e-6 * planned
                yield planned if same else left, stop
                done = stop
            else:
                done += planned
                yield planned, done
            planned = min(planned * growth, largest)
