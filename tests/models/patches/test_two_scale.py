"""Two scales: patches that share a load, against the one-scale run and an independent NumPy solver."""

import json
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from cases_two_scale import KINDS, of_kind, quick
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import ConvergenceError, Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor, Field
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid
from warpwear.kernels import patches as passes
from warpwear.models.patches.local import TwoScaleModel
from warpwear.models.patches.shares import LoadSharing, SmoothContact
from warpwear.study.surface import surface_in


@cache
def _heights_on(grid: Grid) -> FloatArray:
    return surface_in(quick()).heights(grid.x, grid.y)


class Stepped:
    """A model, advanced step by step."""

    def __init__(self, study: Study, *, device: str = "cpu", threads: int | None = None) -> None:
        self.study, self.patches = study, study.patch_layout
        self.executor = Executor(self.patches.grid, device=device, threads=threads)
        self.model = TwoScaleModel(study.contact_task, self.patches, _heights_on(study.cells), self.executor)

    def gap(self) -> FloatArray:
        """Of every patch, shape (patches, side, side)."""
        n = self.patches.side
        rows = self.executor.to_numpy(self.model.contact.gap)
        return rows.reshape(self.patches.count, n, -1)[:, :, :n].copy()


@pytest.mark.parametrize(
    ("macro", "stiffness", "hardness", "distance"),
    [
        ("50 um", "inf N/mm^3", "590 MPa", "300 mm"),
        ("250 um", "inf N/mm^3", "590 MPa", "3 mm"),
        ("30 um", "1.9e6 N/mm^3", "590 MPa", "3 mm"),
        ("30 um", "1.9e6 N/mm^3", "inf MPa", "3 mm"),
    ],
)
def test_full_tiling_without_bulk_is_the_one_scale_run(
    macro: str, stiffness: str, hardness: str, distance: str, device: str
) -> None:
    """To 1e-12 in approach, pressures and wear, in every step of a worn run."""
    study = quick(
        patches__macro_cell=macro, patches__width=None, patches__bulk="none", contact__stiffness=stiffness
    )
    study = study.replace({"sliding.distance": distance, "contact.hardness": hardness})
    with (
        warpwear.run(study.replace({"study.model": "micro"}), device=device) as one,
        warpwear.run(study, device=device) as two,
    ):
        assert one.history["approach"].size > 100
        for name in ("approach", "pressure_max", "pressure_mean", "wear_volume_disc", "wear_depth_counter"):
            assert_allclose(two.history[name], one.history[name], rtol=1e-12, err_msg=name)
        for name in ("area_contact", "area_touched", "area_cumulative", "patch_along", "patch_across"):
            assert_allclose(two.history[name], one.history[name], rtol=1e-12, err_msg=name)
        for i in range(one.snapshot_distances.size):
            a, b = one.snapshot(i), two.snapshot(i)
            for name in ("wear_counter", "wear_disc"):
                expected = getattr(a, name)
                assert_allclose(getattr(b, name), expected, rtol=0.0, atol=1e-12 * expected.max())
            # heights sampled patch by patch and all at once are the same sum to its rounding, 1e-17 mm; a
            # pressure below hardness is their difference by the compliance 1/k + (K_s + K_d) ΔL
            wear_per_mm = 1e-3 * (study.wear.counter.value + study.wear.disc.value)
            step = one.history["increment"][np.argmin(np.abs(one.history["distance"] - a.distance))]
            compliance = 1.0 / study.contact.stiffness + wear_per_mm * step
            allowed = 1e-12 * a.pressure.max() + 1e-17 / compliance
            assert_allclose(b.pressure, a.pressure, rtol=0.0, atol=allowed)
            assert_allclose(b.gap, a.gap, rtol=0.0, atol=1e-15)
            assert_array_equal(b.pressure > 0.0, a.pressure > 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_conserved_in_every_step(kind: str, device: str) -> None:
    """The load, each patch's mean wear, the volumes, and what was ever touched."""
    study = of_kind(kind)
    stepped = Stepped(study, device=device)
    wear, load = sum(study.wear_coefficients), study.contact.load
    area = stepped.patches.area
    increments = (3e-3, 3e-3, 3e-3, 0.01, 0.03, 0.1, 0.1, 0.3, 0.3)
    unworn = before = stepped.gap()
    slid = 0.0
    for increment, step in zip(increments, stepped.model.steps((d, True) for d in increments), strict=True):
        row = step.row
        slid += increment
        share = stepped.model.book.table("load_share")[-1]
        assert share.sum() == pytest.approx(load, rel=1e-12)
        assert abs(row["load_residual"]) <= 1e-12 * load
        after = stepped.gap()
        worn = (after - before).mean(axis=(1, 2))
        asked = wear * share / area * increment
        # What is taken off a gap of 0.1 mm is rounded to 1e-17 mm.
        assert_allclose(worn, asked, rtol=1e-12, atol=1e-12 * asked.max())
        for body, k in zip(("counter", "disc"), study.wear_coefficients, strict=True):
            assert row[f"wear_volume_{body}"] == pytest.approx(k * load * slid, rel=1e-10)
            assert row[f"archard_volume_{body}"] == pytest.approx(k * load * slid, rel=1e-12)
        patch, line, column = np.nonzero(after > unworn)
        weight = stepped.patches.weight * study.grid.cell**2
        assert row["area_touched"] == pytest.approx(patch.size * weight, rel=1e-12)
        along = np.ptp(stepped.patches.first_row[patch] + line) + 1
        across = np.ptp(stepped.patches.first_column[patch] + column) + 1
        assert row["patch_along"] == pytest.approx(along * study.grid.cell, rel=1e-12)
        assert row["patch_across"] == pytest.approx(across * study.grid.cell, rel=1e-12)
        before = after


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
        ahead, before = (sharing.answer.numpy().copy(), [field.numpy().copy() for field in _trial(sharing)])
        base, offset = courses["base_next"].numpy(), courses["offset_next"].numpy()
        for field, values in zip(_trial(sharing), (base, offset), strict=True):
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
        for field, values in zip([sharing.answer, *_trial(sharing)], [ahead, *before], strict=True):
            field.assign(values)
    assert compared > stepped.patches.count


def _carried(gap: FloatArray, at: FloatArray, c: float, hardness: float) -> FloatArray:
    return np.clip((at[:, None] - gap) / c, 0.0, hardness).mean(axis=1)


def reference_step(
    gap: FloatArray, *, c: float, hardness: float, spring: float, area: float, load: float
) -> tuple[float, FloatArray, FloatArray]:
    """δ, and each patch's approach and mean pressure, by bisection in bisection. gap: (patches, cells)."""

    def at(delta: float) -> FloatArray:
        low = np.full(gap.shape[0], delta - hardness / spring)
        high = np.full(gap.shape[0], delta)
        for _ in range(46):
            middle = 0.5 * (low + high)
            short = middle + _carried(gap, middle, c, hardness) / spring < delta
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        return 0.5 * (low + high)

    low, high = float(gap.min()), float(gap.max())
    for _ in range(46):
        delta = 0.5 * (low + high)
        if area * _carried(gap, at(delta), c, hardness).sum() < load:
            low = delta
        else:
            high = delta
    u = at(delta)
    return delta, u, _carried(gap, u, c, hardness)


@pytest.mark.parametrize("spring", [1.9e6, 3e3])
def test_a_bulk_spring_in_series_against_bisection(spring: float) -> None:
    """Over a worn run: every patch's approach and load, δ and the gap, within what bisection resolves."""
    study = quick(
        grid__cell="25 um", patches__macro_cell="100 um", patches__width="100 um", grid__extent="1 mm"
    )
    study = study.replace({"contact.bulk_stiffness": f"{spring} N/mm^3"})
    stepped = Stepped(study)
    gap = stepped.gap().reshape(stepped.patches.count, -1)
    wear = sum(study.wear_coefficients)
    for increment in (0.003, 0.1, 3.0, 3.0, 10.0):
        delta, u, p = reference_step(
            gap,
            c=wear * increment,
            hardness=study.hardness,
            spring=spring,
            area=stepped.patches.area,
            load=study.contact.load,
        )
        step = stepped.model.advance(increment)
        sharing = stepped.model.sharing
        approaches = sharing.approaches
        shares = stepped.model.book.table("load_share")[-1] / stepped.patches.area
        assert step.row["approach"] == pytest.approx(delta, abs=1e-11)
        assert_allclose(shares, p, rtol=0.0, atol=1e-6 * p.max())
        touching = p > 1e-6 * p.max()
        assert_allclose(approaches[touching], u[touching], rtol=0.0, atol=1e-11)
        assert sharing.search["spring_residual"] <= 1e-12 * shares.max() / spring
        series = approaches + shares / spring
        allowed = 2e-12 * shares.max() / spring + 1e-15
        assert_allclose(series[touching], step.row["approach"], rtol=0.0, atol=allowed)
        pressure = np.clip((approaches[:, None] - gap) / (wear * increment), 0.0, study.hardness)
        gap = gap + wear * increment * pressure


@pytest.mark.parametrize("distance", ["10 mm", pytest.param("2400 mm", marks=pytest.mark.slow)])
def test_iterations_and_residuals_of_a_run(distance: str) -> None:
    with warpwear.run(quick(sliding__distance=distance)) as result:
        assert np.median(result.history["evaluations"]) <= 7.0  # and one that was made ahead
        assert np.abs(result.history["load_residual"]).max() <= 1e-12 * 8.0
        assert_allclose(result.load_share.sum(axis=1), 8.0, rtol=1e-12)
        assert_allclose(result.area_patch.sum(axis=1), result.history["area_contact"], rtol=1e-12)
        assert result.load_share.shape == (result.history["distance"].size, 900)
        assert max(map(abs, result.summary["conservation_relative"].values())) < 1e-10


@pytest.mark.parametrize("kind", ["no bulk", "bulk", "load"])
def test_a_step_that_does_not_converge_stops_the_run(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("warpwear.models.patches.shares.MAX_EVALUATIONS", 3)
    with pytest.raises(ConvergenceError, match=r"did not converge .*[0-9] (N|MPa) of") as caught:
        warpwear.run(of_kind(kind))
    assert "\n" not in str(caught.value)


#: Mean pressures of patches, their slopes, and how far these are a straight line, at base + offset.
Response = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]]


def _trial(sharing: LoadSharing) -> tuple[Field, Field]:
    """Base and offset of the approach of every patch [mm]."""
    return sharing.base, sharing.offset


def _common(sharing: LoadSharing) -> tuple[float, float]:
    """Approach of the bodies, base and offset [mm]."""
    return sharing.search["common_base"], sharing.search["bracket"][0]


class Shared:
    """The search of a step, of patches that answer in NumPy."""

    def __init__(self, lowest: FloatArray, response: Response, **task: float) -> None:
        self._executor = Executor(Grid(lowest.size, 8, 1.0))
        self.sharing = LoadSharing(self._executor, lowest, **task)
        self._program, self._response, self._lowest = Program(self._executor), response, lowest
        self.sharing.add_to(self._program, lambda: self._program.call(self._answer))

    def _answer(self) -> None:
        base, offset = (field.numpy() for field in _trial(self.sharing))
        self.sharing.answer.assign(np.array(self._response(base, offset)))

    def solve(self, flexibility: float, *, step: float) -> None:
        """Share the load from where the last solve has ended, or from the lowest cell."""
        sharing, load = self.sharing, self.sharing.load
        pressure, is_first = self.pressure, not self.sharing.search["evaluations"]
        approach = float(self._lowest.min()) if is_first else sum(_common(sharing))
        start = np.where(pressure > 0.0, sharing.approaches, approach)
        sharing.base.assign(start)
        sharing.offset.fill_(step)
        for ends, end in (
            (sharing.curves.low, (-np.inf, -np.inf, 0.0)),
            (sharing.curves.high, (np.inf, np.inf, load.hardness)),
        ):
            ends.assign(np.full(start.size, np.array(end, dtype=ends.numpy().dtype)))
        low = 0.0 if is_first else -1e300
        bracket = (step, low, 1e300, abs(step), 1e300, 0, 0)  # by `kernels.newton.Bracket`
        numbers = dict.fromkeys(("evaluations", "bracketed", "waited", "number"), 0)
        sharing.search.set(flexibility=flexibility, common_base=approach, bracket=bracket, **numbers)
        for flag in (sharing.flags.searching, sharing.flags.unanswered):
            flag.fill_(1)
        self._program.run()
        assert sharing.is_balanced

    @property
    def pressure(self) -> FloatArray:
        """Mean of every patch [MPa]."""
        return self.sharing.answer.numpy()[0].copy()


def _staircase(base: FloatArray, offset: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Flat treads joined by steep risers: Newton's method alone leaps to and fro."""
    u = base + offset
    whole = np.floor(u * 1e4)
    part = np.clip((u * 1e4 - whole - 0.99) * 100.0, 0.0, 1.0)
    p = np.clip((whole + part) * 1e-1, 0.0, 40.0)
    slope = np.where((part > 0.0) & (p > 0.0) & (p < 40.0), 1e5, 0.0)
    return p, slope, np.zeros_like(p)


@pytest.mark.parametrize("flexibility", [0.0, 1e-6, 1e-3, 1.0])
def test_the_safeguards_hold_where_newton_leaps(flexibility: float) -> None:
    heights = np.linspace(0.0, 3e-3, 7)
    shared = Shared(np.zeros(7), lambda b, o: _staircase(b - heights, o), load=40.0, area=1.0, hardness=40.0)
    shared.solve(flexibility, step=1e-5)
    pressure = shared.pressure
    assert pressure.sum() == pytest.approx(40.0, rel=1e-12)
    at = shared.sharing.approaches + flexibility * pressure
    carrying = pressure > 0.0
    assert_allclose(at[carrying], sum(_common(shared.sharing)), rtol=1e-11)


class _Cells:
    """Patches on a capped foundation, in NumPy."""

    def __init__(self, gap: FloatArray, c: float, hardness: float) -> None:
        self.gap, self.c, self._hardness = gap, c, hardness

    def pressures(self, base: FloatArray, offset: FloatArray) -> FloatArray:
        return np.clip(((base[:, None] - self.gap) + offset[:, None]) / self.c, 0.0, self._hardness)

    def response(self, base: FloatArray, offset: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        p = self.pressures(base, offset)
        overlap = (base[:, None] - self.gap) + offset[:, None]
        between = (p > 0.0) & (p < self._hardness)
        nearest = np.minimum(np.abs(overlap), np.abs(overlap - self.c * self._hardness))
        return p.mean(axis=1), between.mean(axis=1) / self.c, nearest.min(axis=1)


def test_springs_behind_cells_that_are_almost_rigid() -> None:
    """c H from far above to far below the spacing of numbers at the approaches, cold and after a worn step.

    What is returned is put into the equations, which have one solution.
    """
    drawn = np.random.default_rng(1)
    hardness, cell = 590.0, 1e-4
    for _ in range(40):
        count, cells = int(drawn.integers(2, 60)), int(drawn.integers(4, 400))
        gap = drawn.normal(0.0, 3e-3, (count, cells)) + drawn.exponential(0.01, (count, 1))
        gap = np.round(gap, 5) if drawn.random() < 0.3 else gap  # ties
        area = cells * cell
        load = count * area * hardness * 10.0 ** drawn.uniform(-3.5, -0.1)
        spring = 10.0 ** drawn.uniform(2.0, 7.5)
        of_cells = _Cells(gap, 0.0, hardness)
        shared = Shared(gap.min(axis=1), of_cells.response, load=load, area=area, hardness=hardness)
        for of_cells.c in 10.0 ** drawn.uniform(-18.0, -6.0, 2):
            shared.solve(1.0 / spring, step=0.5 * hardness * of_cells.c)
            base, offset = (field.numpy() for field in _trial(shared.sharing))
            pressures = of_cells.pressures(base, offset)
            p = pressures.mean(axis=1)
            assert area * p.sum() == pytest.approx(load, rel=2e-12)
            common_base, common_offset = _common(shared.sharing)
            deflection = (common_base - base) + (common_offset - offset)
            allowed = 2e-12 * p.max() / spring + 1e-17  # and the rounding of lengths near 0.05 mm
            assert np.abs(deflection - p / spring)[p > 0.0].max() <= allowed
            assert (deflection[p == 0.0] <= allowed).all()
            assert shared.sharing.search["evaluations"] < 400
            of_cells.gap = of_cells.gap + of_cells.c * pressures


@pytest.mark.parametrize("first", ["1e-6 mm", "1e-10 mm"])
def test_a_run_may_begin_with_any_step(first: str) -> None:
    changes = {"stepping.first": first, "stepping.growth": 10.0, "sliding.distance": "1 mm"}
    with warpwear.run(quick().replace(changes)) as result:
        assert np.abs(result.history["load_residual"]).max() <= 1e-12 * 8.0
        assert max(map(abs, result.summary["conservation_relative"].values())) < 1e-10


def test_a_smooth_contact_prescribes_the_loads() -> None:
    """Its shares are those of a capped Winkler foundation of its own, worn by itself (in NumPy)."""
    study = of_kind("load")
    stepped = Stepped(study)
    x, n = study.cells.x, stepped.patches.across
    r2 = x[:, None] ** 2 + x[None, :] ** 2
    gap = (r2 / (3.0 + np.sqrt(9.0 - r2))).reshape(n, -1, n, stepped.patches.side).mean(axis=(1, 3)).ravel()
    wear, foundation, area = sum(study.wear_coefficients), study.bulk_stiffness(), stepped.patches.area
    for increment in (0.003, 0.01, 0.1, 1.0, 3.0, 3.0):
        stepped.model.advance(increment)
        c = 1.0 / foundation + wear * increment
        low, high = gap.min(), gap.min() + 1.0
        for _ in range(70):
            middle = 0.5 * (low + high)
            p = np.clip((middle - gap) / c, 0.0, study.hardness)
            low, high = (middle, high) if area * p.sum() < study.contact.load else (low, middle)
        found = stepped.model.book.table("load_share")[-1]
        assert_allclose(found, area * p, rtol=0.0, atol=1e-9)
        assert found.max() <= study.hardness * area * (1.0 + 1e-12)
        gap = gap + wear * increment * p


def test_prescribed_loads_add_up_well_within_the_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where every patch and the smooth contact stop on the same side, as far off as they may."""
    stepped = Stepped(of_kind("load"))
    load, area = stepped.study.contact.load, stepped.patches.area
    with monkeypatch.context() as patch:
        patch.setattr("warpwear.models.patches.shares.TOLERANCE", 1e-6)
        smooth = SmoothContact(stepped.study.contact_task, stepped.patches, stepped.executor)
    wear = 0.003 * sum(stepped.study.wear_coefficients)
    target = smooth.press(foundation=stepped.study.bulk_stiffness(), removal=wear)
    assert area * target.sum() == pytest.approx(load, rel=1e-14)

    lowest = np.zeros(target.size)
    sharing = LoadSharing(stepped.executor, lowest, load=load, area=area, hardness=np.inf)

    def answer() -> None:
        """Straight, and a slope that is wrong by a millionth: what is left after a step is as much of it."""
        base, offset = (field.numpy() for field in _trial(sharing))
        p = 1e5 * np.maximum(base + offset, 0.0)
        sharing.answer.assign(np.stack([p, np.full_like(p, 1e5 * (1.0 + 0.9e-6)), np.zeros_like(p)]))

    sharing.base.assign(1e-5 * target * (1.0 - 1e-6) - 1e-4)
    sharing.offset.fill_(1e-4)
    brackets = smooth.brackets.numpy()
    for name, value in {"offset": 1e-4, "low": -1e300, "high": 1e300, "reach": 1e-4, "width": 1e300}.items():
        brackets[name] = value
    program = Program(stepped.executor)
    smooth.add_to(program, sharing, lambda: program.call(answer))
    sharing.flags.searching.fill_(1)
    program.run()
    assert sharing.is_balanced
    assert abs(sharing.search["residual"]) < 0.6e-12 * load


def test_patches_of_a_field_come_back() -> None:
    field = np.random.default_rng(0).random((180, 180))
    tiling = quick(grid__extent="1.8 mm").patch_layout
    assert_array_equal(tiling.on_domain(tiling.stored(field)), field)
    for rule in ("centre", "random"):
        some = (
            of_kind("some of the area").replace({"patches.placement": rule, "patches.seed": 3}).patch_layout
        )
        back = some.on_domain(some.stored(field), beside=-1.0)
        covered = back != -1.0
        assert_array_equal(back[covered], field[covered])
        assert covered.sum() == some.count * some.side**2
        assert some.weight == pytest.approx(9.0)
        inside = (some.first_row % some.pitch) + some.side
        assert inside.max() <= some.pitch
    assert len(set(some.first_row % some.pitch)) > 1


def test_threads_change_nothing(threads: int) -> None:
    study = of_kind("bulk")
    runs = [Stepped(study, threads=count) for count in (1, threads)]
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
