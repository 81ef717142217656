"""Records as machines write them: known by their content, each value the one that stands in the file."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cases_records import RECORDS, ROWS, cetr, course, rtec, written

from warpwear.errors import InputError
from warpwear.measured.course import read_experiment
from warpwear.measured.record import FORMATS
from warpwear.measured.rows import read_rows

HERE = Path(__file__).parent
COURSE = np.array(course(ROWS))


def record(folder: Path, name: str) -> Path:
    path = folder / name
    path.write_bytes(written(RECORDS[name][0]()))
    return path


def test_laps_times_the_radius_of_each_step_are_the_distance_of_a_rtec(tmp_path: Path) -> None:
    path = record(tmp_path, "rtec.csv")
    found = read_experiment(path, radius=[6.0, 9.0])
    lap = 0.2 * 2.0 * np.pi
    expected = np.cumsum([0.0, *[6.0 * lap] * (ROWS - 1), *[9.0 * lap] * ROWS])
    np.testing.assert_allclose(found.distance, expected, rtol=1e-12)
    assert found.cof.tolist() == [*COURSE, *COURSE]
    assert "Format: Rtec, 2 steps." in found.notes
    rows = read_rows(path)
    assert rows.steps == ("4", "7")
    np.testing.assert_allclose(rows.table["time"], 0.1 * np.arange(1, 2 * ROWS + 1), rtol=1e-12)
    with pytest.raises(InputError, match=r"such as --radius '6 mm', or one for each of its 2 steps\.$"):
        read_experiment(path)
    with pytest.raises(InputError, match=r"3 values where .* has 2 steps \('4', '7'\)"):
        read_experiment(path, radius=[1.0, 2.0, 3.0])


def test_turns_a_minute_and_time_serve_where_laps_are_missing(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("Time (s),Speed (rpm),COF\n" + "".join(f"{k},60,0.3\n" for k in range(5)))
    found = read_experiment(path, radius=10.0)
    np.testing.assert_allclose(found.distance, 20.0 * np.pi * np.arange(5), rtol=1e-12)
    path.write_text("Time (s),Velocity (m/s),COF\n" + "".join(f"{k},0.02,0.3\n" for k in range(5)))
    assert read_experiment(path).distance.tolist() == [0.0, 20.0, 40.0, 60.0, 80.0]


def test_files_of_strokes_are_one_record_and_the_offset_of_the_force_drops_out(tmp_path: Path) -> None:
    for number in (2, 1, 10):  # 2 before 10
        (tmp_path / f"wear_{number}.csv").write_text(cetr(number))
    found = read_experiment(tmp_path, stroke=8.0)
    np.testing.assert_allclose(found.cof, [0.301, 0.302, 0.31], rtol=1e-5)
    assert found.distance.tolist() == [8.0, 24.0, 40.0]
    assert found.cycles is not None
    assert found.cycles.tolist() == [1.0, 2.0, 3.0]
    assert any(note.startswith("3 files, from wear_1.csv to wear_10.csv") for note in found.notes)
    assert any("their offset is 0.19" in note for note in found.notes)  # 20 g
    rows = read_rows(tmp_path)
    assert rows.table["normal force"][0] == -200.0 * 0.00980665
    with pytest.raises(InputError, match=r"--stroke '10 mm' is needed\.$"):
        read_experiment(tmp_path)
    assert any("the stroke, 8 mm (as given)" in note for note in found.notes)
    by_speed = read_experiment(tmp_path, speed=10.0)
    np.testing.assert_allclose(by_speed.cof, found.cof)
    np.testing.assert_allclose(np.diff(by_speed.distance), 2 * 10.0 * 0.02 * ROWS, rtol=0.02)


def test_decimal_commas_tabs_and_15_lines_of_a_phoenix(tmp_path: Path) -> None:
    found = read_experiment(record(tmp_path, "phoenix.tsv"))
    np.testing.assert_allclose(found.cof, COURSE[2:], atol=5e-7)
    assert found.distance[0] == 176.0  # 2 laps of 14 mm, to the millimetre as the machine writes it
    assert "Rows at rest, left out: 2 of 40." in found.notes
    assert not found.warnings
    assert read_rows(tmp_path / "phoenix.tsv").steps == ("2", "3")


def test_a_signed_coefficient_gives_way_to_forces_and_position(tmp_path: Path) -> None:
    found = read_experiment(record(tmp_path, "trb3.txt"), load=5.0)
    assert found.cof.size == 6
    np.testing.assert_allclose(found.cof, 0.3 + 0.01 * np.arange(6), atol=0.001)
    np.testing.assert_allclose(np.diff(found.distance), 8.0, rtol=0.01)
    assert any(note.startswith("The column 'µ' goes with the direction") for note in found.notes)
    told = read_experiment(tmp_path / "trb3.txt")
    np.testing.assert_array_equal(told.cof, found.cof)  # its nominal load


def test_channels_in_grams_are_named_by_hand(tmp_path: Path) -> None:
    path = record(tmp_path, "kyowa.csv")
    with pytest.raises(InputError, match=r"'Time\(sec\)', 'CH1', 'CH2'.*'TIME,FRICTION,LOAD' three"):
        read_experiment(path)
    found = read_experiment(path, columns="Time(sec), CH2 [g], CH1 [g]", speed=10.0)
    np.testing.assert_allclose(found.cof, COURSE, atol=1e-9)
    np.testing.assert_allclose(found.distance, 0.2 * np.arange(ROWS), rtol=1e-12)


def test_a_load_is_given_where_the_machine_writes_none(tmp_path: Path) -> None:
    found = read_experiment(record(tmp_path, "t11.csv"), radius=5.0, load=4.0)
    np.testing.assert_allclose(found.cof, COURSE, atol=1e-9)
    np.testing.assert_allclose(found.distance, 20.0 * np.pi * np.arange(ROWS), rtol=1e-12)


def test_values_of_a_mini_traction_machine_as_they_stand_in_its_file() -> None:
    rows = read_rows(HERE / "records" / "pcs-mtm.txt")
    assert (rows.format, rows.steps) == ("PCS", ("2", "4"))
    assert rows.table["cof"][[0, 1, 7, 8, 9]].tolist() == [0.0196, 0.0233, 0.0254, 0.0601, 0.0199]
    assert rows.table["normal force"][[0, 8, 16]].tolist() == [4.948, 49.728, 49.870]
    assert rows.table["speed"][[0, 1, 9]].tolist() == [173.69, 199.75, 174.53]
    assert rows.table["friction force"][0] == 0.0972
    assert rows.table["time"][[0, 8, 9, 16]].tolist() == [1.0, 300.0, 301.0, 308.0]
    found = read_experiment(HERE / "records" / "pcs-mtm.txt")
    assert found.distance[1] == pytest.approx(0.5 * (173.69 + 199.75), rel=1e-14)


def test_columns_that_contradict_each_other_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(rtec().replace(",120,", ",119,"))
    assert not read_experiment(path, radius=6.0).warnings
    shifted = "\n".join(
        line.replace(",3.0,", ",2.0,") if line[:2] in ("4,", "7,") else line for line in rtec().split("\n")
    )
    path.write_text(shifted)
    (told,) = read_experiment(path, radius=6.0).warnings
    assert told.startswith(
        "Warning: the column 'DAQ.COF ()' is not 'DAQ.Fx (N)' over 'DAQ.Fz (N)': its median is"
    )
    rows = "".join(f"{k},{k},0.3\n" for k in range(1, 9))
    path.write_text("Distance (mm),Laps,COF\n" + rows)
    (told,) = read_experiment(path, radius=6.0).warnings
    assert "'Laps' times 2π radius over 263.9 mm" in told


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace(",0,-114.6,", ",0,", 1), "ragged rows"),
        (lambda text: text.replace("\n7,0.100", "\nnothing\n7,0.100"), "a row of numbers behind 'nothing'"),
        (lambda text: text.replace(",0,-114.6,", ",0,-114.6,1,1,"), "fields under 10 names"),
        (lambda text: text.replace(",DAQ.COF", ",a,DAQ.COF"), "one distance only"),
        (lambda text: text.replace(",120,", ",12O,", 1), "which is no number"),
    ],
)
def test_damaged_tables_are_refused(tmp_path: Path, change: Callable[[str], str], words: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(change(rtec()))
    with pytest.raises(InputError, match=words):
        read_experiment(path, radius=[6.0, 9.0])


def test_a_row_without_its_end_is_left_out_and_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(rtec().split("\n\r\nTotalTime")[0][:-9])
    found = read_experiment(path, radius=[6.0, 9.0])
    assert found.cof.size == 2 * ROWS - 1
    assert any(
        note.startswith("The last row, line ") and note.endswith("was left out.") for note in found.notes
    )


def test_a_remark_below_a_plain_table_is_no_row(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes("Distance (mm);COF\n1;0,2\n2;0,3\n\nTest completed\nTotal: 2\n".encode("utf-16-le"))
    assert read_experiment(path).cof.tolist() == [0.2, 0.3]


def test_a_folder_needs_files_with_the_same_columns(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no file"):
        read_experiment(tmp_path)
    (tmp_path / "a.csv").write_text("Distance (mm),COF\n1,0.2\n2,0.3\n")
    (tmp_path / "b.csv").write_text("Time (s),COF\n1,0.2\n2,0.3\n")
    with pytest.raises(InputError, match=r"has time, cof where a\.csv has distance, cof"):
        read_experiment(tmp_path)


def test_every_make_is_known_by_words_of_its_own() -> None:
    assert len({form.name for form in FORMATS}) == len(FORMATS)
    assert all(form.mark for form in FORMATS)
