"""What a ball leaves on its track: groove, passes and roughness in numbers, figures and film."""

import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_figures import OF_TRACKS
from cases_track import small
from click.testing import CliRunner
from numpy.testing import assert_allclose, assert_array_equal
from PIL import Image

import warpwear
from warpwear import InputError, Result
from warpwear.batches.run_one import row_of
from warpwear.cli.main import commands
from warpwear.comparison.table import to_text, values_of
from warpwear.figures.describe import Map
from warpwear.figures.of_run import words
from warpwear.figures.of_run.animation import animate
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.fields import _declare_map
from warpwear.figures.of_run.history import cof
from warpwear.grid import FloatArray
from warpwear.history.quantities import FIELDS
from warpwear.results.track import (
    blocks,
    by_pass,
    course,
    depth_along,
    groove,
    pass_numbers,
    roughness_in_track,
    whole_steps,
)


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """Three passes and a bit on a representative track that keeps its dents."""
    study = small(
        "representative",
        sliding__plastic="keep",
        output__snapshots=["3 mm", "6 mm"],
        grid__cell="10 um",
        sliding__shift=8,
    )
    return warpwear.run(study, out=tmp_path_factory.mktemp("run") / "track", plots=False)


def test_the_groove_holds_what_the_disc_lost(result: Result) -> None:
    """Section × stroke is the volume, worn and displaced; over any number of bins along the track."""
    last = groove(result, 2)
    end = {name: float(values[-1]) for name, values in result.history.items()}
    cell = result.study.grid.cell
    assert 3.0 * last.worn.sum() * cell == pytest.approx(end["wear_volume_disc"], rel=1e-12)
    assert 3.0 * last.displaced.sum() * cell == pytest.approx(end["plastic_volume_disc"], rel=1e-12)
    assert last.mean_depth * last.width == pytest.approx(last.section, rel=1e-12)
    places, depths = depth_along(result, 2, 8)
    assert places.size == 8
    assert depths.mean() == pytest.approx(last.mean_depth, rel=1e-12)
    whole = blocks(result, 2, 40)
    worn, displaced = result.track_loss(2)
    assert whole.loss.sum() == pytest.approx((worn + displaced)[:, :62].sum() / 4.0, rel=1e-12)
    assert_allclose((whole.extent[0], whole.extent[1]), (-0.4, 0.4), atol=1e-12)


def test_passes_add_up(result: Result) -> None:
    passes = by_pass(result, "area_contact")
    assert passes["distance"] == pytest.approx([3.0, 3.0, 1.37])
    ends = np.append(np.flatnonzero(np.diff(pass_numbers(result))), -1)

    def lost(name: str) -> FloatArray:
        return np.diff(result.history[name][ends], prepend=0.0)

    assert lost("wear_volume_counter")[:2] == pytest.approx([9.4e-7 * 24.0] * 2, rel=1e-10)
    areas, increments = result.history["area_contact"], result.history["increment"]
    last = result.history["distance"] > 6.0 + 1e-9
    assert increments[last][-1] < 0.6 * increments[last][0]  # counts as far as it slid
    mean = np.average(areas[last], weights=increments[last])
    assert passes["area_contact"][2] == pytest.approx(mean, rel=1e-12)
    dents = lost("plastic_volume_disc")
    assert dents[0] > 2.0 * dents[1]  # they are made once


def test_the_track_gets_smoother(result: Result) -> None:
    table = roughness_in_track(result)
    assert table["passes"] == pytest.approx([0.0, 1.0, 2.0, 7.37 / 3.0])
    assert (table["spk"][1:] < 0.3 * table["spk"][0]).all()
    summary = result.summary["track"]
    assert summary["passes"] == pytest.approx(7.37 / 3.0)
    assert summary["groove"]["mean_depth_um"] == pytest.approx(1e3 * groove(result, 2).mean_depth)
    assert summary["roughness_um"]["end"]["spk"] == pytest.approx(table["spk"][-1])


@pytest.mark.usefixtures("few_pixels")
def test_figures_of_a_track(result: Result, tmp_path: Path) -> None:
    for name in OF_TRACKS:
        assert result.plot.reason(name) is None
        figure = getattr(result.plot, name)()
        figure.draw_without_rendering()
        for axes in figure.axes:
            assert axes.get_xlabel() or axes.get_ylabel() or not axes.axison, name
    left_out = result.plot.left_out
    assert {"disc_map", "disc_3d", "disc_profiles", "wear_map", "roughness", "distance_factor"} <= set(
        left_out
    )
    assert "track_map" in left_out["disc_map"]
    still = warpwear.run(small("full", sliding__kinematics="stationary", sliding__distance="0.1 mm"))
    assert set(still.plot.left_out) >= OF_TRACKS
    with pytest.raises(InputError, match="the disc lies still"):
        still.plot.groove()
    film = animate(result, tmp_path / "film.gif")
    with Image.open(film) as frames:
        assert frames.n_frames == 3  # type: ignore[attr-defined]


def test_what_was_touched_is_the_counter_s(result: Result) -> None:
    """Not what earlier contacts left on the part of the track that lies under the domain's ends."""
    touched = result.snapshot(-1).touched
    area = np.count_nonzero(touched) * result.study.cells.cell_area
    assert area == pytest.approx(result.history["area_touched"][-1])
    rows = np.flatnonzero(touched.any(axis=1))
    along = (rows[-1] - rows[0] + 1) * result.study.grid.cell
    assert along == pytest.approx(result.history["patch_along"][-1])


def test_a_track_is_compared_by_its_groove(result: Result, tmp_path: Path) -> None:
    """Its section times its length is the worn volume; the middle of the track need not have been touched."""
    folder = result.folder
    assert folder is not None
    shutil.copytree(folder, tmp_path / "other")
    run = warpwear.compare(folder, tmp_path / "other").rows[0]
    cell = result.study.grid.cell
    across, change = run.courses["profile_disc"]
    assert -3e-3 * change.sum() * cell == pytest.approx(result.history["wear_volume_disc"][-1], rel=1e-12)
    assert change.shape == run.courses["profile_counter"][1].shape == across.shape


def test_a_groove_that_was_only_pressed() -> None:
    dented = warpwear.run(
        small("representative", sliding__plastic="keep", wear__disc="0 mm^3/N/m", sliding__distance="3 mm")
    )
    assert dented.plot.reason("groove") is None
    assert groove(dented, -1).mean_depth > 0.0
    dented.plot.groove().draw_without_rendering()


def test_the_shape_of_a_course_is_that_of_its_passes(tmp_path: Path) -> None:
    """At the ends of a short stroke the area is smaller than in its middle, which says nothing of wear."""
    changes = {"disc__synthetic__kind": "flat", "sliding__distance": "72 mm", "sliding__shift": 3}
    result = warpwear.run(small("full", **changes), out=tmp_path / "one", plots=False)
    areas = result.history["area_contact"].reshape(80, 15)  # a row a pass of 45 cells
    assert areas[-1, -1] < 0.8 * areas[-1].mean()
    late, passes = areas[40:].mean(axis=1), np.arange(40, 80) + 0.5
    exponent = np.polyfit(np.log(passes), np.log(late), 1)[0]
    assert result.summary["area_shape"]["exponent_m"] == pytest.approx(exponent, rel=1e-2, abs=1e-3)
    # So are the values at the end, in the summary, in print and in a comparison.
    summary, of_steps = result.summary, result.history
    assert summary["end_values"] == "last cycle"
    assert summary["area_mm2"]["contact"] == pytest.approx(areas[-2:].mean(), rel=1e-12)
    assert summary["area_mm2"]["contact"] == pytest.approx(
        summary["track"]["area_contact_mm2_of_passes"]["last"], rel=1e-12
    )
    of_nominal = areas[-2:].mean() / of_steps["area_nominal"][-1]
    assert summary["area_real_over_nominal"] == pytest.approx(of_nominal, rel=1e-12)
    assert summary["pressure_MPa"]["mean"] == pytest.approx(of_steps["pressure_mean"][-30:].mean(), rel=1e-12)
    assert summary["approach_um"] == pytest.approx(1e3 * of_steps["approach"][-30:].mean(), rel=1e-12)
    assert summary["approach_um"] != pytest.approx(1e3 * of_steps["approach"][-1], rel=1e-3)
    assert summary["pressure_MPa"]["max"] == of_steps["pressure_max"][-30:].max()
    shutil.copytree(tmp_path / "one", tmp_path / "two")
    # An experiment that is the course of the passes differs from it by nothing, though steps scatter.
    places, means = course(result, "cof")
    assert_allclose(means, of_steps["cof"].reshape(80, 15).mean(axis=1), rtol=1e-12)
    measured = zip(places.tolist(), means.tolist(), strict=True)
    lines = ["distance [mm],cof", *(f"{place!r},{mean!r}" for place, mean in measured)]
    (tmp_path / "test.csv").write_text("\n".join(lines))
    comparison = warpwear.compare(tmp_path / "one", tmp_path / "two", experiments=[tmp_path / "test.csv"])
    assert comparison.rows[0].ends["rms_cof test"] == pytest.approx(0.0, abs=1e-9)
    told, values = to_text(comparison), next(iter(values_of(comparison).values()))
    assert values["exponent_m"] == pytest.approx(summary["cof_shape"]["exponent_m"], rel=1e-12)
    assert values["levelling_lambda"] == pytest.approx(summary["cof_shape"]["levelling_lambda"], rel=1e-12)
    assert values["cof"] == pytest.approx(of_steps["cof"][-30:].mean(), rel=1e-12)
    assert f"{areas[-2:].mean():.4g}" in told
    assert "means of the last cycle" in told
    assert "differences from an experiment (rms) are of the means of whole passes" in told


def test_a_short_last_pass_is_left_out_of_a_course(tmp_path: Path) -> None:
    """It ends near the end of the track, where the contact is small; print says what its numbers are."""
    study = small("full", disc__synthetic__kind="flat", sliding__distance="7.41 mm", sliding__shift=3)
    (tmp_path / "study.toml").write_text(study.to_toml(), encoding="utf-8")
    told = CliRunner().invoke(
        commands, ["run", str(tmp_path / "study.toml"), "--out", str(tmp_path / "out"), "--no-plots"]
    )
    assert re.search(r"area in contact .* mm² ± ", told.output), told.output
    with Result.open(tmp_path / "out") as result:
        assert result.history["distance"][-1] == pytest.approx(8 * 0.9 + 0.21)
        distance, areas = course(result, "area_contact")
        assert distance == pytest.approx(0.9 * (np.arange(8) + 0.5))
        assert course(result, "distance")[0] == pytest.approx(distance)
        assert row_of(result).courses["distance"] == pytest.approx(distance)
        whole = result.history["area_contact"][:120].reshape(8, 15)
        assert_allclose(areas, whole.mean(axis=1), rtol=1e-12)


def test_friction_is_calibrated_on_a_whole_cycle(result: Result) -> None:
    """Not on the step at the end, where a stroke's area is another than in its middle."""
    study = result.study.replace(friction={"coefficient": 0.6, "calibrate": "end"})
    history = warpwear.run(study).history
    last = history["distance"] > 7.37 - 2 * 3.0 + 0.15
    assert np.average(history["cof"][last], weights=history["increment"][last]) == pytest.approx(
        0.6, rel=1e-2
    )
    initial = warpwear.run(study.replace({"friction.calibrate": "initial"})).history
    first = initial["distance"] < 3.0 + 1e-6
    assert np.average(initial["cof"][first], weights=initial["increment"][first]) == pytest.approx(0.6)


def test_a_step_that_the_end_cuts_short_is_not_drawn(tmp_path: Path) -> None:
    """Its compliance K ΔL is smaller, so its area and friction fall, whatever the track is like."""
    passes = 40.0 + 2.001 / 5.0  # of 5 steps each
    study = small("full", disc__synthetic__kind="flat", sliding__distance=f"{0.9 * passes!r} mm")
    result = warpwear.run(study.replace({"sliding.shift": 9}), out=tmp_path / "run", plots=False)
    history = result.history
    assert history["cof"][-1] < 0.5 * history["cof"][-2]
    assert np.flatnonzero(~whole_steps(result)).tolist() == [history["cof"].size - 1]
    axes = result.plot.cof().axes[0]
    assert_allclose(axes.lines[0].get_ydata(), history["cof"][:-1])
    assert "shear strength 3.83 MPa, as given" in axes.get_title()
    for name in ("areas", "pressure", "contact_radius"):
        for panel in getattr(result.plot, name)().axes:
            ends = [float(np.asarray(line.get_xdata())[-1]) for line in panel.lines]
            assert max((end for end in ends if end != 1.0), default=0.0) <= history["distance"][-2]
    # Means of its 40 passes lie over the steps.
    means = np.asarray(axes.lines[1].get_xydata())[-40:]
    assert means[:, 0] == pytest.approx(0.9 * (np.arange(40) + 0.5))
    whole = history["cof"][:200].reshape(40, 5)
    assert means[:, 1] == pytest.approx(whole.mean(axis=1))
    shutil.copytree(tmp_path / "run", tmp_path / "other")
    compared = warpwear.compare(tmp_path / "run", tmp_path / "other").rows[0]
    assert compared.courses["area_contact"][0][-1] == history["distance"][-2]
    assert compared.summary.distance == history["distance"][-1]


def test_short_ends_of_passes_are_not_drawn() -> None:
    """Where the shift does not divide the stroke the last step of each pass is short."""
    result = warpwear.run(small("full", sliding__distance="2.7 mm"))  # 6 steps of 7 cells and one of 3
    there, back = [True] * 6 + [False], [False] + [True] * 6
    assert whole_steps(result).reshape(3, 7).tolist() == [there, back, there]


def test_means_of_passes_that_stand_for_many() -> None:
    """A jump is one pass, however far it slides: its mean is over all its steps, not over one of them."""
    changes = {"grid__cell": "20 um", "sliding__distance": "90 mm", "stepping__jump": 4}
    result = warpwear.run(small("representative", output__snapshots=[], **changes))
    assert result.history["cycles"].max() > 1.0
    steps, means = cof(FigureData(result)).panels[0].lines[:2]
    expected = by_pass(result, "cof")
    assert steps.x.size == result.history["distance"].size
    assert_allclose(means.y[-expected["cof"].size + 1 :], expected["cof"][1:], rtol=1e-12)
    ends = np.cumsum(expected["distance"])
    assert_allclose(means.x[-ends.size + 1 :], (ends - 0.5 * expected["distance"])[1:], rtol=1e-12)


def test_a_field_that_says_so_has_a_map(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a track what lies beneath the counter-body; a run that has none of it says so."""
    monkeypatch.setattr(words, "FIGURES", dict(words.FIGURES))
    look: dict[str, Any] = {"label": "dents", "factor": 1e3, "shown_unit": "µm"}
    _declare_map(replace(FIELDS["plastic_disc"], **look))
    entry, data = words.FIGURES["plastic_disc_map"], FigureData(result)
    (panel,) = entry.declare(data).panels
    assert isinstance(panel, Map)
    assert panel.scale is not None
    assert panel.scale.label == "dents, µm"
    last = result.snapshot(-1)
    means = data.window.means(1e3 * last.beneath(last.plastic_disc))
    assert panel.scale.high >= means.max() > 0.0
    assert_array_equal(panel.fields[-1], np.where(means > 0.0, means, np.nan))
    assert entry.template.startswith("Dents {when}: depth displaced of the track for good")
    assert not any(reason.applies(data) for reason in entry.reasons)
    _declare_map(replace(FIELDS["plastic_disc"], only="block"))
    assert words.FIGURES["plastic_disc_map"].reasons[0].applies(data)
