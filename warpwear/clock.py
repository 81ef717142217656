"""Where the time of a run goes: seconds of its phases, of which one goes on at a time."""

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

#: Name of a time that a person reads -> the phases of which it is the sum.
REPORTED = {
    "load": ("imports", "kernels", "surface"),
    "compile": ("compile",),
    "solve": ("steps", "stresses"),
    "write": ("snapshots", "evolution", "write"),
    "draw": ("draw",),
}

#: Units that are not seconds, the longest first.
LONG = ((3600.0, "h"), (60.0, "min"))


class Clock:
    """Adds up the seconds of each phase; one inside another counts for itself alone.

    import_seconds: what imports took before. entered: is called with each phase that begins or goes on.
    """

    def __init__(
        self, *, import_seconds: float = 0.0, entered: Callable[[str], object] = lambda phase: None
    ) -> None:
        self.phases: defaultdict[str, float] = defaultdict(float)
        self._entered = entered
        self._phase, self._since = "imports", time.perf_counter() - import_seconds

    def turn_to(self, phase: str) -> str:
        """Begin a phase; returns the one that went on."""
        before, now = self._phase, time.perf_counter()
        self.phases[before] += now - self._since
        self._phase, self._since = phase, now
        return before

    @contextmanager
    def running(self) -> Iterator[None]:
        """Count the phases of this thread that begin in this context."""
        token = _CLOCK.set(self)
        try:
            yield
        finally:
            _CLOCK.reset(token)
            self.turn_to("")

    @property
    def seconds(self) -> dict[str, float]:
        """Sum up the seconds so far by the names of `REPORTED`."""
        self.turn_to(self._phase)
        return {
            name: round(sum(self.phases.get(p, 0.0) for p in parts), 3) for name, parts in REPORTED.items()
        }


_CLOCK: ContextVar[Clock | None] = ContextVar("clock", default=None)


@contextmanager
def phase(name: str) -> Iterator[None]:
    """Count what happens in this context as a phase of the run that goes on in this thread, if one does."""
    clock = _CLOCK.get()
    if clock is None:
        yield
        return
    before = clock.turn_to(name)
    try:
        clock._entered(name)
        yield
    finally:
        clock.turn_to(before)
        clock._entered(before)


def lasting(seconds: float) -> str:
    """Write how long something takes, as people say it: 40 s, 3 min, 2 h."""
    size, unit = next(((size, unit) for size, unit in LONG if seconds >= size), (1.0, "s"))
    return f"{seconds / size:.2g} {unit}"
