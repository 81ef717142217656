"""The wear of a run as a film: the disc, the pressure and the coefficient of friction, a frame a snapshot.

Where a ball slides over a track, its frames show the whole track, the counter-body's place and its pressure.
"""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter

from warpwear.errors import OVERWRITE_IT, InputError, explained
from warpwear.figures import describe, style
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, Map, Panel, Scale
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.fields import pressure_scale
from warpwear.figures.of_run.view import positive
from warpwear.figures.paint import paint
from warpwear.figures.wording import after, with_scatter
from warpwear.grid import FloatArray
from warpwear.history.quantities import BY_NAME
from warpwear.results.file import ResultFile
from warpwear.results.manifest import replacing
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
    film, writer = _Film(result), WRITERS[path.suffix.lower()](fps=frames_per_second)
    with (
        explained(f"out = {path} cannot be written"),
        replacing(path) as new,
        style.style(),
        writer.saving(paint(film.frame(0)), str(new), DPI),
    ):
        for index in range(result.snapshot_distances.size):
            writer.fig = paint(film.frame(index))
            writer.grab_frame()
    return path


def _check(result: ResultFile, out: str | Path | None, *, frames_per_second: float, overwrite: bool) -> Path:
    if result.study.samples_area:
        raise InputError("a film needs whole fields, and this run's patches cover a part of the area only")
    count = result.snapshot_distances.size
    if count < 2:
        raise InputError(
            f"a film needs at least two snapshots, and this run kept {count}; run it with more of them, "
            'such as --set output.snapshots=\'["30 mm", "600 mm", "1200 mm"]\''
        )
    if not 0.0 < frames_per_second <= 100.0:
        raise InputError(f"fps = {frames_per_second:g} is not possible; allowed: more than 0, to 100")
    name = f"animation{'.mp4' if FFMpegWriter.isAvailable() else '.gif'}"
    path = (result.folder or Path()) / name if out is None else Path(out)
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
    """Declares the frames of a film, whose scales stay."""

    def __init__(self, result: ResultFile) -> None:
        self._data = data = FigureData(result, range(result.snapshot_distances.size), blocks=BLOCKS)
        self._swept, ends = result.study.is_swept, (0, result.snapshot_distances.size - 1)
        means = [float(data.history["pressure_mean"][data.row_of(distance)]) for distance in data.distances]
        pressures = [data.view(index).pressure for index in ends]
        self._pressure = pressure_scale(pressures, means, "pressure, MPa")
        disc = np.stack([self._disc_at(index)[0] for index in ends])
        label = "height of the disc, µm"
        self._height = Scale(label, float(np.nanmin(disc)), float(np.nanmax(disc)), colours="heights")
        self._is_friction = bool(np.isfinite(data.course["cof"]).any())

    def frame(self, index: int) -> Figure:
        """Declare the frame of snapshot number `index`."""
        data, window = self._data, self._data.window
        view, (heights, extent) = data.view(index), self._disc_at(index)
        more: dict[str, Any] = {}
        near: dict[str, Any] = {}
        if self._swept:  # the whole track, as wide as the panel
            position = Level(float(data.history["position"][view.row]), look=Look(describe.COUNTER), axis="x")
            label = "along the track, x, mm (line: the counter-body)"
            more = {"square": False, "levels": [position], "x": label}
            near = {"x": "along sliding, from the counter-body's apex, mm"}
        disc = f"{'track' if self._swept else 'disc'} {after(view.distance)}"
        mean, deviation = (float(data.history[f"pressure_{name}"][view.row]) for name in ("mean", "std"))
        contact = f"{with_scatter(mean, deviation)} MPa in contact"
        panels: list[Panel] = [
            Map(disc, [heights], extent, self._height, [disc], **more),
            Map(contact, [positive(view.pressure)], window.extent, self._pressure, [contact], **near),
            self._course(view.distance),
        ]
        return Figure(panels, width=SIZE[0], height=SIZE[1])

    def _disc_at(self, index: int) -> tuple[FloatArray, describe.Ends]:
        """Return heights of the disc [µm] and their extent: under the ball, or of its whole track."""
        if self._swept:
            track = blocks(self._data.result, index, BLOCKS)
            return 1e3 * track.heights, track.extent
        return 1e3 * self._data.bodies_at(index)["disc"], self._data.window.extent

    def _course(self, slid: float) -> Chart:
        """Declare the course up to a distance and its end, of the area where there is no friction."""
        course = self._data.course
        quantity = BY_NAME["cof" if self._is_friction else "area_contact"]
        values, label = course[quantity.name], quantity.axis
        count = max(int(np.searchsorted(course["distance"], slid, side="right")), 1)
        x, y = course["distance"][:count], values[:count]
        dot = Line(x[-1:], y[-1:], look=describe.DOT, clipped=False)
        distance = Axis(describe.DISTANCE, low=0.0, high=1.03 * float(course["distance"][-1]), ticks=5)
        value = Axis(label, low=0.0, high=1.05 * float(np.nanmax(values)))
        return Chart(label, distance, value, [Line(x, y), dot])
