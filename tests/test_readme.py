"""What the README and the documentation show works as it stands there."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
NAMES = [page.relative_to(ROOT).as_posix() for page in PAGES]


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def headings(page: Path) -> set[str]:
    """Anchors of a page, as Markdown readers make them."""
    found = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in found}


def test_the_readme_is_short() -> None:
    assert len(TEXT.splitlines()) <= 100


def test_the_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    (example,) = blocks(TEXT, "python")
    code = example.replace('"5 um"', '"20 um"')
    assert code != example
    assert code.count("\n") <= 22
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("mm² in contact at the end") == 3
    assert (tmp_path / "loads.png").is_file()


def test_the_study_is_a_study(tmp_path: Path) -> None:
    from warpwear import Study

    (study_text,) = blocks(TEXT, "toml")
    (tmp_path / "my-disc.toml").write_text(study_text, encoding="utf-8")
    study = Study.load(tmp_path / "my-disc.toml")
    assert study.disc.surface == str(tmp_path.resolve() / "disc.sur")
    assert study.notices() == []


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith(("http://", "https://")):
            continue
        name, _, anchor = target.partition("#")
        path = (page.parent / name).resolve() if name else page
        assert path.exists(), target
        if anchor:
            assert anchor in headings(path), target


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_examples_can_be_read(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for block in blocks(text, "toml"):
        tomllib.loads(block)
    for block in blocks(text, "python"):
        compile(block, page.name, "exec")


def test_the_map_names_what_is_there() -> None:
    text = (
        (ROOT / "docs" / "developer" / "index.md")
        .read_text(encoding="utf-8")
        .partition("## What lies where")[2]
    )
    names = re.findall(r"`([a-z_/]+\.py|[a-z_]+/(?:[a-z_]+/)?)`", text)
    names = [name for name in names if not name.startswith("build/")]  # there once it is made
    assert len(names) > 10
    for name in names:
        places = (ROOT / name, ROOT / "warpwear" / name, ROOT / "bench" / name, ROOT / "tests" / name)
        assert any(place.exists() for place in places), name
