"""A disc that moves by whole cells under the counter-body: the package's step, its parts, and NumPy's."""

import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from contenders.baselines import FloatArray, Problem, Solved, sag_of, sliding_step, work_for
from contenders.roster import Setting, Trace, check, heights_of, named, study_on
from measure.timing import Row, Unit, measure

from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.models.track.local import SlidingContact

SHIFT = 8  # cells a step
EXTENT = 2.048  # [mm]: 2048 cells of 1 µm
#: Steps before any is timed, and steps timed together: a pass in between would empty the caches.
BEFORE, TOGETHER = 20, 20
#: Steps in which NumPy is compared with the package.
COMPARED = 5


class Package:
    """The package's contact, one displacement after another."""

    def __init__(self, study: Study, track: FloatArray, executor: Executor) -> None:
        self.steps = 0
        self.trace: Trace = []
        self._contact = SlidingContact(study.contact_task, track, executor, periodic=True)
        self._increment = SHIFT * study.grid.cell

    def advance(self) -> None:
        row = self._contact.step(SHIFT * self.steps, self._increment).row
        self.steps += 1
        found = row["wear_volume_counter"], row["wear_volume_disc"], row["area_contact"]
        self.trace.append(Solved(1.0, *found, int(row["evaluations"])))  # an area has many approaches

    def together(self) -> float:
        """Seconds of a step of many in a row."""
        start = time.perf_counter()
        for _ in range(TOGETHER):
            self.advance()
        return (time.perf_counter() - start) / TOGETHER


class InNumpy:
    """`sliding_step` on the same displacements."""

    def __init__(self, study: Study, track: FloatArray) -> None:
        self.trace: Trace = []
        self._problem = problem = Problem.of(study)
        self._unworn = sag_of(study.cells.x, study.cells.y, study.counter.form.curvature)
        self._counter = self._unworn.copy()
        self._track = track.copy()
        self._work = work_for(self._counter)
        removal = SHIFT * problem.cell
        self._step: Callable[..., object] = partial(
            sliding_step, self._counter, self._track, load=problem.load, hardness=problem.hardness,
            cell=problem.cell, removal_counter=problem.wear_counter * removal,
            removal_disc=problem.wear_disc * removal, work=self._work,
        )  # fmt: skip

    def advance(self) -> float:
        start = time.perf_counter()
        found = self._step(start=SHIFT * len(self.trace))
        took = time.perf_counter() - start
        area = self._problem.cell**2
        worn = float((self._counter - self._unworn).sum()) * area
        disc = worn * self._problem.wear_disc / self._problem.wear_counter
        self.trace.append(Solved(1.0, worn, disc, found.cells * area, found.trials))  # type: ignore[attr-defined]
        return took


def sliding(cells: int, setting: Setting) -> list[Row]:
    """A step with the disc displaced by 8 cells; the contact is near F/H."""
    implicit = study_on(cells, extent=EXTENT)
    rigid = implicit.replace({"stepping.scheme": "explicit", "stepping.force": True})
    half = 0.5 * rigid.hardness * rigid.cells.cell_area
    rigid = rigid.replace({"stepping.load_tolerance": f"{half} N"})
    heights = heights_of(implicit)
    track = np.pad(heights, ((0, SHIFT * 32), (0, 0)), mode="reflect")
    unit = Unit(cells)
    rows: list[Row] = []

    def row(name: str, times: tuple[list[float], list[float]], note: str) -> None:
        rows.append(Row("sliding", cells, name, *times, note))

    compared: dict[str, Trace] = {}
    for threads in setting.threads:
        for study, law in ((implicit, "implicit"), (rigid, "bearing area")):
            name = f"{named(threads)}, {law}"
            with Executor(study.cells, device=setting.device, threads=threads) as executor:
                model = Package(study, track.copy(), executor)
                if law == "implicit":
                    cold = partial(_cold, study, track, setting, threads)
                    row(f"{named(threads)}, first step", measure(cold, unit, setting.repeats), "cold start")
                for _ in range(BEFORE):
                    model.advance()
                times = measure(model.together, unit, setting.repeats)
                trials = [found.evaluations for found in model.trace[-TOGETHER:]]
                row(name, times, f"{statistics.mean(trials):.1f} evaluations")
                _check_archard(study, model.trace)
                if law != "implicit":
                    compared[name] = model.trace[:COMPARED]
    in_numpy = InNumpy(rigid, track)
    times = measure(in_numpy.advance, unit, setting.repeats, warm_ups=COMPARED)
    compared["NumPy"] = in_numpy.trace[:COMPARED]
    trials = [found.evaluations for found in in_numpy.trace]
    row("NumPy, bearing area", times, f"{min(trials)}–{max(trials)} trials to half a cell's force")
    check("sliding", compared)
    return rows


def _cold(study: Study, track: FloatArray, setting: Setting, threads: int) -> float:
    """Seconds of the first step, whose search starts at the lowest cell."""
    with Executor(study.cells, device=setting.device, threads=threads) as executor:
        model = Package(study, track.copy(), executor)
        start = time.perf_counter()
        model.advance()
        return time.perf_counter() - start


def _check_archard(study: Study, trace: Trace) -> None:
    """Both volumes are K F L."""
    problem = Problem.of(study)
    worn = SHIFT * problem.cell * problem.load * len(trace)
    expected = trace[-1]._replace(
        volume_counter=problem.wear_counter * worn, volume_disc=problem.wear_disc * worn
    )
    check("sliding", {"K F L": [expected], "warpwear": [trace[-1]]})
