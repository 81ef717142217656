"""The HDF5 file of a run, read by `ResultFile`."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

import h5py
import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.snapshot import FIELDS, Snapshot
from warpwear.results.seal import digest_of, has_mark, words_of
from warpwear.study.study import Study

Made = TypeVar("Made")
FILE_NAME = "result.h5"
#: What the seal of the file begins with.
MAGIC = "warpwear result"


def check_seal(path: Path) -> None:
    """Raises InputError for a sealed file that is not what was written. One made by hand may be anything."""
    try:
        with path.open("rb") as file:
            words = words_of(file)
            sealed = " ".join(words[:2]) == MAGIC
            if sealed and words[2:] != [digest_of(file)]:
                raise InputError(
                    f"{path} is damaged: it is not what was written, by a fault of the disk or because "
                    "another program changed it; --overwrite runs the study again, and what is added to a "
                    "result belongs in a file of its own."
                )
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error


def is_one(path: Path) -> bool:
    """Whether a file calls itself a result of warpwear, damaged or not."""
    return has_mark(path, MAGIC)


@contextmanager
def _damage_told(file: h5py.File) -> Iterator[None]:
    """InputError where a file cannot give what it must hold."""
    name = file.filename
    try:
        yield
    except InputError:
        raise
    except (OSError, KeyError, ValueError, TypeError, RuntimeError, AttributeError) as error:
        raise InputError(f"{name} is damaged or not a result of warpwear: {error}.") from error


class ResultFile:
    """What a run left in its file: history, snapshots, study. Open one with `ResultFile.open(path)`."""

    def __init__(self, file: h5py.File, folder: Path | None = None) -> None:
        self._file = file
        self.folder = folder
        self._made: dict[str, Any] = {}

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """The result in a run folder or an HDF5 file. Raises InputError."""
        path = Path(path)
        file = path / FILE_NAME if path.is_dir() else path
        if not file.is_file():
            raise InputError(f"{path} holds no result: a run folder or its {FILE_NAME} is expected.")
        check_seal(file)
        try:
            opened = h5py.File(file, "r")
        except OSError as error:
            raise InputError(f"{file} is no HDF5 file or is damaged: {error}.") from error
        with _damage_told(opened):
            is_result = "history" in opened and "study" in opened.attrs
        if not is_result:
            opened.close()
            raise InputError(f"{file} is an HDF5 file, but not a result of warpwear.")
        return cls(opened, file.parent)

    @cached_property
    def history(self) -> dict[str, FloatArray]:
        """Column name -> one value a step, shape (steps,). Units and meanings: `history.columns`."""
        with _damage_told(self._file):
            return {name: dataset[()] for name, dataset in self._file["history"].items() if dataset.ndim == 1}

    @cached_property
    def load_share(self) -> FloatArray:
        """Load of each patch [N], shape (steps, patches); a patch is a macro cell, number x · across + y.

        Raises InputError for a run without patches.
        """
        return self._of_patches("history/load_share")

    @cached_property
    def area_patch(self) -> FloatArray:
        """Real area of contact of each patch [mm²], shape (steps, patches), as `load_share`."""
        return self._of_patches("history/area_patch")

    @cached_property
    def macro_x(self) -> FloatArray:
        """Centres of the macro cells along the sliding direction [mm], shape (across,), as `load_share`."""
        return self._of_patches("macro/x")

    @cached_property
    def macro_y(self) -> FloatArray:
        """Centres of the macro cells across the sliding direction [mm], shape (across,), as `load_share`."""
        return self._of_patches("macro/y")

    def _of_patches(self, name: str) -> FloatArray:
        if name not in self._file:
            raise InputError(
                f"the run has no patches: study.model is '{self.study.study.model}', not 'two-scale'."
            )
        with _damage_told(self._file):
            values: FloatArray = self._file[name][()]
        return values

    @cached_property
    def study(self) -> Study:
        """The study that was run."""
        with _damage_told(self._file):
            return Study.stored(self._file.attrs["study"])

    @property
    def attributes(self) -> dict[str, Any]:
        """Version, device, threads, precision, finished."""
        with _damage_told(self._file):
            return {k: v for k, v in self._file.attrs.items() if k != "study"}

    @property
    def finished(self) -> bool:
        """False for a run that was interrupted."""
        with _damage_told(self._file):
            return bool(self._file.attrs["finished"])

    @cached_property
    def x(self) -> FloatArray:
        """Centres of the cells along the sliding direction [mm], shape (nx,)."""
        return self._centres("x")

    @cached_property
    def y(self) -> FloatArray:
        """Centres of the cells across the sliding direction [mm], shape (ny,)."""
        return self._centres("y")

    def _centres(self, axis: str) -> FloatArray:
        with _damage_told(self._file):
            values: FloatArray = self._file[f"grid/{axis}"][()]
        return values

    @cached_property
    def snapshot_distances(self) -> FloatArray:
        """Sliding distances of the snapshots [mm]."""
        with _damage_told(self._file):
            return np.array([group.attrs["distance"] for group in self._file["snapshots"].values()])

    def snapshot(self, index: int) -> Snapshot:
        """Snapshot number `index`; -1 is the end. Raises IndexError."""
        with _damage_told(self._file):
            names = list(self._file["snapshots"])
            group = self._file["snapshots"][names[index]]
            row = int(group.attrs["row"]) if "row" in group.attrs else None
            fields = {name: group[name][()] for name in FIELDS if name in group}
            return Snapshot(float(group.attrs["distance"]), row=row, **fields)

    @cached_property
    def track_x(self) -> FloatArray:
        """Centres of the track's rows along the sliding direction [mm], shape (rows,). KeyError without."""
        values: FloatArray = self._file["track/x"][()]
        return values

    def track_heights(self, rows: slice = slice(None)) -> FloatArray:
        """Heights of the track before any wear [mm], shape (rows, ny). KeyError without a track."""
        values: FloatArray = self._file["track/heights"][rows]
        return values

    def track_loss(self, index: int, rows: slice = slice(None)) -> tuple[FloatArray, FloatArray]:
        """Depths worn off the track and displaced of it for good at snapshot number `index` [mm]."""
        group = self._file["snapshots"][list(self._file["snapshots"])[index]]
        worn: FloatArray = group["wear_disc"][rows]
        return worn, group["plastic_disc"][rows] if "plastic_disc" in group else np.zeros_like(worn)

    @property
    def record(self) -> dict[str, Any]:
        """What the run recorded beside numbers: the surface, notices and warnings, elapsed time."""
        with _damage_told(self._file):
            found: dict[str, Any] = json.loads(self._file.attrs.get("record", "{}"))
            return found

    def once(self, make: Callable[[Self], Made]) -> Made:
        """What a function makes of this result; it is called the first time only."""
        name = f"{make.__module__}.{make.__qualname__}"
        if name not in self._made:
            self._made[name] = make(self)
        made: Made = self._made[name]
        return made

    def close(self) -> None:
        """Close the file. What was read stays."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        distance = self.history["distance"]
        state = "finished" if self.finished else "interrupted"
        name = self.study.study.name
        return f"<Result of '{name}': {distance[-1]:g} mm in {distance.size} steps, {state}>"
