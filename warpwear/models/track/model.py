"""A sphere that slides over a track: one contact, displaced step by step along the way of `track.Track`."""

from collections.abc import Iterable, Iterator
from typing import ClassVar

from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray
from warpwear.history.recorder import Step
from warpwear.history.snapshot import Snapshot
from warpwear.laws.task import ContactTask
from warpwear.laws.track import Track
from warpwear.models.track.half_space import ElasticSliding
from warpwear.models.track.local import SlidingContact
from warpwear.models.track.on_gpu import LONGEST_BLOCK

#: Fields of the disc's size at the peak of a run: heights as read and as worn, wear, room to work.
DISC_FIELDS = 4.0


class SweptModel:
    """Contact and wear of one swept study on one executor.

    heights: of the track over its mean plane [mm], shape (track.rows, ny). The caller may let go of it.
    """

    STATE: ClassVar = {"contact": SlidingContact, "_done": int}

    def __init__(self, task: ContactTask, track: Track, heights: FloatArray, executor: Executor) -> None:
        self._track, self._executor = track, executor
        law = ElasticSliding if task.half_space else SlidingContact
        self.contact = law(task, heights, executor, periodic=track.periodic, share=track.share)
        self._keeps = self.contact.keeps_dents
        self._done = 0
        #: Steps that the state is ahead of the last one given, in a block.
        self.ahead = 0

    def steps(self, plan: Iterable[tuple[float, bool]]) -> Iterator[Step]:
        """One step for each increment [mm] of the plan, with its pressure where that is asked for.

        On a GPU steps whose pressure nobody asks for are made in blocks, before the first of them is seen.
        """
        block: list[float] = []
        for increment, with_pressure in plan:
            if self.contact.in_blocks and not with_pressure:
                block.append(increment)
                if len(block) < LONGEST_BLOCK:
                    continue
            yield from self._block(block)
            block = []
            if with_pressure or not self.contact.in_blocks:
                row = self._track.row(self._done)
                yield self._given(self.contact.step(row, increment, with_pressure=with_pressure))
        yield from self._block(block)

    def _block(self, increments: list[float]) -> Iterator[Step]:
        """Steps made on the device in one go."""
        if not increments:
            return
        assert isinstance(self.contact, SlidingContact)  # no other is `in_blocks`
        first = self._done
        rows = [self._track.row(first + i) for i in range(len(increments))]
        steps = self.contact.steps(rows, increments)
        self.ahead = len(increments)
        for step in steps:
            self.ahead -= 1
            yield self._given(step)

    def _given(self, step: Step) -> Step:
        step.row["position"] = self._track.place(self._done)
        self._done += 1
        return step

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        state, to_numpy = self.contact.state, self._executor.to_numpy
        row = self._track.row(self._done - 1)
        disc = to_numpy(state.disc)
        return Snapshot(
            distance,
            pressure=step.pressure,
            wear_sphere=to_numpy(state.wear_sphere),
            wear_disc=to_numpy(state.wear_disc),
            gap=to_numpy(state.sphere) - self._track.beneath(disc, row),
            plastic_disc=to_numpy(state.plastic_disc) if self._keeps else None,
            row=row,
        )
