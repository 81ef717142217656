"""The report of the thesis: its page, its folder and its numbers."""

import json
import math
import re
from html import unescape
from pathlib import Path

import jinja2.meta
import jinja2.nodes
import pytest
from click.testing import CliRunner
from coefficients import diameter_of_cap
from compared import Numbers
from items import ALL_ITEMS, GROUPS, Item, environment, number
from matplotlib.figure import Figure
from pictures import CAPTIONS, FIGURES, drawn
from recomputed import Plan, Runs
from report import judge, main, thesis_report

from warpwear import InputError, Study

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("item", ALL_ITEMS, ids=lambda item: item.id)
def test_a_rule_names_what_there_is(item: Item, content: dict) -> None:
    """In every branch: numbers of a report, printed numbers, tolerances, filters and tests."""
    rule, there = item.rule, environment()
    names = {f"printed.{name}" for name in there.globals["printed"]}
    names |= {f"tolerance.{name}" for name in there.globals["tolerance"]}
    names |= {name if "." in name else f"n.{name}" for name in content["numbers"]}
    expressions = [rule.unless, *rule.let.values(), rule.condition]
    for text in (*(f"{{{{ {expression} }}}}" for expression in expressions), rule.yes, rule.no):
        tree = there.parse(text)
        allowed = {*GROUPS, "n", "printed", "tolerance", "speeds", "times", "abs", "max", *rule.let}
        assert jinja2.meta.find_undeclared_variables(tree) <= allowed
        used = {
            f"{node.node.name}.{node.attr}"
            for node in tree.find_all(jinja2.nodes.Getattr)
            if isinstance(node.node, jinja2.nodes.Name)
        }
        assert used <= names
        assert {node.name for node in tree.find_all(jinja2.nodes.Filter)} <= set(there.filters)
        assert {node.name for node in tree.find_all(jinja2.nodes.Test)} <= set(there.tests)


def test_every_item_is_told_by_complete_numbers(content: dict) -> None:
    complete = {name: 0.9 if value is None else value for name, value in content["numbers"].items()}
    for name, verdict in judge(complete).items():
        assert "The runs do not say" not in verdict.reason, name
        assert not re.search(r"[{}%]{2}|  |None", verdict.reason), name
        assert verdict.reason.endswith("."), name


def test_summary_shows_a_verdict_where_something_is_printed(page: str, content: dict) -> None:
    table = page[page.index('<table id="summary-table">') : page.index('id="contents"')]
    rows = re.findall(r"<tr><td>(.*?)</tr>", table, flags=re.DOTALL)
    for row, line in zip(rows, content["summary"], strict=True):
        assert bool(line["printed"]) == (line["verdict"] is not None)
        badges = re.findall(r'<span class="badge [\w-]+">([^<]+)</span>', row)
        assert badges == ([line["verdict"]] if line["verdict"] else [])
        assert f'href="#{line["item"]}"' in row


def small_plan() -> Plan:
    """The published studies on few cells and a tenth of the distance."""
    small = {
        "grid.cell": "30 um",
        "grid.extent": "0.96 mm",
        "sliding.distance": "240 mm",
        "output.snapshots": ["0.3 mm", "30 mm", "120 mm"],
    }
    fine = {"stepping.growth": 1.1} | small
    return Plan(
        {
            "v1": Study.load("v1").replace(small),
            "v2": Study.load("v2").replace(small),
            "v3": Study.load("v3").replace(small),
            "fine": Study.load("v3-fine").replace(fine),
        },
        increments=(3.0,),
        seeds=(1, 2),
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report whose pictures are small, with nothing moved to make room, which draws everything twice."""

    def drawn_once(name: str, runs: Runs, numbers: Numbers) -> Figure:
        figure = drawn(name, runs, numbers)
        figure.set_layout_engine("none")
        return figure

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("report.drawn", drawn_once)
        return thesis_report(tmp_path_factory.mktemp("report") / "new", plan=small_plan(), dpi=20).parent


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return (folder / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def content(folder: Path) -> dict:
    return json.loads((folder / "numbers.json").read_text(encoding="utf-8"))


def test_folder_holds_the_page_and_the_numbers_alone(folder: Path) -> None:
    assert sorted(path.name for path in folder.iterdir()) == ["numbers.json", "report.html"]
    assert [path.name for path in folder.parent.iterdir()] == ["new"]


def test_page_has_every_item_and_every_figure(page: str) -> None:
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    assert {item.id for item in ALL_ITEMS} <= set(ids)
    assert {f"fig-{name}" for name in FIGURES} <= set(ids)
    drawn = {name for item in ALL_ITEMS for name in item.figures}
    assert drawn == set(FIGURES) == set(CAPTIONS)
    linked = set(re.findall(r'href="#([^"]+)"', page))
    assert linked <= set(ids)


def test_page_needs_nothing_else(page: str) -> None:
    sources = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert all(source.startswith(("data:image/png;base64,", "#")) for source in sources)
    assert "<script" not in page
    assert "<link" not in page
    assert "url(" not in page
    assert "@import" not in page


def test_page_says_what_the_numbers_say(page: str, content: dict) -> None:
    """Tables and verdicts of the page against numbers.json, item by item."""
    plain = re.sub(r'src="data:[^"]*"', "", page)
    for item in content["items"]:
        start = plain.index(f'id="{item["id"]}"')
        part = plain[start : re.search(r"<section|<h[23] id=|$", plain[start:]).start() + start]
        badge = re.search(r'<span class="badge [\w-]+">([^<]+)</span>\. ([^<]+)</div>', part)
        assert badge
        assert (badge[1], unescape(badge[2])) == (item["verdict"], item["reason"])
        shown = re.findall(r'<data class="(ours|printed)" value="([^"]+)">([^<]+)</data>', part)
        expected = [
            (kind, value if kind == "ours" else value["value"])
            for row in item["rows"]
            for kind in ("printed", "ours")
            for value in row[kind].values()
        ]
        assert len(shown) >= len(expected)
        for (kind, exact, text), (expected_kind, value) in zip(shown, expected, strict=False):
            assert kind == expected_kind
            if value is None:
                assert (exact, text) == ("nan", "–")
            else:
                assert float(exact) == value
                if kind == "ours" and abs(value) >= 1e-9:
                    assert text == number(value, 4)


def test_numbers_are_those_of_the_runs(content: dict) -> None:
    """Against Archard's law: K F L in mm³, whatever the contact."""
    numbers = content["numbers"]
    assert numbers["v1.counter_volume_mm3"] == pytest.approx(9.4e-7 * 8.0 * 240.0, rel=1e-10)
    assert numbers["fine.disc_volume_mm3"] == pytest.approx(12.7e-7 * 8.0 * 240.0, rel=1e-10)
    # The rim of a cap of height h, V = π h² (3R − h)/3, h by Newton; (4 R K F L/π)^¼ of a paraboloid.
    height = math.sqrt(22.1e-7 * 1920.0 / (math.pi * 3.0))
    for _ in range(9):
        excess = math.pi * height**2 * (9.0 - height) / 3.0 - 22.1e-7 * 1920.0
        height -= excess / (math.pi * height * (6.0 - height))
    assert numbers["closed_form_patch_mm"] == pytest.approx(2.0 * math.sqrt(height * (6.0 - height)))
    assert numbers["paraboloid_patch_mm"] == pytest.approx(
        2.0 * (12.0 * 22.1e-7 * 1920.0 / 3.14159265) ** 0.25
    )
    assert numbers["v1.patch_by_depth_mm"] == pytest.approx(
        diameter_of_cap(22.1e-7 * 1920.0, radius=3.0), rel=0.002
    )
    assert numbers["experiment.K_by_cap"] == pytest.approx(3.5e-4, rel=0.01)
    assert numbers["experiment.K_by_ellipsoid"] == pytest.approx(9.35e-4, rel=0.001)
    assert numbers["experiment.patch_of_printed_K_mm"] == pytest.approx(1.0223, abs=0.0001)


def test_page_quotes_the_refusal_and_lists_assumptions(page: str) -> None:
    text = unescape(page)
    assert "beyond the explicit stability limit" in text
    assert "<td>contact.hardness</td><td>590 MPa</td>" in page
    assert "the measured topography is not published" in text


def test_a_report_is_not_overwritten_unasked(folder: Path) -> None:
    before = (folder / "numbers.json").read_bytes()
    with pytest.raises(InputError, match="already holds a report"):
        thesis_report(folder, plan=small_plan())
    assert (folder / "numbers.json").read_bytes() == before


def test_other_files_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="holds other files"):
        thesis_report(tmp_path, plan=small_plan(), overwrite=True)
    with pytest.raises(InputError, match="is a file"):
        thesis_report(tmp_path / "notes.txt", plan=small_plan())


def test_a_run_that_fails_leaves_nothing(tmp_path: Path) -> None:
    plan = small_plan()
    narrow = plan.studies["v1"].replace({"grid.extent": "0.3 mm"})
    with pytest.raises(InputError, match="too small"):
        thesis_report(tmp_path / "new", plan=Plan(plan.studies | {"v1": narrow}, (3.0,), (1,)))
    assert list(tmp_path.iterdir()) == []


def test_command_refuses_before_it_computes(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    made = CliRunner().invoke(main, ["--quick", "--out", str(tmp_path / "file")])
    assert (made.exit_code, "is a file" in made.stderr) == (2, True)
    assert CliRunner().invoke(main, ["--help"]).exit_code == 0


def test_the_report_is_a_user_of_public_names() -> None:
    for path in (Path(__file__).parents[2] / "bench" / "thesis").glob("*.py"):
        imported = re.findall(r"^\s*(?:from|import) (warpwear\S*)", path.read_text(encoding="utf-8"), re.M)
        assert {*imported} <= {"warpwear"}, path.name
