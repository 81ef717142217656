"""A ball that slides over a track: against an independent loop over all cells, and against closed forms."""

import itertools
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import reference
from cases_track import CELL, LOSES, TRACKS, WINDOW, rough, small
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.laws.track import spread_over
from warpwear.models.track import local
from warpwear.models.track.local import SlidingContact
from warpwear.models.track.model import SweptModel
from warpwear.runs.plan import plan_of
from warpwear.study import movement


def positions(track: str, rows: int) -> Iterator[tuple[int, int]]:
    """First row under the counter-body and cells covered, step after step: walked, not computed.

    Each pass meets the disc some cells further than the one before, round and round within its steps.
    """
    lengths = TRACKS[track][1]
    starts = [0, *itertools.accumulate(lengths)][: len(lengths)]
    there = list(zip(starts, lengths, strict=True))
    back, further = False, {"full": 4, "representative": 5, "rotating": 3}[track]
    for number in itertools.count():
        for start, length in there:
            ahead = (length // 2 + (-further if back else further) * number) % length
            middle = start + (length - ahead if back else ahead)
            yield (middle if track == "full" else (middle - WINDOW // 2) % rows), length
        if track != "rotating":
            there.reverse()
            back = not back


def plain_run(study: Study, track: str, disc: FloatArray) -> dict[str, FloatArray | list[float]]:
    """Every cell at every step, in NumPy."""
    sliding, hardness = study.sliding, study.hardness
    lap = {"full": 0.9, "representative": 3.0, "rotating": 2.0 * np.pi * 0.161}[track]
    cells = sum(TRACKS[track][1])
    share = 1.0 if track == "full" else cells * CELL / lap
    grid = Grid(WINDOW, WINDOW, CELL)
    counter = reference.counter_gap(grid.x, grid.y, 1.0)
    disc, slid, areas = disc.copy(), 0.0, []
    worn_counter, worn, dents = np.zeros_like(counter), np.zeros_like(disc), np.zeros_like(disc)
    for row, length in positions(track, disc.shape[0]):
        increment = min(length * lap / cells, sliding.total - slid)
        if increment < 1e-9:
            break
        slid += increment
        of_counter, of_disc = 9.4e-7 * increment, 12.7e-7 * increment * share
        beneath = (row + np.arange(WINDOW)) % disc.shape[0]
        gap = counter - disc[beneath]
        c = 1.0 / study.contact.stiffness + of_counter + of_disc
        contact = reference.foundation(gap, c, study.contact.load, hardness, CELL)
        areas.append(np.count_nonzero(contact.pressure) * CELL**2)
        if sliding.plastic == "keep":
            beyond = np.maximum(contact.approach - gap - c * hardness, 0.0)
            dents[beneath] += beyond
            disc[beneath] -= beyond
        worn_counter += of_counter * contact.pressure
        counter += of_counter * contact.pressure
        worn[beneath] += of_disc * contact.pressure
        disc[beneath] -= of_disc * contact.pressure
    return {
        "wear_counter": worn_counter,
        "wear_disc": worn,
        "plastic_disc": dents,
        "area": areas,
        "volumes": [
            worn_counter.sum() * CELL**2,
            worn.sum() / share * CELL**2,
            dents.sum() / share * CELL**2,
        ],
    }


def steps_of(study: Study, disc: FloatArray, device: str, *, restart: int | None = None) -> Any:
    """Steps and fields of the model; with `restart`, of another that goes on with its state at that step."""
    track = study.track
    plan = [(increment, i % 9 == 4) for i, (increment, _, _) in enumerate(plan_of(study))]
    with Executor(study.cells, device=device) as executor:

        def fresh() -> SweptModel:
            return SweptModel(study.contact_task, track, disc.copy(), executor)

        model = fresh()
        steps: list[Step] = list(model.steps(plan[:restart]))
        if restart is not None:
            arrays, numbers = saved.save(model)
            arrays = {name: values.copy() for name, values in arrays.items()}
            model = fresh()
            saved.restore(model, arrays, json.loads(json.dumps(numbers)))
            steps += model.steps(plan[restart:])
        last = next(iter(model.steps([(study.sliding.total, True)])))
        snapshot = model.snapshot(last, 0.0)
        return steps, snapshot, executor.to_numpy(model.contact.state.wear_disc).copy()


@pytest.mark.parametrize("window", [30, 31])
@pytest.mark.parametrize("track", TRACKS)
def test_the_apex_is_over_the_middle_of_the_rows_beneath(track: str, window: int) -> None:
    way = small(track, grid__extent=f"{window * CELL:.9g} mm").track
    assert way.window == window
    for step in range(2 * way.steps_of_pass):
        beneath = way.x[0] + CELL * (way.row(step) + np.arange(window))
        laps = (way.place(step) - beneath.mean()) / (way.rows * CELL)
        assert laps == pytest.approx(round(laps) if way.periodic else 0.0, abs=1e-9)


@pytest.mark.parametrize("track", TRACKS)
def test_single_cells_of_a_step_are_the_steps_of_single_cells(track: str) -> None:
    """On the way back too."""
    way = replace(small(track).track, move=0)  # as on the half-space, which alone divides steps
    one_by_one = replace(way, shift=1)
    parts = [way.row(n, done, 1) for n in range(2 * way.steps_of_pass) for done in range(way.cells_of(n))]
    assert parts == [one_by_one.row(step) for step in range(2 * one_by_one.steps_of_pass)]
    assert all(way.row(n, 0, way.cells_of(n)) == way.row(n) for n in range(2 * way.steps_of_pass))


@pytest.mark.parametrize(
    ("track", "loses"),
    [*((track, "keeps") for track in TRACKS), ("full", "forgets"), ("representative", "springs back")],
)
def test_a_track_is_that_of_every_cell(track: str, loses: str, threads: int) -> None:
    """Areas step by step, volumes and the fields at the end of a distance that ends within a step."""
    study = small(track, **{k.replace(".", "__"): v for k, v in LOSES[loses].items()})
    rows = study.track.rows
    plain = plain_run(study, track, rough(rows))
    model_plan = [(increment, False) for increment, _, _ in plan_of(study)]
    with Executor(study.cells) as executor:
        model = SweptModel(study.contact_task, study.track, rough(rows), executor)
        steps = list(model.steps(model_plan))
        state = {
            k: executor.to_numpy(getattr(model.contact.state, k)).copy() for k in model.contact.state.FIELDS
        }
    assert [step.row["area_contact"] for step in steps] == pytest.approx(plain["area"], rel=1e-12)
    for name in ("wear_counter", "wear_disc", *(["plastic_disc"] if loses != "forgets" else [])):
        assert_allclose(state[name], plain[name], rtol=1e-10, atol=1e-15, err_msg=name)
    names = ("wear_volume_counter", "wear_volume_disc", "plastic_volume_disc")
    assert [steps[-1].row[name] for name in names] == pytest.approx(plain["volumes"], rel=1e-11)
    assert (plain["volumes"][2] > 0.0) == (loses != "forgets")  # type: ignore[operator]


def test_a_counter_that_does_not_wear_was_touched_all_the_same(threads: int) -> None:
    """Its wear does not show where, so that the union of the contacts counts; across a restart too."""
    study = small("representative", wear__counter="0 mm^3/N/m")
    plan = [(increment, True) for increment, _, _ in plan_of(study)]
    track = study.track
    touched = np.zeros((WINDOW, WINDOW), dtype=bool)
    with Executor(study.cells, threads=threads) as executor:
        model = SweptModel(study.contact_task, track, rough(track.rows), executor)
        for number, increments in enumerate((plan[:9], plan[9:])):
            if number:
                arrays, numbers = saved.save(model)
                model = SweptModel(study.contact_task, track, rough(track.rows), executor)
                saved.restore(model, arrays, json.loads(json.dumps(numbers)))
            for step in model.steps(increments):
                assert step.pressure is not None
                now = step.pressure > 0.0
                touched |= now
                assert step.row["area_touched"] == pytest.approx(np.count_nonzero(touched) * CELL**2)
        assert np.count_nonzero(touched) > np.count_nonzero(now)


@pytest.mark.parametrize(("track", "loses"), [*zip(TRACKS, LOSES, strict=True)])
def test_a_track_goes_on_from_any_step(track: str, loses: str, device: str) -> None:
    """In every number of every row, and in every cell; on a GPU from the end of a block of steps."""
    study = small(track, **{k.replace(".", "__"): v for k, v in LOSES[loses].items()})
    disc = rough(study.track.rows)
    steps, snapshot, wear = steps_of(study, disc, device)
    for restart in (1, 5):
        again, snapshot_again, wear_again = steps_of(study, disc, device, restart=restart)
        assert [step.row for step in again] == [step.row for step in steps]
        assert_array_equal(wear_again, wear)
        assert_array_equal(snapshot_again.gap, snapshot.gap)
        assert_array_equal(snapshot_again.pressure, snapshot.pressure)


def test_a_run_keeps_its_track(tmp_path: Path) -> None:
    """Snapshots at the first end of a step at or after what was asked; fields over the track; the gap."""
    study = small("representative", sliding__plastic="keep", output__snapshots=["2.9 mm", "6 mm"])
    with warpwear.run(study, out=tmp_path / "run", plots=False) as result:
        track = study.track
        assert result.snapshot_distances == pytest.approx([3.0, 6.0, 7.37])
        assert_array_equal(result.track_x, track.x)
        unworn = result.track_heights()
        snapshot = result.snapshot(1)
        assert unworn.shape == snapshot.wear_disc.shape == (40, 31)
        assert snapshot.plastic_disc is not None
        assert snapshot.row is not None
        disc = unworn - snapshot.wear_disc - snapshot.plastic_disc
        beneath = disc[(snapshot.row + np.arange(31)) % 40]
        counter = reference.counter_gap(result.x, result.y, 1.0) + snapshot.wear_counter
        assert_allclose(snapshot.gap, counter - beneath, atol=1e-15)
        assert_allclose(
            snapshot.lost_beneath, (unworn - disc)[(snapshot.row + np.arange(31)) % 40], atol=1e-15
        )
        header = (tmp_path / "run" / "history.csv").read_text().splitlines()[0]
        assert header.endswith("position [mm],plastic_volume_disc [mm^3]")
        last = result.history["plastic_volume_disc"][-1]
        final = result.snapshot(-1).plastic_disc
        assert final is not None
        assert last == pytest.approx(final.sum() * CELL**2 * 3.0 / 0.8, rel=1e-11)


def test_an_interrupted_run_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From its checkpoint, to the same history and fields."""
    study = small("full", sliding__plastic="keep", output__snapshots=["1 mm", "1.9 mm"])
    study = study.replace({"run.checkpoint": "0 s", "sliding.distance": "2.3 mm"})
    with warpwear.run(study, out=tmp_path / "alone", plots=False) as alone:
        run, calls = SlidingContact._run, itertools.count()

        def stopped(self: SlidingContact, *args: Any) -> None:
            if next(calls) == 5:
                raise SystemExit("killed")
            run(self, *args)

        with monkeypatch.context() as patch:
            patch.setattr(local, "LONGEST", 2)
            patch.setattr(SlidingContact, "_run", stopped)
            with pytest.raises(SystemExit):
                warpwear.run(study, out=tmp_path / "again", plots=False)
        with warpwear.run(study, out=tmp_path / "again", plots=False, resume=True) as again:
            for name, values in alone.history.items():
                assert_array_equal(again.history[name], values, err_msg=name)
            for index in range(3):
                for name, field in alone.snapshot(index).fields.items():
                    assert_array_equal(getattr(again.snapshot(index), name), field, err_msg=name)
            assert_array_equal(again.track_heights(), alone.track_heights())


@pytest.mark.parametrize("track", TRACKS)
def test_a_step_ends_where_newton_s_is_surely_the_solution(
    track: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An evaluation is saved, nothing else changes; of a width that is no multiple of a vector's lanes."""
    study = small(track)
    sure = warpwear.run(study, device="cpu").history
    # As if cells differed, of which one stiffness does not tell how far the force is a straight line.
    monkeypatch.setattr(
        SlidingContact, "_distances", lambda self: self._executor.field(np.ones((1, self._executor.grid.ny)))
    )
    looked_at = warpwear.run(study, device="cpu").history
    assert sure["evaluations"].mean() < looked_at["evaluations"].mean() - 0.5
    assert np.abs(sure["load_residual"]).max() <= 1e-12 * study.contact.load
    for name, values in looked_at.items():
        if name not in ("evaluations", "load_residual"):
            assert_allclose(sure[name], values, rtol=1e-12, err_msg=name)


@pytest.mark.parametrize("track", TRACKS)
def test_passes_are_solved_at_other_places_until_all_were(track: str) -> None:
    """Within each step, on the disc, in as many passes as a step has cells; the half-space has one place."""
    way = small(track, sliding__shift=8).track
    assert {spread_over(cells) for cells in (1, 2, 3, 4, 8, 16)} == {0, 1, 2, 3, 5, 11}
    steps = np.arange(8 * way.steps_of_pass).reshape(8, -1)
    rows = way.row(steps) if way.periodic else way.row(steps) + WINDOW // 2
    back = (np.arange(8) % 2 * way.reverses).astype(bool)
    rows[back] = rows[back, ::-1]
    of_steps = rows[:, :-1] if way.cells % 8 else rows  # the last step may be shorter
    assert all(len({*places}) == 8 for places in of_steps.T)
    first = way.row(np.arange(way.steps_of_pass))
    still = replace(way, move=0)
    assert np.array_equal(first, still.row(np.arange(way.steps_of_pass)))
    if not way.periodic:
        assert way.row(steps).min() >= 0
        assert way.row(steps).max() + WINDOW <= way.rows
    assert small(track, contact__law="half-space").track.move == 0


def test_longer_steps_change_a_capped_area_by_little(monkeypatch: pytest.MonkeyPatch) -> None:
    """In steps of 8 cells at one place a rotating ball's area is 6 % too large, at others less than 1 %."""
    keys = {
        **{"counter.radius": "3 mm", "contact.load": "5 N", "wear.counter": "0 mm^3/N/m"},
        **{
            "wear.disc": "1e-4 mm^3/N/m",
            "grid.cell": "5 um",
            "grid.extent": "0.32 mm",
            "output.snapshots": [],
        },
        **{"sliding.stroke": None, "sliding.track_radius": "0.16 mm", "sliding.track": "full"},
        **{"sliding.distance": "60 mm", "stepping.jump": 1, "disc.synthetic.period": "0.8 mm"},
        **{"disc.synthetic.ra": "0.04 um", "disc.synthetic.cut_off": "20 um"},
    }

    def area(shift: int) -> float:
        study = Study.load("track").replace(keys | {"sliding.shift": shift})
        return warpwear.run(study).summary["area_mm2"]["contact"]

    finest = area(1)
    assert abs(area(8) / finest - 1.0) < 0.01
    monkeypatch.setattr(movement, "spread_over", lambda cells: 0)
    assert area(1) == finest
    assert area(8) / finest - 1.0 > 0.04
