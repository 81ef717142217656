"""Checkpoints and compiled kernels that were damaged: one sentence, or made anew; never a traceback."""

import os
import random
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
import pytest
from fuzzing import check_sentence, mutated_bytes, watched

import warpwear
from warpwear import ConvergenceError, InputError, Study
from warpwear.results.seal import seal
from warpwear.runs import loop
from warpwear.runs.checkpoint import FILE_NAME, FORMAT, MAGIC

ROOT = Path(__file__).parents[2]
SMALL = {
    "grid.cell": "30 um",
    "sliding.distance": "0.05 mm",
    "output.snapshots": ["0.01 mm"],
    "run.checkpoint": "0 s",
}
KINDS = {
    "rest": ("v3-fine", {}),
    "swept": (
        "v3-fine",
        {
            "sliding.kinematics": "swept",
            "sliding.track": "3.2 mm",
            "grid.cell": "50 um",
            "sliding.shift": 1,
            "checks.strict": False,
            "sliding.distance": "3 mm",
        },
    ),
    "patches": ("two-scale", {"grid.cell": "12.5 um"}),
}


def study_of(kind: str) -> Study:
    preset, changes = KINDS[kind]
    return Study.load(preset).replace(SMALL | changes)


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Folders with the checkpoint of the third step."""
    found, write = {}, loop.StepLoop._checkpoint

    def stopping(self: loop.StepLoop, checkpoints: loop.Checkpoints) -> None:
        write(self, checkpoints)
        if len(self._rows) == 3:
            raise SystemExit

    for kind in KINDS:
        found[kind] = tmp_path_factory.mktemp("stopped") / kind
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(loop.StepLoop, "_checkpoint", stopping)
            with pytest.raises(SystemExit):
                warpwear.run(study_of(kind), out=found[kind], plots=False)
    return found


def damaged(path: Path, dice: random.Random) -> str:
    path.write_bytes(mutated_bytes(path.read_bytes(), dice))
    return "bytes"


def resealed(path: Path, dice: random.Random) -> str:
    """Another type or shape, or nothing, in the place of one thing; with a seal that fits."""
    with h5py.File(path, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        name, how = dice.choice(names), dice.randrange(6)
        item = file[name]
        is_array = isinstance(item, h5py.Dataset) and item.ndim > 0
        values = item[()] if isinstance(item, h5py.Dataset) else None
        if how == 0 or values is None:
            del file[name]
        elif how == 1:
            del file[name]
            file[name] = dice.choice(["text", 1.0, np.zeros((2, 3)), np.array([b"a"]), "{}", "[]", "null"])
        elif how == 2 and is_array:
            del file[name]
            file[name] = values[: dice.randrange(len(values))] if len(values) else np.zeros(9)
        elif how == 3 and is_array:
            del file[name]
            file[name] = np.zeros(values.shape, dtype=np.complex64)
        elif how == 4 and is_array and values.dtype.kind == "f":
            item[...] = dice.choice([np.nan, np.inf, -1.0, 1e300])
        else:
            text = file["about"][()].decode()
            a = dice.randrange(len(text))
            del file["about"]
            file["about"] = (
                text[:a] + dice.choice(["", "9", "x", "null", '"', "{"]) + text[a + dice.randrange(4) :]
            )
            name = "about"
    with path.open("r+b") as whole:
        seal(whole, f"{MAGIC} {FORMAT}")
    return f"{how} {name}"


@pytest.mark.parametrize("count", [24, pytest.param(500, marks=pytest.mark.slow)])
def test_checkpoints_that_were_damaged(count: int, stopped: dict[str, Path], tmp_path: Path) -> None:
    refused = 0
    for number in range(count):
        dice = random.Random(number)
        kind, how = dice.choice(list(KINDS)), dice.choice([damaged, resealed])
        out = tmp_path / "out"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(stopped[kind], out)
        told = "nothing"
        with suppress(OSError, ValueError, TypeError, RuntimeError):  # HDF5 itself refuses it
            told = how(out / FILE_NAME, dice)
        try:
            with watched(10.0):
                warpwear.run(study_of(kind), out=out, plots=False, resume=True).close()
        except (InputError, ConvergenceError) as error:
            refused += 1
            if isinstance(error, InputError):
                check_sentence(error)
        except Exception as error:
            raise AssertionError(f"number {number}, {kind}, {told}: {error!r}") from error
    assert refused > count // 3


RUN = """
import sys
from warpwear.cli.main import main
main(["run", "v3-fine", "--set", "grid.cell=30 um", "--set", "sliding.distance=0.001 mm", "--set",
    "output.snapshots=[]", "--no-plots", "--overwrite", "--out", sys.argv[1]])
"""


def run_with(cache: Path, out: Path) -> bytes:
    """The history that a run writes whose compiled kernels are kept in a folder."""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(out)],
        env=os.environ | {"PYTHONPATH": path, "WARP_CACHE_PATH": str(cache)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return (out / "history.csv").read_bytes()


def emptied(path: Path, dice: random.Random) -> None:
    path.write_bytes(b"")


def removed(path: Path, dice: random.Random) -> None:
    path.unlink()


@pytest.mark.parametrize("count", [1, pytest.param(100, marks=pytest.mark.slow)])
def test_compiled_kernels_that_were_damaged(count: int, tmp_path: Path) -> None:
    """They are compiled anew: a changed instruction would crash, or give other numbers."""
    good = tmp_path / "good"
    history = run_with(good, tmp_path / "out")
    files = sorted(path.relative_to(good) for path in good.rglob("*") if path.is_file())
    kernels = [path for path in files if path.suffix in (".o", ".meta")]
    assert kernels
    modules = {path.parts[-2].rpartition("_")[0] for path in kernels}  # what the run launches, no other
    assert {name for name in modules if name.startswith("wp_warpwear")} <= {
        f"wp_warpwear.kernels.{name}" for name in ("contact", "tiles", "wear")
    }
    for number in range(count):
        dice = random.Random(number)
        cache, hows = tmp_path / "bad", [damaged, damaged, emptied, removed]
        shutil.rmtree(cache, ignore_errors=True)
        shutil.copytree(good, cache)
        how: Callable[..., object] = dice.choice(hows)
        how(cache / dice.choice(kernels if dice.random() < 0.8 else files), dice)
        assert run_with(cache, tmp_path / "out") == history
