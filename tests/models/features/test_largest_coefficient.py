"""The shear of cells, bounded by a part of their pressure: closed forms, films, layers, growing junctions."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from cases_track import small

import warpwear
from warpwear import InputError, Study
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.laws.archard import WearLaw
from warpwear.laws.depth_profile import DepthProfile, LayerMaterial
from warpwear.laws.film import Film, grown_cap
from warpwear.laws.form import Ball
from warpwear.laws.task import ContactTask
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import SlidingContact

TAU, MU, RADIUS = 200.0, 0.4, 5.0
LAWS = [SlidingContact, pytest.param(SlidingHalfSpace, marks=pytest.mark.transforms)]
of_laws = pytest.mark.parametrize("law", LAWS, ids=["local", "half-space"])
#: Without wear to speak of.
UNWORN = ContactTask(
    load=30.0,
    hardness=math.inf,
    form=Ball(1.0 / RADIUS, 1.0 / RADIUS),
    wear=(WearLaw(1e-20), WearLaw(1e-20)),
    compliance=1e-6,
    largest_shear=MU / TAU,
    modulus=1.1e5,
)


@of_laws
def test_under_a_ball_it_is_the_integral_of_the_lesser(law: type[Any], device: str, threads: int) -> None:
    """Of springs 1/c the pressures are alike often up to p0, of a half-space as 1 − p²/p0²: ∫ min(τ, μ p) dA.

    With A0 the area and s = τ/μ the first is μ A0 (s − s²/2p0), the second μ A0 (s − s³/3p0²).
    """
    grid, elastic = Grid(96, 96, 0.005), law is SlidingHalfSpace
    with Executor(grid, device=device, threads=threads) as executor:
        contact = law(replace(UNWORN, half_space=elastic), np.zeros(grid.shape), executor, moves=False)
        step = contact.step(0, 1.0, with_pressure=True)
    if elastic:
        radius = (0.75 * UNWORN.load * RADIUS / 1.1e5) ** (1.0 / 3.0)
        area = math.pi * radius**2
        p0 = 1.5 * UNWORN.load / area
    else:
        p0 = math.sqrt(UNWORN.load / (math.pi * RADIUS * UNWORN.compliance))
        area = 2.0 * math.pi * RADIUS * UNWORN.compliance * p0
    limit = TAU / MU
    assert limit < 0.5 * p0
    lost = limit**3 / (3.0 * p0**2) if elastic else limit**2 / (2.0 * p0)
    sheared = step.row["area_sheared"]
    assert sheared == pytest.approx(MU / TAU * area * (limit - lost), rel=5e-3)
    of_cells = np.minimum(1.0, MU / TAU * step.pressure).sum() * grid.cell_area
    assert sheared == pytest.approx(of_cells, rel=1e-12)


@of_laws
def test_each_cell_is_sheared_by_the_least_of_film_layers_and_pressure(law: type[Any]) -> None:
    """Over a rough disc that moves: the sum of a step follows from its pressure and the depths before it."""
    coat = DepthProfile(
        (0.0, 4e-5),
        (LayerMaterial(1e-9, shear_strength=120.0, name="coat"), LayerMaterial(2e-9, shear_strength=TAU)),
    )
    plain = DepthProfile((0.0,), (LayerMaterial(1e-9, shear_strength=TAU),))
    film, grid = Film(2e-5, (True, True), shear_ratio=0.25), Grid(24, 24, 0.01)
    heights = np.random.default_rng(5).normal(0.0, 2e-4, (60, 24))
    wear = WearLaw(1e-9), WearLaw(1e-9)
    for profiles, has_film in ((None, False), (None, True), ((plain, coat), False), ((plain, coat), True)):
        task = replace(
            UNWORN,
            wear=wear,
            half_space=law is SlidingHalfSpace,
            hardness=2e3,
            profiles=profiles,
            film=film if has_film else None,
        )
        with Executor(grid, device="cpu", threads=1) as executor:
            contact = law(task, heights, executor, periodic=True)
            for n in range(12):
                contact.step(n % 60, 6.0)
            before = [
                executor.to_numpy(getattr(contact.state, f"wear_{b}")).copy() for b in ("counter", "disc")
            ]
            before[1] = before[1][12:36]
            step = contact.step(12, 6.0, with_pressure=True)
        pressure = step.pressure
        filmed = ~((before[0] > 2e-5) & (before[1] > 2e-5)) & has_film
        own = np.where((before[1] < 4e-5) & (profiles is not None), 120.0, TAU)
        shear = np.where(
            pressure > 0.0,
            np.minimum(np.minimum(np.where(filmed, np.minimum(50.0, own), own), MU * pressure), own),
            0.0,
        )
        assert 0 < filmed[pressure > 0.0].mean() < 1 or not has_film
        assert step.row["area_sheared"] == pytest.approx(shear.sum() / TAU * grid.cell_area, rel=1e-12)


BOUND = {
    "friction.shear_strength": "100 MPa",
    "friction.area": "contact",
    "friction.largest_coefficient": 0.3,
}
FLAT = {
    "counter.radius": "inf mm",
    "disc.synthetic.kind": "flat",
    "grid.cell": "20 um",
    "grid.extent": "0.4 mm",
}
SWEPT = {
    "sliding.kinematics": "swept",
    "sliding.stroke": "1 mm",
    "sliding.track": "0.4 mm",
    "sliding.shift": 2,
}
HALF_SPACE = {"contact.law": "half-space", "contact.boundary": "periodic"}
SEVERE = {f"wear.severe_{body}": "2e-3 mm^3/N/m" for body in ("counter", "disc")} | {"wear.law": "transition"}
SEVERE |= {"wear.transition_pressure": "300 MPa", "wear.transition_width": "90 MPa"}
WAYS = {
    "rest": {},
    "half-space": HALF_SPACE,
    "track": SWEPT,
    "track, half-space": SWEPT | HALF_SPACE,
    "severe": SEVERE,
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("load", [8.0, 90.0])
def test_a_flat_contact_has_the_lesser_of_both(way: str, load: float) -> None:
    """Friction is min(τ A, μ F), at rest and over a track; ploughing adds to it."""
    keys = FLAT | BOUND | {"friction.ploughing": 0.1, "contact.load": f"{load} N", "sliding.distance": "3 mm"}
    study = Study.load("v3-fine").replace(keys | {"output.snapshots": []} | WAYS[way])
    cof = warpwear.run(study).history["cof"]
    assert cof == pytest.approx(0.1 + min(100.0 * 0.16 / load, 0.3), rel=1e-9)


def test_bounded_shear_leaves_all_but_friction_as_it_is() -> None:
    """Heights, pressures and a film; friction is at most the bound, and less where it is beyond."""
    film = {"friction.film.thickness": "20 nm", "friction.film.shear_strength": "30 MPa"}
    for more in ({}, film, SEVERE):
        plain = small("rotating").replace({**BOUND, "friction.largest_coefficient": None} | more)
        one, bound, far = (
            warpwear.run(plain.replace({"friction.largest_coefficient": largest})).history
            for largest in (None, 0.1, 3.0)
        )
        same = [name for name in one if name not in ("cof", "friction_energy")]
        assert all(np.array_equal(one[name], bound[name]) for name in same)
        assert np.all(bound["cof"] < 0.1 + 1e-12)
        assert np.all(bound["cof"] < one["cof"])
        assert np.all(far["cof"] <= one["cof"] * (1.0 + 1e-12))


def test_junctions_grow_by_the_shear_that_is_left() -> None:
    """The cap solves p² + α min(τ, μ p)² = H²."""
    for tau, mu in ((40.0, 0.1), (172.0, 0.1), (172.0, 0.6), (500.0, 0.3)):
        cap = grown_cap(590.0, tau, 9.0, mu)
        assert cap**2 + 9.0 * min(tau, mu * cap) ** 2 == pytest.approx(590.0**2, rel=1e-12)
    study = Study.load("v3-fine").replace(BOUND | {"friction.junction_growth": 9.0})
    assert study.hardness == pytest.approx(max(np.sqrt(590.0**2 - 9e4), 590.0 / np.sqrt(1.81)))
    strong = {"friction.shear_strength": "500 MPa"}
    assert study.replace(strong).hardness == pytest.approx(590.0 / np.sqrt(1.81))
    with pytest.raises(InputError, match="leaves cells of 590 MPa hardness no pressure"):
        study.replace(strong | {"friction.largest_coefficient": None})


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"friction.shear_strength": None}, "needs friction.shear_strength"),
    ({"friction.area": "nominal"}, "which shears the cells in contact"),
    (
        {"friction.initial_ratio": 2.0, "friction.running_in": "9 mm"},
        "does not go with friction.largest_coeff",
    ),
    (
        {"wear.law": "energy", "wear.counter": "1e-4 mm^3/J", "wear.disc": "1e-4 mm^3/J"},
        "wear.law = 'energy'",
    ),
]


@pytest.mark.parametrize(("changes", "sentence"), REFUSED, ids=[s for _, s in REFUSED])
def test_what_it_does_not_go_with_is_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as error:
        Study.load("v3-fine").replace(BOUND | changes)
    assert "\n" not in str(error.value)


def test_patches_refuse_it() -> None:
    with pytest.raises(InputError, match="whose patches do not follow it"):
        Study.load("two-scale").replace(BOUND)
