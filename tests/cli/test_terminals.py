"""Terminals, devices and names that the command line may meet: a sentence and status 2, never a traceback."""

import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import tomli_w

import warpwear
from warpwear import Study
from warpwear.cli.main import main

ROOT = Path(__file__).parents[2]
FULL = Path("/dev/full")
PATH = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))


def told(*arguments: str | Path, out: int | Path = subprocess.PIPE, **variables: str) -> tuple[int, str, str]:
    """Status, output and errors of a command."""
    with open(out, "w") if isinstance(out, Path) else open(os.devnull) as stream:
        done = subprocess.run(
            [sys.executable, "-m", "warpwear", *map(str, arguments)],
            stdout=stream if isinstance(out, Path) else out,
            stderr=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": PATH} | variables,
            check=False,
        )
    output = (done.stdout or b"").decode("latin-1"), done.stderr.decode("latin-1")
    assert "Traceback" not in output[1]
    return done.returncode, *output


def test_signs_that_the_terminal_lacks() -> None:
    """They are spelled out, as JSON reads them."""
    status, shown, _ = told("materials", PYTHONIOENCODING="latin-1")
    assert status == 0
    assert "\\u03bd 0.29" in shown
    status, _, said = told("run", "no-\u03bd", PYTHONIOENCODING="latin-1")
    assert status == 2
    assert said.startswith("warpwear: STUDY = 'no-\\u03bd' is no file")


@pytest.mark.skipif(not FULL.exists(), reason="no such device here")
@pytest.mark.parametrize("command", [["studies"], ["--help"], ["show", "v3"]])
def test_output_to_a_full_device(command: list[str]) -> None:
    status, _, said = told(*command, out=FULL)
    assert status == 2
    assert said == "warpwear: standard output cannot be read or written: No space left on device.\n"


def test_names_that_no_file_can_have(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name, before = "é" * 200, signal.getsignal(signal.SIGTERM)
    for command in (["plot", name], ["surface", name], ["run", "v3", "--out", str(tmp_path / name)]):
        try:
            with pytest.raises(SystemExit) as ended:
                main(command)
        finally:
            signal.signal(signal.SIGTERM, before)
        assert ended.value.code == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_a_backend_of_matplotlib_that_is_not_there(tmp_path: Path) -> None:
    study = Study.load("v3-fine").replace(
        {"grid.cell": "20 um", "sliding.distance": "0.01 mm", "output.snapshots": []}
    )
    warpwear.run(study, out=tmp_path / "out", plots=False).close()
    status, shown, _ = told("plot", tmp_path / "out", "--only", "cof", MPLBACKEND="nonsense")
    assert (status, shown.strip()) == (0, str(tmp_path / "out" / "figures" / "cof.png"))


def test_a_reason_cannot_add_keys(tmp_path: Path) -> None:
    """What `show` prints is a study: a line end in an assumption's reason stays in its comment."""
    study, content = tmp_path / "mine.toml", tomllib.loads(Study.load("v3-fine").to_toml())
    name = next(iter(content["assumed"]))
    content["assumed"][name] = 'why\n[contact]\nload = "1 N"\n'
    study.write_text(tomli_w.dumps(content))
    status, shown, said = told("show", study)
    assert status == 0, said
    assert "\\n[contact]\\nload" in shown
    (tmp_path / "again.toml").write_text(shown)
    assert Study.load(tmp_path / "again.toml").contact.load == 8.0
