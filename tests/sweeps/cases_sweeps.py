"""What tests of sweeps share: a small study, and an executor in this thread."""

from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from warpwear import Study

ROOT = Path(__file__).parents[2]
#: A rough contact that takes a tenth of a second.
SMALL = {"grid.cell": "10 um", "grid.extent": "1 mm", "sliding.distance": "3 mm", "output.snapshots": []}


class Here(Executor):
    """An executor that calls at once, in this thread."""

    def submit(self, function: Any, /, *arguments: Any, **named: Any) -> "Future[Any]":
        future: Future[Any] = Future()
        future.set_result(function(*arguments))
        return future


def small(**changes: Any) -> Study:
    return Study.load("v3-fine").replace({**SMALL, **changes})
