"""The package as NumPy users hold it: heights as arrays in, steps and tables out."""

import ast
import inspect
import logging
import pickle
import shutil
import tomllib
import warnings
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import warpwear
from warpwear import InputError, Result, Study
from warpwear.history.quantities import columns_of
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.checkpoint import holds_checkpoint
from warpwear.runs.step import RunStep
from warpwear.study.surface import surface_in

QUICK = {"grid.cell": "20 um", "sliding.distance": "3 mm", "output.snapshots": ["0.3 mm"]}
TRACK = {"grid.cell": "20 um", "sliding.distance": "12 mm", "output.snapshots": ["3.1 mm"]}


def study_of(preset: str = "v3-fine", **changes: Any) -> Study:
    base = TRACK if preset == "track" else QUICK
    return Study.load(preset).replace(base | {k.replace("__", "."): v for k, v in changes.items()})


def rough(shape: tuple[int, int], *, seed: int = 1) -> np.ndarray[Any, Any]:
    """Heights [mm] of a smooth random field, 1 µm rms, with a mean of 5 µm that says nothing."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).normal(size=shape))
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(shape[0]), np.fft.rfftfreq(shape[1]), indexing="ij"))
    heights = np.fft.irfft2(spectrum * np.exp(-((waves / 0.05) ** 2)), s=shape)
    return heights / heights.std() * 1.0e-3 + 5.0e-3


def same(one: Result, other: Result) -> None:
    """Every number of two results, to the last digit."""
    assert list(one.history) == list(other.history)
    for name, values in one.history.items():
        np.testing.assert_array_equal(values, other.history[name], err_msg=name)
    assert len(one.snapshots) == len(other.snapshots)
    for mine, theirs in zip(one.snapshots, other.snapshots, strict=True):
        for name, field in mine.fields.items():
            np.testing.assert_array_equal(field, theirs.fields[name], err_msg=name)


# --- heights as an array ---


def test_an_array_of_the_studys_own_surface_gives_its_contact(device: str, threads: int) -> None:
    study = study_of()
    heights = surface_in(study).heights(study.cells.x, study.cells.y)
    named = warpwear.run(study, device=device, threads=threads)
    given = warpwear.run(study, surface=heights, device=device, threads=threads)
    for name in ("area_contact", "wear_depth_disc", "pressure_std", "cof"):
        np.testing.assert_allclose(given.history[name], named.history[name], rtol=1e-9)
    # Heights count from their mean, so approaches do.
    shift = named.history["approach"] - given.history["approach"]
    np.testing.assert_allclose(shift, -heights.mean(), atol=1e-12)


def test_where_an_array_stands_says_nothing() -> None:
    heights = rough((75, 75))
    one, other = (warpwear.run(study_of(), surface=heights + offset) for offset in (0.0, 0.125))
    np.testing.assert_allclose(other.history["approach"], one.history["approach"], atol=1e-15)
    np.testing.assert_allclose(other.snapshot(-1).wear_disc, one.snapshot(-1).wear_disc, atol=1e-15)


@pytest.mark.parametrize("preset", ["v3-fine", "two-scale", "track"])
def test_the_folder_of_an_array_runs_again_by_itself(preset: str, tmp_path: Path) -> None:
    changes = {"grid__cell": "10 um"} if preset == "two-scale" else {}
    study = study_of(preset, **changes)
    heights = rough((study.track.rows if study.is_swept else study.cells.nx, study.cells.ny))
    out = tmp_path / "out"
    kept = warpwear.run(study, surface=heights, out=out, plots=False)
    same(kept, warpwear.run(study, surface=heights))
    np.testing.assert_array_equal(np.load(out / "surface.npy"), heights)
    same(kept, warpwear.run(Study.load(out)))
    same(kept, warpwear.run(kept.study))
    assert Study.load(out) == kept.study
    kept.close()
    moved = tmp_path / "elsewhere"
    shutil.move(out, moved)
    with Result.open(moved) as result:
        assert result.study.disc.surface == str((moved / "surface.npy").resolve())
        assert Study.load(moved) == result.study
        same(result, warpwear.run(Study.load(moved)))


def test_what_the_disc_was_before_is_gone(tmp_path: Path) -> None:
    np.save(tmp_path / "disc.npy", np.zeros((40, 40)))
    measured = study_of().replace(
        {
            "disc.surface": str(tmp_path / "disc.npy"),
            "disc.pixel": "50 um",
            "disc.height_unit": "um",
            "disc.height_sign": "down",
            "disc.sliding_axis": "y",
            "disc.crop": ["1 mm", "1 mm"],
            "disc.extend": "mirror",
            "disc.s_filter": "100 um",
            "disc.level": 4,
        }
    )
    heights = rough((75, 75))
    same(warpwear.run(measured, surface=heights), warpwear.run(study_of(), surface=heights))
    with warpwear.run(measured, surface=heights, out=tmp_path / "out", plots=False) as kept:
        same(kept, warpwear.run(kept.study))
        assert kept.study.disc.young == measured.disc.young


def test_anything_with_heights_is_a_surface() -> None:
    class Waves:
        def heights(self, x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
            return 1.0e-3 * np.cos(20.0 * x)[:, None] * np.cos(30.0 * y)[None, :]

        def notices(self, x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> list[str]:
            return []

        def record(self) -> dict[str, Any]:
            return {"kind": "waves"}

    study = study_of()
    heights = Waves().heights(study.cells.x, study.cells.y)
    same(warpwear.run(study, surface=Waves()), warpwear.run(study, surface=heights))
    same(warpwear.run(study, surface=heights.tolist()), warpwear.run(study, surface=heights))


def test_a_run_on_an_array_is_resumed_with_it_alone(tmp_path: Path) -> None:
    study, heights, out = study_of(), rough((75, 75)), tmp_path / "out"
    whole = warpwear.run(study, surface=heights)

    def stop(step: RunStep) -> None:
        if step.index == 20:
            raise TimeoutError("enough")

    with pytest.raises(TimeoutError):
        warpwear.run(study, surface=heights, out=out, plots=False, callback=stop)
    with pytest.raises(InputError, match=r"cannot go on: the disc's heights are not what they were"):
        warpwear.run(study, surface=heights + rough((75, 75), seed=2), out=out, plots=False, resume=True)
    with pytest.raises(InputError, match=r"is of another study .*disc"):
        warpwear.run(study, out=out, plots=False, resume=True)
    with warpwear.run(study, surface=heights, out=out, plots=False, resume=True) as resumed:
        same(resumed, whole)
    with pytest.raises(InputError, match="holds a run on another surface"):
        warpwear.run(study, surface=2.0 * heights, out=out, plots=False, resume=True)
    with warpwear.run(Study.load(out), out=out, plots=False, resume=True) as finished:
        same(finished, whole)


@pytest.mark.parametrize(
    ("preset", "surface", "message"),
    [
        ("v3-fine", np.zeros((75, 74)), r"the shape \(75, 74\); an array of the shape \(75, 75\) .*20 µm"),
        ("v3-fine", np.zeros(75), r"surface has the shape \(75,\)"),
        ("track", np.zeros((75, 75)), r"surface has the shape \(75, 75\).*of the track"),
        ("v3-fine", np.full((75, 75), np.nan), r"surface holds 5625 values that are no finite numbers"),
        ("v3-fine", "disc.sur", r"surface is a str; .*belongs in disc\.surface"),
        ("v3-fine", rough((75, 75)) * 1e5, r"disc\.height_unit|unit"),
        ("v1", np.zeros((150, 150)), r"does not apply to study\.model = 'macro'"),
    ],
)
def test_what_is_no_surface_is_refused(preset: str, surface: Any, message: str, tmp_path: Path) -> None:
    study = Study.load("v1") if preset == "v1" else study_of(preset)
    with pytest.raises(InputError, match=message):
        warpwear.run(study, surface=surface, out=tmp_path / "out")
    with pytest.raises(InputError, match=message):
        next(iter(warpwear.steps(study, surface=surface)))
    assert not (tmp_path / "out").exists()


# --- steps and callbacks ---


@pytest.mark.parametrize(
    ("preset", "changes"),
    [
        ("v1", {}),
        ("v3", {}),
        ("v3-fine", {}),
        ("v3-fine", {"contact__law": "half-space"}),
        ("v3-fine", {"wear__law": "exponential", "wear__decay": "0.1 1/mm"}),
        ("two-scale", {"grid__cell": "10 um"}),
        ("track", {}),
        ("track", {"sliding__plastic": "keep"}),
    ],
)
def test_steps_are_those_of_a_run(preset: str, changes: dict[str, Any]) -> None:
    study = study_of(preset, **changes)
    result = warpwear.run(study)
    snapshots = {snapshot.distance: snapshot for snapshot in result.snapshots}
    steps = []
    for step in warpwear.steps(study):
        steps.append(step)
        assert step.row is step.row
        if step.row["distance"] in snapshots:
            kept = snapshots.pop(step.row["distance"])
            assert step.snapshot().row == kept.row
            assert set(step.fields) == set(kept.fields)
            for name, field in step.fields.items():
                np.testing.assert_array_equal(field, kept.fields[name])
    assert not snapshots
    assert [step.index for step in steps] == list(range(steps[0].count))
    for column in columns_of(study):
        values = [step.row[column.name] for step in steps]
        np.testing.assert_array_equal(values, result.history[column.name], err_msg=column.name)
    assert steps[0].units["cof"] == "1"
    for named in (steps[0].row, steps[0].units):
        with pytest.raises(InputError, match=r"no column, field or table 'coff'; did you mean 'cof'\?"):
            named["coff"]
    with pytest.raises(InputError, match="step 0 is over"):
        steps[0].snapshot()
    # Kept steps keep no fields.
    assert not [v for step in steps for v in vars(step).values() if isinstance(v, np.ndarray)]


def test_fields_of_every_step_on_every_device(device: str, threads: int) -> None:
    study = study_of(output__snapshots=[])
    area = study.cells.cell_area
    before = None
    for step in warpwear.steps(study, device=device, threads=threads):
        if step.index % 10:
            continue
        row, snapshot = step.row, step.snapshot()
        assert snapshot.pressure.sum() * area == pytest.approx(8.0, rel=1e-9)
        assert snapshot.wear_disc.sum() * area == pytest.approx(row["wear_volume_disc"], rel=1e-9)
        assert (snapshot.pressure > 0.0).sum() == row["cells_in_contact"]
        if before is not None:  # a copy stays as it was
            assert before[0].wear_disc.sum() * area == pytest.approx(before[1]["wear_volume_disc"])
        before = snapshot, row


@pytest.mark.parametrize("stopped", [False, True])
def test_steps_that_are_made_in_blocks_are_made_alone_for_who_watches(
    stopped: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a GPU: within a block there would be no fields, and no checkpoint to go on from."""
    init, study, area = OneScaleModel.__init__, study_of(), study_of().cells.cell_area

    def in_blocks(self: OneScaleModel, *args: Any, **kwargs: Any) -> None:
        init(self, *args, **kwargs)
        self.blocks_allowed = True

    def watch(step: RunStep) -> None:
        snapshot = step.snapshot()
        assert snapshot.pressure.sum() * area == pytest.approx(8.0, rel=1e-9)
        assert snapshot.wear_disc.sum() * area == pytest.approx(step.row["wear_volume_disc"], rel=1e-9)
        if stopped and step.index == 30:
            raise TimeoutError("enough")

    monkeypatch.setattr(OneScaleModel, "__init__", in_blocks)
    whole = warpwear.run(study, callback=None if stopped else watch)
    if stopped:
        with pytest.raises(TimeoutError):
            warpwear.run(study, out=tmp_path / "out", plots=False, callback=watch)
        resumed = warpwear.run(study, out=tmp_path / "out", plots=False, resume=True)
        assert resumed.history["distance"].size == whole.history["distance"].size
        for name in ("area_contact", "wear_volume_disc", "approach"):
            np.testing.assert_allclose(resumed.history[name], whole.history[name], rtol=1e-9)
        resumed.close()


def test_a_coefficient_that_is_calibrated_is_not_known_on_the_way() -> None:
    study = study_of(friction__coefficient=0.6)
    assert all(np.isnan(step.row["cof"]) for step in warpwear.steps(study))


def test_steps_may_be_left_and_stop_where_one_is_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    for step in warpwear.steps("v3-fine"):
        assert step.count > 1000
        break
    seen = 0
    changes = {"grid.extent": "0.44 mm", "output.snapshots": [], "stepping.growth": 1.1}
    steps = warpwear.steps(study_of().replace(changes))
    seen: list[RunStep] = []
    with pytest.raises(InputError, match="the contact reached the domain's edge"):
        deque(map(seen.append, steps))
    assert len(seen) > 1
    assert capsys.readouterr().err == ""


def test_a_callback_sees_the_steps_and_changes_nothing(tmp_path: Path) -> None:
    study = study_of()
    seen: list[float] = []

    def watch(step: RunStep) -> str:
        seen.append(step.row["area_contact"] + 0.0 * float(step.fields["gap"][0, 0]))
        return "is not looked at"

    with warpwear.run(study, out=tmp_path / "out", plots=False, callback=watch) as watched:
        same(watched, warpwear.run(study))
        assert seen == watched.history["area_contact"].tolist()


@pytest.mark.parametrize("error", [ZeroDivisionError("mine"), InputError("mine"), KeyboardInterrupt()])
def test_a_callback_that_raises_stops_the_run_as_an_interrupt_does(
    error: BaseException, tmp_path: Path
) -> None:
    study, out = study_of(), tmp_path / "out"

    def watch(step: RunStep) -> None:
        if step.index == 7:
            raise error

    with pytest.raises(type(error)) as raised:
        warpwear.run(study, out=out, plots=False, callback=watch)
    assert raised.value is error
    with Result.open(out) as stopped:
        assert not stopped.finished
        assert stopped.history["distance"].size == 8
    assert holds_checkpoint(out)
    seen: list[int] = []
    with warpwear.run(
        study, out=out, plots=False, resume=True, callback=lambda step: seen.append(step.index)
    ) as result:
        same(result, warpwear.run(study))
        assert seen == list(range(8, result.history["distance"].size))
    with pytest.raises(type(error)):
        warpwear.run(study, callback=watch)


# --- the result ---


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("front") / "quick"
    warpwear.run(study_of(output__snapshots=["0.003 mm", "0.3 mm"]), out=out, plots=False).close()
    return out


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("front") / "swept"
    warpwear.run(study_of("track", sliding__plastic="keep"), out=out, plots=False).close()
    return out


@pytest.fixture(scope="module")
def tiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("front") / "tiled"
    warpwear.run(study_of("two-scale", grid__cell="10 um"), out=out, plots=False).close()
    return out


def test_snapshots_are_a_sequence(folder: Path) -> None:
    with Result.open(folder) as result:
        snapshots = result.snapshots
        assert len(snapshots) == 3
        assert [s.distance for s in snapshots] == [0.003, 0.3, 3.0]
        assert [s.distance for s in reversed(snapshots)] == [3.0, 0.3, 0.003]
        assert [s.distance for s in snapshots[1:]] == [0.3, 3.0]
        assert snapshots[::-1][0].distance == snapshots[-1].distance == 3.0
        assert snapshots[1:][-1].distance == snapshots[np.int64(2)].distance == 3.0  # type: ignore[call-overload]
        assert len(snapshots[5:]) == 0
        with pytest.raises(IndexError, match="snapshot 3 is not among the 3"):
            snapshots[3]
        with pytest.raises(IndexError):
            snapshots[1:][2]
        assert repr(snapshots) == "<3 snapshots at 0.003, 0.3, 3 mm>"
        assert repr(snapshots[1]) == (
            "<Snapshot at 0.3 mm, 75 × 75 cells: pressure, wear_sphere, wear_disc, gap>"
        )


def test_a_snapshot_by_its_distance(folder: Path, swept: Path) -> None:
    with Result.open(folder) as result:
        for asked in ("0.3 mm", "300 um", "3e-4 m", 0.3):
            assert result.at(asked).distance == 0.3
        np.testing.assert_array_equal(result.at("3 mm").pressure, result.snapshot(-1).pressure)
        with pytest.raises(
            InputError, match=r"at = '30 mm': no snapshot .*allowed: 0\.003 mm, 0\.3 mm, 3 mm"
        ):
            result.at("30 mm")
        for number in (np.float32(3.0), np.int64(3), np.float64(3.0)):
            assert result.at(number).distance == 3.0
        for wrong in ("3", True, np.True_, None):
            with pytest.raises(InputError, match=r"^at = .*: needs its unit: a length such as '1\.5 mm'"):
                result.at(wrong)  # type: ignore[arg-type]
        for wrong in ("3 N", "far"):
            with pytest.raises(InputError, match="at = "):
                result.at(wrong)
    with Result.open(swept) as result:
        assert 3.1 < result.at("3.1 mm").distance < 12.0  # where its track has an end
        with pytest.raises(InputError, match="no snapshot is kept there"):
            result.at("3.05 mm")


@pytest.mark.parametrize("wrong", [30.0, "30 mm", None, slice(1)])
def test_what_is_no_number_of_a_snapshot_is_told(folder: Path, wrong: Any) -> None:
    with (
        Result.open(folder) as result,
        pytest.raises(InputError, match=r"from 0 to 2 .*result\.at\('30 mm'\)"),
    ):
        result.snapshot(wrong)


def test_the_history_is_a_dictionary_that_helps(folder: Path) -> None:
    with Result.open(folder) as result:
        history = result.history
        assert isinstance(history, dict)
        assert list(history) == [column.name for column in columns_of(result.study)]
        with pytest.raises(InputError, match=r"no column 'coff'; did you mean 'cof'\?"):
            history["coff"]
        with pytest.raises(KeyError, match=r"allowed: distance, time"):
            history["zzz"]
        assert history.get("coff") is None
        assert "coff" not in history
        assert repr(history).startswith(f"<History of {history['cof'].size} steps: distance [mm], time [s],")
        assert result.units["cof"] == "1"
        assert result.units["pressure"] == "MPa"
        with pytest.raises(
            InputError, match=r"no column, field or table 'presure'; did you mean 'pressure'\?"
        ):
            result.units["presure"]
        assert pickle.loads(pickle.dumps(history)).keys() == history.keys()


def test_a_result_is_pickled_as_its_path(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder.parent)
    with Result.open("quick") as result:
        content = pickle.dumps(result)
    monkeypatch.chdir("/")
    with pickle.loads(content) as again:
        assert isinstance(again, Result)
        assert again.at("3 mm").distance == 3.0
    with warpwear.run(study_of(sliding__distance="0 mm")) as in_memory:
        assert in_memory.path is None
        with pytest.raises(InputError, match="in memory cannot be pickled; give the run a folder"):
            pickle.dumps(in_memory)


def test_a_closed_result_says_so(folder: Path) -> None:
    result = Result.open(folder)
    distance = result.history["distance"]
    result.close()
    assert result.history["distance"] is distance
    asks: list[Callable[[], Any]] = [
        lambda: result.snapshot(0),
        lambda: result.finished,
        lambda: result.x,
        lambda: result.record,
        lambda: result.track_x,
        lambda: result.load_share,
        lambda: result.track_loss(0),
    ]
    for ask in asks:
        with pytest.raises(InputError, match=r"this result is closed.*Result\.open\('.*result\.h5'\)"):
            ask()
    assert repr(result) == f"<Result, closed: {folder / 'result.h5'}>"


def test_what_a_run_does_not_have_is_told(folder: Path) -> None:
    with Result.open(folder) as result:
        with pytest.raises(InputError, match="the run has no track"):
            _ = result.track_x
        with pytest.raises(InputError, match=r"the run has no patches: study\.model is 'micro'"):
            _ = result.load_share


def test_public_names_are_listed() -> None:
    assert set(warpwear.__all__) <= set(dir(warpwear))
    assert {"__version__", "__doc__", "run", "steps", "Study", "Result"} <= set(dir(warpwear))
    for name in warpwear.__all__:
        assert inspect.getdoc(getattr(warpwear, name))
    with pytest.raises(AttributeError, match="no attribute 'runn'"):
        warpwear.runn  # type: ignore[attr-defined] # noqa: B018
    assert len(inspect.signature(warpwear.run).parameters) <= 10


def test_a_type_checker_sees_the_public_names_and_no_others() -> None:
    body = ast.parse(Path(warpwear.__file__).read_text(encoding="utf-8")).body
    assert not any(isinstance(node, ast.FunctionDef) and node.name == "__getattr__" for node in body)
    (typed,) = (n for n in body if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING")
    names = {name.name for node in typed.body if isinstance(node, ast.ImportFrom) for name in node.names}
    assert names | {"__version__"} == set(warpwear.__all__)


def test_a_log_gets_what_its_level_asks_for(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
    coarse = Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "0.03 mm"})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warpwear.run(coarse)
        assert {record.levelno for record in caplog.records} == {logging.WARNING}
        caplog.set_level(logging.INFO)
        warpwear.run(coarse)
    assert any(record.getMessage().startswith("finished: ") for record in caplog.records)
    assert {record.name for record in caplog.records} == {"warpwear.run"}


# --- pandas and xarray ---


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


def test_a_snapshot_asked_for_on_the_way_is_the_models(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fields are made when they are asked for, not at every step."""
    made: list[float] = []
    snapshot = OneScaleModel.snapshot

    def noted(self: OneScaleModel, step: Any, distance: float) -> Any:
        made.append(distance)
        return snapshot(self, step, distance)

    monkeypatch.setattr(OneScaleModel, "snapshot", noted)
    asked = [step.row["distance"] for step in warpwear.steps(study_of()) if step.index == 5 and step.fields]
    assert made == asked


# --- a folder that changes hands ---


def disc_elsewhere(folder: Path) -> Study:
    """A study of the user's own file, which has the name of the one that runs save."""
    folder.mkdir()
    np.save(folder / "surface.npy", rough((75, 75), seed=7))
    keys = {"surface": str(folder / "surface.npy"), "pixel": "20 um", "height_unit": "mm"}
    return study_of().replace({f"disc.{key}": value for key, value in keys.items()})


def test_heights_of_a_run_that_is_replaced_are_gone(tmp_path: Path) -> None:
    out, other = tmp_path / "out", disc_elsewhere(tmp_path / "elsewhere")
    warpwear.run(study_of(), surface=rough((75, 75)), out=out, plots=False).close()
    with warpwear.run(other, out=out, plots=False, overwrite=True) as replaced:
        assert not (out / "surface.npy").exists()
        assert replaced.study.disc.surface == other.disc.surface
    np.save(out / "surface.npy", rough((75, 75)))  # by hand: another's file of that name misleads nobody
    with Result.open(out) as opened:
        assert opened.study == Study.load(out) == other
    with warpwear.run(other, out=out, plots=False, overwrite=True) as again:
        assert (out / "surface.npy").is_file()
        assert again.study == other


def test_a_folder_is_run_again_in_place_on_its_own_heights(tmp_path: Path) -> None:
    out, heights = tmp_path / "out", rough((75, 75))
    first = warpwear.run(study_of(), surface=heights, out=out, plots=False)
    with warpwear.run(out, out=out, plots=False, overwrite=True) as second:
        same(first, second)
    shutil.move(out, tmp_path / "moved")
    with Result.open(tmp_path / "moved") as moved:
        assert Study.load(tmp_path / "moved") == moved.study
        same(moved, warpwear.run(moved.study))
    first.close()


# --- what is refused or told ---


@pytest.mark.parametrize(
    "surface", [np.ma.masked_less(rough((75, 75)), 5.0e-3), rough((75, 75)) + 0j, [[1j] * 75] * 75]
)
def test_masked_and_complex_heights_are_refused(surface: Any) -> None:
    with pytest.raises(InputError, match=r"^surface has to hold real numbers, none of them masked\.$"):
        warpwear.run(study_of(), surface=surface)


def test_an_attribute_called_heights_is_no_surface() -> None:
    class Record:
        heights = 3

    with pytest.raises(InputError, match="surface is a Record; an array of heights in mm is expected"):
        warpwear.run(study_of(), surface=Record())


def test_what_a_surface_raises_is_raised() -> None:
    class Broken:
        def heights(self, x: Any, y: Any) -> Any:
            raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        warpwear.run(study_of(), surface=Broken())


def test_what_is_no_callback_is_refused_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^callback = 3: a function is expected"):
        warpwear.run("v1", callback=3, out=tmp_path / "out")  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()


def test_notices_are_warnings(capsys: pytest.CaptureFixture[str]) -> None:
    study = study_of(contact__foundation="pressure", output__snapshots=["30 mm"], grid__cell="100 um")
    said = study.notices()
    assert any("new name" in notice for notice in said)
    with pytest.warns(warpwear.StudyWarning, match="output.snapshots that no step ends at: 30 mm") as caught:
        result = warpwear.run(study)
    assert [str(warning.message) for warning in caught] == result.summary["warnings"]
    assert set(said) < set(result.summary["warnings"])
    assert {warning.filename for warning in caught} == {__file__}
    with pytest.warns(warpwear.StudyWarning, match="new name") as caught:
        next(iter(warpwear.steps(study)))
    assert [str(warning.message) for warning in caught][: len(said)] == said
    assert {warning.filename for warning in caught} == {__file__}
    capsys.readouterr()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warpwear.run(study, progress=True)
    assert f"note: {said[0]}\n" in capsys.readouterr().err
