"""Finished runs of which figures are drawn."""

import pytest
from cases_drawn import RUNS, SMALL

import warpwear
from warpwear import Result, Study


class Results(dict[str, Result]):
    """Finished runs by the name of their kind, in folders without figures, made when they are asked for."""

    def __init__(self, folders: pytest.TempPathFactory) -> None:
        super().__init__()
        self._where = folders.mktemp("runs")

    def __missing__(self, name: str) -> Result:
        study = Study.load("v3-fine").replace(SMALL | RUNS[name])
        self[name] = warpwear.run(study, out=self._where / name.replace(" ", "-"), plots=False)
        return self[name]


@pytest.fixture
def few_pixels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Films that are soon drawn."""
    monkeypatch.setattr("warpwear.figures.of_run.animation.DPI", 40)


@pytest.fixture(scope="session")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Result]:
    """Finished runs of each kind by its name."""
    return Results(tmp_path_factory)
