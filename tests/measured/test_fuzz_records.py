"""Broken records of friction, results and checkpoints: one sentence, never a traceback or other numbers."""

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_records import RECORDS, written
from fuzzing import (
    LARGE,
    check_sentence,
    in_a_child,
    mutated_bytes,
    mutated_file,
    mutated_text,
    numbers,
    watched,
)
from numpy.testing import assert_array_equal

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli.record import describe
from warpwear.measured.course import read_experiment
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT

SMALL = {
    "grid.cell": "20 um",
    "sliding.distance": "0.5 mm",
    "output.snapshots": ["0.02 mm"],
    "stepping.growth": 1.4,
    "run.checkpoint": "0 s",
}
#: Broken files in each test run, and among the slow ones.
SLOW = 1000
COUNTS = [60, pytest.param(SLOW, marks=pytest.mark.slow)]


def records(times: int = 1) -> dict[str, tuple[bytes, dict[str, Any]]]:
    """Return records of a course, and of the forces of a reciprocating tribometer, so many times as long."""
    dice = np.random.default_rng(1)
    distance = np.linspace(0.0, 60.0 * times, 120 * times)
    cof = 0.3 + 0.2 * np.sqrt(distance / distance[-1]) + 0.01 * dice.normal(size=distance.size)
    course = "\n".join(f"{a:.3f};{b:.4f}".replace(".", ",") for a, b in zip(distance, cof, strict=True))
    time = np.arange(400 * times) * 0.05
    phase = 2.0 * np.pi * time / 4.0
    table = np.column_stack(
        [time, 1.5 * np.cos(phase), 4.0 * np.sign(np.sin(phase)), np.full(time.size, 8.0)]
    )
    forces = "\n".join("\t".join(f"{v:.4f}" for v in row) for row in table)
    return {
        "course.csv": (f"Distance [mm];COF\n{course}\n".encode(), {}),
        "forces.txt": (
            f"Time [s]\tPosition [mm]\tFx [N]\tFz [N]\n{forces}\n".encode(),
            {"stroke": 3.0},
        ),
    } | {name: (written(make()), options) for name, (make, options) in RECORDS.items()}


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("name", records())
@pytest.mark.filterwarnings("default::RuntimeWarning")
def test_broken_records(name: str, count: int, tmp_path: Path) -> None:
    content, options = records()[name]
    path = tmp_path / name
    path.write_bytes(content)
    intact = read_experiment(path, **options)

    def broken() -> Iterator[bytes]:
        for percent in range(0, 100, 1 if count == SLOW else 4):
            yield content[: len(content) * percent // 100]
        for seed in numbers(count):
            yield mutated_bytes(content, random.Random(seed))
            yield mutated_text(content.decode(errors="replace"), random.Random(seed)).encode()

    refused = 0
    for text in broken():
        path.write_bytes(text)
        with watched():
            try:
                found = read_experiment(path, **options)
            except InputError as error:
                check_sentence(error)
                refused += 1
                continue
        assert np.isfinite(found.distance).all()
        assert np.isfinite(found.cof).all()
        assert (np.diff(found.distance) > 0.0).all()
        assert found.cof.max() <= 3.0
        assert found.cof.size <= max(2 * intact.cof.size, text.count(b"\n") + 1)
    assert refused > 0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("name", "stroke"), [("course.csv", None), ("forces.txt", "3 mm")])
def test_broken_records_of_five_megabytes(name: str, stroke: str | None, tmp_path: Path) -> None:
    """The command reads or refuses each in a sentence, within 10 s of the processor and 1 GiB."""
    content = records(LARGE // len(records()[name][0]))[name][0]
    path, ends = tmp_path / name, []
    for seed in [None, *numbers(12)]:
        path.write_bytes(content if seed is None else mutated_file(content, random.Random(seed)))
        ends.append(in_a_child(lambda: describe([path], stroke=stroke, as_json=True)))
    said, seconds, memory = zip(*ends, strict=True)
    assert said[0] == "", said[0]
    print(
        f"{name}: {len(content) / 1e6:.1f} MB, {sum(map(bool, said))} of {len(said) - 1} refused, at most "
        f"{max(seconds):.1f} s, {max(memory) / 2**20:.0f} MiB"
    )


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Result and checkpoint of a run that was interrupted."""
    out = tmp_path_factory.mktemp("runs") / "out"

    def interrupted(step: warpwear.RunStep) -> None:
        if step.index == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        warpwear.run(study(), out=out, plots=False, callback=interrupted)
    return {name: (out / name).read_bytes() for name in ("result.h5", CHECKPOINT)}


def study() -> Study:
    return Study.load("v3-fine").replace(SMALL)


@pytest.mark.parametrize("count", COUNTS)
def test_broken_checkpoints(count: int, stopped: dict[str, bytes], tmp_path: Path) -> None:
    """A digest covers every byte behind the header, and the header is looked at."""
    good = stopped[CHECKPOINT]
    path = tmp_path / CHECKPOINT
    dice = random.Random(3)
    for seed in numbers(count):
        content = (
            good[: dice.randrange(len(good))] if seed % 4 == 0 else mutated_bytes(good, random.Random(seed))
        )
        if content == good:
            continue
        path.write_bytes(content)
        with watched(), pytest.raises(InputError) as error:
            warpwear.run(study(), out=tmp_path, plots=False, resume=True)
        check_sentence(error.value)
        assert path.read_bytes() == content


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.filterwarnings("ignore")
def test_broken_results(count: int, stopped: dict[str, bytes], tmp_path: Path) -> None:
    """The numbers in it are those of the whole file, or it is refused in one sentence."""
    good = stopped["result.h5"]
    path = tmp_path / "result.h5"
    dice = random.Random(4)
    path.write_bytes(good)
    with Result.open(path) as result:
        history, last = result.history, result.snapshot(-1)
    refused = 0
    for seed in numbers(count):
        content = (
            good[: dice.randrange(len(good))] if seed % 4 == 0 else mutated_bytes(good, random.Random(seed))
        )
        path.write_bytes(content)
        with watched():
            try:
                with Result.open(path) as result:
                    assert result.summary["steps"] == history["distance"].size
                    assert "v3-fine" in repr(result) or result.study.study.name in repr(result)
                    for name, values in result.history.items():
                        assert_array_equal(values, history.get(name, values))
                    for name, values in vars(result.snapshot(-1)).items():
                        assert name == "distance" or np.array_equal(values, getattr(last, name))
            except InputError as error:
                check_sentence(error)
                refused += 1
    assert refused > 0
