"""What every test may ask for: a device and a number of threads."""

import os

import pytest
import warp as wp

from warpwear.engine import executor as execution

wp.config.log_level = wp.LOG_ERROR


def pytest_configure(config: pytest.Config) -> None:
    """Coarse cells make quick tests, and the warnings of them a long list; `pytest.warns` sees them still."""
    config.addinivalue_line("filterwarnings", "ignore::warpwear.StudyWarning")


@pytest.fixture(params=["cpu", "cuda:0"])
def device(request: pytest.FixtureRequest) -> str:
    """Every device; those that are not here are skipped."""
    name: str = request.param
    if name != "cpu" and not wp.is_cuda_available():
        pytest.skip("no CUDA device")
    return name


@pytest.fixture(params=[1, 2], ids=["1 thread", "2 threads"])
def threads(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    """One and two threads, which also share grids too small for it to pay."""
    count: int = request.param
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if count > cores:
        pytest.skip("one core")
    monkeypatch.setattr(execution, "CELLS_PER_THREAD", 1)
    return count
