"""A run that was left alone, which runs that were stopped are compared with."""

from pathlib import Path

import pytest
from cases_stopped import short

import warpwear


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of `short` left alone."""
    out = tmp_path_factory.mktemp("runs") / "alone"
    warpwear.run(short(), out=out, plots=False, threads=1).close()
    return out
