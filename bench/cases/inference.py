"""Simulation-based calibration of `warpwear.infer`: known parameters, synthetic tests, ranks of the truth.

    python bench/cases/inference.py --jobs 16 --limit 240 --out ranks.jsonl
    python bench/cases/inference.py --summary ranks.jsonl [more.jsonl ...]

Parameters are drawn from their priors, the study is run with them, a test of it is simulated with scatter,
and the posterior is sampled as `warpwear.infer` does: with its runs, emulators, likelihood and sampler. Ranks
of the truth among the samples are then even (Talts and others, arXiv 1804.06788), and 90 % of the intervals
of 90 % hold it. There are two cases: `rest`, where one run serves all wear coefficients, and `track`, where a
design of runs is emulated. Every test is a line of the file and is not done again, so that a run that was
stopped goes on, and shards (`--from 0 --to 100` and `--from 100 --to 200`) may be added up. Seeds are fixed:
test n has the seed 1000 + n.
"""

import argparse
import json
import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import numpy as np  # noqa: E402
from scipy import stats  # noqa: E402

TOP = Path(__file__).parents[2]
sys.path[:0] = [str(TOP), str(TOP / "tests" / "calibration" / "bayes")]

from cases_inference import course_like, simulate  # noqa: E402

from warpwear import Study  # noqa: E402
from warpwear.calibration.bayes.data import Data, MeasuredValue  # noqa: E402
from warpwear.calibration.bayes.infer import check_priors, noise_for  # noqa: E402
from warpwear.calibration.bayes.likelihood import Posterior  # noqa: E402
from warpwear.calibration.bayes.model import ForwardModel  # noqa: E402
from warpwear.calibration.bayes.runs import Runs, make_runs  # noqa: E402
from warpwear.calibration.bayes.sampler import sample  # noqa: E402
from warpwear.calibration.bayes.unknowns import unknowns_of  # noqa: E402
from warpwear.errors import ConvergenceError, InputError  # noqa: E402

#: Ranks that a histogram has, and samples that a rank is among.
BINS, AMONG = 10, 199
FIRST_SEED = 1000
#: A case has a preset, what differs from it, and priors: of linear unknowns in closed form and sampled, of
#: wear and hardness, and of the scatter.
NOISE = {"noise.deviation": "log-uniform 0.004 .. 0.05", "noise.repeat": "log-uniform 0.003 .. 0.06"}
CASES: dict[str, tuple[str, dict[str, Any], dict[str, str | None]]] = {
    "rest": (
        "v1",
        {"stepping.scheme": "implicit", "grid.cell": "20 um", "grid.extent": "1.8 mm"},
        {
            "wear.counter": "log-normal 9.4e-4 +- 3e-4 mm^3/N/m",
            "wear.disc": "uniform 6e-4 .. 20e-4 mm^3/N/m",
            "friction.shear_strength": "log-uniform 1.5 .. 8 MPa",
            "friction.ploughing": "normal 0.2 +- 0.02",
            "noise.length": "log-uniform 20 .. 600 mm",
            **NOISE,
        },
    ),
    "track": (
        "track",
        {
            "grid.cell": "20 um",
            "grid.extent": "1.6 mm",
            "disc.synthetic.cut_off": "80 um",
            "disc.synthetic.roll_off": "300 um",
            "disc.synthetic.period": "1.6 mm",
            "sliding.track": "1.6 mm",
            "sliding.shift": 1,
            "sliding.distance": "600 mm",
        },
        {
            "wear.counter": "log-uniform 5e-4 .. 20e-4 mm^3/N/m",
            "contact.hardness": "log-uniform 400 .. 900 MPa",
            "friction.shear_strength": "log-uniform 100 .. 300 MPa",
            "friction.ploughing": "normal 0.2 +- 0.02",
            "noise.length": "log-uniform 10 .. 150 mm",
            **NOISE,
        },
    ),
}


@dataclass(frozen=True, eq=False)
class Case:
    """A study with its unknowns, their priors, and the runs that an inference stands on."""

    name: str
    study: Study
    unknown: dict[str, str | None]
    runs: Runs

    @property
    def like(self) -> Data:
        """What a test measures: two courses, a coefficient, a volume and a diameter; values are drawn."""
        volume = MeasuredValue("volume_disc" if self.name == "rest" else "volume_counter", 1.0, 0.0015)
        values = (volume, MeasuredValue("scar", 1.0, 0.02))
        end = MeasuredValue("friction", 0.5, 0.02, self.study.sliding.total)
        return Data((course_like(self.study), course_like(self.study)), (end,), values)

    def posterior(self, data: Data, study: Study | None = None, runs: Runs | None = None) -> Posterior:
        """The posterior of data, by the case's runs or by others."""
        unknowns = tuple(unknowns_of(self.study, self.unknown))
        model = ForwardModel(study or self.study, unknowns, runs or self.runs, frozenset(data.kinds))
        return Posterior(model, tuple(noise_for(data, self.unknown)), data)


def case_of(name: str, folder: Path) -> Case:
    """Make the runs of a case, or find them in the folder."""
    preset, changes, unknown = CASES[name]
    study = Study.load(preset).replace({"output.snapshots": [], **changes})
    runs = make_runs(
        study, unknowns_of(study, unknown), samples=None, seed=0, out=folder / name, device="cpu"
    )
    return Case(name, study, unknown, runs)


def one(case: Case, number: int) -> dict[str, Any]:
    """Make a test and infer from it: ranks of the truth, whether 90 % intervals hold it, and what it took."""
    start = time.process_time()
    random = np.random.default_rng(FIRST_SEED + number)
    prior = case.posterior(case.like)
    z = random.standard_normal((1, len(prior.unknowns)))
    truth = {u.key: u.values(z[:, place]) for place, u in enumerate(prior.unknowns)}
    folder = Path(tempfile.mkdtemp(prefix="warpwear-calibration-"))
    try:
        # the runs of the case know nothing of this one
        changes = {
            u.key: f"{float(truth[u.key][0])!r} {u.unit}".rstrip()
            for u in prior.model.unknowns
            if not u.key.startswith("friction.")
        }
        study = case.study.replace(changes)
        computed = make_runs(
            study,
            unknowns_of(study, {"friction.shear_strength": None}),
            samples=None,
            seed=0,
            out=folder,
            device="cpu",
        )
        true = case.posterior(case.like, study, computed)
        cof, measured = simulate(true.model, truth, case.like, random)
        # of whole cells, as it was computed
        (row,) = computed.rows
        area = np.interp(case.like.distance, row.courses["distance"], row.courses["area_contact"])
        smooth = true.model.friction(truth, case.like.distance).terms["friction.shear_strength"][0]
        cof += truth["friction.shear_strength"][0] * (area / study.contact.load - smooth)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    like = case.like
    ends = np.cumsum([0, *(course.distance.size for course in like.courses)])
    courses = [replace(c, cof=cof[0, a:b]) for c, a, b in zip(like.courses, ends[:-1], ends[1:], strict=True)]
    values = [replace(v, value=float(m[0])) for v, m in zip(like.values, measured, strict=True)]
    point = replace(like.points[0], value=float(cof[0, -1]))
    posterior = case.posterior(Data(tuple(courses), (point,), tuple(values)))
    check_priors(posterior, seed=number)
    samples = sample(posterior.log_density, len(posterior.sampled), seed=FIRST_SEED + number)
    found, _ = posterior.complete(samples.z, random)
    some = random.choice(len(samples.z), AMONG, replace=False)
    ranks, inside, off = {}, {}, {}
    for key, column in found.items():
        low, high = np.percentile(column, (5.0, 95.0))
        ranks[key] = int(np.sum(column[some] < truth[key][0]))
        inside[key] = bool(low <= truth[key][0] <= high)
        off[key] = float((truth[key][0] - column.mean()) / column.std())
    return {
        "ranks": ranks,
        "inside": inside,
        "off": off,
        "steps": samples.steps,
        "time": samples.time,
        "effective": samples.effective,
        "seconds": time.process_time() - start,
    }


#: The case of a worker, made once and given to it.
_CASE: list[Case] = []


def _begin(case: Case) -> None:
    _CASE[:] = [case]


def attempt(number: int, seconds: int) -> dict[str, Any]:
    """Make a test of the worker's case, or say why there is no posterior. seconds: after which it is left."""

    def late(*_: object) -> None:
        raise TimeoutError(f"not done within {seconds} s")

    signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    told: dict[str, Any] = {"case": _CASE[0].name, "test": number}
    try:
        return told | one(_CASE[0], number)
    except (ConvergenceError, InputError, TimeoutError) as error:
        return told | {"failed": str(error)}
    finally:
        signal.alarm(0)


def attempts(case: Case, numbers: Iterable[int], jobs: int, until: float) -> Iterator[dict[str, Any]]:
    """Make tests by so many processes; begin none later than `until` (of `time.monotonic`)."""
    left = iter(numbers)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=_begin, initargs=(case,)) as pool:
        waiting: set[Future[dict[str, Any]]] = set()
        while True:
            while len(waiting) < jobs and time.monotonic() < until:
                number = next(left, None)
                if number is None:
                    break
                waiting.add(pool.submit(attempt, number, max(1, int(until - time.monotonic()) + 60)))
            if not waiting:
                return
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            yield from (future.result() for future in done)


def read(files: Sequence[Path]) -> list[dict[str, Any]]:
    """Read lines of files, of each test the last that came to an end."""
    lines = [json.loads(line) for file in files if file.exists() for line in file.read_text().splitlines()]
    found: dict[tuple[str, int], dict[str, Any]] = {}
    for line in lines:
        key = (line["case"], line["test"])
        if key not in found or "failed" in found[key]:
            found[key] = line
    return list(found.values())


def summary(lines: Sequence[dict[str, Any]]) -> tuple[str, bool]:
    """Write what the tests of one case say, and whether it is good: ranks even, intervals as they say."""
    done = [line for line in lines if "ranks" in line]
    failed = [f"test {line['test']}: {line['failed']}" for line in lines if "failed" in line]
    head = f"{lines[0]['case']}: {len(lines)} tests, {len(failed)} without a posterior"
    if not done:
        return "\n".join([head, *failed]), False
    each = [np.median([line[name] for line in done]) for name in ("seconds", "time", "effective")]
    text = [
        "{}; medians: {:.1f} s, autocorrelation time {:.1f} steps, {:.0f} independent samples".format(
            head, *each
        ),
        f"{'unknown':<26}{'χ² p':>8}{'in 90 %':>10}{'off by':>16}  histogram of ranks",
    ]
    even, parts = [], []
    for key in done[0]["ranks"]:
        ranks = np.array([line["ranks"][key] for line in done])
        counts = np.bincount(ranks * BINS // (AMONG + 1), minlength=BINS)
        even.append(float(stats.chisquare(counts).pvalue))
        parts.append(float(np.mean([line["inside"][key] for line in done])))
        off = np.array([line["off"][key] for line in done])
        scatter = f"{off.mean():+.2f} ± {off.std():.2f} sd"
        text.append(
            f"{key:<26}{even[-1]:8.3f}{100 * parts[-1]:8.1f} %{scatter:>16}  {' '.join(map(str, counts))}"
        )
    good = not failed and min(even) > 0.01 / len(even) and min(parts) >= 0.83 and max(parts) <= 0.97
    held = f"{100 * min(parts):.1f} to {100 * max(parts):.1f} %"
    text.append(
        f"smallest p {min(even):.4f}, has to exceed {0.01 / len(even):.4f}; intervals of 90 % hold {held}, "
        f"have to hold 83 to 97 %: {'good' if good else 'BAD'}"
    )
    return "\n".join([*text, *failed]), good


def main(arguments: Sequence[str] | None = None) -> None:
    """Make tests and print the summary; end with 1 where it is bad."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--summary", nargs="+", type=Path, metavar="FILE", help="only read these files")
    parser.add_argument("--case", nargs="+", default=list(CASES), choices=list(CASES))
    parser.add_argument("--from", dest="first", type=int, default=0, help="first test")
    parser.add_argument("--to", dest="last", type=int, default=200, help="one beyond the last test")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--limit", type=float, default=3600.0, help="seconds after which no test begins")
    parser.add_argument("--out", type=Path, default=Path("ranks.jsonl"), help="a line a test is added")
    asked = parser.parse_args(arguments)
    start = time.monotonic()
    if not asked.summary:
        there = {(line["case"], line["test"]) for line in read([asked.out]) if "ranks" in line}
        with tempfile.TemporaryDirectory() as folder, asked.out.open("a") as file:
            for name in asked.case:
                numbers = [n for n in range(asked.first, asked.last) if (name, n) not in there]
                if not numbers:
                    continue
                case = case_of(name, Path(folder))
                error = case.posterior(case.like).model.error
                took = time.monotonic() - start
                print(
                    f"{name}: {len(case.runs.rows)} runs in {took:.0f} s, emulator off by {100 * error:.1f} %"
                )
                for line in attempts(case, numbers, asked.jobs, start + asked.limit):
                    file.write(json.dumps(line) + "\n")
                    file.flush()
        print(f"{time.monotonic() - start:.0f} s")
    lines = read(asked.summary or [asked.out])
    told = [summary([x for x in lines if x["case"] == name]) for name in sorted({x["case"] for x in lines})]
    print("\n".join(text for text, _ in told))
    sys.exit(not all(good for _, good in told))


if __name__ == "__main__":
    main()
