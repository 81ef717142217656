"""`warpwear new` from files of tests whose pair is known: each number is right, and says where it is from."""

import re
from pathlib import Path
from typing import Any

import pytest
import tomlkit
from calibration.cases_lab import (
    GIVEN,
    LAP,
    LAPS,
    LOAD,
    SPEED,
    STATES,
    WAITS,
    K,
    lab,
    lab_profile,
    lab_recipe,
    lab_record,
    lab_strokes,
)
from click.testing import CliRunner

import warpwear
from warpwear import InputError
from warpwear.cli.main import commands

RADIUS = {"sliding.track_radius": "6 mm"}


@pytest.fixture(autouse=True)
def _place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ruptures")
    monkeypatch.chdir(tmp_path)


def drafted(tests: Any, *, like: str = "rotating", **changes: Any) -> Any:
    """The study, and the comment of each key, in the file just written."""
    all_changes = GIVEN | {key.replace("__", "."): value for key, value in changes.items()}
    study = warpwear.new_study("a.toml", like=like, tests=tests, changes=all_changes, overwrite=True)
    comments = dict(re.findall(r"^(\w+) = .*?# (.*)$", Path("a.toml").read_text("utf-8"), re.MULTILINE))
    return study, comments


def new(*words: str, **changes: Any) -> Any:
    settings = [word for key, value in (GIVEN | changes).items() for word in ("--set", f"{key}={value}")]
    return CliRunner().invoke(commands, ["new", "b.toml", "--like", "rotating", *words, *settings])


def test_three_records_and_profiles_are_a_study(tmp_path: Path) -> None:
    study, comments = drafted(lab(tmp_path), sliding__track_radius="6 mm")
    assert (study.contact.load, study.sliding.total) == pytest.approx((LOAD, LAPS * LAP), rel=1e-4)
    assert study.sliding.mean_speed == pytest.approx(SPEED, rel=1e-3)
    assert study.wear.disc.value == pytest.approx(K, rel=5e-3)
    states = study.friction.states
    for name, value in STATES.items():
        assert getattr(states, name) == pytest.approx(value, rel=0.02), name
    fit = warpwear.calibrate_states([f"test-{k}.csv" for k in (1, 2, 3)], radius="6 mm").fits
    assert states.spread == pytest.approx(fit["test-1"].numbers["spread"][0], rel=1e-3)
    assert (study.friction.law, states.per) == ("states", "lap")
    wait = sum(WAITS) / 3.0
    assert states.seed == pytest.approx(states.spread * 2.718281828 ** (-states.spread * wait), rel=0.05)
    assert study.study.description.startswith("measured: μ = 0.55")
    assert "(n = 3); transition after" in study.study.description
    for key, words in {
        "load": "median normal force: test-1, test-2, test-3",
        "distance": "the longest: test-1",
        "speed": "distance over time",
        "diameter": "given",
        "track_radius": "given",
        "disc": "V/(F L) (3.00 ± 0.18)e-5 mm³/(N·m) (n = 3): profile track-1.csv, profile track-2.csv",
        "metal": "fit of all, ± ",
        "film": "tests from 0.1",
        "seed": "for a wait of 39.9 laps; tests from 35.9",
    }.items():
        assert words in comments[key], key
    numbers = tomlkit.parse(Path("a.toml").read_text("utf-8")).unwrap()
    assert "frequency" not in numbers["sliding"]  # of the draft, and of no file


def test_a_frequency_that_is_given_stands_for_the_speed(tmp_path: Path) -> None:
    """And a single record's constants have the errors of its fit."""
    record = lab_record(tmp_path / "test-1.csv", 0)
    changes = {"sliding__track_radius": "6 mm", "sliding__frequency": "60 rpm", "wear__disc": 0}
    study, comments = drafted([record], **changes)
    assert (study.sliding.speed, study.sliding.frequency) == (None, 1.0)
    assert study.sliding.total == pytest.approx(LAPS * LAP, rel=1e-4)
    assert comments["film"].startswith("fit of all, ± ")
    assert re.match(r"for a wait of 3[56]\.\d laps; fit of all, ± 0\.\d+$", comments["seed"])


def test_the_command_does_the_same_and_says_what_comes_next(tmp_path: Path) -> None:
    tests = lab(tmp_path)
    words = [word for test in tests for word in ("--repeat", test["record"].name)]
    words += [word for test in tests for word in ("--profile", test["profile"].name)]
    done = new(*words, **RADIUS)
    assert done.exit_code == 0, done.output
    drafted(tests, sliding__track_radius="6 mm")
    name = re.compile('name = "[ab]"')
    assert name.sub("", Path("b.toml").read_text("utf-8")) == name.sub("", Path("a.toml").read_text("utf-8"))
    records = " ".join(f"--experiment test-{k}.csv" for k in (1, 2, 3))
    assert f"then: warpwear run b.toml\n      warpwear compare b {records}" in done.output
    assert "K of the disc (3.00 ± 0.18)e-5" in done.output


def test_what_no_file_says_is_asked_by_name(tmp_path: Path) -> None:
    lab_record(tmp_path / "test-1.csv", 0)
    with pytest.raises(InputError) as error:
        warpwear.new_study("a.toml", like="rotating", tests=["test-1.csv"], changes=RADIUS)
    asked = "counter.diameter, counter.material, disc.material, disc.synthetic.sq, wear.counter, wear.disc"
    assert f"no file says {asked}: give each as a change" in str(error.value)
    assert not Path("a.toml").exists()
    done = new("--record", "test-1.csv")
    assert "such as --set sliding.track_radius='6 mm'" in done.exception.sentence


def test_courses_without_a_jump_give_a_coefficient(tmp_path: Path) -> None:
    tests = lab(tmp_path, jumps=False)
    study, comments = drafted(tests, sliding__track_radius="6 mm")
    assert study.friction.fitted == "end"
    assert study.friction.coefficient == pytest.approx(STATES["cover"], abs=0.002)
    assert comments["coefficient"].startswith("steady value 0.55")
    assert "(n = 3): test-1, test-2, test-3, which do not all jump" in comments["coefficient"]
    study, _ = drafted(tests, sliding__track_radius="6 mm", friction__shear_strength="90 MPa")
    assert (study.friction.shear_strength, study.friction.fitted) == (90.0, None)


def test_strokes_give_stroke_and_track(tmp_path: Path) -> None:
    work = LOAD * 2.0 * 8.0 * 100
    test = {
        "record": lab_strokes(tmp_path / "strokes.csv", stroke=8.0, cycles=100, cof=0.4),
        "profile": lab_profile(tmp_path / "track.csv", 1, work=work, length=8.0),
    }
    study, comments = drafted([test], like="reciprocating")
    assert study.sliding.stroke == pytest.approx(8.0, rel=0.01)
    assert study.sliding.total == pytest.approx(1600.0, rel=0.01)
    assert study.sliding.mean_speed == pytest.approx(16.0, rel=0.02)
    assert study.wear.disc.value == pytest.approx(K, rel=0.01)
    assert study.friction.coefficient == pytest.approx(0.4, abs=0.005)
    assert comments["stroke"] == "stroke: strokes"
    assert "own error" in comments["disc"]
    with pytest.raises(InputError, match=r"strokes goes to and fro: .*like reciprocating is its rig"):
        drafted([test], like="pin")


def test_a_few_strokes_have_the_speed_of_many(tmp_path: Path) -> None:
    record = lab_strokes(tmp_path / "few.csv", stroke=8.0, cycles=25, cof=0.4)
    study, _ = drafted([record], like="reciprocating", wear__disc=0)
    assert study.sliding.mean_speed == pytest.approx(16.0, rel=0.02)


def test_a_stroke_that_a_file_has_is_the_study_s() -> None:
    lines = [f"{0.5 * k},{0.4 + 0.001 * (k % 5)},2,8,5" for k in range(400)]
    head = "Time [s],CoF,Frequency [Hz],Stroke [mm],Fz [N]"
    Path("srv.csv").write_text("\n".join([head, *lines]), encoding="utf-8")
    study, comments = drafted(["srv.csv"], like="reciprocating", wear__disc=0)
    assert (study.sliding.stroke, comments["stroke"]) == (8.0, "stroke: srv")
    assert study.sliding.mean_speed == pytest.approx(32.0, rel=0.01)


def test_a_lap_of_a_circle_is_no_stroke(tmp_path: Path) -> None:
    """Laps beside distances tell a lap, which the rig by default would have as a stroke."""
    lines = [f"{10.0 * k},{k / 4.0},0.5,5" for k in range(400)]
    Path("round.csv").write_text("\n".join(["Distance [mm],Laps,CoF,Fz [N]", *lines]), encoding="utf-8")
    with pytest.raises(InputError, match=r"round goes round: like rotating or pin is its rig, not recip"):
        drafted(["round.csv"], like="reciprocating", wear__disc=0)
    study, _ = drafted(["round.csv"], wear__disc=0)
    assert study.sliding.track_radius == pytest.approx(40.0 / 6.2831853, rel=1e-3)


def test_a_seed_says_nothing_of_the_roughness(tmp_path: Path) -> None:
    known = {key: value for key, value in GIVEN.items() if key != "disc.synthetic.sq"} | RADIUS
    changes = known | {"wear.disc": 0, "disc.synthetic.seed": 3}
    tests = [lab_record(tmp_path / "test-1.csv", 0, jumps=False)]
    with pytest.raises(InputError, match=r"no file says disc\.synthetic\.sq"):
        warpwear.new_study(like="rotating", tests=tests, changes=changes)
    flat = warpwear.new_study(like="rotating", tests=tests, changes=changes | {"disc.synthetic.kind": "flat"})
    assert flat.disc.synthetic.kind == "flat"


def test_keys_of_a_study_may_stand_beside_the_tests(tmp_path: Path) -> None:
    lab(tmp_path, jumps=False)
    table = "\n".join(
        f'[[test]]\nrecord = "test-{k}.csv"\nprofile = "track-{k}.csv"\nscar = "0.30 +- 0.01 mm"\n'
        for k in (1, 2, 3)
    )
    own = '[counter]\ndiameter = "6 mm"\nmaterial = "AISI 52100"\n[sliding]\ntrack_radius = "6 mm"\n'
    Path("lab.toml").write_text(own + table, encoding="utf-8")
    changes = {"disc.material": "AISI 304", "disc.synthetic.sq": "0.02 um"}
    study = warpwear.new_study("a.toml", like="rotating", tests="lab.toml", changes=changes)
    assert study.counter.nominal_radius == 3.0
    cap = 3.14159265 * 0.15**4 / (4.0 * 3.0)
    assert study.wear.counter.value == pytest.approx(1e3 * cap / (LOAD * LAPS * LAP), rel=0.01)
    text = Path("a.toml").read_text("utf-8")
    assert re.search(r'diameter = "6 mm" +# given beside the tests', text)
    assert re.search(r'sq = "0.02 um" +# given\n', text)


@pytest.mark.slow
def test_tests_under_other_loads_are_of_the_study_s_by_the_trend(tmp_path: Path) -> None:
    """K falls from 5 N to 10 N by what the profiles have; a study of 7 N lies on the line through both."""
    tests = [
        {"record": lab_record(tmp_path / f"{k}-{load}.csv", k, jumps=False, load=load)}
        | {"profile": lab_profile(tmp_path / f"{k}-{load}-track.csv", k)}
        for load in (5.0, 10.0)
        for k in range(3)
    ]
    with pytest.raises(InputError, match=r"the tests have a load from 5 to 10 N: .*set contact.load says"):
        drafted(tests, sliding__track_radius="6 mm")
    study, comments = drafted(tests, sliding__track_radius="6 mm", contact__load="7 N")
    assert study.wear.disc.value == pytest.approx(K * 5.0 / 7.0, rel=0.01)
    assert "(n = 6), at 7 N by the trend" in comments["disc"]


@pytest.mark.parametrize(
    ("like", "tests", "words"),
    [
        ("fretting", ["recipe.csv"], "tests fill in a draft of reciprocating, rotating, pin"),
        ("rotating", ["recipe.csv"], r"recipe has steps under several loads: a study of these has \[\[block"),
        ("rotating", ["none.csv"], "none.csv"),
        ("rotating", [], "nothing was measured"),
    ],
)
def test_what_is_no_test_of_a_study_is_refused(tmp_path: Path, like: str, tests: Any, words: str) -> None:
    lab_recipe(tmp_path / "recipe.csv", 0)
    with pytest.raises(InputError, match=words):
        drafted(tests, like=like, sliding__track_radius="6 mm") if like != "fretting" else warpwear.new_study(
            like=like, tests=tests
        )


def test_a_run_gives_its_shear_strength_to_the_next(tmp_path: Path) -> None:
    """The coefficient at the end of the first is an input, that of the second follows from the area."""
    short = {"grid.cell": "20 um", "sliding.revolutions": 2}
    study = warpwear.new_study("a.toml", like="rotating", changes=short)
    found = warpwear.run(study, out="first", plots=False).summary["shear_strength_MPa"]
    words = ["--set", "contact.load=8 N", "--set", "friction.shear_strength=first"]
    done = CliRunner().invoke(commands, ["show", "a.toml", *words])
    assert done.exit_code == 0, done.output
    (strength,) = re.findall(r'shear_strength = "(\S+) MPa"', done.output)
    assert float(strength) == pytest.approx(found)
