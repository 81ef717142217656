"""A ball that slides to and fro on a plate, both wearing: closed forms of scar, groove and volumes.

Every section of the ball along the sliding direction and the place of the plate below it wear by the same
∫ p dx. So the groove is K_d/(K_s S) times the area that the ball lost in its section there, S the stroke.
Where the bodies conform, that area is a segment of the ball's section, as long as the contact is there.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from thesis import F, R, observed_order

import warpwear
from warpwear import Result, Study
from warpwear.calibration.wear import cap, circular_track


@dataclass(frozen=True, kw_only=True)
class WornPair:
    """A worn ball and its groove: lengths in mm; half_length and groove one value a y."""

    y: np.ndarray
    half_length: np.ndarray  # of the contact along the sliding direction
    groove: np.ndarray  # its depth
    approach: float  # of the ball's unworn apex below the plate
    volume_ball: float  # [mm³]

    @property
    def along(self) -> float:
        """Length of the scar [mm]."""
        return 2.0 * float(self.half_length.max())

    @property
    def across(self) -> float:
        """Width of scar and groove [mm], where the unworn ball meets the plate."""
        return 2.0 * math.sqrt(self.approach * (2.0 * R - self.approach))

    @property
    def bowl(self) -> float:
        """What the groove takes of the cap between the ball's scar and the unworn plate [mm³]."""
        return 2.0 * float(np.trapezoid(self.groove * self.half_length, self.y))


def segment(half_length: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Area [mm²] that a chord cuts off a circle."""
    return radius**2 * np.arcsin(half_length / radius) - half_length * np.sqrt(radius**2 - half_length**2)


def at_approach(approach: float, ratio: float, y: np.ndarray) -> WornPair:
    """The pair where the ball's apex stands at a depth [mm]; ratio: K_d/(K_s S) [1/mm]."""
    circle = np.sqrt(R**2 - y**2)  # radius of the ball's section at y
    inside = R - circle < approach
    low, high = np.zeros_like(y), np.where(inside, np.sqrt(approach * 2.0 * R), 0.0)
    for _ in range(60):  # R − √(c² − b²) + ratio × segment = approach, by halving
        middle = 0.5 * (low + high)
        depth = R - np.sqrt(circle**2 - middle**2) + ratio * segment(middle, circle)
        low, high = np.where(depth < approach, middle, low), np.where(depth < approach, high, middle)
    half_length = np.where(inside, 0.5 * (low + high), 0.0)
    lost = segment(half_length, circle)
    return WornPair(
        y=y,
        half_length=half_length,
        groove=ratio * lost,
        approach=approach,
        volume_ball=float(np.trapezoid(lost, y)),
    )


def worn_pair(volume_ball: float, ratio: float) -> WornPair:
    """The pair whose ball lost a volume [mm³]; ratio: K_d/(K_s S) [1/mm], 0 where the plate does not wear."""

    def at(approach: float) -> WornPair:
        half_width = math.sqrt(approach * (2.0 * R - approach))
        # Closer towards the rim, where the depth ends in a power of 3/2.
        return at_approach(approach, ratio, half_width * np.sin(np.linspace(-0.5, 0.5, 801) * math.pi))

    def missing(approach: float) -> float:
        return at(approach).volume_ball - volume_ball

    return at(brentq(missing, 1e-12, 0.2 * R, xtol=1e-15, rtol=1e-14))


def sliding(**changes: Any) -> Study:
    """A smooth ball to and fro on a smooth plate, rigid but for wear, on a periodic piece of the track."""
    study = Study(
        counter={"radius": f"{R} mm"},
        disc={"synthetic": {"kind": "flat"}},
        contact={"load": f"{F} N", "hardness": "inf MPa"},
        wear={"counter": "9.4e-4 mm^3/N/m", "disc": "12.7e-4 mm^3/N/m"},
        grid={"cell": "40 um", "extent": "1.2 mm"},
        sliding={"passes": 80, "stroke": "30 mm", "kinematics": "swept", "track": "1.2 mm", "shift": 1},
    )
    return study.replace({name.replace("__", "."): value for name, value in changes.items()})


def expected(study: Study) -> WornPair:
    """The closed form of a study made by `sliding`."""
    counter, disc = study.wear_laws[0].steady, study.wear_laws[1].steady
    assert study.sliding.stroke is not None
    return worn_pair(counter * F * study.sliding.total, disc / (counter * study.sliding.stroke))


def groove_of(result: Result, study: Study) -> tuple[np.ndarray, np.ndarray]:
    """y [mm] and mean depth [mm] of the groove at the end of a run."""
    depth = np.asarray(result.snapshot(-1).wear_disc).mean(axis=0)
    return study.cells.y, depth


def groove_error(result: Result, study: Study) -> float:
    """Root mean square of the groove's difference from the closed form over that of the closed form."""
    y, depth = groove_of(result, study)
    pair = expected(study)
    exact = np.interp(y, pair.y, pair.groove)
    return float(np.sqrt(np.mean((depth - exact) ** 2) / np.mean(exact**2)))


#: Long and short strokes, and a plate that wears ten times as fast as the ball.
CASES = [
    {"sliding__passes": 20},
    {"sliding__stroke": "3 mm", "sliding__passes": 50},
    {"sliding__stroke": "3 mm", "sliding__passes": 50, "wear__disc": "94e-4 mm^3/N/m"},
]


@pytest.mark.parametrize("changes", CASES, ids=["long stroke", "short stroke", "soft plate"])
def test_scar_and_groove(changes: dict[str, Any], device: str) -> None:
    study = sliding(**changes)
    pair, result = expected(study), warpwear.run(study, device=device)
    cell, history = study.grid.cell, result.history
    assert groove_error(result, study) < 3e-3  # 2e-3 at most on cells of 40 µm
    assert history["patch_along"][-1] == pytest.approx(pair.along, abs=cell)
    assert history["patch_across"][-1] == pytest.approx(pair.across, abs=cell)
    assert history["wear_depth_counter"][-1] == pytest.approx(pair.approach - pair.groove.max(), rel=0.02)


def test_groove_converges_with_the_cells() -> None:
    sizes, errors = [0.08, 0.04, 0.02], []
    for size in sizes:
        study = sliding(
            grid__cell=f"{size} mm", grid__extent="0.96 mm", sliding__track="0.96 mm", sliding__passes=20
        )
        errors.append(groove_error(warpwear.run(study), study))
    assert observed_order(sizes, errors) > 1.0
    assert errors[-1] < 5e-4


def test_a_plate_that_does_not_wear_leaves_a_flat_scar() -> None:
    pair = worn_pair(0.018, 0.0)
    scar = cap(pair.along, radius=R)
    assert scar.volume == pytest.approx(0.018, rel=1e-5)
    assert pair.across == pytest.approx(pair.along, rel=1e-9)
    assert pair.bowl == 0.0


def test_a_ball_that_hardly_wears_cuts_a_circular_groove() -> None:
    """The section is then that of ASTM G99's track."""
    pair = worn_pair(1e-9, 1e7)
    section = float(np.trapezoid(pair.groove, pair.y))
    around = circular_track(pair.across, radius=R, track_radius=1.0)
    assert section == pytest.approx(around.volume / (2.0 * math.pi), rel=1e-3)
    assert pair.along < 0.02 * pair.across


def test_scar_and_groove_share_the_cap() -> None:
    """The unworn ball would lack what it lost and what the groove takes below its scar."""
    for ratio in (0.045, 0.45, 4.5):
        pair = worn_pair(0.01, ratio)
        square = pair.y**2 + pair.half_length**2
        chords = 2.0 * pair.half_length
        circle = np.sqrt(R**2 - pair.y**2)
        # The unworn ball's depth below the plate, over the scar.
        below = (pair.approach - R) * chords + segment(pair.half_length, circle)
        below += chords * np.sqrt(R**2 - square)
        assert float(np.trapezoid(below, pair.y)) == pytest.approx(pair.volume_ball + pair.bowl, rel=1e-4)


def test_two_diameters_of_a_scar_on_a_ball() -> None:
    """The ball lost about π d³ d'/(64 R), d along and d' across; a cap of the mean diameter is too much."""
    errors = []
    for ratio, volume in ((0.0, 2e-3), (0.045, 2e-3), (0.45, 2e-3), (4.5, 2e-3), (4500.0, 2e-6)):
        pair = worn_pair(volume, ratio)
        better = math.pi * pair.along**3 * pair.across / (64.0 * R)
        errors.append(better / pair.volume_ball - 1.0)
        told = cap(pair.across, pair.along, radius=R).bulging  # in either order
        longer = pair.across > 1.1 * pair.along
        assert told == (pytest.approx(better, rel=1e-12) if longer else None)
    assert longer
    assert errors[0] == pytest.approx(0.0, abs=0.01)  # a small scar, as in π d⁴/(64 R)
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] == pytest.approx(9.0 * math.pi / 32.0 - 1.0, abs=0.01)
    assert cap(pair.along, pair.across, radius=R).volume > 10.0 * pair.volume_ball
