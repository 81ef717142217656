"""The half-space under a ball that slides: against dense matrices, closed forms and the local law."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cases_sliding_half_space import (
    CELL,
    FLAT,
    GRID,
    KEEPS,
    SHARE,
    Dense,
    averaged,
    contact_of,
    fields_of,
    heights,
    study_of,
)
from cases_track import CELL as TRACK_CELL
from cases_track import TRACKS, WINDOW, rough, small
from numpy.testing import assert_allclose, assert_array_equal, assert_equal

import warpwear
from warpwear import Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.errors import InvariantError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels import wear_from_pressure
from warpwear.kernels.sliding import Slide
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import SlidingContact
from warpwear.models.track.model import SweptModel
from warpwear.models.track.part_length import PartLength
from warpwear.models.track.starts import AHEAD, LAP, Starts
from warpwear.runs.plan import plan_of

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms


@pytest.mark.parametrize("changes", [KEEPS, KEEPS | FLAT], ids=["counter", "flat"])
def test_every_step_is_that_of_the_dense_matrix(changes: dict[str, Any], device: str) -> None:
    """Windows of one to five cells under a ball, of the line under a flat; dents are kept."""
    study = study_of().replace(changes)
    disc = heights()
    dense = Dense(study, disc.copy())
    with Executor(GRID, device=device) as executor:
        contact = contact_of(study, disc, executor, periodic=True, track_fraction=SHARE)
        for shift, window in ((3, 3), (7, 4), (9, 1), (22, 2), (4, 5)):
            increment = window * CELL / SHARE
            step = contact.step(shift, increment, with_pressure=True)
            expected = dense.step(shift, increment, step.row["approach"])
            assert step.pressure is not None
            assert_allclose(step.pressure, expected, atol=1e-6 * study.hardness)
            assert expected.sum() * CELL**2 == pytest.approx(study.contact.load, rel=1e-6)
            assert 0.0 < step.row["area_plastic"] < step.row["area_contact"] < GRID.area
        fields = fields_of(contact, executor)
        for name in ("disc", "wear_counter", "wear_disc", "plastic_disc"):
            asked = getattr(dense, name)
            assert_allclose(fields[name], asked, atol=1e-6 * dense.wear_counter.max(), err_msg=name)
        assert_allclose(fields["counter"], dense.counter + fields["wear_counter"], atol=1e-15)
        assert dense.plastic_disc.max() > dense.wear_disc.max() > 0.0
        assert step.row["wear_volume_disc"] == pytest.approx(fields["wear_disc"].sum() * CELL**2 / SHARE)
        assert step.row["plastic_volume_disc"] == pytest.approx(
            fields["plastic_disc"].sum() * CELL**2 / SHARE
        )
        assert step.row["wear_depth_counter"] == pytest.approx(fields["wear_counter"].max())
        assert step.row["area_touched"] == pytest.approx(np.count_nonzero(fields["wear_counter"]) * CELL**2)


@pytest.mark.parametrize("changes", [{}, KEEPS], ids=["forgets", "keeps"])
def test_stiff_bodies_wear_as_by_the_local_law(changes: dict[str, Any]) -> None:
    """Where a step covers one cell, cell by cell: what is left of the compliance is K ΔL."""
    stiff = {"counter.young": "2e11 GPa", "disc.young": "2e11 GPa", "contact.load": "1 N"}
    study = study_of().replace(stiff | changes)
    disc = heights()
    moves = [(0, 0.02), (1, 0.02), (2, 0.02), (1, 0.02), (8, 0.01)]
    with Executor(GRID) as executor:
        elastic = contact_of(study, disc, executor, periodic=True)
        local_law = study.replace({"contact.law": "local"})
        local = SlidingContact(local_law.contact_task, disc.copy(), executor, periodic=True)
        for move in moves:
            found, expected = elastic.step(*move, with_pressure=True), local.step(*move, with_pressure=True)
            assert found.pressure is not None
            assert expected.pressure is not None
            assert_allclose(found.pressure, expected.pressure, atol=1e-4)
            assert found.row["approach"] == pytest.approx(expected.row["approach"], abs=1e-11)
            for name in ("area_contact", "wear_volume_counter", "wear_volume_disc", "plastic_volume_disc"):
                assert found.row[name] == pytest.approx(expected.row[name], rel=1e-6), name
        fields, asked = (fields_of(contact, executor) for contact in (elastic, local))
        for name, field in fields.items():
            assert_allclose(field, asked[name], atol=1e-11, err_msg=name)
        assert (asked["plastic_disc"].max() > 1e-5) == bool(changes)


@pytest.mark.parametrize("changes", [{}, KEEPS, FLAT, FLAT | KEEPS], ids=str)
def test_every_step_conserves_both_bodies(changes: dict[str, Any], device: str) -> None:
    """K F ΔL off each, by the fields, whatever is displaced beside it."""
    study = study_of().replace(changes)
    with Executor(GRID, device=device) as executor:
        contact = contact_of(study, heights(), executor, periodic=True, track_fraction=SHARE)
        before = fields_of(contact, executor)
        for shift, window in ((3, 3), (7, 2), (12, 4)):
            increment = window * CELL / SHARE
            row = contact.step(shift, increment).row
            now = fields_of(contact, executor)
            worn = [(now[name] - before[name]).sum() * CELL**2 for name in ("wear_counter", "wear_disc")]
            asked = [9.4e-7 * 2.0 * increment, SHARE * 12.7e-7 * 2.0 * increment]
            assert worn == pytest.approx(asked, rel=1e-12)
            lost = before["disc"] - now["disc"]
            displaced = (now["plastic_disc"] - before["plastic_disc"]).sum()
            assert lost.sum() == pytest.approx(asked[1] / CELL**2 + displaced, rel=1e-10)
            assert (displaced > 0.0) == ("sliding.plastic" in changes)
            for body in ("counter", "disc"):
                of_body = row[f"wear_volume_{body}"], row[f"archard_volume_{body}"]
                assert of_body[0] == pytest.approx(of_body[1], rel=1e-12)
            before = now
        if changes.keys() >= FLAT.keys():
            assert_array_equal(now["wear_counter"], now["wear_counter"][:1].repeat(GRID.nx, axis=0))
            assert np.ptp(now["wear_counter"], axis=1).max() > 0.0


def test_waves_on_the_counter_do_not_grow() -> None:
    """Of a length between half the window and the window S is negative: worn where they are low."""
    grid, amplitude = Grid(24, 24, CELL), 1e-5
    wave = amplitude * np.cos(2.0 * np.pi * np.arange(24) / 3.0)[:, None] * np.ones(24)
    lost = []
    for start in (np.zeros(grid.shape), wave):
        with Executor(grid) as executor:
            contact = contact_of(
                study_of(), np.zeros(grid.shape), executor, periodic=True, track_fraction=SHARE
            )
            for field in (contact.state.wear_counter, contact.state.counter):
                executor.fill(field, executor.to_numpy(field) + start)
            for step in range(8):
                contact.step(4 * step, 4 * CELL / SHARE)
            lost.append(executor.to_numpy(contact.state.wear_counter).copy())
    assert np.abs(lost[1] - lost[0]).max() <= 1.05 * amplitude


@pytest.mark.parametrize("window", [2, 3, 6, 9])
def test_the_mean_that_passes_keeps_the_sum(window: int, device: str) -> None:
    """At the edges too."""
    p = np.random.default_rng(2).random((10, 21))
    with Executor(Grid(10, 21, 1.0), device=device) as executor:
        mean, program = executor.zeros(), Program(executor)
        slides = Numbers(Slide, executor.device, window=window)
        program.launch(wear_from_pressure.means, slides.array, executor.field(p), mean)
        program.run()
        found = executor.to_numpy(mean)
        assert_allclose(found.sum(axis=0), p.sum(axis=0), rtol=1e-13)
        assert_allclose(found, averaged(p, window), rtol=1e-13)


def test_a_flat_on_a_lap_of_its_own_length_feels_no_displacement() -> None:
    """The domain repeats as the disc does."""
    unworn = {"wear.counter": "0 mm^3/N/m", "wear.disc": "0 mm^3/N/m"}
    with Executor(GRID) as executor:
        study = study_of(**FLAT).replace(unworn)
        contact = contact_of(study, heights(GRID.nx), executor, periodic=True)
        first = contact.step(0, 0.02)
        for shift in (5, 14, 3):
            step = contact.step(shift, 0.02)
            assert step.row["area_contact"] == first.row["area_contact"]
            assert step.row["approach"] == pytest.approx(first.row["approach"], rel=1e-9)


@pytest.mark.parametrize(
    ("track", "wears"),
    [pytest.param("full", True, marks=pytest.mark.slow), ("representative", True), ("rotating", False)],
    ids=str,
)
def test_a_track_goes_on_from_any_step(
    track: str, wears: bool, two_threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In every number of every row and in every cell, on one thread and on two; dents are kept."""
    monkeypatch.setattr("warpwear.models.track.part_length.LEAST_STEPS", 2)
    study = small(track, contact__law="half-space", sliding__plastic="keep", stepping__area_error=0.2)
    study = study.replace({"sliding.distance": "3 mm" if track == "rotating" else "9 mm"})
    study = study if wears else study.replace({"wear.counter": "0 mm^3/N/m"})
    path = study.track
    plan = [(increment, True) for increment, _, _ in plan_of(study)]

    def outcome(threads: int, restart: int | None) -> tuple[Any, ...]:
        with Executor(study.cells, threads=threads) as executor:
            model = SweptModel(study.contact_task, path, rough(path.rows), executor)
            steps = list(model.steps(plan[:restart]))
            if restart is not None:
                arrays, numbers = saved.save(model)
                arrays = {name: values.copy() for name, values in arrays.items()}
                model = SweptModel(study.contact_task, path, rough(path.rows), executor)
                saved.restore(model, arrays, json.loads(json.dumps(numbers)))
                steps += model.steps(plan[restart:])
            gap = model.snapshot(steps[-1], 0.9).gap
            return [step.row for step in steps], gap, *fields_of(model.contact, executor).values()

    rows, *fields = outcome(1, None)
    assert rows[0]["parts"] == path.shift > rows[-1]["parts"]
    assert np.isnan(rows[0].pop("area_error"))
    touched = fields[-1] if not wears else fields[3]  # reached, or the counter-body's wear
    assert rows[-1]["area_touched"] == pytest.approx(np.count_nonzero(touched) * TRACK_CELL**2)
    for restart in (None, 3, 8):
        again, *fields_again = outcome(two_threads, restart)
        again[0].pop("area_error")
        assert_equal(again, rows)  # of NaN, too
        for one, other in zip(fields_again, fields, strict=True):
            assert_array_equal(one, other)


@pytest.mark.parametrize("track", TRACKS)
def test_a_run_on_every_kind_of_track(track: str, device: str) -> None:
    """Volumes of both bodies, dents, and an area near that of the local law."""
    changes = {"sliding.distance": "2.17 mm", "contact.law": "half-space", "sliding.plastic": "keep"}
    study = small(track).replace(changes)
    result = warpwear.run(study, device=device)
    local = warpwear.run(study.replace({"contact.law": "local"}), device="cpu").history
    history, last = result.history, result.snapshot(-1)
    area = TRACK_CELL**2
    assert history["wear_volume_counter"][-1] == pytest.approx(9.4e-7 * 8.0 * 2.17, rel=1e-9)
    assert history["wear_volume_disc"][-1] == pytest.approx(12.7e-7 * 8.0 * 2.17, rel=1e-9)
    assert last.wear_counter.sum() * area == pytest.approx(history["wear_volume_counter"][-1])
    assert last.plastic_disc is not None
    displaced = last.plastic_disc.sum() * area / study.track.track_fraction
    assert history["plastic_volume_disc"][-1] == pytest.approx(displaced) != 0.0
    assert np.abs(history["load_residual"]).max() <= 2e-12 * 8.0
    first = slice(study.track.steps_of_pass)  # by the local law the next pass begins elsewhere
    assert_allclose(history["position"][first], local["position"][first])
    assert history["area_contact"].mean() == pytest.approx(local["area_contact"].mean(), rel=0.15)
    assert last.pressure.shape == (WINDOW, WINDOW)
    assert not [note for note in result.summary["warnings"] if "Archard" in note or "extent" in note]


@pytest.mark.parametrize("track", ["full", "representative"])
def test_a_step_over_a_smooth_disc_is_one_of_single_cells(
    track: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A row holds the means over its parts; what the bodies lost, and the last pressure, are the same."""
    monkeypatch.setattr(SlidingHalfSpace, "on_the_way", None)
    smooth = {"disc.synthetic": {"kind": "flat"}, "contact.law": "half-space", "sliding.distance": "1.8 mm"}
    monkeypatch.setattr(PartLength, "begins", False)
    study = small(track).replace(smooth)
    shift = study.track.shift
    divided, cell_by_cell = (warpwear.run(study.replace({"sliding.shift": n})) for n in (shift, 1))
    found, expected = divided.history, cell_by_cell.history
    ends = np.round(np.cumsum(found["parts"])).astype(int)
    assert found["parts"].max() == shift
    assert ends[-1] == expected["parts"].sum() == expected["parts"].size
    for name in ("distance", "wear_volume_counter", "wear_volume_disc", "area_touched", "wear_depth_disc"):
        assert_allclose(found[name], expected[name][ends - 1], rtol=1e-5, err_msg=name)
    for name, of_parts in (("area_contact", np.mean), ("approach", np.mean), ("pressure_max", np.max)):
        asked = [of_parts(part) for part in np.split(expected[name], ends[:-1])]
        assert_allclose(found[name], asked, rtol=1e-5, err_msg=name)
    assert_allclose(found["pressure_mean"] * found["area_contact"], 8.0, rtol=1e-9)
    for name, field in divided.snapshot(-1).fields.items():
        assert_allclose(field, cell_by_cell.snapshot(-1).fields[name], atol=2e-5 * np.abs(field).max())
    summed = divided.summary["track"]["parts"]
    assert summed == {"number": ends[-1], "most_of_a_step": shift, "estimated_error_at_most": None}


def test_the_error_that_parts_make_is_told_and_held() -> None:
    """Against parts of one cell; half a cycle of a smooth ball, whose outline long parts smear."""
    changes: dict[str, Any] = {"disc.synthetic": {"kind": "flat"}, "sliding.distance": "60 mm"}
    study = small("representative", contact__law="half-space").replace(changes | {"stepping.jump": 1})
    single, divided = (
        warpwear.run(study.replace({"stepping.area_error": allowed})) for allowed in (1e-6, 0.5)
    )
    areas = [run.history["area_contact"][-10:].mean() for run in (divided, single)]
    told = divided.summary["track"]["parts"]["estimated_error_at_most"]
    assert divided.history["parts"].sum() < 0.6 * single.history["parts"].sum()
    assert abs(areas[0] / areas[1] - 1.0) <= told
    assert single.summary["track"]["parts"]["estimated_error_at_most"] > 0.0


def test_parts_that_change_the_area_much_are_told_of() -> None:
    study = small("representative", contact__law="half-space", sliding__distance="60 mm")
    result = warpwear.run(study.replace({"stepping.area_error": 0.5, "disc.synthetic": {"kind": "flat"}}))
    assert any("changes the area by more than 10 %" in note for note in result.summary["warnings"])


def sliding_ball(ra: float, shift: int, *, cell: str, passes: int, **changes: str) -> dict[str, FloatArray]:
    """History of the preset `track` on a track of 1.6 mm; changes: keys with __ for the dot."""
    base = {"contact.law": "half-space", "grid.cell": cell, "grid.extent": "0.6 mm", "sliding.shift": shift}
    base |= {"sliding.track": "1.6 mm", "sliding.distance": f"{30 * passes} mm", "output.snapshots": []}
    rough = {"disc.synthetic.ra": f"{ra} um", "disc.synthetic.period": "1.6 mm"}
    base |= rough if ra else {"disc.synthetic": {"kind": "flat"}}
    dotted = {name.replace("__", "."): value for name, value in changes.items()}
    return warpwear.run(Study.load("track").replace(base | dotted)).history


def of_passes(history: dict[str, FloatArray]) -> FloatArray:
    """Mean area of each pass of 30 mm [mm²]."""
    number = np.ceil(history["distance"] / 30.0 - 1e-9).astype(int) - 1
    area, slid = history["area_contact"], history["increment"]
    return np.asarray(np.bincount(number, area * slid) / np.bincount(number, slid))


@pytest.mark.parametrize(
    ("cell", "shift", "passes"),
    [("20 um", 8, 1), *(pytest.param("10 um", n, 2, marks=pytest.mark.slow) for n in (8, 4, 2, 1))],
)
@pytest.mark.parametrize("both", [False, True], ids=["ball", "both"])
def test_a_ball_on_a_smooth_disc_has_the_exact_area(cell: str, shift: int, passes: int, both: bool) -> None:
    """A = π √(a0⁴ + 4 R K F L / π), under an even pressure; a groove this shallow adds little."""
    wear = {} if both else {"wear__disc": "0 mm^3/N/m"}
    history = sliding_ball(0.0, shift, cell=cell, passes=passes, contact__hardness="inf MPa", **wear)
    slid = np.linspace(30.0 * (passes - 1), 30.0 * passes, 2001)
    exact = np.pi * np.sqrt(0.05516**4 + 4.0 * 3.0 * 9.4e-7 * 8.0 * slid / np.pi)
    assert of_passes(history)[-1] == pytest.approx(exact.mean(), rel=0.03)
    late = history["distance"] > 30.0 * passes - 15.0
    assert (history["pressure_max"] / history["pressure_mean"])[late].max() <= 1.7
    for body in ("counter", "disc"):
        worn, asked = (history[f"{kind}_volume_{body}"] for kind in ("wear", "archard"))
        assert_allclose(worn, asked, rtol=1e-12, atol=1e-18)


@pytest.mark.slow
@pytest.mark.parametrize("hardness", ["inf MPa", "590 MPa"])
@pytest.mark.parametrize("ra", [0.1, 0.5, 3.0])
def test_the_area_on_a_rough_track_does_not_depend_on_the_length_of_a_step(ra: float, hardness: str) -> None:
    long, short = (
        of_passes(
            sliding_ball(ra, n, cell="10 um", passes=3, contact__hardness=hardness, grid__extent="0.8 mm")
        )
        for n in (8, 1)
    )
    print(f"Ra {ra} µm, {hardness}: {long} mm² at shift 8, {short} at 1, {100.0 * (long / short - 1.0)} %")
    assert_allclose(long[1:], short[1:], rtol=0.03)


def test_the_first_contact_of_a_smooth_counter_is_hertz_s() -> None:
    smooth = {"disc.synthetic": {"kind": "flat"}, "contact.hardness": "inf MPa", "grid.cell": "2.5 um"}
    smooth |= {"grid.extent": "0.16 mm", "sliding.kinematics": "swept", "sliding.stroke": "0.3 mm"}
    study = Study.load("v3-fine").replace(smooth | {"contact.law": "half-space", "sliding.distance": "0 mm"})
    row = {name: values[-1] for name, values in warpwear.run(study).history.items()}
    assert row["pressure_max"] == pytest.approx(1255.0, rel=2e-3)
    assert row["approach"] == pytest.approx(1.0143e-3, rel=2e-3)
    assert row["area_contact"] == pytest.approx(0.00956, rel=2.0 * 2.5e-3 / 0.0552)


def test_a_contact_at_the_edge_stops_the_run() -> None:
    """Volumes hold there, so that it is the extent which is named."""
    study = small("representative", contact__law="half-space", grid__extent="0.32 mm")
    with pytest.raises(InvariantError, match=r"grid\.extent = 0\.32 mm is too small: the contact"):
        warpwear.run(study)


def test_what_does_not_apply_is_told_and_what_does_not_fit_refused() -> None:
    swept = small("full", contact__law="half-space", wear__distance_factor="across")
    assert any("wear.distance_factor does not apply to sliding.kinematics" in n for n in swept.notices())
    with pytest.raises(warpwear.InputError, match=r"needs stepping\.scheme = 'implicit'"):
        swept.replace({"stepping.scheme": "explicit", "stepping.force": True})


def test_memory_is_looked_at_first(host_with: Callable[[float], None]) -> None:
    """More of it than by the local law."""
    host_with(200_000)
    warpwear.run(small("full", sliding__distance="0 mm"))
    with pytest.raises(warpwear.InputError, match=r"sliding\.track = 'full' makes a disc of"):
        warpwear.run(small("full", sliding__distance="0 mm", contact__law="half-space"))


def test_a_place_keeps_the_pressures_of_two_laps_that_were_made() -> None:
    with Executor(GRID) as executor:
        starts = Starts(executor, memory=1.0e6, places=3)
        asked = [starts.lap_of("0 0", 1.0, LAP, keeps=True) for _ in range(2)]
        assert asked[0] == asked[1]  # the first was not made
        starts.note(["0 0"], 1.0)
        second = starts.lap_of("0 0", 2.0, AHEAD, keeps=True)
        assert (asked[0].ahead, second.ahead, second.row) == (None, 0.0, asked[0].row_before)
        starts.note(["0 0"], 2.0)
        third = starts.lap_of("0 0", 3.0, AHEAD, keeps=True)
        assert (third.row, third.row_before, third.ahead) == (second.row_before, second.row, 1.0)
        assert len(starts.stored) == 2 * GRID.nx


@pytest.mark.parametrize(("cells", "expected"), [(2, 4 * 0.5 + 2 * 0.25), (None, None)])
def test_the_area_of_steps_is_known_unless_one_stood_for_others(
    cells: int | None, expected: float | None
) -> None:
    length = PartLength(study_of().contact_task, is_free=True)
    length.keep({}, {})
    length.note(0.1, 0, 0.5, 4)
    length.note(0.1, 1, 0.25, cells)
    assert length.kept == ({}, {}, [(0.1, 0), (0.1, 1)], expected)
