"""Rows of a report: one declaration, for people and for JSON."""

import json

import numpy as np
import pytest

from warpwear.results.report import Row, aligned, lines, record, shown, table, to_json

NAN = float("nan")
WORN = [
    Row("patch", "patch_mm", [0.38, 0.36], note="(along × across)"),
    Row("volume", "volume_mm3", 0.0070867, digits=5, error=("volume_error_mm3", 0.000354)),
    Row("K", "wear_mm3_per_Nm", 3.691e-4, error=("wear_error_mm3_per_Nm", None), scientific=True),
    Row("", "count", 3),
    Row("hardness", "hardness_MPa", None),
    Row("bearing", "bearing", [Row("Sk", "sk_um", 0.9122), Row("Smr1", "smr1_percent", 10.51, digits=3)]),
    Row("mean", "", [Row("below", "below_um2", 1997.8), Row("above", "above_um2", 0.9)]),
    Row("", "by_axis", [Row("x", "x", [Row("Ra", "ra_um", 0.3)]), Row("notes", "", ["one", "two"])]),
    Row("warning", "warnings", ["first", "second"]),
]


def test_lines_name_every_number_with_its_unit() -> None:
    assert lines(WORN) == [
        "  patch            0.38 × 0.36 mm (along × across)",
        "  volume           0.00709 ± 0.00035 mm³",
        "  K                3.691e-4 mm³/(N·m)",
        "  bearing          Sk 0.9122 µm, Smr1 10.5 %",
        "  mean             below 1998 µm², above 0.9 µm²",
        "  x                Ra 0.3 µm",
        "  notes            one",
        "                   two",
        "  warning          first",
        "                   second",
    ]


def test_a_record_keeps_keys_and_values() -> None:
    assert record(WORN) == {
        "patch_mm": [0.38, 0.36],
        "volume_mm3": 0.0070867,
        "volume_error_mm3": 0.000354,
        "wear_mm3_per_Nm": 3.691e-4,
        "wear_error_mm3_per_Nm": None,
        "count": 3,
        "hardness_MPa": None,
        "bearing": {"sk_um": 0.9122, "smr1_percent": 10.51},
        "below_um2": 1997.8,
        "above_um2": 0.9,
        "by_axis": {"x": {"ra_um": 0.3}},
        "warnings": ["first", "second"],
    }
    tests = record(
        [Row("", "tests", [[Row("", "a", 1)], [Row("", "a", 2)]]), Row("", "by", {"b": WORN[3:4]})]
    )
    assert tests == {"tests": [{"a": 1}, {"a": 2}], "by": {"b": {"count": 3}}}


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("sk_um", "µm"),
        ("volume_mm3", "mm³"),
        ("k_mm3_per_Nm", "mm³/(N·m)"),
        ("steps", ""),
        ("pv_MPa_m_per_s", "MPa·m/s"),
    ],
)
def test_the_end_of_a_key_is_its_unit(key: str, unit: str) -> None:
    assert Row("", key, 1.0).units == unit
    assert Row("", key, 1.0, unit="GPa").units == "GPa"


def test_values_for_people() -> None:
    assert [shown(v) for v in (0.123456, 7, None, "text", {"mean": 3.0, "max": None})] == [
        "0.1235",
        "7",
        "–",
        "text",
        "mean 3, max –",
    ]
    assert shown(np.float64(0.5)) == "0.5"
    assert Row("", "a_mm", 0.0, error=("e", 0.0)).text == "0 ± 0 mm"
    assert Row("", "", "end", note=", or not").text == "end, or not"


def test_tables_are_aligned_under_labels_and_units() -> None:
    groups = [
        [Row("speed", "speed_mm_per_min", speed), Row("", "hidden", 1), Row("power", "power_W", 0.1 * speed)]
        for speed in (10.0, 100.0)
    ]
    assert table(groups) == [
        "  speed, mm/min  power, W",
        "  10                    1",
        "  100                  10",
    ]
    assert aligned([["", "a"], ["long", "1.5"]]) == ["        a", "long  1.5"]


def test_json_has_no_word_for_what_is_not_finite() -> None:
    content = {"a": NAN, "b": [1.0, float("inf")], "c": (np.float64("nan"), "µ")}
    assert json.loads(to_json(content)) == {"a": None, "b": [1.0, None], "c": [None, "µ"]}
    assert "µ" in to_json(content)
