"""Worker processes on this machine that stay alive from call to call, as an executor of concurrent.futures.

A process is `python -m warpwear.engine.workers`, which reads a call from standard input, makes it and writes
what it gave. No worker of `multiprocessing` does it: that runs a user's script once more where it has no
`if __name__ == "__main__"`.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Any

#: How often a call is made again whose worker died.
RETRIES = 2
#: What Python is asked to run as a worker.
COMMAND = ("-m", __name__)
#: Variables by which numerical libraries are told their number of threads.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


class WorkerDiedError(RuntimeError):
    """A worker process ended in the middle of a call, each time it was made."""


class Here(Executor):
    """Makes calls at once, in this process: for one that is not worth the start of another."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> "Future[Any]":
        """Call a function, and return what has its answer already."""
        future: Future[Any] = Future()
        future.set_result(function(*arguments, **named))
        return future


class Workers(ThreadPoolExecutor):
    """Processes that make calls, one each at a time; one that dies is started again and its call with it.

    environments: of each worker what differs from this process's. retries: how often a call is made again.
    quiet: whether what workers say on standard error is left unseen. command: what Python runs as a worker.
    """

    def __init__(
        self,
        environments: Sequence[Mapping[str, str]],
        *,
        retries: int = RETRIES,
        quiet: bool = False,
        command: Sequence[str] = COMMAND,
    ) -> None:
        super().__init__(max_workers=len(environments), thread_name_prefix="worker")
        self._free, self._retries, self._quiet = list(environments), retries, quiet
        self._command = command
        self._lock = threading.Lock()
        self._own = threading.local()
        self._processes: list[subprocess.Popen[bytes]] = []
        self._stopping = False

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> "Future[Any]":
        """Have a worker call a function of a module with arguments that can be pickled."""
        assert not named
        return super().submit(self._call, function, arguments)

    def _call(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
        for _ in range(self._retries + 1):
            process = self._process()
            assert process.stdin is not None
            assert process.stdout is not None
            try:
                pickle.dump((function, arguments), process.stdin, protocol=pickle.HIGHEST_PROTOCOL)
                process.stdin.flush()
                good, answer = pickle.load(process.stdout)
            except (BrokenPipeError, EOFError, ValueError, OSError, pickle.UnpicklingError):
                with suppress(OSError), process:  # closes its pipes
                    process.kill()
                if self._stopping:
                    raise WorkerDiedError("the sweep was stopped") from None
                continue
            if good:
                return answer
            raise answer
        raise WorkerDiedError(
            f"its worker process died {self._retries + 1} times (status {process.returncode}), perhaps for "
            "want of memory"
        )

    def _process(self) -> "subprocess.Popen[bytes]":
        """Return the process of this thread, started where there is none that lives."""
        process: subprocess.Popen[bytes] | None = getattr(self._own, "process", None)
        if process is None or process.poll() is not None:
            with self._lock:
                if process is None:
                    self._own.environment = self._free.pop()
                else:
                    self._processes.remove(process)
                process = self._started()
                self._processes.append(process)
            self._own.process = process
        return process

    def _started(self) -> "subprocess.Popen[bytes]":
        """Return a worker process that imports this very package, wherever this process found it."""
        home = str(Path(__file__).parents[2])
        path = os.pathsep.join([home, *filter(None, [os.environ.get("PYTHONPATH")])])
        return subprocess.Popen(
            [sys.executable, *self._command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL if self._quiet else None,
            env={**os.environ, "PYTHONPATH": path, **self._own.environment},
            start_new_session=True,  # Ctrl-C reaches this process alone, which ends them in order
        )

    def __exit__(self, kind: type[BaseException] | None, *error: Any) -> None:
        """End the workers, at once on Ctrl-C."""
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            self.stop()
        self.shutdown()

    def stop(self) -> None:
        """End the workers at once: a run in the middle leaves its checkpoint."""
        self._stopping = True
        super().shutdown(wait=False, cancel_futures=True)
        with self._lock:
            for process in self._processes:
                process.terminate()
        self.shutdown()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers once their calls are made."""
        super().shutdown(wait=wait, cancel_futures=cancel_futures)
        if wait:
            for process in self._processes:
                with suppress(OSError), process:  # closes its pipes, and waits
                    pass


def local_workers(number: int, *, cores: int, gpus: Sequence[str] = ()) -> Workers:
    """Workers on this machine: they share its cores evenly, and its GPUs in turn where some are given."""
    shared = dict.fromkeys(THREADS, str(max(1, cores // number)))
    each = [{"CUDA_VISIBLE_DEVICES": gpus[worker % len(gpus)]} if gpus else {} for worker in range(number)]
    return Workers([{**shared, **own} for own in each])


def serve() -> None:
    """Make calls until the input ends. What a call prints goes to standard error."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # a run then leaves a checkpoint
    calls, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    with answers:
        while True:
            try:
                function, arguments = pickle.load(calls)
            except EOFError:
                return
            try:
                answer = (True, function(*arguments))
            except Exception as error:
                answer = (False, error)
            pickle.dump(answer, answers, protocol=pickle.HIGHEST_PROTOCOL)
            answers.flush()


if __name__ == "__main__":
    try:
        serve()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(130)
