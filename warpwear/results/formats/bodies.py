"""Heights of the worn bodies, and what of a snapshot is written for other software."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray, Frame
from warpwear.history.quantities import FIELDS, Quantity
from warpwear.history.snapshot import Snapshot
from warpwear.laws.archard import BODIES
from warpwear.results.ensemble import digests_in
from warpwear.results.file import ResultFile
from warpwear.study.surface import surface_in
from warpwear.surfaces.reading import noted

#: Name of the whole track of a swept run, a body beside those over the domain of the contact.
TRACK = "track"
#: All rows or columns of a field.
ALL = slice(None)
#: A gap beyond this stands for a place beyond the counter-body's rim [mm].
NO_SURFACE = 1.0e20
_HEIGHTS: tuple[tuple[str, str, str, str | None, Frame], ...] = (
    ("height_counter", "counter-body", "0 at the unworn apex", None, "counter"),
    ("height_disc", "disc", "over its mean plane", None, "contact"),  # of a track what lies beneath
    ("height_track", "track", "over its mean plane", "track", "disc"),
)
#: Heights of worn bodies, as fields beside those of a snapshot.
HEIGHTS = {
    name: Quantity(name, "mm", f"height of the worn {body} out of its material, {over}", "cell", only, frame)
    for name, body, over, only, frame in _HEIGHTS
}
#: Every field that can be written, by name.
WRITABLE = FIELDS | HEIGHTS
#: Fields on the track of a swept run; its disc beneath the counter-body has a height of its own.
ON_THE_TRACK = tuple(name for name, quantity in WRITABLE.items() if quantity.frame == "disc")


def worn_heights(
    result: ResultFile, snapshot: Snapshot, body: str, part: tuple[slice, slice] = (ALL, ALL)
) -> FloatArray:
    """Return heights of a worn body [mm], positive out of its material, shape (nx, ny) or that of a part.

    The disc's are over its mean plane, the counter-body's over the apex it had, so that its cap lies below 0.
    Beyond the ball's edge the ball is NaN and the disc as it was before; NaN too if its file is gone or
    another now, and of a swept run, whose disc is what lies under the counter-body. Where the patches of a
    two-scale run cover nothing both are NaN.
    """
    x, y, gap = result.x[part[0]], result.y[part[1]], snapshot.gap[part]
    counter = result.unworn_counter(x, y) + snapshot.wear_counter[part]
    with np.errstate(invalid="ignore"):  # beyond the counter-body's edge
        heights = -counter if body == "counter" else counter - gap
    not_covered = np.isnan(gap)  # by the patches of a two-scale run
    beyond = (~np.isfinite(counter) | (gap > NO_SURFACE)) & ~not_covered
    heights[beyond | not_covered] = np.nan
    if body == "disc" and beyond.any() and snapshot.row is None:
        read = dict[str, set[str]]()
        with suppress(InputError), noted(read):
            unworn = surface_in(result.study).heights(x, y)
            if {*chain(*read.values())} <= {*digests_in(result).values()}:
                heights[beyond] = unworn[beyond]
    return heights


@dataclass(frozen=True)
class ExportedBody:
    """Hold a worn body at one snapshot: heights [mm] out of its material, (nx, ny), NaN where it has none.

    Axis 0 of the heights runs along the sliding direction.
    """

    name: str  # counter, disc or track
    title: str  # what it is of, for people
    x: FloatArray  # middles of the cells [mm], shape (nx,)
    y: FloatArray  # shape (ny,)
    heights: FloatArray
    approach: float = 0.0  # by which the counter-body has come down [mm]

    @property
    def upwards(self) -> bool:
        """Whether its material lies below it: not that of the counter-body, which comes down on the disc."""
        return self.name != "counter"

    @property
    def z(self) -> FloatArray:
        """Height in space [mm], shape (nx, ny): 0 is the disc's mean plane, the ball hangs over it."""
        return self.heights if self.upwards else -self.heights - self.approach


@dataclass(frozen=True)
class FieldGrid:
    """Fields at one snapshot over one grid, each of shape (nx, ny), by name; units are those of `WRITABLE`.

    NaN stands for what is not there.
    """

    name: str  # fields or track_fields
    distance: float  # [mm]
    x: FloatArray  # middles of the cells [mm], shape (nx,)
    y: FloatArray  # shape (ny,)
    fields: dict[str, FloatArray]


@dataclass(frozen=True)
class Job:
    """What is to be written: which snapshots, bodies and fields of a result.

    points: most along a side, of which each is the mean of a block of cells; None for every cell.
    added: files that go into a crate.
    """

    result: ResultFile
    numbers: tuple[int, ...]
    bodies: tuple[str, ...] = BODIES
    fields: tuple[str, ...] = tuple(WRITABLE)
    points: int | None = None
    added: tuple[Path, ...] = ()
    _kept: dict[str, Any] = field(default_factory=dict, repr=False)

    def suffix(self, number: int) -> str:
        """Return what tells a snapshot's file from others of its kind: nothing where there is one."""
        return f"_{number:04d}" if len(self.numbers) > 1 else ""

    @property
    def sheets(self) -> tuple[str, ...]:
        """Names of the sheets: the domain of the contact, and the track where it is asked for."""
        has_track = TRACK in self.bodies and any(name in ON_THE_TRACK for name in self.fields)
        return ("fields", "track_fields") if has_track else ("fields",)

    def snapshot(self, number: int) -> Snapshot:
        """Return the snapshot of a number, kept with heights made of it until another is asked for."""
        if self._kept.get("number") != number:
            self._kept.clear()
            self._kept.update(number=number, snapshot=self.result.snapshot(number))
        return self._kept["snapshot"]

    def _heights(self, body: str, number: int) -> FloatArray:
        """Return heights of a worn body at the snapshot of a number [mm], the track's over all its rows."""
        snapshot = self.snapshot(number)
        if body not in self._kept:
            if body != TRACK:
                self._kept[body] = worn_heights(self.result, snapshot, body)
            else:
                self._kept[body] = self.result.track_heights() - np.add(*self.result.track_loss(number))
        return self._kept[body]

    def body(self, name: str, number: int) -> ExportedBody:
        """Return a worn body at the snapshot of a number, reduced to `points`."""
        result, snapshot = self.result, self.snapshot(number)
        title = f"{result.study.study.name}: worn {name} after {snapshot.distance:g} mm of sliding"
        x, heights = result.track_x if name == TRACK else result.x, self._heights(name, number)
        history = result.history
        row = np.searchsorted(history["distance"], snapshot.distance * (1.0 - 1.0e-12))
        approach = float(history["approach"][min(int(row), history["approach"].size - 1)])
        if not abs(approach) < NO_SURFACE:
            raise InputError(f"the approach at {snapshot.distance:g} mm is {approach:g} mm, which is none")
        x, y, fields = self._reduced(x, {"heights": heights})
        return ExportedBody(name, title, x, y, fields["heights"], approach)

    def sheet(self, name: str, number: int, *, whole_disc: bool = False) -> FieldGrid:
        """Return the fields asked for at the snapshot of a number, reduced to `points`.

        whole_disc: of a swept run the fields of its disc stand in the sheet of the track alone, not as what
        lies beneath the counter-body in that of the domain, too.
        """
        result, snapshot = self.result, self.snapshot(number)
        on_track = name == "track_fields"
        swept = snapshot.row is not None
        fields: dict[str, FloatArray] = {}
        for key in self.fields:
            of_track = swept and key in ON_THE_TRACK
            if on_track != of_track and (on_track or whole_disc or key not in FIELDS):
                continue
            if key in snapshot.fields:
                values = snapshot.fields[key]
                fields[key] = snapshot.beneath(values) if of_track and not on_track else values
            elif key in HEIGHTS and (key != "height_track" or swept):
                fields[key] = self._heights(key.removeprefix("height_"), number)
        if "gap" in fields:
            fields["gap"] = np.where(fields["gap"] > NO_SURFACE, np.nan, fields["gap"])
        x = result.track_x if on_track else result.x
        return FieldGrid(name, snapshot.distance, *self._reduced(x, fields))

    def along(self, number: int) -> float:
        """Where the ball's apex is along the track [mm]; 0 where the track is not among the bodies."""
        row, result = self.snapshot(number).row, self.result
        return 0.0 if row is None or TRACK not in self.bodies else float(result.track_x[row] - result.x[0])

    def _reduced(
        self, x: FloatArray, fields: dict[str, FloatArray]
    ) -> tuple[FloatArray, FloatArray, dict[str, FloatArray]]:
        """Means over blocks of cells, at most `points` a side; a block cut short at an end is left out."""
        y = self.result.y
        if self.points is not None:
            along, across = (-(-side.size // self.points) for side in (x, y))
            nx, ny = x.size // along, y.size // across
            x, y = x[: nx * along].reshape(nx, along).mean(1), y[: ny * across].reshape(ny, across).mean(1)
            for name, values in fields.items():
                blocks = values[: nx * along, : ny * across].reshape(nx, along, ny, across)
                fields[name] = blocks.mean(axis=(1, 3))
        return x, y, fields


#: Name of a file, and what writes it at a path.
Files = Iterator[tuple[str, Callable[[Path], None]]]
