"""What is taken as a quantity: text, a number with its unit, and quantities of pint from any registry."""

import tomllib
from typing import Any

import numpy as np
import pint
import pytest

from warpwear import InputError, Study
from warpwear.study.units import FACTORS, parse

REGISTRY = pint.UnitRegistry()
OTHER = pint.UnitRegistry(system="US")
OTHER.define("palm = 80 mm")

BASE = Study.load("v3-fine")


def value_of(study: Study, key: str) -> Any:
    found: Any = study
    for part in key.split("."):
        found = getattr(found, part)
    return found


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("contact.load", (8, "N"), 8.0),
        ("contact.load", [8, "N"], 8.0),
        ("contact.load", (np.float32(0.5), "N"), 0.5),
        ("contact.load", (np.int64(4), "N"), 4.0),
        ("contact.load", REGISTRY.Quantity(0.008, "kN"), 8.0),
        ("contact.load", OTHER.Quantity(1.0, "lbf"), 4.4482216152605),
        ("counter.radius", OTHER.Quantity(0.0375, "palm"), 3.0),
        ("counter.radius", (float("inf"), "mm"), float("inf")),
        ("contact.stiffness", (1e6, "N/mm^3"), 1e6),
        ("contact.bulk_stiffness", REGISTRY.Quantity(2e5, "N/mm^3"), 2e5),
        ("sliding.speed", 20 * REGISTRY.mm / REGISTRY.minute, 1.0 / 3.0),
        ("sliding.track", (3.2, "mm"), 3.2),
        ("sliding.frequency", "60 rpm", 1.0),
        ("sliding.frequency", (3, "turn/s"), 3.0),
        ("sliding.frequency", "2 cycle/s", 2.0),
        ("sliding.frequency", "1.5 rps", 1.5),
        ("sliding.frequency", 120 * OTHER.revolution / OTHER.minute, 2.0),
        ("sliding.frequency", REGISTRY.Quantity(2.0 * np.pi, "rad/s"), 1.0),
        ("sliding.frequency", "60 / min", 1.0),
        ("contact.hardness", "200 HV", 1961.33),
        ("contact.hardness", "200HV10", 1961.33),
        ("disc.hardness", (187, "HBW"), 187 * 9.80665),
        ("disc.hardness", "187 HBW 10/3000", 187 * 9.80665),
        ("counter.hardness", "200 kgf/mm2", 1961.33),
        ("contact.hardness", "590 N/mm2", 590.0),
        ("junctions.surface_energy", "2 J/m2", 2e-3),
        ("disc.synthetic.lay", "0.25 turn", 90.0),
        ("stepping.load_tolerance", (1, "mN"), 1e-3),
        ("wear.decay", REGISTRY.Quantity(0.1, "1/m"), 1e-4),
        ("junctions.surface_energy", (2, "J/m^2"), 2e-3),
        ("disc.synthetic.lay", REGISTRY.Quantity(np.pi / 4.0, "rad"), 45.0),
        ("output.snapshots", [(3, "mm"), "3 cm", REGISTRY.Quantity(0.3, "m")], (3.0, 30.0, 300.0)),
        ("output.snapshots", np.array([3.0, 30.0]) * REGISTRY.mm, (3.0, 30.0)),
        ("output.snapshots", [[3, "mm"]], (3.0,)),
        ("disc.crop", (1, "mm"), (1.0, 1.0)),
        ("disc.crop", [(1, "mm"), REGISTRY.Quantity(500.0, "um")], (1.0, 0.5)),
        ("disc.crop", np.array([0.0, 1.0, 0.5, 1.5]) * REGISTRY.mm, (0.0, 1.0, 0.5, 1.5)),
        ("disc.pixel", REGISTRY.Quantity(0.5, "um"), (5e-4, 5e-4)),
        ("disc.pixel", [(0.5, "um"), (0.6, "um")], (5e-4, 6e-4)),
    ],
)
def test_a_quantity_in_every_form(key: str, value: Any, expected: Any) -> None:
    study = BASE.replace({key: value})
    assert value_of(study, key) == pytest.approx(expected, rel=1e-12)
    section, _, last = key.rpartition(".")
    if "." not in section:
        assert value_of(BASE.replace(**{section: {last: value}}), key) == value_of(study, key)
    again = Study(**tomllib.loads(BASE.replace({key: value}).to_toml()))
    assert again.to_toml() == study.to_toml()


def test_wear_coefficients_as_quantities() -> None:
    written = (
        "mm^3/Nm",
        "mm³/N·m",
        "mm3/Nm",
        "mm³/(N·m)",
        "mm3/N⋅m",
        "mm³ N⁻¹ m⁻¹",
        "mm^3/N*m",
        "mm^3 / N / m",
    )
    for value in (
        *(f"9.4e-4 {unit}" for unit in written),
        (9.4e-4, "mm^3/N/m"),
        REGISTRY.Quantity(9.4e-13, "m^2/N"),
        OTHER.Quantity(9.4e-13, "1/Pa"),
    ):
        study = BASE.replace({"wear.counter": value})
        assert study.wear_coefficients[0] == pytest.approx(9.4e-7, rel=1e-12)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("contact.load", 8, r"contact\.load = 8: needs its unit: a force such as '8 N'\.$"),
        ("contact.load", np.float64(8.0), r"contact\.load = .*8\.0.*: needs its unit"),
        ("contact.load", (8, 9), r"contact\.load = \(8, 9\): needs its unit"),
        ("contact.load", ["8", "N"], r"contact\.load = \['8', 'N'\]: needs its unit"),
        ("contact.load", (True, "N"), r"contact\.load = \(True, 'N'\): needs its unit"),
        ("contact.load", (8, "mm"), r"contact\.load = \(8, 'mm'\): has the wrong dimension"),
        ("contact.load", "8 Nm", r"contact\.load = '8 Nm': has the wrong dimension"),
        ("contact.load", REGISTRY.Quantity(8.0), r"contact\.load = '8\.0.*': needs its unit: a force"),
        ("counter.radius", "3 mm*turn", r"counter\.radius = '3 mm\*turn': has the wrong dimension"),
        (
            "sliding.speed",
            "60 rpm",
            r"sliding\.speed = '60 rpm': has the wrong dimension: a speed.*frequency = '60 rpm'",
        ),
        (
            "disc.hardness",
            "60 HRC",
            r"hardness = '60 HRC': is a Rockwell number, .* 50 and 60 HRC of steel are .* 513 and 697 HV\.$",
        ),
        ("disc.young", "200 HV", r"disc\.young = '200 HV': cannot be read"),
        ("contact.hardness", "-200 HV", r"contact\.hardness = '-200 HV': cannot be read"),
        ("contact.load", "8 " + "m*" * 50_000 + "m", r"contact\.load = '8 m\*.{,300} is not one number with"),
        ("contact.load", (8, "bananas"), r"contact\.load = \(8, 'bananas'\): cannot be read"),
        ("contact.load", (-8, "N"), r"contact\.load = \(-8, 'N'\): must be greater than 0 N"),
        (
            "contact.load",
            REGISTRY.Quantity(8, "mm"),
            r"contact\.load = '8 millimeter': has the wrong dimension",
        ),
        ("contact.load", REGISTRY.Quantity(np.ones(2), "N"), r"contact\.load = .*: cannot be read: a force"),
        (
            "sliding.track",
            3.2,
            r"sliding\.track = 3\.2: needs its unit: a length such as '1\.5 mm', or 'full'",
        ),
        (
            "contact.bulk_stiffness",
            "volume",
            r"contact\.bulk_stiffness = 'volume': is not one number .* or 'area', 'pressure', 'approach'\.$",
        ),
        ("output.snapshots", (30, "mm"), r"output\.snapshots\.0 = 30: needs its unit"),
        (
            "output.snapshots",
            [REGISTRY.Quantity(3, "N")],
            r"output\.snapshots\.0 = '3 newton': has the wrong",
        ),
        (
            "output.snapshots",
            REGISTRY.Quantity(3, "mm"),
            r"output\.snapshots = .* must be a list in brackets",
        ),
    ],
)
def test_what_is_no_quantity_is_one_sentence(key: str, value: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        BASE.replace({key: value})


def test_factors_are_those_of_pint() -> None:
    """To the last bit, for numbers of any size, as results do not depend on who reads a quantity."""
    registry, generator = pint.UnitRegistry(), np.random.default_rng(5)
    numbers = 10.0 ** generator.uniform(-9.0, 9.0, 40)
    for unit, factors in FACTORS.items():
        for asked in factors:
            for number in map(float, numbers):
                assert (
                    parse(f"{number!r} {asked}", unit) == registry.Quantity(number, asked).to(unit).magnitude
                )
