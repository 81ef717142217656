"""The cases of the benchmark. A model that is added later adds a function and a line to CASES."""

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from contenders.baselines import NumpyLoop, Problem
from contenders.roster import (
    Loop,
    Setting,
    Trace,
    check,
    gap_of,
    in_a_row,
    named,
    package,
    steps,
    study_on,
)
from measure.phases import kernel_times, not_recorded
from measure.timing import Row, Unit, measure, ratio_note

from cases.displaced import sliding
from cases.on_track import finer as sliding_finer
from cases.on_track import run_full_pass, run_track
from cases.patches import patches
from cases.whole_runs import sampled_run, whole_run
from warpwear import Study

#: Folder of the scripts, on the path of a process that measures for itself.
BENCH = str(Path(__file__).parents[1])
EARLY = [3.0e-3] * 10  # [mm]: near F/H
LATE = [2400.0, 3.0, 3.0]  # implicit steps may be long: most of the footprint touches
EARLY_STEP, LATE_STEP = 3.0e-3, 3.0


def early(cells: int, setting: Setting) -> list[Row]:
    """A step of 3 µm after ten of them: the contact is near F/H."""
    return steps("early", study_on(cells), EARLY, EARLY_STEP, Unit(cells), setting)


def late(cells: int, setting: Setting) -> list[Row]:
    """A step of 3 mm after 2400 mm: 61 % of the domain touches."""
    return steps("late", study_on(cells), LATE, LATE_STEP, Unit(cells), setting)


def run_v3(_: int, setting: Setting) -> list[Row]:
    """The whole of v3: 8000 explicit steps on 150² cells."""
    study = Study.load("v3")
    return whole_run("v3", study, Unit(study.cells.nx), setting, share=0.2 if setting.quick else 1.0)


def run_fine(_: int, setting: Setting) -> list[Row]:
    """The whole of v3-fine: 1099 balanced steps on 1500² cells."""
    return _run("v3-fine", Study.load("v3-fine"), setting)


def run_springs(_: int, setting: Setting) -> list[Row]:
    """The whole of v3-fine on springs of 1.9e6 N/mm³ capped at 590 MPa."""
    study = Study.load("v3-fine").replace(
        {"contact.stiffness": "1.9e6 N/mm^3", "contact.hardness": "590 MPa"}
    )
    return _run("v3-fine-springs", study, setting)


def _run(case: str, study: Study, setting: Setting) -> list[Row]:
    unit = Unit(study.cells.nx)
    if setting.quick:
        return sampled_run(case, study, 8, unit, setting)
    return whole_run(case, study, unit, setting)


def finer(_: int, setting: Setting) -> list[Row]:
    """The early step at 1 and at 0.5 µm on the same 2.048 mm: what halving the cell costs."""
    rows: list[Row] = []
    threads = max(setting.threads)
    for cells in (2048, 4096):
        study = study_on(cells, extent=2.048)
        trace: Trace = []
        with package(study, setting, threads) as fresh:
            model = fresh()
            trace.extend(in_a_row(model, EARLY))
            seconds, units = measure(
                lambda model=model, trace=trace: trace.append(model.advance(EARLY_STEP)),  # type: ignore[misc]
                Unit(cells),
                setting.repeats,
            )
        in_numpy = NumpyLoop(Problem.of(study), gap_of(study))
        check("finer", {named(threads): trace, "NumPy": [in_numpy.advance(d) for d in EARLY]})
        name = f"{named(threads)}, {1e3 * study.grid.cell:g} µm"
        note = ratio_note("0.5 µm over 1 µm", Row("", 0, "", seconds, units), rows[0]) if rows else ""
        rows.append(Row("finer", cells, name, seconds, units, note))
    return rows


def second_thread(cells: int, setting: Setting) -> list[Row]:
    """The late step by one thread and by two, in turns."""
    study = study_on(cells)
    unit = Unit(cells)
    traces: dict[str, Trace] = {}
    rows: list[Row] = []
    with package(study, setting, 1) as fresh_one, package(study, setting, 2) as fresh_two:
        models = {named(1): fresh_one(), named(2): fresh_two()}
        for name, model in models.items():
            traces[name] = list(in_a_row(model, LATE))
        times: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in models}
        for i in range(1 + setting.repeats):
            for name, model in models.items():
                taken = measure(
                    lambda name=name, model=model: traces[name].append(model.advance(LATE_STEP)),  # type: ignore[misc]
                    unit,
                    1,
                    warm_ups=0,
                )
                for kept, new in zip(times[name], taken, strict=True):
                    kept.extend(new if i else [])
    check("threads", traces)
    for name in models:
        rows.append(Row("threads", cells, name, *times[name]))
    return [rows[0], Row("threads", cells, rows[1].contender, *times[rows[1].contender],
                         ratio_note("one thread over two", *rows))]  # fmt: skip


def phases(cells: int, setting: Setting) -> list[Row]:
    """Balance, wear and the rest of a step, one thread."""
    study = study_on(cells)
    unit = Unit(cells)
    rows = []
    for when, before, increment in (("early", EARLY, EARLY_STEP), ("late", LATE, LATE_STEP)):
        with not_recorded(), package(study, setting, 1) as fresh:
            model = fresh()
            trace = list(in_a_row(model, [*before, increment]))
            spent: list[dict[str, float]] = []

            def run(model: Loop, increment: float, trace: Trace, spent: list[dict[str, float]]) -> None:
                with kernel_times() as times:
                    trace.append(model.advance(increment))
                spent.append(dict(times))

            run_now = partial(run, model, increment, trace, spent)
            seconds, units = measure(run_now, unit, setting.repeats)
            del model, run_now
        in_numpy = NumpyLoop(Problem.of(study), gap_of(study))
        check("phases", {named(1): trace, "NumPy": [in_numpy.advance(d) for d in [*before, increment]]})
        del in_numpy
        spent = spent[-setting.repeats :]
        for i, of_kernels in enumerate(spent):
            of_kernels["rest"] = seconds[i] - sum(of_kernels.values())
        names = sorted({name for times in spent for name in times} - {"rest"})
        for name in [*names, "rest"]:
            part = [times.get(name, 0.0) for times in spent]
            share = statistics.median(part) / statistics.median(seconds)
            rows.append(Row("phases", cells, f"{when} step: {name}", part, units, f"{100 * share:.0f} %"))
    return rows


def memory(cells: int, setting: Setting) -> list[Row]:
    """Peak memory of a run of ten steps above that after its imports, in float64 fields of its size."""
    command = [sys.executable, "-m", "measure.memory", str(cells), str(max(setting.threads))]
    path = os.pathsep.join(filter(None, (BENCH, os.environ.get("PYTHONPATH"))))
    start = time.perf_counter()
    answer = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": path})
    took = time.perf_counter() - start
    if answer.returncode:
        raise RuntimeError(
            f"memory on {cells} × {cells} cells was not measured: {answer.stderr.strip()[-300:]}"
        )
    found = float(answer.stdout)
    row = Row(
        "memory", cells, named(max(setting.threads)), [took], [], f"{found:.2f} fields", {"fields": found}
    )
    return [row]


@dataclass(frozen=True)
class Case:
    """A line of the table of cases."""

    run: Callable[[int, Setting], list[Row]]
    sizes: tuple[int, ...] | None = None  # cells along a side; None: those asked for
    default_sizes: tuple[int, ...] | None = None  # where none is asked for; None: the table's
    fields: float = 10.5  # float64 fields of that size that it holds at its peak
    threads: int = 1  # that it needs

    @property
    def about(self) -> str:
        return (self.run.__doc__ or "").strip()


CASES: dict[str, Case] = {
    "early": Case(early),
    "late": Case(late),
    "v3": Case(run_v3, sizes=(150,)),
    "v3-fine": Case(run_fine, sizes=(1500,)),
    "v3-fine-springs": Case(run_springs, sizes=(1500,)),
    "finer": Case(finer, sizes=(4096,), fields=12.0),
    "threads": Case(second_thread, fields=12.0, threads=2),
    "phases": Case(phases),
    "sliding": Case(sliding, fields=14.0),
    "patches": Case(patches, sizes=(1500,), fields=20.0),
    "sliding-finer": Case(sliding_finer, sizes=(4096,), fields=12.0),
    "track": Case(run_track, sizes=(750,), fields=40.0),
    "track-pass": Case(run_full_pass, sizes=(1500,), fields=120.0),
    "memory": Case(memory),
}
#: What --quick takes where no size is asked for.
QUICK_SIZES = (2048,)
