"""Both wear coefficients of coated bodies come back from craters, in intervals that hold them."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import warpwear
from warpwear import InputError
from warpwear.cli.calibrate import wear

RADIUS, THICKNESS, LOAD = 12.5, 0.004, 0.4
WORK = np.linspace(4.0, 40.0, 6)  # [N m]


def crater(work: float, coat: float, substrate: float) -> np.ndarray:
    """Diameters [mm] of a crater and, if it is through, of the substrate in it: F L = V_c/K_c + V_s/K_s."""

    def volume(height: float) -> float:
        return float(np.pi * height**2 * (RADIUS - height / 3.0)) if height > 0.0 else 0.0

    low, high = 0.0, 1.0
    for _ in range(80):
        height = 0.5 * (low + high)
        below = volume(height - THICKNESS)
        enough = (volume(height) - below) / coat + below / substrate > work
        low, high = (low, height) if enough else (height, high)
    heights = [h for h in (height, height - THICKNESS) if h > 1e-6]
    return np.array([2.0 * np.sqrt(h * (2.0 * RADIUS - h)) for h in heights])


def craters(
    coat: float, substrate: float, error: float, seed: np.random.Generator | None
) -> list[dict[str, object]]:
    """Six craters whose diameters have a standard uncertainty [mm]."""
    tests = []
    for work in WORK.tolist():
        sizes = crater(work, coat, substrate)
        sizes += 0.0 if seed is None else error * seed.standard_normal(sizes.size)
        diameters = [f"{size!r} +- {error} mm" for size in sizes.tolist()]
        tests.append({"crater": diameters, "distance": f"{work / LOAD!r} m"})
    return tests


ALIKE = {"load": f"{LOAD} N", "radius": f"{RADIUS} mm"}


def test_exact_craters_give_both_coefficients_back() -> None:
    found = warpwear.calibrate_coat(craters(2e-4, 8e-4, 1e-4, None), **ALIKE)
    assert 1e3 * found.coat.median == pytest.approx(2e-4, rel=1e-3)
    assert 1e3 * found.substrate.median == pytest.approx(8e-4, rel=1e-3)
    assert found.birge < 1e-3
    assert len(found.to_dataframe()) == 6


def test_volumes_tell_the_same_as_the_diameters_they_are_of() -> None:
    by_diameters = warpwear.calibrate_coat(craters(2e-4, 8e-4, 1e-4, None), **ALIKE)
    tests = [
        {"volume_coat": f"{c!r} +- {c / 50} mm^3", "volume_substrate": f"{s!r} +- {s / 50} mm^3"}
        | {"distance": f"{work / LOAD!r} m"}
        for (c, s), work in zip(by_diameters.volumes.T.tolist(), WORK.tolist(), strict=True)
    ]
    found = warpwear.calibrate_coat(tests, load=ALIKE["load"])
    assert 1e3 * found.coat.median == pytest.approx(2e-4, rel=0.01)
    assert 1e3 * found.substrate.median == pytest.approx(8e-4, rel=0.01)


@pytest.mark.slow
def test_intervals_hold_what_made_the_craters() -> None:
    """Of 200 made cases, 83 to 97 % of the intervals of 90 % hold each coefficient."""
    random, inside = np.random.default_rng(0), np.zeros(2)
    for _ in range(200):
        coat, substrate = np.array([2e-4, 8e-4]) * np.exp(0.3 * random.standard_normal(2))
        found = warpwear.calibrate_coat(craters(coat, substrate, 0.004, random), **ALIKE)
        both = ((found.coat, coat), (found.substrate, substrate))
        inside += [1e3 * k.low <= truth <= 1e3 * k.high for k, truth in both]
    assert (inside / 200 >= 0.83).all(), inside
    assert (inside / 200 <= 0.97).all(), inside


def test_the_command_draws_the_craters(tmp_path: Path) -> None:
    path, figure = tmp_path / "craters.toml", tmp_path / "craters.png"
    tables = craters(2e-4, 8e-4, 0.004, None)
    path.write_text(
        "".join(
            f"[[test]]\ncrater = {t['crater']}\ndistance = '{t['distance']}'\n" + f"radius = '{RADIUS} mm'\n"
            for t in tables
        )
    )
    options = [str(path), "--source", "coat", "--load", f"{LOAD} N", "--figure", str(figure)]
    done = CliRunner().invoke(wear, [*options, "--json"])
    assert done.exit_code == 0, done.exception
    assert json.loads(done.output) == warpwear.calibrate_coat(tables, **ALIKE).numbers
    assert figure.stat().st_size > 1000


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda tests: tests[:2], "two coefficients need 3 craters at least; given: 2"),
        (lambda tests: [tests[0]] * 3, "do not tell coat and substrate apart"),
        (lambda tests: [{"distance": "1 m"}] * 3, "test.1 needs a crater, or volume_coat"),
        (
            lambda tests: [t | {"crater": t["crater"][::-1]} for t in tests],
            "the diameter of the crater, and",
        ),
        (lambda tests: [t | {"crater": "0.8 mm"} for t in tests], "diameters such as '0.80 \\+- 0.01 mm'"),
    ],
)
def test_what_tells_no_two_coefficients_is_refused(change, says: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=says):
        warpwear.calibrate_coat(change(craters(2e-4, 8e-4, 0.004, None)), **ALIKE)
