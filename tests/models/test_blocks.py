"""Steps made many in a replay are the steps made one by one, bit for bit."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import reference
import warp as wp
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.engine.numbers import Numbers
from warpwear.errors import ConvergenceError, InvariantError
from warpwear.grid import Grid
from warpwear.history.recorder import Step
from warpwear.kernels import native_code
from warpwear.models.model import Model
from warpwear.models.rest.local import OneScaleModel
from warpwear.models.track.model import SweptModel
from warpwear.runs.arrangements import model_at_rest
from warpwear.runs.checkpoint import Checkpoints

wp.set_module_options(native_code.options())

SHAPE, CELL = (150, 203), 0.005  # a width that needs padding, rows whose sum NumPy makes in two parts
SPRINGS = {"contact.stiffness": "1.9e6 N/mm^3"}
EXPLICIT = {"stepping.scheme": "explicit", "stepping.force": True}
ACROSS = {"wear.distance_factor": "across"}
KINDS: dict[str, dict[str, Any]] = {
    "implicit": {},
    "capped springs": SPRINGS,
    "no cap": {"contact.hardness": "inf MPa"},
    "smooth": {"study.model": "macro", "contact.bulk_stiffness": "pressure", "contact.hardness": "inf MPa"},
    "exponential": {"wear.law": "exponential", "wear.decay": "0.5 1/mm"},
    "no wear of the disc": {"wear.disc": "0 mm^3/N/m"},
    "across": SPRINGS | ACROSS,
    "across, rigid but for wear": ACROSS,
    "explicit, across": EXPLICIT | ACROSS | {"contact.stiffness": "2e5 N/mm^3"},
    "explicit, radial": EXPLICIT | {"wear.distance_factor": "radial", "contact.stiffness": "2e5 N/mm^3"},
    "bearing area": EXPLICIT | ACROSS | {"stepping.load_tolerance": "0.0074 N"},
    "running in": {"wear.law": "running-in", "wear.running_in": "1 mm", "wear.initial_disc": "1e-2 mm^3/N/m"},
    "no wear of the counter-body": ACROSS | SPRINGS | {"wear.counter": "0 mm^3/N/m"},
}
INCREMENTS = (0.003 * 1.05 ** np.arange(90)).tolist()


def study(kind: str) -> Study:
    return Study.load("v3-fine").replace(KINDS[kind])


def model_of(kind: str, executor: Executor, *, smooth: bool = False) -> Model:
    heights = np.zeros(SHAPE)
    if not smooth:
        heights = np.random.default_rng(5).normal(0.0, 1e-3, SHAPE).cumsum(axis=1) * 0.1
    return model_at_rest(study(kind).contact_task, heights, executor)


def replays(monkeypatch: pytest.MonkeyPatch, before: Callable[[], object] = bool) -> list[int]:
    """Numbers of steps that replays of a program are asked for from now on. before: called before each."""
    asked: list[int] = []
    set_numbers = Numbers.set

    def counted(self: Numbers, **values: float) -> None:
        if "steps" in values:
            asked.append(int(values["steps"]))
            before()
        set_numbers(self, **values)

    monkeypatch.setattr(Numbers, "set", counted)
    return asked


#: How steps are made, and of how many a block is at most.
WAYS = {"one by one": 1, "many in a replay": 500}


def state_of(model: Model) -> dict[str, Any]:
    """What checkpoints keep, but for lists of tiles that displaced bodies make anew in each step."""
    arrays, numbers = saved.save(model)
    return {name: np.array(values) for name, values in arrays.items()} | {"numbers": numbers}


def assert_same(one: list[Step], other: list[Step]) -> None:
    for number, (a, b) in enumerate(zip(one, other, strict=True)):
        assert a.row == b.row, number
        assert (a.touches_edge, a.touches_rim) == (b.touches_edge, b.touches_rim)


def made_by(model: Model, increments: Iterable[float], pressure_of: Iterable[int] = ()) -> list[Step]:
    return list(model.steps((d, n in set(pressure_of)) for n, d in enumerate(increments)))


@pytest.mark.parametrize("kind", KINDS)
def test_a_replay_makes_the_steps(kind: str, threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every row, the state after them and the fields between them."""
    made, outcomes = replays(monkeypatch), []
    for how, longest in WAYS.items():
        with Executor(Grid(*SHAPE, CELL), threads=threads if how == "one by one" else 1) as executor:
            model = model_of(kind, executor)
            model.longest_block = longest
            steps = made_by(model, INCREMENTS, pressure_of=(30, 31, 89))
            outcomes.append((steps, state_of(model)))
        assert (max(made) > 25) == (how != "one by one")
    (one_by_one, before), (in_a_replay, after) = outcomes
    assert_same(one_by_one, in_a_replay)
    for number in (30, 31, 89):
        assert_array_equal(one_by_one[number].pressure, in_a_replay[number].pressure)  # type: ignore[arg-type]
    assert before.keys() == after.keys()
    for name in before.keys() - {"numbers"}:
        assert_array_equal(before[name], after[name], err_msg=name)
    assert before["numbers"] == after["numbers"]


@pytest.mark.parametrize("longest", [1, 7])
@pytest.mark.parametrize("kind", ["capped springs", "explicit, across", "bearing area"])
def test_blocks_may_end_anywhere(kind: str, longest: int) -> None:
    outcomes = []
    for length in (longest, 500):
        with Executor(Grid(*SHAPE, CELL)) as executor:
            model = model_of(kind, executor)
            model.longest_block = length
            outcomes.append(made_by(model, INCREMENTS))
    assert_same(*outcomes)


def test_ties_are_made_in_a_replay() -> None:
    """On a smooth disc eight cells tie, of which the load asks for a part."""
    outcomes = []
    for longest in WAYS.values():
        with Executor(Grid(150, 150, CELL)) as executor:
            task = replace(study("bearing area").contact_task, load_tolerance=1.0e-3)
            model = model_at_rest(task, np.zeros((150, 150)), executor)
            model.longest_block = longest
            outcomes.append(made_by(model, [0.003] * 20))
    assert all(abs(step.row["load_residual"]) < 1.0e-9 for step in outcomes[0])  # but for ties by whole cells
    assert_same(*outcomes)


@pytest.mark.parametrize("model", ["macro", "micro"])
def test_a_contact_at_the_edge_stops_where_it_did(
    model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """With the same rows, and a checkpoint after the step that reached it."""
    small = Study.load("v1" if model == "macro" else "v3").replace(
        {"grid.extent": "0.5 mm", "checks.strict": True, "output.snapshots": []}
    )
    monkeypatch.setattr("warpwear.runs.order.too_small", lambda study: None)
    found = {}
    for name in WAYS:
        watch = (lambda step: None) if name == "one by one" else None  # whoever watches gets them so
        with pytest.raises(InvariantError, match="edge"):
            warpwear.run(small, out=tmp_path / name, plots=False, threads=1, callback=watch)
        with warpwear.Result.open(tmp_path / name) as result:
            found[name] = {column: np.array(values) for column, values in result.history.items()}
        assert (tmp_path / name / "checkpoint.h5").exists()
    one, other = found.values()
    assert len(one["distance"]) > 20
    for column, values in one.items():
        assert_array_equal(values, other[column], err_msg=column)


@pytest.mark.parametrize("preset", ["v1", "v2", "v3"])
def test_a_run_goes_on_from_a_block(preset: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A run that ended after a block, with a checkpoint, ends as one left alone."""
    short = Study.load(preset).replace({"sliding.distance": "60 mm", "output.snapshots": ["30 mm"]})
    alone, calls = warpwear.run(short), iter(range(5))

    def interrupted() -> None:
        if next(calls) == 4:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        replays(patch, interrupted)
        patch.setattr(OneScaleModel, "longest_block", 17)
        patch.setattr(SweptModel, "longest_block", 17)
        patch.setattr(Checkpoints, "due", True)
        with pytest.raises(KeyboardInterrupt):
            warpwear.run(short, out=tmp_path / "run", plots=False)
    assert (tmp_path / "run" / "checkpoint.h5").exists()
    with warpwear.run(short, out=tmp_path / "run", plots=False, resume=True) as resumed:
        for column, values in alone.history.items():
            assert_array_equal(resumed.history[column], values, err_msg=column)
        for index in range(2):
            for name, values in alone.snapshot(index).fields.items():
                assert_array_equal(getattr(resumed.snapshot(index), name), values, err_msg=name)


@pytest.mark.parametrize("kind", ["capped springs", "smooth", "across", "explicit, across", "bearing area"])
def test_against_plain_numpy(kind: str) -> None:
    """Areas are those of an independent loop over every cell, volumes and depths too, to 1e-12."""
    this, shape = study(kind), (61, 75)
    task, grid = this.contact_task, Grid(*shape, CELL)
    heights = np.random.default_rng(3).normal(0.0, 5e-4, shape)
    expected = reference.wear_run(
        reference.counter_gap(grid.x, grid.y, 1.0 / task.form.curvature, heights),
        load=task.load,
        hardness=task.hardness,
        cell=CELL,
        wear=(9.4e-7, 12.7e-7),
        increments=INCREMENTS[:60],
        implicit=task.implicit,
        stiffness=1.0 / task.compliance if task.compliance else np.inf,
        factor=np.sqrt(1.0 - (grid.y[None, :] * task.form.curvature) ** 2)
        if "across" in kind or task.rigid
        else 1.0,
        tolerance=task.load_tolerance,
    ).history
    with Executor(grid) as executor:
        steps = made_by(model_at_rest(task, heights.copy(), executor), INCREMENTS[:60])
    for name, values in expected.items():
        found = np.array([step.row[name] for step in steps])
        if name.startswith(("area", "patch")):
            assert_allclose(found, values, rtol=1e-13, err_msg=name)
        elif name.startswith(("wear", "pressure_m")):
            assert_allclose(found, values, rtol=1e-12, err_msg=name)


@wp.func_native("return sum_of_line(table, 0, 0, table.shape[1]);")
def sum_of_first(table: wp.array2d(dtype=wp.float64)) -> wp.float64: ...


@wp.kernel
def sum_row(table: wp.array2d(dtype=wp.float64), sums: wp.array(dtype=wp.float64)) -> None:
    sums[0] = sum_of_first(table)


@pytest.mark.parametrize("count", [1, 7, 8, 9, 127, 128, 129, 150, 300, 447])
def test_sums_are_those_of_numpy(count: int) -> None:
    """Where they were not, steps made many at a time would differ from steps made by themselves."""
    values = np.random.default_rng(count).lognormal(0.0, 3.0, (1, count))
    table = wp.array(values, dtype=wp.float64, device="cpu")
    sums = wp.zeros(1, dtype=wp.float64, device="cpu")
    wp.launch(sum_row, dim=1, inputs=[table, sums], device="cpu")
    assert sums.numpy()[0] == values.sum(axis=1)[0]


def test_a_load_that_no_approach_carries_is_refused(device: str) -> None:
    """After the steps before it, which are kept; on springs and where nothing yields."""
    for kind, message in (("implicit", "of 1e\\+06 N are left"), ("explicit", "the load asks for")):
        this = Study.load("v3-fine").replace({"stepping.scheme": kind, "stepping.force": True})
        grid, task = Grid(*SHAPE, CELL), replace(this.contact_task, load=1e6)
        with Executor(grid, device=device) as executor:
            model = model_at_rest(task, np.zeros(SHAPE), executor)
            with pytest.raises(ConvergenceError, match=message):
                made_by(model, [0.003] * 3)
