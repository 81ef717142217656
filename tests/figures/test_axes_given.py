"""Figures in axes that are there, of one run or of two, and films of a run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases_drawn import SMALL
from cases_figures import is_empty
from matplotlib.figure import Figure
from PIL import Image

import warpwear
from warpwear import InputError, Result, Study
from warpwear.cli.main import main
from warpwear.figures.describe import DISTANCE, Axis, Chart, Level, Line
from warpwear.figures.describe import Figure as Declared
from warpwear.figures.of_run import animation
from warpwear.figures.of_run.animation import FFMpegWriter, animate
from warpwear.figures.overlay import paint_over
from warpwear.figures.paint import paint
from warpwear.figures.wording import after
from warpwear.page.plots import plots_of


def lines_of(result: Result) -> dict[str, int]:
    """Names of a run's figures of lines, and their numbers of panels."""
    figures = {name: result.plot.declared(name).panels for name in result.plot.names()}
    return {name: len(of) for name, of in figures.items() if all(isinstance(panel, Chart) for panel in of)}


def test_lines_are_drawn_into_axes_that_are_there(results: dict[str, Result]) -> None:
    """The lines of the figure of its own, in the axes given and no others, with a legend inside them."""
    plot, nowhere, lines = results["rough"].plot, Figure().subplots(), lines_of(results["rough"])
    assert {"cof": 1, "volumes": 2}.items() <= lines.items()
    for name in plot.names():
        if name not in lines:
            for asked in ({"ax": nowhere}, {"label": "a"}, {"color": "C1"}):
                with pytest.raises(InputError, match=f"'{name}' is a map or drawn in three dimensions"):
                    getattr(plot, name)(**asked)
            continue
        figure = Figure(figsize=(6.0, 3.0))
        *given, other = figure.subplots(1, lines[name] + 1)
        with pytest.raises(InputError, match=f"'{name}' needs as many axes as it has panels: ax has 3"):
            getattr(plot, name)([other] * 3)
        assert getattr(plot, name)(given if len(given) > 1 else given[0]) is figure
        assert is_empty(other)
        for panel, own in zip(given, getattr(plot, name)().axes, strict=False):
            assert panel.get_xlabel() == own.get_xlabel()
            assert len(panel.lines) == len(own.lines) > 0
            for drawn_there, line in zip(panel.lines, own.lines, strict=True):
                np.testing.assert_array_equal(drawn_there.get_xydata(), line.get_xydata())
        assert figure.legends == []
        labelled = [axes for axes in figure.axes if axes.get_legend()]
        told = any(line.label for chart in plot.declared(name).panels for line in chart.lines)
        assert len(labelled) == int(told)
        figure.draw_without_rendering()


def test_two_runs_on_one_axis_are_told_apart(results: dict[str, Result]) -> None:
    """Each has its colour and its name; nothing of either is out of sight; what holds for one is not said."""
    for name, count in lines_of(results["rough"]).items():
        check_two_runs(results, name, count)


def check_two_runs(results: dict[str, Result], name: str, count: int) -> None:
    figure = Figure(figsize=(6.0, 3.0))
    panels = figure.subplots(1, count, squeeze=False)[0]
    sizes = []
    for run, colour in (("rough", "#112233"), ("published", "#aabbcc")):
        plot = results[run].plot
        getattr(plot, name)(panels if count > 1 else panels[0], label=run, color=colour)
        sizes.append([(panel.get_xlim(), panel.get_ylim()) for panel in panels])
    for panel, early in zip(panels, sizes[0], strict=True):
        for now, then in zip((panel.get_xlim(), panel.get_ylim()), early, strict=True):
            assert min(now) <= min(then)
            assert max(now) >= max(then)
        assert {line.get_color() for line in panel.lines} == {"#112233", "#aabbcc"}
        of_run = [
            line for line in panel.lines if line.get_color() == "#aabbcc" and line.get_label()[0] != "_"
        ]
        assert all(line.get_label().startswith("published") for line in of_run)
    (legend,) = [panel.get_legend() for panel in panels if panel.get_legend()]
    told = [text.get_text().partition(":")[0] for text in legend.get_texts()]
    assert set(told) == {"rough", "published"}
    figure.draw_without_rendering()


def test_titles_of_two_runs_do_not_mislead(results: dict[str, Result]) -> None:
    plots = [results["rough"].plot, results["published"].plot]
    titles = [plot.cof().axes[0].get_title() for plot in plots]
    assert titles[0] != titles[1]
    axes = Figure().subplots()
    for plot, shown in ((plots[0], titles[0]), (plots[0], titles[0]), (plots[1], ""), (plots[1], "")):
        plot.cof(axes)
        assert axes.get_title() == shown
    axes.set_title("mine")
    plots[0].cof(axes)
    assert axes.get_title() == "mine"


def test_times_of_two_runs_have_one_unit(results: dict[str, Result]) -> None:
    """The second run is drawn in the unit of the first, which stands at the axis."""
    fast = warpwear.run(Study.load("v3-fine").replace(SMALL | {"sliding.speed": "1 mm/min"}))
    slow_first, axes = Figure().subplots(), Figure().subplots()
    for plot in (fast.plot, results["rough"].plot):
        plot.cof_time(slow_first)
    results["rough"].plot.cof_time(axes)
    assert axes.get_xlabel() == "sliding time, s"
    assert slow_first.get_xlabel() == "sliding time, min"
    assert slow_first.get_xlim()[1] >= 30.0
    ends = [line.get_xdata()[-1] for line in slow_first.lines if len(line.get_xdata()) > 1]
    np.testing.assert_allclose(ends, [30.0, 1.5])


def test_long_distances_are_shown_in_metres() -> None:
    """All panels alike, with levels and ends; over axes that are there in the unit of these."""
    x = Axis(DISTANCE, low=0.0, high=2.1e7)
    charts = [
        Chart("a", x, Axis("y, –"), [Line(np.array([1e6, end]), np.ones(2)), Level(5e6, axis="x")])
        for end in (2e7, 3e6)
    ]
    for panel, end in zip(paint(Declared(charts)).axes, (20.0, 3.0), strict=True):
        assert panel.get_xlabel() == "sliding distance, km"
        assert panel.lines[0].get_xdata().tolist() == [1.0, end]
        assert panel.lines[1].get_xdata()[0] == 5.0
        assert panel.get_xlim() == (0.0, 21.0)
    short = replace(charts[0], lines=[Line(np.array([0.0, 9e3]), np.ones(2))])
    plots = plots_of("a", Declared(charts[:1])), plots_of("a", Declared([short]))
    assert [plot[0]["x"] for plot in plots] == ["sliding distance, km", "sliding distance, mm"]
    axes = Figure().subplots()
    for chart in (short, charts[1]):
        paint_over(Declared([chart]), [axes])
    assert axes.get_xlabel() == "sliding distance, mm"
    assert axes.lines[1].get_xdata().tolist() == [1e6, 3e6]
    assert [after(d) for d in (0.0, 9999.0, 1e4, 12345.6, 1e7)] == [
        "static contact",
        "after 9999 mm",
        "after 10 m",
        "after 12.35 m",
        "after 10 km",
    ]


def test_a_colour_that_is_none_is_refused(results: dict[str, Result]) -> None:
    with pytest.raises(InputError, match="color = 'greenish' is not a colour of matplotlib"):
        results["rough"].plot.cof(color="greenish")
    figure = results["rough"].plot.cof(label="mine", color="C3")
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["mine"]
    (legend,) = results["rough"].plot.areas(label="mine").legends
    assert all(text.get_text().startswith("mine: ") for text in legend.get_texts())


def test_a_panel_may_lie_in_a_part_of_a_figure(results: dict[str, Result]) -> None:
    figure = Figure(layout="constrained")
    part, _ = figure.subfigures(1, 2)
    assert results["rough"].plot.areas(ax=part.subplots()) is figure


@pytest.mark.slow
def test_a_film_has_a_frame_a_snapshot(
    results: dict[str, Result], tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    result = results["rough"]
    pixels = [round(animation.DPI * inches) for inches in animation.SIZE]
    assert [count % 2 for count in pixels] == [0, 0]  # as H.264 asks
    request.getfixturevalue("few_pixels")
    path = animate(result, tmp_path / "wear.gif", frames_per_second=4.0)
    with Image.open(path) as shown:
        assert shown.n_frames == result.snapshot_distances.size == 4
        assert shown.info["duration"] == 250
        assert shown.size == (40 * animation.SIZE[0], 40 * animation.SIZE[1])
    assert [p.name for p in tmp_path.iterdir()] == ["wear.gif"]
    with pytest.raises(
        InputError,
        match=r"wear\.gif is there already; give another file \(out\), or overwrite it ",
    ):
        animate(result, path)
    before = path.stat().st_mtime_ns
    animate(result, path, overwrite=True)
    assert path.stat().st_mtime_ns != before


@pytest.mark.parametrize(
    ("out", "fps", "message"),
    [
        ("wear.avi", 5.0, r"wear\.avi: the name of a \.mp4 or a \.gif file is expected"),
        ("wear.gif", 0.0, r"fps = 0 is not possible"),
        ("no/wear.gif", 5.0, r"the folder .*no does not exist"),
    ],
)
def test_what_cannot_be_filmed_is_refused(
    results: dict[str, Result], tmp_path: Path, out: str, fps: float, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        animate(results["rough"], tmp_path / out, frames_per_second=fps)
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("few_pixels")
def test_a_film_needs_snapshots_and_an_encoder(
    results: dict[str, Result], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match=r"at least two snapshots, .* kept 1; .*--set output\.snapshots="):
        animate(results["end only"])
    monkeypatch.setenv("PATH", "")
    with pytest.raises(InputError, match=r"needs ffmpeg, which is not installed"):
        animate(results["rough"], tmp_path / "wear.mp4")
    folder = results["flat"].folder
    assert folder is not None
    with pytest.raises(SystemExit) as ended:
        main(["animate", str(folder)])
    assert ended.value.code == 0
    assert (folder / "animation.gif").is_file()


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="ffmpeg is not installed")
def test_a_film_in_mp4(results: dict[str, Result], tmp_path: Path) -> None:
    path = animate(results["rough"], tmp_path / "wear.mp4")
    assert b"ftyp" in path.read_bytes()[:16]
