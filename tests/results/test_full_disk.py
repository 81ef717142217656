"""Files on a disk that is too small, half written or locked: sentences, no crash, and nothing left behind."""

import errno
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import h5py
import pytest

import warpwear
from warpwear import Study
from warpwear.results.manifest import replacing
from warpwear.results.seal import open_to_read

ROOT = Path(__file__).parents[2]
#: Mounts disks of some sizes [KiB], and writes on each.
CODE = """
import subprocess, sys
import warpwear
from warpwear.cli import main as cli
out, disk = sys.argv[1:]
for size in (64, 256, 512, 1024, 1500, 2200, 3000):
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", disk], check=True)
    try:
        cli.main(["export", out, "--format", "netcdf", "--out", disk + "/there"])
    except SystemExit as ended:
        print(size, ended.code, flush=True)
    subprocess.run(["umount", disk], check=True)
"""


@pytest.mark.skipif(shutil.which("unshare") is None, reason="no name space of mounts can be had")
def test_netcdf_on_a_full_disk(tmp_path: Path) -> None:
    pytest.importorskip("h5netcdf")
    small = {"grid.cell": "5 um", "grid.extent": "1 mm", "sliding.distance": "0.1 mm"}
    study = Study.load("v3-fine").replace({**small, "output.snapshots": ["0.05 mm"]})
    warpwear.run(study, out=tmp_path / "out", plots=False).close()
    (tmp_path / "disk").mkdir()
    done = subprocess.run(
        ["unshare", "-rm", sys.executable, "-c", CODE, str(tmp_path / "out"), str(tmp_path / "disk")],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    if "unshare" in done.stderr:
        pytest.skip("no file system of our own can be mounted here")
    assert done.returncode == 0, done.stderr
    codes = dict(line.split() for line in done.stdout.splitlines() if line[:1].isdecimal())
    assert set(codes.values()) == {"2"}
    sentences = [line for line in done.stderr.splitlines() if line.startswith("warpwear: ")]
    assert len(sentences) == len(codes)
    assert all(line.startswith("warpwear: out = ") for line in sentences)
    assert any("cannot be written: result.nc: " in line and "MiB are needed" in line for line in sentences)


def test_what_could_not_be_written_whole_leaves_nothing(tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    path.write_text("older")
    with pytest.raises(OSError, match="No space"):
        _write_half(path)
    assert path.read_text() == "older"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    with replacing(path) as new:
        new.write_text("newer")
    assert path.read_text() == "newer"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def _write_half(path: Path) -> None:
    with replacing(path) as new:
        new.write_text("half of it")
        raise OSError(errno.ENOSPC, "No space left on device")


def test_a_file_that_is_locked_for_a_moment_is_waited_for(tmp_path: Path) -> None:
    """A process that starts holds what was open, with the lock of a writer that has closed it since."""
    fcntl = pytest.importorskip("fcntl")
    path = tmp_path / "result.h5"
    with h5py.File(path, "w") as file:
        file["x"] = 1.0
    with path.open("rb") as holder:
        fcntl.flock(holder, fcntl.LOCK_EX)
        with pytest.raises(BlockingIOError):
            h5py.File(path, "r")
        later = threading.Timer(0.2, fcntl.flock, (holder, fcntl.LOCK_UN))
        later.start()
        with open_to_read(path) as file:
            assert file["x"][()] == 1.0
        later.join()
