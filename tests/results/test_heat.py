"""A run says how hot its last contact gets, or what is not known of it."""

from typing import Any

import pytest

import warpwear
from warpwear.history.end_values import Summary
from warpwear.results.ending import WARM, friction_of

STEEL = {
    f"{body}.{name}": value
    for body in ("counter", "disc")
    for name, value in {
        "conductivity": "46 W/m/K",
        "heat_capacity": "470 J/kg/K",
        "density": "7800 kg/m^3",
    }.items()
}
SMALL = {
    "disc.synthetic": {"kind": "flat"},
    "contact.hardness": "600 MPa",
    "grid.cell": "4 um",
    "grid.extent": "0.2 mm",
    "sliding.distance": "0.1 mm",
    "sliding.speed": "25 mm/s",
    "stepping.first": "0.1 mm",
    "friction.coefficient": 0.6,
    "friction.calibrate": "end",
    "output.snapshots": ["0.1 mm"],
}


def told(**changes: Any) -> tuple[dict[str, Any], str]:
    """The summary, and what is said beside friction."""
    keys = {name.replace("__", "."): value for name, value in changes.items()}
    result = warpwear.run(warpwear.Study.load("v3-fine").replace(SMALL | STEEL | keys))
    return result.summary, friction_of(result.study, Summary.of(result.summary))


def test_how_hot_it_gets_as_a_contact_of_an_array_says() -> None:
    summary, text = told()
    result = warpwear.run(warpwear.Study.load("v3-fine").replace(SMALL | STEEL))
    pressure, cell = result.snapshot(-1).pressure, result.study.grid.cell
    contact = warpwear.solve_contact(pressure, cell=cell, mean_pressure=1.0, hardness=1e4)
    diffusivity = 1e6 * 46.0 / (470.0 * 7800.0)
    object.__setattr__(contact, "pressure", pressure)
    hot = contact.flash(25.0, friction=summary["cof"]["end"], conductivity=46.0, diffusivity=diffusivity)
    assert summary["flash_K"] == {
        "largest": pytest.approx(hot.largest, rel=1e-9),
        "mean": pytest.approx(hot.mean, rel=1e-9),
    }
    assert 2.0 < hot.mean < hot.largest < WARM
    assert text.endswith(f"; {hot.largest:.2g} K hotter at most: temperature plays no part")
    assert not any("hotter" in warning for warning in summary["warnings"])


def test_constants_of_a_material_are_told_as_such() -> None:
    study = warpwear.Study.load("v3-fine").replace(SMALL)
    result = warpwear.run(study)
    assert " K hotter at most, by constants of their materials: " in friction_of(
        study, Summary.of(result.summary)
    )
    assert len(study.assumptions) == len(study.replace(STEEL).assumptions)


def test_what_is_no_longer_small() -> None:
    summary, text = told(sliding__speed="2 m/s")
    assert summary["flash_K"]["largest"] > WARM
    assert text.endswith(" K hotter at most: too hot for constants of room temperature")
    told_of = [text for text in summary["warnings"] if "hotter" in text]
    assert told_of == [
        f"The contact gets {summary['flash_K']['largest']:.2g} K hotter at most, which is no longer small: "
        "hardness, friction and wear are those of room temperature."
    ]


@pytest.mark.parametrize(
    ("changes", "unknown"),
    [
        ({"disc__material": None, "disc__conductivity": None}, "no conductivity of the disc"),
        ({"counter__material": None, "counter__heat_capacity": None}, "no heat capacity of the ball"),
        ({"sliding__speed": None, "sliding__frequency": None}, "no sliding speed"),
    ],
)
def test_what_is_not_known(changes: dict[str, Any], unknown: str) -> None:
    summary, text = told(**changes)
    assert "flash_K" not in summary
    assert summary["flash_unknown"] == unknown
    assert text.endswith(f"; temperature not known: {unknown}")


def test_what_cannot_be_found(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patched:
        patched.setattr("warpwear.history.joint.MOST_HEATED", 9)
        assert told()[0]["flash_unknown"] == "too many cells"
    with monkeypatch.context() as patched:
        for limit in ("TOLERANCE", "ROUNDING"):
            patched.setattr(f"warpwear.contact.joint.flash.{limit}", 1e-30)
        assert "could not be made the same" in told()[1]


def test_nothing_slides() -> None:
    summary, text = told(sliding__distance="0 mm", output__snapshots=[])
    assert not {"flash_K", "flash_unknown"} & {*summary}
    assert "hotter" not in text
