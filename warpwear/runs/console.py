"""How a run speaks to a terminal and listens to it: progress on standard error, and signals to stop."""

import math
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from operator import itemgetter
from types import FrameType
from typing import Any, Self, TypeAlias

from tqdm import tqdm

from warpwear.clock import lasting
from warpwear.errors import StudyWarning
from warpwear.history.distances import with_unit
from warpwear.history.verdict import rank_of

#: Longest silence of what writes plain lines, and shortest and longest of a run [s].
EVERY_SECONDS = 30.0
PACE = 2.0, EVERY_SECONDS
#: Notes that a run writes; all of them are on its page, in its summary and in its log. Those told on the way.
MOST_NOTES, EARLY_NOTES = 3, 2
#: Steps after which their pace tells the time left, and most over least of them that "about" is said of.
FIRST, ABOUT = 20, 4.0
#: Seconds of steps after which a run is foreseen, the first being dearer, as starts and parts are tried out;
#: and after how many at last, where "about" cannot be said yet.
FORESEEN, FORESEEN_AT_LAST = 1.0, 10.0
#: Phases of a run that no other contact has again.
ONCE = ("compile", "kernels")

#: Return how many steps were computed, and how many at least and at most are left.
Contacts: TypeAlias = tuple[Callable[[], int], Callable[[], tuple[float, float]]]


class Progress:
    """Counts steps: in a bar with the time left on a terminal, in a line every tenth of them elsewhere.

    name: of the study, with which lines begin. As a context it tells at its end what misleads, the heaviest
    first: so many sentences at most, and how many are left. pace: the shortest and the longest time between
    plain lines [s]. now: tells the time [s].
    """

    def __init__(
        self,
        name: str,
        *,
        quiet: bool = False,
        most_notes: int = MOST_NOTES,
        pace: tuple[float, float] = PACE,
        now: Callable[[], float] = time.perf_counter,
    ) -> None:
        self._name, self._quiet, self._now = name, quiet, now
        self._shortest, self._longest = pace
        self._notes: list[tuple[int, str]] = []
        self._left, self._early = most_notes, EARLY_NOTES
        self._bar: tqdm | None = None
        self._steps = self._done = 0
        self._made = self._started = self._last_line = now()
        self._next, self._phase, self._by_cycles = 0.1, "", False
        self._told = set[str]()
        self._contacts: Contacts = lambda: 0, lambda: (0.0, 0.0)
        #: When compiling began last, and the time it took since the start [s].
        self._since = self._once = 0.0
        #: Contacts and time when the first was there, which sets out the others; what one of these takes [s].
        self._begun: tuple[int, float] | None = None
        self._pace: float | None = None
        #: Where the pace is counted from next.
        self._middle = 0, 0.0

    def start(self, steps: int, contacts: Contacts, *, done: int = 0, by_cycles: bool = False) -> None:
        """Begin a run of `steps` steps, or go on where `done` of them are done.

        contacts: return how many steps were computed, and how many at least and at most are left.
        by_cycles: whether a step counts as often as the cycles that it stands for.
        """
        self._steps, self._done, self._by_cycles, self._contacts = steps, done, by_cycles, contacts
        self._next, self._once, self._begun, self._pace = done / steps + 0.1, 0.0, None, None
        self._started = self._last_line = self._now()
        if not self._quiet and sys.stderr.isatty():
            form = "{desc}: {percentage:3.0f} %|{bar}| {n_fmt} of {total_fmt} steps, {elapsed}{postfix}"
            self._bar = tqdm(total=steps, initial=done, desc=self._name, leave=False, bar_format=form)

    def step(self, row: Mapping[str, float], *, count: int = 1, in_flight: int = 0) -> None:
        """One step is done, or so many, the last of which has this row.

        in_flight: those that were computed with it and are told next.
        """
        if self._quiet:
            return
        steps = int(row["cycles"]) if self._by_cycles else count
        self._done += steps
        self._write_warnings()
        if in_flight == 0 and self._measure():
            self._next = 0.0  # it is told next
        if self._bar is not None:
            self._bar.update(steps)
            if self._done % 20 < steps:
                self._bar.set_postfix_str(
                    f"{with_unit(row['distance'], 4)}{self._left_text()}", refresh=False
                )
            return
        silent = self._now() - self._last_line
        due = self._shortest if self._done >= self._next * self._steps else self._longest
        if silent > due and self._done < self._steps:
            self._last_line += silent
            gone = lasting(self._last_line - self._started)
            self.say(
                f"{self._name}: step {self._done} of {self._steps}, {with_unit(row['distance'], 4)} slid, "
                f"{row['area_contact']:.4g} mm² in contact, {gone} gone{self._left_text()}"
            )
            self._next = self._done / self._steps + 0.1

    def _measure(self) -> bool:
        """Take the pace of all contacts but the first, without compiling; tell whether it is known now."""
        made, now, first = self._contacts[0](), self._now() - self._once, self._pace is None
        if self._begun is None:
            self._begun = self._middle = made, now
        elif made - self._begun[0] >= FIRST:
            self._pace = (now - self._begun[1]) / (made - self._begun[0])
            if made >= 2 * max(self._middle[0], FIRST):  # what the first ones try out is left behind
                self._begun, self._middle = self._middle, (made, now)
        return first and self._pace is not None

    def time_left(self, gone: float = 0.0) -> str:
        """Say how long the rest takes: 'about 40 s', or within what; nothing before that can be told.

        gone: seconds that are told with it.
        """
        least, most = self._contacts[1]()
        if self._pace is None or not most > 0.0:
            return ""
        if self._is_near:
            return f"about {lasting(gone + self._pace * math.sqrt(least * most))}"
        return f"{lasting(gone + self._pace * least)} to {lasting(gone + self._pace * most)}"

    @property
    def _is_near(self) -> bool:
        """Tell whether least and most of what is left let "about" be said."""
        least, most = self._contacts[1]()
        return most <= ABOUT * least

    def _left_text(self) -> str:
        left = self.time_left() if self._is_near else ""  # far apart, they tell nothing on the way
        return f", {left} left" if left else ""

    def phase(self, name: str) -> None:
        """Begin a phase of the run, or go on with it: what may take long is told, once."""
        if name in ONCE and self._phase not in ONCE:
            self._since = self._now()
        elif name not in ONCE and self._phase in ONCE:
            self._once += self._now() - self._since
        self._phase = name
        if name in self._told or (name == "draw" and self._now() - self._made <= self._shortest):
            return
        self._told.add(name)
        if name == "compile":
            self.say(f"{self._name}: compiling kernels, which are kept for the next run")
        if name == "draw":
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
        more = len(self._notes) - self.tell_notes(self._left)
        if self._left and more:
            self.say(f"{more} more note{'s' * (more > 1)}: in the run's summary and log")

    def tell_notes(self, most: int = sys.maxsize, *, ranks: int = 4) -> int:
        """Tell so many notes at most of the first ranks, the heaviest first, each once; return how many."""
        self._notes.sort(key=itemgetter(0))
        count = min(most, sum(rank < ranks for rank, _ in self._notes))
        for _, line in self._notes[:count]:
            self.say(line)
        self._notes = self._notes[count:]
        return count

    def _write_warnings(self) -> None:
        """Tell warnings of a run that takes long, which one may want to stop."""
        if self._notes and self._early and self._now() - self._started > self._shortest:
            self._early -= (told := self.tell_notes(self._early, ranks=2))
            self._left = max(self._left - told, 0)

    def end(self) -> None:
        """End the run, one way or another; let go of it, but for its counts."""
        made, left = self._contacts[0](), self._contacts[1]()
        self._contacts = (lambda: made), (lambda: left)
        if self._bar is not None:
            self._bar.close()


class Enough(Exception):
    """The first contacts of a run were made, which say how long the whole takes."""


class Foresight(Progress):
    """Stops a run when its first contacts say how long it takes, by raising Enough."""

    def step(self, row: Mapping[str, float], *, count: int = 1, in_flight: int = 0) -> None:
        """One step is done."""
        if in_flight == 0:
            self._measure()
        gone = self._now() - self._once - self._started
        if self._pace is not None and gone >= (FORESEEN if self._is_near else FORESEEN_AT_LAST):
            raise Enough

    def __str__(self) -> str:
        gone = self._now() - self._once - self._started
        return f"{self._name}: {self.time_left(gone) or f'about {lasting(gone)}'}, without figures"


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
