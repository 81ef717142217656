"""What figures need of a result, read once and reduced to what paper shows.

A field of 1500² cells is drawn on some 700 pixels, and matplotlib takes an image's memory several times.
So each snapshot is read once, cropped to the scar, reduced block by block, and let go.

How a block is reduced follows from what is asked of it. Pressure and state of contact are drawn as the
block's *largest*: contact is islands of a few cells, which means would fade out; islands look larger by up to
a block, so areas are written out as numbers. Heights and depths are *means*, which keep volumes. Where
pressure is shown as a height (in 3-D) or along a line it is the mean too, cells without contact included: the
volume under it is then the load at any block size.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Self

import numpy as np

from warpwear.grid import FloatArray, Grid
from warpwear.history.snapshot import Snapshot
from warpwear.results.export import worn_heights
from warpwear.results.file import ResultFile
from warpwear.results.track import whole_steps
from warpwear.surfaces.sphere import sag

#: Most blocks along a side of a map, and of a surface in 3-D.
MAP_BLOCKS = 500
SURFACE_BLOCKS = 70
#: Bins along a line of pressures.
BINS = 50
#: Snapshots in one figure.
SHOWN = 4
#: Side of what is shown over the scar's largest extent.
MARGIN = 1.15
#: Width of a strip of pressures over the side of what is shown.
STRIP = 0.125


class State(IntEnum):
    """What a cell does, by rank: a block shows the highest of its cells."""

    UNTOUCHED = 0
    TOUCHED = 1
    IN_CONTACT = 2
    AT_HARDNESS = 3


@dataclass(frozen=True)
class Window:
    """A part of the grid, cut into blocks of factor × factor cells."""

    x: slice
    y: slice
    factor: int
    extent: tuple[float, float, float, float]  # first x, last x, first y, last y [mm], edges of cells

    @classmethod
    def of(cls, grid: Grid, x: slice, y: slice, *, factor: int = 1) -> Self:
        """Make the window of these rows and columns of a grid, whose middle is the origin."""
        x0, x1 = ((row - 0.5 * grid.nx) * grid.cell for row in (x.start, x.stop))
        y0, y1 = ((column - 0.5 * grid.ny) * grid.cell for column in (y.start, y.stop))
        return cls(x, y, factor, (x0, x1, y0, y1))

    def means(self, field: FloatArray) -> FloatArray:
        """Return the mean of every block of a field of the grid, shape (blocks, blocks)."""
        return _blocks(field[self.x, self.y], self.factor).mean(axis=(1, 3))

    def largest(self, field: FloatArray) -> FloatArray:
        """Return the largest of every block of a field of the grid, shape (blocks, blocks)."""
        return _blocks(field[self.x, self.y], self.factor).max(axis=(1, 3))


@dataclass(frozen=True)
class Profile:
    """Lines through the middle in one direction."""

    place: FloatArray  # [mm]
    sphere: FloatArray  # height over the apex it had, its material above [mm]
    disc: FloatArray  # height over its mean plane [mm]
    wear_sphere: FloatArray  # [mm]
    wear_disc: FloatArray  # [mm]
    bins: FloatArray  # [mm]
    pressure: FloatArray  # mean of the middle strip in each bin [MPa]


@dataclass(frozen=True)
class View:
    """One snapshot, reduced."""

    distance: float  # [mm]
    row: int  # of the history
    pressure: FloatArray  # largest of each block [MPa]
    pressure_mean: FloatArray  # mean of each block, cells without contact included [MPa]
    state: FloatArray  # highest `State` of each block
    sphere: FloatArray  # heights, positive out of the material, mean of each block [mm]
    disc: FloatArray
    wear_sphere: FloatArray
    wear_disc: FloatArray
    along: Profile
    across: Profile


class FigureData:
    """History, study and reduced snapshots of a result."""

    def __init__(self, result: ResultFile) -> None:
        self.result = result
        self.history = result.history
        self.study = result.study
        self._views: dict[int, View] = {}

    @cached_property
    def course(self) -> dict[str, FloatArray]:
        """The history's columns at the steps that are drawn over the distance, those not cut short."""
        whole = whole_steps(self.result)
        return {name: values[whole] for name, values in self.history.items()}

    @property
    def shown(self) -> list[int]:
        """Numbers of the snapshots that figures show: the first, the last and some between."""
        kept = self.result.snapshot_distances.size
        places = np.linspace(0, kept - 1, min(SHOWN, kept))
        return sorted({round(float(place)) for place in places})

    @property
    def views(self) -> list[View]:
        """The snapshots shown, in order of distance."""
        return [self.view(index) for index in self.shown]

    @property
    def last(self) -> View:
        return self.view(self.result.snapshot_distances.size - 1)

    def view(self, index: int) -> View:
        """Return snapshot number `index`, reduced, and keep it."""
        if index not in self._views:
            self._views[index] = self.read(index)
        return self._views[index]

    def read(self, index: int, *, blocks: int = MAP_BLOCKS) -> View:
        """Return snapshot number `index`, reduced to at most `blocks` blocks along a side."""
        result, window = self.result, self.window_of(blocks)
        snapshot = result.snapshot(index)
        row = self.row_of(snapshot.distance)
        return View(
            distance=snapshot.distance,
            row=row,
            pressure=window.largest(snapshot.pressure),
            pressure_mean=window.means(snapshot.pressure),
            state=window.largest(self._state(snapshot, row)),
            sphere=window.means(worn_heights(result, snapshot, "sphere")),
            disc=window.means(worn_heights(result, snapshot, "disc")),
            wear_sphere=window.means(snapshot.wear_sphere),
            wear_disc=window.means(snapshot.lost_beneath),
            along=self._profile(snapshot, 0),
            across=self._profile(snapshot, 1),
        )

    def row_of(self, distance: float) -> int:
        """Return the row of the history whose step ends at a snapshot's distance [mm]."""
        return min(int(np.searchsorted(self.history["distance"], distance)), self.steps - 1)

    def pressure_at(self, row: int) -> tuple[float, float]:
        """Return mean and standard deviation [MPa] of the pressure in contact, of a row of the history."""
        return float(self.history["pressure_mean"][row]), float(self.history["pressure_std"][row])

    def name_of(self, body: str) -> str:
        """Return what a figure calls the body "sphere" or "disc"."""
        return "flat" if body == "sphere" and self.study.sphere.curvature == 0.0 else body

    @property
    def steps(self) -> int:
        return int(self.history["distance"].size)

    @cached_property
    def window(self) -> Window:
        """The scar at the end and some room: what maps show. Touched cells only ever become more."""
        return self.window_of(MAP_BLOCKS)

    def window_of(self, blocks: int) -> Window:
        """Return the scar at the end and some room, in at most `blocks` blocks along a side."""
        return self._centred(self._half, blocks)

    @cached_property
    def relief(self) -> tuple[FloatArray, Window]:
        """Heights [mm] of the unworn disc over the whole domain, for 3-D."""
        snapshot, window = self.result.snapshot(0), self._centred(np.inf, SURFACE_BLOCKS)
        unworn = worn_heights(self.result, snapshot, "disc") + snapshot.lost_beneath
        return window.means(unworn), window

    @cached_property
    def strip(self) -> float:
        """Width [mm] of the strip whose pressures are averaged for a line."""
        cell = self.study.grid.cell
        return max(1, round(STRIP * 2.0 * self._half / cell)) * cell

    @cached_property
    def _half(self) -> float:
        """Half the side [mm] of the square that is shown; the domain is a square, too."""
        places, cell = self.result.x, self.study.grid.cell
        if self.study.sphere.curvature == 0.0:
            return float(places[-1]) + 0.5 * cell
        touched = self.result.snapshot(-1).touched
        reach = max(float(np.abs(places[touched.any(axis=axis)]).max()) for axis in (0, 1))
        return min(MARGIN * reach + cell, float(places[-1]))

    def _centred(self, half: float, most: int) -> Window:
        """Cut a square around the middle into at most `most` blocks a side; part of a block is left out."""
        count = int((np.abs(self.result.x) <= half).sum())
        factor = -(-count // most)
        whole = max(count // factor, 1) * factor
        first = (self.result.x.size - whole) // 2
        part = slice(first, first + whole)
        return Window.of(self.study.cells, part, part, factor=factor)

    def _state(self, snapshot: Snapshot, row: int) -> FloatArray:
        """Return the `State` of every cell at a snapshot. row: of the history."""
        history, least = self.history, self.study.hardness * (1.0 - 1e-9)
        # The bearing area scales its pressure to the load, so that the hardness is met within a tolerance.
        if history["area_plastic"][row] >= history["area_contact"][row] * (1.0 - 1e-9):
            least = 0.0
        state = snapshot.touched.astype(np.float64)
        state[snapshot.pressure > 0.0] = State.IN_CONTACT
        state[(snapshot.pressure > 0.0) & (snapshot.pressure >= least)] = State.AT_HARDNESS
        return state

    def _profile(self, snapshot: Snapshot, axis: int) -> Profile:
        """Cut through the middle of a snapshot. axis: 0 along sliding, 1 across it."""
        places, shown = self.result.x, self.window.x

        def line(field: FloatArray) -> FloatArray:
            return np.asarray(np.take(field, places.size // 2, axis=1 - axis)[shown])

        strip = np.compress(np.abs(places) <= 0.5 * self.strip, snapshot.pressure, axis=1 - axis)
        pressure = strip.mean(axis=1 - axis)[shown]
        cells = -(-pressure.size // BINS)
        bins = pressure.size // cells
        first = (pressure.size - bins * cells) // 2
        whole = slice(first, first + bins * cells)
        curvature = self.study.sphere.curvature
        sphere = sag_or_nan(places[shown], np.zeros(1), curvature)[:, 0] + line(snapshot.wear_sphere)
        return Profile(
            place=places[shown],
            sphere=sphere,
            disc=sphere - line(snapshot.gap),
            wear_sphere=line(snapshot.wear_sphere),
            wear_disc=line(snapshot.lost_beneath),
            bins=places[shown][whole].reshape(bins, cells).mean(axis=1),
            pressure=pressure[whole].reshape(bins, cells).mean(axis=1),
        )


def _blocks(field: FloatArray, n: int) -> FloatArray:
    """View a field in squares of n × n, shape (blocks, n, blocks, n); part of a square is left out."""
    nx, ny = field.shape[0] // n, field.shape[1] // n
    return field[: nx * n, : ny * n].reshape(nx, n, ny, n)


def coarsen(field: FloatArray, most: int) -> tuple[FloatArray, int]:
    """Return means over squares, at most `most` along a side, and how many places a square is wide."""
    n = -(-max(field.shape) // most)
    return _blocks(field, n).mean(axis=(1, 3)), n


def positive(values: FloatArray) -> FloatArray:
    """Return values with NaN, which is not drawn, where they are not above zero."""
    return np.where(values > 0.0, values, np.nan)


def sag_or_nan(x: FloatArray, y: FloatArray, curvature: float) -> FloatArray:
    """Return heights [mm] of the unworn sphere over its apex at x × y; NaN beyond it. curvature: [1/mm]"""
    heights = sag(x, y, radius=1.0 / curvature if curvature else np.inf)
    return np.where(np.isinf(heights), np.nan, heights)
