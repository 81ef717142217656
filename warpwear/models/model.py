"""What a run asks of a model: steps along a plan, snapshots of them, and a state to go on from."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Protocol

from warpwear.history.recorder import Step
from warpwear.history.snapshot import Snapshot


class Model(Protocol):
    """Contact and wear of one task on one executor."""

    #: Steps that the state is ahead of the last one given.
    ahead: int

    @property
    def STATE(self) -> Mapping[str, Any]:
        """What its steps change, see `warpwear.engine.state`."""

    def steps(self, plan: Iterable[tuple[float, bool]]) -> Iterator[Step]:
        """One step for each (increment [mm], whether a snapshot of it will be asked for)."""

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, at its distance [mm]."""
