"""Kills runs at random moments and resumes them: is the end, bit for bit, that of a run left alone?

    python bench/kills.py --kills 200
    python bench/kills.py --kills 200 --shard 3/16
    python bench/kills.py --sweeps 30

Every study runs undisturbed once, with one thread. Then it is run with checkpoints after every step (or every
`--every` seconds), killed with SIGKILL at a random moment, resumed, killed again and so on until it finishes,
each time with other numbers of threads of its own, of BLAS and of OpenMP, or on one core; and again until all
kills are spent. `--shard k/n` does the k-th of n parts, k from 0, so that n processes do all. `--sweeps`
kills sweeps with all their workers instead: the table at the end is that of a sweep left alone, row by row.
"""

import argparse
import contextlib
import csv
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import h5py

from warpwear import Study, run
from warpwear.engine import executor as execution
from warpwear.results.folder import LOCK

#: Threads of BLAS and OpenMP (None: as they like), and whether the process is held on one core, by turns.
ENVIRONMENTS: tuple[tuple[str | None, bool], ...] = ((None, False), ("1", False), ("4", False), (None, True))
#: Begins a command on one core, before BLAS looks how many there are.
ON_ONE_CORE = (
    "import os, sys; os.sched_setaffinity(0, [int(sys.argv[1])]); os.execv(sys.argv[2], sys.argv[2:])"
)
#: A sweep of six runs by two workers.
SWEEP = (
    *(sys.executable, "-m", "warpwear", "sweep", "v3-fine", "--workers", "2", "--set", "grid.cell=20 um"),
    *(
        "--set",
        "sliding.distance=5 mm",
        "--vary",
        "contact.load=2 N,4 N,8 N",
        "--vary",
        "disc.synthetic.seed=1:2",
    ),
)
SMALL = {"grid.cell": "20 um", "output.snapshots": ["0.5 mm", "3 mm"]}
PIECES = SMALL | {
    "sliding.distance": "5 mm",
    "output.snapshots": ["0.5 mm"],
    "disc.synthetic.ra": "0.5 um",
    "wear.particle": "80 um",
    "wear.particle_thickness": "0.5 um",
}
SWEPT = {
    "contact.law": "half-space",
    "sliding.kinematics": "swept",
    "sliding.track": "3.2 mm",
    "sliding.shift": 1,
}
#: Smooth bodies of steel, some thousand cycles a step.
FRETTING = {
    "counter.radius": "5 mm",
    "counter.young": "210 GPa",
    "disc.young": "210 GPa",
    "disc.synthetic": {"kind": "flat"},
    "contact.law": "half-space",
    "contact.hardness": "inf MPa",
    "contact.load": "20 N",
    "friction.law": "coulomb",
    "friction.coefficient": 0.6,
    "friction.shear_strength": None,
    "grid.cell": "10 um",
    "grid.extent": "0.64 mm",
    "sliding.distance": None,
    "output.snapshots": [],
}
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "micro, implicit": ("v3-fine", SMALL | {"sliding.distance": "30 mm"}),
    "micro, many tiles": ("v3-fine", {"grid.cell": "5 um", "sliding.distance": "2 mm"}),
    "micro, elastic, radial": (
        "v3-fine",
        SMALL
        | {
            "sliding.distance": "10 mm",
            "contact.stiffness": "1.9e6 N/mm^3",
            "wear.distance_factor": "radial",
        },
    ),
    "micro, running in apart": (
        "v3-fine",
        SMALL
        | {
            "sliding.distance": "10 mm",
            "wear.law": "running-in",
            "wear.running_in": "5 mm",
            "wear.initial_counter": "3e-3 mm^3/N/m",
        },
    ),
    "bearing area": (
        "v3",
        SMALL
        | {
            "grid.extent": "1.6 mm",
            "stepping.scheme": "explicit",
            "stepping.increment": "0.03 mm",
            "stepping.load_tolerance": "0.5 N",
            "stepping.force": True,
            "sliding.distance": "5 mm",
        },
    ),
    "half-space": ("v3-fine", SMALL | {"contact.law": "half-space", "sliding.distance": "3 mm"}),
    "swept, half-space": (
        "v3-fine",
        SMALL | SWEPT | {"sliding.distance": "3 mm", "sliding.plastic": "keep"},
    ),
    "swept, pieces": (
        "v3-fine",
        PIECES
        | SWEPT
        | {
            "wear.dust_fraction": 0.1,
            "wear.pending_start": "uniform",
            "output.static_area_every": 3,
        },
    ),
    "pieces, bearing area": ("v3-fine", PIECES | {"stepping.increment": "0.03 mm"}),
    "two-scale": ("two-scale", SMALL | {"grid.cell": "10 um", "sliding.distance": "10 mm"}),
    "two-scale, half-space": (
        "two-scale",
        SMALL | {"grid.cell": "10 um", "sliding.distance": "10 mm", "contact.law": "half-space"},
    ),
    "two-scale, load": (
        "two-scale",
        SMALL | {"grid.cell": "10 um", "sliding.distance": "10 mm", "patches.coupling": "load"},
    ),
    "macro, bearing curve": (
        "v2",
        SMALL
        | {
            "sliding.distance": "10 mm",
            "wear.law": "bearing-curve",
            "stepping.scheme": "implicit",
            "disc.synthetic.kind": "self-affine",
            "disc.synthetic.ra": "0.5 um",
        },
    ),
    "layers, jumps": (
        "track",
        {
            "grid.cell": "10 um",
            "sliding.distance": "120 mm",
            "stepping.jump": "auto",
            "disc.layers": [{"name": "coat", "thickness": "0.1 um", "wear": "1e-5 mm^3/N/m"}],
            "output.snapshots": ["20 mm"],
        },
    ),
    "half-space track, jumps": (
        "track",
        {
            "grid.cell": "20 um",
            "contact.law": "half-space",
            "sliding.distance": "60 mm",
            "stepping.jump": "auto",
            "output.snapshots": ["20 mm"],
        },
    ),
    "stresses": (
        "v3-fine",
        SMALL
        | {
            "contact.law": "half-space",
            "sliding.distance": "3 mm",
            "output.stress_depths": ["0 um", "40 um", "80 um"],
        },
    ),
    "programme, swept, stresses": (
        "v3-fine",
        SMALL
        | SWEPT
        | {
            "contact.load": None,
            "sliding.distance": None,
            "output.snapshots": [],
            "output.stress_depths": "auto",
            "block": [{"load": f"{load} N", "passes": 1} for load in (4.0, 16.0, 6.0)],
        },
    ),
    "fretting, gross slip": (
        "v3-fine",
        FRETTING
        | {
            "wear.counter": "1e-6 mm^3/N/m",
            "wear.disc": "1e-6 mm^3/N/m",
            "sliding.kinematics": "fretting",
            "sliding.stroke": "50 um",
            "sliding.cycles": 100_000,
        },
    ),
    "fretting, partial slip": (
        "v3-fine",
        FRETTING
        | {
            "wear.counter": "2e-5 mm^3/N/m",
            "wear.disc": "2e-5 mm^3/N/m",
            "sliding.kinematics": "fretting",
            "sliding.force": "7.2 N",
            "sliding.cycles": 100_000,
        },
    ),
}


def study_of(case: str, every: float) -> Study:
    """Return the study of a case, with a checkpoint every `every` seconds."""
    preset, changes = CASES[case]
    return Study.load(preset).replace(changes | {"run.checkpoint": f"{every} s"})


def differences(one: Path, other: Path) -> list[str]:
    """What differs between the results of two run folders, in any bit."""
    found = []
    with h5py.File(one / "result.h5") as a, h5py.File(other / "result.h5") as b:
        names: list[str] = []
        a.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        others: list[str] = []
        b.visititems(lambda name, item: others.append(name) if isinstance(item, h5py.Dataset) else None)
        if names != others:
            return ["names of the data sets"]
        for name in names:
            mine, theirs = a[name][()], b[name][()]
            if mine.shape != theirs.shape or mine.tobytes() != theirs.tobytes():
                found.append(name)
        if not (a.attrs["finished"] and b.attrs["finished"]):
            found.append("finished")
    for name in ("history.csv", "surface.csv"):
        if (one / name).read_bytes() != (other / name).read_bytes():
            found.append(name)
    return found


def run_here(case: str, every: float, out: Path, threads: int) -> None:
    """Run or resume a case in this process."""
    execution.CELLS_PER_THREAD = 1000  # so that small grids are shared among threads too
    run(study_of(case, every), out=out, threads=threads, plots=False, resume=True).close()


def start(case: str, every: float, out: Path, turn: int) -> subprocess.Popen[bytes]:
    """A process that runs or resumes a case, in the environment of a turn; returns once it has begun."""
    blas, one_core = ENVIRONMENTS[turn % len(ENVIRONMENTS)]
    variables = {} if blas is None else {"OPENBLAS_NUM_THREADS": blas, "OMP_NUM_THREADS": blas}
    threads = 1 if one_core else 1 + (turn // len(ENVIRONMENTS)) % 2
    command = [sys.executable, __file__, "--here", case, str(every), str(out), str(threads)]
    if one_core and hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))
        command = [sys.executable, "-c", ON_ONE_CORE, str(cores[os.getpid() % len(cores)]), *command]
    before = {*out.glob(".work-*")}
    process = subprocess.Popen(command, env=os.environ | variables, stderr=subprocess.PIPE)
    while process.poll() is None:
        if {*out.glob(".work-*")} - before:
            break
        time.sleep(0.001)
    return process


def killed(process: subprocess.Popen[bytes], after: float) -> bool:
    """Return whether a process had to be killed `after` some seconds. RuntimeError if it failed by itself."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        _, told = process.communicate(timeout=after)
        if process.returncode:
            raise RuntimeError(f"a run ended with status {process.returncode}: {told.decode()[-1000:]}")
        return False
    process.kill()
    process.communicate()
    return process.returncode == -signal.SIGKILL


def rows_of(folder: Path) -> list[dict[str, str]]:
    """Return the rows of a sweep's table, without what a clock measured."""
    with open(folder / "table.csv", newline="", encoding="utf-8") as file:
        return [
            {name: cell for name, cell in row.items() if name != "seconds"} for row in csv.DictReader(file)
        ]


def kill_sweeps(many: int, dice: random.Random) -> bool:
    """Kill sweeps with their workers until each has ended, and return whether all tables are alike."""
    kills, alike = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        alone = Path(folder, "alone")
        started = time.monotonic()
        subprocess.run([*SWEEP, "--out", alone], check=True, capture_output=True)
        lasted = time.monotonic() - started
        for turn in range(many):
            out, here = Path(folder, f"killed-{turn}"), 0
            while True:
                patience = dice.uniform(0.2, lasted) if here < 4 else 600.0
                resume = ["--resume"] * (out / "runs").is_dir()
                command = [*SWEEP, "--out", out, *resume]
                process = subprocess.Popen(
                    command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
                )
                with contextlib.suppress(subprocess.TimeoutExpired):
                    _, told = process.communicate(timeout=patience)
                    if process.returncode:
                        raise RuntimeError(
                            f"a sweep ended with status {process.returncode}: {told.decode()[-1000:]}"
                        )
                    break
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
                here += 1
            same = rows_of(alone) == rows_of(out)
            print(f"sweep {turn}: {here} kills, {'the same rows' if same else 'other rows'}", flush=True)
            kills, alike = kills + here, alike + same
    print(f"{kills} kills, {alike} of {many} sweeps the same")
    return alike == many


def main(arguments: list[str]) -> None:
    """Exit status 1 if anything differs."""
    if arguments[:1] == ["--here"]:
        case, every, out, threads = arguments[1:]
        run_here(case, float(every), Path(out), int(threads))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--kills", type=int, default=20, help="in all")
    parser.add_argument("--every", type=float, default=0.0, help="seconds between checkpoints")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--case", choices=CASES, action="append", help="repeatable; all, if not given")
    parser.add_argument("--shard", default="0/1", metavar="k/n", help="which part of how many")
    parser.add_argument("--sweeps", type=int, default=0, help="kill so many sweeps, and no runs")
    options = parser.parse_args(arguments)
    shard, shards = map(int, options.shard.split("/"))
    dice = random.Random(f"{options.seed}, {options.shard}")
    if options.sweeps:
        sys.exit(not kill_sweeps(options.sweeps, dice))
    chosen = options.case or list(CASES)
    jobs = max(len(chosen), shards)  # more shards than cases: cases come several times
    kills, runs, alike, resumed = 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        alone, out = Path(folder, "alone"), Path(folder, "killed")
        for job in range(shard, jobs, shards):
            case = chosen[job % len(chosen)]
            left = (options.kills + job) // jobs
            first = start(case, options.every, alone, 1)
            started = time.monotonic()
            assert not killed(first, 600.0)
            lasted = time.monotonic() - started
            while left > 0:
                here = 0
                while True:
                    patience = dice.uniform(0.0, 0.7 * lasted) if here < left else 600.0
                    process = start(case, options.every, out, here)
                    if not killed(process, patience):
                        break
                    here += 1
                    with contextlib.suppress(OSError):
                        resumed += (out / "checkpoint.h5").stat().st_size > 0
                wrong = differences(alone, out)
                # The lock that a killed process leaves is free, and stays where nothing was left to do.
                names = (p.name for p in out.iterdir() if p.name.startswith((".", "checkpoint")))
                wrong += sorted(name for name in names if name != LOCK)
                print(f"{case}: {here} kills, {', '.join(wrong) or 'bit for bit the same'}", flush=True)
                left, kills, runs, alike = left - here, kills + here, runs + 1, alike + (not wrong)
                shutil.rmtree(out)
            shutil.rmtree(alone)
    print(f"{kills} kills ({resumed} with a checkpoint to go on from), {alike} of {runs} runs the same")
    sys.exit(alike != runs)


if __name__ == "__main__":
    main(sys.argv[1:])
