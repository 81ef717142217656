"""Commands on disks that are nearly full: `unshare -rm python small_disk_commands.py FOLDER FREE...`.

FREE: how much of the disk is free, in MiB. Prints, for each of these and each command, how it ended, what it
said last and what it left. A command is a process of its own, so that one that crashes is told as such.
"""

import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import warpwear
from warpwear import Study
from warpwear.cli import main as cli

disk, sizes = Path(sys.argv[1]), [float(size) for size in sys.argv[2:]]
#: Size of the disk [MiB].
DISK = 6.0
STUDY = Study.load("v3-fine").replace(
    {"grid.cell": "10 um", "sliding.distance": "0.5 mm", "output.snapshots": ["0.1 mm"]}
)


def called(arguments: list[str]) -> tuple[int, list[str]]:
    """Exit status, negative for a signal that ended it, and the lines said on standard error."""
    with tempfile.TemporaryFile("w+") as said:
        child = os.fork()
        if child == 0:
            os.dup2(said.fileno(), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            try:
                cli.main(arguments)
            except SystemExit as ended:
                os._exit(int(str(ended.code or 0)))
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        said.seek(0)
        return status, said.read().splitlines()


def rows_in(out: Path) -> list[dict[str, str]]:
    with (out / "table.csv").open(newline="", encoding="utf-8") as file:
        return [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]


def files_in(out: Path) -> list[str]:
    return sorted(str(path.relative_to(out)) for path in out.rglob("*") if path.is_file())


with tempfile.TemporaryDirectory() as name:
    here = Path(name)
    (here / "s.toml").write_text(STUDY.to_toml())
    warpwear.run(STUDY, out=here / "run", plots=False).close()
    distance = np.linspace(0.0, 60.0, 3000)
    lines = [f"{d:.3f};{0.3 + 0.2 * d / 60.0:.4f}" for d in distance]
    (here / "r.csv").write_text("\n".join(["Distance [mm];COF", *lines]) + "\n")
    commands = {
        "sweep": ["sweep", str(here / "s.toml"), "--vary", "contact.load=4 N,8 N", "--workers", "1"],
        "netcdf": ["export", str(here / "run"), "--format", "netcdf"],
        "all formats": [
            *("export", str(here / "run")),
            *(part for kind in ("csv", "vti", "sdf", "x3p", "crate") for part in ("--format", kind)),
        ],
        "record": ["record", str(here / "r.csv")],
    }
    more = {"sweep": ["--resume"]}
    intact = {}
    for kind, command in commands.items():
        status, said = called([*command, "--out", str(here / kind)])
        assert status == 0, said
        intact[kind] = files_in(here / kind)
    ends = []
    for free in sizes:
        for kind, command in commands.items():
            mount = ["mount", "-t", "tmpfs", "-o", f"size={round(DISK * 2**10)}k", "none", str(disk)]
            subprocess.run(mount, check=True)
            (disk / "full").write_bytes(bytes(round((DISK - free) * 2**20)))
            status, said = called([*command, "--out", str(disk / "out")])
            there = files_in(disk / "out")
            end = {"free": free, "command": kind, "status": status, "said": said[-3:], "there": there}
            end["whole"] = there == intact[kind]
            more_room = ["mount", "-t", "tmpfs", "-o", "remount,size=64m", "none", str(disk)]
            subprocess.run(more_room, check=True)  # tables are written anew beside the older ones
            (disk / "full").unlink()
            again, said = called([*command, "--out", str(disk / "out"), *more.get(kind, ["--overwrite"])])
            end["again"] = again if again else files_in(disk / "out") == intact[kind]
            if kind == "sweep" and again == 0:
                end["again"] = end["again"] and rows_in(disk / "out") == rows_in(here / kind)
            ends.append(end | {"said again": said[-2:]})
            shutil.rmtree(disk / "out", ignore_errors=True)
            subprocess.run(["umount", str(disk)], check=True)
print(json.dumps(ends))
