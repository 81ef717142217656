"""The contenders of the benchmark agree on tiny grids: package, NumPy, C if it compiles, published way."""

import importlib
import json
import math
import re
import runpy
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import reference
from numpy.testing import assert_allclose, assert_array_equal

from warpwear import Study

BENCH = Path(__file__).parents[1] / "bench"
#: Names that the scripts of the benchmark and their folders have as modules.
MODULES = {path.stem for path in BENCH.iterdir() if path.is_dir() or path.suffix == ".py"}
CELLS = 64
#: Cold, growing, one long step, the cap of 590 MPa active in the first.
INCREMENTS = [3.0e-3, 3.0e-3, 0.1, 100.0, 3.0]


@pytest.fixture(autouse=True)
def bench_on_path(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Its scripts import one another by plain names, which nothing else may see."""
    monkeypatch.syspath_prepend(str(BENCH))
    yield
    for name in [name for name in sys.modules if name.partition(".")[0] in MODULES]:
        del sys.modules[name]


@pytest.mark.parametrize("kind", ["fine", "springs", "explicit"])
def test_contenders_agree(kind: str) -> None:
    """Approach, volumes and area of every step to 1e-9, balances of both kinds."""
    from contenders.baselines import NumpyLoop, Problem, sag_of
    from contenders.published import PublishedLoop
    from contenders.roster import TIGHT, Setting, c_loops, check, gap_of, heights_of, package, study_on

    changes = {
        "fine": {},
        "springs": {"contact__stiffness": "1.9e6 N/mm^3"},
        "explicit": {"preset": "v3", "stepping__load_tolerance": "one cell"},
    }[kind]
    increments = [0.3] * 5 if kind == "explicit" else INCREMENTS
    study = study_on(CELLS, **changes)  # type: ignore[arg-type]
    problem = Problem.of(study)
    traces = {}
    with package(study, Setting((1,), "cpu", 5, True), 1) as fresh:
        model = fresh()
        traces["warpwear"] = [model.advance(d) for d in increments]
    for name, made in c_loops(study, (1,)):
        loop = made()
        traces[name] = [loop.advance(d) for d in increments]
    in_numpy = NumpyLoop(problem, gap_of(study))
    traces["NumPy"] = [in_numpy.advance(d) for d in increments]
    counter = sag_of(study.cells.x, study.cells.y, study.counter.form.curvature)
    published = PublishedLoop(problem, counter, heights_of(study).copy())
    tolerance = None if kind == "explicit" else TIGHT * problem.load
    traces["published"] = [published.advance(d, tolerance=tolerance) for d in increments]
    check(kind, traces)
    worn = problem.load * sum(increments)
    assert_allclose(traces["NumPy"][-1].volume_counter, problem.wear_counter * worn, rtol=1e-12)


@pytest.mark.parametrize("script", sorted(BENCH.glob("*.py")), ids=lambda path: path.stem)
def test_scripts_find_what_they_import(script: Path) -> None:
    """Every script that is run by name loads, with all of its helpers."""
    runpy.run_path(str(script))


def test_digests_tell_what_differs() -> None:
    """Nothing for equal bytes, the largest relative difference of numbers, infinity of what is not there."""
    from digest import differences

    one = {"a": np.array([1.0, np.nan, -4.0]), "b": np.arange(3), "c": np.zeros(2), "d": np.array([np.nan])}
    assert differences(one, {name: values.copy() for name, values in one.items()}) == {}
    other = {
        "a": np.array([1.0, np.nan, -4.5]),
        "b": np.arange(3) + 1,
        "c": np.zeros(3),
        "d": np.array([1.0]),
    }
    assert differences(one, other) == {"a": 0.125, "b": np.inf, "c": np.inf, "d": np.inf}
    del other["a"]
    assert differences(one, other)["a"] == np.inf


def test_disagreement_is_told() -> None:
    """A contender that finds another approach stops the benchmark, by name."""
    from contenders.baselines import Solved
    from contenders.roster import DisagreementError, check

    one = Solved(approach=1.0, volume_counter=1.0, volume_disc=1.0, area=1.0, evaluations=3)
    check("equal", {"warpwear": [one], "NumPy": [one._replace(evaluations=4)]})
    with pytest.raises(DisagreementError, match=r"step 2: approach .* by warpwear, .* by NumPy"):
        check("other", {"warpwear": [one, one], "NumPy": [one, one._replace(approach=1.0 + 1e-8)]})


def test_published_way_goes_on_from_a_loop() -> None:
    """After steps of NumPy's loop the next one is that loop's own."""
    from contenders.baselines import NumpyLoop, Problem
    from contenders.published import PublishedLoop
    from contenders.roster import TIGHT, check, gap_of, study_on

    study = study_on(CELLS)
    problem = Problem.of(study)
    loops = [NumpyLoop(problem, gap_of(study)) for _ in range(2)]
    for loop in loops:
        for d in INCREMENTS:
            loop.advance(d)
    published = PublishedLoop.after(loops[0], study.cells.x, study.cells.y, study.counter.form.curvature)
    found = published.advance(3.0, tolerance=TIGHT * problem.load)
    check("after", {"NumPy": [loops[1].advance(3.0)], "published": [found]})


def test_sliding_step() -> None:
    """The lowest cells carry the load; each body loses K F ΔL where they are, and only in the window."""
    from contenders.baselines import sliding_step, work_for

    random = np.random.default_rng(1)
    places = (np.arange(24) - 11.5) * 0.01
    counter = reference.counter_gap(places, places, 3.0)
    track = 1.0e-3 * random.standard_normal((64, 24))
    unworn_counter, unworn_track = counter.copy(), track.copy()
    removals = {"removal_counter": 1.0e-7, "removal_disc": 3.0e-7}
    total = 0.0
    for step in range(4):
        start = 8 * step
        gap, before = counter - track[start : start + 24], track.copy()
        found = sliding_step(
            counter,
            track,
            start=start,
            load=8.0,
            hardness=590.0,
            cell=0.01,
            work=work_for(counter),
            **removals,
        )
        expected = reference.bearing(gap, 8.0, 590.0, 0.01, 0.5 * 590.0 * 0.01**2)
        assert found.cells == np.count_nonzero(expected.pressure)
        assert_allclose(found.pressure, expected.pressure.max(), rtol=1e-12)
        lost = before - track
        assert_array_equal(lost[start : start + 24] > 0.0, expected.pressure > 0.0)
        assert not lost[:start].any()
        assert not lost[start + 24 :].any()
        total += 8.0
    assert_allclose(
        (counter - unworn_counter).sum() * 0.01**2, total * removals["removal_counter"], rtol=1e-9
    )
    assert_allclose((unworn_track - track).sum() * 0.01**2, total * removals["removal_disc"], rtol=1e-9)


@pytest.mark.parametrize(("cells", "cut"), [(64, 2), (64, 16), (30, 3), (25, 2)])
def test_surfaces_of_more_waves_are_made_likewise(cells: int, cut: int) -> None:
    """By transforms of the grid, where the package makes no more waves."""
    from cases.half_space import fine_surface, surface

    assert_allclose(fine_surface(cells, cut, 0.1), surface(cells, cut, 0.1), atol=1e-12)


def test_places_and_extrapolation() -> None:
    """Steps looked at are spread over the run; costs that change in a line are summed exactly."""
    from cases.whole_runs import over_the_run, places_in

    places = places_in([1.0] * 1099, 8)
    assert places[0] == 0
    assert places[-1] == 1096
    assert max(np.diff(places)) <= 158
    assert_allclose(over_the_run([0, 50, 99], [1.0, 2.0, 2.98], 100), sum(1.0 + i / 50 for i in range(100)))


def test_courses_are_drawn_from_their_table(tmp_path: Path) -> None:
    """A table that was written is read back and drawn; every case is a study."""
    import running_in

    courses = {f"friction, seed {n}": {30.0: 0.07 * n, 90.0: 0.1} for n in (1, 3)}
    courses["area, load, H, Ra, mesh: 4 N"] = {30.0: 1.18, 90.0: 1.33}
    table = tmp_path / "courses.json"
    table.write_text(json.dumps(courses), encoding="utf-8")
    figure = running_in.draw(courses)
    (band,) = figure.axes[0].lines
    assert list(band.get_ydata()) == pytest.approx([0.14, 0.1])
    (course, _) = figure.axes[7].lines  # the other says where F/H is
    assert list(course.get_ydata()) == [1.18, 1.33]
    files = ["--read", str(table), "--draw", str(tmp_path / "a.png")]
    running_in.main(files, standalone_mode=False)
    assert (tmp_path / "a.png").stat().st_size > 10_000
    for _, keys in running_in.cases().values():
        assert Study.load("running-in").replace(keys)


def test_seconds_of_the_readme_are_those_recorded() -> None:
    """Each figure is found, and is that of the newest record that has it."""
    from cases.seconds import FIGURES, PAGES, RECORD, newest, written

    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    marked = written(text, {row: [0.0123] for row, _ in FIGURES})
    assert len(re.findall("0.012 s|12 ms|0.0 times", marked)) == len(FIGURES)
    if not RECORD.is_file():
        pytest.skip("nothing is recorded yet")
    rows = newest(json.loads(RECORD.read_text(encoding="utf-8")))
    assert written(text, rows) == text, "run: python bench/cases/seconds.py --write"


def test_the_surface_of_the_largest_contact_has_the_slope_that_it_says() -> None:
    """Along both axes: of waves that are no transform of a real field it had stripes."""
    largest = importlib.import_module("cases.largest")
    field = largest.heights(256)
    across = np.arange(129)
    number = 2.0 * np.pi * np.hypot(np.fft.fftfreq(256, 1 / 256)[:, None], across)
    twice = np.where((across == 0) | (across == 128), 1.0, 2.0)
    power = twice * np.abs(np.fft.rfft2(field)) ** 2
    assert math.sqrt(float((power * number**2).sum())) / 256**2 == pytest.approx(largest.SLOPE, rel=1e-4)
    steps = [256.0 * float(np.diff(field, axis=axis).std()) for axis in (0, 1)]
    assert steps[0] == pytest.approx(steps[1], rel=0.1)
    assert 0.05 < steps[0] < largest.SLOPE
