"""Inference against closed forms, what it says it cannot tell apart, and what it refuses."""

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases_inference import course_like, posterior_of, smooth_study, worn_paraboloid
from click.testing import CliRunner
from scipy import stats

import warpwear
from warpwear import ConvergenceError, InputError, Study
from warpwear.cli.calibrate_bayes import bayes
from warpwear.inference.data import Data, Measured, data_of
from warpwear.inference.emulator import Emulator
from warpwear.inference.identify import identify
from warpwear.inference.infer import check_priors, infer_from
from warpwear.inference.likelihood import INDEPENDENT, Posterior, _innovations, simulate
from warpwear.inference.model import Model
from warpwear.inference.next_test import Candidate, best_tests, repeats_needed
from warpwear.inference.report import calibrated
from warpwear.inference.result import Inference, conflicts_of
from warpwear.inference.runs import Runs, scales
from warpwear.inference.sampler import Samples, sample, split_r
from warpwear.inference.unknowns import unknowns_of
from warpwear.measured.course import Experiment
from warpwear.sweeps.plan import read_plan
from warpwear.sweeps.run_one import Row

emcee = pytest.importorskip("emcee")
NORMAL = {"friction.ploughing": "normal 0.2 +- 0.02", "friction.shear_strength": "normal 3 +- 0.3 MPa"}


def found_for(posterior: Posterior) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Samples of a posterior by weighing many draws of the prior, apart from any sampler."""
    return posterior.complete(weighed(posterior).z, np.random.default_rng(0))


def weighed(posterior: Posterior) -> Samples:
    """Draws of the prior by their likelihood."""
    random = np.random.default_rng(0)
    z = random.standard_normal((200_000 if posterior.sampled else 4000, len(posterior.sampled)))
    logs = posterior.log_likelihood(z)
    weights = np.exp(logs - logs.max())
    return Samples(z[random.choice(len(z), 4000, p=weights / weights.sum())], 0, 1.0, 1.0, 4000.0)


def drawn(study: Study, truth: dict[str, float], data: Data, seed: int) -> Data:
    """The data of a simulated test."""
    random = np.random.default_rng(seed)
    keys = {key: None for key in truth if not key.startswith("noise")}
    model = posterior_of(study, keys, data).model
    cof, values = simulate(model, {key: np.array([value]) for key, value in truth.items()}, data, random)
    ends = np.cumsum([0, *(course.distance.size for course in data.courses)])
    return Data(
        tuple(replace(c, cof=cof[0, a:b]) for c, a, b in zip(data.courses, ends[:-1], ends[1:], strict=True)),
        tuple(replace(p, value=float(v)) for p, v in zip(data.points, cof[0, ends[-1] :], strict=True)),
        tuple(replace(v, value=float(m[0])) for v, m in zip(data.values, values, strict=True)),
    )


@pytest.fixture(scope="module")
def linear() -> Data:
    """Coefficients of friction at single distances: a linear problem with normal priors and known errors."""
    study = smooth_study()
    points = tuple(Measured("cof", 0.5, 0.02, at) for at in np.linspace(100.0, study.sliding.total, 12))
    return drawn(study, {"friction.ploughing": 0.21, "friction.shear_strength": 3.1}, Data(points=points), 3)


def exact(data: Data) -> tuple[np.ndarray, np.ndarray]:
    """Mean and covariance of μ_p and τ0 by the normal equations."""
    study = smooth_study()
    runs = worn_paraboloid(study)
    worn = np.array([p.at for p in data.points]) / 12.0
    distance, area = runs.course("area_contact")
    columns = np.column_stack(
        [np.ones(worn.size), np.exp(np.interp(np.log(worn), np.log(distance), np.log(area[0]))) / 8.0]
    )
    spread = np.linalg.inv(columns.T @ columns / 0.02**2 + np.diag([0.02**-2.0, 0.3**-2.0]))
    cof = np.array([p.value for p in data.points])
    return spread @ (columns.T @ cof / 0.02**2 + np.array([0.2 / 0.02**2, 3.0 / 0.3**2])), spread


@pytest.mark.parametrize("closed_form", [True, False])
def test_a_linear_problem_has_its_closed_form(linear: Data, closed_form: bool) -> None:
    """By Woodbury's identity alone, and by the sampler with everything sampled."""
    posterior = posterior_of(smooth_study(), NORMAL, linear, closed_form=closed_form)
    assert len(posterior.sampled) == (0 if closed_form else 2)
    samples = sample(posterior.log_density, len(posterior.sampled), seed=0)
    values, _ = posterior.complete(samples.z, np.random.default_rng(0))
    mean, spread = exact(linear)
    found = np.array([values[key] for key in NORMAL])
    deviations = np.sqrt(np.diag(spread))
    np.testing.assert_allclose(found.mean(axis=1), mean, atol=0.08 * deviations.min(), rtol=0.01)
    np.testing.assert_allclose(np.cov(found), spread, rtol=0.1)


def test_what_is_integrated_out_changes_no_likelihood() -> None:
    """The closed form is the integral over the strengths: by quadrature, with correlated residuals."""
    study = smooth_study()
    like = Data((course_like(study, points=12), course_like(study, points=9)))
    truth = {
        "friction.ploughing": 0.2,
        "friction.shear_strength": 3.0,
        "noise.deviation": 0.02,
        "noise.length": 300.0,
        "noise.repeat": 0.02,
    }
    data = drawn(study, truth, like, 1)
    closed, whole = (posterior_of(study, NORMAL, data, closed_form=kind) for kind in (True, False))
    noise = np.array([[0.3, -0.4, 0.2]])
    z, weights = np.polynomial.hermite_e.hermegauss(60)
    a, b = np.meshgrid(z, z)
    both = np.column_stack([a.ravel(), b.ravel(), np.repeat(noise, a.size, axis=0)])
    logs = whole.log_likelihood(both)
    top = logs.max()
    integral = top + np.log(np.sum(np.exp(logs - top) * np.outer(weights, weights).T.ravel()) / (2.0 * np.pi))
    assert closed.log_likelihood(noise)[0] == pytest.approx(integral, abs=1e-6)


def test_residuals_go_together_as_a_dense_covariance_says() -> None:
    """The likelihood of a course is that of a normal distribution with the covariance σ² e^(−|ΔL|/ℓ)."""
    study = smooth_study()
    data = drawn(
        study,
        {"friction.shear_strength": 3.0, "noise.deviation": 0.03, "noise.length": 200.0},
        Data((course_like(study, points=25),)),
        2,
    )
    posterior = posterior_of(study, {"friction.shear_strength": "uniform 1 .. 8 MPa"}, data)
    z = np.random.default_rng(0).standard_normal((5, 3))
    values = posterior.values(z)
    distance = data.distance
    expected = []
    for n in range(5):
        one = {key: value[n : n + 1] for key, value in values.items()}
        apart = np.abs(distance[:, None] - distance)
        covariance = one["noise.deviation"] ** 2 * np.exp(-apart / one["noise.length"])
        residual = data.cof - posterior.model.cof(one, distance)[0]
        expected.append(
            -0.5 * (residual @ np.linalg.solve(covariance, residual) + np.linalg.slogdet(covariance)[1])
        )
    np.testing.assert_allclose(posterior.log_likelihood(z), expected, rtol=1e-9)


def test_residuals_that_also_scatter_on_their_own_have_their_covariance() -> None:
    """Whitened lines have the inner products, and the determinant, of the whole covariance matrix."""
    random = np.random.default_rng(3)
    gaps = np.append(np.inf, random.uniform(1.0, 60.0, 29))
    gaps[12] = np.inf  # another course
    deviation, length = random.uniform(0.004, 0.05, 5), random.uniform(20.0, 600.0, 5)
    alone = random.uniform(0.0, 0.02, (5, 30))
    lines = random.standard_normal((5, 3, 30))
    kept = np.exp(-np.minimum(gaps / length[:, None], INDEPENDENT))
    white = lines.copy()
    divided = _innovations(white, kept, deviation[:, None] ** 2 * (1.0 - kept**2), alone**2)
    where = np.cumsum(np.where(np.isinf(gaps), 1e9, gaps))
    for one in range(5):
        among = np.exp(-np.abs(np.subtract.outer(where, where)) / length[one])
        among = deviation[one] ** 2 * among + np.diag(alone[one] ** 2)
        np.testing.assert_allclose(
            white[one] @ white[one].T, lines[one] @ np.linalg.solve(among, lines[one].T)
        )
        assert 2.0 * np.log(divided[one]).sum() == pytest.approx(np.linalg.slogdet(among)[1])


def test_areas_of_whole_cells_carry_their_scatter() -> None:
    """Steps of whole cells are smoothed, and the error that is told is that of a finer grid's area."""
    study = smooth_study()
    exact = worn_paraboloid(study)
    distance = np.linspace(0.3, study.sliding.total, 8000)
    first = exact.rows[0].courses
    area = np.exp(np.interp(np.log(distance), np.log(first["distance"]), np.log(first["area_contact"])))
    x = np.arange(-60, 61) * 0.02
    cells = np.sort(np.add.outer(x**2, x**2).ravel())
    counted = 0.02**2 * np.searchsorted(cells, area / np.pi)
    courses = {"distance": distance, "area_contact": counted, "patch_along": area, "patch_across": area}
    runs = replace(exact, rows=(Row("done", courses=courses),))
    places, smooth, scatter = runs.smooth("area_contact")
    late = places > 200.0
    wanted = np.interp(places, distance, area)
    off = np.log(smooth[0] / wanted)[late]
    raw = np.log(np.interp(places, distance, counted) / wanted)[late]
    assert np.sqrt(np.mean(off**2)) < 0.7 * np.sqrt(np.mean(raw**2))
    assert scatter[late].mean() == pytest.approx(np.sqrt(np.mean(raw**2)), rel=0.25)
    asked: dict[str, str | None] = {"friction.shear_strength": "normal 3 +- 0.3 MPa"}
    made = Model(study, tuple(unknowns_of(study, asked)), runs)
    assert not Posterior(made, (), Data()).linear  # the strength decides how uncertain friction is


def test_one_run_serves_all_wear_coefficients(tmp_path: Path) -> None:
    """Area, scar and volumes of a run at other wear coefficients are those of the scaled run."""
    study = smooth_study(**{"sliding.distance": "300 mm"})
    assert scales(study)
    like = data_of(study, [], {"diameter": "0.72 +- 0.02 mm", "cof": "0.2 +- 0.02"})
    asked = {
        "wear.sphere": "log-uniform 2e-4 .. 9.4e-4 mm^3/N/m",
        "friction.shear_strength": "normal 4 +- 0.4 MPa",
    }
    found = infer_from(study, asked, like, out=tmp_path / "found")
    model = found.posterior.model
    assert len(model.runs.rows) == 1
    other = study.replace({"wear.sphere": "3e-4 mm^3/N/m"})
    with warpwear.run(other, device="cpu") as result:
        one = {"wear.sphere": np.array([3e-4]), "friction.shear_strength": np.array([3.83])}
        history = result.history
        some = history["distance"] > 100.0  # before, an area of whole cells of 20 µm is too coarse a stair
        expected = 3.83 * history["area_contact"][some] / 8.0
        np.testing.assert_allclose(model.cof(one, history["distance"][some])[0], expected, rtol=0.05)
        assert model.cof(one, history["distance"][-1:])[0, 0] == pytest.approx(expected[-1], rel=0.03)
        scar = 0.5 * (history["patch_along"][-1] + history["patch_across"][-1])
        assert model.value(one, "diameter")[0][0] == pytest.approx(scar, abs=0.02)
        assert model.value(one, "volume_sphere")[0][0] == pytest.approx(
            history["wear_volume_sphere"][-1], rel=1e-9
        )
    page = (tmp_path / "found" / "inference.html").read_text(encoding="utf-8")
    assert "unknowns after the test" in page
    assert "https://" not in page


def test_the_ball_and_the_disc_are_not_told_apart_by_a_scar() -> None:
    """At rest a scar follows from K_s + K_d alone: the program says so, and a volume resolves it."""
    study = smooth_study()
    asked: dict[str, str | None] = {"wear.sphere": None, "wear.disc": None}
    data = Data(values=(Measured("diameter", 1.26, 0.02),))
    posterior = posterior_of(study, asked, data)
    values, z = found_for(posterior)
    found = identify(posterior, values, z)
    assert [set(group.keys) for group in found.indistinct] == [{"wear.sphere", "wear.disc"}]
    told = found.sentences[0]
    assert "cannot be told apart" in told
    assert "the sum wear.sphere + wear.disc" in told
    total = values["wear.sphere"] + values["wear.disc"]
    assert total.mean() == pytest.approx(2.21e-3 * (1.26 / 1.269) ** 4, abs=total.std())
    assert total.std() / total.mean() == pytest.approx(4.0 * np.hypot(0.02, 0.02 / 6**0.5) / 1.26, rel=0.15)
    with_volume = posterior_of(
        study, asked, replace(data, values=(*data.values, Measured("volume_disc", 0.0244, 0.001)))
    )
    values, z = found_for(with_volume)
    assert not identify(with_volume, values, z).indistinct


def test_strength_and_area_are_not_told_apart_by_one_coefficient() -> None:
    """Friction at the end is τ0 times the level of the area, here √(K_s + K_d)."""
    study = smooth_study(**{"wear.disc": "0 mm^3/N/m"})
    asked: dict[str, str | None] = {"friction.shear_strength": None, "wear.sphere": None}
    data = Data(points=(Measured("cof", 0.4, 0.02, study.sliding.total),))
    posterior = posterior_of(study, asked, data)
    values, z = found_for(posterior)
    (group,) = identify(posterior, values, z).indistinct
    assert set(group.keys) == set(asked)
    assert group.known.startswith("the product friction.shear_strength · wear.sphere^0.5")
    assert "A scar or a worn volume" in str(group)
    with_scar = posterior_of(study, asked, replace(data, values=(Measured("diameter", 1.0, 0.02),)))
    assert not identify(with_scar, *found_for(with_scar)).indistinct


def test_an_unknown_of_which_data_say_nothing_is_named() -> None:
    study = smooth_study()
    posterior = posterior_of(
        study,
        {"wear.sphere": None, "friction.shear_strength": None},
        Data(values=(Measured("volume_sphere", 0.018, 0.001),)),
    )
    found = identify(posterior, *found_for(posterior))
    assert found.untouched == ("friction.shear_strength",)
    assert not found.indistinct


def test_an_emulator_interpolates_and_knows_how_well() -> None:
    """A smooth function of two inputs, predicted from 32 places; its errors are as large as it says."""
    random = np.random.default_rng(0)
    places = random.uniform(-1.7, 1.7, (32, 2))
    x = np.linspace(0.1, 1.0, 20)

    def course(at: np.ndarray) -> np.ndarray:
        return np.exp(0.4 * at[:, :1] + 0.2 * np.sin(1.5 * at[:, 1:]) * x) * x

    emulator = Emulator(places, course(places))
    assert emulator.logarithmic
    assert emulator.error < 0.01
    new = random.uniform(-1.5, 1.5, (200, 2))
    weights, variances = emulator.weights(new)
    off = np.log(course(new)) - emulator.mean - weights @ emulator.shapes
    assert np.sqrt(np.mean(off**2)) < 0.01
    sizes = np.sqrt(np.maximum(variances @ emulator.shapes**2, 1e-20))
    assert 0.2 < np.sqrt(np.mean((off / sizes) ** 2)) < 2.0


def test_an_emulator_that_is_off_is_refused() -> None:
    """Values that do not follow from the inputs cannot be predicted from each other."""
    study = smooth_study()
    asked = unknowns_of(study, {"contact.hardness": "uniform 300 .. 900 MPa"})
    random = np.random.default_rng(1)
    distance = np.geomspace(1.0, 2400.0, 50)
    rows = tuple(
        Row(
            "done",
            courses={
                "distance": distance,
                "area_contact": np.full(50, float(np.exp(random.standard_normal()))),
            },
        )
        for _ in range(16)
    )
    runs = Runs(study, tuple(asked), random.standard_normal((16, 1)), rows, True)
    with pytest.raises(InputError, match="the emulator of the area is off by"):
        Model(study, tuple(asked), runs)


def test_the_next_test_is_that_of_a_linear_problem(linear: Data) -> None:
    """The expected variance of a linear problem is exact: that of all data together."""
    study = smooth_study()
    posterior = posterior_of(study, NORMAL, linear)
    values, _ = found_for(posterior)
    tests = best_tests(
        posterior,
        values,
        "friction.shear_strength",
        [Candidate({}), Candidate({}, 3)],
        lambda s: posterior.model,
    )
    _, one = exact(linear)
    prior = np.diag([0.02**-2.0, 0.3**-2.0])
    information = np.linalg.inv(one) - prior
    for test in tests:
        after = np.linalg.inv(prior + (1 + test.repeats) * information)
        assert test.expected / test.now == pytest.approx(np.sqrt(after[1, 1] / one[1, 1]), rel=1e-3)
    assert [test.repeats for test in tests] == [3, 1]


def test_repeats_that_reach_ten_percent() -> None:
    """A volume known to 30 % needs nine tests in all; a wear coefficient that none tells is never reached."""
    study = smooth_study()
    data = Data(values=(Measured("volume_sphere", 0.018, 0.0054),))
    wide = {"wear.sphere": "uniform 0 .. 5e-3 mm^3/N/m", "wear.disc": None}
    posterior = posterior_of(study, wide, data)
    values, _ = found_for(posterior)
    assert repeats_needed(posterior, values, "wear.sphere") in (7, 8, 9)
    assert repeats_needed(posterior, values, "wear.disc") is None


def test_samples_that_do_not_converge_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("warpwear.inference.sampler.MOST_STEPS", 500)
    with pytest.raises(ConvergenceError, match="did not converge within 500 steps"):
        sample(lambda z: -0.5 * np.sum(z**2, axis=1), 12, seed=0)
    apart = np.random.default_rng(0).standard_normal((2, 400, 8, 1))
    assert split_r(apart)[0] < 1.01
    apart[1] += 1.0
    assert split_r(apart)[0] > 1.1


def test_a_seed_gives_the_same_samples() -> None:
    def density(z: np.ndarray) -> np.ndarray:
        return np.asarray(-0.5 * np.sum(z**2, axis=1))

    first, second = (sample(density, 2, seed=5).z for _ in range(2))
    np.testing.assert_array_equal(first, second)


def result_of(posterior: Posterior) -> Inference:
    """An inference without its runs."""
    samples = weighed(posterior)
    values, z = posterior.complete(samples.z, np.random.default_rng(0))
    conflicts = tuple(conflicts_of(posterior, values))
    return Inference(
        posterior=posterior,
        samples=samples,
        values=values,
        z=z,
        identified=identify(posterior, values, z),
        conflicts=conflicts,
        target=None,
        tests=(),
        repeats={},
        seed=0,
    )


def test_the_calibrated_study_is_ready_for_a_sweep(tmp_path: Path) -> None:
    """Unknowns that go together are drawn together, others by distributions."""
    study = smooth_study()
    volumes = Data(values=(Measured("volume_sphere", 0.018, 0.0005), Measured("volume_disc", 0.024, 0.0005)))
    asked: dict[str, str | None] = {"wear.sphere": None, "wear.disc": None}
    for data, design, runs in (
        (volumes, "sobol", 64),
        (Data(values=(Measured("diameter", 1.26, 0.02),)), "zip", 64),
    ):
        path = tmp_path / f"{design}.toml"
        path.write_text(calibrated(result_of(posterior_of(study, asked, data))), encoding="utf-8")
        plan = read_plan(path, {}, {}, device="cpu")
        assert plan.design.kind == design
        assert len(plan.points) == runs
        sums = [sum(point.study.wear_coefficients) for point in plan.points if point.study]
        assert np.std(sums) / np.mean(sums) < 0.10


def test_data_that_a_study_cannot_bring_together_are_named() -> None:
    """The disc's volume asks for a scar of 1.1 mm at rest, and 0.80 mm was measured."""
    data = Data(values=(Measured("diameter", 0.80, 0.02), Measured("volume_disc", 0.0244, 0.001)))
    asked: dict[str, str | None] = {
        "wear.sphere": "log-uniform 1e-5 .. 9e-4 mm^3/N/m",
        "wear.disc": "log-uniform 1e-4 .. 3e-3 mm^3/N/m",
    }
    found = result_of(posterior_of(smooth_study(), asked, data))
    assert any("cannot bring all data together" in sentence for sentence in found.conflicts)
    assert "cannot bring all data together" in str(found)
    (why,) = (sentence for sentence in found.conflicts if sentence.startswith("The reason"))
    # a volume V at rest is a paraboloid's of the diameter d, V = π d⁴/(64 R)
    size = (64.0 * smooth_study().sphere.radius * 0.0244 / np.pi) ** 0.25
    assert f"0.0244 mm³, makes one of {size:.2f} mm or more, and measured is 0.80 mm" in why
    assert "So either a measurement or the study is wrong" in str(found)
    assert "2 unknowns for 2 measured values" in str(found)
    assert "<table>" in found._repr_html_()


STRENGTH = {"friction.shear_strength": "log-uniform 1 .. 20 MPa"}


@pytest.mark.parametrize(
    ("measured", "sentence"),
    [
        ({"diameter": "2.2 +- 0.1 mm"}, "the scar is larger than the field of the study, 1.5 mm"),
        ({"volume_disc": "-0.01 +- 0.001 mm^3"}, "must be greater than 0"),
        ({"volume_disc": "0.01 mm^3"}, "a value with its standard uncertainty is expected"),
        ({"volume_disc": "0.01 +- 0 mm^3"}, "the uncertainty must be greater than 0"),
        ({"volume_disc": "0.01 +- 0.001 mm"}, "volume_disc = '0.01 \\+- 0.001 mm': it"),
        ({"cof": "60 +- 1"}, "as if in percent"),
        ({"cof": "0.6 +- 0.01 at 9000 mm"}, "the study slides 2400 mm"),
        ({"weight": "3 +- 1 mm"}, "nothing that can be measured here"),
        ({}, "nothing was measured"),
    ],
)
def test_wrong_data_end_in_one_sentence(measured: dict[str, str], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        warpwear.infer(smooth_study(), unknown=STRENGTH, measured=measured)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "Distance [mm],CoF\n" + "".join(f"{100 * n},{20 + n}\n" for n in range(1, 20)),
            "as if in percent: 20 instead of 0.20",
        ),
        (
            "Distance [mm],CoF,Normal force [N]\n" + "".join(f"{100 * n},0.3,4.1\n" for n in range(1, 20)),
            "the normal force is 4.1 N",
        ),
        (
            "Distance [mm],Temperature [C]\n" + "".join(f"{100 * n},20\n" for n in range(1, 20)),
            "no column for the coefficient",
        ),
        (
            "Distance [mm],CoF\n" + "".join(f"{5000 + n},0.3\n" for n in range(1, 20)),
            "has 0 points from 0 to 2400 mm",
        ),
    ],
)
def test_a_wrong_course_ends_in_one_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "test.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=sentence):
        warpwear.infer(smooth_study(), unknown=STRENGTH, experiments=[path])


@pytest.mark.parametrize(
    ("unknown", "sentence"),
    [
        ({}, "no unknown is named"),
        ({"wear.spere": None}, "wear.spere"),
        ({"contact.law": None}, "it is no number"),
        ({"wear.sphere": "normal 1 +- 0.1 mm"}, "has the unit mm"),
        ({"wear.sphere": "normal 1 +- 0.1"}, "needs its unit"),
        ({"wear.sphere": "between 1 and 2"}, "the prior of 'wear.sphere' = 'between 1 and 2'"),
        ({"wear.sphere": "uniform -1e-4 .. 1e-3 mm^3/N/m"}, "goes beyond what is allowed: from 0"),
        ({"friction.initial_ratio": "uniform 0.1 .. 1"}, "need each other"),
        ({"wear.decay": "uniform 0.1 .. 1 1/m"}, "belongs to 'exponential'"),
    ],
)
def test_wrong_unknowns_end_in_one_sentence(unknown: dict[str, str | None], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        warpwear.infer(smooth_study(), unknown=unknown, measured={"volume_sphere": "0.018 +- 0.001 mm^3"})


def test_priors_that_exclude_the_data_are_refused() -> None:
    data = Data(values=(Measured("volume_sphere", 0.18, 0.01),))
    posterior = posterior_of(smooth_study(), {"wear.sphere": "uniform 8e-4 .. 1e-3 mm^3/N/m"}, data)
    with pytest.raises(
        InputError,
        match=r"the priors exclude the data: .* 0\.0154 to 0\.0192 mm³, and measured is worn volume",
    ):
        check_priors(posterior, seed=0)
    course = Data((replace(course_like(smooth_study()), cof=np.full(40, 1.8)),))
    posterior = posterior_of(smooth_study(), {"friction.shear_strength": "uniform 2 .. 3 MPa"}, course)
    with pytest.raises(InputError, match="the priors exclude the data"):
        check_priors(posterior, seed=0)


def test_repeats_that_scatter_widen_their_uncertainty() -> None:
    data = data_of(smooth_study(), [], {"volume_disc": ["0.020 +- 0.001 mm^3", "0.028 +- 0.001 mm^3"]})
    assert [value.error for value in data.values] == pytest.approx([0.001 * 32**0.5] * 2)
    assert "scatter 5.7 times as much" in data.notes[0]


def test_a_course_is_thinned_by_means() -> None:
    distance = np.linspace(1.0, 2400.0, 5000)
    data = data_of(smooth_study(), [Experiment("long", distance, 0.3 + 1e-4 * distance)], {})
    (course,) = data.courses
    assert course.distance.size == 100
    np.testing.assert_allclose(course.cof, 0.3 + 1e-4 * course.distance)


def test_priors_have_their_quantiles() -> None:
    """z of an unknown is standard normal before the data, and `normal` is its inverse."""
    asked = {
        "wear.sphere": "log-normal 9e-4 +- 2e-4 mm^3/N/m",
        "wear.disc": "log-uniform 1e-4 .. 1e-3 mm^3/N/m",
        "friction.ploughing": "normal 0.02 +- 0.02",
        "friction.shear_strength": "uniform 1 .. 5 MPa",
    }
    unknowns = unknowns_of(smooth_study(), asked)
    z = np.random.default_rng(0).standard_normal(200_000)
    first = unknowns[0].values(z)
    assert first.mean() == pytest.approx(9e-4, rel=0.01)
    assert first.std() == pytest.approx(2e-4, rel=0.02)
    cut = unknowns[2]
    assert not cut.is_normal
    assert cut.values(z).min() >= 0.0
    for unknown in unknowns:
        np.testing.assert_allclose(unknown.normal(unknown.values(z[:1000])), z[:1000], atol=1e-6)


@pytest.mark.slow
def test_ranks_of_the_truth_are_even(tmp_path: Path) -> None:
    """Eight tests of `python bench/cases/inference.py --case rest`: no rank is beyond chance.

    Of eight intervals of 90 % fewer than four hold the truth with a probability of 4e-4, and the distance of
    ranks from even ones is Kolmogorov's.
    """
    bench = runpy.run_path(str(Path(__file__).parents[2] / "bench" / "cases" / "inference.py"))
    case = bench["case_of"]("rest", tmp_path)
    found = [bench["one"](case, number) for number in range(8)]
    for key in found[0]["ranks"]:
        ranks = np.array([one["ranks"][key] + 0.5 for one in found]) / (bench["AMONG"] + 1)
        assert stats.kstest(ranks, "uniform").pvalue > 1e-3 / len(found[0]["ranks"]), key
        assert sum(one["inside"][key] for one in found) >= 4, key


def test_closed_form_has_no_steps(linear: Data) -> None:
    posterior = posterior_of(smooth_study(), NORMAL, linear)
    samples: Samples = sample(posterior.log_density, 0, seed=0)
    assert samples.steps == 0
    assert samples.z.shape[1] == 0


@pytest.mark.parametrize(
    ("section", "sentence"),
    [
        ("infer = 3", "[infer] is a section, and 3 is none"),
        ("[infer]\nmeasured = 'x'", "[infer.measured] is a section, and 'x' is none"),
        ("[infer]\nmesured = {}", "infer.mesured is not known; allowed: unknown, measured, experiments"),
        ("[infer]\nexperiments = 'a.csv'", "infer.experiments = 'a.csv' is not allowed: a list such as"),
        ("[infer]\ntarget = 3", "infer.target = 3 is not allowed: text in quotes is expected"),
        ("[infer.measured]\ndiameter = 0.8", "infer.measured.diameter = 0.8 is not allowed: text in quotes"),
        ("[infer.measured]\nweight = '3 +- 1 mm'", "infer.measured.weight is nothing that can be measured"),
        ("[infer.unknown]\nwear.sphere = 3", "infer.unknown.wear.sphere = 3: a prior such as"),
    ],
)
def test_a_wrong_section_is_one_sentence(tmp_path: Path, section: str, sentence: str) -> None:
    study = smooth_study().to_toml()
    path = tmp_path / "study.toml"
    path.write_text(f"{section}\n{study}" if section.startswith("infer") else f"{study}\n{section}\n")
    assert sentence in refused(path)


def refused(study: Path | str, *more: str) -> str:
    """The sentence that the command ends in."""
    done = CliRunner().invoke(bayes, [str(study), *more])
    assert isinstance(done.exception, InputError), done.output
    assert "\n" not in str(done.exception)
    return str(done.exception)


def test_wrong_data_end_the_command_in_one_sentence(tmp_path: Path) -> None:
    """A course in percent, a load that is off, a scar larger than the field."""
    given = ("v1", "--set", "stepping.scheme=implicit", "--unknown")
    given = (*given, "friction.shear_strength=log-uniform 1 .. 20 MPa")
    percent, heavy = tmp_path / "percent.csv", tmp_path / "heavy.csv"
    percent.write_text("Distance [mm],CoF [%]\n" + "".join(f"{100 * n},{20 + n}\n" for n in range(1, 20)))
    heavy.write_text("Distance [mm],CoF,Fn [N]\n" + "".join(f"{100 * n},0.3,10\n" for n in range(1, 20)))
    assert "as if in percent: 20 instead of 0.20" in refused(*given, "--experiment", str(percent))
    assert "the normal force is 10 N in the middle, the study has contact.load = 8 N" in refused(
        *given, "--experiment", str(heavy)
    )
    assert "the scar is larger than the field of the study, 1.5 mm" in refused(
        *given, "--diameter", "1.8 +- 0.02 mm"
    )
