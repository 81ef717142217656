"""Bodies of layers and gradients: against closed forms and a plain reference, at rest and over a track."""

import json
from dataclasses import replace
from typing import Any

import cases_half_space
import numpy as np
import pytest
import reference
from cases_layered import CASE, COAT, HALF_SPACE, PLAIN, SKIN, Profiles, layered, task_of
from numpy.testing import assert_allclose

import warpwear
from warpwear import Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.laws.depth_profile import DepthProfile, LayerMaterial
from warpwear.laws.film import Film
from warpwear.laws.form import Ball
from warpwear.laws.task import ContactTask
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import SlidingContact

Contact = SlidingContact | SlidingHalfSpace


def slid(contact: Contact, shifts: list[int], increments: list[float]) -> Step:
    """Make all steps; return the last."""
    if isinstance(contact, SlidingHalfSpace):
        return [contact.step(*pair) for pair in zip(shifts, increments, strict=True)][-1]
    done, last = 0, None
    while done < len(increments):
        count, steps = contact.replay(shifts[done:], increments[done:])
        *_, last = steps
        done += count
    assert last is not None
    return last


@pytest.mark.parametrize(
    "profiles", [(PLAIN, COAT), (SKIN, COAT), (COAT, CASE)], ids=["disc", "both", "gradient"]
)
@pytest.mark.parametrize(
    ("law", "moves"),
    [
        (SlidingContact, False),
        *(pytest.param(SlidingHalfSpace, m, marks=pytest.mark.transforms) for m in (False, True)),
    ],
    ids=["local", "half-space", "half-space-track"],
)
def test_flat_on_flat_wears_by_the_closed_form(
    profiles: Profiles, law: type[Contact], moves: bool, device: str, threads: int
) -> None:
    """Every cell bears F/A; Σ V_m / K_m = F L of each body."""
    grid, load, count, increment = Grid(24, 20, 0.01), 20.0, 100, 12000.0
    more = HALF_SPACE | {"boundary": "periodic"} if law is SlidingHalfSpace else {}
    with Executor(grid, device=device, threads=threads) as executor:
        task = task_of(profiles, load=load, **more)
        contact = law(task, np.zeros(grid.shape), executor, moves=moves, periodic=moves)
        row = slid(contact, [3 * n % grid.nx * moves for n in range(count)], [increment] * count).row
        total = load * increment * count
        for body, profile in zip(("counter", "disc"), profiles, strict=True):
            depth = executor.to_numpy(getattr(contact.state, f"wear_{body}"))
            expected = float(profile.worn(np.zeros(1), np.array([total / grid.area]))[0])
            assert_allclose(depth, expected, rtol=1e-12)
            assert row[f"archard_volume_{body}"] == pytest.approx(row[f"wear_volume_{body}"], rel=1e-12)
            if len(profile.materials) > 1 and not profile.graded:
                volumes = [row[f"wear_volume_{body}_{m.name}"] for m in profile.materials]
                books = sum(v / m.wear for v, m in zip(volumes, profile.materials, strict=True))
                assert books == pytest.approx(total, rel=1e-12)
                assert row[f"load_share_{body}_substrate"] == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("profiles", [(PLAIN, COAT), (SKIN, COAT)], ids=["disc", "both"])
def test_rough_bodies_of_unlike_caps_wear_as_the_reference(
    profiles: Profiles, device: str, threads: int
) -> None:
    grid, load, increments = Grid(14, 17, 0.01), 60.0, [400.0] * 19
    heights = np.random.default_rng(3).normal(0.0, 1.5e-3, grid.shape)
    with Executor(grid, device=device, threads=threads) as executor:
        contact = SlidingContact(task_of(profiles, load=load), heights, executor, moves=False)
        step = slid(contact, [0] * 18, increments[:-1])
        step = contact.step(0, increments[-1], with_pressure=True)
        worn = [executor.to_numpy(getattr(contact.state, f"wear_{b}")) for b in ("counter", "disc")]
        counter, disc, pressure = reference.layered_run(
            -heights, (layered(profiles[0]), layered(profiles[1])), load=load, increments=increments,
            cell=grid.cell, own=1e-7,
        )  # fmt: skip
        assert_allclose(worn[0], counter, rtol=1e-8, atol=1e-13)
        assert_allclose(worn[1], disc, rtol=1e-8, atol=1e-13)
        assert_allclose(step.pressure, pressure, rtol=1e-6, atol=1e-4)
        assert len(set(profiles[1].material_at(worn[1]).ravel())) == 3  # all of them are met


BALL = Ball(0.2, 0.2)


@pytest.mark.transforms
@pytest.mark.parametrize(
    ("profiles", "increment"),
    [((PLAIN, COAT), 900.0), ((SKIN, COAT), 900.0), ((PLAIN, CASE), 30.0)],
    ids=["disc", "both", "case"],
)
def test_a_half_space_at_rest_is_that_of_the_dense_matrix(
    profiles: Profiles, increment: float, device: str
) -> None:
    """With K and the cap of each cell as a step begins; a cell that wears through is split by volume."""
    grid, load = Grid(14, 11, 0.01), 55.0
    elastic = cases_half_space.dense_free(grid) * cases_half_space.MODULUS / HALF_SPACE["modulus"]
    heights = np.random.default_rng(3).normal(0.0, 3e-4, grid.shape)
    worn = [np.zeros(grid.shape), np.zeros(grid.shape)]
    unworn = reference.counter_gap(grid.x, grid.y, 5.0) - heights
    with Executor(grid, device=device, threads=1) as executor:
        task = task_of(profiles, load=load, form=BALL, **HALF_SPACE)
        contact = SlidingHalfSpace(task, heights, executor, moves=False)
        contact._half_space.tolerance = 1e-11
        wears_through = []
        for _ in range(12):
            step = contact.step(0, increment, with_pressure=True)
            pairs = list(zip(profiles, worn, strict=True))
            k = sum(profile.coefficient_at(depth) for profile, depth in pairs) * increment
            caps = np.minimum(*(profile.hardness_at(depth) for profile, depth in pairs))
            matrix = elastic + np.diag(k.ravel())
            p = cases_half_space.bounded(matrix, unworn + sum(worn), step.row["approach"], caps.ravel())
            assert_allclose(step.pressure, p, atol=1e-6 * p.max())
            assert p.sum() * grid.cell_area == pytest.approx(load, rel=1e-6)
            for profile, depth in pairs:
                depth[:] = profile.worn(depth, p * increment)
            wears_through.append(np.mean(worn[1] > profiles[1].depths[1]))
            for body, depth in zip(("counter", "disc"), worn, strict=True):
                assert_allclose(
                    executor.to_numpy(getattr(contact.state, f"wear_{body}")), depth, atol=1e-6 * depth.max()
                )
    assert any(0.0 < part < 1.0 for part in wears_through)
    for body, profile, depth in zip(("counter", "disc"), profiles, worn, strict=True):
        if len(profile.materials) > 1 and not profile.graded:
            parts = profile.lost_of_each(depth).sum(axis=(1, 2)) * grid.cell_area
            volumes = [step.row[f"wear_volume_{body}_{m.name}"] for m in profile.materials]
            assert_allclose(volumes, parts, rtol=1e-5)


def test_a_ball_and_its_crater_of_two_materials(device: str) -> None:
    """Where both conform, a cell has lost δ = h − r²/2R of which each body takes what the same ∫ p dL wears.

    F L = ∫ q dA over the crater = 2πR ∫₀ʰ q(δ) dδ, with δ = counter(q) + disc(q).
    """
    grid, load, radius, distance = Grid(150, 150, 0.01), 2.0, 5.0, 4.0e6
    thin = DepthProfile((0.0, 4.0e-3), (LayerMaterial(2e-10, name="coat"), LayerMaterial(2e-9)))
    profiles = DepthProfile((0.0,), (LayerMaterial(3e-10),)), thin
    increments = (distance * np.diff(np.linspace(0.0, 1.0, 601) ** 2)).tolist()
    with Executor(grid, device=device, threads=1) as executor:
        task = task_of(profiles, load=load, form=Ball(1.0 / radius, 1.0 / radius))
        contact = SlidingContact(task, np.zeros(grid.shape), executor, moves=False)
        row = slid(contact, [0] * len(increments), increments).row
    q = np.linspace(0.0, 1.2e8, 200_001)
    depth = profiles[0].worn(np.zeros_like(q), q) + thin.worn(np.zeros_like(q), q)
    carried = (
        2.0 * np.pi * radius * np.concatenate([[0.0], np.cumsum(0.5 * (q[1:] + q[:-1]) * np.diff(depth))])
    )
    deepest = np.interp(load * distance, carried, q)
    expected = [float(p.worn(np.zeros(1), np.array([deepest]))[0]) for p in profiles]
    assert expected[1] > 1.5 * thin.depths[1]
    assert row["wear_depth_counter"] == pytest.approx(expected[0], rel=5e-3)
    assert row["wear_depth_disc"] == pytest.approx(expected[1], rel=5e-3)
    books = row["wear_volume_disc_coat"] / 2e-10 + row["wear_volume_disc_substrate"] / 2e-9
    assert books == pytest.approx(load * distance, rel=1e-12)


TRACK = Grid(14, 24, 0.01)
LAWS = [SlidingContact, pytest.param(SlidingHalfSpace, marks=pytest.mark.transforms)]
of_laws = pytest.mark.parametrize("law", LAWS, ids=["local", "half-space"])


def over_a_track(
    task: ContactTask,
    heights: FloatArray,
    threads: int = 1,
    *,
    law: type[Contact] = SlidingContact,
    restarts: bool = False,
) -> tuple[Step, FloatArray]:
    """The last of many steps over a periodic disc, and the disc's wear.

    restarts: whether all is saved and restored on the way.
    """
    count, increment = (240, 900.0) if law is SlidingContact else (80, 2700.0)
    shifts = [(3 * n) % heights.shape[0] for n in range(count)]
    task = task if law is SlidingContact else replace(task, **HALF_SPACE)
    with Executor(TRACK, device="cpu", threads=threads) as executor:

        def anew() -> Contact:
            contact = law(task, heights, executor, periodic=True, track_fraction=0.25)
            if isinstance(contact, SlidingHalfSpace):
                contact.stands_for = 22500  # cycles: a step goes over three cells
            return contact

        contact = anew()
        if restarts:
            early, shifts = shifts[: count // 2], shifts[count // 2 :]
            slid(contact, early, [increment] * len(early))
            arrays, numbers = saved.save(contact)
            arrays = {name: values.copy() for name, values in arrays.items()}
            contact = anew()
            saved.restore(contact, arrays, json.loads(json.dumps(numbers)))
        step = slid(contact, shifts, [increment] * len(shifts))
        return step, executor.to_numpy(contact.state.wear_disc).copy()


def ground(profiles: Profiles) -> tuple[ContactTask, FloatArray]:
    heights = np.random.default_rng(5).normal(0.0, 4e-4, (60, TRACK.ny))
    return task_of(profiles, load=40.0, form=BALL), heights


@of_laws
def test_on_a_track_all_exposures_are_the_load_times_the_distance(law: type[Contact]) -> None:
    """∫ p dL of every cell of the disc follows from its depth alone, whatever has worn it."""
    task, heights = ground((PLAIN, COAT))
    step, wear = over_a_track(task, heights, law=law)
    slid_by_track = 0.25 * 900.0 * 240
    exposures = COAT.exposure(wear).sum() * TRACK.cell_area
    assert exposures == pytest.approx(40.0 * slid_by_track, rel=1e-12)
    assert wear.max() > COAT.depths[-1]
    parts = COAT.lost_of_each(wear).sum(axis=(1, 2)) * TRACK.cell_area / 0.25
    volumes = [step.row[f"wear_volume_disc_{material.name}"] for material in COAT.materials]
    assert_allclose(volumes, parts, rtol=1e-11)


@of_laws
def test_a_layer_that_is_not_worn_through_leaves_the_plain_numbers(law: type[Contact]) -> None:
    """To the last bit, whatever lies below; and so does a layer of the body's own numbers."""
    thick = replace(COAT, depths=(0.0, 1.0, 2.0))
    same = DepthProfile((0.0, 1e-6, 2e-6), tuple(replace(COAT.materials[0], name=n) for n in "abc"))
    task, heights = ground((PLAIN, thick))
    plain = replace(task, profiles=None)
    (step, wear), (bare, expected) = (over_a_track(one, heights, law=law) for one in (task, plain))
    assert np.array_equal(wear, expected)
    assert {name: step.row[name] for name in bare.row} == bare.row
    _, wear = over_a_track(replace(task, profiles=(PLAIN, same)), heights, law=law)
    assert_allclose(wear, expected, rtol=1e-12 if law is SlidingContact else 1e-6)


@of_laws
def test_two_threads_and_a_restart_find_the_same(two_threads: int, law: type[Contact]) -> None:
    task, heights = ground((SKIN, COAT))
    task = replace(task, largest_shear=1e-3, film=Film(1e-4, (True, True), shear_ratio=0.25))
    step, wear = over_a_track(task, heights, law=law)
    other, twice = over_a_track(task, heights, two_threads, law=law, restarts=True)
    assert np.array_equal(wear, twice)
    assert step.row == other.row


@of_laws
def test_shares_of_a_step_add_up(law: type[Contact]) -> None:
    task, heights = ground((SKIN, COAT))
    row = over_a_track(task, heights, law=law)[0].row
    for body, names in (("counter", ("skin", "substrate")), ("disc", ("coat", "bond", "substrate"))):
        assert sum(row[f"load_share_{body}_{name}"] for name in names) == pytest.approx(1.0, rel=1e-12)
        areas = sum(row[f"area_{body}_{name}"] for name in names)
        assert areas == pytest.approx(row["area_contact"], rel=1e-12)


@pytest.mark.parametrize("coefficient", [np.inf, 0.002])
def test_a_cell_shears_by_the_weaker_material_or_its_pressure(coefficient: float) -> None:
    """Before and after a coat of a tenth of the bodies' strength is worn through, or one of a coefficient."""
    strength = 20.0 if np.isinf(coefficient) else np.inf
    coat = replace(COAT.materials[0], shear_strength=strength, coefficient=coefficient)
    body = replace(COAT.materials[2], shear_strength=200.0)
    disc = DepthProfile((0.0, 2.0e-3), (coat, body))
    counter = DepthProfile((0.0,), (replace(PLAIN.materials[0], shear_strength=200.0),))
    grid, load = Grid(8, 8, 0.01), 20.0
    pressure = load / grid.area
    with Executor(grid, device="cpu", threads=1) as executor:
        contact = SlidingContact(
            task_of((counter, disc), load=load), np.zeros(grid.shape), executor, moves=False
        )
        first = contact.step(0, 100.0).row
        last = slid(contact, [0] * 40, [1000.0] * 40).row
    weaker = min(strength, coefficient * pressure) / 200.0
    assert first["area_sheared"] == pytest.approx(weaker * grid.area, rel=1e-12)
    assert last["load_share_disc_substrate"] == 1.0
    assert last["area_sheared"] == pytest.approx(grid.area, rel=1e-12)


def test_layers_of_the_bodies_own_k_are_a_film() -> None:
    """Cells are as strong as a film while one of both bodies has its layer, and as bare ones after that."""
    film = Film(1.4e-3, (True, True), shear_ratio=0.25)
    tops = [replace(COAT.materials[0], shear_strength=50.0, hardness=2e4, name="film")] * 2
    bodies = [replace(top, shear_strength=200.0, name="substrate") for top in tops]
    filmed = [DepthProfile((0.0, 1.4e-3), pair) for pair in zip(tops, bodies, strict=True)]
    task, heights = ground((filmed[0], filmed[1]))
    step, wear = over_a_track(task, heights)
    other, expected = over_a_track(replace(task, profiles=None, film=film), heights)
    assert_allclose(wear, expected, rtol=1e-9)
    bare = other.row["bare_fraction"]
    assert 0.05 < bare < 0.95
    sheared = other.row["area_contact"] * (0.25 + 0.75 * bare)
    assert step.row["area_sheared"] == pytest.approx(sheared, rel=1e-9)


RUNNING_IN = {"sliding.distance": "60 mm", "output.snapshots": [], "wear.particle": None}
RUNNING_IN |= {"friction.junction_growth": 0.0, "grid.cell": "8 um", "sliding.shift": 3}


@pytest.mark.transforms
@pytest.mark.parametrize("law", ["half-space", "local"])
def test_layers_of_a_films_numbers_are_the_preset_running_in(
    law: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A film of 10 nm on both bodies, or a layer on each with its K: all columns of both, friction too.

    A short and coarse copy, without pieces and growing junctions, which bodies with layers do not have.
    """
    # Layers are made part by part, by the host: so is the film then, from the same pressures.
    monkeypatch.setattr(SlidingHalfSpace, "_in_one_go", lambda *_: (0, None))
    filmed = Study.load("running-in").replace(RUNNING_IN | {"contact.law": law})
    layer = {"name": "film", "thickness": "10 nm", "shear_strength": "40 MPa"}
    own = {body: getattr(filmed.wear, body).write() for body in ("counter", "disc")}
    keys = {f"{body}.layers": [layer | {"wear": wear}] for body, wear in own.items()}
    studies = filmed, filmed.replace(keys | {"friction.film": None})
    one, other = (warpwear.run(study).history for study in studies)
    assert one["bare_fraction"][0] < 0.3
    assert one["bare_fraction"].max() > 0.9
    for name in one.keys() - {"bare_fraction"}:
        assert_allclose(other[name], one[name], rtol=1e-9, atol=1e-12, err_msg=name)


#: A ball of 20 mm over a coat whose shortest waves are six cells of 10 µm long; the groove is narrower than
#: the domain.
STEEL = {"young": "210 GPa", "poisson": 0.3, "hardness": "9 GPa"}
GROUND: dict[str, Any] = {"kind": "self-affine", "sq": "20 nm", "roll_off": "0.2 mm", "cut_off": "60 um"}
GROUND |= {"hurst": 0.8, "seed": 1, "period": "0.8 mm"}
ROUGH_COAT: dict[str, Any] = {
    "study": {"name": "coat"},
    "counter": {"radius": "20 mm", **STEEL},
    "disc": STEEL | {"synthetic": GROUND},
    "contact": {"law": "half-space", "load": "5 N"},
    "wear": {"counter": "4e-6 mm^3/N/m", "disc": "1.2e-4 mm^3/N/m"},
    "grid": {"cell": "10 um", "extent": "0.4 mm"},
    "sliding": {"kinematics": "swept", "stroke": "0.8 mm", "track": "0.8 mm", "shift": 2, "passes": 100},
    "stepping": {"jump": 1},
    "output": {"snapshots": []},
}
ROUGH_COAT["disc"]["layers"] = [{"name": "coat", "thickness": "0.1 um", "wear": "4e-5 mm^3/N/m"}]


@pytest.mark.slow
@pytest.mark.transforms
def test_a_rough_coat_breaks_through_after_the_same_way_on_finer_cells() -> None:
    """First within 5 %, half of the contact within 2 %: on cells of 10 and 5 µm, by two shifts."""
    study = Study(**ROUGH_COAT)
    others = {"grid.cell": "5 um", "sliding.shift": 4}, {"sliding.shift": 4}
    runs = [warpwear.run(one).summary["layers_disc"] for one in (study, *map(study.replace, others))]
    first, half = ([run[f"{name}breakthrough_mm"] for run in runs] for name in ("", "half_"))
    print(first, half)
    assert_allclose(first, first[0], rtol=0.05)
    assert_allclose(half, half[0], rtol=0.02)
