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
from warpwear import InputError, Result, Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.models.track import local
from warpwear.models.track.local import SlidingContact
from warpwear.models.track.model import SweptModel
from warpwear.runs.plan import plan_of


def positions(track: str, rows: int) -> Iterator[tuple[int, int]]:
    """First row under the counter-body and cells covered, step after step: walked, not computed."""
    lengths = TRACKS[track][1]
    starts = [0, *itertools.accumulate(lengths)][: len(lengths)]
    there = list(zip(starts, lengths, strict=True))
    back = False
    while True:
        for start, length in there:
            middle = start + (length - length // 2 if back else length // 2)
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
    way = small(track).track
    one_by_one = replace(way, shift=1)
    parts = [way.row(n, done, 1) for n in range(2 * way.steps_of_pass) for done in range(way.cells_of(n))]
    assert parts == [one_by_one.row(step) for step in range(2 * one_by_one.steps_of_pass)]
    assert all(way.row(n, 0, way.cells_of(n)) == way.row(n) for n in range(2 * way.steps_of_pass))


def test_a_rigid_contact_on_a_track_is_warned_of() -> None:
    """Its area depends on the step; the cure is named."""

    def told(study: Study) -> bool:
        return any("depends on its length" in note for note in study.notices())

    study = small("full")
    assert told(study)
    assert any(
        "the cure is contact.law = 'half-space'" in note
        for note in warpwear.run(study.replace({"sliding.distance": "0.3 mm"})).summary["warnings"]
    )
    for changes in (
        {"contact.law": "half-space"},
        {"contact.stiffness": "2e6 N/mm^3"},
        {"sliding.kinematics": "stationary"},
    ):
        assert not told(study.replace(changes))


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


@pytest.mark.parametrize("shift", [1, 3, 8, 16, 33, 64])
def test_volumes_are_exact_under_reversal(shift: int, device: str) -> None:
    """K F L of both bodies over seven and a third passes, also where the shift does not divide the stroke."""
    changes = {"sliding.stroke": "1.5 mm", "sliding.distance": "11 mm", "sliding.shift": shift}
    changes |= {"grid.extent": "0.8 mm", "counter.radius": "3 mm", "wear.disc": "3e-3 mm^3/N/m"}
    result = warpwear.run(
        small("full", **{k.replace(".", "__"): v for k, v in changes.items()}), device=device
    )
    history = result.history
    assert history["distance"][-1] == pytest.approx(11.0, rel=1e-14)
    assert history["increment"].sum() == pytest.approx(11.0, rel=1e-12)
    assert history["wear_volume_counter"][-1] == pytest.approx(9.4e-7 * 8.0 * 11.0, rel=1e-9)
    assert history["wear_volume_disc"][-1] == pytest.approx(3e-6 * 8.0 * 11.0, rel=1e-9)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(history["position"]))))
    assert 6 <= turns.size <= 14  # into and out of the step that is made twice at each end
    assert np.abs(history["position"]).max() < 0.75 + 1e-9


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


def test_a_static_contact_and_a_measured_time() -> None:
    static = warpwear.run(small("full", sliding__distance="0 mm", contact__stiffness="2e5 N/mm^3"))
    assert static.history["distance"].tolist() == [0.0]
    spun = small("rotating").replace({"sliding.revolutions": 3, "sliding.speed": "1 mm/s"})
    assert spun.sliding.distance is None
    assert spun.sliding.total == pytest.approx(6.0 * np.pi * 0.161)
    assert warpwear.run(spun).history["time"][-1] == pytest.approx(6.0 * np.pi * 0.161)


BAD: list[tuple[dict[str, Any], str]] = [
    (
        {"sliding.track": "3.25 mm", "sliding.shift": 8},
        r"sliding\.track = 3\.25 mm is not a whole .* nearest that is, is 3\.28 mm",
    ),
    (
        {"sliding.track": "2.9 mm", "sliding.shift": 160, "disc.surface": "disc.npz", "disc.synthetic": None},
        r"sliding\.track = 2\.9 mm .* nearest that is, is 3\.2 mm",
    ),
    ({"sliding.track": "0.8 mm"}, r"sliding\.track = 0\.8 mm is shorter than grid\.extent = 1\.5 mm"),
    ({"sliding.track": "32 mm"}, r"sliding\.track = 32 mm is longer than sliding\.stroke = 30 mm"),
    (
        {"sliding.kinematics": None, "study.model": "macro"},
        r"sliding\.stroke = 30 mm: in the macro model the disc lies still; allowed are .*'stationary'",
    ),
    ({"sliding.stroke": "30.005 mm"}, r"sliding\.stroke = 30\.005 mm is not a whole number of cells"),
    ({"sliding.stroke": None}, r"'swept' needs sliding\.stroke"),
    ({"study.model": "macro"}, r"'swept' needs study\.model = 'micro', not 'macro': .*kind = 'flat'"),
    ({"sliding.track_radius": "0.2 mm"}, r"track_radius = 0\.2 mm \(a track of 1\.257 mm\) is shorter than"),
    ({"sliding.shift": 40_000}, r"sliding\.shift = 40000 cells .* longer than sliding\.stroke"),
    ({"sliding.shift": 0}, r"sliding\.shift = 0"),
    ({"sliding.shift": 2.5}, r"sliding\.shift = 2\.5"),
    ({"sliding.revolutions": 3}, r"sliding\.revolutions = 3 needs sliding\.track_radius"),
    ({"sliding.shift": 1, "grid.cell": "1 um"}, r"takes 2\.4e\+06 steps; .* a larger sliding\.shift or"),
    (
        {"stepping.scheme": "explicit", "sliding.plastic": "keep"},
        r"plastic = 'keep' needs a contact with comp",
    ),
    (
        {"stepping.scheme": "explicit", "contact.stiffness": "1e7 N/mm^3", "sliding.shift": 16},
        r"sliding\.shift = 16 cells, .* mm of sliding, is beyond the explicit stability limit",
    ),
]


@pytest.mark.parametrize(("changes", "message"), BAD, ids=[",".join(c) for c, _ in BAD])
def test_a_bad_track_is_one_sentence(changes: dict[str, Any], message: str) -> None:
    swept = {"grid.cell": "10 um", "sliding.kinematics": "swept"}
    with pytest.raises(InputError, match=message) as caught:
        Study.load("v3-fine").replace(swept | changes)
    assert "\n" not in str(caught.value)


def test_a_track_that_memory_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    study = Study.load("v3-fine").replace({"sliding.kinematics": "swept"})
    monkeypatch.setattr("warpwear.engine.executor.free_memory", lambda device: {"the host": 10**9})
    with pytest.raises(
        InputError, match=r"31500 × 1500 cells, which need 1\.5 GiB .* sliding\.track = '3\.2 mm'"
    ):
        warpwear.run(study)


def test_a_domain_too_narrow_for_the_patch_of_a_swept_counter() -> None:
    """Its patch ends 1.025 mm wide, where a disc that lies still makes 1.27 mm."""
    swept = {"grid.cell": "10 um", "sliding.kinematics": "swept", "sliding.track": "3.2 mm"}
    study = Study.load("v3-fine").replace(swept)
    with pytest.raises(
        InputError, match=r"grid\.extent = 1 mm is too small: the worn patch will be 1\.02 mm"
    ):
        warpwear.run(study.replace({"grid.extent": "1 mm"}))


def test_keys_that_do_not_apply() -> None:
    fine = Study.load("v3-fine")
    still = fine.replace({"sliding.shift": 16, "sliding.plastic": "keep"})
    assert still.notices() == [
        "sliding.shift, sliding.plastic do not apply to sliding.kinematics = 'stationary'."
    ]
    moving = fine.replace({"sliding.kinematics": "swept", "wear.distance_factor": "across"})
    told = "\n".join(moving.notices())
    assert "stepping.first, stepping.growth, stepping.largest do not apply" in told
    assert "wear.distance_factor does not apply to sliding.kinematics = 'swept'" in told
    seam = fine.replace({"sliding.kinematics": "swept", "sliding.track": "3.2 mm", "grid.cell": "10 um"})
    assert any("has a seam" in notice for notice in seam.notices())
    assert any("longer than a contact" in n for n in seam.replace({"sliding.shift": 16}).notices())
    assert fine.replace({"sliding.track_radius": "5 mm"}).sliding.stroke is None
    assert fine.replace({"sliding.track_radius": "5 mm", "sliding.revolutions": 10}).sliding.distance is None


def smooth(**changes: Any) -> Study:
    swept: dict[str, Any] = {"sliding.kinematics": "swept", "disc.synthetic.kind": "flat"}
    swept["grid.cell"] = "10 um"
    swept["output.snapshots"] = [f"{1200 + 30 * i / 8} mm" for i in range(9)]
    return Study.load("v3-fine").replace(swept | {k.replace("__", "."): v for k, v in changes.items()})


def middle_areas(result: Result) -> FloatArray:
    """Mean area in contact of each pass over the middle half of the stroke or lap, shape (passes,)."""
    history, track = result.history, result.study.track
    half = 0.25 * track.cells * track.cell
    number = np.ceil(history["distance"] / track.stroke - 1e-9).astype(int) - 1
    inside = np.abs(history["position"]) < half
    areas = np.bincount(number[inside], history["area_contact"][inside]) / np.bincount(number[inside])
    return np.asarray(areas)


@pytest.mark.slow
def test_a_smooth_disc_wears_as_known() -> None:
    """Patch √√ of counter-body only, groove K_d F L/(stroke·width), volumes, section K_d ∫p dx per pass."""
    result = warpwear.run(smooth(sliding__track="3.2 mm"))
    history, last = result.history, result.snapshot(-1)
    for name in ("patch_along", "patch_across"):  # (4 R K_s F L/π)^¼ = 1.025 mm, to a cell a side
        assert history[name][-1] == pytest.approx(1.025, abs=0.02)
    assert history["wear_volume_counter"][-1] == pytest.approx(9.4e-7 * 8.0 * 2400.0, rel=1e-9)
    assert history["wear_volume_disc"][-1] == pytest.approx(12.7e-7 * 8.0 * 2400.0, rel=1e-9)
    section = last.wear_disc.mean(axis=0)
    width = (section > 0.0).sum() * 0.01
    assert section.sum() * 0.01 == pytest.approx(12.7e-7 * 8.0 * 2400.0 / 30.0, rel=1e-9)
    assert 0.78e-3 * 0.99 < section[section > 0.0].mean() < 0.8e-3 * 1.01
    assert width == pytest.approx(1.025, abs=0.02)
    during = [result.snapshot(i) for i in range(9)]  # of one pass
    a_pass = (during[-1].wear_disc - during[0].wear_disc).mean(axis=0)
    line = np.mean([snapshot.pressure for snapshot in during], axis=0).sum(axis=0) * 0.01
    assert_allclose(a_pass, 12.7e-7 * line, atol=0.02 * a_pass.max())


@pytest.mark.slow
def test_a_representative_track_stands_for_the_whole_one() -> None:
    """On a smooth disc: volumes, patch and groove to 2 %, and the area of each pass in mid-stroke.

    On a rotating disc that too agrees. A stroke has ends, beyond which the disc is less worn: they round the
    patch's leading edges, which late costs it some of its area, and which no periodic track has.
    """
    rotating = f"{30.0 / (2.0 * np.pi)!r} mm"
    ways = [{"sliding.track": track} for track in ("full", "3.2 mm")]
    whole, part = (warpwear.run(smooth().replace(way)) for way in ways)
    round_whole, round_part = (
        warpwear.run(smooth().replace(way | {"sliding.track_radius": rotating})) for way in ways
    )
    for name in ("wear_volume_counter", "wear_volume_disc", "patch_across", "patch_along"):
        for one, other in ((part, whole), (round_part, round_whole)):
            assert one.history[name][-1] == pytest.approx(other.history[name][-1], rel=0.02)
    inside = np.abs(whole.track_x) < 14.0
    grooves = whole.snapshot(-1).wear_disc[inside].mean(axis=0), part.snapshot(-1).wear_disc.mean(axis=0)
    assert grooves[1].mean() == pytest.approx(grooves[0].mean(), rel=0.02)
    assert_allclose(middle_areas(round_part)[1:], middle_areas(round_whole)[1:], rtol=0.01)
    assert_allclose(middle_areas(part)[1:40], middle_areas(whole)[1:40], rtol=0.02)
    assert_allclose(middle_areas(part)[40:], middle_areas(whole)[40:], rtol=0.06)
    assert_allclose(middle_areas(part), middle_areas(round_part), rtol=0.01)


@pytest.mark.slow
def test_a_representative_track_on_a_rough_disc() -> None:
    """Within the scatter of five seeds and 2 %: the area of five passes, the patch.

    Steps are short: near F/H an implicit step spreads the load over cells that it has not worn down yet, by
    an area that goes with its length; on a representative track the counter-body's steps are S/P as long.
    """
    found: dict[str, list[list[float]]] = {"full": [], "3.2 mm": []}
    for (track, shift), seed in itertools.product((("full", 2), ("3.2 mm", 1)), range(5)):
        rough_one = smooth(sliding__track=track, sliding__shift=shift).replace(
            {"disc.synthetic.kind": "self-affine", "disc.synthetic.seed": seed, "output.snapshots": []}
            | {"disc.synthetic.period": "3.2 mm", "sliding.distance": "150 mm"}
        )
        result = warpwear.run(rough_one)
        patch = float(result.history["patch_across"][-1])
        found[track].append([*middle_areas(result).tolist(), patch])
    whole, part = (np.array(found[track]) for track in found)
    scatter = np.sqrt(whole.std(axis=0, ddof=1) ** 2 + part.std(axis=0, ddof=1) ** 2)
    off = np.abs(whole.mean(axis=0) - part.mean(axis=0))
    assert (off <= scatter + 0.02 * whole.mean(axis=0)).all(), (whole, part)


@pytest.mark.parametrize("track", TRACKS)
def test_a_step_ends_where_newton_s_is_surely_the_solution(
    track: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An evaluation is saved, nothing else changes; of a width that is no multiple of a vector's lanes."""
    study = small(track)
    sure = warpwear.run(study, device="cpu").history
    # As if cells differed, of which one stiffness does not tell how far the force is a straight line.
    monkeypatch.setattr(SlidingContact, "_factored", True)
    looked_at = warpwear.run(study, device="cpu").history
    assert sure["evaluations"].mean() < looked_at["evaluations"].mean() - 0.5
    assert np.abs(sure["load_residual"]).max() <= 1e-12 * study.contact.load
    for name, values in looked_at.items():
        if name not in ("evaluations", "load_residual"):
            assert_allclose(sure[name], values, rtol=1e-12, err_msg=name)
