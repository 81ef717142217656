"""Profiles in files of several layouts, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from cases_instruments import prf, sdf, x3p

from warpwear.errors import InputError
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.preparation import Preparation
from warpwear.surfaces.profiles.profile import Profile, far_off, parameters, profile_in
from warpwear.surfaces.reading import HoldsAProfile, read

SPACING = 0.0005
HEIGHTS = np.round(1e-3 * np.sin(np.arange(200) * 0.1) * (1 + 0.01 * np.arange(200)), 6)  # to 1 nm


def table(separator: str, head: str) -> str:
    rows = (f"{i * SPACING:.4f}{separator}{1e3 * z:.3f}" for i, z in enumerate(HEIGHTS))
    return "\n".join([head, *rows]) + "\n"


COMMAS = table(";", "x in mm; z in µm").replace(".", ",")
TEXTS = {
    "a.csv": table(",", "x in mm,z in µm"),
    "b.txt": COMMAS,
    "c.txt": table("\t", "Lateral [mm]\tRaw profile [µm]"),
    "d.dat": table(" ", "distance height\nmm µm"),
    "e.prf": prf(HEIGHTS, SPACING),
}


@pytest.mark.parametrize("name", TEXTS)
def test_text(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(TEXTS[name], encoding="utf-8")
    profile = profile_in(tmp_path / name)
    assert profile.spacing == pytest.approx(SPACING, rel=1e-6)
    np.testing.assert_allclose(profile.heights, HEIGHTS, atol=1e-12)
    with pytest.raises(HoldsAProfile, match=r"disc\.surface .* holds a profile \(line scan\) of 200 points"):
        read(tmp_path / name)


def test_one_column_and_depths(tmp_path: Path) -> None:
    path = tmp_path / "one.txt"
    path.write_text("z in um\n" + "\n".join(f"{1e3 * z:.3f}" for z in HEIGHTS) + "\n", encoding="utf-8")
    profile = profile_in(path, spacing=SPACING, down=True)
    np.testing.assert_allclose(profile.heights, -HEIGHTS, atol=1e-12)
    assert profile.length == pytest.approx(0.1)
    with pytest.raises(InputError, match=r"disc\.pixel is not given"):
        profile_in(path)


@pytest.mark.parametrize(("step", "digits"), [(0.15625, 1), (1.6, 0)])
def test_places_are_even_within_their_last_digit(tmp_path: Path, step: float, digits: int) -> None:
    """A stylus instrument prints places to 0.1 µm at 0.156 µm a step, and ends rows by two commas."""
    head = "Length,1500.0 um\nRadius,2.5 um,0.0 um\n\nScan Data\nLateral um,Raw Micrometer,\n"
    rows = "".join(f"{step * i:.{digits}f},{1e3 * z:.3f},,\n" for i, z in enumerate(HEIGHTS))
    (tmp_path / "d.csv").write_text(head + rows, encoding="utf-8")
    profile = profile_in(tmp_path / "d.csv")
    assert profile.spacing == pytest.approx(1e-3 * step, rel=1e-3)
    np.testing.assert_allclose(profile.heights, HEIGHTS, atol=1e-12)
    moved = rows.replace(f"\n{step * 90:.{digits}f},", f"\n{step * 90.4:.{digits}f},")
    moved = moved.replace(f"\n{step * 91:.{digits}f},", f"\n{step * 92.4:.{digits}f},")
    (tmp_path / "d.csv").write_text(head + moved, encoding="utf-8")
    with pytest.raises(InputError, match="not evenly spaced"):
        profile_in(tmp_path / "d.csv")


def test_points_left_out_are_holes(tmp_path: Path) -> None:
    path = tmp_path / "holes.csv"
    lines = TEXTS["a.csv"].splitlines()
    path.write_text("\n".join(lines[:60] + lines[63:]) + "\n", encoding="utf-8")
    profile = profile_in(path)
    assert np.flatnonzero(profile.missing).tolist() == [59, 60, 61]
    there = HEIGHTS[[58, 62]]
    np.testing.assert_allclose(profile.filled()[58:63], np.linspace(*there, 5), atol=1e-12)


@pytest.mark.parametrize("kind", ["D", "I"])
def test_x3p(tmp_path: Path, kind: str) -> None:
    x3p(tmp_path / "p.x3p", HEIGHTS, SPACING, kind=kind, missing=7)
    profile = profile_in(tmp_path / "p.x3p")
    assert profile.spacing == pytest.approx(SPACING)
    assert np.flatnonzero(profile.missing).tolist() == [7]
    np.testing.assert_allclose(np.delete(profile.heights, 7), np.delete(HEIGHTS, 7), atol=1e-12)


@pytest.mark.parametrize("name", ["aISO-1.0", "aBCR-1.0"])
def test_sdf_of_one_line(tmp_path: Path, name: str) -> None:
    pytest.importorskip("SurfaceTopography")
    (tmp_path / "p.sdf").write_text(sdf(HEIGHTS, SPACING, name=name), encoding="ascii")
    profile = profile_in(tmp_path / "p.sdf")
    assert profile.spacing == pytest.approx(SPACING, rel=1e-6)
    np.testing.assert_allclose(profile.heights, HEIGHTS, atol=1e-9)


def test_an_array(tmp_path: Path) -> None:
    np.save(tmp_path / "p.npy", 1e3 * HEIGHTS[None, :])
    profile = profile_in(tmp_path / "p.npy", spacing=SPACING, height_unit="um")
    np.testing.assert_allclose(profile.heights, HEIGHTS, atol=1e-12)
    np.save(tmp_path / "map.npy", np.ones((60, 60)))
    with pytest.raises(InputError, match="holds no profile"):
        profile_in(tmp_path / "map.npy", spacing=SPACING, height_unit="um")


def uneven(text: str) -> str:
    lines = text.splitlines()
    lines[20] = lines[20].replace("0.0095", "0.0097")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("name", "text", "what"),
    [
        ("a.csv", uneven(TEXTS["a.csv"]), r"no profile \(points along x that are not evenly spaced\)"),
        ("a.csv", "x in mm,z in µm\n" + "0.1,2.0\n" * 60, "several points at one x"),
        ("a.csv", "\n".join(TEXTS["a.csv"].splitlines()[:40]) + "\n", "39 points: at least 50"),
        ("e.prf", TEXTS["e.prf"].replace("\r\n0\r\n", "\r\n"), "says that there are"),
        ("e.prf", TEXTS["e.prf"].replace("SPACING CX", "SPACING CY"), "SPACING CX"),
        ("e.prf", TEXTS["e.prf"].replace(" MM ", " IN "), "allowed is MM"),
        ("e.prf", TEXTS["e.prf"][:300], "cut short"),
        ("a.mod", "\x00\x01\x02binary" * 50, "cannot be read"),
    ],
)
def test_bad_files_are_refused_in_one_sentence(tmp_path: Path, name: str, text: str, what: str) -> None:
    (tmp_path / name).write_bytes(text.encode("utf-8"))
    with pytest.raises(InputError, match=rf"disc\.surface .*({what})") as caught:
        profile_in(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_a_damaged_x3p(tmp_path: Path) -> None:
    x3p(tmp_path / "p.x3p", HEIGHTS, SPACING)
    whole = (tmp_path / "p.x3p").read_bytes()
    (tmp_path / "p.x3p").write_bytes(whole[:-40])
    with pytest.raises(InputError, match=r"disc\.surface .*as \.x3p"):
        profile_in(tmp_path / "p.x3p")


def test_a_line_scan_of_surfacetopography(tmp_path: Path) -> None:
    topography = pytest.importorskip("SurfaceTopography")
    scan = topography.UniformLineScan(1e3 * HEIGHTS, 1e3 * SPACING * HEIGHTS.size, unit="um")
    scan.to_netcdf(str(tmp_path / "p.nc"))
    profile = profile_in(tmp_path / "p.nc")
    assert profile.spacing == pytest.approx(SPACING, rel=1e-6)
    np.testing.assert_allclose(profile.heights, HEIGHTS, atol=1e-12)


def noted(tmp_path: Path, heights: np.ndarray, **how: object) -> Profile:
    np.save(tmp_path / "p.npy", 1e3 * heights)
    return profile_in(tmp_path / "p.npy", spacing=SPACING, height_unit="um", **how)


@pytest.mark.parametrize("mark", [-999.0, -25400.0, 9999.0, 0.0])
def test_a_value_that_repeats_far_outside_marks_lost_points(tmp_path: Path, mark: float) -> None:
    heights = 1e-3 * np.random.default_rng(0).normal(size=400) + (0.2 if mark == 0.0 else 0.0)
    lost = heights.copy()
    lost[[5, 40, 41, 300]] = 1e-3 * mark
    profile = noted(tmp_path, lost)
    assert profile.about["notes"][0].startswith(f"4 points hold {mark:g} um, which repeats far outside")
    np.testing.assert_array_equal(np.flatnonzero(profile.missing), [5, 40, 41, 300])
    assert parameters(profile.levelled(1)).ra == pytest.approx(
        parameters(noted(tmp_path, heights).levelled(1)).ra, rel=0.02
    )
    for honest in (heights, np.maximum(heights, heights.mean()), np.where(np.arange(400) < 300, 0.0, -1.0)):
        assert not noted(tmp_path, honest).missing.any()


def test_outliers_and_crop_of_a_profile(tmp_path: Path) -> None:
    heights = 1e-3 * np.random.default_rng(0).normal(size=400)
    heights[[50, 200]] = 0.03, -0.05
    assert "lowest point lies 16 Rq off the middle" in str(far_off(noted(tmp_path, heights).heights))
    assert far_off(1e-3 * np.random.default_rng(0).normal(size=400)) is None
    many = np.where(np.arange(400) % 20 == 7, -0.05 - 1e-4 * np.arange(400), heights)
    assert "lowest point" in str(far_off(many)), "twenty of them hide in their own Rq"
    whole = noted(tmp_path, heights, deviations=6.0)
    np.testing.assert_array_equal(np.flatnonzero(whole.missing), [50, 200])
    assert whole.about["notes"][0].startswith("outliers: 2 points farther than 6 robust standard deviations")
    part = noted(tmp_path, heights, crop=(100 * SPACING, 300 * SPACING))
    np.testing.assert_allclose(part.heights, heights[100:300])
    middle = noted(tmp_path, heights, crop=(200 * SPACING, 200 * SPACING))
    np.testing.assert_allclose(middle.heights, heights[100:300])
    with pytest.raises(
        InputError, match=r"disc\.crop is .* allowed is x0, x1 within the measurement, 0.2 mm"
    ):
        noted(tmp_path, heights, crop=(0.0, 401 * SPACING))
    how = Preparation(outliers=6.0, crop=(0.0, 300 * SPACING))
    disc = read_measured(tmp_path / "p.npy", how, profile=True, pixel=SPACING, height_unit="um")
    assert disc.filled is not None
    np.testing.assert_array_equal(np.flatnonzero(disc.filled[:, 0]), [50, 200])
    assert disc.details["file_grid"] == [400], "of the file, before a part of it is taken"
    assert disc.details["height_min_um"] == pytest.approx(1e3 * heights.min())
