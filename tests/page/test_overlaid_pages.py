"""The pages of a comparison and of a sweep: as safe, as light and as whole as that of a run."""

import base64
import json
import re
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import pytest
from cases_pages import EVIL, EVIL_FILE, check_page, visit
from click.testing import CliRunner

import warpwear
from warpwear import Study
from warpwear.cli.main import commands
from warpwear.figures import style as fs
from warpwear.figures.describe import Axis, Chart, Figure, Line
from warpwear.figures.paint import paint
from warpwear.results.ensemble import in_legend
from warpwear.sweeps.report import write_report

SMALL = {"grid.cell": "20 um", "sliding.distance": "3 mm", "output.snapshots": ["0.3 mm"]}


def plots_of(page: str) -> list[dict[str, Any]]:
    found = re.search(r'id="data">([^<]*)<', page)
    assert found
    plots: list[dict[str, Any]] = json.loads(zlib.decompress(base64.b64decode(found[1])))["plots"]
    return plots


def numbers(packed: dict[str, Any]) -> Any:
    return np.frombuffer(base64.b64decode(packed["data"]), "<f4").reshape(packed["shape"][::-1]).T


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A sweep over two measured discs with hostile names, two loads and one that no study has."""
    folder = tmp_path_factory.mktemp("swept")
    names = []
    for seed in (0, 1):
        names.append(str(folder / f"{seed}{EVIL_FILE}.npy"))
        np.save(names[-1], 1e-3 * np.random.default_rng(seed).normal(size=(100, 100)))
    disc = {"disc.pixel": "20 um", "disc.height_unit": "mm", "disc.surface": names[0]}
    study = Study.load("v3-fine").replace(SMALL | disc | {"study.description": EVIL})
    vary = {"disc.surface": names, "contact.load": ["4 N", "8 N", "-8 N"]}
    with ThreadPoolExecutor(1) as pool:
        return warpwear.sweep(
            study, vary=vary, band_over="disc.surface", out=folder / EVIL_FILE, executor=pool
        )


@pytest.fixture(scope="module")
def compared(swept: Any, tmp_path_factory: pytest.TempPathFactory, quick_pictures: Any) -> Path:
    """A comparison of hostile names: the runs of the sweep, a run with a page, and a measured course."""
    folder = tmp_path_factory.mktemp("compared")
    with quick_pictures(blank=True):
        warpwear.run(Study.load("v3-fine").replace(SMALL), out=folder / f"run {EVIL_FILE}").close()
    (folder / f"{EVIL_FILE}.csv").write_text("Distance [mm],COF\n0.1,0.2\n1,0.3\n3,0.4\n", encoding="utf-8")
    asked = [
        "compare",
        str(swept.folder),
        str(folder / f"run {EVIL_FILE}"),
        "--out",
        str(folder / EVIL_FILE[:60]),
    ]
    asked += ["--experiment", str(folder / f"{EVIL_FILE}.csv")]
    made = CliRunner().invoke(commands, asked, catch_exceptions=False)
    assert made.exit_code == 0, made.output
    return folder / EVIL_FILE[:60]


def test_a_sweep_shows_what_it_found(swept: Any) -> None:
    page, parts = check_page(swept.folder / "sweep.html")
    assert "4 of 6 runs of one study" in page
    assert "2 × failed: contact.load" in page
    assert "Not predicted" in page
    plots = {plot["id"]: plot for plot in plots_of(page)}
    course = plots["coefficient of friction"]["lines"]
    assert [line["name"] for line in course] == ["load 4 N", "load 8 N"]
    mean, low, high = swept.band("cof", swept.plan.groups["load 8 N"])
    for part, of in (("y", mean), ("low", low), ("high", high)):
        np.testing.assert_allclose(numbers(course[1][part]), of, rtol=1e-6)
    bars = next(plot for plot in plots_of(page) if plot["kind"] == "bars")
    assert bars["names"] == ["load", "surface"] or bars["names"] == ["surface", "load"]
    np.testing.assert_allclose(
        sorted(numbers(bars["values"])), sorted(swept.influence("cof").values()), rtol=1e-6
    )
    runs = [link for link in parts.links if link.startswith("runs/")]
    assert len(runs) == 4
    assert all((swept.folder / link).is_dir() for link in runs)


def test_a_sweep_leads_to_pages_that_are_there(swept: Any, quick_pictures: Any) -> None:
    run = swept.plan.points[0].run
    asked = ["report", str(swept.folder / "runs" / run)]
    with quick_pictures(blank=True):
        made = CliRunner().invoke(commands, asked, catch_exceptions=False)
        assert made.exit_code == 0, made.output
        from_sweep = write_report(swept, swept.folder)
    assert swept.folder / "sweep.html" in from_sweep
    assert f"runs/{run}/report.html" in check_page(swept.folder / "sweep.html")[1].links


@pytest.mark.slow
def test_indices_of_a_sampled_design(tmp_path: Path) -> None:
    """Bars with intervals and dots are Sobol's indices in the order of their size."""
    vary = {"contact.load": "uniform 2 .. 8 N", "wear.counter": "normal 9.4e-4 +- 0.7e-4 mm^3/N/m"}
    study = Study.load("v3-fine").replace(SMALL)
    found = warpwear.sweep(study, vary=vary, design="saltelli", samples=2, out=tmp_path / "s", workers=1)
    page, _ = check_page(tmp_path / "s/sweep.html")
    bars = next(plot for plot in plots_of(page) if plot["kind"] == "bars")
    indices = found.sobol("cof")
    order = [found.plan.keys.index(key) for key in found.influence("cof")]
    np.testing.assert_allclose(numbers(bars["values"]), indices.total[order], rtol=1e-5)
    np.testing.assert_allclose(numbers(bars["dots"]), indices.first[order], rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(numbers(bars["ends"]), indices.total_interval[:, order], rtol=1e-5, atol=1e-7)
    assert "uniform: 2 to 8 N" in page
    assert "5 to 95 % of the runs" in page


def test_a_heat_map_has_its_values_in_place(tmp_path: Path, quick_pictures: Any) -> None:
    vary = {"contact.load": ["4 N", "8 N"], "contact.hardness": ["400 MPa", "590 MPa", "800 MPa"]}
    study = Study.load("v3-fine").replace(SMALL | {"sliding.distance": "0 mm", "output.snapshots": []})
    with quick_pictures(blank=True), ThreadPoolExecutor(1) as pool:
        found = warpwear.sweep(study, vary=vary, out=tmp_path / "grid", executor=pool)
    grid = next(p for p in plots_of(check_page(tmp_path / "grid/sweep.html")[0]) if p["kind"] == "grid")
    assert (grid["across"], grid["down"]) == (["4", "8"], ["400", "590", "800"])
    ends = found.ends("cof").reshape(2, 3)  # the first key varies slowest
    np.testing.assert_allclose(numbers(grid["values"]), ends, rtol=1e-6)


def test_a_comparison_shows_what_differs(compared: Path) -> None:
    page, parts = check_page(compared / "compare.html")
    assert "contact.load" in page
    assert "(measured)" in page
    record = json.loads((compared / "comparison.json").read_text())["comparison"]
    plots = {plot["id"]: plot for plot in plots_of(page)}
    assert len(plots["area in contact"]["lines"]) == 5
    assert len(plots["coefficient of friction"]["lines"]) == 6
    for name, values in record.items():
        if values["kind"] == "run":
            line = next(line for line in plots["area in contact"]["lines"] if line["name"] == name)
            assert numbers(line["y"])[-1] == pytest.approx(values["area_contact"], rel=1e-6)
    targets = [compared / unquote(link) for link in parts.links if not link.startswith("#")]
    assert len(targets) == 5
    assert all(target.exists() for target in targets)
    assert sum(target.name == "report.html" for target in targets) >= 1


def test_names_are_no_formulas() -> None:
    """Of a figure either: a broken formula would end the whole comparison."""
    line = Line(np.arange(2.0), np.arange(2.0), in_legend(r"$\frac{$" + "x" * 300))
    assert fs.bytes_of(paint(Figure([Chart("", Axis(), Axis(), [line])], legend=1)))
    assert len(in_legend("x" * 300)) == 60


@pytest.mark.slow
@pytest.mark.parametrize("width", [400, 1280])
@pytest.mark.parametrize("kind", ["sweep", "compare"])
def test_they_fit_and_ask_for_nothing(
    browser: Any, swept: Any, compared: Path, kind: str, width: int
) -> None:
    path = swept.folder / "sweep.html" if kind == "sweep" else compared / "compare.html"
    how = {"viewport": {"width": width, "height": 900}, "color_scheme": "dark" if width == 400 else "light"}
    page, requests, errors = visit(browser, path, **how)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator(".plot.drawn").count() == page.locator(".plot").count()
    page.click("#linear")
    page.click("#theme")
    assert not requests
    assert not errors
    page.close()
