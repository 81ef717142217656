"""Steps of two scales: made ahead, in blocks, on threads and from any state they are the same steps."""

import json
from itertools import pairwise

import numpy as np
import pytest
from cases_stepped import Stepped, trial
from cases_two_scale import KINDS, of_kind, quick
from numpy.testing import assert_allclose, assert_array_equal

from warpwear.engine import state as saved
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.kernels import patches as passes

PLAN = (0.003 * 1.1 ** np.arange(30)).tolist()


@pytest.mark.parametrize("kind", ["no bulk", "bulk", "soft bulk"])
def test_steps_evaluated_ahead_are_the_steps(kind: str, device: str) -> None:
    """The same cells and approaches as with a search of each step's own, which takes more evaluations.

    Another increment than was announced is solved for itself.
    """
    study = of_kind(kind).replace({"stepping.largest": "3 mm"})
    alone, ahead, misled = (Stepped(study, device=device) for _ in range(3))
    foreseen = list(ahead.model.steps((d, True) for d in PLAN))
    evaluations = np.zeros(2)
    for increment, other in zip(PLAN, foreseen, strict=True):
        one = alone.model.advance(increment, with_pressure=True)
        wrong = misled.model.advance(increment, with_pressure=True, then=2.0 * increment)
        assert one.pressure is not None
        for step in (other, wrong):
            assert step.pressure is not None
            assert_array_equal(step.pressure > 0.0, one.pressure > 0.0)
            assert step.row["approach"] == pytest.approx(one.row["approach"], rel=1e-12)
        evaluations += one.row["evaluations"], other.row["evaluations"]
    assert_allclose(ahead.gap(), alone.gap(), rtol=1e-12, atol=1e-15)
    assert evaluations[0] - evaluations[1] > 0.8 * len(PLAN)  # about one a step


@pytest.mark.parametrize("kind", ["no bulk", "bulk", "elastic, explicit"])
def test_what_is_evaluated_ahead_is_what_patches_answer(kind: str, device: str) -> None:
    """Pressure, slope, and how far they are a straight line, by the kernel that evaluates alone."""
    stepped = Stepped(of_kind(kind), device=device)
    model, compared = stepped.model, 0
    sharing, courses = model.sharing, model._courses
    asks = Program(stepped.executor)
    model._pass(asks, passes.carried, model._steps, sharing.curves, model.contact.surfaces)
    for increment, then in pairwise((3e-3, 3e-3, 0.01, 0.03, 0.1, 0.3)):
        model.advance(increment, then=then)
        if model._memory["ahead"] < 0.0:
            continue
        ahead, before = (sharing.answer.numpy().copy(), [field.numpy().copy() for field in trial(sharing)])
        base, offset = courses["base_next"].numpy(), courses["offset_next"].numpy()
        for field, values in zip(trial(sharing), (base, offset), strict=True):
            field.assign(values)
        model._now.set(stiffness=model._now["stiffness_next"])
        asks.run()
        answer = sharing.answer.numpy()
        assert answer[0].any()
        for found, expected in zip(ahead[:2], answer[:2], strict=True):
            assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * expected.max())
        # Of tiles that touched and do so no more, the lowest gap before any wear is told otherwise.
        deeper = base + offset >= courses["reached"].numpy()
        compared += int(deeper.sum())
        assert_allclose(ahead[2][deeper], answer[2][deeper], rtol=1e-6, atol=1e-16)
        for field, values in zip([sharing.answer, *trial(sharing)], [ahead, *before], strict=True):
            field.assign(values)
    assert compared > stepped.patches.count


def test_threads_change_nothing(two_threads: int) -> None:
    study = of_kind("bulk")
    runs = [Stepped(study, threads=count) for count in (1, two_threads)]
    increments = (3e-3, 0.03, 0.3, 3.0)
    one, other = ([step.row for step in run.model.steps((d, False) for d in increments)] for run in runs)
    assert one == other
    assert_array_equal(runs[0].gap(), runs[1].gap())


@pytest.mark.parametrize("kind", KINDS)
def test_a_model_goes_on_from_any_step(kind: str) -> None:
    """Bit for bit, in every number of every row."""
    study = of_kind(kind)
    increments = [3e-3, 0.01, 0.05, 0.1, 0.3, 1.0]

    def rows(restart: int | None) -> tuple[list[dict[str, float]], FloatArray, FloatArray]:
        stepped, found = Stepped(study), []
        for number, increment in enumerate(increments):
            if number == restart:
                arrays, numbers = saved.save(stepped.model)
                kept = {name: np.array(values) for name, values in arrays.items()}
                assert "sharing.answer" in kept
                assert (stepped.model._memory["ahead"] > 0.0) == (kind != "load")
                stepped = Stepped(study)
                saved.restore(stepped.model, kept, json.loads(json.dumps(numbers)))
            then = increments[number + 1] if number + 1 < len(increments) else None
            found.append(stepped.model.advance(increment, then=then).row)
        return found, stepped.gap(), stepped.model.book.table("load_share")

    alone = rows(None)
    again = rows(4)
    assert again[0] == alone[0]
    assert_array_equal(again[1], alone[1])
    assert_array_equal(again[2], alone[2])


@pytest.mark.parametrize("kind", KINDS)
def test_steps_of_a_block_are_the_steps(kind: str, threads: int) -> None:
    """Bit for bit, however many are made in a row."""

    def rows(longest: int) -> tuple[list[dict[str, float]], FloatArray, FloatArray]:
        stepped = Stepped(of_kind(kind), threads=threads)
        stepped.model.longest_block = longest
        found = [step.row for step in stepped.model.steps((d, False) for d in PLAN)]
        return found, stepped.gap(), stepped.model.book.table("load_share")

    alone, together = rows(1), rows(13)
    assert together[0] == alone[0]
    assert_array_equal(together[1], alone[1])
    assert_array_equal(together[2], alone[2])


def test_a_block_ends_where_the_contact_reaches_the_edge() -> None:
    """So that a run that stops there is kept as it is; the steps after it are made one by one."""
    stepped = Stepped(quick(grid__extent="0.5 mm"))
    ahead = []
    for step in stepped.model.steps((d, False) for d in [3e-3] * 3 + [3.0] * 20):
        ahead.append(stepped.model.steps_in_flight)
        if step.touches_edge:
            assert stepped.model.steps_in_flight == 0
    assert ahead[0] > 0
    assert len(ahead) == 23
