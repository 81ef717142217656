"""What every test may ask for: a device, a number of threads, and pictures that are soon drawn."""

import base64
import gc
import importlib
import os
import pkgutil
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import wraps
from types import SimpleNamespace
from typing import Any

# Before anything loads NumPy: threads of BLAS that wait for each other take a fifth of the tests' time. No
# result depends on them, as tests/runs/test_thread_environments.py and bench/kills.py see.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


import psutil
import pytest
import warp as wp

from warpwear import kernels, lazy
from warpwear.engine import executor as execution
from warpwear.engine.device import find_device
from warpwear.engine.kernel_cache import begin_to_load
from warpwear.engine.workers import Here

process, style = lazy.module("warpwear.figures.process"), lazy.module("warpwear.figures.style")

wp.config.log_level = wp.LOG_ERROR


def pytest_configure(config: pytest.Config) -> None:
    """Coarse cells make quick tests, and the warnings of them a long list; `pytest.warns` sees them still."""
    config.addinivalue_line("filterwarnings", "ignore::warpwear.StudyWarning")


#: From so many tests on each of the processes that share them compiles some of the kernels, before any test.
MANY = 1000


def pytest_collection_finish(session: pytest.Session) -> None:
    """Make what all tests need once, and let no collector of garbage look through it again and again."""
    number, count = (os.environ.get(f"PYTEST_XDIST_WORKER{name}", "") for name in ("", "_COUNT"))
    if len(session.items) >= MANY and number:
        compile_kernels(int(number.removeprefix("gw")), int(count))
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


def compile_kernels(number: int, count: int) -> None:
    """Compile every count-th file of kernels, from the one of this number on, for all to load.

    Two processes that meet a file at the same time would both compile it.
    """
    device = find_device("cpu")
    files = [name for _, name, _ in pkgutil.walk_packages(kernels.__path__, f"{kernels.__name__}.")]
    modules = [wp.get_module(importlib.import_module(name).__name__) for name in files]
    for module in [module for module in modules if module.kernels][number::count]:
        begin_to_load(module, device)()


@pytest.fixture(scope="session", autouse=True)
def one_process() -> Iterator[None]:
    """Have the test's own process draw the figures of runs and make the runs of designs.

    Another would first import all, for seconds. Tests of other processes start them themselves, or unwrap.
    """
    start = process.Painter.__init__

    @wraps(start)
    def draw_here(painter: Any, cores: int, **how: Any) -> None:
        start(painter, 0, **how)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(process.Painter, "__init__", draw_here)
        patch.setattr("warpwear.batches.batch.local_workers", lambda *_, **__: Here())
        yield


@pytest.fixture(params=["cpu", "cuda:0"])
def device(request: pytest.FixtureRequest) -> str:
    """Every device; those that are not here are skipped."""
    name: str = request.param
    if name != "cpu" and not wp.is_cuda_available():
        pytest.skip("no CUDA device")
    if name != "cpu" and request.node.get_closest_marker("transforms"):
        pytest.importorskip("cupy")
    return name


@pytest.fixture
def cores(monkeypatch: pytest.MonkeyPatch) -> int:
    """The cores that there are, whose threads share grids too small for it to pay."""
    monkeypatch.setattr(execution, "CELLS_PER_THREAD", 1)
    monkeypatch.setattr("warpwear.contact.array.workplace._kept", {})  # those of one thread
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@pytest.fixture(params=[1, 2], ids=["1 thread", "2 threads"])
def threads(request: pytest.FixtureRequest, cores: int) -> int:
    """One and two threads, which also share grids too small for it to pay; skips where there is one core."""
    number: int = request.param
    if number > cores:
        pytest.skip("one core")
    return number


@pytest.fixture
def two_threads(cores: int) -> int:
    """Two threads, of tests that compare them with one themselves."""
    if cores < 2:
        pytest.skip("one core")
    return 2


@pytest.fixture
def host_with(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Let the host say that it has so much memory free [B]."""

    def say(free: float) -> None:
        monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=int(free)))
        monkeypatch.setattr("warpwear.contact.array.workplace._kept", {})  # which are not asked

    return say


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Have a function told of each call of a method or function, with its arguments, before it is made."""

    def begin(owner: Any, name: str, told: Callable[..., object]) -> None:
        watched = getattr(owner, name)

        def call(*given: Any, **named: Any) -> Any:
            told(*given, **named)
            return watched(*given, **named)

        monkeypatch.setattr(owner, name, call)

    return begin


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, Exception], None]:
    """Let what stands at a place raise an error, as it does on a full disk."""

    def fail(place: str, error: Exception) -> None:
        def call(*_: Any, **__: Any) -> Any:
            raise error

        monkeypatch.setattr(place, call)

    return fail


#: Dots per inch that are soon drawn, and a PNG file of one white dot.
DOTS = 50.0
BLANK = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAG7buVgAAAABJRU5ErkJggg=="
)


@pytest.fixture(scope="session")
def quick_pictures() -> Callable[..., AbstractContextManager[None]]:
    """A context for tests that ask which pictures there are and not how they look: they have few dots.

    blank: figures are made, but not laid out and drawn: each PNG file is a white dot.
    """

    @contextmanager
    def quick(*, blank: bool = False) -> Iterator[None]:
        write = style.bytes_of

        def few_dots(figure: Any, file_format: str = "png", **_: Any) -> bytes:
            if blank and file_format == "png":
                return BLANK
            figure.set_layout_engine(None)  # which draws everything twice, to make room for texts
            return write(figure, file_format, dpi=DOTS)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("warpwear.figures.style.bytes_of", few_dots)
            yield

    return quick
