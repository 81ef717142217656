"""A balance from a cold start, by every contender."""

from collections.abc import Callable

from contenders.baselines import NumpyLoop, Problem, sag_of
from contenders.published import PublishedLoop
from contenders.roster import TIGHT, Loop, Setting, Trace, check, gap_of, heights_of, named, package
from measure.timing import Row, Unit, measure

from warpwear import Study


def cold(case: str, cells: int, setting: Setting, study: Study) -> list[Row]:
    """A static contact, nothing worn: the balance from a cold start, with the gap there or made too."""
    increment = 0.0
    unit = Unit(cells)
    problem = Problem.of(study)
    rows: list[Row] = []
    traces: dict[str, Trace] = {}

    def timed(name: str, fresh: Callable[[], Loop], note: str = "") -> None:
        alive: list[Loop] = []

        def renew() -> None:
            alive[:] = []
            alive.append(fresh())

        def run() -> None:
            traces[name] = [alive[0].advance(increment)]

        def run_with_gap() -> None:
            traces[name] = [fresh().advance(increment)]

        for run_it, prepare, what in ((run, renew, "gap there"), (run_with_gap, None, "gap from heights")):
            seconds, units = measure(run_it, unit, setting.repeats, prepare=prepare)
            trials = traces[name][-1].evaluations
            rows.append(Row(case, cells, f"{name}, {what}", seconds, units, f"{trials} evaluations{note}"))
            alive.clear()

    for threads in setting.threads:
        with package(study, setting, threads) as fresh:
            timed(named(threads), fresh)
    timed("NumPy", lambda: NumpyLoop(problem, gap_of(study)))
    sag = sag_of(study.cells.x, study.cells.y, study.sphere.curvature)
    disc = heights_of(study).copy()
    published = PublishedLoop(problem, sag, disc)
    # Compared in a step that is balanced as tightly as the others, where a tolerance matters.
    tolerance = TIGHT * problem.load if problem.compliance_of(increment) else None
    traces["published way"] = [published.advance(increment, tolerance=tolerance)]
    check(case, traces)
    found: Trace = []
    seconds, units = measure(lambda: found.append(published.advance(increment)), unit, setting.repeats)
    note = f"{found[-1].evaluations} trials to {study.load_tolerance:.2g} N, each a pass over S − D"
    return [*rows, Row(case, cells, "published way", seconds, units, note)]
