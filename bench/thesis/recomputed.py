"""The runs behind the report of the thesis: which studies, and what is kept of them."""

import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import numpy as np
from coefficients import depth_of_rim, diameter_of_cap, rim_at

import warpwear
from warpwear import InputError, Result, Study, StudyWarning

#: Cell of the fine rough model in a quick report; it takes a tenth of the time.
QUICK_CELL = "5 um"
#: Results shown side by side: name in numbers and files -> name for people.
VERSIONS = {"v1": "V1", "v2": "V2", "v3": "V3", "fine": "V3 fine"}
#: Foundation of the smooth model that matches Hertz's area: stiffer, so that V1's increment is too large.
HERTZ_AREA = {"contact.bulk_stiffness": "area"}
#: Names of the other runs: of V1 by its increment [mm], and of V3 before the seed of its surface.
IMPLICIT, SURFACE = "V1 implicit, {:g} mm", "V3, surface "
#: Names for people of the runs whose own are short.
LABELS = VERSIONS | {
    "beyond": "V1, Hertz's area, explicit, forced",
    "steady": "V1, Hertz's area, implicit",
}


@dataclass(frozen=True)
class Plan:
    """Everything that is computed for one report."""

    studies: dict[str, Study]  # keys of VERSIONS
    increments: tuple[float, ...] = (0.3, 3.0, 30.0)  # of the smooth model, implicit [mm]
    seeds: tuple[int, ...] = tuple(range(1, 11))  # of the rough surface

    @property
    def runs(self) -> dict[str, Study]:
        """Every study by the name of its run in `Runs`, in the order of computing."""
        smooth, rough = self.studies["v1"], self.studies["v3"]
        step = smooth.stepping.increment
        own = rough.disc.synthetic.seed if rough.disc.synthetic else None
        implicit = {IMPLICIT.format(length): _implicit(smooth, length) for length in self.increments}
        beyond = smooth.replace(HERTZ_AREA | {"stepping.force": True})
        steady = _implicit(smooth, step).replace(HERTZ_AREA)
        seeds = [seed for seed in self.seeds if seed != own]
        others = {f"{SURFACE}{seed}": rough.replace({"disc.synthetic.seed": seed}) for seed in seeds}
        return self.studies | implicit | {"beyond": beyond, "steady": steady} | others


def published(*, quick: bool = False) -> Plan:
    """Plan runs of the presets as they are. quick: the fine one with cells of 5 µm."""
    fine = Study.load("v3-fine")
    if quick:
        fine = fine.replace({"grid.cell": QUICK_CELL})
    return Plan({"v1": Study.load("v1"), "v2": Study.load("v2"), "v3": Study.load("v3"), "fine": fine})


@dataclass(frozen=True)
class Runs:
    """Open results; closed with `running`."""

    plan: Plan
    results: dict[str, Result]  # by the names of `Plan.runs`
    refusal: str  # what the solver says when it is not forced beyond the limit of stability
    patches: tuple[dict[str, float], ...]  # see `rough_patch`

    def __getitem__(self, name: str) -> Result:
        return self.results[name]


@contextmanager
def running(plan: Plan, *, device: str, threads: int | None, quiet: bool = False) -> Iterator[Runs]:
    """Compute everything and give the open results; they are closed at the end.

    quiet: without a line a run on standard error.
    """
    results: dict[str, Result] = {}
    studies = plan.runs
    with ExitStack() as stack:
        for done, (name, study) in enumerate(studies.items(), 1):
            started = time.perf_counter()
            with warnings.catch_warnings(action="ignore", category=StudyWarning):  # the report tells of them
                result = warpwear.run(study, device=device, threads=threads, plots=False)
            results[name] = stack.enter_context(result)
            if not quiet:
                label, took = LABELS.get(name, name), time.perf_counter() - started
                line = f"report: run {done} of {len(studies)}, {label}: {took:.1f} s"
                print(line, file=sys.stderr, flush=True)
        rough = (results.get(f"{SURFACE}{seed}", results["v3"]) for seed in plan.seeds)
        patches = tuple(map(rough_patch, plan.seeds, rough))
        yield Runs(plan, results, _refusal(plan.studies["v1"]), patches)


def _implicit(study: Study, increment: float) -> Study:
    """Make a study implicit, with a fixed increment [mm]."""
    return study.replace({"stepping.scheme": "implicit", "stepping.increment": f"{increment!r} mm"})


def _refusal(smooth: Study) -> str:
    """Find the sentence that refuses V1 beyond the limit of stability; empty if it is not refused."""
    try:
        smooth.replace(HERTZ_AREA)
    except InputError as error:
        return str(error)
    return ""


def rough_patch(seed: int, result: Result) -> dict[str, float]:
    """Find the touched patch of a run on a surface of a seed, and what geometry says of it [mm].

    along, across: its extents; predicted_along, predicted_across: those of the surface cut by the
    counter-body that V1's patch belongs to; peak: highest point over the mean plane near the rim, R_p;
    bound: 2√(z(2R − z)), z = R − √(R² − a²) + R_p, both ends of a diameter on such a peak; farthest: twice
    the distance of the farthest touched cell from the middle; disc_volume [mm³].
    """
    study, history = result.study, result.history
    heights, radius = result.unworn_disc(result.x, result.y), study.counter.radius
    depth = depth_of_rim(worn_radius(study), radius=radius)
    square = np.add.outer(result.x**2, result.y**2)
    # A cell is touched where it stands above the counter-body through the smooth patch's rim.
    over_rim = result.unworn_counter(result.x, result.y) - depth
    along, across = (study.grid.cell * _length(np.any(heights >= over_rim, axis=axis)) for axis in (1, 0))
    near_rim = (over_rim >= 0.0) & (over_rim <= heights.max())
    peak = float(heights[near_rim].max()) if near_rim.any() else 0.0
    return {
        "seed": seed,
        "along": float(history["patch_along"][-1]),
        "across": float(history["patch_across"][-1]),
        "predicted_along": along,
        "predicted_across": across,
        "peak": peak,
        "bound": 2.0 * rim_at(depth + max(peak, 0.0), radius=radius),
        "farthest": 2.0 * float(np.sqrt(square[result.snapshot(-1).wear_counter > 0.0].max())),
        "disc_volume": float(history["wear_volume_disc"][-1]),
    }


def _length(touched: np.ndarray) -> int:
    """Count the places from the first touched one to the last."""
    places = np.flatnonzero(touched)
    return int(places[-1] - places[0] + 1) if places.size else 0


def worn_radius(study: Study) -> float:
    """Find the rim's radius [mm] of the patch of smooth bodies on a stationary footprint: a cap of K F L."""
    return 0.5 * diameter_of_cap(_worn_volume(study), radius=study.counter.radius)


def worn_radius_of_paraboloid(study: Study) -> float:
    """Find that radius with a paraboloid for the counter-body, (4 R K F L/π)^¼ [mm]; it is a little wider."""
    return float((4.0 * _worn_volume(study) * study.counter.radius / np.pi) ** 0.25)


def _worn_volume(study: Study) -> float:
    """Find what both bodies lose together, K F L [mm³]."""
    return sum(study.wear_coefficients) * study.contact.load * study.sliding.distance
