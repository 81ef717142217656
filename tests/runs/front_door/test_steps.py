"""The package as NumPy users hold it: steps one by one, and a callback that sees them."""

from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_front_door import same, study_of

import warpwear
from warpwear import InputError, Result
from warpwear.history.quantities import columns_of
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.checkpoint import holds_checkpoint
from warpwear.runs.step import RunStep


@pytest.mark.parametrize(
    ("preset", "changes"),
    [
        ("v1", {}),
        ("v3", {}),
        ("v3-fine", {}),
        ("v3-fine", {"contact__law": "half-space", "sliding__distance": "1 mm"}),
        ("v3-fine", {"wear__law": "exponential", "wear__decay": "0.1 1/mm"}),
        ("two-scale", {"grid__cell": "10 um"}),
        ("track", {}),
        ("track", {"sliding__plastic": "keep"}),
    ],
)
def test_steps_are_those_of_a_run(preset: str, changes: dict[str, Any]) -> None:
    study = study_of(preset, **changes)
    result = warpwear.run(study)
    snapshots = {snapshot.distance: snapshot for snapshot in result.snapshots}
    steps = []
    for step in warpwear.steps(study):
        steps.append(step)
        assert step.row is step.row
        if step.row["distance"] in snapshots:
            kept = snapshots.pop(step.row["distance"])
            assert step.snapshot().row == kept.row
            assert set(step.fields) == set(kept.fields)
            for name, field in step.fields.items():
                np.testing.assert_array_equal(field, kept.fields[name])
    assert not snapshots
    assert [step.index for step in steps] == list(range(steps[0].count))
    for column in columns_of(study):
        if column.name == "friction_energy":  # a sum over all steps
            assert np.isnan([step.row[column.name] for step in steps]).all()
            continue
        values = [step.row[column.name] for step in steps]
        np.testing.assert_array_equal(values, result.history[column.name], err_msg=column.name)
    assert steps[0].units["cof"] == "1"
    for named in (steps[0].row, steps[0].units):
        with pytest.raises(InputError, match=r"no column, field or table 'coff'; did you mean 'cof'\?"):
            named["coff"]
    with pytest.raises(InputError, match="step 0 is over"):
        steps[0].snapshot()
    # Kept steps keep no fields.
    assert not [v for step in steps for v in vars(step).values() if isinstance(v, np.ndarray)]


def test_fields_of_every_step_on_every_device(device: str, threads: int) -> None:
    study = study_of(output__snapshots=[])
    area = study.cells.cell_area
    before = None
    for step in warpwear.steps(study, device=device, threads=threads):
        if step.index % 10:
            continue
        row, snapshot = step.row, step.snapshot()
        assert snapshot.pressure.sum() * area == pytest.approx(8.0, rel=1e-9)
        assert snapshot.wear_disc.sum() * area == pytest.approx(row["wear_volume_disc"], rel=1e-9)
        assert (snapshot.pressure > 0.0).sum() == row["cells_in_contact"]
        if before is not None:  # a copy stays as it was
            assert before[0].wear_disc.sum() * area == pytest.approx(before[1]["wear_volume_disc"])
        before = snapshot, row


@pytest.mark.parametrize("stopped", [False, True])
def test_steps_that_are_made_in_blocks_are_made_alone_for_who_watches(
    stopped: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a GPU: within a block there would be no fields, and no checkpoint to go on from."""
    init, study, area = OneScaleModel.__init__, study_of(), study_of().cells.cell_area

    def in_blocks(self: OneScaleModel, *args: Any, **kwargs: Any) -> None:
        init(self, *args, **kwargs)
        self.blocks_allowed = True

    def watch(step: RunStep) -> None:
        snapshot = step.snapshot()
        assert snapshot.pressure.sum() * area == pytest.approx(8.0, rel=1e-9)
        assert snapshot.wear_disc.sum() * area == pytest.approx(step.row["wear_volume_disc"], rel=1e-9)
        if stopped and step.index == 30:
            raise TimeoutError("enough")

    monkeypatch.setattr(OneScaleModel, "__init__", in_blocks)
    whole = warpwear.run(study, callback=None if stopped else watch)
    if stopped:
        with pytest.raises(TimeoutError):
            warpwear.run(study, out=tmp_path / "out", plots=False, callback=watch)
        resumed = warpwear.run(study, out=tmp_path / "out", plots=False, resume=True)
        assert resumed.history["distance"].size == whole.history["distance"].size
        for name in ("area_contact", "wear_volume_disc", "approach"):
            np.testing.assert_allclose(resumed.history[name], whole.history[name], rtol=1e-9)
        resumed.close()


def test_a_coefficient_that_is_calibrated_is_not_known_on_the_way() -> None:
    study = study_of(friction__coefficient=0.6)
    assert all(np.isnan(step.row["cof"]) for step in warpwear.steps(study))


def test_steps_may_be_left_and_stop_where_one_is_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    for step in warpwear.steps("v3-fine"):
        assert step.count > 1000
        break
    seen = 0
    changes = {"grid.extent": "0.44 mm", "output.snapshots": [], "stepping.growth": 1.1}
    steps = warpwear.steps(study_of().replace(changes))
    seen: list[RunStep] = []
    with pytest.raises(InputError, match="the contact reached the domain's edge"):
        deque(map(seen.append, steps))
    assert len(seen) > 1
    assert capsys.readouterr().err == ""


def test_a_callback_sees_the_steps_and_changes_nothing(tmp_path: Path) -> None:
    study = study_of()
    seen: list[float] = []

    def watch(step: RunStep) -> str:
        seen.append(step.row["area_contact"] + 0.0 * float(step.fields["gap"][0, 0]))
        return "is not looked at"

    with warpwear.run(study, out=tmp_path / "out", plots=False, callback=watch) as watched:
        same(watched, warpwear.run(study))
        assert seen == watched.history["area_contact"].tolist()


@pytest.mark.parametrize("error", [ZeroDivisionError("mine"), InputError("mine"), KeyboardInterrupt()])
def test_a_callback_that_raises_stops_the_run_as_an_interrupt_does(
    error: BaseException, tmp_path: Path
) -> None:
    study, out = study_of(), tmp_path / "out"

    def watch(step: RunStep) -> None:
        if step.index == 7:
            raise error

    with pytest.raises(type(error)) as raised:
        warpwear.run(study, out=out, plots=False, callback=watch)
    assert raised.value is error
    with Result.open(out) as stopped:
        assert not stopped.finished
        assert stopped.history["distance"].size == 8
    assert holds_checkpoint(out)
    seen: list[int] = []
    with warpwear.run(
        study, out=out, plots=False, resume=True, callback=lambda step: seen.append(step.index)
    ) as result:
        same(result, warpwear.run(study))
        assert seen == list(range(8, result.history["distance"].size))
    with pytest.raises(type(error)):
        warpwear.run(study, callback=watch)


def test_a_snapshot_asked_for_on_the_way_is_the_models(watch: Callable[..., None]) -> None:
    """Fields are made when they are asked for, not at every step."""
    made: list[float] = []
    watch(OneScaleModel, "snapshot", lambda model, step, distance: made.append(distance))
    asked = [step.row["distance"] for step in warpwear.steps(study_of()) if step.index == 5 and step.fields]
    assert made == asked


def test_what_is_no_callback_is_refused_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^callback = 3: a function is expected"):
        warpwear.run("v1", callback=3, out=tmp_path / "out")  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()
