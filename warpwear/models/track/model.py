"""A ball that slides over a track: one contact, displaced step by step along the way of `track.Track`."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from warpwear.engine import state
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray
from warpwear.history.pieces import PieceBook
from warpwear.history.recorder import Step
from warpwear.history.snapshot import Snapshot, lowered
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.task import ContactTask
from warpwear.laws.track import Track
from warpwear.models.model import Model
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import LONGEST, SlidingContact
from warpwear.models.track.starts import Way

#: Fields of the disc's size at the peak of a run: heights as read and as worn, wear, room to work.
DISC_FIELDS = 4.0
#: Rows of the disc that are compared at a time.
ROWS = 1024


class SweptModel(Model):
    """Contact and wear on one executor, of a disc that moves under the counter-body or lies still.

    heights: of the track over its mean plane [mm], shape (track.rows, ny). The caller may let go of it.
    bearing_curve: of a roughness that the grid does not resolve, by which a disc that lies still runs in.
    """

    #: Interrupts and checkpoints wait for the end of a block.
    longest_block = LONGEST
    STATE: ClassVar = {"contact": SlidingContact, "_done": int}

    def __init__(
        self,
        task: ContactTask,
        track: Track,
        heights: FloatArray,
        executor: Executor,
        *,
        bearing_curve: Logistic | None = None,
    ) -> None:
        self._track, self._executor = track, executor
        options: dict[str, Any] = {"periodic": track.periodic, "moves": track.moves}
        options["track_fraction"] = track.track_fraction
        self.contact: SlidingHalfSpace | SlidingContact
        if task.half_space:
            options["places"] = track.passes_of_cycle * track.cells
            self.contact = SlidingHalfSpace(task, heights, executor, **options)
        else:
            self.contact = SlidingContact(task, heights, executor, bearing_curve=bearing_curve, **options)
        self._done = self._row = 0
        self._middle = track.place(0)  # of the counter-body, before it moves [mm]

    @property
    def pieces(self) -> PieceBook | None:
        """Return the book of the pieces that have left; None where wear leaves at once."""
        return self.contact.features.value_of("book")

    @property
    def in_blocks(self) -> bool:
        """Whether the device makes the next steps by itself."""
        return self.contact.in_blocks

    def switch_track(self, before: Track) -> None:
        """Begin with the first step of this track, on a disc that has slid over another one before."""
        self.contact.ledger.switch_stroke(before.track_fraction)
        self._done = 0
        if isinstance(self.contact, SlidingHalfSpace):
            self.contact.forget_way()

    def go_on(self, track: Track, cycle: int) -> None:
        """Go on over the same disc in the steps of another track, from the first of a cycle."""
        self._track, self._done = track, cycle * track.passes_of_cycle * track.steps_of_pass

    def switch_circle(self, booked: Mapping[str, float]) -> dict[str, float]:
        """Begin with the first step on another circle of the disc, see `Circles` of `runs/loop.py`."""
        self.contact.forget()
        self._done = 0
        return self.contact.ledger.switch_circle(booked)

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Solve the contact, slide on by the increment [mm] and wear both bodies."""
        contact = self.contact
        if not isinstance(contact, SlidingHalfSpace) or not self._track.moves:
            if isinstance(contact, SlidingHalfSpace):
                contact.certified = self.certified
            return self._placed(contact.step(self._go_to(), increment, with_pressure=with_pressure))
        length = contact.length
        if self.measures:
            if length.is_due and self.divides:
                self._measure(contact)
            if length.begins:
                length.keep(*state.save(self, whole=True))
        contact.certified, contact.stands_for = self.certified, self.stands_for
        contact.learns = self.measures
        cells, track = self._track.cells_of(self._done), self._track
        steps = track.passes_of_cycle * track.steps_of_pass
        left = (steps - self._done % steps) / steps * self.stands_for * track.cycle
        way = Way(self._done % steps // track.steps_of_pass, contact.ledger.row["distance"] + left)
        step = contact.slide(self._go_to, cells, increment, way=way, with_pressure=with_pressure)
        if self.measures:
            alone = cells if self.stands_for == 1 else None
            length.note(increment / self.stands_for, self.turned, step.row["area_contact"], alone)
        return self._placed(step)

    def _measure(self, contact: SlidingHalfSpace) -> None:
        """Make steps again, from the state that was kept before them, in parts twice as long.

        Each stands for itself: what their length does shows less in wear of many cycles at once. Where one
        did not, they are made again in parts as long, too.
        """
        length, now, contact.certified = contact.length, state.save(self, whole=True), False
        arrays, numbers, slid, area = length.kept
        before, areas = (self.stands_for, self.turned, self._row), [] if area is None else [area]
        for cells in (length.of_part, 2 * length.of_part)[len(areas) :]:
            length.trial = cells
            state.restore(self, arrays, numbers)
            areas.append(self._replay(contact, slid, cells))
        length.trial = None
        self.stands_for, self.turned, self._row = before
        state.restore(self, *now)
        if length.judge(*areas, shift=self._track.shift, cell_area=self._executor.grid.cell_area):
            contact.forget_laps()

    def _replay(self, contact: SlidingHalfSpace, slid: list[tuple[float, int]], longest: int) -> float:
        """Make steps again: increments of a cycle alone [mm], rows turned by. Return areas × cells [mm²]."""
        total, contact.stands_for = 0.0, 1
        while slid:
            (increment, self.turned), *slid = slid
            first, cells = self._done, self._track.cells_of(self._done)
            ends = (first + 1) % self._track.steps_of_pass == 0
            if cells < longest and not ends and slid and slid[0][1] == self.turned:
                # a part goes over two steps
                increment += slid.pop(0)[0]
                cells += self._track.cells_of(first + 1)
            total += cells * contact.slide(self._go_to, cells, increment).row["area_contact"]
            self._done += 1 + (cells > self._track.cells_of(first))
        return total

    def _go_to(self, done: int = 0, cells: int | None = None) -> int:
        """Return the disc's row under the first of the counter-body, in the next step or in a part of it."""
        self._row = self._row_of(self._done, done, cells)
        return self._row

    def _row_of(self, step: Any, done: int = 0, cells: int | None = None) -> Any:
        """Return what `Track.row` does, on a disc that is turned."""
        row = self._track.row(step, done, cells)
        return (row + self.turned) % self._track.rows if self.turned else row

    def worn_depths(self) -> tuple[FloatArray, FloatArray]:
        """Return the depths worn off counter-body and disc [mm], the disc's of the whole track."""
        bodies, to_numpy = self.contact.state, self._executor.to_numpy
        return to_numpy(bodies.wear_counter), to_numpy(bodies.wear_disc)

    def replay(self, increments: Sequence[float], then: float | None) -> tuple[int, Iterator[Step]]:
        """Make steps on the device, before the first of them is seen."""
        assert isinstance(self.contact, SlidingContact)  # no other is `in_blocks`
        rows = self._row_of(self._done + np.arange(len(increments)))
        count, steps = self.contact.replay(rows, increments)
        return count, map(self._placed, steps)

    def check(self) -> None:
        """Raise ConvergenceError where the last replay ended at a step without a balance."""
        assert isinstance(self.contact, SlidingContact)
        self.contact.check()

    def below_bounds(self) -> float:
        """Ask the tiles of a contact on springs, see `Model.below_bounds`."""
        return self.contact.tiles.below_bounds() if isinstance(self.contact, SlidingContact) else 0.0

    def _placed(self, step: Step) -> Step:
        if not self._track.moves:
            step.row["position"] = self._middle
            self._done += 1
            return step
        track, turned = self._track, self.turned * self._track.cell
        length = track.rows * track.cell
        place = track.place(self._done)
        # Of a closed track, which alone is turned, all places are within it.
        step.row["position"] = (place + turned + 0.5 * length) % length - 0.5 * length if turned else place
        self._done += 1
        return step

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """Return the fields after the last step, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        bodies, to_numpy = self.contact.state, self._executor.to_numpy
        row = self._row
        disc = to_numpy(bodies.disc)
        names = "wear_counter", "wear_disc", *(["plastic_disc"] if self.contact.task.keeps_dents else [])
        fields = {name: to_numpy(getattr(bodies, name)) for name in names}
        fields["gap"] = to_numpy(bodies.counter) - self._track.beneath(disc, row)
        fields |= {"pressure": step.pressure} | self.contact.features.fields(step.pressure)
        return Snapshot.of(distance, fields, row=row if self._track.moves else None)

    def off_heights(self, snapshot: Snapshot, unworn: FloatArray) -> float:
        """Compare the disc of a track with what a snapshot says of it, see `Model.off_heights`."""
        if snapshot.row is None:
            return 0.0
        disc, worn, own = self._executor.to_numpy(self.contact.state.disc), snapshot.wear_disc, snapshot.own
        parts = (slice(first, first + ROWS) for first in range(0, disc.shape[0], ROWS))  # it may be long
        return max(float(np.abs(unworn[p] - worn[p] - lowered(own, p) - disc[p]).max()) for p in parts)
