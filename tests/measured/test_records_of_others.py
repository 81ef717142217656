"""Records as people have them: clocks, odd units, torque, workbooks, sensors at their end, no load yet."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import warpwear
from warpwear import InputError
from warpwear.cli.main import commands
from warpwear.grid import FloatArray
from warpwear.measured.course import read_experiment
from warpwear.measured.record import FORMATS

pytest.importorskip("ruptures")

ROWS = 400
COF: FloatArray = (
    0.6 - 0.4 * np.exp(-np.arange(ROWS) / 40.0) + np.random.default_rng(1).normal(0.0, 0.01, ROWS)
)
SPEED = "50 mm/s"


def record(
    folder: Path, header: str, *columns: Any, name: str = "record.csv", sign: str = ",", end: str = "\n"
) -> Path:
    """Write a record: texts as they are, numbers to four decimals."""
    texts = [[cell if isinstance(cell, str) else f"{cell:.4f}" for cell in column] for column in columns]
    path = folder / name
    path.write_text("\n".join([header, *(sign.join(row) for row in zip(*texts, strict=True))]) + end, "utf-8")
    return path


def clock(second: int, form: str = "{:02d}:{:02d}:{:02d}") -> str:
    """Return the time of day that many seconds after 23:57."""
    second = (second + 86220) % 86400
    return form.format(second // 3600, second // 60 % 60, second % 60)


TIME = [str(k) for k in range(ROWS)]
CLOCKS = {
    "time of day past midnight": ("Time", [clock(k) for k in range(ROWS)]),
    "date and time": (
        "Date/Time",
        [f"2024-02-{28 + (k > 179)}T{clock(k)}.000" for k in range(ROWS)],
    ),
    "German": ("Uhrzeit", [f"{28 + (k > 179)}.02.2024 {clock(k)}" for k in range(ROWS)]),
    "American": (
        "Timestamp",
        [
            f"2/28/2024 {(clock(k)[:2] == '00') * 12 or 11}{clock(k)[2:]} {'AP'[k < 180]}M"
            for k in range(ROWS)
        ],
    ),
    "since the start": ("Time [hh:mm:ss]", [f"0:{k // 60:02d}:{k % 60:02d}" for k in range(ROWS)]),
}


@pytest.mark.parametrize("kind", CLOCKS)
def test_a_clock_is_a_time(tmp_path: Path, kind: str) -> None:
    title, cells = CLOCKS[kind]
    found = read_experiment(record(tmp_path, f"{title},COF", cells, COF), speed=50.0)
    np.testing.assert_allclose(found.distance, 50.0 * np.arange(ROWS), atol=1e-6)
    np.testing.assert_allclose(found.cof, COF, atol=1e-4)


def test_seconds_are_taken_before_a_clock_beside_them(tmp_path: Path) -> None:
    twice = [str(2 * k) for k in range(ROWS)]
    path = record(tmp_path, "Clock;Time [s];COF", CLOCKS["German"][1], twice, COF, sign=";")
    assert read_experiment(path, speed=50.0).distance[-1] == pytest.approx(100.0 * (ROWS - 1))
    cells = ["no clock" if k == 3 else cell for k, cell in enumerate(CLOCKS["German"][1])]
    with pytest.raises(InputError, match="line 5 holds 'no clock', which is no time of day"):
        read_experiment(record(tmp_path, "Clock,COF,Load [N]", cells, COF, COF), speed=50.0)


@pytest.mark.parametrize(
    "units", ["[s],,[N],[Ohm]", "s,-,N,mOhm", "s,,N,µl/min", "(s),(-),(N),(%RH)", "s,-,N,kHz"]
)
def test_a_row_of_units_may_hold_rare_ones(tmp_path: Path, units: str) -> None:
    ones = np.ones(ROWS)
    path = record(tmp_path, f"Time,COF,Load,Other\n{units}", TIME, COF, 10.0 * ones, COF)
    read = warpwear.read_record(path, speed=SPEED)
    assert read.numbers["distance_mm"] == pytest.approx(50.0 * (ROWS - 1))
    assert f"other [{units.split(',')[-1].strip('[]()')}]" in read.numbers


def test_names_above_numbers_are_no_units(tmp_path: Path) -> None:
    path = record(tmp_path, "Operator,Smith\nLoad,5 N\nCycles,CoF", TIME, COF)
    assert read_experiment(path, stroke=5.0).distance[-1] == pytest.approx(10.0 * (ROWS - 1))


def test_a_rare_unit_stands_behind_a_comma(tmp_path: Path) -> None:
    path = record(tmp_path, "Time, s;COF;Supply, mbar;Feed / µl/min", TIME, COF, COF, COF, sign=";")
    others = warpwear.read_record(path, speed=SPEED).numbers
    assert {"supply [mbar]", "feed [μl/min]"} <= others.keys()


@pytest.mark.parametrize("least", [0.05, 0.6])
def test_a_ratio_without_load_is_left_out(tmp_path: Path, least: float) -> None:
    """At 0.6 N of 10 N the noise is more than a fiftieth of the load, and its ratio far more than 3."""
    dice = np.random.default_rng(2)
    load = np.r_[dice.normal(0.0, least, 40), np.full(ROWS - 40, 10.0)]
    load[:2] = 0.01, least
    ratio = np.r_[dice.normal(0.0, 20.0, 40), COF[40:]]
    found = read_experiment(record(tmp_path, "Time [s],COF,Load [N]", TIME, ratio, load), speed=50.0)
    np.testing.assert_allclose(found.cof, COF[40:], atol=1e-4)
    assert "Rows without load, left out: 40 of 400." in found.notes


def test_blocks_of_small_loads_are_no_rows_without_load(tmp_path: Path) -> None:
    load = np.where(np.arange(ROWS) < 100, 5.0, 60.0)
    found = read_experiment(record(tmp_path, "Time [s],COF,Load [N]", TIME, COF, load), speed=50.0)
    assert found.cof.size == ROWS


def test_values_at_an_end_or_at_one_value_are_told(tmp_path: Path) -> None:
    def warnings(cof: FloatArray) -> list[str]:
        path = record(tmp_path, "Time [s],COF", TIME, cof)
        told: list[str] = warpwear.read_record(path, speed=SPEED).numbers["warnings"]
        return [text for text in told if "COF" in text]

    assert not warnings(COF)
    assert warnings(np.minimum(COF, 0.6))[0].startswith("'COF' is exactly 0.6, its largest value, in ")
    both = np.clip(COF, 0.5, 0.6)
    assert {text.split(",")[1] for text in warnings(both)} == {" its largest value", " its least value"}
    set_value = np.where(np.arange(ROWS) > 60, 0.45, COF)
    assert warnings(set_value)[0].startswith("'COF' is exactly 0.45, one value, in 339 of 400 rows")


def test_an_end_of_range_is_told_where_the_offset_was_taken_off(tmp_path: Path) -> None:
    load = np.where(np.arange(ROWS) < 40, 0.0, 8.0)
    force = np.minimum(0.8 + load * COF, 5.0)
    path = record(tmp_path, "Time [s],Fx [N],Fz [N]", TIME, force, load)
    told = warpwear.read_record(path, speed=SPEED, zero=True).numbers["warnings"]
    assert any("its largest value" in text for text in told)
    assert not any("without load" in text for text in told)


def test_other_coefficients_are_named(tmp_path: Path) -> None:
    header = "Time [s],COF effective value,Friction absolute integral,COF,Friction remark"
    path = record(tmp_path, header, TIME, COF / 1.5, COF / 1.51, COF, ["ok"] * ROWS)
    told = " ".join(warpwear.read_record(path, speed=SPEED).numbers["warnings"])
    assert re.search(
        r"the column 'COF', median 0\.5\d+; others look like coefficients: 'COF eff.*' 0\.3\d+, 'Fr", told
    )
    same = record(tmp_path, "Time [s],COF effective value,COF", TIME, 0.99 * COF, COF)
    assert "column" not in " ".join(warpwear.read_record(same, speed=SPEED).numbers["warnings"])


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("N mm", 1.0), ("N·m", 1e3)]
    + [
        pytest.param(unit, factor, marks=pytest.mark.slow)
        for unit, factor in (("Nmm", 1.0), ("Nm", 1e3), ("mNm", 1.0), ("N*cm", 10.0))
    ],
)
def test_a_torque_over_the_radius_is_the_friction_force(tmp_path: Path, unit: str, factor: float) -> None:
    path = record(
        tmp_path,
        f"Time [s],Torque [{unit}],Fz [N]",
        TIME,
        [f"{c * 60.0 / factor:.8f}" for c in COF],
        np.full(ROWS, 10.0),
    )
    read = warpwear.read_record(path, speed=SPEED, radius="6 mm")
    np.testing.assert_allclose(read.analysis.steps[0].course.cof, COF, atol=1e-6)
    with pytest.raises(
        InputError, match=r"gives the torque 'Torque \[.*\]' and no friction force: the radius"
    ):
        warpwear.read_record(path, speed=SPEED)


def test_frequency_and_stroke_are_a_speed(tmp_path: Path) -> None:
    ones = np.ones(ROWS)
    columns = "Time [s],Frequency [Hz],COF,Stroke [µm]"
    path = record(tmp_path, columns, TIME, 50.0 * ones, COF, 500.0 * ones)
    assert read_experiment(path).distance[-1] == pytest.approx(50.0 * (ROWS - 1))
    named = record(
        tmp_path, "Time [s],Stroke sliding speed average value current [m/s],COF", TIME, 0.05 * ones, COF
    )
    assert read_experiment(named).distance[-1] == pytest.approx(50.0 * (ROWS - 1))
    alone = record(tmp_path, "Time [s],Frequency [Hz],COF", TIME, 50.0 * ones, COF)
    assert read_experiment(alone, stroke=0.5).distance[-1] == pytest.approx(50.0 * (ROWS - 1))


def test_a_distance_counted_in_laps_or_cycles_is_one_of_these(tmp_path: Path) -> None:
    path = record(tmp_path, "Distance [laps],COF", TIME, COF)
    assert read_experiment(path, radius=5.0).distance[-1] == pytest.approx(10.0 * np.pi * (ROWS - 1))
    with pytest.raises(InputError, match="gives turns"):
        read_experiment(path)
    path = record(tmp_path, "Sliding distance (cycles),COF", TIME, COF)
    assert read_experiment(path, stroke=5.0).distance[-1] == pytest.approx(10.0 * (ROWS - 1))


def test_a_unit_given_by_hand_goes_before_the_headers(tmp_path: Path) -> None:
    path = record(tmp_path, "Distance [mm],COF", TIME, COF)
    found = read_experiment(path, columns="1 [m],2")
    assert found.distance[-1] == pytest.approx(1e3 * (ROWS - 1))
    assert found.notes[0].startswith("Columns: distance from 'Distance [mm], taken in m'")
    assert read_experiment(path, columns="Distance [mm],COF").distance[-1] == pytest.approx(ROWS - 1)


def test_a_time_that_falls_is_told(tmp_path: Path) -> None:
    time = [str(k - 30 * (k > 200)) for k in range(ROWS)]
    path = record(tmp_path, "Time [s],Speed [mm/s],COF", time, np.full(ROWS, 50.0), COF)
    found = read_experiment(path)
    assert found.distance[-1] == pytest.approx(50.0 * (ROWS - 2))
    assert any("The time falls back at 1 rows, first at row 202: no distance" in note for note in found.notes)


@pytest.mark.parametrize("cut", [1, 3, 7, 8])
@pytest.mark.parametrize("sign", [",", ";", "\t", " "])
def test_a_last_row_that_was_cut_is_left_out(tmp_path: Path, cut: int, sign: str) -> None:
    whole = record(
        tmp_path,
        "Time [s],COF,Load [N]".replace(",", sign if sign != " " else "  "),
        TIME,
        COF,
        10.0 + COF,
        sign=sign,
    )
    expected = read_experiment(whole, speed=50.0)
    whole.write_text(whole.read_text()[: -1 - cut])
    found = read_experiment(whole, speed=50.0)
    assert found.cof.tolist() == expected.cof[:-1].tolist()
    assert found.notes[0] == f"The last row, line {ROWS + 1}, is cut short and was left out."
    whole.write_text(record(tmp_path, "Time [s],COF", TIME, COF).read_text().removesuffix("\n"))
    assert read_experiment(whole, speed=50.0).cof.size == ROWS  # it only has no end


def test_many_equal_steps_are_steps(tmp_path: Path) -> None:
    step = [str(1 + k // 5000) for k in range(60 * 5000)]
    cof = 0.5 + 0.01 * np.random.default_rng(3).standard_normal(300000)
    path = record(tmp_path, "Step,Distance [mm],CoF", step, [str(k) for k in range(300000)], cof)
    read = warpwear.read_record(path)
    assert len(read.numbers["steps"]) == 60
    assert not read.numbers["steps_left_out"]


def test_coefficients_that_no_contact_has_are_refused(tmp_path: Path) -> None:
    path = record(tmp_path, "Distance [mm],CoF", TIME, [f"{1e-160 * c:.4g}" for c in COF])
    with pytest.raises(InputError, match=r"is 5\.\d*e-161 in the middle: nothing was measured"):
        warpwear.read_record(path)


def test_a_workbook_is_read(tmp_path: Path, failing: Callable[[str, Exception], None]) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.title = "About"
    book.active.append(["Operator", "Smith"])
    sheet = book.create_sheet("Data")
    sheet.append(["Test 5", None, None])
    sheet.append(["Time\n[s]", "COF", "Fn [N]"])
    for k, cof in enumerate(COF):
        sheet.append([k, round(float(cof), 4), None if k == 7 else 10.0])
    path = tmp_path / "record.xlsx"
    book.save(path)
    found = read_experiment(path, speed=50.0)
    np.testing.assert_allclose(found.cof, COF, atol=1e-4)
    assert found.notes[0] == "Sheet 'Data' of 2, the one with most rows."
    failing("pandas.read_excel", ImportError("Missing optional dependency 'openpyxl'."))
    with pytest.raises(InputError, match=r"needs pandas and openpyxl: pip install 'warpwear\[io\]'"):
        read_experiment(path)
    (tmp_path / "no.xlsx").write_text("Time,COF")
    with pytest.raises(InputError, match="no workbook that can be read"):
        read_experiment(tmp_path / "no.xlsx")


def test_what_no_record_wrote_stays(tmp_path: Path) -> None:
    """A user's figure and table beside a record, and the source itself, are there after it was written."""
    out = tmp_path / "out"
    out.mkdir()
    source = record(out, "Distance [mm],COF", TIME, COF)
    (out / "record.json").write_text("{}")
    (out / "course.svg").write_text("mine")
    content = source.read_text()
    read = warpwear.read_record(source)
    with pytest.warns(UserWarning, match="was not written by a run"):
        read.write(out, overwrite=True)
    assert (out / "course.svg").read_text() == "mine"
    kept = [path.read_text() for path in out.glob("record-*")]
    assert sorted(kept) == sorted([content, "{}"])
    with pytest.warns(UserWarning, match="course.svg was not written by a run"):  # not its own
        read.write(out, file_format="svg", overwrite=True)
    assert [path.read_text() for path in out.glob("course-*.svg")] == ["mine"]
    assert not (out / "course.png").exists()
    assert len(list(out.glob("record-*"))) == 2


def test_what_a_short_record_cannot_tell_is_not_called_none(tmp_path: Path) -> None:
    read = warpwear.read_record(record(tmp_path, "Distance [mm],COF", TIME[:12], COF[:12]))
    assert re.search(r"jump +not known: 20 means or more tell", read.text)
    assert read.numbers["level_changes_mm"] is None


def test_the_load_is_that_of_rows_under_load(tmp_path: Path) -> None:
    load = np.where(np.arange(ROWS) < 250, 0.01, 10.0)
    cof = np.where(load > 1.0, COF, 0.0)
    read = warpwear.read_record(record(tmp_path, "Time [s],COF,Load [N]", TIME, cof, load), speed=SPEED)
    assert read.numbers["load_N"] == 10.0


def test_help_names_the_makes_that_are_known() -> None:
    text = " ".join(CliRunner().invoke(commands, ["record", "--help"]).output.split())
    assert not [form.name for form in FORMATS if form.name not in text]


def test_a_further_column_beside_a_position_refuses_nothing(tmp_path: Path) -> None:
    """The header of a machine of a university, seven columns without a time; its units written in."""
    phase = 2.0 * np.pi * np.arange(2000) / 47.0
    force, position = 2.0 * np.sign(np.sin(phase)), 2000.0 * (1.0 - np.cos(phase))
    path = record(
        tmp_path, "Fx [N],Fy [N],Fz [N],x-Position [um]", force, force, force * 0.0 - 20.0, position
    )
    read = warpwear.read_record(path)
    assert read.numbers["load_N"] == 20.0
    assert read.analysis.steps[0].course.cof[:10] == pytest.approx(0.1)
