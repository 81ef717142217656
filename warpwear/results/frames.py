"""A result as tables of pandas and data sets of xarray, with units and meanings in their attributes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.history.quantities import FIELDS, PATCH_TABLES, UNITS, Quantity, columns_of, per
from warpwear.results.file import ResultFile

COLUMNS = {quantity.name: quantity for quantity in per("step")}
#: What the axes of fields are, for people and for programs that follow the CF conventions.
AXES = {
    "distance": {"long_name": "sliding distance of the snapshot"},
    "x": {"long_name": "place along the sliding direction, 0 below the unworn apex", "axis": "X"},
    "y": {"long_name": "place across the sliding direction", "axis": "Y"},
    "track_x": {"long_name": "place along the track, 0 in its middle"},
}


def to_dataframe(result: ResultFile) -> Any:
    """Return the history as a pandas.DataFrame, a row a step, a column a quantity; units in `attrs["units"]`.

    Raises InputError where pandas is not installed.
    """
    frame = package("pandas", "to_dataframe").DataFrame(dict(result.history))
    frame.index.name = "step"
    units = UNITS | {column.name: column.units for column in columns_of(result.study)}
    frame.attrs["units"] = {name: units[name] for name in frame if name in units}
    return frame


def to_xarray(result: ResultFile) -> Any:
    """History, tables of patches and all snapshots as an xarray.Dataset, read into memory.

    Dimensions: step (row of the history); distance (of the snapshots) [mm], x, y [mm], and track_x [mm] for
    the disc of a swept run; patch. `step_distance` is the history's distance. Units and meanings stand in
    the attributes `units` and `long_name`. A single snapshot is read from the file by
    xarray.open_dataset(path, group="snapshots/0000", engine="h5netcdf"). Raises InputError without xarray.
    """
    snapshots = list(result.snapshots)
    dataset = courses(result, tuple(range(len(snapshots))))
    for name in snapshots[0].fields if snapshots else ():
        along = "track_x" if FIELDS[name].frame == "disc" and "track_x" in dataset.coords else "x"
        stacked = np.stack([snapshot.fields[name] for snapshot in snapshots])
        dataset[name] = described(FIELDS, name, ("distance", along, "y"), stacked)
    return dataset


def courses(result: ResultFile, numbers: Sequence[int]) -> Any:
    """Return what `to_xarray` gives but for the fields, with coordinates of snapshots of these numbers."""
    xarray = package("xarray", "to_xarray")
    history, columns = dict(result.history), COLUMNS | {c.name: c for c in columns_of(result.study)}
    coordinates = {
        "step": ("step", np.arange(history["distance"].size), {"long_name": "row of the history"}),
        "step_distance": described(COLUMNS, "distance", ("step",), history.pop("distance")),
    }
    data = {name: described(columns, name, ("step",), values) for name, values in history.items()}
    if result.study.study.model == "two-scale":
        tables = {table.name: table for table in PATCH_TABLES}
        data |= {name: described(tables, name, ("step", "patch"), getattr(result, name)) for name in tables}
        places = np.meshgrid(result.macro_x, result.macro_y, indexing="ij")
        about_places = {"units": "mm", "long_name": "centre of the patch"}
        for name, centres in zip(("patch_x", "patch_y"), places, strict=True):
            coordinates[name] = ("patch", centres.ravel(), about_places)
    if numbers:
        axes = {"distance": result.snapshot_distances[list(numbers)], "x": result.x, "y": result.y}
        if result.study.is_swept:
            axes["track_x"] = result.track_x
            rows = result.snapshot_rows[list(numbers)]
            coordinates["track_row"] = ("distance", rows, {"long_name": "row of the track under x[0]"})
        coordinates |= {name: (name, values, {"units": "mm"} | AXES[name]) for name, values in axes.items()}
    about = {"Conventions": "CF-1.11", "title": result.study.study.name}
    about |= {"source": f"warpwear {result.attributes['version']}", "study": result.study.to_toml()}
    if result.study.study.description:
        about["comment"] = result.study.study.description
    return xarray.Dataset(data, coordinates, about)


def described(
    declared: Mapping[str, Quantity], name: str, dimensions: tuple[str, ...], values: Any
) -> tuple[tuple[str, ...], Any, dict[str, str]]:
    """Make a variable for xarray: dimensions, values, and unit and meaning of the quantity."""
    known = declared.get(name)
    return dimensions, values, {"units": known.units, "long_name": known.meaning} if known else {}


def package(name: str, what: str) -> Any:
    """Import a package for a method. Raises InputError where it is not installed."""
    try:
        return lazy.load(name)
    except ImportError as error:
        raise InputError(f"{what}() needs the package {name}: pip install 'warpwear[io]'") from error
