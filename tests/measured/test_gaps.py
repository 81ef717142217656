"""Records in which a logger missed samples: their rows are left out, and all others keep their distance."""

import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_records import RECORDS, ROWS, cetr, raw, written
from numpy.testing import assert_allclose

from warpwear.cli.record import describe
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.course import read_experiment
from warpwear.measured.rows import read_rows

SIZE = 400
TIME = 0.25 * np.arange(SIZE)
COF = np.round(0.2 + 0.4 / (1.0 + np.exp(-(TIME - 60.0) / 2.0)), 6)
#: A record by every column that distance or friction can be made of; the speed changes along straight lines.
SPEED = 5.0 + 0.01 * np.arange(SIZE)
SLID = 5.0 * TIME + 0.5 * 0.04 * TIME**2
TABLE = {
    "Time [s]": TIME,
    "Speed [mm/s]": SPEED,
    "Speed [rpm]": SPEED * 60.0 / (10.0 * np.pi),
    "Laps": SLID / (10.0 * np.pi),
    "Radius [mm]": np.full(SIZE, 5.0),
    "Distance [mm]": SLID,
    "Cycle": SLID / 20.0,
    "CoF": COF,
    "Fx [N]": 8.0 * COF,
    "Fz [N]": np.full(SIZE, 8.0),
}
WAYS: list[tuple[tuple[str, ...], dict[str, Any]]] = [
    (("Time [s]", "Speed [mm/s]"), {}),
    (("Time [s]", "Speed [rpm]"), {"radius": 5.0}),
    (("Laps",), {"radius": 5.0}),
    (("Laps", "Radius [mm]"), {}),
    (("Distance [mm]",), {}),
    (("Cycle",), {"stroke": 10.0}),
]
PLACES = {"beginning": [0], "middle": [100], "together": [200, 201, 202], "end": [398, 399]}


def table(
    folder: Path, columns: dict[str, FloatArray], gaps: dict[str, Iterable[int]], word: str = ""
) -> Path:
    """Write a record with gaps, title -> rows of them."""
    cells = {title: [repr(float(value)) for value in values] for title, values in columns.items()}
    for title, rows in gaps.items():
        for row in rows:
            cells[title][row] = word
    path = folder / "record.csv"
    lines = [",".join(row) for row in zip(*cells.values(), strict=True)]
    path.write_text("\n".join([",".join(cells), *lines, ""]))
    return path


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("way", "options"), WAYS)
def test_a_gap_in_any_column_costs_its_rows_alone(
    way: tuple[str, ...], options: dict[str, Any], place: str, tmp_path: Path
) -> None:
    rows = PLACES[place]
    kept = np.delete(np.arange(SIZE), rows)
    for friction in (("CoF",), ("Fx [N]", "Fz [N]")):
        columns = {title: TABLE[title] for title in (*way, *friction)}
        for gapped in [(title,) for title in columns] + [tuple(columns)]:
            found = read_experiment(table(tmp_path, columns, dict.fromkeys(gapped, rows)), **options)
            # A sum over speeds begins with the first of them.
            from_first = (
                len(way) > 1 and set(way) & set(gapped) and place == "beginning" and "Laps" not in way
            )
            slid = SLID[kept] - (SLID[kept[0]] if from_first else 0.0)
            assert_allclose(found.distance, slid, atol=1e-6)
            assert_allclose(found.cof, COF[kept], rtol=1e-12)
            if gapped != tuple(columns) or place != "beginning":  # an empty line below the header is no row
                assert found.notes[0] == f"Rows with gaps, left out: {len(rows)} of {SIZE}."
            assert not found.warnings


@pytest.mark.parametrize("word", ["", "NaN", "---", "#N/A", "inf", "n/a"])
def test_a_gap_in_the_first_row_or_another_has_many_words(word: str, tmp_path: Path) -> None:
    columns = {title: TABLE[title] for title in ("Time [s]", "Speed [mm/s]", "CoF")}
    for gapped in ([], ["Time [s]"], ["Speed [mm/s]"], ["Time [s]", "Speed [mm/s]"], ["Time [s]", "CoF"]):
        found = read_experiment(table(tmp_path, columns, {title: [0, 7] for title in gapped}, word))
        assert found.cof.tolist() == (np.delete(COF, [0, 7]) if gapped else COF).tolist()


def test_the_steady_value_is_that_of_the_whole_record(tmp_path: Path) -> None:
    pytest.importorskip("ruptures")
    noisy = COF + 0.01 * np.random.default_rng(1).standard_normal(SIZE)
    columns = {"Time [s]": TIME, "Speed [mm/s]": np.full(SIZE, 5.0), "CoF": noisy}
    for title in columns:
        found = json.loads(describe([table(tmp_path, columns, {title: [100]})], as_json=True))
        assert found["steady_cof"] == pytest.approx(0.6, abs=0.003)
        assert found["distance_mm"] == pytest.approx(5.0 * TIME[-1])


def test_where_more_than_a_tenth_has_gaps_it_is_told_first(tmp_path: Path) -> None:
    pytest.importorskip("ruptures")
    columns = {title: TABLE[title] for title in ("Time [s]", "Speed [mm/s]", "Fx [N]", "Fz [N]")}
    gaps: dict[str, Iterable[int]] = {"Speed [mm/s]": range(100, 130), "Fz [N]": range(120, 141)}
    path = table(tmp_path, columns, gaps)
    said = "41 of 400 rows (10%) have gaps and were left out: what happened in them is not known."
    found = read_experiment(path, load=7.0)  # another warning
    assert found.notes[0] == "Rows with gaps, left out: 41 of 400."
    assert found.warnings[0] == f"Warning: {said}"
    assert len(found.warnings) == 2
    content = json.loads(describe([path], as_json=True, load="7 N"))
    assert content["warnings"][0] == said
    assert content["notes"][0] == found.notes[0]
    told = describe([path], load="7 N", out=tmp_path / "out").partition("  warning")[2]
    assert told.strip().startswith(said)
    gaps["Fz [N]"] = range(120, 140)
    assert len(read_experiment(table(tmp_path, columns, gaps), load=7.0).warnings) == 1


def test_time_at_rest_is_no_distance(tmp_path: Path) -> None:
    speed = np.where((TIME > 40.0) & (TIME < 60.0), 0.0, 5.0)
    columns = {"Time [s]": TIME, "Speed [mm/s]": speed, "CoF": COF}
    for gap in ([], [100], [200], [300]):
        found = read_experiment(table(tmp_path, columns, {"Speed [mm/s]": gap}))
        assert found.distance[-1] == pytest.approx(5.0 * (TIME[-1] - 19.75), abs=1e-6)


@pytest.mark.parametrize("column", [1, 2, 7])  # the time of a step, its number, the laps of the record
@pytest.mark.parametrize("row", [0, ROWS - 1, ROWS, ROWS + 1, 2 * ROWS - 1])
def test_a_gap_where_a_step_begins_does_not_hide_it(row: int, column: int, tmp_path: Path) -> None:
    path = tmp_path / "rtec.csv"
    make, options = RECORDS["rtec.csv"]
    path.write_bytes(written(make()))
    whole = read_experiment(path, **options)
    time = read_rows(path).table["time"]
    lines = written(make()).decode().split("\n")
    first = next(number for number, line in enumerate(lines) if line.startswith("4,"))
    fields = lines[first + row].split(",")
    fields[column] = "NaN"
    lines[first + row] = ",".join(fields)
    path.write_text("\n".join(lines))
    rows, found = read_rows(path), read_experiment(path, **options)
    assert rows.steps == ("4", "7")
    kept = np.isfinite(rows.table["time"])
    assert_allclose(rows.table["time"][kept], time[kept], atol=0.1 + 1e-9)
    left = found.distance.size == 2 * ROWS - 1
    assert left == (column != 1)  # time makes no distance here
    if left:  # a turn that is missed where the radius changes is of either
        atol = 3.0 * 0.2 * 2.0 * np.pi if row == ROWS - 1 else 0.0
        assert_allclose(found.distance, np.delete(whole.distance, row), rtol=1e-9, atol=atol + 1e-9)


def test_numbers_of_steps_that_stand_in_their_first_row_are_of_all_its_rows(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = [f"{k % 9},{k},0.3,{4 + k // 9 if k % 9 == 0 else ''}" for k in range(18)]
    path.write_text("\n".join(["Time (s),Distance (mm),COF,Step", *rows, ""]))
    found = read_rows(path)
    assert (found.steps, found.step.tolist()) == (("4", "5"), [0] * 9 + [1] * 9)
    assert read_experiment(path).cof.size == 18


@pytest.mark.parametrize("columns", [(0,), (1,), (2,), (0, 1, 2)])
@pytest.mark.parametrize("passes", [(3.01, 3.015), (4.7, 5.3), (6.2, 8.4), (6.2, 12.5), (23.7, 24.0)])
def test_cycles_in_a_gap_are_counted(
    passes: tuple[float, float], columns: tuple[int, ...], tmp_path: Path
) -> None:
    """Forces or positions that are missing over more than a cycle do not shorten the distance behind it."""
    slid, *values = raw(samples=200)
    gap = (slid >= passes[0]) & (slid < passes[1])
    for column in columns:
        values[column][gap] = np.nan
    path = tmp_path / "raw.txt"
    np.savetxt(
        path, np.column_stack(values), "%.6f", ";", header="Fx (N);Fz (N);X position (mm)", comments=""
    )
    found = read_experiment(path)
    assert found.cycles is not None
    assert_allclose(found.distance, 30.0 * (2.0 * found.cycles - 1.0), atol=0.2)
    assert_allclose(found.cof, 0.3 + 0.01 * (2.0 * found.cycles - 1.0), atol=0.003)
    whole_cycles = 12 - (1 if passes[0] == 6.2 else 0) - (2 if passes[1] == 12.5 else 0)
    assert found.cof.size in (whole_cycles, whole_cycles - (passes[0] > 23.0 and 2 in columns))


@pytest.mark.parametrize("missing", [(0,), (5,), (7, 8), (19,)])
def test_strokes_of_gaps_alone_do_not_turn_the_others_around(
    missing: tuple[int, ...], tmp_path: Path
) -> None:
    for number in range(1, 11):
        lines, stroke = cetr(number).split("\r\n"), 2 * number - 3
        for at, line in enumerate(lines):
            stroke += line.startswith("Step No.")
            if stroke in missing and re.match(r"-?\d.*,", line):
                lines[at] = "nan," + line.partition(",")[2]
        (tmp_path / f"wear_{number}.csv").write_text("\r\n".join(lines))
    left = sorted({number // 2 for number in missing})
    for options in ({"stroke": 8.0}, {"speed": 10.0}):
        found = read_experiment(tmp_path, **options)
        assert_allclose(found.cycles, np.delete(np.arange(1.0, 11.0), left))
        assert_allclose(found.cof, np.delete(0.3 + 0.001 * np.arange(1.0, 11.0), left), rtol=1e-5)
        pitch = (found.distance[-1] - found.distance[0]) / (found.cycles[-1] - found.cycles[0])
        assert pitch == pytest.approx(16.0, rel=1e-9 if "stroke" in options else 0.02)


def test_a_gap_changes_no_decision_about_other_columns(tmp_path: Path) -> None:
    slips = SLID - 5.0 * (np.arange(SIZE) == 150)
    columns = {"Time [s]": TIME, "Distance [mm]": slips, "CoF": COF}
    for gaps in ({"Time [s]": [90]}, {"Distance [mm]": [90]}, {"Distance [mm]": [0, 399]}):
        found = read_experiment(table(tmp_path, columns, gaps))
        assert any("falls back at 1 rows" in note for note in found.notes)
        assert found.distance[-1] == (slips[398] if 399 in gaps.get("Distance [mm]", []) else slips[399])
    path = table(tmp_path, {"Laps": TABLE["Laps"], "Distance [mm]": SLID, "CoF": COF}, {"Laps": [9]})
    pytest.importorskip("ruptures")
    assert json.loads(describe([path], as_json=True))["distance_laps"] == pytest.approx(TABLE["Laps"][-1])
    empty = {"Distance [mm]": SLID, "Fz [N]": TABLE["Fz [N]"], "CoF": COF}
    path = table(tmp_path, empty, {"Fz [N]": range(SIZE)})
    assert json.loads(describe([path], as_json=True, load="3 N"))["load_N"] == 3.0
    path.write_text("Distance [mm],CoF,CoF\n1,0.1,0.1\n2,,\n3,0.2,0.2\n")
    assert read_experiment(path).cof.tolist() == [0.1, 0.2]
    path.write_text("Distance [mm],Speed [mm/s],CoF\n1,,\n2,1,0.2\n")
    with pytest.raises(InputError, match="rows with all values: 1; two or more"):
        read_experiment(path)
