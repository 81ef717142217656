"""Simulation-based calibration of `warpwear.infer`: known parameters, synthetic tests, ranks of the truth.

    python bench/cases/inference.py --tests 200 --jobs 16

Parameters are drawn from their priors, a test is simulated with them, and the posterior of it is sampled.
Ranks of the truth among the samples are then even (Talts and others, arXiv 1804.06788), and 90 % of the
intervals of 90 % hold it. Seeds are fixed: test n has the seed 1000 + n.
"""

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import stats

TOP = Path(__file__).parents[2]
sys.path[:0] = [str(TOP), str(TOP / "tests" / "inference")]

from cases_inference import course_like, posterior_of, smooth_study  # noqa: E402

from warpwear.errors import ConvergenceError  # noqa: E402
from warpwear.grid import FloatArray  # noqa: E402
from warpwear.inference.data import Data, Measured  # noqa: E402
from warpwear.inference.likelihood import simulate  # noqa: E402
from warpwear.inference.sampler import sample  # noqa: E402

#: Unknowns and their priors: a linear one in closed form, a linear one that is sampled, and the wear of both
#: bodies.
UNKNOWN: dict[str, str | None] = {
    "wear.sphere": "log-normal 9.4e-4 +- 3e-4 mm^3/N/m",
    "wear.disc": "uniform 6e-4 .. 20e-4 mm^3/N/m",
    "friction.shear_strength": "log-uniform 1.5 .. 8 MPa",
    "friction.ploughing": "normal 0.2 +- 0.02",
    "noise.deviation": "log-uniform 0.004 .. 0.05",
    "noise.length": "log-uniform 20 .. 600 mm",
    "noise.repeat": "log-uniform 0.003 .. 0.06",
}
#: Ranks that a histogram has, and samples that a rank is among.
BINS, AMONG = 10, 199
FIRST_SEED = 1000


def one(number: int) -> tuple[list[str], FloatArray, FloatArray]:
    """Make a test and infer from it: names, ranks of the truth, whether 90 % intervals hold it."""
    random = np.random.default_rng(FIRST_SEED + number)
    study = smooth_study()
    courses = (course_like(study), course_like(study))
    values = (Measured("volume_disc", 1.0, 0.0015), Measured("diameter", 1.0, 0.02))
    like = Data(courses, (Measured("cof", 0.5, 0.02, study.sliding.total),), values)
    posterior = posterior_of(study, UNKNOWN, like)
    z = random.standard_normal((1, len(posterior.unknowns)))
    truth = {u.key: u.values(z[:, place]) for place, u in enumerate(posterior.unknowns)}
    cof, measured = simulate(posterior.model, truth, like, random)
    ends = np.cumsum([0, *(course.distance.size for course in courses)])
    drawn = [replace(c, cof=cof[0, a:b]) for c, a, b in zip(courses, ends[:-1], ends[1:], strict=True)]
    data = Data(
        tuple(drawn),
        (replace(like.points[0], value=float(cof[0, -1])),),
        tuple(replace(v, value=float(m[0])) for v, m in zip(values, measured, strict=True)),
    )
    posterior = posterior_of(study, UNKNOWN, data)
    samples = sample(posterior.log_density, len(posterior.sampled), seed=FIRST_SEED + number)
    found, _ = posterior.complete(samples.z, random)
    names = list(found)
    some = random.choice(len(samples.z), AMONG, replace=False)
    ranks = np.array([int(np.sum(found[name][some] < truth[name][0])) for name in names])
    bounds = [np.percentile(found[name], (5.0, 95.0)) for name in names]
    inside = np.array(
        [low <= truth[name][0] <= high for name, (low, high) in zip(names, bounds, strict=True)]
    )
    return names, ranks, inside


def attempt(number: int) -> tuple[list[str], FloatArray, FloatArray] | str:
    """Make a test, or say why there is no posterior."""
    try:
        return one(number)
    except ConvergenceError as error:
        return f"test {number}: {error}"


def calibration(tests: int, jobs: int) -> tuple[dict[str, tuple[float, float]], list[str]]:
    """Name -> χ² probability of even ranks, and part of 90 % intervals that hold the truth; and failures."""
    if jobs > 1:
        with ProcessPoolExecutor(jobs) as pool:
            found = list(pool.map(attempt, range(tests)))
    else:
        found = [attempt(number) for number in range(tests)]
    failed = [one for one in found if isinstance(one, str)]
    done = [one for one in found if not isinstance(one, str)]
    ranks, inside = np.array([r for _, r, _ in done]), np.array([i for _, _, i in done])
    table = {}
    for place, name in enumerate(done[0][0]):
        counts = np.bincount(ranks[:, place] * BINS // (AMONG + 1), minlength=BINS)
        table[name] = (float(stats.chisquare(counts).pvalue), float(inside[:, place].mean()))
    return table, failed


def main() -> None:
    """Print the table, and end with 1 where ranks are not even or intervals hold too few or many truths."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tests", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=1)
    asked = parser.parse_args()
    start = time.perf_counter()
    table, failed = calibration(asked.tests, asked.jobs)
    print(f"{asked.tests} tests, {len(failed)} without a posterior, {time.perf_counter() - start:.0f} s")
    print(f"{'unknown':<26}{'χ² p':>8}{'in 90 %':>9}")
    for name, (p, part) in table.items():
        print(f"{name:<26}{p:8.3f}{100 * part:8.1f} %")
    print("\n".join(failed))
    smallest, parts = min(p for p, _ in table.values()), [part for _, part in table.values()]
    good = not failed and smallest > 0.01 / len(table) and min(parts) >= 0.83 and max(parts) <= 0.97
    print(
        f"smallest p {smallest:.4f}, has to exceed {0.01 / len(table):.4f}; intervals have to hold 83 to "
        f"97 %: {'good' if good else 'BAD'}"
    )
    sys.exit(not good)


if __name__ == "__main__":
    main()
