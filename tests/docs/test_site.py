"""The pages of the site hold what the code has. Whether they can be made, continuous integration looks."""

import importlib.util
import re
import tomllib
import zipfile
from importlib.metadata import PackageNotFoundError, metadata
from itertools import pairwise
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"


def loaded(script: Path) -> Any:
    spec = importlib.util.spec_from_file_location(script.stem, script)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_picture_of_the_house_is_that_of_the_code() -> None:
    house = loaded(DOCS / "make_house.py")
    assert house.PICTURE.read_text(encoding="utf-8") == house.picture(), "run: python docs/make_house.py"
    level = {wing: number for number, storey in enumerate(house.storeys()) for wing in storey}
    arrows = house.shortest(house.imports())
    assert len(arrows) > 20
    assert all(level[wing] < level[other] for wing, other in arrows)


def test_no_arrow_of_the_house_passes_behind_a_box() -> None:
    picture = (DOCS / "developer" / "house.svg").read_text(encoding="utf-8")
    boxes = re.findall(r'<rect x="(\d+)" y="(\d+)" width="(\d+)" height="(\d+)" rx', picture)
    paths = re.findall(r'<path d="(M[^"]*)" fill="none"', picture)
    assert len(boxes) > 20
    assert len(paths) > 20
    for path in paths:
        ends = [tuple(map(float, pair)) for pair in re.findall(r"(-?\d+) (-?\d+)", path)]
        for (x0, y0), (x1, y1) in pairwise(ends):
            for part in (n / 50 for n in range(51)):
                x, y = x0 + part * (x1 - x0), y0 + part * (y1 - y0)
                for left, top, width, height in (map(float, box) for box in boxes):
                    assert not (left + 1 < x < left + width - 1 and top + 1 < y < top + height - 1), path


def test_the_gallery_shows_every_example_once() -> None:
    shown = re.findall(r"^```\{example\} (\w+)$", (DOCS / "gallery.md").read_text(encoding="utf-8"), re.M)
    assert sorted(shown) == sorted(path.stem for path in (ROOT / "examples").glob("*.py"))


def test_no_folder_of_pages_is_full() -> None:
    folders = [DOCS, *(path for path in DOCS.iterdir() if path.is_dir() and path.name != "__pycache__")]
    counts = {folder.name: sum(path.is_file() for path in folder.iterdir()) for folder in folders}
    assert all(count <= 16 for count in counts.values()), counts


def test_every_page_is_on_the_way_from_the_first() -> None:
    """Each lies in the table of contents of another."""
    listed = {"index"}
    pages = {path.relative_to(DOCS).with_suffix("").as_posix(): path for path in DOCS.rglob("*.md")}
    for name, path in pages.items():
        for tree in re.findall(r"```\{toctree\}\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL):
            lines = [line for line in tree.splitlines() if line and not line.startswith(":")]
            entries = [re.sub(r".*<(.*)>", r"\1", line) for line in lines]
            listed |= {(Path(name).parent / entry).as_posix() for entry in entries}
    assert listed == set(pages)


def test_links_to_other_places_are_these() -> None:
    """They are listed, not fetched; `nox -s links` fetches them."""
    pages = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
    found = {
        link
        for page in pages
        for link in re.findall(r"\]\((https?://[^)\s]+)\)", page.read_text(encoding="utf-8"))
    }
    assert found == {
        "https://contact.engineering",
        "https://github.com/nick-garabedian/TriboDataFAIR-Ontology",
        "https://w3id.org/ro/crate/1.1",
        "https://distributed.dask.org",
        "https://centre-borelli.github.io/ruptures-docs/",
        "https://emcee.readthedocs.io",
        "https://github.com/ContactEngineering/SurfaceTopography",
        "https://github.com/NVIDIA/warp",
    }


def test_the_made_surface_says_that_it_is_made() -> None:
    with zipfile.ZipFile(DOCS / "files" / "ground-disc.x3p") as file:
        assert b"not measured" in file.read("main.xml")
    assert sum(path.stat().st_size for path in (DOCS / "files").iterdir()) < 400_000


def test_the_licences_of_what_is_needed_are_told() -> None:
    """Each package, with words that its own metadata has where it is installed."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = project["dependencies"] + project["optional-dependencies"]["io"]
    page = (DOCS / "how-to" / "pipeline.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([\w, -]+) \| ([^|]+) \|$", page.partition("| package | licence |")[2], re.M)
    told = {name: licence for names, licence in rows for name in names.split(", ")}
    assert set(told) == {re.split(r"[<>=~]", need)[0] for need in needed}
    for name, licence in told.items():
        try:
            about = metadata(name)
        except PackageNotFoundError:
            continue
        says = " ".join(
            [about.get("License-Expression", ""), about.get("License", ""), *about.get_all("Classifier", [])]
        )
        word = re.split(r"[-\d ]", licence)[0]
        assert word in says, f"{name}: {says[:200]}"


def test_each_argument_that_a_docstring_explains_has_a_line() -> None:
    spec = importlib.util.spec_from_file_location("arguments", DOCS / "extensions" / "arguments.py")
    assert spec is not None
    assert spec.loader is not None
    arguments = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(arguments)
    text = "load, gap: one of\nthem, as a: b says; here. out: folder. And so on."
    assert arguments.listed(text, {"load", "gap", "out"}) == [
        "- **load, gap**: one of them, as a: b says; here.",
        "- **out**: folder. And so on.",
    ]
    assert arguments.listed("Raises it.\nload: no.", {"load"}) == ["Raises it.", "load: no."]
    assert arguments.listed("load: no.", set()) == ["load: no."]
    given = "(heights: _Buffer | _SupportsArray[dtype[Any]] | x._NestedSequence[complex | bytes | str])"
    array = "~numpy.ndarray[tuple[~typing.Any, ...], ~numpy.dtype[~numpy.float64]]"
    found = arguments._signature(None, "function", "f", None, None, given, f"{array} | None")
    assert found == ("(heights: ArrayLike)", "ndarray | None")


def test_what_cells_printed_is_that_of_these_cells() -> None:
    """A copy of an output carries a digest of its cell and those above, so that none outlives a change."""
    outputs = loaded(DOCS / "extensions" / "outputs.py")
    copies = 0
    for page in sorted(DOCS.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        digests = [digest for *_, digest in outputs.cells(outputs.without(text))]
        stored = outputs.COPY.findall(text)
        assert [digest for digest in digests if digest in stored] == stored, f"{page}: docs/make_outputs.py"
        copies += len(stored)
    assert copies > 20
