"""The half-space in the wear loop: studies that ask for it, conservation, closed forms, resuming."""

import json
import math
import re
import tomllib
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import InputError, Study
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.models.rest.local import OneScaleModel
from warpwear.models.track.half_space import SlidingHalfSpace

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

LAW = {"contact.law": "half-space", "output.snapshots": [], "output.precision": "double"}
TRANSITION = {
    "wear__law": "transition",
    "wear__severe_counter": "9.4e-3 mm^3/N/m",
    "wear__severe_disc": "12.7e-3 mm^3/N/m",
    "wear__transition_pressure": "300 MPa",
    "wear__transition_width": "200 MPa",
    "grid__cell": "10 um",
}
PATCHES = {"study.model": "two-scale", "patches.macro_cell": "50 um"}
RUNNING_IN = {
    "wear.law": "running-in",
    "wear.running_in": "1 mm",
    "wear.initial_disc": "1e-2 mm^3/N/m",
}


def study(**changes: Any) -> Study:
    dotted = {name.replace("__", "."): value for name, value in changes.items()}
    return Study.load("v3-fine").replace(LAW | {"grid.cell": "20 um"} | dotted)


def at_rest(asked: Study, heights: FloatArray, executor: Executor) -> SlidingHalfSpace:
    return SlidingHalfSpace(asked.contact_task, heights.copy(), executor, moves=False)


def gap_of(contact: SlidingHalfSpace, executor: Executor) -> FloatArray:
    return executor.to_numpy(contact.state.counter) - executor.to_numpy(contact.state.disc)


def test_hertz_through_a_study() -> None:
    """The reference test's bodies: a = 55.2 µm, 1255 MPa, 1.014 µm."""
    asked = study(
        disc__synthetic={"kind": "flat"},
        contact__hardness="inf MPa",
        sliding__distance="0 mm",
        grid__cell="1.25 um",
        grid__extent="0.16 mm",
    )
    hertz = asked.hertz
    assert hertz is not None
    with warpwear.run(asked) as result:
        end = {name: values[-1] for name, values in result.history.items()}
        assert end["pressure_max"] == pytest.approx(1255.0, rel=2e-3)
        assert end["approach"] == pytest.approx(1.0143e-3, rel=2e-3)
        assert end["area_contact"] == pytest.approx(hertz.area, rel=2.0 * 1.25e-3 / hertz.radius)
        assert abs(end["load_residual"]) <= 2e-12 * hertz.load
        assert end["wear_volume_disc"] == 0.0
        assert end["evaluations"] > 1
        r = np.hypot.outer(result.x, result.y)
        inside = r < 0.95 * hertz.radius
        assert_allclose(result.snapshot(-1).pressure[inside], hertz.pressure(r)[inside], atol=10.0)
        assert result.summary["foundation_N_per_mm3"] is None


def test_soft_asperities_carry_the_hardness() -> None:
    """H/(E* h') = 0.01: the area is the load over the hardness, but for the cells at the rims of islands."""
    with warpwear.run(study(sliding__distance="0 mm", grid__cell="2 um", grid__extent="0.6 mm")) as result:
        end = {name: values[-1] for name, values in result.history.items()}
    assert end["area_contact"] == pytest.approx(8.0 / 590.0, rel=5e-3)
    assert end["area_plastic"] > 0.99 * 8.0 / 590.0 * (1.0 - 5e-3)
    assert end["pressure_max"] == 590.0


@pytest.mark.parametrize("changes", [{}, RUNNING_IN, {"contact.hardness": "inf MPa"}], ids=str)
def test_what_is_worn_is_what_archard_says(changes: dict[str, Any], device: str) -> None:
    """By the fields of every step, on fields that are summed by NumPy."""
    with warpwear.run(
        study(sliding__distance="3 mm").replace(changes | {"output.snapshots": ["0.03 mm", "0.3 mm"]}),
        device=device,
    ) as result:
        history, asked = result.history, result.study
        snapshots = [result.snapshot(index) for index in range(3)]
    volumes = [
        [getattr(s, f"wear_{b}").sum() * asked.cells.cell_area for b in ("counter", "disc")]
        for s in snapshots
    ]
    for snapshot, found in zip(snapshots, volumes, strict=True):
        at = int(np.searchsorted(history["distance"], snapshot.distance))
        expected = [law.wear_per_pressure(0.0, snapshot.distance) * 8.0 for law in asked.wear_laws]
        assert_allclose(found, expected, rtol=1e-10)
        assert_allclose([history[f"wear_volume_{b}"][at] for b in ("counter", "disc")], expected, rtol=1e-10)
        pressure = snapshot.pressure
        assert pressure.sum() * asked.cells.cell_area == pytest.approx(8.0, rel=1e-12)
        assert history["pressure_std"][at] == pytest.approx(pressure[pressure > 0.0].std(), rel=1e-6)
        assert history["cells_in_contact"][at] == np.count_nonzero(pressure)
        assert history["area_touched"][at] == pytest.approx(
            np.count_nonzero((snapshot.wear_disc > 0.0) | (pressure > 0.0)) * asked.cells.cell_area
        )
        x, y = np.nonzero(snapshot.wear_disc)
        assert history["patch_along"][at] == pytest.approx((np.ptp(x) + 1) * asked.cells.cell)
        assert history["patch_across"][at] == pytest.approx((np.ptp(y) + 1) * asked.cells.cell)
        assert history["wear_depth_counter"][at] == pytest.approx(snapshot.wear_counter.max(), rel=1e-9)
    assert np.abs(history["load_residual"]).max() <= 2e-12 * 8.0


def test_every_step_wears_what_its_pressure_says() -> None:
    asked = study()
    grid = asked.cells
    heights = np.random.default_rng(1).normal(0.0, 1e-3, grid.shape)
    with Executor(grid) as executor:
        model = at_rest(asked, heights, executor)
        before = gap_of(model, executor)
        for increment in (0.003, 0.3, 30.0, 0.01):
            step = model.step(0, increment, with_pressure=True)
            after = gap_of(model, executor)
            assert step.pressure is not None
            removal = sum(law.wear_per_pressure(0.0, increment) for law in asked.wear_laws)
            mean = (after - before).sum() / grid.cells
            assert mean == pytest.approx(removal * 8.0 / grid.area, rel=1e-12)
            assert_allclose(after - before, removal * step.pressure, atol=1e-16)
            before = after


@pytest.mark.parametrize("width", ["200 MPa", "5 MPa", "0.1 MPa"])
def test_cells_wear_by_the_k_of_their_own_pressure(width: str) -> None:
    """Each step is the contact of cells whose compliance is K(p) ΔL, given to the solver as numbers."""
    asked = study(**(TRANSITION | {"wear__transition_width": width}))
    grid, modulus, cap = asked.cells, asked.pair.effective_modulus, asked.hardness
    assert modulus is not None
    pieces = []
    heights = np.random.default_rng(1).normal(0.0, 1e-3, grid.shape)
    with Executor(grid) as executor:
        model = at_rest(asked, heights, executor)
        before = gap_of(model, executor)
        for increment in (0.003, 0.03, 0.3, 3.0, 0.01):
            pressure = model.step(0, increment, with_pressure=True).pressure
            assert pressure is not None
            pieces.append(np.histogram(pressure, [1e-9, *asked.wear_laws[0].over_pressure[0], math.inf])[0])
            after = gap_of(model, executor)
            lends = increment * sum(np.interp(pressure, *law.over_pressure) for law in asked.wear_laws)
            assert_allclose(after - before, lends * pressure, rtol=1e-12, atol=1e-16)
            solver = HalfSpace(executor, modulus=modulus, boundary="free", hardness=cap)
            mean = asked.contact.load / grid.area
            other = solver.solve(executor.field(before), mean_pressure=mean, yields=executor.field(lends))
            within = 2.0 * other.allowed.max() * modulus / grid.cell  # what both may miss, on a cell alone
            assert within < 2e-3 * cap
            assert_allclose(other.pressure, pressure, atol=within)
            before = after
    assert np.max(pieces, axis=0).min() > 3  # mild, between and severe


def test_patches_wear_by_the_k_of_their_cells(device: str) -> None:
    longest = {"stepping.increment": "0.3 mm", "sliding.distance": "0.3 mm", "output.snapshots": ["0.3 mm"]}
    asked = study(**TRANSITION).replace(PATCHES | longest)
    with warpwear.run(asked, device=device, plots=False) as result:
        last = result.snapshot(-1)
        for body, law in zip(("counter", "disc"), asked.wear_laws, strict=True):
            expected = np.interp(last.pressure, *law.over_pressure) * last.pressure * 0.3
            assert_allclose(getattr(last, f"wear_{body}"), expected, rtol=1e-12, atol=1e-18)
        begin, end = asked.wear_laws[0].over_pressure[0]
        assert np.histogram(last.pressure, [1e-9, begin, end, math.inf])[0].min() > 3


def test_bodies_without_compliance_wear_as_on_the_capped_foundation() -> None:
    """What is left of c is K ΔL, as with the other law."""
    stiff = study(**{"counter.young": "1e9 GPa", "disc.young": "1e9 GPa"})
    grid = Grid(60, 60, 0.02)
    heights = np.random.default_rng(1).normal(0.0, 1e-3, grid.shape)
    with Executor(grid) as executor:
        one = at_rest(stiff, heights, executor)
        other = OneScaleModel(stiff.replace({"contact.law": "local"}).contact_task, heights.copy(), executor)
        for increment in (0.03, 0.3, 3.0):
            step, expected = one.step(0, increment), other.advance(increment)
            for name in (
                "area_contact",
                "area_plastic",
                "wear_volume_counter",
                "wear_depth_disc",
                "pressure_std",
            ):
                assert step.row[name] == pytest.approx(expected.row[name], rel=1e-3), name
            assert step.row["approach"] == pytest.approx(expected.row["approach"], abs=1e-8)


def test_a_flat_is_periodic_unless_it_is_said_otherwise() -> None:
    flat = {
        "counter.radius": "inf mm",
        "contact.load": "8 N",
        "sliding.distance": "0 mm",
        "grid.extent": "0.2 mm",
    }
    flat |= {"grid.cell": "2 um", "disc.synthetic.period": "0.2 mm", "contact.hardness": "inf MPa"}
    areas = {}
    for boundary in (None, "periodic", "free"):
        with warpwear.run(study().replace(flat | {"contact.boundary": boundary})) as result:
            areas[boundary] = result.history["area_contact"][-1]
    assert areas[None] == areas["periodic"] != areas["free"]


@pytest.mark.parametrize("changes", [{}, RUNNING_IN], ids=["archard", "running-in"])
def test_a_model_goes_on_from_any_step(changes: dict[str, Any]) -> None:
    asked = study().replace(changes)
    dice = np.random.default_rng(3)
    heights = dice.normal(0.0, 1e-3, asked.cells.shape)
    increments = (10.0 ** dice.uniform(-3.0, 1.0, 8)).tolist()

    def rows(restart: int | None) -> tuple[list[dict[str, float]], list[FloatArray]]:
        with Executor(asked.cells) as executor:
            model = at_rest(asked, heights, executor)
            found = []
            for number, increment in enumerate(increments):
                if number == restart:
                    arrays, numbers = saved.save(model)
                    model = at_rest(asked, heights, executor)
                    saved.restore(model, arrays, json.loads(json.dumps(numbers)))
                found.append(model.step(0, increment).row)
            return found, [executor.to_numpy(field).copy() for field in model.state.fields.values()]

    alone, worn = rows(None)
    for restart in (1, 5):
        again, worn_again = rows(restart)
        assert again == alone
        for one, other in zip(worn_again, worn, strict=True):
            assert_array_equal(one, other)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"study.model": "macro"}, "needs study.model = 'micro' or 'two-scale', not 'macro'"),
        ({"counter.material": None}, "needs Young's modulus and Poisson's ratio of both bodies"),
        ({"stepping.scheme": "explicit"}, "needs stepping.scheme = 'implicit'"),
        ({"wear.distance_factor": "across"}, "wear.distance_factor = 'across' does not go with"),
        ({"contact.boundary": "periodic"}, "would repeat the counter-body beside itself"),
        ({"contact.boundary": "open"}, "contact.boundary = 'open' is not allowed"),
        ({"contact.hardness": "3 MPa"}, "more than the domain under the counter-body carries"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_sentence(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as refused:
        study().replace(changes)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_keys_of_the_other_law_are_told() -> None:
    told = study(contact__stiffness="1e6 N/mm^3").notices()
    assert any("contact.stiffness does not apply to contact.law = 'half-space'" in note for note in told)
    told = study(contact__law="local", contact__boundary="free").notices()
    assert any("contact.boundary does not apply to contact.law = 'local'" in note for note in told)
    again = Study(**tomllib.loads(study().to_toml()))
    assert again.boundary == "free"
    # Shown as assumed, and still open: a flat in the counter-body's place gets its own.
    for radius, boundary in (("3 mm", "free"), ("inf mm", "periodic")):
        shown = again.replace({"counter.radius": radius, "sliding.distance": "0 mm"}).to_toml(marked=True)
        assert re.search(rf'^boundary = "{boundary}" +# ASSUMED: ', shown, re.MULTILINE)
    given = study(contact__boundary="free")
    assert re.search(r'^boundary = "free"$', given.to_toml(marked=True), re.MULTILINE)
    assert "boundary" not in study(contact__law="local").to_toml(marked=True)
    assert math.isinf(again.pair.stiffness)
