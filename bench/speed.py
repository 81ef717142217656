"""What the package costs, beside plain NumPy, C and the published way, in passes over memory.

    python bench/speed.py [--cases late,v3-fine] [--sizes 2048,4096] [--threads 1,2] [--repeats 5] [--quick]
                          [--json FILE]
    python bench/speed.py --device cuda:0      (JSON on standard output, the table on standard error)

A pass is `numpy.subtract(S, D, out=G)` on float64 fields of the same size, timed right before each repeat. A
time is the median of the repeats, with the shortest and the longest; "beside" is its ratio to that of the
package with most threads. Every contender's approach, volumes and area are compared to 1e-9 before a time of
a case is printed.
"""

import json
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import click
import psutil
from cases.table import CASES, QUICK_SIZES, Case
from contenders.c_loop import NoCompilerError, compiler_version, library
from contenders.roster import DisagreementError, Setting
from measure.machine import machine
from measure.timing import Row

import warpwear
from warpwear.engine.device import find_device
from warpwear.engine.executor import Executor
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import Grid

SIZES = (1024, 2048, 4096, 8192, 16384)
FEWEST_REPEATS = 5


def whole_numbers(text: str, option: str) -> tuple[int, ...]:
    """Positive whole numbers between commas. Raises InputError."""
    try:
        found = tuple(int(part) for part in text.split(","))
    except ValueError:
        found = ()
    if not found or min(found) < 1:
        raise InputError(f"{option} = {text!r}: positive whole numbers between commas are expected.")
    return found


def chosen(names: str | None, cases: dict[str, Case]) -> dict[str, Case]:
    """The cases asked for. Raises InputError."""
    if names is None:
        return cases
    for name in names.split(","):
        if name not in cases:
            raise InputError(f"--cases: {name!r} is not one of {', '.join(cases)}.")
    return {name: cases[name] for name in names.split(",")}


def gib_needed(case: Case, cells: int) -> float:
    return case.fields * 8 * cells**2 / 2**30


def plan_of(
    cases: dict[str, Case], sizes: tuple[int, ...] | None, setting: Setting
) -> tuple[list[tuple[str, int]], list[str]]:
    """Pairs of case and size, and sentences on what is left out. InputError for a size asked for in vain."""
    left_out = []
    jobs = []
    free = psutil.virtual_memory().available / 2**30
    for name, case in cases.items():
        asked = case.default_sizes or (QUICK_SIZES if setting.quick else SIZES) if sizes is None else sizes
        for cells in case.sizes or asked:
            if gib_needed(case, cells) <= free:
                jobs.append((name, cells))
                continue
            sentence = (
                f"{name} on {cells} × {cells} cells needs {gib_needed(case, cells):.1f} GiB of memory; "
                f"{free:.1f} GiB are free"
            )
            if sizes is not None and case.sizes is None:
                raise InputError(f"--sizes: {sentence}.")
            left_out.append(f"left out: {sentence}.")
    return sorted(jobs, key=lambda job: job[1]), left_out  # a size's cases share its disc


def line_of(row: Row, beside: Row | None, per_second: float) -> str:
    """One line of the table."""
    spread = f"{per_second * min(row.seconds):.4g}–{per_second * max(row.seconds):.4g}"
    passes = "" if row.passes is None else f"{row.passes:,.0f}" if row.passes > 1000 else f"{row.passes:.3g}"
    ratio = "" if beside is None or beside is row else f"{row.median / beside.median:.3g}×"
    median = f"{per_second * row.median:.4g}"
    return f"  {row.contender:<38}{median:>8}{spread:>17}{passes:>9}{ratio:>8}  {row.note}"


def reference_among(rows: Sequence[Row]) -> Row | None:
    """What others than the package are compared with: the package with most threads."""
    own = [row for row in rows if row.contender.startswith("warpwear")]
    if len(own) == len(rows):
        return None
    same = [row for row in own if not row.contender.endswith(("gap from heights", "whole"))]
    return (same or own)[-1] if own else None


def show(name: str, cells: int, about: str, rows: Sequence[Row], *, err: bool) -> None:
    unit = [second for row in rows for second in row.unit_seconds]
    one = f", a pass {1e3 * sorted(unit)[len(unit) // 2]:.3g} ms" if unit else ""
    in_seconds = max(row.median for row in rows) >= 1.0
    head = f"  {'':<38}{'s' if in_seconds else 'ms':>8}{'lowest–highest':>17}{'passes':>9}{'beside':>8}"
    click.echo(f"\n{name}, {cells} × {cells} cells{one}: {about}\n{head}", err=err)
    beside = reference_among(rows)
    for row in rows:
        click.echo(line_of(row, beside, 1.0 if in_seconds else 1e3), err=err)


def versions() -> dict[str, Any]:
    try:
        own = version("warpwear")
    except PackageNotFoundError:
        own = warpwear.__version__
    return {"warpwear": own, "c_compiler": compiler_version()}


@click.command(context_settings={"max_content_width": 110})
@click.option("--cases", "names", help=f"Cases between commas: {', '.join(CASES)}. Default: all.")
@click.option("--sizes", help=f"Cells along a side. Default: those of {', '.join(map(str, SIZES))} that fit.")
@click.option(
    "--threads", default=None, help="Thread counts between commas. Default: 1,2 where there are two."
)
@click.option("--device", default="cpu", show_default=True, help="cpu or cuda:0.")
@click.option(
    "--repeats", default=str(FEWEST_REPEATS), show_default=True, help="Repeats of each time, 5 at least."
)
@click.option("--quick", is_flag=True, help="2048² alone, and runs extrapolated from a few of their steps.")
@click.option("--json", "file", type=click.Path(path_type=Path, dir_okay=False), help="JSON file to write.")
def main(
    names: str | None,
    sizes: str | None,
    threads: str | None,
    device: str,
    repeats: str,
    quick: bool,
    file: Path | None,
) -> None:
    """What the package costs, beside plain NumPy, C and the published way, in passes over memory."""
    try:
        measure_all(names, sizes, threads, device, repeats, quick, file)
    except InputError as error:
        click.echo(str(error), err=True)
        sys.exit(2)
    except (DisagreementError, ConvergenceError) as error:
        click.echo(str(error), err=True)
        sys.exit(1)


def measure_all(
    names: str | None,
    sizes: str | None,
    threads: str | None,
    device: str,
    repeats: str,
    quick: bool,
    file: Path | None,
) -> None:
    """Checks what can fail first, then every case. Raises InputError."""
    if not repeats.isdecimal() or int(repeats) < FEWEST_REPEATS:
        raise InputError(f"--repeats = {repeats!r} is not possible; allowed are {FEWEST_REPEATS} and more.")
    if file is not None and not file.absolute().parent.is_dir():
        raise InputError(f"--json = {file}: the folder {file.absolute().parent} is not there.")
    on_gpu = find_device(device).is_cuda
    if threads is None:
        with Executor(Grid(8, 8, 1.0)) as executor:
            counts: tuple[int, ...] = (1, 2) if executor.threads > 1 and not on_gpu else (1,)
    else:
        counts = tuple(sorted(set(whole_numbers(threads, "--threads"))))
    for count in counts:
        Executor(Grid(8, 8, 1.0), threads=count).__exit__()
    setting = Setting(threads=counts, device=device, repeats=int(repeats), quick=quick)
    table = CASES
    if on_gpu:
        from cases.on_gpu import CASES_GPU

        table = CASES_GPU
    cases = chosen(names, table)
    jobs, left_out = plan_of(cases, None if sizes is None else whole_numbers(sizes, "--sizes"), setting)
    try:
        library()
    except NoCompilerError as error:
        left_out.append(f"{error}.")
    report: dict[str, Any] = {
        "machine": machine(),
        "versions": versions(),
        "device": str(find_device(device)),
        "repeats": setting.repeats,
        "quick": quick,
        "left_out": left_out,
        "rows": [],
    }
    for sentence in left_out:
        click.echo(sentence, err=True)
    click.echo(f"{report['machine']['processor']}, {report['machine']['cores']} cores", err=on_gpu)
    for name, cells in jobs:
        rows = cases[name].run(cells, setting)
        show(name, cells, cases[name].about, rows, err=on_gpu)
        beside = reference_among(rows)
        for row in rows:
            ratio = row.median / beside.median if beside is not None else None
            report["rows"].append(row.record() | {"beside_warpwear": ratio})
        if file is not None:  # after each case, so that an interrupted run leaves what it measured
            file.write_text(json.dumps(report, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    if on_gpu:
        click.echo(json.dumps(report, ensure_ascii=False))


if __name__ == "__main__":
    main()
