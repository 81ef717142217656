"""The command line as a user meets it, mostly in processes of its own."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import click
import pytest
import warp as wp
from click.testing import CliRunner

from warpwear.cli.main import commands, main
from warpwear.errors import InputError

ROOT = Path(__file__).parent.parent.parent
QUICK = ["--set", "grid.cell=20 um", "--set", "sliding.distance=3 mm"]


def warpwear(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    return subprocess.run(
        [sys.executable, "-m", "warpwear", *arguments],
        cwd=cwd,
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": path},
        timeout=120,
        check=False,
    )


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    """A folder in which v3-fine was run, and what was said."""
    place = tmp_path_factory.mktemp("ran")
    command = ("run", "v3-fine", *QUICK, "--set", "output.snapshots=[]", "--threads", "1")
    return place, warpwear(*command, cwd=place)


def test_a_run_from_the_command_line(
    ran: tuple[Path, subprocess.CompletedProcess[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    place, done = ran
    assert done.returncode == 0, done.stderr
    drawn = {p.stem for p in (place / "v3-fine" / "figures").iterdir()}
    assert {"cof", "areas", "volumes", "pressure_map", "profiles"} <= drawn
    assert "disc_map" not in drawn  # only with --plots all
    assert "area in contact" in done.stdout
    assert len(done.stdout.splitlines()) <= 10
    assert "page             v3-fine/report.html (load " in done.stdout
    # Plain lines where there is no terminal, and nothing of Warp's own talk.
    assert "\r" not in done.stderr
    assert "CUDA" not in done.stderr + done.stdout
    monkeypatch.chdir(place)
    again = CliRunner().invoke(commands, ["run", "v3-fine", *QUICK])
    assert isinstance(again.exception, InputError)
    assert "already holds a run" in str(again.exception)
    again = CliRunner().invoke(commands, ["plot", "v3-fine", "--only", "cof"])
    assert again.exit_code == 0
    assert again.output.splitlines() == ["v3-fine/figures/cof.png"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nothing"], "STUDY = 'nothing' is no file, no run folder and no preset"),
        (["run", "v3", "--set", "contact.load=-8 N"], "contact.load = '-8 N': must be greater than 0 N"),
        (["run", "v3", "--set", "contact.load"], "KEY=VALUE is expected"),
        (["run", "v3", "--set", "contact.laod=8 N"], "did you mean 'contact.load'"),
        (["run", "v3", "--device", "cuda:7"], "device = 'cuda:7' is not there"),
        pytest.param(
            ["run", "v3", "--device", "cuda"],
            "device = 'cuda' is not there",
            marks=pytest.mark.skipif(wp.is_cuda_available(), reason="a GPU is there"),
        ),
        (["run", "v3", "--threads", "many"], "'many' is not a valid integer"),
        (["run"], "Missing argument"),
        (["walk"], "No such command 'walk'"),
        (["plot", "nowhere"], "holds no result"),
        (
            ["show", "v3", "--set", "disc.surface=a", "--set", "disc.synthetic.kind=flat"],
            "exclude each other",
        ),
    ],
)
def test_bad_input_is_exit_status_2_and_one_sentence(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = signal.getsignal(signal.SIGTERM)
    try:
        with pytest.raises(SystemExit) as ended:
            main(arguments)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert ended.value.code == 2
    told = capfd.readouterr().err
    assert message in told
    assert told.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_bad_input_in_a_process_of_its_own(tmp_path: Path) -> None:
    done = warpwear("run", "v3", "--device", "cuda:7", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("warpwear: device = 'cuda:7' is not there")
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_smooth_run_stands_beside_hertz(tmp_path: Path) -> None:
    short = ["--set", "sliding.distance=0.3 mm", "--no-plots", "--details"]
    done = CliRunner().invoke(commands, ["run", "v1", *short, "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.stderr
    # K_N = 3/π E*/a with E* = 1.072e5 MPa and a = 55.2 µm
    assert "foundation_N_per_mm3 1.856e+06" in done.stdout
    assert "Hertz (smooth, unworn) 1255 MPa" in done.stdout
    assert re.search(r"hertz: .*radius_um 55.*, peak_pressure_MPa 1255, approach_um 1.01", done.stdout)


def test_listing_and_showing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def told(*arguments: str) -> tuple[str, str]:
        with pytest.raises(SystemExit) as ended:
            main([*arguments])
        assert ended.value.code == 0
        return capsys.readouterr()

    listed, _ = told("studies")
    assert [line.split()[0] for line in listed.splitlines()] == [
        "coat",
        "first",
        "running-in",
        "track",
        "two-scale",
        "v1",
        "v2",
        "v3",
        "v3-fine",
    ]
    shown, said = told("show", "v3", "--set", "disc.synthetic.kind=flat")
    assert "ASSUMED" in shown
    assert "disc.synthetic.period do not apply to kind = 'flat'" in said
    # What `show` prints is a study.
    (tmp_path / "mine.toml").write_text(shown)
    told("show", str(tmp_path / "mine.toml"))


def every_command(group: click.Group, path: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Names of all commands, groups included, as they are typed."""
    found = [path]
    for name, command in group.commands.items():
        here = (*path, name)
        found += every_command(command, here) if isinstance(command, click.Group) else [here]
    return found


#: Slow to import, and nothing that help needs.
HEAVY = ("warp", "scipy", "matplotlib", "pint", "h5py")


@pytest.fixture(scope="module")
def helps() -> dict[str, str]:
    """Help of every command by its name, of one process, and under "imported" what that imported."""
    code = (
        "import contextlib, io, json, sys\n"
        "from warpwear.cli.main import main\n"
        "told = {}\n"
        "for command in json.loads(sys.argv[1]):\n"
        "    with contextlib.redirect_stdout(io.StringIO()) as shown, contextlib.suppress(SystemExit):\n"
        "        main([*command, '--help'])\n"
        "    told[' '.join(command)] = shown.getvalue()\n"
        f"told['imported'] = ' '.join(m for m in {HEAVY!r} if m in sys.modules)\n"
        "print(json.dumps(told))"
    )
    asked = json.dumps(every_command(commands))
    command = [sys.executable, "-c", code, asked]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    found: dict[str, str] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("command", every_command(commands), ids=" ".join)
def test_help_is_quick(command: tuple[str, ...], helps: dict[str, str]) -> None:
    """It imports nothing heavy."""
    assert helps["imported"] == ""
    told = helps[" ".join(command)]
    assert told.startswith("Usage: warpwear")


def test_what_launches_nothing_does_without_warp(tmp_path: Path) -> None:
    """Its import is most of the second that such a command took."""
    made = warpwear("run", "v1", *QUICK, "--out", "run", "--no-plots", cwd=tmp_path)
    assert made.returncode == 0, made.stderr
    profile = "".join(f"{0.001 * i},{0.1 * (i % 7)}\n" for i in range(4000))
    (tmp_path / "profile.csv").write_text(f"x [mm],z [um]\n{profile}", encoding="utf-8")
    asked = [
        "materials",
        "show v1",
        "new own.toml --like pin",
        "surface profile.csv",
        "plot run",
        "report run",
    ]
    asked.append("export run")
    code = (
        "import sys\n"
        "from warpwear.cli.main import main\n"
        "for command in sys.argv[1:]:\n"
        "    try:\n"
        "        main(command.split())\n"
        "    except SystemExit as ended:\n"
        "        assert not ended.code, command\n"
        "    assert 'warp' not in sys.modules, command"
    )
    command, path = [sys.executable, "-c", code, *asked], os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=path, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("command", every_command(commands), ids=" ".join)
def test_no_two_options_write_one_parameter(command: tuple[str, ...]) -> None:
    """Which of them a value is from differs between click's versions."""
    found: click.Command = commands
    for name in command:
        assert isinstance(found, click.Group)
        found = found.commands[name]
    names = [parameter.name for parameter in found.params]
    assert len(set(names)) == len(names)


def test_help_names_what_a_run_writes(
    ran: tuple[Path, subprocess.CompletedProcess[str]], helps: dict[str, str]
) -> None:
    """Every file of a run folder, and no other, is listed in `warpwear run --help`."""
    told = helps["run"].partition("Options:")[0]
    written = {path.name + "/" * path.is_dir() for path in (ran[0] / "v3-fine").iterdir()}
    listed = {line.split()[0] for line in told.splitlines() if re.match(r"  [a-z-]+[./]", line)}
    assert listed == written


def test_the_rooms_have_one_name(tmp_path: Path) -> None:
    for room in ("kernels", "surfaces"):
        done = subprocess.run(
            [sys.executable, "-c", f"import {room}"], cwd=ROOT, capture_output=True, text=True, check=False
        )
        assert f"import this package as warpwear.{room}" in done.stderr
