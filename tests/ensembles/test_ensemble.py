"""Rows in groups, and what bands say of them: of runs, of words, of repeats of a measured course."""

import math
import statistics
from pathlib import Path

import numpy as np
import pytest

from warpwear.ensembles.ensemble import Ensemble, EnsembleRow, Group, means_of_parts, rms_difference, row_of
from warpwear.ensembles.figures import lines_of
from warpwear.ensembles.page import answers_of, than
from warpwear.ensembles.table import read_csv, write_csv
from warpwear.measured.experiment import Experiment
from warpwear.results.ensemble import band, band_name

#: Levels of three tests of one pair.
LEVELS = (0.5, 0.6, 0.58)


def test_a_mean_lies_among_its_values() -> None:
    """The mean of three times 0.1 is 0.10000000000000002; of 19 rows a band is one of 5 to 95 %."""
    assert [float(one[0]) for one in band(np.full((3, 1), 0.1))] == [0.1, 0.1, 0.1]
    assert [band_name(count) for count in (18, 19)] == ["least to most", "5 to 95 %"]


def repeats() -> Group[EnsembleRow]:
    """Three tests of one pair, straight lines to their levels; one is twice as long."""
    rows = []
    for number, level in enumerate(LEVELS):
        distance = np.linspace(0.0, 20.0 if number else 40.0, 21)
        rows.append(row_of(Experiment(f"test {number}", distance, np.full(21, level))))
    return Group("pair", tuple(rows), "experiment")


def test_repeats_of_a_measured_course_have_mean_deviation_and_band() -> None:
    group = repeats()
    assert group.mean("cof") == pytest.approx(statistics.fmean(LEVELS))
    assert group.deviation("cof") == pytest.approx(statistics.stdev(LEVELS))
    assert group.band("cof") == pytest.approx((statistics.fmean(LEVELS), min(LEVELS), max(LEVELS)))
    assert group.numbers("distance") == [40.0, 20.0, 20.0]
    assert group.count is None  # no run
    found = group.courses("cof")
    assert found is not None
    assert found[0][-1] == 40.0
    assert np.isfinite(found[1][:, found[0] <= 20.0]).all()
    assert np.isnan(found[1][1:, found[0] > 20.0]).all()
    ((of, line),) = lines_of([group], "cof")
    assert of is group
    assert line.y[0] == pytest.approx(statistics.fmean(LEVELS))
    assert line.y[-1] == LEVELS[0]


def test_what_is_not_known_of_a_row_is_left_out() -> None:
    ends = ({"area": 1.0, "law": "local"}, {"area": None, "law": "bulk"}, {"area": 3.0})
    group = Group("all", tuple(EnsembleRow(str(n), end, {}) for n, end in enumerate(ends)))
    assert group.mean("area") == 2.0
    assert group.mean("law") == "local, bulk"
    assert group.mean("volume") is None
    assert group.deviation("law") is None
    assert all(map(math.isnan, group.band("volume")))
    assert group.courses("cof") is None
    assert group.count == 3


def test_answers_are_beside_the_first_with_their_scatter() -> None:
    rows = [EnsembleRow(str(n), {"cof": cof}, {}) for n, cof in enumerate((0.4, 0.6, 0.25))]
    table = answers_of(Ensemble((Group("two", tuple(rows[:2])), Group("one", (rows[2],)))), {"one"})
    assert table["names"] == ["two", "one"]
    runs, (_, (two, one)) = table["rows"]
    assert runs == ("runs", [{"text": "2"}, {"text": "1"}])
    assert two == {"text": "0.5 ± 0.14", "notes": ["least to most: 0.4 to 0.6"], "is_input": False}
    assert one == {"text": "0.25", "notes": ["−50 %"], "is_input": True}


def test_differences_are_to_the_first_run() -> None:
    assert than(1.1, 1.0) == "+10 %"
    assert than(0.9, 1.0) == "−10 %"
    assert than(3.0, 1.0) == "× 3"
    assert than(1.00001, 1.0) == "the same"
    assert than(1.0, None) == ""


def test_a_table_is_read_as_it_was_written(tmp_path: Path) -> None:
    """All digits of numbers, nothing for what is not known, no formula, no row that was cut off."""
    path = tmp_path / "table.csv"
    write_csv({"name": ["=1+1", "b"], "cof [1]": [0.1 + 0.2, None], "steps": [3, np.float64(1 / 3)]}, path)
    rows = read_csv(path)
    assert rows[0] == {"name": "'=1+1", "cof [1]": "0.30000000000000004", "steps": "3"}
    assert (rows[1]["cof [1]"], float(rows[1]["steps"])) == ("", 1 / 3)
    path.write_text(path.read_text() + "c,1")
    assert len(read_csv(path)) == 2


def test_rms_difference_of_straight_lines() -> None:
    one, other = np.array([0.0, 3.0]), np.array([1.0, 2.0, 5.0])
    # x against 0 from 1 to 3: the mean of x² is 26/6.
    assert rms_difference((one, one), (other, np.zeros(3))) == pytest.approx(math.sqrt(26 / 6))
    assert rms_difference((one, one), (other + 3.0, np.zeros(3))) is None


def test_shape_of_a_noisy_square_root_and_of_too_few_points() -> None:
    distance = np.linspace(0.0, 100.0, 20_001)
    noise = np.random.default_rng(4).normal(0.0, 0.02, distance.size)
    found = row_of(Experiment("root", distance, np.sqrt(distance) / 10 + noise)).ends
    assert found["exponent_m"] == pytest.approx(0.5, abs=0.01)
    # Secants of √x: (1 − √½)/½ over (√0.1 − √(1/80))/(0.1 − 1/80).
    expected = (1 - math.sqrt(0.5)) / 0.5 / ((math.sqrt(0.1) - math.sqrt(1 / 80)) / (0.1 - 1 / 80))
    assert found["levelling_lambda"] == pytest.approx(expected, rel=0.05)
    late = row_of(Experiment("late", distance[2000:], np.sqrt(distance[2000:]))).ends
    assert "exponent_m" in late
    assert "levelling_lambda" not in late
    few = row_of(Experiment("few", distance[::2000], np.sqrt(distance[::2000]))).ends
    assert set(few) == {"distance", "steps", "cof"}


def test_means_of_parts_are_over_the_distance() -> None:
    """Rows that lie ten times as close weighted ten times as much, and hid what came after."""
    dense, sparse = np.linspace(0.0, 50.0, 501), np.linspace(51.0, 100.0, 50)
    distance = np.concatenate([dense, sparse, 100.0 + dense[1:], 100.0 + sparse])
    places, means, same = means_of_parts(2, distance, distance**2, np.full(distance.size, 0.3))
    assert places == pytest.approx([50.0, 150.0])
    assert means == pytest.approx([100.0**2 / 3.0, 7.0 * 100.0**2 / 3.0], rel=1e-4)
    assert same == pytest.approx([0.3, 0.3], rel=1e-12)
    gap = np.array([0.0, 5.0, 70.0, 80.0, 100.0])  # parts without rows go
    assert means_of_parts(4, gap, gap)[0] == pytest.approx([12.5, 62.5, 87.5])
