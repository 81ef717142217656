"""Worn bodies written for other software come back as they were."""

from pathlib import Path

import numpy as np
import pytest

import warpwear
from warpwear import InputError, Result, Study
from warpwear.results.export import export
from warpwear.results.formats.bodies import worn_heights


@pytest.fixture(scope="module")
def result() -> Result:
    study = Study.load("v3-fine").replace(
        {"grid.cell": "20 um", "sliding.distance": "30 mm", "output.snapshots": ["3 mm"]}
        | {"output.precision": "double"}
    )
    return warpwear.run(study)


def test_worn_heights_are_the_bodies(result: Result) -> None:
    last = result.snapshot(-1)
    counter, disc = (worn_heights(result, last, body) for body in ("counter", "disc"))
    # At contact the two bodies are an approach apart, less the gap.
    np.testing.assert_allclose(-counter - disc, last.gap, atol=1e-15)
    # What was worn off both is what they are short of the unworn bodies.
    x, y = np.meshgrid(result.x, result.y, indexing="ij")
    np.testing.assert_allclose(counter + last.wear_counter, np.sqrt(9.0 - x**2 - y**2) - 3.0, atol=1e-15)
    from warpwear.study.surface import surface_of

    unworn = surface_of(result.study.disc).heights(result.x, result.y)
    np.testing.assert_allclose(disc + last.wear_disc, unworn, atol=1e-15)


@pytest.mark.parametrize("body", ["counter", "disc"])
def test_round_trips(tmp_path: Path, result: Result, body: str) -> None:
    sdfio = pytest.importorskip("sdfio")
    paths = {p.name: p for p in export(result, tmp_path / "out")}
    heights = worn_heights(result, result.snapshot(-1), body)
    sdf = sdfio.read(str(paths[f"{body}_worn.sdf"]))
    np.testing.assert_allclose(1e3 * sdf.data.T, heights, rtol=1e-9, atol=1e-14)
    assert sdf.header.x_scale == pytest.approx(20e-6)
    assert paths[f"{body}_worn.sdf"].read_bytes().startswith(b"aISO-1.0")
    points = np.loadtxt(paths[f"{body}_worn.xyz"])
    assert points.shape == (75 * 75, 3)
    np.testing.assert_allclose(points[:, 2].reshape(75, 75), heights, rtol=1e-8)
    np.testing.assert_allclose(points[:75, 1], result.y, rtol=1e-8)
    np.testing.assert_array_equal(np.load(paths[f"{body}_worn.npy"]), heights)


def test_another_reader_reads_the_sdf(tmp_path: Path, result: Result) -> None:
    pytest.importorskip("SurfaceTopography")
    pytest.importorskip("sdfio")
    from warpwear.surfaces.measured import read_measured
    from warpwear.surfaces.preparation import Preparation

    export(result, tmp_path, formats=["sdf"])
    again = read_measured(tmp_path / "disc_worn.sdf", Preparation(level="none"))
    heights = worn_heights(result, result.snapshot(-1), "disc")
    read = again.heights(result.x, result.y)
    np.testing.assert_allclose(read - read.mean(), heights - heights.mean(), atol=1e-9)


def test_an_earlier_snapshot(tmp_path: Path, result: Result) -> None:
    export(result, tmp_path, snapshot=0, formats=["npy"])
    heights = worn_heights(result, result.snapshot(0), "disc")
    np.testing.assert_array_equal(np.load(tmp_path / "disc_worn.npy"), heights)


def test_bad_input(tmp_path: Path, result: Result) -> None:
    with pytest.raises(InputError, match=r"format = 'obj' is not known; allowed: sdf, xyz, npy"):
        export(result, tmp_path / "out", formats=["obj"])
    with pytest.raises(InputError, match=r"snapshot = 7 is not in this result; allowed: 0 to 1"):
        export(result, tmp_path / "out", snapshot=7)
    assert not (tmp_path / "out").exists()
    export(result, tmp_path / "out", formats=["npy"])
    with pytest.raises(InputError, match=r"already holds counter_worn\.npy"):
        export(result, tmp_path / "out", formats=["npy"])
    export(result, tmp_path / "out", formats=["npy"], overwrite=True)


def test_beyond_the_counter_there_is_nothing() -> None:
    study = Study.load("v3-fine").replace(
        {"grid.cell": "20 um", "sliding.distance": "0 mm", "counter.radius": "0.6 mm"}
        | {"output.precision": "double"}
    )
    result = warpwear.run(study)
    counter = worn_heights(result, result.snapshot(-1), "counter")
    assert np.isnan(counter[0, 0])
    assert np.isfinite(counter[37, 37])
    disc = worn_heights(result, result.snapshot(-1), "disc")
    from warpwear.study.surface import surface_of

    np.testing.assert_allclose(disc, surface_of(result.study.disc).heights(result.x, result.y), atol=1e-14)
