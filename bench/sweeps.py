"""Sweeps: how much faster more workers are, and whether one that is killed ends as one left alone.

    python bench/sweeps.py throughput --runs 100 --workers 1 2        # seeds of v3-fine at 5 µm cells
    python bench/sweeps.py throughput --runs 64 --cell "1 um" --gpus 2 --workers 1 2 8
    python bench/sweeps.py kills --kills 20                           # 60 runs over all models

Throughput tells the workers' start apart: each makes one run before the clock starts. Kills end the sweep,
one of its workers, or all of them, with SIGKILL, in turns and at random moments.
"""

import argparse
import csv
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import wait
from pathlib import Path
from typing import Any

from kills import CASES

from warpwear import Study
from warpwear.engine.device import usable_cores
from warpwear.study.text import to_marked_toml
from warpwear.sweeps.plan import Plan, section_of
from warpwear.sweeps.points import task_of
from warpwear.sweeps.pool import local_workers
from warpwear.sweeps.run_one import run_one
from warpwear.sweeps.sweep import make_runs

#: A case of every model and law, of those that `kills.py` knows.
MODELS = (
    "micro, implicit",
    "bearing area",
    "half-space",
    "swept, half-space",
    "two-scale",
    "macro, bearing curve",
)
RUNS_A_MODEL = 10


def throughput(runs: int, cell: str, workers: int, gpus: int, seed: int) -> tuple[float, float]:
    """Seconds to start the workers, and to make so many runs of v3-fine that differ in their seed."""
    study = Study.load("v3-fine").replace({"grid.cell": cell, "output.snapshots": []})
    device = "cuda:0" if gpus else "cpu"
    seeds = {"disc.synthetic.seed": f"{seed}:{seed + workers + runs - 1}"}
    plan = Plan(study, section_of({"vary": seeds}, {}), device=device)
    cores = usable_cores()
    with (
        tempfile.TemporaryDirectory() as folder,
        local_workers(workers, cores=cores, gpus=[str(number) for number in range(gpus)]) as pool,
    ):
        place, threads = Path(folder), max(1, cores // workers)
        (place / "runs").mkdir()
        started = time.perf_counter()
        first = [
            pool.submit(run_one, task_of(point, place, device=plan.device, threads=threads))
            for point in plan.points[:workers]
        ]
        wait(first)
        begun = time.perf_counter()
        rows = make_runs(plan, place, pool, threads=threads)
        ended = time.perf_counter()
    bad = [row.status for row in rows if row.status != "done"]
    if bad:
        raise RuntimeError(f"{len(bad)} runs failed: {bad[0]}")
    return begun - started, ended - begun


def table_of(folder: Path) -> list[dict[str, str]]:
    """The rows of a sweep's table without what differs by nature."""
    with (folder / "table.csv").open(encoding="utf-8", newline="") as file:
        return [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]


def command_of(case: str, place: Path, out: Path) -> list[str]:
    """The command of a sweep of a case: five loads, two wear coefficients; checkpoints after every step."""
    preset, changes = CASES[case]
    study = Study.load(preset).replace(changes | {"run.checkpoint": "0 s", "output.snapshots": []})
    path = place / "study.toml"
    path.write_text(to_marked_toml(study), encoding="utf-8")
    load = study.contact.load
    return [
        *(sys.executable, "-m", "warpwear", "sweep", str(path), "--workers", "2", "--out", str(out)),
        *("--vary", "contact.load=" + ",".join(f"{load * part!r} N" for part in (0.8, 0.9, 1.0, 1.1, 1.2))),
        *("--vary", "wear.sphere=9e-4 mm^3/N/m,1e-3 mm^3/N/m"),
    ]


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
    return [int(word) for word in text.split()]


def strike(process: "subprocess.Popen[bytes]", what: str, dice: random.Random) -> None:
    """Kill a sweep, one of its workers or all of them."""
    workers = children(process.pid)
    targets = {
        "sweep": [process.pid],
        "worker": workers and [dice.choice(workers)],
        "all": [process.pid, *workers],
    }
    for pid in targets[what]:
        os.kill(pid, signal.SIGKILL)


def killed_sweep(case: str, place: Path, kills: int, dice: random.Random) -> dict[str, Any]:
    """A sweep of a case, killed so many times and resumed; what became of it beside one left alone."""
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    alone, out = place / "alone", place / "killed"
    started = time.monotonic()
    subprocess.run(command_of(case, place, alone), check=True, **quiet)
    lasted = time.monotonic() - started
    command, done, again = [*command_of(case, place, out), "--resume"], 0, 0
    finished: dict[Path, tuple[int, int]] = {}
    process = subprocess.Popen(command, **quiet)
    while process.poll() is None:
        if done < kills:
            try:
                process.wait(dice.uniform(0.1, 0.4) * lasted)
                break
            except subprocess.TimeoutExpired:
                what = ("sweep", "worker", "all")[done % 3]
                strike(process, what, dice)
                done += 1
                if what != "worker":
                    process.wait()
        else:
            process.wait(600.0)
        for path in out.glob("runs/*/result.h5"):
            state = path.stat()
            known = finished.setdefault(path, (state.st_ino, state.st_mtime_ns))
            again += known != (state.st_ino, state.st_mtime_ns)
        if process.returncode == -signal.SIGKILL:
            process = subprocess.Popen(command, **quiet)
    if process.returncode:
        raise RuntimeError(f"{case}: after {done} kills the sweep ended with status {process.returncode}")
    for path, known in finished.items():
        again += known != (path.stat().st_ino, path.stat().st_mtime_ns)
    return {
        "kills": done,
        "rows": len(table_of(out)),
        "same": table_of(out) == table_of(alone),
        "computed again": again,
    }


def main() -> None:
    """Print a line a configuration, or a line a model; exit status 1 if anything differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("throughput", "kills"))
    parser.add_argument("--runs", type=int, default=20, help="of each configuration")
    parser.add_argument("--cell", default="5 um")
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2], help="of each configuration")
    parser.add_argument("--gpus", type=int, default=0, help="that the workers share in turn; 0: on the CPU")
    parser.add_argument("--kills", type=int, default=20, help="in all")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.what == "throughput":
        base = None
        for workers in options.workers:
            start, seconds = throughput(options.runs, options.cell, workers, options.gpus, options.seed)
            rate = options.runs / seconds
            base = base or rate
            print(
                f"{workers} workers, {options.gpus} GPUs: {options.runs} runs in {seconds:.2f} s after "
                f"{start:.2f} s of start, {3600 * rate:.0f} runs an hour, {rate / base:.2f} times the first",
                flush=True,
            )
        return
    dice, good = random.Random(options.seed), True
    for number, case in enumerate(MODELS):
        share = (options.kills * (number + 1)) // len(MODELS) - (options.kills * number) // len(MODELS)
        with tempfile.TemporaryDirectory() as folder:
            found = killed_sweep(case, Path(folder), share, dice)
        good &= found["same"] and found["rows"] == RUNS_A_MODEL and not found["computed again"]
        print(f"{case}: {found}", flush=True)
    sys.exit(not good)


if __name__ == "__main__":
    main()
