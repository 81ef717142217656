"""The half-space beside its peers, in turns: one surface, one residual for all pressures, ratios of pairs.

    python bench/half_space.py --cells 512 1024 [--peers PYTHON …] [--turns 7] [--json FILE]
    python bench/half_space.py --cells 4096 --cases capped --contenders warpwear --device cuda:0

Each contender solves in a process of its own, in turns with ours; one that is not installed is left out
(PYTHON: interpreters that have tamaas, ContactMechanics or ASPHER). The residual is of everybody's pressure
and made by NumPy: the largest violation of complementarity over the rms height, at the level that makes it
least. A peer's own tolerance is the loosest of a few with which its residual is what is asked, and its
setting the best of those given. Ratios are medians over the turns of the peer's time over ours; processor
time is what counts on a machine that does other work. Memory is that of a first solve, above what was held
before.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
from contenders.half_space import MODULUS
from measure.machine import machine

from warpwear.contact.influence import free_coefficients, periodic_spectrum
from warpwear.grid import Grid
from warpwear.surfaces.made.self_affine import SelfAffine

HURST, SLOPE = 0.8, 0.1
#: Radius of the ball, and rms slope of its roughness.
RADIUS, BALL_SLOPE = 10.0, 0.003
TARGETS = (1e-4, 1e-8)
#: A peer's own tolerance over the residual asked of it: the first that gives it is taken.
FACTORS = (1.0, 0.3, 0.1, 0.03, 0.01)
#: Load that a pressure may miss, relatively, over the residual asked.
LOAD = 1e-2
#: Nobody waits longer for one solve of a peer [s].
PATIENCE = 600.0
HERE = Path(__file__).parent


class Case(NamedTuple):
    """cut: cells in the shortest wave; 0: none. load: mean pressure over E*. cap: over E*."""

    cut: int
    load: float = 0.005
    cap: float = math.inf
    ball: bool = False

    @property
    def boundary(self) -> str:
        return "free" if self.ball else "periodic"

    def heights(self, cells: int) -> Any:
        """Heights on 1 × 1."""
        grid = Grid(cells, cells, 1.0 / cells)
        made = np.zeros(grid.shape)
        if self.cut:
            waves = SelfAffine(hurst=HURST, roll_off=0.999, cut_off=self.cut / cells, period=1.0, sq=1.0)
            slope = BALL_SLOPE if self.ball else SLOPE
            made = waves.heights(grid.x, grid.y) * (slope / waves.rms_slope)
        if self.ball:
            made -= ((grid.x[:, np.newaxis] - 0.5) ** 2 + (grid.y - 0.5) ** 2) / (2.0 * RADIUS)
        return made


CASES = {
    "elastic": Case(2),
    "resolved": Case(16),
    "near full": Case(16, load=0.06),
    "ball": Case(0, load=0.003, ball=True),
    "rough ball": Case(16, load=0.003, ball=True),
    "capped": Case(2, cap=0.05),
}


def settings(name: str, case: Case, target: float) -> list[dict[str, Any]]:
    """What a contender is tried with."""
    if name != "ASPHER":
        return [{}]
    precisions = ("double", "float" if target >= 1e-5 else "float_then_double")
    found = [{"precision": p, "precond_engine": e} for p in precisions for e in ("fft", "auto")]
    if case.ball:
        # the stencil takes five times as many iterations there; the hierarchy is approximate to 1e-6
        found = [one for one in found if one["precond_engine"] == "fft"]
        if target >= 1e-5:
            found.append({**found[-1], "backend": "h2", "active_set": True})
    return found


def knows(name: str, case: Case) -> bool:
    """Whether a contender has what a case needs."""
    peers = {"ASPHER": math.isinf(case.cap), "tamaas": not case.ball, "ContactMechanics": not case.ball}
    return peers.get(name, True)


def judge(heights: Any, pressure: Any, case: Case) -> dict[str, float]:
    """Residual, area and load of a pressure, by NumPy alone."""
    n, cap = heights.shape[0], case.cap
    pressure = np.clip(pressure, 0.0, cap)
    if case.ball:
        away = np.minimum(np.arange(2 * n), 2 * n - np.arange(2 * n))
        coefficients = free_coefficients(1.0 / n, MODULUS, n + 1, n + 1)
        spectrum = np.fft.rfft2(coefficients[np.ix_(away, away)]).real
    else:
        spectrum = periodic_spectrum(Grid(n, n, 1.0 / n), MODULUS)
    shape = (2 * n, 2 * n) if case.ball else heights.shape
    gap = np.fft.irfft2(np.fft.rfft2(pressure, s=shape) * spectrum, s=shape)[:n, :n] - heights
    overlap = gap[pressure > 0.0].max() - gap[pressure < cap].min()
    return {
        "residual": max(0.5 * overlap / heights.std(), 0.0),
        "area": float((pressure > 0.0).mean()),
        "load_residual": pressure.mean() / (case.load * MODULUS) - 1.0,
    }


class Contender:
    """A process that solves what it is asked. Raises OSError where it cannot start."""

    def __init__(self, name: str, interpreters: list[str], threads: int) -> None:
        self.name, self.threads = name, threads
        ours = name == "warpwear"
        environment = dict(os.environ, OMP_NUM_THREADS=str(threads), OPENBLAS_NUM_THREADS=str(threads))
        environment["PYTHONPATH"] = str(HERE.parent) if ours else ""
        for interpreter in [sys.executable] if ours else interpreters:
            self._process = subprocess.Popen(
                [interpreter, str(HERE / "contenders" / "half_space.py"), name],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                env=environment,
            )
            said = self._answer()
            if said:
                self.version = said["version"]
                return
        raise OSError(f"{name}: not installed")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()

    def solve(self, case: dict[str, Any]) -> dict[str, Any]:
        """Record of a solve; empty where it failed."""
        assert self._process.stdin is not None
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


def ready(
    contender: Contender, asked: dict[str, Any], heights: Any, case: Case, target: float
) -> list[dict[str, Any]]:
    """The contender's settings that give the residual, with the loosest tolerance; the quickest two."""
    found = []
    for setting in settings(contender.name, case, target):
        for factor in (1.0,) if contender.name == "warpwear" else FACTORS:
            trial = {**asked, "setting": setting, "tolerance": factor * target}
            record = contender.solve(trial)
            if not record:
                break
            record |= judge(heights, np.load(asked["pressure"]), case) | {"trial": trial}
            met = record["residual"] <= target and abs(record["load_residual"]) <= LOAD * target
            if met:
                found.append(record)
            if met or record["processor_seconds"] > PATIENCE:
                break
    return sorted(found, key=lambda record: float(record["processor_seconds"]))[:2]


def compare(name: str, cells: int, target: float, options: argparse.Namespace) -> list[dict[str, Any]]:
    """All rows of a case: ours, and each peer in turns with ours."""
    case, rows = CASES[name], []
    heights = case.heights(cells)
    common = {"case": name, "cells": cells, "target": target, "threads": options.threads}
    with tempfile.TemporaryDirectory() as folder:
        np.save(f"{folder}/heights.npy", heights)
        asked = {
            "heights": f"{folder}/heights.npy",
            "pressure": f"{folder}/pressure.npy",
            "boundary": case.boundary,
            "cap": case.cap * MODULUS,
            "mean_pressure": case.load * MODULUS,
            "device": options.device,
        }
        for peer in options.contenders:
            if peer in options.without or not knows(peer, case):
                continue
            try:
                with (
                    Contender("warpwear", [], options.threads) as us,
                    Contender(peer, options.peers, options.threads) as other,
                ):
                    ours = ready(us, asked, heights, case, target)
                    tried = [
                        _turns(us, other, ours[0], one, options)
                        for one in ready(other, asked, heights, case, target)
                    ]
            except OSError as error:
                print(error, file=sys.stderr)
                continue
            row = common | {"contender": peer, "version": other.version}
            row |= min(tried, key=lambda one: float(one["processor_seconds_ratio"]), default={})
            rows.append(row)
            print(line_of(row), flush=True)
    return rows


def _turns(
    us: Contender, other: Contender, ours: dict[str, Any], theirs: dict[str, Any], options: argparse.Namespace
) -> dict[str, Any]:
    """Solves in turns, and what was found before."""
    row: dict[str, Any] = {
        "setting": theirs["trial"]["setting"],
        "their_tolerance": theirs["trial"]["tolerance"],
    }
    turns: dict[str, list[dict[str, Any]]] = {"ours": [], "theirs": []}
    for _ in range(options.turns if theirs["processor_seconds"] < options.long else 1):
        turns["ours"].append(us.solve(ours["trial"] | {"pressure": ""}))
        turns["theirs"].append(other.solve(theirs["trial"] | {"pressure": ""}))
    for key in ("processor_seconds", "seconds"):
        pairs = [b[key] / a[key] for a, b in zip(*turns.values(), strict=True)]
        row[f"{key}_ratio"] = statistics.median(pairs)
        for side, records in turns.items():
            row[f"{side}_{key}"] = [record[key] for record in records]
    for side, record in (("ours", ours), ("theirs", theirs)):
        for key in ("residual", "area", "iterations"):
            row[f"{side}_{key}"] = record[key]
    for side, contender, record in (("ours", us, ours), ("theirs", other, theirs)):
        row[f"{side}_memory_mib"] = memory_of(contender.name, record["trial"], options)
    return row


def memory_of(name: str, trial: dict[str, Any], options: argparse.Namespace) -> float:
    """Growth of memory in the first solve of a process: a later one finds what earlier ones left."""
    with Contender(name, options.peers, options.threads) as fresh:
        return float(fresh.solve(trial | {"pressure": ""})["memory_mib"])


HEADS = ("×cpu", "×clock", "ours s", "theirs s", "residuals", "iterations", "MiB")


def line_of(row: dict[str, Any]) -> str:
    """A row of the table."""
    start = f"{row['cells']:5d} {row['case']:10} {row['target']:.0e} {row['contender']:17}"
    if "seconds_ratio" not in row:
        return start + " did not come to this residual"
    sides = [
        [row[f"{side}_{key}"] for side in ("ours", "theirs")]
        for key in ("residual", "iterations", "memory_mib")
    ]
    ends = [
        " ".join(f"{v:{form}}" for v in pair) for pair, form in zip(sides, (".1e", "d", ".0f"), strict=True)
    ]
    times = [statistics.median(row[f"{side}_processor_seconds"]) for side in ("ours", "theirs")]
    values = [
        f"{row['processor_seconds_ratio']:.2f}",
        f"{row['seconds_ratio']:.2f}",
        *(f"{t:.3f}" for t in times),
    ]
    setting = " ".join(str(value) for value in row["setting"].values())
    return start + "".join(f"{v:>8} " for v in values) + "".join(f" {v:>16}" for v in ends) + f"  {setting}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cells", type=int, nargs="+", default=[512])
    parser.add_argument("--peers", nargs="+", default=[sys.executable], help="interpreters that have them")
    parser.add_argument("--cases", nargs="+", choices=CASES, default=[*CASES])
    parser.add_argument("--targets", type=float, nargs="+", default=TARGETS)
    parser.add_argument("--contenders", nargs="+", default=["ASPHER", "ContactMechanics", "tamaas"])
    parser.add_argument("--without", nargs="*", default=[], help="such as tamaas, which takes minutes")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--turns", type=int, default=7)
    parser.add_argument(
        "--long", type=float, default=20.0, help="a peer's seconds from which a turn is enough"
    )
    parser.add_argument("--device", default="cpu", help="of warpwear")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print("cells case       to    beside           " + "".join(f"{head:>9}" for head in HEADS))
    rows = []
    for cells in options.cells:
        for name in options.cases:
            for target in options.targets:
                rows += compare(name, cells, target, options)
                if options.json:
                    record = {"machine": machine(), "device": options.device, "rows": rows}
                    options.json.write_text(json.dumps(record, indent=1) + "\n")


if __name__ == "__main__":
    main()
