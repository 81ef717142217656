"""A run asks of a model steps along a plan, snapshots of them, and a state to go on from."""

import itertools
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar

from warpwear.grid import FloatArray
from warpwear.history.pieces import PieceBook
from warpwear.history.recorder import Step
from warpwear.history.recorder_patches import PatchBook
from warpwear.history.snapshot import Snapshot
from warpwear.laws.track import Track


class Model(ABC):
    """Computes contact and wear of one task on one executor."""

    #: Names and types of what its steps change, see `warpwear.engine.state`.
    STATE: ClassVar[Mapping[str, Any]]
    #: Steps that the state is ahead of the last one given: of a block that was made in one go.
    steps_in_flight = 0
    #: Steps of a block at most.
    longest_block = 1
    #: Whether the next step is to be certified, where its law has a certificate.
    certified = False
    #: Cycles of a track that the next steps stand for, each: their increments are as many times as long.
    stands_for = 1
    #: Whether steps are learnt from, and whether the next may be divided otherwise than the last.
    measures = divides = True
    #: Rows of a closed track by which they begin elsewhere.
    turned = 0

    #: Book of its patches; None where it has none.
    book: PatchBook | None = None

    @property
    def pieces(self) -> PieceBook | None:
        """Return the book of the pieces in which its bodies have worn; None where wear leaves at once."""
        return None

    @property
    def in_blocks(self) -> bool:
        """Tell whether the device makes the next steps by itself, unless one is asked for its pressure."""
        return False

    @abstractmethod
    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Solve the contact, slide by the increment [mm] and wear both bodies.

        with_pressure: whether the step is given with its pressure. then: the next increment [mm], where it is
        known: a model may look ahead. Raises ConvergenceError when the contact cannot be solved.
        """

    @abstractmethod
    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """Return the fields after the last step, which was asked for its pressure, at its distance [mm]."""

    def switch_track(self, before: Track) -> None:
        """Begin with the first step of this track, on a disc that has slid over another one before."""
        self.turned = 0

    def replay(self, increments: Sequence[float], then: float | None) -> tuple[int, Iterator[Step]]:
        """Make the next steps on the device, as many as it can in one go; return their number, and them.

        then: the increment after them [mm], where it is known. A model that is never `in_blocks` makes one.
        """
        following = increments[1] if len(increments) > 1 else then
        return 1, iter([self.advance(increments[0], then=following)])

    def check(self) -> None:  # noqa: B027 - one step is looked at as it is made
        """Raise ConvergenceError where the last replay ended at a step without a balance."""

    def below_bounds(self) -> float:
        """Return by how much a gap lies below the bound of its tile, at most [mm]; more than 0 is wrong."""
        return 0.0

    def off_heights(self, snapshot: Snapshot, unworn: FloatArray) -> float:
        """Return by how much the disc is off the heights that a snapshot has of it, at most [mm].

        unworn: its heights before any wear [mm]. Those at rest are read from the gap.
        """
        return 0.0

    def _block(self, increments: Sequence[float], then: float | None) -> Iterator[Step]:
        """Yield the steps of a block, which is made in one go or in a few."""
        while increments:
            count, steps = self.replay(increments, then)
            for number, step in enumerate(steps):
                self.steps_in_flight = count - number - 1
                yield step
            self.check()
            increments = increments[count:]

    def steps(self, plan: Iterable[tuple[float, bool] | tuple[float, bool, bool]]) -> Iterator[Step]:
        """Yield a step for each increment [mm] of the plan, with its pressure where that is asked for.

        A third word says whether to certify the step.
        """
        block: list[float] = []
        end: list[None] = [None]
        in_blocks = self.in_blocks
        for this, following in itertools.pairwise(itertools.chain(plan, end)):
            assert this is not None
            increment, with_pressure, *certified = this
            self.certified = any(certified)
            then = following[0] if following else None
            if with_pressure or not in_blocks:
                yield self.advance(increment, with_pressure=with_pressure, then=then)
                continue
            block.append(increment)
            if following is None or following[1] or len(block) == self.longest_block:
                yield from self._block(block, then)
                block = []
