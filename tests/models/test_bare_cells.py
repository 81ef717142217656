"""A film that wear breaks and junctions that grow: caps of cells, against NumPy, in every model."""

import math
from typing import Any

import cases_half_space
import numpy as np
import pytest
from cases_bare import BARE, FILM, FILMED, GROWN, STUDIES, history_of, needs_transforms
from numpy.testing import assert_allclose, assert_array_equal

from warpwear import Study
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.contact.half_space.window import WindowedHalfSpace
from warpwear.contact.search import LoadSearch
from warpwear.engine.executor import Executor
from warpwear.engine.tiles import Tiles
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING
from warpwear.runs.order import RunOrder

PARTS = np.array([1.0, BARE / FILMED])
#: Half as far where a step is dear.
SHORT = {
    law: study.replace({"sliding.distance": (0.5 * study.sliding.total, "mm")}) if "half" in law else study
    for law, study in STUDIES.items()
}
#: Other ways to the same contact: blocks and lookahead without a film, larger windows with one.
AT_REST = {"rest": 1e-9, "rest, across": 1e-9, "two scales": 1e-9}
AT_REST |= {"rest, half-space": 1e-6, "two scales, half-space": 1e-6}


def rough(grid: Grid, *, seed: int = 1) -> tuple[FloatArray, FloatArray]:
    """A gap [mm] and the parts of the hardness that its cells bear."""
    rng = np.random.default_rng(seed)
    return rng.normal(0.0, 1e-3, grid.shape), rng.choice(PARTS, grid.shape)


# Which approach carries the load, where every cell has a cap of its own.


def test_a_foundation_with_caps(device: str, threads: int) -> None:
    grid = Grid(40, 37, 0.01)
    gap, parts = rough(grid)
    load, compliance = 4.0, 2e-6
    with Executor(grid, device=device, threads=threads) as executor:
        field = executor.field(gap.copy(), padding=PADDING)
        own = executor.field(parts, padding=1.0)
        tiles = Tiles(executor, field, field, least=10.0)
        stiffness = executor.field(np.full((1, 1), 1.0 / compliance), padding=1.0 / compliance)
        search = LoadSearch(
            executor, field, tiles, load=load, hardness=590.0, stiffness=stiffness, cap_ratio=own
        )
        found = search.solve()
        pressure = search.pressures().copy()
    low, high = gap.min(), gap.max() + 1.0
    for _ in range(200):
        level = 0.5 * (low + high)
        expected = np.clip((level - gap) / compliance, 0.0, 590.0 * parts)
        low, high = (level, high) if expected.sum() * grid.cell_area < load else (low, level)
    assert found.approach == pytest.approx(level, rel=1e-12)
    assert_allclose(pressure, expected, atol=1e-6)
    assert len(np.unique(parts[pressure == 590.0 * parts])) == 2  # both kinds of caps are reached


def test_a_bearing_area_with_caps(device: str, threads: int) -> None:
    grid = Grid(40, 37, 0.01)
    gap, parts = rough(grid, seed=2)
    load = 4.0
    with Executor(grid, device=device, threads=threads) as executor:
        field = executor.field(gap.copy(), padding=PADDING)
        tiles = Tiles(executor, field, field, least=10.0)
        own, tolerance = executor.field(parts, padding=1.0), 590.0 * grid.cell_area
        search = LoadSearch(
            executor, field, tiles, load=load, hardness=590.0, tolerance=tolerance, cap_ratio=own
        )
        found = search.solve()
        pressure = search.pressures().copy()
    below = gap < found.approach
    carried = 590.0 * parts[below].sum() * grid.cell_area
    assert abs(carried - load) <= 590.0 * grid.cell_area
    assert found.load_residual == pytest.approx(carried - load, abs=1e-9)
    assert_allclose(pressure, np.where(below, 590.0 * parts * load / carried, 0.0), rtol=1e-12)


def test_tied_cells_share_what_is_missing_by_their_caps(device: str) -> None:
    grid = Grid(8, 8, 0.01)
    gap, parts = np.zeros(grid.shape), rough(grid)[1]
    load = 0.5 * 590.0 * parts.sum() * grid.cell_area
    with Executor(grid, device=device, threads=1) as executor:
        field = executor.field(gap, padding=PADDING)
        tiles = Tiles(executor, field, field, least=10.0)
        own = executor.field(parts, padding=1.0)
        search = LoadSearch(executor, field, tiles, load=load, hardness=590.0, cap_ratio=own, tolerance=1e-6)
        search.solve()
        pressure = search.pressures()
        assert_allclose(pressure, 0.5 * 590.0 * parts, rtol=1e-9)


def by_active_sets(matrix: FloatArray, pull: FloatArray, cap: FloatArray) -> FloatArray:
    """argmin ½ p·Gp − p·pull, 0 ≤ p ≤ cap: cells between the bounds by dense matrices, until none changes."""
    state = np.zeros(pull.size, dtype=int)  # -1 at 0, 0 between, 1 at the cap
    scale = matrix.diagonal().max()
    for _ in range(100):
        between, p = state == 0, np.where(state == 1, cap, 0.0)
        right = pull[between] - matrix[np.ix_(between, ~between)] @ p[~between]
        p[between] = np.linalg.solve(matrix[np.ix_(between, between)], right)
        wanted = p + (pull - matrix @ p) / scale
        after = np.where(wanted <= 0.0, -1, np.where(wanted >= cap, 1, 0))
        if (after == state).all():
            return p
        state = after
    raise AssertionError("the reference did not converge")


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("compliance", [0.0, 0.05])
def test_a_half_space_with_a_field_of_caps(
    device: str, threads: int, boundary: str, compliance: float
) -> None:
    if device != "cpu":
        pytest.importorskip("cupy")
    grid = Grid(24, 24, 0.5) if boundary == "free" else Grid(16, 15, 0.5)
    gap = cases_half_space.rough(grid, seed=3)
    cap = np.random.default_rng(4).choice([1.0, 0.4], grid.shape) * 1.1
    mean = 0.3
    with Executor(grid, device=device, threads=threads) as executor:
        modulus = cases_half_space.MODULUS
        solver = HalfSpace(executor, modulus=modulus, boundary=boundary, hardness=1.1, tolerance=1e-11)
        parts = executor.field(cap / 1.1, padding=1.0)
        field = executor.field(gap, padding=PADDING)
        found = solver.solve(field, mean_pressure=mean, compliance=compliance, cap_ratio=parts)
        pressure, approach = found.pressure.copy(), found.approach
        # From a pressure that the caps have fallen below.
        solver.solve(field, mean_pressure=mean, compliance=compliance)
        again = solver.solve(
            field, mean_pressure=mean, compliance=compliance, cap_ratio=parts
        ).pressure.copy()
    dense = cases_half_space.dense_free if boundary == "free" else cases_half_space.dense_periodic
    matrix = dense(grid) + compliance * np.eye(grid.cells)
    expected = by_active_sets(matrix, approach - gap.ravel(), cap.ravel()).reshape(grid.shape)
    assert_allclose(pressure.mean(), mean, rtol=1e-12)
    assert_allclose(pressure, expected, atol=1e-7)
    assert_allclose(again, expected, atol=1e-7)
    for kind in np.unique(cap):
        assert 0 < np.count_nonzero(pressure[cap == kind] == kind) < np.count_nonzero(cap == kind)


def test_the_window_of_a_half_space_takes_its_caps_along(device: str) -> None:
    if device != "cpu":
        pytest.importorskip("cupy")
    grid = Grid(80, 72, 0.5)
    x, y = grid.x[:, np.newaxis], grid.y
    gap = 0.02 * ((x - 3.0) ** 2 + (y + 4.0) ** 2) + 0.2 * cases_half_space.rough(grid)
    parts = np.random.default_rng(4).choice([1.0, 0.4], grid.shape)
    options: dict[str, Any] = {"modulus": cases_half_space.MODULUS, "boundary": "free", "hardness": 1.1}
    with Executor(grid, device=device, threads=1) as executor:
        field, own = executor.field(gap, padding=PADDING), executor.field(parts, padding=1.0)
        windowed = WindowedHalfSpace(executor, **options, tolerance=1e-11)
        for load in (20.0, 60.0, 5.0):  # larger than the window of the last one, and smaller
            found = windowed.solve(field, load=load, cap_ratio=own, least_cap_ratio=0.4)
            whole = HalfSpace(executor, **options, tolerance=1e-11)
            every = whole.solve(field, mean_pressure=load / grid.area, cap_ratio=own)
            assert_allclose(found.pressure, every.pressure, atol=1e-8)
        assert windowed._window is not None
        assert windowed._window.end_row - windowed._window.first_row < 80


# Every model, with a film that is there everywhere, or nowhere.


@pytest.mark.parametrize("law", STUDIES)
def test_a_film_that_never_breaks_is_its_shear_strength(law: str, device: str) -> None:
    study = SHORT[law]
    needs_transforms(study, device)
    uniform = study.replace(GROWN | {"friction.shear_strength": "40 MPa"})
    film = study.replace(FILM | {"friction.film.thickness": "1 mm"})
    one, other = (history_of(s, device=device) for s in (uniform, film))
    assert (other.pop("bare_fraction") == 0.0).all()
    for name in one.keys() - {"evaluations"}:
        if law in AT_REST or device != "cpu":
            if name.startswith(("violation", "energy_gap")):  # what each solve leaves
                continue
            assert_allclose(other[name], one[name], rtol=AT_REST.get(law, 1e-6), atol=1e-9, err_msg=name)
        else:
            assert_array_equal(other[name], one[name], err_msg=name)


def bared(study: Study, device: str, threads: int) -> tuple[FloatArray, dict[str, float]]:
    """Pressure and row of a first step before which every cell has lost more than its film."""
    order = RunOrder(study)
    with order.arrangement.executor(study, device=device, threads=threads) as executor:
        model: Any = order.model(executor).model
        holder = getattr(model, "contact", model)
        features = getattr(holder, "features", None) or getattr(holder, "_features", None)
        if features:
            features.sources.films.thickness = -1.0
        step = model.advance(order.plan[0][0], with_pressure=True)
        return step.pressure.copy(), step.row


@pytest.mark.parametrize("law", STUDIES)
def test_where_all_is_bare_the_film_is_gone(law: str, device: str, threads: int) -> None:
    study = STUDIES[law]
    needs_transforms(study, device)
    uniform = study.replace(GROWN | {"friction.shear_strength": "172 MPa"})
    pressure, row = bared(study.replace(FILM), device, threads)
    expected, without = bared(uniform, device, threads)
    assert row["bare_fraction"] == 1.0
    tolerance = 1e-4 if "half-space" in law else 1e-7  # what the search leaves
    assert_allclose(pressure, expected, atol=tolerance * BARE)
    assert row["area_contact"] == pytest.approx(without["area_contact"], rel=1e-9)
    assert row["area_plastic"] == pytest.approx(without["area_plastic"], rel=1e-9)


# Growing junctions without a film.


def test_a_uniform_shear_makes_a_bearing_area_grow_as_tabor_says(device: str) -> None:
    static = {"sliding.distance": "0 mm", "stepping.scheme": "explicit", "stepping.force": True}
    static |= {"grid.cell": "2 um", "grid.extent": "0.6 mm", "contact.hardness": "590 MPa"}
    study = Study.load("v3-fine").replace(static)
    one = history_of(study, device=device)["area_contact"][0]
    for alpha, tau in ((9.0, 172.0), (27.0, 100.0)):
        sheared = {"friction.shear_strength": f"{tau} MPa", "friction.junction_growth": alpha}
        other = history_of(study.replace(sheared), device=device)
        assert other["area_contact"][0] / one == pytest.approx(
            1.0 / math.sqrt(1.0 - alpha * (tau / 590.0) ** 2), rel=0.02
        )
        assert other["cof"][0] == pytest.approx(tau * other["area_contact"][0] / 8.0)


@pytest.mark.parametrize("law", STUDIES)
def test_a_uniform_shear_is_a_run_with_that_hardness(law: str, device: str) -> None:
    study = SHORT[law]
    needs_transforms(study, device)
    grown = study.replace(GROWN | {"friction.shear_strength": "172 MPa"})
    softer = study.replace({"friction.shear_strength": "172 MPa", "contact.hardness": (BARE, "MPa")})
    one, other = history_of(softer, device=device), history_of(grown, device=device)
    for name, values in one.items():
        assert_array_equal(other[name], values, err_msg=name)


def test_friction_is_the_mixture_where_all_is_plastic() -> None:
    history = history_of(STUDIES["track, bearing area"].replace(FILM))
    bare = history["bare_fraction"]
    mixture = (40.0 * (1.0 - bare) + 172.0 * bare) / (FILMED * (1.0 - bare) + BARE * bare)
    assert bare.max() > 0.5
    assert_allclose(history["cof"], mixture, rtol=0.05)
    implicit = history_of(STUDIES["track"].replace(FILM))["bare_fraction"]
    assert ((implicit >= 0.0) & (implicit <= 1.0)).all()
