"""The half-space beside its peers, in turns: one surface, one residual for all pressures, ratios of pairs.

    python bench/half_space.py --cells 512 1024 [--peers PYTHON …] [--turns 7] [--json FILE]
    python bench/half_space.py --cells 4096 --jobs 8 --limit 570 --like FILE [--peers PYTHON] --json OTHER
    python bench/half_space.py --cells 8192 --contenders --threads 2

Each contender solves in a process of its own, in turns with ours; one that is not installed is left out
(PYTHON: interpreters that have tamaas, ContactMechanics or ASPHER). The residual is of everybody's pressure
and made by NumPy: the largest violation of complementarity over the rms height, at the level that makes it
least. Under a free boundary ours is `solve_contact`, whose iterations are pairs of transforms. A peer's own
tolerance is the loosest of a few with which its residual is what is asked, and its setting the best of those
given. Ratios are medians over the turns of the peer's time over ours; processor time is what counts on a
machine that does other work. Memory is that of a first solve, above what was held before. Without contenders
ours solves alone.

On a machine with many cores rows may run side by side, each on cores of its own. With the record of another
size a peer is given the setting and tolerance that were best there, or a stricter tolerance where that does
not do here. Rows that are there already are taken from the file.
"""

import argparse
import json
import math
import os
import queue
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from cases.half_space import CASES, Case, judge
from contenders.half_space import MODULUS
from contenders.process import Contender
from measure.machine import machine

TARGETS = (1e-4, 1e-8)
#: A peer's own tolerance over the residual asked of it: the first that gives it is taken.
FACTORS = (1.0, 0.3, 0.1, 0.03, 0.01)
#: Load that a pressure may miss, relatively, over the residual asked.
LOAD = 1e-2
#: Nobody waits longer for one solve of a peer [s].
PATIENCE = 600.0


def knows(name: str, case: Case) -> bool:
    """Whether a contender has what a case needs."""
    peers = {"ASPHER": math.isinf(case.cap), "tamaas": not case.ball, "ContactMechanics": not case.ball}
    return peers.get(name, True)


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


def ready(
    contender: Contender,
    asked: dict[str, Any],
    heights: Any,
    case: Case,
    target: float,
    known: dict[str, Any],
) -> list[dict[str, Any]]:
    """The contender's settings that give the residual, with the loosest tolerance; the quickest two.

    known: a row of another size, whose setting and tolerance are tried first.
    """
    found = []
    ours = contender.name == "warpwear"
    least = known.get("their_tolerance", target) / target
    for setting in [known["setting"]] if known and not ours else settings(contender.name, case, target):
        for factor in (1.0,) if ours else [f for f in FACTORS if f <= least * 1.001]:
            trial = {**asked, "setting": setting, "tolerance": factor * target}
            record = contender.solve(trial)
            if not record:
                break
            record |= judge(heights, np.load(asked["pressure"]), case)
            record |= {"trial": trial, "first": contender.solves == 1}
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
    like = options.like["rows"] if options.like else []
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
        if not options.contenders:
            with Contender("warpwear", [], options.threads) as us:
                record = ready(us, asked, heights, case, target, {})[0]
            rows.append(common | {key: value for key, value in record.items() if key != "trial"})
            print(json.dumps(rows[-1]), flush=True)
        for peer in options.contenders:
            if peer in options.without or not knows(peer, case):
                continue
            try:
                with (
                    Contender("warpwear", [], options.threads) as us,
                    Contender(peer, options.peers, options.threads) as other,
                ):
                    ours = ready(us, asked, heights, case, target, {})
                    same = {"case": name, "target": target, "contender": peer}
                    known = [row for row in like if same.items() <= row.items() and "setting" in row]
                    tried = [
                        _turns(us, other, ours[0], one, options)
                        for one in ready(other, asked, heights, case, target, known[0] if known else {})
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
    long = theirs["processor_seconds"] >= options.long
    if long:  # nobody waits for it twice
        turns = {"ours": [us.solve(ours["trial"] | {"pressure": ""})], "theirs": [theirs]}
    for _ in range(0 if long else options.turns):
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
        first = record["first"] and record["processor_seconds"] >= options.long
        memory = record["memory_mib"] if first else memory_of(contender.name, record["trial"], options)
        row[f"{side}_memory_mib"] = memory
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


def side_by_side(wanted: list[tuple[int, str, float]], options: argparse.Namespace) -> None:
    """Compare rows in processes of their own, the largest first, and print and store each as it comes."""
    end = time.monotonic() + options.limit
    cores, writing = sorted(os.sched_getaffinity(0)), threading.Lock()
    places: queue.Queue[list[int]] = queue.Queue()
    for job in range(options.jobs):
        first = job * len(cores) // options.jobs
        places.put(cores[first : first + options.threads])

    def one(row: tuple[int, str, float]) -> None:
        mine, (cells, name, target) = places.get(), row
        with tempfile.TemporaryDirectory() as folder:
            words = {"cells": cells, "cases": name, "targets": target, "threads": options.threads}
            words |= {"turns": options.turns, "long": options.long, "json": f"{folder}/rows.json"}
            lists = {"peers": options.peers, "contenders": options.contenders, "without": options.without}
            command = [sys.executable, __file__, *(f"--{key}={value}" for key, value in words.items())]
            for key, values in lists.items():
                command += [f"--{key}", *values]
            if options.like:
                Path(f"{folder}/like.json").write_text(json.dumps(options.like))
                command.append(f"--like={folder}/like.json")
            try:
                subprocess.run(
                    command,
                    timeout=max(end - time.monotonic(), 0.1),
                    stdout=subprocess.DEVNULL,
                    preexec_fn=lambda: os.sched_setaffinity(0, mine),
                    check=False,
                )
                found = json.loads(Path(f"{folder}/rows.json").read_text())["rows"]
            except (subprocess.TimeoutExpired, OSError):
                print(f"{cells:5d} {name:10} {target:.0e} not done in time", flush=True)
                return
            finally:
                places.put(mine)
        with writing:
            store(found, options)
            for each in found:
                print(line_of(each) if "contender" in each else json.dumps(each), flush=True)

    with ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(one, sorted(wanted, key=lambda row: (-row[0], row[2]))))


KEY = ("cells", "case", "target", "threads", "contender")


def store(rows: list[dict[str, Any]], options: argparse.Namespace) -> None:
    """Add rows to the record, or put them in the place of what they measure again."""
    if options.json is None:
        return
    before = json.loads(options.json.read_text())["rows"] if options.json.is_file() else []
    new = [[row.get(key) for key in KEY] for row in rows]
    rows = [row for row in before if [row.get(key) for key in KEY] not in new] + rows
    record = {"machine": machine(), "device": options.device, "rows": rows}
    options.json.write_text(json.dumps(record, indent=1) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cells", type=int, nargs="+", default=[512])
    parser.add_argument("--peers", nargs="+", default=[sys.executable], help="interpreters that have them")
    parser.add_argument("--cases", nargs="+", choices=CASES, default=[*CASES])
    parser.add_argument("--targets", type=float, nargs="+", default=TARGETS)
    parser.add_argument("--contenders", nargs="*", default=["ASPHER", "ContactMechanics", "tamaas"])
    parser.add_argument("--without", nargs="*", default=[], help="such as tamaas, which takes minutes")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--turns", type=int, default=7)
    parser.add_argument(
        "--long", type=float, default=20.0, help="a peer's seconds from which a turn is enough"
    )
    parser.add_argument("--device", default="cpu", help="of warpwear")
    parser.add_argument("--like", type=Path, help="record of another size, for a peer's settings")
    parser.add_argument("--jobs", type=int, default=0, help="rows at a time, each on cores of its own")
    parser.add_argument("--limit", type=float, default=math.inf, help="seconds for all rows, with --jobs")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    options.like = json.loads(options.like.read_text()) if options.like else None
    if options.contenders:
        print("cells case       to    beside           " + "".join(f"{head:>9}" for head in HEADS))
    wanted = list(product(options.cells, options.cases, options.targets))
    if options.jobs:
        done = json.loads(options.json.read_text())["rows"] if options.json and options.json.is_file() else []
        have = [(row["cells"], row["case"], row["target"]) for row in done]
        side_by_side([row for row in wanted if row not in have], options)
        return
    for cells, name, target in wanted:
        store(compare(name, cells, target, options), options)


if __name__ == "__main__":
    main()
