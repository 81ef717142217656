"""Small tests of the laboratory that several test files infer from."""

from dataclasses import replace

import numpy as np

from warpwear import Study
from warpwear.batches.run_one import RunRow
from warpwear.calibration.bayes.data import Data, MeasuredCourse
from warpwear.calibration.bayes.identify import conflicts_of, identify
from warpwear.calibration.bayes.likelihood import Posterior
from warpwear.calibration.bayes.model import ForwardModel
from warpwear.calibration.bayes.result import Inference
from warpwear.calibration.bayes.runs import Runs
from warpwear.calibration.bayes.sampler import Samples
from warpwear.calibration.bayes.unknowns import noise_for, unknowns_of
from warpwear.grid import FloatArray

#: Wear that the course of `worn_paraboloid` goes to, as a multiple of the study's.
BEYOND = 12.0
#: Priors under which the coefficient of friction is a linear problem.
NORMAL = {"friction.ploughing": "normal 0.2 +- 0.02", "friction.shear_strength": "normal 3 +- 0.3 MPa"}


def smooth_study(**changes: str) -> Study:
    """The smooth ball at rest on coarse cells, with implicit steps: a run of it takes a moment."""
    return Study.load("v1").replace({"stepping.scheme": "implicit", "grid.cell": "20 um", **changes})


def worn_paraboloid(study: Study) -> Runs:
    """What a run of the smooth study comes to, in closed form: A = π a², a = (4 R (K_s + K_d) F L/π)^¼."""
    counter, disc = (BEYOND * k for k in study.wear_coefficients)
    texts = {"wear.counter": f"{1e3 * counter!r} mm^3/N/m", "wear.disc": f"{1e3 * disc!r} mm^3/N/m"}
    wide = study.replace({"grid.extent": "4 mm", **texts})
    distance = np.geomspace(1e-3, study.sliding.total, 200)
    assert study.counter.radius is not None
    a2 = np.sqrt(4.0 * study.counter.radius * (counter + disc) * study.contact.load * distance / np.pi)
    across = 2.0 * np.sqrt(a2)
    courses = {
        "distance": distance,
        "area_contact": np.pi * a2,
        "patch_along": across,
        "patch_across": across,
    }
    return Runs(wide, (), np.zeros((1, 0)), (RunRow("done", courses=courses),), True)


def posterior_of(
    study: Study, unknown: dict[str, str | None], data: Data, *, closed_form: bool = True
) -> Posterior:
    """The posterior of the smooth study in closed form, without a run."""
    unknowns = list(unknowns_of(study, unknown))
    model = ForwardModel(study, tuple(unknowns), worn_paraboloid(study), frozenset(data.kinds | {"scar"}))
    return Posterior(model, tuple(noise_for(data, unknown)), data, closed_form=closed_form)


def course_like(study: Study, *, points: int = 40, name: str = "test") -> MeasuredCourse:
    """Places of a course over the whole test; its coefficients are to be drawn."""
    distance = np.linspace(study.sliding.total / points, study.sliding.total, points)
    return MeasuredCourse(name, distance, np.zeros(points))


def found_for(
    posterior: Posterior, *, seed: int = 0, draws: int = 80_000
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Samples of a posterior by weighing many draws of the prior, apart from any sampler."""
    return posterior.complete(weighed(posterior, seed=seed, draws=draws).z, np.random.default_rng(seed))


def weighed(posterior: Posterior, *, seed: int = 0, draws: int = 80_000) -> Samples:
    """Draws of the prior by their likelihood."""
    random = np.random.default_rng(seed)
    z = random.standard_normal((draws if posterior.sampled else 4000, len(posterior.sampled)))
    logs = posterior.log_likelihood(z)
    weights = np.exp(logs - logs.max())
    return Samples(z[random.choice(len(z), 4000, p=weights / weights.sum())], 0, 1.0, 1.0, 4000.0)


def simulate(
    model: ForwardModel, values: dict[str, FloatArray], like: Data, random: np.random.Generator
) -> tuple[FloatArray, list[FloatArray]]:
    """Draw what a test would measure: coefficients (samples, points), and (samples,) a value of `like`."""
    samples = len(next(iter(values.values())))
    cof = model.cof(values, like.distance) if like.distance.size else np.zeros((samples, 0))
    if "noise.deviation" in values:
        for course, rows in zip(like.courses, like.rows, strict=True):
            noise = random.standard_normal((samples, course.distance.size))
            memory = np.exp(-np.diff(course.distance) / values["noise.length"][:, None])
            for place in range(1, course.distance.size):
                before = memory[:, place - 1]
                noise[:, place] = before * noise[:, place - 1] + np.sqrt(1.0 - before**2) * noise[:, place]
            level = values.get("noise.repeat", np.zeros(samples)) * random.standard_normal(samples)
            cof[:, rows] += values["noise.deviation"][:, None] * noise + level[:, None]
    if like.points:
        errors = np.array([point.error for point in like.points])
        cof[:, -len(like.points) :] += errors * random.standard_normal((samples, len(like.points)))
    drawn = []
    for measured in like.values:
        mean, variance = model.value(values, measured.kind)
        drawn.append(mean + np.sqrt(variance + measured.error**2) * random.standard_normal(samples))
    return cof, drawn


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
