"""Figures drawn in a second process: it starts while a run computes, and draws while the run is written.

It imports neither a result nor a study, which would take it longer than most figures. What it cannot draw is
missing among its pictures, whatever the reason, and is drawn by who asked.
"""

import sys
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, Self

import numpy as np

from warpwear import lazy
from warpwear.engine.workers import COMMAND, Workers
from warpwear.figures.describe import Axis, Chart, Figure, Line

painter, style = lazy.module("warpwear.figures.paint"), lazy.module("warpwear.figures.style")

#: A figure that loads what most of them need, fonts too.
WARM_UP = Figure([Chart("", Axis("x", "log"), Axis("y"), [Line(np.array([1.0, 10.0]), np.zeros(2), "x")])])
#: Figures of what is computed last.
LATE = ("roughness",)
#: What the other process has drawn, by the figure's name.
DRAWN: dict[str, bytes] = {}


class Painter:
    """Asks a second process for pictures, where there is more than one core for both.

    command: what Python runs there. patience: longest time that pictures are waited for [s].
    """

    def __init__(self, cores: int, *, command: Sequence[str] = COMMAND, patience: float = 60.0) -> None:
        self._patience = patience
        self._pictures: dict[str, Future[bytes]] = {}
        self._worker: Workers | None = None
        if cores >= 2 and sys.executable and not getattr(sys, "frozen", False):
            environment = {"MPLBACKEND": "agg", "OPENBLAS_NUM_THREADS": "1"}
            self._worker = Workers([environment], retries=0, quiet=True, command=command)
            self._worker.submit(draw, "", WARM_UP)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._worker is not None:
            self._worker.stop()

    @property
    def draws(self) -> bool:
        """Whether there is another process."""
        return self._worker is not None

    def order(self, plot: Any, *, but: Sequence[str] = ()) -> None:
        """Ask for the essential figures of a result, `but` some, that were not asked for yet; do not wait.

        plot: its `Plotter`.
        """
        if self._worker is not None:
            for name in plot.names("essential"):
                if name not in but and name not in self._pictures:
                    self._pictures[name] = self._worker.submit(draw, name, plot.declared(name))

    def order_page(self, name: str, content: dict[str, Any], maker: str) -> None:
        """Ask for a page of content and of all pictures, to be found among these by its name; do not wait.

        maker: place of what makes it of both, which the other process imports.
        """
        if self._worker is not None:
            self._pictures[name] = self._worker.submit(make_page, content, maker)

    def pictures(self) -> dict[str, bytes]:
        """Wait for the pictures; return the PNG files that there are by the figure's name, and the page."""
        pictures, end = {}, time.monotonic() + self._patience
        for name, future in self._pictures.items():
            with suppress(Exception):  # the other process has gone, or takes too long
                pictures[name] = future.result(max(end - time.monotonic(), 0.0))
        return pictures


def draw(name: str, figure: Figure) -> bytes:
    """Draw a figure here, in the other process, and keep it for a page; return its PNG file."""
    DRAWN[name] = style.bytes_of(painter.paint(figure))
    return DRAWN[name]


def make_page(content: Mapping[str, Any], maker: str) -> bytes:
    """Make a page of content and of what was drawn here."""
    return lazy.resolve(maker)(content, DRAWN)
