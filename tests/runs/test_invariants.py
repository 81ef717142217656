"""What must hold after every step is watched: a step that breaks it stops the run, in one sentence."""

import math
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_track import small as small_track
from fuzzing import check_sentence
from runs.stopped.cases_stopped import at_step

import warpwear
from warpwear import ConvergenceError, InputError, Result, Study
from warpwear.cli import main as cli
from warpwear.engine import state as saved
from warpwear.engine.program import Program
from warpwear.errors import InvariantError
from warpwear.history.rows import Rows
from warpwear.models.patches.shares import LoadSharing
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT
from warpwear.runs.invariants import Invariants
from warpwear.study.rules_track import summits, widths_with, worn_patch

SMALL = {
    "grid.cell": "20 um",
    "sliding.distance": "0.3 mm",
    "output.snapshots": ["0.2 mm"],
    "output.precision": "double",
    "stepping.growth": 1.2,
    "run.checkpoint": "0 s",
}
ROW = {
    "distance": 3.0,
    "approach": 1e-3,
    "load_residual": 0.0,
    "wear_volume_counter": 1e-5,
    "wear_volume_disc": 2e-5,
    "archard_volume_counter": 1e-5,
    "archard_volume_disc": 2e-5,
}


def small(**changes: Any) -> Study:
    return Study.load("v3-fine").replace(SMALL | {k.replace("__", "."): v for k, v in changes.items()})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"approach": math.nan}, r"approach = nan after 3 mm of sliding is no finite number"),
        ({"pressure_max": math.inf}, r"pressure_max = inf after 3 mm of sliding is no finite number"),
        ({"load_residual": 2e-11}, r"load_residual = 2e-11 N after 3 mm .* beyond 8e-12 N"),
        ({"load_residual": -1.0}, r"load_residual = -1 N"),
        (
            {"wear_volume_disc": 2.0001e-5},
            r"wear_volume_disc = 2\.0001e-05 mm³ after 3 mm of sliding is off the 2e-05 mm³ of Archard's law "
            r"by 5e-05 of it, where 1e-10 is allowed",
        ),
        ({"wear_volume_counter": 1e-5 * (1 - 2e-10)}, r"wear_volume_counter = .*Archard's law"),
        ({"archard_volume_counter": 0.0}, r"wear_volume_counter = .* by all of it"),
    ],
)
def test_rows_that_break_a_law(changes: dict[str, float], message: str) -> None:
    found = [v.sentence for v in Invariants(small()).of_row(ROW | changes)]
    assert len(found) == 1
    assert re.match(message, found[0])


def test_rows_that_break_none() -> None:
    invariants = Invariants(small())
    sound = {"load_residual": 7e-12, "wear_volume_counter": 1e-5 * (1 + 5e-11)}
    assert not [*invariants.of_row(ROW | sound)]
    assert not [*invariants.of_row(ROW | {"time": math.nan, "cof": math.nan})]
    assert not [*invariants.of_row({"distance": 1.0, "approach": 0.1})]  # of a model without those columns
    published = Invariants(Study.load("v3"))
    assert not [*published.of_row(ROW | {"load_residual": 0.49})]
    assert [*published.of_row(ROW | {"load_residual": 0.51})]


def broken(monkeypatch: pytest.MonkeyPatch, name: str, how: Any, *, step: int = 10) -> None:
    """After so many steps change a value of a field in the contact, by the way that checkpoints take."""

    def spoil(model: OneScaleModel) -> None:
        arrays, numbers = saved.save(model)
        if f"state.{name}" not in arrays:
            pytest.skip(f"the model's steps do not change {name}")
        arrays = {key: np.array(values) for key, values in arrays.items()}
        gap, field = (arrays[f"state.{key}"].reshape(model._executor.grid.nx, -1) for key in ("gap", name))
        where = np.unravel_index(gap.argmin(), gap.shape)
        field[where] = how(field[where])
        saved.restore(model, arrays, numbers)

    at_step(monkeypatch, step - 1, spoil)


def unbalanced(_: object) -> None:
    raise ConvergenceError("the load balance did not converge: 1 N of 8 N are left.")


def not_a_number(value: float) -> float:
    return math.nan


def less_worn(gap: float) -> float:
    """By a nanometre."""
    return gap - 1e-6


@cache
def alone(device: str) -> dict[str, Any]:
    """The history of an undisturbed run."""
    return warpwear.run(small(), plots=False, device=device).history


@pytest.mark.parametrize(
    ("name", "how", "message"),
    [
        # It carries no load.
        ("gap", not_a_number, r"is no finite number|N of 8 N are left"),
        ("share", not_a_number, r"is no finite number"),
        ("gap", less_worn, r"wear_volume_counter = .* of Archard's law"),
    ],
    ids=["gap", "share", "worn"],
)
def test_a_broken_state_stops_the_run_with_what_came_before(
    name: str, how: Any, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, device: str
) -> None:
    out = tmp_path / "out"
    if how is not_a_number and name == "gap" and device != "cpu":  # a GPU leaves that cell out of its sums
        message += "|of Archard's law"
    with pytest.MonkeyPatch.context() as patch:
        broken(patch, name, how)
        with pytest.raises((InvariantError, ConvergenceError), match=message) as stopped:
            warpwear.run(small(), out=out, plots=False, device=device)
    check_sentence(stopped.value)
    assert f". The run folder {out} holds the steps so far." in str(stopped.value)
    with Result.open(out) as result:
        assert not result.finished
        assert 9 <= result.history["distance"].size <= 15
        assert all(np.isfinite(v).all() for k, v in result.history.items() if k != "cof")
        assert re.search(message, result.record["warnings"][-1])
    # The last good state is there: what broke was the memory, not the equations.
    with warpwear.run(small(), out=out, plots=False, device=device, resume=True) as result:
        assert result.finished
        for column, values in alone(device).items():
            if device == "cpu":
                np.testing.assert_array_equal(result.history[column], values)
            elif column not in ("load_residual", "evaluations"):
                np.testing.assert_allclose(result.history[column], values, rtol=1e-10)
    assert not (out / CHECKPOINT).exists()


def test_without_strict_checks_it_goes_on_and_says_so_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken(monkeypatch, "gap", less_worn)
    study = small(checks__strict=False)
    with warpwear.run(study, out=tmp_path / "out", plots=False) as result:
        assert result.finished
        told = [w for w in result.summary["warnings"] if "Archard" in w]
        assert sorted(w.partition(" =")[0] for w in told) == ["wear_volume_counter", "wear_volume_disc"]


def test_numbers_that_are_none_are_written_as_such(tmp_path: Path, watch: Callable[..., None]) -> None:
    watch(Rows, "append", lambda _, row: row.update(wear_volume_disc=math.nan))
    study = small(checks__strict=False)
    with warpwear.run(study, out=tmp_path / "out", plots=False) as result:
        assert result.finished
        assert np.isnan(result.history["wear_volume_disc"][-1])
        for name in ("volumes", "disc_map", "disc_profiles"):
            result.plot.save(name, tmp_path)
    assert '"disc": null' in (tmp_path / "out" / "summary.json").read_text()


AT_EDGE = {
    "grid.extent": "0.44 mm",
    "sliding.distance": "3 mm",
    "output.snapshots": [],
    "stepping.growth": 1.1,
}


def test_a_contact_at_the_edge_leaves_the_run_so_far(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """From there it goes on where that is asked for, and tells it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(small().replace(AT_EDGE).to_toml())
    command = ["run", "mine.toml", "--out", "out", "--no-plots"]
    with pytest.raises(SystemExit) as stopped:
        cli.main(command)
    told = capsys.readouterr().err.splitlines()[-1]
    assert stopped.value.code == 2
    assert told.startswith(
        "warpwear: grid.extent = 0.44 mm is too small: the contact reached the domain's edge"
    )
    assert told.endswith(
        "a larger extent is needed, of about 0.75 mm. The run folder out holds the steps so far. "
        "To continue anyway, set checks.strict=false and resume it (--resume, resume=True)."
    )
    with Result.open("out") as result:
        steps = result.history["distance"].size
        assert not result.finished
        first = result.record["warnings"][-1]
    with pytest.raises(
        InputError, match=r"after a check failed \(edge\)\. To continue anyway, set checks\.strict=false"
    ):
        warpwear.run("mine.toml", out="out", resume=True)
    with pytest.raises(SystemExit) as done:
        cli.main([*command, "--resume", "--set", "checks.strict=false"])
    assert done.value.code == 0
    with Result.open("out") as result, warpwear.run(small(checks__strict=False).replace(AT_EDGE)) as alone:
        assert result.finished
        assert result.history["distance"].size > steps
        np.testing.assert_array_equal(result.history["approach"], alone.history["approach"])
        assert [w for w in result.record["warnings"] if "domain's edge" in w] == [first]
    assert not (tmp_path / "out" / CHECKPOINT).exists()


def test_in_memory_nothing_can_be_kept() -> None:
    with pytest.raises(
        InputError, match=r"domain's edge .*; a larger extent is needed, of about 0\.\d+ mm\.$"
    ):
        warpwear.run(small().replace(AT_EDGE))


def test_the_extent_that_is_told_holds_the_contact() -> None:
    with pytest.raises(InputError) as refused:
        warpwear.run(small().replace(AT_EDGE))
    needed = float(str(refused.value).rpartition("of about ")[2].removesuffix(" mm."))
    cell = small().grid.cell
    enough = f"{math.ceil(needed / cell) * cell:.6g} mm"
    assert warpwear.run(small().replace(AT_EDGE | {"grid.extent": enough})).finished


def test_an_extent_that_roughness_may_fill_is_told_before() -> None:
    study = small().replace(AT_EDGE | {"grid.cell": "5 um"})
    for width, expected in ((worn_patch(study), True), (max(widths_with(study, summits(study))), False)):
        cells = math.ceil(1.02 * width / study.grid.cell)
        notices = study.replace({"grid.extent": f"{cells * study.grid.cell:.6g} mm"}).notices()
        assert any("may be too small" in notice and "would do" in notice for notice in notices) == expected


@pytest.mark.parametrize(
    "changes",
    [
        {"stepping": {"first": "3 um", "largest": "40 um"}},
        {"stepping": {"increment": "0.02 mm"}},
        {"stepping": {"increment": None, "largest": None}},
    ],
    ids=["growing", "fixed", "by themselves"],
)
def test_an_unbalanced_step_leaves_the_run_so_far(
    changes: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Solving it again would end alike, so that is not what is advised."""
    at_step(monkeypatch, 10, unbalanced)
    kept = rf"The run folder {re.escape(str(tmp_path / 'out'))} holds the steps so far\."
    told = rf"8 N are left\. {kept} A new run may get further with smaller increments \(\[stepping\]\)\.$"
    with pytest.raises(ConvergenceError, match=told):
        warpwear.run(small().replace(changes), out=tmp_path / "out", plots=False)
    with Result.open(tmp_path / "out") as result:
        assert result.history["distance"].size == 10
    assert (tmp_path / "out" / CHECKPOINT).is_file()


def test_an_unbalanced_step_on_a_track_leaves_the_run_so_far(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its increments are no matter of choice."""
    at_step(monkeypatch, 10, unbalanced)
    kept = rf"8 N are left\. The run folder {re.escape(str(tmp_path / 'out'))} holds the steps so far\.$"
    with pytest.raises(ConvergenceError, match=kept):
        warpwear.run(small_track("representative"), out=tmp_path / "out", plots=False)
    with Result.open(tmp_path / "out") as result:
        assert result.history["distance"].size == 10


def test_without_a_checkpoint_a_stopped_run_begins_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """And says what stopped it once, not as a note as well."""
    broken(monkeypatch, "gap", less_worn)
    (tmp_path / "mine.toml").write_text(small(run__checkpoint="inf s").to_toml())
    with pytest.raises(SystemExit):
        cli.main(["run", str(tmp_path / "mine.toml"), "--out", str(tmp_path / "out"), "--no-plots"])
    told = capsys.readouterr().err
    assert told.endswith(
        f". The run folder {tmp_path / 'out'} holds the steps so far. "
        "To continue anyway, set checks.strict=false and resume it (--resume, resume=True).\n"
    )
    assert told.count("of Archard's law") == 1
    with Result.open(tmp_path / "out") as result:
        assert "of Archard's law" in result.record["warnings"][-1]


def test_a_load_that_patches_do_not_carry_stops_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is booked is what wore: a search that is told what is wrong is no success."""
    study = Study.load("two-scale").replace({"grid.cell": "10 um", "sliding.distance": "0.1 mm"})
    add = LoadSharing.add_to

    def add_wrong(self: LoadSharing, program: Program, evaluate: Callable[[], None]) -> None:
        def evaluate_wrong() -> None:
            evaluate()
            program.call(lambda: self.answer.assign(self.answer.numpy() * (1.0 + 1e-9)))

        add(self, program, evaluate_wrong)

    monkeypatch.setattr(LoadSharing, "add_to", add_wrong)
    with pytest.raises(ConvergenceError, match=r"^\S+ N of 8 N are left at an approach"):
        warpwear.run(study)


def test_the_wear_of_a_much_harder_body_is_no_difference_of_large_numbers() -> None:
    study = Study.load("two-scale").replace(
        {
            "grid.cell": "20 um",
            "patches.macro_cell": "100 um",
            "patches.width": None,
            "sliding.distance": "1 mm",
        }
        | {"wear.counter": "1e-3 mm^3/N/m", "wear.disc": "1e-11 mm^3/N/m"}
    )
    with warpwear.run(study) as result:
        assert abs(result.summary["conservation_relative"]["disc"]) < 1e-12
        last = result.snapshot(-1)
        np.testing.assert_allclose(last.wear_disc, 1e-8 * last.wear_counter, rtol=1e-12)


@pytest.mark.parametrize("law", ["local", "half-space"])
@pytest.mark.parametrize("least", ["counter", "disc"])
def test_a_body_that_hardly_wears_has_its_own_digits(law: str, least: str) -> None:
    """Its wear is no difference of two that are nearly equal."""
    study = small(contact__law=law).replace({f"wear.{least}": "1e-12 mm^3/N/m"})
    with warpwear.run(study) as result:
        for body in ("counter", "disc"):
            worn = result.history[f"wear_volume_{body}"][-1]
            assert worn == pytest.approx(result.history[f"archard_volume_{body}"][-1], rel=1e-12)
        at_end = result.snapshot(-1)
        k_counter, k_disc = study.wear_coefficients
        np.testing.assert_allclose(at_end.wear_disc, k_disc / k_counter * at_end.wear_counter, rtol=1e-14)
        depths = [result.history[f"wear_depth_{body}"][-1] for body in ("counter", "disc")]
        assert depths[1] / depths[0] == pytest.approx(k_disc / k_counter, rel=1e-14)
