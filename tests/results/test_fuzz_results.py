"""Whatever a result file holds, resealed by hand, it is a result or one sentence: no traceback, no hang."""

import random
import shutil
import time
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from fuzzing import check_sentence, little_memory, located, numbers, watched

import warpwear
from warpwear import InputError, Result, Study
from warpwear.comparison.table import to_text
from warpwear.figures.of_run.table import FIGURES
from warpwear.results.export import FORMATS, export
from warpwear.results.file import MAGIC
from warpwear.results.report import to_json
from warpwear.results.seal import seal
from warpwear.results.summary import summarise, summary_text
from warpwear.results.track import inner_rows

#: Longest time of the processor on one file [s].
LONGEST = 10.0
QUICK = {"grid.cell": "30 um", "sliding.distance": "6.5 mm", "output.snapshots": ["0.2 mm", "3 mm"]}
KINDS: dict[str, tuple[str, dict[str, Any]]] = {
    "rest": ("v3-fine", {}),
    "swept": (
        "v3-fine",
        {
            "sliding.kinematics": "swept",
            "sliding.track": "3.2 mm",
            "grid.cell": "50 um",
            "sliding.shift": 1,
            "checks.strict": False,
        },
    ),
    "patches": ("two-scale", {"grid.cell": "12.5 um", "sliding.distance": "1 mm"}),
}
ODD: list[Any] = [
    np.float64(1.0),
    np.zeros(0),
    np.zeros((3, 4)),
    np.arange(7),
    np.zeros((2, 2, 2), dtype=np.float32),
    "text",
    b"\xff\x00",
    np.array(["a", "b"], dtype="S1"),
    np.ones(5, dtype=bool),
    np.ones(5, dtype=complex),
    np.array([1.0, np.nan]),
    np.zeros(3, dtype=[("a", "f8"), ("b", "i4")]),
    h5py.Empty("f8"),
]
NUMBERS = [np.nan, np.inf, -np.inf, -1.0, 0.0, 1e300, -1e300, 1e-300, 1e20]
TEXTS = [
    "",
    "{}",
    "[]",
    "null",
    '{"warnings": 3}',
    '{"surface": []}',
    '{"warnings": [1]}',
    "[study]",
    "\x00",
    "é" * 99,
]


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    found = {}
    for kind, (preset, changes) in KINDS.items():
        found[kind] = tmp_path_factory.mktemp("results") / kind
        warpwear.run(Study.load(preset).replace(QUICK | changes), out=found[kind], plots=False).close()
    return found


def names_in(file: h5py.File) -> list[str]:
    names: list[str] = []
    file.visit(names.append)
    return names


def mutate(file: h5py.File, dice: random.Random) -> str:
    """One change by hand; says which."""
    name = dice.choice(names_in(file))
    item = file[name]
    how = dice.randrange(9)
    if how == 0:
        del file[name]
    elif how == 1:
        del file[name]
        file[name] = dice.choice(ODD)
    elif how == 2:
        del file[name]
        file.create_group(name)
    elif how == 3:
        file.move(name, f"{name}{dice.choice('x0/')}y")
    elif how == 4:
        place = dice.choice([file, item])
        key = dice.choice([*place.attrs, "row", "distance", "record"])
        value = dice.choice([*ODD, *NUMBERS, *TEXTS, 10**6, -3])
        place.attrs[key] = value
        return f"{place.name} attribute {key} = {value!r:.60}"
    elif how == 5:
        key = dice.choice([*file.attrs])
        del file.attrs[key]
        return f"attribute {key} gone"
    elif isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and item.size:
        values = item[()].reshape(-1)
        if how == 6:
            part = values[dice.randrange(values.size) :] if dice.random() < 0.7 else values
            part[...] = dice.choice(NUMBERS)
            item[...] = values.reshape(item.shape)
        else:
            other = values[: dice.randrange(values.size + 1)] if how == 7 else np.tile(values, 2)
            del file[name]
            file[name] = other
    elif how == 8:
        key, text = "study", str(file.attrs["study"])
        a = dice.randrange(len(text))
        file.attrs[key] = (
            text[:a] + dice.choice(["", "9", "-", "x", '"', "e9 "]) + text[a + dice.randrange(3) :]
        )
        return "study"
    return f"{how} {name}"


def use(folder: Path, dice: random.Random, out: Path) -> None:
    """What a user may ask of a result; of the figures a few."""
    with Result.open(folder) as result:
        repr(result)
        for snapshot in result.snapshots:
            repr(snapshot)
        to_json(result.summary)
        summary_text(summarise(result))
        assert result.surface_evolution.table
        result.to_dataframe()
        result.to_xarray()
        left_out = result.plot.left_out
        for name in dice.sample(list(FIGURES), 2):
            if name not in left_out:
                result.plot.png(name, dpi=40)
        export(result, out, formats=dice.sample(list(FORMATS), 3), snapshot="all", overwrite=True)
        if result.study.study.model == "two-scale":
            result.load_share, result.area_patch  # noqa: B018
    to_text(warpwear.compare(folder, out.parent / "good"))


def broken(good: Path, dice: random.Random, folder: Path) -> str:
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(good, folder)
    with h5py.File(folder / "result.h5", "r+") as file:
        told = []
        for _ in range(dice.choice((1, 1, 1, 2, 3))):
            with suppress(OSError, ValueError, TypeError, KeyError, RuntimeError):  # HDF5 itself refuses it
                told.append(mutate(file, dice))
    with (folder / "result.h5").open("r+b") as file:
        seal(file, MAGIC)
    return ", ".join(told)


@pytest.mark.parametrize("count", [12, pytest.param(2000, marks=pytest.mark.slow)])
def test_results_that_were_changed_by_hand(count: int, good: dict[str, Path], tmp_path: Path) -> None:
    refused, longest, wrong = 0, 0.0, []
    shutil.copytree(good["rest"], tmp_path / "good")
    with little_memory():
        for number in numbers(count):
            dice = random.Random(number)
            told = broken(good[dice.choice(list(KINDS))], dice, tmp_path / "broken")
            started = time.process_time()
            try:
                with watched(LONGEST), warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    use(tmp_path / "broken", dice, tmp_path / "export")
            except InputError as error:
                refused += 1
                check_sentence(error)
            except Exception as error:
                wrong.append(f"number {number}, {told}: {located(error)}")
            longest = max(longest, time.process_time() - started)
    print(f"{len(numbers(count))} results, {refused} refused, at most {longest:.1f} s of the processor")
    assert not wrong, "\n".join(wrong)
    assert refused > len(numbers(count)) // 3


def test_a_history_without_one_of_its_columns_is_refused(good: dict[str, Path], tmp_path: Path) -> None:
    file = Path(shutil.copy(good["rest"] / "result.h5", tmp_path))
    for name in ("time", "cof", "pressure_max"):
        with h5py.File(file, "r+") as opened:
            values = opened[f"history/{name}"][()]
            del opened[f"history/{name}"]
        with file.open("r+b") as whole:
            seal(whole, MAGIC)
        with pytest.raises(InputError, match=f"its history has no {name}") as told:
            Result.open(file)
        check_sentence(told.value)
        with h5py.File(file, "r+") as opened:
            opened[f"history/{name}"] = values


def test_a_field_that_is_unknown_in_places_is_refused(good: dict[str, Path], tmp_path: Path) -> None:
    """Only beside the patches of a run that has some of the area is anything unknown."""
    file = Path(shutil.copy(good["swept"] / "result.h5", tmp_path))
    with h5py.File(file, "r+") as opened:
        name = list(opened["snapshots"])[-1]
        opened[f"snapshots/{name}/wear_disc"][:2] = np.nan
    with file.open("r+b") as whole:
        seal(whole, MAGIC)
    with Result.open(file) as result, pytest.raises(InputError, match="wear_disc is negative, infinite or"):
        result.snapshot(-1)


@pytest.mark.parametrize("along", [1e300, 1e20])
def test_a_scar_longer_than_its_track_ends_with_it(
    along: float, good: dict[str, Path], tmp_path: Path
) -> None:
    """Roughness is then that of the whole track."""
    file = Path(shutil.copy(good["swept"] / "result.h5", tmp_path))
    with h5py.File(file, "r+") as opened:
        opened["history/patch_along"][...] = along
    with file.open("r+b") as whole:
        seal(whole, MAGIC)
    with Result.open(file) as result:
        assert 0 <= inner_rows(result).start < inner_rows(result).stop <= result.track_x.size
        assert result.surface_evolution.table
