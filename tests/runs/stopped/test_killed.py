"""Runs that are killed at random, by a signal or within a block go on to the same end."""

import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import pytest
from cases_stopped import ROOT, differences, of_kills, short, stop

import warpwear
from warpwear import Result
from warpwear.cli import main as cli
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.checkpoint import FILE_NAME


def test_steps_made_in_blocks_go_on_from_the_end_of_a_block(
    tmp_path: Path, watch: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Within a block the state is ahead of the history."""
    made: list[int] = []

    def stopped(*_: Any) -> None:
        made.append(1)
        if len(made) == 5:
            raise SystemExit

    monkeypatch.setattr(OneScaleModel, "longest_block", 10)
    one, other = tmp_path / "alone", tmp_path / "stopped"
    study = short().replace({"run.checkpoint": "1e-9 s"})  # 0 s would be after every step: no blocks
    warpwear.run(study, out=one, plots=False).close()
    watch(OneScaleModel, "_write_plan", stopped)
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
    with pytest.raises(SystemExit) as ended:
        of_kills["main"](["--kills", str(count), *options])
    assert ended.value.code == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_an_unfinished_run_and_a_checkpoint(
    number: signal.Signals, alone: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    (tmp_path / "mine.toml").write_text(short(run__checkpoint="inf s").to_toml())
    command = ["run", str(tmp_path / "mine.toml"), "--out", str(out), "--no-plots"]
    before = {one: signal.getsignal(one) for one in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
    try:
        with pytest.MonkeyPatch.context() as patch:
            stop(patch, 20, lambda: os.kill(os.getpid(), number))
            with pytest.raises(SystemExit) as stopped:
                cli.main(command)
        assert stopped.value.code == 130
        assert "go on" in (told := capsys.readouterr().err)
        assert "--resume" in told
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
        for said in ("summary.json", "finished before: nothing was left to do"):
            with pytest.raises(SystemExit) as done:
                cli.main([*command, "--resume"])
            assert done.value.code == 0
            assert said in capsys.readouterr().out
        with pytest.raises(SystemExit) as done:  # a folder that is to be resumed says itself where it is
            cli.main(["run", str(out), "--no-plots", "--resume"])
        assert done.value.code == 0
        assert "finished before: nothing was left to do" in capsys.readouterr().out
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)
    assert differences(alone, out) == []
    assert not (out / FILE_NAME).exists()
