"""What an inference leads to: the next test, how many repeats, and a calibrated study."""

from pathlib import Path

import numpy as np
import pytest
from cases_inference import NORMAL, exact, found_for, posterior_of, result_of, smooth_study

from warpwear.inference.data import Data, Measured
from warpwear.inference.next_test import Candidate, best_tests, repeats_needed
from warpwear.inference.report import calibrated
from warpwear.sweeps.plan import read_plan


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
