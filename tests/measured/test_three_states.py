"""Constants of friction by three states, found in courses whose constants are known, and in two real ones."""

import os
from pathlib import Path

import numpy as np
import pytest
import scipy.signal
from cases_courses import in_laps

import warpwear
from warpwear import InputError
from warpwear.calibration.states import calibrate_states
from warpwear.laws.states import shares
from warpwear.measured.friction.events import LapMeans
from warpwear.measured.friction.states import FITTED, fit_states

#: Two tests of one laboratory: ball on disc, 3 N, laps of 18.98 mm.
TRIB = Path(os.environ.get("WARPWEAR_RECORDS", "nowhere")) / "gokcemay/trib/inst/exdata/tribometer"
LAPS = 160


def made(seed: int, together: float = 0.0, metal: float | None = None) -> tuple[LapMeans, np.ndarray]:
    """Return a course of 160 laps with noise of 0.007, of first order, and the values of `FITTED`.

    together: the correlation from lap to lap. metal: of the pair, whose rate is then 0.2.
    """
    dice = np.random.default_rng(seed)
    count = np.arange(LAPS) + 0.5
    linear = np.array([dice.uniform(*ends) for ends in ((0.9, 1.2), (0.12, 0.2), (0.0, 0.003), (0.4, 0.55))])
    spread, wait, cover_rate = dice.uniform(0.15, 0.25), dice.uniform(30.0, 60.0), dice.uniform(0.06, 0.15)
    if metal is not None:
        linear[0], spread = metal, 0.2
    own = shares(
        count,
        rate=spread * (1.0 + np.exp(-spread * wait)),
        middle=spread * wait,
        cover_rate=cover_rate,
    )
    steps = dice.normal(size=LAPS + 100) * 0.007 * np.sqrt(1.0 - together**2)
    noise = scipy.signal.lfilter([1.0], [1.0, -together], steps)[100:]
    cof = np.column_stack([own.metal, own.filmed, own.filmed * count, own.covered]) @ linear + noise
    return in_laps(cof), np.array([*linear, np.log(spread), wait, np.log(cover_rate)])


def covered(seeds: range, together: float) -> tuple[float, float]:
    """Return which part of the values of made courses lies within one and within 1.96 errors."""
    off = []
    for seed in seeds:
        course, truth = made(seed, together)
        (fit,) = fit_states([course])
        off.append((fit.values - truth) / np.sqrt(np.diag(fit.covariance)))
    each = np.abs(off)
    print(
        together,
        dict(zip(FITTED, zip((each < 1.0).mean(0), (each < 1.96).mean(0), strict=True), strict=True)),
    )
    return float((each < 1.0).mean()), float((each < 1.96).mean())


@pytest.mark.slow
@pytest.mark.parametrize("together", [0.0, 0.5])
def test_the_errors_of_300_courses_hold_what_they_say(together: float) -> None:
    one, two = covered(range(300), together)
    assert abs(one - 0.68) <= 0.05
    assert abs(two - 0.95) <= 0.03


@pytest.mark.slow
def test_the_errors_of_60_courses_hold() -> None:
    one, two = covered(range(60), 0.0)
    assert 0.56 <= one <= 0.8
    assert two >= 0.9


def test_two_courses_share_what_is_the_pairs() -> None:
    """Without noise both have their constants again; the rate and the metal are one number."""
    courses, truths = zip(*(made(seed, metal=1.03) for seed in (1, 2)), strict=True)
    fits = fit_states(courses)
    assert fits[0].values[[0, 4]].tolist() == fits[1].values[[0, 4]].tolist()
    for fit, truth in zip(fits, truths, strict=True):
        assert np.abs((fit.values - truth) / np.sqrt(np.diag(fit.covariance))).max() < 4.0
        assert fit.rms < 0.008
    alone = fit_states(courses[:1])[0]
    assert fits[0].numbers["metal"][1] < alone.numbers["metal"][1]


def test_a_record_tells_its_states_and_a_study_takes_them(tmp_path: Path) -> None:
    """From a record over its constants to a study with the same course."""
    course, truth = made(4)
    rows = [f"{d:.6f},{mu:.6f}" for d, mu in zip(20.0 * course.distance, course.cof, strict=True)]
    path = tmp_path / "test.csv"
    path.write_text("\n".join(["Distance [mm],COF", *rows]), encoding="utf-8")
    record = warpwear.read_record(path)
    assert record.numbers["states"]["wait_mm"] == pytest.approx(20.0 * truth[5], rel=0.02)
    found = calibrate_states(path, until="3.2 m")
    numbers = found.numbers
    keys = {key: numbers[key] for key in ("film", "slope", "metal", "cover", "spread", "seed", "cover_rate")}
    study = warpwear.Study.load("v1").replace(friction={"law": "states", "states": keys | {"per": "mm"}})
    law = study.friction_law.coefficient({"distance": 20.0 * course.distance})
    assert np.sqrt(np.mean((law - course.cof) ** 2)) < 0.0075
    assert "this does not tell which" in str(found)


def test_a_course_without_a_jump_asks_how_far(tmp_path: Path) -> None:
    rows = [f"{k},{0.3 + 0.001 * (k % 2)}" for k in range(200)]
    (tmp_path / "flat.csv").write_text("\n".join(["Distance [mm],COF", *rows]), encoding="utf-8")
    with pytest.raises(InputError, match="flat has no jump: give until, how far it is fitted, such as '3 m'"):
        calibrate_states(tmp_path / "flat.csv")


@pytest.mark.skipif(not TRIB.exists(), reason="WARPWEAR_RECORDS has no gokcemay/trib")
def test_two_courses_of_one_laboratory() -> None:
    """They share r = 0.18 ± 0.03 a lap and μ_m = 1.03 ± 0.1: rms 0.018, and 0.009 each by itself."""
    how = {"columns": "2 [m],4", "radius": "3.02 mm", "until": f"{LAPS * 2.0 * np.pi * 3.02!r} mm"}
    found = calibrate_states([TRIB / "c1.csv", TRIB / "c2.csv"], **how)
    print(found)
    for name, fit in found.fits.items():
        assert fit.cof.size == LAPS
        assert fit.numbers["spread"][0] == pytest.approx(0.18, abs=0.03)
        assert fit.numbers["metal"][0] == pytest.approx(1.03, abs=0.1)
        assert fit.rms <= 0.018
        assert found.alone[name].rms <= 0.009


def test_shares_are_finite_long_before_the_wait() -> None:
    """A cover that comes at once and a film that lasts: nothing is bare, and nothing overflows."""
    filmed, metal, covered = shares(np.array([0.0, 1.0, 400.0]), rate=1.0, middle=200.0, cover_rate=50.0)
    np.testing.assert_allclose(filmed, [1.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(metal, 0.0, atol=1e-12)
    np.testing.assert_allclose(covered, [0.0, 0.0, 1.0], atol=1e-12)


def test_a_record_with_numbers_that_are_none_is_read(tmp_path: Path) -> None:
    """A force of a denormal number and an infinite load let the rates of a fit run away."""
    pytest.importorskip("ruptures")
    rng, path = np.random.default_rng(1), tmp_path / "test.csv"
    s = np.linspace(0.0, 600.0, 400)
    cof = 0.6 - 0.3 * np.exp(-s / 80.0) + 0.01 * rng.normal(size=s.size)
    rows = [[f"{a:.3f}", "5.0000", f"{5.0 * c:.4f}"] for a, c in zip(s, cof, strict=True)]
    rows[22][1], rows[97][2] = "1e400", "1e-320"
    lines = ["Time [s],Normal force [N],Friction force [N]", *(",".join(row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    read = warpwear.read_record(path, speed="10 mm/s")
    states = read.analysis.steps[0].states
    assert states is None or np.isfinite(list(states.numbers.values())).all()
