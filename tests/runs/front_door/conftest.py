"""Folders of finished runs: of a contact at rest, of a track and of patches."""

from pathlib import Path

import pytest
from cases_front_door import study_of

import warpwear


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("front") / "quick"
    warpwear.run(study_of(output__snapshots=["0.003 mm", "0.3 mm"]), out=out, plots=False).close()
    return out


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("front") / "swept"
    warpwear.run(study_of("track", sliding__plastic="keep"), out=out, plots=False).close()
    return out
