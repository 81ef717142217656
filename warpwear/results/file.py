"""The HDF5 file of a run, read by `ResultFile`."""

import json
import operator
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from numbers import Real
from pathlib import Path
from typing import Any, Self, SupportsIndex, TypeVar, overload

import h5py
import numpy as np

from warpwear.errors import OVERWRITE_IT, InputError, explained
from warpwear.grid import FloatArray, IntArray
from warpwear.history.quantities import FIELDS, OF_PIECES, UNITS, columns_of, stress_columns
from warpwear.history.rows import History, Named
from warpwear.history.snapshot import Snapshot, lowered
from warpwear.laws.form import Form, Given
from warpwear.results.check import ATTRIBUTES, check_content, check_fields
from warpwear.results.seal import digest_of, has_mark, open_to_read, read_header
from warpwear.study.study import Study
from warpwear.study.units import parse

Derived = TypeVar("Derived")
FILE_NAME = "result.h5"
#: Heights that were given as an array, beside the file.
SURFACE_FILE = "surface.npy"
#: Attribute of a result whose study names the `SURFACE_FILE` beside it.
OWN_SURFACE = "own_surface"
#: Datasets beside the columns of the history: numbers of its patches.
PATCH = "patch"
#: Part of a distance asked for by which a snapshot's may differ and be the one.
SAME_DISTANCE = 1.0e-6
#: Why a run has no datasets of a track, or of patches.
NO_TRACK, NO_PATCHES = "has no track", "has no patches: study.model is '{model}', not 'two-scale'"
#: What the seal of the file begins with.
MAGIC = "warpwear result"


def check_seal(path: Path) -> None:
    """Raise InputError for a sealed file that is not what was written. One made by hand may be anything."""
    with explained(f"{path} cannot be read"), path.open("rb") as file:
        words = read_header(file)
        if " ".join(words[:2]) == MAGIC and words[2:] != [digest_of(file)]:
            raise InputError(
                f"{path} is damaged: it is not what was written, by a fault of the disk or because another "
                f"program changed it; run the study again and {OVERWRITE_IT}; what is added to a result "
                "belongs in a file of its own."
            )


def is_one(path: Path) -> bool:
    """Whether a file calls itself a result of warpwear, damaged or not."""
    return has_mark(path, MAGIC)


class Snapshots(Sequence[Snapshot]):
    """The snapshots of a result, each read from its file when it is asked for; a slice is a part of them."""

    def __init__(self, result: "ResultFile", numbers: range) -> None:
        self._result, self._numbers = result, numbers

    def __len__(self) -> int:
        return len(self._numbers)

    @overload
    def __getitem__(self, index: int) -> Snapshot: ...
    @overload
    def __getitem__(self, index: slice) -> "Snapshots": ...
    def __getitem__(self, index: int | slice) -> "Snapshot | Snapshots":
        if isinstance(index, slice):
            return Snapshots(self._result, self._numbers[index])
        return self._result.snapshot(self._numbers[_number(index, len(self))])

    def __repr__(self) -> str:
        distances = self._result.snapshot_distances[self._numbers]
        return f"<{len(self)} snapshots at {', '.join(f'{d:g}' for d in distances)} mm>"


def _stored(name: str, about: str, lacks: str = "") -> "cached_property[FloatArray]":
    """Make the property of a result that reads a dataset once. lacks: what a run without it lacks."""

    def read(result: "ResultFile") -> FloatArray:
        return result._array(name, lacks)

    read.__doc__ = f"{about} Raises InputError for a run without it." if lacks else about
    return cached_property(read)


def _opened(file: Path) -> h5py.File:
    """Open the file of a result. Raises InputError."""
    try:
        return open_to_read(file)
    except OSError as error:
        raise InputError(f"{file} is no HDF5 file or is damaged: {error}.") from error


class ResultFile:
    """What a run left in its file: history, snapshots, study.

    path: a run folder, or the HDF5 file in it. What was read stays when the file is closed.
    """

    def __init__(self, path: str | Path) -> None:
        path = Path(path)
        file = path / FILE_NAME if path.is_dir() else path
        if not file.is_file():
            raise InputError(f"{path} holds no result: a run folder or its {FILE_NAME} is expected.")
        check_seal(file)
        self._hold(_opened(file), file)
        try:
            with self._reading() as content:
                if not ("history" in content and "study" in content.attrs):
                    raise InputError(f"{file} is an HDF5 file, but not a result of warpwear.")
                check_content(content, self.study, patch=PATCH)
        except BaseException:
            self.close()
            raise

    def _hold(self, file: h5py.File, path: Path | None) -> None:
        self._file = file
        self.path = path  # of the file, None for a run in memory
        self._derived: dict[str, Any] = {}
        #: What the run took [s], by the names of `warpwear.clock.REPORTED`; empty of one that was opened.
        self.seconds: dict[str, float] = {}
        #: Number -> snapshot, of those that need not be read.
        self.at_hand: dict[int, Snapshot] = {}

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Open the result in a run folder or an HDF5 file, as `Result(path)` does.

        Parameters
        ----------
        path : path
            A run folder, or the HDF5 file in it.

        Returns
        -------
        Result
            With its file open until `close`, or the end of a `with`.

        Raises
        ------
        InputError
            For what is no result, or damaged.
        """
        return cls(path)

    @classmethod
    def of(cls, file: h5py.File | Path) -> Self:
        """Return the result in a file of memory, or in one that this process has just sealed, or looked at.

        Raises InputError.
        """
        result = cls.__new__(cls)
        on_disk = isinstance(file, Path)
        result._hold(_opened(file) if on_disk else file, file if on_disk else None)
        return result

    @property
    def folder(self) -> Path | None:
        """The run folder; None for a run in memory."""
        return None if self.path is None else self.path.parent

    @property
    def name(self) -> str:
        """What sentences call the run: its folder, or the name of its study."""
        return str(self.folder or f"'{self.study.study.name}' in memory")

    @contextmanager
    def _reading(self) -> Iterator[h5py.File]:
        """Return the open file. Raises InputError where it is closed, or cannot give what it must hold."""
        if not self._file:
            again = f"open it again with Result.open({str(self.path)!r})" if self.path else "it was in memory"
            raise InputError(f"this result is closed, so that nothing more can be read from it: {again}.")
        try:
            yield self._file
        except InputError:
            raise
        except (OSError, KeyError, ValueError, TypeError, RuntimeError, AttributeError) as error:
            name = self.path or "this result"
            raise InputError(f"{name} is damaged or not a result of warpwear: {error}.") from error

    @cached_property
    def history(self) -> History:
        """Map each column's name to one value a step, shape (steps,); in the units of `units`."""
        with self._reading() as file:
            columns = {
                name: column[()]
                for name, column in file["history"].items()
                if column.ndim == 1 and name != PATCH
            }
        declared = [name for name in UNITS if name in columns]
        return History((name, columns[name]) for name in dict.fromkeys((*declared, *columns)))

    @property
    def units(self) -> dict[str, str]:
        """Map the name of a column, field or table to its unit, such as "mm^2"."""
        return Named(UNITS | {column.name: column.units for column in columns_of(self.study)})

    x = _stored("grid/x", "Hold the centres of the cells along the sliding direction [mm], shape (nx,).")
    y = _stored("grid/y", "Hold the centres of the cells across the sliding direction [mm], shape (ny,).")
    track_x = _stored("track/x", "Hold the centres of the rows of the track [mm], shape (rows,).", NO_TRACK)
    load_share = _stored(
        "history/load_share",
        "Hold the load of each patch [N], (steps, patches); a patch is macro cell number x · across + y.",
        NO_PATCHES,
    )
    area_patch = _stored("history/area_patch", "Hold each patch's area [mm²], as load_share.", NO_PATCHES)
    macro_x = _stored("macro/x", "Hold the places of macro cells along x [mm], (across,).", NO_PATCHES)
    macro_y = _stored("macro/y", "Hold the places of macro cells along y [mm], (across,).", NO_PATCHES)

    @cached_property
    def pieces(self) -> dict[str, FloatArray]:
        """The pieces in which bodies have worn, in their order, by the columns of their table.

        step, body (0 the counter-body, 1 the disc), x, y, volume, diameter: shape (pieces,) each. Raises
        InputError for a run whose wear leaves at once.
        """
        lacks = "has no pieces: wear.particle is not given"
        return Named((name, self._array(f"pieces/{name}", lacks)) for name in OF_PIECES)

    @cached_property
    def stresses(self) -> dict[str, FloatArray]:
        """What the stresses below the disc come to at the snapshots, by the names of `units`.

        depth, yielding, mises, max_shear, principal, and of fatigue crossland, dang_van, with the places _x
        and _y of the largest: shape (snapshots, depths). mises_plane and so on, in the plane of
        output.stress_plane: shape (snapshots, depths, cells). Raises InputError for a run without stresses.
        """
        lacks = "has no stresses: output.stress_depths is not given"
        return Named((name, self._array(f"stresses/{name}", lacks)) for name in stress_columns(self.study))

    def _array(self, name: str, otherwise: str = "", rows: slice = slice(None)) -> FloatArray:
        """Rows of a dataset. otherwise: what the run lacks where it has none, as the end of a sentence."""
        with self._reading() as file:
            if otherwise and name not in file:
                raise InputError(f"the run {otherwise.format(model=self.study.study.model)}.")
            return file[name][rows]

    @cached_property
    def study(self) -> Study:
        """The study that was run. Heights given as an array are those in the run folder, wherever it is."""
        with self._reading() as file:
            own = self.folder / SURFACE_FILE if self.folder and self.owns_surface else None
            surface = str(own.resolve()) if own and own.is_file() else None
            return Study.stored(file.attrs["study"], surface=surface)

    @property
    def attributes(self) -> dict[str, Any]:
        """Return version, device, threads, precision, finished."""
        with self._reading() as file:
            return {name: file.attrs[name] for name in ATTRIBUTES}

    @property
    def owns_surface(self) -> bool:
        """Whether the study names the heights that lie beside the result, in its folder."""
        with self._reading() as file:
            return OWN_SURFACE in file.attrs

    @property
    def finished(self) -> bool:
        """False for a run that was interrupted."""
        return bool(self.attributes["finished"])

    @cached_property
    def snapshot_distances(self) -> FloatArray:
        """Return the sliding distances of the snapshots [mm]."""
        return self._of_snapshots("distance")

    @cached_property
    def snapshot_rows(self) -> IntArray:
        """Row of the track under the ball's first row, one a snapshot; empty of a run without a track."""
        return self._of_snapshots("row").astype(np.int64)

    @cached_property
    def load_on_filled(self) -> FloatArray:
        """Share of the load on points that the disc's file lacks, one a snapshot; empty where it is whole."""
        return self._of_snapshots("load_on_filled")

    def _of_snapshots(self, name: str) -> FloatArray:
        """Return an attribute of all snapshots that have it."""
        with self._reading() as file:
            return np.array(
                [group.attrs[name] for group in file["snapshots"].values() if name in group.attrs]
            )

    @property
    def snapshots(self) -> Snapshots:
        """All snapshots, as a sequence that reads one when it is asked for it; the last is the end."""
        return Snapshots(self, range(self.snapshot_distances.size))

    def snapshot(self, index: SupportsIndex) -> Snapshot:
        """Return a snapshot by its number.

        Parameters
        ----------
        index : int
            From 0; -1 is the end.

        Returns
        -------
        Snapshot
            Its fields, read from the file.

        Raises
        ------
        InputError
            For what is no number, and where the file is closed.
        IndexError
            For a number beyond the snapshots.
        """
        number = _number(index, self.snapshot_distances.size)
        at_hand = self.at_hand.get(number)
        if at_hand is not None:
            in_memory = self._file and self._file.driver == "core"  # and asked for by whom may change it
            return replace(at_hand, fresh=frozenset()).lasting() if in_memory else at_hand
        with self._reading() as file:
            group = file["snapshots"][list(file["snapshots"])[number]]
            row = int(group.attrs["row"]) if "row" in group.attrs else None
            fields = {name: group[name][()].astype(float) for name in FIELDS if name in group}
            check_fields(fields, self.study)
            on_filled = float(group.attrs["load_on_filled"]) if "load_on_filled" in group.attrs else None
            return Snapshot.of(float(group.attrs["distance"]), fields, row=row, load_on_filled=on_filled)

    def at(self, distance: str | float) -> Snapshot:
        """Return the snapshot kept at a distance.

        If no step ended exactly there, as of a swept run or snapshots = "auto", the first snapshot after it.

        Parameters
        ----------
        distance : str or float
            Text with a unit, such as "30 mm", or a number [mm].

        Returns
        -------
        Snapshot
            Its fields.

        Raises
        ------
        InputError
            For another distance, naming those that are kept.
        """
        return self.snapshot(self.number_at(distance))

    def number_at(self, distance: str | float) -> int:
        """Return the number of the snapshot that `at` finds. Raises InputError."""
        try:
            number = isinstance(distance, Real) and not isinstance(distance, bool)
            place = float(distance) if number else parse(distance, "mm")
        except ValueError as error:
            raise InputError(f"at = {distance!r}: {error}.") from error
        distances, slack = self.snapshot_distances, SAME_DISTANCE * abs(place)
        numbers = np.flatnonzero(np.abs(distances - place) <= slack)
        if not numbers.size and place in self.study.snapshot_distances:
            numbers = np.flatnonzero(distances > place)
        if not numbers.size:
            raise InputError(
                f"at = {distance!r}: no snapshot is kept there; allowed: "
                f"{', '.join(f'{d:g} mm' for d in distances) or 'none, as the run has no snapshots'}."
            )
        return int(numbers[0])

    def track_heights(self, rows: slice = slice(None)) -> FloatArray:
        """Heights of the track before any wear [mm], shape (rows, ny). InputError without a track."""
        return self._array("track/heights", NO_TRACK, rows)

    @cached_property
    def form(self) -> Form:
        """Return the unworn counter-body's form, of a measured one as the run had it."""
        form = self.study.counter.form
        if not isinstance(form, Given):
            return form
        return replace(form, values=self._array("counter/heights", "has no measured counter-body"))

    def unworn_counter(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the unworn counter-body's height over its lowest point.

        Of a measured one it is that of the nearest cells; infinite where there is no body.

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
            Where the file that has a measured one is closed.
        """
        form, cell = self.form, self.study.grid.cell
        if not isinstance(form, Given):
            return form.heights(x, y)
        axes = zip((x, y), (self.x, self.y), strict=True)
        near = (
            np.clip(np.floor((p - axis[0]) / cell + 0.5).astype(int), 0, axis.size - 1) for p, axis in axes
        )
        return form.values[np.ix_(*near)]

    def track_loss(self, index: int, rows: slice = slice(None)) -> tuple[FloatArray, FloatArray]:
        """Return depths worn off the track, and those it lies lower by beside, at snapshot `index` [mm]."""
        with self._reading() as file:
            number = _number(index, self.snapshot_distances.size)
            at_hand, name = self.at_hand.get(number), list(file["snapshots"])[number]
            group = at_hand.fields if at_hand else file["snapshots"][name]
            worn: FloatArray = group["wear_disc"][rows].astype(float)
            return worn, np.zeros_like(worn) + lowered(group, rows)

    @property
    def record(self) -> dict[str, Any]:
        """What the run recorded beside numbers: the surface, notices and warnings, elapsed time."""
        with self._reading() as file:
            return json.loads(file.attrs.get("record", "{}"))

    def once(self, make: Callable[[Self], Derived]) -> Derived:
        """Return what a function makes of this result; it is called the first time only."""
        name = f"{make.__module__}.{make.__qualname__}"
        if name not in self._derived:
            self._derived[name] = make(self)
        return self._derived[name]

    def take_over(self, same: "ResultFile") -> None:
        """Keep what was made of the same result before it was moved, so that it is not made again."""
        self._derived |= same._derived

    def close(self) -> None:
        """Close the file. What was read stays."""
        self._file.close()
        self.at_hand = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> tuple[type[Self], tuple[Path]]:
        """Pickle a result as its path, from which it is opened again."""
        if self.path is None:
            raise InputError("a result in memory cannot be pickled; give the run a folder with out.")
        return type(self), (self.path.resolve(),)

    def __fspath__(self) -> str:
        """Return the run folder, so that a result may stand where a path does. Raises InputError."""
        if self.folder is None:
            raise InputError("a result in memory has no folder: run with out.")
        return str(self.folder)

    def __repr__(self) -> str:
        if not self._file:
            return f"<Result, closed: {self.path or 'it was in memory'}>"
        distance = self.history["distance"]
        state = "finished" if self.finished else "interrupted"
        name = self.study.study.name
        return f"<Result of '{name}': {distance[-1]:g} mm in {distance.size} steps, {state}>"


def _number(index: SupportsIndex, count: int) -> int:
    """Count a place from a sequence's start. Raises InputError for no whole number, IndexError."""
    try:
        number = operator.index(index)
    except TypeError:
        raise InputError(
            f"snapshot = {index!r}: a number from 0 to {count - 1} is expected, -1 is the last; for a "
            "distance use result.at('30 mm')."
        ) from None
    if not -count <= number < count:
        raise IndexError(f"snapshot {number} is not among the {count} of this result")
    return number % count
