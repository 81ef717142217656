"""A run that was stopped goes on as if it had not been."""

import json
import math
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import psutil
import pytest
from cases_stopped import CASES, KILLS, ROOT, differences, of_kills, run_stopped, short, stop, study_of
from cases_tiles import CELL, LAWS, SHAPE, SURFACES
from numpy.testing import assert_array_equal

import warpwear
from warpwear import Result, Study
from warpwear.cli import main as cli
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.engine.tiles import Tiles
from warpwear.grid import FloatArray, Grid
from warpwear.models.on_gpu import DeviceSteps
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.checkpoint import FILE_NAME
from warpwear.runs.make import model_at_rest

#: Cases whose state others have, too: quick tests leave them out.
COVERED = ("micro, implicit", "micro, many tiles", "bearing area", "two-scale, load")


def steps_of(law: str, heights: FloatArray, increments: list[float], restart: int | None) -> Any:
    """Rows and fields of a model; with `restart`, of another one that goes on with its state at that step."""
    study = Study.load("v3-fine").replace({"stepping.increment": "1 mm", "stepping.force": True} | LAWS[law])
    with Executor(Grid(*SHAPE, CELL)) as executor:
        model = OneScaleModel(study.contact_task, heights.copy(), executor)
        rows = []
        for number, increment in enumerate(increments):
            if number == restart:
                arrays, numbers = saved.save(model)
                model = OneScaleModel(study.contact_task, heights.copy(), executor)
                saved.restore(model, arrays, json.loads(json.dumps(numbers)))
            rows.append(model.advance(increment).row)
        state = model.state
        fields = (state.gap, state.unworn)
        return rows, [executor.to_numpy(field).copy() for field in fields]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("make", SURFACES)
def test_a_model_goes_on_from_any_step(
    make: Callable[[np.random.Generator], FloatArray], law: str, threads: int
) -> None:
    """After a random sequence of short and long steps, in every number of every row."""
    dice = np.random.default_rng(7)
    heights = make(dice)
    increments = (10.0 ** dice.uniform(-3.0, 1.0, 12)).tolist()
    rows, fields = steps_of(law, heights, increments, None)
    for restart in (1, int(dice.integers(2, 12))):
        again, fields_again = steps_of(law, heights, increments, restart)
        assert again == rows
        for one, other in zip(fields, fields_again, strict=True):
            assert_array_equal(one, other)


#: Laws of cell by cell, which are those of a track that does not move.
CELL_BY_CELL = {
    "radial": {"wear.distance_factor": "radial"},
    "radial, bearing area": LAWS["bearing area"] | {"wear.distance_factor": "radial"},
    "running in apart": {
        "wear.law": "running-in",
        "wear.running_in": "1 mm",
        "wear.initial_sphere": "3e-3 mm^3/N/m",
    },
}


@pytest.mark.parametrize("law", CELL_BY_CELL)
def test_a_law_of_cell_by_cell_goes_on_from_any_step(law: str, threads: int) -> None:
    dice = np.random.default_rng(11)
    heights = SURFACES[0](dice)
    plan = [(increment, False) for increment in (10.0 ** dice.uniform(-3.0, 0.0, 8)).tolist()]
    study = Study.load("v3-fine").replace({"stepping.increment": "1 mm", "stepping.force": True})
    task = study.replace(CELL_BY_CELL[law]).contact_task
    with Executor(Grid(*SHAPE, CELL)) as executor:
        rows = [step.row for step in model_at_rest(task, heights.copy(), executor).steps(plan)]
        for restart in (1, 5):
            before = model_at_rest(task, heights.copy(), executor)
            again = [step.row for step in before.steps(plan[:restart])]
            arrays, numbers = saved.save(before)
            after = model_at_rest(task, heights.copy(), executor)
            saved.restore(after, arrays, json.loads(json.dumps(numbers)))
            assert [*again, *(step.row for step in after.steps(plan[restart:]))] == rows


def test_the_list_of_tiles_is_part_of_the_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without it the test above fails: a bearing area has more than one approach within its tolerance."""
    dice = np.random.default_rng(7)
    heights = SURFACES[0](dice)
    increments = (10.0 ** dice.uniform(-3.0, 1.0, 12)).tolist()
    rows, _ = steps_of("bearing area", heights, increments, None)
    monkeypatch.setattr(Tiles, "STATE", {})
    assert any(steps_of("bearing area", heights, increments, k)[0] != rows for k in range(1, 12))


@pytest.mark.parametrize(
    "case", [pytest.param(c, marks=[pytest.mark.slow] if c in COVERED else []) for c in CASES]
)
def test_a_resumed_run_is_the_same_bit_for_bit(case: str, tmp_path: Path) -> None:
    """Stopped twice, before and after its first snapshot, on one thread and on two."""
    study = study_of(case, math.inf)
    distance = "0.2 mm" if case.startswith(("micro", "two-scale", "half-space")) else "3 mm"
    study = study.replace({"sliding.distance": distance, "output.snapshots": ["0.06 mm"]})
    one, other = tmp_path / "alone", tmp_path / "stopped"
    cores = len(psutil.Process().cpu_affinity()) if hasattr(psutil.Process, "cpu_affinity") else 1
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("warpwear.engine.executor.CELLS_PER_THREAD", 1)
        warpwear.run(study, out=one, plots=False, threads=1).close()
        run_stopped(study, other, 3, threads=min(2, cores))
        run_stopped(study, other, 5, resume=True, threads=1)
        result = warpwear.run(study, out=other, plots=False, resume=True, threads=min(2, cores))
    with result:
        assert result.finished
        assert len(result.snapshot_distances) == 2
    assert differences(one, other) == []
    assert sorted(p.name for p in other.iterdir()) == sorted(p.name for p in one.iterdir())


def test_steps_made_in_blocks_go_on_from_the_end_of_a_block(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a GPU makes them: within a block the state is ahead of the history."""
    made, init, run = [], OneScaleModel.__init__, DeviceSteps.run

    def in_blocks(self: OneScaleModel, *args: Any, **kwargs: Any) -> None:
        init(self, *args, **kwargs)
        self.blocks_allowed = True

    def stopped(self: DeviceSteps, *args: Any, **kwargs: Any) -> Any:
        made.append(1)
        if len(made) == 4:
            raise SystemExit
        return run(self, *args, **kwargs)

    monkeypatch.setattr(OneScaleModel, "__init__", in_blocks)
    monkeypatch.setattr(OneScaleModel, "longest_block", 10)
    one, other = tmp_path / "alone", tmp_path / "stopped"
    study = short().replace({"run.checkpoint": "1e-9 s"})  # 0 s would be after every step: no blocks
    warpwear.run(study, out=one, plots=False).close()
    monkeypatch.setattr(DeviceSteps, "run", stopped)
    with pytest.raises(SystemExit):
        warpwear.run(study, out=other, plots=False)
    with h5py.File(other / FILE_NAME) as file:
        assert file["rows"].shape[0] > 20
        assert list(file["snapshots"]) == ["0000"]
    warpwear.run(study, out=other, plots=False, resume=True).close()
    assert differences(one, other) == []


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
@pytest.mark.parametrize(
    ("count", "options"),
    [
        (1, ["--every", "0.02", "--case", "micro, elastic, radial"]),
        pytest.param(200, [], marks=pytest.mark.slow),
    ],
)
def test_runs_killed_at_random(count: int, options: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    monkeypatch.setenv("PYTHONPATH", path)
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)  # its processes have one, several and none
    monkeypatch.setattr(sys, "argv", [str(KILLS), "--kills", str(count), *options])
    with pytest.raises(SystemExit) as ended:
        of_kills["main"]()
    assert ended.value.code == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_an_unfinished_run_and_a_checkpoint(
    number: signal.Signals, alone: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    (tmp_path / "mine.toml").write_text(short(run__checkpoint="inf s").to_toml())
    command = ["run", str(tmp_path / "mine.toml"), "--out", str(out), "--no-plots"]
    before = signal.getsignal(signal.SIGTERM)
    try:
        with pytest.MonkeyPatch.context() as patch:
            stop(patch, 20, lambda: os.kill(os.getpid(), number))
            with pytest.raises(SystemExit) as stopped:
                cli.main(command)
        assert stopped.value.code == 130
        assert "--resume goes on from here" in capsys.readouterr().err
        with Result.open(out) as result:
            assert not result.finished
            assert result.history["distance"].size == 21  # the step was not broken off
        assert (out / FILE_NAME).is_file()
        with pytest.raises(SystemExit) as refused:
            cli.main(command)
        assert refused.value.code == 2
        told = capsys.readouterr().err
        assert "--resume" in told
        assert "--overwrite" in told
        assert told.count("\n") == 1
        for said in ("written to", "finished: nothing is left to do"):
            with pytest.raises(SystemExit) as done:
                cli.main([*command, "--resume"])
            assert done.value.code == 0
            assert said in capsys.readouterr().out
        with pytest.raises(SystemExit) as done:  # a folder that is to be resumed says itself where it is
            cli.main(["run", str(out), "--no-plots", "--resume"])
        assert done.value.code == 0
        assert f"{out}/ holds this run, finished" in capsys.readouterr().out
    finally:
        signal.signal(signal.SIGTERM, before)
    assert differences(alone, out) == []
    assert not (out / FILE_NAME).exists()
