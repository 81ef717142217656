"""Whether a file holds what a run writes: names, types, shapes and plausible values, before any is used."""

import json
import math
from typing import Any

import h5py
import numpy as np

from warpwear.history import quantities
from warpwear.history.quantities import stress_columns
from warpwear.study.study import Study

#: Deflate makes data smaller by no more than this factor: what claims more than a file can hold was never
#: written.
DEFLATE = 1100
#: A dataset of fewer bytes may claim what it likes [B].
SMALL = 2**20
Shape = tuple[int | None, ...]
#: Attributes of the file, with what they have to be.
ATTRIBUTES: dict[str, type | tuple[type, ...]] = {
    "version": str,
    "device": str,
    "precision": str,
    "threads": (int, np.integer),
    "finished": (bool, np.bool_),
}
#: Columns that no step has without a contact.
POSITIVE = (
    *("area_contact", "area_touched", "area_cumulative", "area_nominal", "load"),
    *("patch_along", "patch_across"),
)
#: What a run records beside numbers, with what it has to be.
RECORD: dict[str, type | tuple[type, ...]] = {
    "surface": dict,
    "files": dict,
    "warnings": list,
    "notes": list,
    "elapsed_s": (int, float),
    "made_with": dict,
}


def check_content(file: h5py.File, study: Study, *, patch: str) -> None:
    """Raise ValueError, naming it, for the first thing that no run of the study writes.

    patch: name of the numbers of the patches in the history.
    """
    for name, kind in ATTRIBUTES.items():
        if not isinstance(file.attrs.get(name), kind):
            raise ValueError(f"its attribute {name} is {file.attrs.get(name)!r:.40}")
    _check_record(json.loads(file.attrs.get("record", "{}")))
    nx, ny = study.cells.nx, study.cells.ny
    rows = study.track.rows if study.is_swept else nx
    steps = _numbers(file, "history/distance").size
    if not steps:
        raise ValueError("its history has no step")
    history = _item(file, "history", h5py.Group)
    lacking = {column.name for column in quantities.columns_of(study)} - {*history}
    if lacking:
        raise ValueError(f"its history has no {', '.join(sorted(lacking))}")
    shapes: dict[str, Shape] = {f"history/{name}": (steps,) for name in history}
    shapes |= {"grid/x": (nx,), "grid/y": (ny,)}
    if study.counter.shape == "measured":
        shapes["counter/heights"] = nx, ny
    if study.is_swept:
        shapes |= {"track/x": (rows,), "track/heights": (rows, ny)}
    if study.study.model == "two-scale":
        count = study.patch_layout.count
        shapes |= {f"history/{table.name}": (steps, count) for table in quantities.PATCH_TABLES}
        shapes[f"history/{patch}"] = (count,)
        shapes |= dict.fromkeys(("macro/x", "macro/y"), (study.patch_layout.across,))
    if study.wear.sheds:
        left = _numbers(file, "pieces/step").size
        shapes |= {f"pieces/{name}": (left,) for name in quantities.OF_PIECES}
    if "stresses" in file:
        depths = len(_item(file, "snapshots", h5py.Group)), len(study.stress_depths)
        along = {"y": nx, "x": ny}[study.output.stress_plane[0]]
        for name in stress_columns(study):
            shapes[f"stresses/{name}"] = (*depths, along) if name.endswith("_plane") else depths
    for path, shape in shapes.items():
        _numbers(file, path, shape)
    places = {"grid/x": study.cells.x, "grid/y": study.cells.y}
    places |= {"track/x": study.track.x} if study.is_swept else {}
    for path, values in places.items():
        if not np.allclose(file[path][()], values, rtol=0.0, atol=1.0e-6 * study.grid.cell):
            raise ValueError(f"its {path} are not the places of the cells")
    for name in history.keys() & {*POSITIVE}:
        if not file[f"history/{name}"][()].min() > 0.0:
            raise ValueError(f"its history/{name} is not always positive")
    if study.friction.fitted != "coulomb" and (file["history/cof"][()] == 0.0).any():
        raise ValueError("its history/cof is 0, where cells shear")
    distance, slid = file["history/distance"][()], np.cumsum(np.maximum(file["history/increment"][()], 0.0))
    if not np.isfinite(distance).all() or not np.allclose(slid, distance, rtol=1.0e-6, atol=0.0):
        raise ValueError("its history/distance is not the sum of its increments")
    check_snapshots(file, study)


def check_snapshots(file: h5py.File, study: Study) -> None:
    """Raise ValueError for a snapshot that no run of the study keeps."""
    nx, ny = study.cells.nx, study.cells.ny
    rows = study.track.rows if study.is_swept else nx
    for name in _item(file, "snapshots", h5py.Group):
        place = f"snapshots/{name}"
        attributes = _item(file, place, h5py.Group).attrs
        if not isinstance(attributes.get("distance"), int | float | np.number):
            raise ValueError(f"its {place} has no distance")
        if not np.isfinite(attributes["distance"]) or study.is_swept != ("row" in attributes):
            raise ValueError(f"its {place} is of no moment of this run")
        if study.is_swept and not isinstance(attributes["row"], int | np.integer):
            raise ValueError(f"the row of its {place} is {attributes['row']!r}")
        for field, quantity in quantities.FIELDS.items():
            if field in file[place] or quantity.only is None:
                _numbers(file, f"{place}/{field}", (rows if quantity.frame == "disc" else nx, ny))


def check_fields(fields: dict[str, Any], study: Study) -> None:
    """Raise ValueError for values that no field of a run has: only a gap may be infinite, and some signed.

    Unknown is what lies beside the patches of a run that has some of the area.
    """
    for name, values in fields.items():
        known = values[~np.isnan(values)] if study.samples_area else values
        least = -math.inf if quantities.FIELDS[name].signed else 0.0
        if name != "gap" and known.size and not (np.isfinite(known).all() and known.min() >= least):
            raise ValueError(f"its {name} is negative, infinite or unknown in places")


def _check_record(record: Any) -> None:
    if not isinstance(record, dict):
        raise ValueError("its record is none")
    for name, kind in RECORD.items():
        if not isinstance(record.get(name), kind):
            raise ValueError(f"the {name} of its record is {record.get(name)!r:.40}")
    if not all(isinstance(note, str) for note in record["warnings"] + record["notes"]):
        raise ValueError("a warning or a note of its record is no text")


def _numbers(file: h5py.File, path: str, shape: Shape | None = None) -> h5py.Dataset:
    """Return a dataset of real numbers of a shape, kept in this file; None: a vector of any length."""
    item = _item(file, path, h5py.Dataset)
    if item.dtype.kind not in "iuf" or item.dtype.itemsize > 8:
        raise ValueError(f"its {path} holds no numbers")
    if item.ndim != 1 if shape is None else item.shape != shape:
        raise ValueError(f"its {path} has the shape {item.shape}")
    if item.is_virtual or item.external:
        raise ValueError(f"its {path} lies in another file")
    # Of the whole file, which holds gaps everywhere: a small contact leaves a field all but empty, and
    # blocks of zeros take no room.
    if item.nbytes > max(SMALL, DEFLATE * file.id.get_filesize()):
        raise ValueError(f"its {path} was never written")
    return item


def _item(file: h5py.File, path: str, kind: type) -> Any:
    """Return the group or the dataset at a path, each part of which leads on within this file."""
    place: Any = file
    for name in path.split("/"):
        if not isinstance(place, h5py.Group) or name not in place:
            raise ValueError(f"it lacks {path}")
        if isinstance(place.get(name, getlink=True), h5py.ExternalLink):
            raise ValueError(f"its {path} lies in another file")
        place = place[name]
    if not isinstance(place, kind):
        raise ValueError(f"its {path} {'is no group' if kind is h5py.Group else 'holds no numbers'}")
    return place
