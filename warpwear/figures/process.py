"""Figures drawn in a second process: it starts while a run computes, and draws while the run is written.

It imports neither a result nor a study, which would take it longer than most figures. What it cannot draw is
missing among its pictures, whatever the reason, and is drawn by who asked. No worker of `multiprocessing`
does it: that runs a user's script once more where it has no `if __name__ == "__main__"`.
"""

import os
import pickle
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from types import TracebackType
from typing import Any, Self

import numpy as np

from warpwear import lazy
from warpwear.figures.describe import Axis, Chart, Figure, Line

painter, style = lazy.module("warpwear.figures.paint"), lazy.module("warpwear.figures.style")

#: A figure that loads what most of them need.
WARM_UP = Figure([Chart("", Axis("x", "log"), Axis("y"), [Line(np.array([1.0, 10.0]), np.zeros(2), "x")])])
#: Figures of what is computed last.
LATE = ("roughness",)
#: Longest time that pictures are waited for [s].
PATIENCE = 60.0
#: What the other process runs: with the paths of this one, wherever warpwear was imported from.
COMMAND = "import sys; sys.path[:] = {path!r}; from warpwear.figures.process import draw; draw()"


class Painter:
    """Asks a second process for pictures, where there is more than one core for both."""

    def __init__(self, cores: int) -> None:
        self._ordered: set[str] = set()
        self._hands = ThreadPoolExecutor(1)  # orders are handed over while the run goes on
        self._process: subprocess.Popen[bytes] | None = None
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

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._process is not None:
            with suppress(OSError), self._process:  # closes its pipes
                self._process.kill()
                self._hands.shutdown(cancel_futures=True)
        self._hands.shutdown()

    @property
    def draws(self) -> bool:
        """Whether there is another process."""
        return self._process is not None

    def order(self, plot: Any, *, but: Sequence[str] = ()) -> None:
        """Ask for the essential figures of a result, `but` some, that were not asked for yet; do not wait.

        plot: its `Plotter`.
        """
        if self._process is not None:
            names = [n for n in plot.names("essential") if n not in but and n not in self._ordered]
            self._ordered.update(names)
            self._hands.submit(self._hand_over, {name: (None, plot.declared(name)) for name in names})

    def order_page(self, name: str, content: dict[str, Any], maker: str) -> None:
        """Ask for a page of content and of all pictures, to be found among these by its name; do not wait.

        maker: place of what makes it of both, which the other process imports.
        """
        if self._process is not None:
            self._hands.submit(self._hand_over, {name: (maker, content)})

    def pictures(self) -> dict[str, bytes]:
        """Wait for the pictures; return the PNG files that there are by the figure's name, and the page."""
        pictures: dict[str, bytes] = {}
        if self._process is not None:
            with suppress(Exception):  # the other process has gone, or takes too long
                pictures = self._hands.submit(self._collect).result(PATIENCE)
        return pictures

    def _hand_over(self, orders: dict[str, Any]) -> None:
        assert self._process is not None
        assert self._process.stdin is not None
        pickle.dump(orders, self._process.stdin)
        self._process.stdin.flush()

    def _collect(self) -> Any:
        assert self._process is not None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        return pickle.load(self._process.stdout)


def draw() -> None:
    """Draw what comes on standard input until it ends; then hand over the pictures on standard output."""
    orders = sys.stdin.buffer
    pictures: dict[str, bytes] = {}
    style.bytes_of(painter.paint(WARM_UP))  # loads fonts meanwhile
    with suppress(EOFError):
        while True:
            for name, (maker, content) in pickle.load(orders).items():
                with suppress(Exception):  # who ordered it draws it then, and says what is wrong
                    if maker is None:
                        pictures[name] = style.bytes_of(painter.paint(content))
                    else:
                        pictures[name] = lazy.resolve(maker)(content, pictures)
    pickle.dump(pictures, sys.stdout.buffer)
    sys.stdout.flush()
