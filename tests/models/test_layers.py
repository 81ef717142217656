"""Bodies of layers and gradients: against closed forms and a plain reference, at rest and over a track."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import reference
from numpy.testing import assert_allclose

from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.laws.archard import WearLaw
from warpwear.laws.depth_profile import DepthProfile, Material
from warpwear.laws.film import Film
from warpwear.laws.task import ContactTask
from warpwear.models.track.local import SlidingContact
from warpwear.surfaces.form import Ball, Form

COAT = DepthProfile(
    (0.0, 2.0e-3, 2.5e-3),
    (Material(1e-10, 2e4, name="coat"), Material(3e-8, 4e3, name="bond"), Material(2e-9, 8e3)),
)
SKIN = DepthProfile((0.0, 1.0e-3), (Material(4e-9, 5e3, name="skin"), Material(1e-9, 9e3)))
CASE = DepthProfile((0.0, 1.0e-3, 4.0e-3), (Material(1e-9), Material(5e-9), Material(2e-9)), graded=True)
PLAIN = DepthProfile((0.0,), (Material(1e-9, 9e3),))
Profiles = tuple[DepthProfile, DepthProfile]


def task_of(profiles: Profiles, *, load: float, form: Form | None = None, **more: Any) -> ContactTask:
    """A task of bodies that are layered, of unworn surfaces' K and cap."""
    tops = [profile.materials[0] for profile in profiles]
    return ContactTask(
        load=load,
        hardness=min(top.hardness for top in tops),
        form=form or Form(),
        wear=(WearLaw(tops[0].wear), WearLaw(tops[1].wear)),
        compliance=1e-7,
        profiles=profiles,
        **more,
    )


def slid(contact: SlidingContact, shifts: list[int], increments: list[float]) -> Step:
    """Make all steps; return the last."""
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
def test_flat_on_flat_wears_by_the_closed_form(profiles: Profiles, device: str, threads: int) -> None:
    """Every cell bears F/A; Σ V_m / K_m = F L of each body."""
    grid, load, increments = Grid(24, 20, 0.01), 20.0, [3000.0] * 400
    with Executor(grid, device=device, threads=threads) as executor:
        contact = SlidingContact(task_of(profiles, load=load), np.zeros(grid.shape), executor, moves=False)
        row = slid(contact, [0] * 400, increments).row
        total = load * sum(increments)
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


def layered(profile: DepthProfile) -> reference.Layered:
    """The same body as the reference has it."""
    materials = profile.materials
    return reference.Layered(
        profile.depths, tuple(m.wear for m in materials), tuple(m.hardness for m in materials)
    )


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


def test_a_ball_and_its_crater_of_two_materials(device: str) -> None:
    """Where both conform, a cell has lost δ = h − r²/2R of which each body takes what the same ∫ p dL wears.

    F L = ∫ q dA over the crater = 2πR ∫₀ʰ q(δ) dδ, with δ = counter(q) + disc(q).
    """
    grid, load, radius, distance = Grid(150, 150, 0.01), 2.0, 5.0, 4.0e6
    thin = DepthProfile((0.0, 4.0e-3), (Material(2e-10, name="coat"), Material(2e-9)))
    profiles = DepthProfile((0.0,), (Material(3e-10),)), thin
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


def over_a_track(task: ContactTask, heights: FloatArray, threads: int = 1) -> tuple[Step, FloatArray]:
    """The last of many steps over a periodic disc, and the disc's wear."""
    shifts = [(3 * n) % heights.shape[0] for n in range(240)]
    with Executor(TRACK, device="cpu", threads=threads) as executor:
        contact = SlidingContact(task, heights, executor, periodic=True, track_fraction=0.25)
        step = slid(contact, shifts, [900.0] * len(shifts))
        return step, executor.to_numpy(contact.state.wear_disc).copy()


def ground(profiles: Profiles) -> tuple[ContactTask, FloatArray]:
    heights = np.random.default_rng(5).normal(0.0, 4e-4, (60, TRACK.ny))
    return task_of(profiles, load=40.0, form=Ball(0.2, 0.2)), heights


def test_on_a_track_all_exposures_are_the_load_times_the_distance() -> None:
    """∫ p dL of every cell of the disc follows from its depth alone, whatever has worn it."""
    task, heights = ground((PLAIN, COAT))
    step, wear = over_a_track(task, heights)
    slid_by_track = 0.25 * 900.0 * 240
    exposures = COAT.exposure(wear).sum() * TRACK.cell_area
    assert exposures == pytest.approx(40.0 * slid_by_track, rel=1e-12)
    assert wear.max() > COAT.depths[-1]
    parts = COAT.parts(wear).sum(axis=(1, 2)) * TRACK.cell_area / 0.25
    volumes = [step.row[f"wear_volume_disc_{material.name}"] for material in COAT.materials]
    assert_allclose(volumes, parts, rtol=1e-11)


def test_a_layer_that_is_not_worn_through_leaves_the_plain_numbers() -> None:
    """To the last bit, whatever lies below; and so does a layer of the body's own numbers."""
    thick = replace(COAT, depths=(0.0, 1.0, 2.0))
    same = DepthProfile((0.0, 1e-6, 2e-6), tuple(replace(COAT.materials[0], name=n) for n in "abc"))
    task, heights = ground((PLAIN, thick))
    plain = replace(task, profiles=None)
    (step, wear), (bare, expected) = (over_a_track(one, heights) for one in (task, plain))
    assert np.array_equal(wear, expected)
    assert {name: step.row[name] for name in bare.row} == bare.row
    _, wear = over_a_track(replace(task, profiles=(PLAIN, same)), heights)
    assert_allclose(wear, expected, rtol=1e-12)


def test_two_threads_find_the_same(two_threads: int) -> None:
    task, heights = ground((SKIN, COAT))
    (step, wear), (other, twice) = (over_a_track(task, heights, n) for n in (1, two_threads))
    assert np.array_equal(wear, twice)
    assert step.row == other.row


def test_shares_of_a_step_add_up() -> None:
    task, heights = ground((SKIN, COAT))
    row = over_a_track(task, heights)[0].row
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
