"""Time what the README and the page of models give seconds for, and record it in bench/recorded/seconds.json.

    python bench/cases/seconds.py [--rows v1,v3-fine] [--turns 3] [--tree CHECKOUT] [--device cuda:0]
                                  [--write]

Runs are processes of their own, on two cores, with warm kernels, in turns; a row keeps the seconds of each
turn. Dear rows run once. `--tree` times another checkout, so that the history gets older commits. `--write`
puts the medians into both, where the tests compare them with the newest record that has the row.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from statistics import median
from typing import Any

import click

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "bench")]

from contenders.roster import Setting  # noqa: E402
from measure.machine import machine  # noqa: E402

import warpwear  # noqa: E402
from cases.on_gpu import CASES_GPU  # noqa: E402
from cases.table import CASES  # noqa: E402

RECORD = ROOT / "bench" / "recorded" / "seconds.json"
HALF_SPACE = "contact.law=half-space"


@dataclass(frozen=True)
class Command:
    """`warpwear run` with arguments; dear: run once, without a warm-up."""

    arguments: tuple[str, ...]
    dear: bool = False


def run(study: str, *changes: str, plots: str = "none", dear: bool = False) -> Command:
    """A command that runs a study."""
    changed = [word for change in changes for word in ("--set", change)]
    return Command((study, "--plots", plots, *changed), dear)


COMMANDS = {
    "v1": run("v1"),
    "v3-fine": run("v3-fine"),
    "v3-fine, figures": run("v3-fine", plots="essential"),
    "half-space, 5 um": run("v3-fine", HALF_SPACE, "grid.cell=5 um"),
    "half-space, 1 um": run("v3-fine", HALF_SPACE, dear=True),
    "track": run("track", dear=True),
    "running-in": run("running-in", "grid.cell=5 um", "sliding.distance=900 mm", dear=True),
    "patches half-space, 5 um": run("two-scale", HALF_SPACE, "grid.cell=5 um"),
    "patches half-space, 2.5 um": run("two-scale", HALF_SPACE, "grid.cell=2.5 um"),
}

#: Where the seconds stand.
PAGES = (ROOT / "README.md", ROOT / "docs" / "theory" / "models.md")
#: What they say, as a pattern whose group is the figure, and the row that it comes from.
NUMBER = r"((?:[\d.]+ to )?[\d.]+ (?:s|ms|min|times)|minutes|a minute)"
FIGURES: tuple[tuple[str, str], ...] = (
    ("v1", rf"`v1` \| about {NUMBER}"),
    ("v3-fine", rf"`v3-fine` \| 1 µm cells: about {NUMBER}"),
    ("half-space, 5 um", rf"`contact.law` set \| 5 µm cells: {NUMBER}; 1 µm"),
    ("half-space, 1 um", rf"`contact.law` set .*1 µm: about {NUMBER}"),
    ("track", rf"`track` \| 2 µm cells: {NUMBER}"),
    ("contact on a track", rf"{NUMBER} a contact at 10 µm cells"),
    ("running-in", rf"`running-in` \| 5 µm cells, 900 mm: {NUMBER}"),
    ("patches over one scale", rf"{NUMBER} `micro`, late steps"),
    ("patches half-space, 5 um", rf"hard bodies .*5 µm cells: {NUMBER}; 2.5 µm"),
    ("patches half-space, 2.5 um", rf"hard bodies .*2.5 µm: {NUMBER}"),
    ("v3-fine", rf"cells in about {NUMBER} on two quiet cores"),
    ("steps", rf"steps alone take {NUMBER},"),
    ("steps in NumPy", rf"NumPy {NUMBER}, on"),
    ("steps on a GPU", rf"H200 GPU {NUMBER}"),
)


def told(row: str, seconds: Sequence[float]) -> str:
    """Say what the README says of a row: the median, or for a ratio of steps the range."""
    if row == "patches over one scale":
        ends = dict.fromkeys(f"{end(seconds):.1f}" for end in (min, max))  # once if they are the same
        return f"{' to '.join(ends)} times"
    middle = median(seconds)
    if row == "contact on a track":
        return f"{1e3 * middle:.2g} ms"
    if middle >= 100.0:
        return f"{middle / 60.0:.0f} min"
    if middle >= 10.0:
        return f"{middle:.0f} s"
    return f"{middle:.1f} s".replace(".0 ", " ") if middle >= 1.0 else f"{middle:.2g} s"


def newest(records: Sequence[dict[str, Any]]) -> dict[str, list[float]]:
    """Seconds of each row, from the last record that has it."""
    found: dict[str, list[float]] = {}
    for record in records:
        found |= record["rows"]
    return found


def written(text: str, rows: dict[str, list[float]]) -> str:
    """Return the text of a page with the figures of the rows, as far as it has them."""
    for row, pattern in FIGURES:
        if row in rows:
            place = re.search(pattern, text)
            if place is not None:
                text = text[: place.start(1)] + told(row, rows[row]) + text[place.end(1) :]
    return text


def of_command(command: Command, tree: Path, turns: int) -> list[float]:
    """Seconds of every turn of a command, as a person waits for it."""
    environment = os.environ | {"PYTHONPATH": str(tree), "MPLBACKEND": "agg"}
    seconds = []
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(1 if command.dear else 1 + turns):
            words = [sys.executable, "-m", "warpwear", "run", *command.arguments, "--out", f"{folder}/{turn}"]
            start = time.perf_counter()
            done = subprocess.run(
                words, env=environment, cwd=folder, capture_output=True, text=True, check=False
            )
            seconds.append(time.perf_counter() - start)
            if done.returncode:
                raise click.ClickException(f"{' '.join(words)}: {done.stderr[-500:]}")
    return seconds if command.dear else seconds[1:]


def of_contacts(turns: int, _: str) -> Iterator[tuple[str, list[float]]]:
    """Seconds a contact of a ball that slides on the half-space, at 10 µm cells on 0.9 mm."""
    changes = {
        "contact.law": "half-space",
        "grid.cell": "10 um",
        "grid.extent": "0.9 mm",
        "sliding.distance": "30 mm",
        "output.snapshots": [],
    }
    study, seconds = warpwear.Study.load("track").replace(changes), []
    for _turn in range(1 + turns):
        with warpwear.run(study) as result:
            seconds.append(result.seconds["solve"] / float(result.history["parts"].sum()))
    yield "contact on a track", seconds[1:]


def of_steps(turns: int, _: str) -> Iterator[tuple[str, list[float]]]:
    """Steps of v3-fine alone: ours, in C and in NumPy."""
    names = {"warpwear, 2 threads": "steps", "C, 2 threads": "steps in C", "NumPy": "steps in NumPy"}
    for row in CASES["v3-fine"].run(1500, Setting((2,), "cpu", turns, False)):
        if row.contender in names:
            yield names[row.contender], row.seconds


def of_patches(turns: int, _: str) -> Iterator[tuple[str, list[float]]]:
    """Late steps of patches, without and with springs, over those of one scale."""
    rows = CASES["patches"].run(1500, Setting((2,), "cpu", max(turns, 5), False))
    one_scale, *patches = [row.median for row in rows if row.contender.startswith("late: ")]
    yield "patches over one scale", [seconds / one_scale for seconds in patches]


def of_gpu(turns: int, device: str) -> Iterator[tuple[str, list[float]]]:
    """Steps of v3-fine alone on a GPU."""
    (row,) = CASES_GPU["gpu-v3-fine"].run(1500, Setting((1,), device, turns, False))
    yield "steps on a GPU", list(row.seconds)


#: What is timed within a process of this checkout: number of turns, device -> rows.
WITHIN: dict[str, Callable[[int, str], Iterator[tuple[str, list[float]]]]] = {
    "contact on a track": of_contacts,
    "steps": of_steps,
    "patches over one scale": of_patches,
}


def commit_of(tree: Path) -> tuple[str, str]:
    """Commit of a checkout and its date; that of now and no commit where git does not know it."""
    asked = ["git", "-C", str(tree), "log", "-1", "--format=%h %cI"]
    done = subprocess.run(asked, capture_output=True, text=True, check=False)
    if done.returncode:
        return "", datetime.now(UTC).isoformat(timespec="seconds")
    commit, date = done.stdout.split()
    return commit, date


@click.command(help=__doc__)
@click.option(
    "--rows", "names", help=f"Rows between commas: {', '.join([*COMMANDS, *WITHIN])}. Default: all."
)
@click.option("--turns", default=3, show_default=True)
@click.option("--tree", type=click.Path(path_type=Path, exists=True, file_okay=False), default=ROOT)
@click.option("--device", default="cpu", show_default=True, help="cuda:0: the row of a GPU alone.")
@click.option("--commit", help="Name of the commit, where the checkout has no git.")
@click.option("--write", is_flag=True, help="Put the medians into the pages.")
def main(names: str | None, turns: int, tree: Path, device: str, commit: str | None, write: bool) -> None:
    """Time, print a line a row, and add a record."""
    asked = [*COMMANDS, *WITHIN] if names is None else re.split(r",(?! )", names)
    if device != "cpu":
        asked, table = ["steps on a GPU"], {"steps on a GPU": of_gpu}
    else:
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])  # and of what it starts
        table = WITHIN if tree.resolve() == ROOT else {}
    known, date = commit_of(tree)
    load = os.getloadavg()[0]
    if load > 0.5:
        click.echo(f"Other processes are at work (load {load:.1f}): times will be too long.", err=True)
    rows: dict[str, list[float]] = {}
    for name in asked:
        if name in COMMANDS:
            found = {name: of_command(COMMANDS[name], tree, turns)}.items()
        elif name in table:
            found = dict(table[name](turns, device)).items()
        else:
            raise click.ClickException(f"--rows: {name!r} is not one that can be timed here.")
        for row, seconds in found:
            rows[row] = [round(value, 5) for value in seconds]
            click.echo(f"{row:28}{told(row, seconds):>16}   {min(seconds):.4g} to {max(seconds):.4g}")
    records = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.is_file() else []
    here = machine() | {"device": device, "cores_used": len(os.sched_getaffinity(0))}
    record = {"commit": commit or known, "date": date, "load": round(load, 2), "machine": here, "rows": rows}
    same = [old for old in records if (old["commit"], old["machine"]) == (record["commit"], here)]
    if same and record["commit"]:
        same[0]["rows"] |= rows
    else:
        records.append(record)
    records.sort(key=lambda one: datetime.fromisoformat(one["date"]))
    RECORD.write_text(json.dumps(records, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    if write:
        for page in PAGES:
            text = page.read_text(encoding="utf-8")
            page.write_text(written(text, newest(records)), encoding="utf-8")


if __name__ == "__main__":
    main()
