"""A contender of the half-space in a process of its own, that is asked by lines of JSON."""

import json
import os
import subprocess
import sys
import tempfile
from itertools import product
from pathlib import Path
from typing import Any, Self

HERE = Path(__file__).parent


class Contender:
    """A process that solves what it is asked. Raises OSError where it cannot start."""

    def __init__(self, name: str, interpreters: list[str], threads: int) -> None:
        self.name, self.threads, self.solves = name, threads, 0
        ours, path, faults = name == "warpwear", os.environ.get("PYTHONPATH", ""), []
        environment = dict(os.environ, OMP_NUM_THREADS=str(threads), OPENBLAS_NUM_THREADS=str(threads))
        # packages may lie on this process's path alone, or be of another Python than a peer's
        paths = (
            [os.pathsep.join(filter(None, [str(HERE.parents[1]), path]))]
            if ours
            else list(dict.fromkeys([path, ""]))
        )
        for interpreter, there in product([sys.executable] if ours else interpreters, paths):
            environment["PYTHONPATH"] = there
            self._said = tempfile.TemporaryFile("w+")  # noqa: SIM115 as long as the process
            self._process = subprocess.Popen(
                [interpreter, str(HERE / "half_space.py"), name],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                text=True,
                env=environment,
            )
            if answer := self._answer():
                self.version = answer["version"]
                return
            self._process.wait()
            self._said.seek(0)
            faults.append(f"{interpreter}: {(self._said.read().strip().splitlines() or ['no word'])[-1]}")
        raise OSError(f"{name} cannot start ({'; '.join(faults)})")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()

    def solve(self, case: dict[str, Any]) -> dict[str, Any]:
        """Record of a solve; empty where it failed."""
        assert self._process.stdin is not None
        self.solves += 1
        self._process.stdin.write(json.dumps(case | {"threads": self.threads}) + "\n")
        self._process.stdin.flush()
        found = self._answer()
        if "failed" in found:
            print(f"{self.name}: {found['failed']}", file=sys.stderr)
        return {} if "failed" in found else found

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if line.startswith("{"):
                found: dict[str, Any] = json.loads(line)
                return found
        return {}
