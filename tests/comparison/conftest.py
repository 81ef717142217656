"""Runs and a measured record that comparisons are made of."""

from pathlib import Path

import numpy as np
import pytest

import warpwear
from warpwear import Study


@pytest.fixture(scope="session")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders of runs: 'a', at half the load 'light', with another disc 'soft', and static 'still'."""
    folder = tmp_path_factory.mktemp("runs")
    study = Study.load("v3-fine").replace(
        {"grid.cell": "10 um", "sliding.distance": "30 mm", "output.snapshots": ["3 mm", "30 mm"]}
    )
    light = {"contact.load": "4 N", "sliding.distance": "60 mm", "sliding.speed": "40 mm/min"}
    soft = {"wear.disc": "25e-4 mm^3/N/m", "friction.ploughing": 0.05, "study.name": "soft"}
    still = {"sliding.distance": "0 mm", "output.snapshots": [], "study.name": "still"}
    for name, changes in {"a": {}, "light": light, "soft": soft, "still": still}.items():
        warpwear.run(study.replace(changes), out=folder / name, plots=False).close()
    return folder


@pytest.fixture
def measured(tmp_path: Path) -> Path:
    """μ = 0.1 + √(distance/mm)/100 with two columns that could be it."""
    distance = np.linspace(0.0, 40.0, 801)
    path = tmp_path / "sample 3.csv"
    header = "Distance [m];COF"
    table = np.column_stack([distance / 1e3, 0.1 + 0.01 * np.sqrt(distance)])
    np.savetxt(path, table, delimiter=";", header=header, comments="", fmt="%.9f")
    return path
