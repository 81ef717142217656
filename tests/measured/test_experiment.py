"""Reading a measured course of friction: what is read, what is told, what is refused."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_records import raw

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.course import read_experiment
from warpwear.measured.experiment import Experiment
from warpwear.measured.motion import motion_of_runs
from warpwear.study.study import Study


def read(folder: Path, content: str | bytes, **options: Any) -> Experiment:
    path = folder / "wear.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_experiment(path, **options)


@pytest.mark.parametrize(
    "content",
    [
        "Distance (m),COF\n0,0\n0.1,0.35\n0.2,0.4\n",
        "distance [mm];CoF\n0;0\n100;0.35\n200;0.4\n",
        "Weg in mm;Reibwert\n0;0\n100;0,35\n200;0,4\n",
        "\ufeffSliding distance, mm\tµ\n0\t0\n100,0\t0,35\n2e2\t0,4\n",
        "Sliding distance, mm\tµ\n0\t0\n100,0\t0,35\n200\t0,4\n".encode("latin-1"),
        "Gleitweg [m];Reibungskoeffizient [-]\n0;0\n0,1;0,35\n0,2;0,4\n".encode("utf-16"),
        "Sample 7\nLoad;8;N\n\nStep;Distance;Friction coefficient\n;cm;-\nA;0;0\nA;10;.35\nA;20;.4\n",
        "# a record\n# distance_mm cof\n0 0\n100 0.35\n\n# a pause\n200 0.4\n",
        "total distance (mm)  coefficient of friction\n0 0\n100 0,35\n200 0,4\n",
        '"Distance, mm","Mean COF"\r\n"0","0"\r\n"100,0","0,35"\r\n"200,0","0,4"\r\n',
        "Distance,mm,CoF\n0,0\n100,0.35\n200,0.4\n",
        "Distance (mm),COF,\n0,0,\n100,0.35,\n200,0.4,\n",
        "2 rows out of order\nDistance (mm),COF\n200,0.4\n0,0\n100,0.35\n",
        "3\nClock;Date;Distance (mm);COF\n9:59;1.2.2024;0;0\n9:59:59;2.2.2024;100;.35\n;3.2.2024;200;.4\n",
        "Distance (mm)\tCOF\n0\t0\n100;0.35\n200\t0.4\n",
    ],
)
def test_the_same_course_written_in_many_ways(tmp_path: Path, content: str | bytes) -> None:
    found = read(tmp_path, content)
    assert found.name == "wear"
    np.testing.assert_allclose(found.distance, [0, 100, 200], rtol=1e-14)
    np.testing.assert_allclose(found.cof, [0, 0.35, 0.4], rtol=1e-14)
    assert found.cycles is None
    assert any(note.startswith("Columns: distance from '") for note in found.notes)


def test_time_needs_a_speed_and_cycles_a_stroke(tmp_path: Path) -> None:
    minutes = "t [min];temperature [°C];COF\n0;20;0.1\n1;21;0.2\n"
    assert read(tmp_path, minutes, speed=0.5).distance.tolist() == [0.0, 30.0]
    with pytest.raises(InputError, match=r"a speed is needed, such as --speed '20 mm/min'\.$"):
        read(tmp_path, minutes)
    assert read(tmp_path, "Zyklus;CoF\n1;0,1\n3;0,2\n", stroke=30.0).distance.tolist() == [60.0, 180.0]
    with pytest.raises(InputError, match="length of a stroke is needed"):
        read(tmp_path, "Zyklus;CoF\n1;0,1\n3;0,2\n")
    with pytest.raises(InputError, match="time since the start of sliding is expected"):
        read(tmp_path, "time (s),COF\n1700000000,0.1\n1700000060,0.2\n", speed=1.0)


def test_gaps_and_repeated_distances_are_told(tmp_path: Path) -> None:
    found = read(
        tmp_path,
        "Distance (mm);COF\n1;\n2;0,2\n;\n3;NaN\n3;0,1\n4;0,5\n4;0,3\n;0,9\n--;0,1\n5;n/a\n6;0\n",
    )
    assert found.distance.tolist() == [2, 3, 4, 6]
    np.testing.assert_allclose(found.cof, [0.2, 0.1, 0.4, 0.0])
    told = " ".join(found.notes)
    assert "Rows with gaps, left out: 6 of 11." in told
    assert "Rows at the distance of another, averaged with it: 1." in told


def test_rows_before_the_start_are_left_out(tmp_path: Path) -> None:
    rows = "".join(f"{d},{0.3 if d >= 0 else 9}\n" for d in range(-2, 30))
    found = read(tmp_path, "time (s),COF\n" + rows, speed=1.0)
    assert np.array_equal(found.distance, np.arange(30.0))
    assert any("before the start" in note and note.endswith("left out: 2.") for note in found.notes)
    with pytest.raises(InputError, match="2 of 4 distances or times are negative"):
        read(tmp_path, "Distance (mm),COF\n-2,0.1\n-1,0.1\n0,0.1\n1,0.1\n")


def test_rows_out_of_order_are_sorted(tmp_path: Path) -> None:
    distance = np.random.default_rng(2).permutation(np.arange(1.0, 61.0))
    rows = "".join(f"{d:g},{d / 100:g}\n" for d in distance)
    found = read(tmp_path, "Distance (mm),COF\n" + rows)
    assert np.array_equal(found.distance, np.arange(1.0, 61.0))
    np.testing.assert_allclose(found.cof, found.distance / 100)
    assert "Rows were out of order and were sorted by distance." in found.notes


def test_a_counter_that_slips_back_stands_still(tmp_path: Path) -> None:
    rows = "".join(f"{k},{10 * (k - 2 * (k == 100))},{0.3 + k / 1000}\n" for k in range(200))
    found = read(tmp_path, "Time (s),Distance (mm),COF\n" + rows)
    assert any("falls back at 1 rows while time goes on" in note for note in found.notes)
    assert found.distance.size == 199
    assert found.cof[99] == pytest.approx(0.3995)  # of both rows


def test_a_distance_that_starts_again_is_refused(tmp_path: Path) -> None:
    steps = np.arange(200)
    for distance in (steps % 50 + 0.01 * (steps // 50), np.abs(steps % 40 - 20) + 0.001 * steps):
        rows = "".join(f"{d:g},0.3\n" for d in distance)
        with pytest.raises(InputError, match="accumulated distance is expected"):
            read(tmp_path, "Distance (mm),COF\n" + rows)
    with pytest.raises(InputError, match="with different coefficients of friction"):
        read(tmp_path, "Distance (mm),COF\n2,0.3\n1,0.2\n2,0.4\n")
    blocks = [*range(50, 100), *range(50)]  # in the wrong order, but nothing twice
    found = read(tmp_path, "Distance (mm),COF\n" + "".join(f"{d},0.3\n" for d in blocks))
    assert np.array_equal(found.distance, np.arange(100.0))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "is empty"),
        (" \n\n", "is empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", "is no text file"),
        (bytes(range(128, 160)) * 30, "is no text file"),
        ("Distance (mm),COF\n", "no rows of numbers"),
        ("Distance (mm),COF\n1,0.2\n", "rows with all values: 1; two or more"),
        ("Distance (mm),COF\n1,0.2\n1,0.2\n", "one distance only"),
        ("Distance (mm);Temperature (°C)\n1;20\n2;21\n", "no column for the coefficient of friction"),
        ("COF;Temperature (°C)\n1;20\n2;21\n", "neither distance nor time"),
        ("1,0.2\n2,0.3\n", "no header with a name for each of its 2 columns"),
        ("Distance (mm),COF\n0,1,0,2\n0,2,0,3\n", "no header with a name for each of its 4 columns"),
        ("Distance,CoF\n1,0.1\n2,0.2\n", "'Distance' has no unit"),
        ("Distance (kg),CoF\n1,0.1\n2,0.2\n", "unit kg, which is no unit of length"),
        ("Distance (mm),COF (N)\n1,0.2\n2,0.2\n", "unit N, where a plain number is expected"),
        (
            "Distance (mm),COF,Friction coefficient\n1,.1,1\n2,.2,2\n",
            "'COF', 'Friction coefficient'; --columns",
        ),
        ("Distance (mm),COF,COF\n1,0.1,1\n2,0.2,2\n", "picks by number"),
        ("Distance (mm);COF\n1;0.2\n2,0.3\n", "line 3 has 1 fields where line 2 has 2"),
        ("Distance (mm);COF\n1;0.2\n2;0,3\n", r"mixes decimal commas \(line 3\) and points \(line 2\)"),
        ("Distance (mm);COF\n1,5;0,2\n1.002,5;0,3\n", "mixes decimal commas"),
        ("Distance (mm),COF\n1,0.2\n2,0.3 end\n", "line 3 holds '0.3 end', which is no number"),
        ('Distance (mm);COF\n1;0.2\n2;"0.3\n', "which is no number"),
        ("Distance (mm);COF\n1;0.2\n2;٣.5\n", "which is no number"),
        ("Distance (mm),COF\n1,20\n2,0.3\n", "1 of 2 coefficients of friction exceed 3"),
        ("Distance (mm),COF\n1,-0.2\n2,-0.3\n", "negative everywhere"),
        ("Distance (mm),COF\n1,0.3\n2,-0.3\n3,0.3\n", "signed friction of both directions"),
    ],
)
def test_what_could_mean_two_things_or_none_is_refused(
    tmp_path: Path, content: str | bytes, words: str
) -> None:
    with pytest.raises(InputError, match=words) as caught:
        read(tmp_path, content)
    assert re.fullmatch(r"[^\n]*wear\.csv[^\n]*\.", str(caught.value))


def test_columns_are_picked_by_name_number_and_with_a_unit(tmp_path: Path) -> None:
    twice = "Distance, mm;COF;COF\n1;0.1;0.3\n2;0.2;0.4\n"
    assert read(tmp_path, twice, columns="1,3").cof.tolist() == [0.3, 0.4]
    assert read(tmp_path, twice, columns="Distance, mm;2").cof.tolist() == [0.1, 0.2]
    with pytest.raises(InputError, match="2 columns called 'COF'; pick by number"):
        read(tmp_path, twice, columns="Distance, mm;COF")
    odd = "s,ratio\n1,0.1\n2,0.2\n"
    assert read(tmp_path, odd, columns="S [m],ratio").distance.tolist() == [1000, 2000]
    assert read(tmp_path, odd, columns="s [min],ratio", speed=0.5).distance.tolist() == [30, 60]
    assert read(tmp_path, "1,0.2\n2,0.3\n", columns="1 [mm],2").cof.tolist() == [0.2, 0.3]
    for picks in ("s", "s [m],nothing", "s [m],ratio,3", "0,1"):
        with pytest.raises(InputError, match="two columns"):
            read(tmp_path, odd, columns=picks)


def write_raw(
    path: Path, record: tuple[FloatArray, ...], header: str = "Fx (N);Fz (N);X position (mm)"
) -> Path:
    np.savetxt(path, np.column_stack(record[1:]), delimiter=";", header=header, comments="", fmt="%.6f")
    return path


@pytest.mark.parametrize("noise", [0.0, 0.06, 0.3])
def test_raw_forces_give_a_coefficient_a_cycle(tmp_path: Path, noise: float) -> None:
    record = raw(noise=noise)
    found = read_experiment(write_raw(tmp_path / "raw.txt", record))
    assert found.cycles is not None
    assert found.cycles.tolist() == list(range(1, 13))
    middle = 2 * found.cycles - 1  # passes slid at the turn between the two of a cycle
    np.testing.assert_allclose(found.distance, 30 * middle, rtol=0.015, atol=0.2)
    np.testing.assert_allclose(found.cof, 0.3 + 0.01 * middle, atol=0.003)
    summed = np.abs(np.diff(record[3])).sum()  # what noise would make of the distance
    assert noise < 0.1 or summed > 4 * 24 * 30
    told = " ".join(found.notes)
    assert "Samples within a tenth of the stroke of its ends, cut: " in told
    offset = re.search(r"offset is ([\d.]+) N", told)
    assert offset is not None
    assert float(offset[1]) == pytest.approx(0.5, abs=0.02)


def test_raw_forces_from_the_middle_of_a_stroke_with_the_stroke_given(tmp_path: Path) -> None:
    path = write_raw(tmp_path / "raw.txt", raw(start=0.4, cycles=6.3, noise=0.06))
    found = read_experiment(path, stroke=30.0, load=5.0)
    assert found.distance[0] == pytest.approx(0.6 * 30 + 30, abs=0.5)  # the part, then a pass
    np.testing.assert_allclose(np.diff(found.distance), 60.0, rtol=1e-12)
    np.testing.assert_allclose(found.cof, 0.3 + 0.01 * (0.4 + found.distance / 30), atol=0.003)
    told = "Warning: the median of the normal force is 8 N where the run has 5 N."
    assert found.warnings == (told,)
    assert read_experiment(path, stroke=30.0, load=7.5).warnings == ()
    for load in (3.9, 16.5, 8e3):
        with pytest.raises(InputError, match=f"is 8 N where the run has {load:g} N; less than a factor of 2"):
            read_experiment(path, stroke=30.0, load=load)
    with pytest.raises(InputError, match=r"the stroke is (30|29\.9) mm by the position, not 20 mm"):
        read_experiment(path, stroke=20.0)


def test_raw_cycles_without_load_are_left_out(tmp_path: Path) -> None:
    passes, friction, normal, position = raw()
    early = passes < 4
    record = passes, np.where(early, 0.5, friction), np.where(early, -0.01, -normal), position
    found = read_experiment(write_raw(tmp_path / "raw.txt", record))
    assert found.cycles is not None
    assert found.cycles[0] == 3
    assert found.distance[0] == pytest.approx(5 * 30, rel=0.01)
    told = " ".join(found.notes)
    assert "less than half of the median normal force, left out: 2." in told
    assert "negative in the record and was taken as pressing" in told


def test_raw_records_that_say_too_little_are_refused(tmp_path: Path) -> None:
    passes, friction, normal, position = raw(cycles=4)
    path = tmp_path / "raw.txt"
    with pytest.raises(InputError, match="does not change its sign with the direction"):
        read_experiment(write_raw(path, (passes, np.abs(friction), normal, position)))
    with pytest.raises(InputError, match="turns 3 times: two whole cycles are expected"):
        read_experiment(write_raw(path, raw(cycles=1)))
    with pytest.raises(InputError, match="turns 0 times"):
        read_experiment(write_raw(path, (passes, friction, normal, 0 * position)))
    with pytest.raises(InputError, match=r"changes its sign: 'Position \[mm\]' is expected"):
        read_experiment(write_raw(path, (passes, friction, normal), "Fx (N);Fz (N)"))
    with pytest.raises(InputError, match="no normal force"):
        read_experiment(write_raw(path, (passes, friction, position), "Fx (N);Position (mm)"))
    given = read_experiment(write_raw(path, (passes, friction, position), "Fx (N);Position (mm)"), load=8.0)
    assert given.cof[0] == pytest.approx(0.31, abs=0.003)


def test_forces_in_one_direction_need_no_position(tmp_path: Path) -> None:
    record = np.zeros(3), np.array([-2.0, -3.0, -4.0]), np.array([8.0, 8.0, 8.0]), np.array([0.0, 1.0, 2.0])
    found = read_experiment(write_raw(tmp_path / "pin.txt", record, "Ft [N];Fn [N];distance [m]"))
    np.testing.assert_allclose(found.cof, [0.25, 0.375, 0.5])
    assert found.distance.tolist() == [0, 1000, 2000]


def test_final_coefficient_is_the_mean_over_the_last_tenth() -> None:
    """A straight line's is that of its middle, however many rows stand in which part of it."""
    for distance in (np.arange(1.0, 101.0), np.array([1.0, 50.0, *np.linspace(98.0, 99.0, 50), 100.0])):
        assert Experiment("e", distance, 2.0 * distance).final_cof == pytest.approx(190.0)
    assert Experiment("e", np.array([5.0]), np.array([0.3])).final_cof == 0.3
    assert Experiment("e", np.array([98.0, 100.0]), np.array([0.2, 0.4])).final_cof == pytest.approx(0.3)


def test_what_runs_say_of_a_record() -> None:
    """A frequency says a speed, too; what runs differ in is not known."""
    study = Study.load("first")
    said = motion_of_runs(study)
    assert (said.load, said.stroke, said.run_speed, said.speed, said.radius) == (5.0, 5.0, 10.0, None, None)
    both = motion_of_runs(study, study.replace({"contact.load": "8 N"}))
    assert (both.load, both.stroke) == (None, 5.0)
    assert motion_of_runs().run_speed is None
