"""Strokes of any length: against a loop in NumPy over places that are passed twice a cycle, the ends once."""

import json
from typing import Any

import cases_half_space
import numpy as np
import pytest
import reference
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.model import SweptModel
from warpwear.runs.plan import plan_of

SIDE, CELL, LOAD, RADIUS = 16, 0.02, 2.0, 3.0
GRID = Grid(SIDE, SIDE, CELL)
COUNTER, DISC, STIFFNESS = 2.0e-6, 3.0e-6, 2.0e5  # K [mm²/N], k [N/mm³]
TIGHT = 1.0e-13
#: Strokes in cells: two cells, half of a contact of about eight cells, the contact, twice as long.
STROKES = [2, 4, 8, 16]


def study_of(cells: int, **changes: Any) -> Study:
    """A smooth ball that goes to and fro over some cells of a smooth disc, by the local law."""
    keys = {name.replace("__", "."): value for name, value in changes.items()}
    base: dict[str, Any] = {
        "disc.synthetic.kind": "flat",
        "contact.hardness": "inf MPa",
        "contact.load": "2 N",
    }
    base |= {"contact.stiffness": f"{STIFFNESS} N/mm^3", "grid.cell": "20 um", "grid.extent": "0.32 mm"}
    base |= {"wear.counter": "2e-3 mm^3/N/m", "wear.disc": "3e-3 mm^3/N/m", "output.snapshots": []}
    base |= {"sliding.stroke": f"{cells * CELL:g} mm", "sliding.cycles": 3, "sliding.kinematics": None}
    return Study.load("v3-fine").replace(base | {"sliding.shift": 1} | keys)


def elastic(gap: FloatArray, compliance: float, matrix: FloatArray) -> FloatArray:
    """Pressure p ≥ 0 with (G + c) p + gap = δ in contact and the load in all, by active sets."""
    system = matrix + compliance * np.eye(gap.size)
    inside = gap.ravel() < gap.min() + 1.0e-3
    while True:
        active = np.flatnonzero(inside)
        ones = np.ones((active.size, 1))
        left = np.block([[system[np.ix_(active, active)], -ones], [ones.T, np.zeros((1, 1))]])
        *p, approach = np.linalg.solve(left, [*-gap.ravel()[active], LOAD / CELL**2])
        pressure = np.zeros(gap.size)
        pressure[active] = p
        now = np.where(inside, pressure > 0.0, system @ pressure + gap.ravel() < approach)
        if (now == inside).all():
            return pressure.reshape(gap.shape)
        inside = now


def plain(study: Study, rows: list[int], *, periodic: bool = False) -> dict[str, FloatArray]:
    """Wear of both bodies by K p |ds|, with the counter's first row on each of the disc's in turn."""
    half_space, track = study.contact.law == "half-space", study.track
    wear_counter, wear_disc = np.zeros(GRID.shape), np.zeros((track.rows, SIDE))
    sag, slip = reference.counter_gap(GRID.x, GRID.y, RADIUS), track.stroke / track.cells
    matrix = None
    if half_space:
        assert study.pair.effective_modulus is not None
        matrix = cases_half_space.dense_free(GRID) * cases_half_space.MODULUS / study.pair.effective_modulus
    for row in rows:
        beneath = (row + np.arange(SIDE)) % track.rows
        gap = sag + wear_counter + wear_disc[beneath]
        worn = COUNTER * slip, DISC * slip * track.track_fraction
        if matrix is None:
            p = reference.foundation(gap, 1.0 / STIFFNESS + sum(worn), LOAD, np.inf, CELL).pressure
        else:
            p = elastic(gap, sum(worn), matrix)
        wear_counter += worn[0] * p
        wear_disc[beneath] += worn[1] * p
    return {"wear_counter": wear_counter, "wear_disc": wear_disc}


def to_and_fro(cells: int, cycles: int) -> list[int]:
    """Rows of the places −S/2 … S/2: each is passed twice a cycle, the ends once."""
    return [*range(cells), *range(cells, 0, -1)] * cycles


def steps_of(
    study: Study, device: str, *, restart: int | None = None, threads: int = 1
) -> tuple[list[Step], Any]:
    """Steps and fields of the model; with `restart`, of another that goes on with its state at that step."""
    plan = [(increment, False) for increment, _, _ in plan_of(study)]
    with Executor(study.cells, device=device, threads=threads) as executor:

        def fresh() -> SweptModel:
            flat = np.zeros((study.track.rows, SIDE))
            model = SweptModel(study.contact_task, study.track, flat, executor)
            if isinstance(model.contact, SlidingHalfSpace):
                model.contact._half_space.tolerance, model.contact.on_the_way = TIGHT, None
            return model

        model = fresh()
        steps = list(model.steps(plan[:restart]))
        if restart is not None:
            arrays, numbers = saved.save(model)
            arrays = {name: values.copy() for name, values in arrays.items()}
            model = fresh()
            saved.restore(model, arrays, json.loads(json.dumps(numbers)))
            steps += model.steps(plan[restart:])
        state = model.contact.state
        return steps, {name: executor.to_numpy(field).copy() for name, field in state.fields.items()}


@pytest.fixture(params=["local", "half-space"])
def law(request: pytest.FixtureRequest, device: str) -> str:
    if request.param == "half-space" and device != "cpu":
        pytest.importorskip("cupy")
    return str(request.param)


@pytest.mark.parametrize("cells", STROKES)
def test_a_stroke_is_that_of_every_cell(law: str, cells: int, device: str, threads: int) -> None:
    study = study_of(cells, contact__law=law)
    assert study.is_swept
    steps, fields = steps_of(study, device, threads=threads)
    asked = plain(study, to_and_fro(cells, 3))
    for name, field in asked.items():
        assert_allclose(fields[name], field, atol=1e-9 * field.max(), err_msg=name)
    assert_allclose(fields["wear_disc"], fields["wear_disc"][::-1], atol=0.1 * fields["wear_disc"].max())
    for k, name in ((COUNTER, "wear_counter"), (DISC, "wear_disc")):
        worn = k * LOAD * study.sliding.total
        assert fields[name].sum() * CELL**2 == pytest.approx(worn, rel=1e-12)
        assert steps[-1].row[name.replace("wear", "wear_volume")] == pytest.approx(worn, rel=1e-12)


@pytest.mark.parametrize("cells", [17, 80], ids=["short", "long"])
def test_a_circle_is_that_of_every_cell(law: str, cells: int, device: str) -> None:
    """One way, from just longer than the domain."""
    circle = {"sliding.stroke": None, "sliding.cycles": None, "sliding.revolutions": 2}
    study = study_of(8, contact__law=law).replace(
        circle | {"sliding.track_radius": f"{cells * CELL / (2.0 * np.pi):.12g} mm"}
    )
    _, fields = steps_of(study, device)
    rows = [(place - SIDE // 2) % cells for place in range(cells)] * 2
    for name, field in plain(study, rows).items():
        assert_allclose(fields[name], field, atol=1e-9 * field.max(), err_msg=name)


def test_threads_and_a_restart_change_no_bit(law: str, device: str, threads: int) -> None:
    study = study_of(5, contact__law=law, sliding__shift=2)
    steps, fields = steps_of(study, device)
    again, fields_again = steps_of(study, device, restart=7, threads=threads)
    assert [step.row for step in again] == [step.row for step in steps]
    for name, field in fields.items():
        assert_array_equal(fields_again[name], field, err_msg=name)


def test_nothing_jumps_where_the_stroke_leaves_the_contact(device: str) -> None:
    """Depths over the stroke, the same volumes each: even from strokes within the contact to longer ones."""
    depths = []
    for cells in range(4, 25):
        k = {
            f"wear.{body}": f"{24.0 / cells * k} mm^3/N/m" for body, k in (("counter", 2e-3), ("disc", 3e-3))
        }
        _, fields = steps_of(study_of(cells).replace(k), device)
        depths.append([fields["wear_counter"].max(), fields["wear_disc"].max()])
    of_counter, of_disc = np.array(depths).T
    assert (np.diff(of_counter) > 0.0).all()
    assert (np.diff(of_disc) < 0.0).all()
    for depth in (of_counter, of_disc):
        assert np.abs(np.diff(depth, n=2)).max() < 0.025 * depth.max()


def test_a_short_stroke_leaves_a_scar_and_a_long_one_a_groove() -> None:
    """The summary, caption and page say which; the section of a scar is that through its middle."""
    short, long = (warpwear.run(study_of(cells)) for cells in (4, 40))
    worn, sizes = short.snapshot(-1).wear_disc, short.summary["track"]["groove"]
    assert sizes["length_mm"] == pytest.approx(worn.any(axis=1).sum() * CELL)
    assert sizes["length_mm"] == pytest.approx(short.history["patch_along"][-1] + 4 * CELL)
    middle = worn[worn.shape[0] // 2 - 1 : worn.shape[0] // 2 + 1].mean(axis=0)
    assert sizes["deepest_um"] == pytest.approx(1e3 * middle.max())
    assert sizes["section_um2"] == pytest.approx(1e6 * middle.sum() * CELL)
    assert "length_mm" not in long.summary["track"]["groove"]
    for result, called in ((short, "scar"), (long, "groove")):
        assert result.plot.caption("groove").startswith(f"Cross-section of the {called} after")


def test_a_named_stroke_slides_and_chooses_its_steps() -> None:
    """At least eight steps a stroke where cells allow, eight cells at most; said in what is shown."""
    shifts = {
        cells: study_of(cells).replace({"sliding.shift": None}).shift for cells in (2, 8, 16, 30, 64, 900)
    }
    assert shifts == {2: 1, 8: 1, 16: 2, 30: 3, 64: 8, 900: 8}
    piece = {"sliding.stroke": "3 mm", "sliding.shift": None}
    assert study_of(16).replace(piece | {"sliding.track": "0.5 mm"}).shift == 5  # a divisor of 25 cells
    study = study_of(16).replace({"sliding.shift": None})
    assert study.resolved["sliding.kinematics"] == "swept"
    assert study.resolved["sliding.shift"] == 2
    assert "shift = 2" in study.to_toml(marked=True)
    assert Study(**{**study.model_dump(exclude_unset=True)}) == study
    still = study.replace({"sliding.kinematics": "stationary"})
    assert not still.is_swept
    assert not study.replace(
        {"sliding.stroke": None, "sliding.cycles": None, "sliding.distance": "1 mm"}
    ).is_swept


def test_a_stroke_that_the_bodies_yield_is_told() -> None:
    """Mindlin: 3 μ F/(16 a) Σ (2 − ν)/G to either side, of like bodies 3 μ F (2 − ν)/(4 G a) in all."""
    steel = {"counter.young": "200 GPa", "counter.poisson": 0.3, "disc.young": "200 GPa", "disc.poisson": 0.3}
    steel |= {"friction.shear_strength": None, "friction.coefficient": 0.5}
    study = study_of(2).replace(steel)
    assert study.hertz is not None
    modulus = 200e3 / 2.6
    expected = 1.7 * 3.0 * 0.5 * LOAD / (4.0 * modulus * study.hertz.radius)
    (told,) = [
        notice
        for notice in study.replace({"sliding.stroke": "2 um", "grid.cell": "1 um"}).notices()
        if "slip" in notice
    ]
    assert f"travels {1e3 * expected:.3g} µm farther" in told
    assert not [notice for notice in study.notices() if "slip" in notice]
