"""Studies whose disc is a measured file, from the file to the figures."""

from pathlib import Path

import numpy as np
import pytest

import warpwear
from warpwear import InputError, Study

SHARED = Path(__file__).parents[3] / "shared" / "surfaces"


def study_of(path: Path, **changes: str) -> Study:
    common = {
        "disc.surface": str(path),
        "grid.cell": "5 um",
        "sliding.distance": "30 mm",
        "output.snapshots": [],
    }
    return Study.load("v3-fine").replace(common | {k.replace("__", "."): v for k, v in changes.items()})


def needs(path: Path) -> Path:
    pytest.importorskip("SurfaceTopography")
    if not path.is_file():
        pytest.skip("the measured file is not here")
    return path


@pytest.mark.parametrize(
    ("name", "drawn"),
    [
        ("al3d-1.al3d", False),
        ("sur-2.sur", False),
        pytest.param("al3d-1.al3d", True, marks=pytest.mark.slow),
        pytest.param("sur-2.sur", True, marks=pytest.mark.slow),
    ],
)
def test_a_measured_disc_runs_and_draws_its_figures(tmp_path: Path, name: str, drawn: bool) -> None:
    extend = {"disc__extend": "mirror"} if name.endswith(".al3d") else {}
    result = warpwear.run(study_of(needs(SHARED / name), **extend), out=tmp_path / "out", plots=drawn)
    assert result.finished
    there = {path.stem for path in (tmp_path / "out").glob("figures/*.png")}
    assert there == (set(result.plot.names("essential")) if drawn else set())
    assert max(map(abs, result.summary["conservation_relative"].values())) < 1e-10
    record = result.summary["surface"]
    assert record["kind"] == "measured"
    assert record["file"].endswith(name)
    assert record["missing"] == (0 if name.endswith(".al3d") else pytest.approx(117, abs=60))


def test_a_measurement_that_is_too_small_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"disc\.extend is \"refuse\".*allowed is \"mirror\""):
        warpwear.run(study_of(needs(SHARED / "al3d-1.al3d")), out=tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_a_npy_file_equals_the_surface_it_holds(tmp_path: Path) -> None:
    # The heights of a synthetic disc, saved and measured back, give the same contact.
    synthetic = Study.load("v3-fine").replace(
        {"grid.cell": "5 um", "sliding.distance": "30 mm", "output.snapshots": []}
    )
    grid = synthetic.cells
    from warpwear.study.surface import surface_of

    heights = surface_of(synthetic.disc).heights(grid.x, grid.y)
    np.save(tmp_path / "disc.npy", 1e3 * heights)
    measured = study_of(tmp_path / "disc.npy", disc__pixel="5 um", disc__height_unit="um", disc__level="none")
    one, other = warpwear.run(synthetic), warpwear.run(measured)
    for name in ("area_contact", "area_touched", "wear_depth_disc"):
        np.testing.assert_allclose(other.history[name], one.history[name], rtol=1e-9)
    # The file's heights are taken from their mean plane.
    shift = one.history["approach"] - other.history["approach"]
    np.testing.assert_allclose(shift, -heights.mean(), atol=1e-12)


def test_a_spike_decides_the_contact_unless_it_is_removed(tmp_path: Path) -> None:
    from warpwear.surfaces.reading import read

    reading = read(needs(SHARED / "sur-2.sur"))
    heights = 1e3 * reading.heights
    spiked = heights.copy()
    spiked[396, 242] += 50.0  # 0.4 mm from the middle, where the counter-body is 27 µm up
    seen = {}
    for name, field in (("clean", heights), ("spiked", spiked)):
        np.save(tmp_path / f"{name}.npy", field)
        for outliers in (None, 50.0):
            changes = {
                "disc.pixel": f"{reading.pixel[0]} mm",
                "disc.height_unit": "um",
                "grid.cell": "2 um",
                "sliding.distance": "0 mm",
            } | ({} if outliers is None else {"disc.outliers": outliers})
            result = warpwear.run(study_of(tmp_path / f"{name}.npy").replace(changes))
            seen[name, outliers] = {
                key: float(result.history[key][0]) for key in ("area_nominal", "patch_along", "approach")
            }
    assert seen["spiked", 50.0] == pytest.approx(seen["clean", 50.0], rel=2e-3)
    assert seen["clean", None] == pytest.approx(seen["clean", 50.0], rel=0.05)
    assert seen["spiked", None]["patch_along"] > 2.0 * seen["clean", None]["patch_along"]
    told = result.summary["surface"]["operations"]
    assert any("outliers: " in text and "the farthest 50" in text for text in told)
