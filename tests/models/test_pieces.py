"""Runs whose wear comes off in pieces: their own books, Archard's law, and what is shown and refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import InputError, Study
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.executor import Executor
from warpwear.laws.junctions import critical_junction
from warpwear.laws.pieces import Pieces
from warpwear.models.track.bodies import SlidingBodies
from warpwear.study.surface import surface_in

CELL = 0.005
CELL = 0.005
#: A small test on the half-space at 5 µm cells; a pass of 3 mm is a lap of 0.4 mm.
SMALL: dict[str, Any] = {
    "counter.radius": "3 mm",
    "disc.synthetic.ra": "0.3 um",
    "disc.synthetic.roll_off": "80 um",
    "disc.synthetic.cut_off": "12 um",
    "disc.synthetic.period": "0.4 mm",
    "contact.load": "1 N",
    "contact.law": "half-space",
    "grid.cell": "5 um",
    "grid.extent": "0.3 mm",
    "wear.particle": "20 um",
    "wear.particle_thickness": "0.6 um",
    "sliding.distance": "6 mm",
    "sliding.stroke": "3 mm",
    "sliding.track": "0.4 mm",
    "sliding.shift": 4,
    "output.snapshots": [],
}


ARRANGEMENTS: dict[str, dict[str, Any]] = {
    "track": {"sliding.kinematics": "swept"},
    "dusty track": {"sliding.kinematics": "swept", "wear.dust_fraction": 0.2},
    "uniform start": {
        "sliding.kinematics": "swept",
        "wear.pending_start": "uniform",
        "sliding.distance": "3 mm",
    },
    "whole stroke": {
        "sliding.kinematics": "swept",
        "sliding.track": "full",
        "sliding.stroke": "0.5 mm",
        "sliding.distance": "2 mm",
        "wear.particle_thickness": "0.1 um",
    },
    "kept dents": {"sliding.kinematics": "swept", "sliding.plastic": "keep"},
    "at rest": {"stepping.increment": "0.1 mm"},
    "bearing area": {"contact.law": "local", "stepping.increment": "0.1 mm"},
    "springs": {
        "sliding.kinematics": "swept",
        "contact.law": "local",
        "contact.stiffness": "2e6 N/mm^3",
    },
}


def study_of(arrangement: str, **changes: Any) -> Study:
    dotted = {name.replace("__", "."): value for name, value in changes.items()}
    return Study.load("v3-fine").replace(SMALL | ARRANGEMENTS[arrangement] | dotted)


@pytest.mark.parametrize("arrangement", ARRANGEMENTS)
def test_what_is_worn_and_what_is_pending_are_archards_volume_at_every_step(
    device: str, arrangement: str
) -> None:
    if device != "cpu" and "law" not in str(ARRANGEMENTS[arrangement]):
        pytest.importorskip("cupy")
    study = study_of(arrangement)
    result = warpwear.run(study, device=device)
    history, pieces = result.history, result.pieces
    share = study.track.track_fraction if study.is_swept else 1.0
    for number, (body, of_stroke) in enumerate((("counter", 1.0), ("disc", share))):
        worn, asked = history[f"wear_volume_{body}"], history[f"archard_volume_{body}"]
        assert_allclose(worn + history[f"pending_volume_{body}"], asked, rtol=1e-10)
        left = pieces["volume"][pieces["body"] == number]
        assert left.size == pytest.approx(history[f"pieces_{body}"].sum() * of_stroke, abs=1e-6)
        dust = study.wear.dust_fraction * asked[-1]
        assert worn[-1] == pytest.approx(dust + left.sum() / of_stroke, rel=1e-9)
        assert np.all(left <= study.pair.pieces.volume(study.grid.cell) * (1.0 + 1e-9))
    assert history["pieces_counter"].sum() > 20
    assert np.all(np.diff(pieces["step"]) >= 0.0)
    assert np.all((pieces["diameter"] > 0.0) & (pieces["diameter"] <= 20e-3 * (1.0 + 1e-9)))


@pytest.mark.parametrize("shift", [1, 2, 4, 8])
@pytest.mark.parametrize("law", ["half-space", "local"])
def test_dust_alone_is_archards_wear_at_every_shift(shift: int, law: str) -> None:
    """Nothing is pending then: the dust is averaged along a step, and the step divided, as without pieces."""
    changes = {"sliding__shift": shift, "sliding__distance": "1.5 mm", "contact__law": law}
    dust = warpwear.run(study_of("track", wear__dust_fraction=1.0, **changes)).history
    names = ("particle", "particle_thickness", "dust_fraction", "pending_start")
    plain = {name: value for name, value in SMALL.items() if name.removeprefix("wear.") not in names}
    study = Study.load("v3-fine").replace(plain | ARRANGEMENTS["track"])
    archard = warpwear.run(study.replace({k.replace("__", "."): v for k, v in changes.items()})).history
    for name in ("area_contact", "cof", "wear_volume_counter", "wear_volume_disc", "wear_depth_disc"):
        assert_allclose(dust[name], archard[name], rtol=1e-9, err_msg=name)


def test_no_pit_is_much_deeper_than_a_piece() -> None:
    """Cuts go down to a crack surface: pits do not run away, as those of subtracted bowls do."""
    with warpwear.run(study_of("track", sliding__distance="18 mm")) as result:
        last = result.snapshots[-1]
        for wear in (last.wear_counter, last.wear_beneath):
            wide = np.lib.stride_tricks.sliding_window_view(wear, (9, 9))  # 45 µm: twice a piece
            around = np.median(wide.reshape(*wide.shape[:2], -1), axis=2)
            assert np.all(wear[4:-4, 4:-4] - around < 3.0 * 0.6e-3)
        assert last.wear_counter.max() > 2.0 * 0.6e-3  # or there is nothing to see


def test_pieces_of_a_cell_are_archards_dust() -> None:
    """Explicit Archard in the same steps, on the half-space, where a piece is less than a cell's wear."""
    increment, wear = 0.02, 10.0e-7
    study = study_of(
        "at rest",
        disc__synthetic__ra="3 um",
        wear__counter="10e-4 mm^3/N/m",
        wear__disc="10e-4 mm^3/N/m",
        wear__particle="5 um",
        wear__particle_thickness=f"{0.5 * 590.0 * wear * increment} mm",
        stepping__increment=f"{increment} mm",
        sliding__distance="0.6 mm",
        contact__hardness="590 MPa",
    )
    # stable, as explicit steps must be: 1.12 h/E* (at 5 µm cells)
    assert study.pair.effective_modulus is not None
    assert 2.0 * wear * increment <= 1.12 * study.grid.cell / study.pair.effective_modulus
    found = warpwear.run(study).history["area_contact"]
    grid = study.cells
    with Executor(grid) as executor:
        bodies = SlidingBodies.of(study.contact_task, executor, surface_in(study).heights(grid.x, grid.y))
        gap = executor.to_numpy(bodies.counter) - executor.to_numpy(bodies.disc)
        half_space = HalfSpace(
            executor, modulus=study.pair.effective_modulus, boundary="free", hardness=590.0
        )
        expected = []
        for _ in found:
            contact = half_space.solve(executor.field(gap), mean_pressure=study.contact.load / grid.area)
            expected.append(contact.cells_in_contact * grid.cell_area)
            gap = gap + 2.0 * wear * increment * contact.pressure
    late = slice(len(expected) // 2, None)
    assert found[late].mean() == pytest.approx(np.mean(expected[late]), rel=0.01)
    assert np.mean(expected[late]) > 1.1 * expected[0]  # there is wear to agree on


def test_a_start_that_is_drawn_has_pieces_at_every_stage() -> None:
    law = Pieces(0.020, 0.0006, seed=3)
    drawn = law.start((200, 100), CELL, body=0)
    full = law.volume(CELL) / (len(law.footprint(CELL)[0]) * CELL**2)
    assert drawn.min() >= 0.0
    assert drawn.max() <= full
    assert drawn.mean() == pytest.approx(0.5 * full, rel=0.05)
    assert_array_equal(drawn, law.start((200, 100), CELL, body=0))
    assert not np.array_equal(drawn, law.start((200, 100), CELL, body=1))
    assert not Pieces(0.020, 0.0006).start((200, 100), CELL, body=0).any()


def test_a_piece_has_the_volume_of_its_bowl() -> None:
    """(π/8) d*² t on fine cells, and as the coarse ones of a run cut it."""
    exact = np.pi / 8.0 * 0.02**2 * 0.0006
    assert Pieces(0.020, 0.0006).volume(0.02 / 200) == pytest.approx(exact, rel=1e-3)
    assert 1e9 * Pieces(0.020, 0.0006).volume(CELL) == pytest.approx(90.0, rel=1e-12)


def test_the_area_without_wear_in_the_step() -> None:
    """It is that of the same gap solved alone, changes nothing, and lies below the step's own."""
    changes = {"wear__particle_thickness": None, "wear__particle": None, "sliding__distance": "0.6 mm"}
    plain = warpwear.run(study_of("track", **changes)).history
    for every in (1, 4):
        asked = warpwear.run(study_of("track", **changes, output__static_area_every=every)).history
        assert "area_static" not in plain
        for name in plain:
            assert_array_equal(asked[name], plain[name])
        solved = np.isfinite(asked["area_static"])
        assert_array_equal(np.flatnonzero(solved), np.arange(0, solved.size, every))
        assert np.all(asked["area_static"][solved] < plain["area_contact"][solved])
        # At the hardness nearly everywhere, where nothing but the bodies yields.
        assert_allclose(asked["area_static"][solved], 1.0 / 590.0, rtol=0.35)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"wear.particle_thickness": None}, "wear.particle_thickness, such as '0.6 um'"),
        ({"wear.particle": "critical", "junctions.surface_energy": None}, "junctions.surface_energy"),
        ({"wear.particle": "2 um", "wear.particle_thickness": "1 um"}, "smaller than a cell"),
        ({"wear.particle": "0.2 mm"}, "a quarter of grid.extent"),
        ({"wear.particle_thickness": "30 um"}, "a piece is a flake"),
        ({"wear.distance_factor": "across"}, "allowed is 'none'"),
        (
            {"study.model": "two-scale"},
            "needs study.model = 'micro', not 'two-scale': patches would cut pieces",
        ),
        (
            {"study.model": "macro", "contact.law": "local"},
            "not 'macro': patches would cut pieces, and smooth bodies have none",
        ),
        ({"wear.dust_fraction": 1.5}, "must be at most 1"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        study_of("at rest").replace(changes)


def test_steps_and_cells_that_are_too_long_are_told_with_what_would_do() -> None:
    def told(arrangement: str, **changes: Any) -> str:
        return " ".join(study_of(arrangement, **changes).notices())

    assert "wear.particle" not in told("track")
    assert "grid.cell of 2.5 µm or less" in told("track", wear__particle="10 um")
    assert "sliding.shift = 2 would do" in told("track", wear__particle_thickness="0.1 um")
    assert "increments of 0.54 mm or less" in told("at rest", stepping__increment="2 mm")


def test_critical_pieces_are_those_of_the_softer_body() -> None:
    """By eq 2.3 with its own hardness, not the one that a contact may be fitted to."""
    critical = {
        "wear__particle": "critical",
        "junctions__surface_energy": "2 J/m^2",
        "counter__hardness": "4000 MPa",
        "disc__hardness": "2000 MPa",
    }
    study = study_of("track", **critical)
    expected = critical_junction(
        surface_energy=2e-3,
        shear_modulus=193e3 / (2.0 * 1.29),
        poisson=0.29,
        strength=2000.0 / (3.0 * np.sqrt(3.0)),
    )
    assert study.pair.pieces.diameter == pytest.approx(expected, rel=1e-12)
    (sentence,) = (s for s in study.notices() if "critical" in s)
    assert "2000 MPa" in sentence
    assert f"d* = {1e3 * expected:.3g} µm" in sentence
    assert f"{1e3 * expected / 1.44:.3g} µm or {1e3 * expected / 0.64:.3g} µm" in sentence
    harder = study.replace({"contact.hardness": "900 MPa"})
    assert harder.pair.pieces == study.pair.pieces


def test_pieces_of_a_run_are_shown(tmp_path: Path) -> None:
    result = warpwear.run(study_of("track", sliding__speed="20 mm/min"), out=tmp_path / "run", plots=False)
    told = result.summary["pieces"]
    per_mm = result.history["pieces_disc"].sum() / 6.0
    assert told["disc"]["per_minute"] == pytest.approx(20.0 * per_mm)
    assert told["counter"]["number"] == np.count_nonzero(result.pieces["body"] == 0.0)
    number = told["disc"]["number"]
    assert f"worn particles: {number} of the disc, {told['counter']['number']} of the" in str(result)
    x, y = result.pieces["x"], result.pieces["y"]
    on_counter = result.pieces["body"] == 0.0
    assert np.abs(x[on_counter]).max() < 0.5 * 0.3
    assert np.abs(x).max() <= 0.5 * 0.4
    assert np.abs(y).max() < 0.5 * 0.3
    assert result.plot.pieces().axes
    classical = warpwear.run(
        study_of("track", sliding__distance="1 mm", wear__particle=None, wear__particle_thickness=None)
    )
    with pytest.raises(InputError, match="wear leaves at once"):
        classical.plot.pieces()
    with pytest.raises(InputError, match="has no pieces"):
        _ = classical.pieces
