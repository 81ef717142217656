"""A programme of loads: blocks wear by their own, go on from each other, and refuse what contradicts."""

import gc
import weakref
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_stopped import HALF_SPACE, differences, run_stopped, study_of
from cases_track import small
from click.testing import CliRunner
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import InputError, Study
from warpwear.cli.main import commands, main
from warpwear.laws.friction import friction_energy
from warpwear.runs.order import RunOrder

TRACKS = ("full", "representative", "rotating")


AT_REST: tuple[str, ...] = (
    "micro, implicit",
    "micro, running in apart",
    "bearing area",
    "pieces, bearing area",
)


AT_REST += ("half-space", "two-scale", "two-scale, half-space", "two-scale, load", "macro, bearing curve")


QUICK = ("micro, implicit", "half-space", "two-scale, load", "full", "rotating, half-space")


CASES = (*AT_REST, *TRACKS, *(f"{track}, half-space" for track in TRACKS))


EACH = [pytest.param(case, marks=[] if case in QUICK else [pytest.mark.slow]) for case in CASES]


def programme(case: str, loads: list[float]) -> Study:
    """Blocks of these loads [N]: of 1/16 mm at rest, of two passes on a track."""
    length: dict[str, Any]
    if case in AT_REST:
        study, length = study_of(case, 1e9).replace({"output.snapshots": []}), {"distance": "0.0625 mm"}
        if study.stepping.increment:
            study = study.replace({"stepping.increment": "0.0078125 mm"})
    else:
        track, _, law = case.partition(", ")
        study = small(track).replace(HALF_SPACE if law else {})
        length = {"revolutions" if track == "rotating" else "passes": 2}
    return study.replace(block=[{"load": f"{load} N", **length} for load in loads])


@pytest.mark.parametrize("case", EACH)
def test_four_blocks_of_one_load_are_one_four_times_as_long(case: str, device: str) -> None:
    study = programme(case, [8.0] * 4)
    if case in AT_REST:  # where steps end at snapshots as well
        study = study.replace({"output.snapshots": [f"{block.end} mm" for block in study.blocks]})
    at_once = study.replace({"contact.load": "8 N", "sliding.distance": f"{study.sliding.total!r} mm"})
    four, one = (warpwear.run(each, device=device) for each in (study, at_once))
    assert four.study.sliding.total == one.study.sliding.distance
    for name, values in one.history.items():
        assert_array_equal(four.history[name], values, err_msg=name)
    last = [result.at(result.snapshot_distances[-1]).fields for result in (four, one)]
    for name, field in last[1].items():
        assert_array_equal(last[0][name], field, err_msg=name)
    assert set(four.history["block"]) == {1.0, 2.0, 3.0, 4.0}


@pytest.mark.parametrize("case", EACH)
def test_every_block_wears_by_its_load(case: str, device: str) -> None:
    """V = Σ K F_i L_i to rounding, however the load changes, and every step bears its block's."""
    loads = [4.0, 16.0, 6.0]
    result = warpwear.run(programme(case, loads), device=device)
    study, history = result.study, result.history
    tolerance = study.load_tolerance if study.uses_bearing_area else 0.0
    for body, law in zip(("counter", "disc"), study.wear_laws, strict=True):
        if body == "disc" and study.wear.distance_factor != "none":  # of its cells, which differ
            continue
        pending = history.get(f"pending_volume_{body}", np.zeros(1))[-1]
        expected = sum(b.load * law.wear_per_pressure(b.start, b.length) for b in study.blocks)
        assert_allclose(history[f"wear_volume_{body}"][-1] + pending, expected, rtol=1e-12 + tolerance / 4.0)
    assert_array_equal(history["load"], np.array(loads)[history["block"].astype(int) - 1])
    assert np.abs(history["load_residual"]).max() <= 1e-12 * 16.0 + tolerance
    ends = [history["distance"][history["block"] == number][-1] for number in (1, 2, 3)]
    assert_allclose(ends, [block.end for block in study.blocks], rtol=1e-12)


@pytest.mark.parametrize("case", EACH)
def test_a_run_stopped_inside_a_block_goes_on_bit_for_bit(case: str, tmp_path: Path) -> None:
    """Stopped in the second block, whose model is not the one that the run began with, and at its end."""
    study = programme(case, [4.0, 16.0, 6.0])
    one, other = tmp_path / "alone", tmp_path / "stopped"
    with warpwear.run(study, out=one, plots=False, threads=1) as alone:
        number = alone.history["block"]
        inside = int(np.flatnonzero(number == 2.0)[0]) + 2
        last = int(np.flatnonzero(number == 2.0)[-1]) + 1
    run_stopped(study, other, inside, threads=2)
    run_stopped(study, other, last - inside, resume=True, threads=1)
    warpwear.run(study, out=other, plots=False, resume=True, threads=1).close()
    assert differences(one, other) == []


def test_bodies_go_on_as_the_last_block_left_them(device: str) -> None:
    """A disc alone that wears, under a flat, is what a new run begins with."""
    flat = {"counter.radius": "inf mm", "wear.counter": 0.0, "output.snapshots": []}
    flat |= {"friction.shear_strength": "4 MPa", "grid.extent": "0.4 mm", "grid.cell": "20 um"}
    study = Study.load("v3-fine").replace(flat | {"stepping.increment": "0.125 mm"})
    blocks = [{"load": "2 N", "distance": "1 mm"}, {"load": "6 N", "distance": "1 mm"}]
    both = warpwear.run(study.replace(block=blocks), device=device)
    first = warpwear.run(study.replace({"contact.load": "2 N", "sliding.distance": "1 mm"}), device=device)
    gap = first.at(1.0).gap
    second = study.replace({"contact.load": "6 N", "sliding.distance": "1 mm"})
    alone = warpwear.run(second, surface=-(gap - gap.mean()), device=device)
    later = both.history["block"] == 2.0
    for name in ("area_contact", "pressure_max", "pressure_mean", "cof"):
        assert_allclose(both.history[name][later], alone.history[name], rtol=1e-9, err_msg=name)


def test_friction_follows_the_load_of_each_block(device: str) -> None:
    """μ = τ A/F by the block's load, and τ0 fitted at the end by the last one's."""
    fitted = {"friction.coefficient": 0.5, "friction.calibrate": "end", "friction.shear_strength": None}
    result = warpwear.run(programme("micro, implicit", [4.0, 16.0, 6.0]).replace(fitted), device=device)
    history, tau = result.history, result.summary["shear_strength_MPa"]
    assert_allclose(tau, 0.5 * 6.0 / history["area_contact"][-1], rtol=1e-12)
    assert_allclose(history["cof"], tau * history["area_contact"] / history["load"], rtol=1e-12)


def test_the_energy_of_friction_knows_where_a_load_begins() -> None:
    """Of two blocks, each with a coefficient of its own: 0.5 · 2 N · 2 mm + 0.1 · 8 N · 2 mm."""
    cof, load = np.array([0.5, 0.5, 0.1, 0.1]), np.array([2.0, 2.0, 8.0, 8.0])
    assert_allclose(friction_energy(np.arange(1.0, 5.0), cof, load)[-1], 3.6e-3, rtol=1e-14)


def test_time_goes_by_the_speed_of_each_block() -> None:
    blocks: list[dict[str, Any]] = [{"distance": "1 mm", "speed": "2 mm/s"}]
    blocks += [{"distance": "1 mm", "speed": "0.5 mm/s"}, {"cycles": 2, "frequency": "2 Hz"}]
    study = Study.load("v3-fine").replace({"grid.cell": "50 um", "sliding.stroke": "3 mm", "block": blocks})
    history = warpwear.run(study.replace({"output.snapshots": []})).history
    ends = [history["time"][history["block"] == number][-1] for number in (1, 2, 3)]
    assert_allclose(ends, [0.5, 2.5, 3.5], rtol=1e-14)


def test_a_programme_is_read_back_and_changed() -> None:
    study = programme("micro, implicit", [4.0, 16.0])
    assert Study.stored(study.to_toml()) == study
    assert [b.load for b in study.replace({"block.2.load": "9 N"}).blocks] == [4.0, 9.0]
    assert study.replace({"block.2.cycles": 2, "sliding.stroke": "3 mm"}).blocks[1].length == 12.0
    assert study.replace({"sliding.distance": "2 mm"}).block is None
    same = study.replace({"contact.load": "7 N", "block": [{"distance": "1 mm"}]})
    assert [b.load for b in same.blocks] == [7.0]
    assert [b.load for b in same.replace({"contact.load": "3 N"}).blocks] == [3.0]


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"block": [{"load": "2 N"}]}, "block 1: distance, passes, cycles, duration or revolutions must be"),
    ({"block": [{"distance": "1 mm", "passes": 2}]}, "block 1: distance and passes exclude each other"),
    ({"block": []}, "block = []: a programme has one block or more"),
    ({"block": "2 N"}, "block = '2 N' is no list of blocks; write [[block]]"),
    ({"block": [{"distance": "1 mm", "load": "9000 N"}]}, "block 1: load = 9000 N is more than the domain"),
    ({"block": [{"distance": "1 mm", "lod": "9 N"}]}, "'block.1.lod' is no key of a study"),
    ({"block": [{"distance": "1 mm", "load": "9 mm"}]}, "block.1.load = '9 mm': has the wrong dimension"),
    ({"block": [{"distance": "1 mm"}], "sliding.distance": "2 mm"}, "sliding.distance and [[block]] exclude"),
    ({"block": [{"revolutions": 2}]}, "block 1: revolutions = 2 needs track_radius"),
    (
        {"block": [{"cycles": 2, "stroke": "1 mm", "track_radius": "1 mm"}]},
        "block 1: stroke and track_radius",
    ),
    ({"block.7.load": "2 N"}, "block.7: the study has 2 blocks, numbered from 1"),
]


@pytest.mark.parametrize(("changes", "sentence"), REFUSED)
def test_blocks_that_contradict_are_refused_in_a_sentence(changes: dict[str, Any], sentence: str) -> None:
    study = programme("micro, implicit", [4.0, 16.0])
    with pytest.raises(InputError) as error:
        study.replace(changes)
    assert str(error.value).startswith(sentence)


def test_a_block_on_a_track_ends_with_a_pass() -> None:
    study = small("full")
    with pytest.raises(InputError, match=r"block 1: its length, 1\.35 mm, is not a whole number of passes"):
        study.replace(block=[{"distance": "1.35 mm"}, {"passes": 2}])
    assert study.replace(block=[{"passes": 2}, {"distance": "1.35 mm"}]).sliding.total == 1.8 + 1.35


def test_a_load_that_patches_cannot_bear_is_refused_before_the_run() -> None:
    study = programme("two-scale, load", [4.0, 16.0]).replace({"counter.radius": "0.3 mm"})
    with pytest.raises(InputError, match=r"is more than the \d+ macro cells"):
        next(iter(warpwear.steps(study.replace({"block.2.load": "160 N"}))))


def test_the_command_line_refuses_and_sweeps_blocks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "study.toml"
    path.write_text(programme("micro, implicit", [4.0, 16.0]).to_toml(), encoding="utf-8")
    run = CliRunner()
    both = ["--set", "block.2.passes=3", "--set", "block.2.distance=1 mm"]
    with pytest.raises(SystemExit, match="2"):
        main(["run", str(path), *both])
    assert capsys.readouterr().err.strip().endswith("block 2: distance and passes exclude each other.")
    names = ["--vary", "block.2.load=2 N,8 N", "--out", str(tmp_path / "sweep"), "--dry-run"]
    assert run.invoke(commands, ["sweep", str(path), *names]).exit_code == 0


@pytest.mark.parametrize("case", EACH)
def test_a_model_is_given_up_with_its_block(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No circle of references keeps its fields until the collector comes."""
    models: list[weakref.ref[Any]] = []
    model_in = RunOrder.model_in

    def watched(*order: Any) -> Any:
        model = model_in(*order)
        models.append(weakref.ref(model))
        return model

    monkeypatch.setattr(RunOrder, "model_in", watched)
    gc.disable()
    try:
        warpwear.run(programme(case, [4.0, 16.0, 6.0]))
        assert len(models) > 2
        assert not any(model() for model in models)
    finally:
        gc.enable()


def test_what_goes_by_one_load_refuses_a_programme(tmp_path: Path) -> None:
    study = programme("micro, implicit", [4.0, 16.0])
    with pytest.raises(InputError, match=r"goes by one load.*\[\[block\]\]"):
        warpwear.infer(study, unknown=["friction.shear_strength"], tests=[{"friction": "0.2 +- 0.02"}])
    warpwear.run(study, out=tmp_path / "run", plots=False).close()
    of_run = ["calibrate", "friction", "--result", str(tmp_path / "run"), "--cof", "0.5"]
    fitted = CliRunner().invoke(commands, of_run)
    assert isinstance(fitted.exception, InputError)
    assert "goes by one load" in str(fitted.exception)


def test_a_record_lists_the_blocks(device: str) -> None:
    result = warpwear.run(programme("micro, implicit", [4.0, 16.0]), device=device)
    blocks, history = result.summary["blocks"], result.history
    assert [(b["number"], b["load_N"], b["distance_mm"]) for b in blocks] == [
        (1, 4.0, 0.0625),
        (2, 16.0, 0.0625),
    ]
    worn = [b["volume_mm3"]["disc"] for b in blocks]
    assert_allclose(worn[1] / worn[0], 4.0, rtol=1e-9)
    second = history["block"] == 2.0
    mean = np.average(history["cof"][second], weights=history["increment"][second])
    assert blocks[1]["cof_mean"] == mean
    assert f"2 of 2 blocks; in the last 16 N over 0.0625 mm, mean friction {mean:.3g}" in str(result)
