"""Where the time of `warpwear run` goes, cold and warm, phase by phase and figure by figure.

    python bench/command.py [v3-fine] [--plots essential] [--threads 1] [--repeats 3] [--set KEY=VALUE]

Every run is a process of its own, cold and warm in turns; a line gives the median seconds of each. With one
thread all figures are drawn by that process, one after another: each is a line. With more a second process
draws them meanwhile, and `draw` is what is waited for. `whole` is what a person waits, `cpu` what the process
and its helpers used: on a machine that others use it is the one to compare.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from statistics import median

import click

#: What a process runs: the command line, with its clock kept and each figure a phase.
CHILD = """
import json, sys
from warpwear import clock
from warpwear.cli.main import main
from warpwear.figures.of_run import table
from warpwear.runs import run
clocks = []
class Kept(clock.Clock):
    def __init__(self, **how):
        super().__init__(**how)
        clocks.append(self)
save = table.Plotter.save
def timed(self, name, *given, **how):
    with clock.phase("figure " + name):
        return save(self, name, *given, **how)
run.Clock, table.Plotter.save = Kept, timed
try:
    main()
finally:
    phases = {k: v for k, v in clocks[0].phases.items() if k}
    print("PHASES", json.dumps(phases), file=sys.stderr)
"""


def measure(arguments: list[str], cache: Path) -> dict[str, float]:
    """Seconds of the phases of one command, of all of it, and of the processor. cache: of its kernels."""
    home = str(Path(__file__).parents[1])
    paths = os.pathsep.join(filter(None, (home, os.environ.get("PYTHONPATH"))))
    environment = os.environ | {"PYTHONPATH": paths, "WARP_CACHE_PATH": str(cache)}
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-c", CHILD, "run", *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    whole, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise click.ClickException(done.stderr)
    told = [line for line in done.stderr.splitlines() if line.startswith("PHASES ")]
    phases: dict[str, float] = json.loads(told[-1].removeprefix("PHASES "))
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return phases | {"whole": whole, "cpu": cpu}


@click.command(help=__doc__)
@click.argument("study", default="v3-fine")
@click.option("--plots", default="essential", show_default=True)
@click.option("--threads", type=int)
@click.option("--repeats", default=3, show_default=True)
@click.option("--set", "changes", multiple=True)
def main(study: str, plots: str, threads: int | None, repeats: int, changes: tuple[str, ...]) -> None:
    """Measure, and print a line a phase."""
    arguments = [study, "--plots", plots, *(word for change in changes for word in ("--set", change))]
    arguments += [] if threads is None else ["--threads", str(threads)]
    found: dict[str, dict[str, list[float]]] = defaultdict(lambda: {"cold": [], "warm": []})
    with tempfile.TemporaryDirectory() as folder:
        for number in range(repeats):
            cache = Path(folder, f"cache-{number}")
            for state in ("cold", "warm"):
                out = ["--out", str(Path(folder, f"{state}-{number}"))]
                for name, seconds in measure([*arguments, *out], cache).items():
                    found[name][state].append(seconds)
    click.echo(f"{'seconds, median':28}{'cold':>9}{'warm':>9}")
    for name, times in found.items():
        cells = (f"{median(values):9.2f}" if values else f"{'-':>9}" for values in times.values())
        click.echo(f"{name:28}{''.join(cells)}")


if __name__ == "__main__":
    main()
