"""The load that patches share: against bisection, a foundation of its own, and hostile answers in NumPy."""

from collections.abc import Callable

import numpy as np
import pytest
from cases_stepped import Stepped, trial
from cases_two_scale import of_kind, quick
from numpy.testing import assert_allclose

from warpwear.engine.executor import Executor
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid
from warpwear.models.patches.shares import LoadSharing, SmoothContact


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


#: Mean pressures of patches, their slopes, and how far these are a straight line, at base + offset.
Response = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]]


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
        base, offset = (field.numpy() for field in trial(self.sharing))
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
            base, offset = (field.numpy() for field in trial(shared.sharing))
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


def test_a_smooth_contact_prescribes_the_loads() -> None:
    """Its shares are those of a capped Winkler foundation of its own, worn by itself (in NumPy)."""
    study = of_kind("load")
    stepped = Stepped(study)
    x, n = study.cells.x, stepped.patches.across
    r2 = x[:, None] ** 2 + x[None, :] ** 2
    gap = (r2 / (3.0 + np.sqrt(9.0 - r2))).reshape(n, -1, n, stepped.patches.side).mean(axis=(1, 3)).ravel()
    wear, foundation, area = sum(study.wear_coefficients), study.pair.bulk_stiffness, stepped.patches.area
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
    target = smooth.press(foundation=stepped.study.pair.bulk_stiffness, removal=wear)
    assert area * target.sum() == pytest.approx(load, rel=1e-14)

    lowest = np.zeros(target.size)
    sharing = LoadSharing(stepped.executor, lowest, load=load, area=area, hardness=np.inf)

    def answer() -> None:
        """Straight, and a slope that is wrong by a millionth: what is left after a step is as much of it."""
        base, offset = (field.numpy() for field in trial(sharing))
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
