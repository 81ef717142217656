"""The page of a run: one file without requests, harmless whatever its names, turned in a browser."""

import base64
import hashlib
import html
import inspect
import json
import re
import zlib
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_pages import EVIL, visit
from cases_track import small
from click.testing import CliRunner

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli.main import commands
from warpwear.figures import process
from warpwear.history.end_values import Summary
from warpwear.page.content import content_of, words_of, write_page
from warpwear.page.effects import EFFECTS, Weight, effect_of, numbers_of
from warpwear.page.html import run_page
from warpwear.page.limits import CONDITIONS, LIMITS, limits_of
from warpwear.page.plots import coded, thinned
from warpwear.page.words import latex_of, to_latex

MOST = 6e6  # bytes of a page
#: Keys of which more is known than that a sweep tells.
WITH_EFFECTS = {key for effect in EFFECTS for key in effect.keys} - {"unknown"}
PLAIN = {"grid.cell": "20 um", "sliding.distance": "10 mm", "output.snapshots": ["0.3 mm", "3 mm"]}
KINDS = ("track", "two-scale", "static", "half-space", "measured", "smooth")


def study_of(kind: str) -> Study:
    """A small study of a kind."""
    if kind == "track":
        return small("full", output__snapshots=["3 mm"], grid__cell="10 um", sliding__shift=8)
    if kind == "two-scale":
        more = {"grid.cell": "10 um", "disc.synthetic.cut_off": "20 um", "sliding.distance": "3 mm"}
        return Study.load(kind).replace(more | {"output.snapshots": ["0.3 mm"]})
    changes: dict[str, dict[str, Any]] = {
        "static": {"sliding.distance": "0 mm", "output.snapshots": []},
        "half-space": {
            "contact.law": "half-space",
            "sliding.distance": "1 mm",
            "output.snapshots": ["0.3 mm"],
        },
        "smooth": {"study.model": "macro"},
        "measured": {"study.description": EVIL},
    }
    return Study.load("v3-fine").replace(PLAIN | changes.get(kind, {}))


@pytest.fixture(scope="module")
def page_of(tmp_path_factory: pytest.TempPathFactory, quick_pictures: Any) -> Callable[..., Path]:
    """Makes a run of a kind once, and its page, whole or with `quick_pictures`; gives the page's path."""
    made: dict[tuple[str, bool], Path] = {}

    def page(kind: str, *, quick: bool = False) -> Path:
        if (kind, quick) not in made:
            folder = tmp_path_factory.mktemp("pages") / kind
            study: Any = study_of(kind)
            if kind == "measured":
                name = folder.parent / '<script>x</script "$.npy'.replace("/", "")
                np.save(name, 1e-3 * np.random.default_rng(0).normal(size=(100, 100)))
                study = study.replace(
                    {"disc.pixel": "20 um", "disc.height_unit": "mm", "disc.surface": str(name)}
                )
            with quick_pictures() if quick else nullcontext():
                warpwear.run(study, out=folder).close()
            made[kind, quick] = folder / "report.html"
        return made[kind, quick]

    return page


def data_of(page: str) -> Any:
    found = re.search(r'id="data">([^<]*)<', page)
    assert found
    return json.loads(zlib.decompress(base64.b64decode(found[1])))


def array_of(packed: Any) -> Any:
    kind = {"u1": "u1", "u2": "<u2", "f4": "<f4"}[packed["type"]]
    return np.frombuffer(base64.b64decode(packed["data"]), kind).reshape(packed["shape"][::-1]).T


@pytest.mark.parametrize("kind", ["rough", *(pytest.param(k, marks=pytest.mark.slow) for k in KINDS)])
def test_a_run_leaves_a_page_that_needs_nothing(page_of: Callable[..., Path], kind: str) -> None:
    path = page_of(kind)
    page = path.read_text(encoding="utf-8")
    assert len(page.encode()) <= MOST
    outside = re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S)
    assert not re.findall(r'(?:src|href)="(?!data:|#)', outside)
    assert "url(" not in page
    assert "report.html" in json.loads((path.parent / "manifest.json").read_text())["written_by_warpwear"]
    with Result.open(path.parent) as result:
        area = result.summary["area_mm2"]["contact"]
        assert f"{area:.4g}" in page
        for assumed in result.summary["assumptions"]:
            assert assumed in page
        assert page.count('class="weight ') == len(result.summary["assumptions"])
        if result.plot.reason("areas") is None:
            areas = next(p for p in data_of(page)["plots"] if p["id"] == "areas")
            course = array_of(areas["lines"][0]["y"])
            np.testing.assert_allclose(course, result.plot.data.course["area_contact"], rtol=1e-6)
        if result.plot.reason("pressure_map") is None:
            field = next(p for p in data_of(page)["plots"] if p["id"] == "pressure in contact")["fields"][-1]
            codes = array_of(field["codes"])
            values = field["low"] + field["step"] * codes[codes > 0].astype(float)
            values = 10.0**values if field["log"] else values
            truth = result.plot.data.view(result.snapshot_distances.size - 1).pressure
            assert np.array_equal(codes > 0, truth > 0.0)
            step = 10.0 ** field["step"] - 1.0 if field["log"] else field["step"] / truth.max()
            seen = truth[truth > 0.0]
            low = 10.0 ** (field["low"] + field["step"]) if field["log"] else 0.0
            off = np.abs(values - np.maximum(seen, low)) / (seen if field["log"] else truth.max())
            assert off.max() <= step


def test_names_do_nothing(page_of: Callable[..., Path]) -> None:
    page = page_of("measured", quick=True).read_text(encoding="utf-8")
    assert "<script>x<" not in page
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "{{ 7 * 7 }}" in page
    assert page.count("<script") == page.count("</script>") == 3


def test_every_assumption_says_what_it_would_change() -> None:
    """In sentences that end, with numbers of the run where they hang on it."""
    for preset in ("v1", "v2", "v3", "v3-fine", "two-scale", "track", "running-in"):
        assumed = Study.load(preset).assumed
        assert {*assumed} <= WITH_EFFECTS, preset
    study = Study.load("v3-fine").replace(PLAIN | {"disc.synthetic.fine_ra": "0.3 um"})
    with warpwear.run(study) as result:
        rows = words_of(result)["assumptions"]
        assert {row["key"] for row in rows} == {*result.summary["assumptions"]}
    assert [row["weight"] for row in rows] == sorted(row["weight"] for row in rows)
    assert rows[0]["key"] == "friction.shear_strength"
    assert rows[0]["weight"] is Weight.DECIDES
    assert all(re.search(r"[.]( [^ ]|$)|VALUES$", row["effect"]) for row in rows)
    hardness = next(row for row in rows if row["key"] == "contact.hardness")
    assert hardness["weight"] is Weight.LITTLE, "hardly a cell bears it after 10 mm"
    with warpwear.run(study.replace({"sliding.distance": "0 mm", "output.snapshots": []})) as result:
        rows = words_of(result)["assumptions"]
    hardness = next(row for row in rows if row["key"] == "contact.hardness")
    assert hardness["weight"] is Weight.DECIDES, "all of a static contact bears it"
    assert "100 % of the contact" in hardness["effect"]


def test_shear_strength_is_in_proportion_to_the_coefficient() -> None:
    """As the page says of it: half of it, half of the coefficient, and nothing else."""
    study = Study.load("v3-fine").replace(PLAIN)
    with (
        warpwear.run(study) as whole,
        warpwear.run(study.replace({"friction.shear_strength": "1.915 MPa"})) as half,
    ):
        np.testing.assert_allclose(2.0 * half.history["cof"], whole.history["cof"], rtol=1e-12)
        assert np.array_equal(half.history["area_contact"], whole.history["area_contact"])


def test_latex_says_what_stands_there() -> None:
    assert to_latex("a_b $5% \\x{y}~^#&") == (
        r"a\_b \$5\% \textbackslash{}x\{y\}\textasciitilde{}\textasciicircum{}\#\&"
    )
    assert to_latex("10⁻³ mm³/(N·m), 2e-06 ± 1.5e+07") == (
        r"10$^{-3}$ mm$^{3}$/(N$\cdot$m), $2 \cdot 10^{-6}$ $\pm$ $1.5 \cdot 10^{7}$"
    )
    assert to_latex("1e-3x a1e-3 v1.2e3.toml") == "1e-3x a1e-3 v1.2e3.toml"


def test_what_is_an_input_is_marked() -> None:
    fitted = Study.load("v3-fine").replace(PLAIN | {"friction.coefficient": 0.6})
    given = Study.load("v3-fine").replace(PLAIN)
    for study, mark, limit in (
        (fitted, "An input", "is an input"),
        (given, "Not predicted", "not predicted"),
    ):
        with warpwear.run(study) as result:
            words = words_of(result)
        assert words["answers"][-1].input_note.startswith(mark)
        assert sum(limit in sentence for sentence in words["limits"]) == 1


def test_sentences_are_all_reached() -> None:
    """Each limit has conditions that there are; each sentence on an assumption is that of a key or a case."""
    of_effects = {name.removeprefix("not ") for effect in EFFECTS for name in effect.conditions}
    of_limits = {name for names in LIMITS for name in names.split(", ")}
    assert of_limits | of_effects | {"softer body"} == {*CONDITIONS}
    with warpwear.run(Study.load("v3-fine").replace(PLAIN)) as result:
        for key in WITH_EFFECTS:
            weight, sentence = effect_of(
                key, result.study, numbers_of(result.study, Summary.of(result.summary))
            )
            assert isinstance(weight, Weight)
            assert sentence.endswith(".")
            assert "{" not in sentence


@pytest.mark.parametrize(("hardness", "is_told"), [("590 MPa", True), ("320 MPa", False), ("inf MPa", False)])
def test_limits_say_that_cells_at_a_hardness_wear_severely(hardness: str, is_told: bool) -> None:
    """A transition from 250 to 350 MPa ends below the first hardness alone."""
    transition = {"law": "transition", "transition_pressure": "300 MPa", "transition_width": "100 MPa"}
    transition |= {"severe_counter": "9e-3 mm^3/N/m", "severe_disc": "9e-3 mm^3/N/m"}
    changes = {f"wear.{key}": value for key, value in transition.items()}
    study = Study.load("v1").replace({**changes, "stepping.scheme": "implicit", "contact.hardness": hardness})
    told = " ".join(limits_of(study))
    assert ("cells at the hardness always wear severely" in told) == is_told
    assert "K follows the pressure of each cell" in told


def test_limits_follow_the_run() -> None:
    def said(kind: str) -> str:
        return " ".join(limits_of(study_of(kind)))

    assert "lies still" in said("rough")
    assert "lies still" not in said("track")
    assert "lies still" not in said("static")
    assert "Asperities do not feel" in said("rough")
    assert "Asperities do not feel" not in said("half-space")
    assert "smooth" in said("smooth")


def test_no_plots_no_page_and_an_old_one_goes(tmp_path: Path, quick_pictures: Any) -> None:
    study = study_of("static")
    with quick_pictures(blank=True):
        warpwear.run(study, out=tmp_path / "run").close()
    assert (tmp_path / "run/report.html").is_file()
    warpwear.run(study, out=tmp_path / "run", plots=False, overwrite=True).close()
    assert not (tmp_path / "run/report.html").exists()
    (tmp_path / "run/report.html").write_text("mine")
    with pytest.raises(InputError, match=r"report\.html"):
        warpwear.run(study, out=tmp_path / "run", overwrite=True)
    with pytest.raises(InputError, match="not a page of warpwear"):
        write_page(tmp_path / "run", b"")
    assert (tmp_path / "run/report.html").read_text() == "mine"


@pytest.mark.slow
def test_a_second_process_makes_the_same_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """But for the pictures' compression, which is alike too."""
    start, pages = inspect.unwrap(process.Painter.__init__), []
    for cores in (1, 2):
        with monkeypatch.context() as patched:
            patched.setattr(process.Painter, "__init__", lambda self, n, c=cores: start(self, n and c))
            warpwear.run(study_of("rough"), out=tmp_path / f"{cores}").close()
        text = (tmp_path / f"{cores}/report.html").read_text(encoding="utf-8")
        pages.append(re.sub(r"(?s)<details><summary>The summary.*?</details>", "", text))
    assert pages[0] == pages[1]


def test_the_command_makes_it_again(tmp_path: Path, quick_pictures: Any) -> None:
    path = tmp_path / "run" / "report.html"
    warpwear.run(study_of("track"), out=path.parent, plots=False).close()
    written = []
    for _ in range(2):
        with quick_pictures(blank=True):
            made = CliRunner().invoke(commands, ["report", str(path.parent)], catch_exceptions=False)
        assert made.exit_code == 0
        written.append(path.read_bytes())
    assert written[0] == written[1]
    help_text = CliRunner().invoke(commands, ["report", "--help"]).output
    assert "DIR" in help_text


def test_codes_keep_values() -> None:
    values = np.array([[np.nan, 1.0], [30.0, 1000.0]])
    of = coded(values, 1.0, 1000.0, log=True)
    assert of["codes"][0, 0] == 0
    back = 10.0 ** (of["low"] + of["step"] * of["codes"])
    np.testing.assert_allclose(back[0, 1], 1.0)
    np.testing.assert_allclose(back[1], [30.0, 1000.0], rtol=0.014)
    steps = np.linspace(1e-3, 1e5, 200_000)
    chosen = thinned(steps)
    assert chosen[0] == 0
    assert chosen[-1] == steps.size - 1
    assert chosen.size <= 1500


def test_a_name_of_a_run_in_memory(tmp_path: Path) -> None:
    with warpwear.run(study_of("static")) as result:
        page = run_page(content_of(result, result.plot), {})
    assert page.count(b"<img") == 1, "the bodies, drawn of the page's own data"


@pytest.mark.slow
def test_slider_by_keyboard_and_bodies_by_mouse(browser: Any, page_of: Callable[..., Path]) -> None:
    page, requests, errors = visit(browser, page_of("rough"), viewport={"width": 1280, "height": 900})
    shown = "document.querySelector('.plot.map').data[0].z"
    last = page.evaluate(f"{shown}.flatMap(row => [...row]).filter(v => v === v).length")
    page.focus(".slider")
    page.keyboard.press("Home")
    assert page.inner_text("output") == "after 0.3 mm"
    page.wait_for_function(f"{shown}.flatMap(row => [...row]).filter(v => v === v).length !== {last}")
    node = page.locator(".plot.bodies")
    node.scroll_into_view_if_needed()
    box = node.bounding_box()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.55 * box["height"], steps=4)
    page.mouse.up()
    page.wait_for_function("document.querySelector('.plot.bodies').dataset.turned > 0")
    eye = "document.querySelector('.plot.bodies').layout.scene.camera.eye.x"
    before = page.evaluate(eye)
    node.focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_function(f"{eye} !== {before}")
    page.click("#choose-body button:nth-child(3)")
    page.click("#theme")
    assert page.evaluate("document.documentElement.classList.contains('dark')")
    assert not requests
    assert not errors
    page.close()


@pytest.mark.slow
@pytest.mark.parametrize("width", [400, 1280])
@pytest.mark.parametrize("kind", KINDS)
def test_pages_fit_and_say_nothing_wrong(
    browser: Any, page_of: Callable[..., Path], kind: str, width: int
) -> None:
    how = {"viewport": {"width": width, "height": 900}, "color_scheme": "dark" if width == 400 else "light"}
    page, requests, errors = visit(browser, page_of(kind), **how)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert not requests
    assert not errors
    page.close()


def test_without_scripts_pictures_stand_there(browser: Any, page_of: Callable[..., Path]) -> None:
    page = browser.new_page(java_script_enabled=False)
    page.goto(page_of("rough").as_uri())
    assert page.locator("img.static:visible").count() >= 5
    assert page.locator(".plot:visible").count() == 0
    page.close()


def test_a_script_that_slipped_through_does_not_run(browser: Any, page_of: Callable[..., Path]) -> None:
    """Escaping is not the only barrier: the page's policy names its own scripts by what they are."""
    path = page_of("measured")
    text = path.read_text(encoding="utf-8")
    assert "script-src &#39;sha256-" in text
    evil = path.with_name("evil.html")
    evil.write_text(
        text.replace("<body", "<body onload='document.title=1'", 1).replace(
            "</body>", "<script>document.title = 'taken'</script></body>"
        ),
        encoding="utf-8",
    )
    page = browser.new_page()
    page.goto(evil.as_uri())
    page.wait_for_function("document.documentElement.classList.contains('scripted')")
    assert page.title() not in ("taken", "1")
    page.close()


def test_the_policy_of_a_page_names_its_scripts(page_of: Callable[..., Path]) -> None:
    text = page_of("measured", quick=True).read_text(encoding="utf-8")
    script = text.rpartition("<script>")[2].partition("</script>")[0]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = html.unescape(text.partition('Content-Security-Policy" content="')[2].partition('"')[0])
    assert f"script-src 'sha256-{digest}'" in policy
    assert policy.startswith("default-src 'none'")
    assert "unsafe-eval" not in policy


def test_no_heading_stands_over_nothing_where_scripts_are_off(page_of: Callable[..., Path]) -> None:
    """A figure that has no picture is drawn by the script alone."""
    text = page_of("track", quick=True).read_text(encoding="utf-8").partition('id="data"')[0]
    sections = re.findall(r'<section id="([^"]*)"([^>]*)>(.*?)</section>', text, re.DOTALL)
    lone = {name for name, tag, _ in sections if tag == ' class="lone"'}
    assert "roughness" in lone
    assert lone == {name for name, _, content in sections if "<img" not in content}


def test_a_page_tells_conservation_of_layers_and_what_they_cannot_show() -> None:
    """From books of pressures and depths, against F L and against what has worn; and that they are thick."""
    coarse = {"grid.cell": "20 um", "disc.synthetic.cut_off": "40 um", "grid.extent": "1.2 mm"}
    study = Study.load("coat").replace(
        coarse | {"output.snapshots": [], "disc.layers.1.wear": "4e-6 mm^3/N/m"}
    )
    study = study.replace({"disc.layers.1.thickness": "6 um", "disc.layers.1.name": "thick_dlc"})
    with pytest.warns(match="Asperities yield|elastic constants"):
        result = warpwear.run(study)
    page = words_of(result)
    what = {check["what"]: (float(check["value"]), check["good"]) for check in page["checks"][1:]}
    books = "Σ V/K of the disc's materials, from pressures and depths alone, over F L, less 1"
    worn = "worn volume of the disc over what its materials lose by the pressures, less 1"
    assert [*what] == ["worn volume of the counter-body over Archard's K F L, less 1", worn, books]
    assert all(off < 1e-12 and good for off, good in what.values())
    assert any(text.startswith("Layers and cases wear and shear") for text in page["limits"])
    assert any("elastic constants" in text for text in page["s"].warnings)
    assert "below layers by worn depth: the disc's thick_dlc (6 µm, 4e-06 mm³/(N·m))" in page["methods"]
    assert r"Thickness of thick\_dlc, disc & 6 & $\mu$m \\" in page["latex"]
    assert r"\sum_m V_m / K_m = F L" in page["latex"]
    assert r"\sum_m" not in latex_of(Study.load("v1"), page["methods"], page["table"])
