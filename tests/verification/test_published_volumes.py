"""Volumes that a standard prints beside diameters and widths, against the formulas of the calibration."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from thesis import smooth

import warpwear
from warpwear.calibration.wear import cap, circular_track

#: Of the round robin's test: radius of the ball and of the track [mm].
BALL, TRACK = 5.0, 16.0


@dataclass(frozen=True)
class Printed:
    """A line of the table of the interlaboratory test in ASTM G99."""

    name: str
    mean: float  # diameter of the ball's scar, or width of the disc's [mm]
    deviation: float
    printed: float  # volume [1e-3 mm³]
    on_disc: bool = False


ROUND_ROBIN = (
    Printed("ball, steel on steel", 2.11, 0.27, 198.0),
    Printed("ball, steel on alumina", 2.08, 0.35, 186.0),
    Printed("ball, alumina on alumina", 0.30, 0.05, 0.08),
    Printed("disc, alumina on steel", 0.64, 0.12, 480.0, on_disc=True),
)


def volume_at(row: Printed, length: float) -> float:
    """Volume [mm³] of a scar or track of a length across [mm]."""
    if row.on_disc:
        return circular_track(length, radius=BALL, track_radius=TRACK).volume
    return cap(length, radius=BALL).volume


def volume_of(row: Printed) -> tuple[float, float]:
    """Volume of the mean length, and the mean volume of lengths that scatter normally [mm³]."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(7)
    volumes = [
        volume_at(row, row.mean + row.deviation * node)
        for node in nodes
        if row.mean + row.deviation * node > 0
    ]
    assert len(volumes) == nodes.size
    return volume_at(row, row.mean), float(np.average(volumes, weights=weights))


@pytest.mark.parametrize("row", ROUND_ROBIN[:3], ids=lambda row: row.name)
def test_balls_of_the_round_robin(row: Printed) -> None:
    """Printed with three digits, or one."""
    digits = 2 if row.printed < 1.0 else 0
    assert round(1e3 * volume_of(row)[0], digits) == pytest.approx(row.printed, abs=0.51)
    assert 1e3 * volume_of(row)[0] == pytest.approx(row.printed, rel=0.01)


def test_the_track_of_the_round_robin_is_no_mean_width() -> None:
    """0.440 mm³ of the mean width, 0.486 of widths that scatter; 0.480 is printed."""
    of_mean, of_scatter = volume_of(ROUND_ROBIN[3])
    assert of_mean == pytest.approx(0.440, abs=0.001)
    assert of_scatter == pytest.approx(0.480, rel=0.02)
    assert abs(0.480 / of_mean - 1.0) > 0.08


def test_a_run_at_the_printed_wear_makes_the_printed_scar() -> None:
    """Steel on steel: K of the printed volume, 10 N and 1 km give back 2.11 mm."""
    row = ROUND_ROBIN[0]
    coefficient = 1e-3 * row.printed / (10.0 * 1e6)  # [mm²/N]
    study = smooth(
        counter__radius=f"{BALL} mm",
        contact__load="10 N",
        wear__counter=f"{1e3 * coefficient} mm^3/N/m",
        wear__disc="1e-15 mm^3/N/m",
        grid__cell="20 um",
        grid__extent="2.4 mm",
        sliding__distance="1e6 mm",
        stepping__largest="1e5 mm",
    )
    history = warpwear.run(study).history
    seen = 0.5 * (history["patch_along"][-1] + history["patch_across"][-1])
    assert seen == pytest.approx(row.mean, abs=0.02)
    assert history["area_contact"][-1] == pytest.approx(math.pi / 4.0 * row.mean**2, rel=0.01)
