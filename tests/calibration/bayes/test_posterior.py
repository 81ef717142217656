"""The posterior against closed forms: what is integrated out, residuals that go together, the sampler."""

import numpy as np
import pytest
from cases_inference import NORMAL, course_like, drawn, exact, posterior_of, smooth_study

from warpwear import ConvergenceError
from warpwear.calibration.bayes.data import Data
from warpwear.calibration.bayes.likelihood import INDEPENDENT, _innovations
from warpwear.calibration.bayes.sampler import Samples, sample, split_r

pytest.importorskip("emcee")


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


def test_closed_form_has_no_steps(linear: Data) -> None:
    posterior = posterior_of(smooth_study(), NORMAL, linear)
    samples: Samples = sample(posterior.log_density, 0, seed=0)
    assert samples.steps == 0
    assert samples.z.shape[1] == 0


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


def test_samples_that_do_not_converge_are_an_error() -> None:
    with pytest.raises(ConvergenceError, match="did not converge within 100 steps"):
        sample(lambda z: -0.5 * np.sum(z**2, axis=1), 12, seed=0, most=100)
    apart = np.random.default_rng(0).standard_normal((2, 400, 8, 1))
    assert split_r(apart)[0] < 1.01
    apart[1] += 1.0
    assert split_r(apart)[0] > 1.1


def test_a_seed_gives_the_same_samples() -> None:
    def density(z: np.ndarray) -> np.ndarray:
        return np.asarray(-0.5 * np.sum(z**2, axis=1))

    first, second = (sample(density, 2, seed=5).z for _ in range(2))
    np.testing.assert_array_equal(first, second)
