"""Results: one HDF5 file a run, read by `Result`."""

import json
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import h5py
import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.seal import digest_of, has_mark, words_of
from warpwear.study import Study

if TYPE_CHECKING:
    from warpwear.evolution import SurfaceEvolution
    from warpwear.figures import Plotter

FIELDS = {
    "pressure": "MPa",
    "wear_sphere": "mm",
    "wear_disc": "mm",
    "gap": "mm",
    "plastic_disc": "mm",  # of a swept disc that keeps its dents
}
FILE_NAME = "result.h5"
#: What the seal of the file begins with.
MAGIC = "warpwear result"


@dataclass(frozen=True)
class Snapshot:
    """Fields at one sliding distance, each of shape (nx, ny), axis 0 along the sliding direction.

    Of a swept run the fields of the disc cover the track, shape (rows, ny), whose row number `row` lies under
    the first row of the others.
    """

    distance: float  # [mm]
    pressure: FloatArray  # [MPa], solved in the step that ends here
    wear_sphere: FloatArray  # [mm]
    wear_disc: FloatArray  # [mm]
    gap: FloatArray  # [mm], after the step's wear
    plastic_disc: FloatArray | None = None  # [mm], displaced for good, of a swept disc that keeps its dents
    row: int | None = None  # of the track, under the sphere's first row

    @property
    def wear_beneath(self) -> FloatArray:
        """Wear of the disc under the sphere's domain [mm], shape (nx, ny)."""
        return self.wear_disc if self.row is None else self._under(self.wear_disc)

    @property
    def touched(self) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
        """Cells ever touched, shape (nx, ny): of a swept run those of the sphere, or of the disc beneath a
        sphere that does not wear."""
        touched = (self.wear_sphere > 0.0) | (self.pressure > 0.0)
        if self.row is not None and self.wear_sphere.any():
            return np.asarray(touched)
        return np.asarray(touched | (self.wear_beneath > 0.0))

    @property
    def lost_beneath(self) -> FloatArray:
        """What is gone of the disc under the sphere's domain [mm]: worn, or displaced for good."""
        if self.plastic_disc is None:
            return self.wear_beneath
        return self.wear_beneath + self._under(self.plastic_disc)

    def _under(self, field: FloatArray) -> FloatArray:
        assert self.row is not None
        rows = np.arange(self.row, self.row + self.pressure.shape[0]) % field.shape[0]
        return np.asarray(field[rows])


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


class Result:
    """A run: its history, its snapshots, its figures. Open one with `Result.open(path)`."""

    def __init__(self, file: h5py.File, folder: Path | None = None) -> None:
        self._file = file
        self.folder = folder

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
        """Column name -> one value a step, shape (steps,). Units and meanings: `warpwear.history.COLUMNS`."""
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
            return Study(**tomllib.loads(self._file.attrs["study"]))

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

    @cached_property
    def summary(self) -> dict[str, Any]:
        """What `summary.json` says: scar, depths, volumes, areas, residuals, conservation, assumptions."""
        from warpwear.summary import summarise

        return summarise(self)

    @cached_property
    def surface_evolution(self) -> "SurfaceEvolution":
        """Roughness inside the scar and islands of contact at every snapshot."""
        from warpwear.evolution import surface_evolution

        return surface_evolution(self)

    @property
    def record(self) -> dict[str, Any]:
        """What the run recorded beside numbers: the surface, notices and warnings, elapsed time."""
        with _damage_told(self._file):
            found: dict[str, Any] = json.loads(self._file.attrs.get("record", "{}"))
            return found

    @property
    def plot(self) -> "Plotter":
        """Figures: `result.plot.cof()` and so on return a matplotlib figure."""
        from warpwear.figures import Plotter

        return Plotter(self)

    def _repr_html_(self) -> str:
        """A notebook's view of the result."""
        from warpwear.notebook import to_html

        return to_html(self)

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
