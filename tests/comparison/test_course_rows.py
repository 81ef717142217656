"""What a run has of a measured course: start, rise and level, each a row."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from warpwear.comparison.courses import data_by_name, data_of, rms_of_constant, told_of
from warpwear.comparison.groups import RunData
from warpwear.ensembles.ensemble import Group
from warpwear.measured.experiment import Experiment
from warpwear.study.study import Study

pytest.importorskip("ruptures")
PLACES = (np.arange(2000) + 0.5) / 2.0  # [mm]


def course(rise: float, length: float, high: float = 0.6) -> np.ndarray:
    """Friction of 0.15 that rises from 10 to 90 % within a length [mm] to another level."""
    return 0.15 + (high - 0.15) * np.clip(0.5 + 0.8 * (PLACES - rise) / length, 0.0, 1.0)


def run_with(cof: np.ndarray, **friction: Any) -> Any:
    """A run, whose study is one of its presets, with a course of friction."""
    study = Study.load("first").replace({f"friction.{key}": value for key, value in friction.items()})
    summary: Any = SimpleNamespace()
    return RunData("run", {}, {"cof": (PLACES, cof)}, study, Path("run"), summary)


MEASURED = course(300.0, 20.0) + np.random.default_rng(0).normal(0.0, 0.01, PLACES.size)
EXPERIMENT = Experiment("test", PLACES, MEASURED)


def off_by_name(cof: np.ndarray) -> dict[str, float]:
    return {datum.name: datum.off for datum in data_of(run_with(cof), EXPERIMENT)}


def test_the_course_itself_is_met() -> None:
    off = off_by_name(course(300.0, 20.0))
    assert list(off) == ["start", "place of the rise", "length of the rise", "level"]
    assert max(map(abs, off.values())) < 1.0


def test_a_slow_rise_to_the_level_is_missed() -> None:
    off = off_by_name(course(300.0, 300.0))
    assert abs(off["length of the rise"]) > 3.0
    assert max(abs(off["place of the rise"]), abs(off["level"])) < 3.0
    assert abs(off_by_name(course(450.0, 20.0))["place of the rise"]) > 3.0


def test_a_course_that_never_rises_has_none() -> None:
    groups = [Group("run", (run_with(np.full(PLACES.size, 0.15)),))]
    (line,) = told_of(data_by_name(groups, [EXPERIMENT]))
    assert line.startswith(
        "run beside test: agrees in start; differs in place of the rise (measured 300 mm, computed none)"
    )


def test_what_was_fitted_is_marked() -> None:
    data = data_of(run_with(course(300.0, 20.0), law="coulomb", coefficient=0.6), EXPERIMENT)
    assert [datum.name for datum in data if datum.fitted] == ["start", "level"]
    states = {"film": 0.15, "metal": 0.9, "cover": 0.6, "spread": 0.2, "seed": 1e-4, "cover_rate": 0.1}
    data = data_of(run_with(course(300.0, 20.0), law="states", states=states), EXPERIMENT)
    assert [datum.fitted for datum in data] == [True] * 4


def test_the_best_constant() -> None:
    """Its difference is the standard deviation over the distance that both have."""
    rms = rms_of_constant((PLACES, MEASURED), (PLACES[1000:], MEASURED[1000:]))
    assert rms == pytest.approx(MEASURED[1000:].std(), rel=0.3)
    line = np.linspace(0.0, 1.0, PLACES.size)
    assert rms_of_constant((PLACES, line), (PLACES, line)) == pytest.approx(12.0**-0.5)
