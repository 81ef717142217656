"""Coefficient, slip and the rig's compliance come back from loops that closed forms make."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from warpwear import CalibratedTests, InputError, Study
from warpwear.calibration.loop import calibrate_loop
from warpwear.cli.main import commands
from warpwear.drafts.draft import draft
from warpwear.laws.elastic import Hertz, effective_modulus
from warpwear.laws.fretting import displacement, energy_ratio, loop, softness_ratio

STEEL, FRICTION, LOAD = (2.1e5, 0.3), 0.6, 20.0
HERTZ = Hertz(effective_modulus(STEEL, STEEL), 5.0, LOAD)
BORDER = displacement(HERTZ, softness_ratio(STEEL, STEEL), FRICTION)


def written(path: Path, *, slide: float, rig: float = 0.0, noise: float = 0.0, ratio: float = 1.0) -> Path:
    """Write Mindlin's loop of so much gross slip, to either side [mm], off its middle as records are."""
    limit = FRICTION * LOAD
    elastic = BORDER * (1.0 - (1.0 - ratio) ** (2 / 3))
    energy = energy_ratio(2 / 3, ratio, slide / BORDER)
    force, place = loop(ratio * limit, elastic + slide, BORDER, energy, limit=limit)
    at = np.linspace(0.0, force.size - 1.0, 900)
    force = np.interp(at, np.arange(force.size), force)
    place = np.interp(at, np.arange(place.size), place) + rig * force
    random = np.random.default_rng(1)
    place = 1e3 * place + 3.0 + random.normal(0.0, 20.0 * noise, at.size)
    force = force + 0.4 + random.normal(0.0, 12.0 * noise, at.size)
    rows = [f"{x:.6f},{q:.6f}" for x, q in zip(place, force, strict=True)]
    path.write_text("\n".join(["Displacement [um],Friction force [N]", *rows]), encoding="utf-8")
    return path


def study_in(folder: Path) -> str:
    """Write the ball of the loops as a study."""
    sections: dict[str, Any] = {
        "counter": {"radius": "5 mm", "young": "210 GPa", "poisson": 0.3},
        "disc": {"young": "210 GPa", "poisson": 0.3, "synthetic": {"kind": "flat"}},
        "contact": {"load": "20 N", "law": "half-space", "hardness": "inf MPa"},
        "wear": {"counter": "1e-6 mm^3/N/m", "disc": "1e-6 mm^3/N/m"},
        "friction": {"law": "coulomb"},
        "grid": {"cell": "5 um", "extent": "0.64 mm"},
        "sliding": {"stroke": "50 um", "cycles": 1000},
    }
    path = folder / "ball.toml"
    path.write_text(Study(**sections).to_toml(), encoding="utf-8")
    return str(path)


def strip_in(folder: Path) -> Path:
    """Write the draft of a line contact into a folder."""
    path = folder / "strip.toml"
    path.write_text(draft("fretting", name="strip", folder=folder), encoding="utf-8")
    return path


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_what_made_a_loop_comes_back(noise: float, tmp_path: Path) -> None:
    file = written(tmp_path / "loop.csv", slide=0.024, rig=2e-4, noise=noise)
    told = calibrate_loop(file, study=study_in(tmp_path)).numbers
    assert told["coefficient"] == pytest.approx(FRICTION, rel=0.01)
    assert told["stroke_um"] == pytest.approx(48.0, rel=0.02)
    assert told["rig_compliance_um_per_N"] == pytest.approx(0.2, rel=0.05)
    assert told["energy_mJ"] == pytest.approx(0.8 * 12.0 * BORDER + 48.0 * 0.024, rel=0.01)


@pytest.mark.parametrize("noise", [0.0, 2e-5])
@pytest.mark.parametrize("slide", [0.3, 1.0, 3.7, 20.0])
def test_what_the_contact_yields_is_taken_off(noise: float, slide: float, tmp_path: Path) -> None:
    """Left in, slip was 87 % too large and the coefficient 11 % too small at 0.3, or told partial slip."""
    file = written(tmp_path / "loop.csv", slide=slide * BORDER, rig=2e-4, noise=noise)
    told = calibrate_loop(file, study=study_in(tmp_path)).numbers
    assert told["regime"] == "gross slip"
    assert told["coefficient"] == pytest.approx(FRICTION, rel=0.005)
    assert told["stroke_um"] == pytest.approx(2e3 * slide * BORDER, rel=0.02)
    assert told["rig_compliance_um_per_N"] == pytest.approx(0.2, rel=0.005)
    assert told["coefficient_least"] is None
    alone = calibrate_loop(file, load="20 N")
    assert ("not taken off" in str(alone)) == (slide > 0.5)
    if slide < 0.5:
        assert "not known: partial slip, or a soft rig" in str(alone)
    else:
        assert alone.coefficient < told["coefficient"]
        assert 1e3 * alone.slip > told["stroke_um"]


def test_partial_slip_is_told_from_gross_slip_that_noise_hides(tmp_path: Path) -> None:
    study = study_in(tmp_path)
    for slide, ratio, noise, regime in (
        (0.0, 0.9, 0.0, "partial slip"),
        (0.0, 0.99, 0.0, "partial slip"),
        (0.02, 1.0, 0.0, "gross slip"),
        (0.02, 1.0, 2e-2, "not known: the points scatter"),
    ):
        file = written(tmp_path / "loop.csv", slide=slide * BORDER, rig=2e-4, ratio=ratio, noise=noise)
        told = calibrate_loop(file, study=study)
        assert told.regime.startswith(regime)
        assert (told.slip is None) == (told.coefficient is None) == (regime != "gross slip")
        assert (told.numbers["coefficient_least"] is None) == (regime == "gross slip")


def test_a_force_on_the_other_body_tells_the_same(tmp_path: Path) -> None:
    """Its tips were looked for where the loop has none: a rig of 0.2 µm/N was told as 0.4."""
    file = written(tmp_path / "loop.csv", slide=3.7 * BORDER, rig=2e-4)
    expected = calibrate_loop(file, study=study_in(tmp_path)).numbers
    place, force = np.loadtxt(file, delimiter=",", skiprows=1).T
    header = "Displacement [um],Friction force [N]"
    np.savetxt(file, np.column_stack([place, -force]), delimiter=",", header=header, comments="")
    told = calibrate_loop(file, study=study_in(tmp_path)).numbers
    assert told["regime"] == expected["regime"]
    for name in ("coefficient", "force_N", "stroke_um", "rig_compliance_um_per_N"):
        assert told[name] == pytest.approx(expected[name], rel=1e-6), name


@pytest.mark.slow
def test_noise_makes_no_force_and_is_told_as_errors(tmp_path: Path) -> None:
    """The largest of noisy points is 0.1 above the force at the tips; errors hold what 40 loops scatter."""
    names = ("coefficient", "force", "slip", "energy")
    exact = calibrate_loop(written(tmp_path / "exact.csv", slide=0.024), load="20 N")
    place, force = np.loadtxt(tmp_path / "exact.csv", delimiter=",", skiprows=1).T
    truth, offs = np.array([getattr(exact, name) for name in names]), []
    for seed in range(40):
        noise = np.random.default_rng(seed).standard_normal((2, place.size))
        rows = np.column_stack([place + 0.4 * noise[0], force + 0.24 * noise[1]])
        header = "displacement [um],friction force [N]"  # as the command's help calls them
        np.savetxt(tmp_path / "noisy.csv", rows, delimiter=",", header=header, comments="")
        noisy = calibrate_loop(tmp_path / "noisy.csv", load="20 N")
        offs.append(
            [(getattr(noisy, name) - t) / noisy.errors[name] for name, t in zip(names, truth, strict=True)]
        )
    assert rows[:, 1].max() > force.max() + 0.2
    assert np.sqrt(np.mean(np.square(offs), axis=0)).max() < 1.6
    assert noisy.numbers["coefficient_error"] == noisy.errors["coefficient"]
    assert " ± " in str(noisy)


def test_partial_slip_tells_no_coefficient(tmp_path: Path) -> None:
    file = written(tmp_path / "loop.csv", slide=0.0, ratio=0.6)
    told = calibrate_loop(file, load="20 N").numbers
    assert told["coefficient"] is None
    assert told["coefficient_least"] == pytest.approx(0.36, rel=1e-3)
    assert told["energy_ratio"] == pytest.approx(energy_ratio(2 / 3, 0.6), rel=0.01)
    assert 'force = "7.2 N"' in str(calibrate_loop(file, load="20 N"))


def test_the_command_and_its_refusals(tmp_path: Path) -> None:
    file = written(tmp_path / "loop.csv", slide=0.024)
    done = CliRunner().invoke(commands, ["calibrate", "loop", str(file), "--load", "20 N"])
    assert done.exit_code == 0
    assert 'law = "coulomb", coefficient = 0.598' in done.output
    for text, told in (
        ("Displacement [um],CoF\n" + "1,0.5\n" * 30, "friction force"),
        ("Displacement [um],Friction force [N]\n1,2\n", "a loop of 20"),
        ("Displacement [um],Friction force [N]\n" + "1,2\n" * 30, "does not change"),
        (
            "Displacement [um],Friction force [N]\n"
            + "".join(f"{15 - abs(i)},{15 - abs(i)}\n" for i in range(-15, 16)),
            "an area",
        ),
    ):
        file.write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match=told):
            calibrate_loop(file, load="20 N")
    with pytest.raises(InputError, match="is a line contact: type load"):
        calibrate_loop(written(file, slide=0.024), study=str(strip_in(tmp_path)))
    with pytest.raises(InputError, match="load is missing"):
        calibrate_loop(written(file, slide=0.024))


def test_a_part_of_a_cycle_and_several_are_refused(tmp_path: Path) -> None:
    """Their energy is that of a part, or of all."""
    header, *rows = written(tmp_path / "loop.csv", slide=3.0 * BORDER).read_text().splitlines()
    for points in (rows[:450], rows * 2):
        (tmp_path / "other.csv").write_text("\n".join([header, *points]), encoding="utf-8")
        with pytest.raises(InputError, match="holds a part of a cycle, or more than one"):
            calibrate_loop(tmp_path / "other.csv", load="20 N")
    for names in ("displacement (mm),friction (mN)", "Displacement,Friction force"):
        (tmp_path / "other.csv").write_text("\n".join([names, *rows]), encoding="utf-8")
        with pytest.raises(InputError, match="names both columns with units: 'Displacement"):
            calibrate_loop(tmp_path / "other.csv", load="20 N")


def test_several_loops_give_mean_and_scatter(tmp_path: Path) -> None:
    """The load's error is that of each coefficient; a list beside a study has its load."""
    files = [written(tmp_path / f"{n}.csv", slide=slide) for n, slide in enumerate((0.024, 0.03))]
    tests = [{"loop": str(file), "load": "20 +- 0.4 N"} for file in files]
    found = calibrate_loop(tests)
    assert isinstance(found, CalibratedTests)
    assert found.values == pytest.approx([calibrate_loop(file, load="20 N").coefficient for file in files])
    assert found.errors == pytest.approx([0.02 * value for value in found.values])
    path = tmp_path / "loops.toml"
    path.write_text("".join(f'[[test]]\nloop = "{n}.csv"\n' for n in (0, 1)), encoding="utf-8")
    study = study_in(tmp_path)
    with_study = calibrate_loop(path, study=study)
    assert with_study.values == tuple(calibrate_loop(file, study=study).coefficient for file in files)
    assert with_study.tests["test.1"].rig == pytest.approx(0.0, abs=1e-5)
    done = CliRunner().invoke(commands, ["calibrate", "loop", str(path), "--load", "20 N"])
    assert done.output.startswith("coefficient of 2 tests")
    partial = {"loop": written(tmp_path / "partial.csv", slide=0.0, ratio=0.6), "load": "20 N"}
    with pytest.raises(InputError, match="has no coefficient: not known: partial slip, or"):
        calibrate_loop([partial])
    with pytest.raises(InputError, match=r"^test\.1\.load is missing"):
        calibrate_loop(path)
