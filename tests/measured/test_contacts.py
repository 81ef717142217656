"""One contact of a measured surface: command and function, against Hertz and `solve_contact`, refusals."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_half_space import rough

import warpwear
from warpwear.cli.main import main
from warpwear.errors import InputError
from warpwear.grid import Grid

pytestmark = pytest.mark.transforms

HOW: dict[str, Any] = {"pixel": "2 um", "height_unit": "um"}
OPTIONS = ["--pixel", "2 um", "--height-unit", "um", "--material", "AISI 304"]
STEEL = {"material": "AISI 304", **HOW}
BALL = {"radius": "3 mm", "material": "AISI 304"}
E = 193e3 / (1.0 - 0.29**2) / 2.0


@pytest.fixture
def surface(tmp_path: Path) -> Path:
    path = tmp_path / "lapped.npy"
    np.save(path, rough(Grid(64, 64, 1.0), shortest=10) * 0.1)
    return path


@pytest.fixture
def flat(tmp_path: Path) -> Path:
    path = tmp_path / "flat.npy"
    np.save(path, np.zeros((64, 64)))
    return path


def test_a_ball_on_a_flat_is_hertz(flat: Path, device: str) -> None:
    """20 cells in a radius: area, largest pressure, approach, 2a of the conductance, and stress below."""
    load = 0.5
    under = warpwear.measured_contact(
        flat, load=f"{load} N", counter=BALL, stresses=True, device=device, hardness="9 GPa", **STEEL
    )
    told, a = under.numbers, (0.75 * load * 3.0 / E) ** (1.0 / 3.0)
    peak = 1.5 * load / (math.pi * a**2)
    assert told["hertz_radius_um"] == pytest.approx(1e3 * a)
    assert told["hertz_pressure_MPa"] == pytest.approx(peak)
    assert told["area_corrected_mm2"] == pytest.approx(
        math.pi * a**2, abs=2.0 * told["area_corrected_error_mm2"]
    )
    assert told["area_mm2"] == under.contact.area > math.pi * a**2
    assert told["pressure_max_MPa"] == pytest.approx(peak, rel=0.01)
    assert told["approach_um"] == pytest.approx(1e3 * a**2 / 3.0, rel=0.01)
    assert told["conductance_length_mm"] == pytest.approx(2.0 * a, rel=0.05)
    assert told["thermal_W_per_K"] == pytest.approx(16.2e-3 * told["conductance_length_mm"])
    assert told["resistance_ohm"] == pytest.approx(7.2e-4 / told["conductance_length_mm"])
    assert told["stiffness_loading_N_per_mm"] == pytest.approx(E * told["conductance_length_mm"])
    assert told["spots"] == 1.0
    # Johnson, section 3.4, Poisson's ratio 0.3: 0.62 of the peak pressure at a depth of 0.48 a.
    assert told["mises_max_MPa"] == pytest.approx(0.62 * peak, rel=0.02)
    assert told["mises_depth_um"] == pytest.approx(480.0 * a, rel=0.15)
    assert told["area_nominal_mm2"] is told["gap_um"] is None
    assert told["undefined"] == ["nominal area, mean gap: the contact does not repeat"]
    assert "stress_map" in under.figures


def test_a_contact_is_that_of_solve_contact(surface: Path) -> None:
    """On a plane, of a force and of the same mean pressure, a capped one, with all that a joint has."""
    area = (64 * 0.002) ** 2
    plane, forced = (
        warpwear.measured_contact(surface, load=load, flow=True, **STEEL).numbers
        for load in ("100 MPa", f"{100.0 * area} N")
    )
    heights = warpwear.read_surface(surface, **HOW).heights
    contact = warpwear.solve_contact(heights, cell=0.002, mean_pressure=100.0, modulus=E, hardness=1520.0)
    assert forced["area_mm2"] == plane["area_mm2"] == contact.area
    assert plane["area_at_hardness_mm2"] == contact.area_at_hardness > 0.0
    assert plane["area_nominal_mm2"] == pytest.approx(area)
    assert forced["pressure [MPa]"] == pytest.approx(100.0)
    assert plane["approach_um"] == pytest.approx(1e3 * contact.approach)
    assert plane["residual"] == pytest.approx(contact.residual, rel=1e-3)
    assert plane["evaluations"] == contact.evaluations
    assert plane["stiffness_unloading_N_per_mm"] == pytest.approx(contact.stiffness(unloading=True))
    assert plane["stiffness_loading_N_per_mm"] == pytest.approx(contact.stiffness())
    assert plane["gap_um"] == pytest.approx(1e3 * np.maximum(contact.gap, 0.0).mean())
    joint = warpwear.joint_curve(surface, load="100 MPa", **STEEL)
    for name in ("heat_transfer [W/m^2/K]", "resistance [ohm mm^2]", "flow_along [1]", "flow_shear [1]"):
        assert joint.numbers["table"][name] == [plane[name]]
    assert joint.numbers["changes_percent"] == plane["changes_percent"]


@pytest.mark.parametrize(
    ("counter", "boundary"),
    [
        ({"shape": "cylinder", "radius": "3 mm"}, "line"),
        ({"shape": "crowned", "radius_along": "2 mm", "radius_across": "5 mm"}, "free"),
        ({"shape": "pin", "radius": "20 um"}, "free"),
        ({"radius": "3 mm"}, "free"),
    ],
)
def test_every_form_is_that_of_solve_contact(surface: Path, counter: dict[str, str], boundary: str) -> None:
    under = warpwear.measured_contact(surface, load="0.5 N", counter=counter, **STEEL)
    told, units = under.numbers, {"3 mm": 3.0, "2 mm": 2.0, "5 mm": 5.0, "20 um": 0.02}
    form: dict[str, Any] = {key: units.get(value, value) for key, value in counter.items()}
    heights = warpwear.read_surface(surface, **HOW).heights
    contact = warpwear.solve_contact(
        heights, cell=0.002, load=0.5, modulus=E, hardness=1520.0, counter=form, boundary=boundary
    )
    assert told["area_mm2"] == contact.area
    assert told["pressure_max_MPa"] == contact.pressure.max()
    assert told["conductance_length_mm"] == pytest.approx(contact.conductance())
    assert (told["approach_um"] is None) == (boundary == "line")
    assert any("distance of the map's length" in text for text in told["undefined"]) == (boundary == "line")
    assert ("and a crowned body, " in under.text) == (counter.get("shape") == "crowned")
    assert (told["area_corrected_mm2"] is None) == (counter.get("shape") == "pin")
    assert ("hertz_radius_um" in under.table) == (counter.get("shape") != "pin")
    gaps = under.figures["gap_map"].panels[0]
    assert (gaps.hidden is not None) == (counter.get("shape") == "pin")  # beyond which there is no body


def test_two_surfaces(surface: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.npy"
    np.save(other, -np.load(surface)[:, ::-1])
    counter = {"material": "PTFE"}
    told = warpwear.measured_contact(surface, load="10 MPa", against=other, counter=counter, **STEEL)
    assert told.numbers["area_mm2"] == told.contact.nominal_area
    assert told.numbers["undefined"] == ["conductance, stiffness: infinite, all cells are in contact"]
    assert told.numbers["not_known"] == ["resistivity of PTFE"]
    assert told.text.startswith("contact of lapped.npy and other.npy\n")


def test_the_command_prints_and_writes(
    surface: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ["contact", str(surface), *OPTIONS, "--load", "0.5 N", "--set", "counter.radius=3 mm"]
    with pytest.raises(SystemExit, match="0"):
        main([*command, "--set", "counter.material=AISI 52100", "--stresses"])
    text = capsys.readouterr().out
    assert text.startswith("contact of lapped.npy and a ball, radius 3 mm\n  area   ")
    for label in ("Hertz: a", "von Mises", "twice the cell", "has no meaning"):
        assert f"\n  {label} " in text
    folder = tmp_path / "lapped.npy-contact"
    names = {path.name for path in folder.iterdir()}
    assert {"contact.html", "contact.csv", "contact.json", "stress_map.png", "gap_map.png"} <= names
    header, row = (folder / "contact.csv").read_text().splitlines()
    numbers = json.loads((folder / "contact.json").read_text())
    values = dict(zip(header.split(","), map(float, row.split(",")), strict=True))
    assert values["area_mm2"] == pytest.approx(numbers["area_mm2"])
    with pytest.raises(SystemExit, match="2"):
        main(command)
    assert "lapped.npy-contact" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="0"):
        main([*command, "--json"])
    assert json.loads(capsys.readouterr().out)["load_N"] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"load": "5 mm"}, "load = '5 mm': allowed are a force, '5 N', and of a plane a pressure"),
        ({"load": "-5 N"}, "load = '-5 N': allowed are"),
        ({"load": "10 MPa"}, "load = '10 MPa': allowed are a force"),
        ({"load": "500 N"}, "load = 500 N: at most 24.9037 N, all at the hardness"),
        ({"flow": True}, "flow and a counter-body exclude each other"),
        ({"against": "lapped.npy"}, "against and a counter-body exclude each other"),
        ({"material": "cheese"}, "no material 'cheese' is known"),
        ({"counter": {"radius": "3 mm", "material": "cheese"}}, "counter.material: no material 'cheese' is"),
        ({"counter": ["radius", "3 mm"]}, "counter = ['radius', '3 mm']: keys of a study's [counter]"),
        ({"counter": {"radius": "3 kg"}}, "counter.radius = '3 kg': has the wrong dimension"),
        (
            {"counter": {"shape": "cube", "radius": "3 mm"}},
            "shape = 'cube' is unknown; allowed are 'ball', 'crowned', 'cylinder' and 'pin'",
        ),
        ({"counter": {"shape": "pin"}}, "counter of shape 'pin' needs radius"),
        ({"counter": {"shape": "crowned"}}, "counter of shape 'crowned' needs radius_along"),
        ({"counter": {"radius": "0 mm"}}, "counter radius = 0 is not possible"),
        ({"counter": {"diameter": "6 mm"}}, "counter has no 'diameter'; its keys are shape, radius"),
        ({"counter": {"shape": "measured", "radius": 1.0}}, "shape = 'measured' is unknown"),
        ({"counter": {"contact.law": "winkler"}}, "counter has no 'contact.law'; its keys are shape"),
    ],
)
def test_what_is_not_possible_is_said(surface: Path, changed: dict[str, Any], sentence: str) -> None:
    given = {"load": "0.5 N", "counter": {"radius": "3 mm"}} | STEEL | changed
    with pytest.raises(InputError) as refused:
        warpwear.measured_contact(surface, **given)
    assert sentence in str(refused.value)


@pytest.mark.parametrize(
    ("load", "counter", "warning"),
    [
        ("20 N", {"radius": "3 mm"}, "the contact with the counter-body reaches the edge of heights"),
        ("1e-5 N", {"radius": "3 mm"}, "half of the spots in contact are of fewer than 3 cells"),
    ],
)
def test_what_misleads_is_told(
    surface: Path, flat: Path, load: str, counter: dict[str, str], warning: str
) -> None:
    of = surface if load == "1e-5 N" else flat
    told = warpwear.measured_contact(of, load=load, counter=counter, hardness="9 GPa", **STEEL)
    assert any(text.startswith(warning) for text in told.numbers["warnings"])
    assert f"  warning          {told.numbers['warnings'][0]}" in told.text
