"""What the README shows works as it stands there."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    found = re.search(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)
    assert found
    return found.group(1)


def test_the_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    code = block("python").replace('"5 um"', '"20 um"')
    assert code.count("\n") <= 22
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("islands after 30 mm") == 3
    assert (tmp_path / "loads.png").is_file()


def test_the_study_is_a_study(tmp_path: Path) -> None:
    from warpwear import Study

    (tmp_path / "my-disc.toml").write_text(block("toml"), encoding="utf-8")
    study = Study.load(tmp_path / "my-disc.toml")
    assert study.disc.surface == str(tmp_path.resolve() / "disc.sur")
    assert study.notices() == []


def test_the_map_names_what_is_there() -> None:
    for name in re.findall(r"`([a-z_/]+\.py|[a-z]+/)`", TEXT.partition("## Where things are")[2]):
        places = (ROOT / name, ROOT / "warpwear" / name, ROOT / "bench" / name)
        assert any(place.exists() for place in places), name
