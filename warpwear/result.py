"""A run as a user holds it: its numbers, its pictures, its summary, and how a notebook shows it."""

import base64
from contextlib import AbstractContextManager, nullcontext
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.lazy import resolve
from warpwear.results.ending import ending
from warpwear.results.evolution import SurfaceEvolution, surface_evolution
from warpwear.results.file import ResultFile
from warpwear.results.frames import to_dataframe, to_xarray
from warpwear.results.summary import summarise
from warpwear.study.rules import without_unit
from warpwear.study.surface import surface_in

content, html = lazy.module("warpwear.page.content"), lazy.module("warpwear.page.html")

#: Draws the figures; Matplotlib takes as long to import as everything else together.
PLOTTER = "warpwear.figures.of_run.table:Plotter"
#: Writes files for other software.
EXPORT = "warpwear.results.export:export"
#: Films the run.
ANIMATION = "warpwear.figures.of_run.animation:animate"
#: Pixels an inch of the pictures that stand in a page made again.
PAGE_DPI = 200
#: Figures that a notebook shows, those of a run without a course; pixels an inch.
COURSES, FIELDS, DPI = ("cof", "areas", "pressure"), ("pressure_map",), 100


class Result(ResultFile):
    """A run: its history, its snapshots, its figures.

    `Result(path)` and `Result.open(path)` open the one in a run folder; `run` returns one.

    Parameters
    ----------
    path : path
        A run folder, or the HDF5 file in it. What was read stays when the file is closed.

    Raises
    ------
    InputError
        For what is no result, or damaged.
    """

    @cached_property
    def summary(self) -> dict[str, Any]:
        """What `summary.json` says: verdict, scar, depths, volumes, areas, friction, checks, assumptions."""
        return summarise(self)

    def unworn_disc(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the disc's heights before any wear over its mean plane, made or read again.

        Parameters
        ----------
        x, y : array
            Places [mm], shapes (nx,) and (ny,).

        Returns
        -------
        array
            Heights [mm], shape (nx, ny).

        Raises
        ------
        InputError
            Where the file of a measured disc is gone.
        """
        return surface_in(self.study).heights(x, y)

    @property
    def surface_evolution(self) -> SurfaceEvolution:
        """Measure the roughness inside the scar and islands of contact at every snapshot."""
        return surface_evolution(self)

    def to_dataframe(self) -> Any:
        """Return the history as a table.

        Returns
        -------
        pandas.DataFrame
            A row a step; units in ``.attrs["units"]``.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        return to_dataframe(self)

    def to_xarray(self) -> Any:
        """Return history, patches and all snapshots, read into memory.

        Returns
        -------
        xarray.Dataset
            Dimensions step, distance (of the snapshots), x, y, track_x, patch; units in the attributes.

        Raises
        ------
        InputError
            Where xarray is not installed.
        """
        return to_xarray(self)

    def export(self, folder: str | Path, **options: Any) -> list[Path]:
        """Write worn bodies and fields into a folder for other software.

        Parameters
        ----------
        folder : path
            Where to.
        **options
            formats, such as ``["vti", "x3p"]``; snapshot, bodies, fields, points, overwrite, as `warpwear
            export` has them.

        Returns
        -------
        list of Path
            Of all files.

        Raises
        ------
        InputError
            For what is not known or not there, and for files that are there.
        """
        return resolve(EXPORT)(self, folder, **options)

    def animate(self, out: str | Path | None = None, **options: Any) -> Path:
        """Film the run, a frame a snapshot.

        Parameters
        ----------
        out
            A .mp4 file, which needs ffmpeg, or a .gif file; by default animation.mp4 or .gif in the folder.
        **options
            frames_per_second, by default 5; overwrite, whether to replace a file that is there.

        Returns
        -------
        Path
            Of the film.

        Raises
        ------
        InputError
            For fewer than two snapshots, and for what cannot be written.
        """
        path: Path = resolve(ANIMATION)(self, out, **options)
        return path

    def write_page(self) -> Path:
        """Write report.html into the run's folder again: all of it on one page.

        Returns
        -------
        Path
            Of the page.

        Raises
        ------
        InputError
            For a run in memory, and where a file of others has the page's name.
        """
        folder = Path(self)
        shown_here = content.content_of(self, self.plot)
        wanted = set(content.statics(shown_here)) & set(self.plot.names())
        pictures = {name: self.plot.png(name, dpi=PAGE_DPI) for name in sorted(wanted)}
        path: Path = content.write_page(folder, content.made_here(shown_here, pictures))
        return path

    @cached_property
    def plot(self) -> Any:
        """Figures: `result.plot.cof()` and so on return a matplotlib figure.

        Those of lines go into axes that are there, over another run's: `result.plot.cof(ax, label="8 N",
        color="C1")`; `help(result.plot)` says more.
        """
        return resolve(PLOTTER)(self)

    def __str__(self) -> str:
        bare = " and ".join(without_unit(self.study))
        told = f"\n  no unit          {bare}: taken as k of V = k F L / H, not as K" if bare else ""
        return ending(self) + told if self._file else repr(self)

    def _repr_html_(self) -> str:
        """Draw a notebook's view of the result."""
        return _to_html(self)


#: A run, or its folder.
Run: TypeAlias = Result | str | Path


def opened(result: Run) -> AbstractContextManager[Result]:
    """Open the result in a folder, closed at the end; one in memory is given as it is. Raises InputError."""
    if isinstance(result, Result) and result.folder is None:
        return nullcontext(result)
    return Result.open(Path(result))


def _to_html(result: Result) -> str:
    """Make a fragment of HTML: the top of the run's page and its courses, as pictures within it."""
    plot = result.plot
    names = [name for name in COURSES if plot.reason(name) is None] or [
        name for name in FIELDS if plot.reason(name) is None
    ]
    pictures = [(name, base64.b64encode(plot.png(name, dpi=DPI)).decode("ascii")) for name in names]
    top = content.top_of(result)
    return html.render("notebook.html", {}, **top, pictures=pictures)
