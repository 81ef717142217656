"""The package as NumPy users hold it: a result, its history and its snapshots, and the public names."""

import ast
import inspect
import logging
import pickle
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_front_door import study_of

import warpwear
from warpwear import InputError, Result, Study
from warpwear.history.quantities import columns_of


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
            "<Snapshot at 0.3 mm, 75 × 75 cells: pressure, wear_counter, wear_disc, gap>"
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


def test_a_result_is_opened_by_its_class_or_by_open(folder: Path) -> None:
    with Result(str(folder)) as one, Result.open(folder / "result.h5") as other:
        assert repr(one) == repr(other)
        assert one.path == other.path
    for way in (Result, Result.open):
        with pytest.raises(InputError, match="holds no result"):
            way(folder / "nothing")


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
        with pytest.raises(InputError, match="a result in memory has no folder: run with out"):
            in_memory.write_page()


def test_print_shows_the_summary_and_a_result_stands_for_its_folder(folder: Path) -> None:
    with Result.open(folder) as result:
        lines = str(result).splitlines()
        assert lines[0].startswith(f"{result.study.study.name}: 3 mm slid, ")
        assert 6 < len(lines) <= 10
        assert any("area in contact" in line for line in lines)
        assert Study.load(result) == result.study
        assert Path(result) == folder
        energy = warpwear.calibrate_energy(result=result)
        assert energy.numbers == warpwear.calibrate_energy(result=folder).numbers
        assert len(warpwear.calibrate_energy(result=result, speeds="20 mm/min").speeds) == 1
        strength = warpwear.calibrate_friction(result=result, cof=0.6)
        assert strength.numbers == warpwear.calibrate_friction(result=folder, cof=0.6).numbers
    assert str(result) == f"<Result, closed: {folder / 'result.h5'}>"


def test_a_refusal_is_its_sentence_alone() -> None:
    """Pydantic's own text, with an address, does not stand above it."""
    for refused in (
        lambda: Study.load("v1").replace({"contact.load": "4 mm"}),
        lambda: warpwear.calibrate_wear([{"volume": "4 mm"}], load="8 N", distance="1 m"),
        lambda: warpwear.read_surface("disc.npy", pixel="2 N", height_unit="um"),
    ):
        with pytest.raises(InputError) as error:
            refused()
        assert "pydantic" not in "".join(traceback.format_exception(error.value))


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
    body = ast.parse(Path(warpwear.__file__).with_suffix(".pyi").read_text(encoding="utf-8")).body
    assert not any(isinstance(node, ast.FunctionDef) and node.name == "__getattr__" for node in body)
    names = {name.asname for node in body if isinstance(node, ast.ImportFrom) for name in node.names}
    assert names == set(warpwear.__all__)


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


def test_notices_are_warnings(capsys: pytest.CaptureFixture[str]) -> None:
    study = study_of(contact__bulk_stiffness="pressure", output__snapshots=["30 mm"], grid__cell="100 um")
    said = study.notices()
    assert any("not apply" in notice for notice in said)
    with pytest.warns(warpwear.StudyWarning, match="output.snapshots that no step ends at: 30 mm") as caught:
        result = warpwear.run(study)
    assert [str(warning.message) for warning in caught] == result.summary["warnings"]
    assert set(said) < set(result.summary["warnings"])
    assert {warning.filename for warning in caught} == {__file__}
    with pytest.warns(warpwear.StudyWarning, match="not apply") as caught:
        next(iter(warpwear.steps(study)))
    assert [str(warning.message) for warning in caught][: len(said)] == said
    assert {warning.filename for warning in caught} == {__file__}
    capsys.readouterr()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warpwear.run(study, progress=True)
    assert f"note: {said[0]}\n" in capsys.readouterr().err
