"""Table 4.1 and the worn patch: each turned into the other, as numbers and as text."""

import json
import math

import printed as thesis
import pytest
from click.testing import CliRunner
from coefficients import depth_of_rim, diameter_of_cap, patch, rim_at, table_4_1, volume_of_cap
from report import main


def test_the_numbers_of_the_thesis() -> None:
    for row in table_4_1().values():
        assert row["wear_coefficient_mm3_per_Nm"] == pytest.approx(row["printed_mm3_per_Nm"], rel=1e-3)
    worn = patch()
    assert worn["by_cap_mm3_per_Nm"] == pytest.approx(3.5e-4, abs=0.05e-4)
    assert worn["by_ellipsoid_mm3_per_Nm"] == pytest.approx(9.35e-4, abs=0.005e-4)
    assert worn["diameter_asked_for_mm"] == pytest.approx(1.022, abs=5e-4)


def test_the_printed_test_agrees_with_itself() -> None:
    assert thesis.STROKE.value * thesis.PASSES.value == thesis.DISTANCE.value
    for speed, time in zip(thesis.SERIES["speeds"], thesis.SERIES["times"], strict=True):
        assert speed.value * time.value == thesis.DISTANCE.value


@pytest.mark.parametrize("diameter", [1e-3, 0.8, 5.9])
def test_caps_are_turned_round(diameter: float) -> None:
    assert diameter_of_cap(volume_of_cap(diameter, radius=3.0), radius=3.0) == pytest.approx(diameter)
    assert rim_at(depth_of_rim(0.5 * diameter, radius=3.0), radius=3.0) == pytest.approx(0.5 * diameter)
    assert volume_of_cap(6.0, radius=3.0) == pytest.approx(18.0 * math.pi)


def test_the_script_says_both_that_do_not_agree() -> None:
    text = CliRunner().invoke(main, ["--calibration"]).output
    for words in (
        "disc, focus variation microscope    12.7e-4      0.02438  12.7e-4                    812.7",
        "disc, confocal microscope           23.7e-4       0.0455  23.7e-4                     1517",
        "section over 30 mm, µm²",
        "do not agree",
        "flat cap         3.51e-4 mm³/(N·m)",
        "full ellipsoid   9.35e-4 mm³/(N·m)",
        "1.022 mm by the cap",
        "an inference",
    ):
        assert words in text
    record = json.loads(CliRunner().invoke(main, ["--json"]).output)
    assert record["patch"]["by_cap_mm3_per_Nm"] == pytest.approx(3.5e-4, abs=0.05e-4)
