"""Whatever a study says, it is a study or one sentence: never a traceback, never a hang."""

import os
import random
import signal
import tempfile
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
from fuzzing import check_sentence, mutated_text, paths_in, watched
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from odd_values import VALUES

import warpwear
from warpwear import ConvergenceError, InputError, Study
from warpwear.cli.main import main
from warpwear.laws.track import increments
from warpwear.study.keys import declarations
from warpwear.study.loading import presets

PRESETS = {
    name: (resources.files("warpwear") / "presets" / f"{name}.toml").read_text(encoding="utf-8")
    for name in presets()
}
#: Whole studies after defaults too: more keys to break.
TEXTS = [*PRESETS.values(), *(Study.load(name).to_toml() for name in PRESETS)]
TREES = [tomllib.loads(text) for text in TEXTS]
KEYS = [
    *declarations(Study),
    "contact.laod",
    "x",
    "study.name.x",
    "",
    ".",
    "counter.",
    "a" * 300,
    "a." * 50_000,
]


def examples(quick: int, slow: int) -> Any:
    """So many examples in each test run, and so many more among the slow tests."""
    return pytest.mark.parametrize("count", [quick, pytest.param(slow, marks=pytest.mark.slow)])


def try_all(count: int, strategy: Any, check: Any) -> None:
    """The same examples every time: a failure is the code's, not the dice's."""

    @settings(
        max_examples=count,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(strategy)
    def each(example: Any) -> None:
        check(example)

    each()


def study_or_sentence(make: Any) -> Study | None:
    """The study, all of it usable, or None where it was refused in one sentence."""
    with watched():
        try:
            study: Study = make()
        except InputError as error:
            check_sentence(error)
            return None
        assert all(notice.isprintable() for notice in study.notices())
        study.to_toml(marked=True)
        again = Study(**tomllib.loads(study.to_toml()))
        assert again.to_toml() == study.to_toml()  # keys that do not apply are not in it
        assert again.uses_bearing_area == study.uses_bearing_area
    return study


def write(text: str, folder: str) -> Path:
    path = Path(folder) / "study.toml"
    path.write_bytes(text.encode("utf-8", errors="surrogatepass"))
    return path


@examples(50, 5000)
def test_broken_text(count: int) -> None:
    with tempfile.TemporaryDirectory() as folder:

        def check(example: tuple[str, int]) -> None:
            path = write(mutated_text(example[0], random.Random(example[1])), folder)
            study_or_sentence(lambda: Study.load(path))

        try_all(count, st.tuples(st.sampled_from(TEXTS), st.integers(0, 2**32)), check)


@st.composite
def broken_trees(draw: st.DrawFn) -> dict[str, Any]:
    """Sections with one to four keys changed, renamed, moved, added or left out."""
    tree: dict[str, Any] = tomllib.loads(draw(st.sampled_from(TEXTS)))
    for _ in range(draw(st.integers(1, 4))):
        paths = paths_in(tree)
        if not paths:
            break
        *above, name = draw(st.sampled_from(paths))
        section = tree
        for key in above:
            section = section[key]
        how = draw(st.integers(0, 4))
        if how < 2:
            section[name] = draw(VALUES)
        elif how == 2:
            del section[name]
        elif how == 3:
            section[draw(st.text(max_size=8))] = section.pop(name)
        else:
            tree[draw(st.sampled_from(list(tree)))] = section[name]
    return tree


@examples(50, 5000)
def test_broken_keys_and_values(count: int) -> None:
    try_all(count, broken_trees(), lambda tree: study_or_sentence(lambda: Study(**tree)))


@examples(60, 2000)
def test_broken_changes(count: int) -> None:
    changes = st.dictionaries(st.sampled_from(KEYS), VALUES, min_size=1, max_size=3)
    bases = [Study.load(name) for name in PRESETS]

    def check(example: tuple[Study, dict[str, Any]]) -> None:
        study_or_sentence(lambda: example[0].replace(example[1]))

    try_all(count, st.tuples(st.sampled_from(bases), changes), check)


@examples(15, 300)
def test_broken_studies_on_the_command_line(count: int, capfd: pytest.CaptureFixture[str]) -> None:
    before = signal.getsignal(signal.SIGTERM)
    with tempfile.TemporaryDirectory() as folder:

        def check(example: tuple[str, int, str, Any]) -> None:
            text, seed, key, value = example
            path = write(mutated_text(text, random.Random(seed)) if seed % 2 else text, folder)
            with watched(), pytest.raises(SystemExit) as ended:
                main(["show", str(path), "--set", f"{key}={value}"])
            told = capfd.readouterr().err
            assert ended.value.code in (0, 2)
            assert "Traceback" not in told
            if ended.value.code == 2:
                assert told.startswith("warpwear: ")
                assert told.count("\n") == 1

        example = st.tuples(st.sampled_from(TEXTS), st.integers(0, 2**32), st.sampled_from(KEYS), VALUES)
        try:
            try_all(count, example, check)
        finally:
            signal.signal(signal.SIGTERM, before)


SMALL = {
    "grid.cell": "50 um",
    "grid.extent": "0.8 mm",
    "sliding.distance": "0.02 mm",
    "output.snapshots": ["0.01 mm"],
}
SCALES = st.sampled_from([1e-300, 1e-30, 1e-9, 1e-3, 0.5, 1.0, 3.0, 1e3, 1e9, 1e30, 1e300])
TO_SCALE = {
    "counter.radius": "mm",
    "contact.load": "N",
    "contact.hardness": "MPa",
    "contact.stiffness": "N/mm^3",
    "contact.bulk_stiffness": "N/mm^3",
    "wear.counter": "mm^3/N/m",
    "wear.disc": "mm^3/N/m",
    "sliding.distance": "mm",
    "stepping.first": "mm",
    "disc.synthetic.ra": "mm",
    "disc.synthetic.roll_off": "mm",
    "grid.extent": "mm",
}
CHOICES = {
    "stepping.scheme": ["explicit", "implicit"],
    "stepping.force": [True],
    "disc.synthetic.kind": ["flat", "milled", "self-affine"],
    "wear.distance_factor": ["none", "across", "radial"],
    "checks.strict": [True, False],
    "friction.area": ["contact", "cumulative", "nominal"],
    "patches.macro_cell": ["50 um", "100 um", "200 um"],
    "patches.placement": ["random"],
    "patches.coupling": ["approach", "load"],
}


@st.composite
def small_studies(draw: st.DrawFn) -> Study | None:
    """Studies of few cells and steps with numbers from tiny to huge; None for those that are refused."""
    changes: dict[str, Any] = {}
    for key in draw(st.lists(st.sampled_from(list(TO_SCALE)), min_size=1, max_size=3, unique=True)):
        changes[key] = f"{draw(SCALES)} {TO_SCALE[key]}"
    for key in draw(st.lists(st.sampled_from(list(CHOICES)), max_size=3, unique=True)):
        changes[key] = draw(st.sampled_from(CHOICES[key]))
    try:
        study = Study.load(draw(st.sampled_from(sorted(PRESETS)))).replace(SMALL).replace(changes)
    except InputError as error:
        check_sentence(error)
        return None
    plan = increments(study.increments, study.sliding.total, set(study.output.snapshots))
    few = sum(1 for _, _ in zip(range(60), plan, strict=False)) < 60
    return study if few and study.cells.cells <= 64**2 else None


@examples(40, 1000)
@pytest.mark.filterwarnings("default::RuntimeWarning")
def test_absurd_numbers_run_or_are_refused(count: int) -> None:
    """A run ends with a history of finite numbers that conserves what it must, or with one sentence."""

    def check(study: Study | None) -> None:
        if study is None:
            return
        with watched(20.0):
            try:
                result = warpwear.run(study, threads=1)
            except (InputError, ConvergenceError) as error:
                check_sentence(error)
                return
            assert result.finished
            assert abs(result.history["load_residual"]).max() <= max(
                study.load_tolerance, 1e-12 * study.contact.load
            )
            assert result.summary["name"] == study.study.name

    try_all(count, small_studies(), check)


def test_nothing_in_a_study_is_executed(tmp_path: Path) -> None:
    harm = tmp_path / "harm"
    for value in (
        f"__import__('os').mkdir('{harm}')",
        f"!!python/object/apply:os.mkdir ['{harm}']",
        "{{7*7}} mm",
    ):
        with pytest.raises(InputError):
            Study.load("v3").replace({"contact.load": value})
        with pytest.raises(InputError):
            Study.load("v3").replace({"grid.cell": f"1 {value}"})
    assert not os.path.exists(harm)
