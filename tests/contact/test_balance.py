"""Load balance and worn runs against the independent NumPy reference, on every device and thread count."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
import reference
from numpy.testing import assert_allclose, assert_array_equal
from reference import FloatArray

from warpwear import Study
from warpwear.contact.balance import Balance
from warpwear.contact.search import LoadSearch
from warpwear.engine.executor import Executor
from warpwear.engine.tiles import Tiles
from warpwear.grid import Grid
from warpwear.kernels.cells import LANES, PADDING
from warpwear.runs.arrangements import model_at_rest

SHAPES = [(37, 53), (64, 64), (5, 131)]
CELL = 0.01
HARDNESS = 590.0


def rough(shape: tuple[int, int], seed: int) -> FloatArray:
    """Heights of a smoothed random surface [mm], Sq 3 µm, mean zero."""
    white = np.random.default_rng(seed).standard_normal(shape)
    waves = np.hypot(*np.meshgrid(*(np.fft.fftfreq(n) for n in shape), indexing="ij"))
    heights = np.fft.ifft2(np.fft.fft2(white) / (0.05 + waves) ** 1.8).real
    return 3.0e-3 * (heights - heights.mean()) / heights.std()


def spike(shape: tuple[int, int], seed: int) -> FloatArray:
    gap = rough(shape, seed)
    gap[shape[0] // 3, shape[1] // 2] = gap.min() - 0.02
    return gap


def plateaus(shape: tuple[int, int], seed: int) -> FloatArray:
    """Gaps cut off at two levels: a quarter of the cells tie exactly, another tenth does so lower down."""
    gap = rough(shape, seed)
    gap = np.maximum(gap, np.quantile(gap, 0.35))
    low = np.random.default_rng(seed).random(shape) < 0.1
    return np.where(low, gap.min() - 2.0e-3, gap)


def ties(shape: tuple[int, int], seed: int) -> FloatArray:
    """Heights in whole tenths of a micrometre: every level is shared."""
    return np.round(rough(shape, seed) * 1.0e4) * 1.0e-4


def flat(shape: tuple[int, int], seed: int) -> FloatArray:
    """Everything at one gap."""
    return np.full(shape, 1.0e-3 * (seed + 1))


def counter(shape: tuple[int, int], seed: int) -> FloatArray:
    """A smooth ball (seed 0) or a rough one: symmetric ties, and gaps up to far beyond the contact."""
    grid = Grid(*shape, CELL)
    return reference.counter_gap(grid.x, grid.y, 3.0, rough(shape, seed) if seed else 0.0)


GAPS: list[Callable[[tuple[int, int], int], FloatArray]] = [rough, spike, plateaus, ties, flat, counter]


class Solver:
    """The package's balance of one gap, and the pressures it stands for."""

    def __init__(self, executor: Executor, gap: FloatArray) -> None:
        self._executor = executor
        padded = np.full((gap.shape[0], executor.vectors * LANES), PADDING)
        padded[:, : gap.shape[1]] = gap
        self._gap = executor.field(padded)
        self.shape = gap.shape

    def foundation(self, compliance: float | FloatArray, load: float, hardness: float) -> Balance:
        values = np.atleast_2d(1.0 / np.asarray(compliance))
        values = np.broadcast_to(values, (values.shape[0], self.shape[1]))
        return self._solve(load, hardness, stiffness=self._executor.field(values.copy()))

    def bearing(self, load: float, hardness: float, tolerance: float) -> Balance:
        return self._solve(load, hardness, tolerance=tolerance)

    def _solve(self, load: float, hardness: float, **options: Any) -> Balance:
        """On a list of tiles as short as it may be: the balance asks for more."""
        tiles = Tiles(self._executor, self._gap, self._gap, least=load / (hardness * CELL**2))
        self._search = LoadSearch(self._executor, self._gap, tiles, load=load, hardness=hardness, **options)
        return self._search.solve()

    def pressures(self, balance: Balance) -> FloatArray:
        return self._search.pressures(balance).copy()


def loads(cells: int, hardness: float) -> list[float]:
    """From half a cell's force at 590 MPa to 99 % of what the domain carries."""
    reach = min(hardness, HARDNESS) * CELL**2
    return [0.5 * reach, 0.037 * cells * reach, 0.61 * cells * reach, 0.99 * cells * reach]


@cache
def expected_of(
    make: Callable[..., FloatArray],
    seed: int,
    shape: tuple[int, int],
    *,
    compliance: float,
    load: float,
    hardness: float,
) -> reference.Contact:
    """The reference's contact, for every device and number of threads."""
    return reference.foundation(make(shape, seed), compliance, load, hardness, CELL)


@pytest.mark.parametrize("make", GAPS)
@pytest.mark.parametrize("hardness", [HARDNESS, np.inf])
@pytest.mark.parametrize("compliance", [1.0e-10, 3.0e-8, 1.0e-5])
def test_foundation_equals_reference(
    make: Callable[..., FloatArray], compliance: float, hardness: float, device: str, threads: int
) -> None:
    """p = clip((δ − g)/c, 0, H), h² Σ p = F: the same cells, approach and pressures to 1e-12."""
    for seed, shape in enumerate(SHAPES):
        gap = make(shape, seed)
        with Executor(Grid(*shape, CELL), device=device, threads=threads) as executor:
            solver = Solver(executor, gap)
            for load in loads(gap.size, hardness):
                asked = {"compliance": compliance, "load": load, "hardness": hardness}
                expected = expected_of(make, seed, shape, **asked)
                balance = solver.foundation(compliance, load, hardness)
                _assert_same_contact(solver.pressures(balance), balance, expected, load)
                assert_allclose(balance.approach, expected.approach, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("per", ["column", "cell"])
@pytest.mark.parametrize("hardness", [HARDNESS, np.inf])
def test_foundation_with_a_compliance_per_cell(per: str, hardness: float, device: str, threads: int) -> None:
    """The distance factor makes c a row or a field (compliances within a factor of 3)."""
    for seed, shape in enumerate(SHAPES):
        gap = rough(shape, seed)
        random = np.random.default_rng(100 + seed).random((1 if per == "column" else shape[0], shape[1]))
        compliance = 1.0e-7 * (1.0 + 2.0 * random)
        with Executor(Grid(*shape, CELL), device=device, threads=threads) as executor:
            solver = Solver(executor, gap)
            for load in loads(gap.size, hardness):
                expected = reference.foundation(gap, compliance, load, hardness, CELL)
                balance = solver.foundation(compliance, load, hardness)
                _assert_same_contact(solver.pressures(balance), balance, expected, load)


def _assert_same_contact(
    pressure: FloatArray, balance: Balance, expected: reference.Contact, load: float
) -> None:
    assert abs(balance.load_residual) <= 1e-12 * load
    assert_allclose(pressure.sum() * CELL**2, load, rtol=2e-12)
    assert_array_equal(pressure > 0.0, expected.pressure > 0.0)
    assert_array_equal(pressure >= balance.cap, expected.plastic)
    # Two balances with residuals of 1e-12 F each: all pressures together differ by no more than both, though
    # one cell may have to take all of it where the others are at hardness.
    assert np.abs(pressure - expected.pressure).sum() * CELL**2 <= 2e-12 * load


@pytest.mark.parametrize("make", GAPS)
def test_bearing_area_equals_reference(make: Callable[..., FloatArray], device: str, threads: int) -> None:
    """With half a cell of tolerance only one count, or one tie, is possible: the same cells and pressures."""
    one_cell = HARDNESS * CELL**2
    for seed, shape in enumerate(SHAPES):
        gap = make(shape, seed)
        with Executor(Grid(*shape, CELL), device=device, threads=threads) as executor:
            solver = Solver(executor, gap)
            for load in [0.9 * one_cell, *loads(gap.size, HARDNESS)[1:]]:
                expected = reference.bearing(gap, load, HARDNESS, CELL, 0.5 * one_cell)
                balance = solver.bearing(load, HARDNESS, 0.5 * one_cell)
                pressure = solver.pressures(balance)
                assert_array_equal(pressure > 0.0, expected.pressure > 0.0)
                assert_allclose(pressure, expected.pressure, rtol=1e-12)
                assert_allclose(pressure.sum() * CELL**2, load, rtol=1e-12)
                assert_allclose(balance.load_residual, expected.residual, atol=1e-12 * load)
                above = gap[gap > expected.approach + reference.TIE]
                assert expected.approach - reference.TIE <= balance.approach
                assert balance.approach <= above.min(initial=np.inf)


@pytest.mark.parametrize("tolerance", [HARDNESS * CELL**2, 0.5, 5.0])
def test_bearing_area_within_a_loose_tolerance(tolerance: float, device: str, threads: int) -> None:
    """|A H − F| ≤ tolerance, the lowest cells, p = F/A (eqs 4.8–4.11): volumes are exact all the same."""
    for seed, shape in enumerate(SHAPES):
        gap = rough(shape, seed)
        with Executor(Grid(*shape, CELL), device=device, threads=threads) as executor:
            solver = Solver(executor, gap)
            for load in loads(gap.size, HARDNESS)[1:]:
                balance = solver.bearing(load, HARDNESS, tolerance)
                pressure = solver.pressures(balance)
                count = np.count_nonzero(pressure)
                assert abs(count * HARDNESS * CELL**2 - load) <= tolerance
                assert_allclose(balance.load_residual, count * HARDNESS * CELL**2 - load, atol=1e-12 * load)
                assert_array_equal(pressure > 0.0, gap <= np.sort(gap, axis=None)[count - 1])
                assert_allclose(pressure[pressure > 0.0], load / (count * CELL**2), rtol=1e-12)


def study(**changes: object) -> Study:
    """A rough counter-body on a disc; the fields come from the test, so that the grid may be a rectangle."""
    return Study.load("v3").replace(
        {
            "grid.cell": "10 um",
            "grid.extent": "1 mm",
            "stepping.load_tolerance": f"{0.5 * HARDNESS * CELL**2} N",
            **changes,
        }
    )


#: c = 0; finite springs below their stability limit; no springs; springs and a cap.
RUNS: dict[str, dict[str, object]] = {
    "explicit cells": {"stepping.scheme": "explicit", "stepping.increment": "0.3 mm"},
    "explicit springs": {
        "stepping.scheme": "explicit",
        "stepping.increment": "0.1 mm",
        "contact.stiffness": "2e6 N/mm^3",
        "contact.hardness": "inf MPa",
    },
    "implicit": {"stepping.scheme": "implicit", "contact.hardness": "inf MPa"},
    "implicit springs": {"stepping.scheme": "implicit", "contact.stiffness": "5e5 N/mm^3"},
}
TRANSITION = {
    "wear.law": "transition",
    "wear.severe_counter": "9.4e-3 mm^3/N/m",
    "wear.severe_disc": "2.54e-3 mm^3/N/m",
    "wear.transition_pressure": "300 MPa",
    "wear.transition_width": "100 MPa",
    "stepping.force": True,
}
RUNS |= {f"{kind}, K of the pressure": changes | TRANSITION for kind, changes in RUNS.items()}
#: Where the transition begins and ends, and what K of counter-body and disc are multiplied by.
OVER_PRESSURE = np.array([[250.0, 350.0], [1.0, 10.0], [1.0, 2.0]])
WORN = [(kind, factor) for kind in RUNS for factor in ("none", "across", "radial")]
WORN = [(kind, factor) for kind, factor in WORN if "pressure" not in kind or factor == "none"]
GROWING = {"stepping.first": "3 um", "stepping.growth": 1.2, "stepping.largest": "3 mm"}


def worn_study(kind: str, factor: str) -> Study:
    changes = RUNS[kind] | {"wear.distance_factor": factor}
    return study(**(changes if "stepping.increment" in changes else changes | GROWING))


def increments_of(this: Study) -> FloatArray:
    first, growth, largest = this.increments
    return np.minimum(first * growth ** np.arange(40), largest)


@cache
def worn_as_expected(kind: str, factor: str, shape: tuple[int, int]) -> reference.Run:
    """The reference's run, for every device and number of threads."""
    this, grid = worn_study(kind, factor), Grid(*shape, CELL)
    d2 = grid.y[None, :] ** 2 + (grid.x[:, None] ** 2 if factor == "radial" else 0.0)
    return reference.wear_run(
        reference.counter_gap(grid.x, grid.y, 3.0, rough(shape, 3)),
        load=this.contact.load,
        hardness=this.hardness,
        cell=CELL,
        wear=(9.4e-7, 12.7e-7),
        increments=increments_of(this),
        implicit=this.stepping.scheme == "implicit",
        stiffness=this.contact.stiffness,
        factor=1.0 if factor == "none" else np.sqrt(1.0 - d2 / 9.0),
        tolerance=this.load_tolerance,
        over_pressure=tuple(OVER_PRESSURE) if this.wear.law == "transition" else None,
    )


@pytest.mark.parametrize(("kind", "factor"), WORN)
@pytest.mark.parametrize(
    ("shape", "threads"),
    [((64, 64), 1), ((61, 75), 2)],
    indirect=["threads"],
    ids=["64 x 64, 1 thread", "61 x 75, 2 threads"],
)
def test_worn_run_equals_reference(
    kind: str, factor: str, shape: tuple[int, int], device: str, threads: int
) -> None:
    """40 steps: areas identical, volumes to 1e-12, fields to 1e-10."""
    this, grid, heights = worn_study(kind, factor), Grid(*shape, CELL), rough(shape, 3)
    increments, expected = increments_of(this), worn_as_expected(kind, factor, shape)
    bent = this.wear.law == "transition"
    with Executor(grid, device=device, threads=threads) as executor:
        model = model_at_rest(this.contact_task, heights.copy(), executor)
        steps = list(model.steps((d, True) for d in increments.tolist()))
        last = model.snapshot(steps[-1], 0.0)
        fields, gap = {"wear_counter": last.wear_counter, "wear_disc": last.wear_disc}, last.gap.copy()
    history = {name: np.array([step.row[name] for step in steps]) for name in expected.history}
    for name, values in expected.history.items():
        if name.startswith(("area", "patch")):
            assert_allclose(history[name], values, rtol=1e-13, err_msg=name)
        elif name.startswith(("wear", "pressure_m")):
            # Volumes that are not K F L feel what is left of the load, 1e-12 of it, on the cells between.
            assert_allclose(history[name], values, rtol=1e-11 if bent else 1e-12, err_msg=name)
    assert_allclose(history["pressure_std"], expected.history["pressure_std"], rtol=1e-9, atol=1e-7)
    if not kind.startswith("explicit cells"):  # its approach may lie anywhere between two gaps
        expected_approach = expected.history["approach"]
        assert_allclose(history["approach"], expected_approach, rtol=1e-10 if bent else 1e-12)
    for name, values in fields.items():
        worn = getattr(expected, name)
        assert_array_equal(values > 0.0, worn > 0.0, err_msg=name)
        assert_allclose(values, worn, rtol=1e-10, atol=1e-12 * worn.max(), err_msg=name)
    assert_allclose(gap, expected.gap, rtol=1e-10, atol=1e-15)
    assert_allclose(steps[-1].pressure, expected.pressure, rtol=1e-10, atol=1e-10 * expected.pressure.max())


@pytest.mark.parametrize("kind", RUNS)
def test_threads_do_not_change_a_bit(kind: str, device: str, two_threads: int) -> None:
    """Once more, and with two threads: bit-identical fields and history."""
    changes = RUNS[kind] | {"wear.distance_factor": "none" if "pressure" in kind else "radial"}
    this = study(**(changes if "stepping.increment" in changes else changes | GROWING))
    outcomes = []
    for count in (1, two_threads):
        with Executor(Grid(61, 75, CELL), device=device, threads=count) as executor:
            model = model_at_rest(this.contact_task, rough((61, 75), 4), executor)
            steps = list(model.steps([(0.1, True)] * 30))
            rows = [list(step.row.values()) for step in steps]
            last = model.snapshot(steps[-1], 0.0)
            fields = [field.copy() for field in (last.gap, last.wear_counter, last.wear_disc)]
            outcomes.append((rows, fields))
    assert_array_equal(outcomes[0][0], outcomes[1][0])
    for one, two in zip(outcomes[0][1], outcomes[1][1], strict=True):
        assert_array_equal(one, two)
