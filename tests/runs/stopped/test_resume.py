"""A run that was stopped goes on as if it had not been, or says in one sentence why it cannot."""

import json
import math
import os
import platform
import runpy
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import psutil
import pytest
from cases_tiles import CELL, LAWS, SHAPE, SURFACES
from numpy.testing import assert_array_equal

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli import main as cli
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.engine.tiles import Tiles
from warpwear.grid import FloatArray, Grid
from warpwear.models.on_gpu import DeviceSteps
from warpwear.models.patches.half_space import HalfSpacePatches
from warpwear.models.patches.local import TwoScaleModel
from warpwear.models.rest.local import OneScaleModel
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import SlidingContact
from warpwear.results import manifest
from warpwear.results.seal import HEADER
from warpwear.runs import checkpoint
from warpwear.runs import lock as run_lock
from warpwear.runs.checkpoint import FILE_NAME
from warpwear.runs.make import model_at_rest

ROOT = Path(__file__).parents[2]
KILLS = ROOT / "bench" / "kills.py"
_kills = runpy.run_path(str(KILLS))
#: Cases whose state others have, too: quick tests leave them out.
COVERED = ("micro, implicit", "micro, many tiles", "bearing area", "two-scale, load")
CASES, differences, study_of = _kills["CASES"], _kills["differences"], _kills["study_of"]

#: What makes a step of a model that lies still, or of a contact that slides.
MODELS = (OneScaleModel, TwoScaleModel, HalfSpacePatches)
ADVANCE: dict[tuple[Any, str], Callable[..., Any]] = {(model, "advance"): model.advance for model in MODELS}
ADVANCE |= {
    (SlidingContact, "step"): SlidingContact.step,
    (SlidingHalfSpace, "slide"): SlidingHalfSpace.slide,
}

SHORT = {"sliding.distance": "0.2 mm", "output.snapshots": ["0.05 mm"]}


def short(**changes: Any) -> Study:
    """A study of 43 steps."""
    dotted = {k.replace("__", "."): v for k, v in changes.items()}
    return study_of("micro, implicit", math.inf).replace(SHORT | dotted)


def stop(monkeypatch: pytest.MonkeyPatch, after: int, how: Callable[[], None]) -> None:
    """Let something happen in the step after so many, counted from here."""
    calls: list[int] = []
    monkeypatch.setattr("warpwear.engine.executor.SMALL", 0)  # a call is a step

    def stopping(advance: Callable[..., Any]) -> Callable[..., Any]:
        def stopped(*args: Any, **kwargs: Any) -> Any:
            calls.append(1)
            if len(calls) == after + 1:
                how()
            return advance(*args, **kwargs)

        return stopped

    for (model, name), advance in ADVANCE.items():
        monkeypatch.setattr(model, name, stopping(advance))


def killed() -> None:
    raise SystemExit("killed")


def run_stopped(study: Study, out: Path, after: int, **options: Any) -> None:
    """Leaves the checkpoint of so many steps, with one after each of them."""
    study = study.replace({"run.checkpoint": "0 s"})
    with pytest.MonkeyPatch.context() as patch:
        stop(patch, after, killed)
        with pytest.raises(SystemExit):
            warpwear.run(study, out=out, plots=False, **options)
    assert (out / FILE_NAME).is_file()


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of `short` left alone."""
    out = tmp_path_factory.mktemp("runs") / "alone"
    warpwear.run(short(), out=out, plots=False, threads=1).close()
    return out


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
        _kills["main"]()
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


def test_without_a_checkpoint_it_starts_from_the_beginning(alone: Path, tmp_path: Path) -> None:
    warpwear.run(short(), out=tmp_path / "out", plots=False, resume=True).close()
    assert differences(alone, tmp_path / "out") == []
    with pytest.raises(InputError, match="resume needs out, a run folder"):
        warpwear.run(short(), resume=True)
    with pytest.raises(InputError, match="excludes overwrite"):
        warpwear.run(short(), out=tmp_path / "out", resume=True, overwrite=True)


def test_a_finished_run_is_left_as_it_is(alone: Path) -> None:
    before = (alone / "result.h5").stat()
    with warpwear.run(short(), out=alone, resume=True) as result:
        assert result.finished
    assert (alone / "result.h5").stat() == before
    with pytest.raises(InputError, match=r"holds a run of another study \(contact\.load\)"):
        warpwear.run(short(contact__load="9 N"), out=alone, resume=True)
    with pytest.raises(InputError, match=r"holds a run of another study \(friction\.shear_strength\)"):
        warpwear.run(short(friction__shear_strength="9 MPa"), out=alone, resume=True)
    warpwear.run(short(run__checkpoint="1 min", study__name="other"), out=alone, resume=True).close()
    with pytest.raises(InputError, match="already holds a run"):
        warpwear.run(short(), out=alone)


def test_what_cannot_be_resumed_is_refused_and_kept(alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_stopped(short(), out, 12)
    path = out / FILE_NAME
    good = path.read_bytes()

    def refused(match: str, study: Study | None = None) -> None:
        left = path.read_bytes()
        with pytest.raises(InputError, match=match) as error:
            warpwear.run(study or short(), out=out, plots=False, resume=True)
        assert "\n" not in str(error.value)
        assert path.read_bytes() == left
        assert [p.name for p in out.iterdir()] == [FILE_NAME]

    changed = short(contact__load="9 N", wear__disc="0 mm^3/N/m")
    refused(r"another study \(contact\.load, wear\.disc\)", changed)
    refused(r"another study \(output\.snapshots\)", short(output__snapshots=["0.1 mm"]))
    with pytest.raises(InputError, match=r"resume it \(--resume, resume=True\), or overwrite it \(--over"):
        warpwear.run(short(), out=out)
    for place in (30, HEADER + 40, len(good) - 1):
        path.write_bytes(good[:place] + bytes([good[place] ^ 1]) + good[place + 1 :])
        refused("is damaged")
    for size in (0, HEADER, len(good) // 2):
        path.write_bytes(good[:size])
        refused("damaged")
    path.write_bytes(good.replace(b"checkpoint %d " % checkpoint.FORMAT, b"checkpoint 9 ", 1))
    refused(rf"another version of warpwear \(format 9, this one reads {checkpoint.FORMAT}\)")
    path.write_bytes(good)
    # What no step depends on may change.
    renamed = short(study__name="other", friction__shear_strength="2 MPa", run__checkpoint="1 min")
    with warpwear.run(renamed, out=out, plots=False, resume=True) as result:
        assert_array_equal(result.history["cof"], 2.0 * result.history["area_contact"] / 8.0)
        assert result.study.study.name == "other"
    assert set(differences(alone, out)) == {"history/cof", "history.csv"}


def test_another_device_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_stopped(short(), out, 2)
    with checkpoint.opened(out / FILE_NAME) as found:
        assert found is not None
        with pytest.raises(InputError, match="which was made on cpu; give that one"):
            found.refuse_changes(short(), device="cuda:0")


def test_overwriting_forgets_the_checkpoint(alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_stopped(short(contact__load="9 N"), out, 12)
    warpwear.run(short(run__checkpoint="inf s"), out=out, plots=False, overwrite=True).close()
    assert differences(alone, out) == []
    assert not (out / FILE_NAME).exists()


def test_a_file_of_that_name_that_is_none_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / FILE_NAME).write_bytes(b"weights of a network")
    for overwrite in (False, True):
        with pytest.raises(InputError, match="holds other files"):
            warpwear.run(short(), out=tmp_path, overwrite=overwrite)
    with pytest.raises(InputError, match="no checkpoint of warpwear or is damaged"):
        warpwear.run(short(), out=tmp_path, resume=True)
    assert (tmp_path / FILE_NAME).read_bytes() == b"weights of a network"


def test_a_full_disk_costs_the_checkpoint_and_not_the_run(
    alone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(folder: Path, nbytes: int) -> None:
        raise OSError(28, f"{nbytes / 2**20:.0f} MiB are needed, 0 MiB are free")

    monkeypatch.setattr("warpwear.runs.checkpoint.require_free_space", full)
    with warpwear.run(short(run__checkpoint="0 s"), out=tmp_path / "out", plots=False) as result:
        told = [w for w in result.record["warnings"] if "checkpoint" in w]
        assert len(told) == 1
        assert "No checkpoint could be written: 2 MiB are needed, 0 MiB are free." in told[0]
    assert differences(alone, tmp_path / "out") == []


def test_the_last_checkpoint_stays_until_the_next_is_whole(
    alone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    run_stopped(short(), out, 12)
    good = (out / FILE_NAME).read_bytes()

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", full)
        stop(patch, 5, killed)
        with pytest.raises(SystemExit):
            warpwear.run(short(run__checkpoint="0 s"), out=out, plots=False, resume=True)
    assert (out / FILE_NAME).read_bytes() == good
    warpwear.run(short(), out=out, plots=False, resume=True).close()
    assert differences(alone, out) == []


def test_what_killed_runs_left_is_cleaned_up(tmp_path: Path) -> None:
    """A run killed before its first checkpoint leaves its lock and its work folder."""
    out = tmp_path / "out"
    (out / ".work-abc").mkdir(parents=True)
    (out / ".work-abc" / "result.h5").write_bytes(b"half")
    gone = {"pid": os.getpid(), "started": psutil.Process().create_time() - 99.0, "host": platform.node()}
    gone["work"] = [".work-abc"]
    manifest.write(out, ["history.csv"])
    (out / run_lock.NAME).write_text(json.dumps(gone))
    (out / "history.csv").write_text("half")  # killed while it moved its files into place
    study = short(sliding__distance="0 mm")
    warpwear.run(study, out=out, plots=False).close()
    assert not [p for p in out.iterdir() if p.name.startswith(".")]
    (out / ".work-abc").mkdir()  # killed when all was in place
    (out / run_lock.NAME).write_text(json.dumps(gone))
    warpwear.run(study, out=out, plots=False, resume=True).close()
    assert not [p for p in out.iterdir() if p.name.startswith(".")]


@pytest.mark.parametrize(
    ("owner", "message"),
    [
        ({"pid": os.getppid()}, rf"in use by another run \(process {os.getppid()}\)"),
        ({"host": "elsewhere"}, r"on elsewhere\).* If that is gone, delete .*\.lock"),
        (None, r"left of one that is gone and may be deleted"),
    ],
)
def test_a_folder_in_use_is_refused(tmp_path: Path, owner: dict[str, Any] | None, message: str) -> None:
    pid = os.getpid() if owner is None else owner.get("pid", os.getpid())
    known = {"pid": pid, "started": psutil.Process(pid).create_time(), "host": platform.node()}
    lock = tmp_path / run_lock.NAME
    lock.write_text("" if owner is None else json.dumps(known | owner))
    for options in ({}, {"resume": True}, {"overwrite": True}):
        with pytest.raises(InputError, match=message):
            warpwear.run(short(), out=tmp_path, **options)
    assert [p.name for p in tmp_path.iterdir()] == [run_lock.NAME]


def test_a_lock_taken_between_looking_and_taking_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parent = psutil.Process(os.getppid())
    lock = tmp_path / run_lock.NAME
    owner = {"pid": parent.pid, "started": parent.create_time(), "host": platform.node()}
    found = run_lock.psutil.Process

    def quicker(*args: Any) -> psutil.Process:  # another process takes it while this one asks for its number
        if not args:
            lock.write_text(json.dumps(owner))
        return found(*args)

    monkeypatch.setattr(run_lock.psutil, "Process", quicker)
    with pytest.raises(InputError, match=rf"in use by another run \(process {parent.pid}\)"):
        warpwear.run(short(), out=tmp_path)
    assert json.loads(lock.read_text()) == owner


def test_a_result_that_was_changed_is_refused_and_may_be_overwritten(alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(alone, out)
    with h5py.File(out / "result.h5", "a") as file:
        file.attrs["note"] = "mine"
    told = r"result\.h5 is damaged: .* another program changed it; run the study again and overwrite it"
    with pytest.raises(InputError, match=told):
        Result.open(out)
    for options in ({}, {"resume": True}):
        with pytest.raises(InputError, match=told):
            warpwear.run(short(), out=out, plots=False, **options)
    warpwear.run(short(), out=out, plots=False, overwrite=True).close()
    assert differences(alone, out) == []


def test_two_runs_in_one_folder(alone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out"
    refused: list[str] = []

    def another() -> None:
        for options in ({}, {"resume": True}, {"overwrite": True}):
            with pytest.raises(InputError, match="is in use by another run") as error:
                warpwear.run(short(), out=out, **options)
            refused.append(str(error.value))

    stop(monkeypatch, 10, another)
    warpwear.run(short(), out=out, plots=False).close()
    assert len(refused) == 3
    assert differences(alone, out) == []
    assert not (out / run_lock.NAME).exists()


def test_the_checkpoint_is_plain_hdf5(tmp_path: Path) -> None:
    run_stopped(short(), tmp_path / "out", 12)
    with h5py.File(tmp_path / "out" / FILE_NAME) as file:
        assert file["rows"].shape[0] == 12
        assert {"state.gap", "tiles.list"} <= set(file["model"])
