"""A joint of measured surfaces over its loads: command and function, table, folder, and what is refused."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_half_space import rough

import warpwear
from warpwear.cli.main import main
from warpwear.errors import InputError
from warpwear.grid import Grid
from warpwear.measured import joints

pytestmark = pytest.mark.transforms

HOW: dict[str, Any] = {"pixel": "2 um", "height_unit": "um"}
OPTIONS = ["--pixel", "2 um", "--height-unit", "um", "--material", "AISI 304"]


@pytest.fixture
def surface(tmp_path: Path) -> Path:
    path = tmp_path / "lapped.npy"
    np.save(path, rough(Grid(64, 64, 1.0), shortest=10) * 0.1)
    return path


def test_a_curve_is_that_of_solved_contacts(surface: Path) -> None:
    joint = warpwear.joint_curve(surface, load="1:100 MPa", material="AISI 304", **HOW)
    table = joint.table
    assert table["pressure"] == pytest.approx(np.geomspace(1.0, 100.0, 13))
    heights = warpwear.read_surface(surface, **HOW).heights
    modulus = warpwear.effective_modulus((193e3, 0.29), (193e3, 0.29))
    contact = warpwear.solve_contact(
        heights, cell=0.002, mean_pressure=100.0, modulus=modulus, hardness=1520.0
    )
    per_area = 1.0 / contact.nominal_area
    assert table["area"][-1] == contact.area * per_area
    assert table["conductance"][-1] == pytest.approx(contact.conductance() * per_area)
    assert table["stiffness_loading"][-1] == pytest.approx(contact.stiffness() * per_area)
    # k 16.2 W/(m K), ρ 7.2e-7 Ω m of both: h in W/(m² K) and R A in Ω mm² of G in 1/mm.
    assert table["heat_transfer"] == pytest.approx(16.2 * 1e3 * table["conductance"])
    assert table["resistance"] == pytest.approx(7.2e-4 / table["conductance"])
    assert (np.diff(table["conductance"]) > 0.0).all()
    assert table["residual"][-1] == contact.residual
    assert joint.numbers["residual_largest"] == table["residual"].max() < 1e-5
    flow = contact.flow_factors()
    assert table["flow_along"][-1] == pytest.approx(flow.along)
    assert table["flow_across"][-1] == pytest.approx(flow.across)
    assert table["flow_shear"][-1] == pytest.approx(flow.shear)
    cube = (table["gap"] / table["separation"]) ** 3
    assert table["nominal_flow_along"] == pytest.approx(cube * table["flow_along"])
    assert {"flow", "gap_map", "pressure_histogram"} <= {*joint.figures}


def test_one_load_is_shown_by_its_fields(surface: Path) -> None:
    """Shares of a histogram are those of all cells in contact; what is not known is told."""
    joint = warpwear.joint_curve(surface, load="20 MPa", material="AISI 304", against_material="PTFE", **HOW)
    assert [*joint.figures] == ["pressure_map", "pressure_histogram", "gap_map", "gap_histogram"]
    for name in ("pressure", "gap"):
        chart = joint.figures[f"{name}_histogram"].panels[0]
        assert chart.lines[0].high[::2].sum() == pytest.approx(1.0)
    assert joint.numbers["not_known"] == ["resistivity of PTFE"]
    assert "\n  nominal_flow_across [1] " in joint.text


def test_laws_stand_beside_the_conductance_and_what_was_done_to_the_surface_is_said(
    surface: Path, tmp_path: Path
) -> None:
    """By the rms height and slope of the heights that are pressed; steep slopes are told."""
    heights = 60.0 * np.load(surface)
    heights[3, 4] = np.nan
    np.save(tmp_path / "steep.npy", heights)
    joint = warpwear.joint_curve(tmp_path / "steep.npy", load="1, 100 MPa", material="AISI 304", **HOW)
    lines = {line.label: line for line in joint.figures["conductance"].panels[0].lines}
    made = warpwear.read_surface(tmp_path / "steep.npy", **HOW)
    mean = made.numbers["rms_slope"] / np.sqrt(np.pi)
    plastic = 1.25e3 * mean / made.numbers["sq_um"] * (np.array([1.0, 100.0]) / 1520.0) ** 0.95
    assert lines["plastic, Cooper, Mikic, Yovanovich (1969)"].y == pytest.approx(plastic, rel=1e-3)
    assert "elastic, Mikic (1974)" in lines
    assert "of cells of 2 µm: half-spaces are for small slopes\n" in joint.text
    assert "1 missing point" in " ".join(joint.numbers["operations"])


def test_a_number_is_a_load_and_a_flat_conducts_without_bound(tmp_path: Path) -> None:
    np.save(tmp_path / "flat.npy", np.zeros((32, 32)))
    joint = warpwear.joint_curve(tmp_path / "flat.npy", load=5.0, material="AISI 304", **HOW)
    assert joint.table["pressure"] == [5.0]
    assert joint.table["conductance"] == [np.inf]
    assert not joint.figures.keys() & {"gap_map", "gap_histogram"}  # of no cell
    two = warpwear.joint_curve(tmp_path / "flat.npy", load="1, 5 MPa", material="AISI 304", **HOW)
    assert not {"conductance", "stiffness"} & {*two.figures}
    assert two.numbers["operations"][1].startswith("flat")


@pytest.mark.parametrize("load", ["1 MPa, 5 MPa", "1,5MPa", "1e0, 5e0 N/mm^2"])
def test_loads_have_one_unit_or_one_each(surface: Path, load: str) -> None:
    assert [*joints.loads_of(load)] == [1.0, 5.0]
    assert joints.loads_of("0.1:10MPa") == pytest.approx(np.geomspace(0.1, 10.0, 13))


def test_a_pit_does_not_rule_the_axis_of_gaps_which_says_so(tmp_path: Path) -> None:
    """A pit of 2 of 4096 cells, fifteen times as deep as all else: the axis ends before it."""
    heights = np.add.outer(np.sin(np.arange(64) / 5.0), np.sin(np.arange(64) / 5.0))
    heights[30:32, 30] = -60.0
    np.save(tmp_path / "pit.npy", 0.1 * heights)
    joint = warpwear.joint_curve(tmp_path / "pit.npy", load="5 MPa", material="AISI 304", **HOW)
    (chart,), (drawn,) = (joint.figures[f"gap_{kind}"].panels for kind in ("histogram", "map"))
    found = re.fullmatch("gap, µm; (.*) of the area lies beyond", chart.x.label)
    assert found is not None
    assert 0.0005 < float(found[1]) < 0.0015
    assert chart.lines[0].x[-1] == drawn.scale.high < 1.0
    assert drawn.scale.beyond == "max"
    assert chart.lines[0].high[::2].sum() == pytest.approx(1.0 - float(found[1]), abs=1e-4)


def test_it_is_told_how_long_a_large_table_takes(
    surface: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(joints, "LONG", 0.0)
    warpwear.joint_curve(surface, load="1, 5 MPa", material="AISI 304", **HOW)
    (told,) = capsys.readouterr().err.splitlines()
    assert re.fullmatch("joint: about .* (s|min), most for what flows; less by --no-flow, or --crop", told)


def test_a_table_without_a_folder_is_refused_before_anything_is_solved(
    surface: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(joints, "joint_curve", None)
    for table in ("nowhere/fe.csv", "."):
        with pytest.raises(SystemExit, match="2"):
            main(["joint", str(surface), *OPTIONS, "--load", "5 MPa", "--json", "--table", table])
        assert f"--table = {table}: the name of a file in a folder that is there" in capsys.readouterr().err


def test_a_gap_of_too_many_cells_has_no_flow(surface: Path, host_with: Any) -> None:
    host_with(2**22)
    joint = warpwear.joint_curve(surface, load="1, 20 MPa", material="AISI 304", **HOW)
    assert np.isnan(joint.table["flow_along"]).all()
    assert np.isfinite(joint.table["conductance"]).all()
    assert "flow" not in joint.figures
    assert any(text.startswith("flow is not known: gaps of shape") for text in joint.numbers["warnings"])


def test_two_surfaces_touch_where_both_are_high(surface: Path, tmp_path: Path) -> None:
    """The second is turned over about x: against one that fills it exactly all is in contact."""
    other = tmp_path / "other.npy"
    np.save(other, -np.load(surface)[:, ::-1])
    joint = warpwear.joint_curve(
        surface, against=other, load="10 MPa", material="AISI 304", against_material="PTFE", **HOW
    )
    assert joint.table["area"][0] == 1.0
    assert np.isnan(joint.table["resistance"][0])  # that of PTFE is not known
    assert joint.numbers["hardness_MPa"] == 28.0


def test_the_command_prints_and_writes(
    surface: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ["joint", str(surface), *OPTIONS, "--load", "1, 10 MPa", "--table", "fe.csv"]
    with pytest.raises(SystemExit, match="0"):
        main(command)
    text = capsys.readouterr().out
    assert "asperities" in text
    assert "twice the cell" in text
    folder = tmp_path / "lapped.npy-joint"
    names = {path.name for path in folder.iterdir()}
    assert {"joint.html", "joint.csv", "joint.json", "conductance.png", "gap_map.png"} <= names
    assert "heat_transfer [W/m^2/K]  resistance" in text
    assert "heat_transfer [W/m^2/K]  resistance" in (folder / "joint.html").read_text("utf-8")
    assert (tmp_path / "fe.csv").read_text() == (folder / "joint.csv").read_text()
    header, *rows = (tmp_path / "fe.csv").read_text().splitlines()
    assert header.startswith("pressure [MPa],heat_transfer [W/m^2/K],resistance [ohm mm^2]")
    assert [float(row.split(",")[0]) for row in rows] == [1.0, 10.0]
    for again, named in (([], "lapped.npy-joint"), (["--out", "other"], "--table = fe.csv is there already")):
        with pytest.raises(SystemExit, match="2"):
            main([*command, *again])
        assert named in capsys.readouterr().err
    with pytest.raises(SystemExit, match="0"):
        main(["joint", str(surface), *OPTIONS, "--load", "5 MPa", "--json"])
    numbers = json.loads(capsys.readouterr().out)
    assert numbers["table"]["pressure [MPa]"] == [5.0]
    assert numbers["asperities"] in ("elastic", "plastic", "partly plastic")


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"load": "100:1 MPa"}, "load = '100:1 MPa': allowed are '0.1:100 MPa'"),
        ({"load": "1:2:3 MPa"}, "allowed are"),
        ({"load": "5 N"}, "load = '5 N'"),
        ({"load": "1:5000 MPa"}, "load = 5000 MPa: at most 1520 MPa, all at the hardness"),
        ({"load": "1,,5 MPa"}, "load = 'MPa': is not one number"),
        ({"material": 3}, "material: no material '3' is known"),
        ({"load": "words"}, "load = 'words': is not one number"),
        ({"load": "1, 0 MPa"}, "load = '0 MPa': must be greater than 0 MPa"),
        ({"load": [1, 2]}, "load = '[1 MPa': is not"),
        ({"material": "cheese"}, "material: no material 'cheese' is known"),
        ({"against_material": "cheese"}, "against_material: no material 'cheese' is known"),
        ({"hardness": "inf MPa"}, "hardness = 'inf MPa': must be finite"),
        ({"crop": 0.006}, "a joint of 2 × 2 cells is not possible: 16 each way are the least"),
        ({"hardness": "soft"}, "hardness = 'soft'"),
    ],
)
def test_what_is_not_possible_is_said(surface: Path, changed: dict[str, Any], sentence: str) -> None:
    given = {"load": "10 MPa", "material": "AISI 304", **HOW, **changed}
    with pytest.raises(InputError) as refused:
        warpwear.joint_curve(surface, **given)
    assert sentence in str(refused.value)


def test_a_table_never_replaces_a_surface(surface: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = surface.read_bytes()
    command = ["joint", str(surface), *OPTIONS, "--load", "5 MPa", "--json", "--overwrite", "--table"]
    with pytest.raises(SystemExit, match="2"):
        main([*command, str(surface)])
    assert "is there already: give another name.\n" in capsys.readouterr().err
    assert surface.read_bytes() == before


def test_what_flows_is_left_out_if_asked(surface: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The rest is the same; what was not looked at is no number."""
    with pytest.raises(SystemExit, match="0"):
        main(["joint", str(surface), *OPTIONS, "--load", "1, 5 MPa", "--json", "--no-flow"])
    told = json.loads(capsys.readouterr().out)["table"]
    table = warpwear.joint_curve(surface, load="1, 5 MPa", material="AISI 304", **HOW).table
    assert told["conductance [1/mm]"] == table["conductance"].tolist()
    assert told["flow_along [1]"] == [None, None]
    assert np.isfinite(table["flow_along"]).all()
