"""Who takes part in a case: the package, the same loop in C and in NumPy, and the published way.

Every contender advances through the same increments and says what it found; `check` compares before a time is
shown.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from measure.timing import Row, Unit, measure

from contenders.baselines import FloatArray, NumpyLoop, Problem, Solved, sag_of
from contenders.c_loop import CLoop, NoCompilerError, library
from contenders.published import PublishedLoop
from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.history.recorder import Step
from warpwear.runs.arrangements import model_at_rest
from warpwear.study.surface import surface_in

#: Relative difference allowed between contenders, in approach, volumes and area.
AGREEMENT = 1.0e-9
#: Tolerance over the load of the published bisection when it is compared; timed it has the study's.
TIGHT = 1.0e-10
EXTENT = 1.4336  # [mm]: the scar after 2400 mm covers 61 % of it

Trace = list[Solved]


class DisagreementError(RuntimeError):
    """Two contenders found different contacts: no time of them means anything."""


@dataclass(frozen=True)
class Setting:
    """What was asked for."""

    threads: tuple[int, ...]
    device: str
    repeats: int
    quick: bool


class Loop(Protocol):
    """Anything that advances a contact."""

    def advance(self, increment: float) -> Solved:
        """Solve and wear over an increment [mm]."""


class Package:
    """warpwear's own step."""

    def __init__(self, study: Study, heights: FloatArray, executor: Executor) -> None:
        self._model = model_at_rest(study.contact_task, heights, executor)

    def advance(self, increment: float, then: float | None = None) -> Solved:
        """then: the increment after this one, which a run knows; by default the same."""
        return self._solved(self._model.advance(increment, then=increment if then is None else then))

    def advance_all(self, increments: Iterable[float]) -> list[Solved]:
        """Steps in a row, in blocks where a run makes them so."""
        return [self._solved(step) for step in self._model.steps((d, False) for d in increments)]

    @staticmethod
    def _solved(step: Step) -> Solved:
        row = step.row
        return Solved(
            row["approach"],
            row["wear_volume_counter"],
            row["wear_volume_disc"],
            row["area_contact"],
            int(row["evaluations"]),
        )


def in_a_row(loop: Loop, increments: Sequence[float]) -> Iterator[Solved]:
    """Steps one after another. The package is told the next increment, as a run tells it."""
    for increment, then in zip(increments, [*increments[1:], *increments[-1:]], strict=True):
        yield loop.advance(increment, then) if isinstance(loop, Package) else loop.advance(increment)


def study_on(cells: int, *, preset: str = "v3-fine", extent: float = EXTENT, **changes: object) -> Study:
    """A preset on cells² cells over the same physical domain. Names of keys with __ for the dot."""
    dotted = {name.replace("__", "."): value for name, value in changes.items()}
    grid = {"grid.extent": f"{extent} mm", "grid.cell": f"{extent / cells} mm", "output.snapshots": []}
    return Study.load(preset).replace(grid | dotted)


_KEPT: dict[tuple[str, Grid], FloatArray] = {}


def heights_of(study: Study) -> FloatArray:
    """The disc on the study's grid; made once for contenders in a row, who leave it as it is."""
    grid = study.cells
    key = study.disc.model_dump_json(), grid
    if key not in _KEPT:
        _KEPT.clear()
        _KEPT[key] = surface_in(study).heights(grid.x, grid.y)
    return _KEPT[key]


def gap_of(study: Study) -> FloatArray:
    """Return the gap of the unworn bodies [mm], made by NumPy."""
    gap = sag_of(study.cells.x, study.cells.y, study.counter.form.curvature)
    gap -= heights_of(study)
    return gap


@contextmanager
def package(study: Study, setting: Setting, threads: int) -> Iterator[Callable[[], Package]]:
    """Makes fresh models on one executor."""
    with Executor(study.cells, device=setting.device, threads=threads) as executor:
        heights = heights_of(study)
        yield lambda: Package(study, heights, executor)


def named(threads: int, name: str = "warpwear") -> str:
    return f"{name}, {threads} thread{'s' * (threads > 1)}"


def check(case: str, traces: Mapping[str, Sequence[Solved]]) -> None:
    """All traces show the same approach, volumes and area at every step. Raises DisagreementError."""
    (first, reference), *others = traces.items()
    for name, trace in others:
        for i, (one, other) in enumerate(zip(reference, trace, strict=False)):
            for quantity in ("approach", "volume_counter", "volume_disc", "area"):
                expected, found = getattr(one, quantity), getattr(other, quantity)
                if not abs(found - expected) <= AGREEMENT * abs(expected):
                    raise DisagreementError(
                        f"{case}, step {i + 1}: {quantity} is {expected!r} by {first}, {found!r} by {name}, "
                        f"not within {AGREEMENT:g}: no time is shown."
                    )


def c_loops(study: Study, counts: Iterable[int]) -> Iterator[tuple[str, Callable[[], CLoop]]]:
    """Names and makers of the loop in C, one a thread count; none without a compiler."""

    def made(threads: int) -> CLoop:
        return CLoop(Problem.of(study), gap_of(study), threads=threads)

    try:
        library()
    except NoCompilerError:
        return
    for threads in counts:
        yield named(threads, "C"), partial(made, threads)


def steps(
    case: str, study: Study, before: Iterable[float], increment: float, unit: Unit, setting: Setting
) -> list[Row]:
    """Times a step of `increment` after those `before`, by every contender, one of them alive at a time."""
    before = list(before)
    rows: list[Row] = []
    traces: dict[str, Trace] = {}

    def timed(name: str, loop: Loop, note: str = "") -> None:
        trace = traces[name] = list(in_a_row(loop, [*before, increment]))
        seconds, units = measure(lambda: trace.append(loop.advance(increment)), unit, setting.repeats)
        evaluations = [found.evaluations for found in trace[-setting.repeats :]]
        note = f"{note}{_span(evaluations)} evaluations"
        rows.append(Row(case, unit.cells, name, seconds, units, note, {"evaluations": evaluations}))

    for threads in setting.threads:
        name = named(threads)
        with package(study, setting, threads) as fresh:
            model = fresh()
            timed(name, model)
            traces[name].append(model.advance(increment))
            del model
    for name, made in c_loops(study, setting.threads):
        timed(name, made())
    in_numpy = NumpyLoop(Problem.of(study), gap_of(study))
    timed("NumPy", in_numpy)
    published = PublishedLoop.after(in_numpy, study.cells.x, study.cells.y, study.counter.form.curvature)
    del in_numpy
    # Compared in the step after those of NumPy, balanced as tightly; timed as published.
    compared = published.advance(increment, tolerance=TIGHT * study.contact.load)
    check(case, traces)
    first = next(iter(traces))
    check(case, {first: traces[first][-1:], "the published way": [compared]})
    timed_from = traces.setdefault("published", [])
    seconds, units = measure(lambda: timed_from.append(published.advance(increment)), unit, setting.repeats)
    trials = [found.evaluations for found in timed_from[-setting.repeats :]]
    note = f"{_span(trials)} trials to {study.load_tolerance:.2g} N, each a pass over S − D"
    rows.append(Row(case, unit.cells, "published way", seconds, units, note, {"evaluations": trials}))
    return rows


def _span(values: Sequence[int]) -> str:
    low, high = min(values), max(values)
    return f"{low}" if low == high else f"{low}–{high}"
