"""A study is read, completed and said back: what is assumed, what follows, what does not apply."""

import re
import tomllib
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

from warpwear import Study
from warpwear.study.keys import declarations
from warpwear.study.loading import presets


@pytest.mark.parametrize("name", presets())
def test_presets_come_back_from_their_own_text(name: str) -> None:
    study = Study.load(name)
    again = Study(**tomllib.loads(study.to_toml()))
    assert again.model_dump(exclude={"assumed"}) == study.model_dump(exclude={"assumed"})
    assert again.assumptions == study.assumptions
    assert study.study.name == name
    step = [notice for notice in study.notices() if "the area in contact depends on its length" in notice]
    assert study.notices() == step
    assert len(step) == (name == "track")


def test_the_presets_are_the_thesis() -> None:
    v3, fine = Study.load("v3"), Study.load("v3-fine")
    assert (v3.cells.nx, v3.load_tolerance, v3.increments) == (150, 0.5, (0.3, 1.0, 0.3))
    assert (v3.stepping.scheme, v3.wear.distance_factor, v3.friction.area) == (
        "explicit",
        "across",
        "cumulative",
    )
    assert (fine.cells.nx, fine.increments) == (1500, (0.003, 1.02, 3.0))
    assert (fine.stepping.scheme, fine.wear.distance_factor, fine.friction.area) == (
        "implicit",
        "none",
        "contact",
    )
    assert fine.load_tolerance == pytest.approx(590e-6)
    for study in (v3, fine):
        assert study.wear_coefficients == pytest.approx((9.4e-7, 12.7e-7))
        assert study.sliding.total == 2400.0
        assert study.friction.shear_strength == 3.83


def test_show_marks_what_the_thesis_does_not_give() -> None:
    shown = Study.load("v3").to_toml(marked=True)
    assert re.search(r'^hardness = "590 MPa" +# ASSUMED: not in the thesis', shown, re.MULTILINE)
    assert re.search(r'^stiffness = "inf N/mm\^3" +# ASSUMED', shown, re.MULTILINE)
    assert re.search(r'^load = "8 N"$', shown, re.MULTILINE)
    assert re.search(r'^ra = "3 um"$', shown, re.MULTILINE)
    assert "feed" not in shown  # a milled surface's key does not apply
    assert tomllib.loads(shown)["contact"]["load"] == "8 N"  # marks are comments: the text is a study
    # What a user sets is no longer assumed.
    given = Study.load("v3").replace({"contact.hardness": "1800 MPa"})
    assert "contact.hardness" in Study.load("v3").assumptions
    assert "contact.hardness" not in given.assumptions


def test_replacing_one_way_of_saying_drops_the_other() -> None:
    fine = Study.load("v3-fine")
    assert fine.replace({"counter.diameter": "8 mm"}).counter.form.curvature == 0.25
    assert fine.replace({"stepping.increment": "0.3 mm"}).increments == (0.3, 1.0, 0.3)
    assert fine.replace(sliding={"passes": 2}).sliding.total == 60.0
    assert fine.replace({"disc.surface": "a.sur"}).disc.synthetic is None
    lower = fine.replace({"disc.synthetic.sq": "1 um"}).disc.synthetic
    assert lower is not None
    assert (lower.ra, lower.sq) == (None, pytest.approx(1e-3))
    assert fine.counter.radius == 3.0  # the original is untouched


def test_keys_that_do_not_apply_are_noticed() -> None:
    flat = Study.load("v3").replace({"disc.synthetic.kind": "flat"})
    assert any(re.match(r"disc\.synthetic\.ra.* do not apply to kind = 'flat'\.", n) for n in flat.notices())
    assert "feed" not in flat.to_toml()
    short = Study.load("v3").replace({"sliding.distance": "30 mm"})
    assert short.notices() == ["output.snapshots that no step ends at: 240, 600, 1200, 2400 mm."]


def test_every_rule_asks_for_what_a_study_has() -> None:
    """A rule whose key or property is misspelt would never let its key be used."""
    study = Study.load("v3")
    for key, declared in declarations(Study).items():
        for rule in declared.applies:
            attrgetter(rule.name)(study)
            assert rule.otherwise.startswith("does not apply"), key


def test_a_rough_study_becomes_a_smooth_one() -> None:
    macro = Study.load("v3-fine").replace({"study.model": "macro", "counter.material": "inconel718"})
    assert macro.counter.material == "Inconel 718"
    assert macro.study.model == "macro"
    assert "synthetic" not in macro.to_toml()
    told = [n for n in macro.notices() if "smooth disc" in n]
    assert len(told) == 1
    assert "disc.synthetic.ra" in told[0]


def test_a_material_fills_what_is_not_given() -> None:
    v1 = Study.load("v1")
    assert v1.counter.elastic == (200e3, 0.29)
    assert v1.disc.elastic == (193e3, 0.29)
    assert v1.hertz is not None
    # E* = 1.072e5 MPa: radius 55.2 µm, peak 1255 MPa, approach 1.014 µm, area 0.00956 mm².
    assert v1.hertz.modulus == pytest.approx(1.072e5, rel=1e-3)
    assert v1.hertz.radius == pytest.approx(0.0552, rel=1e-3)
    assert v1.hertz.peak_pressure == pytest.approx(1255.0, rel=1e-3)
    assert v1.hertz.approach == pytest.approx(1.014e-3, rel=1e-3)
    assert v1.hertz.area == pytest.approx(0.00956, rel=1e-3)
    assert "Inconel 718" in v1.assumptions["counter.young"]
    given = v1.replace({"counter.young": "210 GPa"})
    assert given.counter.elastic == (210e3, 0.29)
    assert "counter.young" not in given.assumptions
    # Another material brings its own constants, also into what was read back from a resolved text.
    back = Study(**tomllib.loads(given.to_toml())).replace({"counter.material": "alumina"})
    assert back.counter.elastic == Study.load("v1").replace({"counter.material": "Al2O3"}).counter.elastic


def test_the_macro_model_has_a_cell_of_its_own_and_no_cap() -> None:
    sections = tomllib.loads(Study.load("v1").to_toml())
    del sections["grid"]["cell"], sections["assumed"]
    study = Study(**sections)
    assert study.grid.cell == pytest.approx(0.01)
    assert study.hardness == float("inf")
    assert re.search(r'^cell = "10 um" +# default', study.to_toml(marked=True), re.MULTILINE)
    assert study.replace({"contact.hardness": "590 MPa"}).hardness == pytest.approx(590.0)


@pytest.mark.parametrize(
    ("match", "constant"),
    [("area", 16.0 / (3.0 * np.pi)), ("pressure", 3.0 / np.pi), ("approach", 4.0 / (3.0 * np.pi))],
)
def test_foundations_match_one_of_hertz_values(match: str, constant: float) -> None:
    """π K_N R δ² = F: the area 2πRδ, the peak K_N δ or the approach δ itself is Hertz's."""
    study = Study.load("v1").replace({"contact.bulk_stiffness": match, "stepping.scheme": "implicit"})
    assert study.hertz is not None
    stiffness = study.pair.stiffness
    assert stiffness == pytest.approx(constant * study.hertz.modulus / study.hertz.radius, rel=1e-12)
    delta = np.sqrt(8.0 / (np.pi * stiffness * 3.0))
    found = {"area": 2.0 * np.pi * 3.0 * delta, "pressure": stiffness * delta, "approach": delta}
    expected = {
        "area": study.hertz.area,
        "pressure": study.hertz.peak_pressure,
        "approach": study.hertz.approach,
    }
    assert found[match] == pytest.approx(expected[match], rel=1e-12)


def test_wear_coefficients_in_every_unit() -> None:
    study = Study.load("v3")
    for text in ("9.4e-4 mm^3/N/m", "9.4e-4 mm**3/(N*m)", "9.4e-13 m^2/N", "9.4e-13 / Pa"):
        assert study.replace({"wear.counter": text}).wear_coefficients[0] == pytest.approx(9.4e-7)
    # A bare number is Archard's k of V = k F L / H.
    assert study.replace({"wear.counter": 5.546e-4}).wear_coefficients[0] == pytest.approx(9.4e-7)


def test_sliding_in_every_way() -> None:
    study = Study.load("v3").replace({"sliding.stroke": "30 mm"})
    for way in (
        {"sliding.passes": 80},
        {"sliding.cycles": 40},
        {"sliding.duration": "40 min", "sliding.frequency": "1 / min"},
        {"sliding.duration": "40 min", "sliding.frequency": "1 rpm"},
    ):
        assert study.replace(way).sliding.total == pytest.approx(2400.0)


def test_the_hardness_defaults_to_the_softer_body() -> None:
    softer = Study.load("v3").replace(
        contact={"load": "8 N"}, counter={"hardness": "3 GPa"}, disc={"hardness": "1.8 GPa"}
    )
    nested = softer.model_dump(exclude_unset=True)
    del nested["contact"]["hardness"]
    assert Study(**nested).hardness == pytest.approx(1800.0)
    assert re.search(r'^hardness = "1800 MPa" ', Study(**nested).to_toml(marked=True), re.MULTILINE)


def test_a_surface_is_relative_to_its_study(tmp_path: Path) -> None:
    text = Study.load("v3").replace({"disc.surface": "disc.npy"}).to_toml(marked=True)
    (tmp_path / "s.toml").write_text(text)
    assert Study.load(tmp_path / "s.toml").disc.surface == str(tmp_path.resolve() / "disc.npy")


def test_what_a_study_leaves_out_is_shown_as_assumed() -> None:
    nested = Study.load("v3-fine").model_dump(exclude_unset=True)
    for section in ("stepping", "friction", "assumed"):
        del nested[section]
    study = Study(**nested)
    assert study.increments == (0.003, 1.02, 3.0)
    longest = study.replace({"sliding.distance": "3600 m"})  # in as many steps as anyone waits for
    assert longest.increments == (0.003, 1.02, 4500.0)
    assert longest.resolved["stepping.largest"] == "4500.0 mm"
    assert longest.replace({"stepping.largest": "10 mm"}).increments[2] == 10.0
    assert {"stepping.first", "friction.coefficient", "contact.stiffness"} <= set(study.assumptions)
    shown = study.to_toml(marked=True)
    assert re.search(r"^coefficient = 0\.6 +# ASSUMED", shown, re.MULTILINE)
    assert re.search(r'^first = "3 um" +# ASSUMED', shown, re.MULTILINE)
    assert Study(**tomllib.loads(study.to_toml())).increments == study.increments


def test_what_is_shown_keeps_every_digit_that_counts() -> None:
    study = Study.load("v3-fine").replace({"grid.cell": f"{1.5 / 7001!r} mm"})
    assert Study(**tomllib.loads(study.to_toml(marked=True))).cells.nx == 7001


def test_a_description_tells_what_was_changed(tmp_path: Path) -> None:
    v1 = Study.load("v1")
    plain = v1.study.description
    as_it_is = {"contact.load": "8000 mN", "study.name": "other", "output.snapshots": []}
    assert v1.replace(as_it_is).study.description == plain
    changed = v1.replace({"wear.law": "exponential", "wear.decay": "0.01 1/m"}).replace(
        contact={"load": "4 N"}
    )
    assert changed.study.description == f"{plain}; changed: wear.law, wear.decay, contact.load"
    assert changed.replace({"contact.load": "5 N"}).study.description == changed.study.description
    (tmp_path / "changed.toml").write_text(changed.to_toml(), encoding="utf-8")
    read = Study.load(tmp_path / "changed.toml")
    assert read.study.description == changed.study.description
    more = read.replace({"grid.cell": "20 um", "sliding.distance": "240 mm"})
    listed = "wear.law, wear.decay, contact.load, grid.cell, sliding.distance"
    assert more.study.description == f"{plain}; changed: {listed}"
    assert more.replace({"sliding.distance": "120 mm"}).study.description == more.study.description
    assert v1.replace({"grid.cell": "20 um", "study.description": "mine"}).study.description == "mine"
    assert v1.replace({"study.description": "", "grid.cell": "20 um"}).study.description == ""


def test_patches_on_a_part_of_the_area_know_the_scar_to_a_macro_cell() -> None:
    some = {"grid.extent": "2.1 mm", "patches.macro_cell": "300 um", "patches.width": "100 um"}
    study = Study.load("two-scale").replace(some)
    (told,) = [notice for notice in study.notices() if notice.startswith("patches.width = 100 µm")]
    assert told.endswith("off by up to a macro cell on each side, and so is what follows from them.")
    assert Study.load("two-scale").notices() == []


def test_a_study_shows_itself_in_one_line() -> None:
    study, cells = Study.load("v3-fine"), "1500 × 1500 cells of 1 µm"
    told = f"<Study 'v3-fine': micro model, local law, stationary, {cells}, 8 N over 2400 mm>"
    assert repr(study) == str(study) == told


def test_a_notebook_shows_a_study_with_its_assumptions_marked() -> None:
    study = Study.load("v3-fine").replace({"study.description": "<script>alert(1)</script>"})
    html = study._repr_html_()
    assert html.count("# ASSUMED: ") == len(study.assumptions) == 22
    assert "\nshear_strength = " in html
    assert "<script" not in html
    assert repr(study).startswith("<Study 'v3-fine': micro model, local law")
