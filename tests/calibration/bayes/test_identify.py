"""What an inference says it cannot tell apart, and data that a study cannot bring together."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases_inference import course_like, drawn, found_for, posterior_of, result_of, smooth_study

from warpwear import Study
from warpwear.batches.plan import read_plan
from warpwear.calibration.bayes.data import Data, MeasuredCourse, MeasuredValue
from warpwear.calibration.bayes.identify import conflicts_of, identify
from warpwear.calibration.bayes.result import write_report
from warpwear.calibration.bayes.sampler import split_of, spread_of


def test_the_ball_and_the_disc_are_not_told_apart_by_a_scar() -> None:
    """At rest a scar follows from K_s + K_d alone: the program says so, and a volume resolves it."""
    study = smooth_study()
    asked: dict[str, str | None] = {"wear.counter": None, "wear.disc": None}
    data = Data(values=(MeasuredValue("scar", 1.26, 0.02),))
    posterior = posterior_of(study, asked, data)
    values, z = found_for(posterior)
    found = identify(posterior, values, z)
    assert [set(group.keys) for group in found.indistinct] == [{"wear.counter", "wear.disc"}]
    told = found.sentences[0]
    assert "cannot be told apart" in told
    assert "the sum wear.counter + wear.disc" in told
    total = values["wear.counter"] + values["wear.disc"]
    assert total.mean() == pytest.approx(2.21e-3 * (1.26 / 1.269) ** 4, abs=total.std())
    assert total.std() / total.mean() == pytest.approx(4.0 * np.hypot(0.02, 0.02 / 6**0.5) / 1.26, rel=0.15)
    with_volume = posterior_of(
        study, asked, replace(data, values=(*data.values, MeasuredValue("volume_disc", 0.0244, 0.001)))
    )
    values, z = found_for(with_volume)
    assert not identify(with_volume, values, z).indistinct


def test_strength_and_area_are_not_told_apart_by_one_coefficient() -> None:
    """Friction at the end is τ0 times the level of the area, here √(K_s + K_d)."""
    study = smooth_study(**{"wear.disc": "0 mm^3/N/m"})
    asked: dict[str, str | None] = {"friction.shear_strength": None, "wear.counter": None}
    data = Data(points=(MeasuredValue("friction", 0.4, 0.02, study.sliding.total),))
    posterior = posterior_of(study, asked, data)
    values, z = found_for(posterior)
    found = identify(posterior, values, z)
    (group,) = found.indistinct
    assert set(group.keys) == set(asked)
    assert group.known.startswith("the product friction.shear_strength · wear.counter^0.5")
    assert "A scar or a worn volume" in found.sentences[0]
    with_scar = posterior_of(study, asked, replace(data, values=(MeasuredValue("scar", 1.0, 0.02),)))
    assert not identify(with_scar, *found_for(with_scar)).indistinct


@pytest.mark.parametrize("error", [0.02, 0.05, 0.1, 0.2])
def test_one_number_never_tells_two_unknowns_apart(error: float) -> None:
    """Its information has rank one: however large its error, and whatever was drawn, only a sum is told."""
    asked: dict[str, str | None] = {"wear.counter": None, "wear.disc": None}
    for seed in range(6):
        scar = 1.269 + error * np.random.default_rng(seed).standard_normal()
        posterior = posterior_of(smooth_study(), asked, Data(values=(MeasuredValue("scar", scar, error),)))
        found = identify(posterior, *found_for(posterior, seed=seed, draws=20_000))
        assert "the sum wear.counter + wear.disc" in found.sentences[0]


def test_three_unknowns_of_one_coefficient_are_told_as_a_product() -> None:
    study = smooth_study()
    asked: dict[str, str | None] = dict.fromkeys(("friction.shear_strength", "wear.counter", "wear.disc"))
    asked["friction.shear_strength"] = "log-uniform 1 .. 10 MPa"
    for seed in range(6):
        data = Data(points=(MeasuredValue("friction", 0.4, 0.05, study.sliding.total),))
        posterior = posterior_of(study, asked, data)
        found = identify(posterior, *found_for(posterior, seed=seed, draws=20_000))
        assert set(found.indistinct[0].keys) == set(asked)
        assert "the product friction.shear_strength · wear.counter^" in found.sentences[0]


def test_an_unknown_of_which_data_say_nothing_is_named() -> None:
    study = smooth_study()
    posterior = posterior_of(
        study,
        {"wear.counter": None, "friction.shear_strength": None},
        Data(values=(MeasuredValue("volume_counter", 0.018, 0.001),)),
    )
    found = identify(posterior, *found_for(posterior))
    assert found.untouched == ("friction.shear_strength",)
    assert not found.indistinct


def test_data_that_a_study_cannot_bring_together_are_named() -> None:
    """The disc's volume asks for a scar of 1.1 mm at rest, and 0.80 mm was measured."""
    data = Data(values=(MeasuredValue("scar", 0.80, 0.02), MeasuredValue("volume_disc", 0.0244, 0.001)))
    asked: dict[str, str | None] = {
        "wear.counter": "log-uniform 1e-5 .. 9e-4 mm^3/N/m",
        "wear.disc": "log-uniform 1e-4 .. 3e-3 mm^3/N/m",
    }
    found = result_of(posterior_of(smooth_study(), asked, data))
    assert any("cannot bring all data together" in sentence for sentence in found.conflicts)
    assert "cannot bring all data together" in str(found)
    (why,) = (sentence for sentence in found.conflicts if sentence.startswith("The reason"))
    # a volume V at rest is a paraboloid's of the diameter d, V = π d⁴/(64 R)
    size = (64.0 * smooth_study().counter.radius * 0.0244 / np.pi) ** 0.25
    assert f"0.0244 mm³, makes one of {size:.2f} mm or more, and measured is 0.80 mm" in why
    assert "So either a measurement or the study is wrong" in str(found)
    assert "2 unknowns for 2 measured values" in str(found)
    assert "<pre>" in found._repr_html_()


def levels_off(study: Study, *, level: float = 0.6) -> MeasuredCourse:
    """A course that runs in soon and then stays, while the area of a ball at rest grows as L^½."""
    course, random = course_like(study, points=60), np.random.default_rng(0)
    rough = 0.01 * random.standard_normal(course.distance.size)
    return replace(course, cof=level - 0.4 * np.exp(-course.distance / 80.0) + rough)


def test_a_course_that_the_study_misses_is_the_headline(tmp_path: Path) -> None:
    """Neither noise nor the end of a prior explains a level of 0.60 away that the record holds to 0.01."""
    study = smooth_study()
    data = Data((levels_off(study),))
    strength = {"friction.shear_strength": "log-uniform 1 .. 3 MPa"}
    posterior = posterior_of(study, strength, data)
    assert posterior.noise[0].prior.second < 0.04
    inference = result_of(posterior)
    text = str(inference)
    assert inference.misses
    first, second = text.splitlines()[:2]
    assert first.startswith("The study cannot bring all data together, for it misses the course of friction")
    assert "fitted unknowns of a study that misses its data" in second
    assert "tell all unknowns apart" not in text
    assert "at its end" in text
    assert (
        "presses against the upper end of its prior, 3 MPa; give one that goes on, such as "
        "'friction.shear_strength=log-uniform 1 .. 15 MPa'"
    ) in text
    rows = [row for row in inference.computed() if row["what"].startswith("test: ")]
    assert [row["what"].split()[1:3] for row in rows] == [
        ["friction", "over"],
        ["its", "rise"],
        ["its", "shape,"],
    ]
    assert rows[0]["off"] > 3.0
    assert rows[0]["measured"] == pytest.approx(0.6, abs=0.02)
    assert all(row["fitted"] for row in rows)
    assert f"the worst {max(row['off'] for row in rows):.1f} apart; all were fitted" in text
    write_report(inference, tmp_path)
    assert not (tmp_path / "calibrated.toml").exists()
    written = (tmp_path / "fitted.toml").read_text(encoding="utf-8")
    assert written.startswith("# FITTED, NOT CALIBRATED: this study misses the data.")
    plan = read_plan(tmp_path / "fitted.toml", {}, {}, device="cpu")
    for point in plan.points:
        assert point.study is not None
        assert point.study.study.name == "v1 - misses its data"
        assert "FITTED TO DATA THAT IT MISSES" in point.study.study.description


def test_a_course_that_the_study_meets_is_calibrated(tmp_path: Path) -> None:
    study = smooth_study()
    truth = {"friction.shear_strength": 3.0, "noise.deviation": 0.02, "noise.length": 60.0}
    data = drawn(study, truth, Data((course_like(study, points=60),)), 4)
    (tmp_path / "fitted.toml").touch()
    inference = result_of(posterior_of(study, {"friction.shear_strength": "log-uniform 2 .. 5 MPa"}, data))
    assert not inference.misses
    assert max(row["off"] for row in inference.computed()) < 3.0
    write_report(inference, tmp_path)
    assert (tmp_path / "calibrated.toml").is_file()
    assert not (tmp_path / "fitted.toml").exists()


@pytest.mark.parametrize("length", [20.0, 150.0, 600.0])
def test_a_true_study_is_not_said_to_miss_its_course(length: float) -> None:
    """Noise that goes together moves the level of a third: the verdict has the noise that was fitted."""
    study, misses = smooth_study(), 0
    truth = {"friction.shear_strength": 3.0, "noise.deviation": 0.03, "noise.length": length}
    for seed in range(25):
        data = drawn(study, truth, Data((course_like(study, points=60),)), seed)
        posterior = posterior_of(study, {"friction.shear_strength": "log-uniform 2 .. 5 MPa"}, data)
        values, _ = found_for(posterior, draws=4000)
        misses += any("cannot bring" in line for line in conflicts_of(posterior, values))
    assert misses == 0


def test_what_one_test_tells_is_of_this_test() -> None:
    """One volume tells K of its own test; of two the scatter between tests is in the uncertainty."""
    wear: dict[str, str | None] = {"wear.disc": None}
    volumes = (MeasuredValue("volume_disc", 0.0244, 0.0005), MeasuredValue("volume_disc", 0.0248, 0.0005))
    for count in (1, 2):
        inference = result_of(posterior_of(smooth_study(), wear, Data(values=volumes[:count])))
        inference = replace(inference, repeats={"wear.disc": 0})
        (line,) = (line for line in inference.sentences if "is known to" in line)
        assert ("of this test" in line) == (count == 1)


def test_what_the_prior_decides_is_not_said_to_be_known() -> None:
    """Nor how many more tests help: of what no datum tells, at a prior's end, in a study that misses its
    data."""
    counter, disc = (MeasuredValue(f"volume_{body}", 0.0244, 0.0005) for body in ("counter", "disc"))
    scar = MeasuredValue("scar", 0.8, 0.02)
    both: dict[str, str | None] = {"wear.counter": None, "wear.disc": None}
    at_its_end = both | {"wear.disc": "uniform 1e-4 .. 1.25e-3 mm^3/N/m"}
    for asked, data, told in (
        (both, (counter,), {"wear.counter"}),
        (both, (counter, disc), {"wear.counter", "wear.disc"}),
        (at_its_end, (counter, disc), {"wear.counter"}),
        (both, (counter, disc, scar), set()),
    ):
        inference = result_of(posterior_of(smooth_study(), asked, Data(values=data)))
        inference = replace(inference, repeats=dict.fromkeys(both, 3))
        assert set(inference.more_tests) == told
        assert {key for key in both if f"{key} is known to" in str(inference)} == told


def test_quantiles_are_told_where_few_samples_make_the_deviation() -> None:
    """Four in a thousand samples made ± 49 %; groups that lie apart are named."""
    random = np.random.default_rng(0)
    near, far = 1.0 + 0.02 * random.standard_normal(3984), 8.0 + 0.1 * random.standard_normal(16)
    middle, half, by_quantiles = spread_of(np.append(near, far))
    assert (middle, half) == pytest.approx((1.0, 0.02), rel=0.06)
    assert by_quantiles
    assert split_of(np.append(far, near), 4000.0) == near.size
    assert spread_of(near) == (near.mean(), near.std(), False)
    assert spread_of(np.full(10, 0.1)) == (pytest.approx(0.1), 0.0, False)
    alone = [split_of(random.standard_normal(4000), 4000.0) for _ in range(400)]
    alone += [split_of(random.exponential(size=4000), 4000.0) for _ in range(400)]
    assert len([one for one in alone if one is not None]) <= 8
    data = Data(values=(MeasuredValue("volume_disc", 0.0244, 0.0005),))
    inference = result_of(posterior_of(smooth_study(), {"wear.disc": None}, data))
    assert 0.995 < inference.table[0]["learnt"] < 1.0
    assert "over 99 %" in str(inference)
    inference = replace(inference, values={"wear.disc": np.append(near, far)})
    assert "wear.disc has two groups of values: 0.4 % lie from 7." in str(inference)
    assert "(median, 16 to 84 %)" in str(inference)


def test_a_prior_that_holds_an_unknown_back_is_named() -> None:
    """A lower end with a prior that goes on below it, and a normal prior far from what the volume tells."""
    data = Data(values=(MeasuredValue("volume_disc", 0.0244, 0.0005),))  # K = 1.27e-3
    for prior, sentence in (
        ("log-uniform 1.26e-3 .. 5e-3 mm^3/N/m", "'wear.disc=log-uniform 0.000252 .. 0.005 mm^3/N/m'"),
        ("uniform 1e-4 .. 1.28e-3 mm^3/N/m", "'wear.disc=uniform 0.0001 .. 0.00246 mm^3/N/m'"),
        ("normal 5e-4 +- 1e-4 mm^3/N/m", "from the middle of its prior, normal 0.0005 ± 0.0001 mm^3/N/m"),
    ):
        inference = result_of(posterior_of(smooth_study(), {"wear.disc": prior}, data))
        assert any(sentence in line for line in inference.sentences), inference.sentences
