"""Designs of a sweep: which values go together, and how distributions are drawn from."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from warpwear import InputError
from warpwear.batches.design import Design, distribution, factors_of
from warpwear.sweeps.indices import sobol
from warpwear.sweeps.report import _short
from warpwear.sweeps.sweep import values_of_text, varied

#: Samples by which a distribution is looked at.
MANY = 4096


def drawn(text: str) -> np.ndarray:
    u = Design("sobol", MANY, seed=3).unit_samples(1)[:, 0]
    return distribution(text, "key").quantiles(u)


def test_grid_varies_the_first_key_slowest() -> None:
    points = Design().points(factors_of({"a": ["2 N", "4 N"], "b": "1:3"}))
    assert [tuple(point.values()) for point in points] == [
        ("2 N", 1),
        ("2 N", 2),
        ("2 N", 3),
        ("4 N", 1),
        ("4 N", 2),
        ("4 N", 3),
    ]


def test_zip_goes_through_the_lists_together() -> None:
    points = Design("zip").points(factors_of({"a": [1, 2], "b": ["x", "y"]}))
    assert points == [{"a": 1, "b": "x"}, {"a": 2, "b": "y"}]


@pytest.mark.parametrize(
    ("text", "exact"),
    [
        ("normal 9.4e-4 +- 0.7e-4 mm^3/N/m", stats.norm(9.4e-4, 0.7e-4)),
        ("normal 8 ± 2 within 7 .. 12 N", stats.truncnorm(-0.5, 2.0, 8.0, 2.0)),
        ("truncated normal 8 +- 2 within 7 to 12 N", stats.truncnorm(-0.5, 2.0, 8.0, 2.0)),
        ("uniform 2 .. 8 N", stats.uniform(2.0, 6.0)),
        ("log-uniform 1e-4 .. 1e-3 mm^3/N/m", stats.loguniform(1e-4, 1e-3)),
    ],
)
def test_samples_follow_the_distribution(text: str, exact: object) -> None:
    assert stats.kstest(drawn(text), exact.cdf).statistic < 2.0e-3  # type: ignore[attr-defined]


def test_mean_and_deviation_of_a_log_normal_are_those_of_the_quantity() -> None:
    values = drawn("log-normal 2 +- 0.5 N")
    assert values.mean() == pytest.approx(2.0, rel=2e-3)
    assert values.std() == pytest.approx(0.5, rel=1e-2)


def test_value_keeps_its_unit() -> None:
    assert distribution("uniform 2 .. 8 N", "contact.load").written(3.5) == "3.5 N"
    assert distribution("uniform 0.5 .. 0.9", "hurst").written(0.75) == 0.75


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"a": "normal 8 +- 0 N"}, "greater than 0"),
        ({"a": "uniform 8 .. 2 N"}, "the smaller one"),
        ({"a": "log-uniform -1 .. 2 N"}, "positive"),
        ({"a": "gauss 8 +- 1 N"}, "a distribution such as"),
        ({"a": "uniform 2 +- 8 N"}, "a distribution such as"),
        ({"a": "7:3"}, "the smaller one"),
        ({"a": "1:99999999"}, "at most"),
        ({"a": []}, "no values"),
        ({"a": 3}, "a list of values"),
        ({}, "name a key"),
    ],
)
def test_bad_values_are_told(given: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        factors_of(given)


@pytest.mark.parametrize(
    ("kind", "samples", "vary", "says"),
    [
        ("grid", None, {"a": "normal 8 +- 1 N"}, "cannot draw"),
        ("grid", 10, {"a": [1]}, "does not apply"),
        ("sobol", None, {"a": "normal 8 +- 1 N"}, "needs a number of samples"),
        ("zip", None, {"a": [1, 2], "b": [1]}, "as many values"),
        ("saltelli", 100, {"a": "normal 8 +- 1 N"}, "power of two"),
        ("grid", None, dict.fromkeys("abc", "1:1000"), "at most"),
    ],
)
def test_bad_designs_are_told(kind: str, samples: int | None, vary: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        Design(kind, samples).points(factors_of(vary))


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("2 N,4 N, 8 N", ["2 N", "4 N", "8 N"]),
        ("1:20", "1:20"),
        ("0.5,0.8", [0.5, 0.8]),
        ("explicit,implicit", ["explicit", "implicit"]),
        ("{positions = 3, seed = 1}", {"positions": 3, "seed": 1}),
        ("normal 8 +- 1 N", "normal 8 +- 1 N"),
        ("true,false", [True, False]),
        ("7", [7]),
    ],
)
def test_values_from_the_command_line(text: str, values: object) -> None:
    assert values_of_text(text) == values
    assert varied([f"key = {text}"]) == {"key": values}


def ishigami(samples: int, seed: int) -> np.ndarray:
    """Outputs of Ishigami and Homma's function, a = 7, b = 0.1, over a Saltelli design."""
    vary = dict.fromkeys("xyz", "uniform -3.141592653589793 .. 3.141592653589793")
    points = Design("saltelli", samples, seed).points(factors_of(vary))
    x, y, z = (np.array([point[key] for point in points]) for key in "xyz")
    values: np.ndarray = np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)
    return values


#: First-order and total indices of that function, in closed form.
VARIANCE = 7.0**2 / 8.0 + 0.1 * np.pi**4 / 5.0 + 0.1**2 * np.pi**8 / 18.0 + 0.5
FIRST = np.array([0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 7.0**2 / 8.0, 0.0]) / VARIANCE
MIXED = 0.1**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0) / VARIANCE
TOTAL = FIRST + np.array([MIXED, 0.0, MIXED])


def test_sobol_indices_of_ishigami() -> None:
    found = sobol(ishigami(1024, seed=1), 3)
    assert np.abs(found.first - FIRST).max() < 0.05
    assert np.abs(found.total - TOTAL).max() < 0.05


def test_sobol_indices_are_those_of_scipy() -> None:
    values = ishigami(256, seed=2)
    blocks = values.reshape(5, -1)
    outputs = {"f_A": blocks[:1], "f_B": blocks[1:2], "f_AB": blocks[2:, None, :]}
    exact, found = stats.sobol_indices(func=outputs, n=256), sobol(values, 3)
    assert found.first == pytest.approx(exact.first_order, abs=1e-12)
    assert found.total == pytest.approx(exact.total_order, abs=1e-12)


@pytest.mark.parametrize("samples", [16, 64, 256])
def test_an_interval_holds_the_truth_as_often_as_it_says(samples: int) -> None:
    """Of 100 designs, and at 256 samples it is shorter than that of a bootstrap, ± 0.17."""
    found = np.array([sobol(ishigami(samples, seed=seed), 3).total_interval for seed in range(100)])
    held = (found[:, 0] <= TOTAL) & (found[:, 1] >= TOTAL)
    assert held.mean() >= 0.9
    if samples == 256:
        assert 0.5 * np.median(found[:, 1] - found[:, 0], axis=0).max() < 0.15


def test_an_input_without_influence_is_known_to_have_none() -> None:
    found = sobol(np.tile(ishigami(64, seed=1).reshape(5, -1)[0], 5) + np.repeat([0, 1, 0, 1, 0], 64), 3)
    assert found.total[[0, 2]].tolist() == [0.0, 0.0]
    assert found.total_interval[:, [0, 2]].tolist() == [[0.0, 0.0], [0.0, 0.0]]


def test_samples_without_a_value_are_left_out_whole() -> None:
    values = ishigami(1024, seed=1)
    values[5] = np.nan
    assert np.abs(sobol(values, 3).total - TOTAL).max() < 0.05


def test_total_indices_are_parts_in_words() -> None:
    """An estimate beyond 1 is cut off for people; few samples say how many it takes, many say nothing."""
    few = sobol(ishigami(32, seed=5), 3)
    few = replace(few, total=np.array([1.13, *few.total[1:]]))
    value, low, high = few.total_in_words(0).replace("(", "").replace(")", "").replace("to ", "").split()
    assert value == "1.00"
    assert 0.0 <= float(low) < float(high) <= 1.0
    assert "32 samples tell total indices to ±" in few.doubt
    needed = int(few.doubt.partition("about ")[2].split()[0])
    assert needed in 2 ** np.arange(6, 14)
    many = sobol(ishigami(needed, seed=5), 3)
    assert np.diff(many.total_interval, axis=0).max() < 2.0 * 0.1 * 1.5
    assert not sobol(ishigami(4 * needed, seed=5), 3).doubt


def test_drawn_values_are_short_on_the_page() -> None:
    assert _short("0.0009240627741320547 mm^3/N/m") == "0.00092406 mm^3/N/m"
    assert _short("9.800640489966497") == "9.8006"
    assert _short("0.25 mm") == "0.25 mm"
    assert _short("hardness-limited") == "hardness-limited"
