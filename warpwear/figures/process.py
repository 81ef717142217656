"""Figures drawn in a second process: it starts while a run computes, and draws while the run is written.

What it cannot draw is missing among its pictures, whatever the reason, and is drawn by who asked.
"""

import os
import pickle
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from queue import SimpleQueue
from threading import Thread
from types import TracebackType
from typing import Any, Self

from warpwear.figures.table import ESSENTIAL, FIGURES, Plotter

#: Figures of what is computed last.
LATE = ("roughness",)
#: Longest time that pictures are waited for [s].
PATIENCE = 60.0
#: What the other process runs: with the paths of this one, wherever warpwear was imported from.
COMMAND = "import sys; sys.path[:] = {path!r}; from warpwear.figures.drawing import main; main()"


class Painter:
    """Asks a second process for pictures, where there is more than one core for both."""

    def __init__(self, cores: int) -> None:
        self._ordered: set[str] = set()
        self._pictures: dict[str, bytes] = {}
        self._orders: SimpleQueue[bytes | None] = SimpleQueue()
        self._process: subprocess.Popen[bytes] | None = None
        self._thread = Thread(target=self._serve, daemon=True)
        if cores < 2 or not sys.executable or getattr(sys, "frozen", False):
            return
        with suppress(OSError):
            self._process = subprocess.Popen(
                [sys.executable, "-c", COMMAND.format(path=sys.path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=os.environ | {"MPLBACKEND": "agg", "OPENBLAS_NUM_THREADS": "1"},
                start_new_session=True,  # Ctrl-C is for who asks
            )
            self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()

    @property
    def draws(self) -> bool:
        """Whether there is another process."""
        return self._process is not None

    def order(self, plot: Plotter, *, but: Sequence[str] = ()) -> None:
        """Ask for the essential figures of a result, `but` some, that were not asked for yet; do not wait."""
        if self._process is not None:
            names = [n for n in plot.names("essential") if n not in but and n not in self._ordered]
            needed = dict.fromkeys(need for name in names for need in ESSENTIAL[name])
            places = {name: FIGURES[name].place for name in names}
            self._orders.put(pickle.dumps((plot.data.packed([*needed]), places)))
            self._ordered.update(names)

    def order_page(self, name: str, content: dict[str, Any], maker: str) -> None:
        """Ask for a page of content and of all pictures, to be found among these by its name; do not wait.

        maker: place of what makes it of both, which the other process imports.
        """
        if self._process is not None:
            self._orders.put(pickle.dumps((content, {name: maker})))

    def pictures(self) -> dict[str, bytes]:
        """Wait for the pictures; return the PNG files that there are by the figure's name, and the page."""
        if self._process is not None:
            self._orders.put(None)
            self._thread.join(PATIENCE)
        return self._pictures

    def _serve(self) -> None:
        """Hand over orders, and take the pictures at the end."""
        assert self._process is not None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(OSError, EOFError, pickle.UnpicklingError):  # the other process has gone
            while (order := self._orders.get()) is not None:
                self._process.stdin.write(order)
                self._process.stdin.flush()
            self._process.stdin.close()
            self._pictures = pickle.load(self._process.stdout)
