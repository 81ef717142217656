"""`warpwear calibrate` as a user meets it."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import warpwear
from warpwear.cli.calibrate import calibrate as command
from warpwear.cli.main import commands
from warpwear.errors import InputError
from warpwear.laws.form import sag
from warpwear.surfaces.made.self_affine import SelfAffine

TEST = ("--load", "8 N", "--distance", "2400 mm")
GIVEN = ("--pixel", "3 um", "--height-unit", "um")


def calibrate(*arguments: str | Path | float) -> Result:
    return CliRunner().invoke(command, [*map(str, arguments)])


def record(*arguments: str | Path | float) -> dict[str, Any]:
    done = calibrate(*arguments, "--json")
    assert done.exit_code == 0, done.output

    def refused(word: str) -> float:
        raise AssertionError(f"{word} is no JSON")

    found: dict[str, Any] = json.loads(done.output, parse_constant=refused)
    return found


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short run in a folder."""
    folder = tmp_path_factory.mktemp("runs") / "short"
    study = warpwear.Study.load("v3-fine").replace(
        {"grid.cell": "20 um", "sliding.distance": "300 mm", "stepping.growth": 1.1, "output.snapshots": []}
    )
    warpwear.run(study, out=folder, plots=False)
    return folder


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the topographies of a worn track and a worn ball."""
    folder = tmp_path_factory.mktemp("files")
    points = (np.arange(300) - 149.5) * 0.003
    rough = SelfAffine(ra=0.00003, period=1.0).heights(points, points)
    trough = -0.01 * np.maximum(1 - np.square(points / 0.15), 0.0)
    np.save(folder / "track.npy", 1e3 * (rough + trough[None, :]))
    np.save(folder / "ball.npy", 1e3 * (np.minimum(-sag(points, points, radius=3.0), -0.005) + rough))
    return folder


def test_diagonals_of_a_ball() -> None:
    diagonals = ("--diagonals", "0.80 mm", "0.82 mm", "--radius", "3 mm")
    done = calibrate("wear", *diagonals, *TEST, "--hardness", "590 MPa")
    assert done.exit_code == 0, done.output
    for words in (
        "K                (3.69 ± 0.18)e-4 mm³/(N·m) (standard uncertainty, 0.05 of K)",
        "3.691e-13 m²/N (Pa⁻¹)",
        "2.178e-4 dimensionless",
        "0.0070435 mm³ for a small scar: K 3.668e-4, -0.61%; not used, K is of the exact volume",
        'counter = "3.691e-4 mm^3/N/m"',
        "half the difference of the two diameters",
    ):
        assert words in done.output
    found = record("wear", *diagonals, *TEST, "--uncertainty", "10 um")
    assert found["uncertainty_mm3_per_Nm"] / found["wear_coefficient_mm3_per_Nm"] == pytest.approx(
        4 * 0.01 / 0.81, rel=0.02
    )
    assert found["tests"][0]["depth_um"] == pytest.approx(27.463, rel=1e-4)
    unknown = calibrate("wear", "--scar", "0.8 mm", "--radius", "3 mm", *TEST)
    assert "its uncertainty is unknown" in unknown.output


def test_standards_of_astm_are_under_their_names() -> None:
    ball = record("wear", "--scar", "0.8 mm", "--radius", "3 mm", *TEST, "--standard", "g99-ball")
    again = record(
        "wear", "--diagonals", "0.7 mm", "0.9 mm", "--radius", "3 mm", *TEST, "--standard", "g133-ball"
    )
    volume = ball["tests"][0]["volume_mm3"]
    assert again["tests"][0]["volume_mm3"] == pytest.approx(volume, rel=1e-12)
    assert ball["tests"][0]["volume_by_approximation_mm3"] == pytest.approx(math.pi * 0.8**4 / (64 * 3))
    assert "no wear of the disc" in ball["relation"]
    track = ("--width", "0.5 mm", "--radius", "3 mm", "--track-radius", "10 mm")
    disc = record("wear", *track, "--load", "8 N", "--distance", "1 km", "--standard", "g99-disc")
    assert disc["tests"][0]["volume_by_approximation_mm3"] == pytest.approx(math.pi * 10 * 0.5**3 / 18)
    exact = 2 * math.pi * 10 * (9 * math.asin(0.5 / 6) - 0.125 * math.sqrt(35.75))
    assert disc["tests"][0]["volume_mm3"] == pytest.approx(exact)
    assert disc["wear_coefficient_mm3_per_Nm"] == pytest.approx(exact / 8000)
    flat = ("--section", "812.8 um^2", "--stroke", "30 mm", "--passes", "80", "--load", "8 N")
    found = record("wear", *flat, "--standard", "g133-flat", "--uncertainty", "8.128 um^2")
    assert found["wear_coefficient_mm3_per_Nm"] == pytest.approx(12.7e-4)
    assert found["uncertainty_mm3_per_Nm"] == pytest.approx(0.127e-4)
    assert found["worn"] == "disc"
    same = record("wear", *flat, "--standard", "g133-flat", "--track-length", "3 cm")
    assert same["wear_coefficient_mm3_per_Nm"] == found["wear_coefficient_mm3_per_Nm"]
    refused = calibrate("wear", *flat, "--standard", "g133-flat", "--track-length", "25 mm").exception
    assert isinstance(refused, InputError)
    assert "--track-length 25 mm is not --stroke 30 mm, which g133-flat takes" in str(refused)
    longer = record(
        "wear", *flat, "--track-length", "25 mm"
    )  # without the standard it is a length like any other
    assert longer["wear_coefficient_mm3_per_Nm"] == pytest.approx(12.7e-4 * 25 / 30)


def test_replicates_give_mean_scatter_and_count() -> None:
    volumes = [argument for v in (0.016, 0.018, 0.023) for argument in ("--volume", f"{v} mm^3")]
    found = record("wear", *volumes, *TEST)
    values = np.array([0.016, 0.018, 0.023]) / 19.2
    assert found["count"] == 3
    assert found["wear_coefficient_mm3_per_Nm"] == pytest.approx(values.mean())
    assert found["standard_deviation_mm3_per_Nm"] == pytest.approx(values.std(ddof=1))
    assert found["standard_error_mm3_per_Nm"] == pytest.approx(values.std(ddof=1) / math.sqrt(3))
    page = calibrate("wear", *volumes, *TEST).output
    assert "of 3 tests" in page
    assert "counter or disc" in page


def test_a_list_of_tests_serves_the_command_and_python(tmp_path: Path) -> None:
    """Loads and distances differ; the weighted mean is the posterior's of a fine grid of K."""
    tests = [
        {"volume_disc": "0.016 +- 0.001 mm^3", "load": "8 N", "distance": "2400 mm", "scar": "0.8 mm"},
        {"volume_disc": "0.010 +- 0.001 mm^3", "load": "4 +- 0.1 N", "distance": "2400 mm"},
    ]
    path = tmp_path / "tests.toml"
    lines = ("[[test]]\n" + "".join(f'{key} = "{value}"\n' for key, value in test.items()) for test in tests)
    path.write_text("\n".join(lines), encoding="utf-8")
    found = record("wear", path, "--source", "volume_disc")
    k = warpwear.calibrate_wear(tests, source="volume_disc")
    assert found == json.loads(json.dumps(k.numbers))
    assert found["load_N"] == [8.0, 4.0]
    assert found["worn"] == "disc"
    values, errors = np.array(k.values), np.array(k.errors)
    assert 1e3 * values == pytest.approx([0.016 / 19.2, 0.010 / 9.6])
    assert errors / values == pytest.approx([1 / 16, math.hypot(1 / 10, 1 / 40)])
    grid = np.linspace(0.5, 1.5, 20001) * values.mean()
    density = np.exp(-0.5 * np.sum(((grid[:, None] - values) / errors) ** 2, axis=1))
    mean = float(np.average(grid, weights=density))
    assert k.weighted is not None
    assert k.weighted[:2] == pytest.approx(
        (mean, math.sqrt(np.average((grid - mean) ** 2, weights=density))), rel=1e-4
    )
    table = k.to_dataframe()
    assert list(table["volume_mm3"]) == [0.016, 0.010]
    assert "tests: 2" in repr(k)
    assert "volume_disc and test.1.scar exclude each other" in str(calibrate("wear", path).exception)
    assert "--volume and FILE exclude each other" in str(
        calibrate("wear", path, "--volume", "1 mm^3").exception
    )


def test_a_study_brings_load_distance_and_ball(tmp_path: Path) -> None:
    study = warpwear.Study.load("v1")
    path = tmp_path / "study.toml"
    path.write_text(f'{study.to_toml()}\n[[test]]\nscar = ["0.80 mm", "0.82 mm"]\n', encoding="utf-8")
    same = record("wear", "--diagonals", "0.80 mm", "0.82 mm", "--radius", "3 mm", *TEST)
    assert record("wear", path) == same
    heavier = record("wear", path, "--load", "16 N")
    assert heavier["wear_coefficient_mm3_per_Nm"] == pytest.approx(same["wear_coefficient_mm3_per_Nm"] / 2)


def test_sentences_of_python_name_its_parameters() -> None:
    with pytest.raises(InputError, match=r"^test\.1\.width needs test\.1\.track_radius, such as '3 mm'"):
        warpwear.calibrate_wear([{"width": "1 mm"}], load="8 N", distance="1 m", radius="3 mm")
    with pytest.raises(InputError, match=r"^cof and result exclude each other"):
        warpwear.calibrate_energy(result="none", cof=0.6)


def test_topographies(files: Path) -> None:
    found = record("wear", "--track", files / "track.npy", *GIVEN, "--track-length", "30 mm", *TEST)
    assert found["wear_coefficient_mm3_per_Nm"] == pytest.approx(0.002 * 30 / 19.2, rel=0.01)
    assert 0 < found["uncertainty_mm3_per_Nm"] < 0.05 * found["wear_coefficient_mm3_per_Nm"]
    options = ["surface", str(files / "track.npy"), *GIVEN, "--track", "--track-length", "30 mm", "--json"]
    same = json.loads(CliRunner().invoke(commands, options).output)["track"]
    assert found["tests"][0]["volume_mm3"] == same["whole_volume_mm3"]
    assert found["tests"][0]["volume_uncertainty_mm3"] == same["whole_volume_error_mm3"]
    assert "scatter along the measured 0.9 mm" in found["tests"][0]["uncertainty_from"]
    ball = record(
        "wear", "--ball", files / "ball.npy", "--ball", files / "ball.npy", "--radius", "3 mm", *GIVEN, *TEST
    )
    assert ball["count"] == 2
    assert ball["tests"][0]["volume_mm3"] == pytest.approx(math.pi * 0.005**2 * (9 - 0.005) / 3, rel=0.02)
    assert ball["standard_deviation_mm3_per_Nm"] == 0.0


def test_a_profile_across_a_track(tmp_path: Path) -> None:
    """A parabolic groove of depth h and width b has the section 2/3 h b."""
    place = np.arange(0.0, 3.0, 0.0005)
    rough = 1e-2 * np.random.default_rng(7).normal(size=place.size)
    heights = rough - np.clip(2.0 * (1.0 - ((place - 1.5) / 0.11) ** 2), 0.0, None) + 0.4 * place
    path = tmp_path / "across.csv"
    table = np.column_stack([place, heights])
    np.savetxt(path, table, delimiter=";", header="x [mm];z [um]", comments="")
    found = record("wear", "--track", path, "--track-length", "31.4 mm", *TEST)
    expected = 31.4 * 2 / 3 * 2e-3 * 0.22 / 19.2
    assert found["wear_coefficient_mm3_per_Nm"] == pytest.approx(expected, rel=5e-3)
    refused = calibrate("wear", "--track", path, "--before", path, "--track-length", "31.4 mm", *TEST)
    assert isinstance(refused.exception, InputError)
    assert "--before is for a map of heights" in str(refused.exception)


def test_a_value_brings_its_own_uncertainty() -> None:
    for text in ("0.018 +- 0.001 mm^3", "0.018 mm^3 ± 1e6 um^3", "(0.018±0.001) mm^3"):
        found = record("wear", "--volume", text, *TEST)["tests"][0]
        assert (found["volume_mm3"], found["volume_uncertainty_mm3"]) == pytest.approx((0.018, 0.001))
    ball = ("--radius", "3 mm", *TEST)
    sizes = [
        record("wear", "--diagonals", "0.8 +- 0.01 mm", "0.82 +- 0.01 mm", *ball),
        record("wear", "--diagonals", "0.8 mm", "0.82 mm", "--uncertainty", "0.01 mm", *ball),
    ]
    assert sizes[0]["tests"] == sizes[1]["tests"]
    done = calibrate("wear", "--volume", "0.018 +- 0.001 mm^3", "--uncertainty", "0.001 mm^3", *TEST)
    assert done.exit_code != 0
    assert "--uncertainty and --volume with +- exclude each other" in str(done.exception)
    assert "+- -1 mm^3': must be at least 0" in str(
        calibrate("wear", "--volume", "0.018 +- -1 mm^3", *TEST).exception
    )


def test_a_place_before_and_after_the_test(tmp_path: Path) -> None:
    """Roughness as high as the wear drops out of it, of a scar that ends in the field and of a track."""
    points = (np.arange(160) - 79.5) * 0.003
    rough = 1e3 * SelfAffine(ra=0.001, period=1.0).heights(points, points)
    noise = 0.01 * np.random.default_rng(1).normal(size=(3, *rough.shape))
    bowl = np.maximum(1.0 - np.add.outer(np.square(points / 0.1), np.square(points / 0.08)), 0.0)
    trough = np.multiply.outer(np.ones(points.size), np.maximum(1.0 - np.square(points / 0.08), 0.0))
    for name, heights in zip(("new", "scar", "track"), (0.0 * bowl, 3.0 * bowl, 3.0 * trough), strict=True):
        np.save(tmp_path / f"{name}.npy", rough - heights + noise[len(name) - 3])
    before = ("--before", tmp_path / "new.npy", *GIVEN, *TEST)
    for source, lost, more in (("--after", bowl, ()), ("--track", trough, ("--track-length", 160 * 0.003))):
        more = (more[0], f"{more[1]} mm") if more else ()
        name = "scar" if source == "--after" else "track"
        found = record("wear", source, tmp_path / f"{name}.npy", *before, *more)["tests"][0]
        off = found["volume_mm3"] - 3e-3 * float(lost.sum()) * 0.003**2
        assert abs(off) < 3.0 * found["volume_uncertainty_mm3"] < 0.05 * found["volume_mm3"]
    for given, says in (
        (("--after", tmp_path / "scar.npy"), "--before is given 0 times, --after 1: each"),
        (("--ball", tmp_path / "scar.npy", "--before", tmp_path / "new.npy"), "--before is not for --ball"),
    ):
        assert says in str(calibrate("wear", *given, *GIVEN, *TEST).exception)


def test_shear_strength_of_one_area_and_of_a_run(run: Path) -> None:
    single = calibrate("friction", "--area", "1.254 mm^2", "--load", "8 N", "--cof", 0.6)
    assert "= 3.828 MPa" in single.output
    found = record("friction", "--result", run, "--cof", 0.6, "--ploughing", 0.05)
    with warpwear.Result.open(run) as result:
        history = result.history
    for name, values in found["areas"].items():
        for when, row in (("initial", 0), ("end", -1)):
            expected = 0.55 * 8.0 / history[f"area_{name}"][row]
            assert values[f"shear_strength_{when}_MPa"] == pytest.approx(expected)
    assert list(found["areas"]) == ["contact", "touched", "cumulative", "nominal"]
    assert (
        "from the hardness, H/(3√3): 113.5 MPa" in calibrate("friction", "--result", run, "--cof", 0.6).output
    )
    assert list(record("friction", "--result", run, "--cof", 1, "--area", "nominal")["areas"]) == ["nominal"]


def test_fit_of_a_measured_curve(run: Path, tmp_path: Path) -> None:
    with warpwear.Result.open(run) as result:
        history = result.history
    where = np.linspace(0.5, 400.0, 500)
    area = np.interp(where, history["distance"], history["area_contact"])
    scatter = 0.005 * np.random.default_rng(0).standard_normal(where.size)
    file = tmp_path / "measured.csv"
    table = np.c_[where, 0.1 + 4.0 * area / 8.0 + scatter]
    np.savetxt(file, table, delimiter=",", header="distance [mm],cof", comments="")
    found = record("friction", "--result", run, "--experiment", file)
    assert abs(found["shear_strength_MPa"] - 4.0) < 4 * found["shear_strength_error_MPa"]
    assert abs(found["ploughing"] - 0.1) < 4 * found["ploughing_error"]
    assert found["distance_used_mm"][1] <= 300.0
    assert found["points_left_out"] == int((where > 300.0).sum())
    page = calibrate("friction", "--result", run, "--experiment", file, "--area", "cumulative").output
    assert 'area = "cumulative"' in page
    table[:, 1] = 0.5 * (area / area.max()) ** 1.4
    np.savetxt(file, table, delimiter=",", header="distance [mm],cof", comments="")
    negative = record("friction", "--result", run, "--experiment", file)
    assert negative["ploughing"] < 0
    assert "μ_p is negative" in negative["doubts"][0]
    alone = negative["without_ploughing"]["shear_strength_MPa"]
    page = calibrate("friction", "--result", run, "--experiment", file).output
    assert f'shear_strength = "{alone:.4g} MPa", ploughing = 0\n' in page


def test_energy(run: Path) -> None:
    done = calibrate("energy", *TEST, "--cof", 0.6, "--area", "1.254 mm^2")
    assert "= 11.52 J" in done.output
    assert "rate-independent" in done.output
    rows = record("energy", *TEST, "--cof", 0.6, "--area", "1.254 mm^2")["speeds"]
    assert [row["speed_mm_per_min"] for row in rows] == pytest.approx([10, 20, 50, 100])
    assert [row["time_s"] / 60 for row in rows] == pytest.approx([240, 120, 48, 24])
    assert rows[3]["power_mean_W"] == pytest.approx(0.6 * 8 * 0.1 / 60)
    assert rows[3]["pv_MPa_m_per_s"]["given"] == pytest.approx(8 / 1.254 * 0.1 / 60)
    found = record("energy", "--result", run, "--speed", "1 m/s")
    with warpwear.Result.open(run) as result:
        history = result.history
    distance, force = np.r_[0.0, history["distance"]], 8.0 * np.r_[history["cof"][0], history["cof"]]
    assert found["energy_J"] == pytest.approx(1e-3 * np.trapezoid(force, distance))
    assert found["speeds"][0]["pv_MPa_m_per_s"] == pytest.approx(
        {name: 8.0 / history[f"area_{name}"][-1] for name in ("nominal", "contact")}
    )


BALL = ("--scar", "0.8 mm", "--radius", "3 mm")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["wear", *TEST], "what was measured is missing"),
        (["wear", "--volume", "1 mm^3", "--scar", "1 mm", *TEST], "--volume and --scar exclude each other"),
        (["wear", "--volume", "-1 mm^3", *TEST], "--volume = '-1 mm^3': must be greater than 0"),
        (["wear", "--volume", "nan mm^3", *TEST], "is not a number"),
        (["wear", "--volume", "inf mm^3", *TEST], "must be finite"),
        (["wear", "--volume", "1 mm", *TEST], "a volume such as"),
        (["wear", "--section", "1", "--track-length", "1 mm", *TEST], "an area such as"),
        (["wear", "--volume", "1 mm^3", "--distance", "1 m"], "--load is missing"),
        (["wear", "--volume", "1 mm^3", "--load", "8 N"], "the sliding distance is missing"),
        (["wear", "--volume", "1 mm^3", *TEST, "--passes", "8"], "--distance and --passes exclude"),
        (["wear", "--volume", "1 mm^3", *TEST, "--stroke", "8 mm"], "--stroke needs --passes"),
        (["wear", "--volume", "1 mm^3", "--load", "8 N", "--passes", "8"], "--passes needs --stroke"),
        (["wear", "--volume", "1 mm^3", "--load", "8 N", "--passes", "0"], "--passes is 0"),
        (["wear", "--volume", "1 mm^3", *TEST, "--radius", "3 mm"], "--radius is not for --volume"),
        (["wear", "--volume", "1 mm^3", *TEST, "--crop", "3 mm"], "--crop is not for --volume"),
        (["wear", "--volume", "1 mm^3", *TEST, "--standard", "g99-disc"], "is for width"),
        (["wear", "--scar", "0.8 mm", *TEST], "--scar needs --radius"),
        (
            ["wear", "--scar", "6.1 mm", "--radius", "3 mm", *TEST],
            "allowed is up to the ball's, 6 mm",
        ),
        (["wear", *BALL, *TEST, "--uncertainty", "-1 um"], "--scar = '0.8 mm +- -1 um': must be at least 0"),
        (["wear", "--width", "7 mm", "--radius", "3 mm", "--track-radius", "9 mm", *TEST], "width is 7 mm"),
        (["wear", "--section", "1 um^2", *TEST], "--section needs --track-length"),
        (["wear", "--track", "none.sur", "--track-length", "1 mm", *TEST], "'none.sur' does not exist"),
        (["wear", "--ball", "b.npy", "--uncertainty", "1 um", *TEST], "brings its own standard error"),
        (["wear", "--ball", "b.npy", "--level", "plane", *TEST], "--level is not for --ball"),
        (["friction", "--cof", "0.6"], "the area is missing"),
        (["friction", "--area", "1 mm^2", "--load", "8 N"], "--cof is missing"),
        (["friction", "--area", "1 mm^2", "--load", "8 N", "--cof", "3.5"], "must be at most 3"),
        (
            ["friction", "--area", "1 mm^2", "--load", "8 N", "--cof", "0"],
            "--cof = 0: must be greater than 0",
        ),
        (["friction", "--area", "1 mm^2", "--load", "8 N", "--cof", "nan"], "is not a number"),
        (
            ["friction", "--area", "1 mm^2", "--load", "8 N", "--cof", "0.1", "--ploughing", "0.2"],
            "--cof = 0.1 must exceed --ploughing = 0.2",
        ),
        (["friction", "--result", "none", "--cof", "0.6"], "none holds no result"),
        (["friction", "--result", "none", "--cof", "0.6", "--load", "8 N"], "exclude each other"),
        (["friction", "--result", "none", "--cof", "0.6", "--area", "real"], "--area is 'real': allowed"),
        (["friction", "--experiment", "a.csv"], "--experiment needs --result"),
        (["friction", "--result", "b", *["--experiment", "a.csv"] * 2], "b holds no result"),
        (["friction", "--experiment", "a.csv", "--result", "b", "--cof", "1"], "--cof and --experiment"),
        (["friction", "--cof", "0.6", "--columns", "a, b"], "--columns needs --experiment"),
        (["energy", *TEST], "--cof is missing"),
        (["energy", "--cof", "0.6", "--distance", "1 m"], "--load is missing"),
        (["energy", *TEST, "--cof", "0.6", "--speed", "0 mm/s"], "--speed = '0 mm/s'"),
        (["energy", "--result", "none", "--cof", "0.6"], "--cof and --result exclude each other"),
    ],
)
def test_bad_input_is_one_sentence(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = calibrate(*arguments)
    assert isinstance(done.exception, InputError), done.output
    assert message in str(done.exception)
    assert "\n" not in str(done.exception)
    assert done.output == ""


def test_what_lost_nothing_and_what_is_longer_than_its_track_are_refused(files: Path) -> None:
    across = np.abs((np.arange(300) - 149.5) * 0.003)
    built_up = np.where(across < 0.02, -15.0, np.where(across < 0.15, 10.0, 0.0))  # a slit in a ridge
    np.save(files / "ridge.npy", np.tile(built_up, (300, 1)))
    options = ("--track-width", "0.4 mm", "--track-length", "30 mm")
    up = calibrate("wear", "--track", files / "ridge.npy", *GIVEN, *options, *TEST)
    assert "has lost no volume" in str(up.exception)
    short = calibrate("wear", "--track", files / "track.npy", *GIVEN, "--track-length", "0.5 mm", *TEST)
    assert "at least the piece in" in str(short.exception)


def test_a_static_contact_dissipates_nothing(tmp_path: Path) -> None:
    study = warpwear.Study.load("v3-fine").replace(
        {"grid.cell": "20 um", "sliding.distance": "0 mm", "output.snapshots": []}
    )
    warpwear.run(study, out=tmp_path / "static", plots=False)
    assert "is a static contact" in str(calibrate("energy", "--result", tmp_path / "static").exception)


def listed(path: Path, tests: list[dict[str, str]]) -> Path:
    lines = ("[[test]]\n" + "".join(f'{key} = "{value}"\n' for key, value in test.items()) for test in tests)
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def test_a_list_of_tests_gives_shear_strengths_and_energies(tmp_path: Path) -> None:
    """τ0 = (μ − μ_p) F/A and μ F L, whose errors are those of what was measured."""
    tests = [
        {"friction": "0.6 +- 0.02", "load": "8 N", "area": "1.25 +- 0.05 mm^2", "distance": "2400 mm"},
        {"friction": "0.5", "load": "4 +- 0.1 N", "area": "0.7 mm^2", "distance": "1 m", "scar": "1 mm"},
        {"scar": "0.8 mm"},
    ]
    path = listed(tmp_path / "tests.toml", tests)
    tau = warpwear.calibrate_friction(tests, ploughing=0.1)
    assert isinstance(tau, warpwear.CalibratedTests)
    assert list(tau.tests) == ["test.1", "test.2"]
    assert tau.values == pytest.approx((0.5 * 8 / 1.25, 0.4 * 4 / 0.7))
    parts = [math.hypot(0.02 / 0.5, 0.05 / 1.25), 0.1 / 4]
    assert tau.errors == pytest.approx([value * part for value, part in zip(tau.values, parts, strict=True)])
    assert tau.mean == pytest.approx(sum(tau.values) / 2)
    found = record("friction", path, "--ploughing", 0.1)
    assert found == json.loads(json.dumps(tau.numbers))
    assert found["shear_strength_error_MPa"] == pytest.approx(abs(tau.values[0] - tau.values[1]) / 2)
    assert list(tau.to_dataframe()["name"]) == ["test.1", "test.2"]
    energy = warpwear.calibrate_energy(path)
    assert isinstance(energy, warpwear.CalibratedTests)
    assert energy.values == pytest.approx((11.52, 2.0))
    assert energy.errors == pytest.approx((11.52 * 0.02 / 0.6, 2.0 * 0.1 / 4))
    assert repr(energy).startswith("<energy of 2 tests: 6.8 ± 4.8 J")


def test_a_list_beside_a_run_has_its_load(run: Path, tmp_path: Path) -> None:
    with warpwear.Result.open(run) as result:
        study, history = result.study, result.history
    path = listed(tmp_path / "tests.toml", [{"friction": "0.6 +- 0.02", "load": "8 N"}, {"friction": "0.7"}])
    found = record("friction", path, "--result", run)
    areas = {"initial": history["area_contact"][0], "end": history["area_contact"][-1]}
    single = 8.0 / areas[study.friction.calibrate]
    assert [test["shear_strength_MPa"] for test in found["tests"]] == pytest.approx(
        [0.6 * single, 0.7 * single]
    )
    assert found["tests"][0]["shear_strength_error_MPa"] == pytest.approx(0.02 * single)
    file = tmp_path / "measured.csv"
    where = np.linspace(0.5, 290.0, 300)
    area = np.interp(where, history["distance"], history["area_contact"])
    np.savetxt(file, np.c_[where, 0.1 + 0.5 * area], delimiter=",", header="distance [mm],cof", comments="")
    fits = warpwear.calibrate_friction([{"record": file}, {"record": str(file)}], result=run, area="contact")
    assert isinstance(fits, warpwear.CalibratedTests)
    assert fits.values == pytest.approx((4.0, 4.0))
    with pytest.raises(InputError, match=r"^test\.1\.load is 7, and the study has 8: they have to agree"):
        warpwear.calibrate_friction([{"friction": 0.6, "load": "7 N"}], result=run)


def test_a_result_in_memory_calibrates() -> None:
    study = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "3 mm"})
    result = warpwear.run(study, plots=False)
    tau = warpwear.calibrate_friction(result=result, cof=0.6)
    assert isinstance(tau, warpwear.FrictionCalibration)
    assert "'v3-fine' in memory" in str(tau)
    energy = warpwear.calibrate_energy(result=result)
    assert isinstance(energy, warpwear.EnergyCalibration)
    assert energy.energy == pytest.approx(result.history["friction_energy"][-1])
    assert result.finished  # it is not closed


@pytest.mark.parametrize(
    ("tests", "options", "says"),
    [
        ([{"friction": 0.6}], {}, r"^the area is missing: .*test\.1\.area and test\.1\.load"),
        ([{"scar": "1 mm"}], {}, "^what was measured is missing: one of friction, record"),
        ([{"friction": 0.6}], {"cof": 0.5}, "^cof and a list of tests exclude each other"),
        ([{"friction": "0.6 at 3 mm"}], {}, r"^test\.1\.friction is at a distance"),
        ([{"friction": 4, "area": "1 mm^2", "load": "1 N"}], {}, r"^test\.1\.friction = 4"),
        ([{"fricton": 0.6}], {}, "fricton"),
        ([{"record": "none.csv", "load": "1 N"}], {}, r"^test\.1\.record needs result"),
    ],
)
def test_refusals_of_a_list(tests: list[dict[str, Any]], options: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        warpwear.calibrate_friction(tests, **options)
