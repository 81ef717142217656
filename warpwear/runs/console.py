"""How a run speaks to a terminal and listens to it: progress on standard error, and signals to stop."""

import signal
import sys
import threading
import time
import warnings
from collections.abc import Mapping
from contextlib import suppress
from operator import itemgetter
from types import FrameType
from typing import Any, Self

from tqdm import tqdm

from warpwear.errors import StudyWarning
from warpwear.history.distances import with_unit
from warpwear.history.verdict import rank_of

#: Longest silence of what writes plain lines, and shortest and longest of a run [s].
EVERY_SECONDS = 30.0
PACE = 2.0, EVERY_SECONDS
#: Notes that a run writes; all of them are on its page, in its summary and in its log.
MOST_NOTES = 3


class Progress:
    """Counts steps: in a bar with the time left on a terminal, in a line every tenth of them elsewhere.

    name: of the study, with which lines begin. As a context it tells at its end what misleads, the heaviest
    first; with all_notes all of it, else three sentences, and how many are left. pace: the shortest and the
    longest time between plain lines [s].
    """

    def __init__(
        self, name: str, *, quiet: bool = False, all_notes: bool = False, pace: tuple[float, float] = PACE
    ) -> None:
        self._name = name
        self._shortest, self._longest = pace
        self._quiet = quiet
        self._notes: list[tuple[int, str]] = []
        self._left = sys.maxsize if all_notes else MOST_NOTES
        #: Where all notes are.
        self.elsewhere = "in the run's summary and log"
        self._bar: tqdm | None = None
        self._steps = self._done = self._before = 0
        self._made = self._started = self._last_line = time.perf_counter()
        self._next, self._compiles, self._by_cycles = 0.1, False, False

    def start(self, steps: int, *, done: int = 0, by_cycles: bool = False) -> None:
        """Begin a run of `steps` steps, or go on where `done` of them are done.

        by_cycles: whether a step counts as often as the cycles that it stands for.
        """
        self._steps, self._done, self._before, self._by_cycles = steps, done, done, by_cycles
        self._next = done / steps + 0.1
        self._started = self._last_line = time.perf_counter()
        if not self._quiet and sys.stderr.isatty():
            self._bar = tqdm(total=steps, initial=done, desc=self._name, unit="step", leave=False)

    def step(self, row: Mapping[str, float], *, count: int = 1) -> None:
        """One step is done, or so many, the last of which has this row."""
        if self._quiet:
            return
        steps = int(row["cycles"]) if self._by_cycles else count
        self._done += steps
        self._write_warnings()
        if self._bar is not None:
            self._bar.update(steps)
            if self._done % 20 < steps:
                self._bar.set_postfix_str(
                    f"{with_unit(row['distance'], 4)}, {row['area_contact']:.4g} mm²", refresh=False
                )
            return
        silent = time.perf_counter() - self._last_line
        if silent > (self._shortest if self._done >= self._next * self._steps else self._longest):
            self._last_line += silent
            elapsed = self._last_line - self._started
            left = elapsed / (self._done - self._before) * (self._steps - self._done)
            self.say(
                f"{self._name}: step {self._done} of {self._steps}, {with_unit(row['distance'], 4)} slid, "
                f"{row['area_contact']:.4g} mm² in contact, {elapsed:.0f} s gone, about {left:.0f} s left"
            )
            self._next = self._done / self._steps + 0.1

    def phase(self, name: str) -> None:
        """Begin a phase of the run: what may take long is told, once."""
        if name == "compile" and not self._compiles:
            self._compiles = True
            self.say(f"{self._name}: compiling kernels, which are kept for the next run")
        if name == "draw" and time.perf_counter() - self._made > self._shortest:
            self.say(f"{self._name}: drawing")

    def say(self, line: str) -> None:
        """Write a line for the user, if there is one still."""
        if not self._quiet:
            with suppress(BrokenPipeError):
                tqdm.write(line, file=sys.stderr)

    def note(self, sentence: str, *, kind: str = "note") -> None:
        """Tell what misleads: a line for the user after the result, or a warning of Python without console.

        kind: "note", or "warning" where numbers are not to be trusted.
        """
        self._notes.append((rank_of(sentence, kind), f"{kind}: {sentence}"))
        if self._quiet:
            warn(sentence)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._write_notes(self._left)
        if more := len(self._notes):
            self.say(f"{more} more note{'s' * (more > 1)}: {self.elsewhere}")

    def _write_notes(self, most: int, ranks: int = 4) -> None:
        """Write so many notes at most of the first ranks, the heaviest first; each is written once."""
        self._notes.sort(key=itemgetter(0))
        count = min(max(most, 0), sum(rank < ranks for rank, _ in self._notes))
        for _, line in self._notes[:count]:
            self.say(line)
        self._left -= count
        self._notes = self._notes[count:]

    def _write_warnings(self) -> None:
        """Tell warnings of a run that takes long, which one may want to stop; the last is for its end."""
        if self._notes and time.perf_counter() - self._started > self._shortest:
            self._write_notes(self._left - 1, ranks=2)

    def end(self) -> None:
        """End the run, one way or another."""
        if self._bar is not None:
            self._bar.close()


def warn(sentence: str) -> None:
    """Warn at the line of the user's that called warpwear."""
    caller, level = sys._getframe(), 1
    while caller.f_back and caller.f_globals.get("__name__", "").startswith(("warpwear.", "contextlib")):
        caller, level = caller.f_back, level + 1
    warnings.warn(sentence, StudyWarning, stacklevel=level)


class Interrupts:
    """A context in which the first signal that would raise KeyboardInterrupt only sets `requested`.

    A second one raises it at once. Handlers of others, and signals in other threads, are left alone.
    """

    def __init__(self) -> None:
        self.requested = False
        self._before: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if signal.getsignal(number) is signal.default_int_handler:
                    self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.requested:
            raise KeyboardInterrupt
        self.requested = True
