"""Runs that an inference stands on: one where results only scale, else a Sobol design over the priors."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.batches import batch
from warpwear.batches.batch import RUNS, make_all, opened_folder
from warpwear.batches.plan import Plan, SweepSection
from warpwear.batches.run_one import RunRow
from warpwear.calibration.bayes.unknowns import Unknown, number_of
from warpwear.engine.workers import Here
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws import archard
from warpwear.laws.archard import BODIES
from warpwear.laws.friction import COEFFICIENT, NUMBERS
from warpwear.result import Result
from warpwear.results.evolution import surface_evolution
from warpwear.results.track import course
from warpwear.study.study import Study

ndimage, signal = lazy.module("scipy.ndimage"), lazy.module("scipy.signal")

#: Unknowns of the wear laws: of a contact at rest they change only how fast the run goes.
WEAR = tuple(f"wear.{key}" for key in sorted(archard.KEYS))
#: Unknowns of friction that need no run, unless junctions grow by their strength.
FRICTION = tuple(f"friction.{key}" for key in NUMBERS)
#: Places of a normal prior between which the runs reach.
REACH = 3.3
#: A scar that the field does not hold is made smaller by this factor of the wear until it does.
SMALLER = 0.85
MOST_CUTS = 40
#: A field that does not hold the scar of another test is made wider by this factor, this often at most.
WIDER, MOST_WIDER = 1.12, 10
#: Points of a course between runs.
POINTS = 240
#: Points along which a smooth course is a polynomial of this degree (Savitzky and Golay, 1964).
WINDOW, DEGREE = 15, 2


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs of a study over the unknowns that need them.

    study: of the runs. inputs: those unknowns. places: (runs, inputs), see `Unknown.place_of`. rows: one a
    run. scaled: whether the rest of the wear only scales the distance. cut: a sentence where the field holds
    less wear than the priors allow, else empty. roughness: (runs, 2), Sq of ball and disc in the scar at the
    end [µm], where asked for. part: of the fastest wear of the priors, what the run wears.
    """

    study: Study
    inputs: tuple[Unknown, ...]
    places: FloatArray
    rows: tuple[RunRow, ...]
    scaled: bool
    cut: str = ""
    roughness: FloatArray | None = None
    part: float = 1.0

    def course(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Distances [mm], (points,), and a column of the history over them, (runs, points)."""
        first = max(float(row.courses["distance"][0]) for row in self.rows)
        last = min(float(row.courses["distance"][-1]) for row in self.rows)
        places = self.rows[0].courses["distance"]
        if len(self.rows) > 1 or places.size > POINTS:
            places = np.unique(np.append(np.geomspace(first, last, POINTS), last))
        values = [np.interp(places, row.courses["distance"], row.courses[name]) for row in self.rows]
        return places, np.array(values)

    def smooth(self, name: str) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return distances [mm], a smooth course (runs, points), and how runs scatter about it, (points,).

        Areas are of whole cells, which come and go ring by ring: what a finer grid would give lies between.
        The scatter is relative, or in units of a course that is not positive; it is 0 where all steps are
        kept as they are.
        """
        places, courses = self.course(name)
        if min(row.courses["distance"].size for row in self.rows) <= POINTS:
            return places, courses, np.zeros(places.size)
        positive = bool((courses > 0.0).all())
        rough = np.log(courses) if positive else courses
        fit = signal.savgol_filter(rough, WINDOW, DEGREE, axis=1)
        square = np.mean((rough - fit) ** 2, axis=0) * WINDOW / (WINDOW - DEGREE - 1)
        mean = ndimage.uniform_filter1d(square, 2 * WINDOW, mode="nearest")
        scatter = np.sqrt(np.maximum(mean, 0.0))  # a running sum leaves −1e-20 of zeros
        return places, np.exp(fit) if positive else fit, scatter


def scales(study: Study) -> bool:
    """Tell whether a study's area and scar follow from the sum of both wears alone, over the distance.

    That is so of a contact at rest, in implicit steps, by laws that all say so of themselves.
    """
    return (
        not study.is_swept
        and study.study.model != "two-scale"
        and study.contact_task.scales
        and study.friction.law_with().scales
        and study.friction.junction_growth == 0.0
        and min(study.wear_coefficients) >= 0.0
    )


def wears_by(study: Study, key: str) -> bool:
    """Tell whether an unknown is a number of the study's wear law."""
    return key in WEAR or (key == f"friction.{COEFFICIENT}" and study.wear.law == "energy")


def needs_runs(study: Study, key: str, *, scaled: bool) -> bool:
    """Tell whether an unknown changes the contact, so that other values need other runs."""
    if wears_by(study, key):
        return not scaled
    if key == f"friction.{COEFFICIENT}":
        return study.sliding.drives_bodies  # else it changes no contact
    if key in FRICTION:
        return study.friction.junction_growth > 0.0 and key.endswith("shear_strength")
    return True


def other_surfaces(study: Study, count: int) -> dict[str, str]:
    """Vary the seed of a made-up surface over so many runs: it is one of many, and they scatter.

    Empty where the heights are known.
    """
    synthetic = study.disc.synthetic
    if synthetic is None or synthetic.kind == "flat" or study.study.model == "macro":
        return {}
    return {"disc.synthetic.seed": f"{synthetic.seed}:{synthetic.seed + count - 1}"}


def make_runs(
    study: Study,
    unknowns: Sequence[Unknown],
    *,
    samples: int | None,
    seed: int,
    out: Path,
    device: str,
    roughness: bool = False,
    part: float | None = None,
) -> Runs:
    """Make the runs that an inference stands on.

    samples: of a design, by default 8 an unknown that needs runs, 16 at least, as a power of two, and twice
    that where surfaces are made up, which scatter. out: folder that keeps them. part: of the fastest wear of
    the priors, where it is known that the field holds it; else as much as it holds.

    Raises InputError where a run fails: outside of what the runs cover nothing can be said.
    """
    scaled = scales(study) and not roughness
    inputs = tuple(unknown for unknown in unknowns if needs_runs(study, unknown.key, scaled=scaled))
    test, cut = study, ""
    if scaled and part is None:
        part = _part_held(test, unknowns, out, device)
        edge = f"{test.grid.size} (grid.extent)"
        cut = f"Priors of the wear are cut off where the scar reaches the edge of the field, {edge}."
        cut = cut if part < 1.0 else ""
    if scaled:
        study = _wearing(test, unknowns, part or 1.0)
    if not inputs:
        folder, row = _run(study, out, device)
        folders = [folder]
        if row.status != "done":
            raise InputError(f"the run that the inference stands on {row.status}")
        places, rows = np.zeros((1, 0)), [row]
    else:
        plan = _plan_of(study, inputs, samples=samples, seed=seed, device=device)
        with opened_folder(out):
            rows = make_all(plan, out)
        failed = [row.status for row in rows if row.status != "done"]
        if failed:
            raise InputError(
                f"{len(failed)} of {len(rows)} runs over the priors of {', '.join(u.key for u in inputs)} "
                f"{failed[0]} Narrower priors, or a study that can be run over all of them, are needed"
            )
        studies = [point.study for point in plan.points if point.study]
        numbers = {u: np.array([number_of(study, u.key) for study in studies]) for u in inputs}
        places = np.column_stack([unknown.place_of(column) for unknown, column in numbers.items()])
        folders = [out / RUNS / point.run for point in plan.points]
    whole = tuple(_whole(row, folder) for row, folder in zip(rows, folders, strict=True))
    rough = np.array([_roughness(folder) for folder in folders]) if roughness else None
    return Runs(study, inputs, places, whole, scaled, cut, rough, part or 1.0)


def cost_of(
    study: Study, unknowns: Sequence[Unknown], *, samples: int | None, seed: int, device: str, roughness: bool
) -> str:
    """Make the first of the runs that an inference stands on, and say what all of them will cost."""
    scaled = scales(study) and not roughness
    inputs = tuple(unknown for unknown in unknowns if needs_runs(study, unknown.key, scaled=scaled))
    plan = _plan_of(study, inputs, samples=samples, seed=seed, device=device)
    with opened_folder(None) as folder, batch.local_executor(plan) as (pool, threads, workers):
        return batch.estimate(plan, folder, pool, threads=threads, workers=workers)


def _plan_of(study: Study, inputs: Sequence[Unknown], *, samples: int | None, seed: int, device: str) -> Plan:
    """Return the runs of a design over the unknowns that need them, of one run where none does.

    Raises InputError for too few, and for priors of which some samples make no study.
    """
    if not inputs:
        return Plan(study, device=device)
    usual = 2 ** max(4, int(np.ceil(np.log2(8 * len(inputs))))) * (2 if other_surfaces(study, 2) else 1)
    count = samples if samples is not None else usual
    if count < (fewest := 3 * len(inputs) + 5):
        raise InputError(f"runs = {count}: at least {fewest} are needed for {len(inputs)} unknowns")
    vary: dict[str, Any] = other_surfaces(study, count) | {u.key: u.prior for u in inputs}
    design = SweepSection(vary=vary, design="sobol", samples=count, seed=seed)
    plan = Plan(study, design, device=device)
    _foresee(plan)
    return plan


def _foresee(plan: Plan) -> None:
    """Refuse priors of which some samples make no study, before any run."""
    points = [point for point in plan.points if point.study is None]
    if not points:
        return
    cure = "narrower priors are needed"
    if "explicit stability limit" in points[0].problem:
        cure = "stepping.scheme = 'implicit', smaller increments or narrower priors are needed"
    raise InputError(
        f"{len(points)} of {len(plan.points)} runs over the priors of {', '.join(plan.keys)} make no study: "
        f"{points[0].problem.removesuffix('.')}. None was made; {cure}"
    )


def _whole(row: RunRow, folder: Path) -> RunRow:
    """Return a row with whole courses: a sweep keeps few points of the start, where slow wear looks."""
    with Result.open(folder) as result:
        courses = {name: course(result, name)[int(name != "distance")] for name in row.courses}
    return replace(row, courses=courses)


def _run(study: Study, out: Path, device: str) -> tuple[Path, RunRow]:
    """Return folder and row of a study's run, which is made here unless its folder holds it."""
    plan = Plan(study, device=device)
    (row,) = batch.make_runs(plan, out, Here())
    return out / RUNS / plan.points[0].run, row


def wide_enough(
    study: Study, changes: Mapping[str, Any], unknowns: Sequence[Unknown], part: float, out: Path, device: str
) -> Study:
    """Return a study with changes, on a field that holds the scar of a part of the fastest wear.

    Raises InputError where no field does, or the study cannot have such a wide one.
    """
    sides, cell = study.grid.sides, study.grid.cell
    for _ in range(MOST_WIDER):
        try:
            extent = [f"{side:.9g} mm" for side in sides]
            other = study.replace({**changes, "grid.extent": extent if study.is_line else extent[0]})
            if not scales(other) or _holds(other, unknowns, part, out, device):
                return other
        except InputError as error:
            if "grid.extent" not in str(error):
                raise
        wider = cell * np.ceil(WIDER * sides[0] / cell)
        sides = wider, sides[1] if study.is_line else wider
    raise InputError(
        f"the scar of the next test {', '.join(f'{key} = {value}' for key, value in changes.items())} is "
        f"larger than a field of {sides[0]:.4g} mm (grid.extent): narrower priors or another test are needed"
    )


def _part_held(study: Study, unknowns: Sequence[Unknown], out: Path, device: str) -> float:
    """Return the part of the fastest wear of the priors whose scar the field holds."""
    part = 1.0
    if _wearing(study, unknowns, part) is study:  # no part of it is less
        return part
    for _ in range(MOST_CUTS):
        if _holds(study, unknowns, part, out, device):
            break
        part *= SMALLER
    return part


def _holds(study: Study, unknowns: Sequence[Unknown], part: float, out: Path, device: str) -> bool:
    """Tell whether the field holds the scar of a part of the fastest wear of the priors."""
    try:
        wearing = _wearing(study, unknowns, part)
    except InputError as error:
        if "grid.extent" not in str(error):
            raise
        return False
    return "grid.extent" not in _run(wearing, out, device)[1].status


def _wearing(study: Study, unknowns: Sequence[Unknown], part: float) -> Study:
    """Return a study that wears by a part of the fastest wear that the priors allow.

    It wears by Archard's constant law: the others only change how soon it gets as far.
    """
    wear = [unknown for unknown in unknowns if wears_by(study, unknown.key)]
    if not wear and study.wear.law == "archard":
        return study
    ends = [unknown.values(np.array([-REACH, REACH])) for unknown in wear]
    corners = [dict(zip((u.key for u in wear), corner, strict=True)) for corner in itertools.product(*ends)]
    numbers = study.pair.wear_hardness, study.friction
    laws = [study.wear_laws, *(study.wear.laws(*numbers, corner) for corner in corners)]
    fastest = [float(max(pair[body].fastest for pair in laws)) for body in range(len(BODIES))]
    counter, disc = (f"{1e3 * part * k!r} mm^3/N/m" for k in fastest)
    return study.replace({"wear.law": "archard", "wear.counter": counter, "wear.disc": disc})


def _roughness(folder: Path) -> tuple[float, float]:
    """Return Sq of ball and disc in the inner scar at the end of a run [µm]."""
    with Result.open(folder) as result:
        table = surface_evolution(result).table
    columns = (table.get(f"sq_{body}", np.zeros(0)) for body in BODIES)
    counter, disc = (float(column[-1]) if column.size else np.nan for column in columns)
    if not np.isfinite([counter, disc]).all():
        raise InputError("Sq in the scar is not known of every run: it needs a snapshot at the end")
    return counter, disc
