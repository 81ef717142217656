"""Further columns of a record, friction without load, and a sensor at the end of its range."""

from pathlib import Path

import numpy as np
import pytest
from calibration.cases_lab import lab_recipe

import warpwear
from warpwear import InputError

ROWS = 3000


def record(folder: Path, *, offset: float = 0.0, most: float = 99.0) -> Path:
    """Write a record with forces, linear wear of 0.5 µm a metre, a remark, and 40 rows without load."""
    dice = np.random.default_rng(1)
    time = 0.1 * np.arange(ROWS)
    load = np.where(np.arange(ROWS) < 40, 0.0, 8.0)
    friction = np.minimum(offset + 0.4 * load + dice.normal(0.0, 0.02, ROWS), most)
    wear = 0.5 * 0.02 * time + dice.normal(0.0, 0.01, ROWS)
    lines = ["Time [s],Fx [N],Fz [N],Linear wear [um],Remark"]
    lines += [
        f"{t:.1f},{f:.6f},{n},{w:.6f},ok" for t, f, n, w in zip(time, friction, load, wear, strict=True)
    ]
    path = folder / "record.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def test_a_further_column_is_kept_and_summed_up(tmp_path: Path) -> None:
    read = warpwear.read_record(record(tmp_path), speed="20 mm/s")
    wear = read.numbers["linear wear [um]"]
    assert wear["rate_per_m"] == pytest.approx(0.5, abs=4.0 * wear["rate_per_m_error"])
    assert 0.0 < wear["rate_per_m_error"] < 0.01
    assert "linear wear [um]" in read.to_dataframe()
    assert len(read.figure().axes) == 2
    assert not read.numbers["warnings"]


def test_friction_without_load_is_told_and_taken_off(tmp_path: Path) -> None:
    path = record(tmp_path, offset=0.8)
    read = warpwear.read_record(path, speed="20 mm/s")
    assert any("friction without load is 0.8" in warning for warning in read.numbers["warnings"])
    assert read.numbers["steady_cof"] == pytest.approx(0.5, abs=0.01)
    zeroed = warpwear.read_record(path, speed="20 mm/s", zero=True)
    assert zeroed.numbers["steady_cof"] == pytest.approx(0.4, abs=0.01)
    assert any("was taken off" in note for note in zeroed.numbers["notes"])
    with pytest.raises(InputError, match="shows no friction without load"):
        warpwear.read_record(record(tmp_path), speed="20 mm/s", zero=True)


def test_a_sensor_at_the_end_of_its_range_is_told(tmp_path: Path) -> None:
    read = warpwear.read_record(record(tmp_path, most=3.2), speed="20 mm/s")
    assert any("is exactly 3.2, its largest value" in warning for warning in read.numbers["warnings"])


def test_steps_of_a_recipe_are_rows_and_panels(tmp_path: Path) -> None:
    """Steps of 10 m under 5, 10 and 20 N; linear wear rises by 0.2 µm a metre and newton."""
    path = lab_recipe(tmp_path / "recipe.csv", 0, loads=(5.0, 10.0, 20.0))
    read = warpwear.read_record(path, radius="6 mm")
    steps = read.analysis.steps
    assert [step.slid for step in steps] == pytest.approx([9990.0] * 3)
    assert [step.before for step in steps] == pytest.approx([0.0, 9990.0, 19980.0])
    for number, load in zip(read.numbers["steps"], (5.0, 10.0, 20.0), strict=True):
        assert number["load_N"] == pytest.approx(load)
        assert number["energy_J"] == pytest.approx((0.5 + 0.01 * load) * load * 9.99, rel=0.01)
        rate = number["linear wear [um]"]
        assert rate["rate_per_m"] == pytest.approx(0.2 * load, abs=4.0 * rate["rate_per_m_error"])
    lines = read.text.splitlines()
    (head,) = (k for k, line in enumerate(lines) if line.startswith("  steps "))
    assert "steady value  jump at, m  energy, J  linear wear, um/m" in lines[head]
    assert [line.split()[:2] for line in lines[head + 1 : head + 4]] == [["1", "5"], ["2", "10"], ["3", "20"]]
    axes = [axis for axis in read.figure().axes if axis.has_data()]
    assert len(axes) == 4  # of friction a step, and of the wear
    assert [axis.get_xlim()[0] for axis in axes[:3]] == pytest.approx([0.0, 9.99, 19.98])
