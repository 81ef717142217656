"""A run asks of a model steps along a plan, snapshots of them, and a state to go on from."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar

from warpwear.grid import FloatArray
from warpwear.history.pieces import PieceBook
from warpwear.history.recorder import Step, StepColumns
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

    def replay(
        self, increments: Sequence[float], then: float | None
    ) -> tuple[int, Iterator[Step | StepColumns]]:
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

    def _block(self, increments: Sequence[float], then: float | None) -> Iterator[Step | StepColumns]:
        """Yield the steps of a block, which is made in one go or in a few."""
        while increments:
            count, steps = self.replay(increments, then)
            self.steps_in_flight = count
            for made in steps:
                self.steps_in_flight -= len(made) if isinstance(made, StepColumns) else 1
                yield made
            self.check()
            increments = increments[count:]

    def steps(self, plan: Iterable[tuple[float, bool] | tuple[float, bool, bool]]) -> Iterator[Step]:
        """Yield a step for each increment [mm] of the plan, with its pressure where that is asked for.

        A third word says whether to certify the step.
        """
        increments, asked, *certified = zip(*plan, strict=True)
        for group in self.groups(increments, asked, *certified):
            if not isinstance(group, StepColumns):
                yield group
                continue
            last = self.steps_in_flight + len(group)
            for number, step in enumerate(group, 1):
                self.steps_in_flight = last - number
                yield step

    def groups(
        self, increments: Sequence[float], asked: Sequence[bool], certified: Sequence[bool] = ()
    ) -> Iterator[Step | StepColumns]:
        """Yield steps as `steps` does, but together where a model has them in one piece.

        asked: whether for the pressure of each. certified: whether to certify each.
        """
        in_blocks, first = self.in_blocks, 0
        while first < len(increments):
            alone, end = asked[first] or not in_blocks, first + 1
            if not alone:
                most = min(first + self.longest_block, len(increments))
                end = first + [*map(bool, asked[first:most]), True].index(True)
            then = increments[end] if end < len(increments) else None
            self.certified = any(certified[end - 1 : end])
            if alone:
                yield self.advance(increments[first], with_pressure=asked[first], then=then)
            else:
                yield from self._block(increments[first:end], then)
            first = end
