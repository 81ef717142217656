"""The cases on a GPU. Times are divided by a copy of a field there, the bandwidth that memory gives."""

import statistics
import time

import warp as wp
from contenders.baselines import NumpyLoop, Problem
from contenders.roster import Setting, Trace, check, gap_of, package, study_on
from measure.timing import Row, Unit, measure

import warpwear
from cases.on_track import run_full
from cases.table import EARLY, LATE, LATE_STEP, Case
from cases.whole_runs import plan_of
from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.grid import Grid

#: Where the package's steps are compared with NumPy's.
CHECK_CELLS = 1024
#: Steps between two looks at the history.
IN_A_BLOCK = 8
#: Between which distances [mm] a ball's steps on the half-space are timed.
BALL_SLIDES = (3.0, 12.0)
COPIES = 20  # in a row, so that the time of a launch does not count


class Copy(Unit):
    """A copy of one field of cells² cells on the device, in place of NumPy's pass."""

    def __init__(self, cells: int, device: str) -> None:
        self.cells = cells
        self._device = device
        with Executor(Grid(cells, cells, 1.0), device=device, fields_needed=2.0) as executor:
            self._from, self._to = executor.zeros(), executor.zeros()
        self.seconds()

    def seconds(self) -> float:
        wp.synchronize_device(self._device)
        start = time.perf_counter()
        for _ in range(COPIES):
            wp.copy(self._to, self._from)
        wp.synchronize_device(self._device)
        return (time.perf_counter() - start) / COPIES

    @property
    def bytes(self) -> int:
        """Read and written by one copy."""
        return 2 * 8 * self.cells**2


def compared(case: str, setting: Setting) -> None:
    """Early and late steps of a small grid on the device and by NumPy. Raises DisagreementError."""
    study = study_on(CHECK_CELLS)
    before = [*EARLY, *LATE, LATE_STEP]
    with package(study, setting, 1) as fresh:
        model = fresh()
        found = model.advance_all(before)
    in_numpy = NumpyLoop(Problem.of(study), gap_of(study))
    check(case, {setting.device: found, "NumPy": [in_numpy.advance(d) for d in before]})


def late(cells: int, setting: Setting) -> list[Row]:
    """A step of 3 mm after 2400 mm, 61 % of the domain touches, beside a copy of a field."""
    compared("gpu-late", setting)
    unit = Copy(cells, setting.device)
    trace: Trace = []
    with package(study_on(cells), setting, 1) as fresh:
        model = fresh()
        trace.extend(model.advance(d) for d in LATE)

        def run() -> float:
            start = time.perf_counter()
            trace.extend(model.advance_all([LATE_STEP] * IN_A_BLOCK))
            return (time.perf_counter() - start) / IN_A_BLOCK

        seconds, units = measure(run, unit, setting.repeats)
    timed = trace[-setting.repeats * IN_A_BLOCK :]
    evaluations = sum(found.evaluations for found in timed) / len(timed)
    bandwidth = unit.bytes / statistics.median(units)
    # The gap once an evaluation; by the wear both gaps read, and one written where it touches.
    touching = timed[-1].area / study_on(cells).cells.area
    moved = (evaluations + 2.0 + touching) * 8 * cells**2 / statistics.median(seconds)
    note = (
        f"{evaluations:g} evaluations; at a field read each and {2.0 + touching:.2f} moved by the wear "
        f"{moved / 1e9:.0f} GB/s, {100 * moved / bandwidth:.0f} % of the copy's"
    )
    extra = {"evaluations": evaluations, "bytes_per_second": moved, "share_of_copy": moved / bandwidth}
    step = Row("gpu-late", cells, f"warpwear on {setting.device}", seconds, units, note, extra)
    note = f"{bandwidth / 1e9:.0f} GB/s read and written"
    return [step, Row("gpu-late", cells, "copy", units, units, note, {"bytes_per_second": bandwidth})]


def run_fine(_: int, setting: Setting) -> list[Row]:
    """The whole of v3-fine, 1099 balanced steps on 1500² cells, after compilation."""
    compared("gpu-v3-fine", setting)
    study = Study.load("v3-fine")
    plan = plan_of(study)
    unit = Copy(study.cells.nx, setting.device)
    with package(study, setting, 1) as fresh:

        def run() -> float:
            model = fresh()
            start = time.perf_counter()
            model.advance_all(plan)
            return time.perf_counter() - start

        fresh().advance_all(plan[:5])
        seconds, units = measure(run, unit, setting.repeats)
    note = f"{len(plan)} steps, {1e6 * sorted(seconds)[len(seconds) // 2] / len(plan):.0f} µs each"
    return [Row("gpu-v3-fine", unit.cells, f"warpwear on {setting.device}", seconds, units, note)]


def run_ball(_: int, setting: Setting) -> list[Row]:
    """A step of a ball that slides on the half-space, preset track on 750² cells, as its contact begins."""
    study = Study.load("track").replace({"contact.law": "half-space", "output.snapshots": []})
    unit = Copy(study.cells.nx, setting.device)

    def solved(distance: float) -> tuple[float, int]:
        changed = study.replace({"sliding.distance": f"{distance} mm"})
        with warpwear.run(changed, device=setting.device) as result:
            return result.seconds["solve"], result.history["distance"].size

    def run() -> float:
        (first, few), (all_of_them, many) = (solved(distance) for distance in BALL_SLIDES)
        return (all_of_them - first) / (many - few)

    run()
    seconds, units = measure(run, unit, setting.repeats)
    note = f"{1e3 * statistics.median(seconds):.2f} ms a step"
    return [Row("gpu-ball", unit.cells, f"warpwear on {setting.device}", seconds, units, note)]


CASES_GPU: dict[str, Case] = {
    "gpu-late": Case(late, default_sizes=(16384,)),
    "gpu-v3-fine": Case(run_fine, sizes=(1500,)),
    "gpu-ball": Case(run_ball, sizes=(750,)),
    "gpu-track": Case(run_full, sizes=(1500,), fields=120.0),
}
