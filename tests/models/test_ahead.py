"""What a step evaluates ahead of the next one, and what is told of the wear of two bodies from one gap."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from warpwear import Study, run
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.laws.archard import ExponentialLaw, RunningInLaw, WearLaw, wear_in_steps
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.arrangements import model_at_rest

SHAPE, CELL = (150, 203), 0.005  # a width that needs padding
LAWS = {
    "implicit": {},
    "elastic": {"contact.stiffness": "1.9e6 N/mm^3"},
    "no cap": {"contact.hardness": "inf MPa"},
    "smooth": {"study.model": "macro", "contact.bulk_stiffness": "pressure", "contact.hardness": "inf MPa"},
}
#: Laws of cell by cell, whose steps do not look ahead.
RARE = {
    "across": {"contact.stiffness": "1.9e6 N/mm^3", "wear.distance_factor": "across"},
    "radial": {"wear.distance_factor": "radial"},
    "explicit, radial": {
        "stepping.scheme": "explicit",
        "contact.stiffness": "2e5 N/mm^3",
        "wear.distance_factor": "radial",
    },
    "running in": {"wear.law": "running-in", "wear.running_in": "1 mm", "wear.initial_disc": "1e-2 mm^3/N/m"},
}
PLAN = (0.003 * 1.1 ** np.arange(60)).tolist()


def heights() -> np.ndarray:
    return np.random.default_rng(5).normal(0.0, 1e-3, SHAPE).cumsum(axis=1) * 0.1


def study(kind: str) -> Study:
    return Study.load("v3-fine").replace({"wear.counter": "9.4e-4 mm^3/N/m"} | (LAWS | RARE)[kind])


@pytest.mark.parametrize("kind", LAWS)
def test_steps_evaluated_ahead_are_the_steps(kind: str, threads: int) -> None:
    """The same cells and approaches as with a search of each step's own, which takes several evaluations."""
    outcomes = []
    for ahead in (False, True):
        with Executor(Grid(*SHAPE, CELL), threads=threads) as executor:
            model = OneScaleModel(study(kind).contact_task, heights(), executor)
            if ahead:
                steps = list(model.steps((d, True) for d in PLAN))
            else:
                steps = [model.advance(d, with_pressure=True) for d in PLAN]
            outcomes.append((steps, [executor.to_numpy(model.gap).copy(), *model.worn_depths()]))
    (plain, fields), (foreseen, fields_foreseen) = outcomes
    for one, other in zip(plain, foreseen, strict=True):
        assert_array_equal(one.pressure > 0.0, other.pressure > 0.0)  # type: ignore[operator]
        assert other.row["approach"] == pytest.approx(one.row["approach"], rel=1e-12)
        assert abs(other.row["load_residual"]) <= 1e-12 * 8.0
    for one_field, other_field in zip(fields, fields_foreseen, strict=True):
        assert_allclose(other_field, one_field, rtol=1e-10, atol=1e-15)
    evaluations = [sum(step.row["evaluations"] for step in steps[3:]) for steps in (plain, foreseen)]
    assert evaluations[1] < 0.6 * evaluations[0]


def test_another_increment_than_announced_is_solved_for_itself() -> None:
    steps = {}
    for then in (None, 1.0):
        with Executor(Grid(*SHAPE, CELL)) as executor:
            model = OneScaleModel(study("implicit").contact_task, heights(), executor)
            steps[then] = [model.advance(d, with_pressure=True, then=then) for d in (0.01, 0.02, 0.3, 0.01)]
    for one, other in zip(steps[None], steps[1.0], strict=True):
        assert one.row["approach"] == pytest.approx(other.row["approach"], rel=1e-12)
        assert_array_equal(one.pressure > 0.0, other.pressure > 0.0)  # type: ignore[operator]


@pytest.mark.parametrize("kind", LAWS | RARE)
def test_wear_of_both_bodies_is_what_the_pressures_took(kind: str) -> None:
    """Σ K p ΔL of each cell and body, added up from the pressures of all steps."""
    this = study(kind)
    grid = Grid(*SHAPE, CELL)
    factor = np.ones(SHAPE)
    if this.wear.distance_factor != "none":
        d2 = np.broadcast_to(grid.y[None, :] ** 2, SHAPE)
        d2 = d2 + grid.x[:, None] ** 2 * (this.wear.distance_factor == "radial")
        factor = np.sqrt(1.0 - d2 / 9.0)
    expected = np.zeros((2, *SHAPE))
    with Executor(grid) as executor:
        model = model_at_rest(this.contact_task, heights(), executor)
        distance = 0.0
        for step, increment in zip(model.steps((d, True) for d in PLAN), PLAN, strict=True):
            for worn, law, slid in zip(expected, this.wear_laws, (1.0, factor), strict=True):
                worn += law.wear_per_pressure(distance, increment) * slid * step.pressure
            distance += increment
        last = model.snapshot(step, distance)
        for worn, found in zip(expected, (last.wear_counter, last.wear_disc), strict=True):
            assert_allclose(found, worn, rtol=1e-10, atol=1e-12 * worn.max())
    for name, worn in zip(("counter", "disc"), expected, strict=True):
        assert step.row[f"wear_volume_{name}"] == pytest.approx(worn.sum() * CELL**2, rel=1e-11)
        assert step.row[f"wear_depth_{name}"] == pytest.approx(worn.max(), rel=1e-11)


def test_wear_in_proportion() -> None:
    fast, slow = WearLaw(3e-6), WearLaw(1e-6)
    assert fast.in_proportion_to(slow)
    assert ExponentialLaw(3e-6, decay=0.1).in_proportion_to(ExponentialLaw(1e-6, decay=0.1))
    assert not ExponentialLaw(3e-6, decay=0.1).in_proportion_to(slow)
    running_in = RunningInLaw(3e-6, initial=6e-6, running_in=2.0)
    assert running_in.in_proportion_to(RunningInLaw(1e-6, initial=2e-6, running_in=2.0))
    assert not running_in.in_proportion_to(RunningInLaw(1e-6, initial=1e-6, running_in=2.0))
    assert running_in.in_proportion_to(WearLaw(0.0))


def test_wear_that_dies_away() -> None:
    """Exponential wear far beyond its decay: the steps go on and add nothing."""
    changes = {"grid.cell": "20 um", "sliding.distance": "3 mm", "stepping.increment": "0.03 mm"}
    changes |= {"wear.law": "exponential", "wear.decay": "40 1/mm", "output.snapshots": []}
    history = run(Study.load("v3-fine").replace(changes)).history
    assert history["wear_volume_disc"][-1] == pytest.approx(12.7e-7 * 8.0 / 40.0, rel=1e-9)


def test_removals_of_a_block_follow_each_other() -> None:
    """Each begins where the last one ends, so that together they are those of the whole distance."""
    laws = ExponentialLaw(3e-6, decay=0.1), RunningInLaw(1e-6, initial=5e-6, running_in=2.0)
    found = np.array(wear_in_steps(laws, 4.0, [0.5, 1.0, 0.25]))
    assert found.shape == (3, 2)
    assert_allclose(found[1], [law.wear_per_pressure(4.5, 1.0) for law in laws], rtol=1e-14)
    assert_allclose(found.sum(axis=0), [law.wear_per_pressure(4.0, 1.75) for law in laws], rtol=1e-14)
