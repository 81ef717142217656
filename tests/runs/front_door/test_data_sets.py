"""The package as NumPy users hold it: tables of pandas and data sets of xarray out."""

import tomllib
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from cases_front_door import study_of

import warpwear
from warpwear import InputError, Result, Study


@pytest.fixture(scope="module")
def tiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("front") / "tiled"
    warpwear.run(study_of("two-scale", grid__cell="10 um"), out=out, plots=False).close()
    return out


def test_the_history_as_a_data_frame(folder: Path) -> None:
    pytest.importorskip("pandas")
    with Result.open(folder) as result:
        frame = result.to_dataframe()
        assert list(frame.columns) == list(result.history)
        np.testing.assert_array_equal(frame["cof"], result.history["cof"])
        assert frame.attrs["units"]["area_contact"] == "mm^2"
        assert frame.index.name == "step"


def test_a_result_as_a_data_set(folder: Path) -> None:
    pytest.importorskip("xarray")
    with Result.open(folder) as result:
        data = result.to_xarray()
        assert dict(data.sizes) == {"step": result.history["cof"].size, "distance": 3, "x": 75, "y": 75}
        assert data["pressure"].dims == ("distance", "x", "y")
        assert data["cof"].dims == ("step",)
        np.testing.assert_array_equal(data["gap"].sel(distance=0.3), result.at("0.3 mm").gap)
        np.testing.assert_array_equal(data["step_distance"], result.history["distance"])
        assert data["pressure"].attrs["units"] == "MPa"
        assert data["wear_depth_disc"].attrs["long_name"] == "deepest wear of a cell of the disc"
        np.testing.assert_array_equal(data["x"], result.x)


def test_tracks_and_patches_as_data_sets(swept: Path, tiled: Path) -> None:
    pytest.importorskip("xarray")
    with Result.open(swept) as result:
        data = result.to_xarray()
        assert data["wear_disc"].dims == data["plastic_disc"].dims == ("distance", "track_x", "y")
        assert data["gap"].dims == ("distance", "x", "y")
        assert data["track_row"].values.tolist() == [s.row for s in result.snapshots]
    with Result.open(tiled) as result:
        data = result.to_xarray()
        assert data["load_share"].dims == ("step", "patch")
        np.testing.assert_allclose(data["load_share"].sum("patch"), 8.0, rtol=1e-9)
        shares = data["load_share"].isel(step=-1)
        # The contact sits in the middle: the loads' centre is the apex, within a macro cell.
        for axis in ("patch_x", "patch_y"):
            assert abs(float((shares * data[axis]).sum() / shares.sum())) < 0.05


@pytest.mark.parametrize("package", ["pandas", "xarray"])
def test_a_package_that_is_missing_is_one_sentence(
    folder: Path, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, package, None)
    with Result.open(folder) as result:
        make = result.to_dataframe if package == "pandas" else result.to_xarray
        with pytest.raises(InputError, match=rf"needs the package {package}: pip install 'warpwear\[io\]'"):
            make()


def test_groups_of_the_file_open_in_xarray(folder: Path, swept: Path, tiled: Path) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")

    def opened(of: Path, group: str) -> Any:
        return xarray.open_dataset(of / "result.h5", group=group, engine="h5netcdf")

    with opened(folder, "snapshots/0001") as data, Result.open(folder) as result:
        assert data["pressure"].dims == ("x", "y")
        np.testing.assert_array_equal(data["pressure"], result.snapshot(1).pressure)
        np.testing.assert_array_equal(data["x"], result.x)
        assert data["pressure"].attrs["units"] == "MPa"
        assert data["pressure"].attrs["long_name"].startswith("contact pressure")
    with opened(folder, "history") as data:
        assert set(data.sizes) == {"distance"}
        assert data["cof"].sel(distance=3.0, method="nearest") == data["cof"][-1]
    with opened(swept, "snapshots/0000") as data:
        assert data["wear_disc"].dims == data["plastic_disc"].dims == ("track_x", "y")
        assert data["gap"].dims == ("x", "y")
    with opened(swept, "track") as data:
        assert data["heights"].dims == ("track_x", "y")
    with opened(tiled, "history") as data:
        assert data["load_share"].dims == ("distance", "patch")


def test_labels_of_axes_take_no_room(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Hard links, and references of some hundred bytes a dataset."""
    with h5py.File(folder / "result.h5") as file:
        assert file["snapshots/0002/x"] == file["snapshots/0000/x"] == file["grid/x"]
        assert file["snapshots/0002/gap"].dims[0].keys() == ["x"]
        datasets = 4 * len(file["snapshots"]) + len(file["history"])
        study = Study(**tomllib.loads(file.attrs["study"]))
    monkeypatch.setattr("warpwear.results.writer._label", lambda *_: None)
    warpwear.run(study, out=tmp_path / "bare", plots=False).close()
    bare, labelled = ((of / "result.h5").stat().st_size for of in (tmp_path / "bare", folder))
    assert labelled - bare < 300 * datasets


@pytest.mark.slow
def test_more_snapshots_than_a_scale_can_list(monkeypatch: pytest.MonkeyPatch) -> None:
    """A list of its users in a scale ends at 64 KiB: labels do not keep one."""
    stops = [f"{d:g} mm" for d in np.linspace(0.002, 3.0, 1300)]
    study = study_of(grid__cell="50 um", output__snapshots=stops, stepping__increment="1 mm")
    with warpwear.run(study) as result:
        assert len(result.snapshots) == 1300
        assert len(result.snapshots[700].fields) == 4
