"""Verdicts on items of the thesis follow the numbers, and their reasons quote them."""

import json
from pathlib import Path

import jinja2.meta
import jinja2.nodes
import pytest
from coefficients import diameter_of_cap
from items import ALL_ITEMS, SUMMARY, Kind, Rule, as_printed, number
from printed import PATCH_DIAMETERS, WEAR_COEFFICIENTS
from report import judge, thesis_report

#: What the published studies give, to the digits that verdicts need.
NUMBERS = {
    "beyond.area_highest": 0.0,
    "beyond.area_last": -0.4296,
    "beyond.area_lowest": -0.5082,
    "beyond.area_mean": -0.3854,
    "beyond.depth_change": -2.896e-05,
    "beyond.increment_mm": 0.3,
    "beyond.limit_mm": 0.2742,
    "beyond.patch_change": 0.0,
    "beyond.volume_change": 2.887e-15,
    "closed_form_patch_mm": 1.264,
    "experiment.K_by_cap": 0.0003512,
    "experiment.K_by_ellipsoid": 0.000935,
    "experiment.K_over_cap": 2.677,
    "experiment.distance_by_strokes_mm": 2400.0,
    "experiment.groove_depth_um": 1.524,
    "experiment.patch_of_printed_K_mm": 1.022,
    "fine.area_first_over_F_H": 1.001,
    "fine.area_over_v1": 0.9925,
    "fine.exponent_m": 0.5071,
    "fine.levelling_lambda": 0.2378,
    "fine.pressure_end_MPa": 6.424,
    "implicit.largest_deviation": 1.186e-07,
    "surfaces": 3.0,
    "surfaces.bound_exceeded_mm": -0.0547,
    "surfaces.cell_mm": 0.01,
    "surfaces.disc_volume_over_v2_largest": 1.417e-05,
    "surfaces.disc_volume_over_v2_smallest": -3.452e-05,
    "surfaces.farthest_largest_mm": 1.343,
    "surfaces.farthest_smallest_mm": 1.338,
    "surfaces.patch_largest_mm": 1.32,
    "surfaces.patch_mean_mm": 1.305,
    "surfaces.patch_smallest_mm": 1.29,
    "surfaces.peak_asked_um": 11.9,
    "surfaces.peak_largest_um": 12.32,
    "surfaces.peak_smallest_um": 10.5,
    "surfaces.prediction_error_mm": 0.02,
    "v1.area_over_hertz": 1.297,
    "v1.area_touched_mm2": 1.255,
    "v1.cof_first_over_end": 0.009882,
    "v1.depth_exponent": 0.5017,
    "v1.disc_depth_um": 38.7,
    "v1.disc_volume_error": 6.061e-14,
    "v1.exponent_m": 0.497,
    "v1.levelling_lambda": 0.2447,
    "v1.mean_disc_depth_um": 19.56,
    "v1.patch_along_mm": 1.26,
    "v1.patch_by_depth_mm": 1.264,
    "v1.peak_over_hertz": 0.9879,
    "v1.pressure_fallen_early": 0.9615,
    "v1.pressure_unevenness": 2.299e-10,
    "v1.radius_grown_early": 0.4538,
    "v1.counter_pattern_um": 0.005653,
    "v1.counter_volume_error": -1.069e-13,
    "v1.volume_straightness_R2": 1.0,
    "v2.cof_change_end": -0.001275,
    "v2.cof_change_largest": 0.01246,
    "v2.disc_volume_change": -0.003728,
    "v2.edge_pressure_excess": 0.01277,
    "v2.edge_pressure_excess_expected": 0.01277,
    "v2.factor_at_edge": 0.9781,
    "v2.patch_by_depth_mm": 1.264,
    "v2.skewness_um": 0.09274,
    "v2.counter_change_um": 0.06193,
    "v2.counter_depth_change": -0.001075,
    "v2.counter_depth_um": 28.6,
    "v2.counter_volume_change": 9.548e-15,
    "v2.true_factor_at_edge": 0.1257,
    "v3.area_sum_mm2": 108.8,
    "v3.area_touched_mm2": 1.239,
    "v3.cof_over_v1": 86.73,
    "v3.disc_depth_um": 43.35,
    "v3.disc_volume_over_v1": -0.003714,
    "v3.disc_volume_over_v2": 1.417e-05,
    "v3.fewest_cells": 128.0,
    "v3.mean_disc_depth_um": 18.3,
    "v3.pressure_least_allowed_MPa": 555.3,
    "v3.pressure_most_allowed_MPa": 629.3,
    "v2.exponent_m": 0.4965,
    "v2.levelling_lambda": 0.2447,
    "v3.most_cells": 144.0,
    "v3.patch_along_mm": 1.31,
    "v3.pressure_largest_MPa": 625.0,
    "v3.pressure_scatter_MPa": 20.31,
    "v3.pressure_smallest_MPa": 555.6,
    "v3.pressures_within_printed": 0.2661,
    "v3.counter_pattern_um": 1.589,
    "v3.sum_over_worn_patch": 86.73,
    "v3.sum_straightness_R2": 1.0,
    "v3.touched_straightness_R2": 0.9588,
}


AGREES, DISAGREES, WRONG, UNKNOWN = Kind.AGREES, Kind.DISAGREES, Kind.WRONG, Kind.NOT_COMPARABLE


HOLDS, FAILS = Kind.HOLDS, Kind.FAILS


#: Item -> verdict on the numbers above, a number made wrong, verdict then.
CASES = {
    "table-3.4": (AGREES, {"experiment.distance_by_strokes_mm": 240.0}, DISAGREES),
    "table-4.1": (WRONG, {"experiment.K_over_cap": 1.0}, AGREES),
    "figure-4.17": (AGREES, {"v1.pressure_unevenness": 0.3}, DISAGREES),
    "figure-4.18": (AGREES, {"v1.pressure_fallen_early": 0.5}, DISAGREES),
    "figure-4.19": (AGREES, {"v1.depth_exponent": 1.0}, DISAGREES),
    "figure-4.20": (AGREES, {"v1.patch_by_depth_mm": 1.1}, DISAGREES),
    "figure-4.21": (AGREES, {"v1.disc_volume_error": 1e-6}, DISAGREES),
    "figure-4.22": (AGREES, {"v1.exponent_m": 1.0}, DISAGREES),
    "figure-4.24": (WRONG, {"v2.true_factor_at_edge": 0.97}, AGREES),
    "figure-4.25": (AGREES, {"v2.edge_pressure_excess": -0.01}, DISAGREES),
    "figure-4.26": (AGREES, {"v2.disc_volume_change": 0.01}, DISAGREES),
    "figure-4.27": (WRONG, {"v2.cof_change_largest": 0.3}, AGREES),
    "figure-4.28": (AGREES, {"v3.counter_pattern_um": 0.006}, DISAGREES),
    "figure-4.30": (DISAGREES, {"v3.pressure_smallest_MPa": 581.0, "v3.pressure_largest_MPa": 599.0}, AGREES),
    "figure-4.31": (WRONG, {"v3.mean_disc_depth_um": 25.0}, AGREES),
    "figure-4.32": (DISAGREES, {"surfaces.patch_largest_mm": 1.36}, AGREES),
    "figure-4.32-shape": (WRONG, {"v2.skewness_um": 3.0}, AGREES),
    "figure-4.33": (WRONG, {"v3.disc_volume_over_v2": 0.02}, AGREES),
    "figure-4.34": (AGREES, {"v3.cof_over_v1": 1.1}, DISAGREES),
    "figure-4.35": (WRONG, {"v1.disc_depth_um": 1.5}, AGREES),
    "figure-4.36": (WRONG, {"v1.patch_by_depth_mm": 0.81}, AGREES),
    "figure-A.8": (DISAGREES, {"v1.area_over_hertz": 1.0}, AGREES),
    "figure-A.9": (AGREES, {"v2.counter_depth_change": 0.1}, DISAGREES),
    "figure-A.10": (WRONG, {"v3.touched_straightness_R2": 0.9999}, AGREES),
    "volume": (HOLDS, {"surfaces.disc_volume_over_v2_largest": 0.01}, FAILS),
    "patch": (HOLDS, {"experiment.patch_of_printed_K_mm": 0.8}, FAILS),
    "line": (HOLDS, {"v3.sum_straightness_R2": 0.96}, FAILS),
    "cure": (HOLDS, {"fine.exponent_m": 1.0}, FAILS),
    "increments": (HOLDS, {"implicit.largest_deviation": 0.05}, FAILS),
    "stability": (HOLDS, {"beyond.area_mean": 0.0}, FAILS),
    "surfaces": (HOLDS, {"surfaces.prediction_error_mm": 0.2}, FAILS),
    # What no number of ours can decide; but a run that says nothing is told.
    "figure-4.29": (UNKNOWN, {}, UNKNOWN),
    "figure-4.37": (UNKNOWN, {}, UNKNOWN),
}


def test_every_item_has_a_case() -> None:
    assert set(CASES) == {item.id for item in ALL_ITEMS}


@pytest.mark.parametrize("name", CASES)
def test_a_verdict_follows_its_numbers(name: str) -> None:
    expected, wrong, then = CASES[name]
    assert judge(NUMBERS)[name].kind == expected
    assert judge(NUMBERS | wrong)[name].kind == then


@pytest.mark.parametrize(
    "mistake", ["{{ v1.patch | nearly }}", "{{ version_1 }}", "{{ printed.lode | number }}"]
)
def test_a_mistake_in_a_rule_is_an_error(mistake: str) -> None:
    with pytest.raises(jinja2.TemplateError):
        Rule(kind=Kind.AGREES, yes=mistake, no="").judge({"v1.patch": 1.0})


def test_a_rule_without_a_comparison_says_why() -> None:
    within = judge(NUMBERS | {"beyond.limit_mm": 0.4})["stability"]
    assert within.kind == UNKNOWN
    assert within.reason == "The increment of these studies is within the limit."


def test_a_number_that_no_run_gives_leaves_its_item_open() -> None:
    assert judge(NUMBERS | {"fine.exponent_m": float("nan")})["cure"].kind == UNKNOWN
    assert "fine.exponent_m" in judge(NUMBERS | {"fine.exponent_m": float("nan")})["cure"].reason
    assert judge({})["figure-4.33"].kind == UNKNOWN


def test_reasons_quote_the_numbers() -> None:
    reason = judge(NUMBERS | {"v2.edge_pressure_excess": 0.0119})["figure-4.25"].reason
    assert "1.2 % more" in reason
    assert "1.3 %" in reason  # the closed form


def test_a_patch_that_no_surface_reaches_does_not_agree() -> None:
    found = judge(NUMBERS)["figure-4.32"]
    assert "V1 and V2 agree" in found.reason
    assert "1.29 to 1.32 mm over 3 surfaces and do not reach the printed 1.37 mm" in found.reason
    assert "1.338 to 1.343 mm" in found.reason
    wide = judge(NUMBERS | {"v1.patch_by_depth_mm": 1.4})["figure-4.32"]
    assert (wide.kind, "do not both agree" in wide.reason) == (DISAGREES, True)


def test_a_line_of_the_summary_is_judged_by_its_own_numbers() -> None:
    found = {line.row.quantity: line.judge(NUMBERS | {"fine.patch_along_mm": 1.29}) for line in SUMMARY}
    assert {name: kind for name, kind in found.items() if kind is not None} == {
        "worn patch of the sphere, smooth: diameter": AGREES,
        "worn patch of the sphere, rough: along sliding": DISAGREES,
        "worn patch of the sphere, models beside the experiment": DISAGREES,
        "mean pressure of V3, smallest of all steps": DISAGREES,
        "mean pressure of V3, largest of all steps": DISAGREES,
    }
    smooth, rough = SUMMARY[:2]
    assert smooth.judge(NUMBERS | {"v2.patch_by_depth_mm": 1.24}) == DISAGREES
    assert rough.judge(NUMBERS | {"v3.patch_along_mm": 1.36}) == AGREES
    assert rough.judge({}) == UNKNOWN
    assert {line.item for line in SUMMARY} <= {item.id for item in ALL_ITEMS}


def test_numbers_for_people() -> None:
    assert [number(v) for v in (1.3, 0.018048, 2400.0, 3.5e-7, -0.5)] == [
        "1.30",
        "0.0180",
        "2400",
        "3.50·10⁻⁷",
        "−0.500",
    ]
    assert number(float("nan")) == "–"
    assert number(615.38) == "615"
    assert number(1856420.0) == "1860000"


def test_printed_numbers_look_as_printed() -> None:
    assert as_printed(PATCH_DIAMETERS["experiment"]) == "0.80"
    assert as_printed(WEAR_COEFFICIENTS["counter"], 1e4) == "9.4"


@pytest.mark.slow
def test_quick_report_of_the_published_studies(tmp_path: Path) -> None:
    thesis_report(tmp_path / "report", quick=True)
    content = json.loads((tmp_path / "report" / "numbers.json").read_text(encoding="utf-8"))
    n = content["numbers"]
    assert n["closed_form_patch_mm"] == pytest.approx(1.2642, abs=0.0001)
    assert n["paraboloid_patch_mm"] == pytest.approx(1.2690, abs=0.0001)
    for patch in ("v1.patch_along_mm", "v1.patch_by_area_mm", "v1.patch_by_depth_mm"):
        assert n[patch] == pytest.approx(1.264, abs=0.01)
    # The rim of a ball; a paraboloid's would be 7 µm wider.
    counter = diameter_of_cap(22.1e-7 * 8.0 * 2400.0, radius=3.0)
    assert n["v1.patch_by_depth_mm"] == pytest.approx(counter, abs=0.002)
    assert n["v1.counter_depth_um"] == pytest.approx(28.5, rel=0.01)
    assert n["v1.disc_depth_um"] == pytest.approx(38.6, rel=0.01)
    assert n["v1.counter_volume_mm3"] == pytest.approx(0.018048, rel=1e-10)
    assert n["v1.disc_volume_mm3"] == pytest.approx(0.024384, rel=1e-10)
    assert n["v1.exponent_m"] == pytest.approx(0.50, abs=0.01)
    assert n["v1.levelling_lambda"] == pytest.approx(0.25, abs=0.01)
    assert n["v2.disc_volume_change"] == pytest.approx(-0.0037, abs=0.0005)
    assert n["v2.edge_pressure_excess"] == pytest.approx(0.013, abs=0.001)
    assert n["implicit.largest_deviation"] < 0.01
    assert n["fine.exponent_m"] == pytest.approx(0.50, abs=0.02)
    assert n["fine.levelling_lambda"] == pytest.approx(0.24, abs=0.01)
    assert 0.115 < n["fine.area_30_mm2"] < 0.131
    assert n["fine.area_first_over_F_H"] == pytest.approx(1.0, abs=0.01)
    assert n["v3.area_sum_mm2"] == pytest.approx(108.8, rel=0.005)
    assert n["surfaces.patch_mean_mm"] == pytest.approx(1.37, rel=0.05)
    assert n["surfaces.prediction_error_mm"] < 0.04
    assert n["surfaces.bound_exceeded_mm"] < 0.01
    assert n["beyond.area_mean"] == pytest.approx(-0.39, abs=0.05)
    assert {item["id"]: item["verdict"] for item in content["items"]} == {
        name: expected.value for name, (expected, _, _) in CASES.items()
    }
    assert (tmp_path / "report" / "report.html").stat().st_size < 10e6
