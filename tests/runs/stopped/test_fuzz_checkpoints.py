"""Checkpoints and compiled kernels that were damaged: one sentence, or made anew; never a traceback."""

import functools
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import warp as wp
from fuzzing import check_sentence, little_memory, located, mutated_bytes, numbers, watched

import warpwear
from warpwear import ConvergenceError, InputError, Study
from warpwear.engine.kernel_cache import begin_to_load
from warpwear.kernels import balance, contact, wear
from warpwear.results.seal import seal
from warpwear.runs import loop
from warpwear.runs.checkpoint import FILE_NAME, FORMAT, MAGIC

ROOT = Path(__file__).parents[3]
#: Longest time of the processor on one file [s].
LONGEST = 10.0
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
    with resealing(path) as file:
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
    return f"{how} {name}"


@pytest.mark.parametrize("count", [24, pytest.param(500, marks=pytest.mark.slow)])
def test_checkpoints_that_were_damaged(count: int, stopped: dict[str, Path], tmp_path: Path) -> None:
    refused, longest, wrong = 0, 0.0, []
    with little_memory():
        for number in numbers(count):
            dice = random.Random(number)
            kind, how = dice.choice(list(KINDS)), dice.choice([damaged, resealed])
            out, told = copied(stopped[kind], tmp_path), "nothing"
            with suppress(OSError, ValueError, TypeError, RuntimeError):  # HDF5 itself refuses it
                told = how(out / FILE_NAME, dice)
            started = time.process_time()
            try:
                with watched(LONGEST):
                    study = study_of(kind).replace({"run.checkpoint": "inf s"})
                    warpwear.run(study, out=out, plots=False, resume=True).close()
            except (InputError, ConvergenceError) as error:
                refused += 1
                if isinstance(error, InputError):
                    check_sentence(error)
            except Exception as error:
                wrong.append(f"number {number}, {kind}, {told}: {located(error)}")
            longest = max(longest, time.process_time() - started)
    print(f"{len(numbers(count))} checkpoints, {refused} refused, at most {longest:.1f} s of the processor")
    assert not wrong, "\n".join(wrong)
    assert refused > len(numbers(count)) // 3


def copied(stopped: Path, folder: Path) -> Path:
    """A run folder like one that was stopped."""
    shutil.rmtree(folder / "out", ignore_errors=True)
    return Path(shutil.copytree(stopped, folder / "out"))


@contextmanager
def resealing(path: Path) -> Iterator[h5py.File]:
    """A checkpoint that may be changed; it has a seal that fits afterwards."""
    with h5py.File(path, "r+") as file:
        yield file
    with path.open("r+b") as whole:
        seal(whole, f"{MAGIC} {FORMAT}")


def refused(kind: str, out: Path, says: str) -> None:
    with pytest.raises(InputError, match="is no checkpoint that can be read: " + says) as told:
        warpwear.run(study_of(kind), out=out, plots=False, resume=True)
    check_sentence(told.value)


@pytest.mark.parametrize("name", ["sharing.base", "sharing.offset", "courses.reached"])
def test_arrays_of_another_shape_are_refused(name: str, stopped: dict[str, Path], tmp_path: Path) -> None:
    out = copied(stopped["patches"], tmp_path)
    with resealing(out / FILE_NAME) as file:
        values = file[f"model/{name}"][()]
        del file[f"model/{name}"]
        file[f"model/{name}"] = values[:-7]
    refused("patches", out, re.escape(f"arrays.{name} is float64 (893,) instead of float64 (900,)."))
    with resealing(out / FILE_NAME) as file:
        del file[f"model/{name}"]
    refused("patches", out, re.escape(f"arrays.{name} is missing instead of float64 (900,)."))


def places_in(nested: Any, *place: Any) -> Iterator[tuple[Any, ...]]:
    """Where a value stands in nested mappings and lists."""
    if isinstance(nested, dict | list):
        for key, value in nested.items() if isinstance(nested, dict) else enumerate(nested):
            yield (*place, key)
            yield from places_in(value, *place, key)


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_of_another_type_are_refused(kind: str, stopped: dict[str, Path], tmp_path: Path) -> None:
    out, dice = copied(stopped[kind], tmp_path), random.Random(1)
    with h5py.File(out / FILE_NAME) as file:
        good = file["about"][()]
    for place in dice.sample([*places_in(json.loads(good)["numbers"])], 6):
        about = json.loads(good)
        *path, last = place
        holder = functools.reduce(lambda values, key: values[key], path, about["numbers"])
        others = [
            other for other in (None, "text", 1, 0.5, True, {}, []) if type(other) is not type(holder[last])
        ]
        holder[last] = dice.choice(others)
        with resealing(out / FILE_NAME) as file:
            del file["about"]
            file["about"] = json.dumps(about)
        refused(kind, out, r"numbers\..* is .* instead of ")


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


def processor_time() -> float:
    """That of all processes that this one started and that ended [s]."""
    of_children = os.times()
    return of_children.children_user + of_children.children_system


def emptied(path: Path, dice: random.Random) -> None:
    path.write_bytes(b"")


def removed(path: Path, dice: random.Random) -> None:
    path.unlink()


@pytest.mark.slow
@pytest.mark.parametrize("count", [100])
def test_compiled_kernels_that_were_damaged(count: int, tmp_path: Path) -> None:
    """Files that were emptied or removed are compiled anew; others are what Warp takes them for."""
    good = tmp_path / "good"
    for file in (balance, contact, wear):  # as they were compiled for other tests
        module = wp.get_module(file.__name__)
        begin_to_load(module, wp.get_device("cpu"))()
        folder = module.get_module_identifier(1)
        shutil.copytree(Path(wp.config.kernel_cache_dir) / folder, good / folder)
    history = run_with(good, tmp_path / "out")
    files = sorted(path.relative_to(good) for path in good.rglob("*") if path.is_file())
    kernels = [path for path in files if path.suffix in (".o", ".meta")]
    assert kernels
    modules = {path.parts[-2].rpartition("_")[0] for path in kernels}  # what the run launches, no other
    together = {name for name in modules if name.startswith("wp_warpwear.kernels.contact.")}
    assert len(together) <= 1  # kernels of a run at rest are compiled as one file
    assert {name for name in modules - together if name.startswith("wp_warpwear")} <= {
        f"wp_warpwear.kernels.{name}" for name in ("balance", "contact", "wear")
    }
    longest, wrong = 0.0, []
    with little_memory():
        for number in numbers(count):
            dice = random.Random(number)
            cache, hows = tmp_path / "bad", [emptied, removed]
            shutil.rmtree(cache, ignore_errors=True)
            shutil.copytree(good, cache)
            how: Callable[..., object] = dice.choice(hows)
            how(cache / dice.choice(kernels if dice.random() < 0.8 else files), dice)
            started = processor_time()
            try:
                assert run_with(cache, tmp_path / "out") == history
            except AssertionError as error:
                wrong.append(f"number {number}: {error!s:.2000}")
            longest = max(longest, processor_time() - started)
    print(f"{len(numbers(count))} caches, at most {longest:.1f} s of the processor")
    assert not wrong, "\n".join(wrong)
    assert longest < LONGEST
