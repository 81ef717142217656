"""Ctrl-C that waits for the end of a step."""

import signal
import threading
from types import FrameType
from typing import Any, Self


class Interrupts:
    """Inside the context the first signal that would raise KeyboardInterrupt only sets `asked`.

    A second one raises it at once. Handlers of others, and signals in other threads, are left alone.
    """

    def __init__(self) -> None:
        self.asked = False
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
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True
