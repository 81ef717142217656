"""Files for ParaView, MountainsMap, MATLAB and CAD: read back they hold the same numbers, axes and units."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from cases_formats import EVIL, Vtk, needs, read_x3p, result, swept
from click.testing import CliRunner

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli.main import commands
from warpwear.history.quantities import FIELDS
from warpwear.results.export import FORMATS, export
from warpwear.results.formats.bodies import NO_SURFACE, worn_heights

__all__ = ["result", "swept"]  # the fixtures


@pytest.fixture(scope="module")
def images(tmp_path_factory: pytest.TempPathFactory, result: Result) -> Path:
    """The result as it is written for ParaView."""
    folder = tmp_path_factory.mktemp("images")
    export(result, folder, formats="vti")
    return folder


def test_images_hold_the_fields(images: Path, result: Result) -> None:
    for number, snapshot in enumerate(result.snapshots):
        image = Vtk(images / f"fields_{number:04d}.vti")
        assert image.kind == "ImageData"
        assert image.time == snapshot.distance
        for name, values in snapshot.fields.items():
            expected = np.where(values > NO_SURFACE, np.nan, values) if name == "gap" else values
            np.testing.assert_array_equal(image.arrays[f"{name} [{FIELDS[name].units}]"], expected)
        for body in ("counter", "disc"):
            found = image.arrays[f"height_{body} [mm]"]
            np.testing.assert_array_equal(found, worn_heights(result, snapshot, body))
        origin, spacing = ([float(v) for v in image.grid.attrib[k].split()] for k in ("Origin", "Spacing"))
        np.testing.assert_allclose(origin[0] + spacing[0] * np.arange(result.x.size), result.x, atol=1e-15)
        np.testing.assert_allclose(origin[1] + spacing[1] * np.arange(result.y.size), result.y, atol=1e-15)


def test_surfaces_lie_in_space_as_the_bodies_do(tmp_path: Path, result: Result) -> None:
    export(result, tmp_path, formats=["vti"], snapshot="all")
    for number, snapshot in enumerate(result.snapshots):
        row = int(np.argmin(np.abs(result.history["distance"] - snapshot.distance)))
        approach = result.history["approach"][row]
        places = {}
        for body in ("counter", "disc"):
            surface = Vtk(tmp_path / f"{body}_{number:04d}.vts")
            points = surface.arrays["points [mm]"]
            np.testing.assert_allclose(points[:, 0, 0], result.x, rtol=1e-7)
            np.testing.assert_allclose(points[0, :, 1], result.y, rtol=1e-7)
            assert np.isfinite(points).all()
            heights = worn_heights(result, snapshot, body)
            np.testing.assert_array_equal(surface.arrays[f"height_{body} [mm]"], heights)
            hidden = surface.arrays.get("vtkGhostType", np.zeros(surface.shape))
            np.testing.assert_array_equal(hidden, np.where(np.isnan(heights), 2, 0))
            assert f"wear_{'disc' if body == 'counter' else 'counter'} [mm]" not in surface.arrays
            places[body] = np.where(hidden == 0, points[:, :, 2], np.nan)
        # The gap of the result is that of bodies which have not come down on each other.
        gap = np.where(snapshot.gap > NO_SURFACE, np.nan, snapshot.gap)
        np.testing.assert_allclose(places["counter"] - places["disc"], gap - approach, atol=1e-7)
    assert np.isnan(places["counter"]).any()


def test_a_film_is_timed_by_the_distance(images: Path, result: Result) -> None:
    for name, ending in (("fields", "vti"), ("counter", "vts"), ("disc", "vts")):
        entries = [one.attrib for one in ElementTree.parse(images / f"{name}.pvd").iter("DataSet")]
        assert [float(entry["timestep"]) for entry in entries] == result.snapshot_distances.tolist()
        assert [entry["file"] for entry in entries] == [f"{name}_{n:04d}.{ending}" for n in range(3)]
        assert all((images / entry["file"]).is_file() for entry in entries)


def test_vtk_itself_reads_them(images: Path, result: Result) -> None:
    pyvista = pytest.importorskip("pyvista")
    last = result.snapshot(-1)
    image = pyvista.read(images / "fields_0002.vti")
    assert image.dimensions == (*last.pressure.shape, 1)
    np.testing.assert_array_equal(
        image["pressure [MPa]"].reshape(last.pressure.shape, order="F"), last.pressure
    )
    np.testing.assert_allclose(image.bounds[:2], (result.x[0], result.x[-1]))
    assert image.field_data["study"][0] == result.study.study.name
    surface = pyvista.read(images / "counter_0002.vts")
    heights = surface["height_counter [mm]"].reshape(last.pressure.shape, order="F")
    np.testing.assert_array_equal(heights, worn_heights(result, last, "counter"))
    film = pyvista.get_reader(str(images / "disc.pvd"))
    assert film.time_values == result.snapshot_distances.tolist()


def test_netcdf_is_labelled(tmp_path: Path, result: Result) -> None:
    needs("netcdf")
    import xarray

    (path,) = export(result, tmp_path, formats=["netcdf"])
    with xarray.open_dataset(path, engine="h5netcdf") as found:
        assert found["pressure"].dims == ("distance", "x", "y")
        np.testing.assert_array_equal(found["distance"], result.snapshot_distances)
        np.testing.assert_array_equal(found["x"], result.x)
        assert all(found[axis].attrs["units"] == "mm" for axis in ("x", "y", "distance", "step_distance"))
        assert all(found[name].attrs["long_name"] for name in found.variables)
        for name, column in result.history.items():
            column_found = found["step_distance" if name == "distance" else name]
            np.testing.assert_array_equal(column_found, column)
            assert column_found.attrs["units"] == result.units[name]
        for number, snapshot in enumerate(result.snapshots):
            for name in ("pressure", "wear_counter", "wear_disc"):
                np.testing.assert_array_equal(found[name][number], snapshot.fields[name])
                assert found[name].attrs["units"] == FIELDS[name].units
            for body in ("counter", "disc"):
                heights = worn_heights(result, snapshot, body)
                np.testing.assert_array_equal(found[f"height_{body}"][number], heights)
        assert found.attrs["Conventions"].startswith("CF-")
        assert found.attrs["title"] == "v3-fine"
        assert found.attrs["comment"] == EVIL
        assert found.attrs["source"] == f"warpwear {result.attributes['version']}"
        assert "exported by warpwear" in found.attrs["history"]
        assert found.attrs["study"] == result.study.to_toml()


def test_netcdf_of_a_track_has_all_of_it(tmp_path: Path, swept: Result) -> None:
    needs("netcdf")
    import xarray

    (path,) = export(swept, tmp_path, formats=["netcdf"], snapshot=-1)
    with xarray.open_dataset(path, engine="h5netcdf") as found:
        last = swept.snapshot(-1)
        assert found["wear_disc"].dims == ("distance", "track_x", "y")
        np.testing.assert_array_equal(found["distance"], [last.distance])
        np.testing.assert_array_equal(found["wear_disc"][0], last.wear_disc)
        assert last.plastic_disc is not None
        worn = swept.track_heights() - last.wear_disc - last.plastic_disc
        np.testing.assert_allclose(found["height_track"][0], worn, atol=1e-18)
        assert int(found["track_row"][0]) == last.row


def test_fields_can_be_chosen(tmp_path: Path, result: Result) -> None:
    export(result, tmp_path, formats=["vti", "csv"], fields=["pressure"], bodies=["disc"])
    assert set(Vtk(tmp_path / "fields_0000.vti").arrays) == {"pressure [MPa]"}
    assert (tmp_path / "fields.csv").read_text().splitlines()[0] == "x [mm],y [mm],pressure [MPa]"
    assert not (tmp_path / "counter_0000.vts").exists()


def test_several_snapshots_have_numbers(tmp_path: Path, result: Result) -> None:
    paths = result.export(tmp_path, formats=["npy"], snapshot=[0, "30 mm"], bodies=["disc"])
    assert [path.name for path in paths] == ["disc_worn_0000.npy", "disc_worn_0002.npy"]
    assert np.array_equal(np.load(paths[0]), worn_heights(result, result.snapshot(0), "disc"))


def test_a_track_shows_the_counter_where_it_is(tmp_path: Path, swept: Result) -> None:
    export(swept, tmp_path, formats=["vti"], bodies=["counter", "track"])
    last = swept.snapshot(-1)
    counter = Vtk(tmp_path / "counter_0001.vts").arrays["points [mm]"]
    middle = counter[counter.shape[0] // 2, 0, 0]
    assert middle == pytest.approx(swept.history["position"][-1], abs=swept.study.grid.cell)
    track = Vtk(tmp_path / "track_fields_0001.vti")
    np.testing.assert_array_equal(track.arrays["wear_disc [mm]"], last.wear_disc)
    fields = Vtk(tmp_path / "fields_0001.vti")
    np.testing.assert_array_equal(fields.arrays["wear_disc [mm]"], last.wear_beneath)


def test_a_track_is_a_table_of_its_own(tmp_path: Path, swept: Result) -> None:
    export(swept, tmp_path, formats=["csv"], bodies=["track"], fields=["wear_disc", "pressure"])
    last = swept.snapshot(-1)
    table = np.loadtxt(tmp_path / "track_fields.csv", delimiter=",", skiprows=1)
    assert (tmp_path / "track_fields.csv").read_text().startswith("x [mm],y [mm],wear_disc [mm]\n")
    columns = [values.reshape(last.wear_disc.shape) for values in table.T]
    np.testing.assert_allclose(columns[0][:, 0], swept.track_x, rtol=1e-11)
    np.testing.assert_allclose(columns[1][0], swept.y, rtol=1e-11)
    np.testing.assert_allclose(columns[2], last.wear_disc, rtol=1e-11)
    under = np.loadtxt(tmp_path / "fields.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(under[:, 2].reshape(last.pressure.shape), last.wear_beneath, rtol=1e-11)


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_writes_every_kind_of_run(tmp_path: Path, name: str) -> None:
    needs(name)
    kinds: dict[str, dict[str, Any]] = {
        "two-scale": {"grid.cell": "25 um", "sliding.distance": "1 mm", "disc.synthetic.cut_off": "50 um"},
        "v1": {"sliding.distance": "0 mm"},
    }
    for kind, changes in kinds.items():
        result = warpwear.run(Study.load(kind).replace(changes))
        paths = export(result, tmp_path / kind, formats=[name])
        assert paths
        assert all(path.stat().st_size > 0 for path in paths)
        assert {path.name for path in paths} == {path.name for path in (tmp_path / kind).iterdir()}


@pytest.mark.parametrize("name", FORMATS)
def test_names_are_harmless(tmp_path: Path, result: Result, name: str) -> None:
    """A description, a name beyond what studies allow, and a folder with what HTML, XML and shells mean."""
    needs(name)
    about = result.study.study.model_copy(update={"name": EVIL})
    study = result.study.model_copy(update={"study": about})
    named = Named(result, study)
    folder = tmp_path / "<b> $HOME & 'x' \"y\""
    for path in export(named, folder, formats=[name]):  # type: ignore[arg-type]
        if path.suffix in (".vti", ".vts", ".pvd"):
            ElementTree.parse(path)
        if path.suffix in (".vti", ".vts"):
            assert Vtk(path).texts["study"] == EVIL
        if path.suffix == ".x3p":
            assert EVIL in read_x3p(path)[1]["Record2/Comment"]
        assert b"<script>" not in path.read_bytes() or path.suffix == ".nc"  # whose texts nobody interprets


class Named:
    """A result whose study bears another name."""

    def __init__(self, result: Result, study: Study) -> None:
        self._result, self.study = result, study

    def __getattr__(self, name: str) -> Any:
        return getattr(self._result, name)


def test_bad_input(tmp_path: Path, result: Result, swept: Result) -> None:
    def refused(words: str, **how: Any) -> None:
        with pytest.raises(InputError, match=words):
            export(result, tmp_path / "out", **how)

    refused(
        "format = 'obj' is not known; allowed: sdf, xyz, npy, x3p, stl, csv, vti, netcdf", formats=["obj"]
    )
    refused("body = 'track' is not known; allowed: counter, disc", formats=["stl"], bodies=["track"])
    refused("field = 'heat' is not known; allowed: pressure", formats=["csv"], fields=["heat"])
    refused("fields changes nothing in stl; it is for csv, vti, netcdf", formats=["stl"], fields=["gap"])
    refused("points = 1 make no surface; allowed: 2 or more", formats=["stl"], points=1)
    refused("snapshot = 3 is not in this result; allowed: 0 to 2, -1 is the last, a", snapshot=3)
    refused("'7 mm': no snapshot is kept there; allowed: 1 mm, 3 mm, 30 mm", snapshot="7 mm")
    refused(
        "field = 'bare' is not known; .*gap, height_counter, height_disc", formats=["csv"], fields=["bare"]
    )
    assert not (tmp_path / "out").exists()


def test_a_missing_package_is_named(tmp_path: Path, result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(InputError, match=r"'netcdf' needs the package xarray: pip install 'warpwear\[io\]'"):
        export(result, tmp_path / "out", formats=["netcdf"])
    assert not (tmp_path / "out").exists()


def test_all_or_nothing(tmp_path: Path, result: Result, failing: Callable[[str, Exception], None]) -> None:
    """A disk that fills up at the last file leaves what was there, and nothing new."""
    (tmp_path / "disc.pvd").write_text("mine")
    with pytest.raises(InputError, match=r"already holds disc\.pvd"):
        export(result, tmp_path, formats=["npy", "vti"])

    failing("warpwear.results.formats.vtk._write_film", OSError(28, "No space left on device"))
    for folder in (tmp_path, tmp_path / "new"):
        with pytest.raises(InputError, match="cannot be written: No space left on device"):
            export(result, folder, formats=["npy", "vti"], overwrite=True)
    assert [path.name for path in tmp_path.iterdir()] == ["disc.pvd"]
    assert (tmp_path / "disc.pvd").read_text() == "mine"


def test_the_command(tmp_path: Path) -> None:
    study = Study.load("v3-fine").replace({"grid.cell": "50 um", "sliding.distance": "3 mm"})
    warpwear.run(study, out=tmp_path / "run", plots=False).close()
    called = ["export", str(tmp_path / "run"), "--format", "x3p", "--format", "vti", "--snapshot", "-1"]
    done = CliRunner().invoke(commands, [*called, "--field", "pressure", "--body", "disc"])
    assert done.exit_code == 0, done.output
    names = [Path(line).name for line in done.output.splitlines()]
    count = Result.open(tmp_path / "run").snapshot_distances.size - 1
    images = [f"fields_{count:04d}.vti", f"disc_{count:04d}.vts", "fields.pvd", "disc.pvd"]
    assert names == ["disc_worn.x3p", *images]
    assert sorted(names) == sorted(path.name for path in (tmp_path / "run" / "export").iterdir())
    again = CliRunner().invoke(commands, called)
    assert isinstance(again.exception, InputError)
    shown = CliRunner().invoke(commands, ["export", "--help"]).output
    assert all(name in shown for name in FORMATS)
