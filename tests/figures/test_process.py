"""Figures that a second process draws while a run goes on: the same pictures, and all, whatever happens."""

import inspect
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_figures import OF_FRETTING, OF_STRESSES
from cases_track import small
from click.testing import CliRunner
from PIL import Image

import warpwear
from warpwear import InputError, Study
from warpwear.cli.main import commands
from warpwear.figures import process
from warpwear.figures.of_run.table import ESSENTIAL
from warpwear.results.file import ResultFile
from warpwear.runs import run as running

PLAIN = {"grid.cell": "20 um", "sliding.distance": "10 mm", "output.snapshots": ["0.3 mm", "3 mm"]}
OF_PATCHES = {"grid.cell": "10 um", "disc.synthetic.cut_off": "20 um", "sliding.distance": "3 mm"}
#: Kinds of runs, and a figure that only they have.
OF_KINDS = {"rough": "roughness", "smooth": "hertz", "two-scale": "load_share", "track": "groove"}
OF_KINDS |= {"film": "bare_map", "pieces": "pieces"}
#: Cores with which a run has another process draw.
CORES = 2


def study_of(kind: str) -> Study:
    """A study of a kind; of one of them every essential figure is drawn."""
    if kind == "track":
        return small("full", output__snapshots=["3 mm"], grid__cell="10 um", sliding__shift=8)
    if kind == "two-scale":
        return Study.load(kind).replace(OF_PATCHES | {"output.snapshots": ["0.3 mm"]})
    if kind == "pieces":
        return Study.load("running-in").replace({"sliding.distance": "2 mm", "output.snapshots": []})
    static = {"sliding.distance": "0 mm", "output.snapshots": []}
    more: dict[str, dict[str, Any]] = {"smooth": {"study.model": "macro"}, "static": static}
    more["film"] = {"friction.film.thickness": "10 nm", "friction.film.shear_strength": "1 MPa"}
    return Study.load("v3-fine").replace(PLAIN | more.get(kind, {}))


@pytest.fixture
def two_cores(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """A run that has a core for another process, wherever the tests run; asked again, with options."""
    start = inspect.unwrap(process.Painter.__init__)

    def ask(**how: Any) -> None:
        painter = lambda self, cores: start(self, cores and CORES, **how)  # noqa: E731
        monkeypatch.setattr(process.Painter, "__init__", painter)

    ask()
    return ask


def figures_in(folder: Path) -> dict[str, Path]:
    return {path.stem: path for path in (folder / "figures").glob("*.png")}


@pytest.mark.usefixtures("two_cores")
@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[] if kind == "smooth" else pytest.mark.slow) for kind in OF_KINDS]
)
def test_pictures_are_those_that_the_run_itself_would_draw(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """Pixel for pixel; and the run draws none of them itself."""
    drawn: list[dict[str, bytes]] = []
    wait = process.Painter.pictures
    monkeypatch.setattr(process.Painter, "pictures", lambda self: drawn.append(wait(self)) or drawn[-1])
    with warpwear.run(study_of(kind), out=tmp_path / "run") as result:
        there = figures_in(tmp_path / "run")
        assert (
            set(drawn[0]) - {"report.html"}
            == set(there)
            == set(result.plot.names("essential"))
            >= {OF_KINDS[kind]}
        )
        for figure, path in there.items():
            again = result.plot.save(figure, tmp_path / "again")
            with Image.open(path) as one, Image.open(again) as other:
                np.testing.assert_array_equal(np.asarray(one), np.asarray(other), err_msg=figure)


@pytest.mark.parametrize("fault", ["it does not start", "it dies", "it says nothing", "a figure fails"])
def test_figures_are_there_whatever_happens_to_the_other_process(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    two_cores: Callable[..., None],
    quick_pictures: Any,
    fault: str,
) -> None:
    if fault == "it does not start":
        monkeypatch.setattr(sys, "executable", str(tmp_path / "nothing"))
    elif fault == "it dies":
        two_cores(command=("-c", "import os; os._exit(1)"))
    elif fault == "it says nothing":
        two_cores(command=("-c", "import time; time.sleep(60)"), patience=0.2)
    else:
        broken = "import warpwear.figures.paint as p; p.paint_map = None"
        serves = "from warpwear.engine.workers import serve; serve()"
        two_cores(command=("-c", f"{broken}; {serves}"))
    with (
        quick_pictures(blank=True),
        warpwear.run(study_of("static"), out=tmp_path / "run") as result,
    ):
        assert set(figures_in(tmp_path / "run")) == set(result.plot.names("essential"))


def test_the_other_process_imports_neither_studies_nor_results() -> None:
    """Nor Warp: they take as long as all figures together."""
    code = "import sys; from warpwear.figures.process import painter; painter.paint; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    slow = {"warp", "pydantic", "pint", "h5py", "scipy.ndimage", "warpwear.study.study"}
    assert not slow & set(done.stdout.split())


def test_what_is_slow_is_imported_when_it_is_needed() -> None:
    """Matplotlib by who draws, pint for units seldom written, a model and its kernels by its runs."""
    code = "import sys, warpwear.figures.process, warpwear.runs.run as r; r.Study.load('v3-fine')"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    slow = {"matplotlib", "pint", "warpwear.models.track.model", "warpwear.models.patches.local"}
    assert not slow & {*done.stdout.split()}


def test_no_snapshot_is_read_back(
    tmp_path: Path, watch: Callable[..., None], two_cores: Callable[..., None], quick_pictures: Any
) -> None:
    """Tables and all figures, whoever draws them, come from the fields that the run had in its hands.

    The other process gets what it needs and dies: this one makes all figures.
    """
    missed: list[Any] = []

    def note(file: ResultFile, index: int) -> None:
        missed.extend([] if index % file.snapshot_distances.size in file.at_hand else [index])

    watch(ResultFile, "snapshot", note)
    two_cores(command=("-c", "import sys; sys.stdin.read(100)"))
    with quick_pictures(blank=True):
        result = warpwear.run(study_of("rough"), out=tmp_path / "run", plots="all")
    assert not missed
    assert not result.at_hand  # memory is given back
    result.snapshots[-1]
    assert missed == [result.snapshot_distances.size - 1]


def test_captions_need_no_matplotlib(tmp_path: Path) -> None:
    """A run whose figures another process draws writes them itself."""
    warpwear.run(study_of("static"), out=tmp_path / "run", plots=False).close()
    code = (
        "import sys\nfrom warpwear.results.file import ResultFile\n"
        "from warpwear.figures.of_run.table import Plotter\n"
        "plot = Plotter(ResultFile.open(sys.argv[1])); print(*map(plot.caption, plot.names()))\n"
        "assert 'matplotlib' not in sys.modules"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "run")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "Pressure of the cells in contact without sliding" in done.stdout


def test_which_figures_are_asked_for(tmp_path: Path) -> None:
    study = study_of("static")
    with warpwear.run(study, out=tmp_path / "none", plots=False):
        assert not (tmp_path / "none" / "figures").exists()
    with pytest.raises(InputError, match="plots = 'some' is not known; allowed: essential, all, none"):
        warpwear.run(study, out=tmp_path / "some", plots="some")
    assert not (tmp_path / "some").exists()


def test_figures_on_the_command_line(tmp_path: Path, watch: Callable[..., None]) -> None:
    asked: list[str] = []

    def run_study(study: Study, how: Any) -> None:
        asked.append(how.plots)
        raise InputError("enough")

    watch(running, "run_study", run_study)
    for options in ([], ["--plots", "all"], ["--no-plots"], ["--plots", "none"]):
        CliRunner().invoke(commands, ["run", "v1", "--out", str(tmp_path / "out"), *options])
    assert asked == ["essential", "all", "none", "none"]
    told = CliRunner().invoke(commands, ["run", "v1", "--plots", "some"])
    assert told.exit_code == 2
    assert "'some' is not one of 'essential', 'all', 'none'" in told.output


@pytest.mark.usefixtures("two_cores")
def test_an_interrupted_run_leaves_no_process(tmp_path: Path, watch: Callable[..., None]) -> None:
    seen: list[subprocess.Popen[bytes]] = []

    def stop(step: Any) -> None:
        raise KeyboardInterrupt

    watch(subprocess.Popen, "__init__", lambda process, *_, **__: seen.append(process))
    with pytest.raises(KeyboardInterrupt):
        warpwear.run(study_of("rough"), out=tmp_path / "run", callback=stop)
    assert [started.poll() is None for started in seen] == [False]
    assert not (tmp_path / "run" / "figures").exists()


def test_the_kinds_drawn_here_have_all_essential_figures() -> None:
    common = {"setup", "pressure_map", "contact_map", "areas", "cof", "profiles", "volumes"}
    of_kinds = {*OF_KINDS.values(), *OF_FRETTING, *OF_STRESSES}
    elsewhere = {"track_map", "bare_fraction", "material_map", "layers"}
    assert common | of_kinds | elsewhere == set(ESSENTIAL)
