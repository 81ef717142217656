"""Runs of a plan, made once each by workers, in a folder that is the truth about them."""

import logging
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from pathlib import Path
from typing import Any, Literal

from warpwear.batches.cluster import connected
from warpwear.batches.plan import Plan, task_of
from warpwear.batches.run_one import RunRow, RunTask, is_there, run_one
from warpwear.clock import lasting
from warpwear.engine.device import find_device, gpu_count, usable_cores
from warpwear.engine.workers import WorkerDiedError, local_workers
from warpwear.errors import InputError, explained
from warpwear.figures.wording import counted
from warpwear.results import manifest
from warpwear.results.folder import LOCK, check_writable, held, refuse_if_held
from warpwear.runs.console import warn

#: Folder of the runs in that of a sweep.
RUNS = "runs"
#: How often it is looked after runs that take long [s].
LOOK = 5.0
#: A run is told of that takes this many times as long as the longest before, and this long at least [s].
MANY, SILENCE = 10.0, 60.0
#: Workers on this machine at most, or four for each of its cores.
MOST_WORKERS = 64
#: Tells at the level INFO how far runs asked for from Python are.
LOG = logging.getLogger("warpwear")


class Count:
    """Counts the runs that are done, and foresees when the others will be."""

    def __init__(self, runs: int) -> None:
        self._runs, self._done, self._made = runs, 0, 0
        self._began = time.monotonic()

    def one(self, row: RunRow) -> str:
        """Count a run and say how many are done, how it ended and how long the others may take."""
        self._done += 1
        self._made += row.seconds > 0.0 and not row.was_there  # others took no time
        gone, todo = time.monotonic() - self._began, self._runs - self._done
        left = f", about {lasting(gone / self._made * todo)} left" if self._made else ""
        return f"{self._done} of {self._runs} runs, the last {row.status}; {lasting(gone)} gone{left}"


def make_all(plan: Plan, folder: Path) -> list[RunRow]:
    """Make the runs of a plan by processes here, one a core, and log each; see `make_runs`."""
    with local_executor(plan) as (pool, threads, _):
        return make_runs(plan, folder, pool, threads=threads, **logging_each(plan))


def logging_each(plan: Plan) -> dict[str, Any]:
    """Return the calls of `make_runs` that log each run and warn."""
    count = Count(len(plan.points))
    return {"on_row": lambda _, row: LOG.info(count.one(row)), "on_warning": warn}


def make_runs(
    plan: Plan,
    folder: Path,
    executor: Executor,
    *,
    threads: int | None = None,
    on_row: Callable[[int, RunRow], object] = lambda number, row: None,
    on_warning: Callable[[str], object] = lambda sentence: None,
    silence: float = SILENCE,
) -> list[RunRow]:
    """Have an executor make the runs of a plan, each once, and return their rows in the plan's order.

    on_row: is called with the number and row of each run that is done. on_warning: is called once with a
    sentence about a run that takes far longer than all that are done, and than silence [s]. On an interrupt
    what is not begun is left, and KeyboardInterrupt raised.
    """
    rows: dict[int, RunRow] = {}
    numbers: dict[str, list[int]] = defaultdict(list)
    for point in plan.points:
        if point.study is None:
            rows[point.number] = RunRow(f"failed: {point.problem}")
            on_row(point.number, rows[point.number])
        else:
            numbers[point.run].append(point.number)
    waiting: dict[Future[RunRow], list[int]] = {}
    for those in numbers.values():  # of one run
        task = task_of(plan.points[those[0]], folder / RUNS, device=plan.device, threads=threads)
        waiting[_submitted(executor, task)] = those
    begun: dict[Future[RunRow], float] = {}
    longest = 0.0
    late: set[Future[RunRow]] = set()
    try:
        while waiting:
            for future in waiting:
                if future.running():
                    begun.setdefault(future, time.monotonic())
            done = wait(waiting, timeout=min(LOOK, silence), return_when=FIRST_COMPLETED).done
            for future in begun.keys() & (waiting.keys() - done - late) if longest else ():
                took = time.monotonic() - begun[future]
                if took > max(silence, MANY * longest):
                    late.add(future)
                    point = plan.points[waiting[future][0]]
                    on_warning(
                        f"run {point.number} has taken {lasting(took)}, the longest of the others "
                        f"{lasting(longest)}: it is still working ({folder / RUNS / point.run})"
                    )
            for future in done:
                row = _row(future)
                longest = max(longest, row.seconds if row.status == "done" else 0.0)
                for number in waiting.pop(future):
                    rows[number] = row
                    on_row(number, row)
    except KeyboardInterrupt:
        for future in waiting:
            future.cancel()
        raise
    return [rows[number] for number in range(len(plan.points))]


def _submitted(executor: Executor, task: RunTask) -> "Future[RunRow]":
    """Return the future of a run; an executor that takes none any more has it fail."""
    try:
        return executor.submit(run_one, task)
    except RuntimeError as error:
        future: Future[RunRow] = Future()
        future.set_exception(error)
        return future


def _row(future: "Future[RunRow]") -> RunRow:
    """Return the row of a run; one whose worker was lost says so."""
    try:
        return future.result()
    except CancelledError:
        return RunRow("failed: it was cancelled, as runs are whose cluster is gone")
    except (WorkerDiedError, OSError, RuntimeError, MemoryError) as error:
        return RunRow(f"failed: {' '.join(str(error).split()) or type(error).__name__}")


def estimate(
    plan: Plan, folder: Path, executor: Executor, *, threads: int | None = None, workers: int = 1
) -> str:
    """Make the first run that is not there yet, and say from it what all of them will cost.

    folder: of the sweep, which keeps that run.
    """
    runs = {point.run: point for point in plan.points if point.study is not None}
    missing = [name for name in runs if not is_there(folder / RUNS / name)]
    seconds, size = 0.0, 0
    if missing:
        task = task_of(runs[missing[0]], folder / RUNS, device=plan.device, threads=threads)
        seconds = _row(_submitted(executor, task)).seconds
        size = sum(path.stat().st_size for path in Path(task.folder).glob("*") if path.is_file())
    there = len(runs) - len(missing)
    to_do, already = len(plan.points) - there, f", {there} of them there already" if there else ""
    return (
        f"{counted(len(plan.points), 'run')}{already}: about {lasting(to_do * seconds / max(1, workers))} on "
        f"{counted(workers, 'worker')} ({lasting(seconds)} a run) and {to_do * size / 2**20:.3g} MiB"
    )


def check_folder(folder: Path, *, resume: bool, files: Sequence[str] = ()) -> None:
    """Raise InputError for a folder that runs may not be made in. files: others that are written there."""
    check_writable(folder)
    names = {path.name for path in folder.iterdir()} - {LOCK} if folder.is_dir() else set()
    if not names:
        return
    if not (folder / RUNS).is_dir():
        raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected.")
    if not resume:
        raise InputError(
            f"out = {folder} already holds a sweep; resume it (--resume), or give another folder (--out)."
        )
    refuse_if_held(folder)
    if (folder / manifest.FIGURES).is_symlink():
        raise InputError(
            f"{folder / manifest.FIGURES} is a link; figures are drawn into the folder itself: move it away."
        )
    ours = manifest.written(folder)
    foreign = [name for name in files if name in names and name not in ours]
    if foreign:
        raise InputError(
            f"out = {folder} holds {', '.join(foreign)}, which its {manifest.NAME} does not name and a sweep "
            "would replace: move what you want to keep, or give another folder (out)."
        )


def share_runs(folder: Path, store: Path) -> None:
    """Keep the runs of a sweep in a folder that several sweeps share: the sweep's `runs` is a link to it.

    Raises InputError where that cannot be, or where the sweep has its runs elsewhere.
    """
    place = folder / RUNS
    with explained(f"--runs {store} cannot be shared"):
        store.mkdir(parents=True, exist_ok=True)
        if not place.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            place.symlink_to(store.resolve(), target_is_directory=True)
    if place.resolve() != store.resolve():
        raise InputError(f"--runs {store}: the sweep in {folder} has its runs in {place.resolve()}.")


@contextmanager
def opened_folder(out: Path | None) -> Iterator[Path]:
    """Hold the folder of a sweep, or give one that is gone at the end. Raises InputError."""
    if out is None:
        with tempfile.TemporaryDirectory(prefix="warpwear-sweep-", ignore_cleanup_errors=True) as place:
            yield Path(place)
        return
    lock = ExitStack()
    with explained(f"out = {out} cannot be written"):
        (out / RUNS).mkdir(parents=True, exist_ok=True)
        lock.enter_context(held(out))
    with lock:
        yield out


def executor_for(
    plan: Plan,
    *,
    executor: Executor | None = None,
    cluster: str | None = None,
    insecure: bool = False,
    **here: Any,
) -> AbstractContextManager[tuple[Executor, int, int]]:
    """Give the executor that was asked for, the threads of a run, and the number of workers.

    here: without another executor as of `local_executor`. Raises InputError for what is none, or does not go
    together.
    """
    if executor is not None:
        if not callable(getattr(executor, "submit", None)):
            expected = "an object with submit(), as in concurrent.futures, is expected."
            raise InputError(f"executor = {executor!r}: {expected}")
        return nullcontext((executor, 1, 1))
    if cluster is None:
        return local_executor(plan, **here)
    if any(value is not None for value in here.values()):
        raise InputError("--cluster excludes --workers and --gpus: its own workers make the runs.")
    return connected(cluster, insecure=insecure, device=plan.device)


@contextmanager
def local_executor(
    plan: Plan, *, workers: int | None = None, gpus: Literal["all"] | None = None
) -> Iterator[tuple[Executor, int, int]]:
    """Workers of this machine, by default one a core or one a GPU; the threads of a run; their number.

    Raises InputError for a number that is none, and where there is no GPU.
    """
    cores = usable_cores()
    visible = [str(number) for number in range(gpu_count())] if gpus else []
    if gpus and not visible:
        raise InputError("gpus = 'all': no GPU of CUDA is here.")
    number = workers if workers is not None else len(visible) or min(cores, len(plan.points))
    most = max(MOST_WORKERS, 4 * cores)
    if not 1 <= number <= most:
        raise InputError(f"workers = {number} is not possible; allowed: 1 to {most}.")
    if plan.device != "cpu":
        find_device(plan.device)  # before any worker asks for it in vain
    with local_workers(number, cores=cores, gpus=visible) as pool:
        yield pool, max(1, cores // number), number
