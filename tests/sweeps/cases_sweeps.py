"""What tests of sweeps share: a small study, processes, and the address of a scheduler."""

import json
import os
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from warpwear import Study

ROOT = Path(__file__).parents[2]
#: A rough contact that takes a tenth of a second.
SMALL = {"grid.cell": "10 um", "grid.extent": "1 mm", "sliding.distance": "3 mm", "output.snapshots": []}
VARY = {"contact.load": ["4 N", "8 N"], "disc.synthetic.seed": "1:3"}


def small(**changes: Any) -> Study:
    return Study.load("v3-fine").replace({**SMALL, **changes})


@contextmanager
def processes(*commands: list[str]) -> Iterator[list["subprocess.Popen[str]"]]:
    """Processes of the given commands, which end with the test."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    started = [subprocess.Popen(command, env=environment, text=True) for command in commands]
    try:
        yield started
    finally:
        for process in started:
            process.kill()
            process.wait()


def address_in(place: Path) -> str:
    """The address that a scheduler writes into its file."""
    end = time.monotonic() + 60.0
    while not (place.is_file() and place.stat().st_size):
        assert time.monotonic() < end, "the scheduler did not start"
        time.sleep(0.1)
    return str(json.loads(place.read_text(encoding="utf-8"))["address"])
