"""The table of materials: numbers against their sources' hardness numbers, names in every spelling."""

import re
import tomllib
from importlib.resources import files

import pytest

import warpwear
from warpwear.study.materials import material, names

#: Given in GPa by their sources, not as a hardness number.
IN_GPA = {"alumina", "silicon nitride", "zirconia 3Y-TZP", "DLC a-C:H"}
#: Whose hardness is that of a ball's indentation.
POLYMERS = {"PTFE", "PEEK", "UHMWPE"}
INSULATORS = POLYMERS | IN_GPA


@pytest.mark.parametrize("name", names())
def test_every_number_has_a_source_and_is_possible(name: str) -> None:
    known = material(name)
    assert known.name == name
    assert known.condition
    numbers = {"young", "poisson", "hardness", "conductivity", "heat_capacity", "density"}
    assert set(known.sources) == numbers | ({"resistivity"} if name not in INSULATORS else set())
    assert {key for key in vars(known) if getattr(known, key) is not None} >= known.sources.keys()
    assert all(len(source) > 10 for source in known.sources.values())
    assert (5e2 if name in POLYMERS else 5e4) < known.young < 7e5
    assert 0.2 < known.poisson < (0.5 if name in POLYMERS else 0.35)
    # The least and the most that H/E is among metals and ceramics, and beyond them.
    assert 0.005 < known.hardness / known.young < (0.06 if name not in INSULATORS - {"alumina"} else 0.13)
    # A mole of atoms stores 3 R at most: ρ c of all solids is of one order.
    assert known.density is not None
    assert known.heat_capacity is not None
    assert known.conductivity is not None
    assert 1.5e6 < known.density * known.heat_capacity < 4.5e6
    assert known.resistivity is None or 2e-8 < known.resistivity < 2e-6
    if known.resistivity is not None:  # Wiedemann and Franz: electrons, and lattice or graphite beside them
        assert 0.4 < known.conductivity * known.resistivity / (2.44e-8 * 293.0) < 6.0


@pytest.mark.parametrize("name", sorted(set(names()) - IN_GPA - POLYMERS))
def test_hardness_is_its_sources_number_as_a_pressure(name: str) -> None:
    known = material(name)
    number = re.search(r"(\d+) H[VB]\b", known.sources["hardness"])
    assert number is not None
    assert known.hardness == pytest.approx(9.807 * float(number[1]), rel=3e-3)


def test_the_pair_of_the_thesis() -> None:
    steel, nickel = material("AISI 304"), material("Inconel 718")
    compliance = sum((1.0 - known.poisson**2) / known.young for known in (steel, nickel))
    assert 1.0 / compliance == pytest.approx(1.0724e5, rel=1e-4)  # E* [MPa]
    assert 1500.0 <= steel.hardness <= 2000.0
    assert 0.5 * steel.young / (1.0 + steel.poisson) == pytest.approx(74806.2, rel=1e-6)  # G [MPa]


@pytest.mark.parametrize(
    ("spelling", "name"),
    [
        ("304", "AISI 304"),
        ("aisi-304", "AISI 304"),
        ("SS 304", "AISI 304"),
        ("EN 1.4301", "AISI 304"),
        ("UNS S31600", "AISI 316"),
        ("inconel718", "Inconel 718"),
        ("W.-Nr. 2.4668", "Inconel 718"),
        ("Alloy 600", "Inconel 600"),
        ("100Cr6", "AISI 52100"),
        ("SAE 52100", "AISI 52100"),
        ("EN31", "AISI 52100"),
        ("Ck 45", "AISI 1045"),
        ("Al₂O₃", "alumina"),
        ("SI3N4", "silicon nitride"),
        ("ti6al4v", "Ti-6Al-4V"),
        ("WC", "tungsten carbide WC-6Co"),
    ],
)
def test_spellings(spelling: str, name: str) -> None:
    assert material(spelling).name == name


@pytest.mark.parametrize(
    ("given", "near"),
    [("AISI 305", "AISI 304"), ("304L", "AISI 304"), ("Incnel 718", "Inconel 718"), ("alumnia", "alumina")],
)
def test_a_name_that_is_near_is_suggested_and_not_taken(given: str, near: str) -> None:
    with pytest.raises(
        ValueError, match=f"^no material '{given}' is known \\(did you mean '{near}'\\?\\); allowed: "
    ):
        material(given)


@pytest.mark.parametrize("given", ["", "??", "Inconel 304", "AISI", "unobtainium"])
def test_a_name_of_nothing_is_refused_with_all_that_is_allowed(given: str) -> None:
    with pytest.raises(ValueError, match="allowed: ") as refused:
        material(given)
    assert all(name in str(refused.value) for name in names())


def test_the_list_has_each_number_with_its_unit_and_source() -> None:
    told = str(warpwear.materials())
    for line in (
        "conductivity 16.2 W/m/K",
        "density 8000 kg/m^3",
        "resistivity 7.2e-07 ohm*m",
        "poisson 0.29",
    ):
        assert f"\n    {line}: " in told


def test_no_alias_means_two_materials() -> None:
    rows = tomllib.loads((files("warpwear") / "materials.toml").read_text(encoding="utf-8"))["material"]
    for row in rows:
        for alias in (row["name"], *row["aliases"]):
            assert material(alias).name == row["name"], alias
