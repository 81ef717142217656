"""What computing a circular track straight leaves out: closed forms, and the fields of straight runs.

A place of the pin at x along and y outside of the track's middle slides by ρ = √((R_t + y)² + x²) over R_t
times what the middle slides. A place of the disc slides below the same chord of the pin on either track.
"""

import numpy as np
import pytest
from thesis import smooth

import warpwear


def way(x: np.ndarray, y: np.ndarray, track_radius: float) -> np.ndarray:
    """How far places of the pin slide, over the middle."""
    return np.hypot(track_radius + y, x) / track_radius


def worn_over_straight(wear: np.ndarray, x: np.ndarray, y: np.ndarray, track_radius: float) -> float:
    """Volume that a rigid pin loses on a circle over that on a straight track.

    wear: depth that the pin lost, (x, y). Rigid bodies that conform end in one shape on either track. So a
    pressure goes with its wear over the way, and the load with the sum of that.
    """
    return float(wear.sum() / (wear / way(x[:, None], y, track_radius)).sum())


def mean_way(pressure: np.ndarray, x: np.ndarray, y: np.ndarray, track_radius: float) -> float:
    """Volume that a pin loses at first on a circle over that on a straight track: the load's mean way."""
    return float(np.average(way(x[:, None], y, track_radius), weights=pressure))


def square(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Centres [mm] of cells along a side, and which cells of the square lie in a pin of radius 1 mm."""
    places = (np.arange(2 * cells + 8) - cells - 3.5) / cells
    return places, np.hypot(places[:, None], places) < 1.0


def punch(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Pressure below a flat pin of radius 1 mm on an elastic body, and the centres of cells along a side."""
    places, pin = square(cells)
    heights = np.where(pin, 0.0, -1.0)
    found = warpwear.solve_contact(heights, cell=1.0 / cells, load=1.0, modulus=1e4, boundary="free")
    return found.pressure, places


def test_a_ball_loses_less() -> None:
    """By a²/(12 R_t²): pressures of a conforming ball go with 1/ρ, its wear with the cap."""
    study = smooth(wear__disc="1e-12 mm^3/N/m", sliding__distance="240 mm")
    result = warpwear.run(study)
    wear = np.asarray(result.snapshot(-1).wear_counter)
    a = 0.5 * result.history["patch_along"][-1]
    for track_radius in (1.0, 2.0, 5.0):
        found = 1.0 - worn_over_straight(wear, study.cells.x, study.cells.y, track_radius)
        assert found == pytest.approx(a**2 / (12.0 * track_radius**2), rel=0.06)


@pytest.mark.parametrize("ratio", [1.25, 2.5, 5.0])
def test_a_flat_pin_loses_more_at_first_and_less_when_worn_in(ratio: float) -> None:
    """ratio: R_t/a. An even pressure: a²/(8 R_t²) more; an elastic body's: a²/(6 R_t²); worn in: less."""
    places, pin = square(64)
    even = mean_way(pin, places, places, ratio)
    assert even == pytest.approx(1.0 + 1.0 / (8.0 * ratio**2) + 1.0 / (192.0 * ratio**4), abs=1e-3)
    pressure, centres = punch(32)
    elastic = mean_way(pressure, centres, centres, ratio)
    assert elastic == pytest.approx(1.0 + 1.0 / (6.0 * ratio**2) + 1.0 / (120.0 * ratio**4), abs=2e-3)
    assert elastic - even > 0.8 / (24.0 * ratio**2)
    worn_in = worn_over_straight(pin.astype(float), places, places, ratio)
    # The load turns to the inside, so that pressure times way is even.
    assert worn_in == pytest.approx(1.0 - 1.0 / (8.0 * ratio**2), abs=0.05 / ratio**4)
