"""`warpwear surface` on profiles, as a user meets it."""

import json
from pathlib import Path

import numpy as np
import pytest
from cases_instruments import rough, x3p
from click.testing import CliRunner, Result

from warpwear.cli.main import commands
from warpwear.errors import InputError
from warpwear.surfaces.profiles.profile import parameters, profile_in

STEP = 0.002
PLACES = STEP * (np.arange(2000) + 0.5) - 2.0


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a plain profile, one with a groove, and a map."""
    plain = rough(np.random.default_rng(0), 2000, STEP, hurst=0.8, roll_off=0.1, rq=2e-4)
    table = np.column_stack([PLACES + 2.0, 1e3 * plain])
    np.savetxt(tmp_path / "plain.csv", table, delimiter=",", header="x [mm],z [um]", comments="")
    x3p(tmp_path / "groove.x3p", plain - 3e-3 * np.maximum(1.0 - np.square(PLACES / 0.4), 0.0), STEP)
    np.save(tmp_path / "map.npy", 1e3 * np.tile(plain[:400], (60, 1)))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*arguments: str) -> Result:
    return CliRunner().invoke(commands, ["surface", *arguments])


def numbers(*arguments: str) -> dict[str, object]:
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.output
    content: dict[str, object] = json.loads(result.output)
    return content


def test_parameters_on_the_terminal_in_json_and_in_a_figure(here: Path) -> None:
    result = run("plain.csv", "--lambda-c", "0.25 mm", "--figure", "a.svg")
    assert result.exit_code == 0, result.output
    content = numbers("plain.csv", "--lambda-c", "0.25 mm")
    expected = parameters(profile_in("plain.csv").levelled(1), cut_off=0.25)
    assert content["ra_um"] == pytest.approx(1e3 * expected.ra)
    assert content["rsm_um"] == pytest.approx(1e3 * (expected.rsm or 0.0))
    assert content["lambda_c_mm"] == 0.25
    assert f"Ra               {1e3 * expected.ra:.4g} µm" in result.output
    assert "Material ratio" not in result.output
    assert (here / "a.svg").stat().st_size > 1000


def test_the_section_of_a_groove(here: Path) -> None:
    content = numbers("groove.x3p", "--track")
    error = content["section_error_um2"]
    assert isinstance(error, float)
    assert content["section_um2"] == pytest.approx(1e6 * 3e-3 * 0.8 / 1.5, abs=3.0 * error)
    result = run("groove.x3p", "--track", "--figure", "g.svg", "--details")
    assert "through the profile beside the groove" in result.output
    assert "± one standard error" in result.output
    assert (here / "g.svg").is_file()


def test_a_line_of_a_map(here: Path) -> None:
    content = numbers("map.npy", "--pixel", "2 um", "--height-unit", "um", "--line", "y, 0.05 mm")
    assert content["points"] == 400
    assert content["length_mm"] == pytest.approx(0.8)
    expected = parameters(profile_in("plain.csv"))
    assert content["ra_um"] == pytest.approx(1e3 * expected.ra, rel=0.3)


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (("plain.csv", "--track"), "no track"),
        (("plain.csv", "--ball"), "holds a profile (line scan), and no map of heights"),
        (
            ("plain.csv", "--crop", "1 m"),
            "--crop is (1000, 1000) mm: allowed is x0, x1 within the measurement, 4 mm",
        ),
        (("plain.csv", "--level", "sphere"), "--level"),
        (("plain.csv", "--line", "x, 1 mm"), "holds a profile"),
        (("plain.csv", "--lambda-c", "8 um", "--lambda-s", "8 um"), "--lambda-s is 8 µm"),
        (("groove.x3p", "--track", "--track-length", "1 m"), "--track-length is for a map"),
        (("map.npy", "--pixel", "2 um", "--height-unit", "um", "--line", "z, 1 mm"), "--line is 'z, 1 mm'"),
        (("map.npy", "--pixel", "2 um", "--height-unit", "um", "--line", "y, 9 mm"), "the map has 0.12 mm"),
        (
            ("map.npy", "--pixel", "2 um", "--height-unit", "um", "--line", "y, 0.1 mm", "--ball"),
            "--line and --ball exclude each other",
        ),
    ],
)
def test_bad_options_are_refused_in_one_sentence(here: Path, arguments: tuple[str, ...], what: str) -> None:
    result = run(*arguments)
    assert isinstance(result.exception, InputError)  # exit 2
    assert what in result.exception.sentence
    assert "\n" not in result.exception.sentence
