"""Several tests of one pair in one answer: records, volumes, conditions, two pairs, and what is written."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from calibration.cases_lab import LAP as LAP_OF_LAB
from calibration.cases_lab import LAPS, LOAD, OFF, K, lab, lab_recipe, lab_record
from click.testing import CliRunner
from measured.cases_courses import Truth, made

import warpwear
from warpwear.calibration.measurements import Value
from warpwear.calibration.scatter import PairTest, RepeatedNumber
from warpwear.cli.main import commands
from warpwear.ensembles.datum import CONTRADICTION, Datum, headline, worst_of
from warpwear.errors import InputError

LAP = 2.0 * math.pi * 6.0  # [mm]
LOADS = (2.0, 5.0, 10.0)
VOLUMES = [
    {"volume_disc": f"{v} +- 0.001 mm^3", "load": "5 N", "distance": "2 m"} for v in (0.02, 0.03, 0.025)
]


def record(path: Path, seed: int) -> Truth:
    """Write a record with a jump, five points a lap."""
    cof, truth = made(seed)
    laps = (np.arange(5 * cof.size) + 0.5) / 5.0
    table = np.column_stack([laps * LAP, np.repeat(cof, 5)])
    np.savetxt(path, table, delimiter=",", header="Distance [mm],COF [-]", comments="", fmt="%.6f")
    return truth


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Path], list[Truth]]:
    pytest.importorskip("ruptures")
    paths = [tmp_path_factory.mktemp("records") / f"test-{k}.csv" for k in range(3)]
    return paths, [record(path, k) for k, path in enumerate(paths)]


def numbers(*words: Any) -> Any:
    done = CliRunner().invoke(commands, ["repeats", *map(str, words), "--json"])
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


def test_three_records_are_one_answer(records: tuple[list[Path], list[Truth]]) -> None:
    """Mean and standard deviation of what each record says by itself."""
    paths, truths = records
    alone = [warpwear.read_record(path, radius="6 mm").numbers for path in paths]
    found = numbers(*paths, "--radius", "6 mm")["numbers"]
    for name, key in (("level", "steady_cof"), ("incubation", "incubation_mm"), ("jump", "jump_mm")):
        values = [each[key] for each in alone]
        assert (found[name]["mean"], found[name]["s"]) == pytest.approx(
            (np.mean(values), np.std(values, ddof=1))
        )
        assert found[name]["next_low"] < found[name]["mean"] < found[name]["next_high"]
        assert found[name]["n"] == found[name]["left_out"] == 3
    assert found["incubation"]["mean"] == pytest.approx(LAP * np.mean([t.start for t in truths]), abs=LAP)


def test_the_sentence_for_a_paper(records: tuple[list[Path], list[Truth]], tmp_path: Path) -> None:
    paths, truths = records
    table = "\n".join(
        f'[[test]]\nrecord = "{p}"\n' + 'load = "5 N"\nvolume_disc = "0.02 mm^3"\n' for p in paths
    )
    (tmp_path / "tests.toml").write_text(table, encoding="utf-8")
    report = warpwear.repeats(tmp_path / "tests.toml", radius="6 mm")
    level = report.told["level"]
    sentence = report.numbers["sentence"]
    assert sentence.startswith(f"μ = {level['mean']:.3f} ± {level['s']:.3f} (n = 3); transition after ")
    assert "K of the disc (" in sentence
    first, last = (
        float(word) for word in sentence.partition("after ")[2].partition(" laps")[0].split(" to ")
    )
    assert (first, last) == pytest.approx(
        (min(t.start for t in truths), max(t.start for t in truths)), abs=1.0
    )
    work = 5.0 * report.tests[0].course[0][-1] if report.tests[0].course else math.nan
    assert report.tests[0].values["k_disc"].value == pytest.approx(0.02 / work, rel=0.01)  # mm³/(N·m)
    assert len(str(report).splitlines()) <= 10


def test_it_is_written_as_a_folder(records: tuple[list[Path], list[Truth]], tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["repeats", *map(str, records[0]), "--radius", "6 mm", "--out", str(out)]
    done = CliRunner().invoke(commands, words)
    assert done.exit_code == 0, done.output
    assert {path.name for path in out.iterdir()} == {
        "repeats.html",
        "repeats.csv",
        "repeats.json",
        "manifest.json",
        "courses.png",
    }
    page = (out / "repeats.html").read_text(encoding="utf-8")
    assert json.loads((out / "repeats.json").read_text(encoding="utf-8"))["sentence"] in page
    assert "(difference)/error" in page
    again = CliRunner().invoke(commands, words)
    assert "already holds repeats" in str(again.exception)
    assert CliRunner().invoke(commands, [*words, "--overwrite"]).exit_code == 0


def test_places_of_one_test_are_no_tests() -> None:
    """Two entries of one name are their mean, with the larger of both errors."""
    places = [{**VOLUMES[0], "name": "a"}, {**VOLUMES[1], "name": "a"}, {**VOLUMES[2], "name": "b"}]
    report = warpwear.repeats(places)
    k = report.tests[0].values["k_disc"]
    assert [test.name for test in report.tests] == ["a", "b"]
    assert report.told["k_disc"]["n"] == 2
    assert k.value == pytest.approx(0.025 / 10.0)
    assert k.error == pytest.approx(0.005 / 10.0)


def test_a_trend_over_the_load() -> None:
    """K falls as F^-0.5, exactly: the next test is told at its own load."""
    law = [{"volume_disc": f"{0.002 * f**0.5} mm^3", "load": f"{f} N", "distance": "1 m"} for f in LOADS * 3]
    told = warpwear.repeats(law, at={"load": "20 N"}).told["k_disc"]
    assert told["trend"]["load"][0] == pytest.approx(-0.5, abs=1e-6)
    assert told["mean"] == pytest.approx(0.002 / 20.0**0.5)
    assert told["s"] == pytest.approx(0.0, abs=1e-9)
    middle = warpwear.repeats(law).told["k_disc"]
    assert middle["at"]["load"] == pytest.approx(100.0 ** (1.0 / 3.0))
    assert middle["mean"] == pytest.approx(0.002 / middle["at"]["load"] ** 0.5)


def test_two_pairs_differ_with_an_error() -> None:
    other = [{**test, "volume_disc": "0.05 +- 0.001 mm^3"} for test in VOLUMES]
    report = warpwear.repeats(VOLUMES, than=other)
    assert report.than is not None
    gap, error = report.differences["k_disc"]
    pairs = [each.told["k_disc"] for each in (report, report.than)]
    assert gap == pytest.approx(pairs[0]["pair"] - pairs[1]["pair"])
    assert error == pytest.approx(math.hypot(*(pair["pair_error"] for pair in pairs)))
    assert abs(gap) > 2.0 * error


def test_each_test_stands_beside_the_others() -> None:
    """Measured, computed and their difference in errors; the worst is the headline."""
    report = warpwear.repeats(
        [{"friction": f"{level} +- 0.002"} for level in (0.6, 0.602, 0.598, 0.601, 0.9)]
    )
    worst = worst_of(report.data)
    assert worst is not None
    assert (worst.name, worst.measured) == ("test.5, level of friction", 0.9)
    assert worst.computed == pytest.approx(0.600, abs=0.002)
    assert report.told["level"]["left_out_within"] == 4
    assert str(report).splitlines()[-1].strip() == report.numbers["headline"] == headline(report.data)


def test_zero_overshoot_is_a_number() -> None:
    """Where some tests have none, numbers and not logarithms scatter, and none is below zero."""
    tests = tuple(PairTest(str(k), {}, {"o": Value(v)}) for k, v in enumerate((0.0, 0.1, 0.05)))
    found = RepeatedNumber("o", tests, (), {})
    told = found.numbers(0.05)
    assert (told["mean"], told["s"]) == pytest.approx((0.05, 0.05))
    assert told["next_low"] == 0.0


@pytest.mark.slow
def test_laboratories_are_told_how_the_next_test_will_be() -> None:
    """Three loads, three repeats, a hidden scatter: 200 laboratories with three numbers each."""
    dice = np.random.default_rng(7)
    inside, left_out = [], []
    for _ in range(200):
        for scatter, slope in ((dice.uniform(0.1, 0.5), -0.3), (dice.uniform(0.2, 0.8), 0.5), (0.08, 0.0)):
            loads = np.array([*LOADS * 3, dice.choice(LOADS)])
            true = slope * np.log(loads) + dice.normal(0.0, scatter, 10)
            values = np.exp(true + dice.normal(0.0, 0.05, 10))
            tests = [
                PairTest(str(k), {"load": load}, {"k": Value(v, 0.05 * v)})
                for k, (load, v) in enumerate(zip(loads.tolist(), values.tolist(), strict=True))
            ]
            number = RepeatedNumber("k", tuple(tests[:9]), ("load",), {"load": float(loads[9])})
            low, high = number.interval
            inside.append(low < values[9] < high)
            left_out += [within for _, within in number.data]
    print(f"next test {np.mean(inside):.3f}, left out {np.mean(left_out):.3f}")
    assert 0.84 <= np.mean(inside) <= 0.96
    assert 0.84 <= np.mean(left_out) <= 0.96
    assert np.mean(left_out) == pytest.approx(np.mean(inside), abs=0.04)


def test_agreement_that_was_fitted_does_not_count() -> None:
    fitted, free = Datum("a", 1.0, 1.2, 0.1, fitted=True), Datum("b", 1.0, 1.05, 0.1)
    assert worst_of([fitted, free]) is free
    missed = Datum("c", 1.0, 1.0 + (CONTRADICTION + 1.0) * 0.1, 0.1, fitted=True)
    assert worst_of([missed, free]) is missed
    assert headline([missed, free]).endswith("4.0 errors apart (fitted); 1 of 1 agree within 3 errors")
    assert headline([fitted]).endswith("(fitted); all were fitted")


@pytest.mark.parametrize(
    ("tests", "more", "text"),
    [
        ([{"load": "5 N"}], {}, "nothing was measured"),
        ([{"volume_disc": "0.02 mm^3"}], {}, "test.1.volume_disc needs a load and a distance"),
        (
            [{**VOLUMES[0], "section": "800 um^2", "track_length": "30 mm"}],
            {},
            "of a body whose wear is given already",
        ),
        (VOLUMES, {"at": {"load": "9 N"}}, "the tests have to differ in it"),
        (VOLUMES, {"at": {"humidity": "9"}}, "at humidity is not allowed; allowed: load, speed"),
        (VOLUMES, {"wanted": 0.0}, "wanted is 0: allowed is a part of the mean"),
        ([{"friction": "0.6 at 3 mm"}], {}, "test.1.friction is at a distance"),
    ],
)
def test_what_is_no_repeat_is_refused(tests: Any, more: dict[str, Any], text: str) -> None:
    with pytest.raises(InputError) as error:
        warpwear.repeats(tests, **more)
    assert text in str(error.value)


def test_profiles_and_scars_stand_beside_records_in_order(tmp_path: Path) -> None:
    """What the command line says is what a list of tests says; a test without a profile has none."""
    pytest.importorskip("ruptures")
    tests = lab(tmp_path, jumps=False)
    words = [word for test in tests[:2] for word in ("--profile", test["profile"])]
    words += [*("--scar", "0.30 mm", "--scar", "0.32 mm", "--ball-radius", "3 mm", "--radius", "6 mm")]
    found = numbers(*(test["record"] for test in tests), *words)["numbers"]
    listed = [
        test | {"scar": scar, "radius": "3 mm"}
        for test, scar in zip(tests, ("0.30 mm", "0.32 mm"), strict=False)
    ]
    told = warpwear.repeats([*listed, {"record": tests[2]["record"]}], radius="6 mm").told
    assert {name: row["n"] for name, row in found.items()} == {"level": 3, "k_counter": 2, "k_disc": 2}
    assert {name: row["mean"] for name, row in found.items()} == pytest.approx(
        {name: row["mean"] for name, row in told.items()}
    )
    assert found["k_disc"]["mean"] == pytest.approx(K * (1.0 + (OFF[0] + OFF[1]) / 2.0), rel=5e-3)


def test_steps_under_several_loads_are_numbers_by_load(tmp_path: Path) -> None:
    """Friction 0.5 + 0.01 F + 0.01 k of test k; K is the volume over the sum of F L."""
    pytest.importorskip("ruptures")
    tests = [
        {"record": lab_recipe(tmp_path / f"r{k}.csv", k), "volume_disc": "0.03 mm^3", "track_radius": "6 mm"}
        for k in range(3)
    ]
    report = warpwear.repeats(tests)
    for load, name in ((5.0, "5.01 N"), (10.0, "10 N")):  # the mean of what the three machines had
        told = report.told[f"level at {name}"]
        assert told["mean"] == pytest.approx(0.51 + 0.01 * load, abs=0.003)
        assert told["s"] == pytest.approx(0.01, abs=0.003)
        assert (told["n"], told["at"]) == (3, {})
    work = [(5.0 + 10.0) * (1.0 + 0.002 * k) * 10.0 for k in range(3)]
    assert report.told["k_disc"]["mean"] == pytest.approx(np.mean([0.03 / w for w in work]), rel=2e-3)
    assert " at 5.01 N (n = 3); μ = " in report.numbers["sentence"]
    with pytest.raises(
        InputError, match=r"section needs test.1.track_length"
    ):  # nothing says how long the track is
        warpwear.repeats([{"record": tests[0]["record"], "section": "90 um^2"}], radius=None)
    course = report.tests[0].course
    assert course is not None
    assert course[0][-1] == pytest.approx(20.0, rel=0.02)  # one step after the other


def test_a_load_that_a_record_has_goes_before_the_one_that_is_given(tmp_path: Path) -> None:
    pytest.importorskip("ruptures")
    test = {"record": lab_record(tmp_path / "a.csv", 0, jumps=False), "volume_disc": "0.01 mm^3"}
    report = warpwear.repeats([test], load="9 N", radius=6.0)
    assert report.tests[0].conditions["load"] == pytest.approx(LOAD)
    assert report.told["k_disc"]["mean"] == pytest.approx(10.0 / (LOAD * LAPS * LAP_OF_LAB), rel=1e-3)


def test_a_trend_over_the_speed_that_records_say(tmp_path: Path) -> None:
    """K falls as v^-0.5 of records whose time and laps give the speed."""
    pytest.importorskip("ruptures")
    speeds = (50.0, 100.0, 200.0)
    tests = [
        {"record": lab_record(tmp_path / f"{v:g}-{k}.csv", k, jumps=False, pace=v)}
        | {"volume_disc": f"{0.05 / v**0.5} mm^3"}
        for v in speeds
        for k in range(2)
    ]
    told = warpwear.repeats(tests, radius="6 mm", at={"speed": "400 mm/s"}).told["k_disc"]
    assert told["trend"]["speed"][0] == pytest.approx(-0.5, abs=1e-3)
    assert told["mean"] == pytest.approx(1e3 * 0.05 / 20.0 / (LOAD * LAPS * LAP_OF_LAB), rel=2e-3)


def test_a_volume_that_may_be_nothing_is_told() -> None:
    sections = [
        {"section": f"100 +- {u} um^2", "track_length": "30 mm", "load": "5 N", "distance": "10 m"}
        for u in (20, 80)
    ]
    notes = warpwear.repeats(sections).numbers["notes"]
    assert notes == ["test.2: of section the volume is within three standard uncertainties of nothing"]


def test_courses_that_share_no_place_have_no_band(tmp_path: Path) -> None:
    """Their lines are drawn, each where it was measured."""
    pytest.importorskip("ruptures")
    for name, start in (("near", 0.0), ("far", 5000.0)):
        rows = "".join(f"{start + s},{0.5 + 0.01 * math.sin(s)}\n" for s in range(1, 401))
        (tmp_path / f"{name}.csv").write_text("distance [mm],COF\n" + rows)
    found = warpwear.repeats([{"record": tmp_path / f"{name}.csv"} for name in ("near", "far")])
    labels = [text.get_text() for text in found.figure().legends[0].get_texts()]
    assert labels == ["near", "far"]
