"""A displaced contact that visits what can touch finds what visiting every cell finds."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
import reference
from numpy.testing import assert_allclose

from warpwear import Study
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.numbers import Numbers
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.kernels.sliding import Bodies, Slide
from warpwear.models.features.features import Features
from warpwear.models.track.local import SlidingContact
from warpwear.models.track.tiles import SlidingTiles

SHAPE, ROWS, CELL = (31, 299), 44, 0.005
STEPS = 25
TRANSITION = {
    "wear.law": "transition",
    "wear.severe_counter": "9.4e-3 mm^3/N/m",
    "wear.severe_disc": "2.54e-3 mm^3/N/m",
    "wear.transition_pressure": "550 MPa",
    "wear.transition_width": "200 MPa",
}
LAWS = {
    "implicit": {"stepping.scheme": "implicit"},
    "implicit, no cap": {"stepping.scheme": "implicit", "contact.hardness": "inf MPa"},
    "explicit": {"stepping.scheme": "explicit", "contact.stiffness": "2e5 N/mm^3"},
    "implicit, K of the pressure": TRANSITION | {"stepping.scheme": "implicit"},
    "springs, K of the pressure": TRANSITION
    | {"stepping.scheme": "implicit", "contact.stiffness": "2e5 N/mm^3"},
    "bearing area": {"stepping.scheme": "explicit", "stepping.load_tolerance": "0.00738 N"},
}


def rough(rng: np.random.Generator) -> FloatArray:
    return rng.normal(0.0, 1e-3, (ROWS, SHAPE[1])).cumsum(axis=1) * 0.1


def plateaus(rng: np.random.Generator) -> FloatArray:
    return np.round(rng.normal(0.0, 2.0, (ROWS, SHAPE[1]))) * 1e-3


def one_spike(rng: np.random.Generator) -> FloatArray:
    heights = rng.normal(0.0, 1e-4, (ROWS, SHAPE[1]))
    heights[20, 141] = 0.05
    return heights


def flat(rng: np.random.Generator) -> FloatArray:
    return np.zeros((ROWS, SHAPE[1]))


SURFACES: list[Callable[[np.random.Generator], FloatArray]] = [rough, plateaus, one_spike, flat]


@dataclass
class Plain:
    """The same contact in NumPy, every cell at every step."""

    study: Study
    counter: FloatArray
    disc: FloatArray

    def __post_init__(self) -> None:
        self.wear_counter = np.zeros_like(self.counter)
        self.wear_disc = np.zeros_like(self.disc)
        self.plastic_disc = np.zeros_like(self.disc)
        self.reached = np.zeros((1, SHAPE[1]))  # wear shows it

    def step(self, shift: int, increment: float) -> reference.Contact:
        beneath = (np.arange(SHAPE[0]) + shift) % self.disc.shape[0]
        study = self.study
        load, hardness = study.contact.load, study.hardness
        removal = [law.wear_per_pressure(0.0, increment) for law in study.wear_laws]
        c = 1.0 / study.pair.stiffness + (sum(removal) if study.stepping.scheme == "implicit" else 0.0)
        gap = self.counter - self.disc[beneath]
        if study.wear.law == "transition":
            at = study.wear_laws[0].over_pressure[0]
            lent = np.sum([increment * np.array(law.over_pressure[1]) for law in study.wear_laws], axis=0)
            contact = reference.stretched(gap, 1.0 / study.pair.stiffness, (at, lent), load, hardness, CELL)
            removal = [increment * np.interp(contact.pressure, *law.over_pressure) for law in study.wear_laws]
            c = 1.0 / study.pair.stiffness + np.interp(hardness, at, lent)
        elif c > 0.0:
            contact = reference.foundation(gap, c, load, hardness, CELL)
        else:
            contact = reference.bearing(gap, load, hardness, CELL, study.load_tolerance)
        if study.sliding.plastic == "keep":
            beyond = np.maximum(contact.approach - gap - c * hardness, 0.0)
            self.disc[beneath] -= beyond
            self.plastic_disc[beneath] += beyond
        self.counter += removal[0] * contact.pressure
        self.wear_counter += removal[0] * contact.pressure
        self.disc[beneath] -= removal[1] * contact.pressure
        self.wear_disc[beneath] += removal[1] * contact.pressure
        return contact


def study_of(law: str) -> Study:
    changes: dict[str, Any] = {"stepping.increment": "1 mm", "stepping.force": True}
    return Study.load("v3-fine").replace(changes | LAWS[law])


def displacements(rng: np.random.Generator, *, periodic: bool) -> list[tuple[int, float]]:
    """Shifts of 1 to 64 cells in both directions and steps of many lengths."""
    moves = rng.integers(1, 65, STEPS) * rng.choice([-1, 1], STEPS)
    places = moves.cumsum()
    if not periodic:  # between the ends, with stops at both
        places = np.clip(moves, 0, ROWS - SHAPE[0])
    return list(zip(places.tolist(), (10.0 ** rng.uniform(-2.5, 0.5, STEPS)).tolist(), strict=True))


def fields_of(contact: SlidingContact, executor: Executor) -> dict[str, FloatArray]:
    return {name: executor.to_numpy(v).copy() for name, v in contact.state.fields.items()}


@pytest.mark.parametrize(
    ("periodic", "threads"),
    [(True, 1), (False, 2)],
    indirect=["threads"],
    ids=["periodic, 1 thread", "track, 2 threads"],
)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("make", SURFACES)
def test_a_displaced_contact_is_that_of_every_cell(
    make: Callable[[np.random.Generator], FloatArray], law: str, periodic: bool, threads: int
) -> None:
    compare(study_of(law), make, law, periodic=periodic, threads=threads)


@pytest.mark.parametrize("stiffness", ["inf N/mm^3", "2e5 N/mm^3"])
@pytest.mark.parametrize("make", [rough, plateaus])
def test_a_disc_that_keeps_its_dents_is_that_of_every_cell(
    make: Callable[[np.random.Generator], FloatArray], stiffness: str, threads: int
) -> None:
    study = study_of("implicit").replace({"sliding.plastic": "keep", "contact.stiffness": stiffness})
    plain = compare(study, make, "implicit", periodic=True, threads=threads)
    assert plain.plastic_disc.sum() > 0.01 * plain.wear_disc.sum()


@cache
def expected_of(
    study: Study, make: Callable[[np.random.Generator], FloatArray], *, periodic: bool
) -> tuple[Plain, list[tuple[int, float, dict[str, float]]]]:
    """The plain contact after the last step; of each the cells in contact, the approach, and the row."""
    rng = np.random.default_rng(7)
    disc, grid, found = make(rng), Grid(*SHAPE, CELL), []
    plain = Plain(study, reference.counter_gap(grid.x, grid.y, study.counter.radius), disc)
    for shift, increment in displacements(rng, periodic=periodic):
        expected = plain.step(shift, increment)
        pressure = expected.pressure
        row = {
            "area_plastic": np.count_nonzero(expected.plastic) * CELL**2,
            "pressure_mean": pressure[pressure > 0.0].mean(),
            "pressure_max": pressure.max(),
            "wear_volume_counter": plain.wear_counter.sum() * CELL**2,
            "wear_volume_disc": plain.wear_disc.sum() * CELL**2,
            "wear_depth_counter": plain.wear_counter.max(),
            "wear_depth_disc": plain.wear_disc.max(),
            "area_touched": np.count_nonzero(plain.wear_counter) * CELL**2,
            "plastic_volume_disc": plain.plastic_disc.sum() * CELL**2,
        }
        found.append((np.count_nonzero(pressure), expected.approach, row))
    return plain, found


def compare(
    study: Study,
    make: Callable[[np.random.Generator], FloatArray],
    law: str,
    *,
    periodic: bool,
    threads: int,
) -> Plain:
    """Cells in contact, approach, pressures and volumes to 1e-12 over a random sequence of displacements."""
    plain, steps = expected_of(study, make, periodic=periodic)
    rng = np.random.default_rng(7)
    disc = make(rng)
    with Executor(Grid(*SHAPE, CELL), threads=threads) as executor:
        contact = SlidingContact(study.contact_task, disc, executor, periodic=periodic)
        moves = displacements(rng, periodic=periodic)
        for (shift, increment), (cells, approach, row) in zip(moves, steps, strict=True):
            found = contact.step(shift, increment)
            assert found.row["cells_in_contact"] == cells
            if law != "bearing area":  # of which any approach up to the next cell will do
                # A line ends at the load, a bend within 1e-12 of it, which few cells may bear.
                within = 1e-12 if "pressure" not in law else 1e-10
                assert found.row["approach"] == pytest.approx(approach, rel=within, abs=1e-15)
            for name, value in row.items():
                assert found.row[name] == pytest.approx(value, rel=1e-11), name
        for name, field in fields_of(contact, executor).items():
            expected_field = getattr(plain, name)[: field.shape[0]]  # one row where no dent is kept
            assert_allclose(field, expected_field, rtol=1e-11, atol=1e-15, err_msg=name)
    return plain


def run(law: str, disc: FloatArray, moves: list[tuple[int, float]], threads: int) -> tuple[list[Step], Any]:
    with Executor(Grid(*SHAPE, CELL), threads=threads) as executor:
        contact = SlidingContact(study_of(law).contact_task, disc, executor, periodic=True)
        return [contact.step(*move) for move in moves], fields_of(contact, executor)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("make", SURFACES)
def test_listed_tiles_give_what_every_tile_gives(
    make: Callable[[np.random.Generator], FloatArray],
    law: str,
    threads: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rng = np.random.default_rng(8)
    disc, moves = make(rng), displacements(rng, periodic=True)
    some, some_fields = run(law, disc, moves, threads)
    monkeypatch.setattr("warpwear.engine.tiles.LEAST_TILES", 10**9)
    every, every_fields = run(law, disc, moves, threads)
    for one, other in zip(some, every, strict=True):
        assert one.row["cells_in_contact"] == other.row["cells_in_contact"]
        for name, value in other.row.items():
            if name not in ("evaluations", "load_residual", "pressure_std"):
                rel = 1e-6 if (name, law) == ("approach", "bearing area") else 1e-11
                assert one.row[name] == pytest.approx(value, rel=rel, abs=1e-15), name
    for name, field in some_fields.items():
        assert_allclose(field, every_fields[name], rtol=1e-11, atol=1e-15, err_msg=name)


def test_bounds_follow_the_wear(threads: int) -> None:
    """After many steps the bounds and sums of every tile are those of the fields."""
    rng = np.random.default_rng(9)
    disc = rough(rng)
    with Executor(Grid(*SHAPE, CELL), threads=threads) as executor:
        contact = SlidingContact(study_of("implicit").contact_task, disc, executor, periodic=True)
        for move in displacements(rng, periodic=True):
            contact.step(*move)
        bodies = arguments(Bodies, **contact.state.fields, gap=executor.zeros())
        slides = Numbers(Slide, executor.device).array
        again = SlidingTiles(executor, bodies, slides, Features({}), least=1.0)
        assert np.array_equal(contact.tiles.lowest.to_numpy(), again.lowest.to_numpy())
        assert np.array_equal(contact.tiles.highest.to_numpy(), again.highest.to_numpy())


def test_a_step_visits_few_tiles() -> None:
    study = Study.load("v3-fine").replace({"grid.cell": "2 um"})
    from warpwear.study.surface import surface_in

    grid = study.cells
    with Executor(grid) as executor:
        contact = SlidingContact(
            study.contact_task, surface_in(study).heights(grid.x, grid.y), executor, periodic=True
        )
        for i in range(8):
            contact.step(8 * i, 8e-3)
            assert 0 < contact.tiles.lists["listed"] < 0.1 * grid.nx * executor.tiles_per_row


def test_a_track_has_ends() -> None:
    with Executor(Grid(*SHAPE, CELL)) as executor:
        contact = SlidingContact(study_of("implicit").contact_task, np.zeros((ROWS, SHAPE[1])), executor)
        contact.step(ROWS - SHAPE[0], 1e-2)
        for shift in (-1, ROWS - SHAPE[0] + 1):
            with pytest.raises(ValueError, match=f"a shift of {shift} rows leaves the disc of {ROWS} rows"):
                contact.step(shift, 1e-2)
        with pytest.raises(ValueError, match="does not fit"):
            SlidingContact(study_of("implicit").contact_task, np.zeros(SHAPE)[1:], executor)


def test_steps_that_wear_nothing_stand_between_others() -> None:
    """An implicit step without wear is on rigid cells, whatever was asked of the steps before it."""
    study = study_of("implicit")
    disc = rough(np.random.default_rng(3))

    def rows(asked: tuple[bool, ...]) -> list[dict[str, float]]:
        with Executor(Grid(*SHAPE, CELL), threads=1) as executor:
            contact = SlidingContact(study.contact_task, disc.copy(), executor, periodic=True)
            steps = zip((0.0, 0.3, 0.0, 0.3), asked, strict=True)
            return [contact.step(5, length, with_pressure=of_it).row for length, of_it in steps]

    plain = rows((False, False, False, False))
    for asked in ((True, True, False, False), (True, False, False, True)):
        for row, expected in zip(rows(asked), plain, strict=True):
            assert row == expected
