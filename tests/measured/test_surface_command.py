"""`warpwear surface` as a user meets it."""

import itertools
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from warpwear.cli.main import commands
from warpwear.errors import InputError
from warpwear.figures import style
from warpwear.figures.describe import Figure
from warpwear.figures.paint import paint
from warpwear.laws.form import sag
from warpwear.measured.surface import read_surface
from warpwear.surfaces.made.self_affine import SelfAffine

ROOT = Path(__file__).parents[2]
SHARED = ROOT.parent / "shared" / "surfaces"
GIVEN = ("--pixel", "3 um", "--height-unit", "um")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in, with three files in a folder beside it."""
    files = tmp_path / "files"
    files.mkdir()
    points = (np.arange(300) - 149.5) * 0.003
    rough = SelfAffine(ra=0.0003, period=1.0).heights(points, points)
    np.save(files / "rough.npy", 1e3 * rough)
    trough = -0.01 * np.maximum(1 - np.square(points / 0.15), 0.0)
    np.save(files / "track.npy", 1e3 * (0.1 * rough + trough[None, :]))
    worn = np.minimum(-sag(points, points, radius=3.0), -0.005)
    np.save(files / "ball.npy", 1e3 * (worn + 0.1 * rough))
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def few_dots(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures that nobody looks at are soon drawn: with few dots, and no room made for texts."""

    def save(figure: Figure, path: Path) -> None:
        painted = paint(figure)
        painted.set_layout_engine(None)
        style.write_figure(painted, path)

    monkeypatch.setitem(style.STYLE, "figure.dpi", 50.0)
    monkeypatch.setattr("warpwear.measured.report.save", save)


def surface(*arguments: str | Path) -> Result:
    return CliRunner().invoke(commands, ["surface", *map(str, arguments)])


def test_a_page_and_a_figure(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    filters = ("--outliers", "6", "--s-filter", "8 um", "--l-filter", "0.5 mm")
    done = surface("../files/rough.npy", *GIVEN, *filters, "--details")
    assert done.exit_code == 0, done.output
    for words in ("300 × 300 points", "pixel 3 × 3 µm (as given)", "Sa 0.", "Sk 0.", "Smr1", "Ra along y"):
        assert words in done.output
    for words in ("outliers: 0 points", "S-filter", "L-filter", "roll-off", "no clear lay", "λc reduced"):
        assert words in done.output
    assert (here / "rough.npy-surface.png").stat().st_size > 20_000
    monkeypatch.setitem(style.STYLE, "figure.dpi", 50.0)
    again = surface("../files/rough.npy", *GIVEN)
    assert again.exit_code == 0, again.output
    assert "Sa 0." in again.output
    assert again.output.count("\n") <= 10 < done.output.count("\n")
    assert "rough.npy-surface.png is there already and was not written again" in again.output
    refused = surface("../files/rough.npy", *GIVEN, "--figure", "rough.npy-surface.png")
    assert isinstance(refused.exception, InputError)
    assert "rough.npy-surface.png is there already" in refused.exception.sentence
    (here / "rough.npy-surface.png").unlink()
    assert "Sa 0." in surface("../files/rough.npy", *GIVEN, "--no-figure").output
    assert not (here / "rough.npy-surface.png").exists()
    assert surface("../files/rough.npy", *GIVEN, "--overwrite").exit_code == 0
    assert surface("../files/rough.npy", *GIVEN, "--figure", "other.pdf").exit_code == 0
    assert (here / "other.pdf").read_bytes().startswith(b"%PDF")


def test_the_sheet_carries_its_numbers(here: Path) -> None:
    """Those that the page prints, each inside the sheet and no two over each other."""
    report = read_surface(here.parent / "files" / "rough.npy", pixel="3 um", height_unit="um")
    figure = report.figure()
    figure.canvas.draw()
    notes = [text for axes in figure.axes for text in axes.texts if text.get_text()]
    told, found = " ".join(text.get_text() for text in notes), report.numbers
    for name, value in (
        ("Sa", "sa_um"),
        ("Sq", "sq_um"),
        ("Ssk", "ssk"),
        ("Sku", "sku"),
        ("rms slope", "rms_slope"),
    ):
        assert f"{name} {found[value]:.4g}" in told
    for words in ("Sdr ", "Sal ", "0.9 × 0.9 mm", "300 × 300", "least-squares plane", "λs 8 µm", "Spk "):
        assert words in told
    boxes = [text.get_window_extent() for text in notes]
    assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))


def test_json(here: Path) -> None:
    done = surface("../files/rough.npy", *GIVEN, "--json", "--crop", "0.6 mm, 0.45 mm", "--sliding-axis", "y")
    record = json.loads(done.output)
    assert record["grid"] == [150, 200]
    assert record["sa_um"] == pytest.approx(0.3, rel=0.1)
    assert record["bearing"]["sk_um"] == pytest.approx(2.574 * record["sq_um"], rel=0.1)
    assert len(record["slope_against_cut_off"]["rms_slope"]) == 25
    assert record["roll_off"]["wavelength_um"] == pytest.approx(100, rel=0.4)
    assert list(here.iterdir()) == []


@pytest.mark.usefixtures("few_dots")
@pytest.mark.parametrize("name", ["al3d-1.al3d", "sur-2.sur", "x3p-2.x3p"])
def test_real_files(here: Path, name: str) -> None:
    pytest.importorskip("SurfaceTopography")
    if not (SHARED / name).is_file():
        pytest.skip("the measured files are not here")
    done = surface(SHARED / name)
    assert done.exit_code == 0, done.output
    assert (here / f"{Path(name).name}-surface.png").is_file()
    assert "nan" not in done.output


@pytest.mark.usefixtures("few_dots")
def test_a_worn_track(here: Path) -> None:
    done = surface("../files/track.npy", *GIVEN, "--track", "--track-length", "30 mm")
    assert done.exit_code == 0, done.output
    assert "over 30 mm" in done.output
    assert (here / "track.npy-track.png").is_file()
    record = json.loads(surface("../files/track.npy", *GIVEN, "--track", "--json").output)
    assert record["track"]["section_net_um2"]["mean"] == pytest.approx(2000, rel=0.01)
    assert record["track"]["volume_mm3"] == pytest.approx(0.002 * 0.9, rel=0.01)


@pytest.mark.usefixtures("few_dots")
def test_a_track_less_what_was_there_before(here: Path) -> None:
    after = np.load(here / "../files/track.npy")
    points = (np.arange(300) - 149.5) * 3e-3
    groove = -10.0 * np.maximum(1 - np.square(points / 0.15), 0.0)
    rough = 20.0 * (after - groove)
    np.save(here / "../files/before.npy", rough)
    np.save(here / "../files/after.npy", rough + 0.05 * groove)
    asked = ("../files/after.npy", *GIVEN, "--track", "--before", "../files/before.npy")
    done = surface(*asked)
    assert done.exit_code == 0, done.output
    for words in ("shifted", "correlation beside the wear", "wide at the level of the surface beside"):
        assert words in done.output
    record = json.loads(surface(*asked, "--json").output)
    assert record["track"]["volume_mm3"] == pytest.approx(0.0001 * 0.9, rel=0.02)
    assert record["track"]["width_mm"] == pytest.approx(0.3, rel=0.02)
    assert record["track"]["window_mm"] > 0.35
    assert record["before"]["correlation"] == pytest.approx(1.0)
    for name, heights in (
        ("after", rough + 0.05 * groove),
        ("before", np.random.default_rng(0).normal(size=(300, 300))),
    ):
        np.save(here / f"../files/{name}.npy", heights[:60, :60])  # the search takes as long as it is large
    refused = surface(*asked, "--overwrite").exception
    assert isinstance(refused, InputError)
    assert "--before does not show the place of FILE" in refused.sentence


@pytest.mark.usefixtures("few_dots")
def test_a_worn_ball(here: Path) -> None:
    done = surface("../files/ball.npy", *GIVEN, "--ball", "--radius", "3 mm")
    assert done.exit_code == 0, done.output
    assert (here / "ball.npy-ball.png").is_file()
    record = json.loads(surface("../files/ball.npy", *GIVEN, "--ball", "--radius", "3 mm", "--json").output)
    assert record["ball"]["volume_mm3"] == pytest.approx(np.pi * 0.005**2 * (9 - 0.005) / 3, rel=0.02)
    by_hand = surface("--ball", "--radius", "3 mm", "--diagonals", "0.80 mm", "0.82 mm")
    assert "depth 27.463 µm, volume 0.0070867 mm³" in by_hand.output
    record = json.loads(
        surface("--ball", "--radius", "3 mm", "--diagonals", "800 um", "820 um", "--json").output
    )
    assert record["height_um"] == pytest.approx(27.463, rel=1e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "FILE is missing"),
        (["none.sur"], "the file 'none.sur' does not exist."),
        (
            ["../files/rough.npy"],
            "--height-unit is not given and the file '../files/rough.npy' names no unit",
        ),
        (["../files/rough.npy", *GIVEN, "--level", "cubic"], "--level = 'cubic' is not allowed"),
        (["../files/rough.npy", *GIVEN, "--outliers", "many"], "--outliers = 'many': must be a number"),
        (["../files/rough.npy", *GIVEN, "--outliers", "1"], "--outliers = 1: must be at least 3"),
        (["../files/rough.npy", *GIVEN, "--crop", "1 mm, 2 mm, 3 mm"], "--crop = "),
        (["../files/rough.npy", *GIVEN, "--crop", "5 mm"], "--crop is (5, 5) mm"),
        (["../files/rough.npy", *GIVEN, "--s-filter", "8"], "--s-filter = '8': needs its unit"),
        (
            ["../files/rough.npy", *GIVEN, "--lambda-c", "-1 mm"],
            "--lambda-c = '-1 mm': must be greater than 0",
        ),
        (["../files/rough.npy", *GIVEN, "--figure", "a.exe"], "allowed endings are .png"),
        (["../files/rough.npy", *GIVEN, "--figure", "no/a.png"], "the folder no does not exist"),
        (["../files/rough.npy", *GIVEN, "--track", "--ball"], "exclude each other"),
        (["../files/rough.npy", *GIVEN, "--radius", "3 mm"], "--radius needs --ball"),
        (["../files/rough.npy", *GIVEN, "--track-width", "1 mm"], "--track-width needs --track"),
        (
            ["../files/ball.npy", *GIVEN, "--ball", "--before", "../files/rough.npy"],
            "--before and --ball exclude each other",
        ),
        (["../files/track.npy", *GIVEN, "--track", "--level", "sphere"], "--level sphere is for a ball"),
        (["--ball", "--diagonals", "1 mm", "1 mm"], "--diagonals needs --radius"),
        (["--ball", "--radius", "3 mm", "--diagonals", "9 mm", "1 mm"], "allowed is up to the ball's, 6 mm"),
        (["../files/ball.npy", "--ball", "--diagonals", "1 mm", "1 mm"], "--diagonals stand for FILE"),
    ],
)
def test_bad_input_is_one_sentence_and_leaves_nothing(here: Path, arguments: list[str], message: str) -> None:
    done = surface(*arguments)
    assert isinstance(done.exception, InputError), done.output
    assert message in done.exception.sentence
    assert "\n" not in done.exception.sentence
    assert "disc." not in done.exception.sentence, "a key of a study, which this command does not have"
    assert list(here.iterdir()) == []


def test_from_the_shell(here: Path) -> None:
    run = [sys.executable, "-m", "warpwear", "surface", "../files/rough.npy"]
    done = subprocess.run(
        run, cwd=here, capture_output=True, text=True, check=False, env={"PYTHONPATH": str(ROOT), "PATH": ""}
    )
    assert done.returncode == 2
    assert done.stderr.startswith("warpwear: --height-unit is not given")
    assert done.stderr.count("\n") == 1
