"""Finished runs of which figures are drawn."""

import pytest
from cases_drawn import RUNS, SMALL

import warpwear
from warpwear import Result, Study


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Result]:
    """A finished run of each kind, in a folder without figures."""
    where = tmp_path_factory.mktemp("runs")
    return {
        name: warpwear.run(
            Study.load("v3-fine").replace(SMALL | changes), out=where / name.replace(" ", "-"), plots=False
        )
        for name, changes in RUNS.items()
    }
