"""The wear of a run as a film: the disc, the pressure and the coefficient of friction, a frame a snapshot.

Where a sphere slides over a track, its frames show the whole track, the sphere's place and its pressure.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from warpwear.errors import OVERWRITE_IT, InputError
from warpwear.figures import style as fs
from warpwear.figures.axes import draw_map
from warpwear.figures.data import FigureData
from warpwear.figures.fields import pressure_scale
from warpwear.figures.view import View, positive
from warpwear.grid import FloatArray
from warpwear.results.file import ResultFile
from warpwear.results.track import blocks

#: Blocks along a side of a map.
BLOCKS = 250
#: Pixels an inch.
DPI = 160
#: Width and height [inch]: even numbers of pixels, which H.264 asks for.
SIZE = (9.0, 2.9)
#: Formats by their suffix.
WRITERS: dict[str, Any] = {".mp4": FFMpegWriter, ".gif": PillowWriter}


def animate(
    result: ResultFile,
    out: str | Path | None = None,
    *,
    frames_per_second: float = 5.0,
    overwrite: bool = False,
) -> Path:
    """Write a film with one frame a snapshot; returns its path.

    out: a .mp4 (by ffmpeg) or .gif file; by default animation.mp4 in the run folder, or .gif where ffmpeg is
    not installed. Raises InputError for fewer than two snapshots, for what cannot be written, and for a file
    that is there.
    """
    path = _check(result, out, frames_per_second=frames_per_second, overwrite=overwrite)
    partial = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    try:
        with fs.style():
            film = _Film(result)
            writer = WRITERS[path.suffix.lower()](fps=frames_per_second)
            with writer.saving(film.figure, str(partial), DPI):
                for index in range(result.snapshot_distances.size):
                    film.show(index)
                    writer.grab_frame()
        partial.replace(path)
    except OSError as error:
        raise InputError(f"out = {path} cannot be written: {error.strerror or error}") from error
    finally:
        partial.unlink(missing_ok=True)
    return path


def _check(result: ResultFile, out: str | Path | None, *, frames_per_second: float, overwrite: bool) -> Path:
    if result.study.samples_area:
        raise InputError(
            "a film needs whole fields, and the patches of this run cover a part of the area only"
        )
    kept = result.snapshot_distances.size
    if kept < 2:
        raise InputError(
            f"a film needs at least two snapshots, and this run kept {kept}; run it with more of them, "
            'such as --set output.snapshots=\'["30 mm", "600 mm", "1200 mm"]\''
        )
    if not 0.0 < frames_per_second <= 100.0:
        raise InputError(f"fps = {frames_per_second:g} is not possible; allowed: more than 0, to 100")
    if out is None:
        suffix = ".mp4" if FFMpegWriter.isAvailable() else ".gif"
        path = (result.folder or Path()) / f"animation{suffix}"
    else:
        path = Path(out)
    suffix = path.suffix.lower()
    if suffix not in WRITERS:
        raise InputError(f"out = {path}: the name of a {' or a '.join(WRITERS)} file is expected")
    if not WRITERS[suffix].isAvailable():
        raise InputError(f"out = {path} needs ffmpeg, which is not installed; a .gif file needs nothing")
    if path.exists() and (path.is_dir() or not overwrite):
        raise InputError(f"out = {path} is there already; give another file (out), or {OVERWRITE_IT}")
    if not path.parent.is_dir():
        raise InputError(f"out = {path}: the folder {path.parent} does not exist")
    return path


class _Film:
    """The figure whose contents change from frame to frame; scales stay."""

    def __init__(self, result: ResultFile) -> None:
        self._data = FigureData(result)
        self._rows = [self._data.row_of(distance) for distance in result.snapshot_distances]
        self.figure = Figure(figsize=SIZE, layout="constrained")
        FigureCanvasAgg(self.figure)
        self._disc_axes, self._pressure_axes, friction = self.figure.subplots(1, 3)
        window, means = self._data.window_of(BLOCKS), self._data.history["pressure_mean"][self._rows]
        disc = np.stack([self._disc_at(index) for index in (0, len(self._rows) - 1)])
        ends: dict[str, Any] = {"low": float(np.nanmin(disc)), "high": float(np.nanmax(disc))}
        label = "height of the disc, µm"
        self._disc = draw_map(self._disc_axes, disc[0], window, fs.HEIGHTS, label, **ends)
        self._apex = None
        if result.study.is_swept:  # the whole track, as wide as the panel
            self._disc.set_extent(blocks(result, 0, BLOCKS).extent)
            self._disc_axes.set_aspect("auto")
            self._disc_axes.set_xlabel("along the track, x, mm (line: the sphere)")
            self._apex = self._disc_axes.axvline(0.0, color=fs.SPHERE, lw=1.2)
        seen = [self._read(index).pressure for index in (0, len(self._rows) - 1)]
        first, norm = positive(seen[0]), pressure_scale(seen, [float(mean) for mean in means])
        self._pressure = draw_map(
            self._pressure_axes, first, window, fs.PRESSURES, "pressure, MPa", norm=norm
        )
        if result.study.is_swept:
            self._pressure_axes.set_xlabel("along sliding, from the sphere's apex, mm")
        self._line, self._point = self._course(friction)

    def show(self, index: int) -> None:
        """Draw snapshot number `index`."""
        view = self._read(index)
        self._disc.set_data(self._disc_at(index).T)
        self._pressure.set_data(positive(view.pressure).T)
        history = self._data.history
        self._disc_axes.set_title(f"{'track' if self._apex else 'disc'} {fs.after(view.distance)}")
        if self._apex is not None:
            self._apex.set_xdata([history["position"][view.row]] * 2)
        told = fs.with_scatter(*(float(history[f"pressure_{name}"][view.row]) for name in ("mean", "std")))
        self._pressure_axes.set_title(f"{told} MPa in contact")
        course = self._data.course["distance"]
        so_far = slice(0, max(int(np.searchsorted(course, view.distance, side="right")), 1))
        self._line.set_data(course[so_far], self._values[so_far])
        self._point.set_data(course[so_far][-1:], self._values[so_far][-1:])

    def _disc_at(self, index: int) -> FloatArray:
        """Return heights of the disc [µm]: under the sphere, or of the whole track that it slides over."""
        result = self._data.result
        if result.study.is_swept:
            return 1e3 * blocks(result, index, BLOCKS).heights
        return np.asarray(1e3 * self._data.bodies_at(index, most=BLOCKS).disc)

    def _read(self, index: int) -> View:
        return self._data.view(index, most=BLOCKS)

    def _course(self, axes: Axes) -> Any:
        """Draw the third panel's line up to now and its end, of the area where there is no friction."""
        history = self._data.course
        known = bool(np.isfinite(history["cof"]).any())
        self._values = history["cof" if known else "area_contact"]
        axes.set_ylabel("coefficient of friction, –" if known else "area in contact, mm²")
        axes.set_xlabel("sliding distance, mm")
        axes.set_xlim(0.0, 1.03 * float(history["distance"][-1]))
        axes.set_ylim(0.0, 1.05 * float(np.nanmax(self._values)))
        axes.xaxis.set_major_locator(MaxNLocator(5))
        (line,) = axes.plot([], [], color=fs.NEUTRAL)
        (point,) = axes.plot([], [], "o", color=fs.NEUTRAL, ms=4, clip_on=False)
        return line, point
