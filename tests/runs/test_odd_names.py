"""Names of files and folders that are not UTF-8, of old archives: commands work, and say them escaped."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpwear.cli.main import main
from warpwear.errors import escaped, unescaped
from warpwear.study.loading import parse_toml
from warpwear.study.study import Study

ODD = os.fsdecode(b"M\xfcller")
STUDY = """
counter = {radius = "3 mm", material = "AISI 52100"}
disc = {surface = "s.npy", pixel = "20 um", height_unit = "um", material = "AISI 304"}
contact = {load = "2 N", law = "local"}
wear = {counter = "1e-5 mm^3/N/m", disc = "1e-5 mm^3/N/m"}
grid = {cell = "20 um", extent = "0.6 mm"}
sliding = {distance = "3 mm", speed = "20 mm/min"}
friction = {coefficient = 0.6}
"""


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / ODD
    try:
        folder.mkdir()
    except (OSError, UnicodeError):
        pytest.skip("this file system has no such names")
    monkeypatch.chdir(folder)
    np.save(folder / "s.npy", np.random.default_rng(0).normal(0.0, 0.2, (40, 40)))
    (folder / "s.toml").write_text(STUDY)
    return folder


@pytest.fixture
def blank(quick_pictures: Any) -> Iterator[None]:
    """Nobody looks at the pictures."""
    with quick_pictures(blank=True):
        yield


def invoke(*arguments: str) -> None:
    with pytest.raises(SystemExit) as end:
        main([*arguments])
    assert end.value.code == 0, arguments


@pytest.mark.usefixtures("blank")
def test_every_command_takes_them(place: Path) -> None:
    invoke("run", "s.toml", "--out", ODD, "--overwrite")
    invoke("run", f"{ODD}/study.toml", "--out", "again", "--no-plots", "--set", "contact.load=3 N")
    assert Study.load(place / ODD).disc.surface == str(place / "s.npy")
    invoke("compare", ODD, "again", "--out", "both")
    invoke("export", ODD)
    shutil.copy("s.npy", f"{ODD}.npy")
    invoke("surface", f"{ODD}.npy", "--pixel", "20 um", "--height-unit", "um")
    invoke(
        "new",
        "n.toml",
        "--surface",
        f"{ODD}.npy",
        "--set",
        "disc.pixel=20 um",
        "--set",
        "disc.height_unit=um",
    )
    assert Study.load("n.toml").disc.surface == str(place / f"{ODD}.npy")
    Path(f"{ODD}.csv").write_text("Distance [mm],CoF\n" + "".join(f"{n},0.6{n % 3}\n" for n in range(300)))
    invoke("record", f"{ODD}.csv", "--out", "record")
    for path in place.rglob("*"):
        if path.suffix in (".html", ".json", ".csv", ".txt", ".toml", ".md", ".tex"):
            path.read_text(encoding="utf-8")


def test_a_locale_without_such_signs_is_no_hindrance(place: Path) -> None:
    folder = place.parent / "M\u00fcller"
    shutil.copytree(place, folder)
    environment = os.environ | {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = [sys.executable, "-m", "warpwear", "run", "s.toml", "--out", "o", "--no-plots"]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert Path(str(Study.load(folder / "o").disc.surface)).is_file()


@pytest.mark.parametrize("name", [ODD, "plain", "M\u00fcller", "a\\b"])
def test_what_is_escaped_comes_back(name: str) -> None:
    assert unescaped(escaped(name)) == name
    escaped(name).encode()
    assert parse_toml(f'a = "{escaped(name)}"'.replace("\\", "\\\\")) == {"a": name}
