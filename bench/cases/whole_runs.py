"""Whole runs, or steps spread over one from which the whole is extrapolated."""

import itertools
import time
from collections.abc import Callable, Sequence
from copy import copy

import numpy as np
from contenders.baselines import FloatArray, NumpyLoop, Problem, sag_of
from contenders.published import PublishedLoop
from contenders.roster import (
    Loop,
    Package,
    Setting,
    Trace,
    c_loops,
    check,
    gap_of,
    heights_of,
    in_a_row,
    named,
    package,
)
from measure.timing import Row, Unit, measure

from warpwear import Study
from warpwear.laws.track import increments

#: Steps timed in a row at each place of a sampled run.
IN_A_ROW = 2


def plan_of(study: Study) -> list[float]:
    """The increments of a run [mm]."""
    stops = set(study.output.snapshots)
    return [d for d, _ in increments(study.increments, study.sliding.total, stops)]


def places_in(plan: Sequence[float], count: int) -> list[int]:
    """Evenly spaced steps at which a sampled run looks, the first and nearly the last among them."""
    return [round(place) for place in np.linspace(0, len(plan) - IN_A_ROW - 1, count).tolist()]


def whole(loop: Loop, plan: Sequence[float], trace: Trace) -> float:
    """Seconds of all steps."""
    start = time.perf_counter()
    trace.extend(loop.advance_all(plan) if isinstance(loop, Package) else in_a_row(loop, plan))
    return time.perf_counter() - start


def sampled(
    loop: Loop,
    plan: Sequence[float],
    places: Sequence[int],
    trace: Trace,
    *,
    at_place: Callable[[int], None] | None = None,
) -> float:
    """Seconds of all steps, interpolated between those timed at the places.

    The way from place to place is one long implicit step, then one of the plan, neither timed: a contact worn
    by one long increment or by many short ones costs the same. at_place: called after the last step at each.
    """
    done = 0  # steps of the plan
    where, costs = [], []
    for place in places:
        untimed = [sum(plan[done:place])] * (place > done) + [plan[place]]
        done = place + 1
        solved = in_a_row(loop, [*untimed, *plan[done : done + IN_A_ROW]])
        trace.extend(itertools.islice(solved, len(untimed)))
        start = time.perf_counter()
        trace.extend(solved)
        costs.append((time.perf_counter() - start) / IN_A_ROW)
        where.append(done)
        done += IN_A_ROW
        if at_place is not None:
            at_place(done)
    return over_the_run(where, costs, len(plan))


def over_the_run(where: Sequence[int], costs: Sequence[float], steps: int) -> float:
    """Sum over all steps of costs known at some."""
    return float(np.interp(np.arange(steps), where, costs).sum())


def sampled_run(case: str, study: Study, places: int, unit: Unit, setting: Setting) -> list[Row]:
    """Every contender extrapolated from the same steps; the published way from one step at each place."""
    plan = plan_of(study)
    look = places_in(plan, places)
    rows: list[Row] = []
    traces: dict[str, Trace] = {}
    note = f"extrapolated from {places * IN_A_ROW} of {len(plan)} steps"

    def timed(name: str, fresh: Callable[[], Loop]) -> None:
        def run() -> float:
            traces[name] = []
            return sampled(fresh(), plan, look, traces[name])

        rows.append(Row(case, unit.cells, name, *measure(run, unit, setting.repeats, warm_ups=0), note))

    for threads in setting.threads:
        with package(study, setting, threads) as fresh:
            timed(named(threads), fresh)
            if threads == max(setting.threads):
                once = measure(lambda: whole(fresh(), plan, []), unit, 1, warm_ups=0)
                whole_row = Row(
                    case, unit.cells, f"{named(threads)}, whole", *once, f"all {len(plan)} steps, once"
                )
                rows.insert(0, whole_row)
    for name, made in c_loops(study, setting.threads):
        timed(name, made)
    timed("NumPy", lambda: NumpyLoop(Problem.of(study), gap_of(study)))
    check(case, traces)
    return [*rows, published_run(case, study, plan, places_in(plan, setting.repeats), unit)]


def published_run(case: str, study: Study, plan: Sequence[float], look: Sequence[int], unit: Unit) -> Row:
    """The published way extrapolated from one step at each place, from where NumPy's loop is there."""
    loop = NumpyLoop(Problem.of(study), gap_of(study))
    where: list[int] = []
    costs: list[float] = []
    trials: list[int] = []
    units: list[float] = []

    def once(step: int) -> None:
        step = min(step, len(plan) - 1)
        here = copy(loop)
        here.gap, here.overlap = loop.gap.copy(), np.empty_like(loop.gap)
        published = PublishedLoop.after(here, study.cells.x, study.cells.y, study.counter.form.curvature)
        units.append(unit.seconds())
        start = time.perf_counter()
        trials.append(published.advance(plan[step]).evaluations)
        costs.append(time.perf_counter() - start)
        where.append(step)

    sampled(loop, plan, look, [], at_place=once)
    note = (
        f"extrapolated from {len(look)} of {len(plan)} steps, each once; "
        f"{min(trials)}–{max(trials)} trials to {study.load_tolerance:.2g} N"
    )
    return Row(case, unit.cells, "published way", [over_the_run(where, costs, len(plan))], units, note)


def whole_run(case: str, study: Study, unit: Unit, setting: Setting, *, share: float = 1.0) -> list[Row]:
    """Every contender through all steps, or through the first `share` of them, extrapolated.

    The published way goes with them where a step is short; elsewhere it is extrapolated from a few places.
    """
    plan = plan_of(study)
    first = plan[: round(share * len(plan))]
    note = f"{len(plan)} steps"
    if len(first) < len(plan):
        note = f"extrapolated from the first {len(first)} of {len(plan)} steps"
    rows: list[Row] = []
    traces: dict[str, Trace] = {}
    small = study.cells.cells < 50_000  # threads are not used below

    def timed(name: str, fresh: Callable[[], Loop]) -> None:
        def run() -> float:
            traces[name] = []
            return whole(fresh(), first, traces[name]) * len(plan) / len(first)

        rows.append(Row(case, unit.cells, name, *measure(run, unit, setting.repeats, warm_ups=0), note))

    counts = setting.threads[:1] if small else setting.threads
    for threads in counts:
        with package(study, setting, threads) as fresh:
            timed(named(threads), fresh)
    for name, made in c_loops(study, counts):
        timed(name, made)
    timed("NumPy", lambda: NumpyLoop(Problem.of(study), gap_of(study)))
    if small:
        timed("published way", lambda: unworn_published(study))
        check(case, traces)
        return rows
    check(case, traces)
    return [*rows, published_run(case, study, plan, places_in(plan, 2 * setting.repeats), unit)]


def unworn_published(study: Study) -> PublishedLoop:
    """The published way from the start."""
    counter: FloatArray = sag_of(study.cells.x, study.cells.y, study.counter.form.curvature)
    return PublishedLoop(Problem.of(study), counter, heights_of(study).copy())
