"""The worn bodies as solids, points and tables: read back by other readers, or by what the standards say."""

import csv
import hashlib
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_formats import needs, read_x3p, result, swept

from warpwear import Result
from warpwear.results.export import export
from warpwear.results.formats.bodies import worn_heights

__all__ = ["result", "swept"]  # the fixtures


@pytest.mark.parametrize("body", ["counter", "disc"])
def test_x3p_is_what_the_standard_says(tmp_path: Path, result: Result, body: str) -> None:
    export(result, tmp_path, formats=["x3p"], bodies=[body])
    data, texts, parts = read_x3p(tmp_path / f"{body}_worn.x3p")
    heights = worn_heights(result, result.snapshot(-1), body)
    np.testing.assert_allclose(1e3 * data, heights, rtol=1e-15)
    for axis in "XY":
        assert texts[f"Record1/Axes/C{axis}/AxisType"] == "I"
        assert float(texts[f"Record1/Axes/C{axis}/Increment"]) == pytest.approx(20e-6)
        assert float(texts[f"Record1/Axes/C{axis}/Offset"]) == pytest.approx(1e-3 * result.x[0])
    assert texts["Record1/Axes/CZ/AxisType"] == "A"
    assert texts["Record1/Axes/CZ/DataType"] == "D"
    assert texts["Record1/Revision"] == "ISO5436 - 2000"
    # The file of sums is that of main.xml, which holds those of the others.
    assert parts["md5checksum.hex"].decode().split() == [
        hashlib.md5(parts["main.xml"]).hexdigest(),
        "*main.xml",
    ]
    assert (
        texts["Record3/DataLink/MD5ChecksumPointData"] == hashlib.md5(parts["bindata/data.bin"]).hexdigest()
    )
    if body == "counter":
        valid = np.unpackbits(np.frombuffer(parts["bindata/valid.bin"], "u1"), bitorder="little")
        np.testing.assert_array_equal(
            valid[: heights.size].reshape(heights.shape[::-1]).T, np.isfinite(heights)
        )
    else:
        assert "bindata/valid.bin" not in parts


@pytest.mark.parametrize("ending", ["x3p", "sdf"])
def test_other_readers_give_the_same_heights(tmp_path: Path, swept: Result, ending: str) -> None:
    """A track is no square: swapped axes would show."""
    needs("sdf")
    io = pytest.importorskip("SurfaceTopography")
    export(swept, tmp_path, formats=[ending], bodies=["track"])
    topography = io.read_topography(str(tmp_path / f"track_worn.{ending}")).to_unit("mm")
    last = swept.snapshot(-1)
    worn = swept.track_heights() - last.wear_disc - last.plastic_disc
    np.testing.assert_allclose(topography.heights(), worn, rtol=1e-9, atol=1e-14)
    cell = swept.study.grid.cell
    assert topography.physical_sizes == pytest.approx((cell * worn.shape[0], cell * worn.shape[1]))
    surfalize = pytest.importorskip("surfalize")
    surface = surfalize.Surface.load(str(tmp_path / f"track_worn.{ending}"))
    np.testing.assert_allclose(np.ptp(surface.data, axis=1), 1e3 * np.ptp(worn, axis=0), rtol=1e-6)
    assert (surface.step_x, surface.step_y) == pytest.approx((1e3 * cell, 1e3 * cell))


def read_stl(path: Path) -> Any:
    """Corners of the triangles [mm], shape (triangles, 3, 3); their normals are looked at."""
    content = path.read_bytes()
    (count,) = struct.unpack("<I", content[80:84])
    assert len(content) == 84 + 50 * count
    assert not content.startswith(b"solid")
    facets = np.frombuffer(content[84:], [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    corners = facets["v"].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    np.testing.assert_allclose(facets["n"], normals, atol=2e-3)
    return corners


def is_closed(corners: Any) -> bool:
    """Whether each edge of a triangle runs once in either direction."""
    _, names = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    names = names.reshape(-1, 3)
    edges = np.concatenate([names[:, [0, 1]], names[:, [1, 2]], names[:, [2, 0]]])
    there, counts = np.unique(edges, axis=0, return_counts=True)
    back = np.unique(edges[:, ::-1], axis=0)
    return bool((counts == 1).all()) and np.array_equal(there, back)


@pytest.mark.parametrize("body", ["counter", "disc"])
def test_stl_is_a_closed_solid(tmp_path: Path, result: Result, body: str) -> None:
    export(result, tmp_path, formats=["stl"], bodies=[body])
    corners = read_stl(tmp_path / f"{body}_worn.stl")
    assert is_closed(corners)
    heights = worn_heights(result, result.snapshot(-1), body)
    approach = result.history["approach"][-1]
    z = heights if body == "disc" else -heights - approach
    thickness = 0.1 * (result.x[-1] - result.x[0])
    back = np.nanmin(z) - thickness if body == "disc" else np.nanmax(z) + thickness
    # Under two triangles of a quad a - b - c and a - c - d lies the mean of a, a, b, c, c, d.
    depth = np.abs(z - back)
    a, b, c, d = depth[:-1, :-1], depth[1:, :-1], depth[1:, 1:], depth[:-1, 1:]
    volume = np.nansum((2 * a + b + 2 * c + d) / 6.0) * result.study.grid.cell**2
    first, second, third = corners.swapaxes(0, 1)
    assert np.sum(np.cross(first, second) * third) / 6.0 == pytest.approx(volume, rel=1e-6)
    whole = body == "disc"
    assert (
        corners[..., 0].min() == pytest.approx(result.x[0]) if whole else corners[..., 0].min() > result.x[0]
    )
    ends = sorted([back, np.nanmax(z) if whole else np.nanmin(z[1:-1, 1:-1])])
    assert (corners[..., 2].min(), corners[..., 2].max()) == pytest.approx(ends)


def test_another_reader_reads_the_stl(tmp_path: Path, result: Result) -> None:
    trimesh = pytest.importorskip("trimesh")
    export(result, tmp_path, formats=["stl"])
    for body in ("counter", "disc"):
        mesh = trimesh.load(tmp_path / f"{body}_worn.stl")
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert mesh.volume > 0.0


def test_points_are_means_of_blocks(tmp_path: Path, result: Result) -> None:
    export(result, tmp_path, formats=["npy", "csv"], points=25, bodies=["disc"], fields=["wear_disc"])
    heights = worn_heights(result, result.snapshot(-1), "disc")
    means = heights.reshape(25, 3, 25, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(np.load(tmp_path / "disc_worn.npy"), means, rtol=1e-12)
    table = np.loadtxt(tmp_path / "fields.csv", delimiter=",", skiprows=1)
    assert table.shape == (625, 3)
    np.testing.assert_allclose(table[::25, 0], result.x.reshape(25, 3).mean(axis=1), rtol=1e-11)
    # so that volumes stay
    assert table[:, 2].sum() * 9 == pytest.approx(result.snapshot(-1).wear_disc.sum())


def test_csv_has_labelled_columns(tmp_path: Path, result: Result) -> None:
    export(result, tmp_path, formats=["csv"], snapshot="3 mm")
    snapshot = result.at("3 mm")
    with (tmp_path / "fields.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = list(csv.reader(file))
    assert header[:4] == ["x [mm]", "y [mm]", "pressure [MPa]", "wear_counter [mm]"]
    assert header[-2:] == ["height_counter [mm]", "height_disc [mm]"]
    table = np.array(rows, dtype=float)
    shape = snapshot.pressure.shape
    np.testing.assert_allclose(table[:, 0].reshape(shape)[:, 0], result.x, rtol=1e-11)
    np.testing.assert_allclose(table[:, 1].reshape(shape)[0], result.y, rtol=1e-11)
    np.testing.assert_allclose(table[:, 2].reshape(shape), snapshot.pressure, rtol=1e-11)
    heights = worn_heights(result, snapshot, "counter")
    np.testing.assert_allclose(table[:, -2].reshape(shape), heights, rtol=1e-11)
    middle = shape[0] // 2
    along = np.loadtxt(tmp_path / "profile_along.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(along[:, 1], snapshot.pressure[:, middle], rtol=1e-11)
    across = np.loadtxt(tmp_path / "profile_across.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(across[:, 0], result.y, rtol=1e-11)
    np.testing.assert_allclose(across[:, 3], snapshot.wear_disc[middle], rtol=1e-11)
