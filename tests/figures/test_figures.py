"""Figures: all of them drawn of several kinds of run, legible, with units, or left out with a reason."""

import base64
import re
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from cases_drawn import RUNS, SMALL
from cases_figures import (
    OF_FILMS,
    OF_FRETTING,
    OF_PATCHES,
    OF_STRESSES,
    OF_TRACKS,
    axes_lines,
    drawn,
    faults_of,
    is_map,
    left_out_for,
    shown_ticks,
)
from matplotlib.colors import LogNorm
from PIL import Image

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli.main import main
from warpwear.figures.describe import Axis, Chart, Figure, Line
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.table import ESSENTIAL
from warpwear.figures.of_run.view import State, last_at_hardness
from warpwear.figures.paint import paint
from warpwear.figures.wording import short, with_scatter

#: What a run without sliding has not.
NOT_STATIC = left_out_for(
    words.NO_COURSE,
    words.ONE_SNAPSHOT,
    words.UNWORN,
    words.UNWORN_COUNTER,
    words.UNWORN_DISC,
    words.NO_GROOVE,
)


@pytest.mark.parametrize("run", ["rough", "static", "smooth"])
def test_every_figure_is_fit_to_print(results: dict[str, Result], run: str) -> None:
    """All of a rough run, all of a static contact, and what only a smooth run has."""
    names = set(results[run].plot.NAMES) - set(results[run].plot.left_out)
    if run == "smooth":
        names &= set(results["rough"].plot.left_out)
        assert names
    check_figures(results[run], run, names)


@pytest.mark.slow
@pytest.mark.parametrize("run", RUNS)
def test_every_figure_of_every_run_is_fit_to_print(results: dict[str, Result], run: str) -> None:
    check_figures(results[run], run, set(results[run].plot.NAMES) - set(results[run].plot.left_out))


def check_figures(result: Result, run: str, names: set[str]) -> None:
    faults: list[str] = []
    for name in sorted(names):
        faults += faults_of(f"{run}, {name}", *drawn(result, name))
    assert not faults, "\n".join(faults)


def test_what_makes_no_sense_is_left_out_with_its_reason(
    results: dict[str, Result], tmp_path: Path, quick_pictures: Any
) -> None:
    plot = results["static"].plot
    of_others = {
        *OF_TRACKS,
        *OF_PATCHES,
        *OF_FILMS,
        *OF_FRETTING,
        *OF_STRESSES,
        *left_out_for(words.ROUGH, words.NO_FACTOR, words.NO_PIECES),
    }
    static = set(plot.NAMES) - NOT_STATIC - of_others
    assert {"setup", "contact_map", "junctions"} < static == set(plot.names())
    with quick_pictures(blank=True):
        written = plot.save_all(tmp_path)
    assert {path.stem for path in written} == static
    with pytest.raises(InputError, match="there is no figure 'cof': the run has one step"):
        plot.cof()
    assert set(results["rough"].plot.left_out) == of_others
    assert set(results["flat"].plot.left_out) == {"contact_radius"} | of_others
    assert (
        results["flat"].plot.left_out["contact_radius"]
        == "a rigid flat, or a cylinder, has no radius of contact"
    )
    of_rough = left_out_for(words.SMOOTH_DISC, words.SMOOTH, words.NO_PIECES)
    assert set(results["smooth"].plot.left_out) == of_rough | {
        *OF_TRACKS,
        *OF_PATCHES,
        *OF_FILMS,
        *OF_FRETTING,
        *OF_STRESSES,
    }
    no_speed = warpwear.run(
        Study.load("v3").replace({"grid.cell": "20 um", "sliding.speed": None, "sliding.distance": "3 mm"})
    )
    assert "sliding.speed" in str(no_speed.plot.reason("cof_time"))


def test_an_interrupted_run_without_snapshots_still_plots(
    results: dict[str, Result], tmp_path: Path, quick_pictures: Any
) -> None:
    source = results["end only"].folder
    assert source is not None
    with h5py.File(source / "result.h5") as old, h5py.File(tmp_path / "result.h5", "w") as new:
        for name in ("grid", "history"):
            old.copy(name, new)
        new.create_group("snapshots")
        new.attrs.update(old.attrs)
        new["history/cof"][...] = np.nan
        new.attrs["finished"] = False
    with quick_pictures(), Result.open(tmp_path) as result:
        names = {path.stem for path in result.plot.save_all(tmp_path / "figures")}
        lacking = left_out_for(words.NO_SNAPSHOT, words.ONE_SNAPSHOT, words.NO_COF)
        assert names == set(results["end only"].plot.names()) - lacking >= {"areas", "volumes"}
        assert "interrupted" in result._repr_html_()


def test_all_maps_of_pressure_share_one_scale(results: dict[str, Result]) -> None:
    """62, 13 and 6 MPa are told apart by their colours, and the hardness is at the end of the scale."""
    for run, logarithmic in (("rough", True), ("static", False)):
        figure = results[run].plot.pressure_map()
        norms = [axes.images[0].norm for axes in figure.axes if is_map(axes)]
        assert len({(type(norm), norm.vmin, norm.vmax) for norm in norms}) == 1
        assert isinstance(norms[0], LogNorm) == logarithmic
        assert norms[0].vmax == results[run].history["pressure_max"].max() == pytest.approx(590.0, rel=0.01)
    rough = results["rough"]
    figure = rough.plot.pressure_map()
    means = [
        rough.history["pressure_mean"][np.searchsorted(rough.history["distance"], at)]
        for at in rough.snapshot_distances
    ]
    places = [figure.axes[0].images[0].norm(mean) for mean in means]
    assert (np.diff(places) < -0.05).all()


def test_a_body_that_hardly_wears_is_seen(results: dict[str, Result]) -> None:
    """On a scale of its own, which is said; bodies that wear alike have one scale."""
    study = Study.load("v3-fine").replace(SMALL | {"wear.counter": "9.4e-6 mm^3/N/m", "output.snapshots": []})
    for result, own in ((results["rough"], False), (warpwear.run(study), True)):
        counter, disc = result.plot.wear_map().axes[:2]
        assert ("a scale of its own" in counter.get_title()) == own
        shown = float(np.nanmax(counter.images[0].get_array().filled(np.nan)))
        assert (counter.images[0].norm.vmax == pytest.approx(shown)) == own
        assert (counter.images[0].norm.vmax == disc.images[0].norm.vmax) != own


def test_friction_that_was_calibrated_is_called_so(results: dict[str, Result]) -> None:
    assert "calibrated" not in results["rough"].plot.cof().axes[0].get_title()
    assert not any(line.get_marker() == "o" for line in results["rough"].plot.cof().axes[0].lines)
    changes = SMALL | {"friction.shear_strength": None, "friction.coefficient": 0.55, "output.snapshots": []}
    for when, told in (("end", "at the end"), ("initial", "at the start")):
        study = Study.load("v3-fine").replace(changes | {"friction.calibrate": when})
        plot = warpwear.run(study).plot
        axes = plot.cof().axes[0]
        assert axes.get_title().endswith(f"\ncalibrated to 0.55 {told}")
        course, mark = (np.asarray(line.get_xydata()) for line in axes.lines)
        assert mark[0] == pytest.approx(course[-1 if when == "end" else 0])
        assert f"calibrated to 0.55 {told}, so that the value" in plot.caption("cof")


def test_the_fall_of_the_largest_pressure_is_explained(results: dict[str, Result]) -> None:
    """Where the last cell leaves the hardness; and it is not where the pressure stays there."""
    course = {"area_plastic": [3.0, 1.0, 0.0, 0.0], "pressure_max": [590.0, 590.0, 200.0, 90.0]}
    rows = {name: np.array(values) for name, values in course.items()}
    assert last_at_hardness(rows) == 1
    assert last_at_hardness(rows | {"pressure_max": np.full(4, 590.0)}) is None
    assert last_at_hardness(rows | {"area_plastic": np.zeros(4)}) is None
    assert last_at_hardness(rows | {"area_plastic": np.ones(4)}) is None
    history = results["rough"].history
    last = history["distance"][np.flatnonzero(history["area_plastic"])[-1]]
    title = f"after {last:.3g} mm no cell is at the hardness"
    assert results["rough"].plot.pressure().axes[0].get_title() == title
    assert f"after {last:.3g} mm; from then on the pressure is" in results["rough"].plot.caption("pressure")
    assert results["published"].plot.pressure().axes[0].get_title() == ""


def test_a_sum_of_areas_is_drawn_where_it_shears(results: dict[str, Result]) -> None:
    for run, there in (("rough", False), ("published", True)):
        labels = [line.get_label() for line in results[run].plot.areas().axes[0].lines]
        assert ("running sum" in labels) == there


def test_heights_are_told_to_be_larger(results: dict[str, Result]) -> None:
    figure, _ = drawn(results["rough"], "profiles")
    axes = figure.axes[0]
    (x0, y0), (x1, y1) = axes.transData.transform([(0.0, 0.0), (0.1, 1.0)])
    ratio = (y1 - y0) / 1e-3 / ((x1 - x0) / 0.1)
    assert axes.get_title() == f"heights drawn {float(f'{ratio:.2g}'):g} times as large"


def test_a_legend_stays_on_its_page() -> None:
    """In fewer columns where names are long."""
    y = np.array([0.0, 1.0])
    lines = [Line(y, y, f"after {n} mm, a name") for n in range(6)]
    figure = paint(Figure([Chart("", Axis("x"), Axis("y"), lines)], legend=6))
    figure.canvas.draw()
    box = figure.legends[0].get_window_extent()
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.x1


def test_a_deviation_has_the_digits_of_its_mean() -> None:
    told = [with_scatter(*pair) for pair in ((537.2, 118.0), (12.83, 0.334), (6.423, 0.0891), (589.0, 1e-9))]
    assert told == ["540 ± 120", "12.83 ± 0.33", "6.423 ± 0.089", "589"]


def test_captions_lie_beside_the_figures(
    results: dict[str, Result], tmp_path: Path, quick_pictures: Any
) -> None:
    """One a figure; those of others are left alone."""
    plot = results["rough"].plot
    with quick_pictures(blank=True):
        drawn_there = plot.save_all(tmp_path, plots="essential")
    text = (tmp_path / "captions.md").read_text(encoding="utf-8")
    assert re.findall(r"^\*\*(\w+)\*\*: ", text, re.MULTILINE) == [
        name for name in plot.NAMES if name in {path.stem for path in drawn_there}
    ]
    assert "after 0.3, 3, 10 and 30 mm" in text
    assert "Local law, cell by cell, hardness 590 MPa; load 8 N; cells of 20 µm." in text
    assert "The area in contact shears; shear strength 3.83 MPa, as given." in plot.caption("cof")
    for name, run in ((n, results[kind]) for kind in RUNS for n in results[kind].plot.names()):
        assert "{" not in run.plot.caption(name)
    with pytest.raises(InputError, match="'cop' is no figure"):
        plot.caption("cop")
    (tmp_path / "captions.md").write_text("mine")
    plot.save_captions(tmp_path)
    assert (tmp_path / "captions.md").read_text() == "mine"


def test_ticks_are_plain_numbers(results: dict[str, Result]) -> None:
    """Not 4 × 10⁰; without formulas, whose setting takes long."""
    for name in ("islands", "areas", "pressure_profiles", "contact_radius"):
        figure, _ = drawn(results["rough"], name)
        ticks = [t.get_text() for axes in figure.axes for axis in axes_lines(axes) for t in shown_ticks(axis)]
        assert ticks
        assert not any("$" in tick for tick in ticks), ticks
    assert [short(value) for value in (0.002, 4.0, 2e4, 1e-5, 3e6, -1e-4)] == [
        "0.002", "4", "20\u202f000", "10⁻⁵", "3·10⁶", "-1·10⁻⁴",
    ]  # fmt: skip


def test_what_goes_into_a_paper_is_drawn_by_default(
    results: dict[str, Result], tmp_path: Path, quick_pictures: Any
) -> None:
    plot = results["rough"].plot
    essential = {"setup", "pressure_map", "contact_map", "areas", "cof", "profiles", "volumes", "roughness"}
    assert set(plot.names("essential")) == essential
    assert set(plot.names()) == set(plot.NAMES) - set(plot.left_out) > essential
    assert set(results["smooth"].plot.names("essential")) == essential - {"roughness"} | {"hertz"}
    with quick_pictures(blank=True):
        assert {path.stem for path in plot.save_all(tmp_path, plots="essential")} == essential
    assert set(ESSENTIAL) - {*OF_TRACKS, *OF_PATCHES, *OF_FILMS, *OF_FRETTING, *OF_STRESSES} == essential | {
        "hertz",
        "pieces",
    }


def test_formats_and_names(results: dict[str, Result], tmp_path: Path) -> None:
    plot = results["rough"].plot
    for kind, start in (("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")):
        path = plot.save("profiles", tmp_path, file_format=kind)
        assert path.name == f"profiles.{kind}"
        assert path.read_bytes().startswith(start)
    with Image.open(tmp_path / "profiles.png") as image:
        assert image.width == 7 * 300
    assert b"Type3" not in (tmp_path / "profiles.pdf").read_bytes()
    first = (tmp_path / "profiles.pdf").read_bytes()
    assert plot.save("profiles", tmp_path, file_format="pdf").read_bytes() == first
    with pytest.raises(InputError, match=r"'pressure_mpa' is no figure \(did you mean 'pressure_map'"):
        plot.save("pressure_mpa", tmp_path)
    with pytest.raises(InputError, match="format = 'eps' is not known; allowed: png, pdf, svg"):
        plot.save("cof", tmp_path, file_format="eps")
    with pytest.raises(AttributeError):
        _ = plot.nothing


def test_the_figures_are_listed(results: dict[str, Result]) -> None:
    """`dir` and tab completion know them all, each with a sentence of help."""
    plot = results["rough"].plot
    assert {*plot.NAMES, "NAMES", "left_out", "reason", "save", "save_all"} <= set(dir(plot))
    assert all((getattr(plot, name).__doc__ or "").partition("\n")[0].endswith(".") for name in plot.NAMES)
    assert plot.cof.__name__ == "cof"


def test_plot_on_the_command_line(
    results: dict[str, Result], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = results["static"].folder
    with pytest.raises(SystemExit) as ended:
        main(["plot", str(folder), "--only", "contact_map", "--only", "setup", "--format", "svg"])
    assert ended.value.code == 0
    assert [Path(line).name for line in capsys.readouterr().out.split()] == ["contact_map.svg", "setup.svg"]
    for arguments, message in (
        (["--only", "contact_mpa"], "did you mean 'contact_map'"),
        (["--format", "eps"], "format = 'eps' is not known"),
        (["--only", "cof"], "there is no figure 'cof': the run has one step"),
    ):
        with pytest.raises(SystemExit) as ended:
            main(["plot", str(folder), *arguments])
        assert ended.value.code == 2
        assert message in capsys.readouterr().err


def test_reduction_keeps_what_it_promises(results: dict[str, Result]) -> None:
    result = results["rough"]
    data = FigureData(result, blocks=20)
    view, bodies, snapshot = data.view(0), data.bodies_at(0), result.snapshot(0)
    window = data.window_of(20)
    side = (window.extent[1] - window.extent[0]) / view.pressure.shape[0]
    assert window.factor > 1
    # The scar is inside the window, so the load and the volumes are too.
    assert window.means(snapshot.pressure).sum() * side**2 == pytest.approx(8.0, rel=1e-12)
    volume = snapshot.wear_disc.sum() * result.study.cells.cell_area
    assert bodies["wear_disc"].sum() * side**2 == pytest.approx(volume, rel=1e-12)
    assert view.pressure.max() == snapshot.pressure.max()
    last = FigureData(result).views[-1]
    assert (last.state > State.TOUCHED).sum() * (20e-3) ** 2 == pytest.approx(
        result.history["area_contact"][-1]
    )
    published = FigureData(results["published"]).views[-1]
    assert set(np.unique(published.state)) == {State.UNTOUCHED, State.TOUCHED, State.AT_HARDNESS}


def test_a_notebook_shows_a_result(results: dict[str, Result]) -> None:
    html = results["rough"]._repr_html_()
    images = re.findall(r'data:image/png;base64,([^"]+)"', html)
    assert len(images) == 3
    assert all(base64.b64decode(image).startswith(b"\x89PNG") for image in images)
    assert "slides 30 mm" in html
    assert "Not predicted: as good as the shear strength" in html
    assert "<script" not in html
    assert len(html) < 200_000
    assert len(re.findall("data:image", results["static"]._repr_html_())) == 1


def test_a_notebook_shows_a_figure_without_pyplot(results: dict[str, Result]) -> None:
    figure = results["rough"].plot.areas()
    assert figure._repr_png_().startswith(b"\x89PNG")
