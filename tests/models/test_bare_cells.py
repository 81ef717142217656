"""A film that wear breaks and junctions that grow: caps of cells, against NumPy, in every model."""

import json
import math
import re
from pathlib import Path
from typing import Any

import cases_half_space
import numpy as np
import pytest
from cases_figures import drawn, faults_of
from cases_track import small
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Study
from warpwear.contact.balance import Balancer, Foundation
from warpwear.contact.bearing_area import BearingArea
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.contact.half_space.window import WindowedHalfSpace
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.tiles import Tiles
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING
from warpwear.kernels.contact import Law
from warpwear.results.summary_text import summary_text
from warpwear.runs.make import executor_of, model_of, plan_of
from warpwear.study.surface import surface_in

STRENGTHS = {"friction.shear_strength": "172 MPa", "friction.film.shear_strength": "40 MPa"}
GROWN = {"friction.junction_growth": 9.0, "contact.hardness": "590 MPa"}
FILM = STRENGTHS | GROWN | {"friction.film.thickness": "10 nm"}
HALF_SPACE = {"contact.law": "half-space"}
#: Caps under the film and without it [MPa].
FILMED, BARE = math.sqrt(590.0**2 - 9.0 * 40.0**2), math.sqrt(590.0**2 - 9.0 * 172.0**2)
PARTS = np.array([1.0, BARE / FILMED])
REST = {"grid.cell": "20 um", "grid.extent": "0.6 mm", "sliding.distance": "3 mm", "sphere.radius": "1 mm"}
REST |= {"stepping.first": "30 um", "output.snapshots": []}
TWO_SCALE = {"grid.cell": "20 um", "grid.extent": "0.6 mm", "patches.macro_cell": "100 um"}
TWO_SCALE |= {"sliding.distance": "3 mm", "stepping.first": "30 um", "output.snapshots": []}
PATCHED_HALF_SPACE = HALF_SPACE | {"patches.bulk": "none", "contact.boundary": "free"}

STUDIES: dict[str, Study] = {
    "track": small("representative"),
    "track, bearing area": small("full").replace({"stepping.scheme": "explicit", "stepping.force": True}),
    "track, dents": small("full", sliding__plastic="keep", contact__stiffness="2e5 N/mm^3"),
    "track, half-space": small("representative").replace(HALF_SPACE),
    "rest": Study.load("v3-fine").replace(REST),
    "rest, across": Study.load("v3-fine").replace(REST | {"wear.distance_factor": "across"}),
    "rest, half-space": Study.load("v3-fine").replace(REST | HALF_SPACE),
    "two scales": Study.load("two-scale").replace(TWO_SCALE),
    "two scales, half-space": Study.load("two-scale").replace(TWO_SCALE | PATCHED_HALF_SPACE),
}
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


def needs_transforms(study: Study, device: str) -> None:
    if device != "cpu" and study.contact.law == "half-space":
        pytest.importorskip("cupy")


def history_of(study: Study, **options: Any) -> dict[str, FloatArray]:
    with warpwear.run(study, **options) as result:
        return {name: np.array(values) for name, values in result.history.items()}


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
        balancer, law = Balancer(executor), arguments(Law)
        found = balancer.solve(Foundation(field, stiffness, tiles, load, 590.0, parts=own))
        found.fill(law)
        pressure = balancer.pressures(law, stiffness, field, tiles, own).copy()
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
        bearing, balancer, law = BearingArea(executor), Balancer(executor), arguments(Law)
        bearing.parts = executor.field(parts, padding=1.0)
        stiffness = executor.field(np.full((1, 1), 1e300), padding=1e300)
        found = bearing.solve(
            field,
            tiles,
            load=load,
            hardness=590.0,
            tolerance=590.0 * grid.cell_area,
            highest=float(gap.max()),
        )
        found.fill(law)
        pressure = balancer.pressures(law, stiffness, field, tiles, bearing.parts).copy()
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
        bearing, law = BearingArea(executor), arguments(Law)
        bearing.parts = executor.field(parts, padding=1.0)
        found = bearing.solve(field, tiles, load=load, hardness=590.0, tolerance=1e-6, highest=0.0)
        found.fill(law)
        stiffness = executor.field(np.full((1, 1), 1e300), padding=1e300)
        pressure = Balancer(executor).pressures(law, stiffness, field, tiles, bearing.parts)
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
        found = solver.solve(field, mean_pressure=mean, compliance=compliance, parts=parts)
        pressure, approach = found.pressure.copy(), found.approach
        # From a pressure that the caps have fallen below.
        solver.solve(field, mean_pressure=mean, compliance=compliance)
        again = solver.solve(field, mean_pressure=mean, compliance=compliance, parts=parts).pressure.copy()
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
            found = windowed.solve(field, load=load, parts=own, least_part=0.4)
            whole = HalfSpace(executor, **options, tolerance=1e-11)
            every = whole.solve(field, mean_pressure=load / grid.area, parts=own)
            assert_allclose(found.pressure, every.pressure, atol=1e-8)
        assert windowed.window != [0, 80, 0, 9]


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
    surface = surface_in(study)
    with executor_of(study, device=device, threads=threads) as executor:
        model: Any = model_of(study, surface, executor).model
        holder = getattr(model, "contact", model)
        film = getattr(holder, "film", None) or getattr(holder, "_film", None)
        if film is not None:
            film._thickness = -1.0
            if hasattr(holder, "state"):
                holder.state.columns = (0, executor.grid.ny)
        step = model.advance(plan_of(study)[0][0], with_pressure=True)
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


# What is bare, step by step, against books kept in NumPy.


class Books:
    """The film of one body, as the documentation describes it."""

    def __init__(self, shape: tuple[int, ...], thickness: float, regrowth: float) -> None:
        self.thickness, self.regrowth = thickness, regrowth
        self.whole, self.rubbed, self.wear = np.zeros(shape), np.zeros(shape), np.zeros(shape)

    def lost(self, distance: float) -> FloatArray:
        heals = distance - self.rubbed >= self.regrowth
        self.whole[heals] = self.wear[heals]
        return self.wear - self.whole > self.thickness

    def note(self, wear: FloatArray, distance: float) -> None:
        self.rubbed[wear > self.wear] = distance
        self.wear = wear.copy()


#: Each model heals in each way and has a film on each body, the quickest in all their combinations.
BARED = [
    (law, regrowth, bodies)
    for law in ("track", "track, bearing area", "rest, half-space")
    for n, regrowth in enumerate(("never", "0.5 mm", "4 mm"))
    for m, bodies in enumerate(("both", "sphere", "disc"))
    if n == m or law == "track"
]


@pytest.mark.parametrize(("law", "regrowth", "bodies"), BARED)
def test_what_is_bare(law: str, regrowth: str, bodies: str, device: str) -> None:
    study = STUDIES[law]
    needs_transforms(study, device)
    thickness = "200 nm"
    film = FILM | {"friction.film.bodies": bodies, "friction.film.regrowth": regrowth}
    study = study.replace(film | {"friction.film.thickness": thickness})
    after = math.inf if regrowth == "never" else float(regrowth.split()[0])
    books: dict[str, Books] = {}
    done, seen = 0.0, []
    for step in warpwear.steps(study, device=device):
        fields, shot = step.fields, step.snapshot()
        if not books:
            names = ("sphere", "disc") if bodies == "both" else (bodies,)
            books = {name: Books(fields[f"wear_{name}"].shape, 2e-4, after) for name in names}
        nx, bare = fields["pressure"].shape[0], np.ones(fields["pressure"].shape, dtype=bool)
        for name, kept in books.items():
            lost = kept.lost(done)
            if name == "disc" and shot.row is not None:
                lost = lost[np.arange(shot.row, shot.row + nx) % lost.shape[0]]
            bare &= lost
        assert_array_equal(fields["bare"] > 0.0, bare)
        pressed = fields["pressure"] > 0.0
        assert step.row["bare_fraction"] == pytest.approx(bare[pressed].mean(), abs=1e-12)
        strength = 40.0 + (172.0 - 40.0) * step.row["bare_fraction"]
        assert step.row["cof"] == pytest.approx(strength * step.row["area_contact"] / 8.0)
        done = step.row["distance"]
        seen.append(step.row["bare_fraction"])
        for name, kept in books.items():
            kept.note(fields[f"wear_{name}"], done)
    if regrowth == "never":
        assert max(seen) > 0.1


# Runs.


def healing(law: str) -> Study:
    """A study whose films form anew, of which three fields a body are kept."""
    film = FILM | {"friction.film.regrowth": "1.5 mm"}
    return STUDIES[law].replace(film)


@pytest.mark.parametrize("law", ["track", "track, half-space", "rest, half-space", "two scales"])
def test_a_killed_run_goes_on_bit_for_bit(law: str, tmp_path: Path) -> None:
    study = healing(law)
    alone = warpwear.run(study, out=tmp_path / "alone", plots=False)
    steps = alone.history["distance"].size

    class Killed(Exception):
        pass

    def kill(step: Any) -> None:
        if step.index == steps // 2:
            raise Killed

    with pytest.raises(Killed):
        warpwear.run(study, out=tmp_path / "killed", plots=False, callback=kill)
    resumed = warpwear.run(study, out=tmp_path / "killed", plots=False, resume=True)
    for name, values in alone.history.items():
        assert_array_equal(resumed.history[name], values, err_msg=name)
    for name, field in alone.snapshot(-1).fields.items():
        assert_array_equal(resumed.snapshot(-1).fields[name], field, err_msg=name)


def test_a_run_does_not_go_on_with_another_film(tmp_path: Path) -> None:
    study = healing("track")

    def stop(step: Any) -> None:
        if step.index == 3:
            raise StopIteration

    with pytest.raises(StopIteration):
        warpwear.run(study, out=tmp_path / "run", plots=False, callback=stop)
    for change in (
        {"friction.film.thickness": "20 nm"},
        {"friction.junction_growth": 10.0},
        {"friction.shear_strength": "150 MPa"},
    ):
        with pytest.raises(InputError, match=f"of another study \\({next(iter(change))}\\)"):
            warpwear.run(study.replace(change), out=tmp_path / "run", plots=False, resume=True)
    warpwear.run(study.replace({"friction.ploughing": 0.1}), out=tmp_path / "run", plots=False, resume=True)


def test_a_run_tells_of_its_film(tmp_path: Path) -> None:
    study = STUDIES["track"].replace(FILM | {"sliding.distance": "60 mm"})
    with warpwear.run(study, out=tmp_path / "run", plots=False) as result:
        summary = json.loads((tmp_path / "run" / "summary.json").read_text())
        figures = {*result.plot.names("essential")}
        for name in ("bare_map", "bare_fraction"):
            assert not faults_of(name, *drawn(result, name))
        bare = result.snapshot(-1).bare
        assert bare is not None
        assert set(np.unique(bare)) <= {0.0, 1.0}
        assert result.units["bare_fraction"] == "1"
    assert {"bare_map", "bare_fraction"} <= figures
    assert summary["hardness_MPa"] == pytest.approx(FILMED)
    assert summary["junction_growth"]["hardness_sheared_MPa"] == pytest.approx(BARE)
    assert summary["junction_growth"]["indentation_hardness_MPa"] == 590.0
    fit = summary["film"]["fit"]
    assert 0.0 < fit["plateau"] < 1.1
    assert 0.0 < fit["e_folding_mm"] < 60.0
    text = summary_text(summary)
    assert re.search(
        r"sheared hardness +under the film 577\.7, bare 286\.1 MPa, of 590 MPa, by junction", text
    )
    assert re.search(r"bare of film +at first 0\.\d+, at the end 0\.9\d+ of the area in contact", text)
    assert re.search(
        r"fitted course +plateau 0\.\d+ ± \S+, e-folding [\d.]+ ± \S+ mm, from [\d.]+ mm on", text
    )
    told = summary_text(summary | {"film": summary["film"] | {"fit": None, "no_fit": "no cell is bare"}})
    assert "none: no cell is bare" in told


def test_a_film_without_growing_junctions_changes_friction_alone(device: str) -> None:
    film = STRENGTHS | {"friction.film.thickness": "10 nm"}
    one = history_of(STUDIES["track"], device=device)
    other = history_of(STUDIES["track"].replace(film), device=device)
    assert other["bare_fraction"].max() > 0.3
    strength = 40.0 + 132.0 * other["bare_fraction"]
    assert_allclose(other["cof"], strength * other["area_contact"] / 8.0, rtol=1e-13)
    for name in one.keys() - {"cof", "evaluations"}:
        if device == "cpu":
            assert_array_equal(other[name], one[name], err_msg=name)
        else:
            assert_allclose(other[name], one[name], rtol=1e-9, atol=1e-12, err_msg=name)


def test_a_shear_beyond_what_the_softer_body_bears_is_told() -> None:
    growing = {"friction.shear_strength": "150 MPa", "friction.junction_growth": 9.0}
    harder = STUDIES["track"].replace({"disc.hardness": "400 MPa", "contact.hardness": "590 MPa"} | growing)
    with pytest.warns(warpwear.StudyWarning, match=r"150 MPa is beyond H/√α = 133 MPa"):
        warpwear.run(harder)
    with pytest.warns(warpwear.StudyWarning, match=r"150 MPa is beyond H/\(3√3\) = 77 MPa"):
        warpwear.run(harder.replace({"friction.junction_growth": 0.0}))


BAD: list[tuple[dict[str, Any], str]] = [
    ({"friction.film.thickness": "10 nm"}, r"friction\.film\.shear_strength"),
    (
        {"friction.film": {"thickness": "10 nm", "shear_strength": "40 MPa"}, "friction.coefficient": 0.5},
        r"friction\.coefficient = 0\.5 does not go with \[friction\.film\]",
    ),
    (
        {"friction.film": {"thickness": "10 nm", "shear_strength": "40 MPa"}, "friction.calibrate": "end"},
        r"friction\.calibrate = 'end' does not go with \[friction\.film\]",
    ),
    (
        FILM | {"friction.initial_ratio": 2.0, "friction.running_in": "3 mm"},
        r"friction\.initial_ratio = 2 does not go with \[friction\.film\]",
    ),
    (FILM | {"friction.area": "touched"}, r"friction\.area = 'touched' does not go with \[friction\.film\]"),
    (
        {"friction.shear_strength": "172 MPa", "friction.junction_growth": 9.0, "friction.area": "nominal"},
        r"friction\.area = 'nominal' does not go with friction\.junction_growth = 9",
    ),
    ({"friction.film.regrowth": "soon"} | FILM, r"friction\.film\.regrowth = 'soon'"),
    ({"friction.film.bodies": "ball"} | FILM, r"friction\.film\.bodies = 'ball'"),
    (
        FILM | {"friction.shear_strength": "200 MPa"},
        r"friction\.shear_strength = 200 MPa with friction\.junction_growth = 9 leaves cells of 590 MPa "
        r"hardness no pressure to bear: allowed are less than H/√α = 196\.7 MPa",
    ),
    (FILM | {"friction.film.shear_strength": "197 MPa"}, r"friction\.film\.shear_strength = 197 MPa with"),
    (FILM | {"contact.hardness": "inf MPa"}, r"needs a finite contact\.hardness"),
    (
        FILM | {"contact.load": "111 N"},
        r"\(110 N, as friction\.junction_growth = 9 leaves 286\.1 MPa of it",
    ),
]


@pytest.mark.parametrize(("change", "sentence"), BAD)
def test_what_cannot_be_is_refused_in_a_sentence(change: dict[str, Any], sentence: str) -> None:
    study = STUDIES["track"]
    if "friction.coefficient" in change or "friction.calibrate" in change:
        given = study.model_dump(exclude_unset=True)
        given["friction"] = {name.split(".")[1]: value for name, value in change.items()}
        with pytest.raises(InputError, match=sentence):
            Study(**given)
        return
    with pytest.raises(InputError, match=sentence) as refused:
        study.replace(change)
    assert str(refused.value).count(". ") == 0


def test_what_only_some_models_cannot_be_is_refused() -> None:
    bearing = {"wear.law": "bearing-curve", "friction.shear_strength": "3 MPa"}
    bearing |= {"disc.synthetic": {"kind": "milled", "ra": "0.3 um"}}
    with pytest.raises(InputError, match=r"does not go with wear\.law = 'bearing-curve'"):
        Study.load("v1").replace(bearing | {"friction.junction_growth": 9.0, "contact.hardness": "590 MPa"})
    with pytest.raises(InputError, match=r"patches\.coupling = 'load' does not go with \[friction\.film\]"):
        STUDIES["two scales"].replace(FILM | {"patches.coupling": "load"})
    unworn = STUDIES["track"].replace(FILM | {"wear.sphere": "0 mm^3/N/m"})
    assert any("wear.sphere = 0: the sphere keeps its film" in notice for notice in unworn.notices())
