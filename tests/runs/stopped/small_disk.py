"""Runs on small disks, in a name space of mounts of its own: `unshare -rm python small_disk.py FOLDER COUNT`.

Prints, for every size of the disk, at what stage the run stopped, and whether it went on to the same end once
the disk had more room.
"""

import contextlib
import io
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

import warpwear
from warpwear import Result, Study
from warpwear.cli import main as cli
from warpwear.runs.checkpoint import is_one

disk, count = Path(sys.argv[1]), int(sys.argv[2])
STUDY = Study.load("v3-fine").replace(
    {
        "grid.cell": "10 um",
        "sliding.distance": "0.5 mm",
        "output.snapshots": ["0.05 mm", "0.1 mm", "0.2 mm", "0.3 mm", "0.4 mm"],
        "stepping.growth": 1.5,
        "run.checkpoint": "0 s",
    }
)
ALONE = warpwear.run(STUDY).history


def mount(mebibytes: float, *options: str) -> None:
    size = ",".join(("remount", f"size={round(mebibytes * 2**10)}k")[not options :])
    subprocess.run(["mount", "-t", "tmpfs", "-o", size, "none", disk], check=True)


def called(*arguments: str) -> tuple[int, str]:
    """Exit status and what is said on standard error."""
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            cli.main([*arguments])
        except SystemExit as ended:
            return int(str(ended.code)), said.getvalue()
    return 0, said.getvalue()


def same() -> bool:
    with Result.open(disk / "out") as result:
        return result.finished and all(np.array_equal(result.history[k], v) for k, v in ALONE.items())


found = []
study = Path(os.environ.get("TMPDIR", "/tmp")) / f"small-disk-{os.getpid()}.toml"
study.write_text(STUDY.to_toml())
try:
    for number in range(count):
        mebibytes = 1.0 + 9.0 * (number / (count - 1)) ** 1.5
        mount(mebibytes)
        plots = ["--no-plots"] if number % 3 or count < 10 else []  # they take seconds
        status, said = called("run", str(study), "--out", str(disk / "out"), *plots)
        lines = said.splitlines()
        assert "Traceback" not in said, said
        if status == 0:
            stage = "finished"
            assert same()
            if "No checkpoint could be written" in said:
                stage = "finished, without checkpoints"
        else:
            assert status == 2, said
            assert lines[-1].startswith("warpwear: "), said
            stage = "nothing written"
            if is_one(disk / "out" / "checkpoint.h5"):
                stage = "stopped with a checkpoint"
                assert "a checkpoint; resume it (--resume, resume=True)" in lines[-1], said
            elif (disk / "out" / "result.h5").exists():
                stage = "finished, without all its figures"
                assert same()
            else:
                assert "holds no run" in lines[-1] or "cannot be written" in lines[-1], said
        left = [path.name for path in (disk / "out").glob(".*")] if (disk / "out").exists() else []
        assert not left, left
        mount(64.0, "remount")
        again, more = called("run", str(study), "--out", str(disk / "out"), "--resume", "--no-plots")
        resumed = "the same" if again == 0 and same() else f"status {again}: {more}"
        found.append({"MiB": mebibytes, "stage": stage, "said": lines[-1:], "resumed": resumed})
        subprocess.run(["umount", disk], check=True)
finally:
    study.unlink()
    shutil.rmtree(disk / "out", ignore_errors=True)
print(json.dumps(found))
