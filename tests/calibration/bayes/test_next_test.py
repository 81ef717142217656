"""What an inference leads to: the next test, how many repeats, and a calibrated study."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cases_inference import NORMAL, exact, found_for, posterior_of, result_of, smooth_study

import warpwear
from warpwear import InputError
from warpwear.batches import batch
from warpwear.batches.plan import read_plan
from warpwear.calibration.bayes import infer as inferring
from warpwear.calibration.bayes.data import Data, MeasuredValue
from warpwear.calibration.bayes.next_test import Candidate, best_tests, repeats_needed
from warpwear.calibration.bayes.result import calibrated


def test_the_next_test_is_that_of_a_linear_problem(linear: Data) -> None:
    """The expected variance of a linear problem is exact: that of all data together."""
    study = smooth_study()
    posterior = posterior_of(study, NORMAL, linear)
    values, _ = found_for(posterior)
    candidates = [Candidate({}), Candidate({}, 3)]
    tests = best_tests(posterior, values, "friction.shear_strength", candidates)
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
    data = Data(values=(MeasuredValue("volume_counter", 0.018, 0.0054),))
    wide = {"wear.counter": "uniform 0 .. 5e-3 mm^3/N/m", "wear.disc": None}
    posterior = posterior_of(study, wide, data)
    values, _ = found_for(posterior)
    assert repeats_needed(posterior, values, "wear.counter") in (7, 8, 9)
    assert repeats_needed(posterior, values, "wear.disc") is None


@pytest.mark.parametrize("error", [0.006, 0.0045])
def test_more_tests_leave_what_simulated_ones_leave(error: float) -> None:
    """Tests to come, drawn from the posterior and weighed by Bayes' rule: one measure says what each leaves,
    and how many reach ± 10 % (46 for 17 where the mean variance was that of the prior's normal number)."""
    study = smooth_study(**{"wear.disc": "0 mm^3/N/m"})
    data = Data(values=(MeasuredValue("volume_counter", 0.018, error),))
    posterior = posterior_of(study, {"wear.counter": None}, data)
    values, _ = found_for(posterior)
    k, random = values["wear.counter"], np.random.default_rng(1)
    volumes = posterior.model.value(values, "volume_counter")[0]

    def left(repeats: int) -> float:
        truth = volumes[random.integers(0, k.size, 400)]
        means = truth + error / repeats**0.5 * random.standard_normal(truth.size)
        weights = np.exp(-0.5 * repeats * ((means[:, None] - volumes) / error) ** 2)
        weights /= weights.sum(axis=1, keepdims=True)
        return float(np.sqrt(np.mean(weights @ k**2 - (weights @ k) ** 2)) / k.mean())

    tests = best_tests(posterior, values, "wear.counter", [Candidate({}, n) for n in (1, 5, 20)])
    for test in tests:
        assert test.expected == pytest.approx(left(test.repeats), rel=0.1)
    needed = repeats_needed(posterior, values, "wear.counter")
    assert needed == pytest.approx(next(n for n in range(1, 101) if left(n) <= 0.10), abs=4)


def test_the_calibrated_study_is_ready_for_a_sweep(tmp_path: Path) -> None:
    """Unknowns that go together are drawn together, others by distributions."""
    study = smooth_study()
    volumes = Data(
        values=(MeasuredValue("volume_counter", 0.018, 0.0005), MeasuredValue("volume_disc", 0.024, 0.0005))
    )
    asked: dict[str, str | None] = {"wear.counter": None, "wear.disc": None}
    for data, design, runs in (
        (volumes, "sobol", 64),
        (Data(values=(MeasuredValue("scar", 1.26, 0.02),)), "zip", 64),
    ):
        path = tmp_path / f"{design}.toml"
        path.write_text(calibrated(result_of(posterior_of(study, asked, data))), encoding="utf-8")
        plan = read_plan(path, {}, {}, device="cpu")
        assert plan.design.kind == design
        assert len(plan.points) == runs
        sums = [sum(point.study.wear_coefficients) for point in plan.points if point.study]
        assert np.std(sums) / np.mean(sums) < 0.10


@pytest.mark.slow
def test_another_test_whose_scar_is_larger_is_computed_on_a_wider_field(tmp_path: Path) -> None:
    """Twice the load or radius makes a scar 2^¼ as large: the scar tells the sum of both wears as
    well or better, its error and a cell's rounding being a smaller part of it."""
    study = smooth_study(**{"wear.disc": "0 mm^3/N/m"})
    tests = ("contact.load=16 N", "counter.radius=6 mm")
    inference = warpwear.infer(
        study,
        unknown={"wear.counter": "log-uniform 4e-4 .. 1e-2 mm^3/N/m"},
        tests=[{"scar": "1.28 +- 0.03 mm"}],
        target="wear.counter",
        candidates=(*tests, "repeats=1"),
        out=tmp_path / "out",
    )
    assert len(inference.tests) == 3
    assert inference.tests[-1].label == "the same test again"
    # by the scar d = (…K)^¼ u(K)/K = 4 u(d)/d: the information of one more is 2^½ of what it was
    for test in inference.tests[:2]:
        assert test.expected / test.now == pytest.approx((1.0 + 2.0**0.5) ** -0.5, abs=0.02)
        assert "(grid.extent 1." in test.label


@pytest.mark.slow
def test_tests_are_tried_before_anything_is_sampled(
    tmp_path: Path, watch: Callable[..., None], failing: Callable[[str, Exception], None]
) -> None:
    """A test that equals the study is the study's own; one that cannot be made ends before samples; and
    samples are written before anything else may fail."""
    sampled: list[object] = []
    calls: list[str] = []
    watch(inferring, "sample", lambda *given, **_: sampled.append(given))
    watch(batch, "run_one", lambda task: calls.append(task.folder))

    def infer(candidate: str, target: str = "wear.counter") -> warpwear.Inference:
        return warpwear.infer(
            smooth_study(**{"sliding.distance": "100 mm"}),
            unknown="wear.counter",  # one stands for a list of one
            tests=[{"volume_counter": "0.00075 +- 0.00003 mm^3"}],
            target=target,
            candidates=candidate,
            out=tmp_path / candidate,
        )

    with pytest.raises(InputError, match="is no unknown"):
        infer("repeats=2", "wear.disc")
    with pytest.raises(InputError, match=r"contact\.load"):
        infer("contact.load=16 m")
    with pytest.raises(InputError, match=r"the scar of the next test contact\.load = 1e6 N is larger than"):
        infer("contact.load=1e6 N")
    assert not sampled
    calls.clear()
    inference = infer("contact.load=8.0 N, repeats=3")
    assert re.fullmatch(
        r"<inference of '.*': wear.counter = 0.0009\d+ ± 3.\de-05 mm³/\(N·m\)>", repr(inference)
    )
    (same,) = inference.tests
    assert "3 tests" in str(inference)  # what the ranks do not say: what each costs
    assert len({*calls}) == 1  # no run but that of the study
    assert same.repeats == 3
    failing("warpwear.calibration.bayes.next_test.best_tests", ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        infer("contact.load=4 N")
    assert (tmp_path / "contact.load=4 N" / "posterior.csv").is_file()
